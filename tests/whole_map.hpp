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
  if (s.kind == filter::contour) c.contour = terms_of(s.texture->contour());
  if (s.map->w_at(cx, cy) > 0) {
    reference r;
    if (spantex::detail::coordinates_of_span(prof, s, cx, cy, r, c)) {
      if (uses_area(s.kind)) return c;
      if (uses_footprint(s.kind)) span_axis(q, c);
      else formula_levels(q, *s.map, r, c);
      if (s.kind == filter::contour) span_contour(q, c);
      return c;
    }
  }
  const int32_t hx = cx + half_pixels(i), hy = cy + half_pixels(j);
  reference r;
  spantex::detail::coordinates_of_pixel(prof, s, hx, hy, r, c);
  if (uses_area(s.kind)) return c;
  if (uses_footprint(s.kind)) pixel_axis(*s.map, q, hx, hy, c);
  else formula_levels_of_pixel(q, *s.map, r, hx, hy, c);
  if (s.kind == filter::contour) pixel_contour(*s.map, hx, hy, c);
  return c;
}

inline uint32_t channel_of(rgba8 c, int k) { return k == 0 ? c.r : k == 1 ? c.g : k == 2 ? c.b : c.a; }

inline texels2x2 whole_map_texels(const texture_view& t, int level, const snapped_position& p, int channel) {
  const auto texel = [&](int x, int y) {
    return channel_of(t.texel(level, t.wrapped_u(p.u + x, level), t.wrapped_v(p.v + y, level)), channel);
  };
  return {texel(0, 0), texel(1, 0), texel(0, 1), texel(1, 1)};
}

// One level of one channel at a position.
inline partial_colour whole_map_blend(const profile& q, const texture_view& t, filter kind, int level, const snapped_position& p,
                                      int channel) {
  const texels2x2 four = whole_map_texels(t, level, p, channel);
  return uses_three_points(kind) ? three_point(four, p.fraction, q) : four_point(four, p.fraction, q);
}

inline section whole_level(const texture_view& t, int level) {
  return {0, 0, t.ratio_u(level), t.ratio_v(level), uint8_t(level), t.width(level) == 1, t.height(level) == 1};
}

// All samples of a footprint, texel by texel.
template <class Prof>
rgba8 whole_map_footprint(const Prof& prof, const texture_view& t, const span_coefficients& c, int i, int j) {
  const profile& q = prof.get();
  const texel_position centre = position_at(prof, c, i, j);
  const footprint f = footprint_at(prof, c, i, j);
  const int level = integer_level(c.kind, f.level, q.level_bits, c.last_level), fraction = f.level - (level << q.level_bits);
  footprint_sums sums{};
  for (int k = 0; k < f.samples; ++k) {
    if (c.kind == filter::squares) {
      const snapped_position p = snap(centre, whole_level(t, level), c.kind, q);
      const square s = square_at(f, p.fraction, q.subtexel_bits, k);
      for (int n = 0; n < 4; ++n) {
        const rgba8 texel = t.texel(level, t.wrapped_u(p.u + s.u + (n & 1), level), t.wrapped_v(p.v + s.v + (n >> 1), level));
        for (int channel = 0; channel < 4; ++channel)
          sums.channel[channel] += channel_of(texel, channel) * s.weight[n] * uint32_t(s.row_weight);
        sums.weight += s.weight[n] * uint32_t(s.row_weight);
      }
      continue;
    }
    const texel_position at = sample_position(centre, f, k);
    const bool two = level < t.last_level();
    partial_colour colour{};
    for (int channel = 0; channel < 4; ++channel) {
      colour = whole_map_blend(q, t, c.kind, level, snap(at, whole_level(t, level), c.kind, q), channel);
      if (two) {
        const snapped_position coarse = snap(at, whole_level(t, level + 1), c.kind, q);
        colour = between_levels(colour, whole_map_blend(q, t, c.kind, level + 1, coarse, channel), uint32_t(fraction), q);
      } else {
        colour = kept_of_level(colour, q);
      }
      colour = summable(colour, q);
      sums.channel[channel] += colour.value;
    }
    sums.weight += 1u << colour.bits;
  }
  return mean_colour(sums, q.colour_rounding);
}

