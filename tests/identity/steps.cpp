// SPDX-License-Identifier: Apache-2.0
// The C++ side of tests/scripts/proofs.py: prints the ranges that is_valid() really accepts and the constants of the headers, then answers
// a line 'step number number ...' with what the library computes. So the formulas that are proved can be held against the code.
#include <spantex/datapath.hpp>
#include <spantex/texture.hpp>

#include <utility>

#include "questions.hpp"

using namespace spantex;
using namespace spantex::identity;

namespace {

// Bits of the number that coordinate_at() shifts, for the profiles with the longest shifts.
template <int Offset, int Reciprocal>
void print_width() {
  using prof = fixed_profile<profile{.coordinate_bits = 4, .offset_bits = Offset, .reciprocal_bits = Reciprocal, .tolerance_bits = 16}>;
  std::printf("width_%d_%d %d 0\n", Offset, Reciprocal, int(sizeof(position_rep<prof>)) * 8);
}
template <int... K>
void print_widths(std::integer_sequence<int, K...>) {
  (print_width<12 + K / 19, 12 + K % 19>(), ...);
}

void print_constants() {
  print_range("offset_bits", &profile::offset_bits);
  print_range("reciprocal_bits", &profile::reciprocal_bits);
  print_range("coordinate_bits", &profile::coordinate_bits);
  print_range("tolerance_bits", &profile::tolerance_bits);
  print_range("subtexel_bits", &profile::subtexel_bits);
  print_range("level_bits", &profile::level_bits);
  print_range("blend_bits", &profile::blend_bits);
  std::printf("least_slope_log2 %d 0\nmost_series_slope_log2 %d 0\nmost_level_slope_log2 %d 0\nmost_series_terms %d 0\nlevel_factor %d 0\n",
              least_slope_log2, most_series_slope_log2, most_level_slope_log2, most_series_terms, int(level_factor.raw()));
  std::printf("max_extent_log2 %d 0\nmax_exponent %d 0\nmax_levels %d 0\nreach %d 0\n", max_extent_log2, max_exponent, max_levels, reach);
  for (int k = 0; k < 128; ++k) std::printf("seed_%d %d 0\n", k, int(reciprocal_seeds.seed[k]));
  for (int k = 0; k < 64; ++k) std::printf("knot_%d %d 0\n", k, int(log2_knots.knot[k]));
  print_widths(std::make_integer_sequence<int, 20 * 19>{});
}

run_time_profile with(int64_t offset, int64_t reciprocal, int64_t coordinate, int64_t tolerance = 12) {
  return {{.coordinate_bits = int(coordinate), .offset_bits = int(offset), .reciprocal_bits = int(reciprocal), .tolerance_bits = int(tolerance)}};
}

span_coefficients coefficients(const numbers& x, size_t at) {
  span_coefficients c{};
  c.c_u = int32_t(x[at]); c.a_u = int32_t(x[at + 1]); c.b_u = int32_t(x[at + 2]);
  c.c_v = int32_t(x[at + 3]); c.a_v = int32_t(x[at + 4]); c.b_v = int32_t(x[at + 5]);
  c.g = int32_t(x[at + 6]); c.h = int32_t(x[at + 7]);
  return c;
}

numbers reference_of(const plane& p) {
  const reference r = reference_at(p, 0, 0);
  return {r.base_u, r.c_u, r.a_u, r.b_u, r.base_v, r.c_v, r.a_v, r.b_v, r.u_in_range && r.v_in_range};
}

plane plane_of(const numbers& x, size_t at) {
  return {{x[at], x[at + 1], x[at + 2]}, {x[at + 3], x[at + 4], x[at + 5]}, {x[at + 6], x[at + 7], x[at + 8]}, 0, 0, 0};
}

// Offset, reciprocal, coordinate and tolerance bits, then the plane.
numbers span_of(const numbers& x) {
  const plane p = plane_of(x, 4);
  const reference r = reference_at(p, 0, 0);
  span_coefficients c{};
  if (!span_coordinates(r, with(x[0], x[1], x[2], x[3]).value, c)) return {0};
  return {1, c.base_u, c.base_v, c.c_u, c.a_u, c.b_u, c.c_v, c.a_v, c.b_v, c.g, c.h, c.exponent, int(c.how), c.slope_log2, c.terms};
}

// Reciprocal bits, exponent, then the coefficients.
numbers levels_of(const numbers& x) {
  span_coefficients c = coefficients(x, 2);
  c.exponent = int8_t(x[1]);
  span_levels(with(31, x[0], 16).value, c);
  numbers out(c.level_row, c.level_row + span_side);
  out.insert(out.end(), c.level_column, c.level_column + span_side);
  return out;
}

// Coordinate bits, reciprocal bits, evaluation, exponent, base, n, 1/w.
numbers position_of(const numbers& x) {
  span_coefficients c{};
  c.how = evaluation(x[2]);
  c.exponent = int8_t(x[3]);
  const auto n = offset_mantissa<run_time_profile>::from_raw(int32_t(x[5]));
  return {coordinate_at(with(31, x[1], x[0]), c, int32_t(x[4]), n, uint32_t(x[6])).raw()};
}

// Offset bits, reciprocal bits, slope_log2, terms, then e and n.
numbers by_series(const numbers& x) {
  const run_time_profile prof = with(x[0], x[1], 16);
  span_coefficients c{};
  c.slope_log2 = int8_t(x[2]);
  const series_number e16 = series_slope(prof, c, relative_slope<run_time_profile>::from_raw(int32_t(x[4])));
  const series_number q = series_of(e16, int(x[2]), int(x[3]));
  return {e16.raw(), q.raw(), numerator_by_series(prof, offset_mantissa<run_time_profile>::from_raw(int32_t(x[5])), q, int(x[2])).raw()};
}

numbers answer(const std::string& step, const numbers& x) {
  const auto pixel = [&](size_t at) { return std::pair(int(x[at]), int(x[at + 1])); };
  if (step == "newton_step") return {newton_step(uint32_t(x[0]), uint32_t(x[1]))};
  if (step == "quotient") return {quotient(x[0], int(x[1]), {uint32_t(x[2]), int(x[3])}, int(x[4]))};
  if (step == "numerator") return {numerator_at<run_time_profile>(span_coefficients{}, int32_t(x[0]), int32_t(x[1]), int32_t(x[2]), pixel(3).first, pixel(3).second).raw()};
  if (step == "relative_w") {
    span_coefficients c{};
    c.g = int32_t(x[1]);
    c.h = int32_t(x[2]);
    return {w_at(with(31, x[0], 16), c, pixel(3).first, pixel(3).second)};
  }
  if (step == "reciprocal_of_w") return {reciprocal_of_w(uint32_t(x[0]), int(x[1]))};
  if (step == "position") return position_of(x);
  if (step == "by_series") return by_series(x);
  if (step == "level_series") return {power_log2_of_series(series_number::from_raw(int32_t(x[0])), int(x[1]), int(x[2]))};
  if (step == "on_level") return {detail::on_level(coordinate::from_raw(int32_t(x[0])), uint32_t(x[1]), int(x[2]), int(x[3]), rounding::nearest)};
  if (step == "interpolated") return {interpolated(uint32_t(x[0]), uint32_t(x[1]), uint32_t(x[2]), int(x[3]))};
  if (step == "reference") return reference_of(plane_of(x, 0));
  if (step == "span") return span_of(x);
  if (step == "levels") return levels_of(x);
  if (step == "level_bound") return {int64_t(level_bound({.offset_bits = int(x[0]), .reciprocal_bits = int(x[1]), .level_bits = int(x[2])}))};
  return {};
}

}  // namespace

int main() {
  print_constants();
  answer_questions(answer);
}
