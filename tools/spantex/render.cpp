// SPDX-License-Identifier: Apache-2.0
// spantex render: a model or a scene by name, one picture or a turntable of them.
#include <stdio.h>

#include <chrono>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include <sim/parallel.hpp>
#include <sim/quality.hpp>
#include <sim/reference.hpp>
#include <sim/unchanged.hpp>
#include "commands.hpp"
#include "options.hpp"

namespace spantex::tool {
namespace {

constexpr int most_frames = 9999;

struct render_options {
  drawing_options drawing;
  subject_options subject;
  std::string out, stats, reference, path;
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

// A view a line, which may end as on Windows: x,y,z of the eye and of what it looks at; lines that begin with # and empty ones say nothing. Read once: it may be a pipe.
std::vector<sim::viewpoint> read_path(const std::string& file) {
  const sim::bytes data = sim::read_file(file);
  std::vector<sim::viewpoint> views;
  int line = 0;
  for (std::string& text : split({data.begin(), data.end()}, '\n')) {
    ++line;
    if (text.ends_with('\r')) text.pop_back();
    if (text.empty() || text[0] == '#') continue;
    const std::vector<double> n = parse_numbers(text, 6, file + ": line " + std::to_string(line));
    views.push_back({{n[0], n[1], n[2]}, {n[3], n[4], n[5]}});
  }
  if (views.empty() || views.size() > size_t(most_frames)) throw sim::input_error(file + ": " + std::to_string(views.size()) + " views, not 1.." + std::to_string(most_frames));
  return views;
}

// all: the scene with what others hide.
nlohmann::ordered_json frame_json(const sim::scene& s, const sim::scene& all, const sim::draw_result& r, double set_up_ns) {
  nlohmann::ordered_json j;
  j["draw_ns"] = r.ns_per_pixel * double(r.picture.pixels.size());
  j["set_up_ns"] = set_up_ns;
  j["polygons"] = all.items.size();
  j["polygons_set_up"] = s.items.size();
  if (all.uses_depth() || all.items.empty()) {
    const sim::overdraw over = sim::overdraw_of(all);
    j["pixels_tested"] = over.pixels_tested;
    j["pixels_shown"] = over.pixels_shown;
  }
  j.update(work_json(r));
  return j;
}

void check_files(const render_options& o, const std::vector<sim::output_file>& frames, std::vector<std::string> inputs) {
  inputs.push_back(o.path);
  std::vector<named_output> outputs{{"--stats", o.stats}, {"--reference", o.reference}};
  for (const sim::output_file& f : frames) outputs.push_back({"--out", f.path()});
  check_outputs(outputs, inputs);
}

std::vector<sim::output_file> outputs(const render_options& o, const std::vector<sim::viewpoint>& path) {
  const int frames = o.path.empty() ? o.frames.value_or(0) : int(path.size());
  if (!o.frames && o.path.empty()) return {sim::output_file(o.out)};
  if (o.path.empty()) check_range("--frames", *o.frames, 1, most_frames);
  std::vector<sim::output_file> files;
  for (int k = 0; k < frames; ++k) files.emplace_back(frame_name(o.out, k));
  return files;
}

void print_psnr(const sim::output_file& file, std::optional<double> psnr_db) {
  if (psnr_db) printf("%s: PSNR against the reference: %.2f dB\n", file.path().c_str(), *psnr_db);
}

// Writes frames in their order under their names, as many at a time as there are threads, or take 64 MB: each thread encodes one, which takes longer than drawing it.
class frame_writer {
 public:
  frame_writer(sim::output_files& to, sim::thread_team& team) : to_(to), team_(team) {}
  frame_writer(const frame_writer&) = delete;
  frame_writer& operator=(const frame_writer&) = delete;
  // Where a frame fails those before it are there.
  ~frame_writer() {
    try {
      finish();
    } catch (...) {
    }
  }

  void write(const sim::output_file& file, sim::image picture, std::optional<double> psnr_db) {
    constexpr size_t most_pixels = size_t(16) << 20;
    pixels_ += picture.pixels.size();
    waiting_.push_back({&file, std::move(picture), psnr_db});
    if (int(waiting_.size()) == team_.size() || pixels_ >= most_pixels) finish();
  }
  void finish() {
    const std::vector<frame> frames = std::exchange(waiting_, {});
    pixels_ = 0;
    std::vector<sim::bytes> data(frames.size());
    team_.run(int(data.size()), [&](int k) { data[size_t(k)] = sim::encode_png(frames[size_t(k)].picture); });
    for (size_t k = 0; k < data.size(); ++k) {
      to_.write(*frames[k].file, data[k]);
      to_.commit();
      print_psnr(*frames[k].file, frames[k].psnr_db);
    }
  }

