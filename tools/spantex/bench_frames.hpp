// SPDX-License-Identifier: Apache-2.0
// Frames of a model or level, from the world's faces to pixels: set-up and drawing of ours, nearest first, and of peers that draw triangles, map by map from a buffer that was filled before.
// One thread. Not timed: clearing, which all of them do first, and memory for the picture.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "bench_measure.hpp"
#include "options.hpp"

namespace spantex::tool {

struct frames_row {
  std::string filter, drawer, kernel;  // kernel: ours
  spread set_up_ms, all_ms;            // over the frames, each the middle one of so many turns; set-up of ours, which is part of all
  double most_ms = 0;                  // the slowest frame
  double psnr_db = 0;                  // of all frames together, against the reference
  double psnr_ours_db = 0;             // peers: against ours
  bool right_picture = true;           // peers, as of bench_row
};

struct frames_choice {
  std::vector<filter> filters;
  std::vector<kernels::choice> kernels;
  int rounds, frames;
};

// Of a walk through a level, or of a model turned once around. `step` is called after each frame by each filter that a kernel draws by.
std::vector<frames_row> measure_frames(const subject_options::loaded& subject, const frames_choice& choice, const peer_list& peers, const std::function<void()>& step);

}  // namespace spantex::tool
