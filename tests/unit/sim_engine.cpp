// SPDX-License-Identifier: Apache-2.0
// The simulated engine: its time, its counters, its ownership check, and that none of it changes a byte.
#include "tests/support.hpp"

#include <cstring>

#include <hal/sim_engine.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

using seed_profile = fixed_profile<profiles::seed>;
using standard_profile = fixed_profile<profiles::standard>;
constexpr profile unbiased_standard = [] { profile p = profiles::standard; p.mip_bias = 0; return p; }();

// The three planes stand first in support.hpp's list.
enum sample : int { facing, tilted, grazing, horizon };

// One texel is about eight pixels wide.
plane magnified_plane() {
  static constexpr double m[9] = {0.11, -0.02, 40.3, 0.03, 0.12, 17.9, 0, 0.00001, 1};
  plane p{};
  if (make_plane(homography_of(m), {0, 0, 640, 480}, p) != status::ok) std::abort();
  return p;
}

const texture_view& map_512() {
  static const texture_view t = photographic_map(512, 512).view(wrap::repeat, wrap::repeat);
  return t;
}

picture& scratch() {
  static picture p;
  p.reset(640, 480);
  return p;
}

template <class Prof, class Engine>
draw_counters draw(Engine& engine, const plane& p, filter kind, bool single_half = false) {
  picture& out = scratch();
  renderer<Engine, Prof> r(engine, Prof{}, out.frame());
  r.single_half(single_half);
  if (r.draw(p, map_512(), kind, out.area()) != status::ok || r.finish() != status::ok) std::abort();
  return r.counters();
}

template <class Prof>
sim::counters simulated(const plane& p, filter kind, const latencies& table = {}, bool single_half = false) {
  sim_engine<Prof> engine({}, table);
  (void)draw<Prof>(engine, p, kind, single_half);
  if (engine.ownership().violation_count() != 0) std::abort();
  return engine.counters();
}

double percent_hidden(const sim::counters& c) { return 100.0 * double(c.hidden_load_cycles) / double(c.load_cycles); }

void report(const char* what, const sim::counters& c) {
  print_message("%-44s %7.2f %% hidden, %8llu load, %7llu stall, %8llu cycles, %5.3f a pixel, %5.1f words a job\n", what, percent_hidden(c),
                static_cast<unsigned long long>(c.load_cycles), static_cast<unsigned long long>(c.stall_cycles),
                static_cast<unsigned long long>(c.total_cycles), double(c.total_cycles) / double(c.pixels),
                double(c.words_loaded) / double(c.jobs));
}

// Everything the engine told a trace, kept.
struct kept_trace final : trace_sink {
  std::vector<load_record> loads;
  std::vector<compute_record> computes;
  std::vector<interval> stalls;
  cycle settled_until = 0;
  bool in_order = true;

  void begins(cycle at) { in_order = in_order && at >= settled_until; }
  void load(const load_record& r) override { begins(r.time.begin); loads.push_back(r); }
  void compute(const compute_record& r) override { begins(r.issue.begin); computes.push_back(r); }
  void stall(interval t) override { begins(t.begin); stalls.push_back(t); }
  void mark(cycle at, event) override { begins(at); }
  void settled(cycle at) override { settled_until = later(settled_until, at); }
};

// One 64-bit word a clock for all channels together.
latencies one_word_port() {
  latencies t;
  t.port_words = 1;
  return t;
}

// --- time ----------------------------------------------------------------------------------------------

SPANTEX_CASE(one_pixel_per_cycle_when_loads_are_hidden) {
  static kept_trace trace;
  static sim_engine<seed_profile> engine({}, {}, &trace);
  (void)draw<seed_profile>(engine, magnified_plane(), filter::trilinear);
  const sim::counters& c = engine.counters();
  assert_int_equal(c.pixels, 640 * 480);
  assert_int_equal(c.compute_cycles, c.pixels);
  assert_int_equal(c.stall_cycles, 0);
  // The first load, then a pixel every cycle, then the last pixel's way through the pipeline: nothing else.
  const latencies t;
  const cycle way = cycle(t.coordinate_fill_cycles + t.fetch_fill_cycles + t.filter_fill_cycles + t.write_out_cycles);
  assert_int_equal(c.total_cycles, trace.computes[0].issue.begin + c.pixels + way);
  assert_true(trace.computes[0].issue.begin <= cycle(t.burst_start_cycles + 40 + t.coefficient_words));
  report("seed, magnified, trilinear", c);
}

