// SPDX-License-Identifier: Apache-2.0
// Maps of many sizes in every wrap mode, drawn by rows with every filter: seams between pixels and within blocks, sides that masks wrap and others. Prints
// a line "size wrap filter hash" for the scenes of rows_scenes.hpp at two distances; tools/count_instructions compares it with the host's.
#include "rows_scenes.hpp"

#include <firmware/targets/console.hpp>

using namespace spantex;

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

int main() {
  for (int32_t k = 0; k < most_texels; ++k) texels[k] = app::map_texel(k & 255, k >> 8);
  for (const map_size& m : sizes)
    for (const wrap_modes& w : modes)
      for (filter kind : app::row_filters)
        if (!show(m, w, kind)) return 1;
  return 0;
}
