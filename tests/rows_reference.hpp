// SPDX-License-Identifier: Apache-2.0
// Drawing by rows, a pixel at a time as docs/SPEC.md "Rows" says it: its block is found by halving the 32 x 32 or 256 x 32 pixels that hold it, its position
// the row's polynomial, its colour a function of sample.hpp, every texel wrapped on its own. Slow; kernels and borders have no part in it.
#pragma once
#include <spantex/rows/draw.hpp>

namespace spantex::rows {

struct reference_position { block b; int i, j; };

// last_level < 0: a filter without levels.
inline bool find_block(const plane& p, int32_t x, int32_t y, int last_level, reference_position& out) {
  centre r{};
  const auto try_at = [&](int32_t x0, int32_t y0, int k, int n) {
    return last_level < 0 ? block_at<false>(p, x0, y0, k, n, {}, r, out.b) : block_at<true>(p, x0, y0, k, n, {last_level, 0}, r, out.b);
  };
  for (int k = has_straight_rows(p) ? widest_block_log2 : largest_block_log2, n = largest_block_log2;;) {
    const int32_t x0 = x >> k << k, y0 = y >> n << n;
    switch (try_at(x0, y0, k, n)) {
      case outcome::behind: return false;
      case outcome::drawn: out.i = int(x - x0); out.j = int(y - y0); return true;
      case outcome::upper_and_lower: --n; break;
      case outcome::left_and_right: --k; break;
    }
  }
}

// Position on level 0, 2^-16 texel, by the row's polynomial.
struct exact_position { int64_t u, v; };
inline exact_position position_on_level_0(const reference_position& at) {
  walk w;
  row_at(at.b, at.j, w);
  const int64_t pairs = int64_t(at.i) * (at.i - 1) / 2, up = at.b.unit_log2;
  return {int64_t(at.b.u.base) * 65536 + ((w.u + int64_t(at.i) * w.du + pairs * w.ddu) << up),
          int64_t(at.b.v.base) * 65536 + ((w.v + int64_t(at.i) * w.dv + pairs * w.ddv) << up)};
}

// A level's position of the pixel: the row's numbers scaled to the level, then the polynomial.
inline level_walk on_level(const reference_position& at, int level, int32_t offset) {
  block b = at.b;
  detail::set_offsets(b, level, offset);
  level_walk w{detail::base_on(level, b.u.base), detail::base_on(level, b.v.base), {}};
  row_at(b, at.j, w.at);
  w.at = detail::scaled(w.at, level - b.unit_log2);
  for (int n = 0; n < at.i; ++n) w.at.step();
  return w;
}

// False: nothing is drawn.
inline bool reference_pixel(const plane& p, const texture_view& t, filter kind, int32_t x, int32_t y, uint16_t& out) {
  reference_position at;
  if (!find_block(p, x, y, uses_levels(kind) ? t.last_level() : -1, at)) return false;
  const auto one = [&](int level) {
    const level_walk w = on_level(at, level, kind == filter::nearest ? 0 : snap);
    if (kind == filter::nearest) return pixel_of<filter::nearest>(level_of(t, level), w);
    return kind == filter::three_point ? pixel_of<filter::three_point>(level_of(t, level), w) : pixel_of<filter::bilinear>(level_of(t, level), w);
  };
  if (!uses_levels(kind)) { out = one(0); return true; }
  const level_run run = level_rows_of(at.b).row(at.j);
  const int32_t level = run.start + at.i * run.step + detail::level_rounding(kind);
  const int whole = int(clamp_to(level >> 16, -1, t.last_level())), fine = max_of(whole, 0);
  if (kind == filter::mip_bilinear || whole < 0 || fine == t.last_level()) { out = one(fine); return true; }
  out = pixel_between(level_of(t, fine), level_of(t, fine + 1), on_level(at, fine, snap), level);
  return true;
}

}  // namespace spantex::rows
