// SPDX-License-Identifier: Apache-2.0
// coverage() of a polygon's spans, row by row, four rows of pixels a vector: the same masks.
#pragma once
#include <stdint.h>

#include <spantex/coverage.hpp>

namespace spantex::kernels {

class polygon_coverage {
 public:
  explicit polygon_coverage(const edge_set& set) : count_(set.count) {
    constexpr int last = span_side - 1;
    for (int k = 0; k < count_; ++k) {
      const edge& e = set.edges[k];
      const int32_t a = int32_t(e.a), b = int32_t(e.b), far_x = a * last, far_y = b * last;
      edges_[k] = {a, b, e.at(centre_subpixels(0), centre_subpixels(0)) >> subpixel_bits, 0, min_of(far_x, 0) + min_of(far_y, 0), max_of(far_x, 0) + max_of(far_y, 0)};
    }
  }

  // Of the spans that are asked for next.
  void begin_row(int32_t sy) {
    for (int k = 0; k < count_; ++k) edges_[k].row = edges_[k].first + int64_t(edges_[k].b) * (sy * span_side);
  }

  span_mask of(int32_t sx) const {
    int32_t corners[max_edges];
    int crossing[max_edges + at_once - 1], count = 0;
    for (int k = 0; k < count_; ++k) {
      const pixel_edge& e = edges_[k];
      const int64_t corner = e.row + int64_t(e.a) * (sx * span_side);
      if (corner + e.most < 0) return 0;
      corners[k] = int32_t(corner);
      crossing[count] = k;
      count += corner + e.least < 0;
    }
    if (count == 0) return full_mask;
    for (int n = 1; n < at_once; ++n) crossing[count + n - 1] = crossing[count - 1];
    span_mask outside = 0;
    for (int k = 0; k < count; k += at_once) outside |= outside_of(corners, crossing + k);
    return ~outside;
  }

 private:
  static constexpr int at_once = 3;
  using rows = int32_t __attribute__((vector_size(16)));
  using bytes = uint8_t __attribute__((vector_size(4)));

  // An edge of whole pixels: a x + b y + first >= 0 inside; first is rounded down, so that the sign is that of edge::at() at the pixel's centre. Where an edge crosses a span its
  // values there are less than 2^27.
  struct pixel_edge {
    int32_t a, b;
    int64_t first, row;   // at pixel (0, 0); at the row's first
    int32_t least, most;  // that a pixel's value differs from the first pixel's
  };

  // Of one half of the span's rows, the first one's in the lowest byte. first: the edges' values at the last pixels of its rows.
  static uint32_t outside_of(const rows (&step)[at_once], const rows (&first)[at_once]) {
    rows value[at_once] = {first[0], first[1], first[2]}, pixels = {};
#pragma GCC unroll 8
    for (int i = 0; i < span_side; ++i) {  // from the last pixel of each row to the first
      pixels = pixels + pixels - ((value[0] | value[1] | value[2]) >> 31);
      for (int n = 0; n < at_once; ++n) value[n] -= step[n];
    }
    const uint32_t word = __builtin_bit_cast(uint32_t, __builtin_convertvector(pixels, bytes));
    return __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__ ? __builtin_bswap32(word) : word;
  }

  span_mask outside_of(const int32_t (&corners)[max_edges], const int* some) const {
    constexpr int half = span_side / 2;
    constexpr rows down = {0, 1, 2, 3};
    rows step[at_once], upper[at_once], lower[at_once];
    for (int n = 0; n < at_once; ++n) {
      const pixel_edge& e = edges_[some[n]];
      step[n] = rows{} + e.a;
      upper[n] = down * e.b + (corners[some[n]] + e.a * (span_side - 1));
      lower[n] = upper[n] + e.b * half;
    }
    return outside_of(step, upper) | span_mask(outside_of(step, lower)) << (span_side * half);
  }

  pixel_edge edges_[max_edges];
  int count_;
};

}  // namespace spantex::kernels
