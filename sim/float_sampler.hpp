// SPDX-License-Identifier: Apache-2.0
// The yardstick: what a plain single-precision sampler makes of each filter. Per pixel, at its centre: one float division,
// Vulkan's rho from the Jacobian (the longer of its columns), level log2 rho clamped to the map's levels, nearest mip
// ceil(d + 1/2) - 1, weights and colours in float, result rounded to nearest. `mip_bias` as in a profile: parity is with the same levels.
#pragma once
#include <spantex/span.hpp>
#include "image.hpp"
#include "scene.hpp"

namespace spantex::sim {

image render_float(const scene& s, filter kind, int mip_bias, rgba8 background);

}  // namespace spantex::sim
