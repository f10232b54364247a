// SPDX-License-Identifier: Apache-2.0
// spantex bench: time against error, ours and others' side by side, and how cost grows. Everything on one thread.
#include <stdio.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "bench_counts.hpp"
#include "bench_frames.hpp"
#include "bench_growth.hpp"
#include "bench_machine.hpp"
#include "bench_measure.hpp"
#include "bench_scenes.hpp"
#include "commands.hpp"
#include "options.hpp"
#include "progress.hpp"

namespace spantex::tool {
namespace {

using json = nlohmann::ordered_json;

struct bench_options {
  std::vector<std::string> scenes, filters{"nearest", "bilinear", "three-point", "trilinear", "aniso"}, profiles{"all"}, kernels{"all"}, peers{"all"};
  std::string matrix, size = "640x480", out, model, map;
  bench_maps maps;
  double fov_degrees = 40;
  int rounds = 9, frames = 12;
  std::optional<int> samples;
  bool srgb = false, growth = false, counts = false, draws_only = false;
};

constexpr int most_rounds = 1000, most_frames = 9999;

std::vector<filter> filters_of(const std::vector<std::string>& names) {
  if (names == std::vector<std::string>{"all"}) return judged_filters();
  std::vector<filter> kinds;
  for (const std::string& name : names) kinds.push_back(judged_filter(name));
  return kinds;
}

bench_choice choice_of(const bench_options& o) {
  refuse_repeats("--filters", o.filters);
  refuse_repeats("--profiles", o.profiles);
  refuse_repeats("--kernels", o.kernels);
  check_range("--repeat", o.rounds, 1, most_rounds);
  bench_choice c{filters_of(o.filters), values_of(sim::profile_names, o.profiles, "profile"),
                 values_of(sim::kernel_names, o.kernels, "kernel"), o.rounds, o.samples};
  std::erase(c.kernels, kernels::choice::fastest);  // every kernel under its own name
  if (c.kernels.empty()) throw sim::input_error("--kernels: fastest is one of the others; name them, or all");
  if (o.samples) {
    if (std::count(c.filters.begin(), c.filters.end(), filter::aniso) == 0) throw sim::input_error("--samples: only filter aniso has them");
    check_changes({.max_samples = o.samples}, filter::aniso);
  }
  return c;
}

json to_json(const spread& s) { return {{"median", s.median}, {"low", s.low}, {"high", s.high}, {"least", s.least}, {"samples", s.samples}}; }

json to_json(const bench_row& r) {
  json j{{"scene", r.scene}, {"filter", r.filter}, {"drawer", r.drawer}};
  if (r.counts) {
    const draw_counters& w = *r.counts;
    j["profile"] = r.profile;
    j["kernel"] = r.kernel;
    j["words_per_pixel"] = double(w.words_loaded) / r.pixels;
    j["reads_per_pixel"] = double(w.words_read) / r.pixels;
    j["divides_per_pixel"] = double(w.divides) / r.pixels;
  } else {
    j["right_picture"] = r.right_picture;
    j["psnr_ours_db"] = finite_or_null(r.psnr_ours_db);
  }
  j["ns_per_pixel"] = to_json(r.ns_per_pixel);
  j["rms_error"] = r.error.rms;
  j["worst_error"] = r.error.worst;
  j["psnr_db"] = finite_or_null(r.error.psnr_db);
  return j;
}

json to_json(const bench_ratio& r) {
  return {{"scene", r.scene}, {"filter", r.filter}, {"peer", r.peer}, {"ours_ns", r.ours_ns}, {"peer_ns", r.peer_ns}, {"times", r.peer_ns / r.ours_ns},
          {"ours_psnr_db", finite_or_null(r.ours_psnr_db)}, {"peer_psnr_db", finite_or_null(r.peer_psnr_db)}};
}

json to_json(const growth_curve& c) {
  json points = json::array();
  for (const growth_point& p : c.points) points.push_back({{"amount", p.amount}, {"ns", to_json(p.ns)}, {"words", p.words}});
  return {{"of", c.of}, {"drawer", c.drawer}, {"time_slope", c.time_slope}, {"words_slope", c.words_slope}, {"points", points}};
}

json to_json(const bench_machine& m) {
  return {{"processor", m.processor}, {"processors", m.processors}, {"load", m.load}, {"system", m.system}, {"date", m.date},
          {"compiler", m.compiler}, {"flags", m.flags}, {"commit", m.commit}, {"threads", 1}};
}

json to_json(const peer_list& peers) {
  json all = json::array();
  for (const auto& p : peers) all.push_back({{"name", p->name()}, {"version", p->version()}});
  return all;
}

void print_heading(const bench_machine& m, const bench_options& o, const peer_list& peers) {
  printf("%s, %d processors, load %.1f before, %s, %s\n", m.processor.c_str(), m.processors, m.load, m.system.c_str(), m.date.c_str());
  printf("commit %s, %s\n", m.commit.c_str(), build_text(m).c_str());
  printf("one thread for everybody, %s pixels\n", o.size.c_str());
  if (o.srgb) printf("maps are sRGB: filtered in linear light, but for nearest\n");
  if (o.samples) printf("ours by aniso: at most %d samples a pixel\n", *o.samples);
  for (const auto& p : peers) printf("peer %s: %s\n", p->name(), p->version());
}

void print_table_head(const bench_options& o) {
  printf("at most %d turns each, medians, quartiles and least of ns a pixel\n", o.rounds);
  printf("\n%-8s %-12s %-9s %-8s %-14s %8s %17s %8s %7s %6s %8s %7s %7s\n", "scene", "filter", "drawer", "profile", "kernel", "ns", "quartiles", "least", "rms",
         "worst", "PSNR dB", "words", "ours dB");
}

void print_row(const bench_row& r) {
  char quartiles[40], words[16] = "-", ours[32] = "-";
  snprintf(quartiles, sizeof quartiles, "%.2f..%.2f", r.ns_per_pixel.low, r.ns_per_pixel.high);
  if (r.counts) snprintf(words, sizeof words, "%.2f", double(r.counts->words_loaded) / r.pixels);
  else snprintf(ours, sizeof ours, "%.2f%s", r.psnr_ours_db, r.right_picture ? "" : " WRONG");
  const auto dash = [](const std::string& s) { return s.empty() ? "-" : s.c_str(); };
  printf("%-8s %-12s %-9s %-8s %-14s %8.2f %17s %8.2f %7.3f %6.0f %8.2f %7s %7s\n", r.scene.c_str(), r.filter.c_str(), r.drawer.c_str(), dash(r.profile),
         dash(r.kernel), r.ns_per_pixel.median, quartiles, r.ns_per_pixel.least, r.error.rms, r.error.worst, r.error.psnr_db, words, ours);
}

void print_ratios(const std::vector<bench_ratio>& ratios) {
  if (ratios.empty()) return;
  printf("\nprofile default against the fastest peer whose picture is right\n%-8s %-12s %8s %8s %-9s %6s %9s %9s\n", "scene", "filter", "ours", "peer", "",
         "times", "ours dB", "peer dB");
  for (const bench_ratio& r : ratios)
    printf("%-8s %-12s %8.2f %8.2f %-9s %6.2f %9.2f %9.2f%s\n", r.scene.c_str(), r.filter.c_str(), r.ours_ns, r.peer_ns, r.peer.c_str(), r.peer_ns / r.ours_ns,
           r.ours_psnr_db, r.peer_psnr_db, r.ours_psnr_db < r.peer_psnr_db - 0.005 ? "  ours is worse" : "");
}

void print_growth(const std::vector<growth_curve>& curves) {
  printf("\nhow cost grows: slope of log cost over log amount\n%-26s %-36s %6s %6s\n", "with", "drawn", "time", "words");
  for (const growth_curve& c : curves) printf("%-26s %-36s %6.2f %6.2f\n", c.of.c_str(), c.drawer.c_str(), c.time_slope, c.words_slope);
}

std::vector<sim::scene> scenes_of(const bench_options& o) {
  bench_maps maps = o.maps;
  maps.colours = o.srgb ? colour_space::srgb : colour_space::coded;
  const sim::screen_size size = parse_size(o.size);
  const bool all = o.scenes.empty() ? o.matrix.empty() : o.scenes == std::vector<std::string>{"all"};
  const std::vector<std::string> names = all ? bench_scene_names() : o.scenes;
  refuse_repeats("--scenes", names);
  std::vector<sim::scene> scenes;
  for (const std::string& name : names) scenes.push_back(make_bench_scene(name, size, maps));
  if (!o.matrix.empty()) scenes.push_back(make_bench_plane(parse_matrix(o.matrix, size), size, maps));
  return scenes;
}

void measure(const bench_options& o) {
  const bench_choice choice = choice_of(o);
  check_outputs({{"--json", o.out}}, {o.maps.texture});
  const sim::output_file out = wanted_output(o.out);
  const peer_list peers = load_peers(o.peers);
  const std::vector<sim::scene> scenes = scenes_of(o);
  const bench_machine machine = this_machine();
  std::vector<bench_row> rows;
  std::vector<growth_curve> curves;
  {
    progress_bar bar("bench", int(scenes.size() * (choice.filters.size() + 1)) + (o.growth ? growth_curve_count : 0));
    const auto step = [&] { bar.advance(1); };
    for (const sim::scene& s : scenes)
      for (bench_row& row : measure_scene(s, choice, peers, step)) rows.push_back(std::move(row));
    if (o.growth) curves = measure_growth(o.rounds, step);
  }
  const std::vector<bench_ratio> ratios = ratios_of(rows);
  print_heading(machine, o, peers);
  print_table_head(o);
  for (const bench_row& r : rows) print_row(r);
  print_ratios(ratios);
  if (o.growth) print_growth(curves);
  if (!out.wanted()) return;
  json all{{"machine", to_json(machine)}, {"size", o.size}, {"srgb", o.srgb}, {"samples", o.samples.value_or(max_footprint_samples)}, {"peers", to_json(peers)}, {"rows", json::array()}, {"ratios", json::array()}, {"growth", json::array()}};
  for (const bench_row& r : rows) all["rows"].push_back(to_json(r));
  for (const bench_ratio& r : ratios) all["ratios"].push_back(to_json(r));
  for (const growth_curve& c : curves) all["growth"].push_back(to_json(c));
  out.write(all.dump(1) + "\n");
}

std::string rounded_to(int digits, double x) {
  char text[32];
  snprintf(text, sizeof text, "%.*f", digits, x);
  return text;
}

void print_frames(const std::vector<frames_row>& rows) {
  printf("\n%-12s %-9s %-14s %9s %9s %17s %9s %8s %7s\n", "filter", "drawer", "kernel", "set-up ms", "all ms", "quartiles", "most", "PSNR dB", "ours dB");
  for (const frames_row& r : rows) {
    const bool ours = !r.kernel.empty();
    printf("%-12s %-9s %-14s %9s %9.2f %17s %9.2f %8.2f %7s\n", r.filter.c_str(), r.drawer.c_str(), ours ? r.kernel.c_str() : "-", ours ? rounded_to(2, r.set_up_ms.median).c_str() : "-",
           r.all_ms.median, (rounded_to(2, r.all_ms.low) + ".." + rounded_to(2, r.all_ms.high)).c_str(), r.most_ms, r.psnr_db, ours ? "-" : (rounded_to(2, r.psnr_ours_db) + (r.right_picture ? "" : " WRONG")).c_str());
  }
}

json to_json(const frames_row& r) {
  json j{{"filter", r.filter}, {"drawer", r.drawer}};
  if (!r.kernel.empty()) {
    j["kernel"] = r.kernel;
    j["set_up_ms"] = to_json(r.set_up_ms);
  } else {
    j["psnr_ours_db"] = finite_or_null(r.psnr_ours_db);
    j["right_picture"] = r.right_picture;
  }
  j["all_ms"] = to_json(r.all_ms);
  j["most_ms"] = r.most_ms;
  j["psnr_db"] = finite_or_null(r.psnr_db);
  return j;
}

// Frames of a model or level, with set-up.
void measure_frames_of_model(const bench_options& o) {
  const bench_choice choice = choice_of(o);
  check_range("--frames", o.frames, 1, most_frames);
  subject_options what;
  what.subject = o.model;
  what.map = o.map;
  what.size = o.size;
  what.fov_degrees = o.fov_degrees;
  what.order = "nearest";
  const sim::output_file out = wanted_output(o.out);
  const subject_options::loaded subject(what, drawing_options());
  if (!subject.is_model()) throw sim::input_error("--model: '" + o.model + "' has its own view; only models and levels are drawn frame by frame");
  check_outputs({{"--json", o.out}}, subject.files());
  const peer_list peers = load_peers(o.peers);
  const bench_machine machine = this_machine();
  std::vector<frames_row> rows;
  {
    progress_bar bar("bench", o.frames * int(choice.filters.size()));
    rows = measure_frames(subject, {choice.filters, choice.kernels, choice.rounds, o.frames}, peers, [&] { bar.advance(1); });
  }
  print_heading(machine, o, peers);
  printf("%s: %d frames, medians, quartiles and most of ms a frame, of %d turns each, a turn the middle one of three; from faces in the world to pixels in memory\n", subject.world().name.c_str(), o.frames, o.rounds);
  print_frames(rows);
  if (!out.wanted()) return;
  json all{{"machine", to_json(machine)}, {"size", o.size}, {"model", o.model}, {"map", o.map}, {"frames", o.frames}, {"peers", to_json(peers)}, {"rows", json::array()}};
  for (const frames_row& r : rows) all["rows"].push_back(to_json(r));
  out.write(all.dump(1) + "\n");
}

void run(const bench_options& o) {
  if (o.counts) print_counts(o.draws_only);
  else if (!o.model.empty()) measure_frames_of_model(o);
  else measure(o);
}

}  // namespace

void add_bench_command(CLI::App& app) {
  const auto o = std::make_shared<bench_options>();
  CLI::App& sub = *app.add_subcommand("bench", "time against error: scenes, filters, profiles, kernels, and other programs' renderers side by side");
  CLI::Option* const of_planes[] = {
      sub.add_option("--scenes", o->scenes, joined(bench_scene_names()) + "; separated by commas, or all (which it is without --matrix)")->delimiter(','),
      sub.add_option("--profiles", o->profiles, list_of(sim::profile_names) + "; or all")->delimiter(',')->capture_default_str(),
      sub.add_option("--matrix", o->matrix, "a plane of your own, as of `spantex plane`, named matrix; after the scenes of --scenes, where they are named"),
      sub.add_option("--texture", o->maps.texture, "map of the planes, a picture, instead of a built-in one"),
      sub.add_option("--models", o->maps.models, "folder of assimp's test models")->capture_default_str(),
      sub.add_option("--samples", o->samples, "ours, filter aniso: at most so many samples along a footprint, 1..16" + unless_given(std::to_string(profiles::standard.max_samples))),
      sub.add_flag("--growth", o->growth, "also how cost grows with pixels, polygons, map size and overdraw"),
      sub.add_flag("--srgb", o->srgb, "maps are sRGB: levels and filters in linear light; peers that know it")->excludes("--growth"),
  };
  CLI::Option* const of_both[] = {
      sub.add_option("--filters", o->filters, list_of(sim::filter_names) + "; or all; not contour")->delimiter(',')->capture_default_str(),
      sub.add_option("--kernels", o->kernels, "scalar and the host's kernels, or all; one that cannot draw a scene or filter has no row there")->delimiter(',')->capture_default_str(),
      sub.add_option("--peers", o->peers, "files of the folder peers beside this command, or all, or none")->delimiter(',')->capture_default_str(),
      sub.add_option("--size", o->size, "picture size, WxH")->capture_default_str(),
      sub.add_option("--repeat", o->rounds, "turns of each, 1.." + std::to_string(most_rounds) + "; of slow ones (20 ms a picture) three at most, but with --model")->capture_default_str(),
      sub.add_option("--json", o->out, "everything measured, as JSON"),
  };
  CLI::Option* const model = sub.add_option("--model", o->model, "instead: frames of a model or level, drawn nearest first, with its set-up, profile default; peers that draw triangles");
  CLI::Option* const of_model[] = {
      model,
      sub.add_option("--map", o->map, "which level of a .pk3 archive")->needs(model),
      sub.add_option("--fov", o->fov_degrees, "angle of view of the picture's height, 10..150 degrees")->capture_default_str()->needs(model),
      sub.add_option("--frames", o->frames, "of a walk through the level, or of the model turned once around, 1.." + std::to_string(most_frames))->capture_default_str()->needs(model),
  };
  for (CLI::Option* const other : of_planes) model->excludes(other);
  CLI::Option* const counts = sub.add_flag("--counts", o->counts, "no clock: counts of work on fixed scenes, for baselines; nothing else is chosen then");
  for (CLI::Option* const other : of_planes) counts->excludes(other);
  for (CLI::Option* const other : of_both) counts->excludes(other);
  for (CLI::Option* const other : of_model) counts->excludes(other);
  sub.add_flag("--draws-only", o->draws_only, "with --counts: each row drawn once, for a profiler")->needs(counts);
  sub.footer("rms, worst: colour errors of 0..255 against the 16x16 supersampled reference. words: 64 bits, loaded into local memory, a pixel. ours dB: a peer's picture "
             "against ours in profile default; WRONG if it is no nearer the reference than its mean colour.");
  sub.callback([o] { run(*o); });
}

}  // namespace spantex::tool
