// SPDX-License-Identifier: Apache-2.0
// spantex stress: the numerics against exact arithmetic, random and adversarial (sim/stress.hpp). Prints the worst case found per family
// against the bound, with the command that reproduces it; exit code 1 if a bound was broken.
#include <stdio.h>

#include <array>
#include <memory>
#include <nlohmann/json.hpp>

#include <sim/stress.hpp>
#include "commands.hpp"
#include "options.hpp"

namespace spantex::tool {
namespace {

struct stress_arguments {
  std::string profile = "exact", family, case_seed, json;
  uint64_t evaluations = 10'000'000, seed = 1;
  double seconds = 0;
  int threads = 1;
};

profile profile_of(const std::string& name) {
  switch (value_of(sim::profile_names, name, "profile")) {
    case sim::profile_choice::seed: return profiles::seed;
    case sim::profile_choice::compact: return profiles::compact;
    case sim::profile_choice::standard: return profiles::standard;
    case sim::profile_choice::exact: break;
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

uint64_t case_number(const std::string& text) {
  size_t used = 0;
  uint64_t number = 0;
  try {
    number = std::stoull(text, &used);
  } catch (const std::exception&) {
  }
  if (used == 0 || used != text.size()) throw sim::input_error("--case '" + text + "': not a whole number");
  return number;
}

std::string fraction(double error) {
  char text[32];
  if (error == 0) return "0";
  snprintf(text, sizeof text, error < 0.5 ? "1/%.0f" : "%.2f", error < 0.5 ? 1 / error : error);
  return text;
}

nlohmann::json to_json(const stress_arguments& a, const sim::stress_report& r) {
  nlohmann::json rows = nlohmann::json::array();
  const auto worst = [](const sim::stress_worst& w) { return nlohmann::json{{"error", w.error}, {"case", w.case_seed}}; };
  for (const sim::stress_row& row : r.rows)
    rows.push_back({{"family", sim::name_of(row.family)},
                    {"cases", row.cases},
                    {"coordinate_evaluations", row.evaluations},
                    {"snapped_positions", row.positions},
                    {"level_evaluations", row.levels},
                    {"polygon_pixels", row.polygon_pixels},
                    {"worst_coordinate", worst(row.coordinate)},
                    {"worst_position_share_of_bound", worst(row.position)},
                    {"worst_level", worst(row.level)},
                    {"failures", row.failures}});
  return {{"profile", a.profile}, {"seed", a.seed}, {"complete", r.complete}, {"coordinate_bound_texels", r.coordinate_bound},
          {"level_bound", r.level_bound}, {"families", rows}};
}

void print_table(const stress_arguments& a, const sim::stress_report& r) {
  printf("profile %s, seed %llu: coordinate within %s texel, level within %s\n", a.profile.c_str(), static_cast<unsigned long long>(a.seed),
         fraction(r.coordinate_bound).c_str(), fraction(r.level_bound).c_str());
  printf("%-16s %9s %12s %10s %10s %10s %10s %9s  %s\n", "family", "cases", "evaluations", "worst u,v", "of bound", "snapped", "level",
         "failures", "case of the worst u,v");
  for (const sim::stress_row& row : r.rows)
    printf("%-16s %9llu %12llu %10s %8.1f %% %8.1f %% %10s %9llu  %llu\n", sim::name_of(row.family),
           static_cast<unsigned long long>(row.cases), static_cast<unsigned long long>(row.evaluations + row.polygon_pixels),
           fraction(row.coordinate.error).c_str(), 100 * row.share.error, 100 * row.position.error, fraction(row.level.error).c_str(),
           static_cast<unsigned long long>(row.failures), static_cast<unsigned long long>(row.coordinate.case_seed));
  printf("of bound: the worst share of the bound for the reach of its span; snapped: of positions on levels of maps 1..4096\n");
  if (!r.complete) printf("stopped by --seconds before all evaluations were made\n");
}

int run(const stress_arguments& a) {
  const profile p = profile_of(a.profile);
  if (!a.case_seed.empty()) {
    if (a.family.empty()) throw sim::input_error("--case needs --family");
    const std::string text = sim::describe_case(p, family_of(a.family), case_number(a.case_seed));
    fputs(text.c_str(), stdout);
    return text.find("FAILS") == std::string::npos ? 0 : 1;
  }
  if (a.threads < 1 || a.threads > 256) throw sim::input_error("--threads " + std::to_string(a.threads) + ": 1 to 256");
  const sim::output_file json = a.json.empty() ? sim::output_file() : sim::output_file(a.json);
  sim::stress_options o{a.evaluations, a.seed, a.seconds, a.threads, {}};
  if (!a.family.empty()) o.families = {family_of(a.family)};
  const sim::stress_report r = sim::run_stress(p, o);
  print_table(a, r);
  if (json.wanted()) json.write(to_json(a, r).dump(1) + "\n");
  int failed = 0;
  for (const sim::stress_row& row : r.rows) {
    if (row.failures == 0) continue;
    failed = 1;
    printf("reproduce: spantex stress --profile %s --family %s --case %llu\n", a.profile.c_str(), sim::name_of(row.family),
           static_cast<unsigned long long>(row.first_failure));
    fputs(sim::describe_case(p, row.family, row.first_failure).c_str(), stdout);
  }
  return failed;
}

}  // namespace

void add_stress_command(CLI::App& app) {
  const auto a = std::make_shared<stress_arguments>();
  CLI::App& sub =
      *app.add_subcommand("stress", "texture coordinates, levels and coverage against exact arithmetic; exit code 1 if a bound breaks");
  sub.add_option("--profile", a->profile, "seed, compact, default, exact")->capture_default_str();
  sub.add_option("--evaluations", a->evaluations, "texture coordinates to evaluate")->capture_default_str();
  sub.add_option("--seed", a->seed, "of the whole run")->capture_default_str();
  sub.add_option("--seconds", a->seconds, "stop after this time (0: no limit)")->capture_default_str();
  sub.add_option("--threads", a->threads, "1 to 256; the cases do not depend on it")->capture_default_str();
  sub.add_option("--family", a->family, "one family of cases only");
  sub.add_option("--case", a->case_seed, "one case, described, and shrunk if it fails; needs --family");
  sub.add_option("--json", a->json, "the table as JSON");
  sub.callback([a] {
    if (const int code = run(*a); code != 0) throw CLI::RuntimeError(code);
  });
}

}  // namespace spantex::tool
