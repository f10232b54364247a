// SPDX-License-Identifier: Apache-2.0
// A floor that turns under the camera, on an ST7789 of 240 x 240 pixels at the SPI of a Raspberry Pi Pico. No frame buffer: the picture is drawn in bands
// of 32 rows, and while DMA sends one band the other is drawn. Pixels go out as 16-bit words, so RGB565 needs no swapping of bytes.
#include <hardware/dma.h>
#include <hardware/spi.h>
#include <pico/stdlib.h>

#include <spantex/camera.hpp>
#include <spantex/rows/draw.hpp>

using namespace spantex;

namespace {

constexpr uint pin_sck = 18, pin_data = 19, pin_select = 17, pin_command = 20, pin_reset = 21;
constexpr int32_t width = 240, height = 240, band_rows = 32, horizon = 80, side = 32;

uint16_t tiles[side * side], bands[2][width * band_rows];
rows::state state;

// Rows [y, y + band_rows) of the picture.
struct band {
  int32_t width, height, y;
  uint16_t* pixels;
  uint16_t* row(int32_t x, int32_t line, int32_t) const { return pixels + (line - y) * width + x; }
  void done(int32_t, int32_t, int32_t) const {}
};

status make_tiles(texture_view& out) {
  for (int32_t k = 0; k < side * side; ++k)
    tiles[k] = pack(texel_format::rgb565, (k ^ k / side) & 16 ? rgba8{70, 95, 130, 255} : rgba8{215, 205, 180, 255});
  const uint16_t* const levels[] = {tiles};
  return texture_view::make(texel_format::rgb565, levels, 1, side, side, wrap::repeat, wrap::repeat, out);
}

// The floor one tile below the eye, turned by `turn` (2^32 is all round): u = X cos + Z sin, v = Z cos - X sin, Z = 120 side / (y - horizon).
status make_floor(uint32_t turn, plane& out) {
  const auto s = sine_cosine_of(binary_angle(turn));
  const int64_t c = s.cosine >> 18, n = s.sine >> 18;  // s1.12
  const homography view{side * c, 0, side * (-120 * c + 120 * n), -side * n, 0, side * (120 * n + 120 * c), 0, 4096, -4096 * horizon};
  return make_plane(view, {0, 0, width, height}, out);
}

status draw_band(const plane& floor, const texture_view& map, int32_t y, uint16_t* pixels) {
  const int32_t end = min_of(y + band_rows, height), sky_end = clamp_to(horizon + 2, y, end);
  for (int32_t k = 0; k < (sky_end - y) * width; ++k) pixels[k] = 0x861F;
  return rows::draw<filter::bilinear>(state, band{width, height, y, pixels}, floor, map, {0, sky_end, width, end});
}

void send(uint8_t command, const uint8_t* data, size_t count) {
  gpio_put(pin_select, false);
  gpio_put(pin_command, false);
  spi_write_blocking(spi0, &command, 1);
  gpio_put(pin_command, true);
  if (count > 0) spi_write_blocking(spi0, data, count);
  gpio_put(pin_select, true);
}

void start_display() {
  spi_init(spi0, 62'500'000);
  gpio_set_function(pin_sck, GPIO_FUNC_SPI);
  gpio_set_function(pin_data, GPIO_FUNC_SPI);
  constexpr uint outputs[] = {pin_select, pin_command, pin_reset};
  for (uint pin : outputs) {
    gpio_init(pin);
    gpio_set_dir(pin, GPIO_OUT);
    gpio_put(pin, true);
  }
  const uint8_t bits_16 = 0x55, upright = 0x00;
  send(0x01, nullptr, 0);  // reset
  sleep_ms(150);
  send(0x11, nullptr, 0);  // out of sleep
  sleep_ms(120);
  send(0x3A, &bits_16, 1);
  send(0x36, &upright, 1);
  send(0x21, nullptr, 0);  // these panels show colours inverted
  send(0x29, nullptr, 0);  // on
}

// The whole screen as the window of what follows, which is 16-bit words until end_frame().
void begin_frame() {
  const uint8_t columns[] = {0, 0, 0, width - 1}, lines[] = {0, 0, 0, height - 1};
  spi_set_format(spi0, 8, SPI_CPOL_0, SPI_CPHA_0, SPI_MSB_FIRST);
  send(0x2A, columns, 4);
  send(0x2B, lines, 4);
  send(0x2C, nullptr, 0);
  gpio_put(pin_select, false);
  spi_set_format(spi0, 16, SPI_CPOL_0, SPI_CPHA_0, SPI_MSB_FIRST);
}

// DMA is done when its last word is in the SPI's queue, not when it is on the wire.
void end_frame(uint channel) {
  dma_channel_wait_for_finish_blocking(channel);
  while (spi_is_busy(spi0)) tight_loop_contents();
  gpio_put(pin_select, true);
}

status draw_frame(uint32_t turn, const texture_view& map, uint channel, const dma_channel_config& to_display) {
  plane floor{};
  SPANTEX_TRY(make_floor(turn, floor));
  begin_frame();
  for (int32_t y = 0, which = 0; y < height; y += band_rows, which ^= 1) {
    SPANTEX_TRY(draw_band(floor, map, y, bands[which]));
    dma_channel_wait_for_finish_blocking(channel);  // the other band is out
    dma_channel_configure(channel, &to_display, &spi_get_hw(spi0)->dr, bands[which], uint(min_of(band_rows, height - y) * width), true);
  }
  end_frame(channel);
  return status::ok;
}

}  // namespace

int main() {
  start_display();
  const uint channel = uint(dma_claim_unused_channel(true));
  dma_channel_config to_display = dma_channel_get_default_config(channel);
  channel_config_set_transfer_data_size(&to_display, DMA_SIZE_16);
  channel_config_set_dreq(&to_display, spi_get_dreq(spi0, true));

  texture_view map;
  if (make_tiles(map) != status::ok) return 1;
  for (uint32_t turn = 0;; turn += 1u << 24)
    if (draw_frame(turn, map, channel, to_display) != status::ok) return 1;
}
