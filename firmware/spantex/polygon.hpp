// SPDX-License-Identifier: Apache-2.0
// Convex polygons: perspective-correct planes from vertices, clipping, projection, depth.
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>
#include <spantex/coverage.hpp>
#include <spantex/plane.hpp>
#include <spantex/reciprocal.hpp>
#include <spantex/status.hpp>
#include <spantex/wide.hpp>

namespace spantex {

// A vertex in camera space (z forward), s15.16, with its texture coordinates in texels of level 0, s15.16.
struct vertex {
  int32_t x, y, z;
  int32_t u, v;
};

// A position of the map, s15.16 texels of level 0.
struct texel_point { int32_t u, v; };

// Where the camera's rays meet the screen: screen = focal * (x, y) / z + centre. Pixels, s15.16, any number.
struct projection {
  int32_t focal_x, focal_y;
  int32_t centre_x, centre_y;
  int32_t near_z;              // s15.16, > 0: what is nearer is clipped
};

inline constexpr int max_polygon_vertices = 8;

// Homogeneous screen position, 16 fraction bits: screen = (x, y) / z. |x|, |y| < 2^44, |z| < 2^31.
struct homogeneous_point { int64_t x, y, z; };
inline constexpr uint64_t max_homogeneous = uint64_t(1) << 44;

// What would be 2^63 is -2^63: beyond the range as well.
SPANTEX_WRAPS constexpr homogeneous_point project(const vertex& p, const projection& c) {
  const auto axis = [&](int32_t x, int32_t focal, int32_t centre) SPANTEX_WRAPS {
    return shift_right(int64_t(uint64_t(int64_t(x) * focal) + uint64_t(int64_t(p.z) * centre)), 16);
  };
  return {axis(p.x, c.focal_x, c.centre_x), axis(p.y, c.focal_y, c.centre_y), p.z};
}

namespace detail {

// Until edges are made of them, corners of a polygon lie where its edges will, as a = x, b = y, c = z: set-up takes no other memory to speak of.
constexpr int64_t on_axis(const edge& p, int axis) { return axis == 0 ? p.a : axis == 1 ? p.b : p.c; }
constexpr homogeneous_point corner_in(const edge& e) { return {e.a, e.b, e.c}; }
constexpr edge held(const homogeneous_point& p) { return {p.x, p.y, p.z}; }

// Row `axis` (x, y, z) of the adjugate of the matrix whose columns are three homogeneous points. At most 77 bits.
struct adjugate_row { wide of[3]; };
constexpr int next_of_three(int k) { return k == 2 ? 0 : k + 1; }
constexpr void make_adjugate_row(const edge* const (&v)[3], int axis, adjugate_row& out) {
  const int next = next_of_three(axis), after = next_of_three(next);
  for (int k = 0; k < 3; ++k) {
    const edge &a = *v[next_of_three(k)], &b = *v[next_of_three(next_of_three(k))];
    set_difference(out.of[k], on_axis(a, next), on_axis(b, after), on_axis(a, after), on_axis(b, next));
  }
}

// Coefficient of the linear form that takes the value det * t_k at vertex k, of an attribute t. At most 123 bits.
SPANTEX_FRAME_APART constexpr void interpolate(const adjugate_row& m, int32_t t0, int32_t t1, int32_t t2, wide& out) {
  out = {};
  add_product(out, m.of[0], t0);
  add_product(out, m.of[1], t1);
  add_product(out, m.of[2], t2);
}

// Point where the segment from `inside` to `outside` meets the plane where a distance is zero; rounded to nearest, and always from
// the inside end, so that two polygons sharing the edge get the same point. `out` may be one of the two.
SPANTEX_FRAME_APART constexpr void cut(const edge& inside, const edge& outside, int64_t d_in, int64_t d_out, edge& out) {
  for (int axis = 0; axis < 3; ++axis) {
    const int64_t a = on_axis(inside, axis), b = on_axis(outside, axis);
    (axis == 0 ? out.a : axis == 1 ? out.b : out.c) = a + divide_nearest(multiply(b - a, d_in), d_in - d_out);
  }
}

// Sides of a view in the order in which they cut: the near plane, then two for x and two for y, in pixels.
struct view_sides {
  int32_t limits[4];
  bool lower_first;
};
inline constexpr view_sides guard_band{{guard_px, -guard_px, guard_px, -guard_px}, false};
inline constexpr int view_side_count = 5;

// From a side, inwards.
constexpr int64_t distance_from(int side, int64_t near_z, const view_sides& sides, const edge& p) {
  if (side == 0) return p.c - near_z;
  const int64_t away = (side <= 2 ? p.a : p.b) - p.c * sides.limits[side - 1];
  return (side % 2 != 0) == sides.lower_first ? away : -away;
}

inline constexpr int max_clipped = max_polygon_vertices + view_side_count;
static_assert(max_clipped < max_edges - 1);

// Keeps the part within the view (Sutherland and Hodgman), in place: for each side corners move to the end, the first again behind the last, and what is kept
// is written from the start. That never meets what is not read yet if the outline is convex; else corners are lost.
SPANTEX_FRAME_APART constexpr void clip_to_view(int64_t near_z, const view_sides& sides, edge_set& o) {
  for (int side = 0; side < view_side_count && o.count != 0; ++side) {
    bool inside = true;
    for (int k = 0; k < o.count; ++k) inside &= distance_from(side, near_z, sides, o.edges[k]) >= 0;
    if (inside) continue;
    const int start = max_edges - 1 - o.count;
    o.edges[max_edges - 1] = o.edges[0];
    for (int k = o.count - 1; k >= 0; --k) o.edges[start + k] = o.edges[k];
    int kept = 0;
    int64_t next = distance_from(side, near_z, sides, o.edges[start]);
    for (int read = start; read < max_edges - 1; ++read) {
      const int64_t here = next;
      next = distance_from(side, near_z, sides, o.edges[read + 1]);
      const edge &p = o.edges[read], &q = o.edges[read + 1];
      const auto room = [read, &kept] { return kept <= read && kept < max_clipped; };
      if (here >= 0 && room()) o.edges[kept++] = p;
      if (here >= 0 && next < 0 && room()) cut(p, q, here, next, o.edges[kept++]);
      if (here < 0 && next >= 0 && room()) cut(q, p, next, here, o.edges[kept++]);
    }
    o.count = kept;
  }
}

// x / z in 1/256 pixel, to nearest (halves up), |result| <= guard.
constexpr int32_t snapped(int64_t x, int64_t z) {
  const int64_t n = x * (int64_t(2) << subpixel_bits) + z, d = 2 * z;      // floor((2^9 x + z) / 2z)
  const int64_t q = n / d - (n % d < 0 ? 1 : 0);
  constexpr int64_t limit = int64_t(guard_px) << subpixel_bits;
  return int32_t(clamp_to(q, -limit, limit));
}

}  // namespace detail

// What set-up leaves for drawing one polygon.
struct polygon {
  plane map;           // u, v, W
  linear_form depth;   // near/z as u0.31 with depth_guard_bits more, on the plane's origin: larger is nearer. |x|, |y| < 2^57; modulo 2^64, which pixels of the polygon never reach
  edge_set edges;
  rectangle box;       // pixels that may be covered, within the clip rectangle
  bool front_facing;   // clockwise on the screen
  friend constexpr bool operator==(const polygon&, const polygon&) = default;
};

inline constexpr int depth_guard_bits = 16;

namespace detail {

// Edges, box and facing of a clipped outline, in its place; the clip rectangle is in that of the box. Errors: degenerate (no area, outside the clip rectangle).
SPANTEX_FRAME_APART constexpr status make_edges(polygon& out) {
  edge_set& o = out.edges;
  const int corners = o.count;
  if (corners < 3) return status::degenerate;
  int32_t left = INT32_MAX, top = INT32_MAX, right = INT32_MIN, bottom = INT32_MIN;
  for (int k = 0; k < corners; ++k) {
    edge& e = o.edges[k];
    const int32_t x = snapped(e.a, e.c), y = snapped(e.b, e.c);
    e = {x, y, 0};
    left = min_of(left, x);
    right = max_of(right, x);
    top = min_of(top, y);
    bottom = max_of(bottom, y);
  }
  o.edges[corners] = o.edges[0];
  int64_t area = 0;
  for (int k = 0; k < corners; ++k) area += o.edges[k].a * o.edges[k + 1].b - o.edges[k + 1].a * o.edges[k].b;
  if (area == 0) return status::degenerate;
  const bool clockwise = area > 0;
  o.count = 0;
  for (int k = 0; k < corners; ++k) {
    const screen_point p{int32_t(o.edges[k].a), int32_t(o.edges[k].b)}, q{int32_t(o.edges[k + 1].a), int32_t(o.edges[k + 1].b)};
    if (p.x == q.x && p.y == q.y) continue;
    o.edges[o.count++] = clockwise ? make_edge(p, q) : make_edge(q, p);
  }
  for (int k = o.count; k < max_edges; ++k) o.edges[k] = {};
  out.box = intersection(out.box, {left >> subpixel_bits, top >> subpixel_bits, (right >> subpixel_bits) + 1, (bottom >> subpixel_bits) + 1});
  if (out.box.empty()) return status::degenerate;
  out.front_facing = clockwise;
  return status::ok;
}

inline constexpr int depth_gradient_bits = 57;  // so that what a span reaches beyond a pixel of the polygon stays within 2^62

// The plane's W, scaled to depth. W = 2 W' / 2^drop. A polygon so nearly edge-on that the place of its edges, 2^-8 pixels, leaves all depths open has that of its origin everywhere.
SPANTEX_FRAME_APART constexpr void set_depth(const plane& p, const wide& determinant, int drop, int32_t near_z, linear_form& out) {
  // W' = 2^16 det / z, so near / z * 2^31 = W' near 2^15 / |det| = W 2^(drop - 1) near 2^15 / |det|
  const wide d = magnitude(determinant);
  const int shift = bit_length(d) - 32;
  const uint32_t mantissa = uint32_t(to_int64(shift >= 0 ? shift_right_floor(d, shift) : shift_left(d, -shift)));
  const uint64_t k = uint64_t(reciprocal_wide(mantissa)) * uint64_t(uint32_t(near_z));   // 2^63 near / mantissa
  const int down = 63 + shift - (drop - 1) - 15 - depth_guard_bits;
  const auto scaled = [k, down](int64_t x) { return narrowed(multiply(x, int64_t(k)), down); };
  constexpr int depth_bits = 31 + depth_guard_bits;
  const int gain = bit_length(k) - down;
  const bool steep = bit_length(magnitude(p.w.x) | magnitude(p.w.y)) + gain > depth_gradient_bits;
  out.x = steep ? 0 : scaled(p.w.x);
  out.y = steep ? 0 : scaled(p.w.y);
  out.c = scaled(p.w.c);
  if (steep && bit_length(magnitude(p.w.c)) + gain > depth_bits) out.c = p.w.c > 0 ? int64_t(1) << depth_bits : 0;
}

// What vertex attributes other than u and v are interpolated with (shade.hpp).
struct polygon_basis {
  int second, drop;  // vertices 0, second, second + 1; W of the plane = 2 W of their adjugate / 2^drop
};

}  // namespace detail

// Whether a polygon is nearer than near_z or beyond one side of the clip rectangle as a whole: make_polygon, which costs many times as much, would find that
// it covers nothing. False for what make_polygon reports otherwise.
constexpr bool is_outside(const vertex* vertices, int count, const projection& camera, rectangle clip) {
  if (count < 3 || count > max_polygon_vertices || !on_screen(clip) || camera.near_z <= 0) return false;
  bool near = true, left = true, right = true, above = true, below = true;
  for (int k = 0; k < count; ++k) {
    const homogeneous_point p = project(vertices[k], camera);
    if (magnitude(p.x) >= max_homogeneous || magnitude(p.y) >= max_homogeneous) return false;
    near = near && p.z < camera.near_z;
    left = left && p.x < clip.x0 * p.z;
    right = right && p.x > clip.x1 * p.z;
    above = above && p.y < clip.y0 * p.z;
    below = below && p.y > clip.y1 * p.z;
  }
  return near || left || right || above || below;
}

namespace detail {

struct vertex_pointers { const vertex* to[max_polygon_vertices]; };
constexpr vertex_pointers pointers_to(const vertex* vertices, int count) {
  vertex_pointers out{};
  for (int k = 0; k < count; ++k) out.to[k] = vertices + k;
  return out;
}

// A corner more, projected, as it is held until edges are made. Errors: out_of_range.
SPANTEX_FRAME_APART constexpr status hold_projected(const vertex& v, const projection& camera, edge_set& out) {
  const homogeneous_point p = project(v, camera);
  if (magnitude(p.x) >= max_homogeneous || magnitude(p.y) >= max_homogeneous) return status::out_of_range;
  out.edges[out.count++] = held(p);
  return status::ok;
}

struct three_texels { texel_point at[3]; };
constexpr wide& coefficient(wide_form& f, int axis) { return axis == 0 ? f.x : axis == 1 ? f.y : f.c; }

// u/z = (adj . u) / det and 1/z = (adj . 1) / det, of held corners 0, second and second + 1: det cancels in u but for its sign.
SPANTEX_FRAME_APART constexpr void make_forms(const three_texels& map, int second, polygon& out, wide& determinant) {
  const edge* const corners[] = {&out.edges.edges[0], &out.edges.edges[second], &out.edges.edges[second + 1]};
  constexpr int32_t one = 1 << 16;  // u, v carry 16 fraction bits, so W must
  plane& p = out.map;
  determinant = {};
  for (int axis = 0; axis < 3; ++axis) {
    adjugate_row row;
    make_adjugate_row(corners, axis, row);
    add_product(determinant, row.of[0], on_axis(*corners[0], axis));
    interpolate(row, map.at[0].u, map.at[1].u, map.at[2].u, coefficient(p.exact_u, axis));
    interpolate(row, map.at[0].v, map.at[1].v, map.at[2].v, coefficient(p.exact_v, axis));
    interpolate(row, one, one, one, coefficient(p.exact_w, axis));
  }
  const uint64_t sign = sign_of(determinant.high);
  for (int k = 0; k < 3; ++k)
    for (int axis = 0; axis < 3; ++axis) negate_if(coefficient(exact_form(p, k), axis), sign);
}

// The rest of set-up but depth, from held corners and forms. Errors: degenerate.
SPANTEX_FRAME_MERGED constexpr status finish_polygon(int32_t near_z, const wide& determinant, int& drop, polygon& out) {
  if (determinant.zero()) return status::degenerate;
  clip_to_view(near_z, guard_band, out.edges);
  SPANTEX_TRY(make_edges(out));
  return normalise(out.box, out.map, drop);
}

SPANTEX_FRAME_MERGED constexpr status finish_triangle(int32_t near_z, const three_texels& map, polygon& out) {
  wide determinant;
  make_forms(map, 1, out, determinant);
  int drop = 0;
  return finish_polygon(near_z, determinant, drop, out);
}

// No corners yet; the clip rectangle is out.box. Errors: bad_size, out_of_range.
constexpr status begin_polygon(const projection& camera, polygon& out) {
  out.edges.count = 0;
  if (!on_screen(out.box)) return status::bad_size;
  return camera.near_z <= 0 ? status::out_of_range : status::ok;
}

// A triangle whose vertices corner(0), corner(1), corner(2) are, each asked for once, for who has no depths: out.depth is left as it is. The clip rectangle is out.box.
template <class Corner>
constexpr status make_triangle_of(const projection& camera, const Corner& corner, polygon& out) {
  three_texels map{};
  SPANTEX_TRY(begin_polygon(camera, out));
  for (int n = 0; n < 3; ++n) {
    const vertex& v = corner(n);
    SPANTEX_TRY(hold_projected(v, camera, out.edges));
    map.at[n] = {v.u, v.v};
  }
  return finish_triangle(camera.near_z, map, out);
}

// The clip rectangle is out.box.
SPANTEX_FRAME_APART constexpr status make_polygon(const vertex* const* vertices, int count, const projection& camera, polygon& out, polygon_basis& basis) {
  if (count < 3 || count > max_polygon_vertices) return status::bad_size;
  SPANTEX_TRY(begin_polygon(camera, out));
  for (int k = 0; k < count; ++k) SPANTEX_TRY(hold_projected(*vertices[k], camera, out.edges));
  int& second = basis.second;
  second = 0;
  wide determinant;
  do {
    ++second;
    const vertex &a = *vertices[0], &b = *vertices[second], &c = *vertices[second + 1];
    make_forms({{{a.u, a.v}, {b.u, b.v}, {c.u, c.v}}}, second, out, determinant);
  } while (determinant.zero() && second + 2 < count);
  SPANTEX_TRY(finish_polygon(camera.near_z, determinant, basis.drop, out));
  set_depth(out.map, determinant, basis.drop, camera.near_z, out.depth);
  return status::ok;
}

}  // namespace detail

// Sets a convex planar polygon up: the plane through its first three vertices that span one, edges after clipping against the
// near plane and the guard band. Errors: bad_size (3..8 vertices; clip rectangle), out_of_range (near_z <= 0; a vertex beyond
// 2^28 pixels times depth), degenerate (zero area, edge-on, outside); what is left in `out` then is undefined.
// No divisor W <= 0 survives: what lies nearer than near_z is cut off before projection.
constexpr status make_polygon(const vertex* vertices, int count, const projection& camera, rectangle clip, polygon& out) {
  if (count < 3 || count > max_polygon_vertices) return status::bad_size;
  detail::polygon_basis basis{};
  out.box = clip;
  return detail::make_polygon(detail::pointers_to(vertices, count).to, count, camera, out, basis);
}

namespace detail {

// dx, dy half pixels from the form's origin.
SPANTEX_WRAPS constexpr uint32_t depth_of(const linear_form& depth, int32_t dx, int32_t dy) {
  const int64_t d = int64_t(uint64_t(depth.c) + uint64_t(depth.x) * uint64_t(dx) + uint64_t(depth.y) * uint64_t(dy)) >> depth_guard_bits;
  return uint32_t(clamp_to(d, int64_t(1), int64_t(1) << 31));
}

}  // namespace detail

// Depth of a pixel, larger is nearer: near/z as u0.31, saturated to [1, 2^31].
constexpr uint32_t depth_at(const polygon& p, int32_t hx, int32_t hy) {
  return detail::depth_of(p.depth, hx - p.map.origin_x, hy - p.map.origin_y);
}

}  // namespace spantex
