// SPDX-License-Identifier: Apache-2.0
// What every package must draw alike: a plane to the horizon by the engine (trilinear, aniso) and by rows (every filter), told as hashes.
#ifdef SPANTEX_ONE_HEADER
#include <spantex.hpp>
#else
#include <hal/direct_engine.hpp>
#include <spantex/rows/draw.hpp>
#include <spantex/spantex.hpp>
#endif

#include "console.hpp"

using namespace spantex;

static constexpr int32_t width = 96, height = 64, side = 32, level_count = 6;
static constexpr fixed_profile<profiles::standard> word_lengths;
static direct_engine<fixed_profile<profiles::standard>> unit;
static rows::state state;
static rgba8 map[2 * side * side], screen[width * height];
static uint16_t map565[2 * side * side], lines[width * height];

static uint32_t hash_of(const void* data, int count) {
  uint32_t hash = 2166136261u;
  for (int k = 0; k < count; ++k) hash = (hash ^ static_cast<const uint8_t*>(data)[k]) * 16777619u;
  return hash;
}

static void tell(const char* what, uint32_t hash) {
  console::print(what);
  console::print(" ");
  console::print_hex(hash);
  console::print("\n");
}

// Levels one after the other; every texel differs from its neighbours.
static status make_maps(texture_view& rgba, texture_view& rgb565) {
  const rgba8* levels[level_count];
  const uint16_t* levels565[level_count];
  for (int level = 0, offset = 0, n = side; level < level_count; ++level, offset += n * n, n /= 2) {
    levels[level] = map + offset;
    levels565[level] = map565 + offset;
    for (int k = 0; k < n * n; ++k) {
      const int x = k % n, y = k / n;
      map[offset + k] = {uint8_t(x * 37 + y * 11), uint8_t(y * 53 + level * 20), uint8_t((x ^ y) & 4 ? 230 : 20), 255};
      map565[offset + k] = pack(texel_format::rgb565, map[offset + k]);
    }
  }
  SPANTEX_TRY(texture_view::make(levels, level_count, side, side, wrap::repeat, wrap::repeat, rgba));
  return texture_view::make(texel_format::rgb565, levels565, level_count, side, side, wrap::repeat, wrap::repeat, rgb565);
}

static status draw_all() {
  texture_view rgba, rgb565;
  SPANTEX_TRY(make_maps(rgba, rgb565));
  plane floor{};
  constexpr homography view{8 * 1126, 0, 8 * (-48 * 1126 + 90 * 650), -8 * 650, 0, 8 * (48 * 650 + 90 * 1126), 0, 1000, -20000};
  constexpr rectangle whole{0, 0, width, height};
  constexpr filter by_engine[] = {filter::trilinear, filter::aniso},
                   by_rows[] = {filter::nearest, filter::three_point, filter::bilinear, filter::mip_bilinear, filter::trilinear};
  SPANTEX_TRY(make_plane(view, whole, floor));
  for (filter kind : by_engine) {
    renderer r(unit, word_lengths, {screen, width, height, width});
    SPANTEX_TRY(r.draw(floor, rgba, kind, whole));
    SPANTEX_TRY(r.finish());
    tell("engine", hash_of(screen, int(sizeof screen)));
  }
  for (filter kind : by_rows) {
    SPANTEX_TRY(rows::draw_any(kind, state, rows::frame565{lines, width, height, width}, floor, rgb565, whole));
    tell("rows", hash_of(lines, int(sizeof lines)));
  }
  console::print(SPANTEX_VERSION "\n");
  return status::ok;
}

int main() { return draw_all() == status::ok ? 0 : 1; }
