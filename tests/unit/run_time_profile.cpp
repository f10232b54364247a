// SPDX-License-Identifier: Apache-2.0
// A profile known at run time gives the bytes of the same profile known at compile time, in every filter; and what only the simulator varies
// (unit_variants) keeps what its bounds say: reciprocal units of any table, evaluations asked for, spans of 4 and 16 pixels.
#include "tests/support.hpp"

#include <cstdlib>

using namespace spantex;
using namespace spantex::sim;

namespace {

constexpr int32_t width = 120, height = 72;
picture compiled, at_run_time;

// The sample planes, shrunk to the picture; the horizon is near one and in another.
plane plane_number(int k) {
  homography m = sample_homography(k);
  for (wide* c : {&m.a, &m.b, &m.d, &m.e, &m.g, &m.h}) *c = multiply(*c, 6);
  plane p{};
  if (make_plane(m, {0, 0, width, height}, p) != status::ok) std::abort();
  return p;
}

template <class Prof, int Side>
void draw(const Prof& prof, int plane_index, const texture_view& t, filter kind, picture& out) {
  out.reset(width, height);
  SPANTEX_ASSERT_OK(render_plane_direct<Side>(prof, plane_number(plane_index), t, kind, out));
}

template <profile P>
void same_bytes_in_every_filter() {
  const texture_view t = photographic_map(200, 128).view(wrap::repeat, wrap::mirror);
  for (int k = 0; k < sample_plane_count; ++k)
    for (const filter kind : all_filters) {
      draw<fixed_profile<P>, P.fine_side>({}, k, t, kind, compiled);
      draw<run_time_profile, P.fine_side>({P}, k, t, kind, at_run_time);
      if (differing_pixels(compiled, at_run_time) != 0) fail_msg("plane %d, filter %d: other bytes at run time", k, int(kind));
    }
}

const filter filters_of_spans[] = {filter::nearest, filter::trilinear, filter::trilinear3, filter::aniso, filter::squares, filter::step, filter::hat};

// Where the level is exact on every pixel, sections are split and positions do not depend on local memory, its size changes no byte.
void local_memory_changes_no_byte(const unit_variants& v) {
  const texture_view t = photographic_map(256, 256).view(wrap::repeat, wrap::repeat);
  profile small = profiles::exact;
  small.fine_side = 8;
  for (int k = 0; k < sample_plane_count; ++k)
    for (const filter kind : filters_of_spans) {
      draw<run_time_profile, 32>({profiles::exact, v}, k, t, kind, compiled);
      draw<run_time_profile, 8>({small, v}, k, t, kind, at_run_time);
      if (differing_pixels(compiled, at_run_time) != 0) fail_msg("plane %d, filter %d: local memory shows", k, int(kind));
    }
}

double worst_difference(const picture& a, const picture& b) {
  int worst = 0;
  for (size_t k = 0; k < a.pixels.size(); ++k)
    for (const int d : {a.pixels[k].r - b.pixels[k].r, a.pixels[k].g - b.pixels[k].g, a.pixels[k].b - b.pixels[k].b}) worst = max_of(worst, std::abs(d));
  return worst;
}

}  // namespace

SPANTEX_CASE(seed_is_seed) { same_bytes_in_every_filter<profiles::seed>(); }
SPANTEX_CASE(compact_is_compact) { same_bytes_in_every_filter<profiles::compact>(); }
SPANTEX_CASE(default_is_default) { same_bytes_in_every_filter<profiles::standard>(); }
SPANTEX_CASE(exact_is_exact) { same_bytes_in_every_filter<profiles::exact>(); }

