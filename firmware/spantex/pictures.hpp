// SPDX-License-Identifier: Apache-2.0
// What programs draw, set up as the polygons and planes that the engine (draw.hpp) and rows (rows/pictures.hpp, one call each) take: perspective quads,
// triangles on the screen, rotated and scaled pictures, the floor or ceiling below or above a camera, the faces of a cube around it.
//
//   screen positions   screen_point: 1/256 pixel, origin top left, |x|, |y| < 2^28
//   map positions      s15.16 texels of level 0; corner (0, 0) is the outer corner of the first texel
//   angles             0.1 degree, any int32_t; clockwise as seen on the screen
//   depth              none: these polygons are the farthest in a depth buffer (triangles of a scene with one: polygon.hpp)
//
// Set-up works in what it makes (docs/DESIGN.md, "Set-up in place"); what it leaves there on an error is undefined.
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

inline constexpr int32_t max_corner = 1 << 28;  // 1/256 pixel
inline constexpr int32_t max_texel = 1 << 30;   // s15.16

// Positions of the map's corners by its size: top left, top right, bottom right, bottom left.
constexpr texel_point corner_of_map(int k, int32_t width, int32_t height) { return {k == 1 || k == 2 ? width * (1 << 16) : 0, k >= 2 ? height * (1 << 16) : 0}; }
struct map_corners { texel_point at[4]; };
constexpr map_corners corners_of_map(int32_t width, int32_t height) {
  map_corners out{};
  for (int k = 0; k < 4; ++k) out.at[k] = corner_of_map(k, width, height);
  return out;
}

// A corner on the screen. w: its depth in any unit, from 1; all alike for an affine triangle.
struct screen_vertex {
  screen_point at;
  texel_point map;
  uint32_t w;
};

