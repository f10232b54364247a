// SPDX-License-Identifier: Apache-2.0
// What programs draw (spantex/pictures.hpp), by rows, in one call each:
//
//   rows::draw<filter::bilinear>(memory, target, quad{...}, map)          four corners
//   rows::draw<filter::nearest>(memory, target, sprite{...}, map)         a picture turned and scaled
//   rows::draw<filter::bilinear>(memory, target, triangle_list{...}, map) on the screen, perspective or affine
//   rows::draw<filter::bilinear>(memory, target, mesh{...}, map)          in camera space, clipped
//   rows::draw<filter::trilinear>(memory, target, floor_view{...}, map)   mode 7, or a ceiling
//   rows::draw<filter::bilinear>(memory, target, cube_view{...})          the six faces of a sky
//
// and draw_any with the filter as its first argument. Set-up is for the target's whole screen, so clips, strips and tiles show the same pixels.
#pragma once
#include <stdint.h>

#include <spantex/pictures.hpp>
#include <spantex/rows/draw.hpp>
#include <spantex/status.hpp>

namespace spantex::rows {

inline namespace SPANTEX_ROWS_KERNELS {

// The caller's memory, in which set-up works too: 1344 bytes on a core of 32 bits, 1912 and 2104 with kernels (run.hpp).
struct picture_state : state { polygon shape; };

}  // namespace SPANTEX_ROWS_KERNELS

// Corners clockwise from that of the map's texel (0, 0), or with map positions of their own.
struct quad {
  screen_point corners[4];
  const texel_point* map = nullptr;  // four; none: the map's rectangle
};

namespace detail {

// Set-up is apart: its frames are gone when the picture is drawn.
template <class Target>
SPANTEX_FRAME_APART status set_up(picture_state& memory, const Target& target, const quad& q, const texture_view& t) {
  memory.shape.box = screen_of(target);
  const auto corner = [&](int k) { return screen_vertex{q.corners[k], q.map != nullptr ? q.map[k] : corner_of_map(k, t.width(), t.height()), 1}; };
  return spantex::detail::make_picture(4, corner, memory.shape);
}
template <class Target>
SPANTEX_FRAME_APART status set_up(picture_state& memory, const Target& target, const sprite& s, const texture_view& t) {
  memory.shape.box = screen_of(target);
  return spantex::detail::make_sprite(s, t.width(), t.height(), memory.shape);
}

template <filter Kind, class Target, class What>
status draw_set_up(picture_state& memory, const Target& target, const What& what, const texture_view& t) {
  SPANTEX_TRY(check(t, Kind));
  SPANTEX_TRY(set_up(memory, target, what, t));
  return draw<Kind>(memory, target, memory.shape, t);
}

}  // namespace detail

// Errors: those of check() and make_quad, make_sprite.
template <filter Kind, class Target>
status draw(picture_state& memory, const Target& target, const quad& q, const texture_view& t) {
  return detail::draw_set_up<Kind>(memory, target, q, t);
}
template <filter Kind, class Target>
status draw(picture_state& memory, const Target& target, const sprite& s, const texture_view& t) {
  return detail::draw_set_up<Kind>(memory, target, s, t);
}

// Triangles in the order of their indices; without indices vertices are taken by threes. Front: clockwise on the screen.
enum class culling : uint8_t { none, back };
struct triangle_list {
  const screen_vertex* vertices;
  int32_t vertex_count;
  const uint16_t* indices;
  int32_t triangle_count;
  culling cull = culling::none;
};

// The same in camera space: perspective, clipping at camera.near_z.
struct mesh {
  const vertex* vertices;
  int32_t vertex_count;
  const uint16_t* indices;
  int32_t triangle_count;
  projection camera;
  culling cull = culling::none;
};

namespace detail {

SPANTEX_FRAME_APART constexpr status check_list(const void* vertices, int32_t vertex_count, const uint16_t* indices, int32_t triangle_count) {
  if (triangle_count < 0 || vertex_count < 0) return status::bad_size;
  if (triangle_count == 0) return status::ok;
  if (vertices == nullptr) return status::bad_pointer;
  if (indices == nullptr) return triangle_count > vertex_count / 3 ? status::out_of_range : status::ok;
  for (int32_t k = 0; k < triangle_count; ++k)
    for (int n = 0; n < 3; ++n)
      if (*indices++ >= vertex_count) return status::out_of_range;
  return status::ok;
}

// Corner n of triangle k.
template <class List>
constexpr const auto& corner_of(const List& list, int32_t k, int32_t n) {
  return list.vertices[list.indices != nullptr ? int32_t(list.indices[3 * k + n]) : 3 * k + n];
}

template <class Target>
SPANTEX_FRAME_APART status set_up_triangle(picture_state& memory, const Target& target, const triangle_list& list, int32_t k) {
  memory.shape.box = screen_of(target);
  return spantex::detail::make_picture(3, [&](int n) -> const screen_vertex& { return corner_of(list, k, n); }, memory.shape);
}
template <class Target>
SPANTEX_FRAME_APART status set_up_triangle(picture_state& memory, const Target& target, const mesh& list, int32_t k) {
  memory.shape.box = screen_of(target);
  return spantex::detail::make_triangle_of(list.camera, [&](int n) -> const vertex& { return corner_of(list, k, n); }, memory.shape);
}

// Of a list that was checked.
template <filter Kind, class Target, class List>
status draw_list(picture_state& memory, const Target& target, const List& list, const texture_view& t) {
  SPANTEX_TRY(check(t, Kind));
  for (int32_t k = 0; k < list.triangle_count; ++k) {
    const status made = set_up_triangle(memory, target, list, k);
    if (made == status::degenerate || (made == status::ok && list.cull == culling::back && !memory.shape.front_facing)) continue;
    SPANTEX_TRY(made);
    SPANTEX_TRY(draw<Kind>(memory, target, memory.shape, t));
  }
  return status::ok;
}

}  // namespace detail

// Triangles without area, or outside the screen, are passed over. Errors: those of check() and make_triangle but degenerate; bad_pointer, bad_size,
// out_of_range (an index beyond the vertices: nothing is drawn).
template <filter Kind, class Target>
status draw(picture_state& memory, const Target& target, const triangle_list& list, const texture_view& t) {
  SPANTEX_TRY(detail::check_list(list.vertices, list.vertex_count, list.indices, list.triangle_count));
  return detail::draw_list<Kind>(memory, target, list, t);
}
template <filter Kind, class Target>
status draw(picture_state& memory, const Target& target, const mesh& list, const texture_view& t) {
  SPANTEX_TRY(detail::check_list(list.vertices, list.vertex_count, list.indices, list.triangle_count));
  return detail::draw_list<Kind>(memory, target, list, t);
}

struct floor_view {
  looking_camera camera;
  floor_map map;
};

// faces[int(cube_face)]: those without a map (nullptr) are left out.
struct cube_view {
  looking_camera camera;
  const texture_view* faces[cube_face_count];
};

namespace detail {

template <class Target>
SPANTEX_FRAME_APART status set_up_plane(picture_state& memory, const Target& target, const floor_view& f) {
  memory.shape.box = screen_of(target);
  return make_floor(f.camera, f.map, memory.shape.box, memory.shape.map);
}

template <filter Kind, class Target, class Floor>
status draw_floor(picture_state& memory, const Target& target, const Floor& f, const texture_view& t) {
  SPANTEX_TRY(check(t, Kind));
  SPANTEX_TRY(set_up_plane(memory, target, f));
  return draw<Kind>(memory, target, memory.shape.map, t, memory.shape.box);
}

constexpr const texture_view* face_of(const cube_view& cube, int face) { return cube.faces[face]; }

template <class Target>
SPANTEX_FRAME_APART status set_up_face(picture_state& memory, const Target& target, const cube_view& cube, int face) {
  const texture_view& t = *cube.faces[face];
  memory.shape.box = screen_of(target);
  return spantex::detail::make_cube_face(cube.camera, cube_face(face), t.width(), t.height(), memory.shape);
}

template <filter Kind, class Target, class Cube>
status draw_cube(picture_state& memory, const Target& target, const Cube& cube) {
  for (int face = 0; face < cube_face_count; ++face)
    if (const texture_view* const t = face_of(cube, face); t != nullptr) SPANTEX_TRY(check(*t, Kind));
  for (int face = 0; face < cube_face_count; ++face) {
    if (face_of(cube, face) == nullptr) continue;
    const status made = set_up_face(memory, target, cube, face);
    if (made == status::degenerate) continue;
    SPANTEX_TRY(made);
    SPANTEX_TRY(draw<Kind>(memory, target, memory.shape, *face_of(cube, face)));
  }
  return status::ok;
}

}  // namespace detail

// Errors: those of check() and make_floor.
template <filter Kind, class Target>
status draw(picture_state& memory, const Target& target, const floor_view& f, const texture_view& t) {
  return detail::draw_floor<Kind>(memory, target, f, t);
}

// Errors: those of check() and make_cube_face but degenerate.
template <filter Kind, class Target>
status draw(picture_state& memory, const Target& target, const cube_view& cube) {
  return detail::draw_cube<Kind>(memory, target, cube);
}

}  // namespace spantex::rows
