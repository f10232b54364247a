// SPDX-License-Identifier: Apache-2.0
// The C interface (spantex.h) over rows/pictures.hpp and rows/targets.hpp: structures are copied, nothing is computed here.
//   -DSPANTEX_C_FILTERS=0x..  bits of the filters that are compiled in (1 << SPANTEX_NEAREST and so on); others are out of range
#include <spantex/spantex.h>

#include <spantex/pack.hpp>
#include <spantex/rows/pictures.hpp>
#include <spantex/rows/targets.hpp>

#ifndef SPANTEX_C_FILTERS
#define SPANTEX_C_FILTERS 0x1F
#endif

namespace {

using namespace spantex;
using target_type = rows::memory_target<rows::any_format>;

template <class Inside, class Outside>
constexpr bool fits = sizeof(Inside) <= sizeof(Outside) && alignof(Inside) <= alignof(Outside) && alignof(Outside) == SPANTEX_ALIGNMENT;
static_assert(fits<texture_view, spantex_map>, "spantex: SPANTEX_MAP_BYTES");
static_assert(fits<target_type, spantex_target>, "spantex: SPANTEX_TARGET_BYTES");
static_assert(fits<rows::picture_state, spantex_state>, "spantex: SPANTEX_STATE_BYTES");
static_assert(sizeof(spantex_map) == SPANTEX_MAP_BYTES && sizeof(spantex_target) == SPANTEX_TARGET_BYTES && sizeof(spantex_state) == SPANTEX_STATE_BYTES);

static_assert(int(status::ok) == SPANTEX_OK && int(status::bad_size) == SPANTEX_BAD_SIZE && int(status::bad_pointer) == SPANTEX_BAD_POINTER &&
              int(status::bad_alignment) == SPANTEX_BAD_ALIGNMENT && int(status::out_of_memory) == SPANTEX_OUT_OF_MEMORY && int(status::bad_levels) == SPANTEX_BAD_LEVELS &&
              int(status::out_of_range) == SPANTEX_OUT_OF_RANGE && int(status::degenerate) == SPANTEX_DEGENERATE && int(status::half_busy) == SPANTEX_HALF_BUSY &&
              int(status::half_not_loaded) == SPANTEX_HALF_NOT_LOADED && int(status::half_not_started) == SPANTEX_HALF_NOT_STARTED &&
              int(status::bad_address) == SPANTEX_BAD_ADDRESS && int(status::device_error) == SPANTEX_DEVICE_ERROR && int(status::device_timeout) == SPANTEX_DEVICE_TIMEOUT &&
              int(status::mismatch) == SPANTEX_MISMATCH && int(status::pack_misaligned) == SPANTEX_PACK_MISALIGNED && int(status::pack_truncated) == SPANTEX_PACK_TRUNCATED &&
              int(status::pack_not_a_pack) == SPANTEX_PACK_NOT_A_PACK && int(status::pack_bad_version) == SPANTEX_PACK_BAD_VERSION &&
              int(status::pack_bad_header) == SPANTEX_PACK_BAD_HEADER && int(status::pack_bad_field) == SPANTEX_PACK_BAD_FIELD &&
              int(status::pack_bad_layout) == SPANTEX_PACK_BAD_LAYOUT && int(status::pack_byte_order) == SPANTEX_PACK_BYTE_ORDER &&
              int(status::pack_bad_payload) == SPANTEX_PACK_BAD_PAYLOAD, "spantex: numbers of errors");
static_assert(int(filter::nearest) == SPANTEX_NEAREST && int(filter::bilinear) == SPANTEX_BILINEAR && int(filter::three_point) == SPANTEX_THREE_POINT &&
              int(filter::mip_bilinear) == SPANTEX_MIP_BILINEAR && int(filter::trilinear) == SPANTEX_TRILINEAR, "spantex: numbers of filters");
static_assert(int(wrap::repeat) == SPANTEX_REPEAT && int(wrap::clamp) == SPANTEX_CLAMP && int(wrap::mirror) == SPANTEX_MIRROR, "spantex: numbers of wrap modes");
static_assert(int(pixel_format::rgb565) == SPANTEX_RGB565 && int(pixel_format::rgb565_swapped) == SPANTEX_RGB565_SWAPPED && int(pixel_format::rgb888) == SPANTEX_RGB888 &&
              int(pixel_format::bgr888) == SPANTEX_BGR888 && int(pixel_format::rgba8888) == SPANTEX_RGBA8888 && int(pixel_format::bgra8888) == SPANTEX_BGRA8888 &&
              int(pixel_format::grey8) == SPANTEX_GREY8 && int(pixel_format::grey4) == SPANTEX_GREY4 && int(pixel_format::mono1) == SPANTEX_MONO1 &&
              int(pixel_format::mono1_pages) == SPANTEX_MONO1_PAGES, "spantex: numbers of formats");

// Objects in the caller's memory.
texture_view& in(spantex_map& m) { return *reinterpret_cast<texture_view*>(m.bytes); }
const texture_view& in(const spantex_map& m) { return *reinterpret_cast<const texture_view*>(m.bytes); }
target_type& in(spantex_target& t) { return *reinterpret_cast<target_type*>(t.bytes); }
const target_type& in(const spantex_target& t) { return *reinterpret_cast<const target_type*>(t.bytes); }
rows::picture_state& in(spantex_state& s) { return *reinterpret_cast<rows::picture_state*>(s.bytes); }

constexpr spantex_status outside(status s) { return spantex_status(s); }
constexpr rectangle inside(spantex_rectangle r) { return {r.x0, r.y0, r.x1, r.y1}; }
constexpr screen_point inside(spantex_point p) { return {p.x, p.y}; }
constexpr texel_point inside(spantex_texel_point p) { return {p.u, p.v}; }
constexpr screen_vertex inside(const spantex_screen_vertex& v) { return {inside(v.at), inside(v.map), v.w}; }
constexpr vertex inside(const spantex_vertex& v) { return {v.x, v.y, v.z, v.u, v.v}; }
constexpr looking_camera inside(const spantex_camera& c) { return {c.heading, c.pitch, c.roll, c.focal, c.centre_x, c.centre_y}; }

bool is_set_up(const spantex_target* target) { return target != nullptr && in(*target).memory().bytes != nullptr; }
status check_objects(const spantex_state* state, const spantex_target* target) { return state == nullptr || !is_set_up(target) ? status::bad_pointer : status::ok; }
status check_map(const spantex_map* map) { return map == nullptr || in(*map).level_count() == 0 ? status::bad_pointer : status::ok; }
status check_call(const spantex_state* state, const spantex_target* target, const spantex_map* map, const void* what) {
  SPANTEX_TRY(check_objects(state, target));
  SPANTEX_TRY(check_map(map));
  return what == nullptr ? status::bad_pointer : status::ok;
}

template <filter Kind>
struct of_filter { static constexpr filter value = Kind; };

// draw(of_filter<kind>) for the filters that are compiled in.
template <class Draw>
status with_filter(spantex_filter kind, const Draw& draw) {
  constexpr auto has = [](spantex_filter f) { return (SPANTEX_C_FILTERS >> f & 1) != 0; };
  if constexpr (has(SPANTEX_NEAREST)) if (kind == SPANTEX_NEAREST) return draw(of_filter<filter::nearest>{});
  if constexpr (has(SPANTEX_BILINEAR)) if (kind == SPANTEX_BILINEAR) return draw(of_filter<filter::bilinear>{});
  if constexpr (has(SPANTEX_THREE_POINT)) if (kind == SPANTEX_THREE_POINT) return draw(of_filter<filter::three_point>{});
  if constexpr (has(SPANTEX_MIP_BILINEAR)) if (kind == SPANTEX_MIP_BILINEAR) return draw(of_filter<filter::mip_bilinear>{});
  if constexpr (has(SPANTEX_TRILINEAR)) if (kind == SPANTEX_TRILINEAR) return draw(of_filter<filter::trilinear>{});
  return status::out_of_range;
}

// What callers describe, for rows/pictures.hpp: set up with frames of their own.
struct quad {
  const spantex_point* corners;
  const spantex_texel_point* map;
};
SPANTEX_FRAME_APART status set_up(rows::picture_state& memory, const target_type& target, const quad& q, const texture_view& t) {
  memory.shape.box = rows::screen_of(target);
  const auto corner = [&](int k) { return screen_vertex{inside(q.corners[k]), q.map != nullptr ? inside(q.map[k]) : corner_of_map(k, t.width(), t.height()), 1}; };
  return detail::make_picture(4, corner, memory.shape);
}
struct sprite_view { const spantex_sprite* of; };
SPANTEX_FRAME_APART status set_up(rows::picture_state& memory, const target_type& target, const sprite_view& view, const texture_view& t) {
  const spantex_sprite& s = *view.of;
  return rows::detail::set_up(memory, target, sprite{inside(s.at), inside(s.pivot), s.scale_x, s.scale_y, s.angle}, t);
}
struct floor_view {
  const spantex_camera* camera;
  const spantex_floor* map;
};
SPANTEX_FRAME_APART status set_up_plane(rows::picture_state& memory, const target_type& target, const floor_view& f) {
  memory.shape.box = rows::screen_of(target);
  return make_floor(inside(*f.camera), {f.map->x, f.map->z, f.map->height, f.map->texels_per_unit}, memory.shape.box, memory.shape.map);
}
struct cube_view {
  const spantex_camera* camera;
  const spantex_map* const* faces;
};
const texture_view* face_of(const cube_view& cube, int face) { return cube.faces[face] == nullptr ? nullptr : &in(*cube.faces[face]); }
SPANTEX_FRAME_APART status set_up_face(rows::picture_state& memory, const target_type& target, const cube_view& cube, int face) {
  const texture_view& t = in(*cube.faces[face]);
  memory.shape.box = rows::screen_of(target);
  return detail::make_cube_face(inside(*cube.camera), cube_face(face), t.width(), t.height(), memory.shape);
}

template <class Vertex>
struct list_of {
  const Vertex* vertices;
  const uint16_t* indices;
  int32_t triangle_count;
  rows::culling cull;
};
struct triangles : list_of<spantex_screen_vertex> {};
struct mesh : list_of<spantex_vertex> { const spantex_projection* camera; };

SPANTEX_FRAME_APART status set_up_triangle(rows::picture_state& memory, const target_type& target, const triangles& list, int32_t k) {
  memory.shape.box = rows::screen_of(target);
  return detail::make_picture(3, [&](int n) { return inside(rows::detail::corner_of(list, k, n)); }, memory.shape);
}
SPANTEX_FRAME_APART status set_up_triangle(rows::picture_state& memory, const target_type& target, const mesh& list, int32_t k) {
  const projection camera{list.camera->focal_x, list.camera->focal_y, list.camera->centre_x, list.camera->centre_y, list.camera->near_z};
  memory.shape.box = rows::screen_of(target);
  return detail::make_triangle_of(camera, [&](int n) { return inside(rows::detail::corner_of(list, k, n)); }, memory.shape);
}

template <class List>
spantex_status draw_list(spantex_state* state, const spantex_target* target, const spantex_map* map, spantex_filter filter, const List& list) {
  if (const status s = check_call(state, target, map, state); s != status::ok) return outside(s);
  return outside(with_filter(filter, [&](auto kind) { return rows::detail::draw_list<decltype(kind)::value>(in(*state), in(*target), list, in(*map)); }));
}

// Not inlined: its frame is not to lie under that of drawing.
[[gnu::noinline]] status set_up(const spantex_matrix& m, const spantex_target& target, plane& out) {
  out.exact_u = {m.a, m.b, m.c};
  out.exact_v = {m.d, m.e, m.f};
  out.exact_w = {m.g, m.h, m.i};
  return detail::normalise(rows::screen_of(in(target)), out);
}

constexpr rows::culling culling_of(int back_faces) { return back_faces != 0 ? rows::culling::none : rows::culling::back; }

}  // namespace