namespace detail {

constexpr bool in_range(screen_point p) { return magnitude(p.x) < uint64_t(max_corner) && magnitude(p.y) < uint64_t(max_corner); }
constexpr bool in_range(texel_point p) { return magnitude(p.u) <= uint64_t(max_texel) && magnitude(p.v) <= uint64_t(max_texel); }

// Until edges are made of them a picture's corners lie where its edges will (polygon.hpp), with a depth of 1 (256 as positions are in 1/256 pixel), and, `map_slot` later, what
// they show: a = u, b = v, c = depth in any unit.
inline constexpr int map_slot = max_edges / 2;
SPANTEX_FRAME_APART constexpr void hold(const screen_point& p, edge_set& out) { out.edges[out.count++] = held({p.x, p.y, 1 << subpixel_bits}); }

// Errors: out_of_range.
SPANTEX_FRAME_APART constexpr status hold_corner(const screen_vertex& v, edge_set& out) {
  if (!in_range(v.at) || !in_range(v.map) || v.w == 0) return status::out_of_range;
  out.edges[out.count + map_slot] = {v.map.u, v.map.v, v.w};
  hold(v.at, out);
  return status::ok;
}

// Twice the area of a triangle by a and b, positive clockwise (y down).
SPANTEX_FRAME_APART constexpr int64_t doubled_area(const edge& p, const edge& q, const edge& r) { return (q.a - p.a) * (r.b - p.b) - (q.b - p.b) * (r.a - p.a); }

// The plane is that of three of the corners, 0, 1 and `third`, with weights: the product of the depths of the other two, in any unit.
struct corner_weights {
  wide of[3];
  int third;
  constexpr int corner(int k) const { return k == 2 ? third : k; }
};

// Sides of their triangle, from each corner's next to the one after it; its area doubled, positive clockwise. How many lower bits of map positions are 0; how
// many of weights there is no room for.
struct triangle_sides {
  int32_t x[3], y[3];
  int64_t area;
  int down, spare;
};
SPANTEX_FRAME_APART constexpr triangle_sides sides_of(const edge_set& corners, const corner_weights& w) {
  triangle_sides t{};
  const auto bits_of = [](int64_t x) { return uint32_t(x < 0 ? -x : x); };
  uint32_t map_bits = 1 << 16, side_bits = 0;
  int most = 0;
  for (int k = 0; k < 3; ++k) {
    const edge &b = corners.edges[w.corner(next_of_three(k))], &c = corners.edges[w.corner(next_of_three(next_of_three(k)))], &map = corners.edges[w.corner(k) + map_slot];
    t.x[k] = int32_t(c.a - b.a);
    t.y[k] = int32_t(b.b - c.b);
    if (k != 0) side_bits |= bits_of(t.x[k]) | bits_of(t.y[k]);
    map_bits |= bits_of(map.a) | bits_of(map.b);
    most = max_of(most, bit_length(w.of[k]));
  }
  t.area = int64_t(t.x[2]) * t.y[1] - int64_t(t.x[1]) * t.y[2];
  t.spare = __builtin_ctz(map_bits);
  // Bits of the longest side, of the farthest corner, of a map position; what the largest terms leave for a weight.
  const int side = bit_length(side_bits), far = bit_length(bits_of(corners.edges[0].a) | bits_of(corners.edges[0].b)), map = bit_length(map_bits) - t.spare;
  const int room = min_of(110 - (side + map + 11), 121 - map - max_of(2 * side + 2, side + far + 5));
  t.down = max_of(0, most - room);
  return t;
}

// With P = w (x, y, 1) the plane's W is the sum of the rows of the adjugate of (P0 P1 P2), Nu that of the rows times u. Integers of 128 bits, exact but for
// weights of more bits than there is room for (70 for 512 x 512 pixels and corners on whole texels, where those of quads have no more): those are rounded, to
// 46 bits or more on the largest screen. Held as the plane's exact forms. Errors: degenerate (corners in line).
SPANTEX_FRAME_APART constexpr status hold_plane_through(corner_weights& w, const edge_set& corners, plane& out) {
  const triangle_sides t = sides_of(corners, w);
  if (t.area == 0) return status::degenerate;
  out.exact_u = out.exact_v = out.exact_w = {};
  // A corner's row of the adjugate about corner 0, times its weight and u, v or 1.
  for (int k = 0; k < 3; ++k) {
    wide& weight = w.of[k];
    round_off(weight, t.down);
    if (weight.zero()) weight.low = 1;
    negate_if(weight, sign_of(t.area));
    const edge& map = corners.edges[w.corner(k) + map_slot];
    for (int n = 0; n < 3; ++n) {
      constexpr int64_t one = 1 << 16;
      wide scaled;
      add_product(scaled, weight, (n == 0 ? map.a : n == 1 ? map.b : one) >> t.spare);
      wide_form& f = exact_form(out, n);
      add_product(f.x, scaled, t.y[k]);
      add_product(f.y, scaled, t.x[k]);
      if (k == 0) add_product(f.c, scaled, t.area);
    }
  }
  for (int n = 0; n < 3; ++n) {
    wide_form& f = exact_form(out, n);
    add_product(f.c, f.x, -corners.edges[0].a);
    add_product(f.c, f.y, -corners.edges[0].b);
    f.x = shift_left(f.x, subpixel_bits);
    f.y = shift_left(f.y, subpixel_bits);
  }
  return status::ok;
}

// Edges of the convex outline of the corners; the clip rectangle is out.box.
SPANTEX_FRAME_APART constexpr status set_outline(polygon& out) {
  out.depth = {};
  clip_to_view(1, guard_band, out.edges);
  return make_edges(out);
}

// Whether all corners are beyond one side of out.box: set_outline would find that the picture covers nothing.
SPANTEX_FRAME_APART constexpr bool is_outside(const polygon& p) {
  bool left = true, right = true, above = true, below = true;
  for (int k = 0; k < p.edges.count; ++k) {
    const int32_t x = int32_t(p.edges.edges[k].a >> subpixel_bits), y = int32_t(p.edges.edges[k].b >> subpixel_bits);
    left = left && x < p.box.x0;
    right = right && x >= p.box.x1;
    above = above && y < p.box.y0;
    below = below && y >= p.box.y1;
  }
  return left || right || above || below;
}

// No corners yet; the clip rectangle is out.box. Errors: bad_size.
constexpr status begin_picture(polygon& out) {
  out.edges.count = 0;
  return on_screen(out.box) ? status::ok : status::bad_size;
}

// The `bits` bits below the highest of all of a kind: exact if they have no more.
constexpr int64_t cut_to(uint64_t x, uint64_t all, int bits) { return int64_t(x >> max_of(0, bit_length(all) - bits)); }

// Twice the areas of the triangles without each of four corners, on the screen or on the map, and the bits of all. False: not convex, or one has no area.
struct quad_areas { uint64_t without[4], all; };
SPANTEX_FRAME_APART constexpr bool set_areas(const edge* p, quad_areas& out) {
  int turns = 0;
  out.all = 0;
  for (int k = 0; k < 4; ++k) {
    const int64_t area = doubled_area(p[(k + 1) & 3], p[(k + 2) & 3], p[(k + 3) & 3]);
    if (area == 0) return false;
    turns += area > 0 ? 1 : -1;
    out.without[k] = magnitude(area);
    out.all |= out.without[k];
  }
  return turns == 4 || turns == -4;
}

enum class quad_shape : uint8_t { none, parallelogram, any };
SPANTEX_FRAME_APART constexpr quad_shape shape_of(const edge* map) {
  quad_areas a{};
  if (!set_areas(map, a)) return quad_shape::none;
  const bool alike = a.without[0] == a.without[1] && a.without[1] == a.without[2] && a.without[2] == a.without[3];
  return alike ? quad_shape::parallelogram : quad_shape::any;
}

// The product of the areas without the other two of three corners, in `bits` bits each. False: not convex.
SPANTEX_FRAME_APART constexpr bool set_products(const edge* corners, int bits, corner_weights& out) {
  quad_areas a{};
  if (!set_areas(corners, a)) return false;
  for (int n = 0; n < 3; ++n) {
    const uint64_t i = a.without[out.corner(next_of_three(n))], j = a.without[out.corner(next_of_three(next_of_three(n)))];
    out.of[n] = {};
    accumulate(out.of[n], uint64_t(cut_to(i, a.all, bits)), uint64_t(cut_to(j, a.all, bits)));
  }
  return true;
}

// Times the area without the corner itself, but for what all have in common.
SPANTEX_FRAME_APART constexpr void multiply_by_areas(const edge* map, int bits, corner_weights& out) {
  quad_areas a{};
  set_areas(map, a);
  const int whole = __builtin_ctzll(a.all);
  for (int n = 0; n < 3; ++n) {
    const wide both = out.of[n];
    out.of[n] = {};
    add_product(out.of[n], both, cut_to(a.without[out.corner(n)] >> whole, a.all >> whole, bits));
  }
}

// The plane of a quad that is the image of a quad on the map: with a_k and b_k the areas of the triangles without corner k on screen and map,
// sum (-1)^k a_k p_k = 0, so depths are a_k / b_k, and the product of two of three a_i a_j b_k but for what all have in common. Exact up to 4096 pixels and 16
// texels, or 4096 whole ones; parallelograms on the map (its rectangle) of any size. Errors: degenerate (one of the two is not convex, or has no area).
SPANTEX_FRAME_APART constexpr status hold_quad(polygon& out) {
  const edge *const corners = out.edges.edges, *const map = corners + map_slot;
  const quad_shape shape = shape_of(map);
  const int bits = shape == quad_shape::parallelogram ? 64 : 41;
  corner_weights w{{}, 3};
  if (shape == quad_shape::none || !set_products(corners, bits, w)) return status::degenerate;
  if (shape == quad_shape::any) multiply_by_areas(map, bits, w);
  return hold_plane_through(w, out.edges, out.map);
}

SPANTEX_FRAME_APART constexpr status hold_triangle(polygon& out) {
  const edge* const map = out.edges.edges + map_slot;
  corner_weights w{{wide(1), wide(1), wide(1)}, 2};
  if (map[0].c != map[1].c || map[1].c != map[2].c)
    for (int k = 0; k < 3; ++k) w.of[k] = wide(0, uint64_t(map[next_of_three(k)].c) * uint64_t(map[next_of_three(next_of_three(k))].c));
  return hold_plane_through(w, out.edges, out.map);
}

// From four or three corners. Errors: degenerate.
SPANTEX_FRAME_APART constexpr status finish_picture(polygon& out) {
  if (is_outside(out)) return status::degenerate;
  SPANTEX_TRY(out.edges.count == 4 ? hold_quad(out) : hold_triangle(out));
  SPANTEX_TRY(set_outline(out));
  return normalise(out.box, out.map);
}

// From `count` corners, each a screen_vertex that corner(k) says; the clip rectangle is out.box. Errors: bad_size, out_of_range, degenerate.
template <class Corner>
constexpr status make_picture(int count, const Corner& corner, polygon& out) {
  SPANTEX_TRY(begin_picture(out));
  for (int k = 0; k < count; ++k) SPANTEX_TRY(hold_corner(corner(k), out.edges));
  return finish_picture(out);
}

// To nearest; 2^52 / 3600 in place of a division of 64 bits.
constexpr binary_angle angle_of(int32_t tenths) {
  const int32_t within = (tenths % 3600 + 3600) % 3600;
  return {uint32_t((uint64_t(within) * 1250999896492u + (1u << 19)) >> 20)};
}

}  // namespace detail

