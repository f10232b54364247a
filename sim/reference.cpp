// SPDX-License-Identifier: Apache-2.0
#include "reference.hpp"

#include <math.h>

#include <algorithm>
#include <array>
#include <iterator>

#include <spantex/coverage.hpp>

namespace spantex::sim {
namespace {

// Wrapped index of any whole-numbered double, however large.
int32_t wrapped_index(wrap mode, double whole, int32_t size) {
  constexpr double limit = 1 << 29;
  if (fabs(whole) < limit) return wrapped(mode, int32_t(whole), size);
  if (!(whole == whole)) return 0;
  if (mode == wrap::clamp) return whole < 0 ? 0 : size - 1;
  return wrapped(mode, int32_t(fmod(whole, 2.0 * size)), size);
}

ideal_colour to_ideal(rgba8 c) { return {double(c.r), double(c.g), double(c.b), double(c.a)}; }

// IEC 61966-2-1, both scaled to 255.
double to_linear(double code) {
  const double x = code / 255;
  return 255 * (x <= 0.04045 ? x / 12.92 : pow((x + 0.055) / 1.055, 2.4));
}
double to_code(double linear) {
  const double x = linear / 255;
  return 255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - 0.055);
}

// A texel in the units that the map's colours are averaged in.
ideal_colour light_of(const texture_view& t, rgba8 c) {
  static const std::array<double, 256> linear = [] {
    std::array<double, 256> all{};
    for (size_t k = 0; k < all.size(); ++k) all[k] = to_linear(double(k));
    return all;
  }();
  return t.colours() == colour_space::srgb ? ideal_colour{linear[c.r], linear[c.g], linear[c.b], double(c.a)} : to_ideal(c);
}

void add_scaled(ideal_colour& sum, const ideal_colour& c, double weight) {
  for (size_t k = 0; k < c.size(); ++k) sum[k] += weight * c[k];
}

ideal_colour mean_over_pixel(const matrix& m, const texture_view& t, int i, int j) {
  ideal_colour sum{};
  int count = 0;
  for (int b = 0; b < reference_grid; ++b)
    for (int a = 0; a < reference_grid; ++a) {
      const ideal_position p = position(m, i + (a + 0.5) / reference_grid, j + (b + 0.5) / reference_grid);
      if (!(p.w > 0)) continue;
      add_scaled(sum, sample_bilinear(t, 0, p.u, p.v), 1);
      ++count;
    }
  for (double& x : sum) x /= count > 0 ? count : 1;
  if (t.colours() == colour_space::srgb)
    for (size_t k = 0; k < 3; ++k) sum[k] = to_code(sum[k]);
  return sum;
}

void show_plane(const scene& s, int item, std::vector<int>& shown) {
  const matrix& m = s.items[size_t(item)].plane_matrix;
  for (int j = 0; j < s.size.height_px; ++j)
    for (int i = 0; i < s.size.width_px; ++i)
      if (position(m, i + 0.5, j + 0.5).w > 0) shown[size_t(j) * size_t(s.size.width_px) + size_t(i)] = item;
}

void show_polygon(const scene& s, int item, std::vector<int>& shown, std::vector<uint32_t>& depth) {
  const polygon& p = s.items[size_t(item)].shape;
  for (int sy = p.box.y0 / span_side; sy <= (p.box.y1 - 1) / span_side; ++sy)
    for (int sx = p.box.x0 / span_side; sx <= (p.box.x1 - 1) / span_side; ++sx) {
      span_mask mask = coverage(p.edges, sx, sy) & rectangle_mask(p.box, sx, sy);
      if (mask != 0) mask &= front_mask(p.map, sx, sy);
      for (; mask != 0; mask &= mask - 1) {
        const int bit = __builtin_ctzll(mask), x = sx * span_side + bit % span_side, y = sy * span_side + bit / span_side;
        const size_t at = size_t(y) * size_t(s.size.width_px) + size_t(x);
        const uint32_t z = depth_at(p, 2 * x + 1, 2 * y + 1);
        if (z <= depth[at]) continue;
        depth[at] = z;
        shown[at] = item;
      }
    }
}

}  // namespace

ideal_colour sample_bilinear(const texture_view& t, int level, double u, double v) {
  const double left = floor(u - 0.5), top = floor(v - 0.5), fu = u - 0.5 - left, fv = v - 0.5 - top;
  const int32_t x0 = wrapped_index(t.wrap_u(), left, t.width(level)), x1 = wrapped_index(t.wrap_u(), left + 1, t.width(level));
  const int32_t y0 = wrapped_index(t.wrap_v(), top, t.height(level)), y1 = wrapped_index(t.wrap_v(), top + 1, t.height(level));
  ideal_colour sum{};
  add_scaled(sum, light_of(t, t.texel(level, x0, y0)), (1 - fu) * (1 - fv));
  add_scaled(sum, light_of(t, t.texel(level, x1, y0)), fu * (1 - fv));
  add_scaled(sum, light_of(t, t.texel(level, x0, y1)), (1 - fu) * fv);
  add_scaled(sum, light_of(t, t.texel(level, x1, y1)), fu * fv);
  return sum;
}

std::vector<int> visible_items(const scene& s) {
  const size_t count = size_t(s.size.width_px) * size_t(s.size.height_px);
  std::vector<int> shown(count, -1);
  std::vector<uint32_t> depth(s.uses_depth() ? count : 0, 0);
  for (int k = 0; k < int(s.items.size()); ++k) {
    if (s.items[size_t(k)].is_polygon) show_polygon(s, k, shown, depth);
    else show_plane(s, k, shown);
  }
  return shown;
}

ideal_image render_reference(const scene& s, rgba8 background, int threads, const progress_callback& rows_done) {
  const int width = s.size.width_px, height = s.size.height_px;
  ideal_image out{width, height, std::vector<ideal_colour>(size_t(width) * size_t(height))};
  const std::vector<int> shown = visible_items(s);
  std::vector<matrix> planes;
  std::transform(s.items.begin(), s.items.end(), std::back_inserter(planes), ideal_of);
  for_each_index(height, threads, [&](int j) {
    for (int i = 0; i < width; ++i) {
      const size_t at = size_t(j) * size_t(width) + size_t(i);
      if (shown[at] < 0) {
        out.pixels[at] = to_ideal(background);
        continue;
      }
      const size_t item = size_t(shown[at]);
      out.pixels[at] = mean_over_pixel(planes[item], s.texture(s.items[item]), i, j);
    }
    if (rows_done) rows_done(1);
  });
  return out;
}

}  // namespace spantex::sim
