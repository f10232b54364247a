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

// Of the pixels in mask, those nearer than what is stored, whose depth is stored if wanted (the rest may be written as they are). frame_width in pixels.
SPANTEX_WRAPS constexpr span_mask depth_test(const polygon& p, int32_t sx, int32_t sy, span_mask mask, depth_buffer depth, int32_t frame_width, bool stores) {
  uint32_t* const floor = depth.floors == nullptr ? nullptr : &depth.floors[sy * ((frame_width + span_side - 1) / span_side) + sx];
  const depth_range range = depth_range_of(p, sx, sy);
  if (floor != nullptr && range.most <= *floor) return 0;
  uint32_t* const first = depth.values + int64_t(sy) * span_side * frame_width + sx * span_side;
  const int32_t dx = 2 * span_side * sx + 1 - p.map.origin_x, dy = 2 * span_side * sy + 1 - p.map.origin_y;
  const bool saturates = range.least <= 1 || range.most >= uint32_t(1) << 31;
  span_mask visible = 0;
  if (mask == full_mask && !saturates) {
    uint64_t down = uint64_t(p.depth.c) + uint64_t(p.depth.x) * uint64_t(dx) + uint64_t(p.depth.y) * uint64_t(dy);
    for (int j = 0; j < span_side; ++j, down += 2 * uint64_t(p.depth.y)) {
      uint32_t* const row = first + j * frame_width;
      uint64_t across = down;
      for (int i = 0; i < span_side; ++i, across += 2 * uint64_t(p.depth.x)) {
        const uint32_t z = uint32_t(across >> depth_guard_bits), stored = row[i];
        const bool nearer = z > stored;
        row[i] = nearer && stores ? z : stored;
        visible |= span_mask(nearer) << (span_side * j + i);
      }
    }
  } else {
    for (span_mask rest = mask; rest != 0; rest &= rest - 1) {
      const int k = __builtin_ctzll(rest), i = k % span_side, j = k / span_side;
      uint32_t& stored = first[j * frame_width + i];
      const uint32_t z = detail::depth_of(p.depth, dx + 2 * i, dy + 2 * j);
      if (z <= stored) continue;
      if (stores) stored = z;
      visible |= span_mask(1) << k;
    }
  }
  if (mask == full_mask && floor != nullptr && stores && range.least > *floor) *floor = range.least;
  return visible;
}

// --- triangles that are hidden as a whole ------------------------------------------------------------------

namespace detail {

// A corner on the screen, in 1/256 pixel, and near/z as u0.31, rounded down.
struct seen_corner { int32_t x, y; int64_t depth; };

inline constexpr uint64_t no_bound = UINT64_MAX;

// What the depth of no pixel of a triangle exceeds (docs/ACCURACY.md, section 18), whose texture coordinates are at most most_texel (s15.16) in size, set up for a box of at most box_px pixels down and
// across together; no_bound where its corners, that are snapped, do not tell: it may be narrower than some 1/64 pixel.
constexpr uint64_t depth_bound(const seen_corner (&c)[3], uint32_t most_texel, int32_t box_px) {
  const auto size = [](int64_t x) { return int64_t(magnitude(x)); };
  const int64_t x1 = c[1].x - c[0].x, x2 = c[2].x - c[0].x, y1 = c[1].y - c[0].y, y2 = c[2].y - c[0].y, d1 = c[1].depth - c[0].depth, d2 = c[2].depth - c[0].depth;
  const int64_t sides = size(x1) + size(x2) + size(y1) + size(y2), area = size(x1 * y2 - x2 * y1), least_area = area - sides - 2;
  if (least_area <= sides + 2) return no_bound;
  const int64_t steepest = size(d1 * y2 - d2 * y1) + size(d2 * x1 - d1 * x2) + 2 * (size(d1) + size(d2) + 2) + sides;
  constexpr int64_t around_box = 17 << subpixel_bits;
  const int64_t spread = 4 + (sides + around_box) * (2 * sides) / least_area;
  constexpr int most_spread_bits = 20;
  if (spread >> most_spread_bits != 0) return no_bound;
  uint64_t most = 0;
  for (const seen_corner& k : c) most = uint64_t(k.depth) > most ? uint64_t(k.depth) : most;
  const uint64_t units = uint64_t(spread) * uint64_t(box_px + 1) * ((most_texel >> 16) + 1);  // of 2^-59 of the depth
  return most + uint64_t(steepest / least_area) + (((most >> 16) + 1) * ((units >> 16) + 1) >> 27) + (most >> 28) + 8;
}

}  // namespace detail