extern "C" {

const char* spantex_status_string(spantex_status s) { return to_string(unsigned(s) <= unsigned(SPANTEX_PACK_BAD_PAYLOAD) ? status(s) : status(255)); }

spantex_status spantex_map_init(spantex_map* map, const uint16_t* const* levels, int level_count, int32_t width, int32_t height, spantex_wrap wrap_u, spantex_wrap wrap_v) {
  if (map == nullptr || levels == nullptr) return SPANTEX_BAD_POINTER;
  if (unsigned(wrap_u) > SPANTEX_MIRROR || unsigned(wrap_v) > SPANTEX_MIRROR) return SPANTEX_OUT_OF_RANGE;
  in(*map).reset();
  return outside(texture_view::make(texel_format::rgb565, levels, level_count, width, height, wrap(wrap_u), wrap(wrap_v), in(*map)));
}

spantex_status spantex_map_open(spantex_map* map, const void* pack, size_t bytes, int check_payload) {
  if (map == nullptr) return SPANTEX_BAD_POINTER;
  in(*map).reset();
  if (const status s = texture_pack::open_view(pack, bytes, in(*map), check_payload != 0 ? payload_check::crc : payload_check::none); s != status::ok) return outside(s);
  if (in(*map).format() == texel_format::rgb565) return SPANTEX_OK;
  in(*map).reset();
  return SPANTEX_OUT_OF_RANGE;
}

spantex_status spantex_target_init(spantex_target* target, spantex_format format, void* pixels, int32_t stride_bytes, spantex_rectangle held) {
  if (target == nullptr) return SPANTEX_BAD_POINTER;
  in(*target) = {};
  if (unsigned(format) >= unsigned(pixel_format_count)) return SPANTEX_OUT_OF_RANGE;
  return outside(target_type::make({static_cast<uint8_t*>(pixels), stride_bytes, inside(held)}, in(*target), {pixel_format(format)}));
}

spantex_status spantex_target_screen(spantex_target* target, spantex_rectangle screen) {
  if (!is_set_up(target)) return SPANTEX_BAD_POINTER;
  in(*target) = in(*target).of(inside(screen));
  return SPANTEX_OK;
}

spantex_status spantex_target_clip(spantex_target* target, spantex_rectangle clip) {
  if (!is_set_up(target)) return SPANTEX_BAD_POINTER;
  in(*target) = in(*target).clipped(inside(clip));
  return SPANTEX_OK;
}

spantex_status spantex_target_blend(spantex_target* target, uint8_t alpha, int32_t key) {
  if (!is_set_up(target)) return SPANTEX_BAD_POINTER;
  in(*target) = in(*target).with({alpha, key});
  return SPANTEX_OK;
}

spantex_status spantex_target_fill(const spantex_target* target, uint16_t rgb565) {
  if (!is_set_up(target)) return SPANTEX_BAD_POINTER;
  in(*target).fill(rgb565);
  return SPANTEX_OK;
}

spantex_status spantex_draw_plane(spantex_state* state, const spantex_target* target, const spantex_map* map, spantex_filter filter, const spantex_matrix* m,
                                  spantex_rectangle area) {
  if (const status s = check_call(state, target, map, m); s != status::ok) return outside(s);
  return outside(with_filter(filter, [&](auto kind) {
    polygon& p = in(*state).shape;
    SPANTEX_TRY(rows::check(in(*map), kind.value));
    SPANTEX_TRY(set_up(*m, *target, p.map));
    p.box = inside(area);
    return rows::draw<decltype(kind)::value>(in(*state), in(*target), p.map, in(*map), p.box);
  }));
}

spantex_status spantex_draw_quad(spantex_state* state, const spantex_target* target, const spantex_map* map, spantex_filter filter, const spantex_point* c,
                                 const spantex_texel_point* at) {
  if (const status s = check_call(state, target, map, c); s != status::ok) return outside(s);
  return outside(with_filter(filter, [&](auto kind) { return rows::detail::draw_set_up<decltype(kind)::value>(in(*state), in(*target), quad{c, at}, in(*map)); }));
}

spantex_status spantex_draw_sprite(spantex_state* state, const spantex_target* target, const spantex_map* map, spantex_filter filter, const spantex_sprite* s) {
  if (const status bad = check_call(state, target, map, s); bad != status::ok) return outside(bad);
  return outside(with_filter(filter, [&](auto kind) { return rows::detail::draw_set_up<decltype(kind)::value>(in(*state), in(*target), sprite_view{s}, in(*map)); }));
}

spantex_status spantex_draw_triangles(spantex_state* state, const spantex_target* target, const spantex_map* map, spantex_filter filter,
                                      const spantex_screen_vertex* vertices, int32_t vertex_count, const uint16_t* indices, int32_t triangle_count, int back_faces) {
  if (const status s = rows::detail::check_list(vertices, vertex_count, indices, triangle_count); s != status::ok) return outside(s);
  return draw_list(state, target, map, filter, triangles{{vertices, indices, triangle_count, culling_of(back_faces)}});
}

spantex_status spantex_draw_mesh(spantex_state* state, const spantex_target* target, const spantex_map* map, spantex_filter filter, const spantex_projection* camera,
                                 const spantex_vertex* vertices, int32_t vertex_count, const uint16_t* indices, int32_t triangle_count, int back_faces) {
  if (camera == nullptr) return SPANTEX_BAD_POINTER;
  if (const status s = rows::detail::check_list(vertices, vertex_count, indices, triangle_count); s != status::ok) return outside(s);
  return draw_list(state, target, map, filter, mesh{{vertices, indices, triangle_count, culling_of(back_faces)}, camera});
}

spantex_status spantex_draw_floor(spantex_state* state, const spantex_target* target, const spantex_map* map, spantex_filter filter, const spantex_camera* camera,
                                  const spantex_floor* f) {
  if (const status s = check_call(state, target, map, f); s != status::ok) return outside(s);
  if (camera == nullptr) return SPANTEX_BAD_POINTER;
  return outside(with_filter(filter, [&](auto kind) { return rows::detail::draw_floor<decltype(kind)::value>(in(*state), in(*target), floor_view{camera, f}, in(*map)); }));
}

spantex_status spantex_draw_cube(spantex_state* state, const spantex_target* target, const spantex_map* const faces[6], spantex_filter filter, const spantex_camera* camera) {
  if (const status s = check_objects(state, target); s != status::ok) return outside(s);
  if (faces == nullptr || camera == nullptr) return SPANTEX_BAD_POINTER;
  for (int k = 0; k < cube_face_count; ++k)
    if (faces[k] != nullptr)
      if (const status s = check_map(faces[k]); s != status::ok) return outside(s);
  return outside(with_filter(filter, [&](auto kind) { return rows::detail::draw_cube<decltype(kind)::value>(in(*state), in(*target), cube_view{camera, faces}); }));
}

spantex_status spantex_draw_tiles(const spantex_display* display, spantex_format format, spantex_rectangle screen, int32_t tile_width, int32_t tile_height, void* buffer0,
                                  void* buffer1, uint32_t bytes, spantex_draw_tile draw, void* user) {
  if (display == nullptr || display->start == nullptr || display->wait == nullptr || draw == nullptr) return SPANTEX_BAD_POINTER;
  if (unsigned(format) >= unsigned(pixel_format_count)) return SPANTEX_OUT_OF_RANGE;
  struct called_display {
    const spantex_display& to;
    void start(const rectangle& w, const uint8_t* from, uint32_t count, int buffer) const { to.start(to.user, {w.x0, w.y0, w.x1, w.y1}, from, count, buffer); }
    void wait(int buffer) const { to.wait(to.user, buffer); }
  } called{*display};
  spantex_target tile;
  const auto draw_tile = [&](const target_type&) { return status(draw(user, &tile)); };
  return outside(rows::detail::draw_tiles(called, inside(screen), tile_width, tile_height, {{static_cast<uint8_t*>(buffer0), static_cast<uint8_t*>(buffer1)}, bytes}, draw_tile,
                                          rows::any_format{pixel_format(format)}, in(tile)));
}

}  // extern "C"
