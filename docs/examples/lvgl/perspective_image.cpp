// SPDX-License-Identifier: Apache-2.0
#include "perspective_image.hpp"

#include <spantex/camera.hpp>

using namespace spantex;

namespace {

constexpr int32_t one = 1 << 16;  // s15.16: pixels, texels

status map_of(const lv_image_dsc_t& picture, texture_view& out) {
  const lv_image_header_t& h = picture.header;
  const bool packed = h.stride == 0 || h.stride == 2 * h.w, aligned = reinterpret_cast<uintptr_t>(picture.data) % 2 == 0;
  if (h.cf != LV_COLOR_FORMAT_RGB565 || !packed || !aligned) return status::out_of_range;
  const uint16_t* const levels[] = {reinterpret_cast<const uint16_t*>(picture.data)};
  return texture_view::make(texel_format::rgb565, levels, 1, int32_t(h.w), int32_t(h.h), wrap::clamp, wrap::clamp, out);
}

status frame_of(lv_draw_buf_t* buffer, rows::frame565& out) {
  if (buffer == nullptr || buffer->header.cf != LV_COLOR_FORMAT_RGB565 || buffer->header.stride % 2 != 0) return status::out_of_range;
  out = {reinterpret_cast<uint16_t*>(buffer->data), int32_t(buffer->header.w), int32_t(buffer->header.h), int32_t(buffer->header.stride / 2)};
  return status::ok;
}

int32_t scaled(int32_t x, int32_t s1_30) { return int32_t(int64_t(x) * s1_30 >> 30); }

}  // namespace

status perspective_image::draw(int32_t angle, filter kind) {
  texture_view map;
  rows::frame565 frame{};
  SPANTEX_TRY(map_of(*picture, map));
  SPANTEX_TRY(frame_of(lv_canvas_get_draw_buf(canvas), frame));
  lv_canvas_fill_bg(canvas, background, LV_OPA_COVER);  // tells LVGL to show the canvas anew, too

  // A turn is 2^32. The eye is two picture widths away from the axis; there a pixel of the picture is a pixel of the screen.
  const int32_t turned = angle % 3600;
  const auto turn = sine_cosine_of(binary_angle(uint32_t(int64_t(turned) * (int64_t(1) << 32) / 3600)));
  const int32_t width = int32_t(picture->header.w) * one, height = int32_t(picture->header.h) * one, distance = 2 * width;
  const int32_t x = scaled(width / 2, turn.cosine), z = scaled(width / 2, turn.sine);
  const projection camera{distance, distance, frame.width * (one / 2), frame.height * (one / 2), one};
  const vertex corners[] = {{-x, -height / 2, distance - z, 0, 0}, {x, -height / 2, distance + z, width, 0},
                            {x, height / 2, distance + z, width, height}, {-x, height / 2, distance - z, 0, height}};
  const status set_up = make_polygon(corners, 4, camera, {0, 0, frame.width, frame.height}, face);
  if (set_up == status::degenerate) return status::ok;  // seen edge-on
  return set_up == status::ok ? rows::draw_any(kind, state, frame, face, map) : set_up;
}
