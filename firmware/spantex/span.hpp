// SPDX-License-Identifier: Apache-2.0
// What crosses the HAL for one span: coefficients, a mask of pixels, and the pixels that come back.
#pragma once
#include <stdint.h>

#include <spantex/contour_style.hpp>
#include <spantex/coverage.hpp>

namespace spantex {

// A colour; bytes in this order in memory on every target.
struct rgba8 {
  uint8_t r, g, b, a;
  friend constexpr bool operator==(const rgba8&, const rgba8&) = default;
};

inline constexpr int channel_count = 4, alpha_channel = 3;

enum class filter : uint8_t {
  nearest, bilinear, three_point,           // level 0
  mip_bilinear, trilinear, trilinear3,      // by level of detail
  squares, aniso,                           // a row of samples along the pixel's image (footprint.hpp)
  step, hat,                                // a polygon, the pixel's image, weighted by area (area.hpp)
  contour,                                  // trilinear colours; alpha is the coverage of a contour (contour.hpp)
};

inline constexpr filter last_filter = filter::contour;

constexpr bool uses_levels(filter f) { return f >= filter::mip_bilinear; }
constexpr bool uses_two_levels(filter f) {
  return f == filter::trilinear || f == filter::trilinear3 || f == filter::aniso || f == filter::contour;
}
constexpr bool uses_footprint(filter f) { return f == filter::squares || f == filter::aniso; }
constexpr bool uses_area(filter f) { return f == filter::step || f == filter::hat; }
constexpr bool uses_three_points(filter f) { return f == filter::three_point || f == filter::trilinear3; }

// Texels that one sample uses on each level.
constexpr int texels_per_sample(filter f) { return f == filter::nearest ? 1 : uses_three_points(f) ? 3 : 4; }

// How 1/w = 1/(1 + e) is evaluated on a span (docs/SPEC.md "Span coordinates"). Each is chosen only where its error stays within the
// profile's tolerance.
enum class evaluation : uint8_t {
  affine,    // 1
  series,    // 1 - e + e^2 - ..., one to four terms in 16-bit products
  divide,    // table and Newton's iteration
};

// Position of the map section in local memory for one level, and how level-0 coordinates become that level's.
struct section {
  int32_t origin_u, origin_v;  // first texel of the section, which is side x side texels, held at its index modulo the side
  uint32_t ratio_u, ratio_v;   // u1.31: level size * 2^L / size of level 0; 2^31 for power-of-two sizes
  uint8_t level;               // L
  bool one_u, one_v;           // the level is one texel wide / high: every position is texel 0
};

// The pixel's image as a vector on the map, along the span's direction on the screen (footprint.hpp):
//   n_u = c_u + a_u hx + b_u hy,  V_u = n_u / w^2 2^-exponent texels of level 0 per half pixel
// For filter contour the Jacobian's columns and their twist instead (contour.hpp).
struct axis_terms {
  int32_t c_u, a_u, b_u, c_v, a_v, b_v;    // offset_bits magnitude for the sums
  int16_t area_log2;                       // s5.10: log2 of the area of a pixel's image at w = 1, texels of level 0
  int8_t exponent;
  uint8_t first_sample, last_sample;       // of each pixel's row: [first, last); step, hat: the first is the window's tile
  bool partial;                            // not all of it: sums come back instead of a pixel (one pixel in the mask)
};

// One span. Positions are relative to its reference point: the span's centre, or a pixel's centre.
//   n_u = c_u + a_u hx + b_u hy,  w = 1 + g hx + h hy,  u = base_u + n_u / w 2^-exponent
// with hx = 2i - 7, hy = 2j - 7: half pixels from the centre for pixel (i, j) of the span; 0 if `centred`.
struct span_coefficients {
  int32_t base_u, base_v;                  // whole texels of level 0
  int32_t c_u, a_u, b_u, c_v, a_v, b_v;    // texels 2^exponent; offset_bits magnitude for the sums
  int32_t g, h;                            // reciprocal_bits fraction bits; |7g| + |7h| < 1/2 - 1/256 (9 for step, hat; 2 if centred)
  int16_t level_row[span_side];            // s5.10: level of detail for w = 1, along each row and each column
  int16_t level_column[span_side];         // the larger of the two counts
  axis_terms axis;                         // filters with a footprint, contour
  contour_terms contour;                   // filter contour
  section fine, coarse;
  int8_t exponent;
  int8_t slope_log2;                       // |w - 1| < 2^slope_log2 on the span; -15 or more
  uint8_t last_level;                      // of the map
  evaluation how;
  uint8_t terms;                           // of the series, 1 to 4
  filter kind;
  bool two_levels;                         // the coarser section is loaded and wanted
  bool corrects;                           // the section may be too small: coordinates are clamped to it
  bool linear_light;                       // r, g, b are sRGB codes (srgb.hpp), filtered in linear light
  bool centred;                            // the reference point is the centre of the one pixel in the mask, and slopes count (step, hat)
  int8_t from_x = 0, from_y = 0;           // half pixels from the reference point to the span's centre: in the simulator only (unit_variants)
};

// Weighted sums of texels over part of a footprint; their total over all parts is divided once. Below 2^32: weights add up to at most 2^24
// (2^16 in linear light, whose colours have 16 bits).
struct footprint_sums {
  uint32_t channel[channel_count];
  uint32_t weight;
  friend constexpr bool operator==(const footprint_sums&, const footprint_sums&) = default;
};

struct span_pixels {
  rgba8 pixel[span_pixel_count];           // only those in the mask are defined; none for partial coefficients
  footprint_sums sums;                     // for partial coefficients only
};

}  // namespace spantex