SPANTEX_CASE(second_half_hides_loading_on_the_tilted_plane_in_the_seed_machine) {
  const plane p = sample_plane(tilted);
  const sim::counters both = simulated<seed_profile>(p, filter::trilinear), one = simulated<seed_profile>(p, filter::trilinear, {}, true);
  report("seed, tilted, trilinear, two halves", both);
  report("seed, tilted, trilinear, one half", one);
  assert_true(percent_hidden(both) >= 90);
  assert_int_equal(one.hidden_load_cycles, 0);
  // With one half loading and computing take turns.
  assert_true(one.total_cycles >= one.load_cycles + one.compute_cycles);
  assert_true(one.total_cycles > both.total_cycles);
}

// 16x16 + 8x8 texels are four times VR11's words: with one word a clock no schedule can hide what takes longer than computing.
SPANTEX_CASE(one_word_a_clock_is_too_narrow_for_larger_local_memory) {
  const plane p = sample_plane(tilted);
  const sim::counters narrow = simulated<standard_profile>(p, filter::trilinear, one_word_port());
  report("default, tilted, trilinear, 1 word a clock", narrow);
  assert_true(narrow.load_cycles > narrow.compute_cycles);
  // The port is the bottleneck and never rests: nothing is lost to the order of operations.
  assert_true(double(narrow.load_cycles) >= 0.99 * double(narrow.total_cycles));
  assert_true(double(narrow.hidden_load_cycles) >= 0.99 * double(narrow.compute_cycles));
}

SPANTEX_CASE(second_half_hides_loading_on_the_tilted_plane_in_the_default_profile) {
  const plane p = sample_plane(tilted);
  const sim::counters both = simulated<standard_profile>(p, filter::trilinear);
  const sim::counters one = simulated<standard_profile>(p, filter::trilinear, {}, true);
  const sim::counters unbiased = simulated<fixed_profile<unbiased_standard>>(p, filter::trilinear);
  report("default, tilted, trilinear, default latencies", both);
  report("the same with one half", one);
  report("the same without its bias of the level", unbiased);
  assert_true(percent_hidden(unbiased) >= 90);
  assert_true(percent_hidden(both) >= 80);  // sections of finer levels fit less often, and what is cut computes for less time than the next load takes
  assert_int_equal(one.hidden_load_cycles, 0);
  assert_true(one.total_cycles > both.total_cycles);
}

SPANTEX_CASE(second_half_hides_loading_on_the_tilted_plane_in_compact_and_exact) {
  const plane p = sample_plane(tilted);
  const sim::counters compact = simulated<fixed_profile<profiles::compact>>(p, filter::trilinear), exact = simulated<fixed_profile<profiles::exact>>(p, filter::trilinear);
  report("compact, tilted, trilinear", compact);
  report("exact, tilted, trilinear", exact);
  assert_true(percent_hidden(compact) >= 99);
  assert_true(percent_hidden(exact) >= 90);  // its bias of the level included
}

SPANTEX_CASE(every_latency_costs_what_it_says) {
  const plane p = sample_plane(facing);
  const auto with = [&](int latencies::*field, int value) {
    latencies t = one_word_port();
    t.*field = value;
    return simulated<seed_profile>(p, filter::bilinear, t, true);
  };
  const sim::counters base = simulated<seed_profile>(p, filter::bilinear, one_word_port(), true);
  const latencies t = one_word_port();
  const cycle jobs = base.jobs;
  assert_int_equal(with(&latencies::cycles_per_pixel, 2).total_cycles, base.total_cycles + base.pixels);
  const cycle words = base.words_loaded + jobs * cycle(t.coefficient_words);
  assert_int_equal(with(&latencies::cycles_per_transfer, 2).total_cycles, base.total_cycles + words);
  assert_int_equal(with(&latencies::coordinate_fill_cycles, t.coordinate_fill_cycles + 3).total_cycles, base.total_cycles + 3 * jobs);
  assert_int_equal(with(&latencies::fetch_fill_cycles, t.fetch_fill_cycles + 3).total_cycles, base.total_cycles + 3 * jobs);
  assert_int_equal(with(&latencies::filter_fill_cycles, t.filter_fill_cycles + 3).total_cycles, base.total_cycles + 3 * jobs);
  assert_int_equal(with(&latencies::write_out_cycles, t.write_out_cycles + 3).total_cycles, base.total_cycles + 3 * jobs);
  assert_int_equal(with(&latencies::coefficient_words, t.coefficient_words + 3).total_cycles, base.total_cycles + 3 * jobs);
  // One burst in a job's queue pays its start, the others follow it without a gap.
  assert_int_equal(with(&latencies::burst_start_cycles, t.burst_start_cycles + 3).total_cycles, base.total_cycles + 3 * jobs);
}

