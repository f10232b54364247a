// SPDX-License-Identifier: Apache-2.0
// What rows_counts.cpp leaves out, drawn, printed and counted in the same way: formats of frame buffers (the tilted plane, nearest texels, bilinear over
// what is there) and pictures. Every call covers the 320 x 240 pixels; `sprites` is 80 calls of 32 x 32 pixels and so mostly set-up.
#include "rows_scenes.hpp"

#include <spantex/rows/pictures.hpp>
#include <spantex/rows/targets.hpp>

#include <firmware/targets/console.hpp>

using namespace spantex;

static constexpr int32_t width = 320, height = 240, one = 1 << 16, subpixel = 1 << 8;
static app::map_texels texels;
static rows::picture_state state;
alignas(4) static uint8_t frame[4 * width * height];

extern "C" {
[[gnu::noinline, gnu::used]] void count_begin() { asm volatile(""); }
[[gnu::noinline, gnu::used]] void count_end() { asm volatile(""); }
}

// One call of `draw`, counted, and its line.
template <class Draw>
static bool show(const char* scene, filter kind, int32_t bytes, const Draw& draw) {
  for (int32_t k = 0; k < bytes; ++k) frame[k] = uint8_t(k % width);
  count_begin();
  const status s = draw();
  count_end();
  if (s != status::ok) return false;
  console::print(scene);
  console::print(" ");
  console::print(app::name_of_filter(kind));
  console::print(" ");
  console::print_hex(app::hash_of(reinterpret_cast<const rows::texel565*>(frame), bytes / 2, app::hash_seed));
  console::print("\n");
  return true;
}

template <pixel_format F, filter Kind = filter::nearest>
static bool show_format(const char* name, const texture_view& map, const blending& mix = {}) {
  rows::memory_target<rows::fixed_format<F>> target;
  if (rows::memory_target<rows::fixed_format<F>>::make({frame, pixel_row_bytes(F, width), {0, 0, width, height}}, target) != status::ok) return false;
  target = target.with(mix);
  return show(name, Kind, pixel_bytes(F, width, height), [&] {
    plane p{};
    SPANTEX_TRY(make_plane(app::scenes[1].map, {0, 0, width, height}, p));
    return rows::draw<Kind>(state, target, p, map, {0, 0, width, height});
  });
}

template <filter Kind, class What>
static bool show_picture(const char* name, const texture_view& map, const What* what, int count = 1) {
  const rows::frame565 target{reinterpret_cast<rows::texel565*>(frame), width, height, width};
  return show(name, Kind, 2 * width * height, [&] {
    for (int k = 0; k < count; ++k) SPANTEX_TRY(rows::draw<Kind>(state, target, what[k], map));
    return status::ok;
  });
}

static bool show_formats(const texture_view& map) {
  return show_format<pixel_format::rgb565_swapped>("rgb565-swapped", map) && show_format<pixel_format::rgb888>("rgb888", map) &&
         show_format<pixel_format::rgba8888>("rgba8888", map) && show_format<pixel_format::grey8>("grey8", map) &&
         show_format<pixel_format::grey4>("grey4", map) && show_format<pixel_format::mono1>("mono1", map) &&
         show_format<pixel_format::mono1_pages>("mono1-pages", map) && show_format<pixel_format::rgb565>("rgb565-key", map, {255, 0x8410}) &&
         show_format<pixel_format::rgb565, filter::bilinear>("rgb565-alpha", map, {128, -1}) &&
         show_format<pixel_format::rgb888, filter::bilinear>("rgb888-alpha", map, {128, -1});
}

static bool show_pictures(const texture_view& map, const texture_view& repeated) {
  constexpr rows::quad quad{{{-40 * subpixel, -8 * subpixel}, {360 * subpixel, 0}, {500 * subpixel, 260 * subpixel}, {-160 * subpixel, 248 * subpixel}}};
  constexpr sprite turned{{160 * subpixel, 120 * subpixel}, {128 * one, 128 * one}, 2 * one, 2 * one, 300};
  static sprite sprites[80];
  for (int k = 0; k < 80; ++k) sprites[k] = {{k % 10 * 32 * subpixel, k / 10 * 32 * subpixel}, {0, 0}, one / 8, one / 8, 0};
  constexpr int32_t t = app::map_side * one;
  static const screen_vertex flat[] = {{{0, 0}, {0, 0}, one}, {{width * subpixel, 0}, {t, 0}, one}, {{width * subpixel, height * subpixel}, {t, t}, one},
                                       {{0, height * subpixel}, {0, t}, one}};
  static const vertex wall[] = {{-3 * one, -2 * one, one, 0, 0}, {6 * one, -4 * one, 4 * one, t, 0}, {6 * one, 4 * one, 4 * one, t, t}, {-3 * one, 2 * one, one, 0, t}};
  static const uint16_t indices[] = {0, 1, 2, 0, 2, 3};
  constexpr projection camera{160 * one, 160 * one, 160 * one, 120 * one, one / 8};
  const rows::triangle_list triangles{flat, 4, indices, 2};
  const rows::mesh mesh{wall, 4, indices, 2, camera};
  constexpr rows::floor_view floor{{0, 200, 0, 256 * one, 160 * one, -40 * one}, {0, 0, 2 * one, 24 * one}};
  return show_picture<filter::bilinear>("quad", map, &quad) && show_picture<filter::bilinear>("sprite", map, &turned) &&
         show_picture<filter::nearest>("sprites", map, sprites, 80) && show_picture<filter::bilinear>("triangles", map, &triangles) &&
         show_picture<filter::bilinear>("mesh", map, &mesh) && show_picture<filter::trilinear>("floor", repeated, &floor);
}

int main() {
  texels.make();
  texture_view repeated, single;
  if (texels.view(wrap::repeat, repeated) != status::ok || texels.view(wrap::clamp, single) != status::ok) return 1;
  return show_formats(repeated) && show_pictures(single, repeated) ? 0 : 1;
}
