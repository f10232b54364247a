// SPDX-License-Identifier: Apache-2.0
// Polygons of the stress run: fans of triangles, triangles of a pixel and less, needles up to 4096 pixels long. Corners are whole numbers
// of 1/256 pixel, so that which pixel centres lie inside is a question of exact integers.
#pragma once
#include <string>
#include <vector>

#include <spantex/coverage.hpp>

#include "sim/stress.hpp"
#include "sim/stress_judge.hpp"

namespace spantex::sim {

// Seen at `at`, at depth z >= 1 (s15.16), with texture coordinates s15.16.
struct stress_corner {
  screen_point at;
  int32_t z, u, v;
};
struct stress_triangle {
  stress_corner corners[3];
};

// A convex outline, on the screen, cut into triangles that share edges.
struct stress_fan {
  int width_px, height_px;
  std::vector<screen_point> outline;
  std::vector<stress_triangle> triangles;
};

// The same for the same seed.
stress_fan make_stress_fan(stress_family family, uint64_t seed);

// Judges set-up, coverage and every stage of the covered pixels. Returns the number of pixels drawn.
int64_t judge_triangle(const stress_fan& fan, const stress_triangle& t, stress_judge& judge, stress_row& row);

// All triangles, and that each pixel of the outline is drawn once.
void judge_fan(const stress_fan& fan, stress_judge& judge, stress_row& row);

std::string text_of(const stress_triangle& t);

}  // namespace spantex::sim
