// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: how a span's 64 pixels are cut into four quads of sixteen, a register each. Included by by_blocks.hpp alone.
//
// What a quad takes must lie in local memory together. Where the map is minified along one axis of the screen alone, as on a floor or a wall to the side, square
// quads reach far along that axis and hardly along the other; quads two pixels high, or wide, reach as far as they need to along both.
#pragma once

enum class cut : uint8_t { square, flat, tall };  // 4x4, 8x2, 2x8 pixels

// Where the pixels of quads of width x height lie, in half pixels from their span's centre. A quad's lanes are its pixels row by row; quads fill the span row by row.
struct quad_cut {
  struct steps { int32_t x[quad_side], y[quad_side]; };
  steps across{}, down{};                           // lane n of the first quad: across[n % 4] + down[n / 4]
  int32_t right_x, right_y, below_x, below_y;       // from quads 0 and 2 to 1 and 3; from 0 and 1 to 2 and 3
  int32_t half_x, half_y, centre_x, centre_y;       // how far pixels lie from their quad's centre, and that from the span's
  span_mask pixels[quads]{};
  alignas(64) int32_t column[quads][16]{}, row[quads][16]{};  // lanes' in the span
  alignas(64) int32_t corners[16]{};                // a quad's first lane, the ends of its rows and columns, the last; and those of another quad's register

  constexpr quad_cut(int width, int height)
      : right_x(0), right_y(0), below_x(0), below_y(0), half_x(width - 1), half_y(height - 1), centre_x(span_side - width), centre_y(span_side - height) {
    const int in_a_row = span_side / width;
    const auto x = [&](int quad, int lane) { return quad % in_a_row * width + lane % width; };
    const auto y = [&](int quad, int lane) { return quad / in_a_row * height + lane / width; };
    for (int n = 0; n < quad_side; ++n) {
      across.x[n] = 2 * x(0, n) + 1 - span_side;
      across.y[n] = 2 * y(0, n) + 1 - span_side;
      down.x[n] = 2 * x(0, quad_side * n);
      down.y[n] = 2 * y(0, quad_side * n);
    }
    right_x = 2 * x(1, 0);
    right_y = 2 * y(1, 0);
    below_x = 2 * x(2, 0);
    below_y = 2 * y(2, 0);
    const int lanes[] = {0, width - 1, 16 - width, 15};
    for (int k = 0; k < 16; ++k) corners[k] = lanes[k / 4] + 16 * (k % 2);
    for (int quad = 0; quad < quads; ++quad)
      for (int lane = 0; lane < 16; ++lane) {
        column[quad][lane] = x(quad, lane);
        row[quad][lane] = y(quad, lane);
        pixels[quad] |= span_mask(1) << (span_side * y(quad, lane) + x(quad, lane));
      }
  }
};
constexpr quad_cut cuts[] = {{4, 4}, {8, 2}, {2, 8}};
constexpr const quad_cut& cut_of(cut how) { return cuts[int(how)]; }

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
