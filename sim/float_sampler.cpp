// SPDX-License-Identifier: Apache-2.0
#include "float_sampler.hpp"

#include <math.h>

#include <algorithm>
#include <array>

#include "reference.hpp"

namespace spantex::sim {
namespace {

using colour = std::array<float, channel_count>;
using float_matrix = std::array<float, 9>;

colour texel(const texture_view& t, int level, int x, int y) {
  const rgba8 c = t.texel(level, t.wrapped_u(x, level), t.wrapped_v(y, level));
  return {float(c.r), float(c.g), float(c.b), float(c.a)};
}

colour sum_of(const colour& a, float wa, const colour& b, float wb) {
  colour c;
  for (size_t k = 0; k < c.size(); ++k) c[k] = wa * a[k] + wb * b[k];
  return c;
}

colour four_point(const texture_view& t, int level, int x, int y, float fu, float fv) {
  const colour top = sum_of(texel(t, level, x, y), 1 - fu, texel(t, level, x + 1, y), fu);
  const colour bottom = sum_of(texel(t, level, x, y + 1), 1 - fu, texel(t, level, x + 1, y + 1), fu);
  return sum_of(top, 1 - fv, bottom, fv);
}

colour three_point(const texture_view& t, int level, int x, int y, float fu, float fv) {
  const bool lower = fv >= fu;
  const float big = lower ? fv : fu, small = lower ? fu : fv;
  const colour side = lower ? texel(t, level, x, y + 1) : texel(t, level, x + 1, y);
  const colour ends = sum_of(texel(t, level, x + 1, y + 1), small, texel(t, level, x, y), 1 - big);
  return sum_of(ends, 1, side, big - small);
}

colour on_level(const texture_view& t, int level, float u, float v, bool three) {
  const float lu = u * float(t.width(level)) / float(t.width()) - 0.5f, lv = v * float(t.height(level)) / float(t.height()) - 0.5f;
  const float left = floorf(lu), top = floorf(lv);
  return (three ? three_point : four_point)(t, level, int(left), int(top), lu - left, lv - top);
}

float level_of_detail(const float_matrix& m, float u, float v, float w) {
  const float ux = (m[0] - u * m[6]) / w, uy = (m[1] - u * m[7]) / w, vx = (m[3] - v * m[6]) / w, vy = (m[4] - v * m[7]) / w;
  return log2f(std::max(hypotf(ux, vx), hypotf(uy, vy)));
}

colour sample(const texture_view& t, filter kind, int mip_bias, const float_matrix& m, float x, float y) {
  const float w = m[6] * x + m[7] * y + m[8];
  const float limit = 1 << 20;
  const float u = std::clamp((m[0] * x + m[1] * y + m[2]) / w, -limit, limit);
  const float v = std::clamp((m[3] * x + m[4] * y + m[5]) / w, -limit, limit);
  const bool three = uses_three_points(kind);
  if (kind == filter::nearest) return texel(t, 0, int(floorf(u)), int(floorf(v)));
  if (!uses_levels(kind)) return on_level(t, 0, u, v, three);
  const float rho = level_of_detail(m, u, v, w);
  const float level = std::clamp(std::max(rho + float(mip_bias) / 16, std::min(rho, -5 * float(mip_bias) / 128)), 0.0f, float(t.last_level()));
  if (kind == filter::mip_bilinear) return on_level(t, std::max(0, int(ceilf(level + 0.5f)) - 1), u, v, false);
  const int fine = int(level);
  if (fine >= t.last_level()) return on_level(t, fine, u, v, three);
  const float fraction = level - float(fine);
  return sum_of(on_level(t, fine, u, v, three), 1 - fraction, on_level(t, fine + 1, u, v, three), fraction);
}

rgba8 rounded(const colour& c) {
  const auto byte = [](float x) { return uint8_t(std::clamp(x + 0.5f, 0.0f, 255.0f)); };
  return {byte(c[0]), byte(c[1]), byte(c[2]), byte(c[3])};
}

}  // namespace

image render_float(const scene& s, filter kind, int mip_bias, rgba8 background) {
  image out(s.size.width_px, s.size.height_px, background);
  const std::vector<int> shown = visible_items(s);
  std::vector<float_matrix> matrices;
  for (const drawable& item : s.items) {
    const matrix exact = ideal_of(item);
    std::transform(exact.begin(), exact.end(), matrices.emplace_back().begin(), [](double x) { return float(x); });
  }
  for (int j = 0; j < out.height_px; ++j)
    for (int i = 0; i < out.width_px; ++i) {
      const int index = shown[size_t(j) * size_t(out.width_px) + size_t(i)];
      if (index < 0) continue;
      out.at(i, j) = rounded(sample(s.texture(s.items[size_t(index)]), kind, mip_bias, matrices[size_t(index)], float(i) + 0.5f, float(j) + 0.5f));
    }
  return out;
}

}  // namespace spantex::sim