// Small enough to follow by hand: 4 + 2 cycles of words, 16 of coefficients, then 3 pixels and 11 cycles of pipeline.
SPANTEX_CASE(times_of_a_job_worked_out_by_hand) {
  static kept_trace trace;
  static sim_engine<seed_profile> engine({}, one_word_port(), &trace);
  static const uint64_t words[2] = {};
  static const span_coefficients c{};
  static span_pixels pixels;
  assert_int_equal(latencies{}.coefficient_words, 16);
  SPANTEX_ASSERT_OK(engine.load_words(half::first, 0, words, 2));
  SPANTEX_ASSERT_OK(engine.load_coefficients(half::first, c));
  SPANTEX_ASSERT_OK(engine.load_words(half::second, 0, words, 2));
  SPANTEX_ASSERT_OK(engine.start(half::first, 0b111));
  SPANTEX_ASSERT_OK(engine.load_coefficients(half::second, c));
  SPANTEX_ASSERT_OK(engine.start(half::second, 1));
  SPANTEX_ASSERT_OK(engine.take(half::first, pixels));
  assert_int_equal(engine.host_time(), 36);
  SPANTEX_ASSERT_OK(engine.take(half::second, pixels));
  assert_int_equal(engine.host_time(), 52);
  assert_int_equal(trace.loads[0].time.end, 6);
  assert_int_equal(trace.loads[1].time.end, 22);
  assert_int_equal(trace.loads[2].time.end, 24);
  assert_int_equal(trace.loads[3].time.end, 40);
  assert_int_equal(trace.computes[0].issue.begin, 22);
  assert_int_equal(trace.computes[0].issue.end, 25);
  assert_int_equal(trace.computes[0].end, 36);
  assert_int_equal(trace.computes[1].issue.begin, 40);
  assert_int_equal(engine.counters().load_cycles, 40);
  assert_int_equal(engine.counters().hidden_load_cycles, 3);   // cycles 22 to 25
  assert_int_equal(engine.counters().stall_cycles, 15);        // cycles 25 to 40
  assert_int_equal(engine.counters().total_cycles, 52);
  assert_int_equal(engine.counters().words_loaded, 4);
}

// --- counters ------------------------------------------------------------------------------------------

// Cycle by cycle, from what the trace tells.
SPANTEX_CASE(counters_agree_with_a_count_cycle_by_cycle) {
  static kept_trace trace;
  static sim_engine<standard_profile> engine({}, {}, &trace);
  const draw_counters drawn = draw<standard_profile>(engine, sample_plane(tilted), filter::trilinear);
  const sim::counters& c = engine.counters();
  static std::vector<uint8_t> loading, computing[half_count], issuing;  // loading, issuing: 1 + half
  for (std::vector<uint8_t>* v : {&loading, &computing[0], &computing[1], &issuing}) v->assign(c.total_cycles, 0);
  int clashes = 0;
  const auto paint = [&](std::vector<uint8_t>& v, interval t, int value) {
    for (cycle k = t.begin; k < t.end; ++k) {
      if (v[k] != 0) ++clashes;
      v[k] = uint8_t(value);
    }
  };
  for (const load_record& r : trace.loads) paint(loading, r.time, 1 + int(r.target));
  for (const compute_record& r : trace.computes) {
    paint(issuing, r.issue, 1 + int(r.target));
    paint(computing[int(r.target)], {r.issue.begin, r.end}, 1);
  }
  assert_int_equal(clashes, 0);
  assert_true(trace.in_order);
  cycle loads = 0, hidden = 0, issues = 0, stalls = 0, owned_twice = 0;
  for (cycle k = 0; k < c.total_cycles; ++k) {
    issues += issuing[k] != 0 ? 1 : 0;
    if (k > trace.computes.front().issue.begin && k < trace.computes.back().issue.begin && issuing[k] == 0) ++stalls;
    if (loading[k] == 0) continue;
    ++loads;
    hidden += issuing[k] == 3 - loading[k] ? 1 : 0;
    owned_twice += computing[loading[k] - 1][k];
  }
  assert_int_equal(owned_twice, 0);
  assert_int_equal(loads, c.load_cycles);
  assert_int_equal(hidden, c.hidden_load_cycles);
  assert_int_equal(issues, c.compute_cycles);
  assert_int_equal(stalls, c.stall_cycles);
  assert_int_equal(drawn.words_loaded, c.words_loaded);
  assert_int_equal(drawn.jobs, c.jobs);
  assert_int_equal(drawn.pixels, c.pixels);
  assert_int_equal(c.fetches, c.pixels * channel_count);
  assert_int_equal(c.bank_conflicts, 0);
}

