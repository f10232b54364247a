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
constexpr void scale(linear_form& f, int drop) { f = {scaled_by(f.x, drop), scaled_by(f.y, drop), scaled_by(f.c, drop)}; }

// x hx + y hy + c about the origin of p. False out of range.
SPANTEX_FRAME_APART constexpr bool set_about_origin(const plane& p, int64_t x, int64_t y, int64_t c, linear_form& out) {
  if ((magnitude(x) | magnitude(y)) >> 40 != 0 || magnitude(c) >> 52 != 0) return false;
  out = {x, y, x * p.origin_x + y * p.origin_y + 2 * c};
  return true;
}

}  // namespace detail

// The plane of make_plane(homography), without its exact forms; `Levels`: with what filters with levels need. Errors: as there; out_of_range.
template <bool Levels>
constexpr status make_small_plane(const homography64& m, rectangle region, plane& out) {
  if (!on_screen(region)) return status::bad_size;
  const int32_t rx = region.x1 - region.x0 + 32, ry = region.y1 - region.y0 + 32;
  out.origin_x = region.x0 + region.x1;
  out.origin_y = region.y0 + region.y1;
  const bool in_range = detail::set_about_origin(out, m.a, m.b, m.c, out.u) && detail::set_about_origin(out, m.d, m.e, m.f, out.v) &&
                        detail::set_about_origin(out, m.g, m.h, m.i, out.w);
  if (!in_range) return status::out_of_range;
  const int w_bits = bit_length(detail::bound_of(out.w, rx, ry));
  if (w_bits == 0) return status::degenerate;
  const int drop = max_of(bit_length(detail::bound_of(out.u, rx, ry) | detail::bound_of(out.v, rx, ry)) - 59, w_bits - 45);
  detail::scale(out.u, drop);
  detail::scale(out.v, drop);
  detail::scale(out.w, drop);
  out.major_log2 = out.minor_log2 = 0;
  out.dropped_bits = out.rounding_bits = 0;
  if constexpr (Levels) return spantex::detail::set_major_log2(region, out);
  int32_t hx = 0, hy = 0;
  return spantex::detail::find_front(region, out, hx, hy) ? status::ok : status::degenerate;
}

}  // namespace spantex::rows
