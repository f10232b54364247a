// SPDX-License-Identifier: Apache-2.0
// Planes of the stress run: where each family's adversity lies, and the spans to look at.
#pragma once
#include <spantex/plane.hpp>

#include "sim/stress.hpp"

namespace spantex::sim {

struct stress_plane_case {
  homography exact;
  plane map;
  int width_px, height_px;
  int x0, y0;  // the anchor: a pixel at which the plane has what its family is named for
};

// The same for the same seed.
stress_plane_case make_stress_plane(stress_family family, uint64_t seed);

struct span_at {
  int x, y;
};
inline constexpr int stress_span_count = 16;
struct span_list {
  span_at spans[stress_span_count];
  int count = 0;
  void add(int x, int y) {
    if (count < stress_span_count) spans[count++] = {x, y};
  }
};

// The anchor's span and its neighbours, spans where W passes zero along rows and columns, a corner, some at random.
span_list spans_to_visit(const stress_plane_case& c, uint64_t seed);

// The span is what the family is for. Told from the plane alone, not from how it was made.
bool is_adverse(stress_family family, const plane& map, span_at s);

}  // namespace spantex::sim
