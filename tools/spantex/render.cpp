// SPDX-License-Identifier: Apache-2.0
// spantex render: a model or a scene by name, one picture or a turntable of them.
#include <stdio.h>

#include <memory>
#include <optional>
#include <vector>

#include <sim/quality.hpp>
#include <sim/reference.hpp>
#include "commands.hpp"
#include "options.hpp"

namespace spantex::tool {
namespace {

constexpr int most_frames = 9999;

struct render_options {
  drawing_options drawing;
  subject_options subject;
  std::string out, stats, reference;
  std::optional<int> frames;
  bool psnr = false;
};

// O-%04d.png with its one %d or %0Nd replaced by the frame's number.
std::string frame_name(const std::string& pattern, int frame) {
  const size_t percent = pattern.find('%'), letter = pattern.find('d', percent == std::string::npos ? 0 : percent);
  const auto bad = [&] { return sim::input_error("--out: '" + pattern + "' needs one %d or %04d for the frame's number"); };
  if (percent == std::string::npos || letter == std::string::npos || pattern.find('%', percent + 1) != std::string::npos) throw bad();
  const std::string digits = pattern.substr(percent + 1, letter - percent - 1);
  if (!digits.empty() && (digits.size() != 2 || digits[0] != '0' || digits[1] < '1' || digits[1] > '9')) throw bad();
  const size_t width = digits.empty() ? 1 : size_t(digits[1] - '0');
  std::string number = std::to_string(frame);
  if (number.size() < width) number.insert(0, width - number.size(), '0');
  return pattern.substr(0, percent) + number + pattern.substr(letter + 1);
}

std::vector<sim::output_file> outputs(const render_options& o) {
  check_outputs_differ({{"--out", o.out}, {"--stats", o.stats}, {"--reference", o.reference}});
  if (!o.frames) return {sim::output_file(o.out)};
  if (*o.frames < 1 || *o.frames > most_frames) throw sim::input_error("--frames: outside 1.." + std::to_string(most_frames));
  std::vector<sim::output_file> files;
  for (int k = 0; k < *o.frames; ++k) {
    const std::string name = frame_name(o.out, k);
    check_outputs_differ({{"--out", name}, {"--stats", o.stats}});
    files.emplace_back(name);
  }
  return files;
}

void run(const render_options& o) {
  sim::draw_options drawing = o.drawing.resolve();
  drawing.counted = !o.stats.empty();
  if (o.psnr || !o.reference.empty()) refuse_reference(drawing);
  const std::vector<sim::output_file> files = outputs(o);
  const sim::output_file stats = o.stats.empty() ? sim::output_file() : sim::output_file(o.stats);
  const subject_options::loaded subject(o.subject, o.drawing);
  if (files.size() > 1 && !subject.turns())
    throw sim::input_error("--frames: the view of '" + o.subject.subject + "' is fixed, every frame equal");
  const sim::output_file reference = o.reference.empty() ? sim::output_file() : sim::output_file(o.reference);
  std::string report;
  for (size_t k = 0; k < files.size(); ++k) {
    const sim::scene s = subject.at(360.0 * double(k) / double(files.size()));
    const sim::draw_result r = draw_with_bar(s, drawing);
    std::optional<double> psnr_db;
    if (o.psnr) psnr_db = reference_psnr_db(s, r.picture, drawing.background);
    if (k == 0) report = stats_json(r, drawing, psnr_db);
    files[k].write(sim::encode_png(r.picture));
    if (psnr_db) printf("%s: PSNR against the reference: %.2f dB\n", files[k].path().c_str(), *psnr_db);
  }
  if (stats.wanted()) stats.write(report);
  if (reference.wanted())
    reference.write(sim::encode_png(sim::rounded(sim::render_reference(subject.at(0), drawing.background, sim::hardware_threads()))));
}

}  // namespace

void add_render_command(CLI::App& app) {
  const auto o = std::make_shared<render_options>();
  CLI::App& sub = *app.add_subcommand("render", "draw a model with its own textures, or a scene by name");
  o->subject.add_to(sub, false);
  sub.add_option("--out", o->out, "the picture, PNG; with --frames a pattern such as O-%04d.png")->required();
  sub.add_option("--frames", o->frames, "a turntable of so many pictures, the camera turned once around");
  o->drawing.add_to(sub, true);
  sub.add_option("--stats", o->stats, stats_help("counts and times (of the first frame) as JSON"));
  sub.add_option("--reference", o->reference, "the reference's own picture (of the first frame), PNG");
  sub.add_flag("--psnr", o->psnr, "compare with the 16x16 supersampled double-precision reference");
  sub.callback([o] { run(*o); });
}

}  // namespace spantex::tool
