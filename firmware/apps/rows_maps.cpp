// SPDX-License-Identifier: Apache-2.0
// Maps of many sizes in every wrap mode, drawn by rows with every filter: seams between pixels and within blocks, sides that masks wrap and others. Prints
// a line "size wrap filter hash" for the scenes of rows_scenes.hpp at two distances, then "random number hash" of forty planes of any direction each, horizons
// in the picture among them, on any of the maps; tools/count_instructions compares them with the host's.
#include "random_numbers.hpp"
#include "rows_scenes.hpp"

#include <firmware/targets/console.hpp>

using namespace spantex;
using app::between, app::random_number;

struct map_size { const char* name; int32_t width, height; };
// 2^16 texels and less, more, a side of more than 2^11, of one texel, and none a power of two.
static constexpr map_size sizes[] = {{"256x256", 256, 256}, {"128x512", 128, 512}, {"2048x32", 2048, 32}, {"32x2048", 32, 2048}, {"64x64", 64, 64},
                                     {"16x8", 16, 8},       {"2x1", 2, 1},         {"1x64", 1, 64},      {"4096x16", 4096, 16}, {"512x256", 512, 256},
                                     {"100x60", 100, 60},   {"255x64", 255, 64}};
struct wrap_modes { const char* name; wrap u, v; };
static constexpr wrap_modes modes[] = {{"repeat", wrap::repeat, wrap::repeat}, {"clamp", wrap::clamp, wrap::clamp}, {"mirror", wrap::mirror, wrap::mirror},
                                       {"repeat-clamp", wrap::repeat, wrap::clamp}};

static constexpr int32_t width = 96, height = 72, most_texels = 512 * 256;
static constexpr rectangle drawn{5, 3, 94, 71};
static uint16_t texels[most_texels], pixels[width * height];
static rows::state state;

// As many levels as halve exactly and fit, one after the other.
static status make_view(const map_size& m, const wrap_modes& w, texture_view& out) {
  const uint16_t* levels[13] = {texels};
  int count = 1;
  int32_t end = m.width * m.height;
  for (int32_t x = m.width / 2, y = m.height / 2; (x << count) == m.width && (y << count) == m.height && end + x * y <= most_texels; x /= 2, y /= 2) {
    levels[count++] = texels + end;
    end += x * y;
  }
  return texture_view::make(texel_format::rgb565, levels, count, m.width, m.height, w.u, w.v, out);
}

static bool show(const map_size& m, const wrap_modes& w, filter kind) {
  texture_view map;
  if (make_view(m, w, map) != status::ok) return false;
  uint32_t hash = app::hash_seed;
  for (const app::scene& s : app::scenes)
    for (int32_t down = 1; down <= 3; down += 2) {
      plane p{};
      if (make_plane(app::scaled_to(s.map, down), {0, 0, width, height}, p) != status::ok) return false;
      if (rows::draw_any(kind, state, rows::frame565{pixels, width, height, width}, p, map, drawn) != status::ok) return false;
      hash = app::hash_of(pixels, width * height, hash);
    }
  const char* const words[] = {m.name, w.name, app::name_of_filter(kind)};
  for (const char* word : words) {
    console::print(word);
    console::print(" ");
  }
  console::print_hex(hash);
  console::print("\n");
  return true;
}

static int64_t within(int64_t x) {
  const uint64_t high = random_number(), low = random_number();
  return int64_t((high << 32 | low) % uint64_t(2 * x + 1)) - x;
}

// A plane that faces the viewer or whose horizon lies in the picture or near it, level, upright or slanted; texels from 2^-9 to 2^5 pixels.
static homography random_plane() {
  const int64_t one = 1 << 24;
  const auto slope = [&](int32_t side) { return within((one << 2) / side >> between(0, 12)); };
  const int32_t kind = between(0, 3);
  const int64_t g = (kind & 1) != 0 ? slope(width) : 0, h = (kind & 2) != 0 ? slope(height) : 0;
  // A number at a time: the order within an expression is the compiler's.
  const int32_t x = between(-50, width + 50), y = between(-50, height + 50), nearness = between(0, 12), up = between(0, 5), down = between(0, 9), far = between(0, 14);
  const int64_t i = kind == 0 ? one : -g * x - h * y + (one >> nearness), scale = one << up >> down, offset = one << far;
  return {within(scale), within(scale), within(offset), within(scale), within(scale), within(offset), g, h, i};
}

static bool show_random(uint32_t number) {
  uint32_t hash = app::hash_seed;
  for (int n = 0; n < 40; ++n) {
    texture_view map;
    const map_size& m = sizes[random_number() % 12];
    if (make_view(m, modes[random_number() % 4], map) != status::ok) return false;
    plane p{};
    if (make_plane(random_plane(), {0, 0, width, height}, p) != status::ok) continue;
    const filter kind = app::row_filters[random_number() % 5];
    const rectangle area{between(0, 40), between(0, 30), between(50, width), between(35, height)};
    if (rows::draw_any(kind, state, rows::frame565{pixels, width, height, width}, p, map, area) == status::ok) hash = app::hash_of(pixels, width * height, hash);
  }
  console::print("random ");
  console::print_hex(number);
  console::print(" ");
  console::print_hex(hash);
  console::print("\n");
  return true;
}

int main() {
  for (int32_t k = 0; k < most_texels; ++k) texels[k] = app::map_texel(k & 255, k >> 8);
  for (const map_size& m : sizes)
    for (const wrap_modes& w : modes)
      for (filter kind : app::row_filters)
        if (!show(m, w, kind)) return 1;
  for (uint32_t n = 0; n < 16; ++n)
    if (!show_random(n)) return 1;
  return 0;
}