 private:
  struct frame { const sim::output_file* file; sim::image picture; std::optional<double> psnr_db; };
  sim::output_files& to_;
  sim::thread_team& team_;
  std::vector<frame> waiting_;
  size_t pixels_ = 0;
};

void run(const render_options& o) {
  sim::draw_options drawing = o.drawing.resolve();
  drawing.counted = !o.stats.empty();
  drawing.depths_first = o.subject.order == "depths";
  if (drawing.depths_first && drawing.how.alpha != alpha_mode::opaque) throw sim::input_error("--order depths: the depths of what is cut out or blended are not known first: not with --alpha " + o.drawing.alpha);
  if (drawing.depths_first && drawing.space != sim::sampling_space::screen) throw sim::input_error("--order depths: not in object space, which has its own order");
  if (o.psnr || !o.reference.empty()) refuse_reference(drawing, o.psnr ? "--psnr" : "--reference");
  if (!o.path.empty() && (o.frames || !o.subject.camera.empty() || !o.subject.eye.empty())) throw sim::input_error("--path: has frames and cameras of its own");
  // Of a path or a walk; none where the camera is the subject's or turns around it.
  std::vector<sim::viewpoint> views = o.path.empty() ? std::vector<sim::viewpoint>() : read_path(o.path);
  const std::vector<sim::output_file> files = outputs(o, views);
  const sim::output_file stats = wanted_output(o.stats);
  const subject_options::loaded subject(o.subject, o.drawing);
  check_files(o, files, subject.files());
  if (!o.path.empty() && !subject.is_model()) throw sim::input_error("--path: '" + o.subject.subject + "' has its own view; only models and levels take a camera");
  if (o.path.empty() && files.size() > 1 && !subject.turns())
    throw sim::input_error("--frames: the view of '" + o.subject.subject + "' is fixed, every frame equal");
  const sim::output_file reference = wanted_output(o.reference);
  if (o.path.empty() && subject.walks()) views = subject.walk(int(files.size()));
  using faces = subject_options::loaded::faces;
  const auto scene_of = [&](size_t k, faces which = faces::that_may_show) {
    return views.empty() ? subject.at(360.0 * double(k) / double(files.size()), drawing.team, which) : subject.seen_from(views[k], drawing.team, which);
  };
  sim::thread_team team(drawing.threads);
  drawing.team = &team;
  nlohmann::ordered_json report, frames;
  sim::frame_before before;
  sim::output_files written;
  if (reference.wanted()) written.write(reference, sim::encode_png(sim::rounded(sim::render_reference(scene_of(0, faces::all), drawing.background, sim::hardware_threads()))));
  frame_writer in_order(written, team);
  const bool keeps = files.size() > 1 && parse_no_skip(o.drawing.no_skip).unchanged;
  for (size_t k = 0; k < files.size(); ++k) {
    const auto begun = std::chrono::steady_clock::now();
    const sim::scene s = scene_of(k);
    const double set_up_ns = std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - begun).count();
    sim::draw_result r = draw_with_bar(s, drawing, keeps ? &before : nullptr);
    std::optional<double> psnr_db;
    const bool counts = stats.wanted() && files.size() > 1;
    std::optional<sim::scene> with_hidden;
    if (subject.leaves_hidden() && (o.psnr || counts)) with_hidden = scene_of(k, faces::all);
    const sim::scene& all = with_hidden ? *with_hidden : s;
    if (o.psnr) psnr_db = reference_psnr_db(all, r.picture, drawing.background);
    if (k == 0) report = nlohmann::ordered_json::parse(stats_json(r, drawing, psnr_db, subject.textures_missing()));
    if (counts) frames.push_back(frame_json(s, all, r, set_up_ns));
    if (files.size() > 1) {
      in_order.write(files[k], std::move(r.picture), psnr_db);
      continue;
    }
    written.write(files[k], sim::encode_png(r.picture));
    print_psnr(files[k], psnr_db);
  }
  in_order.finish();
  if (!frames.empty()) report["frames"] = frames;
  if (stats.wanted()) written.write(stats, report.dump(2) + "\n");
  written.commit();
}

}  // namespace

void add_render_command(CLI::App& app) {
  const auto o = std::make_shared<render_options>();
  CLI::App& sub = *app.add_subcommand("render", "draw a model with its own textures, or a scene by name");
  o->subject.add_to(sub, false);
  sub.add_option("--out", o->out, "the picture, PNG; with --frames a pattern such as O-%04d.png")->required();
  sub.add_option("--frames", o->frames, "so many pictures, 1.." + std::to_string(most_frames) + ": of a level a walk through it, else a turntable, the camera turned once around");
  sub.add_option("--path", o->path, "a file of cameras, a frame a line: x,y,z of the eye, x,y,z of what it looks at");
  o->drawing.add_to(sub, true);
  sub.add_option("--stats", o->stats, stats_help("counts and times (of the first frame; where there are more, of each under 'frames') as JSON; of a level 'textures_missing': those that have no picture and are grey"));
  sub.add_option("--reference", o->reference, "the reference's own picture (of the first frame), PNG");
  sub.add_flag("--psnr", o->psnr, "compare with the 16x16 supersampled double-precision reference");
  sub.callback([o] { run(*o); });
}

}  // namespace spantex::tool
