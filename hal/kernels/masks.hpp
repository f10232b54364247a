// SPDX-License-Identifier: Apache-2.0
// Masks of a polygon's spans, row by row: the pixels that it covers, in front of the viewer and nearer than what was drawn before, whose depths are stored. The same pixels and depths
// as by coverage(), front_mask() and depth_test(), span by span; floors are at least as high, as they may rise where several polygons cover a span together.
#pragma once
#include <stdint.h>

#include <spantex/draw.hpp>
#include <spantex/polygon.hpp>
#include <spantex/visibility.hpp>
#include "kernel.hpp"

namespace spantex::kernels {

// Spans of a row that may be drawn, and what of them.
struct row_masks {
  span_mask mask[max_row_spans];
  int from, to;  // those with something to draw lie in [from, to)
};

// Of an area of pixels that is not empty.
inline int32_t first_span(rectangle area) { return area.x0 / span_side; }
inline int span_count(rectangle area) { return (area.x1 - 1) / span_side - first_span(area) + 1; }

// A polygon within an area of the frame, ready for its rows of spans.
class masked_polygon {
 public:
  // An edge of whole pixels: a x + b y + first >= 0 inside; first is rounded down, so that the sign is that of edge::at() at the pixel's centre. Where an edge crosses a span its
  // values there are less than 2^27.
  struct pixel_edge {
    int32_t a, b;
    int64_t first;        // at pixel (0, 0)
    int32_t least, most;  // that a pixel's value differs from its span's first one's
  };

  // The area is not empty. depth.values null: no pixel is compared, spans with floors where there are. stores: depths of what is visible.
  masked_polygon(const polygon& p, rectangle area, depth_buffer depth, int32_t frame_width, int32_t frame_height, bool stores);

  const polygon& shape;
  const rectangle area;  // of pixels, within the frame
  const depth_buffer depth;
  const int32_t frame_width, frame_height;
  const bool stores;
  const bool in_front;   // W > 0 all over the area's spans
  const span_mask first_columns, last_columns;  // pixels of the first and last spans of its rows that lie between the area's sides
  const uint64_t to_nearest, depth_extent;      // from a span's first pixel to the nearest, from its farthest to the nearest, before they are shifted
  int32_t edge_count;
  pixel_edge edges[max_edges];
  int32_t first_span() const { return kernels::first_span(area); }
  int span_count() const { return kernels::span_count(area); }

  SPANTEX_WRAPS uint64_t depth_step() const { return 2 * span_side * uint64_t(shape.depth.x); }  // from span to span

  // Null: there are none.
  uint32_t* floor_of(int32_t sx, int32_t sy) const { return depth.floors == nullptr ? nullptr : &depth.floors[sy * ((frame_width + span_side - 1) / span_side) + sx]; }
  uint32_t* depths_of(int32_t sx, int32_t sy) const { return depth.values + int64_t(sy) * span_side * frame_width + sx * span_side; }
  // To the least depth that is stored of a span within the frame.
  void raise_floor(int32_t sx, int32_t sy, uint32_t least) const {
    uint32_t* const floor = floor_of(sx, sy);
    if (floor != nullptr && least > *floor) *floor = least;
  }
};

// What a row of its spans begins with, of the first of them.
struct masked_row {
  int64_t edges[max_edges];  // at its first pixel
  int64_t depth;             // there, before it is shifted by depth_guard_bits
  const uint32_t* floors;    // null: there are none
  span_mask rows;            // of pixels within the area

  SPANTEX_WRAPS masked_row(const masked_polygon& p, int32_t sy) : floors(p.floor_of(p.first_span(), sy)), rows(rectangle_mask({0, p.area.y0, span_side, p.area.y1}, 0, sy)) {
    for (int e = 0; e < p.edge_count; ++e) edges[e] = p.edges[e].first + int64_t(p.edges[e].b) * (sy * span_side) + int64_t(p.edges[e].a) * (p.first_span() * span_side);
    const linear_form& f = p.shape.depth;
    depth = int64_t(uint64_t(f.c) + uint64_t(f.x) * uint64_t(2 * span_side * p.first_span() + 1 - p.shape.map.origin_x) + uint64_t(f.y) * uint64_t(2 * span_side * sy + 1 - p.shape.map.origin_y));
  }
  SPANTEX_WRAPS int64_t depth_of(const masked_polygon& p, int k) const { return int64_t(uint64_t(depth) + p.depth_step() * uint64_t(k)); }
  SPANTEX_WRAPS int64_t nearest_of(const masked_polygon& p, int k) const { return int64_t(uint64_t(depth_of(p, k)) + p.to_nearest); }
  SPANTEX_WRAPS bool saturates(const masked_polygon& p, int k) const {
    const int64_t nearest = nearest_of(p, k), farthest = int64_t(uint64_t(nearest) - p.depth_extent);
    return farthest >> depth_guard_bits <= 1 || nearest >> depth_guard_bits >= int64_t(1) << 31;
  }
  int64_t edge_at(const masked_polygon& p, int e, int k) const { return edges[e] + int64_t(p.edges[e].a) * (span_side * k); }  // of span k
  // The same in 32 bits of a span that no edge leaves out: less where it is so far inside that no pixel of it is outside.
  int32_t near_edge(const masked_polygon& p, int e, int k) const {
    const int64_t at = edge_at(p, e, k);
    return at < 1 << 30 ? int32_t(at) : 1 << 30;
  }
};

// Of span_count() spans from first_span() on. leaves: so many, true where nothing is to be drawn and nothing counted; null: nowhere. What a span is counted as, empty or hidden, where it is
// both, is not said.
using row_cover = void (*)(const masked_polygon& p, int32_t sy, const bool* leaves, row_masks& out, draw_counters& counts);

row_cover avx512_cover();  // null where this machine has not what it takes
row_cover avx2_cover();
row_cover words_cover();   // anything

row_cover cover_of(choice c);

}  // namespace spantex::kernels
