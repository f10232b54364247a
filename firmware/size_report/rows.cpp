// SPDX-License-Identifier: Apache-2.0
// The smallest programs, for their size: set-up of a plane and one filter into a frame buffer, memory from the caller. -DSPANTEX_FILTER=nearest or
// another; what a feature adds: SPANTEX_ANY_MAP (nearest without a promise about the map), SPANTEX_POLYGONS, SPANTEX_WIDE (128-bit set-up),
// SPANTEX_FORMAT=rgb888 or another (a target of that format, with blending and clip), SPANTEX_ANY_FORMAT (chosen at run time), SPANTEX_CAMERAS (planes that they see),
// SPANTEX_PICTURE=rows::quad or another, SPANTEX_ANY_FILTER (of pictures, chosen at run time).
#include <spantex/camera.hpp>
#include <spantex/rows/draw.hpp>
#include <spantex/rows/pictures.hpp>
#include <spantex/rows/small_plane.hpp>
#include <spantex/rows/targets.hpp>

using namespace spantex;

static_assert(sizeof(rows::state) <= 1024, "spantex: the state of rows is below 1 KiB");

constexpr filter kind = filter::SPANTEX_FILTER;
#ifdef SPANTEX_ANY_MAP
constexpr rows::map_kind map_kind = rows::map_kind::any;
#else
constexpr rows::map_kind map_kind = kind == filter::nearest ? rows::map_kind::repeats_in_powers_of_two : rows::map_kind::any;
#endif

#if defined(SPANTEX_ANY_FORMAT)
using target_type = rows::memory_target<rows::any_format>;
#elif defined(SPANTEX_FORMAT)
using target_type = rows::memory_target<rows::fixed_format<pixel_format::SPANTEX_FORMAT>>;
#else
using target_type = rows::frame565;
#endif

extern "C" {

#ifdef SPANTEX_WIDE
int set_up(const homography& m, const rectangle& screen, plane& out) { return int(make_plane(m, screen, out)); }
#else
int set_up(const rows::homography64& m, const rectangle& screen, plane& out) { return int(rows::make_small_plane<uses_levels(kind)>(m, screen, out)); }
#endif

int draw_plane(rows::state& state, const target_type& frame, const plane& p, const texture_view& map, const rectangle& area) {
  return int(rows::draw<kind, map_kind>(state, frame, p, map, area));
}

#ifdef SPANTEX_POLYGONS
int set_up_polygon(const vertex* corners, int count, const projection& camera, const rectangle& screen, polygon& out) {
  return int(make_polygon(corners, count, camera, screen, out));
}
int draw_polygon(rows::state& state, const target_type& frame, const polygon& p, const texture_view& map) {
  return int(rows::draw<kind>(state, frame, p, map));
}
#endif

#ifdef SPANTEX_CAMERAS
int set_up_kt88(const kt88_plane& seen, const view& v, plane& out) { return int(make_plane(seen, v, out)); }
int set_up_attitude(const attitude_camera& camera, const view& v, plane& out) { return int(make_plane(camera, v, out)); }
#endif

#ifdef SPANTEX_PICTURE
int draw_picture(rows::picture_state& state, const target_type& frame, const SPANTEX_PICTURE& what, const texture_view& map) {
  return int(rows::draw<kind>(state, frame, what, map));
}
#ifdef SPANTEX_ANY_FILTER
int draw_by_any_filter(filter by, rows::picture_state& state, const target_type& frame, const SPANTEX_PICTURE& what, const texture_view& map) {
  return int(rows::draw_any(by, state, frame, what, map));
}
#endif
#endif

}  // extern "C"
