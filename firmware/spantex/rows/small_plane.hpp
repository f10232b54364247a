// SPDX-License-Identifier: Apache-2.0
// Set-up of a plane in 64-bit integers, for programs that have no room for plane.hpp's 128-bit one: the same plane, from coefficients in a smaller range.
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>
#include <spantex/plane.hpp>
#include <spantex/status.hpp>

namespace spantex::rows {

// u = (a x + b y + c)/(g x + h y + i), v = (d x + e y + f)/(...), x and y in pixels, origin top left; only ratios matter, and the sign: a point is in
// front where the divisor is positive. |a|, |b|, |d|, |e|, |g|, |h| < 2^40, |c|, |f|, |i| < 2^52.
struct homography64 { int64_t a, b, c, d, e, f, g, h, i; };

namespace detail {

constexpr uint64_t bound_of(const linear_form& f, int32_t rx, int32_t ry) { return magnitude(f.x) * uint32_t(rx) + magnitude(f.y) * uint32_t(ry) + magnitude(f.c); }
constexpr int64_t scaled_by(int64_t x, int drop) { return drop > 0 ? shift_right_symmetric(x, drop) : x * (int64_t(1) << -drop); }
constexpr linear_form scaled_form(const linear_form& f, int drop) { return {scaled_by(f.x, drop), scaled_by(f.y, drop), scaled_by(f.c, drop)}; }

}  // namespace detail

// The plane of make_plane(homography), without its exact forms; `Levels`: with what filters with levels need. Errors: as there; out_of_range.
template <bool Levels>
constexpr status make_small_plane(const homography64& m, rectangle region, plane& out) {
  if (!on_screen(region)) return status::bad_size;
  const uint64_t slopes = magnitude(m.a) | magnitude(m.b) | magnitude(m.d) | magnitude(m.e) | magnitude(m.g) | magnitude(m.h);
  if (slopes >> 40 != 0 || (magnitude(m.c) | magnitude(m.f) | magnitude(m.i)) >> 52 != 0) return status::out_of_range;
  const int32_t ox = region.x0 + region.x1, oy = region.y0 + region.y1, rx = region.x1 - region.x0 + 32, ry = region.y1 - region.y0 + 32;
  const auto about = [=](int64_t x, int64_t y, int64_t c) { return linear_form{x, y, x * ox + y * oy + 2 * c}; };
  linear_form u = about(m.a, m.b, m.c), v = about(m.d, m.e, m.f), w = about(m.g, m.h, m.i);
  const int w_bits = bit_length(detail::bound_of(w, rx, ry));
  if (w_bits == 0) return status::degenerate;
  const int drop = max_of(bit_length(detail::bound_of(u, rx, ry) | detail::bound_of(v, rx, ry)) - 59, w_bits - 45);
  out.u = detail::scaled_form(u, drop);
  out.v = detail::scaled_form(v, drop);
  out.w = detail::scaled_form(w, drop);
  out.origin_x = ox;
  out.origin_y = oy;
  out.major_log2 = out.minor_log2 = 0;
  out.dropped_bits = out.rounding_bits = 0;
  // In front somewhere: at the middle, or at the corner where W is largest.
  int32_t ax = ox, ay = oy;
  if (out.w_at(ax, ay) <= 0) {
    ax = out.w.x > 0 ? 2 * region.x1 - 1 : 2 * region.x0 + 1;
    ay = out.w.y > 0 ? 2 * region.y1 - 1 : 2 * region.y0 + 1;
    if (out.w_at(ax, ay) <= 0) return status::degenerate;
  }
  if constexpr (Levels) out.major_log2 = major_log2_at(out, ax, ay);
  return status::ok;
}

}  // namespace spantex::rows
