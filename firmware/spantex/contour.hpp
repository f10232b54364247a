// SPDX-License-Identifier: Apache-2.0
// Filter `contour` (VR11, "contour textures"; docs/SPEC.md "Contours"): colours are interpolated as by `trilinear`; alpha is the coverage of a
// shape whose edge is where the map's alpha, a scalar field, crosses a threshold. The interpolated field is steepened in proportion to the texels
// per pixel, so the edge is a pixel wide and a line along it keeps its width on the screen at every magnification:
//
//   D = (field - threshold) / scale 2^-lambda                             pixels from the contour, positive inside
//   fill(D) = clamp(D + 1/2, 0, 1)                                        coverage of a half-plane by a box of one pixel
//   line(D) = fill(D + width / 2) - fill(D - width / 2)                   its integral across the contour is the width, thin lines included
//
// lambda is the level of detail before its bias and its clamp: it is negative where the map is magnified.
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>
#include <spantex/exp2.hpp>
#include <spantex/filter.hpp>
#include <spantex/level.hpp>
#include <spantex/profile.hpp>
#include <spantex/span.hpp>

namespace spantex {

namespace detail {

inline constexpr int field_bits = 12;                      // fraction bits of the field
inline constexpr int32_t most_distance = 32 << 16;         // s5.16 pixels

// Field less threshold, s8.12.
constexpr int32_t centred_field(partial_colour f, uint32_t threshold, rounding mode) {
  const uint32_t value = f.bits > field_bits ? round_off(f.value, f.bits - field_bits, mode) : f.value << (field_bits - f.bits);
  return int32_t(value) - int32_t(threshold << (field_bits - 8));
}

// Coverage of a half-plane, u1.16.
constexpr int32_t filled(int32_t distance) { return clamp_to(distance + (1 << 15), 0, 1 << 16); }

}  // namespace detail

// Field of one pixel on its level, or of two levels; s9.12 with level_bits more. Below 2^29: 8 + 1 + 12 + 8 bits.
constexpr int32_t contour_field(partial_colour fine, partial_colour coarse, uint32_t fraction, const span_coefficients& c, const profile& q) {
  const int32_t one = 1 << q.level_bits, a = detail::centred_field(fine, c.contour.threshold, q.colour_rounding);
  if (!c.two_levels) return a * one;
  const int32_t b = detail::centred_field(coarse, c.contour.threshold, q.colour_rounding) * (c.contour.own_units ? 2 : 1);
  return a * (one - int32_t(fraction)) + b * int32_t(fraction);
}

// log2 of the factor from field units to pixels, s.16, -32 to 15.
template <class Prof>
constexpr int32_t steepness_log2(const Prof& prof, const span_coefficients& c, int i, int j) {
  const profile& q = prof.get();
  // KT88's axes are those of a circle two pixels wide.
  const int32_t lambda = unbiased_level(prof, c, i, j) - (q.formula == level_formula::jacobian ? 0 : 1 << 16);
  const int32_t unit = c.contour.own_units ? int32_t(c.fine.level) << 16 : 0;
  return clamp_to(unit - lambda - c.contour.scale_log2 * (1 << (16 - level_term_bits)), -32 * 65536, 15 * 65536);
}

// Pixels from the contour, s5.16, positive inside; cut to 32. The product with the factor's mantissa stays below 2^(29 + 17), up by at most 2 bits.
template <class Prof>
constexpr int32_t contour_distance(const Prof& prof, const span_coefficients& c, int32_t field, int i, int j) {
  const int32_t log2 = steepness_log2(prof, c, i, j), whole = log2 >> 16;
  const int64_t product = int64_t(field) * exp2_16(log2 & 0xFFFF);
  const int64_t distance = scale_down(product, detail::field_bits + prof.get().level_bits - int(whole));
  return int32_t(clamp_to(distance, -int64_t(detail::most_distance), int64_t(detail::most_distance)));
}

// Coverage, 0..255 to nearest.
constexpr uint8_t contour_coverage(int32_t distance, uint8_t outline) {
  const int32_t half = outline * (1 << 11);  // 1/16 pixel, halved, in 2^-16
  const int32_t coverage = outline == 0 ? detail::filled(distance) : detail::filled(distance + half) - detail::filled(distance - half);
  return uint8_t((coverage * 255 + (1 << 15)) >> 16);
}

}  // namespace spantex
