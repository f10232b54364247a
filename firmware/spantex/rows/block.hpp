// SPDX-License-Identifier: Apache-2.0
// Rows: texture coordinates for a core that samples the map where it lies (docs/SPEC.md "Rows"; errors: docs/ACCURACY.md "Rows").
//
// The screen is cut into squares of 32 pixels, and those into halves, across or down, until coordinates are true enough: blocks of 2^k x 2^n
// pixels. Block: one division, numerators rebased on a whole texel as in coordinates.hpp, cut to 16 bits. Row: 1/w at the middle of the row by a series in 16-bit products; what is left of the perspective along
// the row is a polynomial of second degree with integer coefficients,
//   u(i) = start + i step + i (i - 1)/2 bend        2^-16 texel, exactly,
// so a pixel takes two additions a coordinate and the order of evaluation cannot matter. A block is as large as that is true to
// 2^-row_tolerance_bits texel. Products are of 16-bit numbers, sums of 32: the same on Cortex-M0+ as with DSP instructions.
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>
#include <spantex/coordinates.hpp>
#include <spantex/plane.hpp>

namespace spantex::rows {

inline constexpr int largest_block_log2 = 5;
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
  int32_t g, h;   // 2^-(16 + k), 2^-(16 + n); h = 0 if n = 0
  int32_t level;  // level of detail at the centre, s.16; filters with levels
  int8_t k, n;    // 2^k pixels wide, 2^n high; k = 0: one pixel
  int8_t unit_log2;
};

// Positions pixel after pixel, 2^-16 unit, relative to a whole texel: u(i) = u + i du + i (i - 1)/2 ddu.
struct walk {
  int32_t u, v, du, dv, ddu, ddv;
  SPANTEX_WRAPS constexpr void step() { u += du; v += dv; du += ddu; dv += ddv; }
};

SPANTEX_WRAPS constexpr walk advanced(const walk& w, int i) {
  const int32_t pairs = i * (i - 1) / 2;
  return {w.u + i * w.du + pairs * w.ddu, w.v + i * w.dv + pairs * w.ddv, w.du + i * w.ddu, w.dv + i * w.ddv, w.ddu, w.ddv};
}

// Half pixels from the centre to the outermost pixel centres.
constexpr int32_t reach_of(int k) { return (1 << k) - 1; }

// What becomes of a block: it is drawn, it is not in front of the viewer, or one of its halves is next.
enum class outcome : uint8_t { drawn, behind, upper_and_lower, left_and_right };

