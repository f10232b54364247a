// SPDX-License-Identifier: Apache-2.0
// What kernels leave, and what is drawn by numbers that they are not made for: spans by the specification's own planner and datapath (spantex/plan.hpp, spantex/datapath.hpp), a pixel at a time, with the whole map for local memory.
#pragma once
#include <stdint.h>

#include <spantex/plan.hpp>
#include "kernel.hpp"

namespace spantex::kernels {

// Whether it draws by these numbers: those of profile default or exact, filter aniso's samples aside. Filters are those that kernels draw.
bool draws_by_pixel(const profile& numbers);

// Pixels of span (sx, sy), all of them in front of the viewer, of a surface without a level of its own. `pixels`: the first one of row span_side sy, from x = 0 on.
void draw_by_pixel(const surface& s, const planar_map& texels, const profile& numbers, int32_t sx, int32_t sy, span_mask mask, rgba8* pixels, int32_t stride);

// A row_kernel that leaves every span: choice::pixels.
void leave_to_pixels(const row_work& work);

}  // namespace spantex::kernels
