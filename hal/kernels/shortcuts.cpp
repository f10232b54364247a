// SPDX-License-Identifier: Apache-2.0
#include "shortcuts.hpp"

#include <string.h>

#include <algorithm>

#include "level_rows.hpp"

namespace spantex::kernels {
namespace {

// Half pixels, from the first pixel's centre to the last's.
struct corners { int32_t x0, y0, x1, y1; };
corners spans_of(rectangle area) {
  constexpr int32_t of_a_span = 2 * span_side;
  const auto first = [](int32_t x) { return x / span_side * of_a_span + 1; };
  const auto last = [](int32_t x) { return ((x - 1) / span_side + 1) * of_a_span - 1; };
  return {first(area.x0), first(area.y0), last(area.x1), last(area.y1)};
}

template <class Holds>
bool at_every(const corners& c, const Holds& holds) {
  return holds(c.x0, c.y0) && holds(c.x1, c.y0) && holds(c.x0, c.y1) && holds(c.x1, c.y1);
}

// How far a position may lie from a texel's centre, 2^-16 texel, so that every weight is 0: less than half a weight's step. The rounding to coordinate_bits
// takes half a unit of that, what comes before it (ACCURACY 4, E = 3) 2^-16 texel and less: three quarters of it spare more.
// Then from a span's first pixel to its last, seven, positions change by a texel a pixel give or take 2/7 of it, levels of detail by 1.45 times that, which
// rounds to 0, to 2^-10 and to level_bits after that, with 8 units of 2^-16 for log2, the mantissas and squares (ACCURACY 4); and a row has one sample.
constexpr const profile& by = profiles::standard;
constexpr int32_t most_off_centre = 3 << (13 - by.subtexel_bits);
static_assert(by.coordinate_bits >= 14 && by.offset_bits >= 23 && by.position_rounding == rounding::nearest);
static_assert(most_off_centre * 2 * 145 / 700 + 8 < 96 && by.level_bits <= 8 && by.sample_slack >= 1);  // 96: what two roundings to nearest make 1/256 of, 2^-16

// Steps of a texel a pixel, upright; W alike everywhere, so that spans are affine.
bool shift_of(const plane& p, const corners& c, int32_t& u, int32_t& v) {
  const int64_t w = p.w_at(c.x0, c.y0);
  constexpr int32_t farthest = 32000;
  if ((p.w.x | p.w.y) != 0 || w <= 0 || !rounding_is_small(p, w, 16)) return false;
  const auto texel = [&](int64_t n) { return n / w - (n % w < 0 ? 1 : 0); };
  const int64_t from_u = texel(p.u_at(c.x0, c.y0)) - c.x0 / 2, from_v = texel(p.v_at(c.x0, c.y0)) - c.y0 / 2;
  if (std::max(std::abs(from_u), std::abs(from_v)) > farthest - max_screen_px) return false;
  u = int32_t(from_u);
  v = int32_t(from_v);
  const int64_t limit = 2 * most_off_centre * (w >> 16);
  const auto centred = [&](int64_t n, int32_t texels_and_half) { return std::abs(2 * n - texels_and_half * w) <= limit; };  // texels_and_half: half texels
  return at_every(c, [&](int32_t x, int32_t y) { return centred(p.u_at(x, y), x + 2 * u) && centred(p.v_at(x, y), y + 2 * v); });
}

// `count` texels of a row from u on.
[[gnu::always_inline]] inline void copy_texels(const level_rows& map, int32_t u, int32_t v, int32_t count, rgba8* out) {
  const rgba8* const row = map.row(v) + map.apron;
  if (map.wrap_u == wrap::clamp) {
    const int32_t before = clamp_to(-u, 0, count), within = clamp_to(map.columns - max_of(u, 0), 0, count - before);
    std::fill_n(out, before, row[0]);
    std::copy_n(row + u + before, within, out + before);
    std::fill_n(out + before + within, count - before - within, row[map.columns - 1]);
    return;
  }
  for (int32_t at = map.column(u, 1) - map.apron; count > 0; at = 0) {
    const int32_t n = min_of(count, map.columns - at);
    memcpy(out, row + at, size_t(n) * sizeof *out);
    out += n;
    count -= n;
  }
}

// Calls draw(x, y, count) for the pixels of a row of spans, as many side by side as their masks are the same whole rows.
template <class Draw>
void each_run(const row_work& work, const Draw& draw) {
  constexpr span_mask a_row = 0xFF;
  for (int k = 0; k < work.count;) {
    const span_mask mask = work.masks[k];
    int same = 1;
    while (k + same < work.count && work.masks[k + same] == mask) ++same;
    for (int j = 0; j < span_side; ++j) {
      const auto bits = uint32_t(mask >> (span_side * j) & a_row);
      const int32_t x = (work.sx + k) * span_side, y = work.sy * span_side + j;
      if (bits == a_row) {
        draw(x, y, same * span_side);
        continue;
      }
      for (int n = 0; n < same; ++n)
        for (uint32_t rest = bits; rest != 0; rest &= rest - 1) draw(x + n * span_side + __builtin_ctz(rest), y, 1);
    }
    k += same;
  }
}

}  // namespace

shortcut shortcut_of(const surface& s, const planar_map& texels, rectangle area) {
  const corners c = spans_of(area);
  if (texels.levels_in_rows().uniform() && at_every(c, [&](int32_t x, int32_t y) { return s.map->w_at(x, y) > 0; })) return {shortcut::way::fill, 0, 0};
  shortcut found;
  if (shift_of(*s.map, c, found.u, found.v)) found.how = shortcut::way::copy;
  return found;
}

void draw_by(const shortcut& s, const row_work& work) {
  const auto pixel = [&](int32_t x, int32_t y) { return work.pixels + (int64_t(y - work.sy * span_side) * work.stride + x); };
  const level_rows map(*work.texels);
  if (s.how == shortcut::way::fill) return each_run(work, [&](int32_t x, int32_t y, int32_t count) { std::fill_n(pixel(x, y), count, *map.origin); });
  each_run(work, [&](int32_t x, int32_t y, int32_t count) { copy_texels(map, x + s.u, y + s.v, count, pixel(x, y)); });
}

}  // namespace spantex::kernels
