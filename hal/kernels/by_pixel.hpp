// SPDX-License-Identifier: Apache-2.0
// What kernels leave: spans by the specification's own planner and datapath (spantex/plan.hpp, spantex/datapath.hpp), a pixel at a time, with the whole map for local memory.
#pragma once
#include <stdint.h>

#include <spantex/plan.hpp>
#include "kernel.hpp"

namespace spantex::kernels {

// Pixels of span (sx, sy), all of them in front of the viewer, of an opaque surface or to be written out. `pixels`: the first one of row span_side sy, from x = 0 on. Profile default but for
// max_samples; filters that kernels draw.
void draw_by_pixel(const surface& s, const planar_map& texels, int max_samples, int32_t sx, int32_t sy, span_mask mask, rgba8* pixels, int32_t stride);

}  // namespace spantex::kernels
