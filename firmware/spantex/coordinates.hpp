// SPDX-License-Identifier: Apache-2.0
// Texture coordinates in span-relative form (METHODS "Numerical notes"; docs/SPEC.md "Coordinates").
//
// Set-up side: reference_at() rebases a plane on whole texels at a reference point. The rebased numerators
//   c = Nu - base W,  a = A - base G,  b = B - base H
// are exact integers, so nothing cancels later; one reciprocal of W then serves every quotient of the span.
// Datapath side: position_at() evaluates one pixel: n and 1 + e are linear, 1/(1 + e) is 1, a series in 16-bit products, or a divide.
#pragma once
#include <stdint.h>

#include <spantex/accuracy.hpp>
#include <spantex/bits.hpp>
#include <spantex/fixed.hpp>
#include <spantex/plane.hpp>
#include <spantex/profile.hpp>
#include <spantex/reciprocal.hpp>
#include <spantex/span.hpp>

namespace spantex {

using coordinate = s<15, 16>;  // texels of level 0

struct texel_position { coordinate u, v; };

// --- set-up side ---------------------------------------------------------------------------------------

// A plane about a point with W > 0; exact but for the choice of base.
struct reference {
  inverse inverse_w;
  int64_t w;
  int32_t base_u, base_v;          // nearest whole texel, give or take 2^-14
  int64_t c_u, a_u, b_u, c_v, a_v, b_v;
  int64_t g, h;                    // slopes of w
  bool u_in_range, v_in_range;     // |u|, |v| < 2^15 there
  int w_exponent;                  // W of the plane = w 2^w_exponent
  int slope_drop;                  // a, b, g, h are 2^-slope_drop of what they should be: too steep for a span
};

// log2 W in the plane's scale, s.16.
constexpr int32_t log2_of_w(const reference& r) { return log2_16(uint64_t(r.w)) + r.w_exponent * (1 << 16); }

namespace detail {

// Nearest whole number to n/w, up to +-32768; beyond, +-32767 and in_range false.
constexpr int32_t whole_quotient(int64_t n, int64_t w, inverse iw, bool& in_range) {
  constexpr int32_t limit = 32768;
  const int bits = bit_length(magnitude(n));
  if (bits <= bit_length(uint64_t(w)) + 15) {
    const int32_t q = quotient(n, max_of(0, bits - 31), iw, 0);
    if (q >= -limit && q <= limit) return q;
  }
  in_range = false;
  return n < 0 ? 1 - limit : limit - 1;
}

}  // namespace detail

enum class slopes : bool { left_out, wanted };  // of a reference: a pixel about its own centre has no use for them, and they stay as they are

// In `r`, for who has memory for it.
SPANTEX_FRAME_APART constexpr void set_reference(const plane& p, int32_t hx, int32_t hy, reference& r, slopes of = slopes::wanted) {
  r.w = p.w_at(hx, hy);
  r.inverse_w = invert(r.w);
  r.u_in_range = r.v_in_range = true;
  const int64_t nu = p.u_at(hx, hy), nv = p.v_at(hx, hy);
  r.base_u = detail::whole_quotient(nu, r.w, r.inverse_w, r.u_in_range);
  r.base_v = detail::whole_quotient(nv, r.w, r.inverse_w, r.v_in_range);
  r.c_u = nu - r.base_u * r.w;
  r.c_v = nv - r.base_v * r.w;
  r.w_exponent = r.slope_drop = 0;
  if (of == slopes::left_out) return;
  r.a_u = p.u.x - r.base_u * p.w.x;
  r.b_u = p.u.y - r.base_u * p.w.y;
  r.a_v = p.v.x - r.base_v * p.w.x;
  r.b_v = p.v.y - r.base_v * p.w.y;
  r.g = p.w.x;
  r.h = p.w.y;
}
constexpr reference reference_at(const plane& p, int32_t hx, int32_t hy) {
  reference r{};
  set_reference(p, hx, hy, r);
  return r;
}

inline constexpr int set_up_tolerance_bits = 12;  // what set-up's rounding may move a coordinate by: 2^-12 texel

// Whether it moves no coordinate with |u|, |v| < 2^reach_bits by more, evaluated about a point where W is `w`: by at most
// d (1 + |u|) / W, W >= w/2 on a span, d half units for each of a form's coefficients (ACCURACY 1).
constexpr bool rounding_is_small(const plane& p, int64_t w, int reach_bits) {
  return p.rounding_bits == 0 || p.rounding_bits + reach_bits + set_up_tolerance_bits < bit_length(uint64_t(w));
}

// Bits of 1 + |u| or |v| up to `extent` texels from the bases of a point; beyond the range its end counts.
constexpr int reach_bits(const reference& r, int32_t extent) {
  const int32_t u = r.base_u < 0 ? -r.base_u : r.base_u, v = r.base_v < 0 ? -r.base_v : r.base_v;
  return bit_length(uint64_t((u > v ? u : v) + extent + 2));
}

namespace detail {

inline constexpr int exact_w_bits = 45, exact_slope_bits = 57;

// One coordinate from the exact forms about a point, cut like W.
struct exact_axis { int32_t base; bool in_range; wide c, a, b; };
constexpr exact_axis exact_axis_at(const plane& p, const wide_form& f, int32_t hx, int32_t hy, wide w, const reference& r, int cut, slopes of) {
  exact_axis x{0, true, {}, {}, {}};
  const wide n = p.value(f, hx, hy);
  if (bit_length(n) - cut > 62) return {n.negative() ? -32767 : 32767, false, {}, {}, {}};
  x.base = whole_quotient(to_int64(scale_down(n, cut)), r.w, r.inverse_w, x.in_range);
  if (!x.in_range) return x;
  x.c = n - multiply(w, x.base);
  if (of == slopes::left_out) return x;
  x.a = f.x - multiply(p.exact_w.x, x.base);
  x.b = f.y - multiply(p.exact_w.y, x.base);
  return x;
}

}  // namespace detail

// The same from the forms before they were rounded: exact, then rounded to 45 bits of W. False if W is not positive by them, with nothing written. An
// axis out of range keeps only its sign.
constexpr bool exact_reference_at(const plane& p, int32_t hx, int32_t hy, reference& r, slopes of = slopes::wanted) {
  const wide w = p.value(p.exact_w, hx, hy);
  if (w.negative() || w.zero()) return false;
  const int cut = max_of(0, bit_length(w) - detail::exact_w_bits);
  r.w = to_int64(scale_down(w, cut));
  r.inverse_w = invert(r.w);
  r.w_exponent = cut - p.dropped_bits;
  r.slope_drop = 0;
  const detail::exact_axis u = detail::exact_axis_at(p, p.exact_u, hx, hy, w, r, cut, of), v = detail::exact_axis_at(p, p.exact_v, hx, hy, w, r, cut, of);
  r.base_u = u.base;
  r.u_in_range = u.in_range;
  r.base_v = v.base;
  r.v_in_range = v.in_range;
  const auto offset = [&](wide x) { return to_int64(scale_down(x, cut)); };
  r.c_u = offset(u.c);
  r.c_v = offset(v.c);
  if (of == slopes::left_out) return true;
  const wide all[] = {u.a, u.b, v.a, v.b, p.exact_w.x, p.exact_w.y};
  int steepest = 0;
  for (const wide& s : all) steepest = max_of(steepest, bit_length(s));
  r.slope_drop = max_of(0, steepest - cut - detail::exact_slope_bits);
  const auto slope = [&](wide x) { return to_int64(scale_down(x, cut + r.slope_drop)); };
  r.a_u = slope(u.a);
  r.b_u = slope(u.b);
  r.a_v = slope(v.a);
  r.b_v = slope(v.b);
  r.g = slope(p.exact_w.x);
  r.h = slope(p.exact_w.y);
  return true;
}

// Half pixels from the centre to the outermost pixel centres.
inline constexpr int reach = span_side - 1;
constexpr int span_reach(const unit_variants& v) { return (1 << v.span_log2) - 1; }

inline constexpr int series_bits = 14;        // e and q of the series: 16-bit numbers in 2^(slope_log2 - 14)
inline constexpr int least_slope_log2 = -15;  // flatter spans count as this
inline constexpr int most_series_slope_log2 = -2, most_series_terms = 4;

// An evaluation asked for, where the datapath has it.
constexpr void force_evaluation(evaluation_order order, bool may_be_series, span_coefficients& c) {
  c.how = evaluation::divide;
  c.terms = 1;
  if (order == evaluation_order::affine || (c.g | c.h) == 0) c.how = evaluation::affine;
  else if (order != evaluation_order::divide && may_be_series) {
    c.how = evaluation::series;
    c.terms = uint8_t(int(order) - int(evaluation_order::series1) + 1);
  }
}

// The cheapest evaluation within the tolerance (ACCURACY 6), from the rounded slopes: |e| < 2^slope_log2 for every pixel.
constexpr void choose_evaluation(const profile& q, int farthest, int extent_log2, bool may_be_series, span_coefficients& c, const unit_variants& v = {}) {
  const uint64_t slope = uint64_t(farthest) * (magnitude(c.g) + magnitude(c.h));
  const int slope_log2 = max_of(bit_length(slope) - q.reciprocal_bits, least_slope_log2);  // -1 or less
  const int steep = slope_log2 > most_series_slope_log2 ? 1 : 0;
  c.slope_log2 = int8_t(slope_log2);
  if (v.order != evaluation_order::by_tolerance) return force_evaluation(v.order, may_be_series && steep == 0, c);
  c.terms = 1;
  c.how = evaluation::divide;
  if (slope == 0 || extent_log2 + slope_log2 + 1 + steep <= -q.tolerance_bits) {
    c.how = evaluation::affine;
    return;
  }
  const int resolution_log2 = q.offset_bits - 1 - c.exponent;  // extent_log2, or what the largest exponent leaves of it
  if (!may_be_series || steep || resolution_log2 + slope_log2 > series_bits - 3 - q.tolerance_bits) return;
  for (int terms = 1; terms <= most_series_terms; ++terms)
    if (extent_log2 + slope_log2 * (terms + 1) + 1 <= -q.tolerance_bits - 1) {
      c.how = evaluation::series;
      c.terms = uint8_t(terms);
      return;
    }
}

// Fills the coordinate part of the coefficients about a reference point, for positions up to `farthest` half pixels from it. False if w
// leaves (1/2, 3/2) there, u or v is out of range, or they reach more than 2^max_extent_log2 texels.
constexpr bool coordinates_within(int farthest, const reference& r, const profile& q, bool may_be_series, span_coefficients& c, const unit_variants& v = {}) {
  if (!r.u_in_range || !r.v_in_range || r.slope_drop > 0) return false;
  const uint64_t slope = uint64_t(farthest) * (magnitude(r.g) + magnitude(r.h));
  if (slope >= uint64_t(r.w) / 2 - uint64_t(r.w) / 256) return false;  // the margin keeps the rounded w in (1/2, 3/2) as well
  const uint64_t extent_u = magnitude(r.c_u) + uint64_t(farthest) * (magnitude(r.a_u) + magnitude(r.b_u));
  const uint64_t extent_v = magnitude(r.c_v) + uint64_t(farthest) * (magnitude(r.a_v) + magnitude(r.b_v));
  const uint64_t extent = extent_u > extent_v ? extent_u : extent_v;
  // extent / W < 2^extent_log2
  const int extent_log2 = bit_length(extent) - bit_length(uint64_t(r.w)) + 1;
  if (extent_log2 > max_extent_log2) return false;
  const int exponent = mantissa_exponent(q, extent_log2);
  const int drop = max_of(0, bit_length(extent) - 31);
  c.base_u = r.base_u;
  c.base_v = r.base_v;
  c.c_u = quotient(r.c_u, drop, r.inverse_w, exponent);
  c.a_u = quotient(r.a_u, drop, r.inverse_w, exponent);
  c.b_u = quotient(r.b_u, drop, r.inverse_w, exponent);
  c.c_v = quotient(r.c_v, drop, r.inverse_w, exponent);
  c.a_v = quotient(r.a_v, drop, r.inverse_w, exponent);
  c.b_v = quotient(r.b_v, drop, r.inverse_w, exponent);
  const int slope_drop = max_of(0, bit_length(slope) - 31);
  c.g = quotient(r.g, slope_drop, r.inverse_w, q.reciprocal_bits);
  c.h = quotient(r.h, slope_drop, r.inverse_w, q.reciprocal_bits);
  c.exponent = int8_t(exponent);
  choose_evaluation(q, farthest, extent_log2, may_be_series, c, v);
  return true;
}

// Of a span about its centre. False if it must be evaluated pixel by pixel.
constexpr bool span_coordinates(const reference& r, const profile& q, span_coefficients& c, const unit_variants& v = {}) {
  return coordinates_within(span_reach(v), r, q, true, c, v);
}

// Fills the coordinate part for a single pixel about its own centre: the same position wherever it is evaluated.
constexpr void pixel_coordinates(const reference& r, const profile& q, span_coefficients& c) {
  c.base_u = r.base_u;
  c.base_v = r.base_v;
  c.a_u = c.b_u = c.a_v = c.b_v = c.g = c.h = 0;
  c.c_u = c.c_v = 0;  // what is out of range stays at +-32767
  c.exponent = int8_t(min_of(q.offset_bits - 2, max_exponent));
  c.slope_log2 = least_slope_log2;
  c.terms = 1;
  c.how = evaluation::affine;
  const auto offset = [&](int64_t n) { return quotient(n, max_of(0, bit_length(magnitude(n)) - 31), r.inverse_w, c.exponent); };
  if (r.u_in_range) c.c_u = offset(r.c_u);
  if (r.v_in_range) c.c_v = offset(r.c_v);
}

// --- datapath side -------------------------------------------------------------------------------------

// Half pixels from the span's centre to pixel column or row i.
constexpr int32_t half_pixels(int i) { return 2 * i - reach; }
// From the reference point, which only the simulator has elsewhere (unit_variants::span_log2).
template <class Prof> constexpr int32_t half_pixels_x(const span_coefficients& c, int i) { return half_pixels(i) + (Prof::has_variants ? c.from_x : 0); }
template <class Prof> constexpr int32_t half_pixels_y(const span_coefficients& c, int j) { return half_pixels(j) + (Prof::has_variants ? c.from_y : 0); }
template <class Prof> using half_pixel_offset = s<Prof::has_variants ? 4 : 3, 0>;
template <class Prof> constexpr half_pixel_offset<Prof> offset_x(const span_coefficients& c, int i) { return half_pixel_offset<Prof>::from_raw(half_pixels_x<Prof>(c, i)); }
template <class Prof> constexpr half_pixel_offset<Prof> offset_y(const span_coefficients& c, int j) { return half_pixel_offset<Prof>::from_raw(half_pixels_y<Prof>(c, j)); }

// Formats of the datapath, by the profile's widest numbers: mantissas (scaled by a run-time exponent), slopes below 1/14, and 1/w.
template <class Prof> using offset_mantissa = s<Prof::max_offset_bits, 0>;
template <class Prof> using slope_of_w = s<Prof::has_variants ? -2 : -3, Prof::max_reciprocal_bits>;  // below 1/6 on spans of 4 pixels
template <class Prof> using relative_w = u<1, Prof::max_reciprocal_bits>;

// c + a hx + b hy. The planner bounds |c| + n (|a| + |b|) below 2^(offset_bits - 1), n the largest offset, so the sum fits (proofs:
// pixel_numerator, corner_numerator).
template <class Prof, int I>
constexpr offset_mantissa<Prof> numerator_at(int32_t c, int32_t a, int32_t b, s<I, 0> hx, s<I, 0> hy) {
  using mantissa = offset_mantissa<Prof>;
  return trust_to<mantissa>(mantissa::from_raw(c) + mantissa::from_raw(a) * hx + mantissa::from_raw(b) * hy);
}
template <class Prof>
constexpr offset_mantissa<Prof> numerator_at(const span_coefficients& at, int32_t c, int32_t a, int32_t b, int i, int j) {
  return numerator_at<Prof>(c, a, b, offset_x<Prof>(at, i), offset_y<Prof>(at, j));
}

// e = g hx + h hy as reciprocal_bits fraction bits: |e| < 1/2 by the planner's condition and relative_w_bound() < 1/256.
template <class Prof> using relative_slope = s<-1, Prof::max_reciprocal_bits>;
template <class Prof, class Slope, int I>
constexpr relative_slope<Prof> slope_at(const span_coefficients& c, s<I, 0> hx, s<I, 0> hy) {
  return trust_to<relative_slope<Prof>>(Slope::from_raw(c.g) * hx + Slope::from_raw(c.h) * hy);  // proofs: relative_w, corner_w
}
template <class Prof>
constexpr relative_slope<Prof> slope_at(const span_coefficients& c, int i, int j) {
  return slope_at<Prof, slope_of_w<Prof>>(c, offset_x<Prof>(c, i), offset_y<Prof>(c, j));
}

// w = 1 + e, in (1/2, 3/2).
template <class Prof>
constexpr uint32_t w_of(const Prof& prof, relative_slope<Prof> e) {
  const auto one = relative_w<Prof>::from_raw(uint32_t(1) << prof.get().reciprocal_bits);
  return trust_to<relative_w<Prof>>(one + e).raw();  // proofs: relative_w, corner_w
}
template <class Prof>
constexpr uint32_t w_at(const Prof& prof, const span_coefficients& c, int i, int j) {
  return w_of(prof, slope_at<Prof>(c, i, j));
}

// 1/w for w in (1/2, 3/2), same format.
constexpr uint32_t reciprocal_of_w(uint32_t w, int bits, const unit_variants& v = {}) {
  const int below_one = (w >> bits) == 0 ? 1 : 0;
  if (bits <= 15) {
    const uint32_t y = reciprocal_narrow(w << (15 - bits + below_one), v);
    return shift_right(y, 16 - bits - below_one);
  }
  const uint64_t y = reciprocal_wide(w << (31 - bits + below_one), v);
  return uint32_t(shift_right(y, 32 - bits - below_one));
}

// 1/w as a number: by the divide wherever the span is not affine.
template <class Prof>
constexpr uint32_t reciprocal_of(const Prof& prof, const span_coefficients& c, relative_slope<Prof> e) {
  const int bits = prof.get().reciprocal_bits;
  return c.how == evaluation::affine ? uint32_t(1) << bits : reciprocal_of_w(w_of(prof, e), bits, prof.variants());
}
template <class Prof>
constexpr uint32_t reciprocal_at(const Prof& prof, const span_coefficients& c, int i, int j) {
  return reciprocal_of(prof, c, slope_at<Prof>(c, i, j));
}

// --- the series: 1/(1 + e) = 1 - q, q = e - e^2 + e^3 - e^4. Products of 16 bits (proof: series).

using series_number = s<15, 0>;  // 2^(slope_log2 - 14)

// e as a series_number, floor; at most 2^14. Flat spans of few reciprocal_bits have no fraction to drop.
template <class Prof>
constexpr series_number series_slope(const Prof& prof, const span_coefficients& c, relative_slope<Prof> e) {
  const int drop = prof.get().reciprocal_bits + c.slope_log2 - series_bits;
  return trust_to<series_number>(s<31, 0>::from_raw(scale_down(e.raw(), drop, rounding::floor)));
}

constexpr series_number series_of(series_number e, int slope_log2, int terms) {
  series_number q = e;
  for (int k = 1; k < terms; ++k) {
    const auto product = e * q;
    q = trust_to<series_number>(e - series_number::from_raw(product.raw() >> (series_bits - slope_log2)));
  }
  return q;
}

// n (1 - q), floor: n cut to its upper 16 bits for the product.
template <class Prof>
constexpr offset_mantissa<Prof> numerator_by_series(const Prof& prof, offset_mantissa<Prof> n, series_number q, int slope_log2) {
  const int drop = max_of(0, prof.get().offset_bits - series_bits - 1);
  const auto product = trust_to<series_number>(s<31, 0>::from_raw(n.raw() >> drop)) * q;
  return trust_to<offset_mantissa<Prof>>(n - offset_mantissa<Prof>::from_raw(product.raw() >> (series_bits - slope_log2 - drop)));
}

// n / w before it is rounded. Spans of small reach have large exponents: where the shift to coordinate_bits may exceed 30, 64 bits hold the
// product even if 32 would (proof: position_shifts).
template <class Prof> using position_product = decltype(offset_mantissa<Prof>{} * relative_w<Prof>{});
template <class Prof>
constexpr bool position_is_wide() {
  if constexpr (position_product<Prof>::bits > 32) return true;
  else return longest_position_shift(Prof::value) > 30;
}
template <class Prof> using position_rep = typename detail::rep<true, position_is_wide<Prof>()>::type;

// base + n / w, rounded once to coordinate_bits. Only a divide has a reciprocal; n of a series is divided already.
template <class Prof>
constexpr s<31, 16> unlimited_coordinate_at(const Prof& prof, const span_coefficients& c, int32_t base, offset_mantissa<Prof> n, uint32_t reciprocal) {
  const profile& q = prof.get();
  using rep = position_rep<Prof>;
  const int drop = c.exponent - q.coordinate_bits;
  rep offset;
  if (c.how != evaluation::divide) {
    offset = scale_down(rep(n.raw()), drop);
  } else {
    const position_product<Prof> p = n * relative_w<Prof>::from_raw(reciprocal);
    offset = scale_down(rep(p.raw()), drop + q.reciprocal_bits);  // up only in narrow profiles, whose products are short
  }
  const int up = 16 - q.coordinate_bits;
  return s<31, 16>::from_raw((int64_t(base) << 16) + (int64_t(offset) << up));
}

// The same, saturated to s15.16.
template <class Prof>
constexpr coordinate coordinate_at(const Prof& prof, const span_coefficients& c, int32_t base, offset_mantissa<Prof> n, uint32_t reciprocal) {
  return sat_to<coordinate>(unlimited_coordinate_at(prof, c, base, n, reciprocal));
}

template <class Prof>
constexpr texel_position position_at(const Prof& prof, const span_coefficients& c, int i, int j) {
  auto u = numerator_at<Prof>(c, c.c_u, c.a_u, c.b_u, i, j), v = numerator_at<Prof>(c, c.c_v, c.a_v, c.b_v, i, j);
  uint32_t reciprocal = 0;
  switch (c.how) {
    case evaluation::affine: break;
    case evaluation::series: {
      const series_number q = series_of(series_slope(prof, c, slope_at<Prof>(c, i, j)), c.slope_log2, c.terms);
      u = numerator_by_series(prof, u, q, c.slope_log2);
      v = numerator_by_series(prof, v, q, c.slope_log2);
      break;
    }
    case evaluation::divide: reciprocal = reciprocal_at(prof, c, i, j); break;
  }
  return {coordinate_at(prof, c, c.base_u, u, reciprocal), coordinate_at(prof, c, c.base_v, v, reciprocal)};
}

// How far rounding can move a position from the hull of its span's corners, raw s15.16.
template <class Prof>
constexpr int32_t position_slack(const Prof& prof, const span_coefficients& c) {
  const profile& q = prof.get();
  const int extent_log2 = q.offset_bits - 1 - c.exponent;
  uint64_t bound = evaluation_bound(q, extent_log2, c.how, prof.variants());
  if (prof.variants().order != evaluation_order::by_tolerance) bound += forced_evaluation_bound(extent_log2, c.slope_log2, c.terms, c.how);
  return int32_t(2 * bound >> (error_unit_log2 - 16)) + 2;  // the corners' own rounding and the pixel's
}

}  // namespace spantex
