// SPDX-License-Identifier: Apache-2.0
// spantex sweep: drives a sweep. What its points are is sweep_spec's, what they are worth sim/sweep_judge's, what is kept of them sweep_record's, and what is drawn
// from that tools/report's.
#include <stdio.h>

#include <filesystem>
#include <memory>
#include <set>

#include <sim/file.hpp>
#include <sim/parallel.hpp>
#include <sim/sweep_judge.hpp>
#include "commands.hpp"
#include "options.hpp"
#include "progress.hpp"
#include "sweep_record.hpp"
#include "sweep_spec.hpp"

namespace spantex::tool {
namespace {

struct sweep_options {
  std::string spec, out, job = "1/1", pictures;
  std::vector<std::string> merge;
  int threads = 1;
  bool count = false, points = false;
};

// Every count-th point from the first-th on.
struct share_of_points { uint64_t first = 0, count = 1; };

share_of_points parse_job(const std::string& text) {
  const std::vector<std::string> parts = split(text, '/');
  const auto number = [&](const std::string& t) {
    if (t.empty() || t.size() > 7 || t.find_first_not_of("0123456789") != std::string::npos) throw sim::input_error("--job: '" + text + "' is not i/n");
    return uint64_t(std::stoull(t));
  };
  if (parts.size() != 2) throw sim::input_error("--job: '" + text + "' is not i/n");
  const uint64_t i = number(parts[0]), n = number(parts[1]);
  if (i < 1 || i > n) throw sim::input_error("--job: " + text + ": i must be 1 to n");
  return {i - 1, n};
}

void judge_points(const sweep_options& o, const sweep_spec& spec, share_of_points share) {
  sweep_record record(o.out, spec);
  const uint64_t points = share.first < spec.points() ? (spec.points() - share.first - 1) / share.count + 1 : 0;
  uint64_t missing = 0;
  for (uint64_t k = 0; k < points; ++k) missing += !record.has(share.first + k * share.count);
  sim::sweep_subjects subjects;
  {
    progress_bar bar("sweep", int(missing));
    sim::for_each_index(int(points), o.threads, [&](int k) {
      const uint64_t number = share.first + uint64_t(k) * share.count;
      if (record.has(number)) return;
      const numbered_point p = spec.at(number);
      record.append(number, sweep_row(spec, number, p, sim::judge(p.point, p.part->measures, subjects)));
      bar.advance(1);
    });
  }
  record.finish();
  printf("%s: %llu points, %llu of them judged now\n", o.out.c_str(), static_cast<unsigned long long>(points), static_cast<unsigned long long>(missing));
}

// Frame 0 of each point, and what it is judged by.
void draw_points(const sweep_options& o, const sweep_spec& spec, share_of_points share) {
  const auto file_of = [&](uint64_t number, const char* end) { return o.pictures + "/" + std::to_string(number) + end; };
  std::set<std::string> inputs{o.spec};
  for (uint64_t number = share.first; number < spec.points(); number += share.count) {
    const sim::sweep_subject subject = spec.at(number).point.subject;
    if (!sim::is_sweep_map(subject.map)) inputs.insert((std::filesystem::path(subject.map_folder) / subject.map).string());
  }
  for (const std::string& input : inputs)
    if (input.ends_with(".png") && std::filesystem::path(sim::place_of(input)).parent_path() == sim::place_of(o.pictures)) throw sim::input_error("--pictures: " + input + " lies in the folder, where a picture might replace it");
  make_folder(o.pictures);
  sim::sweep_subjects subjects;
  for (uint64_t number = share.first; number < spec.points(); number += share.count) {
    const sim::sweep_point p = spec.at(number).point;
    sim::output_file(file_of(number, ".png")).write(sim::encode_png(sim::picture_of(p, subjects)));
    sim::output_file(file_of(number, "-reference.png")).write(sim::encode_png(subjects.reference_of(p.subject, 0)->rounded));
  }
}

// What each point is, without judging it: the record's columns up to the measures.
void list_points(const sweep_spec& spec, share_of_points share) {
  printf("%s\n", point_heading().c_str());
  for (uint64_t number = share.first; number < spec.points(); number += share.count) printf("%s\n", point_columns(spec, number, spec.at(number)).c_str());
}

void run(const sweep_options& o) {
  const share_of_points share = parse_job(o.job);
  check_range("--threads", o.threads, 1, most_threads);
  const int tasks = int(o.count) + int(o.points) + int(!o.pictures.empty()) + int(!o.out.empty());
  if (tasks != 1) throw sim::input_error("sweep: one of --out, --pictures, --points and --count is needed");
  if (!o.merge.empty() && o.out.empty()) throw sim::input_error("--merge: needs --out");
  std::vector<std::string> inputs = o.merge;
  inputs.push_back(o.spec);
  check_outputs({{"--out", o.out}}, inputs);
  const sweep_spec spec = sweep_spec::load(o.spec);
  if (o.count) printf("%llu\n", static_cast<unsigned long long>(spec.points()));
  else if (o.points) list_points(spec, share);
  else if (!o.merge.empty()) merge_records(spec, o.merge, o.out);
  else if (!o.pictures.empty()) draw_points(o, spec, share);
  else judge_points(o, spec, share);
}

}  // namespace

void add_sweep_command(CLI::App& app) {
  const auto o = std::make_shared<sweep_options>();
  CLI::App& sub = *app.add_subcommand("sweep", "many points of word lengths, policies, filters and scenes, each judged: one row of CSV a point");
  sub.add_option("spec", o->spec, "what is varied: JSON, docs/SWEEPS.md")->required();
  sub.add_option("--out", o->out, "the record; a run that finds one of the same study goes on where it ended");
  sub.add_option("--job", o->job, "i/n: every n-th point from the i-th on, i from 1; for several machines, each with its own --out")->capture_default_str();
  sub.add_option("--threads", o->threads, "points judged side by side, 1.." + std::to_string(most_threads))->capture_default_str();
  sub.add_option("--merge", o->merge, "records of all jobs into --out; refused with gaps or points twice")->expected(1, 1 << 20);
  sub.add_option("--pictures", o->pictures, "folder: draw every point and its reference instead of judging it");
  sub.add_flag("--points", o->points, "print what each point is, as CSV, without judging it");
  sub.add_flag("--count", o->count, "print how many points there are");
  sub.callback([o] { run(*o); });
}

}  // namespace spantex::tool
