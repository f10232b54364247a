// SPDX-License-Identifier: Apache-2.0
// Kernels: a whole span of single texels, moved one by one from the map to the picture by general registers. Included by the machines' files alone.
#pragma once

// Pixels x and x + 1, x even, of row y have their places in `from` at places[index(x, y)] and the next.
SPANTEX_INLINE void move_texels(const row_work& work, int32_t sx, const rgba8* from, const int32_t* places, auto&& index) {
  constexpr int of_first = __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__ ? 0 : 32;
  rgba8* row = work.pixels + int64_t(work.sy) * span_side * work.stride + sx * span_side;
#pragma GCC unroll 8
  for (int y = 0; y < span_side; ++y, row += work.stride)
#pragma GCC unroll 4
    for (int x = 0; x < span_side; x += 2) {
      uint64_t two;  // half as many loads
      __builtin_memcpy(&two, places + index(x, y), sizeof two);
      __builtin_memcpy(row + x, from + uint32_t(two >> of_first), sizeof(rgba8));
      __builtin_memcpy(row + x + 1, from + uint32_t(two >> (32 - of_first)), sizeof(rgba8));
    }
}
