// SPDX-License-Identifier: Apache-2.0
// Pictures drawn by rows that are the same on every target and whose instructions are counted: planes seen from one height, facing, tilted, grazing
// and rolled, on a map of 256 x 256 texels; with SPANTEX_SMALL of 64 x 64, which a device of 16 KiB keeps in flash.
#pragma once
#include <stdint.h>

#include <spantex/rows/draw.hpp>

namespace spantex::app {

#ifdef SPANTEX_SMALL
inline constexpr int map_side_log2 = 6;
#else
inline constexpr int map_side_log2 = 8;
#endif
inline constexpr int map_side = 1 << map_side_log2;

struct scene { const char* name; homography map; };

// Coefficients times 2^24, for 320 x 240 pixels and 256 texels; scaled to other sizes by scaled_to().
inline constexpr scene scenes[] = {
    {"facing", {15301708, -5280506, -1180954796, -5569355, -14507863, 4373107082, 0, 9696, 15041840}},
    {"tilted", {10432798, -2395894, -103030742, -3797299, -6582464, 4910790834, 0, 28698, 7340478}},
    {"grazing", {5216496, -575907, 28260670, -1898650, -1582252, 2674666434, 0, 35630, 910342}},
    {"rolled", {7613202, 7021541, -103030742, -7613202, 1621541, 3910790834, 14349, 24853, 6340478}}};

inline constexpr filter row_filters[] = {filter::nearest, filter::three_point, filter::bilinear, filter::mip_bilinear, filter::trilinear};
constexpr const char* name_of_filter(filter f) {
  constexpr const char* names[] = {"nearest", "bilinear", "three-point", "mip-bilinear", "trilinear"};
  return names[int(f)];
}

// The same view in a picture `down` times smaller each way.
constexpr homography scaled_to(const homography& m, int down) {
  return {multiply(m.a, down), multiply(m.b, down), m.c, multiply(m.d, down), multiply(m.e, down), m.f, multiply(m.g, down), multiply(m.h, down), m.i};
}

// A texel's colour: every one differs from its neighbours, so that a wrong texel shows.
SPANTEX_WRAPS constexpr uint16_t map_texel(int x, int y) {
  const uint32_t n = (uint32_t(x) * 73856093u ^ uint32_t(y) * 19349663u) * 2654435761u;
  return uint16_t((n >> 16 & 0x3186) + uint32_t((x >> 3 ^ y >> 3) & 1) * 0x8410 + (uint32_t(x + y) >> 5 & 7));
}

// Levels one after the other, each the mean of the one above.
inline constexpr int map_texel_count = (4 * map_side * map_side) / 3 + 1;
struct map_texels {
  uint16_t texel[map_texel_count];
  static constexpr int offset(int level) {
    int sum = 0;
    for (int k = 0; k < level; ++k) sum += map_side * map_side >> 2 * k;
    return sum;
  }
  constexpr void make() {
    for (int y = 0; y < map_side; ++y)
      for (int x = 0; x < map_side; ++x) texel[y * map_side + x] = map_texel(x, y);
    for (int level = 1, side = map_side / 2; level <= map_side_log2; ++level, side /= 2)
      for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
          const uint16_t* const p = texel + offset(level - 1) + 4 * y * side + 2 * x;
          const rows::texels t{p[0], p[1], p[2 * side], p[2 * side + 1]};
          texel[offset(level) + y * side + x] = rows::rounded(rows::four_point(t, 16, 16), 2 * rows::weight_bits);
        }
  }
  constexpr status view(wrap mode, texture_view& out) const {
    const uint16_t* levels[map_side_log2 + 1] = {};
    for (int k = 0; k <= map_side_log2; ++k) levels[k] = texel + offset(k);
    return texture_view::make(texel_format::rgb565, levels, map_side_log2 + 1, map_side, map_side, mode, mode, out);
  }
};

inline constexpr uint32_t hash_seed = 2166136261u;
SPANTEX_WRAPS inline uint32_t hash_of(const uint16_t* pixels, int count, uint32_t hash) {
  for (int k = 0; k < count; ++k) {
    hash = (hash ^ (pixels[k] & 255u)) * 16777619u;
    hash = (hash ^ (uint32_t(pixels[k]) >> 8)) * 16777619u;
  }
  return hash;
}

}  // namespace spantex::app
