// SPDX-License-Identifier: Apache-2.0
// One method on one scene, judged: quality against the reference, reads and words from the simulated engine, time from the direct one. Both
// engines must give the same bytes.
#pragma once
#include <stdint.h>

#include <string>
#include <vector>

#include <sim/draw_host.hpp>
#include <sim/reference.hpp>

namespace spantex::tool {

struct method {
  filter kind;
  sim::profile_choice profile;
  sim::sampling_space space = sim::sampling_space::screen;
  sim::profile_changes changes{};
};

struct judged {
  std::string scene;
  method how;
  sim::image picture;
  double psnr_db, ssim, worst;   // against the reference; SSIM against it rounded. NaN for contours: nothing to compare a coverage with
  double ns_per_pixel;           // engine direct, one thread, on this machine
  std::string_view kernel;       // what took them: draw_result
  double texel_reads, words, stalls;  // a pixel of the picture that is drawn; stalls of engine sim
  sim::counters machine;
};

std::string label_of(const method& m);  // "trilinear", "aniso:slack=8", "object-space"
std::string name_of(const method& m);   // "trilinear-exact"
std::string file_name_of(const method& m);  // the same without colons and signs of equality

// A scene with its reference, to judge methods on.
class bench {
 public:
  bench(sim::scene s, rgba8 background, int repeats);
  judged judge(const method& m) const;
  const sim::scene& scene() const { return scene_; }
  const sim::image& reference_picture() const { return rounded_; }

 private:
  sim::scene scene_;
  rgba8 background_;
  int repeats_;
  sim::ideal_image reference_;
  sim::image rounded_;
  size_t shown_ = 0;  // pixels that are not background
};

std::string table_heading();
std::string table_line(const judged& j);

}  // namespace spantex::tool
