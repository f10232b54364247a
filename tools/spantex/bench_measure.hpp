// SPDX-License-Identifier: Apache-2.0
// Time against error: everybody who draws the same picture by the same filter takes turns, round after round, so that what else the machine does
// meets them all alike. Ours: every profile and kernel asked for; peers: those that have the filter.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <sim/draw_host.hpp>
#include <sim/reference.hpp>
#include "bench_peers.hpp"

namespace spantex::tool {

struct spread { double median, low, high, least; int samples; };  // low and high: quartiles
spread spread_of(std::vector<double> values);

// Against the reference, r, g, b, 0..255.
struct picture_error { double rms, worst, psnr_db; };

struct bench_row {
  std::string scene, filter;
  std::string drawer;                  // "spantex", or the peer's name
  std::string profile, kernel;         // ours
  spread ns_per_pixel;                 // one thread; coefficients and prepared map in, pixels in memory out
  picture_error error;
  std::optional<draw_counters> counts; // ours: of one picture
  double pixels = 0;                   // of the picture
  double psnr_ours_db = 0;             // peers: against our picture, profile default
  bool right_picture = true;           // peers: nearer the reference than a picture of nothing but the reference's mean colour
};

struct bench_choice {
  std::vector<filter> filters;
  std::vector<sim::profile_choice> profiles;
  std::vector<kernels::choice> kernels;
  int rounds;
  std::optional<int> max_samples;  // of ours, filter aniso
};

// All rows of a scene. `step` is called as each filter is done.
std::vector<bench_row> measure_scene(const sim::scene& s, const bench_choice& choice, const peer_list& peers, const std::function<void()>& step);

// Ours and the fastest peer with the right picture, a scene and filter.
struct bench_ratio {
  std::string scene, filter, peer;
  double ours_ns, peer_ns, ours_psnr_db, peer_psnr_db;
};
std::vector<bench_ratio> ratios_of(const std::vector<bench_row>& rows);

}  // namespace spantex::tool
