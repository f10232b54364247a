// SPDX-License-Identifier: Apache-2.0
// docs/examples/lvgl/ on a canvas in memory: facing it is the picture, edge-on nothing, a whole turn the same again; nothing is written beside the canvas.
#include <stdio.h>
#include <string.h>

#include "../../docs/examples/lvgl/perspective_image.hpp"

struct _lv_obj_t { lv_draw_buf_t buffer; };

static constexpr int width = 40, height = 30, stride = 48;
static uint16_t picture_pixels[width * height], canvas_pixels[stride * height], seen[stride * height];

lv_draw_buf_t* lv_canvas_get_draw_buf(lv_obj_t* canvas) { return &canvas->buffer; }
static uint16_t filled;
void lv_canvas_fill_bg(lv_obj_t*, lv_color_t c, lv_opa_t) {
  filled = uint16_t(c.red >> 3 << 11 | c.green >> 2 << 5 | c.blue >> 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) canvas_pixels[y * stride + x] = filled;
}

static int failed(const char* what) { return printf("%s\n", what), 1; }
static int drawn() {
  int count = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) count += canvas_pixels[y * stride + x] != filled;
  return count;
}

int main() {
  for (int k = 0; k < width * height; ++k) picture_pixels[k] = uint16_t(k * 40503 | 1);
  for (uint16_t& p : canvas_pixels) p = 0xDEAD;
  lv_image_dsc_t picture{{0x19, LV_COLOR_FORMAT_RGB565, 0, width, height, 2 * width, 0}, sizeof picture_pixels, reinterpret_cast<const uint8_t*>(picture_pixels), nullptr};
  lv_obj_t canvas{{{0x19, LV_COLOR_FORMAT_RGB565, 0, width, height, 2 * stride, 0}, sizeof canvas_pixels, reinterpret_cast<uint8_t*>(canvas_pixels), nullptr}};
  perspective_image card{&canvas, &picture};

  if (card.draw(0, spantex::filter::nearest) != spantex::status::ok) return failed("not drawn");
  for (int y = 0; y < height; ++y) {
    if (memcmp(canvas_pixels + y * stride, picture_pixels + y * width, 2 * width) != 0) return failed("facing: not the picture");
    for (int x = width; x < stride; ++x)
      if (canvas_pixels[y * stride + x] != 0xDEAD) return failed("written beside the canvas");
  }
  if (card.draw(900) != spantex::status::ok || drawn() > height) return failed("edge-on: still seen");
  if (card.draw(450) != spantex::status::ok || drawn() < width * height / 2 || drawn() > width * height * 9 / 10) return failed("turned by 45 degrees: no narrower, or gone");
  memcpy(seen, canvas_pixels, sizeof seen);
  if (card.draw(450 - 7200) != spantex::status::ok || memcmp(seen, canvas_pixels, sizeof seen) != 0) return failed("two whole turns back: another picture");
  if (card.draw(-450) != spantex::status::ok || memcmp(seen, canvas_pixels, sizeof seen) == 0) return failed("turned the other way: the same picture");
  card.background = {0, 0xFF, 0};
  if (card.draw(900) != spantex::status::ok || canvas_pixels[0] != 0x07E0 || drawn() > height) return failed("edge-on: not the background");
  picture.header.cf = LV_COLOR_FORMAT_ARGB8888;
  if (card.draw(0) != spantex::status::out_of_range) return failed("another format taken");
  return 0;
}
