// SPDX-License-Identifier: Apache-2.0
// What programs draw, set up as the polygons and planes that the engine (draw.hpp) and rows (rows/pictures.hpp, one call each) take: perspective quads,
// triangles on the screen, rotated and scaled pictures, the floor or ceiling below or above a camera, the faces of a cube around it.
//
//   screen positions   screen_point: 1/256 pixel, origin top left, |x|, |y| < 2^28
//   map positions      s15.16 texels of level 0; corner (0, 0) is the outer corner of the first texel
//   angles             0.1 degree, any int32_t; clockwise as seen on the screen
//   depth              none: these polygons are the farthest in a depth buffer (triangles of a scene with one: polygon.hpp)
//
// Set-up is not inlined: its frame is not to lie under those of drawing.
// Maps that are not to show their other side at the border of a picture are clamped (wrap::clamp).
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>
#include <spantex/camera.hpp>
#include <spantex/coverage.hpp>
#include <spantex/plane.hpp>
#include <spantex/polygon.hpp>
#include <spantex/status.hpp>
#include <spantex/wide.hpp>

namespace spantex {

struct texel_point { int32_t u, v; };

inline constexpr int32_t max_corner = 1 << 28;  // 1/256 pixel
inline constexpr int32_t max_texel = 1 << 30;   // s15.16

// A position of the map by its size, for the corners of a picture: top left, top right, bottom right, bottom left.
struct map_corners { texel_point at[4]; };
constexpr map_corners corners_of_map(int32_t width, int32_t height) {
  const int32_t u = width * (1 << 16), v = height * (1 << 16);
  return {{{0, 0}, {u, 0}, {u, v}, {0, v}}};
}

namespace detail {

constexpr bool in_range(screen_point p) { return magnitude(p.x) < uint64_t(max_corner) && magnitude(p.y) < uint64_t(max_corner); }
constexpr bool in_range(texel_point p) { return magnitude(p.u) <= uint64_t(max_texel) && magnitude(p.v) <= uint64_t(max_texel); }

// Twice the area of a triangle, positive clockwise (y down).
constexpr int64_t doubled_area(screen_point p, screen_point q, screen_point r) {
  return (int64_t(q.x) - p.x) * (int64_t(r.y) - p.y) - (int64_t(q.y) - p.y) * (int64_t(r.x) - p.x);
}
constexpr int64_t doubled_area(texel_point p, texel_point q, texel_point r) {
  return (int64_t(q.u) - p.u) * (int64_t(r.v) - p.v) - (int64_t(q.v) - p.v) * (int64_t(r.u) - p.u);
}

// A corner of a plane: where it is on the screen and on the map; the product of the depths of the other two, in any unit.
struct weighted_corner {
  screen_point at;
  texel_point map;
  wide weight;
};

// The plane through three corners: with P = w (x, y, 1) its W is the sum of the rows of the adjugate of (P0 P1 P2), Nu that of the rows times u. Integers of
// 128 bits, exact but for weights of more bits than there is room for (70 for 512 x 512 pixels and corners on whole texels, where those of quads have no more):
// those are rounded, to 46 bits or more on the largest screen. Errors: those of make_plane; degenerate (corners in line).
[[gnu::noinline]] constexpr status plane_through(const weighted_corner (&p)[3], rectangle region, plane& out) {
  const int64_t x1 = int64_t(p[1].at.x) - p[0].at.x, y1 = int64_t(p[1].at.y) - p[0].at.y, x2 = int64_t(p[2].at.x) - p[0].at.x, y2 = int64_t(p[2].at.y) - p[0].at.y;
  const int64_t area = x1 * y2 - x2 * y1;
  if (area == 0) return status::degenerate;
  uint64_t map_bits = 1 << 16;
  int most = 0;
  for (const weighted_corner& c : p) {
    map_bits |= magnitude(c.map.u) | magnitude(c.map.v);
    most = max_of(most, bit_length(c.weight));
  }
  const int spare = __builtin_ctzll(map_bits);
  // Bits of the longest side, of the farthest corner, of a map position; what the largest terms leave for a weight.
  const int side = bit_length(magnitude(x1) | magnitude(y1) | magnitude(x2) | magnitude(y2));
  const int far = bit_length(magnitude(p[0].at.x) | magnitude(p[0].at.y)), map = bit_length(map_bits) - spare;
  const int room = min_of(110 - (side + map + 11), 121 - map - max_of(2 * side + 2, side + far + 5)), down = max_of(0, most - room);
  wide w[3];
  for (int k = 0; k < 3; ++k) {
    w[k] = shift_right_nearest(p[k].weight, down);
    if (w[k].zero()) w[k] = wide(1);
  }
  // Rows of the adjugate about corner 0, on clockwise corners.
  const int sign = area < 0 ? -1 : 1;
  const auto scaled = [&](int k, int64_t by) { return multiply(w[k], sign * by); };
  const wide_form row[3] = {{scaled(0, y1 - y2), scaled(0, x2 - x1), scaled(0, area)}, {scaled(1, y2), scaled(1, -x2), wide(0)}, {scaled(2, -y1), scaled(2, x1), wide(0)}};
  const auto form = [&](int32_t t0, int32_t t1, int32_t t2) {
    const auto sum = [&](wide wide_form::*m) { return multiply(row[0].*m, t0 >> spare) + multiply(row[1].*m, t1 >> spare) + multiply(row[2].*m, t2 >> spare); };
    const wide x = sum(&wide_form::x), y = sum(&wide_form::y);
    return wide_form{shift_left(x, subpixel_bits), shift_left(y, subpixel_bits), sum(&wide_form::c) - multiply(x, p[0].at.x) - multiply(y, p[0].at.y)};
  };
  constexpr int32_t one = 1 << 16;
  const wide_form u = form(p[0].map.u, p[1].map.u, p[2].map.u), v = form(p[0].map.v, p[1].map.v, p[2].map.v), d = form(one, one, one);
  return make_plane({u.x, u.y, u.c, v.x, v.y, v.c, d.x, d.y, d.c}, region, out);
}

// Edges of a convex outline on the screen.
template <int Count>
[[gnu::noinline]] constexpr status set_outline(const screen_point (&corners)[Count], rectangle clip, polygon& out) {
  if (!on_screen(clip)) return status::bad_size;
  outline o;
  for (screen_point c : corners) {
    if (!in_range(c)) return status::out_of_range;
    o.points[o.count++] = {c.x, c.y, 1 << subpixel_bits};
  }
  out.depth = {};
  return set_edges(clip_to_view(o, 1), clip, out);
}

// The `bits` bits below the highest of all of a kind: exact if they have no more.
constexpr int64_t cut_to(uint64_t x, uint64_t all, int bits) { return int64_t(x >> max_of(0, bit_length(all) - bits)); }

// Weights of corners 0, 1 and 3 of a quad that is the image of a quad on the map: with a_k and b_k the areas of the triangles without corner k on screen and
// map, sum (-1)^k a_k p_k = 0, so depths are a_k / b_k, and the product of two of three a_i a_j b_k but for what all have in common. Exact up to 4096 pixels
// and 16 texels, or 4096 whole ones; parallelograms on the map (its rectangle) of any size. False: one of the two is not convex, or has no area.
constexpr bool quad_weights(const screen_point (&p)[4], const texel_point (&q)[4], wide (&out)[3]) {
  uint64_t a[4], b[4], all_a = 0, all_b = 0;
  int turns = 0, map_turns = 0;
  for (int k = 0; k < 4; ++k) {
    const int i = (k + 1) % 4, j = (k + 2) % 4, l = (k + 3) % 4;
    const int64_t on_screen = doubled_area(p[i], p[j], p[l]), on_map = doubled_area(q[i], q[j], q[l]);
    if (on_screen == 0 || on_map == 0) return false;
    turns += on_screen > 0 ? 1 : -1;
    map_turns += on_map > 0 ? 1 : -1;
    all_a |= a[k] = magnitude(on_screen);
    all_b |= b[k] = magnitude(on_map);
  }
  if (magnitude(turns) != 4 || magnitude(map_turns) != 4) return false;
  const bool parallelogram = b[0] == b[1] && b[1] == b[2] && b[2] == b[3];
  const int whole = __builtin_ctzll(all_b);
  constexpr int corner[3] = {0, 1, 3};
  for (int n = 0; n < 3; ++n) {
    const uint64_t i = a[corner[(n + 1) % 3]], j = a[corner[(n + 2) % 3]];
    if (parallelogram) out[n] = multiply(int64_t(i), int64_t(j));
    else out[n] = multiply(multiply(cut_to(i, all_a, 41), cut_to(j, all_a, 41)), cut_to(b[corner[n]] >> whole, all_b >> whole, 41));
  }
  return true;
}

// To nearest; 2^52 / 3600 in place of a division of 64 bits.
constexpr binary_angle angle_of(int32_t tenths) {
  const int32_t within = (tenths % 3600 + 3600) % 3600;
  return {uint32_t((uint64_t(within) * 1250999896492u + (1u << 19)) >> 20)};
}

}  // namespace detail

// A picture with four corners on the screen, clockwise or not: the projective map that takes each to its corner of the map. Errors: bad_size (clip),
// out_of_range (a corner beyond 2^20 pixels, or 2^14 texels), degenerate (three corners in line, not convex, outside `clip`).
[[gnu::noinline]] constexpr status make_quad(const screen_point (&corners)[4], const texel_point (&map)[4], rectangle clip, polygon& out) {
  for (texel_point t : map)
    if (!detail::in_range(t)) return status::out_of_range;
  wide by[3];
  SPANTEX_TRY(detail::set_outline(corners, clip, out));
  if (!detail::quad_weights(corners, map, by)) return status::degenerate;
  return detail::plane_through({{corners[0], map[0], by[0]}, {corners[1], map[1], by[1]}, {corners[3], map[3], by[2]}}, out.box, out.map);
}

// A corner of a triangle on the screen. w: its depth in any unit, from 1; all alike for an affine triangle.
struct screen_vertex {
  screen_point at;
  texel_point map;
  uint32_t w;
};

// Errors: bad_size (clip), out_of_range (as make_quad; w = 0), degenerate (no area, outside `clip`).
[[gnu::noinline]] constexpr status make_triangle(const screen_vertex (&corners)[3], rectangle clip, polygon& out) {
  const screen_vertex &a = corners[0], &b = corners[1], &c = corners[2];
  for (const screen_vertex& v : corners)
    if (v.w == 0 || !detail::in_range(v.map)) return status::out_of_range;
  SPANTEX_TRY(detail::set_outline({a.at, b.at, c.at}, clip, out));
  const bool affine = a.w == b.w && b.w == c.w;
  const auto corner = [affine](const screen_vertex& v, const screen_vertex& i, const screen_vertex& j) {
    return detail::weighted_corner{v.at, v.map, affine ? wide(1) : multiply(int64_t(i.w), int64_t(j.w))};
  };
  return detail::plane_through({corner(a, b, c), corner(b, c, a), corner(c, a, b)}, out.box, out.map);
}

// A picture turned about a pivot and scaled. LVGL's `angle` is this one, its `scale` of 256 is 65536 here, its pivot and position are shifted by 16 and 8 bits.
struct sprite {
  screen_point at;           // where the pivot lies on the screen
  texel_point pivot;
  int32_t scale_x, scale_y;  // s15.16 pixels a texel; negative: mirrored
  int32_t angle;             // 0.1 degree, clockwise
};

// The whole of a map of width x height texels. With c, s the cosine and sine of camera.hpp (s1.30, within 1.4 units; exact at right angles)
//   u = pivot + (c (x - at.x) + s (y - at.y)) / scale_x,  v = pivot + (c (y - at.y) - s (x - at.x)) / scale_y
// exactly; corners by the inverse, to 1/256 pixel. Errors: bad_size (clip, map's sides outside 1..4096), out_of_range (a corner beyond 2^20 pixels),
// degenerate (a scale of 0, outside `clip`).
[[gnu::noinline]] constexpr status make_sprite(const sprite& s, int32_t width, int32_t height, rectangle clip, polygon& out) {
  if (width < 1 || height < 1 || width > 4096 || height > 4096) return status::bad_size;
  if (!detail::in_range(s.at)) return status::out_of_range;
  if (s.scale_x == 0 || s.scale_y == 0) return status::degenerate;
  const sine_cosine turn = sine_cosine_of(detail::angle_of(s.angle));
  const map_corners map = corners_of_map(width, height);
  screen_point corners[4];
  for (int k = 0; k < 4; ++k) {
    const int64_t x = (int64_t(map.at[k].u) - s.pivot.u) * s.scale_x, y = (int64_t(map.at[k].v) - s.pivot.v) * s.scale_y;  // s31.32 pixels
    const auto moved = [](int32_t by, wide d) { return wide(by) + shift_right_nearest(d, 30 + 32 - subpixel_bits); };
    const wide cx = moved(s.at.x, multiply(x, turn.cosine) - multiply(y, turn.sine)), cy = moved(s.at.y, multiply(x, turn.sine) + multiply(y, turn.cosine));
    if (bit_length(cx) > 28 || bit_length(cy) > 28) return status::out_of_range;
    corners[k] = {int32_t(to_int64(cx)), int32_t(to_int64(cy))};
  }
  SPANTEX_TRY(detail::set_outline(corners, clip, out));
  // Over W = scale_x scale_y 2^22: 30 bits of cosines and 8 of positions, less 16 of scales.
  const int64_t area = int64_t(s.scale_x) * s.scale_y;
  const int sign = area < 0 ? -1 : 1;
  const auto form = [&](int32_t scale, int32_t x, int32_t y, int32_t pivot) {
    const int64_t a = int64_t(scale) * sign * x, b = int64_t(scale) * sign * y;
    const wide c = multiply(multiply(area, sign), int64_t(pivot) * 64) - multiply(a, s.at.x) - multiply(b, s.at.y);
    return wide_form{shift_left(wide(a), subpixel_bits), shift_left(wide(b), subpixel_bits), c};
  };
  const wide_form u = form(s.scale_y, turn.cosine, turn.sine, s.pivot.u), v = form(s.scale_x, -turn.sine, turn.cosine, s.pivot.v);
  return make_plane({u.x, u.y, u.c, v.x, v.y, v.c, wide(0), wide(0), shift_left(multiply(area, sign), 22)}, out.box, out.map);
}

// --- around a camera -------------------------------------------------------------------------------------

// Heading turns to the right, pitch upwards, roll lowers the right side of the camera.
struct looking_camera {
  int32_t heading, pitch, roll;  // 0.1 degree
  int32_t focal;                 // s15.16 pixels, > 0: half the screen's width over the tangent of half the angle of view
  int32_t centre_x, centre_y;    // s15.16 pixels: where its axis meets the screen. Of a level camera centre_y is the horizon
};

// A level map below a camera (mode 7), or above it: clouds, a ceiling. u grows ahead of heading 0, v to its right.
struct floor_map {
  int32_t x, z, height;     // s15.16: where the camera stands (ahead, to the right), and how high above the map; negative: below it
  int32_t texels_per_unit;  // s15.16, > 0
};

namespace detail {

constexpr attitude attitude_of(const looking_camera& c) {
  return spantex::attitude_of(angle_of(c.roll), angle_of(c.pitch), angle_of(c.heading == INT32_MIN ? -(c.heading + 3600) : -c.heading));
}

// What a numerator is along the camera's axes, as a form in pixels times 2^16: rays are focal ahead, x - centre_x to the right, centre_y - y up.
constexpr wide_form on_rays(const looking_camera& c, wide ahead, wide up, wide right) {
  return {shift_left(right, 16), -shift_left(up, 16), multiply(ahead, c.focal) + multiply(up, c.centre_y) - multiply(right, c.centre_x)};
}

}  // namespace detail

// The part of the level map in view within `region`. Numerators are rounded at 2^-40 (camera.hpp). Errors: bad_size (region), out_of_range (focal or
// texels_per_unit not positive), degenerate (height 0, or nothing in view).
[[gnu::noinline]] constexpr status make_floor(const looking_camera& camera, const floor_map& map, rectangle region, plane& out) {
  if (camera.focal <= 0 || map.texels_per_unit <= 0) return status::out_of_range;
  if (map.height == 0) return status::degenerate;
  const attitude r = detail::attitude_of(camera);
  const attitude_camera from{{}, {}, {}, {map.x, map.height, map.z}, map.texels_per_unit};
  const int sign = map.height > 0 ? -1 : 1;  // rays that go down meet what is below
  const auto form = [&](int32_t along, int64_t ahead, int64_t up, int64_t right) {
    const auto numerator = [&](int64_t d, int64_t dy) { return multiply(detail::ground_numerator(from, along, d, dy), sign); };
    return detail::on_rays(camera, numerator(ahead, r.yu), numerator(up, r.yv), numerator(right, r.yw));
  };
  const wide_form u = form(map.x, r.xu, r.xv, r.xw), v = form(map.z, r.zu, r.zv, r.zw);
  const wide_form w = detail::on_rays(camera, wide(sign * r.yu), wide(sign * r.yv), wide(sign * r.yw));
  return make_plane({u.x, u.y, u.c, v.x, v.y, v.c, w.x, w.y, w.c}, region, out);
}

// Faces of a cube seen from its middle, each a map as one sees it there, upright; those above and below as one sees them looking up and down from `ahead`.
enum class cube_face : uint8_t { ahead, right, behind, left, above, below };
inline constexpr int cube_face_count = 6;

// Edges of neighbours are the same: together the faces cover every pixel once. Errors: bad_size (clip, sides outside 1..4096), out_of_range (focal not positive,
// or 2^28 pixels reached), degenerate (not in view).
[[gnu::noinline]] constexpr status make_cube_face(const looking_camera& camera, cube_face face, int32_t width, int32_t height, rectangle clip, polygon& out) {
  if (width < 1 || height < 1 || width > 4096 || height > 4096) return status::bad_size;
  if (camera.focal <= 0 || int(face) >= cube_face_count) return status::out_of_range;
  // Corners of the cube, clockwise from the top left: bits 1 ahead, 2 up, 4 right.
  constexpr uint8_t corners[cube_face_count][4] = {{3, 7, 5, 1}, {7, 6, 4, 5}, {6, 2, 0, 4}, {2, 3, 1, 0}, {2, 6, 7, 3}, {1, 5, 4, 0}};
  const attitude r = detail::attitude_of(camera);
  const map_corners map = corners_of_map(width, height);
  vertex v[4];
  for (int k = 0; k < 4; ++k) {
    const int corner = corners[int(face)][k];
    const auto along = [corner](int64_t ahead, int64_t up, int64_t right) {  // 256 units to a face
      const int64_t sum = ((corner & 1) != 0 ? ahead : -ahead) + ((corner & 2) != 0 ? up : -up) + ((corner & 4) != 0 ? right : -right);
      return int32_t(shift_right(sum, detail::camera_bits - 24));
    };
    v[k] = {along(r.xw, r.yw, r.zw), -along(r.xv, r.yv, r.zv), along(r.xu, r.yu, r.zu), map.at[k].u, map.at[k].v};
  }
  constexpr int32_t near_z = 1 << 16;
  SPANTEX_TRY(make_polygon(v, 4, {camera.focal, camera.focal, camera.centre_x, camera.centre_y, near_z}, clip, out));
  out.depth = {};
  return status::ok;
}

}  // namespace spantex
