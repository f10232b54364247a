// SPDX-License-Identifier: Apache-2.0
// The drawing of drawing.c (compiled as C) in every pixel format, sent to a display tile by tile: a line "format hash" of the bytes that it gets. The same on
// every core: tools/device_drawing.
#include <spantex/spantex.h>

#include <firmware/targets/console.hpp>

extern "C" {
spantex_status make_maps(void);
spantex_status draw_into(void* user, spantex_target* target);
}

static uint32_t hash;
alignas(4) static uint8_t buffers[2][4 * 64 * 32];

// Bytes are those of a little-endian core, which all of these are.
static void start(void*, spantex_rectangle, const uint8_t* bytes, uint32_t count, int) {
  for (uint32_t k = 0; k < count; ++k) hash = (hash ^ bytes[k]) * 16777619u;
}
static void wait(void*, int) {}

int main() {
  static const char* const names[] = {"rgb565", "rgb565_swapped", "rgb888", "bgr888", "rgba8888", "bgra8888", "grey8", "grey4", "mono1", "mono1_pages"};
  if (make_maps() != SPANTEX_OK) return 1;
  const spantex_display display{start, wait, nullptr};
  for (int f = 0; f < 10; ++f) {
    hash = 2166136261u;
    if (spantex_draw_tiles(&display, spantex_format(f), {0, 0, 320, 240}, 64, 32, buffers[0], buffers[1], sizeof buffers[0], draw_into, nullptr) != SPANTEX_OK) return 1;
    console::print(names[f]);
    console::print(" ");
    console::print_hex(hash);
    console::print("\n");
  }
  return 0;
}
