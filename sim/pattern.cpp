// SPDX-License-Identifier: Apache-2.0
#include "pattern.hpp"

#include <algorithm>

namespace spantex::sim {
namespace {

// A hash of a lattice point, 0..255.
SPANTEX_WRAPS int lattice(uint32_t x, uint32_t y, uint32_t seed) {
  uint32_t h = x * 0x9E3779B1u ^ y * 0x85EBCA77u ^ seed * 0xC2B2AE3Du;
  h = (h ^ (h >> 15)) * 0x2C1B3C6Du;
  h = (h ^ (h >> 12)) * 0x297A2D39u;
  return int((h ^ (h >> 15)) >> 24);
}

// Lattice noise between cells of 2^cell_log2 texels, repeating over `side`, 0..255.
int noise(int x, int y, int cell_log2, int side, uint32_t seed) {
  const int cell = 1 << cell_log2, cells = std::max(1, side >> cell_log2), cx = x >> cell_log2, cy = y >> cell_log2;
  const int fx = x & (cell - 1), fy = y & (cell - 1);
  const auto at = [&](int i, int j) { return lattice(uint32_t((cx + i) % cells), uint32_t((cy + j) % cells), seed); };
  const int top = at(0, 0) * (cell - fx) + at(1, 0) * fx, bottom = at(0, 1) * (cell - fx) + at(1, 1) * fx;
  return (top * (cell - fy) + bottom * fy) >> (2 * cell_log2);
}

uint8_t byte(int x) { return uint8_t(std::clamp(x, 0, 255)); }

}  // namespace

image random_pattern(int side, uint32_t seed) {
  image out(side, side, {});
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const int coarse = noise(x, y, 3, side, seed), fine = noise(x, y, 1, side, seed + 1);
      const int dots = lattice(uint32_t(x), uint32_t(y), seed + 2);
      const int grain = 128 + ((3 * coarse + 2 * fine + dots) / 6 - 128) * 3 / 2;
      out.at(x, y) = {byte(grain), byte(grain * 15 / 16 + 8), byte(grain * 13 / 16 + 16), 255};
    }
  return out;
}

image squares_pattern(int side, int squares_per_side) {
  constexpr rgba8 ground{32, 40, 72, 255}, light{240, 236, 216, 255}, warm{208, 96, 48, 255};
  image out(side, side, ground);
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const int cx = x * squares_per_side / side, cy = y * squares_per_side / side;
      const int fx = x * squares_per_side % side, fy = y * squares_per_side % side, margin = side * 3 / 16;
      const bool inside = fx >= margin && fy >= margin && fx < side - margin && fy < side - margin;
      if (inside) out.at(x, y) = (cx + cy) % 2 == 0 ? light : warm;
    }
  return out;
}

image shapes_mask(int side) {
  image out(side, side, {0, 0, 0, 255});
  const auto inside = [](int x, int y) {  // in 1/1024 of the side, doubled: centres are odd
    const auto within = [&](int cx, int cy, int r) { return (x - cx) * (x - cx) + (y - cy) * (y - cy) < r * r; };
    const auto box = [&](int x0, int y0, int x1, int y1) { return x > x0 && x < x1 && y > y0 && y < y1; };
    const bool disc = within(520, 520, 300), ring = within(1520, 520, 320) && !within(1520, 520, 180);
    const bool cross = box(240, 1440, 800, 1600) || box(440, 1240, 600, 1800);
    const bool triangle = y < 1800 && 9 * (y - 1240) > 16 * (x > 1520 ? x - 1520 : 1520 - x);
    return disc || ring || cross || triangle;
  };
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      if (inside((2 * x + 1) * 1024 / side, (2 * y + 1) * 1024 / side)) out.at(x, y) = {255, 255, 255, 255};
  return out;
}

image chessboard_pattern(int side, int squares_per_side) {
  image out(side, side, {0, 0, 0, 255});
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      if ((x * squares_per_side / side + y * squares_per_side / side) % 2 != 0) out.at(x, y) = {255, 255, 255, 255};
  return out;
}

image photographic_pattern(int side, uint32_t seed) {
  image out(side, side, {});
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const auto channel = [&](uint32_t k) {
        int sum = 0;
        for (int log2 = 6; log2 >= 0; --log2) sum += (noise(x, y, log2, side, seed + k + uint32_t(log2)) - 128) * (1 << log2);
        const int edge = noise(x, y, 5, side, seed + 99) > 140 ? 40 : -24;
        return byte(128 + sum / 64 + edge);
      };
      out.at(x, y) = {channel(0), channel(100), channel(200), 255};
    }
  return out;
}

}  // namespace spantex::sim