struct column_banks {
  static constexpr int bank(int x, int) { return x & 3; }
};

SPANTEX_CASE(wrong_banks_cost_cycles_but_no_bytes) {
  static picture right, wrong;
  right.reset(160, 120);
  wrong.reset(160, 120);
  static sim_engine<seed_profile> good;
  static sim_engine<seed_profile, 8, column_banks> bad;
  const plane p = sample_plane(facing, {0, 0, 160, 120});
  SPANTEX_ASSERT_OK(render_plane(seed_profile{}, good, p, map_512(), filter::trilinear, right));
  SPANTEX_ASSERT_OK(render_plane(seed_profile{}, bad, p, map_512(), filter::trilinear, wrong));
  assert_true(right == wrong);
  assert_int_equal(good.counters().bank_conflicts, 0);
  assert_int_equal(bad.counters().bank_conflicts, bad.counters().fetches);
  assert_int_equal(bad.counters().compute_cycles, 2 * good.counters().compute_cycles);
}

// --- ownership -----------------------------------------------------------------------------------------

SPANTEX_CASE(violations_are_refused_recorded_and_named) {
  static sim_engine<seed_profile> engine({}, one_word_port());
  static const uint64_t words[2] = {};
  static const span_coefficients c{};
  static span_pixels pixels;
  const ownership_guard& guard = engine.ownership();
  SPANTEX_ASSERT_STATUS(engine.take(half::second, pixels), half_not_started);
  SPANTEX_ASSERT_STATUS(engine.start(half::first, 1), half_not_loaded);
  SPANTEX_ASSERT_STATUS(engine.load_words(half::first, 39, words, 2), bad_address);
  SPANTEX_ASSERT_OK(engine.load_coefficients(half::first, c));
  SPANTEX_ASSERT_OK(engine.start(half::first, 1));
  assert_int_equal(guard.violation_count(), 3);
  engine.delay(20);
  SPANTEX_ASSERT_STATUS(engine.load_words(half::first, 0, words, 1), half_busy);
  SPANTEX_ASSERT_STATUS(engine.load_coefficients(half::first, c), half_busy);
  SPANTEX_ASSERT_STATUS(engine.start(half::first, 1), half_busy);
  assert_int_equal(guard.violation_count(), 6);
  assert_string_equal(text_of(guard.at(0)).c_str(), "take of half 1 at cycle 0: half was not started");
  assert_string_equal(text_of(guard.at(1)).c_str(), "start of half 0 at cycle 0: half is not loaded");
  assert_string_equal(text_of(guard.at(2)).c_str(), "load_words of half 0 at cycle 0: word address beyond local texture memory");
  assert_string_equal(text_of(guard.at(3)).c_str(), "load_words of half 0 at cycle 20: half is busy (last computing in cycles 20 to 32)");
  assert_string_equal(text_of(guard.at(4)).c_str(),
                      "load_coefficients of half 0 at cycle 20: half is busy (last computing in cycles 20 to 32)");
  assert_string_equal(text_of(guard.at(5)).c_str(), "start of half 0 at cycle 20: half is busy (last computing in cycles 20 to 32)");
}

SPANTEX_CASE(violations_beyond_the_kept_ones_are_counted) {
  static sim_engine<seed_profile> engine;
  static span_pixels pixels;
  for (int k = 0; k < 100; ++k) SPANTEX_ASSERT_STATUS(engine.take(half::first, pixels), half_not_started);
  assert_int_equal(engine.ownership().violation_count(), 100);
}