// Whether a triangle, three vertices, is hidden by what was drawn before: nowhere nearer than the floor (depth_buffer) of any span that it may meet, so that set-up, which costs ten times as much, and its spans would
// come to nothing. False for what this cannot tell: what the near plane or the guard band cuts, and slivers; for what is outside of the clip rectangle or the frame; and without floors. Of pixels'
// centres, which are what is drawn: between them something may be seen.
constexpr bool is_hidden(const vertex* triangle, const projection& camera, rectangle clip, const uint32_t* floors, int32_t frame_width, int32_t frame_height) {
  if (!on_screen(clip) || camera.near_z <= 0 || floors == nullptr) return false;
  detail::seen_corner corners[3]{};
  int32_t left = INT32_MAX, top = INT32_MAX, right = INT32_MIN, bottom = INT32_MIN;
  uint32_t most_texel = 0;
  uint64_t nearest = 0;
  for (int k = 0; k < 3; ++k) {
    const vertex& v = triangle[k];
    const homogeneous_point p = project(v, camera);
    if (p.z < camera.near_z || magnitude(p.x) >= max_homogeneous || magnitude(p.y) >= max_homogeneous) return false;
    detail::seen_corner& c = corners[k];
    c = {detail::snapped(p.x, p.z), detail::snapped(p.y, p.z), (int64_t(camera.near_z) << 31) / p.z};
    constexpr uint64_t guard = uint64_t(guard_px) << subpixel_bits;
    if (magnitude(c.x) >= guard || magnitude(c.y) >= guard) return false;
    left = min_of(left, c.x);
    top = min_of(top, c.y);
    right = max_of(right, c.x);
    bottom = max_of(bottom, c.y);
    nearest = uint64_t(c.depth) > nearest ? uint64_t(c.depth) : nearest;
    const uint32_t u = uint32_t(magnitude(v.u)), farther = magnitude(v.v) > u ? uint32_t(magnitude(v.v)) : u;
    most_texel = farther > most_texel ? farther : most_texel;
  }
  const rectangle set_up = intersection(clip, {left >> subpixel_bits, top >> subpixel_bits, (right >> subpixel_bits) + 1, (bottom >> subpixel_bits) + 1});
  const rectangle box = intersection(set_up, {0, 0, frame_width, frame_height});
  if (box.empty()) return false;
  const int32_t columns = (frame_width + span_side - 1) / span_side;
  uint32_t least = UINT32_MAX;
  for (int32_t sy = box.y0 / span_side; sy <= (box.y1 - 1) / span_side; ++sy)
    for (int32_t sx = box.x0 / span_side; sx <= (box.x1 - 1) / span_side; ++sx) {
      const uint32_t floor = floors[sy * columns + sx];
      if (floor <= nearest) return false;
      least = floor < least ? floor : least;
    }
  return detail::depth_bound(corners, most_texel, set_up.x1 - set_up.x0 + set_up.y1 - set_up.y0) <= least;
}

// --- depths before colours ---------------------------------------------------------------------------------

// Opaque surfaces, of which nothing is to be filtered that another one hides, in whatever order they come: first lay_depths() of each, which stores what is nearest, then reopen_depths() once, then
// each drawn as ever. What is drawn is seen: every pixel by one surface, the first of those that are equally near. Picture and depths are the same as without.
// What leaves(sx, sy) says yes to is left alone. Returns the spans looked at.
template <class Leaves>
constexpr uint64_t lay_depths(const polygon& p, depth_buffer depth, int32_t frame_width, int32_t frame_height, Leaves leaves) {
  const rectangle box = intersection(p.box, {0, 0, frame_width, frame_height});
  if (box.empty()) return 0;
  uint64_t spans = 0;
  for (int32_t sy = box.y0 / span_side; sy <= (box.y1 - 1) / span_side; ++sy)
    for (int32_t sx = box.x0 / span_side; sx <= (box.x1 - 1) / span_side; ++sx) {
      if (leaves(sx, sy)) continue;
      ++spans;
      if (const span_mask mask = coverage(p.edges, sx, sy) & rectangle_mask(p.box, sx, sy) & front_mask(p.map, sx, sy); mask != 0) depth_test(p, sx, sy, mask, depth, frame_width, true);
    }
  return spans;
}
constexpr uint64_t lay_depths(const polygon& p, depth_buffer depth, int32_t frame_width, int32_t frame_height) {
  return lay_depths(p, depth, frame_width, frame_height, [](int32_t, int32_t) { return false; });
}

// Depths, or floors: what is as near as what is stored is nearer again.
constexpr void reopen_depths(uint32_t* values, int64_t count) {
  for (int64_t k = 0; k < count; ++k) values[k] -= values[k] != 0;
}

}  // namespace spantex
