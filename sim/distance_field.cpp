// SPDX-License-Identifier: Apache-2.0
#include "distance_field.hpp"

#include <algorithm>
#include <utility>

#include "file.hpp"

namespace spantex::sim {
namespace {

constexpr int64_t far_away = 1 << 20;  // more than any side

// Distance along the column to the nearest pixel of the kind, far_away if none.
std::vector<int64_t> column_distances(const mask& m, bool of) {
  const int w = m.width_px, h = m.height_px;
  std::vector<int64_t> d(size_t(w) * size_t(h));
  const auto at = [&](int x, int y) -> int64_t& { return d[size_t(y) * size_t(w) + size_t(x)]; };
  for (int x = 0; x < w; ++x) {
    for (int y = 0; y < h; ++y) at(x, y) = m.at(x, y) == of ? 0 : y == 0 ? far_away : std::min(far_away, at(x, y - 1) + 1);
    for (int y = h - 2; y >= 0; --y) at(x, y) = std::min(at(x, y), at(x, y + 1) + 1);
  }
  return d;
}

int64_t floor_divided(int64_t a, int64_t b) { return a / b - (a % b != 0 && (a < 0) != (b < 0) ? 1 : 0); }

// Lower envelope of the parabolas (x - i)^2 + g[i]^2 along a row.
void row_distances(const int64_t* g, int w, int64_t* out) {
  std::vector<int64_t> centre, from;
  const auto value = [&](int64_t x, int64_t i) { return (x - i) * (x - i) + g[i] * g[i]; };
  for (int64_t u = 0; u < w; ++u) {
    if (g[u] >= far_away) continue;
    while (!centre.empty() && value(from.back(), centre.back()) > value(from.back(), u)) {
      centre.pop_back();
      from.pop_back();
    }
    if (centre.empty()) {
      centre.push_back(u);
      from.push_back(0);
      continue;
    }
    const int64_t i = centre.back(), first = 1 + floor_divided(u * u - i * i + g[u] * g[u] - g[i] * g[i], 2 * (u - i));
    if (first >= w) continue;
    centre.push_back(u);
    from.push_back(first);
  }
  for (int64_t x = w - 1, k = int64_t(centre.size()) - 1; x >= 0; --x) {
    if (k < 0) {
      out[x] = no_distance;
      continue;
    }
    out[x] = value(x, centre[size_t(k)]);
    if (x == from[size_t(k)]) --k;
  }
}

// round(256 sqrt(x)).
int32_t root_256(int64_t x) {
  const uint64_t n = uint64_t(x) << 18;  // (2 256)^2 x
  uint64_t root = 0;
  for (uint64_t bit = uint64_t(1) << 31; bit != 0; bit >>= 1)
    if ((root + bit) * (root + bit) <= n) root += bit;
  return int32_t((root + 1) / 2);
}

uint8_t coded(int64_t sum, int64_t count, int scale, int level) {
  // 128 + scale mean / (256 2^level), to nearest
  const int64_t d = count * 256 * (int64_t(1) << level), n = scale * sum;
  const int64_t rounded = floor_divided(2 * n + d, 2 * d);
  return uint8_t(std::clamp<int64_t>(128 + rounded, 0, 255));
}

}  // namespace

mask make_mask(const image& picture, inside_by rule) {
  const bool opaque = std::all_of(picture.pixels.begin(), picture.pixels.end(), [](const rgba8& c) { return c.a == 255; });
  if (rule == inside_by::either) rule = opaque ? inside_by::light : inside_by::alpha;
  mask m{picture.width_px, picture.height_px, {}};
  for (const rgba8& c : picture.pixels) {
    const bool light = 299 * c.r + 587 * c.g + 114 * c.b >= 128000;
    m.inside.push_back(rule == inside_by::alpha ? c.a >= 128 : light == (rule == inside_by::light));
  }
  return m;
}

std::vector<int64_t> squared_distances(const mask& m, bool of) {
  const std::vector<int64_t> columns = column_distances(m, of);
  std::vector<int64_t> out(columns.size());
  for (int y = 0; y < m.height_px; ++y) {
    const size_t row = size_t(y) * size_t(m.width_px);
    row_distances(columns.data() + row, m.width_px, out.data() + row);
  }
  return out;
}

std::vector<int32_t> signed_distances(const mask& m) {
  const std::vector<int64_t> to_inside = squared_distances(m, true), to_outside = squared_distances(m, false);
  std::vector<int32_t> out;
  for (size_t k = 0; k < m.inside.size(); ++k) {
    const bool in = m.inside[k] != 0;
    const int64_t square = in ? to_outside[k] : to_inside[k];
    const int32_t distance = square == no_distance ? 1 << 30 : root_256(square) - 128;
    out.push_back(in ? distance : -distance);
  }
  return out;
}

std::vector<image> make_field_levels(const image& picture, int reduction, int scale, rgba8 colour, inside_by rule) {
  if (scale < 1 || scale > 64) throw input_error("field: scale outside 1..64 units a texel");
  if (reduction < 1 || picture.width_px % reduction != 0 || picture.height_px % reduction != 0)
    throw input_error("field: the picture's sides are not multiples of " + std::to_string(reduction));
  const std::vector<int32_t> distance = signed_distances(make_mask(picture, rule));
  int w = picture.width_px / reduction, h = picture.height_px / reduction;
  // Sums over the squares of a level's texels; counts differ where sides are odd.
  struct cell { int64_t sum = 0, count = 0; };
  std::vector<cell> cells(size_t(w) * size_t(h));
  for (int y = 0; y < h * reduction; ++y)
    for (int x = 0; x < w * reduction; ++x) {
      cell& c = cells[size_t(y / reduction) * size_t(w) + size_t(x / reduction)];
      c.sum += distance[size_t(y) * size_t(picture.width_px) + size_t(x)];
      c.count += reduction;  // distances are in pixels, `reduction` to a texel
    }
  std::vector<image> levels;
  for (int level = 0;; ++level) {
    image& out = levels.emplace_back(w, h, colour);
    for (size_t k = 0; k < cells.size(); ++k) out.pixels[k].a = coded(cells[k].sum, cells[k].count, scale, level);
    if (w == 1 && h == 1) break;
    const int next_w = level_side(w, 1), next_h = level_side(h, 1);
    std::vector<cell> next(size_t(next_w) * size_t(next_h));
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        cell& c = next[size_t(std::min(y / 2, next_h - 1)) * size_t(next_w) + size_t(std::min(x / 2, next_w - 1))];
        c.sum += cells[size_t(y) * size_t(w) + size_t(x)].sum;
        c.count += cells[size_t(y) * size_t(w) + size_t(x)].count;
      }
    cells = std::move(next);
    w = next_w;
    h = next_h;
  }
  return levels;
}

contour_style field_style(int scale, int outline_16) {
  if (outline_16 < 0 || outline_16 > 255) throw input_error("field: outline outside 0..255 sixteenths of a pixel");
  contour_style style;
  style.scale = uint16_t(scale << 8);
  style.outline = uint8_t(outline_16);
  style.unit = field_unit::own_level;
  return style;
}

texture_map make_field_map(const image& picture, int reduction, int scale, int outline_16, rgba8 colour, wrap u, wrap v) {
  texture_map map(make_field_levels(picture, reduction, scale, colour), u, v);
  map.set_contour(field_style(scale, outline_16));
  return map;
}

}  // namespace spantex::sim
