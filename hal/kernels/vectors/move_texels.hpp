// SPDX-License-Identifier: Apache-2.0
// Kernels: a whole span of single texels, moved one by one from the map to the picture by general registers. Included by the machines' files alone.
#pragma once

struct two_places { uint32_t first, second; };

// x86 reads both by one load; elsewhere two loads are fewer instructions.
SPANTEX_INLINE two_places places_at(const int32_t* places) {
#if defined(__x86_64__)
  uint64_t both;
  __builtin_memcpy(&both, places, sizeof both);
  return {uint32_t(both), uint32_t(both >> 32)};
#else
  return {uint32_t(places[0]), uint32_t(places[1])};
#endif
}

// Pixels x and x + 1, x even, of row y have their places in `from` at places[index(x, y)] and the next.
SPANTEX_INLINE void move_texels(const row_work& work, int32_t sx, const rgba8* from, const int32_t* places, auto&& index) {
  rgba8* row = work.pixels + sx * span_side;
#pragma GCC unroll 8
  for (int y = 0; y < span_side; ++y, row += work.stride)
#pragma GCC unroll 4
    for (int x = 0; x < span_side; x += 2) {
      const two_places at = places_at(places + index(x, y));
      uint32_t first, second;  // both read before either is written
      __builtin_memcpy(&first, from + at.first, sizeof first);
      __builtin_memcpy(&second, from + at.second, sizeof second);
      __builtin_memcpy(row + x, &first, sizeof first);
      __builtin_memcpy(row + x + 1, &second, sizeof second);
    }
}
