// SPDX-License-Identifier: Apache-2.0
// Truncated inverse filter: sharpens a level by what its prefilter blurred (METHODS 6; derivation and measurements: docs/TEXTURES.md).
//
// A blur x (a symmetric kernel with sum 1, its response in [0, 1]) has the inverse 1/x = 1/(1 - (1 - x)) = sum over j of (1 - x)^j; its first
// four terms are (1 - (1 - x)^4) / x = 4 - 6x + 4x^2 - x^3, powers being repeated convolution. What is left of x after it is 1 - (1 - x)^4.
//
// x stands for what the chain of prefilters from level 0 does to a level, on the level's own grid: [a, 1 - 2a, a] along u and along v with
// a = (1 - K) / 2, K the chain's response at a quarter cycle per texel of the level, where x then agrees with it. a is rounded to 1/128 and
// limited to [0, 1/4]; a prefilter that does not blur there (kaiser, lanczos: nearly) is left as it is.
#pragma once
#include <array>
#include <vector>

#include "prefilter.hpp"

namespace spantex::sim {

inline constexpr int blur_bits = 7;

// a 2^blur_bits.
struct blur { int32_t u = 0, v = 0; };

// Of the chain that leads from a map of size width x height to its level.
blur blur_of(int width, int height, int level, prefilter kind);

// 4 f - 6 x f + 4 x^2 f - x^3 f, exact in 64 bits, rounded once to nearest, halves to even, clamped to 0..255. Beyond the edges as `u` and
// `v` say. With alpha weighted: of colours multiplied by alpha; where the new alpha is 0 the colour stays. srgb: colours in linear light, as halved().
image inverse_filtered(const image& level, blur x, wrap u, wrap v, alpha_weighting alpha = alpha_weighting::independent, int threads = 1,
                       colour_space colours = colour_space::coded);

}  // namespace spantex::sim