// A schedule that gives a half to loader and pipeline at once is found even where every call was in order.
SPANTEX_CASE(overlap_in_time_is_a_violation_of_the_schedule) {
  ownership_guard guard;
  SPANTEX_ASSERT_OK(guard.computes(half::first, operation::start, {10, 20}));
  SPANTEX_ASSERT_OK(guard.loads(half::first, operation::load_words, {20, 30}));
  SPANTEX_ASSERT_OK(guard.loads(half::second, operation::load_words, {10, 20}));
  assert_int_equal(guard.violation_count(), 0);
  SPANTEX_ASSERT_STATUS(guard.loads(half::first, operation::load_words, {19, 25}), half_busy);
  assert_int_equal(guard.violation_count(), 1);
  SPANTEX_ASSERT_STATUS(guard.computes(half::second, operation::start, {19, 40}), half_busy);
  assert_int_equal(guard.violation_count(), 2);
  assert_int_equal(int(guard.at(1).what), int(operation::start));
}

// --- bytes ---------------------------------------------------------------------------------------------

// High enough for the horizon to cross it.
constexpr rectangle small_area{0, 0, 104, 180};

template <class Prof, int Side>
void same_bytes(const Prof& prof, const plane& p, const texture_view& t, filter kind, const char* name) {
  static picture plain, timed;
  plain.reset(small_area.x1, small_area.y1);
  timed.reset(small_area.x1, small_area.y1);
  static direct_engine<Prof, Side> direct(prof);
  static sim_engine<Prof, Side> simulation(prof);
  SPANTEX_ASSERT_OK(render_plane(prof, direct, p, t, kind, plain));
  SPANTEX_ASSERT_OK(render_plane(prof, simulation, p, t, kind, timed));
  const int64_t differing = differing_pixels(plain, timed);
  if (differing != 0) fail_msg("profile %s, filter %d: %lld pixels differ", name, int(kind), static_cast<long long>(differing));
  assert_int_equal(simulation.counters().bank_conflicts, 0);
  assert_int_equal(simulation.ownership().violation_count(), 0);
}

template <class Prof, int Side>
void same_bytes_everywhere(const char* name, const Prof& prof = {}) {
  const synthetic_map& square = photographic_map(128, 128, 5);
  const synthetic_map& odd = photographic_map(83, 45, 6);
  for (int k = 0; k < sample_plane_count; ++k) {
    const plane p = sample_plane(k, small_area);
    for (filter kind : all_filters)
      for (wrap mode : all_wraps) {
        same_bytes<Prof, Side>(prof, p, square.view(mode, mode), kind, name);
        same_bytes<Prof, Side>(prof, p, odd.view(mode, wrap::mirror), kind, name);
      }
  }
}

SPANTEX_CASE(same_bytes_as_direct_seed) { same_bytes_everywhere<seed_profile, 8>("seed"); }
SPANTEX_CASE(same_bytes_as_direct_compact) { same_bytes_everywhere<fixed_profile<profiles::compact>, 8>("compact"); }
SPANTEX_CASE(same_bytes_as_direct_default) { same_bytes_everywhere<standard_profile, 16>("default"); }
SPANTEX_CASE(same_bytes_as_direct_exact) { same_bytes_everywhere<fixed_profile<profiles::exact>, 32>("exact"); }
SPANTEX_CASE(same_bytes_as_direct_run_time_profile) { same_bytes_everywhere<run_time_profile, 32>("exact at run time", {profiles::exact}); }

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(one_pixel_per_cycle_when_loads_are_hidden),
      cmocka_unit_test(second_half_hides_loading_on_the_tilted_plane_in_the_seed_machine),
      cmocka_unit_test(one_word_a_clock_is_too_narrow_for_larger_local_memory),
      cmocka_unit_test(second_half_hides_loading_on_the_tilted_plane_in_the_default_profile),
      cmocka_unit_test(second_half_hides_loading_on_the_tilted_plane_in_compact_and_exact),
      cmocka_unit_test(every_latency_costs_what_it_says),
      cmocka_unit_test(times_of_a_job_worked_out_by_hand),
      cmocka_unit_test(counters_agree_with_a_count_cycle_by_cycle),
      cmocka_unit_test(wrong_banks_cost_cycles_but_no_bytes),
      cmocka_unit_test(violations_are_refused_recorded_and_named),
      cmocka_unit_test(violations_beyond_the_kept_ones_are_counted),
      cmocka_unit_test(overlap_in_time_is_a_violation_of_the_schedule),
      cmocka_unit_test(same_bytes_as_direct_seed),
      cmocka_unit_test(same_bytes_as_direct_compact),
      cmocka_unit_test(same_bytes_as_direct_default),
      cmocka_unit_test(same_bytes_as_direct_exact),
      cmocka_unit_test(same_bytes_as_direct_run_time_profile),
  };
  return sim::run_suite("sim_engine", tests);
}
