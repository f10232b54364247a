// SPDX-License-Identifier: Apache-2.0
#include "sim/stress.hpp"

#include <spantex/accuracy.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <mutex>
#include <thread>

#include "sim/random.hpp"
#include "sim/stress_judge.hpp"
#include "sim/stress_planes.hpp"
#include "sim/stress_polygons.hpp"

namespace spantex::sim {
namespace {

// --- one case --------------------------------------------------------------------------------------------

void judge_plane_case(const stress_plane_case& c, uint64_t seed, stress_judge& judge, stress_row& row) {
  const exact_plane exact = exact_plane_of(c.exact);
  const rectangle region{0, 0, c.width_px, c.height_px};
  const span_list list = spans_to_visit(c, seed);
  for (int k = 0; k < list.count; ++k) {
    const span_at s = list.spans[k];
    judge.judge_set_up(exact, region, c.map, 16 * s.x + 8, 16 * s.y + 8);
    judge.judge_span(c.map, s, full_mask, is_adverse(row.family, c.map, s));
  }
  judge.judge_moved(c.map, list.spans[0]);
  if (row.family == stress_family::wide_screen) judge.judge_walks(c);
}

void judge_case(const stress_bounds& bounds, uint64_t seed, stress_row& row) {
  ++row.cases;
  const uint64_t before = row.failures();
  stress_judge judge(bounds, seed, row);
  if (is_polygons(row.family))
    judge_fan(make_stress_fan(row.family, seed), judge, row);
  else
    judge_plane_case(make_stress_plane(row.family, seed), seed, judge, row);
  if (row.failures() != before && row.failed_cases++ == 0) row.first_failure = seed;
}

// --- a run -----------------------------------------------------------------------------------------------

void merge(stress_record& into, const stress_record& from) {
  if (from.judged == 0) return;
  if (into.judged == 0 || from.share > into.share) {
    into.worst = from.worst;
    into.share = from.share;
  }
  if (into.judged == 0 || from.largest.error > into.largest.error) into.largest = from.largest;
  into.judged += from.judged;
  into.failures += from.failures;
}

void merge(stress_row& into, const stress_row& from) {
  into.cases += from.cases;
  into.evaluations += from.evaluations;
  into.adverse += from.adverse;
  into.undecided += from.undecided;
  into.polygons += from.polygons;
  into.refused += from.refused;
  if (into.failed_cases == 0) into.first_failure = from.first_failure;
  into.failed_cases += from.failed_cases;
  for (int k = 0; k < stress_stage_count; ++k) merge(into.stages[k], from.stages[k]);
}

using clock = std::chrono::steady_clock;

// A family's share of the evaluations, cases dealt out to the threads by number: which they are does not depend on the threads, only
// how far past the share they go.
stress_row run_family(const stress_bounds& bounds, stress_family family, const stress_options& o, uint64_t share, clock::time_point end,
                      bool& complete) {
  stress_row total{};
  total.family = family;
  std::mutex lock;
  std::atomic<uint64_t> next{0}, done{0};
  std::atomic<bool> late{false};
  const auto work = [&] {
    stress_row row{};
    row.family = family;
    while (done < share && !late) {
      const uint64_t before = row.evaluations;
      judge_case(bounds, mix(o.seed, uint64_t(family), next++), row);
      done += row.evaluations - before;
      if (o.seconds > 0 && clock::now() > end) late = true;
    }
    const std::lock_guard<std::mutex> hold(lock);
    merge(total, row);
  };
  std::vector<std::thread> crew;
  for (int k = 0; k < o.threads; ++k) crew.emplace_back(work);
  for (std::thread& t : crew) t.join();
  complete = complete && done >= share;
  return total;
}

// Polygons cost far more set-up per evaluation.
uint64_t weight_of(stress_family f) {
  switch (f) {
    case stress_family::one_pixel:
      return 3;
    case stress_family::fans:
    case stress_family::needles:
      return 20;
    default:
      return 100;
  }
}

}  // namespace

const char* name_of(stress_family f) {
  constexpr const char* names[stress_family_count] = {"any-plane", "horizon",  "near-horizon", "edge-on",  "cancelling", "far-coordinates",
                                                      "magnified", "minified", "wide-screen",  "extremes", "fans",       "one-pixel",
                                                      "needles"};
  return names[int(f)];
}

const char* name_of(stress_stage s) {
  constexpr const char* names[stress_stage_count] = {
      "set-up",          "numerator",         "relative w",  "reciprocal",   "u, v: affine",      "u, v: series",
      "u, v: divide",    "u, v: pixel",       "beyond 2^15", "drift: row",   "drift: column",     "drift: moved",
      "level: Jacobian", "level: major axis", "log2",        "snapped u, v", "axis of one texel", "nearest texel",
      "colour",          "write-out",         "coverage",    "W > 0",        "fan drawn once",
      "footprint corner", "footprint vector", "footprint level", "sample place", "colour: squares", "colour: aniso",
      "area of a texel", "colour: step, hat", "contour"};
  return names[int(s)];
}

const char* unit_of(stress_stage s) {
  switch (s) {
    case stress_stage::set_up:
      return "half units";
    case stress_stage::relative_w:
    case stress_stage::reciprocal:
      return "";
    case stress_stage::level_jacobian:
    case stress_stage::level_major:
    case stress_stage::log2:
    case stress_stage::footprint_level:
      return "levels";
    case stress_stage::area:
      return "units";
    case stress_stage::squares:
    case stress_stage::aniso:
    case stress_stage::step_hat:
    case stress_stage::contour:
    case stress_stage::colour:
    case stress_stage::write_out:
      return "LSB";
    case stress_stage::coverage:
    case stress_stage::in_front:
    case stress_stage::fan_once:
      return "pixels";
    case stress_stage::moved:
      return "bits";
    default:
      return "texels";
  }
}

uint64_t stress_row::failures() const {
  uint64_t sum = 0;
  for (const stress_record& r : stages) sum += r.failures;
  return sum;
}

double least_adverse_share(stress_family f) {
  switch (f) {
    case stress_family::any_plane:
    case stress_family::fans:
      return 0;
    default:
      return 0.25;
  }
}

double widest_bound(const profile& p, stress_stage s) {
  const auto unit = [](uint64_t bound) { return double(bound) / double(error_unit); };
  constexpr int e = max_extent_log2;
  switch (s) {
    case stress_stage::numerator:
      return unit(numerator_bound(p, e));
    case stress_stage::relative_w:
      return unit(relative_w_bound(p));
    case stress_stage::reciprocal:
      return unit(reciprocal_unit_bound(p));
    case stress_stage::affine:
      return unit(affine_bound(p, e));
    case stress_stage::series:
      return unit(series_bound(p, e));
    case stress_stage::divide:
      return unit(divide_bound(p, e));
    case stress_stage::nearest:
      return unit(coordinate_bound(p));
    case stress_stage::pixel:
      return unit(pixel_bound(p) + saturation_bound());
    case stress_stage::row:
    case stress_stage::column:
      return 2 * unit(coordinate_bound(p));
    case stress_stage::level_jacobian:
      return unit(level_bound(p));
    case stress_stage::level_major:
      return unit(major_level_bound(p));
    case stress_stage::log2:
      return unit(log2_bound());
    case stress_stage::snapped:
      return unit(snapped_bound(p, 0));
    case stress_stage::colour:
      return unit(colour_bound(p, true));
    case stress_stage::write_out:
      return p.colour_rounding == rounding::floor ? 1 : 0.5;
    case stress_stage::corner:
      return unit(corner_bound(p, e));
    case stress_stage::footprint_level:
      return unit(footprint_level_bound(p));
    case stress_stage::squares:
    case stress_stage::step_hat:
      return unit(mean_bound(p));
    case stress_stage::aniso:
      return unit(aniso_colour_bound(p, true));
    case stress_stage::area:
      return unit(area_bound(true));
    default:
      return 0;
  }
}

double undecided_share(const stress_report& r) {
  uint64_t undecided = 0;
  for (const stress_row& row : r.rows) undecided += row.undecided;
  const uint64_t judged = over_families(r, stress_stage::nearest).judged;
  return judged == 0 ? 0 : double(undecided) / double(judged);
}

// Found with every family (docs/ACCURACY.md): planes edge-on, magnified a thousand times or of few bits run along texel edges; the rest is
// what the bound leaves, more than a texel in compact's longest reach. Half as much again as long runs find: runs of 10^6 scatter by a quarter.
double most_undecided_share(const profile& p) {
  const double bound = double(coordinate_bound(p)) / double(error_unit);
  return bound <= 1.0 / 512 ? 0.07 : bound <= 1.0 / 256 ? 0.1 : bound <= 0.125 ? 0.13 : 0.4;
}

std::vector<std::string> shortfalls(const stress_report& r) {
  constexpr uint64_t enough_of_family = 2000, enough_of_run = 1'000'000;
  std::vector<std::string> missed;
  uint64_t evaluations = 0, judged[stress_stage_count] = {};
  bool every_family[stress_family_count] = {};
  for (const stress_row& row : r.rows) {
    every_family[int(row.family)] = true;
    evaluations += row.evaluations;
    for (int k = 0; k < stress_stage_count; ++k) judged[k] += row.stages[k].judged;
    if (row.evaluations < enough_of_family || row.adverse_share() >= least_adverse_share(row.family)) continue;
    char text[160];
    std::snprintf(text, sizeof text, "%s: %.1f %% of the evaluations are in adverse spans, not %.0f %%", name_of(row.family),
                  100 * row.adverse_share(), 100 * least_adverse_share(row.family));
    missed.emplace_back(text);
  }
  if (evaluations < enough_of_run || !std::all_of(every_family, every_family + stress_family_count, [](bool x) { return x; }))
    return missed;
  if (undecided_share(r) > most_undecided_share(r.prof)) {
    char text[160];
    std::snprintf(text, sizeof text, "nearest texel: %.1f %% of the samples are too near an edge to judge, not at most %.0f %%",
                  100 * undecided_share(r), 100 * most_undecided_share(r.prof));
    missed.emplace_back(text);
  }
  for (int k = 0; k < stress_stage_count; ++k)
    if (judged[k] == 0) missed.push_back(std::string(name_of(stress_stage(k))) + ": never judged");
  return missed;
}

stress_report run_stress(const profile& p, const stress_options& options) {
  const stress_bounds bounds(p);
  stress_report report;
  report.prof = p;
  std::vector<stress_family> families = options.families;
  if (families.empty())
    for (int k = 0; k < stress_family_count; ++k) families.push_back(stress_family(k));
  uint64_t weights = 0;
  for (const stress_family f : families) weights += weight_of(f);
  const auto begin = clock::now();
  for (size_t k = 0; k < families.size(); ++k) {
    const auto end = begin + std::chrono::duration_cast<clock::duration>(
                                 std::chrono::duration<double>(options.seconds * double(k + 1) / double(families.size())));
    const uint64_t share = uint64_t(double(options.evaluations) * double(weight_of(families[k])) / double(weights)) + 1;
    report.rows.push_back(run_family(bounds, families[k], options, share, end, report.complete));
  }
  return report;
}

stress_record over_families(const stress_report& r, stress_stage stage) {
  stress_record sum;
  for (const stress_row& row : r.rows) merge(sum, row.stages[int(stage)]);
  return sum;
}

stress_row run_case(const profile& p, stress_family family, uint64_t seed) {
  stress_row row{};
  row.family = family;
  judge_case(stress_bounds(p), seed, row);
  return row;
}

}  // namespace spantex::sim
