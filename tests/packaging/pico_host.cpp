// SPDX-License-Identifier: Apache-2.0
// docs/examples/pico/ against an SPI display in memory. DMA reads its words only when somebody waits for it, the latest moment the contract allows: a band
// that is drawn over too early shows. Prints the checksum of the first picture, and ends after the third.
#include <hardware/dma.h>
#include <hardware/spi.h>
#include <stdio.h>
#include <stdlib.h>

static constexpr uint pin_select = 17, pin_command = 20, width = 240, height = 240;
static struct spi_inst_t* const the_spi = nullptr;
spi_inst_t* const spi0 = the_spi;
static spi_hw_t hardware;
static bool selected, is_data, frame_open;
static uint bits = 8, pixel_count, frame_count;
static uint32_t checksum = 2166136261u;
static const volatile uint16_t* in_flight;
static uint in_flight_count;

static void fail(const char* what) {
  printf("%s\n", what);
  exit(1);
}

void gpio_init(uint) {}
void gpio_set_dir(uint, bool) {}
void gpio_set_function(uint, gpio_function) {}
void sleep_ms(uint32_t) {}
void tight_loop_contents() {}
void gpio_put(uint pin, bool value) {
  if (pin == pin_command) is_data = value;
  if (pin != pin_select) return;
  if (in_flight != nullptr) fail("display deselected while DMA was under way");
  selected = !value;
  if (value && frame_open && pixel_count > 0) {
    if (pixel_count != width * height) fail("not a whole picture");
    if (frame_count == 0) printf("%X\n", unsigned(checksum));
    if (++frame_count == 3) exit(0);
    frame_open = false;
  }
}

uint spi_init(spi_inst_t*, uint baudrate) { return baudrate; }
void spi_set_format(spi_inst_t*, uint data_bits, spi_cpol_t, spi_cpha_t, spi_order_t) {
  if (in_flight != nullptr) fail("format changed while DMA was under way");
  bits = data_bits;
}
int spi_write_blocking(spi_inst_t*, const uint8_t* src, size_t len) {
  if (!selected || bits != 8) fail("bytes to a display that is not selected or takes words");
  if (!is_data && src[0] == 0x2C) frame_open = true, pixel_count = 0;
  return int(len);
}
bool spi_is_busy(const spi_inst_t*) { return false; }
spi_hw_t* spi_get_hw(spi_inst_t*) { return &hardware; }
uint spi_get_dreq(spi_inst_t*, bool) { return 16; }

int dma_claim_unused_channel(bool) { return 0; }
dma_channel_config dma_channel_get_default_config(uint) { return {}; }
void channel_config_set_transfer_data_size(dma_channel_config* c, dma_channel_transfer_size size) { c->ctrl = size; }
void channel_config_set_dreq(dma_channel_config*, uint) {}
void dma_channel_configure(uint, const dma_channel_config* config, volatile void* to, const volatile void* from, uint count, bool) {
  if (in_flight != nullptr) fail("DMA started while it was under way");
  if (to != &hardware.dr || config->ctrl != DMA_SIZE_16 || !frame_open || !selected || !is_data || bits != 16) fail("words to a display that does not wait for them");
  in_flight = static_cast<const volatile uint16_t*>(from);
  in_flight_count = count;
}
void dma_channel_wait_for_finish_blocking(uint) {
  for (; in_flight_count > 0; --in_flight_count, ++pixel_count) checksum = frame_count == 0 ? (checksum ^ *in_flight++) * 16777619u : checksum;
  in_flight = nullptr;
}
