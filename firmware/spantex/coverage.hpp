// SPDX-License-Identifier: Apache-2.0
// Coverage: which pixels of an 8x8 span a convex polygon covers, as one 64-bit word. Bit 8 j + i is pixel (i, j) of the span.
// Vertices are snapped to 1/256 pixel; edge functions are exact integers; the top-left rule decides pixels on an edge, so
// that polygons sharing an edge cover every pixel once.
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>
#include <spantex/plane.hpp>

namespace spantex {

using span_mask = uint64_t;
inline constexpr int span_side = 8;
inline constexpr int span_pixel_count = span_side * span_side;
inline constexpr span_mask full_mask = ~span_mask(0);

inline constexpr int subpixel_bits = 8;
inline constexpr int32_t guard_px = 1 << 14;  // snapped vertices lie within +-guard_px

// A screen position in 1/256 pixel, origin top left.
struct screen_point { int32_t x, y; };

// e(x, y) = a x + b y + c >= 0 inside, in units of 1/256 pixel; |a|, |b| <= 2^23, |c| < 2^48.
struct edge {
  int64_t a, b, c;
  constexpr int64_t at(int32_t x, int32_t y) const { return multiply_by_32(a, x) + multiply_by_32(b, y) + c; }
  friend constexpr bool operator==(const edge&, const edge&) = default;
};

// Edge from p to q of a polygon that runs clockwise on the screen (y down). A pixel centre exactly on the edge is inside if the
// edge is a top edge (horizontal, running right) or a left edge (running up).
constexpr edge make_edge(screen_point p, screen_point q) {
  const int64_t dx = q.x - p.x, dy = q.y - p.y;
  const bool top_left = dy < 0 || (dy == 0 && dx > 0);
  // inside is to the right of p -> q: cross(q - p, x - p) = dx (y - py) - dy (x - px) >= 0
  return {-dy, dx, dy * p.x - dx * p.y - (top_left ? 0 : 1)};
}

inline constexpr int max_edges = 16;

struct edge_set {
  edge edges[max_edges];
  int count = 0;
  friend constexpr bool operator==(const edge_set&, const edge_set&) = default;
};

constexpr int32_t centre_subpixels(int32_t pixel) { return pixel * (1 << subpixel_bits) + (1 << (subpixel_bits - 1)); }

// An edge's least and largest value at the centres of width x height pixels, at most 256 each.
struct edge_range { int64_t corner, low, high; };
constexpr edge_range range_of(const edge& e, int32_t x, int32_t y, int32_t width, int32_t height) {
  constexpr int32_t step = 1 << subpixel_bits;
  const int64_t corner = e.at(centre_subpixels(x), centre_subpixels(y)), far_x = int64_t(int32_t(e.a) * (width - 1)) * step, far_y = int64_t(int32_t(e.b) * (height - 1)) * step;
  return {corner, corner + (far_x < 0 ? far_x : 0) + (far_y < 0 ? far_y : 0), corner + (far_x > 0 ? far_x : 0) + (far_y > 0 ? far_y : 0)};
}

// Pixels of span (sx, sy) on the inner side of one edge.
constexpr span_mask edge_mask(const edge& e, int32_t sx, int32_t sy) {
  constexpr int64_t step = int64_t(1) << subpixel_bits;
  const auto [corner, low, high] = range_of(e, sx * span_side, sy * span_side, span_side, span_side);
  if (low >= 0) return full_mask;
  if (high < 0) return 0;
  span_mask mask = 0;
  int64_t row = corner;
  for (int j = 0; j < span_side; ++j, row += e.b * step) {
    int64_t value = row;
    for (int i = 0; i < span_side; ++i, value += e.a * step)
      if (value >= 0) mask |= span_mask(1) << (span_side * j + i);
  }
  return mask;
}

constexpr span_mask coverage(const edge_set& set, int32_t sx, int32_t sy) {
  span_mask mask = full_mask;
  for (int k = 0; k < set.count && mask != 0; ++k) mask &= edge_mask(set.edges[k], sx, sy);
  return mask;
}

// Pixels of span (sx, sy) that lie in the rectangle.
constexpr span_mask rectangle_mask(rectangle r, int32_t sx, int32_t sy) {
  const int32_t x0 = clamp_to(r.x0 - sx * span_side, 0, span_side), x1 = clamp_to(r.x1 - sx * span_side, 0, span_side);
  const int32_t y0 = clamp_to(r.y0 - sy * span_side, 0, span_side), y1 = clamp_to(r.y1 - sy * span_side, 0, span_side);
  if (x0 >= x1 || y0 >= y1) return 0;
  const uint32_t row = ((1u << x1) - 1) & ~((1u << x0) - 1);
  span_mask mask = 0;
  for (int j = y0; j < y1; ++j) mask |= span_mask(row) << (span_side * j);
  return mask;
}

// Pixels of span (sx, sy) at which a linear form in half pixels about an origin is positive.
constexpr span_mask positive_mask(const linear_form& f, int32_t origin_x, int32_t origin_y, int32_t sx, int32_t sy) {
  const int32_t hx = 2 * span_side * sx + 1, hy = 2 * span_side * sy + 1;
  const int64_t corner = f.c + f.x * (hx - origin_x) + f.y * (hy - origin_y);
  const int64_t far_x = f.x * (2 * (span_side - 1)), far_y = f.y * (2 * (span_side - 1));
  const int64_t low = corner + (far_x < 0 ? far_x : 0) + (far_y < 0 ? far_y : 0);
  const int64_t high = corner + (far_x > 0 ? far_x : 0) + (far_y > 0 ? far_y : 0);
  if (low > 0) return full_mask;
  if (high <= 0) return 0;
  span_mask mask = 0;
  int64_t row = corner;
  for (int j = 0; j < span_side; ++j, row += 2 * f.y) {
    int64_t value = row;
    for (int i = 0; i < span_side; ++i, value += 2 * f.x)
      if (value > 0) mask |= span_mask(1) << (span_side * j + i);
  }
  return mask;
}

// Pixels in front of the viewer: W > 0.
constexpr span_mask front_mask(const plane& p, int32_t sx, int32_t sy) { return positive_mask(p.w, p.origin_x, p.origin_y, sx, sy); }

// Smallest box of pixels, within a span, that holds every bit of a non-zero mask.
struct mask_box { int x0, y0, x1, y1; };  // inclusive
constexpr mask_box box_of(span_mask mask) {
  span_mask columns = mask;
  columns |= columns >> 32;
  columns |= columns >> 16;
  columns |= columns >> 8;
  const uint32_t c = uint32_t(columns & 0xFF);
  return {__builtin_ctz(c), __builtin_ctzll(mask) / span_side, 31 - __builtin_clz(c), (63 - __builtin_clzll(mask)) / span_side};
}

}  // namespace spantex
