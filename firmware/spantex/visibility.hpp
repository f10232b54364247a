// SPDX-License-Identifier: Apache-2.0
// Visibility: which pixels of a span are nearer than what was drawn before, and spans that are hidden as a whole without a look at their pixels.
#pragma once
#include <stdint.h>

#include <spantex/coverage.hpp>
#include <spantex/polygon.hpp>

namespace spantex {

// Optional depth, one word per pixel of the frame, rows of the frame's width: near/z as u0.31, 0 where nothing was drawn. Larger is nearer.
// Optional floors, one word per span, rows of ceil(width / 8), 0 at the start: what the farthest pixel of the span is at least. A surface that is
// nowhere nearer than the floor is hidden. Floors leave the picture as it is.
struct depth_buffer {
  uint32_t* values = nullptr;
  uint32_t* floors = nullptr;
};

struct depth_range { uint32_t least, most; };

// Depths of the centres of span (sx, sy) lie between those of its corners.
constexpr depth_range depth_range_of(const polygon& p, int32_t sx, int32_t sy) {
  const linear_form& f = p.depth;
  const int32_t dx = 2 * span_side * sx + 1 - p.map.origin_x, dy = 2 * span_side * sy + 1 - p.map.origin_y, side = 2 * (span_side - 1);
  const int32_t far_x = f.x > 0 ? side : 0, far_y = f.y > 0 ? side : 0;
  return {detail::depth_of(f, dx + side - far_x, dy + side - far_y), detail::depth_of(f, dx + far_x, dy + far_y)};
}

// Whether the span is hidden by its floor alone.
constexpr bool is_below_floor(const polygon& p, int32_t sx, int32_t sy, depth_buffer depth, int32_t frame_width) {
  return depth.floors != nullptr && depth_range_of(p, sx, sy).most <= depth.floors[sy * ((frame_width + span_side - 1) / span_side) + sx];
}

// Of the pixels in mask, those nearer than what is stored, whose depth is stored if wanted. frame_width in pixels.
constexpr span_mask depth_test(const polygon& p, int32_t sx, int32_t sy, span_mask mask, depth_buffer depth, int32_t frame_width, bool stores) {
  uint32_t* const floor = depth.floors == nullptr ? nullptr : &depth.floors[sy * ((frame_width + span_side - 1) / span_side) + sx];
  const depth_range range = depth_range_of(p, sx, sy);
  if (floor != nullptr && range.most <= *floor) return 0;
  uint32_t* const first = depth.values + int64_t(sy) * span_side * frame_width + sx * span_side;
  const int32_t dx = 2 * span_side * sx + 1 - p.map.origin_x, dy = 2 * span_side * sy + 1 - p.map.origin_y;
  const auto nearer = [&](int i, int j) {
    uint32_t& stored = first[j * frame_width + i];
    const uint32_t z = detail::depth_of(p.depth, dx + 2 * i, dy + 2 * j);
    if (z <= stored) return false;
    if (stores) stored = z;
    return true;
  };
  span_mask visible = 0;
  if (mask == full_mask) {
    for (int j = 0; j < span_side; ++j)
      for (int i = 0; i < span_side; ++i) visible |= span_mask(nearer(i, j)) << (span_side * j + i);
    if (floor != nullptr && stores && range.least > *floor) *floor = range.least;
  } else {
    for (span_mask rest = mask; rest != 0; rest &= rest - 1) {
      const int k = __builtin_ctzll(rest);
      if (nearer(k % span_side, k / span_side)) visible |= span_mask(1) << k;
    }
  }
  return visible;
}

}  // namespace spantex
