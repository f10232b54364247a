// SPDX-License-Identifier: Apache-2.0
// The C interface: every call gives the pixels of the C++ call in every format and filter; what is missing or wrong is refused by its number, and nothing drawn.
#include <tests/support.hpp>

#include <algorithm>
#include <cstring>

#include <firmware/apps/rows_scenes.hpp>
#include <spantex/pack.hpp>
#include <spantex/rows/pictures.hpp>
#include <spantex/rows/targets.hpp>
#include <spantex/spantex.h>

using namespace spantex;
using namespace spantex::sim;

namespace {

constexpr int32_t width = 96, height = 64, one = 1 << 16, stride = 4 * width;
constexpr spantex_rectangle c_screen{0, 0, width, height};
constexpr rectangle screen{0, 0, width, height};
alignas(8) uint8_t from_c[stride * height], from_cpp[stride * height];
app::map_texels texels;
spantex_map c_map;
texture_view map;
spantex_state c_state;
rows::picture_state state;

void make_maps() {
  texels.make();
  SPANTEX_ASSERT_OK(texels.view(wrap::mirror, map));
  const uint16_t* levels[app::map_side_log2 + 1];
  for (int k = 0; k <= app::map_side_log2; ++k) levels[k] = texels.texel + app::map_texels::offset(k);
  assert_int_equal(spantex_map_init(&c_map, levels, app::map_side_log2 + 1, app::map_side, app::map_side, SPANTEX_MIRROR, SPANTEX_MIRROR), SPANTEX_OK);
}

using target_type = rows::memory_target<rows::any_format>;

// Draws by both over the same bytes and compares them.
template <class InC, class InCpp>
void same(pixel_format f, uint8_t alpha, const InC& in_c, const InCpp& in_cpp) {
  for (int k = 0; k < stride * height; ++k) from_c[k] = from_cpp[k] = uint8_t(k * 11);
  spantex_target t;
  assert_int_equal(spantex_target_init(&t, spantex_format(f), from_c, stride, c_screen), SPANTEX_OK);
  assert_int_equal(spantex_target_clip(&t, {3, 2, 90, 61}), SPANTEX_OK);
  assert_int_equal(spantex_target_blend(&t, alpha, 0x1234), SPANTEX_OK);
  target_type u;
  SPANTEX_ASSERT_OK(target_type::make({from_cpp, stride, screen}, u, {f}));
  const status expected = in_cpp(u.clipped({3, 2, 90, 61}).with({alpha, 0x1234}));
  assert_int_equal(int(in_c(&t)), int(expected));
  assert_int_equal(int(expected), int(status::ok));
  if (std::memcmp(from_c, from_cpp, sizeof from_c) != 0) fail_msg("format %d: other bytes", int(f));
  int changed = 0;
  for (int k = 0; k < stride * height; ++k) changed += from_c[k] != uint8_t(k * 11);
  assert_true(changed > 50);
}

// Every format with one filter, every filter with one format.
template <class Each>
void each_way(const Each& each) {
  make_maps();
  for (int f = 0; f < pixel_format_count; ++f) each(pixel_format(f), filter::bilinear, uint8_t(f % 2 == 0 ? 255 : 160));
  for (filter kind : app::row_filters) each(pixel_format::rgb565, kind, uint8_t(255));
}

SPANTEX_CASE(planes_are_those_of_the_cpp_calls) {
  each_way([](pixel_format f, filter kind, uint8_t alpha) {
    const spantex_matrix m{1000, 200, -30000, -150, 900, 4000, 0, 3, 1000};
    same(f, alpha, [&](spantex_target* t) { return spantex_draw_plane(&c_state, t, &c_map, spantex_filter(kind), &m, {1, 1, 80, 64}); }, [&](const target_type& t) {
      plane p{};
      SPANTEX_TRY(make_plane({m.a, m.b, m.c, m.d, m.e, m.f, m.g, m.h, m.i}, screen, p));
      return rows::draw_any(kind, state, t, p, map, rectangle{1, 1, 80, 64});
    });
  });
}

SPANTEX_CASE(quads_and_sprites_are_those_of_the_cpp_calls) {
  each_way([](pixel_format f, filter kind, uint8_t alpha) {
    const spantex_point c[] = {{500, 300}, {22000, 1500}, {20000, 15000}, {2500, 12000}};
    const spantex_texel_point at[] = {{one, one}, {200 * one, 0}, {180 * one, 90 * one}, {0, 120 * one}};
    const rows::quad whole{{{500, 300}, {22000, 1500}, {20000, 15000}, {2500, 12000}}};
    const texel_point own[] = {{one, one}, {200 * one, 0}, {180 * one, 90 * one}, {0, 120 * one}};
    rows::quad part = whole;
    part.map = own;
    same(f, alpha, [&](spantex_target* t) { return spantex_draw_quad(&c_state, t, &c_map, spantex_filter(kind), c, nullptr); },
         [&](const target_type& t) { return rows::draw_any(kind, state, t, whole, map); });
    same(f, alpha, [&](spantex_target* t) { return spantex_draw_quad(&c_state, t, &c_map, spantex_filter(kind), c, at); },
         [&](const target_type& t) { return rows::draw_any(kind, state, t, part, map); });
    const spantex_sprite s{{12000, 8000}, {128 * one, 100 * one}, one / 4, -one / 5, 1234};
    same(f, alpha, [&](spantex_target* t) { return spantex_draw_sprite(&c_state, t, &c_map, spantex_filter(kind), &s); },
         [&](const target_type& t) { return rows::draw_any(kind, state, t, sprite{{12000, 8000}, {128 * one, 100 * one}, one / 4, -one / 5, 1234}, map); });
  });
}

SPANTEX_CASE(triangles_are_those_of_the_cpp_calls) {
  each_way([](pixel_format f, filter kind, uint8_t alpha) {
    const spantex_screen_vertex v[] = {{{500, 500}, {0, 0}, 3}, {{20000, 3000}, {99 * one, 5 * one}, 7}, {{9000, 15000}, {40 * one, 120 * one}, 5}, {{23000, 16000}, {9 * one, 9 * one}, 9}};
    const screen_vertex w[] = {{{500, 500}, {0, 0}, 3}, {{20000, 3000}, {99 * one, 5 * one}, 7}, {{9000, 15000}, {40 * one, 120 * one}, 5}, {{23000, 16000}, {9 * one, 9 * one}, 9}};
    const uint16_t indices[] = {0, 1, 2, 1, 2, 3};
    for (int back : {0, 1})
      same(f, alpha, [&](spantex_target* t) { return spantex_draw_triangles(&c_state, t, &c_map, spantex_filter(kind), v, 4, indices, 2, back); }, [&](const target_type& t) {
        return rows::draw_any(kind, state, t, rows::triangle_list{w, 4, indices, 2, back != 0 ? rows::culling::none : rows::culling::back}, map);
      });
    const spantex_vertex m[] = {{-2 * one, -one, one, 0, 0}, {2 * one, -one, 6 * one, 200 * one, 0}, {0, one, 2 * one, 0, 200 * one}};
    const vertex n[] = {{-2 * one, -one, one, 0, 0}, {2 * one, -one, 6 * one, 200 * one, 0}, {0, one, 2 * one, 0, 200 * one}};
    const spantex_projection camera{60 * one, 60 * one, 48 * one, 32 * one, one / 2};
    same(f, alpha, [&](spantex_target* t) { return spantex_draw_mesh(&c_state, t, &c_map, spantex_filter(kind), &camera, m, 3, nullptr, 1, 1); },
         [&](const target_type& t) { return rows::draw_any(kind, state, t, rows::mesh{n, 3, nullptr, 1, {60 * one, 60 * one, 48 * one, 32 * one, one / 2}}, map); });
  });
}

SPANTEX_CASE(floors_and_cubes_are_those_of_the_cpp_calls) {
  each_way([](pixel_format f, filter kind, uint8_t alpha) {
    const spantex_camera c{123, -80, 45, 70 * one, 50 * one, 30 * one};
    const looking_camera camera{123, -80, 45, 70 * one, 50 * one, 30 * one};
    const spantex_floor level{5 * one, -one, 2 * one, 12 * one};
    same(f, alpha, [&](spantex_target* t) { return spantex_draw_floor(&c_state, t, &c_map, spantex_filter(kind), &c, &level); },
         [&](const target_type& t) { return rows::draw_any(kind, state, t, rows::floor_view{camera, {5 * one, -one, 2 * one, 12 * one}}, map); });
    const spantex_map* const faces[6] = {&c_map, &c_map, nullptr, &c_map, &c_map, &c_map};
    same(f, alpha, [&](spantex_target* t) { return spantex_draw_cube(&c_state, t, faces, spantex_filter(kind), &c); },
         [&](const target_type& t) { return rows::draw_any(kind, state, t, rows::cube_view{camera, {&map, &map, nullptr, &map, &map, &map}}); });
  });
}

struct recorder {
  std::vector<int> calls;
  static void start(void* user, spantex_rectangle w, const uint8_t* bytes, uint32_t count, int buffer) {
    static_cast<recorder*>(user)->calls.push_back(buffer);
    assert_int_equal(count, 2 * (w.x1 - w.x0) * (w.y1 - w.y0));
    for (int32_t y = w.y0; y < w.y1; ++y) std::memcpy(from_c + 2 * (y * width + w.x0), bytes + 2 * (y - w.y0) * (w.x1 - w.x0), size_t(2 * (w.x1 - w.x0)));
  }
  static void wait(void* user, int buffer) { static_cast<recorder*>(user)->calls.push_back(10 + buffer); }
};
spantex_status draw_tile(void*, spantex_target* tile) {
  const spantex_camera c{10, -80, 45, 70 * one, 50 * one, 30 * one};
  const spantex_floor level{5 * one, -one, 2 * one, 12 * one};
  const spantex_status s = spantex_target_fill(tile, 7);
  return s != SPANTEX_OK ? s : spantex_draw_floor(&c_state, tile, &c_map, SPANTEX_TRILINEAR, &c, &level);
}

SPANTEX_CASE(tiles_and_strips_show_the_pixels_of_the_whole_screen) {
  make_maps();
  spantex_target t;
  assert_int_equal(spantex_target_init(&t, SPANTEX_RGB565, from_cpp, 2 * width, c_screen), SPANTEX_OK);
  assert_int_equal(draw_tile(nullptr, &t), SPANTEX_OK);
  alignas(4) static uint8_t buffers[2][2 * 48 * 32];
  static recorder r;
  r.calls.reserve(100);
  const spantex_display display{recorder::start, recorder::wait, &r};
  assert_int_equal(spantex_draw_tiles(&display, SPANTEX_RGB565, c_screen, 48, 32, buffers[0], buffers[1], sizeof buffers[0], draw_tile, nullptr), SPANTEX_OK);
  assert_memory_equal(from_c, from_cpp, 2 * width * height);
  const int order[] = {0, 1, 10, 0, 11, 1, 10, 11};
  assert_int_equal(r.calls.size(), std::size(order));
  for (size_t k = 0; k < std::size(order); ++k) assert_int_equal(r.calls[k], order[k]);
  for (int32_t y = 0; y < height; y += 16) {  // by hand
    assert_int_equal(spantex_target_init(&t, SPANTEX_RGB565, buffers, 2 * width, {0, y, width, y + 16}), SPANTEX_OK);
    assert_int_equal(spantex_target_screen(&t, c_screen), SPANTEX_OK);
    assert_int_equal(draw_tile(nullptr, &t), SPANTEX_OK);
    assert_memory_equal(buffers, from_cpp + 2 * width * y, 2 * width * 16);
  }
  assert_int_equal(spantex_draw_tiles(&display, SPANTEX_RGB565, c_screen, 48, 32, buffers[0], buffers[1], 99, draw_tile, nullptr), SPANTEX_BAD_SIZE);
  assert_int_equal(spantex_draw_tiles(&display, spantex_format(10), c_screen, 48, 32, buffers[0], buffers[1], 99, draw_tile, nullptr), SPANTEX_OUT_OF_RANGE);
  assert_int_equal(spantex_draw_tiles(nullptr, SPANTEX_RGB565, c_screen, 48, 32, buffers[0], buffers[1], 99, draw_tile, nullptr), SPANTEX_BAD_POINTER);
  assert_int_equal(spantex_draw_tiles(&display, SPANTEX_RGB565, c_screen, 48, 32, buffers[0], buffers[1], 99, nullptr, nullptr), SPANTEX_BAD_POINTER);
}

SPANTEX_CASE(errors_have_the_numbers_and_words_of_the_library) {
  for (int k = 0; k <= SPANTEX_PACK_BAD_PAYLOAD; ++k) assert_string_equal(spantex_status_string(spantex_status(k)), to_string(status(k)));
  for (int k : {SPANTEX_PACK_BAD_PAYLOAD + 1, 31}) assert_string_equal(spantex_status_string(spantex_status(k)), "unknown status");
}

SPANTEX_CASE(what_is_missing_or_wrong_is_refused) {
  make_maps();
  std::fill(std::begin(from_c), std::end(from_c), uint8_t(0));
  spantex_target t{}, none{};
  spantex_map empty{};
  const uint16_t* const levels[] = {texels.texel, nullptr};
  spantex_map m;
  assert_int_equal(spantex_map_init(nullptr, levels, 1, 4, 4, SPANTEX_CLAMP, SPANTEX_CLAMP), SPANTEX_BAD_POINTER);
  assert_int_equal(spantex_map_init(&m, nullptr, 1, 4, 4, SPANTEX_CLAMP, SPANTEX_CLAMP), SPANTEX_BAD_POINTER);
  assert_int_equal(spantex_map_init(&m, levels, 2, 4, 4, SPANTEX_CLAMP, SPANTEX_CLAMP), SPANTEX_BAD_POINTER);
  assert_int_equal(spantex_map_init(&m, levels, 0, 4, 4, SPANTEX_CLAMP, SPANTEX_CLAMP), SPANTEX_BAD_LEVELS);
  assert_int_equal(spantex_map_init(&m, levels, 1, 0, 4, SPANTEX_CLAMP, SPANTEX_CLAMP), SPANTEX_BAD_SIZE);
  assert_int_equal(spantex_map_init(&m, levels, 1, 4, 4, SPANTEX_CLAMP, spantex_wrap(3)), SPANTEX_OUT_OF_RANGE);
  assert_int_equal(spantex_target_init(nullptr, SPANTEX_GREY8, from_c, width, c_screen), SPANTEX_BAD_POINTER);
  assert_int_equal(spantex_target_init(&t, SPANTEX_GREY8, nullptr, width, c_screen), SPANTEX_BAD_POINTER);
  assert_int_equal(spantex_target_init(&t, SPANTEX_GREY8, from_c, width - 1, c_screen), SPANTEX_BAD_SIZE);
  assert_int_equal(spantex_target_init(&t, SPANTEX_RGB565, from_c + 1, 2 * width, c_screen), SPANTEX_BAD_ALIGNMENT);
  assert_int_equal(spantex_target_init(&t, spantex_format(10), from_c, width, c_screen), SPANTEX_OUT_OF_RANGE);
  for (auto call : {+[](spantex_target* x) { return spantex_target_clip(x, c_screen); }, +[](spantex_target* x) { return spantex_target_screen(x, c_screen); },
                    +[](spantex_target* x) { return spantex_target_blend(x, 1, -1); }, +[](spantex_target* x) { return spantex_target_fill(x, 1); }}) {
    assert_int_equal(call(nullptr), SPANTEX_BAD_POINTER);
    assert_int_equal(call(&none), SPANTEX_BAD_POINTER);
  }
  assert_int_equal(spantex_target_init(&t, SPANTEX_GREY8, from_c, width, c_screen), SPANTEX_OK);
  const spantex_sprite s{{2560, 2560}, {0, 0}, one, one, 0};
  const spantex_point c[] = {{0, 0}, {2560, 0}, {2560, 2560}, {0, 2560}};
  const auto draw = [&](spantex_state* st, const spantex_target* to, const spantex_map* from, int kind, const spantex_sprite* what) {
    return spantex_draw_sprite(st, to, from, spantex_filter(kind), what);
  };
  assert_int_equal(draw(nullptr, &t, &c_map, 0, &s), SPANTEX_BAD_POINTER);
  assert_int_equal(draw(&c_state, nullptr, &c_map, 0, &s), SPANTEX_BAD_POINTER);
  assert_int_equal(draw(&c_state, &none, &c_map, 0, &s), SPANTEX_BAD_POINTER);
  assert_int_equal(draw(&c_state, &t, nullptr, 0, &s), SPANTEX_BAD_POINTER);
  assert_int_equal(draw(&c_state, &t, &empty, 0, &s), SPANTEX_BAD_POINTER);
  assert_int_equal(draw(&c_state, &t, &c_map, 0, nullptr), SPANTEX_BAD_POINTER);
  assert_int_equal(draw(&c_state, &t, &c_map, 5, &s), SPANTEX_OUT_OF_RANGE);
  assert_int_equal(draw(&c_state, &t, &c_map, 7, &s), SPANTEX_OUT_OF_RANGE);
  assert_int_equal(spantex_draw_quad(&c_state, &t, &c_map, SPANTEX_NEAREST, nullptr, nullptr), SPANTEX_BAD_POINTER);
  const spantex_point crossed[] = {c[0], c[2], c[1], c[3]};
  assert_int_equal(spantex_draw_quad(&c_state, &t, &c_map, SPANTEX_NEAREST, crossed, nullptr), SPANTEX_DEGENERATE);
  assert_int_equal(spantex_draw_plane(&c_state, &t, &c_map, SPANTEX_NEAREST, nullptr, c_screen), SPANTEX_BAD_POINTER);
  const spantex_matrix edge_on{};
  assert_int_equal(spantex_draw_plane(&c_state, &t, &c_map, SPANTEX_NEAREST, &edge_on, c_screen), SPANTEX_DEGENERATE);
  const spantex_camera level{0, 0, 0, one, 0, 0};
  const spantex_floor ground{0, 0, one, one};
  assert_int_equal(spantex_draw_floor(&c_state, &t, &c_map, SPANTEX_NEAREST, nullptr, &ground), SPANTEX_BAD_POINTER);
  assert_int_equal(spantex_draw_floor(&c_state, &t, &c_map, SPANTEX_NEAREST, &level, nullptr), SPANTEX_BAD_POINTER);
  assert_int_equal(spantex_draw_cube(&c_state, &t, nullptr, SPANTEX_NEAREST, &level), SPANTEX_BAD_POINTER);
  const spantex_map* const faces[6] = {&empty};
  assert_int_equal(spantex_draw_cube(&c_state, &t, faces, SPANTEX_NEAREST, &level), SPANTEX_BAD_POINTER);
  assert_int_equal(spantex_draw_triangles(&c_state, &t, &c_map, SPANTEX_NEAREST, nullptr, 3, nullptr, 1, 1), SPANTEX_BAD_POINTER);
  assert_int_equal(spantex_draw_mesh(&c_state, &t, &c_map, SPANTEX_NEAREST, nullptr, nullptr, 0, nullptr, 0, 1), SPANTEX_BAD_POINTER);
  for (uint8_t b : from_c) assert_int_equal(b, 0);
}

// A pack of one level of 2 x 2 RGB565 texels, made here byte by byte.
SPANTEX_CASE(compiled_maps_are_opened_where_they_lie) {
  struct alignas(8) { uint8_t b[64]; } pack{};
  const auto u16 = [&](int at, uint32_t x) { pack.b[at] = uint8_t(x); pack.b[at + 1] = uint8_t(x >> 8); };
  const auto u32 = [&](int at, uint32_t x) { u16(at, x); u16(at + 2, x >> 16); };
  std::memcpy(pack.b, pack_format::magic, 4);
  u16(4, pack_format::version);
  u16(6, 56);
  u32(8, 64);
  pack.b[12] = uint8_t(texel_format::rgb565);
  pack.b[13] = 1;
  u16(16, 2);
  u16(18, 2);
  pack.b[22] = pack_format::native_order;
  u32(48, 56);
  u32(52, 8);
  const uint16_t colours[] = {1, 2, 3, 4};
  std::memcpy(pack.b + 56, colours, 8);
  const auto seal = [&] {
    u32(40, crc32(pack.b + 56, 8));
    u32(44, crc32(pack.b + 48, 8, crc32(pack.b, 44)));
  };
  seal();
  spantex_map m;
  assert_int_equal(spantex_map_open(&m, pack.b, 64, 1), SPANTEX_OK);
  spantex_target t;
  assert_int_equal(spantex_target_init(&t, SPANTEX_RGB565, from_c, 2 * width, c_screen), SPANTEX_OK);
  assert_int_equal(spantex_target_fill(&t, 0), SPANTEX_OK);
  const spantex_sprite s{{0, 0}, {0, 0}, one, one, 0};
  assert_int_equal(spantex_draw_sprite(&c_state, &t, &m, SPANTEX_NEAREST, &s), SPANTEX_OK);
  const auto* const pixels = reinterpret_cast<const uint16_t*>(from_c);
  assert_true(pixels[0] == 1 && pixels[1] == 2 && pixels[width] == 3 && pixels[width + 1] == 4 && pixels[2] == 0);
  assert_int_equal(spantex_map_open(&m, nullptr, 64, 1), SPANTEX_BAD_POINTER);
  assert_int_equal(spantex_map_open(nullptr, pack.b, 64, 1), SPANTEX_BAD_POINTER);
  assert_int_equal(spantex_map_open(&m, pack.b, 63, 1), SPANTEX_PACK_TRUNCATED);
  pack.b[57] ^= 1;
  assert_int_equal(spantex_map_open(&m, pack.b, 64, 0), SPANTEX_OK);
  assert_int_equal(spantex_map_open(&m, pack.b, 64, 1), SPANTEX_PACK_BAD_PAYLOAD);
  assert_int_equal(spantex_draw_sprite(&c_state, &t, &m, SPANTEX_NEAREST, &s), SPANTEX_BAD_POINTER);  // a map that failed is none
  pack.b[12] = uint8_t(texel_format::argb4444);
  seal();
  assert_int_equal(spantex_map_open(&m, pack.b, 64, 1), SPANTEX_OUT_OF_RANGE);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(planes_are_those_of_the_cpp_calls),
      cmocka_unit_test(quads_and_sprites_are_those_of_the_cpp_calls),
      cmocka_unit_test(triangles_are_those_of_the_cpp_calls),
      cmocka_unit_test(floors_and_cubes_are_those_of_the_cpp_calls),
      cmocka_unit_test(tiles_and_strips_show_the_pixels_of_the_whole_screen),
      cmocka_unit_test(errors_have_the_numbers_and_words_of_the_library),
      cmocka_unit_test(what_is_missing_or_wrong_is_refused),
      cmocka_unit_test(compiled_maps_are_opened_where_they_lie),
  };
  return run_suite("c_interface", tests);
}
