// SPDX-License-Identifier: Apache-2.0
// Rows: texture coordinates for a core that samples the map where it lies (docs/SPEC.md "Rows"; errors: docs/ACCURACY.md "Rows").
//
// The screen is cut into squares of 32 pixels, or 256 x 32 where W is the same along a row, and those into halves, across or down, until coordinates
// are true enough: blocks of 2^k x 2^n pixels. Block: one division, numerators rebased on a whole texel as in coordinates.hpp, cut to 16 bits. Row: a
// polynomial of second degree with integer coefficients,
//   u(i) = start + i step + i (i - 1)/2 bend        2^-16 texel, exactly,
// so a pixel takes two additions a coordinate and the order of evaluation cannot matter. Start, step and bend are polynomials of the row's number, of third,
// second and first degree, by forward differences: exact sums of 32 bits again. A block is as large as that is true to about 2^-row_tolerance_bits texel in either
// of two ways (by_bends()). Products fit 32 bits: the same on Cortex-M0+ as with DSP instructions.
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>
#include <spantex/plane.hpp>
#include <spantex/reciprocal.hpp>

namespace spantex::rows {

inline constexpr int largest_block_log2 = 5, widest_block_log2 = 8;
inline constexpr int row_tolerance_bits = 6;

// The rows of a block, one coordinate: row 0 and forward differences, x(j) = x[0] + j x[1] + j (j - 1)/2 x[2] + j (j - 1)(j - 2)/6 x[3], modulo 2^32.
struct row_differences {
  uint32_t start[4];  // 2^-(16 + row_bits), half a unit of 2^-16 added; k = 0: the position, 2^-16
  uint32_t step[3];   // in the middle of the row: step + (2^(k-1) - 1) bend; 2^-(16 + row_bits + k - 1), likewise
  uint32_t bend[2];   // likewise
};
inline constexpr int row_bits = 5;

struct block_axis {
  int32_t base;    // whole texels of level 0
  int32_t offset;  // added to every position, 2^-16 unit; a unit is 2^unit_log2 texels
  row_differences rows;
};

struct block {
  block_axis u, v;
  int32_t g, h;   // 2^-(18 + k), 2^-(18 + n); h = 0 if n = 0
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

constexpr bool is_straight(const walk& w) { return (w.ddu | w.ddv) == 0; }

// Not by a call of memcpy, as Cortex-M0+ would.
constexpr void copy(const walk& from, walk& to) {
  to.u = from.u;
  to.v = from.v;
  to.du = from.du;
  to.dv = from.dv;
  to.ddu = from.ddu;
  to.ddv = from.ddv;
}

SPANTEX_WRAPS constexpr walk moved(const walk& w, int32_t u, int32_t v) { return {w.u + u, w.v + v, w.du, w.dv, w.ddu, w.ddv}; }

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
template <class Number>
constexpr outcome halves_of(int k, int n, Number across, Number down) { return n > 0 && (k <= 1 || down >= across) ? outcome::upper_and_lower : outcome::left_and_right; }
constexpr outcome halves_of(int k, int n, const change& x) { return halves_of(k, n, x.across, x.down); }

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

// floor((2^62 - 1) / m), m >= 2^31, one way or the other: bit by bit, or from the engine's reciprocals, which are never above it.
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
// From a reciprocal of 16 bits, for cores without products of 64: each quotient of what is left is below it.
SPANTEX_WRAPS constexpr int32_t inverse_by_halves(uint32_t m) {
  const uint32_t y = reciprocal_narrow(m >> 16) - 2;                        // 2^47/m, at most 6 below it
  const auto times_m = [&](uint32_t x) { return uint64_t(x * (m >> 16)) << 16; };
  uint64_t rest = (uint64_t(1) << 62) - 1 - ((times_m(y) + y * (m & 0xFFFF)) << 15);  // below 2^50
  const uint32_t second = uint32_t(rest >> 34) * y >> 13;                   // at most 2^18, and 45 below the quotient
  rest -= multiply_32(second, m);
  const uint32_t third = uint32_t(rest >> 24) * y >> 23;
  rest -= times_m(third) + third * (m & 0xFFFF);
  uint32_t q = (y << 15) + second + third;
  for (; rest >= m; rest -= m) ++q;
  return int32_t(q);
}
constexpr int32_t inverse_of(uint32_t m) {
  if (optimised_for_size) return inverse_by_bits(m);
#if defined(__ARM_ARCH_6M__)
  return inverse_by_halves(m);
#endif
  uint32_t q = reciprocal_wide(m) >> 1;
  for (uint64_t rest = (uint64_t(1) << 62) - 1 - multiply_32(q, m); rest >= m; rest -= m) ++q;
  return int32_t(q);
}

// n / W in the upper word of a product of numbers cut to 31 bits (floor), |n| < 2^(31 + drop); then to nearest.
constexpr int32_t quotient_of(int64_t n, int drop, int32_t inverse, int shift) {
  const int32_t x = drop >= 0 ? int32_t(n >> drop) : int32_t(uint32_t(n) << (-drop & 31));  // n = 0 where drop < -31
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

// Value and derivatives at the centre, where row 0 and its differences will be; k, g, h set.
constexpr void set_axis(const centre_axis& x, const quotients& by_w, const block& o, block_axis& out) {
  const int32_t c = by_w.at(x.c), b = o.n == 0 ? 0 : by_w.slope(x.b, o.n);
  out.base = x.base;
  out.rows.start[0] = uint32_t(c);
  out.rows.start[1] = uint32_t(b - ((c >> 1) * o.h >> 17));  // |c| is a bit more than 2^15 at most, |h| 2^16
  out.rows.step[0] = uint32_t(by_w.slope(x.a, o.k) - ((c >> 1) * o.g >> 17));
}
// Of a single pixel.
constexpr void set_point(const centre_axis& x, const quotients& by_w, block_axis& out) {
  out.base = x.base;
  out.rows.start[0] = uint32_t(x.in_range ? by_w.at(x.c) : 0);
}
// |G| <= W/8, and |H| if n > 0.
SPANTEX_FRAME_APART constexpr void set_axes(const plane& p, const centre& r, uint64_t largest, block& o) {
  const quotients by_w(r, largest, 16 - o.unit_log2);
  const auto slope_of_w = [&](int64_t n, int scale) { return quotient_of(n, r.exponent + 32 - 3 - 31, r.inverse, 32 - scale); };
  o.g = slope_of_w(p.w.x, 18 + o.k);
  o.h = o.n == 0 ? 0 : slope_of_w(p.w.y, 18 + o.n);
  set_axis(r.u, by_w, o, o.u);
  set_axis(r.v, by_w, o, o.v);
}

// x (2^k - 1) / 2^k: a slope's reach.
constexpr int32_t reached(int32_t slope, int k) { return slope - (slope >> k); }
constexpr int32_t size_of(int32_t x) { return x < 0 ? -x : x; }

// 1 - e + e^2 with slopes so much steeper that e^3 is replaced by its best line, e 3/4 r^2; products of slopes. 2^-18.
struct bend_terms {
  int32_t g, h, gg, gh, hh;  // gh twice
  int32_t third;             // of S g^2 hx^3: the line's share
};

// About the centre u = c + L / (1 + e), L = S hx + T hy, e = g hx + h hy, |e| <= r. 1/(1 + e) is replaced by a polynomial of second degree, which is off by 0.328 r^3
// at most, and the term S g^2 hx^3 of the product by its best line: a quarter of it is left. What becomes of a block where either is too large; else the polynomial.
SPANTEX_FRAME_APART constexpr outcome by_bends(const block& o, bend_terms& out) {
  const int k = o.k, n = o.n;
  const int32_t x = reached(size_of(o.g), k), y = reached(size_of(o.h), n), r = x + y, rr = r * r >> 18;  // 2^-18, r at most 2^15
  const auto larger = [](uint32_t a, uint32_t b) { return max_of(size_of(int32_t(a)), size_of(int32_t(b))); };
  const int32_t s = reached(larger(o.u.rows.step[0], o.v.rows.step[0]), k) >> 8, t = reached(larger(o.u.rows.start[1], o.v.rows.start[1]), n) >> 8;  // 2^-8
  constexpr int32_t most = 1 << (26 + 2 - row_tolerance_bits);
  if (s * (x * x >> 18) > most) return halves_of(k, n, 1, 0);
  if ((s + t) * (rr * r >> 18) > most / 2) return halves_of(k, n, x, y);
  const int32_t more = 3 * rr >> 2, g = o.g + (o.g * more >> 18), h = o.h + (o.h * more >> 18), across = reached(g, k) >> 1;
  out = {g, h, (g >> 1) * (g >> 1) >> 16, (g >> 1) * (h >> 1) >> 15, (h >> 1) * (h >> 1) >> 16, 3 * (across * across >> 16) >> 2};
  return outcome::drawn;
}

// Row 0 and `count` - 1 differences of q0 + q1 y - q2 y^2 + q3 y^3, y = hy / 2^n.
struct polynomial { int32_t q0, q1, q2, q3; };
SPANTEX_FRAME_APART constexpr void set_differences(const polynomial& q, int n, int count, uint32_t* out) {
  const auto down = [&](int32_t x) { return reached(x, n); };
  const int z = max_of(n - 1, 0);
  const int32_t to_middle = (1 << z) - 1, first = q.q1 >> z, second = -(2 * q.q2 >> 2 * z), third = 6 * q.q3 >> 3 * z;  // about the middle
  out[0] = uint32_t(q.q0 - down(q.q1 + down(q.q2 + down(q.q3))));
  out[1] = uint32_t(first - second * to_middle + (third * to_middle * to_middle >> 1) + (q.q3 >> (3 * z + 2)));
  if (count == 2) return;
  out[2] = uint32_t(second - third * to_middle + (third >> 1));
  if (count == 4) out[3] = uint32_t(third);
}

// From the value c and derivatives S, T at the centre:
//   u = c + T y - yy y^2 + yyy y^3 + (S - xy y + xyy y^2) x - (xx - xxy y) x^2,   x = hx / 2^k
SPANTEX_FRAME_APART constexpr void set_rows(const block& o, const bend_terms& e, row_differences& out) {
  const int k = o.k;
  const auto across = [&](int32_t x) { return reached(x, k); };
  const int32_t slope = int32_t(out.step[0]), c = int32_t(out.start[0]) * (1 << row_bits), down_slope = int32_t(out.start[1]);
  const int32_t s = (slope + 512) >> 10, t = (down_slope + 512) >> 10;  // 2^-6; products of 2^-24, then 2^-21
  const int32_t xx = s * e.g >> 3, xy = (s * e.h + t * e.g) >> 3, yy = t * e.h >> 3;
  const int32_t xxy = (s * e.gh + t * e.gg) >> 3, xyy = (s * e.hh + t * e.gh) >> 3, yyy = t * e.hh >> 3;
  const int32_t S = slope * (1 << row_bits) + (s * e.third >> 3), T = down_slope * (1 << row_bits);
  const int32_t half = 1 << (row_bits + k - 2);
  // At x = -(2^k - 1)/2^k; in the middle 2 (S - xy y + xyy y^2) / 2^k; 8 (-xx + xxy y) / 4^k.
  set_differences({c - across(S + across(xx)) + (1 << (row_bits - 1)), T + across(xy + across(xxy)), yy + across(xyy), yyy}, o.n, 4, out.start);
  set_differences({S + half, -xy, -xyy, 0}, o.n, 3, out.step);
  set_differences({-(2 * xx >> (k - 1)) + half, 2 * xxy >> (k - 1), 0, 0}, o.n, 2, out.bend);
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
  o.u.offset = o.v.offset = 0;
  if constexpr (Levels) {
    o.level = detail::level_at_centre(p, r.w, levels.bias);
    o.unit_log2 = int8_t(k == 0 ? 0 : detail::unit_of(o.level, levels.last_level));
  }
  if (k == 0) {
    const detail::quotients by_w(r, uint64_t(r.w), 16);
    o.g = o.h = 0;
    detail::set_point(r.u, by_w, o.u);
    detail::set_point(r.v, by_w, o.v);
    return outcome::drawn;
  }
  const uint64_t largest = detail::largest_of(r, o);
  if (largest == 0) return detail::halves_in_reach(r, k, n);
  detail::set_axes(p, r, largest, o);
  detail::bend_terms e;
  const outcome next = detail::by_bends(o, e);
  if (next == outcome::drawn) {
    detail::set_rows(o, e, o.u.rows);
    detail::set_rows(o, e, o.v.rows);
  }
  return next;
}

template <bool Levels>
[[gnu::noinline]] constexpr outcome block_at_apart(const plane& p, int32_t x, int32_t y, int k, int n, level_terms levels, centre& r, block& out) {
  return block_at<Levels>(p, x, y, k, n, levels, r, out);
}

namespace detail {

// Formulas of rows below: Word is a row's number, or a vector of several, Int the same with a sign.

// j, j (j - 1)/2, j (j - 1)(j - 2)/6.
template <class Word>
struct row_numbers { Word one, two, three; };
template <class Word>
SPANTEX_WRAPS constexpr row_numbers<Word> numbers_of(Word j) {
  const Word pairs = j * (j - 1) >> 1;
  return {j, pairs, pairs * (j - 2) * 21846 >> 16};  // a third
}
template <class Word>
SPANTEX_WRAPS constexpr Word value_of(const uint32_t (&x)[4], const row_numbers<Word>& j) { return x[0] + x[1] * j.one + x[2] * j.two + x[3] * j.three; }

// One coordinate of rows with k > 0. Bend is rounded, then step: the middle of the row keeps its slope.
template <class Int>
struct row_axis { Int start, step, bend; };
template <class Int, class Word>
SPANTEX_WRAPS constexpr row_axis<Int> axis_at(const block_axis& x, const row_numbers<Word>& j, int k) {
  const row_differences& r = x.rows;
  const int down = row_bits + k - 1;
  const Word step = r.step[0] + r.step[1] * j.one + r.step[2] * j.two;
  const Int bend = Int(r.bend[0] + r.bend[1] * j.one) >> down;
  return {(Int(value_of(r.start, j)) >> row_bits) + x.offset, (Int(step) >> down) - ((1 << (k - 1)) - 1) * bend, bend};
}

}  // namespace detail

// Row j of a block.
SPANTEX_WRAPS constexpr void row_at(const block& b, int32_t j, walk& out) {
  if (b.k == 0) {
    out = {int32_t(b.u.rows.start[0]) + b.u.offset, int32_t(b.v.rows.start[0]) + b.v.offset, 0, 0, 0, 0};
    return;
  }
  const detail::row_numbers<uint32_t> numbers = detail::numbers_of(uint32_t(j));
  const detail::row_axis<int32_t> u = detail::axis_at<int32_t>(b.u, numbers, b.k), v = detail::axis_at<int32_t>(b.v, numbers, b.k);
  out = {u.start, v.start, u.step, v.step, u.bend, v.bend};
}

// Level of detail along a row, s.16.
struct level_run { int32_t start, step; };

// Of a block's rows: linear in the block. 2/ln 2 = 23637/8192.
struct level_rows {
  int32_t start, step, down;
  constexpr level_run row(int j) const { return {start + j * down, step}; }
};
constexpr level_rows level_rows_of(const block& b) {
  const auto per_half_pixel = [](int32_t slope, int side_log2) { return -(slope * 23637 >> (15 + side_log2)); };
  const int32_t x = per_half_pixel(b.g, b.k), y = per_half_pixel(b.h, b.n);
  return {b.level - x * reach_of(b.k) - y * reach_of(b.n), 2 * x, 2 * y};
}

}  // namespace spantex::rows
