// SPDX-License-Identifier: Apache-2.0
#include "masks.hpp"

namespace spantex::kernels {

namespace {

bool lies_in_front(const plane& p, rectangle area) {
  const auto at = [&](int32_t x, int32_t y) { return p.w_at(2 * x + 1, 2 * y + 1) > 0; };  // linear: positive at the corners, positive between them
  const auto begin = [](int32_t x) { return x / span_side * span_side; };
  const auto last = [](int32_t x) { return (x - 1) / span_side * span_side + span_side - 1; };
  const int32_t x0 = begin(area.x0), y0 = begin(area.y0), x1 = last(area.x1), y1 = last(area.y1);
  return at(x0, y0) && at(x1, y0) && at(x0, y1) && at(x1, y1);
}

uint64_t or_0(int64_t x) { return x > 0 ? uint64_t(x) : 0; }
SPANTEX_WRAPS uint64_t sides_of(uint64_t x, uint64_t y) { return 2 * (span_side - 1) * (x + y); }

}  // namespace

masked_polygon::masked_polygon(const polygon& p, rectangle a, depth_buffer d, int32_t width, int32_t height, bool stored)
    : shape(p), area(a), depth(d), frame_width(width), frame_height(height), stores(stored), in_front(lies_in_front(p.map, a)),
      first_columns(rectangle_mask({a.x0, 0, first_span() * span_side + span_side, span_side}, first_span(), 0)),
      last_columns(rectangle_mask({a.x1 - 1 - (a.x1 - 1) % span_side, 0, a.x1, span_side}, (a.x1 - 1) / span_side, 0)),
      to_nearest(sides_of(or_0(p.depth.x), or_0(p.depth.y))), depth_extent(sides_of(magnitude(p.depth.x), magnitude(p.depth.y))), edge_count(p.edges.count) {
  constexpr int last = span_side - 1;
  for (int k = 0; k < edge_count; ++k) {
    const edge& e = p.edges.edges[k];
    const int32_t x = int32_t(e.a), y = int32_t(e.b), far_x = x * last, far_y = y * last;
    edges[k] = {x, y, e.at(centre_subpixels(0), centre_subpixels(0)) >> subpixel_bits, min_of(far_x, 0) + min_of(far_y, 0), max_of(far_x, 0) + max_of(far_y, 0)};
  }
}

row_cover cover_of(choice c) {
  switch (resolved(c)) {
    case choice::avx512:
    case choice::avx512_gathers: return avx512_cover();
    case choice::avx2: return avx2_cover();
    case choice::pixels: return cover_of(choice::fastest);  // which is another: masks are the same by any numbers
    default: return words_cover();
  }
}

}  // namespace spantex::kernels
