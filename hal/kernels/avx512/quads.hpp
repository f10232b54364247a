// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: how a span's 64 pixels are cut into four quads of sixteen, a register each. Included by ../avx512.cpp alone.
//
// What a quad takes must lie in local memory together. Where the map is minified along one axis of the screen alone, as on a floor or a wall to the side, square
// quads reach far along that axis and hardly along the other; quads two pixels high, or wide, reach as far as they need to along both.
#pragma once

enum class cut : uint8_t {
  square,  // 4x4 pixels: left and right of the top, left and right of the bottom; lane 4 y + x
  flat,    // 8x2: from the top down; lane 8 y + x
  tall,    // 2x8: from left to right; lane 2 y + x
};

// Half pixels from a span's centre to those of its pixels. Lane n of the first quad: across[n % 4] + down[n / 4]. Quads 1 and 3 lie `right` of 0 and 2, and 2 and 3 `below` 0
// and 1, wherever that is.
struct quad_steps { int32_t x[quad_side], y[quad_side]; };
struct quad_cut {
  quad_steps across, down;
  int32_t right_x, right_y, below_x, below_y;
  int32_t half_x, half_y;      // how far a quad's pixels lie from its centre
  int32_t centre_x, centre_y;  // how far its centre lies from the span's
  int32_t beyond_x, beyond_y;  // plan_bounds()
  span_mask pixels[quads];
};
constexpr quad_cut cuts[] = {
    {{{-7, -5, -3, -1}, {}}, {{}, {-7, -5, -3, -1}}, 8, 0, 0, 8, 3, 3, 4, 4, 0, 0, {0x000000000F0F0F0F, 0x00000000F0F0F0F0, 0x0F0F0F0F00000000, 0xF0F0F0F000000000}},
    {{{-7, -5, -3, -1}, {}}, {{0, 8, 0, 8}, {-7, -7, -5, -5}}, 0, 4, 0, 8, 7, 1, 0, 6, 0, 7, {0x000000000000FFFF, 0x00000000FFFF0000, 0x0000FFFF00000000, 0xFFFF000000000000}},
    {{{-7, -5, -7, -5}, {0, 0, 2, 2}}, {{}, {-7, -3, 1, 5}}, 4, 0, 8, 0, 1, 7, 6, 0, 7, 0, {0x0303030303030303, 0x0C0C0C0C0C0C0C0C, 0x3030303030303030, 0xC0C0C0C0C0C0C0C0}},
};
constexpr const quad_cut& cut_of(cut how) { return cuts[int(how)]; }

// Where a quad's corners are, and those of another quad's register.
struct alignas(64) corner_table {
  int32_t of_two[16];
  constexpr corner_table(int top_right, int bottom_left) : of_two() {
    const int lanes[] = {0, top_right, bottom_left, 15};
    for (int k = 0; k < 16; ++k) of_two[k] = lanes[k / 4] + 16 * (k % 2);
  }
};
constexpr corner_table corner_lanes[] = {{3, 12}, {7, 8}, {1, 14}};

// The square one, or what most of eight spans reach less far with, given the steps of their positions along x and y: by how far the wider axis of a quad reaches.
SPANTEX_INLINE cut best_cut(__m256i u_x, __m256i v_x, __m256i u_y, __m256i v_y, uint32_t spans) {
  const auto reach = [&](cut how) SPANTEX_INLINED {
    const quad_cut& c = cut_of(how);
    const auto of = [&](__m256i x, __m256i y) SPANTEX_INLINED {
      return _mm256_add_epi32(_mm256_mullo_epi32(_mm256_abs_epi32(x), _mm256_set1_epi32(c.half_x)), _mm256_mullo_epi32(_mm256_abs_epi32(y), _mm256_set1_epi32(c.half_y)));
    };
    return _mm256_max_epi32(of(u_x, u_y), of(v_x, v_y));
  };
  const __m256i square = reach(cut::square);
  const auto most_gain = [&](cut how) SPANTEX_INLINED { return 2 * __builtin_popcount(_mm256_cmplt_epi32_mask(reach(how), square) & spans) > __builtin_popcount(spans); };
  return most_gain(cut::flat) ? cut::flat : most_gain(cut::tall) ? cut::tall : cut::square;
}
