// SPDX-License-Identifier: Apache-2.0
// Filters step and hat (GCK09; METHODS section 4; docs/SPEC.md "Footprints: step and hat"): the texels under the pixel's image on the map,
// weighted by how much of them it covers.
//
//   step   1 on the quadrilateral of the images of the pixel's corners
//   hat    1 at the image of its centre, 0 on the hexagon of the images of six neighbouring centres, linear in between: the mean of
//          hat_layers such hexagons, shrunk about the centre by (2m + 1) / (2 hat_layers)
//
// A footprint lies in a window of at most 2^area_side_log2 texels a side: the planner takes the finest level where it does, and what is
// too large on the last level is shrunk. Where local memory is smaller than the window, it is cut into tiles, and their sums are added.
// Weights are areas, integers; sums are divided by their sum, once.
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>
#include <spantex/coordinates.hpp>
#include <spantex/profile.hpp>
#include <spantex/span.hpp>

namespace spantex {

inline constexpr int max_area_corners = 6;
inline constexpr int max_area_side = 16;
inline constexpr int area_bits = 11;  // of a coordinate in a window: twice areas have 23, below 2^30 with their fraction
inline constexpr int hat_layers = 8;
constexpr int area_reach(const unit_variants& v) { return span_reach(v) + 2; }  // half pixels from a span's centre to the farthest corner

// Half pixels from a pixel's centre to its footprint's corners along an axis.
constexpr int area_margin(filter kind) { return kind == filter::hat ? 2 : 1; }
constexpr int corner_count(filter kind) { return kind == filter::hat ? 6 : 4; }
constexpr int layer_count(filter kind) { return kind == filter::hat ? hat_layers : 1; }

struct screen_offset { int8_t x, y; };  // half pixels
constexpr screen_offset area_corner(filter kind, int k) {
  constexpr screen_offset square[4] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, hexagon[6] = {{2, 0}, {2, 2}, {0, 2}, {-2, 0}, {-2, -2}, {0, -2}};
  return kind == filter::hat ? hexagon[k] : square[k];
}

// --- set-up side ---------------------------------------------------------------------------------------

// Coordinate part of a single pixel about its own centre, with slopes for its corners. Towards the horizon the footprint is clipped: it is
// halved about its centre until w stays in (1/2, 3/2) and it reaches no more than 2^max_extent_log2 texels. Out of range it is the
// square of +-2^10 texels for every half pixel: as good as the mean of the map.
constexpr void pixel_area_coordinates(const reference& r, const profile& q, span_coefficients& c, const unit_variants& v = {}) {
  c.centred = true;
  for (int k = 0; k < 62; ++k) {
    const auto halved = [k](int64_t slope) { return shift_right_symmetric(slope, k); };
    reference clipped = r;
    clipped.slope_drop = 0;  // what was dropped is clipped already
    clipped.a_u = halved(r.a_u);
    clipped.b_u = halved(r.b_u);
    clipped.a_v = halved(r.a_v);
    clipped.b_v = halved(r.b_v);
    clipped.g = halved(r.g);
    clipped.h = halved(r.h);
    if (coordinates_within(2, clipped, q, false, c, v)) return;
    if (!r.u_in_range || !r.v_in_range) break;
  }
  pixel_coordinates(r, q, c);
  c.exponent = int8_t(mantissa_exponent(q, max_extent_log2));
  c.c_u = c.c_v = 0;
  c.a_u = c.b_v = int32_t(1) << (10 + c.exponent);
}

// --- datapath side -------------------------------------------------------------------------------------

template <class Prof> using corner_offset = s<Prof::has_variants ? 5 : 4, 0>;
using wide_coordinate = s<16, 16>;  // texels of level 0: |base| <= 2^15 and at most 2^13 from it
template <class Prof> using steep_slope_of_w = s<-1, Prof::max_reciprocal_bits>;

struct wide_position { wide_coordinate u, v; };

// (x, y) half pixels from the centre of pixel (i, j).
template <class Prof>
constexpr wide_position position_beside(const Prof& prof, const span_coefficients& c, int i, int j, screen_offset d) {
  const auto hx = corner_offset<Prof>::from_raw((c.centred ? 0 : half_pixels_x<Prof>(c, i)) + d.x);
  const auto hy = corner_offset<Prof>::from_raw((c.centred ? 0 : half_pixels_y<Prof>(c, j)) + d.y);
  const uint32_t reciprocal = reciprocal_of(prof, c, slope_at<Prof, steep_slope_of_w<Prof>>(c, hx, hy));
  const auto at = [&](int32_t base, offset_mantissa<Prof> n) {
    return trust_to<wide_coordinate>(unlimited_coordinate_at(prof, c, base, n, reciprocal));
  };
  return {at(c.base_u, numerator_at<Prof>(c.c_u, c.a_u, c.b_u, hx, hy)), at(c.base_v, numerator_at<Prof>(c.c_v, c.a_v, c.b_v, hx, hy))};
}

// Texels of a level with subtexel_bits fraction bits, rounded once; texel k is [k, k + 1).
constexpr int32_t area_on_level(wide_coordinate x, uint32_t ratio, int level, const profile& q) {
  if (ratio == uint32_t(1) << 31) return int32_t(shift_right(int64_t(x.raw()), 16 + level - q.subtexel_bits, q.position_rounding));
  const auto scaled = x * u<0, 31>::from_raw(ratio);
  return int32_t(shift_right(int64_t(scaled.raw()), decltype(scaled)::fraction_bits + level - q.subtexel_bits, q.position_rounding));
}

// Texels from `low` to `high`, both with `bits` fraction bits; an interval's end is not part of it, a point's is.
constexpr int32_t last_texel(int32_t low, int32_t high, int bits) { return (high > low ? high - 1 : high) >> bits; }
constexpr int32_t texels_within(int32_t low, int32_t high, int bits) { return last_texel(low, high, bits) - (low >> bits) + 1; }

struct area_point { int32_t u, v; };

// A pixel's footprint on a level: texels (u, v) to (u + columns - 1, v + rows - 1); points relative to (u, v), `bits` fraction bits:
// subtexel_bits, less where the window's side would then take more than area_bits.
struct area_window {
  int32_t u, v;
  int columns, rows, bits;
  area_point centre, corner[max_area_corners];
};

namespace detail {

struct area_axis { int32_t first; int count; };

// Shrinks one axis about the centre, by halves, until it lies in the window, and makes it relative to the first texel.
constexpr area_axis fit_axis(area_window& w, int32_t area_point::*x, int corners, const profile& q) {
  const int bits = q.subtexel_bits;
  const int32_t centre = w.centre.*x;
  int32_t low = centre, high = centre;
  for (int k = 0; k < corners; ++k) {
    low = low < w.corner[k].*x ? low : w.corner[k].*x;
    high = high > w.corner[k].*x ? high : w.corner[k].*x;
  }
  const auto shrunk = [&](int32_t at, int k) { return centre + shift_right_symmetric(at - centre, k); };
  int halvings = 0;
  while (halvings < 24 && texels_within(shrunk(low, halvings), shrunk(high, halvings), bits) > 1 << q.area_side_log2) ++halvings;
  low = shrunk(low, halvings);
  const int32_t first = low >> bits, origin = first * (1 << bits);
  const int count = texels_within(low, shrunk(high, halvings), bits);
  for (int k = 0; k < corners; ++k) w.corner[k].*x = shrunk(w.corner[k].*x, halvings) - origin;
  w.centre.*x = centre - origin;
  return {first, count};
}

}  // namespace detail

template <class Prof>
constexpr area_window area_window_at(const Prof& prof, const span_coefficients& c, int i, int j, const section& at) {
  const profile& q = prof.get();
  const auto on_level = [&](screen_offset d) {
    const wide_position p = position_beside(prof, c, i, j, d);
    return area_point{area_on_level(p.u, at.ratio_u, at.level, q), area_on_level(p.v, at.ratio_v, at.level, q)};
  };
  const int corners = corner_count(c.kind);
  area_window w{};
  w.centre = on_level({0, 0});
  for (int k = 0; k < corners; ++k) w.corner[k] = on_level(area_corner(c.kind, k));
  const detail::area_axis u = detail::fit_axis(w, &area_point::u, corners, q), v = detail::fit_axis(w, &area_point::v, corners, q);
  w.u = u.first;
  w.columns = u.count;
  w.v = v.first;
  w.rows = v.count;
  w.bits = q.subtexel_bits;
  while (max_of(w.columns, w.rows) << w.bits > 1 << area_bits) --w.bits;
  const int drop = q.subtexel_bits - w.bits;
  const auto cut = [drop](area_point& p) { p = {shift_right(p.u, drop), shift_right(p.v, drop)}; };
  cut(w.centre);
  for (int k = 0; k < corners; ++k) cut(w.corner[k]);
  return w;
}

// The part of a window that one job covers.
struct area_tile { int column, row, columns, rows; };
constexpr int tiles_across(int cells, int side) { return (cells + side - 1) / side; }
constexpr int tile_count(const area_window& w, int side) { return tiles_across(w.columns, side) * tiles_across(w.rows, side); }
constexpr area_tile tile_at(const area_window& w, const axis_terms& part, int side) {
  if (!part.partial) return {0, 0, w.columns, w.rows};
  const int across = tiles_across(w.columns, side), column = part.first_sample % across * side, row = part.first_sample / across * side;
  return {column, row, min_of(side, w.columns - column), min_of(side, w.rows - row)};
}

// A convex polygon in a window; coordinates from 0 to cells 2^bits.
struct area_polygon {
  int count;
  area_point at[max_area_corners];
};

// Twice the area; positive if u turns to v.
constexpr int32_t twice_area(const area_polygon& p) {
  int32_t sum = 0;
  for (int k = 0; k < p.count; ++k) {
    const area_point& a = p.at[k];
    const area_point& b = p.at[k + 1 < p.count ? k + 1 : 0];
    sum += a.u * b.v - b.u * a.v;
  }
  return sum;
}

namespace detail {

inline constexpr int swept_bits = 5;  // 6 edges, each up to 3 roundings of half a unit: less than a whole one

// num t^2 / den to swept_bits fraction bits, to nearest; 0 <= t <= den; num, den <= 2^area_bits. Exact for t = den.
constexpr int32_t scaled_square(int32_t t, int32_t num, int32_t den) {
  const int32_t whole = num * t / den, rest = num * t % den;
  return t * whole * (1 << swept_bits) + (t * rest * (1 << swept_bits) + den / 2) / den;
}

// Twice the area to the right of an edge that runs from (x0, 0) by (dx, dy), dy > 0: all of its rows down to `top`, within x_end, and of
// the row from `top` to `bottom` (0 <= top <= bottom <= dy) what lies within x. In swept_bits fraction bits; below 2^30.
struct downward_edge { int32_t x0, dx, dy; };
constexpr int32_t swept_area(const downward_edge& e, int32_t top, int32_t bottom, int32_t x, int32_t x_end) {
  const int32_t width = e.dx < 0 ? -e.dx : e.dx, d = x - e.x0, at_top = e.dx * top, at_bottom = e.dx * bottom, at_x = d * e.dy;
  const auto scaled = [](int32_t twice) { return twice * (1 << (swept_bits + 1)); };
  const auto triangle = [&](int32_t t) { return (e.dx < 0 ? -1 : 1) * scaled_square(t, width, e.dy); };
  const int32_t above = (x_end - e.x0) * top;
  const bool right_of_top = at_x >= at_top, right_of_bottom = at_x >= at_bottom;
  if (right_of_top && right_of_bottom) return scaled(above + d * (bottom - top)) - triangle(bottom);
  if (!right_of_top && !right_of_bottom) return scaled(above) - triangle(top);
  const int32_t corner = scaled_square(d < 0 ? -d : d, e.dy, width);
  if (right_of_top) return scaled(above - d * top) + corner;
  return scaled(above + d * bottom) - triangle(top) - triangle(bottom) + corner;
}

// A polygon that rounding has left thinner than a unit on average becomes a strip one unit wide from end to end: its weights stay spread
// along it and their sum is never zero. `limit`: the window's far corner.
constexpr void thicken(area_polygon& p, area_point limit) {
  area_point low = p.at[0], high = p.at[0];
  for (int k = 1; k < p.count; ++k) {
    low = {low.u < p.at[k].u ? low.u : p.at[k].u, low.v < p.at[k].v ? low.v : p.at[k].v};
    high = {high.u > p.at[k].u ? high.u : p.at[k].u, high.v > p.at[k].v ? high.v : p.at[k].v};
  }
  const bool steep = high.v - low.v > high.u - low.u;
  const int32_t length = steep ? high.v - low.v : high.u - low.u, area = twice_area(p);
  if ((area < 0 ? -area : area) >= 2 * length && length > 0) return;
  int32_t area_point::*const along = steep ? &area_point::v : &area_point::u;
  int32_t area_point::*const across = steep ? &area_point::u : &area_point::v;
  const auto before = [&](const area_point& a, const area_point& b) {
    return a.*along < b.*along || (a.*along == b.*along && a.*across < b.*across);
  };
  area_point a = p.at[0], b = p.at[0];
  for (int k = 1; k < p.count; ++k) {
    if (before(p.at[k], a)) a = p.at[k];
    if (before(b, p.at[k])) b = p.at[k];
  }
  if (a.*along == b.*along) {  // a point
    if (b.*along < limit.*along) ++(b.*along);
    else --(a.*along);
  }
  // One unit aside at both ends, towards each other; where both are level, to the side that lies in the window.
  const int32_t rise = b.*across - a.*across;
  const int32_t aside = rise > 0 || (rise == 0 && a.*across < limit.*across) ? 1 : -1;
  area_point a2 = a, b2 = b;
  a2.*across += aside;
  b2.*across += rise == 0 ? aside : -aside;
  p = rise == 0 ? area_polygon{4, {a, a2, b2, b}} : area_polygon{4, {a, a2, b, b2}};
}

}  // namespace detail

// Coverage of a convex polygon, row of cells by row of cells. The area swept up to each cell, in the order of rows, is rounded down to
// a unit and never falls nor grows by more than a cell: so every cell is within [0, full] and errs by less than one unit, and the sum
// is the exact area (docs/SPEC.md has the proof). Units of half a square unit: a full cell is 2 4^bits.
// Adds to weight[0..columns - 1] what the polygon covers of row `row`; rows from 0 on, each once. `swept` starts at 0.
constexpr void add_covered(const area_polygon& p, int bits, int columns, int row, int32_t& swept, int32_t* weight) {
  const int32_t top = row * (1 << bits), bottom = top + (1 << bits), x_end = columns * (1 << bits);
  const bool clockwise = twice_area(p) > 0;
  int32_t sums[max_area_side] = {};
  for (int k = 0; k < p.count; ++k) {
    const area_point& a = p.at[k];
    const area_point& b = p.at[k + 1 < p.count ? k + 1 : 0];
    if (a.v == b.v) continue;
    const bool down = a.v < b.v;
    const area_point& high = down ? a : b;
    const area_point& low = down ? b : a;
    if (high.v >= bottom) continue;
    const detail::downward_edge e{high.u, low.u - high.u, low.v - high.v};
    const int32_t t0 = clamp_to(top - high.v, 0, e.dy), t1 = clamp_to(bottom - high.v, 0, e.dy);
    const bool left = down != clockwise;
    for (int n = 0; n < columns; ++n) {
      const int32_t area = detail::swept_area(e, t0, t1, (n + 1) * (1 << bits), x_end);
      sums[n] += left ? area : -area;
    }
  }
  for (int n = 0; n < columns; ++n) {
    const int32_t next = (sums[n] + 9) >> detail::swept_bits, cell = clamp_to(next - swept, 0, 2 << (2 * bits));
    swept += cell;
    weight[n] += cell;
  }
}

// Linear light sums 16-bit values: weights are cut to 16 bits in all, to nearest, but for what is not zero to no less than one.
constexpr int linear_weight_drop(const area_window& w) { return max_of(0, bit_length(uint64_t(w.columns * w.rows) << (2 * w.bits + 1)) - 15); }
constexpr int32_t linear_weight(int32_t weight, int drop) {
  return weight == 0 ? 0 : max_of(1, shift_right(weight, drop));
}

// Weights of a footprint's texels, row by row.
class area_weights {
 public:
  constexpr area_weights(const area_window& w, filter kind) : w_(w), kind_(kind) {}

