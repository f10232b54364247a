// SPDX-License-Identifier: Apache-2.0
// Runs: a row of a block, cut where its texels leave the level (a map repeats, or ends) or its level of detail passes a whole number, and given to the
// kernels. A pixel whose texels lie on both sides of a border is read texel by texel.
#pragma once
#include <stdint.h>

#include <spantex/rows/block.hpp>
#include <spantex/rows/kernels.hpp>
#include <spantex/rows/sample.hpp>
#include <spantex/span.hpp>
#include <spantex/texture.hpp>

namespace spantex::rows {

// One level of an RGB565 map as kernels see it.
struct level_view {
  const texel565* texels;
  int32_t width, height;
  wrap wrap_u, wrap_v;
  bool masked;  // repeats_in_powers_of_two()
};

// A map that repeats in powers of two: whole positions wrap by masks.
constexpr bool repeats_in_powers_of_two(wrap across, wrap down, int32_t width, int32_t height) {
  return across == wrap::repeat && down == wrap::repeat && (width & (width - 1)) == 0 && (height & (height - 1)) == 0;
}

// Not returned: Cortex-M0+ would copy it by a call.
SPANTEX_FRAME_APART constexpr void set_level_view(const texture_view& t, int level, level_view& out) {
  out.texels = t.numbers(level);
  out.width = t.width(level);
  out.height = t.height(level);
  out.wrap_u = t.wrap_u();
  out.wrap_v = t.wrap_v();
  out.masked = repeats_in_powers_of_two(out.wrap_u, out.wrap_v, out.width, out.height);
}
constexpr level_view level_of(const texture_view& t, int level) {
  level_view out{};
  set_level_view(t, level, out);
  return out;
}

// Positions along a run on one level: whole texels, and a walk relative to them.
struct level_walk {
  int32_t base_u, base_v;
  walk at;
};

namespace detail {

constexpr int32_t base_on(int level, int32_t base) { return (base >> (level + 1)) * 2; }

// Positions of a block's rows are to be relative to the level's even base, plus `offset` texels of the level 2^-16. On the block's own level
// (its unit) rows then come as they are; another level scales them.
constexpr void set_offsets(block& b, int level, int32_t offset) {
  const int32_t mask = (2 << level) - 1, up = 16 - b.unit_log2, own = scale_down(offset, b.unit_log2 - level);
  b.u.offset = ((b.u.base & mask) * (1 << up)) + own;
  b.v.offset = ((b.v.base & mask) * (1 << up)) + own;
}
constexpr walk scaled(const walk& w, int down) {
  return {scale_down(w.u, down, rounding::floor), scale_down(w.v, down, rounding::floor), scale_down(w.du, down), scale_down(w.dv, down),
          scale_down(w.ddu, down), scale_down(w.ddv, down)};
}

// The same run on the coarser level: a bound is enough, its positions follow from the finer one's.
constexpr int32_t coarser(int32_t fine) { return (fine + snap) >> 1; }

struct interval { int32_t low, high; };
struct box { interval u, v; };

// Positions along `count` pixels. A parabola that turns within the run passes its ends by at most bend n^2 / 8.
constexpr interval reach_along(int32_t start, int32_t step, int32_t bend, int count) {
  const int n = count - 1;
  const int32_t end = start + n * step + n * (n - 1) / 2 * bend, last_step = step + n * bend;
  const int32_t more = (step ^ last_step) < 0 ? int32_t(magnitude(bend)) * n * n / 8 + 1 : 0;
  return {(start < end ? start : end) - more, (start < end ? end : start) + more};
}

// Where texel 0 of the copy of the map that holds a position lies in positions relative to the base. False where the map is not repeated as it is.
constexpr bool origin_of(int32_t position, int32_t base, int32_t size, wrap mode, int32_t& origin) {
  const int32_t texel = position >> 16, index = base + texel;
  origin = -base;
  if (uint32_t(index) < uint32_t(size)) return true;
  if (mode != wrap::repeat) return false;
  origin = texel - wrapped(mode, index, size);
  return true;
}

// Positions whose texels all lie in that copy: [first, end).
struct borders { int32_t first, end; };
constexpr borders borders_of(int32_t origin, int32_t size, int neighbour) { return {origin * (1 << 16), (origin + size - neighbour) * (1 << 16)}; }
constexpr bool lies_in(interval x, borders b) { return x.low >= b.first && x.high < b.end; }

// Those of the coarser level as positions of the finer one, whose (fine + snap) / 2 they bound.
constexpr borders of_finer(borders coarse) { return {2 * coarse.first - snap, 2 * coarse.end - snap}; }
constexpr borders within_both(borders a, borders b) { return {a.first > b.first ? a.first : b.first, a.end < b.end ? a.end : b.end}; }

// Pixels until a position that changes by `step` has left its borders: 0 if it is not within them now, at most `count`.
constexpr int until_border(int32_t position, int32_t step, borders b, int count) {
  if (count == 0 || position >= b.end || position < b.first) return 0;
  const int32_t last = position + (count - 1) * step;
  if (last < b.end && last >= b.first) return count;
  const int32_t n = step > 0 ? (b.end - 1 - position) / step : (position - b.first) / -step;
  return n + 1;
}
// The copy of a level, or of two, that holds a pair of positions.
struct copy { borders u, v; };
[[gnu::noinline]] constexpr int bent_until_border(const walk& w, const copy& c, int n) {
  while (n > 1 && !(lies_in(reach_along(w.u, w.du, w.ddu, n), c.u) && lies_in(reach_along(w.v, w.dv, w.ddv, n), c.v))) n -= 1 + n / 8;
  return n;
}
SPANTEX_FRAME_APART constexpr int straight_until_border(const walk& w, const copy& c, int count) { return until_border(w.v, w.dv, c.v, until_border(w.u, w.du, c.u, count)); }
constexpr int until_border(const walk& w, const copy& c, int count) {
  const int n = straight_until_border(w, c, count);
  return is_straight(w) ? n : bent_until_border(w, c, n);
}

// To the pixel n further on.
SPANTEX_WRAPS constexpr void go_on(walk& w, int n) {
  if (!is_straight(w)) {
    w = advanced(w, n);
    return;
  }
  w.u += n * w.du;
  w.v += n * w.dv;
}

inline bool copy_of(const level_view& t, int32_t u, int32_t v, int32_t base_u, int32_t base_v, int neighbour, copy& out, source& s) {
  int32_t x = 0, y = 0;
  if (!origin_of(u, base_u, t.width, t.wrap_u, x) || !origin_of(v, base_v, t.height, t.wrap_v, y)) return false;
  out = {borders_of(x, t.width, neighbour), borders_of(y, t.height, neighbour)};
  s = {t.texels - (y * t.width + x), 2 * t.width};
  return true;
}

// A pointer for the kernel if all positions lie in one copy of the level.
SPANTEX_FRAME_APART inline bool source_of(const level_view& t, interval u, interval v, int32_t base_u, int32_t base_v, int neighbour, source& out) {
  copy c{};
  return copy_of(t, u.low, v.low, base_u, base_v, neighbour, c, out) && lies_in(u, c.u) && lies_in(v, c.v);
}

// On the seam to the next copy, which two levels leave two texels wide and more.
constexpr bool is_beside(int32_t position, borders b) { return uint32_t(position - b.end) < 2 << 16 || uint32_t(b.first - 1 - position) < 2 << 16; }
constexpr bool is_beside(const walk& w, const copy& c) { return is_beside(w.u, c.u) || is_beside(w.v, c.v); }

// Pixels of a run, `count` at most, that lie in one copy of the level, and that copy; 0 if not even the first.
SPANTEX_FRAME_APART inline int run_within(const level_view& t, const level_walk& w, int count, int neighbour, source& out) {
  copy c;
  if (!copy_of(t, w.at.u, w.at.v, w.base_u, w.base_v, neighbour, c, out)) return 0;
  return until_border(w.at, c, count);
}

inline uint32_t wrapped_texel(const level_view& t, int32_t x, int32_t y) {
  return t.texels[wrapped(t.wrap_v, y, t.height) * t.width + wrapped(t.wrap_u, x, t.width)];
}
inline texels masked_texels(const level_view& t, int32_t x, int32_t y) {
  const int32_t across = t.width - 1, down = t.height - 1, x0 = x & across, x1 = (x + 1) & across;
  const texel565 *const top = t.texels + (y & down) * t.width, *const bottom = t.texels + ((y + 1) & down) * t.width;
  return {top[x0], top[x1], bottom[x0], bottom[x1]};
}
inline texels wrapped_texels(const level_view& t, int32_t x, int32_t y) {
  if (t.masked) return masked_texels(t, x, y);
  const int32_t x0 = wrapped(t.wrap_u, x, t.width), x1 = wrapped(t.wrap_u, x + 1, t.width);
  const texel565 *const top = t.texels + wrapped(t.wrap_v, y, t.height) * t.width, *const bottom = t.texels + wrapped(t.wrap_v, y + 1, t.height) * t.width;
  return {top[x0], top[x1], bottom[x0], bottom[x1]};
}

#if SPANTEX_ROWS_MVE
// Where lanes read positions that lie in a box, in one copy of the level. False if their offsets do not fit.
inline bool lanes_within(const box& x, const source& s, mve::source& out) {
  const int32_t u = x.u.low >> 16, v = x.v.low >> 16, pitch = s.pitch_bytes / 2;
  out = {s.origin + (v * pitch + u), pitch, 0, 0, uint32_t(-u) << 16, uint32_t(-v) << 16};
  return mve::offsets_fit((x.v.high >> 16) - v + 2, pitch);
}
// Any positions, which lanes wrap.
inline bool lanes_wrapped(const level_view& t, int32_t base_u, int32_t base_v, mve::source& out) {
  if (!t.masked || t.width < 2 || t.width * t.height > 1 << 16 || max_of(t.width, t.height) > mve::longest_side) return false;
  out = {t.texels, t.width, uint16_t(t.width - 1), uint16_t((t.height - 1) * t.width), uint32_t(base_u) << 16, uint32_t(base_v) << 16};
  return true;
}
#endif

}  // namespace detail

// Filters of one level.
template <filter Kind>
SPANTEX_FRAME_APART inline uint16_t pixel_of(const level_view& t, const level_walk& w) {
  const int32_t x = w.base_u + texel_of(w.at.u), y = w.base_v + texel_of(w.at.v);
  if constexpr (Kind == filter::nearest) return uint16_t(detail::wrapped_texel(t, x, y));
  const texels four = detail::wrapped_texels(t, x, y);
  const uint32_t fu = weight_of(w.at.u), fv = weight_of(w.at.v);
  if constexpr (Kind == filter::three_point) return fv >= fu ? detail::three_points(four.t00, four.t01, four.t11, fv, fu) : detail::three_points(four.t00, four.t10, four.t11, fu, fv);
  return detail::pixel_of(detail::four_points(four, fu, fv));
}

// The kernel of a filter of one level.
template <filter Kind>
inline void run(uint16_t* out, int count, const walk& at, const source& s, scratch& between) {
  if constexpr (Kind == filter::nearest) nearest_run(out, count, at, s);
  else if constexpr (Kind == filter::three_point) three_point_run(out, count, at, s, between);
  else bilinear_run(out, count, at, s, between);
}
#if SPANTEX_ROWS_MVE
template <>
inline void run<filter::bilinear>(uint16_t* out, int count, const walk& at, const source& s, scratch& between) {
  mve::source map;
  if (count > 4 && detail::lanes_within({detail::reach_along(at.u, at.du, at.ddu, count), detail::reach_along(at.v, at.dv, at.ddv, count)}, s, map))
    mve::bilinear(out, count, at, map, between.words);
  else bilinear_run(out, count, at, s, between);
}
#endif

template <filter Kind>
[[gnu::noinline]] inline void draw_level(uint16_t* out, int count, const level_view& t, level_walk& w, scratch& between) {
#if SPANTEX_ROWS_MVE
  if constexpr (Kind == filter::bilinear) {
    mve::source map;
    if (detail::lanes_wrapped(t, w.base_u, w.base_v, map)) return mve::bilinear(out, count, w.at, map, between.words);
  }
#endif
  while (count > 0) {
    source s;
    int n = detail::run_within(t, w, count, Kind == filter::nearest ? 0 : 1, s);
    if (n > 0) run<Kind>(out, n, w.at, s, between);
    else *out = pixel_of<Kind>(t, w);
    n = max_of(n, 1);
    out += n;
    count -= n;
    if (count > 0) detail::go_on(w.at, n);
  }
}

namespace detail {

// What is added to a level of detail so that its whole part is the level: to nearest at the fraction's bits, or the nearest level.
constexpr int32_t level_rounding(filter kind) { return kind == filter::mip_bilinear ? (1 << 15) - 1 : 1 << (15 - blend_bits); }

// Whole levels of rows [from, to) of a block, -1 where the map is magnified: linear, so extremes are at corners.
SPANTEX_FRAME_APART constexpr interval levels_of(const block& b, int from, int to, int32_t rounding, int last_level) {
  const int last = (1 << b.k) - 1;
  const level_rows rows = level_rows_of(b);
  const level_run top = rows.row(from), bottom = rows.row(to - 1);
  const int32_t corners[] = {top.start, top.start + last * top.step, bottom.start, bottom.start + last * bottom.step};
  interval x{corners[0], corners[0]};
  for (int32_t c : corners) x = {c < x.low ? c : x.low, c > x.high ? c : x.high};
  const auto whole = [&](int32_t level) { return clamp_to((level + rounding) >> 16, -1, last_level); };
  return {whole(x.low), whole(x.high)};
}

inline namespace SPANTEX_ROWS_KERNELS {
// A block is drawn in strips of rows, made at once. Those of wide blocks are low, so that fewer parts of them lie on the map's borders; others as high as there is
// memory for.
inline constexpr int wide_strip_rows = 8, strip_rows = SPANTEX_ROWS_DSP ? 16 : 8;
inline constexpr int longest_seam = SPANTEX_ROWS_THUMB1 ? 16 : longest_run;  // pixels that are read texel by texel at once
constexpr int row_in_strip(int j) { return j & (strip_rows - 1); }

// Of one coordinate, rows from j on by additions, four at a time; it is walk's U, Du, Ddu. Two loops, as cores have few registers.
template <int32_t walk::*U, int32_t walk::*Du, int32_t walk::*Ddu>
SPANTEX_WRAPS inline void add_rows(const block_axis& x, const row_numbers<uint32_t>& j, int k, walk* to, const walk* end) {
  const row_differences& r = x.rows;
  {
    const uint32_t third = r.start[3];
    uint32_t start = value_of(r.start, j), first = r.start[1] + j.one * r.start[2] + j.two * third, second = r.start[2] + j.one * third;
    const int32_t offset = x.offset;
    for (walk* w = to; w < end; w += 4)
#pragma GCC unroll 4
      for (int n = 0; n < 4; ++n) {
        w[n].*U = (int32_t(start) >> row_bits) + offset;
        start += first;
        first += second;
        second += third;
      }
  }
  const uint32_t second = r.step[2], by_row = r.bend[1];
  uint32_t step = r.step[0] + j.one * r.step[1] + j.two * second, first = r.step[1] + j.one * second, bend = r.bend[0] + j.one * by_row;
  const int32_t down = row_bits + k - 1, columns = (1 << (k - 1)) - 1;
  for (walk* w = to; w < end; w += 4)
#pragma GCC unroll 4
    for (int n = 0; n < 4; ++n) {
      const int32_t bent = int32_t(bend) >> down;
      w[n].*Ddu = bent;
      w[n].*Du = (int32_t(step) >> down) - columns * bent;
      bend += by_row;
      step += first;
      first += second;
    }
}

// Rows [from, to) of a block, all in one strip.
SPANTEX_FRAME_APART inline void make_rows(const block& b, int from, int to, walk* rows) {
#ifndef __OPTIMIZE_SIZE__
  if (b.k > 0) {
    const int first = from & ~3;  // four at a time; those that are not asked for are of no use
    walk *const at = rows + row_in_strip(first), *const end = at + (to - first);
#if SPANTEX_ROWS_MVE
    mve::rows_from(b, first, at, end);
#else
    const row_numbers<uint32_t> j = numbers_of(uint32_t(first));
    add_rows<&walk::u, &walk::du, &walk::ddu>(b.u, j, b.k, at, end);
    add_rows<&walk::v, &walk::dv, &walk::ddv>(b.v, j, b.k, at, end);
#endif
    return;
  }
#endif
  for (int j = from; j < to; ++j) row_at(b, j, rows[row_in_strip(j)]);
}
}  // namespace SPANTEX_ROWS_KERNELS

// What is drawn at once of a block at (x0, y0): columns [left, right) of 32 of them, rows [top, bottom) of a strip, on a level alone or between it and the next.
struct block_part {
  int32_t x0, y0;
  int16_t left, right;
  int8_t top, bottom;
  int8_t level;
  bool two;
};

// Positions of `count` pixels of the rows between two of a block, on a level `down` above its own: the hull of their ends, and an eighth of a unit for what
// rows leave out.
SPANTEX_FRAME_APART constexpr void box_of_rows(const walk& top, const walk& bottom, int count, int down, box& out) {
  const int n = count - 1, pairs = n * (n - 1) / 2;
  const int32_t margin = scale_down(1 << 13, down) + 64;
  const auto end = [&](int32_t start, int32_t step, int32_t bend) { return start + n * step + pairs * bend; };
  const auto set_hull = [&](int32_t a, int32_t b, int32_t c, int32_t d, interval& x) {
    x.low = min_of(min_of(a, b), min_of(c, d)) - margin;
    x.high = max_of(max_of(a, b), max_of(c, d)) + margin;
  };
  set_hull(top.u, end(top.u, top.du, top.ddu), bottom.u, end(bottom.u, bottom.du, bottom.ddu), out.u);
  set_hull(top.v, end(top.v, top.dv, top.ddv), bottom.v, end(bottom.v, bottom.dv, bottom.ddv), out.v);
}

}  // namespace detail

inline namespace SPANTEX_ROWS_KERNELS {

// One surface being drawn. Its memory is the caller's: `state`, 664 bytes on a core of 32 bits, 1232 with what DSP kernels work in, 1424 with those of Cortex-M0+.
struct state {
  level_view fine, coarse;        // what runs need comes first: Cortex-M0+ reaches 31 words from an address
  level_walk at;
  level_run level;                // along a run between two levels
  source near, far;               // where it reads
  detail::copy within;            // the copy of both levels that it lies in
  detail::block_part part;        // that is drawn
  detail::box reach;              // of its positions
  block coordinates;
  centre about;                   // of the block
  walk rows[detail::strip_rows];  // of a strip of the block
  uint32_t masks[1 << largest_block_log2];  // of the block's rows; polygons
  rectangle area;                 // to be drawn
  scratch between;
};

}  // namespace SPANTEX_ROWS_KERNELS

// Between the state's levels. Where the fraction is 0 all along, the finer level alone is drawn: the same pixels.
inline void run_between(uint16_t* out, int count, const walk& at, state& s) {
  if (s.level.step == 0 && fraction_of(s.level.start) == 0) run<filter::bilinear>(out, count, at, s.near, s.between);
  else trilinear_run(out, count, at, s.near, s.far, s.level, s.between);
}

namespace detail {

// As run_within(), in one copy of each of two levels; that copy and where to read are the state's. -1 if there is none.
SPANTEX_FRAME_APART inline int run_within_both(state& s, int count) {
  const level_walk& w = s.at;
  copy c;
  if (!copy_of(s.fine, w.at.u, w.at.v, w.base_u, w.base_v, 1, s.within, s.near)) return -1;
  if (!copy_of(s.coarse, coarser(w.at.u), coarser(w.at.v), w.base_u >> 1, w.base_v >> 1, 1, c, s.far)) return -1;
  s.within = {within_both(s.within.u, of_finer(c.u)), within_both(s.within.v, of_finer(c.v))};
  return until_border(w.at, s.within, count);
}

}  // namespace detail

// Filters of two levels.
SPANTEX_FRAME_APART inline uint16_t pixel_between(const level_view& fine, const level_view& coarse, const level_walk& w, int32_t level) {
  const int32_t u = detail::coarser(w.at.u), v = detail::coarser(w.at.v);
  const int32_t x = w.base_u + texel_of(w.at.u), y = w.base_v + texel_of(w.at.v), coarse_x = (w.base_u >> 1) + texel_of(u), coarse_y = (w.base_v >> 1) + texel_of(v);
  texels a, b;
#ifndef __OPTIMIZE_SIZE__
  if (fine.masked) {  // then the other does as well
    a = detail::masked_texels(fine, x, y);
    b = detail::masked_texels(coarse, coarse_x, coarse_y);
  } else
#endif
  {
    a = detail::wrapped_texels(fine, x, y);
    b = detail::wrapped_texels(coarse, coarse_x, coarse_y);
  }
  return detail::pixel_between(detail::four_points(a, weight_of(w.at.u), weight_of(w.at.v)), detail::four_points(b, weight_of(u), weight_of(v)), fraction_of(level));
}

namespace detail {

// Pixels from where the walk is until it leaves the seam beside a copy; the first is there.
SPANTEX_FRAME_APART constexpr int seam_length(const walk& from, const copy& c, int count) {
  walk w = from;
  int n = 1;
  for (w.step(); n < count && is_beside(w, c); w.step()) ++n;
  return n;
}

constexpr void go_on_between(state& s, int n) {
  go_on(s.at.at, n);
  s.level.start += n * s.level.step;
}

// draw_seam(): the state's next pixels between its levels, at most longest_seam, read texel by texel.
#if SPANTEX_ROWS_THUMB1

// Places of pixels on one of two levels, whose texels, wherever they lie, are copied. Positions have `Bits` of fraction.
template <int Bits>
[[gnu::noinline]] SPANTEX_WRAPS inline void place_copies(uint32_t* to, uint32_t* copies, int count, const walk& from, const level_view& t, int32_t base_u, int32_t base_v, uint32_t weight) {
  const uint32_t* const end = to + thumb1::trilinear_words * count;
  if (t.masked && is_straight(from)) {
    const uint32_t pitch = 2 * t.width, across = pitch - 2, down = t.height - 1, du = from.du, dv = from.dv;
    const uint8_t* const map = reinterpret_cast<const uint8_t*>(t.texels);
    uint32_t u = from.u + (base_u << Bits), v = from.v + (base_v << Bits);
    const auto texel = [](const uint8_t* row, uint32_t x) { return uint32_t(*reinterpret_cast<const texel565*>(row + x)); };
    for (; to != end; to += thumb1::trilinear_words, u += du, v += dv) {
      const uint32_t x = u >> (Bits - 1), y = v >> Bits, left = x & across, right = (x + 2) & across;
      const uint8_t *const top = map + (y & down) * pitch, *const bottom = map + ((y + 1) & down) * pitch;
      copies = thumb1::place_copied(to, {texel(top, left), texel(top, right), texel(bottom, left), texel(bottom, right)}, copies, u << (32 - Bits), v << (32 - Bits) | weight);
    }
    return;
  }
  for (walk at = from; to != end; to += thumb1::trilinear_words, at.step())
    copies = thumb1::place_copied(to, wrapped_texels(t, base_u + (at.u >> Bits), base_v + (at.v >> Bits)), copies, uint32_t(at.u) << (32 - Bits), uint32_t(at.v) << (32 - Bits) | weight);
}

SPANTEX_FRAME_APART inline void draw_seam(uint16_t* out, int count, state& s) {
  uint32_t *const to = s.between.words, *const copies = to + thumb1::trilinear_words * longest_seam;
  const level_walk& w = s.at;
  const bool changes = s.level.step != 0;
  const uint32_t f = fraction_of(s.level.start);
  place_copies<16>(to, copies, count, w.at, s.fine, w.base_u, w.base_v, changes ? 0 : (1u << blend_bits) - f);
  place_copies<17>(to + thumb1::place_words, copies + 2 * longest_seam, count, thumb1::coarser(w.at), s.coarse, w.base_u >> 1, w.base_v >> 1, changes ? 0 : f);
  if (changes) thumb1::weigh(to, count, s.level);
  thumb1::trilinear(out, count, nullptr, {nullptr, 4}, {nullptr, 4}, s.level, to);
  go_on_between(s, count);
}

#else

SPANTEX_FRAME_MERGED inline void draw_seam(uint16_t* out, int count, state& s) {
  for (; count > 0; --count) {
    *out++ = pixel_between(s.fine, s.coarse, s.at, s.level.start);
    s.at.at.step();
    s.level.start += s.level.step;
  }
}

#endif

}  // namespace detail

// Between the state's levels, from where it is. Pixels beside the copy of the run before need no search.
[[gnu::noinline]] inline void draw_between(uint16_t* out, int count, state& s) {
  for (bool known = false; count > 0;) {
    int n = known && detail::is_beside(s.at.at, s.within) ? 0 : detail::run_within_both(s, count);
    known = n >= 0;
    if (n > 0) {
      run_between(out, n, s.at.at, s);
      if (n == count) return;
      detail::go_on_between(s, n);
    } else {
      n = known ? detail::seam_length(s.at.at, s.within, min_of(count, detail::longest_seam)) : 1;
      detail::draw_seam(out, n, s);
    }
    out += n;
    count -= n;
  }
}

// The first pixels of [first, end) of row j of a block that lie on one whole level, or between the same two: how many; the state is set for them. Its rows
// have been made without an offset.
struct level_part { int count; bool two; };
template <filter Kind>
[[gnu::noinline]] inline level_part begin_part(const texture_view& t, int j, int first, int end, state& s) {
  block& b = s.coordinates;
  level_walk& w = s.at;
  level_run level = level_rows_of(b).row(j);
  level.start += detail::level_rounding(Kind);
  const auto whole_level = [&](int i) { return clamp_to((level.start + i * level.step) >> 16, -1, t.last_level()); };
  int n = end - first;
  const int at = whole_level(first), fine = max_of(at, 0);
  while (whole_level(first + n - 1) != at) n = (n + 1) / 2;
  detail::set_offsets(b, fine, snap);
  set_level_view(t, fine, s.fine);
  w.base_u = detail::base_on(fine, b.u.base);
  w.base_v = detail::base_on(fine, b.v.base);
  w.at = s.rows[detail::row_in_strip(j)];
  w.at.u += b.u.offset;
  w.at.v += b.v.offset;
  if (fine != b.unit_log2) w.at = detail::scaled(w.at, fine - b.unit_log2);
  if (first > 0) w.at = advanced(w.at, first);
  if (Kind == filter::mip_bilinear || at < 0 || at == t.last_level()) return {n, false};
  set_level_view(t, fine + 1, s.coarse);
  s.level = {level.start + first * level.step, level.step};
  return {n, true};
}

}  // namespace spantex::rows
