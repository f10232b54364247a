// SPDX-License-Identifier: Apache-2.0
// Draws every scene with every filter and prints what was drawn: a line "scene filter hash" a picture. tools/count_instructions counts the instructions
// from count_begin to count_end: a whole call, set-up from the matrix included. With SPANTEX_SMALL the picture goes out in strips of eight rows, as to a
// display, and is drawn by a device of 16 KiB of RAM.
#include "rows_scenes.hpp"

#include <firmware/targets/console.hpp>

using namespace spantex;

#ifdef SPANTEX_SMALL
static constexpr int32_t down = 2, strip = 8;
static constexpr app::map_texels make_texels() {
  app::map_texels m{};
  m.make();
  return m;
}
static constexpr app::map_texels texels = make_texels();
#else
static constexpr int32_t down = 1, strip = 240;
static app::map_texels texels;
#endif
static constexpr int32_t width = 320 / down, height = 240 / down;
static rows::state state;
static uint16_t lines[width * strip];

extern "C" {
[[gnu::noinline, gnu::used]] void count_begin() { asm volatile(""); }
[[gnu::noinline, gnu::used]] void count_end() { asm volatile(""); }
}

// Rows [y, y + strip) of the picture, kept where rows [0, strip) would be.
struct strip_target {
  int32_t width, height, y;
  uint16_t* row(int32_t x, int32_t row, int32_t) const { return lines + (row - y) * width + x; }
  void done(int32_t, int32_t, int32_t) const {}
};

static status draw(const homography& m, filter kind, const texture_view& map, uint32_t& hash) {
  count_begin();
  plane p{};
  status s = make_plane(m, {0, 0, width, height}, p);
  for (int32_t y = 0; y < height && s == status::ok; y += strip) {
    if (strip == height) s = rows::draw_any(kind, state, rows::frame565{lines, width, height, width}, p, map, rectangle{0, 0, width, height});
    else s = rows::draw_any(kind, state, strip_target{width, height, y}, p, map, rectangle{0, y, width, y + strip});
    if (strip == height) count_end();
    hash = app::hash_of(lines, width * strip, hash);
  }
  return s;
}

int main() {
#ifndef SPANTEX_SMALL
  texels.make();
#endif
  texture_view map;
  if (texels.view(wrap::repeat, map) != status::ok) return 1;
  for (const app::scene& s : app::scenes)
    for (filter kind : app::row_filters) {
      for (uint16_t& pixel : lines) pixel = 0;
      uint32_t hash = app::hash_seed;
      if (draw(app::scaled_to(s.map, down), kind, map, hash) != status::ok) return 1;
      console::print(s.name);
      console::print(" ");
      console::print(app::name_of_filter(kind));
      console::print(" ");
      console::print_hex(hash);
      console::print("\n");
    }
  return 0;
}
