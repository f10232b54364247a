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

// Corners of a plane: where they are on the screen and on the map; the product of the depths of the other two of each, in any unit.
struct weighted_corners {
  const screen_point* at[3];
  const texel_point* map[3];
  wide weight[3];
};

// Sides of a triangle on the screen, from each corner's next to the one after it, made clockwise; its area doubled. What their numbers and the map's leave
// for weights, and how many bits of them that takes; how many lower bits of map positions are 0.
struct triangle_sides {
  int32_t x[3], y[3];
  int64_t area;
  int down, spare;
};
SPANTEX_FRAME_APART constexpr triangle_sides sides_of(const weighted_corners& p) {
  triangle_sides t{};
  uint64_t map_bits = 1 << 16;
  uint32_t side_bits = 0;
  int most = 0;
  for (int k = 0; k < 3; ++k) {
    const screen_point &b = *p.at[k == 2 ? 0 : k + 1], &c = *p.at[k == 0 ? 2 : k - 1];
    t.x[k] = c.x - b.x;
    t.y[k] = b.y - c.y;
    if (k != 0) side_bits |= uint32_t(magnitude(t.x[k]) | magnitude(t.y[k]));
    map_bits |= magnitude(p.map[k]->u) | magnitude(p.map[k]->v);
    most = max_of(most, bit_length(p.weight[k]));
  }
  t.area = int64_t(t.x[2]) * t.y[1] - int64_t(t.x[1]) * t.y[2];
  t.spare = __builtin_ctzll(map_bits);
  // Bits of the longest side, of the farthest corner, of a map position; what the largest terms leave for a weight.
  const int side = bit_length(side_bits), far = bit_length(magnitude(p.at[0]->x) | magnitude(p.at[0]->y)), map = bit_length(map_bits) - t.spare;
  const int room = min_of(110 - (side + map + 11), 121 - map - max_of(2 * side + 2, side + far + 5));
  t.down = max_of(0, most - room);
  return t;
}

// The plane through three corners: with P = w (x, y, 1) its W is the sum of the rows of the adjugate of (P0 P1 P2), Nu that of the rows times u. Integers of
// 128 bits, exact but for weights of more bits than there is room for (70 for 512 x 512 pixels and corners on whole texels, where those of quads have no more):
// those are rounded, to 46 bits or more on the largest screen. Held as the plane's exact forms. Errors: degenerate (corners in line).
SPANTEX_FRAME_APART constexpr status hold_plane_through(const weighted_corners& p, plane& out) {
  const triangle_sides t = sides_of(p);
  if (t.area == 0) return status::degenerate;
  out.exact_u = out.exact_v = out.exact_w = {};
  // A corner's row of the adjugate about corner 0, times its weight and u, v or 1.
  for (int k = 0; k < 3; ++k)
    for (int n = 0; n < 3; ++n) {
      constexpr int32_t one = 1 << 16;
      wide scaled = shift_right_nearest(p.weight[k], t.down);
      if (scaled.zero()) scaled = wide(1);
      scaled = multiply(scaled, (n == 0 ? p.map[k]->u : n == 1 ? p.map[k]->v : one) >> t.spare);
      if (t.area < 0) scaled = -scaled;
      wide_form& f = exact_form(out, n);
      add_product(f.x, scaled, t.y[k]);
      add_product(f.y, scaled, t.x[k]);
      if (k == 0) add_product(f.c, scaled, t.area);
    }
  for (int n = 0; n < 3; ++n) {
    wide_form& f = exact_form(out, n);
    add_product(f.c, f.x, -p.at[0]->x);
    add_product(f.c, f.y, -p.at[0]->y);
    f.x = shift_left(f.x, subpixel_bits);
    f.y = shift_left(f.y, subpixel_bits);
  }
  return status::ok;
}

constexpr edge on_the_screen(screen_point p) { return held({p.x, p.y, 1 << subpixel_bits}); }

