// SPDX-License-Identifier: Apache-2.0
// The datapath's arithmetic with the whole map at hand: no jobs, no sections, no local memory, no correction. What a picture made of spans
// must equal, bit for bit, wherever the profile's local memory holds the section.
#pragma once
#include <tests/support.hpp>

namespace spantex::sim {

template <class Prof>
span_coefficients whole_map_coefficients(const Prof& prof, const surface& s, int32_t sx, int32_t sy, int i, int j) {
  const profile& q = prof.get();
  const int32_t cx = 16 * sx + 8, cy = 16 * sy + 8;
  span_coefficients c{};
  c.kind = s.kind;
  c.last_level = uint8_t(s.texture->last_level());
  const bool major = q.formula == level_formula::major;
  if (s.map->w_at(cx, cy) > 0) {
    const reference r = reference_at(*s.map, cx, cy);
    if (span_coordinates(*s.map, r, q, c)) {
      if (major) major_levels(*s.map, r, c);
      else span_levels(q, c);
      return c;
    }
  }
  const int32_t hx = cx + half_pixels(i), hy = cy + half_pixels(j);
  const reference r = reference_at(*s.map, hx, hy);
  pixel_coordinates(r, q, c);
  if (major) major_levels(*s.map, r, c);
  else pixel_levels(*s.map, r, hx, hy, c);
  return c;
}

inline uint32_t channel_of(rgba8 c, int k) { return k == 0 ? c.r : k == 1 ? c.g : k == 2 ? c.b : c.a; }

// One level of one channel at a position.
inline partial_colour whole_map_blend(const profile& q, const texture_view& t, filter kind, int level, const snapped_position& p,
                                      int channel) {
  const auto texel = [&](int x, int y) {
    return channel_of(t.texel(level, t.wrapped_u(p.u + x, level), t.wrapped_v(p.v + y, level)), channel);
  };
  const texels2x2 four{texel(0, 0), texel(1, 0), texel(0, 1), texel(1, 1)};
  return uses_three_points(kind) ? three_point(four, p.fraction, q) : four_point(four, p.fraction, q);
}

inline section whole_level(const texture_view& t, int level) {
  return {0, 0, t.ratio_u(level), t.ratio_v(level), uint8_t(level), t.width(level) == 1, t.height(level) == 1};
}

template <class Prof>
rgba8 whole_map_pixel(const Prof& prof, const surface& s, int32_t x, int32_t y) {
  const profile& q = prof.get();
  const texture_view& t = *s.texture;
  const int i = x % 8, j = y % 8;
  const span_coefficients c = whole_map_coefficients(prof, s, x / 8, y / 8, i, j);
  const texel_position at = position_at(prof, c, i, j);
  const int32_t detail = uses_levels(s.kind) ? level_at(prof, c, i, j) : 0;
  const int level = integer_level(s.kind, detail, q.level_bits, c.last_level);
  const snapped_position fine = snap(at, whole_level(t, level), s.kind, q);
  if (s.kind == filter::nearest) return t.texel(0, t.wrapped_u(fine.u, 0), t.wrapped_v(fine.v, 0));
  const bool two = uses_two_levels(s.kind) && level < t.last_level();
  uint8_t out[4];
  for (int k = 0; k < 4; ++k) {
    partial_colour colour = whole_map_blend(q, t, s.kind, level, fine, k);
    if (two) {
      const snapped_position coarse = snap(at, whole_level(t, level + 1), s.kind, q);
      const int32_t fraction = detail - (level << q.level_bits);
      colour = between_levels(colour, whole_map_blend(q, t, s.kind, level + 1, coarse, k), uint32_t(fraction), q);
    }
    out[k] = written(colour, q);
  }
  return {out[0], out[1], out[2], out[3]};
}

template <class Prof>
void draw_whole_map(const Prof& prof, const surface& s, rectangle area, picture& out) {
  for (int32_t y = area.y0; y < area.y1; ++y)
    for (int32_t x = area.x0; x < area.x1; ++x)
      if (s.map->w_at(2 * x + 1, 2 * y + 1) > 0) out.pixels[size_t(y) * size_t(out.width) + size_t(x)] = whole_map_pixel(prof, s, x, y);
}

}  // namespace spantex::sim
