// SPDX-License-Identifier: Apache-2.0
// spantex stress: the numerics against exact arithmetic, random and adversarial (sim/stress.hpp). Prints the worst case found per stage
// against its bound, with what reproduces it; exit code 1 if a bound was broken or the run missed what it is for.
#include <stdio.h>

#include <charconv>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include <sim/stress.hpp>
#include "commands.hpp"
#include "options.hpp"

namespace spantex::tool {
namespace {

constexpr uint64_t most_evaluations = 1'000'000'000'000'000;
constexpr double most_seconds = 1e9;  // thirty years; clocks count nanoseconds in 63 bits

struct stress_arguments {
  std::string profile = "exact", family, case_seed, json, evaluations = "10000000", seed = "1", seconds = "0";
  int threads = 1;
};

profile profile_of(const std::string& name) {
  switch (value_of(sim::profile_names, name, "profile")) {
    case sim::profile_choice::seed:
      return profiles::seed;
    case sim::profile_choice::compact:
      return profiles::compact;
    case sim::profile_choice::standard:
      return profiles::standard;
    case sim::profile_choice::exact:
      break;
  }
  return profiles::exact;
}

sim::stress_family family_of(const std::string& name) {
  std::string known;
  for (int k = 0; k < sim::stress_family_count; ++k) {
    const auto f = sim::stress_family(k);
    if (name == sim::name_of(f)) return f;
    known += (k == 0 ? "" : ", ") + std::string(sim::name_of(f));
  }
  throw sim::input_error("unknown family '" + name + "' (known: " + known + ")");
}

uint64_t whole_number(const char* option, const std::string& text) {
  uint64_t number = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || rest != end) throw sim::input_error(std::string(option) + ": '" + text + "' is not a whole number from 0 to 2^64 - 1");
  return number;
}

// Small errors read best as 1/n, very small ones as powers of two.
std::string fraction(double error) {
  char text[32];
  if (error == 0) return "0";
  if (error < 1e-5)
    snprintf(text, sizeof text, "2^%.2f", std::log2(error));
  else
    snprintf(text, sizeof text, error < 0.1 ? "1/%.0f" : "%.6g", error < 0.1 ? 1 / error : error);
  return text;
}

unsigned long long number(uint64_t x) { return x; }

nlohmann::json to_json(const sim::stress_worst& w) {
  return {{"error", w.error}, {"bound", w.bound}, {"family", sim::name_of(w.family)}, {"case", w.case_seed}, {"span", {w.span_x, w.span_y}},
          {"pixel", w.pixel}};
}

nlohmann::json to_json(const stress_arguments& a, const sim::stress_report& r) {
  nlohmann::json families = nlohmann::json::array();
  for (const sim::stress_row& row : r.rows) {
    nlohmann::json stages;
    for (int k = 0; k < sim::stress_stage_count; ++k) {
      const sim::stress_record& s = row.stages[k];
      if (s.judged == 0) continue;
      stages[sim::name_of(sim::stress_stage(k))] = {
          {"judged", s.judged}, {"failures", s.failures}, {"worst_share", to_json(s.worst)}, {"largest", to_json(s.largest)}};
    }
    families.push_back({{"family", sim::name_of(row.family)},
                        {"cases", row.cases},
                        {"coordinate_evaluations", row.evaluations},
                        {"adverse_evaluations", row.adverse},
                        {"polygons", row.polygons},
                        {"polygons_refused", row.refused},
                        {"failed_cases", row.failed_cases},
                        {"stages", stages}});
  }
  return {{"profile", a.profile}, {"seed", whole_number("--seed", a.seed)}, {"complete", r.complete}, {"families", families}, {"shortfalls", sim::shortfalls(r)},
          {"nearest_undecided", sim::undecided_share(r)}};
}

void print_stages(const profile& p, const sim::stress_report& r) {
  printf("%-18s %11s  %-10s %11s %11s %8s %9s  %s\n", "stage", "judged", "unit", "largest", "bound", "worst", "failures",
         "reproduce the worst share of its bound");
  for (int k = 0; k < sim::stress_stage_count; ++k) {
    const auto stage = sim::stress_stage(k);
    const sim::stress_record s = sim::over_families(r, stage);
    if (s.judged == 0) continue;
    const double widest = sim::widest_bound(p, stage);
    const std::string bound = stage == sim::stress_stage::set_up || (widest == 0 && s.worst.bound != 0) ? "place" : fraction(widest);
    printf("%-18s %11llu  %-10s %11s %11s %6.1f %% %9llu  --family %s --case %llu\n", sim::name_of(stage), number(s.judged),
           sim::unit_of(stage), fraction(s.largest.error).c_str(), bound.c_str(), 100 * s.worst.share(), number(s.failures),
           sim::name_of(s.worst.family), number(s.worst.case_seed));
  }
}

void print_families(const sim::stress_report& r) {
  printf("%-16s %9s %12s %9s %9s %9s %10s %10s %9s\n", "family", "cases", "evaluations", "adverse", "at least", "undecided", "polygons",
         "refused", "failures");
  uint64_t sum = 0;
  for (const sim::stress_row& row : r.rows) {
    printf("%-16s %9llu %12llu %7.1f %% %7.0f %% %7.2f %% %10llu %10llu %9llu\n", sim::name_of(row.family), number(row.cases),
           number(row.evaluations), 100 * row.adverse_share(), 100 * sim::least_adverse_share(row.family), 100 * row.undecided_share(),
           number(row.polygons), number(row.refused), number(row.failures()));
    sum += row.evaluations;
  }
  printf("%llu coordinates\n", number(sum));
}

void print_table(const stress_arguments& a, const profile& p, const sim::stress_report& r) {
  printf("profile %s, seed %s; one case again: spantex stress --profile %s --family F --case N\n", a.profile.c_str(), a.seed.c_str(),
         a.profile.c_str());
  print_stages(p, r);
  printf("bound: for the longest reach; worst: the largest part of the bound of its own place that an error is\n");
  printf("nearest texel: %.2f %% of the samples are undecided: within the bound of an edge, where either texel passes (at most %.0f %%)\n\n",
         100 * sim::undecided_share(r), 100 * sim::most_undecided_share(p));
  print_families(r);
  printf("adverse: in spans that have what the family is named for; undecided: point samples; refused: polygons that cover no pixel centre\n");
  if (!r.complete) printf("INCOMPLETE: stopped by --seconds %s: not all of --evaluations %s were made\n", a.seconds.c_str(), a.evaluations.c_str());
}

int run(const stress_arguments& a) {
  const profile p = profile_of(a.profile);
  if (!a.case_seed.empty()) {
    const std::string text = sim::describe_case(p, family_of(a.family), whole_number("--case", a.case_seed));
    fputs(text.c_str(), stdout);
    return text.find("FAILS") == std::string::npos ? 0 : 1;
  }
  check_range("--threads", a.threads, 1, most_threads);
  const uint64_t evaluations = whole_number("--evaluations", a.evaluations), seed = whole_number("--seed", a.seed);
  const double seconds = parse_number(a.seconds, "--seconds");
  if (evaluations == 0 || evaluations > most_evaluations) throw sim::input_error("--evaluations " + a.evaluations + ": 1 to 10^15");
  if (!(seconds >= 0 && seconds <= most_seconds)) throw sim::input_error("--seconds " + a.seconds + ": 0 to 10^9");
  const sim::output_file json = wanted_output(a.json);
  sim::stress_options o{evaluations, seed, seconds, a.threads, {}};
  if (!a.family.empty()) o.families = {family_of(a.family)};
  const sim::stress_report r = sim::run_stress(p, o);
  print_table(a, p, r);
  if (json.wanted()) json.write(to_json(a, r).dump(1) + "\n");
  int failed = 0;
  for (const std::string& missed : sim::shortfalls(r)) {
    failed = 1;
    printf("MISSED %s\n", missed.c_str());
  }
  for (const sim::stress_row& row : r.rows) {
    if (row.failed_cases == 0) continue;
    failed = 1;
    printf("reproduce: spantex stress --profile %s --family %s --case %llu\n", a.profile.c_str(), sim::name_of(row.family),
           number(row.first_failure));
    fputs(sim::describe_case(p, row.family, row.first_failure).c_str(), stdout);
  }
  return failed;
}

}  // namespace

