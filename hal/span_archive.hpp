// SPDX-License-Identifier: Apache-2.0
// What crosses the HAL, one field at a time in either direction: the one place that knows the order of the fields in recordings and on
// the bench's wires. An archive is a class with
//   operator()(Int&)         an integer or bool, little-endian, bool as one byte
//   one_of(Enum&, Enum last) an enumeration as one byte; values up to `last` exist
// Freestanding: devices use it too.
#pragma once
#include <stdint.h>

#include <spantex/profile.hpp>
#include <spantex/span.hpp>

namespace spantex::detail {

// The bindings name every member: a new one does not compile until it is archived.
template <class Archive>
constexpr void archive(Archive& a, section& s) {
  auto& [origin_u, origin_v, ratio_u, ratio_v, level, one_u, one_v] = s;
  a(origin_u); a(origin_v); a(ratio_u); a(ratio_v); a(level); a(one_u); a(one_v);
}

template <class Archive>
constexpr void archive(Archive& a, axis_terms& t) {
  auto& [c_u, a_u, b_u, c_v, a_v, b_v, area_log2, exponent, first_sample, last_sample, partial] = t;
  a(c_u); a(a_u); a(b_u); a(c_v); a(a_v); a(b_v);
  a(area_log2);
  a(exponent);
  a(first_sample);
  a(last_sample);
  a(partial);
}

template <class Archive>
constexpr void archive(Archive& a, contour_terms& t) {
  auto& [threshold, scale_log2, outline, own_units] = t;
  a(threshold); a(scale_log2); a(outline); a(own_units);
}

template <class Archive>
constexpr void archive(Archive& a, footprint_sums& s) {
  for (uint32_t& channel : s.channel) a(channel);
  a(s.weight);
}

template <class Archive>
constexpr void archive(Archive& a, span_coefficients& c) {
  auto& [base_u, base_v, c_u, a_u, b_u, c_v, a_v, b_v, g, h, row, column, axis, contour, fine, coarse, exponent, slope_log2, last_level, how, terms,
         kind, two_levels, corrects, linear_light, centred, from_x, from_y] = c;
  a(base_u); a(base_v);
  a(c_u); a(a_u); a(b_u); a(c_v); a(a_v); a(b_v);
  a(g); a(h);
  for (int16_t& term : row) a(term);
  for (int16_t& term : column) a(term);
  archive(a, axis);
  archive(a, contour);
  archive(a, fine);
  archive(a, coarse);
  a(exponent);
  a(slope_log2);
  a(last_level);
  a.one_of(how, evaluation::divide);
  a(terms);
  a.one_of(kind, last_filter);
  a(two_levels);
  a(corrects);
  a(linear_light);
  a(centred);
  static_cast<void>(from_x), static_cast<void>(from_y);  // no device has other than zero
}

// Each field as (name, value); values are small whole numbers.
template <class Visit>
constexpr void for_each_field(const profile& p, Visit visit) {
  const auto& [fine_side, overflow, scope, formula, level_bias, mip_bias, coordinate_bits, offset_bits, reciprocal_bits, tolerance_bits, subtexel_bits,
               level_bits, blend_bits, max_samples, sample_spacing, sample_slack, sample_bias, area_side_log2, contours, exact_set_up, linear_light, position_rounding,
               colour_rounding] = p;
  visit("fine_side", fine_side); visit("overflow", int(overflow)); visit("scope", int(scope)); visit("formula", int(formula));
  visit("level_bias", level_bias); visit("mip_bias", mip_bias); visit("coordinate_bits", coordinate_bits); visit("offset_bits", offset_bits);
  visit("reciprocal_bits", reciprocal_bits); visit("tolerance_bits", tolerance_bits); visit("subtexel_bits", subtexel_bits);
  visit("level_bits", level_bits); visit("blend_bits", blend_bits); visit("max_samples", max_samples); visit("sample_spacing", sample_spacing);
  visit("sample_slack", sample_slack); visit("sample_bias", sample_bias); visit("area_side_log2", area_side_log2); visit("contours", int(contours)); visit("exact_set_up", int(exact_set_up));
  visit("linear_light", int(linear_light)); visit("position_rounding", int(position_rounding)); visit("colour_rounding", int(colour_rounding));
}

}  // namespace spantex::detail
