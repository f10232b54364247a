// SPDX-License-Identifier: Apache-2.0
// How cost grows with one thing while the rest stays: pixels, polygons, map side, overdraw.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "bench_measure.hpp"

namespace spantex::tool {

struct growth_point {
  double amount;         // pixels, polygons, texels a side, layers
  spread ns;             // a picture
  double words;          // 64-bit words loaded into local memory, a picture
};

struct growth_curve {
  std::string of, drawer;        // "pixels", "trilinear avx512"
  std::vector<growth_point> points;
  double time_slope, words_slope;  // of the straight line nearest to the logarithms; 1: in proportion, 0: not at all
};

inline constexpr int growth_curve_count = 8;

std::vector<growth_curve> measure_growth(int rounds, const std::function<void()>& curve_done);

}  // namespace spantex::tool