  // The next row: weight[0..columns - 1]; all rows add up to less than 2^24.
  constexpr void next_row(int32_t* weight) {
    for (int n = 0; n < w_.columns; ++n) weight[n] = 0;
    for (int m = 0; m < layer_count(kind_); ++m)
      add_covered(layer(m), w_.bits, w_.columns, row_, swept_[m], weight);
    if (kind_ == filter::hat)
      for (int n = 0; n < w_.columns; ++n) weight[n] = shift_right(weight[n], 1);
    ++row_;
  }

 private:
  constexpr area_polygon layer(int m) const {
    area_polygon p{corner_count(kind_), {}};
    for (int k = 0; k < p.count; ++k) {
      const area_point& a = w_.corner[k];
      const auto part = [&](int32_t from, int32_t to) { return from + shift_right_symmetric((to - from) * (2 * m + 1), 4); };
      p.at[k] = kind_ == filter::hat ? area_point{part(w_.centre.u, a.u), part(w_.centre.v, a.v)} : a;
    }
    detail::thicken(p, {w_.columns * (1 << w_.bits), w_.rows * (1 << w_.bits)});
    return p;
  }

  const area_window& w_;
  filter kind_;
  int row_ = 0;
  int32_t swept_[hat_layers] = {};
};
static_assert(hat_layers == 8, "layers are shrunk by (2m + 1) / 16: a shift of 4");
}  // namespace spantex
