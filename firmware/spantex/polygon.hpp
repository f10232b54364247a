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

// Where the camera's rays meet the screen: screen = focal * (x, y) / z + centre. Pixels, s15.16.
struct projection {
  int32_t focal_x, focal_y;
  int32_t centre_x, centre_y;
  int32_t near_z;              // s15.16, > 0: what is nearer is clipped
};

inline constexpr int max_polygon_vertices = 8;

// Homogeneous screen position, 16 fraction bits: screen = (x, y) / z. |x|, |y| < 2^44, |z| < 2^31.
struct homogeneous_point { int64_t x, y, z; };
inline constexpr uint64_t max_homogeneous = uint64_t(1) << 44;

constexpr homogeneous_point project(const vertex& p, const projection& c) {
  const auto axis = [&](int32_t x, int32_t focal, int32_t centre) {
    return shift_right(int64_t(x) * focal + int64_t(p.z) * centre, 16);
  };
  return {axis(p.x, c.focal_x, c.centre_x), axis(p.y, c.focal_y, c.centre_y), p.z};
}

namespace detail {

// Rows of the adjugate of the matrix of three homogeneous vertices, dotted with an attribute: the linear form that
// takes the value det * t_k at vertex k. At most 123 bits.
struct attribute_form { wide x, y, c; };
struct adjugate {
  wide x[3], y[3], c[3];
  wide determinant;
};

constexpr adjugate make_adjugate(const homogeneous_point& p, const homogeneous_point& q, const homogeneous_point& r) {
  adjugate m;
  const homogeneous_point* v[3] = {&p, &q, &r};
  for (int k = 0; k < 3; ++k) {
    const homogeneous_point &a = *v[(k + 1) % 3], &b = *v[(k + 2) % 3];
    m.x[k] = multiply(a.y, b.z) - multiply(a.z, b.y);
    m.y[k] = multiply(a.z, b.x) - multiply(a.x, b.z);
    m.c[k] = multiply(a.x, b.y) - multiply(a.y, b.x);
  }
  m.determinant = multiply(m.x[0], p.x) + multiply(m.y[0], p.y) + multiply(m.c[0], p.z);
  return m;
}

constexpr attribute_form interpolate(const adjugate& m, int32_t t0, int32_t t1, int32_t t2, bool negate) {
  const auto dot = [&](const wide* k) {
    const wide sum = multiply(k[0], t0) + multiply(k[1], t1) + multiply(k[2], t2);
    return negate ? -sum : sum;
  };
  return {dot(m.x), dot(m.y), dot(m.c)};
}

// Point where the segment from `inside` to `outside` meets the plane where a distance is zero; rounded to nearest, and always from
// the inside end, so that two polygons sharing the edge get the same point.
constexpr homogeneous_point cut(const homogeneous_point& inside, const homogeneous_point& outside, int64_t d_in, int64_t d_out) {
  const int64_t length = d_in - d_out;
  const auto axis = [&](int64_t a, int64_t b) { return a + divide_nearest(multiply(b - a, d_in), length); };
  return {axis(inside.x, outside.x), axis(inside.y, outside.y), axis(inside.z, outside.z)};
}

inline constexpr int max_clipped = max_polygon_vertices + 5;

struct outline {
  homogeneous_point points[max_clipped];
  int count = 0;
};

// Keeps the part where distance(point) >= 0 (Sutherland and Hodgman).
template <class Distance>
constexpr outline clip(const outline& in, Distance distance) {
  outline out;
  for (int k = 0; k < in.count; ++k) {
    const homogeneous_point &a = in.points[k], &b = in.points[k + 1 == in.count ? 0 : k + 1];
    const int64_t da = distance(a), db = distance(b);
    if (da >= 0 && out.count < max_clipped) out.points[out.count++] = a;
    if ((da >= 0) != (db >= 0) && out.count < max_clipped)
      out.points[out.count++] = da >= 0 ? cut(a, b, da, db) : cut(b, a, db, da);
  }
  return out;
}

constexpr outline clip_to_view(outline o, int64_t near_z) {
  o = clip(o, [&](const homogeneous_point& p) { return p.z - near_z; });
  o = clip(o, [&](const homogeneous_point& p) { return p.z * guard_px - p.x; });
  o = clip(o, [&](const homogeneous_point& p) { return p.z * guard_px + p.x; });
  o = clip(o, [&](const homogeneous_point& p) { return p.z * guard_px - p.y; });
  return clip(o, [&](const homogeneous_point& p) { return p.z * guard_px + p.y; });
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
  linear_form depth;   // near/z as u0.31 with depth_guard_bits more, on the plane's origin: larger is nearer
  edge_set edges;
  rectangle box;       // pixels that may be covered, within the clip rectangle
  bool front_facing;   // clockwise on the screen
  friend constexpr bool operator==(const polygon&, const polygon&) = default;
};

inline constexpr int depth_guard_bits = 16;

namespace detail {

// Edges, box and facing of a clipped outline. Errors: degenerate (no area, outside `clip`).
constexpr status set_edges(const outline& clipped, rectangle clip, polygon& out) {
  if (clipped.count < 3) return status::degenerate;
  screen_point points[max_clipped];
  int64_t area = 0;
  int32_t left = INT32_MAX, top = INT32_MAX, right = INT32_MIN, bottom = INT32_MIN;
  for (int k = 0; k < clipped.count; ++k) {
    const homogeneous_point& p = clipped.points[k];
    points[k] = {snapped(p.x, p.z), snapped(p.y, p.z)};
    left = min_of(left, points[k].x);
    right = max_of(right, points[k].x);
    top = min_of(top, points[k].y);
    bottom = max_of(bottom, points[k].y);
  }
  for (int k = 0; k < clipped.count; ++k) {
    const screen_point &p = points[k], &q = points[k + 1 == clipped.count ? 0 : k + 1];
    area += int64_t(p.x) * q.y - int64_t(q.x) * p.y;
  }
  if (area == 0) return status::degenerate;
  const bool clockwise = area > 0;
  out.edges.count = 0;
  for (int k = 0; k < clipped.count; ++k) {
    const screen_point &p = points[k], &q = points[k + 1 == clipped.count ? 0 : k + 1];
    if (p.x == q.x && p.y == q.y) continue;
    out.edges.edges[out.edges.count++] = clockwise ? make_edge(p, q) : make_edge(q, p);
  }
  out.box = intersection(clip, {left >> subpixel_bits, top >> subpixel_bits, (right >> subpixel_bits) + 1, (bottom >> subpixel_bits) + 1});
  if (out.box.empty()) return status::degenerate;
  out.front_facing = clockwise;
  return status::ok;
}

// The plane's W, scaled to depth. W = 2 W' / 2^drop.
constexpr linear_form depth_form(const plane& p, wide determinant, int drop, int32_t near_z) {
  // W' = 2^16 det / z, so near / z * 2^31 = W' near 2^15 / |det| = W 2^(drop - 1) near 2^15 / |det|
  const wide d = magnitude(determinant);
  const int shift = bit_length(d) - 32;
  const uint32_t mantissa = uint32_t(to_int64(shift >= 0 ? shift_right_floor(d, shift) : shift_left(d, -shift)));
  const uint64_t k = uint64_t(reciprocal_wide(mantissa)) * uint64_t(uint32_t(near_z));   // 2^63 near / mantissa
  const auto scaled = [&](int64_t x) {
    const int down = 63 + shift - (drop - 1) - 15 - depth_guard_bits;
    return to_int64(scale_down(multiply(wide(x), int64_t(k)), down));
  };
  return {scaled(p.w.x), scaled(p.w.y), scaled(p.w.c)};
}

// What vertex attributes other than u and v are interpolated with (shade.hpp).
struct polygon_basis {
  adjugate adjugated;
  int second, drop;  // vertices 0, second, second + 1; W of the plane = 2 W of the adjugate / 2^drop
};

constexpr status make_polygon(const vertex* vertices, int count, const projection& camera, rectangle clip, polygon& out, polygon_basis& basis);

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

// Sets a convex planar polygon up: the plane through its first three vertices that span one, edges after clipping against the
// near plane and the guard band. Errors: bad_size (3..8 vertices; clip rectangle), out_of_range (near_z <= 0; a vertex beyond
// 2^28 pixels times depth), degenerate (zero area, edge-on, outside).
// No divisor W <= 0 survives: what lies nearer than near_z is cut off before projection.
constexpr status make_polygon(const vertex* vertices, int count, const projection& camera, rectangle clip, polygon& out) {
  detail::polygon_basis basis{};
  return detail::make_polygon(vertices, count, camera, clip, out, basis);
}

constexpr status detail::make_polygon(const vertex* vertices, int count, const projection& camera, rectangle clip, polygon& out,
                                      polygon_basis& basis) {
  if (count < 3 || count > max_polygon_vertices) return status::bad_size;
  if (!on_screen(clip)) return status::bad_size;
  if (camera.near_z <= 0) return status::out_of_range;
  detail::outline o;
  for (int k = 0; k < count; ++k) {
    const homogeneous_point p = project(vertices[k], camera);
    if (magnitude(p.x) >= max_homogeneous || magnitude(p.y) >= max_homogeneous) return status::out_of_range;
    o.points[o.count++] = p;
  }

  detail::adjugate m;
  int second = 1;
  do {
    m = detail::make_adjugate(o.points[0], o.points[second], o.points[second + 1]);
  } while (m.determinant.zero() && ++second + 1 < count);
  if (m.determinant.zero()) return status::degenerate;
  const vertex &a = vertices[0], &b = vertices[second], &c = vertices[second + 1];

  const detail::outline clipped = detail::clip_to_view(o, camera.near_z);
  SPANTEX_TRY(detail::set_edges(clipped, clip, out));

  // u/z = (adj . u) / det and 1/z = (adj . 1) / det: det cancels in u but for its sign.
  const bool negative = m.determinant.negative();
  const detail::attribute_form fu = detail::interpolate(m, a.u, b.u, c.u, negative), fv = detail::interpolate(m, a.v, b.v, c.v, negative);
  constexpr int32_t one = 1 << 16;  // u, v carry 16 fraction bits, so W must
  const detail::attribute_form fw = detail::interpolate(m, one, one, one, negative);
  const homography h{fu.x, fu.y, fu.c, fv.x, fv.y, fv.c, fw.x, fw.y, fw.c};
  int drop = 0;
  SPANTEX_TRY(detail::normalise(h, out.box, out.map, drop));
  out.depth = detail::depth_form(out.map, m.determinant, drop, camera.near_z);
  basis = {m, second, drop};
  return status::ok;
}

namespace detail {

// dx, dy half pixels from the form's origin.
constexpr uint32_t depth_of(const linear_form& depth, int32_t dx, int32_t dy) {
  const int64_t d = (depth.c + depth.x * dx + depth.y * dy) >> depth_guard_bits;
  return uint32_t(clamp_to(d, int64_t(1), int64_t(1) << 31));
}

}  // namespace detail

// Depth of a pixel, larger is nearer: near/z as u0.31, saturated to [1, 2^31].
constexpr uint32_t depth_at(const polygon& p, int32_t hx, int32_t hy) {
  return detail::depth_of(p.depth, hx - p.map.origin_x, hy - p.map.origin_y);
}

}  // namespace spantex