namespace detail {

// How far a number goes from a block's centre, by its rows and by its columns.
struct change { uint64_t across, down; };
SPANTEX_FRAME_APART constexpr change change_of(int64_t a, int64_t b, int k, int n) { return {magnitude(a) * uint32_t(reach_of(k)), magnitude(b) * uint32_t(reach_of(n))}; }

// Halves of a block that cannot be drawn: of the side that the greater change is along. A single column has no halves left and right; one of several
// pixels has no rows.
constexpr outcome halves_of(int k, int n, const change& x) { return n > 0 && (k <= 1 || x.down >= x.across) ? outcome::upper_and_lower : outcome::left_and_right; }

// Whether the block is in front of the viewer, and |e| <= 1/8.
constexpr outcome by_depth(const plane& p, int32_t hx, int32_t hy, int k, int n) {
  const change slope = change_of(p.w.x, p.w.y, k, n);
  const int64_t w = p.w_at(hx, hy), sum = int64_t(slope.across + slope.down);
  if (w + sum <= 0) return outcome::behind;
  return sum > w >> 3 ? halves_of(k, n, slope) : outcome::drawn;
}

// The largest number that quotients are taken of; 0 where they would have more than 16 bits: u and v reach less than 96 units.
[[gnu::noinline]] constexpr uint64_t largest_of(const reference& r, int k, int n, int unit_log2) {
  if (!r.u_in_range || !r.v_in_range) return 0;
  const change along_u = change_of(r.a_u, r.b_u, k, n), along_v = change_of(r.a_v, r.b_v, k, n);
  const uint64_t u = magnitude(r.c_u) + along_u.across + along_u.down, v = magnitude(r.c_v) + along_v.across + along_v.down, larger = u > v ? u : v;
  if (larger >= uint64_t(r.w) * (uint64_t(96) << unit_log2)) return 0;
  return larger | uint64_t(r.w) >> 3 | 1;
}
SPANTEX_FRAME_APART constexpr outcome halves_in_reach(const reference& r, int k, int n) {
  return halves_of(k, n, change_of(int64_t(magnitude(r.a_u) + magnitude(r.a_v)), int64_t(magnitude(r.b_u) + magnitude(r.b_v)), k, n));
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

// Quotients by W of numbers below 2^bits: numbers and 1/W cut to 31 bits (floor), the upper word of the product, to nearest.
class quotients {
 public:
  constexpr quotients(const inverse& w, int bits) : inverse_(int32_t(w.y >> 1)), drop_(bits - 31), shift_(30 + w.exponent - drop_) {}
  constexpr int32_t at(int64_t n, int scale) const {
    const int32_t x = drop_ >= 0 ? int32_t(n >> drop_) : int32_t(n) * (1 << -drop_);
    return shift_right(upper_word(x, inverse_), shift_ - scale);
  }

 private:
  int32_t inverse_;
  int drop_, shift_;
};

constexpr void set_axis(int64_t c, int64_t a, int64_t b, int32_t base, const quotients& by_w, const block& o, block_axis& out) {
  const int bits = 16 - o.unit_log2;
  const int32_t qa = by_w.at(a, bits + o.k), qb = o.n == 0 ? 0 : by_w.at(b, bits + o.n), qc = by_w.at(c, bits);
  out = {base, 0, qc, qb, qa - ((qc >> 6) * o.g >> 10), ((qa >> 9) * o.h - (qb >> 9) * o.g) >> (7 + o.n)};
}

// Both axes, k, unit and level set. |G| <= W/8, and |H| if n > 0.
SPANTEX_FRAME_APART constexpr void set_axes(const reference& r, uint64_t largest, block& o) {
  const quotients by_w(r.inverse_w, bit_length(largest)), slopes(r.inverse_w, r.inverse_w.exponent + 32 - 3);
  o.g = slopes.at(r.g, 16 + o.k);
  o.h = o.n == 0 ? 0 : slopes.at(r.h, 16 + o.n);
  set_axis(r.c_u, r.a_u, r.b_u, r.base_u, by_w, o, o.u);
  set_axis(r.c_v, r.a_v, r.b_v, r.base_v, by_w, o, o.v);
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
constexpr outcome block_at(const plane& p, int32_t x, int32_t y, int k, int n, level_terms levels, reference& r, block& out) {
  const int32_t hx = 2 * x + (1 << k), hy = 2 * y + (1 << n);
  if (const outcome seen = detail::by_depth(p, hx, hy, k, n); seen != outcome::drawn) return seen;
  set_reference(p, hx, hy, r);
  block& o = out;
  o.k = int8_t(k);
  o.n = int8_t(n);
  o.unit_log2 = 0;
  o.level = 0;
  if constexpr (Levels) {
    o.level = detail::level_at_centre(p, r.w, levels.bias);
    o.unit_log2 = int8_t(k == 0 ? 0 : detail::unit_of(o.level, levels.last_level));
  }
  if (k == 0) {  // a coordinate out of range is +-32767
    const detail::quotients by_w(r.inverse_w, bit_length(magnitude(r.c_u) | magnitude(r.c_v) | uint64_t(r.w)));
    o.g = o.h = 0;
    o.u = {r.base_u, 0, r.u_in_range ? by_w.at(r.c_u, 16) : 0, 0, 0, 0};
    o.v = {r.base_v, 0, r.v_in_range ? by_w.at(r.c_v, 16) : 0, 0, 0, 0};
    return outcome::drawn;
  }
  const uint64_t largest = detail::largest_of(r, k, n, o.unit_log2);
  if (largest == 0) return detail::halves_in_reach(r, k, n);
  detail::set_axes(r, largest, o);
  return detail::bends_little(o) ? outcome::drawn : detail::halves_of(k, n, {1, 0});
}

template <bool Levels>
[[gnu::noinline]] constexpr outcome block_at_apart(const plane& p, int32_t x, int32_t y, int k, int n, level_terms levels, reference& r, block& out) {
  return block_at<Levels>(p, x, y, k, n, levels, r, out);
}

namespace detail {

// Formulas of rows below: Int is a row's number, or a vector of several.
// 1/(1 + e) = 1 - q, four terms; e and q 2^-17, |e| <= 1/8: off by less than 2^-14.8.
template <class Int>
constexpr Int series_of(Int e) {
  Int q = e;
  for (int n = 0; n < 3; ++n) q = e - (e * q >> 17);
  return q;
}

// 1 - 1/w, 2^-17; 1 - 1/w^2, 2^-16; g / w; 3/4 (g X / w)^2, 2^-15.
template <class Int>
struct row_terms { Int q, q2, g, third; };

// One coordinate of a row: position and derivative by hx at its middle, then where it starts and how it goes on.
template <class Int>
struct row_axis { Int start, step, bend; };
template <bool Bent, class Int>
#ifndef __OPTIMIZE_SIZE__
[[gnu::always_inline]]
#endif
constexpr row_axis<Int> axis_at(const block_axis& x, Int hy, const row_terms<Int>& t, int k, int rows_log2) {
  const int32_t reach = reach_of(k);
  const Int n = x.c + (x.b * hy >> rows_log2), s = x.slope + x.twist * hy;
  const Int slope = s - ((s >> 9) * t.q2 >> 7);
  const Int position = n - ((n >> 8) * t.q >> 9) + x.offset;
  Int half = slope >> k;
  if constexpr (!Bent) return {position - reach * half, 2 * half, Int{}};
  const Int bend = ((int32_t(8) << 2 * k) - (slope >> 9) * t.g) >> (4 + 2 * k);  // to nearest
  half = (slope + ((slope >> 9) * t.third >> 6)) >> k;
  return {position - reach * half + (reach * reach * bend >> 3), 2 * half - (reach >> 1) * bend, bend};
}

// Rows j of a block with k > 0.
template <class Int, class Walk>
[[gnu::always_inline]] constexpr void rows_at(const block& b, Int j, Walk& out) {
  const int k = b.k;
  const int32_t reach = reach_of(k);
  const Int hy = 2 * j - reach_of(b.n), q = series_of<Int>(2 * b.h * hy >> b.n);
  row_terms<Int> t;
  t.q = q;
  t.q2 = q - (q * q >> 18);
  const auto both = [&](const row_axis<Int>& u, const row_axis<Int>& v) { out = {u.start, v.start, u.step, v.step, u.bend, v.bend}; };
#ifndef __OPTIMIZE_SIZE__  // what comes of the rest, sooner
  if (b.g == 0) return both(axis_at<false>(b.u, hy, t, k, b.n), axis_at<false>(b.v, hy, t, k, b.n));
#endif
  t.g = b.g - (b.g * q >> 17);
  const Int e = t.g * reach >> (k + 1);  // 2^-15
  t.third = 3 * (e * e >> 15) >> 2;
  both(axis_at<true>(b.u, hy, t, k, b.n), axis_at<true>(b.v, hy, t, k, b.n));
}

}  // namespace detail

// Row j of a block.
constexpr void row_at(const block& b, int32_t j, walk& out) {
  if (b.k == 0) out = {b.u.c + b.u.offset, b.v.c + b.v.offset, 0, 0, 0, 0};
  else detail::rows_at(b, j, out);
}

// Level of detail along row j, s.16: linear in the block. 2/ln 2 = 23637/8192.
struct level_run { int32_t start, step; };
constexpr level_run level_row_at(const block& b, int j) {
  const auto per_half_pixel = [](int32_t slope, int side_log2) { return -(slope * 23637 >> (13 + side_log2)); };
  const int32_t x = per_half_pixel(b.g, b.k), hy = 2 * j - reach_of(b.n);
  return {b.level + per_half_pixel(b.h, b.n) * hy - x * reach_of(b.k), 2 * x};
}

}  // namespace spantex::rows
