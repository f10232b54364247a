// SPDX-License-Identifier: Apache-2.0
// The polygons family of the stress run.
#pragma once
#include "sim/stress.hpp"

namespace spantex::sim {

// A fan of triangles around a point of a square: every pixel centre in the square is covered once; W > 0 wherever one is covered.
bool check_polygons(uint64_t seed, stress_row& row);

}  // namespace spantex::sim
