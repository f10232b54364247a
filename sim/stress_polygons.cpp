// SPDX-License-Identifier: Apache-2.0
#include "sim/stress_polygons.hpp"

#include <spantex/coverage.hpp>
#include <spantex/polygon.hpp>

#include <algorithm>

#include "sim/random.hpp"

namespace spantex::sim {

bool check_polygons(uint64_t seed, stress_row& row) {
  random_source r(seed);
  constexpr int side_px = 64;
  const projection camera{1 << 16, 1 << 16, 0, 0, 1 << 10};
  const int spread = 1 + int(r.below(24));
  const int64_t z_spread = int64_t(1) << r.below(14);
  const auto corner = [&](int32_t x_16, int32_t y_16) {  // at a depth of its own, seen at the pixel position given
    const int32_t z = (1 << 16) + int32_t(r.below(uint32_t(z_spread)));
    return vertex{int32_t((int64_t(x_16) * z) >> 16), int32_t((int64_t(y_16) * z) >> 16), z, int32_t(r.below(1 << 24)),
                  int32_t(r.below(1 << 24))};
  };
  constexpr int rim_max = 32;
  vertex rim[rim_max];
  int count = 0;
  const int32_t end = side_px << 16;
  for (int edge = 0; edge < 4; ++edge) {
    const int steps = 1 + int(r.below(uint32_t(std::min(spread, 7))));
    uint32_t cuts[8] = {0};
    for (int k = 1; k < steps; ++k) cuts[k] = r.below(uint32_t(end));
    std::sort(cuts, cuts + steps);
    for (int k = 0; k < steps; ++k) {
      const int32_t t = int32_t(cuts[k]);
      rim[count++] = edge == 0 ? corner(t, 0) : edge == 1 ? corner(end, t) : edge == 2 ? corner(end - t, end) : corner(0, end - t);
    }
  }
  const vertex hub = corner(int32_t(r.below(uint32_t(end))), int32_t(r.below(uint32_t(end))));
  uint8_t drawn[side_px * side_px] = {};
  bool good = true;
  for (int k = 0; k < count; ++k) {
    const vertex triangle[3] = {hub, rim[k], rim[(k + 1) % count]};
    polygon p;
    if (make_polygon(triangle, 3, camera, {0, 0, side_px, side_px}, p) != status::ok) continue;
    for (int sy = 0; sy < side_px / span_side; ++sy)
      for (int sx = 0; sx < side_px / span_side; ++sx)
        for (span_mask mask = coverage(p.edges, sx, sy) & rectangle_mask(p.box, sx, sy); mask != 0; mask &= mask - 1) {
          const int bit = __builtin_ctzll(mask), x = sx * span_side + bit % span_side, y = sy * span_side + bit / span_side;
          ++drawn[y * side_px + x];
          good = good && p.map.w_at(2 * x + 1, 2 * y + 1) > 0;
          ++row.polygon_pixels;
        }
  }
  for (int y = 1; y < side_px - 1; ++y)
    for (int x = 1; x < side_px - 1; ++x) good = good && drawn[y * side_px + x] == 1;
  return good;
}

}  // namespace spantex::sim
