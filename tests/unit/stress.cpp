// SPDX-License-Identifier: Apache-2.0
// The stress run itself: that cases repeat, families visit what they are named for, every stage is judged, and failures are seen and
// shrunk. tests/gates.py breaks each stage and expects `a_short_run...` to notice.
#include <tests/support.hpp>

#include <sim/stress.hpp>
#include <sim/stress_judge.hpp>
#include <sim/stress_planes.hpp>
#include <sim/stress_polygons.hpp>
#include <sim/stress_shrink.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

constexpr uint64_t short_evaluations = 1'200'000;

stress_report short_report(const profile& p) {
  return run_stress(p, {short_run() ? short_evaluations / 4 : short_evaluations, 5, 0, 1, {}});
}

void print_failures(const profile& p, const stress_report& r) {
  for (const std::string& missed : shortfalls(r)) std::printf("# %s\n", missed.c_str());
  for (const stress_row& row : r.rows)
    if (row.failures() != 0) std::printf("# %s\n", describe_case(p, row.family, row.first_failure).c_str());
}

uint64_t failures_of(const stress_report& r) {
  uint64_t sum = 0;
  for (const stress_row& row : r.rows) sum += row.failures();
  return sum;
}

bool same(const stress_worst& a, const stress_worst& b) {
  return a.error == b.error && a.bound == b.bound && a.span_x == b.span_x && a.span_y == b.span_y && a.pixel == b.pixel;
}

}  // namespace

SPANTEX_CASE(a_short_run_of_every_profile_is_within_bounds_and_misses_nothing) {
  for (const named_profile& p : all_profiles) {
    const stress_report r = short_report(p.value);
    print_failures(p.value, r);
    assert_true(failures_of(r) == 0);
    assert_true(shortfalls(r).empty());
  }
}

// The command that a table prints for a stage gives the numbers of the table.
SPANTEX_CASE(the_case_of_every_worst_repeats) {
  const stress_report r = run_stress(profiles::exact, {300'000, 9, 0, 1, {}});
  for (const stress_row& row : r.rows)
    for (int k = 0; k < stress_stage_count; ++k) {
      if (row.stages[k].judged == 0) continue;
      assert_true(same(run_case(profiles::exact, row.family, row.stages[k].worst.case_seed).stages[k].worst, row.stages[k].worst));
      assert_true(same(run_case(profiles::exact, row.family, row.stages[k].largest.case_seed).stages[k].largest, row.stages[k].largest));
    }
}

SPANTEX_CASE(a_case_does_not_depend_on_the_threads) {
  for (const stress_family f : {stress_family::near_horizon, stress_family::one_pixel}) {
    const stress_report one = run_stress(profiles::exact, {20'000, 3, 0, 1, {f}}),
                        three = run_stress(profiles::exact, {20'000, 3, 0, 3, {f}});
    assert_true(three.rows[0].cases >= one.rows[0].cases);  // they may go a few cases further
    assert_true(three.rows[0].stages[int(stress_stage::pixel)].worst.share() >= one.rows[0].stages[int(stress_stage::pixel)].worst.share());
  }
}

SPANTEX_CASE(a_family_that_visits_other_spans_is_reported) {
  stress_report r = run_stress(profiles::exact, {20'000, 3, 0, 1, {stress_family::near_horizon}});
  assert_true(shortfalls(r).empty());
  r.rows[0].adverse = r.rows[0].evaluations / 5;
  assert_int_equal(shortfalls(r).size(), 1);
  assert_true(shortfalls(r)[0].starts_with("near-horizon"));
}

SPANTEX_CASE(a_stage_that_is_never_judged_is_reported) {
  stress_report r = short_report(profiles::compact);
  if (short_run()) return;
  assert_true(shortfalls(r).empty());
  for (stress_row& row : r.rows) row.stages[int(stress_stage::series)].judged = 0;
  assert_int_equal(shortfalls(r).size(), 1);
}

// Positions of one profile judged by the bounds of a finer one.
SPANTEX_CASE(words_too_short_for_the_bounds_fail) {
  stress_bounds bounds(profiles::exact);
  bounds.prof = profiles::seed;
  stress_row row{};
  for (uint64_t seed = 1; seed < 200; ++seed) {
    const stress_plane_case c = make_stress_plane(stress_family::any_plane, seed);
    stress_judge judge(bounds, seed, row);
    judge.judge_span(c.map, spans_to_visit(c, seed).spans[0], full_mask, true);
  }
  for (const stress_stage s : {stress_stage::numerator, stress_stage::relative_w, stress_stage::pixel, stress_stage::affine})
    assert_true(row.stages[int(s)].failures > 0);
}

SPANTEX_CASE(shrinking_ends_at_the_simplest_numbers_that_fail) {
  const auto fails = [](const std::vector<int128>& n) { return n[0] >= 100 && n[1] <= -7; };
  const std::vector<int128> least = shrink({int128(123456789) << 60, -1000, 77}, fails);
  assert_true(least[2] == 0);
  assert_true(bits_of(least[1]) == 10 && fails(least));  // one bit is left of -1000
  assert_true(least[1] == -512);
  assert_true(size_of(least[0]) == int128(1) << (bits_of(int128(123456789) << 60) - 1));
}

SPANTEX_CASE(fans_cover_their_outline_and_polygons_that_set_up_refuses_cover_nothing) {
  for (const stress_family f : {stress_family::fans, stress_family::one_pixel, stress_family::needles}) {
    const stress_report r = run_stress(profiles::standard, {6'000, 11, 0, 1, {f}});
    const stress_row& row = r.rows[0];
    assert_true(row.polygons > row.refused);
    assert_true(row.stages[int(stress_stage::coverage)].judged > 0 && row.failures() == 0);
  }
  // Without half of its triangles a fan leaves pixels of its outline undrawn.
  stress_fan fan = make_stress_fan(stress_family::fans, 1);
  fan.triangles.resize(fan.triangles.size() / 2);
  stress_row row{};
  row.family = stress_family::fans;
  const stress_bounds bounds(profiles::standard);
  stress_judge judge(bounds, 1, row);
  judge_fan(fan, judge, row);
  assert_true(row.stages[int(stress_stage::fan_once)].failures == 1);
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_short_run_of_every_profile_is_within_bounds_and_misses_nothing),
      cmocka_unit_test(the_case_of_every_worst_repeats),
      cmocka_unit_test(a_case_does_not_depend_on_the_threads),
      cmocka_unit_test(a_family_that_visits_other_spans_is_reported),
      cmocka_unit_test(a_stage_that_is_never_judged_is_reported),
      cmocka_unit_test(words_too_short_for_the_bounds_fail),
      cmocka_unit_test(shrinking_ends_at_the_simplest_numbers_that_fail),
      cmocka_unit_test(fans_cover_their_outline_and_polygons_that_set_up_refuses_cover_nothing),
  };
  return run_suite("stress", tests);
}
