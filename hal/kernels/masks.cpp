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

constexpr int spans_at_once = 8;

uint32_t empty(const masked_polygon& p, const masked_row& row, int k) {
  int64_t outside[spans_at_once] = {};
  for (int e = 0; e < p.edge_count; ++e) {
    int64_t most = row.edge_at(p, e, k) + p.edges[e].most;
    for (int n = 0; n < spans_at_once; ++n, most += int64_t(p.edges[e].a) * span_side) outside[n] |= most;
  }
  uint32_t bits = 0;
  for (int n = 0; n < spans_at_once; ++n) bits |= uint32_t(outside[n] < 0) << n;
  return bits;
}

uint32_t hidden(const masked_polygon& p, const masked_row& row, int k, int count) {
  uint32_t bits = 0;
  for (int n = 0; n < count && row.floors != nullptr; ++n) {
    const uint32_t floor = row.floors[k + n];
    bits |= uint32_t(floor != 0 && row.nearest_of(p, k + n) >> depth_guard_bits <= int64_t(floor)) << n;
  }
  return bits;
}

// Four rows of pixels at once, three edges at once.
constexpr int at_once = 3;
using rows = int32_t __attribute__((vector_size(16)));
using bytes = uint8_t __attribute__((vector_size(4)));

struct pixel_lanes {
  void prepare(const masked_polygon&) {}
};

// Of one half of the span's rows, the first one's in the lowest byte. first: the edges' values at the last pixels of its rows.
uint32_t outside_of(const rows (&step)[at_once], const rows (&first)[at_once]) {
  rows value[at_once] = {first[0], first[1], first[2]}, pixels = {};
#pragma GCC unroll 8
  for (int i = 0; i < span_side; ++i) {  // from the last pixel of each row to the first
    pixels = pixels + pixels - ((value[0] | value[1] | value[2]) >> 31);
    for (int n = 0; n < at_once; ++n) value[n] -= step[n];
  }
  const uint32_t word = __builtin_bit_cast(uint32_t, __builtin_convertvector(pixels, bytes));
  return __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__ ? __builtin_bswap32(word) : word;
}

span_mask covered(const masked_polygon& p, const masked_row& row, const pixel_lanes&, int k) {
  constexpr int half = span_side / 2;
  constexpr rows down = {0, 1, 2, 3};
  int crossing[max_edges + at_once - 1] = {}, count = 0;  // and any edges where a group is not full
  for (int e = 0; e < p.edge_count; ++e) {
    crossing[count] = e;
    count += row.edge_at(p, e, k) + p.edges[e].least < 0;
  }
  span_mask outside = 0;
  for (int first = 0; first < count; first += at_once) {
    rows step[at_once], upper[at_once], lower[at_once];
    for (int n = 0; n < at_once; ++n) {
      const masked_polygon::pixel_edge& e = p.edges[crossing[first + n]];
      step[n] = rows{} + e.a;
      upper[n] = down * e.b + (row.near_edge(p, crossing[first + n], k) + e.a * (span_side - 1));
      lower[n] = upper[n] + e.b * half;
    }
    outside |= outside_of(step, upper) | span_mask(outside_of(step, lower)) << (span_side * half);
  }
  return ~outside;
}

span_mask nearer(const masked_polygon& p, const pixel_lanes&, int64_t, int32_t sx, int32_t sy, span_mask mask) { return depth_test(p.shape, sx, sy, mask, p.depth, p.frame_width, p.stores); }

#include "vectors/masks.hpp"

uint64_t max_of_0(int64_t x) { return x > 0 ? uint64_t(x) : 0; }
SPANTEX_WRAPS uint64_t sides_of(uint64_t x, uint64_t y) { return 2 * (span_side - 1) * (x + y); }

}  // namespace

masked_polygon::masked_polygon(const polygon& p, rectangle a, depth_buffer d, int32_t width, int32_t height, bool stored)
    : shape(p), area(a), depth(d), frame_width(width), frame_height(height), stores(stored), in_front(lies_in_front(p.map, a)),
      first_columns(rectangle_mask({a.x0, 0, first_span() * span_side + span_side, span_side}, first_span(), 0)),
      last_columns(rectangle_mask({a.x1 - 1 - (a.x1 - 1) % span_side, 0, a.x1, span_side}, (a.x1 - 1) / span_side, 0)),
      to_nearest(sides_of(max_of_0(p.depth.x), max_of_0(p.depth.y))), depth_extent(sides_of(magnitude(p.depth.x), magnitude(p.depth.y))), edge_count(p.edges.count) {
  constexpr int last = span_side - 1;
  for (int k = 0; k < edge_count; ++k) {
    const edge& e = p.edges.edges[k];
    const int32_t x = int32_t(e.a), y = int32_t(e.b), far_x = x * last, far_y = y * last;
    edges[k] = {x, y, e.at(centre_subpixels(0), centre_subpixels(0)) >> subpixel_bits, min_of(far_x, 0) + min_of(far_y, 0), max_of(far_x, 0) + max_of(far_y, 0)};
  }
}

row_cover words_cover() { return cover_row; }

row_cover cover_of(choice c) {
  switch (resolved(c)) {
    case choice::avx512:
    case choice::avx512_gathers: return avx512_cover();
    case choice::avx2: return avx2_cover();
    default: return words_cover();
  }
}

}  // namespace spantex::kernels
