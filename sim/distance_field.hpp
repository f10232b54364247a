// SPDX-License-Identifier: Apache-2.0
// Fields for contour textures (spantex/contour.hpp): signed Euclidean distances of a mask, in integers, exact but for one square root.
#pragma once
#include <stdint.h>

#include <vector>

#include "image.hpp"
#include "map.hpp"

namespace spantex::sim {

// A picture's inside.
enum class inside_by : uint8_t {
  either,  // alpha, or, of a picture that is opaque everywhere, light
  alpha,   // of at least 128
  light,   // luma (BT.601) of at least 128
  dark,    // below
};
struct mask {
  int width_px = 0, height_px = 0;
  std::vector<uint8_t> inside;  // 0 or 1, rows from the top
  bool at(int x, int y) const { return inside[size_t(y) * size_t(width_px) + size_t(x)] != 0; }
};
mask make_mask(const image& picture, inside_by rule = inside_by::either);

// Squared distance of every pixel's centre to the nearest centre of a pixel whose `inside` is `of`: exact (Meijster, Roerdink and Hesselink 2000).
// no_distance where there is none. Beyond the picture there is nothing.
inline constexpr int64_t no_distance = INT64_MAX;
std::vector<int64_t> squared_distances(const mask& m, bool of);

// Signed distance from every pixel's centre to the outline, 1/256 pixel of the mask, positive inside. The outline lies half way between a pixel and its
// nearest neighbour on the other side, so a distance is sqrt(squared) - 1/2, the root to nearest. A mask of one kind: +-2^30.
std::vector<int32_t> signed_distances(const mask& m);

// The levels of a contour map from a picture whose sides are multiples of `reduction`: one texel for reduction x reduction pixels. Level L holds, in alpha, 128 plus
// `scale` times the mean distance over the texel's square, in texels of level L, to nearest, cut to 0..255; r, g, b are `colour`.
// Throws input_error: sides, scale outside 1..64.
std::vector<image> make_field_levels(const image& picture, int reduction, int scale, rgba8 colour, inside_by rule = inside_by::either);

// How they are read: field_unit::own_level, threshold 128, the scale, an outline in 1/16 pixel. Throws input_error: outside 0..255.
contour_style field_style(int scale, int outline_16);

// Both as a map.
texture_map make_field_map(const image& picture, int reduction, int scale, int outline_16, rgba8 colour, wrap u, wrap v);

}  // namespace spantex::sim
