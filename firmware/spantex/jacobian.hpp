// SPDX-License-Identifier: Apache-2.0
// The Jacobian of a pixel about its own centre, from the plane's forms, for filters that need more of it than lengths.
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>
#include <spantex/plane.hpp>
#include <spantex/reciprocal.hpp>

namespace spantex {

// Derivatives of (u, v) along the screen's axes at one point, with a common unknown scale; magnitudes below 2^31.
struct jacobian {
  int64_t ux, uy, vx, vy;
};

// The same in 2^-exponent texels per half pixel.
struct scaled_jacobian {
  jacobian columns;
  int exponent;
};

// W^2 J over W^2, with 1/W twice: 32 significant bits each. W^2 J = g 2^drop; J = g y y 2^(drop - 2 (63 + e)).
constexpr scaled_jacobian jacobian_of(const scaled_gradients& g, int64_t w) {
  const inverse over_w = invert(w);
  const int64_t y = int64_t(over_w.y >> 1);
  const auto over_w2 = [y](int64_t x) { return shift_right_symmetric(shift_right_symmetric(x * y, 31) * y, 31); };
  return {{over_w2(g.ux), over_w2(g.uy), over_w2(g.vx), over_w2(g.vy)}, 62 + 2 * over_w.exponent - g.drop};
}
constexpr scaled_jacobian jacobian_at(const plane& p, int32_t hx, int32_t hy) { return jacobian_of(scaled_gradients_at(p, hx, hy), p.w_at(hx, hy)); }

}  // namespace spantex
