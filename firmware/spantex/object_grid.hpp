// SPDX-License-Identifier: Apache-2.0
// The grid of a polygon textured in object space: turned parallel to the screen, its pitch, its texture and projection as linear forms
// (RD16; object_space.hpp tells what for, docs/METHODS.md, "Object space", derives it).
#pragma once
#include <stdint.h>

#include <spantex/accuracy.hpp>
#include <spantex/bits.hpp>
#include <spantex/level.hpp>
#include <spantex/log2.hpp>
#include <spantex/plane.hpp>
#include <spantex/polygon.hpp>
#include <spantex/status.hpp>
#include <spantex/wide.hpp>

namespace spantex {

inline constexpr int max_grid_side = 1 << 14;        // samples
inline constexpr int grid_tile_side = max_screen_px; // samples that one plane's formats cover
inline constexpr int whole_share = 256;

// --- rotation parallel to the screen -----------------------------------------------------------------------

// floor(sqrt(x)), one bit a step.
constexpr uint32_t floor_sqrt(uint64_t x) {
  uint64_t root = 0;
  for (int bit = 31; bit >= 0; --bit) {
    const uint64_t candidate = root | (uint64_t(1) << bit);
    if (candidate * candidate <= x) root = candidate;
  }
  return uint32_t(root);
}

// To nearest: floor(sqrt(x) + 1/2).
constexpr uint32_t nearest_sqrt(uint64_t x) {
  const uint64_t root = floor_sqrt(x);
  return uint32_t(root + (x - root * root > root ? 1 : 0));
}

// Axes of the turned polygon in camera space, unit vectors s1.30, each component within 2^-28:
//   across = (cos b, -sin a sin b, -cos a sin b), along = (0, cos a, -sin a), normal = (sin b, cos b sin a, cos b cos a)
// with cos b = dn = sqrt(Ny^2 + Nz^2), sin b = Nx, cos a = Nz / dn, sin a = Ny / dn; dn = 0: a = 0.
struct object_rotation { vector3 across, along, normal; };

namespace detail {

struct wide_vector { wide x, y, z; };

constexpr int32_t ratio_s1_30(int64_t n, int64_t d) {  // |n| <= d < 2^32
  const int64_t q = int64_t((magnitude(n) * (uint64_t(1) << 30) + uint64_t(d) / 2) / uint64_t(d));
  return int32_t(n < 0 ? -q : q);
}

struct int64_vector { int64_t x, y, z; };

constexpr int64_t cut_to(wide a, int drop) { return to_int64(scale_down(a, drop)); }
constexpr uint64_t squared(int64_t a) { return magnitude(a) * magnitude(a); }
constexpr int32_t product_s1_30(int32_t a, int32_t b) { return int32_t(shift_right_symmetric(int64_t(a) * b, 30)); }

}  // namespace detail

// Of a normal of any length but 0. The angle about x is taken from Ny and Nz alone, so that it keeps its precision however small they are.
constexpr object_rotation rotation_of(const detail::wide_vector& n) {
  using namespace detail;
  constexpr int32_t one = 1 << 30;
  const int yz_bits = max_of(bit_length(n.y), bit_length(n.z)), bits = max_of(bit_length(n.x), yz_bits);
  int32_t sin_a = 0, cos_a = one;
  if (yz_bits > 0) {
    const int64_t y = cut_to(n.y, yz_bits - 30), z = cut_to(n.z, yz_bits - 30);
    const int64_t length = nearest_sqrt(squared(y) + squared(z));
    sin_a = ratio_s1_30(y, length);
    cos_a = ratio_s1_30(z, length);
  }
  const int64_t x = cut_to(n.x, bits - 30), y = cut_to(n.y, bits - 30), z = cut_to(n.z, bits - 30);
  const int64_t dn = nearest_sqrt(squared(y) + squared(z)), length = nearest_sqrt(squared(x) + squared(y) + squared(z));
  const int32_t sin_b = ratio_s1_30(x, length), cos_b = ratio_s1_30(min_of(int(dn), int(length)), length);
  return {{cos_b, -product_s1_30(sin_a, sin_b), -product_s1_30(cos_a, sin_b)},
          {0, cos_a, -sin_a},
          {sin_b, product_s1_30(cos_b, sin_a), product_s1_30(cos_b, cos_a)}};
}

// --- set-up of the grid ------------------------------------------------------------------------------------

// Distance between samples on the polygon: mantissa 2^-exponent, camera units.
struct grid_pitch { uint32_t mantissa; int exponent; };

// What set-up leaves of a polygon. Positions on the grid are in samples from its corner; sample (i, j) is at (i + 1/2, j + 1/2).
struct object_grid {
  object_rotation axes;
  grid_pitch pitch;
  wide_form x, y, z;  // screen x z, y z (pixels) and z (camera units), 72 fraction bits
  wide_form u, v;     // texture coordinates times tex_w
  wide tex_w;
  int32_t width, height;      // samples
  int32_t near_z, far_z;      // s15.16: samples are taken between
  int16_t level;              // s5.10: one level of detail for all
};

namespace detail {

inline constexpr int grid_bits = 72;

constexpr int64_vector difference(const vertex& a, const vertex& b) { return {int64_t(a.x) - b.x, int64_t(a.y) - b.y, int64_t(a.z) - b.z}; }

constexpr wide_vector cross(const int64_vector& a, const int64_vector& b) {
  return {multiply(a.y, b.z) - multiply(a.z, b.y), multiply(a.z, b.x) - multiply(a.x, b.z), multiply(a.x, b.y) - multiply(a.y, b.x)};
}

constexpr wide dot(const int64_vector& a, const vector3& axis) { return multiply(a.x, axis.x) + multiply(a.y, axis.y) + multiply(a.z, axis.z); }

constexpr uint64_t size_of(const vertex& v) { return magnitude(v.x) + magnitude(v.y) + magnitude(v.z); }
constexpr int size_bits(const wide_vector& n) { return max_of(bit_length(n.x), max_of(bit_length(n.y), bit_length(n.z))); }

// Three vertices to hang the plane on: the nearest one, and the neighbours of its fan whose triangle is the largest (by a power of two).
struct corner_choice { int a, b, c; wide_vector normal; };
constexpr corner_choice choose_corners(const vertex* v, int count) {
  int a = 0;
  for (int k = 1; k < count; ++k)
    if (size_of(v[k]) < size_of(v[a])) a = k;
  corner_choice best{a, a, a, {}};
  for (int k = 1; k + 1 < count; ++k) {
    const int b = (a + k) % count, c = (a + k + 1) % count;
    const wide_vector n = cross(difference(v[b], v[a]), difference(v[c], v[a]));
    if (size_bits(n) > size_bits(best.normal)) best = {a, b, c, n};
  }
  return best;
}

// The part of the polygon within a pixel of the box.
constexpr edge_set visible_outline(const vertex* v, int count, const projection& camera, rectangle box) {
  edge_set o;
  for (int k = 0; k < count; ++k) o.edges[o.count++] = held(project(v[k], camera));
  clip_to_view(camera.near_z, {{box.x0 - 1, box.x1 + 1, box.y0 - 1, box.y1 + 1}, true}, o);
  return o;
}

// Smallest and largest of some numbers.
struct range {
  int64_t low = INT64_MAX, high = INT64_MIN;
  constexpr void include(int64_t x) {
    low = x < low ? x : low;
    high = x > high ? x : high;
  }
};

// x', y' from the anchor and depth of a polygon's visible part, 16 fraction bits.
struct visible_part { range across, along, z; };
constexpr visible_part measure(const edge_set& o, const vertex& anchor, const projection& camera, const object_rotation& r) {
  visible_part part;
  for (int k = 0; k < o.count; ++k) {
    const homogeneous_point p = corner_in(o.edges[k]);
    const int64_t x = (p.x * 65536 - p.z * camera.centre_x) / camera.focal_x, y = (p.y * 65536 - p.z * camera.centre_y) / camera.focal_y;
    const int64_vector d{x - anchor.x, y - anchor.y, p.z - anchor.z};
    part.across.include(cut_to(dot(d, r.across), 30));
    part.along.include(cut_to(dot(d, r.along), 30));
    part.z.include(p.z);
  }
  return part;
}

// |focal e + (centre - edge) e_z|, pixels, 16 fraction bits, rounded up.
constexpr uint64_t sweep(int32_t focal, int32_t centre, int32_t edge_px, int32_t e, int32_t e_z) {
  const wide s = multiply(focal, e) + multiply(int64_t(centre) - int64_t(edge_px) * 65536, e_z);
  return shift_right_floor(magnitude(s), 30).low + 1;
}

// Largest pixel movement per unit of x' plus that per unit of y', times depth: linear in the screen position, so the largest is at an end.
constexpr uint64_t axis_sweep(int32_t focal, int32_t centre, int32_t low_px, int32_t high_px, int32_t e1, int32_t e1_z, int32_t e2, int32_t e2_z) {
  const uint64_t low = sweep(focal, centre, low_px - 1, e1, e1_z) + sweep(focal, centre, low_px - 1, e2, e2_z);
  const uint64_t high = sweep(focal, centre, high_px + 1, e1, e1_z) + sweep(focal, centre, high_px + 1, e2, e2_z);
  return low > high ? low : high;
}

// Depth per unit of x' plus that per unit of y', 16 fraction bits, rounded up.
constexpr uint64_t depth_sweep(const object_rotation& r) { return ((magnitude(r.across.z) + magnitude(r.along.z)) >> 14) + 1; }

// The largest pitch that leaves no hole, times share / 256. Half a pitch on both axes moves a point at depth z by at most (p/2) S / (z - (p/2) E)
// pixels; that is 15/16 at the nearest depth for p = 30 z / (16 S + 15 E). Rounded down.
constexpr grid_pitch pitch_of(const object_rotation& r, const projection& camera, rectangle box, int64_t z, int share) {
  const uint64_t sx = axis_sweep(camera.focal_x, camera.centre_x, box.x0, box.x1, r.across.x, r.across.z, r.along.x, r.along.z);
  const uint64_t sy = axis_sweep(camera.focal_y, camera.centre_y, box.y0, box.y1, r.across.y, r.across.z, r.along.y, r.along.z);
  const uint64_t denominator = 16 * (sx > sy ? sx : sy) + 15 * depth_sweep(r), numerator = 30 * uint64_t(z) * uint64_t(share);
  const int up = 62 - bit_length(numerator);
  const uint64_t q = (numerator << up) / denominator;
  const int cut = max_of(0, bit_length(q) - 31);
  return {uint32_t(q >> cut), up + 8 - cut};
}

// x (16 fraction bits) in pitches, to nearest; false beyond 2^30.
constexpr bool in_pitches(int64_t x, grid_pitch p, int64_t& out) {
  if (bit_length(magnitude(x)) + p.exponent - 16 - bit_length(p.mantissa) > 29) return false;
  out = divide_nearest(scale_down(wide(x), 16 - p.exponent), p.mantissa);
  return true;
}

// Samples of one axis: the visible part and a margin, a quarter of it where that is allowed, 16 at least.
struct grid_axis { int64_t first; int32_t count; };
constexpr status place_axis(const range& r, grid_pitch p, grid_axis& out) {
  int64_t low = 0, high = 0;
  if (!in_pitches(r.low, p, low) || !in_pitches(r.high, p, high)) return status::out_of_range;
  const int64_t size = high - low + 1;
  if (size + 32 > max_grid_side) return status::out_of_range;
  const int64_t margin = clamp_to(size / 4 + 16, int64_t(16), (max_grid_side - size) / 2);
  out = {low - margin, int32_t(size + 2 * margin)};
  return status::ok;
}

// A form on the grid from its value at the anchor and its slopes per sample.
constexpr wide_form moved_to(wide at_anchor, wide per_x, wide per_y, const grid_axis& gx, const grid_axis& gy) {
  return {per_x, per_y, at_anchor + multiply(per_x, gx.first) + multiply(per_y, gy.first)};
}

// p (focal e + centre e_z), grid_bits fraction bits.
constexpr wide per_sample(grid_pitch p, int32_t focal, int32_t centre, int32_t e, int32_t e_z) {
  return scale_down(multiply(multiply(focal, e) + multiply(centre, e_z), p.mantissa), p.exponent + 46 - grid_bits);
}

constexpr void project_grid(const vertex& anchor, const projection& c, const grid_axis& gx, const grid_axis& gy, object_grid& g) {
  const vector3 &e1 = g.axes.across, &e2 = g.axes.along;
  const wide x = shift_left(multiply(anchor.x, c.focal_x) + multiply(anchor.z, c.centre_x), grid_bits - 32);
  const wide y = shift_left(multiply(anchor.y, c.focal_y) + multiply(anchor.z, c.centre_y), grid_bits - 32);
  g.x = moved_to(x, per_sample(g.pitch, c.focal_x, c.centre_x, e1.x, e1.z), per_sample(g.pitch, c.focal_x, c.centre_x, e2.x, e2.z), gx, gy);
  g.y = moved_to(y, per_sample(g.pitch, c.focal_y, c.centre_y, e1.y, e1.z), per_sample(g.pitch, c.focal_y, c.centre_y, e2.y, e2.z), gx, gy);
  constexpr int32_t one = 1 << 16;
  g.z = moved_to(shift_left(wide(anchor.z), grid_bits - 16), per_sample(g.pitch, one, 0, e1.z, 0), per_sample(g.pitch, one, 0, e2.z, 0), gx, gy);
}

// The affine map from samples to texels through three vertices. With b, c the edges in x', y' (24 fraction bits) and det = b x c:
//   du/dx' = (du_b c_y - du_c b_y) / det,  du/dy' = (du_c b_x - du_b c_x) / det
// exact but for the rounding of b and c; everything is multiplied by det, scaled to 92 bits.
constexpr status texture_grid(const vertex* v, const corner_choice& k, const grid_axis& gx, const grid_axis& gy, object_grid& g) {
  const vertex &a = v[k.a], &b = v[k.b], &c = v[k.c];
  const auto on = [&](const vertex& p, const vector3& axis) { return cut_to(dot(difference(p, a), axis), 22); };
  const int64_t bx = on(b, g.axes.across), by = on(b, g.axes.along), cx = on(c, g.axes.across), cy = on(c, g.axes.along);
  const wide signed_det = multiply(bx, cy) - multiply(by, cx);
  if (signed_det.zero()) return status::degenerate;
  const bool negative = signed_det.negative();
  const wide det = magnitude(signed_det);
  const int up = 92 - bit_length(det);
  g.tex_w = scale_down(det, -up);
  bool fits = true;
  const auto form = [&](int32_t ta, int32_t tb, int32_t tc) {
    const int64_t db = int64_t(tb) - ta, dc = int64_t(tc) - ta;
    const auto slope = [&](wide n) {
      const wide p = multiply(negative ? -n : n, g.pitch.mantissa);
      const int down = g.pitch.exponent - 8 - up;
      fits = fits && bit_length(p) - down < 110;
      return fits ? scale_down(p, down) : wide();
    };
    const wide x = slope(multiply(cy, db) - multiply(by, dc)), y = slope(multiply(bx, dc) - multiply(cx, db));
    return moved_to(scale_down(multiply(det, ta), 16 - up), x, y, gx, gy);
  };
  g.u = form(a.u, b.u, c.u);
  g.v = form(a.v, b.v, c.v);
  return fits ? status::ok : status::out_of_range;
}

// From one tile's corner, for the plane's formats.
constexpr homography tile_homography(const wide_form& u, const wide_form& v, const wide_form& w, int32_t tx, int32_t ty) {
  const auto at = [&](const wide_form& f) { return f.c + multiply(f.x, tx) + multiply(f.y, ty); };
  return {u.x, u.y, at(u), v.x, v.y, at(v), w.x, w.y, at(w)};
}

constexpr homography tile_texture(const object_grid& g, int32_t tx, int32_t ty) {
  return tile_homography(g.u, g.v, {wide(), wide(), g.tex_w}, tx, ty);
}

constexpr rectangle tile_region(const object_grid& g, int32_t tx, int32_t ty) {
  return {0, 0, min_of(grid_tile_side, g.width - tx), min_of(grid_tile_side, g.height - ty)};
}

}  // namespace detail

// The grid of a polygon that make_polygon() has accepted. `share`: of the largest pitch without holes, in 1/256 (128: about a sample a pixel at the
// nearest point of a plane parallel to the screen). Errors: out_of_range (share outside 1..256; focal lengths not positive; more than
// max_grid_side samples along an axis: take a larger share or cut the polygon; coordinates that stretch beyond 2^15 texels a sample),
// degenerate (no area, nothing in view).
constexpr status make_object_grid(const vertex* vertices, int count, const projection& camera, const polygon& p, int share, object_grid& out) {
  if (share < 1 || share > whole_share || camera.focal_x <= 0 || camera.focal_y <= 0) return status::out_of_range;
  const detail::corner_choice corners = detail::choose_corners(vertices, count);
  if (detail::size_bits(corners.normal) == 0) return status::degenerate;
  const edge_set seen = detail::visible_outline(vertices, count, camera, p.box);
  if (seen.count == 0) return status::degenerate;
  object_grid g{};
  g.axes = rotation_of(corners.normal);
  const vertex& anchor = vertices[corners.a];
  const detail::visible_part part = detail::measure(seen, anchor, camera, g.axes);
  if (part.z.low < 2) return status::out_of_range;
  const int64_t nearest = part.z.low - 1;  // cuts are rounded
  g.pitch = detail::pitch_of(g.axes, camera, p.box, nearest, share);
  detail::grid_axis gx{}, gy{};
  SPANTEX_TRY(detail::place_axis(part.across, g.pitch, gx));
  SPANTEX_TRY(detail::place_axis(part.along, g.pitch, gy));
  g.width = gx.count;
  g.height = gy.count;
  detail::project_grid(anchor, camera, gx, gy, g);
  SPANTEX_TRY(detail::texture_grid(vertices, corners, gx, gy, g));

  // Half a pitch on both axes changes depth by this much.
  const int64_t half_step = detail::cut_to(multiply(wide(int64_t(detail::depth_sweep(g.axes))), g.pitch.mantissa), g.pitch.exponent + 1) + 1;
  g.near_z = int32_t(nearest > half_step ? nearest - half_step : 0);
  g.far_z = int32_t(clamp_to(part.z.high + part.z.high / 8 + half_step, int64_t(0), int64_t(INT32_MAX)));

  plane texture{};
  SPANTEX_TRY(make_plane(detail::tile_texture(g, 0, 0), detail::tile_region(g, 0, 0), texture));
  const gradient_logs logs = gradient_logs_at(texture, texture.origin_x, texture.origin_y);
  const int32_t w_log2 = log2_16(uint64_t(texture.w_at(texture.origin_x, texture.origin_y)));
  g.level = detail::level_term(max_of(logs.x, logs.y) + (1 << 16) - 2 * w_log2);
  out = g;
  return status::ok;
}

}  // namespace spantex
