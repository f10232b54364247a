// SPDX-License-Identifier: Apache-2.0
// Stress of the numerics: random and adversarial planes and polygons against exact integer arithmetic. Every case is a function of
// (family, seed), so one number reproduces it; a failure is shrunk to the simplest plane that still fails.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include <spantex/plane.hpp>
#include <spantex/profile.hpp>

namespace spantex::sim {

enum class stress_family {
  any_plane,        // coefficients of every size
  horizon,          // W = 0 runs through the picture
  near_horizon,     // W passes zero within a span or two
  edge_on,          // W almost the same multiple of Nu everywhere: nearly singular
  cancelling,       // numerators that cancel to a small difference of large terms
  far_coordinates,  // u, v near +-2^15
  magnified,        // thousands of pixels per texel
  minified,         // thousands of texels per pixel: beyond the last level of any map
  wide_screen,      // 4096 pixels, spans at its far end
  polygons,         // fans of triangles down to needles and slivers: each pixel drawn once, W > 0
};
inline constexpr int stress_family_count = 10;
const char* name_of(stress_family f);

struct stress_options {
  uint64_t evaluations = 10'000'000;  // texture coordinates to evaluate (u and v count one each), over all families
  uint64_t seed = 1;
  double seconds = 0;                 // stop after this time; 0: no limit
  int threads = 1;
  std::vector<stress_family> families; // empty: all
};

struct stress_worst {
  double error = 0;        // in texels, levels, or parts of the bound
  uint64_t case_seed = 0;
  int span_x = 0, span_y = 0, pixel = 0;
};

struct stress_row {
  stress_family family;
  uint64_t cases = 0, evaluations = 0, positions = 0, levels = 0, polygon_pixels = 0;
  stress_worst coordinate, share, position, level;  // share: of the coordinate bound of its span; position: snapped, likewise
  uint64_t failures = 0;
  uint64_t first_failure = 0;  // case seed
};

struct stress_report {
  std::vector<stress_row> rows;
  double coordinate_bound = 0, level_bound = 0;  // of the profile
  bool complete = true;                          // false: stopped by time
};

// A plane of the family; the same for the same seed.
plane stress_plane(stress_family family, uint64_t seed, int& width_px, int& height_px);

stress_report run_stress(const profile& p, const stress_options& options);

// Runs one case and describes it, and, if it fails, the simplest plane found that still does.
std::string describe_case(const profile& p, stress_family family, uint64_t seed);

}  // namespace spantex::sim