SPANTEX_CASE(reciprocals_of_every_table_and_step_are_within_their_bound) {
  random_source random(3);
  for (const int bits : {12, 15, 16, 22, 30})
    for (int table = 3; table <= 10; ++table)
      for (int steps = 0; steps <= 2; ++steps) {
        const unit_variants v{.reciprocal_table_log2 = table, .reciprocal_iterations = steps};
        profile q = profiles::exact;
        q.reciprocal_bits = bits;
        const uint64_t bound = reciprocal_unit_bound(q, v);
        for (int k = 0; k < 20000; ++k) {
          const uint32_t w = uint32_t(random.between((1 << (bits - 1)) + 1, (3 << (bits - 1)) - 1)), r = reciprocal_of_w(w, bits, v);
          const int128 difference = magnitude_of(int128(r) * w - (int128(1) << (2 * bits)));
          if (difference << error_unit_log2 > int128(bound) << (2 * bits))
            fail_msg("R = %d, table 2^%d, %d steps: w = %u gives %u", bits, table, steps, unsigned(w), unsigned(r));
        }
      }
}

SPANTEX_CASE(fewer_seeds_and_steps_show) {
  const auto worst = [](int table, int steps) {
    double most = 0;
    const uint32_t one = 1u << 30;
    for (uint32_t w = one / 2 + 1; w < one + one / 2; w += 99991) {
      const double r = double(reciprocal_of_w(w, 30, {.reciprocal_table_log2 = table, .reciprocal_iterations = steps})) / one, error = r * w / one - 1;
      most = error > most ? error : -error > most ? -error : most;
    }
    return most;
  };
  assert_true(worst(3, 0) > worst(5, 0) && worst(5, 0) > worst(7, 0) && worst(7, 0) > worst(7, 1) && worst(7, 1) > worst(7, 2));
  assert_true(worst(4, 1) < 1.1 * worst(4, 0) * worst(4, 0));
}

SPANTEX_CASE(spans_of_4_and_16_hold_what_their_sections_promise) {
  for (const int span_log2 : {2, 4}) local_memory_changes_no_byte({.span_log2 = span_log2});
}

SPANTEX_CASE(evaluations_asked_for_hold_what_their_sections_promise) {
  for (int order = 1; order <= int(evaluation_order::divide); ++order) local_memory_changes_no_byte({.order = evaluation_order(order)});
}

// At full word lengths the span's size moves positions by less than a weight's step: at most a unit or two between a map's sharp edges.
SPANTEX_CASE(spans_of_any_size_show_the_same_picture) {
  const texture_view t = photographic_map(256, 256).view(wrap::repeat, wrap::repeat);
  for (int k = 0; k < sample_plane_count; ++k) {
    draw<run_time_profile, 32>({profiles::exact, {}}, k, t, filter::trilinear, compiled);
    for (const int span_log2 : {2, 4}) {
      draw<run_time_profile, 32>({profiles::exact, {.span_log2 = span_log2}}, k, t, filter::trilinear, at_run_time);
      if (worst_difference(compiled, at_run_time) > 2) fail_msg("plane %d, spans of %d: off by %.0f", k, 1 << span_log2, worst_difference(compiled, at_run_time));
    }
  }
}

SPANTEX_CASE(no_division_at_all_shows) {
  const texture_view t = photographic_map(256, 256).view(wrap::repeat, wrap::repeat);
  draw<run_time_profile, 32>({profiles::exact, {}}, 1, t, filter::bilinear, compiled);
  draw<run_time_profile, 32>({profiles::exact, {.order = evaluation_order::divide}}, 1, t, filter::bilinear, at_run_time);
  assert_true(worst_difference(compiled, at_run_time) <= 2);
  draw<run_time_profile, 32>({profiles::exact, {.order = evaluation_order::affine}}, 1, t, filter::bilinear, at_run_time);
  assert_true(worst_difference(compiled, at_run_time) > 2);
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(seed_is_seed),
      cmocka_unit_test(compact_is_compact),
      cmocka_unit_test(default_is_default),
      cmocka_unit_test(exact_is_exact),
      cmocka_unit_test(reciprocals_of_every_table_and_step_are_within_their_bound),
      cmocka_unit_test(fewer_seeds_and_steps_show),
      cmocka_unit_test(spans_of_4_and_16_hold_what_their_sections_promise),
      cmocka_unit_test(evaluations_asked_for_hold_what_their_sections_promise),
      cmocka_unit_test(spans_of_any_size_show_the_same_picture),
      cmocka_unit_test(no_division_at_all_shows),
  };
  return run_suite("run_time_profile", tests);
}