// A picture with four corners on the screen, clockwise or not: the projective map that takes each to its corner of the map. Errors: bad_size (clip),
// out_of_range (a corner beyond 2^20 pixels, or 2^14 texels), degenerate (three corners in line, not convex, outside `clip`).
constexpr status make_quad(const screen_point (&corners)[4], const texel_point (&map)[4], rectangle clip, polygon& out) {
  out.box = clip;
  return detail::make_picture(4, [&](int k) { return screen_vertex{corners[k], map[k], 1}; }, out);
}

// Errors: bad_size (clip), out_of_range (as make_quad; w = 0), degenerate (no area, outside `clip`).
constexpr status make_triangle(const screen_vertex (&corners)[3], rectangle clip, polygon& out) {
  out.box = clip;
  return detail::make_picture(3, [&](int k) -> const screen_vertex& { return corners[k]; }, out);
}

// A picture turned about a pivot and scaled. LVGL's `angle` is this one, its `scale` of 256 is 65536 here, its pivot and position are shifted by 16 and 8 bits.
struct sprite {
  screen_point at;           // where the pivot lies on the screen
  texel_point pivot;
  int32_t scale_x, scale_y;  // s15.16 pixels a texel; negative: mirrored
  int32_t angle;             // 0.1 degree, clockwise
};

