// SPDX-License-Identifier: Apache-2.0
// The C++ side of tests/scripts/footprint_proofs.py: the steps of footprint.hpp, area.hpp, contour.hpp and exp2.hpp.
#include <spantex/datapath.hpp>
#include <spantex/texture.hpp>

#include "questions.hpp"

using namespace spantex;
using namespace spantex::identity;

namespace {

void print_constants() {
  print_range("offset_bits", &profile::offset_bits);
  print_range("reciprocal_bits", &profile::reciprocal_bits);
  print_range("coordinate_bits", &profile::coordinate_bits);
  print_range("subtexel_bits", &profile::subtexel_bits);
  print_range("level_bits", &profile::level_bits);
  print_range("max_samples", &profile::max_samples);
  print_range("area_side_log2", &profile::area_side_log2);
  print_constant("max_extent_log2", max_extent_log2);
  print_constant("max_exponent", max_exponent);
  print_constant("max_axis_exponent", spantex::detail::max_axis_exponent);
  print_constant("max_levels", max_levels);
  print_constant("reach", reach);
  print_constant("direction_bits", direction_bits);
  print_constant("direction_count", direction_count);
  print_constant("max_footprint_samples", max_footprint_samples);
  print_constant("max_sum_bits", max_sum_bits);
  print_constant("max_linear_sum_bits", max_linear_sum_bits);
  print_constant("area_bits", area_bits);
  print_constant("swept_bits", spantex::detail::swept_bits);
  print_constant("hat_layers", hat_layers);
  print_constant("max_area_corners", max_area_corners);
  print_constant("max_area_side", max_area_side);
  print_constant("field_bits", spantex::detail::field_bits);
  print_constant("most_distance", spantex::detail::most_distance);
  for (int k = 0; k < direction_count; ++k) {
    const screen_direction d = direction_at(k);
    std::printf("direction_%d %d %d\n", k, int(d.cos), int(d.sin));
  }
  for (int k = 0; k < 4; ++k) std::printf("border_%d %d 0\n", k, int(spantex::detail::direction_borders[k]));
  for (int k = 0; k < 64; ++k) std::printf("knot_%d %d 0\n", k, int(log2_knots.knot[k]));
  for (int k = 0; k <= 64; ++k) std::printf("exp2_%d %d 0\n", k, int(exp2_knots.knot[k]));
}

run_time_profile with_reciprocal(int64_t bits) { return {{.reciprocal_bits = int(bits)}}; }

// Offset bits, the columns, the twist, the exponent.
numbers axis_of(const numbers& x) {
  const profile q{.offset_bits = int(x[0])};
  const axis_terms t = spantex::detail::axis_of(q, {x[1], x[2], x[3], x[4]}, x[5], x[6], int(x[7]));
  return {t.c_u, t.a_u, t.b_u, t.c_v, t.a_v, t.b_v, t.area_log2, t.exponent};
}

// Reciprocal bits, affine, exponent, n, 1/w.
numbers axis_at(const numbers& x) {
  span_coefficients c{};
  c.how = x[1] != 0 ? evaluation::affine : evaluation::divide;
  c.axis.exponent = int8_t(x[2]);
  const auto n = offset_mantissa<run_time_profile>::from_raw(int32_t(x[3]));
  return {spantex::detail::axis_at(with_reciprocal(x[0]), c, n, uint32_t(x[4])).raw()};
}

footprint footprint_of(int64_t u, int64_t v, int64_t samples) {
  return {coordinate::from_raw(int32_t(u)), coordinate::from_raw(int32_t(v)), 0, int(samples)};
}

// u, v of the vector, samples, the two weights, subtexel_bits, the square's number.
numbers square_of(const numbers& x) {
  const square s = square_at(footprint_of(x[0], x[1], x[2]), {uint32_t(x[3]), uint32_t(x[4])}, int(x[5]), int(x[6]));
  return {s.u, s.v, s.weight[0], s.weight[1], s.weight[2], s.weight[3], s.row_weight};
}

// Filter, level_bits, max_samples, sample_spacing, sample_slack, sample_bias, axis exponent, area, n, log2 w.
numbers shape_of_pixel(const numbers& x) {
  const run_time_profile prof{{.level_bits = int(x[1]), .max_samples = int(x[2]), .sample_spacing = int(x[3]), .sample_slack = int(x[4]), .sample_bias = int(x[5])}};
  span_coefficients c{};
  c.kind = x[0] != 0 ? filter::squares : filter::aniso;
  c.last_level = 12;
  c.axis.exponent = int8_t(x[6]);
  c.axis.area_log2 = int16_t(x[7]);
  using mantissa = offset_mantissa<run_time_profile>;
  const footprint_shape s = shape_of(prof, c, mantissa::from_raw(int32_t(x[8])), mantissa::from_raw(int32_t(x[9])), int32_t(x[10]));
  return {s.level, s.samples};
}

// Two levels, own units, threshold, level_bits, fraction, then value and bits of the finer and the coarser field.
numbers contour_field_of(const numbers& x) {
  span_coefficients c{};
  c.two_levels = x[0] != 0;
  c.contour.own_units = x[1] != 0;
  c.contour.threshold = uint16_t(x[2]);
  const profile q{.level_bits = int(x[3]), .colour_rounding = rounding::nearest};
  return {contour_field({uint32_t(x[5]), int(x[6])}, {uint32_t(x[7]), int(x[8])}, uint32_t(x[4]), c, q)};
}

// level_bits, the field, log2 of the factor to pixels (s.16).
numbers contour_distance_of(const numbers& x) { return {scaled_distance(int32_t(x[1]), int32_t(x[2]), int(x[0]))}; }

numbers swept_of(const numbers& x) {
  const auto n = [&](size_t k) { return int32_t(x[k]); };
  return {spantex::detail::swept_area({n(0), n(1), n(2)}, n(3), n(4), n(5), n(6))};
}

// subtexel_bits, area_side_log2, then centre and corners of a hexagon along u, texels of the level.
numbers fitted(const numbers& x) {
  const profile q{.subtexel_bits = int(x[0]), .area_side_log2 = int(x[1])};
  area_window w{};
  w.centre.u = int32_t(x[2]);
  for (size_t k = 0; k < max_area_corners; ++k) w.corner[k].u = int32_t(x[3 + k]);
  const spantex::detail::area_axis axis = spantex::detail::fit_axis(w, &area_point::u, max_area_corners, q);
  numbers out{axis.first, axis.count, w.centre.u};
  for (const area_point& p : w.corner) out.push_back(p.u);
  return out;
}

numbers answer(const std::string& step, const numbers& x) {
  if (step == "direction") return {major_direction({x[0], x[1], x[2], x[3]})};
  if (step == "axis_of") return axis_of(x);
  if (step == "axis_at") return axis_at(x);
  if (step == "shape") return shape_of_pixel(x);
  if (step == "sample_offset") return {sample_offset(coordinate::from_raw(int32_t(x[0])), int(x[1]), int(x[2])).raw()};
  if (step == "square") return square_of(x);
  if (step == "area_on_level") {
    const profile q{.subtexel_bits = int(x[3])};
    return {area_on_level(wide_coordinate::from_raw(x[0]), uint32_t(x[1]), int(x[2]), q)};
  }
  if (step == "fitted") return fitted(x);
  if (step == "scaled_square") return {spantex::detail::scaled_square(int32_t(x[0]), int32_t(x[1]), int32_t(x[2]))};
  if (step == "swept") return swept_of(x);
  if (step == "linear_weight") {
    area_window w{};
    w.columns = int(x[0]), w.rows = int(x[1]), w.bits = int(x[2]);
    return {linear_weight_drop(w), linear_weight(int32_t(x[3]), linear_weight_drop(w))};
  }
  if (step == "exp2") return {exp2_16(int32_t(x[0]))};
  if (step == "contour_field") return contour_field_of(x);
  if (step == "contour_distance") return contour_distance_of(x);
  if (step == "coverage") return {contour_coverage(int32_t(x[0]), uint8_t(x[1]))};
  return {};
}

}  // namespace

int main() {
  print_constants();
  answer_questions(answer);
}
