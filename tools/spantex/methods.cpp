// SPDX-License-Identifier: Apache-2.0
#include "methods.hpp"

#include <stdio.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include <sim/quality.hpp>

namespace spantex::tool {

std::string label_of(const method& m) {
  if (m.space == sim::sampling_space::object) return "object-space";
  std::string label(sim::name_of(sim::filter_names, m.kind));
  if (m.changes.level) label += ":level=" + std::string(sim::name_of(sim::level_names, *m.changes.level));
  if (m.changes.max_samples) label += ":samples=" + std::to_string(*m.changes.max_samples);
  if (m.changes.sample_spacing) label += ":spacing=" + std::to_string(*m.changes.sample_spacing);
  if (m.changes.sample_slack) label += ":slack=" + std::to_string(*m.changes.sample_slack);
  if (m.changes.sample_bias) label += ":bias=" + std::to_string(*m.changes.sample_bias);
  return label;
}

std::string name_of(const method& m) { return label_of(m) + "-" + std::string(sim::name_of(sim::profile_names, m.profile)); }

std::string file_name_of(const method& m) {
  std::string name = name_of(m);
  std::replace(name.begin(), name.end(), ':', '-');
  std::replace(name.begin(), name.end(), '=', '-');
  return name;
}

bench::bench(sim::scene s, rgba8 background, int repeats)
    : scene_(std::move(s)), background_(background), repeats_(repeats),
      reference_(sim::render_reference(scene_, background, sim::hardware_threads())), rounded_(sim::rounded(reference_)) {
  for (const int item : sim::visible_items(scene_)) shown_ += item >= 0;
}

judged bench::judge(const method& m) const {
  sim::draw_options o;
  o.kind = m.kind;
  o.profile = m.profile;
  o.space = m.space;
  o.changes = m.changes;
  const bool contours = m.kind == filter::contour;
  if (contours) o.how.alpha = alpha_mode::blended;
  o.background = background_;
  o.repeat = repeats_;
  o.counted = true;
  sim::draw_result direct = sim::draw(scene_, o);
  if (m.space == sim::sampling_space::screen) {
    o.engine = sim::engine_choice::simulated;
    o.repeat = 1;
    const sim::draw_result simulated = sim::draw(scene_, o);
    if (direct.picture.pixels != simulated.picture.pixels)
      throw std::runtime_error(scene_.name + " " + name_of(m) + ": engines direct and sim differ");
    direct.machine = simulated.machine;
  }
  const double pixels = double(std::max<size_t>(1, shown_));
  const auto unless_contours = [&](double x) { return contours ? std::numeric_limits<double>::quiet_NaN() : x; };
  judged j{scene_.name, m, {}, unless_contours(sim::psnr_db(direct.picture, reference_)), unless_contours(sim::ssim(direct.picture, rounded_)),
           unless_contours(sim::worst_error(direct.picture, reference_)), direct.ns_per_pixel, direct.kernel, double(direct.machine.texel_reads) / pixels,
           double(direct.work.words_loaded) / pixels, double(direct.machine.stall_cycles) / pixels, direct.machine};
  j.picture = std::move(direct.picture);
  return j;
}

std::string table_heading() {
  char line[200];
  snprintf(line, sizeof line, "%-10s  %-24s  %-7s  %7s  %6s  %5s  %8s  %6s  %8s  %8s  %s", "picture", "filter", "profile", "PSNR dB", "SSIM", "worst",
           "texels", "words", "stalls", "ns", "kernel");
  return line;
}

std::string table_line(const judged& j) {
  char line[200];
  const std::string kind = label_of(j.how), profile(sim::name_of(sim::profile_names, j.how.profile));
  snprintf(line, sizeof line, "%-10s  %-24s  %-7s  %7.2f  %6.4f  %5.0f  %8.2f  %6.2f  %8.3f  %8.1f  %s", j.scene.c_str(), kind.c_str(), profile.c_str(), j.psnr_db,
           j.ssim, j.worst, j.texel_reads, j.words, j.stalls, j.ns_per_pixel, std::string(j.kernel).c_str());
  return line;
}

}  // namespace spantex::tool
