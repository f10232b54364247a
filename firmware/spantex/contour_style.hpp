// SPDX-License-Identifier: Apache-2.0
// How a contour map is read (VR11): its alpha is a scalar field, and the contour is where the field crosses a threshold.
#pragma once
#include <stdint.h>

#include <spantex/log2.hpp>
#include <spantex/status.hpp>

namespace spantex {

// In which texels the field of a coarser level counts its distances.
enum class field_unit : uint8_t {
  level_0,    // as on level 0: levels are means, as of any map
  own_level,  // its own: 8 bits reach as far on the screen on every level (sim/distance_field.hpp makes such maps)
};

struct contour_style {
  uint16_t threshold = 128 << 8;  // u8.8: the field where the contour runs; larger is inside
  uint16_t scale = 16 << 8;       // u8.8, at least 1/16: field units per texel, across the contour
  uint8_t outline = 0;            // 1/16 pixel: width of the line drawn along the contour; 0: the inside is filled
  field_unit unit = field_unit::level_0;
  friend constexpr bool operator==(const contour_style&, const contour_style&) = default;
};

constexpr status check(const contour_style& s) {
  return s.scale < 16 || s.unit > field_unit::own_level ? status::out_of_range : status::ok;
}

// What of it crosses the HAL.
struct alignas(4) contour_terms {
  uint16_t threshold;    // u8.8
  int16_t scale_log2;    // s5.10
  uint8_t outline;       // 1/16 pixel
  bool own_units;        // of each level
};

constexpr contour_terms terms_of(const contour_style& s) {
  const int32_t scale_log2 = log2_16(s.scale) - (8 << 16);  // [-4, 8)
  return {s.threshold, int16_t((scale_log2 + 32) >> 6), s.outline, s.unit == field_unit::own_level};
}

}  // namespace spantex
