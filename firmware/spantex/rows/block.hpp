// SPDX-License-Identifier: Apache-2.0
// Rows: texture coordinates for a core that samples the map where it lies (docs/SPEC.md "Rows"; errors: docs/ACCURACY.md "Rows").
//
// The screen is cut into squares of 32 pixels, or 256 x 32 where W is the same along a row, and those into halves, across or down, until coordinates
// are true enough: blocks of 2^k x 2^n pixels. Block: one division, numerators rebased on a whole texel as in coordinates.hpp, cut to 16 bits. Row: 1/w at
// the middle of the row by a series in 16-bit products; what is left of the perspective along the row is a polynomial of second degree with integer coefficients,
//   u(i) = start + i step + i (i - 1)/2 bend        2^-16 texel, exactly,
// so a pixel takes two additions a coordinate and the order of evaluation cannot matter. A block is as large as that is true to
// 2^-row_tolerance_bits texel. Products are of 16-bit numbers, sums of 32: the same on Cortex-M0+ as with DSP instructions.
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>
#include <spantex/plane.hpp>
#include <spantex/reciprocal.hpp>

namespace spantex::rows {

inline constexpr int largest_block_log2 = 5, widest_block_log2 = 8;
inline constexpr int row_tolerance_bits = 6;

// One coordinate of a block about its centre, hx and hy in half pixels: u - base = (c + a hx + b hy) / (1 + g hx + h hy).
struct block_axis {
  int32_t base;   // whole texels of level 0
  int32_t offset; // added to every position, 2^-16 unit; a unit is 2^unit_log2 texels
  int32_t c;      // 2^-16
  int32_t b;      // 2^-(16 + n); 0 if n = 0
  int32_t slope;  // a - c g: w^2 du/dhx in the middle row; 2^-(16 + k)
  int32_t twist;  // a h - b g: what it gains per hy; 2^-(16 + k)
};

struct block {
  block_axis u, v;
  int32_t g, h;   // 2^-(16 + k), 2^-(18 + n); h = 0 if n = 0
  int32_t level;  // level of detail at the centre, s.16; filters with levels
  int8_t k, n;    // 2^k pixels wide, 2^n high; k = 0: one pixel
  int8_t unit_log2;
  bool straight;  // W is the same all along a row
};

constexpr bool has_straight_rows(const plane& p) { return p.w.x == 0; }

// Positions pixel after pixel, 2^-16 unit, relative to a whole texel: u(i) = u + i du + i (i - 1)/2 ddu.
struct walk {
  int32_t u, v, du, dv, ddu, ddv;
  SPANTEX_WRAPS constexpr void step() { u += du; v += dv; du += ddu; dv += ddv; }
};

// Not by a call of memcpy, as Cortex-M0+ would.
constexpr void copy(const walk& from, walk& to) {
  to.u = from.u;
  to.v = from.v;
  to.du = from.du;
  to.dv = from.dv;
  to.ddu = from.ddu;
  to.ddv = from.ddv;
}

SPANTEX_WRAPS constexpr walk advanced(const walk& w, int i) {
  const int32_t pairs = i * (i - 1) / 2;
  return {w.u + i * w.du + pairs * w.ddu, w.v + i * w.dv + pairs * w.ddv, w.du + i * w.ddu, w.dv + i * w.ddv, w.ddu, w.ddv};
}

// Half pixels from the centre to the outermost pixel centres.
constexpr int32_t reach_of(int k) { return (1 << k) - 1; }

// What becomes of a block: it is drawn, it is not in front of the viewer, or one of its halves is next.
enum class outcome : uint8_t { drawn, behind, upper_and_lower, left_and_right };

// A coordinate about a block's centre: base + (c + a hx + b hy) / (W + G hx + H hy); a base out of range is +-32767.
struct centre_axis {
  int64_t c, a, b;
  int32_t base;
  bool in_range;
};
// W there, and about 2^(62 - exponent) / W.
struct centre {
  int64_t w;
  int32_t inverse;
  int exponent;
  centre_axis u, v;
};

namespace detail {

// How far a number goes from a block's centre, by its rows and by its columns.
struct change { uint64_t across, down; };
SPANTEX_FRAME_APART constexpr change change_of(int64_t a, int64_t b, int k, int n) { return {multiply_by_31(magnitude(a), reach_of(k)), multiply_by_31(magnitude(b), reach_of(n))}; }

// Halves of a block that cannot be drawn: of the side that the greater change is along. A single column has no halves left and right; one of several
// pixels has no rows.
constexpr outcome halves_of(int k, int n, const change& x) { return n > 0 && (k <= 1 || x.down >= x.across) ? outcome::upper_and_lower : outcome::left_and_right; }

// Whether the block is in front of the viewer, and |e| <= 1/8; w: at its centre.
constexpr outcome by_depth(const plane& p, int64_t w, int k, int n) {
  const change slope = change_of(p.w.x, p.w.y, k, n);
  const int64_t sum = int64_t(slope.across + slope.down);
  if (w + sum <= 0) return outcome::behind;
  return sum > w >> 3 ? halves_of(k, n, slope) : outcome::drawn;
}

// Upper word of a product; y >= 0. In 16-bit pieces where a product of 64 bits would be a call.
#if defined(__thumb__) && !defined(__thumb2__)
[[gnu::noinline]]
#endif
constexpr int32_t upper_word(int32_t x, int32_t y) {
#if defined(__thumb__) && !defined(__thumb2__)
  const int32_t x1 = x >> 16, y1 = y >> 16;
  const uint32_t x0 = uint32_t(x) & 0xFFFF, y0 = uint32_t(y) & 0xFFFF;
  const int32_t middle = x1 * int32_t(y0) + int32_t(x0 * y0 >> 16);
  return x1 * y1 + (middle >> 16) + int32_t((x0 * uint32_t(y1) + (uint32_t(middle) & 0xFFFF)) >> 16);
#else
  return int32_t(int64_t(x) * y >> 32);
#endif
}

// floor((2^62 - 1) / m), m >= 2^31: bit by bit, or from the engine's reciprocal, which is never above it.
SPANTEX_WRAPS constexpr int32_t inverse_by_bits(uint32_t m) {
  uint32_t rest = 0x7FFFFFFF, q = 0;
  for (int n = 0; n < 31; ++n) {
    const bool carry = rest >> 31 != 0;
    rest = (rest & 0x7FFFFFFF) << 1 | 1;
    q <<= 1;
    if (carry || rest >= m) {
      rest -= m;
      ++q;
    }
  }
  return int32_t(q);
}
constexpr int32_t inverse_of(uint32_t m) {
  if (optimised_for_size) return inverse_by_bits(m);
  uint32_t q = reciprocal_wide(m) >> 1;
  for (uint64_t rest = (uint64_t(1) << 62) - 1 - multiply_32(q, m); rest >= m; rest -= m) ++q;
  return int32_t(q);
}

// n / W in the upper word of a product of numbers cut to 31 bits (floor), |n| < 2^(31 + drop); then to nearest.
constexpr int32_t quotient_of(int64_t n, int drop, int32_t inverse, int shift) {
  const int32_t x = drop >= 0 ? int32_t(n >> drop) : int32_t(n) * (1 << -drop);
  return shift_right(upper_word(x, inverse), shift);
}

// Of numbers c that are at most `largest`, with `scale` fraction bits, and of what changes them by at most that along 2^k - 1 or 2^n - 1 half pixels.
struct quotients {
  int32_t inverse;
  int drop, shift;

