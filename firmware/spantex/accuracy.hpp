// SPDX-License-Identifier: Apache-2.0
// Error bounds as functions of a profile, derived in docs/ACCURACY.md. The planner, the tests, the stress run and the sweeps use
// these same functions. Compile time or set-up only; unit 2^-40 texel of level 0 unless a name says otherwise.
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>
#include <spantex/profile.hpp>

namespace spantex {

inline constexpr int error_unit_log2 = 40;
inline constexpr uint64_t error_unit = uint64_t(1) << error_unit_log2;

inline constexpr int max_extent_log2 = 12;  // span mode: texels of level 0 that a span may reach from its base
inline constexpr int max_exponent = 36;     // of the span's mantissas: keeps every shift below 63

// Exponent of a span's mantissas: offset_bits of them, one kept free for the roundings of the terms.
constexpr int mantissa_exponent(const profile& p, int extent_log2) {
  return min_of(p.offset_bits - 1 - extent_log2, max_exponent);
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
constexpr uint64_t reciprocal_unit_bound(const profile& p) {
  const uint64_t unit = detail::bound_power(p.reciprocal_bits <= 15 ? -13 : -29);  // 4 units of a number that is at least 1/2
  return unit + detail::bound_power(-p.reciprocal_bits);
}

// |position_at - n/w| for the ideal n/w of the same rounded coefficients: what widens the box of a section.
constexpr uint64_t evaluation_bound(const profile& p, int extent_log2, bool divides, bool approximates) {
  return detail::bound_power(-p.coordinate_bits - 1) + (approximates ? detail::bound_power(-p.tolerance_bits) : 0) +
         (divides ? detail::bound_scaled(reciprocal_unit_bound(p), extent_log2 + 1) : 0);
}

// End to end: |computed - exact| of a texture coordinate within s15.16, for spans that reach up to 2^extent_log2 texels.
constexpr uint64_t coordinate_bound(const profile& p, int extent_log2 = max_extent_log2) {
  const uint64_t n = numerator_bound(p, extent_log2), w = relative_w_bound(p);
  const uint64_t affine = evaluation_bound(p, extent_log2, false, true) + n;
  const uint64_t one_term = evaluation_bound(p, extent_log2, false, true) + 2 * n + detail::bound_scaled(w, extent_log2);
  const uint64_t divide = evaluation_bound(p, extent_log2, true, false) + 2 * n + detail::bound_scaled(w, extent_log2 + 2);
  return affine > one_term ? (affine > divide ? affine : divide) : (one_term > divide ? one_term : divide);
}

// |snapped - exact| of a blending filter's position on a level, in texels of that level: the coordinate, the ratio of sizes that do not
// halve exactly (31 bits), and half a step of the weights (a whole one if
// positions are cut).
constexpr uint64_t snapped_bound(const profile& p, int level) {
  return detail::bound_scaled(coordinate_bound(p), -level) + detail::bound_power(-17 - level) + detail::bound_power(-p.subtexel_bits - (p.position_rounding == rounding::floor ? 0 : 1));
}

// |computed - formula| of the level of detail where it lies in [0, last], in 2^-40 level: terms, final rounding, log2 twice and a
// half, and the span's mantissas.
constexpr uint64_t level_bound(const profile& p) {
  constexpr int term_bits = 10;
  return detail::bound_power(-term_bits - 1) + detail::bound_power(-p.level_bits - 1) + 10 * detail::bound_power(-16) +
         detail::bound_power(14 - p.offset_bits) + 6 * relative_w_bound(p);
}

// The promises, checked when the library is compiled.
static_assert(coordinate_bound(profiles::exact) <= error_unit / 512, "exact: coordinates within 1/512 texel");
static_assert(coordinate_bound(profiles::standard) <= error_unit / 256, "default: coordinates within 1/256 texel");
static_assert(relative_w_bound({.reciprocal_bits = 12}) < error_unit / 256,
              "the planner's margin keeps w inside the reciprocal unit's domain");
static_assert(level_bound(profiles::exact) <= error_unit / 256, "exact: level of detail within 1/256");
static_assert(level_bound(profiles::standard) <= error_unit / 128, "default: level of detail within 1/128");

}  // namespace spantex
