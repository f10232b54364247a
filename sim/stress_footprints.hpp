// SPDX-License-Identifier: Apache-2.0
// Filters with a footprint and contours under stress: one pixel of a span, its coefficients as the planner fills them, every step against exact
// arithmetic and its bound (accuracy.hpp).
#pragma once
#include "sim/stress_judge.hpp"

namespace spantex::sim {

// Judges one pixel of `mask` with W > 0 with one of squares, aniso, step, hat and contour, both drawn from the seed.
void judge_footprint(const profile& p, const plane& map, span_at s, span_mask mask, uint64_t seed, stress_judge& judge);

}  // namespace spantex::sim
