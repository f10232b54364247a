// SPDX-License-Identifier: Apache-2.0
#include "scene.hpp"

#include <math.h>

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

namespace spantex::sim {
namespace {

// The engine's own plane, for one so nearly edge-on that doubles find no other: what is drawn is decided by integers alone.
matrix matrix_of(const plane& p) {
  matrix m;
  const linear_form* const forms[3] = {&p.u, &p.v, &p.w};
  for (size_t k = 0; k < 3; ++k) {
    const linear_form& f = *forms[k];
    m[3 * k] = 2 * double(f.x);
    m[3 * k + 1] = 2 * double(f.y);
    m[3 * k + 2] = double(f.c) - double(f.x) * p.origin_x - double(f.y) * p.origin_y;
  }
  return m;
}

}  // namespace

void refuse_as_too_large(double x) { throw input_error("scene: number too large for the engine: " + std::to_string(x)); }

matrix ideal_of(const drawable& item) {
  if (!item.is_polygon) return item.plane_matrix;
  return matrix_of(item.corners.data(), int(item.corners.size()), item.camera).value_or(matrix_of(item.shape.map));
}

lens make_lens(screen_size size, double vertical_angle, double near_z) {
  const double focal = size.height_px / 2.0 / tan(vertical_angle / 2);
  const projection camera{to_fixed(focal), to_fixed(focal), to_fixed(size.width_px / 2.0), to_fixed(size.height_px / 2.0),
                          to_fixed(near_z)};
  return {camera, {0, 0, size.width_px, size.height_px}};
}

void add_polygon(scene& s, const lens& view, const vertex* vertices, int count, int map_index) {
  static constexpr auto colours = [] {
    std::array<rgba8, max_polygon_vertices> all{};
    all.fill(white);
    return all;
  }();
  add_polygon(s, view, vertices, colours.data(), count, map_index);
}

void add_polygon(scene& s, const lens& view, const vertex* vertices, const rgba8* colours, int count, int map_index) {
  if (view.skips_outside && is_outside(vertices, count, view.camera, view.clip)) {
    ++s.polygons_outside;
    return;
  }
  drawable& item = s.items.emplace_back();
  item.is_polygon = true;
  item.map_index = map_index;
  item.camera = view.camera;
  const status made = make_polygon(vertices, colours, count, view.camera, view.clip, item.shape, item.colours);
  if (made == status::ok) item.corners.assign(vertices, vertices + count);
  else s.items.pop_back();
  if (made != status::ok && made != status::degenerate) throw input_error(s.name + ": polygon: " + to_string(made));
}

void add_plane(scene& s, const matrix& m, int map_index) {
  drawable item{false, {}, map_index};
  item.plane_matrix = m;
  const status made = make_plane(to_homography(m), {0, 0, s.size.width_px, s.size.height_px}, item.shape.map);
  if (made == status::degenerate) return;
  if (made != status::ok) throw input_error(s.name + ": plane: " + to_string(made));
  s.items.push_back(item);
}

void add_plane(scene& s, const kt88_plane& q, const view& v, int map_index) {
  drawable item{false, {}, map_index};
  item.plane_matrix = matrix_of(q, v);
  const status made = make_plane(q, v, item.shape.map);
  if (made != status::ok) throw input_error(s.name + ": plane: " + to_string(made));
  s.items.push_back(item);
}

void nearest_first(scene& s) {
  const auto nearest = [](const drawable& d) {
    int32_t least = INT32_MAX;
    for (const vertex& v : d.corners) least = std::min(least, v.z);
    return std::max(least, d.camera.near_z);
  };
  std::vector<std::pair<int32_t, size_t>> order;
  for (size_t k = 0; k < s.items.size(); ++k) order.emplace_back(nearest(s.items[k]), k);
  std::sort(order.begin(), order.end());
  std::vector<drawable> sorted;
  sorted.reserve(order.size());
  for (const auto& [depth, k] : order) sorted.push_back(std::move(s.items[k]));
  s.items = std::move(sorted);
}

overdraw overdraw_of(const scene& s) {
  const int32_t columns = (s.size.width_px + span_side - 1) / span_side, rows = (s.size.height_px + span_side - 1) / span_side;
  std::vector<span_mask> shown(size_t(columns) * size_t(rows));
  overdraw sum;
  for (const drawable& d : s.items) {
    const polygon& p = d.shape;
    if (p.box.empty()) continue;
    for (int32_t sy = p.box.y0 / span_side; sy <= (p.box.y1 - 1) / span_side; ++sy)
      for (int32_t sx = p.box.x0 / span_side; sx <= (p.box.x1 - 1) / span_side; ++sx) {
        const span_mask mask = coverage(p.edges, sx, sy) & rectangle_mask(p.box, sx, sy) & front_mask(p.map, sx, sy);
        sum.pixels_tested += uint64_t(std::popcount(mask));
        shown[size_t(sy) * size_t(columns) + size_t(sx)] |= mask;
      }
  }
  for (const span_mask mask : shown) sum.pixels_shown += uint64_t(std::popcount(mask));
  return sum;
}

}  // namespace spantex::sim
