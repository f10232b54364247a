// SPDX-License-Identifier: Apache-2.0
// An LVGL 9 image that turns about its upright axis in perspective, on a canvas. LVGL blends the canvas with everything else as it does any image.
//
//   LV_DRAW_BUF_DEFINE_STATIC(buffer, 120, 120, LV_COLOR_FORMAT_RGB565);
//   LV_DRAW_BUF_INIT_STATIC(buffer);
//   lv_obj_t* canvas = lv_canvas_create(lv_screen_active());
//   lv_canvas_set_draw_buf(canvas, &buffer);
//   static perspective_image card{canvas, &picture};           // picture: lv_image_dsc_t of LV_COLOR_FORMAT_RGB565
//   card.draw(450);                                             // 45.0 degrees; from an lv_anim_t's exec_cb to make it turn
#pragma once
#include <spantex/rows/draw.hpp>

#include <lvgl.h>

struct perspective_image {
  lv_obj_t* canvas;               // its draw buffer: LV_COLOR_FORMAT_RGB565
  const lv_image_dsc_t* picture;  // LV_COLOR_FORMAT_RGB565, rows without gaps, sides 1..4096; not copied
  lv_color_t background{};        // what lies beside the picture: black, or what lies under the canvas
  spantex::rows::state state{};
  spantex::polygon face{};

  // Turned by `angle` tenths of a degree, any number; at 0 a picture pixel is a canvas pixel.
  // Errors: out_of_range (a format or stride that is not as above), those of texture_view::make() and make_polygon().
  spantex::status draw(int32_t angle, spantex::filter kind = spantex::filter::bilinear);
};
