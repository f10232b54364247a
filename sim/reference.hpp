// SPDX-License-Identifier: Apache-2.0
// The reference renderer: double precision, 16x16 samples a pixel, the only floating point that judges pictures.
//
// A pixel is the plain mean of 256 bilinear samples of level 0, taken at ((a + 1/2)/16, (b + 1/2)/16) of its square, wrap modes
// included. Samples with W <= 0 are left out; a pixel whose centre has W <= 0 is background, as it is for the engine.
//
// Where polygons are drawn, the pixel shows the polygon that the engine's coverage and depth rules choose, and the reference
// samples that polygon's plane over the whole square: texture quality is judged, not anti-aliasing of edges.
#pragma once
#include <array>
#include <vector>

#include "image.hpp"
#include "parallel.hpp"
#include "scene.hpp"

namespace spantex::sim {

using ideal_colour = std::array<double, channel_count>;  // r g b a, 0..255

struct ideal_image {
  int width_px = 0, height_px = 0;
  std::vector<ideal_colour> pixels;
};

inline constexpr int reference_grid = 16;  // samples along a pixel's side

// Index of the item that each pixel shows, -1 for background.
std::vector<int> visible_items(const scene& s);

ideal_image render_reference(const scene& s, rgba8 background, int threads, const progress_callback& rows_done = {});

// One bilinear sample of a level, position in texels of that level; the reference's kernel.
ideal_colour sample_bilinear(const texture_view& t, int level, double u, double v);

}  // namespace spantex::sim
