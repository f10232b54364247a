// SPDX-License-Identifier: Apache-2.0
// Any machine: four rows of pixels at once, in whatever lanes the compiler makes of four 32-bit numbers; depths pixel by pixel.
#include "masks.hpp"

namespace spantex::kernels {
namespace {

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

}  // namespace

row_cover words_cover() { return cover_row; }

}  // namespace spantex::kernels
