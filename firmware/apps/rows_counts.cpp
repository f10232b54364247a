// SPDX-License-Identifier: Apache-2.0
// Draws every scene with every filter and prints what was drawn: a line "scene filter hash" a picture. tools/count_instructions counts the
// instructions from count_begin to count_end: a whole call, set-up from the matrix included.
#include "rows_scenes.hpp"
#if defined(__arm__) && defined(__ARM_ARCH_PROFILE) || defined(__riscv)
#include "../targets/semihosting.hpp"
static void print(const char* text) { semihosting::print(text); }
static void print_hex(uint32_t x) { semihosting::print_hex(x); }
#else
#include <stdio.h>
static void print(const char* text) { fputs(text, stdout); }
static void print_hex(uint32_t x) { printf("%08x", x); }
#endif

using namespace spantex;

#ifndef SPANTEX_DOWN
#define SPANTEX_DOWN 1
#endif
static constexpr int32_t width = 320 / SPANTEX_DOWN, height = 240 / SPANTEX_DOWN;
static rows::state state;
static uint16_t texels[app::map_texel_count], frame[width * height];

extern "C" {
[[gnu::noinline, gnu::used]] void count_begin() { asm volatile(""); }
[[gnu::noinline, gnu::used]] void count_end() { asm volatile(""); }
}

static status draw(const homography& m, filter kind, const texture_view& map) {
  const rectangle screen{0, 0, width, height};
  const rows::frame565 target{frame, width, height, width};
  count_begin();
  plane p{};
  status s = make_plane(m, screen, p);
  if (s == status::ok) s = rows::draw_any(kind, state, target, p, map, screen);
  count_end();
  return s;
}

int main() {
  const uint16_t* levels[app::map_side_log2 + 1];
  app::make_map(texels, levels);
  texture_view map;
  if (texture_view::make(texel_format::rgb565, levels, app::map_side_log2 + 1, app::map_side, app::map_side, wrap::repeat, wrap::repeat, map) != status::ok) return 1;
  for (const app::scene& s : app::scenes)
    for (filter kind : app::row_filters) {
      for (uint16_t& pixel : frame) pixel = 0;
      if (draw(app::scaled_to(s.map, SPANTEX_DOWN), kind, map) != status::ok) return 1;
      print(s.name);
      print(" ");
      print(app::name_of_filter(kind));
      print(" ");
      print_hex(app::hash_of(frame, width * height));
      print("\n");
    }
  return 0;
}