// Step and hat: every texel of the window by its weight.
template <class Prof>
rgba8 whole_map_area(const Prof& prof, const texture_view& t, const span_coefficients& c, int i, int j) {
  const profile& q = prof.get();
  const int level = spantex::detail::area_level(prof, t, c, i, j);
  const area_window w = area_window_at(prof, c, i, j, whole_level(t, level));
  area_weights area(w, c.kind);
  const bool linear = q.linear_light && t.colours() == colour_space::srgb;
  footprint_sums sums{};
  for (int row = 0; row < w.rows; ++row) {
    int32_t weight[max_area_side];
    area.next_row(weight);
    for (int column = 0; column < w.columns; ++column) {
      const rgba8 texel = t.texel(level, t.wrapped_u(w.u + column, level), t.wrapped_v(w.v + row, level));
      const uint32_t share = uint32_t(linear ? linear_weight(weight[column], linear_weight_drop(w)) : weight[column]);
      for (int channel = 0; channel < 4; ++channel) {
        const uint32_t value = channel_of(texel, channel);
        sums.channel[channel] += (linear && channel != alpha_channel ? srgb_decoded(value) : value) * share;
      }
      sums.weight += share;
    }
  }
  return linear ? mean_linear_colour(sums, q.colour_rounding) : mean_colour(sums, q.colour_rounding);
}

template <class Prof>
rgba8 whole_map_pixel(const Prof& prof, const surface& s, int32_t x, int32_t y) {
  const profile& q = prof.get();
  const texture_view& t = *s.texture;
  const int i = x % 8, j = y % 8;
  span_coefficients c = whole_map_coefficients(prof, s, x / 8, y / 8, i, j);
  if (uses_area(s.kind)) return whole_map_area(prof, t, c, i, j);
  if (uses_footprint(s.kind)) return whole_map_footprint(prof, t, c, i, j);
  const texel_position at = position_at(prof, c, i, j);
  const int32_t detail = uses_levels(s.kind) ? level_at(prof, c, i, j) : 0;
  const int level = integer_level(s.kind, detail, q.level_bits, c.last_level);
  const snapped_position fine = snap(at, whole_level(t, level), s.kind, q);
  if (s.kind == filter::nearest) return t.texel(0, t.wrapped_u(fine.u, 0), t.wrapped_v(fine.v, 0));
  const bool two = uses_two_levels(s.kind) && level < t.last_level();
  c.two_levels = two;
  c.fine.level = uint8_t(level);
  uint8_t out[4];
  for (int k = 0; k < 4; ++k) {
    partial_colour colour = whole_map_blend(q, t, s.kind, level, fine, k);
    if (s.kind == filter::contour && k == alpha_channel) {
      const snapped_position coarse = two ? snap(at, whole_level(t, level + 1), s.kind, q) : fine;
      const partial_colour above = two ? whole_map_blend(q, t, s.kind, level + 1, coarse, k) : colour;
      const uint32_t fraction = two ? uint32_t(detail - (level << q.level_bits)) : 0;
      field_gradient d = gradient_of(whole_map_texels(t, level, fine, k), fine.fraction, q.subtexel_bits);
      if (two) d = between_levels(d, gradient_of(whole_map_texels(t, level + 1, coarse, k), coarse.fraction, q.subtexel_bits), fraction, q.level_bits);
      out[k] = contour_coverage(contour_distance(prof, c, contour_field(colour, above, fraction, c, q), d, i, j), c.contour.outline);
      continue;
    }
    if (uses_two_levels(s.kind)) colour = kept_of_level(colour, q);
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
