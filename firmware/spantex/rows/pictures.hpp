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

// The caller's memory: below 1.5 KiB.
struct picture_state : state { polygon shape; };

// Corners clockwise from that of the map's texel (0, 0), or with map positions of their own.
struct quad {
  screen_point corners[4];
  const texel_point* map = nullptr;  // four; none: the map's rectangle
};

// Errors: those of check() and make_quad.
template <filter Kind, class Target>
status draw(picture_state& memory, const Target& target, const quad& q, const texture_view& t) {
  SPANTEX_TRY(check(t, Kind));
  const map_corners whole = corners_of_map(t.width(), t.height());
  const texel_point* const at = q.map != nullptr ? q.map : whole.at;
  SPANTEX_TRY(make_quad(q.corners, {at[0], at[1], at[2], at[3]}, screen_of(target), memory.shape));
  return draw<Kind>(memory, target, memory.shape, t);
}

// Errors: those of check() and make_sprite.
template <filter Kind, class Target>
status draw(picture_state& memory, const Target& target, const sprite& s, const texture_view& t) {
  SPANTEX_TRY(check(t, Kind));
  SPANTEX_TRY(make_sprite(s, t.width(), t.height(), screen_of(target), memory.shape));
  return draw<Kind>(memory, target, memory.shape, t);
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

template <class List>
constexpr status check_list(const List& list) {
  if (list.triangle_count < 0 || list.vertex_count < 0) return status::bad_size;
  if (list.triangle_count == 0) return status::ok;
  if (list.vertices == nullptr) return status::bad_pointer;
  if (list.indices == nullptr) return list.triangle_count > list.vertex_count / 3 ? status::out_of_range : status::ok;
  for (int32_t k = 0; k < 3 * list.triangle_count; ++k)
    if (list.indices[k] >= list.vertex_count) return status::out_of_range;
  return status::ok;
}

template <filter Kind, class Target, class List, class SetUp>
status draw_list(picture_state& memory, const Target& target, const List& list, const texture_view& t, const SetUp& set_up) {
  SPANTEX_TRY(check(t, Kind));
  SPANTEX_TRY(check_list(list));
  for (int32_t k = 0; k < list.triangle_count; ++k) {
    const auto corner = [&](int32_t n) -> const auto& { return list.vertices[list.indices != nullptr ? int32_t(list.indices[3 * k + n]) : 3 * k + n]; };
    const status made = set_up(corner(0), corner(1), corner(2));
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
  return detail::draw_list<Kind>(memory, target, list, t, [&](const screen_vertex& a, const screen_vertex& b, const screen_vertex& c) {
    return make_triangle({a, b, c}, screen_of(target), memory.shape);
  });
}
template <filter Kind, class Target>
status draw(picture_state& memory, const Target& target, const mesh& list, const texture_view& t) {
  return detail::draw_list<Kind>(memory, target, list, t, [&](const vertex& a, const vertex& b, const vertex& c) {
    const vertex corners[] = {a, b, c};
    return make_polygon(corners, 3, list.camera, screen_of(target), memory.shape);
  });
}

struct floor_view {
  looking_camera camera;
  floor_map map;
};

// Errors: those of check() and make_floor.
template <filter Kind, class Target>
status draw(picture_state& memory, const Target& target, const floor_view& f, const texture_view& t) {
  SPANTEX_TRY(check(t, Kind));
  SPANTEX_TRY(make_floor(f.camera, f.map, screen_of(target), memory.shape.map));
  return draw<Kind>(memory, target, memory.shape.map, t, screen_of(target));
}

// faces[int(cube_face)]: those without a map (nullptr) are left out.
struct cube_view {
  looking_camera camera;
  const texture_view* faces[cube_face_count];
};

// Errors: those of check() and make_cube_face but degenerate.
template <filter Kind, class Target>
status draw(picture_state& memory, const Target& target, const cube_view& cube) {
  for (const texture_view* t : cube.faces)
    if (t != nullptr) SPANTEX_TRY(check(*t, Kind));
  for (int face = 0; face < cube_face_count; ++face) {
    const texture_view* const t = cube.faces[face];
    if (t == nullptr) continue;
    const status made = make_cube_face(cube.camera, cube_face(face), t->width(), t->height(), screen_of(target), memory.shape);
    if (made == status::degenerate) continue;
    SPANTEX_TRY(made);
    SPANTEX_TRY(draw<Kind>(memory, target, memory.shape, *t));
  }
  return status::ok;
}

}  // namespace spantex::rows
