// SPDX-License-Identifier: Apache-2.0
// Maps made here, the same on every machine: KT88's two (random, squares) and one with the statistics of a photograph.
#pragma once
#include <stdint.h>

#include "image.hpp"

namespace spantex::sim {

image random_pattern(int side, uint32_t seed);        // coarse grains with finer ones on them; repeats without a seam
image squares_pattern(int side, int squares_per_side);
image shapes_mask(int side);                          // white on black: a disc, a ring, a cross, a triangle; clear of its edges
image chessboard_pattern(int side, int squares_per_side);  // black and white, black first
image photographic_pattern(int side, uint32_t seed);  // octaves whose amplitude falls as 1/f, with sharp edges; repeats

}  // namespace spantex::sim