// Edges of the convex outline of corners that are held in their place.
SPANTEX_FRAME_APART constexpr status set_outline(const rectangle& clip, polygon& out) {
  out.depth = {};
  clip_to_view(1, guard_band, out.edges);
  return make_edges(clip, out);
}
template <int Count>
constexpr status set_outline(const screen_point (&corners)[Count], const rectangle& clip, polygon& out) {
  if (!on_screen(clip)) return status::bad_size;
  out.edges.count = 0;
  for (screen_point c : corners) {
    if (!in_range(c)) return status::out_of_range;
    out.edges.edges[out.edges.count++] = on_the_screen(c);
  }
  return set_outline(clip, out);
}

// The `bits` bits below the highest of all of a kind: exact if they have no more.
constexpr int64_t cut_to(uint64_t x, uint64_t all, int bits) { return int64_t(x >> max_of(0, bit_length(all) - bits)); }

// Weights of corners 0, 1 and 3 of a quad that is the image of a quad on the map: with a_k and b_k the areas of the triangles without corner k on screen and
// map, sum (-1)^k a_k p_k = 0, so depths are a_k / b_k, and the product of two of three a_i a_j b_k but for what all have in common. Exact up to 4096 pixels
// and 16 texels, or 4096 whole ones; parallelograms on the map (its rectangle) of any size. False: one of the two is not convex, or has no area.
SPANTEX_FRAME_APART constexpr bool quad_weights(const screen_point (&p)[4], const texel_point (&q)[4], wide (&out)[3]) {
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

// Errors: degenerate.
SPANTEX_FRAME_APART constexpr status hold_quad(const screen_point (&at)[4], const texel_point (&map)[4], plane& out) {
  weighted_corners corners{{&at[0], &at[1], &at[3]}, {&map[0], &map[1], &map[3]}, {}};
  return quad_weights(at, map, corners.weight) ? hold_plane_through(corners, out) : status::degenerate;
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
  SPANTEX_TRY(detail::set_outline(corners, clip, out));
  SPANTEX_TRY(detail::hold_quad(corners, map, out.map));
  return detail::normalise(out.box, out.map);
}

// A corner of a triangle on the screen. w: its depth in any unit, from 1; all alike for an affine triangle.
struct screen_vertex {
  screen_point at;
  texel_point map;
  uint32_t w;
};

namespace detail {

SPANTEX_FRAME_APART constexpr status hold_triangle(const screen_vertex& a, const screen_vertex& b, const screen_vertex& c, plane& out) {
  weighted_corners corners{{&a.at, &b.at, &c.at}, {&a.map, &b.map, &c.map}, {wide(1), wide(1), wide(1)}};
  if (a.w != b.w || b.w != c.w) {
    corners.weight[0] = multiply(int64_t(b.w), int64_t(c.w));
    corners.weight[1] = multiply(int64_t(c.w), int64_t(a.w));
    corners.weight[2] = multiply(int64_t(a.w), int64_t(b.w));
  }
  return hold_plane_through(corners, out);
}

}  // namespace detail

// Errors: bad_size (clip), out_of_range (as make_quad; w = 0), degenerate (no area, outside `clip`).
[[gnu::noinline]] constexpr status make_triangle(const screen_vertex (&corners)[3], rectangle clip, polygon& out) {
  const screen_vertex &a = corners[0], &b = corners[1], &c = corners[2];
  for (const screen_vertex& v : corners)
    if (v.w == 0 || !detail::in_range(v.map)) return status::out_of_range;
  SPANTEX_TRY(detail::set_outline({a.at, b.at, c.at}, clip, out));
  SPANTEX_TRY(detail::hold_triangle(a, b, c, out.map));
  return detail::normalise(out.box, out.map);
}

// A picture turned about a pivot and scaled. LVGL's `angle` is this one, its `scale` of 256 is 65536 here, its pivot and position are shifted by 16 and 8 bits.
struct sprite {
  screen_point at;           // where the pivot lies on the screen
  texel_point pivot;
  int32_t scale_x, scale_y;  // s15.16 pixels a texel; negative: mirrored
  int32_t angle;             // 0.1 degree, clockwise
};

namespace detail {

// Corners on the screen, as they are held until edges are made. Errors: out_of_range.
SPANTEX_FRAME_APART constexpr status hold_sprite_corners(const sprite& s, const sine_cosine& turn, int32_t width, int32_t height, edge_set& out) {
  const map_corners map = corners_of_map(width, height);
  out.count = 0;
  for (const texel_point& corner : map.at) {
    const int64_t x = (int64_t(corner.u) - s.pivot.u) * s.scale_x, y = (int64_t(corner.v) - s.pivot.v) * s.scale_y;  // s31.32 pixels
    const auto moved = [](int32_t by, int64_t along, int32_t cosine, int64_t across, int32_t sine) {
      const wide w = wide(by) + shift_right_nearest(difference_of_products(along, cosine, across, sine), 30 + 32 - subpixel_bits);
      return bit_length(w) > 28 ? int64_t(max_corner) : to_int64(w);
    };
    const int64_t cx = moved(s.at.x, x, turn.cosine, y, turn.sine), cy = moved(s.at.y, y, turn.cosine, -x, turn.sine);
    if (cx == max_corner || cy == max_corner) return status::out_of_range;
    out.edges[out.count++] = on_the_screen({int32_t(cx), int32_t(cy)});
  }
  return status::ok;
}

// Over W = scale_x scale_y 2^22: 30 bits of cosines and 8 of positions, less 16 of scales. Held as the plane's exact forms.
SPANTEX_FRAME_APART constexpr void hold_sprite(const sprite& s, const sine_cosine& turn, plane& out) {
  const int64_t area = int64_t(s.scale_x) * s.scale_y;
  const int sign = area < 0 ? -1 : 1;
  const wide size = multiply(area, sign);
  const auto form = [&](wide_form& f, int32_t scale, int32_t x, int32_t y, int32_t pivot) {
    const int64_t a = int64_t(scale) * sign * x, b = int64_t(scale) * sign * y;
    f = {shift_left(wide(a), subpixel_bits), shift_left(wide(b), subpixel_bits), wide(0)};
    add_product(f.c, size, int64_t(pivot) * 64);
    add_product(f.c, -a, s.at.x);
    add_product(f.c, -b, s.at.y);
  };
  form(out.exact_u, s.scale_y, turn.cosine, turn.sine, s.pivot.u);
  form(out.exact_v, s.scale_x, -turn.sine, turn.cosine, s.pivot.v);
  out.exact_w = {wide(0), wide(0), shift_left(size, 22)};
}

}  // namespace detail

// The whole of a map of width x height texels. With c, s the cosine and sine of camera.hpp (s1.30, within 1.4 units; exact at right angles)
//   u = pivot + (c (x - at.x) + s (y - at.y)) / scale_x,  v = pivot + (c (y - at.y) - s (x - at.x)) / scale_y
// exactly; corners by the inverse, to 1/256 pixel. Errors: bad_size (clip, map's sides outside 1..4096), out_of_range (a corner beyond 2^20 pixels),
// degenerate (a scale of 0, outside `clip`).
[[gnu::noinline]] constexpr status make_sprite(const sprite& s, int32_t width, int32_t height, rectangle clip, polygon& out) {
  if (width < 1 || height < 1 || width > 4096 || height > 4096 || !on_screen(clip)) return status::bad_size;
  if (!detail::in_range(s.at)) return status::out_of_range;
  if (s.scale_x == 0 || s.scale_y == 0) return status::degenerate;
  const sine_cosine turn = sine_cosine_of(detail::angle_of(s.angle));
  SPANTEX_TRY(detail::hold_sprite_corners(s, turn, width, height, out.edges));
  SPANTEX_TRY(detail::set_outline(clip, out));
  detail::hold_sprite(s, turn, out.map);
  return detail::normalise(out.box, out.map);
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

// From what a numerator is along the camera's axes (x: right, y: up, c: ahead) to a form in pixels times 2^16: rays are focal ahead, x - centre_x to the
// right, centre_y - y up.
SPANTEX_FRAME_APART constexpr void turn_to_rays(const looking_camera& camera, wide_form& f) {
  f.c = multiply(f.c, camera.focal);
  add_product(f.c, f.y, camera.centre_y);
  add_product(f.c, -f.x, camera.centre_x);
  f.x = shift_left(f.x, 16);
  f.y = -shift_left(f.y, 16);
}

// Held as the plane's exact forms.
SPANTEX_FRAME_APART constexpr void hold_floor(const looking_camera& camera, const floor_map& map, plane& out) {
  const attitude r = attitude_of(camera);
  const int sign = map.height > 0 ? -1 : 1;  // rays that go down meet what is below
  const auto set = [&](wide& c, int32_t along, int64_t d, int64_t dy) { c = ground_numerator(map.height, map.texels_per_unit * sign, along, d, dy); };
  set(out.exact_u.x, map.x, r.xw, r.yw);
  set(out.exact_u.y, map.x, r.xv, r.yv);
  set(out.exact_u.c, map.x, r.xu, r.yu);
  set(out.exact_v.x, map.z, r.zw, r.yw);
  set(out.exact_v.y, map.z, r.zv, r.yv);
  set(out.exact_v.c, map.z, r.zu, r.yu);
  out.exact_w = {wide(sign * r.yw), wide(sign * r.yv), wide(sign * r.yu)};
  for (int k = 0; k < 3; ++k) turn_to_rays(camera, exact_form(out, k));
}

}  // namespace detail

// The part of the level map in view within `region`. Numerators are rounded at 2^-40 (camera.hpp). Errors: bad_size (region), out_of_range (focal or
// texels_per_unit not positive), degenerate (height 0, or nothing in view).
[[gnu::noinline]] constexpr status make_floor(const looking_camera& camera, const floor_map& map, rectangle region, plane& out) {
  if (camera.focal <= 0 || map.texels_per_unit <= 0) return status::out_of_range;
  if (map.height == 0) return status::degenerate;
  detail::hold_floor(camera, map, out);
  return detail::normalise(region, out);
}

namespace detail {

// Corners of a face, clockwise from the top left.
SPANTEX_FRAME_APART constexpr void make_cube_corners(const looking_camera& camera, int face, vertex (&v)[4]) {
  constexpr uint8_t corners[6][4] = {{3, 7, 5, 1}, {7, 6, 4, 5}, {6, 2, 0, 4}, {2, 3, 1, 0}, {2, 6, 7, 3}, {1, 5, 4, 0}};  // bits: 1 ahead, 2 up, 4 right
  const attitude r = attitude_of(camera);
  for (int k = 0; k < 4; ++k) {
    const int corner = corners[face][k];
    const auto along = [corner](int64_t ahead, int64_t up, int64_t right) {  // 256 units to a face
      const int64_t sum = ((corner & 1) != 0 ? ahead : -ahead) + ((corner & 2) != 0 ? up : -up) + ((corner & 4) != 0 ? right : -right);
      return int32_t(shift_right(sum, camera_bits - 24));
    };
    v[k].x = along(r.xw, r.yw, r.zw);
    v[k].y = -along(r.xv, r.yv, r.zv);
    v[k].z = along(r.xu, r.yu, r.zu);
  }
}

}  // namespace detail

// Faces of a cube seen from its middle, each a map as one sees it there, upright; those above and below as one sees them looking up and down from `ahead`.
enum class cube_face : uint8_t { ahead, right, behind, left, above, below };
inline constexpr int cube_face_count = 6;

// Edges of neighbours are the same: together the faces cover every pixel once. Errors: bad_size (clip, sides outside 1..4096), out_of_range (focal not positive,
// or 2^28 pixels reached), degenerate (not in view).
[[gnu::noinline]] constexpr status make_cube_face(const looking_camera& camera, cube_face face, int32_t width, int32_t height, rectangle clip, polygon& out) {
  if (width < 1 || height < 1 || width > 4096 || height > 4096) return status::bad_size;
  if (camera.focal <= 0 || int(face) >= cube_face_count) return status::out_of_range;
  const map_corners map = corners_of_map(width, height);
  vertex v[4];
  detail::make_cube_corners(camera, int(face), v);
  for (int k = 0; k < 4; ++k) {
    v[k].u = map.at[k].u;
    v[k].v = map.at[k].v;
  }
  constexpr int32_t near_z = 1 << 16;
  SPANTEX_TRY(make_polygon(v, 4, {camera.focal, camera.focal, camera.centre_x, camera.centre_y, near_z}, clip, out));
  out.depth = {};
  return status::ok;
}

}  // namespace spantex
