// SPDX-License-Identifier: Apache-2.0
// RD16 on the host: any scene textured in object space and filtered in the screen plane, through the direct engine.
#pragma once
#include <stdint.h>

#include <spantex/object_space.hpp>
#include "draw_host.hpp"
#include "image.hpp"
#include "scene.hpp"

namespace spantex::sim {

struct object_space_options {
  profile_choice profile = profile_choice::standard;
  filter kind = filter::trilinear;   // of the texture on the grid; those with a footprint leave every item out
  int share = 128;                   // of the largest pitch without holes, 1/256
  rgba8 background{0, 0, 0, 255};
  int strip_rows = 0;                // rows of sums; 0: the whole picture
  double band_ratio = 0;             // planes are cut into bands whose depths differ by at most this, each a polygon with its own pitch and level; 0: one polygon
};

struct object_space_result {
  image picture;
  object_space_counters samples;
  draw_counters texturing;           // what the span engine was asked
  uint64_t texel_reads = 0;          // per channel: 4 a sample and level
  int items_left_out = 0;            // items or bands with too large a grid, or nothing in front
};

// A plane is drawn as the polygon of it that the picture shows, up to where it is 512 times as far as at its nearest or leaves +-30000 texels,
// seen by a lens of 40 x 30 degrees: any lens gives a valid object space, the named planes were made with this one.
object_space_result render_object_space(const scene& s, const object_space_options& options);

}  // namespace spantex::sim