void add_stress_command(CLI::App& app) {
  const auto a = std::make_shared<stress_arguments>();
  CLI::App& sub = *app.add_subcommand("stress", "every stage of the numerics against exact arithmetic; exit code 1 if a bound breaks");
  sub.add_option("--profile", a->profile, "seed, compact, default, exact")->capture_default_str();
  CLI::Option* const of_a_run[] = {
      sub.add_option("--evaluations", a->evaluations, "texture coordinates to evaluate, 1 to 10^15")->capture_default_str(),
      sub.add_option("--seed", a->seed, "of the whole run")->capture_default_str(),
      sub.add_option("--seconds", a->seconds, "stop after this time, to 10^9, and say that the run is incomplete (0: no limit)")->capture_default_str(),
      sub.add_option("--threads", a->threads, "threads, 1.." + std::to_string(most_threads) + "; the cases do not depend on it")->capture_default_str(),
      sub.add_option("--json", a->json, "the table as JSON")};
  CLI::Option* const family = sub.add_option("--family", a->family, "one family of cases only");
  CLI::Option* const one_case = sub.add_option("--case", a->case_seed, "one case, described, and shrunk if it fails")->needs(family);
  for (CLI::Option* const o : of_a_run) one_case->excludes(o);
  sub.callback([a] {
    if (const int code = run(*a); code != 0) throw CLI::RuntimeError(code);
  });
}

}  // namespace spantex::tool
