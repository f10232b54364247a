// SPDX-License-Identifier: Apache-2.0
// Error bounds as functions of a profile, derived in docs/ACCURACY.md. The planner, the tests, the stress run and the sweeps use
// these same functions. Compile time or set-up only; unit 2^-40 texel of level 0 unless a name says otherwise.
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>
#include <spantex/profile.hpp>
#include <spantex/span.hpp>

namespace spantex {

inline constexpr int error_unit_log2 = 40;
inline constexpr uint64_t error_unit = uint64_t(1) << error_unit_log2;

inline constexpr int max_extent_log2 = 12;  // span mode: texels of level 0 that a span may reach from its base
inline constexpr int max_exponent = 36;     // of the span's mantissas: keeps every shift below 63

// Exponent of a span's mantissas: offset_bits of them, one kept free for the roundings of the terms.
constexpr int mantissa_exponent(const profile& p, int extent_log2) {
  return min_of(p.offset_bits - 1 - extent_log2, max_exponent);
}

// How far a position's offset may be shifted down to coordinate_bits: affine at the largest exponent; otherwise the extent is at least
// 2^-tolerance_bits, or the evaluation would be affine.
constexpr int longest_position_shift(const profile& p) {
  return max_of(max_exponent, mantissa_exponent(p, -p.tolerance_bits) + p.reciprocal_bits) - p.coordinate_bits;
}

namespace detail {

// 2^(error_unit_log2 + e), or 1 where that is below the unit: always rounded up.
constexpr uint64_t bound_power(int e) { return e + error_unit_log2 >= 0 ? uint64_t(1) << (e + error_unit_log2) : 1; }

// x 2^e, rounded up.
constexpr uint64_t bound_scaled(uint64_t x, int e) { return e >= 0 ? x << e : (x >> -e) + 1; }

}  // namespace detail

// Numerator n of a pixel, against its exact value: the reciprocal of W0 (2^-29 relative), fifteen cut terms, fifteen rounded mantissas.
constexpr uint64_t numerator_bound(const profile& p, int extent_log2) {
  const int exponent = mantissa_exponent(p, extent_log2);
  return detail::bound_power(extent_log2 - 29) + 15 * detail::bound_power(extent_log2 - 31) + 8 * detail::bound_power(-exponent);
}

// Relative w of a pixel: the same for 14 terms of which the sum is below 1/2.
constexpr uint64_t relative_w_bound(const profile& p) {
  return detail::bound_power(-30) + 14 * detail::bound_power(-31) + 7 * detail::bound_power(-p.reciprocal_bits);
}

// The reciprocal unit, relative: table and iterations, then rounding to reciprocal_bits of a number that is at least 2/3.
constexpr uint64_t reciprocal_unit_bound(const profile& p, const unit_variants& v = {}) {
  const bool narrow = p.reciprocal_bits <= 15;
  const uint64_t unit = detail::bound_power(narrow ? -13 : -29);  // 4 units of a number that is at least 1/2
  // A seed errs by 2^-(bits + 1) and its 16 bits; each step squares that. What is left of it is within the 4 units at full length.
  const int correct_bits = (v.reciprocal_table_log2 + 1) << min_of(v.reciprocal_iterations, narrow ? 1 : 2);
  const uint64_t left = correct_bits >= (narrow ? 16 : 32) ? 0 : detail::bound_power(1 - correct_bits);
  return unit + left + detail::bound_power(-p.reciprocal_bits);
}

// |position_at - n/w| for the ideal n/w of the same rounded coefficients: what widens the box of a section. What affine and series leave out,
// and the 16 bits of a series, are at most 3/4 of the tolerance; the series' last floor is a unit of the mantissas.
constexpr uint64_t evaluation_bound(const profile& p, int extent_log2, evaluation how, const unit_variants& v = {}) {
  const uint64_t final_rounding = detail::bound_power(-p.coordinate_bits - 1);
  switch (how) {
    case evaluation::affine: return final_rounding + 3 * detail::bound_power(-p.tolerance_bits - 2);
    case evaluation::series:
      return final_rounding + 3 * detail::bound_power(-p.tolerance_bits - 2) + detail::bound_power(-mantissa_exponent(p, extent_log2));
    case evaluation::divide: break;
  }
  return final_rounding + detail::bound_scaled(reciprocal_unit_bound(p, v), extent_log2 + 1);
}

// What an evaluation that was not chosen by the tolerance leaves out, and what the 16 bits of a series cut off (ACCURACY 6, without its conditions).
constexpr uint64_t forced_evaluation_bound(int extent_log2, int slope_log2, int terms, evaluation how) {
  switch (how) {
    case evaluation::affine: return detail::bound_power(extent_log2 + slope_log2 + 1);
    case evaluation::series: return detail::bound_power(extent_log2 + slope_log2 * (terms + 1) + 1) + detail::bound_power(extent_log2 + slope_log2 - 12);
    case evaluation::divide: break;
  }
  return 0;
}

// Set-up: |rounded form - exact| in half units of the form, dx, dy half pixels from its origin: three coefficients, each to nearest.
constexpr int64_t set_up_half_units(int32_t dx, int32_t dy) { return int64_t(magnitude(dx)) + int64_t(magnitude(dy)) + 1; }

// What is left of it in a coordinate where the profile looks after it (coordinates.hpp, rounding_is_small), else it is not counted: bounds are
// then against the plane's rounded forms.
constexpr uint64_t set_up_bound(const profile& p) { return p.exact_set_up ? detail::bound_power(-12) : 0; }

// Numerator of a pixel evaluated about its own centre: one quotient below 1 texel with a cut of its own.
constexpr uint64_t pixel_numerator_bound(const profile& p) {
  return detail::bound_power(-29) + detail::bound_power(-31) + detail::bound_power(-min_of(p.offset_bits - 2, max_exponent) - 1);
}

// End to end, |computed - exact| of a texture coordinate within s15.16, against the caller's integers if exact_set_up, for spans that reach up to 2^extent_log2 texels, by how 1/w is
// evaluated: w > 1/2 at a divide and where an affine span's reach is below the tolerance, else w > 3/4. Pixels about their own centre have no slopes.
constexpr uint64_t affine_bound(const profile& p, int extent_log2) {
  return set_up_bound(p) + evaluation_bound(p, extent_log2, evaluation::affine) + 2 * numerator_bound(p, extent_log2) +
         2 * detail::bound_scaled(relative_w_bound(p), extent_log2);
}
constexpr uint64_t series_bound(const profile& p, int extent_log2) {
  return set_up_bound(p) + evaluation_bound(p, extent_log2, evaluation::series) + 2 * numerator_bound(p, extent_log2) +
         2 * detail::bound_scaled(relative_w_bound(p), extent_log2);
}
constexpr uint64_t divide_bound(const profile& p, int extent_log2) {
  return set_up_bound(p) + evaluation_bound(p, extent_log2, evaluation::divide) + 2 * numerator_bound(p, extent_log2) +
         detail::bound_scaled(relative_w_bound(p), extent_log2 + 2);
}
constexpr uint64_t pixel_bound(const profile& p) {
  return set_up_bound(p) + detail::bound_power(-p.coordinate_bits - 1) + pixel_numerator_bound(p);
}

// In addition, for positions between the largest s15.16 and 2^15: they come out as that largest one at best.
constexpr uint64_t saturation_bound() { return detail::bound_power(-16); }

constexpr uint64_t coordinate_bound(const profile& p, int extent_log2 = max_extent_log2) {
  const uint64_t series = series_bound(p, extent_log2), divide = divide_bound(p, extent_log2);  // affine is below series
  return series > divide ? series : divide;
}

// |snapped - exact| of a blending filter's position on a level, in texels of that level, beside the coordinate's own error: the ratio of
// sizes that do not halve exactly (31 bits), and half a step of the weights (a whole one if positions are cut).
constexpr uint64_t snapping_bound(const profile& p, int level) {
  return detail::bound_power(-17 - level) + detail::bound_power(-p.subtexel_bits - (p.position_rounding == rounding::floor ? 0 : 1));
}

// With the coordinate's error, for spans of any reach.
constexpr uint64_t snapped_bound(const profile& p, int level) {
  return detail::bound_scaled(coordinate_bound(p), -level) + snapping_bound(p, level);
}

// log2_16(), in 2^-40: less than 1 above the true value, at most 3.91 units of 2^-16 below it (exhaustive: tests/unit/log2.cpp).
constexpr uint64_t log2_bound() { return 4 * detail::bound_power(-16); }

// 2 log2 w of a pixel: twice log2_16(), or the series of flat spans, at most 16.73 units of 2^-16 (exhaustive: tests/unit/series.cpp).
constexpr uint64_t twice_log2_w_bound() { return 17 * detail::bound_power(-16); }

namespace detail {

// What every level of detail has in common: terms rounded to 10 bits, the final rounding, and w.
constexpr uint64_t level_rounding_bound(const profile& p) {
  constexpr int term_bits = 10;
  return bound_power(-term_bits - 1) + bound_power(-p.level_bits - 1) + 6 * relative_w_bound(p);
}

}  // namespace detail

// |computed - formula| of the level of detail where it lies in [0, last], in 2^-40 level. Jacobian: log2 w twice, half a log2, the
// span's mantissas, and its slopes in the gradient.
constexpr uint64_t level_bound(const profile& p) {
  return detail::level_rounding_bound(p) + twice_log2_w_bound() + log2_bound() / 2 + detail::bound_power(14 - p.offset_bits) +
         144 * detail::bound_power(-p.reciprocal_bits);
}

// Major axis, against the plane's log2 K: log2 W0 twice and log2 w twice.
constexpr uint64_t major_level_bound(const profile& p) { return detail::level_rounding_bound(p) + twice_log2_w_bound() + 2 * log2_bound(); }

// |colour - exact filtering at the snapped position and level| in 2^-40 LSB: write-out and, of two levels, the rounding of each to blend_bits.
constexpr uint64_t colour_bound(const profile& p, bool two_levels) {  // two_levels: the filter's kind
  const int half = p.colour_rounding == rounding::floor ? 0 : 1;
  const bool rounds = two_levels && 2 * p.subtexel_bits > p.blend_bits;
  return detail::bound_power(-half) + (rounds ? detail::bound_power(-p.blend_bits - half) : 0);
}

// --- filters with a footprint (docs/ACCURACY.md 14 to 17) ---------------------------------------------------

// Corner of a footprint of step or hat, against the exact position: a coordinate up to nine half pixels from the centre, four more terms.
constexpr uint64_t corner_bound(const profile& p, int extent_log2) {
  const uint64_t terms = 4 * detail::bound_power(extent_log2 - 31) + 2 * detail::bound_power(-mantissa_exponent(p, extent_log2));
  const uint64_t w = 4 * detail::bound_power(-31) + 2 * detail::bound_power(-p.reciprocal_bits);
  return coordinate_bound(p, extent_log2) + 2 * terms + detail::bound_scaled(w, extent_log2 + 2);
}

// A texel's area, in units of half a square step of the window (a full texel is 2 4^bits of them): less than one, and 9/16 where the clamp
// moved it. Hat: half the sum of eight, rounded. In 2^-40 units.
constexpr uint64_t area_bound(bool hat) { return hat ? 27 * error_unit / 4 : 25 * error_unit / 16; }

namespace detail {

// One term of W^2 J over W0^2 per half pixel (ACCURACY 8): mantissas, slopes, products, and the reciprocal of W0 common to all.
constexpr uint64_t gradient_bound(const profile& p, int extent_log2) {
  return 2 * bound_power(extent_log2 - 31) + 9 * bound_power(-mantissa_exponent(p, extent_log2)) + bound_power(extent_log2 - p.reciprocal_bits - 1) +
         bound_power(extent_log2 - 31) + bound_power(extent_log2 - 29);
}

// 1/w, absolute: what an evaluation leaves out over the span's reach, the rounding of w, the unit.
constexpr uint64_t inverse_w_bound(const profile& p, int extent_log2) {
  return bound_power(-p.tolerance_bits - extent_log2) + 4 * relative_w_bound(p) + 2 * reciprocal_unit_bound(p);
}

}  // namespace detail

// A component of a footprint's vector along its direction, of a span: n (its terms, fifteen roundings), two products with 1/w, the final
// rounding. length: the vector's, texels of level 0, whole.
constexpr uint64_t axis_bound(const profile& p, int extent_log2, int axis_exponent, uint32_t length) {
  const uint64_t n = 3 * detail::gradient_bound(p, extent_log2) / 2 + 8 * detail::bound_power(-axis_exponent);
  return 8 * n + 3 * length * detail::inverse_w_bound(p, extent_log2) + 3 * detail::bound_power(-axis_exponent) + detail::bound_power(-17);
}

// The same of a pixel about its own centre: gradients of 31 bits and two products with a mantissa of 1/W: 2^-26 relative; the terms' last bits,
// a whole one per half pixel where rounding would lead to a bit more than there is.
constexpr uint64_t pixel_axis_bound(int jacobian_exponent, int axis_exponent, uint32_t length) {
  return length * detail::bound_power(-26) + 5 * detail::bound_power(-jacobian_exponent) + 2 * detail::bound_power(-axis_exponent) +
         detail::bound_power(-17);
}

// Level of an aniso footprint (its minor axis, or the major one over max_samples), against the exact vector along the same direction and the
// exact area, where it lies in [0, last]: the term and final roundings; log2 of n, the area, w and max_samples; w; n relative to the vector,
// the determinant to the area, which is at least 1/16 of the vector's square where it counts; the slopes in both.
constexpr uint64_t footprint_level_bound(const profile& p) {
  return detail::level_rounding_bound(p) + 7 * log2_bound() / 2 + detail::bound_power(18 - p.offset_bits) + detail::bound_power(13 - p.reciprocal_bits);
}

// A sample's offset from the footprint's centre: half a unit of 2^-16, and the step's rounding, 15/2 2^-16 of the vector's component, texels.
constexpr uint64_t sample_bound(uint32_t length) { return detail::bound_power(-17) + length * (15 * detail::bound_power(-17)); }

// Colours against exact means of the specified footprint. One division of exact sums; of aniso's samples each is rounded as a trilinear
// pixel is before write-out, and to what is summed.
constexpr uint64_t mean_bound(const profile& p) { return detail::bound_power(p.colour_rounding == rounding::floor ? 0 : -1); }
constexpr uint64_t aniso_colour_bound(const profile& p, bool two_levels) {
  constexpr int sum_bits = 20;
  return colour_bound(p, two_levels) + detail::bound_power(-sum_bits - (p.colour_rounding == rounding::floor ? 0 : 1));
}

// exp2_16(), relative: a chord of 1/64, two knots, the last rounding (all fractions: tests/scripts/footprint_proofs.py).
constexpr uint64_t exp2_bound() { return detail::bound_power(-15); }

// Contours: the field of a pixel against exact filtering, in units of it: rounded to blend_bits, and to 12 fraction bits, on each level; twice as
// much of a coarser level that counts in its own texels.
constexpr uint64_t contour_field_bound(const profile& p, bool doubled) {
  constexpr int field_bits = 12;
  const int half = p.colour_rounding == rounding::floor ? 0 : 1, bits = min_of(2 * p.subtexel_bits, p.blend_bits);
  const uint64_t bound = (2 * p.subtexel_bits > p.blend_bits ? detail::bound_power(-p.blend_bits - half) : 0) +
                         (bits > field_bits ? detail::bound_power(-field_bits - half) : 0);
  return doubled ? 2 * bound : bound;
}

// Distance from the contour, pixels, for the factor's logarithm as computed (log2_ceil: rounded up) and a distance of up to `pixels`.
constexpr uint64_t contour_distance_bound(const profile& p, bool doubled, int log2_ceil, uint32_t pixels) {
  return detail::bound_scaled(contour_field_bound(p, doubled), log2_ceil) + pixels * exp2_bound() + detail::bound_power(-17);
}

// Coverage, LSB: a box of one pixel turns pixels into 255 times as much; two roundings of 2^-17 and one of a half.
constexpr uint64_t contour_bound(uint64_t distance_bound) { return 255 * distance_bound + error_unit / 2; }

// The promises, checked when the library is compiled.
static_assert(coordinate_bound(profiles::exact) <= error_unit / 512, "exact: coordinates within 1/512 texel");
static_assert(coordinate_bound(profiles::standard) <= error_unit / 256, "default: coordinates within 1/256 texel");
static_assert(relative_w_bound({.reciprocal_bits = 12}) < error_unit / 256,
              "the planner's margin keeps w inside the reciprocal unit's domain");
static_assert(level_bound(profiles::exact) <= error_unit / 256, "exact: level of detail within 1/256");
static_assert(major_level_bound(profiles::exact) <= error_unit / 256, "exact: KT88's level of detail within 1/256");
static_assert(level_bound(profiles::standard) <= error_unit / 128, "default: level of detail within 1/128");
static_assert(major_level_bound(profiles::standard) <= error_unit / 128, "default: KT88's level of detail within 1/128");

}  // namespace spantex
