// SPDX-License-Identifier: Apache-2.0
// A floor to the horizon, drawn band by band without a frame buffer. Without a display its checksum is printed; with one, send each band where show() is.
#include <spantex.hpp>

using namespace spantex;

const int32_t screen_width = 240, screen_height = 240, band_rows = 32, horizon_row = 80, tile_side = 32;

uint16_t tiles[tile_side * tile_side], pixels[screen_width * band_rows];
rows::state state;
texture_view tile_map;
plane ground;
uint32_t checksum = 2166136261u;

// Rows [y, y + band_rows) of the picture.
struct band_target {
  int32_t width, height, y;
  uint16_t* row(int32_t x, int32_t line, int32_t) const { return pixels + (line - y) * width + x; }
  void done(int32_t, int32_t, int32_t) const {}
};

void setup() {
  Serial.begin(115200);
  for (int32_t k = 0; k < tile_side * tile_side; ++k)
    tiles[k] = pack(texel_format::rgb565, (k ^ k / tile_side) & 16 ? rgba8{70, 95, 130, 255} : rgba8{215, 205, 180, 255});
  const uint16_t* const levels[] = {tiles};
  status s = texture_view::make(texel_format::rgb565, levels, 1, tile_side, tile_side, wrap::repeat, wrap::repeat, tile_map);
  // u = X, v = Z in texels: Z = 120 tile_side / (y - horizon_row)
  const homography view{4096 * tile_side, 0, -120 * 4096 * tile_side, 0, 0, 120 * 4096 * tile_side, 0, 4096, -4096 * horizon_row};
  if (s == status::ok) s = make_plane(view, {0, 0, screen_width, screen_height}, ground);
  for (int32_t y = 0; y < screen_height && s == status::ok; y += band_rows) s = draw_band(y);
  Serial.println(s == status::ok ? checksum : 0, HEX);
}

void loop() {}

status draw_band(int32_t y) {
  const int32_t end = min_of(y + band_rows, screen_height), sky_end = clamp_to(horizon_row + 2, y, end);
  for (int32_t k = 0; k < (sky_end - y) * screen_width; ++k) pixels[k] = 0x861F;
  const status s = rows::draw<filter::bilinear>(state, band_target{screen_width, screen_height, y}, ground, tile_map, {0, sky_end, screen_width, end});
  if (s == status::ok) show(y, end - y);
  return s;
}

// Adafruit_GFX: tft.drawRGBBitmap(0, y, pixels, screen_width, row_count). TFT_eSPI: tft.pushImage(0, y, screen_width, row_count, pixels).
void show(int32_t y, int32_t row_count) {
  (void)y;
  for (int32_t k = 0; k < row_count * screen_width; ++k) checksum = (checksum ^ pixels[k]) * 16777619u;
}