namespace detail {

// at += x a + y b, of s31.32 pixels by s1.30, to 1/256 pixel. False: beyond 2^20 pixels.
SPANTEX_FRAME_APART constexpr bool move_by(int32_t& at, int64_t x, int32_t a, int64_t y, int32_t b) {
  wide sum;
  add_product(sum, x, a);
  add_product(sum, y, b);
  round_off(sum, 30 + 32 - subpixel_bits);
  if (bit_length(sum) > 30) return false;
  at += int32_t(to_int64(sum));
  return magnitude(at) < uint64_t(max_corner);
}

// Corners on the screen, as they are held until edges are made. Errors: out_of_range.
SPANTEX_FRAME_APART constexpr status hold_sprite_corners(const sprite& s, const sine_cosine& turn, int32_t width, int32_t height, edge_set& out) {
  for (int k = 0; k < 4; ++k) {
    const texel_point corner = corner_of_map(k, width, height);
    const int64_t x = (int64_t(corner.u) - s.pivot.u) * s.scale_x, y = (int64_t(corner.v) - s.pivot.v) * s.scale_y;  // s31.32 pixels
    screen_point p = s.at;
    if (!move_by(p.x, x, turn.cosine, y, -turn.sine) || !move_by(p.y, x, turn.sine, y, turn.cosine)) return status::out_of_range;
    hold(p, out);
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

// The clip rectangle is out.box.
SPANTEX_FRAME_APART constexpr status make_sprite(const sprite& s, int32_t width, int32_t height, polygon& out) {
  if (width < 1 || height < 1 || width > 4096 || height > 4096) return status::bad_size;
  SPANTEX_TRY(begin_picture(out));
  if (!in_range(s.at)) return status::out_of_range;
  if (s.scale_x == 0 || s.scale_y == 0) return status::degenerate;
  const sine_cosine turn = sine_cosine_of(angle_of(s.angle));
  SPANTEX_TRY(hold_sprite_corners(s, turn, width, height, out.edges));
  if (is_outside(out)) return status::degenerate;
  SPANTEX_TRY(set_outline(out));
  hold_sprite(s, turn, out.map);
  return normalise(out.box, out.map);
}

}  // namespace detail

// The whole of a map of width x height texels. With c, s the cosine and sine of camera.hpp (s1.30, within 1.4 units; exact at right angles)
//   u = pivot + (c (x - at.x) + s (y - at.y)) / scale_x,  v = pivot + (c (y - at.y) - s (x - at.x)) / scale_y
// exactly; corners by the inverse, to 1/256 pixel. Errors: bad_size (clip, map's sides outside 1..4096), out_of_range (a corner beyond 2^20 pixels),
// degenerate (a scale of 0, outside `clip`).
constexpr status make_sprite(const sprite& s, int32_t width, int32_t height, rectangle clip, polygon& out) {
  out.box = clip;
  return detail::make_sprite(s, width, height, out);
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

// The world's axes along the camera's, held in the plane's forms.
constexpr void hold_attitude(const looking_camera& c, plane& out) {
  set_attitude(angle_of(c.roll), angle_of(c.pitch), angle_of(c.heading == INT32_MIN ? -(c.heading + 3600) : -c.heading), out.u, out.v, out.w);
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

// Held as the plane's exact forms, from the attitude in the others.
SPANTEX_FRAME_APART constexpr void hold_floor(const looking_camera& camera, const floor_map& map, plane& out) {
  const int sign = map.height > 0 ? -1 : 1;  // rays that go down meet what is below
  const ground g{map.height, map.texels_per_unit * sign};
  const linear_form &x = out.u, &y = out.v, &z = out.w;
  for (int axis = 0; axis < 3; ++axis) {  // right, up, ahead
    const auto part = [axis](const linear_form& f) { return axis == 0 ? f.c : axis == 1 ? f.y : f.x; };
    const int64_t down = part(y);
    set_ground_numerator(coefficient(out.exact_u, axis), g, map.x, part(x), down);
    set_ground_numerator(coefficient(out.exact_v, axis), g, map.z, part(z), down);
    coefficient(out.exact_w, axis) = wide(sign * down);
  }
  for (int k = 0; k < 3; ++k) turn_to_rays(camera, exact_form(out, k));
}

}  // namespace detail

// The part of the level map in view within `region`. Numerators are rounded at 2^-40 (camera.hpp). Errors: bad_size (region), out_of_range (focal or
// texels_per_unit not positive), degenerate (height 0, or nothing in view).
[[gnu::noinline]] constexpr status make_floor(const looking_camera& camera, const floor_map& map, rectangle region, plane& out) {
  if (camera.focal <= 0 || map.texels_per_unit <= 0) return status::out_of_range;
  if (map.height == 0) return status::degenerate;
  detail::hold_attitude(camera, out);
  detail::hold_floor(camera, map, out);
  return detail::normalise(region, out);
}

// Faces of a cube seen from its middle, each a map as one sees it there, upright; those above and below as one sees them looking up and down from `ahead`.
enum class cube_face : uint8_t { ahead, right, behind, left, above, below };
inline constexpr int cube_face_count = 6;

namespace detail {

// Corners of a face on the screen, clockwise from the top left, as they are held until edges are made, from the attitude in the plane's forms. Errors:
// out_of_range.
SPANTEX_FRAME_APART constexpr status hold_cube_corners(const looking_camera& camera, int face, polygon& out) {
  constexpr uint8_t corners[6][4] = {{3, 7, 5, 1}, {7, 6, 4, 5}, {6, 2, 0, 4}, {2, 3, 1, 0}, {2, 6, 7, 3}, {1, 5, 4, 0}};  // bits: 1 ahead, 2 up, 4 right
  const linear_form &x = out.map.u, &y = out.map.v, &z = out.map.w;
  out.edges.count = 0;
  for (int corner : corners[face]) {
    const auto along = [corner](int64_t ahead, int64_t up, int64_t right) {  // 256 units to a face
      const int64_t sum = ((corner & 1) != 0 ? ahead : -ahead) + ((corner & 2) != 0 ? up : -up) + ((corner & 4) != 0 ? right : -right);
      return int32_t(shift_right(sum, camera_bits - 24));
    };
    const vertex v{along(x.c, y.c, z.c), -along(x.y, y.y, z.y), along(x.x, y.x, z.x), 0, 0};
    SPANTEX_TRY(hold_projected(v, {camera.focal, camera.focal, camera.centre_x, camera.centre_y, 0}, out.edges));
  }
  return status::ok;
}

// The clip rectangle is out.box.
SPANTEX_FRAME_APART constexpr status make_cube_face(const looking_camera& camera, cube_face face, int32_t width, int32_t height, polygon& out) {
  if (width < 1 || height < 1 || width > 4096 || height > 4096 || !on_screen(out.box)) return status::bad_size;
  if (camera.focal <= 0 || int(face) >= cube_face_count) return status::out_of_range;
  hold_attitude(camera, out.map);
  SPANTEX_TRY(hold_cube_corners(camera, int(face), out));
  constexpr int32_t one = 1 << 16;
  SPANTEX_TRY(finish_triangle(one, {{{0, 0}, {width * one, 0}, {width * one, height * one}}}, out));
  out.depth = {};
  return status::ok;
}

}  // namespace detail

// Edges of neighbours are the same: together the faces cover every pixel once. Errors: bad_size (clip, sides outside 1..4096), out_of_range (focal not positive,
// or 2^28 pixels reached), degenerate (not in view).
constexpr status make_cube_face(const looking_camera& camera, cube_face face, int32_t width, int32_t height, rectangle clip, polygon& out) {
  out.box = clip;
  return detail::make_cube_face(camera, face, width, height, out);
}

}  // namespace spantex
