// SPDX-License-Identifier: Apache-2.0
// spantex compare: how far two pictures are apart, or one table of methods on scenes, each against the reference.
#include <stdio.h>
#include <stdlib.h>

#include <filesystem>
#include <memory>
#include <utility>

#include <nlohmann/json.hpp>

#include <sim/quality.hpp>
#include "commands.hpp"
#include "methods.hpp"
#include "options.hpp"
#include "progress.hpp"

namespace spantex::tool {
namespace {

struct compare_options {
  std::vector<std::string> pictures, filters, profiles{"default"};
  std::string diff, scenes, out, json;
  drawing_options drawing;
  subject_options subject;
};

std::string size_text(const sim::image& p) { return std::to_string(p.width_px) + "x" + std::to_string(p.height_px); }

void compare_pictures(const compare_options& o) {
  check_outputs({{"--diff", o.diff}}, o.pictures);
  const sim::output_file diff = wanted_output(o.diff);
  const sim::image a = sim::load_image(o.pictures[0]), b = sim::load_image(o.pictures[1]);
  if (a.width_px != b.width_px || a.height_px != b.height_px)
    throw sim::input_error(o.pictures[1] + ": picture is " + size_text(b) + ", but " + o.pictures[0] + " is " + size_text(a));
  const sim::difference d = sim::compare(a, b);
  if (diff.wanted()) diff.write(sim::encode_png(sim::difference_picture(a, b)));
  printf("PSNR              %.2f dB\n", sim::psnr_db(a, b));
  printf("SSIM              %.6f\n", sim::ssim(a, b));
  printf("worst error       %d\n", d.worst);
  printf("differing pixels  %llu of %zu\n", static_cast<unsigned long long>(d.differing_px), a.pixels.size());
}

nlohmann::ordered_json to_json(const judged& j) {
  return {{"scene", j.scene},
          {"method", label_of(j.how)},
          {"profile", std::string(sim::name_of(sim::profile_names, j.how.profile))},
          {"psnr_db", finite_or_null(j.psnr_db)},
          {"ssim", finite_or_null(j.ssim)},
          {"worst_error", finite_or_null(j.worst)},
          {"ns_per_pixel", j.ns_per_pixel},
          {"kernel", std::string(j.kernel)},
          {"texel_reads_per_pixel", j.texel_reads},
          {"words_per_pixel", j.words},
          {"stalls_per_pixel", j.stalls},
          {"pixels", j.machine.pixels},
          {"cycles", j.machine.total_cycles},
          {"stalls", j.machine.stall_cycles}};
}

// The filters in screen space, and RD16's object space with trilinear samples.
constexpr const char* object_space = "object-space";

int parse_count(const std::string& text, const std::string& what) {
  if (text.empty() || text.size() > 3 || text.find_first_not_of("0123456789") != std::string::npos) throw sim::input_error(what + ": '" + text + "' is not a number");
  return atoi(text.c_str());
}

// A filter with changes behind it: "trilinear:level=minor", "aniso:samples=4:slack=8".
method method_of(const std::string& text) {
  if (text == object_space) return {filter::trilinear, {}, sim::sampling_space::object};
  const std::vector<std::string> parts = split(text, ':');
  method m{judged_filter(parts[0]), {}};
  for (size_t k = 1; k < parts.size(); ++k) {
    const size_t equals = parts[k].find('=');
    const std::string name = parts[k].substr(0, equals), value = equals == std::string::npos ? "" : parts[k].substr(equals + 1);
    if (name == "level") m.changes.level = value_of(sim::level_names, value, "level of detail");
    else if (name == "samples") m.changes.max_samples = parse_count(value, text);
    else if (name == "spacing") m.changes.sample_spacing = parse_count(value, text);
    else if (name == "slack") m.changes.sample_slack = parse_count(value, text);
    else if (name == "bias") m.changes.sample_bias = value.starts_with('-') ? -parse_count(value.substr(1), text) : parse_count(value, text);
    else throw sim::input_error("--filters: '" + text + "': unknown '" + name + "' (known: level, samples, spacing, slack, bias)");
  }
  check_changes(m.changes, m.kind);
  return m;
}

std::vector<method> methods_of(const std::vector<std::string>& names) {
  std::vector<method> methods;
  if (names.size() == 1 && names[0] == "all") {
    for (const filter kind : judged_filters()) methods.push_back({kind, {}});
    methods.push_back(method_of(object_space));
  } else {
    for (const std::string& n : names) methods.push_back(method_of(n));
  }
  std::vector<std::string> labels;
  for (const method& m : methods) labels.push_back(label_of(m));
  refuse_repeats("--filters", std::move(labels));
  return methods;
}

void compare_methods(const compare_options& o) {
  o.drawing.resolve();
  refuse_repeats("--profiles", o.profiles);
  std::vector<method> methods;
  for (const sim::profile_choice profile : values_of(sim::profile_names, o.profiles, "profile"))
    for (method m : methods_of(o.filters)) {
      m.profile = profile;
      methods.push_back(m);
    }
  const sim::output_file json = wanted_output(o.json);
  const std::vector<std::string> subjects = split(o.scenes, ',');
  std::vector<std::string> names;  // in the table and of pictures
  for (const std::string& s : subjects) names.push_back(sim::is_scene_name(s) ? s : std::filesystem::path(s).stem().string());
  refuse_repeats("--scenes", names);
  std::vector<sim::scene> scenes;
  std::vector<std::string> inputs;
  for (size_t k = 0; k < subjects.size(); ++k) {
    subject_options subject = o.subject;
    subject.subject = subjects[k];
    const subject_options::loaded loaded(subject, o.drawing);
    inputs.insert(inputs.end(), loaded.files().begin(), loaded.files().end());
    scenes.push_back(loaded.at(0));
    scenes.back().name = names[k];
  }
  const auto path_of = [&](const sim::scene& s, const std::string& what) { return o.out + "/" + s.name + "-" + what + ".png"; };
  std::vector<named_output> outputs{{"--out", o.out}, {"--json", o.json}};
  for (const sim::scene& s : scenes) {
    if (o.out.empty()) break;
    outputs.push_back({"--out", path_of(s, "reference")});
    for (const method& m : methods) outputs.push_back({"--out", path_of(s, file_name_of(m))});
  }
  check_outputs(outputs, inputs);
  if (!o.out.empty()) make_folder(o.out);
  const auto save = [&](const sim::scene& s, const std::string& what, const sim::image& picture) {
    if (!o.out.empty()) sim::output_file(path_of(s, what)).write(sim::encode_png(picture));
  };
  progress_bar bar("compare", int(scenes.size() * (methods.size() + 1)));
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  printf("%s\n", table_heading().c_str());
  for (const sim::scene& s : scenes) {
    const bench on(s, o.drawing.resolve().background, o.drawing.repeat);
    save(s, "reference", on.reference_picture());
    bar.advance(1);
    for (const method& m : methods) {
      const judged j = on.judge(m);
      printf("%s\n", table_line(j).c_str());
      save(s, file_name_of(m), j.picture);
      all.push_back(to_json(j));
      bar.advance(1);
    }
  }
  if (json.wanted()) json.write(all.dump(2) + "\n");
}

void run(const compare_options& o) {
  if (!o.scenes.empty()) {
    if (!o.pictures.empty()) throw sim::input_error("--scenes: compares methods; pictures '" + joined(o.pictures) + "' have no place there");
    compare_methods(o);
  } else {
    if (o.pictures.size() != 2) throw sim::input_error("compare: two pictures are needed, or --scenes");
    compare_pictures(o);
  }
}

}  // namespace

void add_compare_command(CLI::App& app) {
  const auto o = std::make_shared<compare_options>();
  CLI::App& sub = *app.add_subcommand("compare", "two pictures: PSNR, SSIM, worst error, differing pixels; or methods on scenes, one table");
  sub.add_option("pictures", o->pictures, "two pictures of the same size")->expected(0, 2)->type_name("A B");
  CLI::Option* const diff = sub.add_option("--diff", o->diff, "of two pictures: absolute differences, PNG");
  CLI::Option* const scenes =
      sub.add_option("--scenes", o->scenes, "scenes or models, separated by commas: every filter and profile on each of them")->excludes(diff);
  sub.add_option("--filters", o->filters, list_of(sim::filter_names) + ", object-space (RD16); with level=, samples=, spacing=, slack=, bias= behind a colon (trilinear:level=minor, aniso:slack=8); separated by commas, or all; not contour")->delimiter(',')->needs(scenes)
      ->default_val(std::vector<std::string>{"all"});
  sub.add_option("--profiles", o->profiles, list_of(sim::profile_names) + "; or all")->delimiter(',')->needs(scenes)->capture_default_str();
  sub.add_option("--texture", o->subject.texture, "map of planes")->needs(scenes);
  sub.add_option("--size", o->subject.size, "picture size, WxH")->needs(scenes)->capture_default_str();
  sub.add_option("--prefilter", o->drawing.prefilter, list_of(sim::prefilter_names))->needs(scenes)->capture_default_str();
  sub.add_option("--repeat", o->drawing.repeat, "time so often, 1.." + std::to_string(most_repeats) + "; the median counts")->needs(scenes)->capture_default_str();
  sub.add_option("--out", o->out, "folder for the pictures and the references; made if missing")->needs(scenes);
  sub.add_option("--json", o->json, "the table as JSON")->needs(scenes);
  sub.footer("Table: against the 16x16 supersampled reference; texels and words (64 bits, into local memory) read per pixel; stalls: cycles per pixel in which the "
             "simulated pipeline waits for loading or for pixels that the host writes itself; ns per pixel of engine direct on this machine, one thread.");
  sub.callback([o] { run(*o); });
}

}  // namespace spantex::tool