  constexpr quotients(const centre& r, uint64_t largest, int scale) : inverse(r.inverse), drop(bit_length(largest) - 31), shift(30 + r.exponent - drop - scale) {}
  constexpr int32_t at(int64_t c) const { return quotient_of(c, drop, inverse, shift); }
  constexpr int32_t slope(int64_t a, int k) const { return quotient_of(a, drop - k + 1, inverse, shift - 1); }  // k bits more
};

// W set.
constexpr void set_axis(const plane& p, const linear_form& f, int32_t hx, int32_t hy, const centre& r, centre_axis& out) {
  const int64_t n = p.value(f, hx, hy);
  const uint64_t size = magnitude(n);
  int32_t base = size >> 17 < uint64_t(r.w) ? quotients(r, size | uint64_t(r.w), 0).at(n) : INT32_MAX;
  out.in_range = base >= -32768 && base <= 32768;
  if (!out.in_range) base = n < 0 ? -32767 : 32767;
  out.base = base;
  out.c = n - multiply_by_32(r.w, base);
  out.a = f.x - multiply_by_32(p.w.x, base);
  out.b = f.y - multiply_by_32(p.w.y, base);
}
// W set.
SPANTEX_FRAME_APART constexpr void set_centre(const plane& p, int32_t hx, int32_t hy, centre& r) {
  r.exponent = bit_length(uint64_t(r.w)) - 32;
  r.inverse = inverse_of(r.exponent >= 0 ? uint32_t(uint64_t(r.w) >> r.exponent) : uint32_t(r.w) << -r.exponent);
  set_axis(p, p.u, hx, hy, r, r.u);
  set_axis(p, p.v, hx, hy, r, r.v);
}

// The largest number that quotients are taken of; 0 where they would have too many bits: u and v reach less than 96 units, or 256 where rows are straight.
constexpr uint64_t farthest_of(const centre_axis& x, int k, int n) {
  const change along = change_of(x.a, x.b, k, n);
  return magnitude(x.c) + along.across + along.down;
}
[[gnu::noinline]] constexpr uint64_t largest_of(const centre& r, const block& o) {
  if (!r.u.in_range || !r.v.in_range) return 0;
  const uint64_t u = farthest_of(r.u, o.k, o.n), v = farthest_of(r.v, o.k, o.n), larger = u > v ? u : v;
  const uint64_t w = uint64_t(r.w);
  if (larger >> (5 + o.unit_log2) >= (o.straight ? 8 * w : 3 * w)) return 0;
  return larger | w >> 3 | 1;
}
SPANTEX_FRAME_APART constexpr outcome halves_in_reach(const centre& r, int k, int n) {
  return halves_of(k, n, change_of(int64_t(magnitude(r.u.a) + magnitude(r.v.a)), int64_t(magnitude(r.u.b) + magnitude(r.v.b)), k, n));
}

// k, unit and level set.
constexpr void set_axis(const centre_axis& x, const quotients& by_w, const block& o, block_axis& out) {
  const int32_t a = by_w.slope(x.a, o.k), b = o.n == 0 ? 0 : by_w.slope(x.b, o.n), c = by_w.at(x.c);
  const int cut = 9 + o.straight;
  out = {x.base, 0, c, b, a - ((c >> 6) * o.g >> 10), ((a >> cut) * (o.h >> 2) - (b >> cut) * o.g) >> (16 - cut + o.n)};
}
// |G| <= W/8, and |H| if n > 0.
SPANTEX_FRAME_APART constexpr void set_axes(const plane& p, const centre& r, uint64_t largest, block& o) {
  const quotients by_w(r, largest, 16 - o.unit_log2);
  const auto slope_of_w = [&](int64_t n, int scale) { return quotient_of(n, r.exponent + 32 - 3 - 31, r.inverse, 32 - scale); };
  o.g = slope_of_w(p.w.x, 16 + o.k);
  o.h = o.n == 0 ? 0 : slope_of_w(p.w.y, 18 + o.n);
  set_axis(r.u, by_w, o, o.u);
  set_axis(r.v, by_w, o, o.v);
}

// The term of third degree, at most a X (g X)^2 units, X the reach, is replaced by its best line: a quarter of it is left.
[[gnu::noinline]] constexpr bool bends_little(const block& o) {
  const int32_t reach = reach_of(o.k);
  const auto size = [](int32_t x) { return x < 0 ? -x : x; };
  const int32_t e = size(o.g) * reach >> (o.k + 1);                                    // 2^-15
  const int32_t square = e * e >> 15;
  const auto steepest = [&](const block_axis& x) { return size(x.slope) + reach_of(o.n) * size(x.twist); };  // of all rows
  const int32_t steeper = steepest(o.u) > steepest(o.v) ? steepest(o.u) : steepest(o.v);
  const int32_t extent = (steeper >> 9) * reach >> (o.k - 1);                          // 2^-8
  return extent * square <= 1 << (23 + 2 - row_tolerance_bits);
}

// Level of detail: KT88's formula about the pixel interval, log2 K - 2 log2 W - 1, with an extra bias in 1/16 level.
constexpr int32_t level_at_centre(const plane& p, int64_t w, int bias) { return p.major_log2 - 2 * log2_16(uint64_t(w)) - (1 << 16) + bias * (1 << 12); }

// A unit is a texel of the finer level at the centre; of level 0 for filters without levels.
constexpr int unit_of(int32_t level, int last_level) { return clamp_to(level >> 16, 0, last_level); }

}  // namespace detail

// What a block's level of detail needs; ignored without Levels.
struct level_terms { int last_level, bias; };

// Coordinates of the block of 2^k x 2^n pixels at (x, y), with `r` as memory to work in; `out` is undefined if it is not drawn.
template <bool Levels>
constexpr outcome block_at(const plane& p, int32_t x, int32_t y, int k, int n, level_terms levels, centre& r, block& out) {
  const int32_t hx = 2 * x + (1 << k), hy = 2 * y + (1 << n);
  r.w = p.w_at(hx, hy);
  if (const outcome seen = detail::by_depth(p, r.w, k, n); seen != outcome::drawn) return seen;
  detail::set_centre(p, hx, hy, r);
  block& o = out;
  o.k = int8_t(k);
  o.n = int8_t(n);
  o.unit_log2 = 0;
  o.straight = has_straight_rows(p);
  o.level = 0;
  if constexpr (Levels) {
    o.level = detail::level_at_centre(p, r.w, levels.bias);
    o.unit_log2 = int8_t(k == 0 ? 0 : detail::unit_of(o.level, levels.last_level));
  }
  if (k == 0) {
    const detail::quotients by_w(r, uint64_t(r.w), 16);
    o.g = o.h = 0;
    o.u = {r.u.base, 0, r.u.in_range ? by_w.at(r.u.c) : 0, 0, 0, 0};
    o.v = {r.v.base, 0, r.v.in_range ? by_w.at(r.v.c) : 0, 0, 0, 0};
    return outcome::drawn;
  }
  const uint64_t largest = detail::largest_of(r, o);
  if (largest == 0) return detail::halves_in_reach(r, k, n);
  detail::set_axes(p, r, largest, o);
  return detail::bends_little(o) ? outcome::drawn : detail::halves_of(k, n, {1, 0});
}

template <bool Levels>
[[gnu::noinline]] constexpr outcome block_at_apart(const plane& p, int32_t x, int32_t y, int k, int n, level_terms levels, centre& r, block& out) {
  return block_at<Levels>(p, x, y, k, n, levels, r, out);
}

namespace detail {

// Formulas of rows below: Int is a row's number, or a vector of several.
// 1/(1 + e) = 1 - q, four terms; e and q 2^-18, |e| <= 1/8: off by less than 2^-14.8.
template <class Int>
constexpr Int series_of(Int e) {
  Int q = e;
  for (int n = 0; n < 3; ++n) q = e - (e * q >> 18);
  return q;
}

// 1 - 1/w, 2^-18; 1 - 1/w^2, 2^-17; g / w; 3/4 (g X / w)^2, 2^-15.
template <class Int>
struct row_terms { Int q, q2, g, third; };

// One coordinate of a row: position and derivative by hx at its middle, then where it starts and how it goes on.
template <class Int>
struct row_axis { Int start, step, bend; };
template <class Int>
#ifndef __OPTIMIZE_SIZE__
[[gnu::always_inline]]
#endif
constexpr row_axis<Int> axis_at(const block_axis& x, Int hy, const row_terms<Int>& t, int k, int rows_log2, bool straight) {
  const int32_t reach = reach_of(k);
  const int cut = straight;
  const Int n = x.c + (x.b * hy >> rows_log2), s = x.slope + x.twist * hy;
  const Int slope = s - ((s >> (9 + cut)) * t.q2 >> (8 - cut));
  const Int position = n - ((n >> (8 + cut)) * t.q >> (10 - cut)) + x.offset;
  if (straight) {
    const Int step = (2 * slope + (1 << (k - 1))) >> k;  // to nearest
    return {position - (reach * step >> 1), step, Int{}};
  }
  const Int bend = ((int32_t(8) << 2 * k) - (slope >> 9) * t.g) >> (4 + 2 * k);  // to nearest
  const Int half = (slope + ((slope >> 9) * t.third >> 6)) >> k;
  return {position - reach * half + (reach * reach * bend >> 3), 2 * half - (reach >> 1) * bend, bend};
}

// Rows j of a block with k > 0 that is straight, or not.
template <bool Straight, class Int, class Walk>
[[gnu::always_inline]] constexpr void rows_at(const block& b, Int j, Walk& out) {
  const int32_t reach = reach_of(b.k);
  const Int hy = 2 * j - reach_of(b.n), q = series_of<Int>(b.h * hy >> b.n);
  row_terms<Int> t{};
  t.q = q;
  t.q2 = q - (q * q >> 19);
  if constexpr (!Straight) {
    t.g = b.g - (b.g * q >> 18);
    const Int e = t.g * reach >> (b.k + 1);  // 2^-15
    t.third = 3 * (e * e >> 15) >> 2;
  }
#ifdef __OPTIMIZE_SIZE__
  const bool straight = b.straight;
#else
  constexpr bool straight = Straight;
#endif
  const row_axis<Int> u = axis_at(b.u, hy, t, b.k, b.n, straight), v = axis_at(b.v, hy, t, b.k, b.n, straight);
  out = {u.start, v.start, u.step, v.step, u.bend, v.bend};
}
template <class Int, class Walk>
[[gnu::always_inline]] constexpr void rows_at(const block& b, Int j, Walk& out) {
#ifndef __OPTIMIZE_SIZE__
  if (b.straight) return rows_at<true>(b, j, out);
#endif
  rows_at<false>(b, j, out);
}

}  // namespace detail

// Row j of a block.
constexpr void row_at(const block& b, int32_t j, walk& out) {
  if (b.k == 0) out = {b.u.c + b.u.offset, b.v.c + b.v.offset, 0, 0, 0, 0};
  else detail::rows_at(b, j, out);
}

// Level of detail along a row, s.16.
struct level_run { int32_t start, step; };

// Of a block's rows: linear in the block. 2/ln 2 = 23637/8192.
struct level_rows {
  int32_t start, step, down;
  constexpr level_run row(int j) const { return {start + j * down, step}; }
};
constexpr level_rows level_rows_of(const block& b) {
  const auto per_half_pixel = [](int32_t slope, int side_log2) { return -(slope * 23637 >> (13 + side_log2)); };
  const int32_t x = per_half_pixel(b.g, b.k), y = per_half_pixel(b.h >> 2, b.n);
  return {b.level - x * reach_of(b.k) - y * reach_of(b.n), 2 * x, 2 * y};
}

}  // namespace spantex::rows
