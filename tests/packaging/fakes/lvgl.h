/* SPDX-License-Identifier: Apache-2.0
 * As much of LVGL 9 as docs/examples/lvgl/ uses, declared as LVGL's headers do: src/draw/lv_image_dsc.h (headers, descriptors), src/draw/lv_draw_buf.h,
 * src/widgets/canvas/lv_canvas.h, src/misc/lv_color.h. https://docs.lvgl.io/9.2/API/ */
#pragma once
#include <stdint.h>

typedef struct _lv_obj_t lv_obj_t;
typedef uint8_t lv_opa_t;
typedef struct { uint8_t blue, green, red; } lv_color_t;
enum { LV_OPA_COVER = 255 };
typedef enum { LV_COLOR_FORMAT_RGB565 = 0x12, LV_COLOR_FORMAT_ARGB8888 = 0x10 } lv_color_format_t;

typedef struct {
  uint32_t magic : 8, cf : 8, flags : 16;
  uint32_t w : 16, h : 16;
  uint32_t stride : 16, reserved_2 : 16;
} lv_image_header_t;

typedef struct {
  lv_image_header_t header;
  uint32_t data_size;
  const uint8_t* data;
  const void* reserved;
} lv_image_dsc_t;

typedef struct {
  lv_image_header_t header;
  uint32_t data_size;
  uint8_t* data;
  void* unaligned_data;
} lv_draw_buf_t;

extern "C" {
lv_draw_buf_t* lv_canvas_get_draw_buf(lv_obj_t* canvas);
void lv_canvas_fill_bg(lv_obj_t* canvas, lv_color_t color, lv_opa_t opa);
}
