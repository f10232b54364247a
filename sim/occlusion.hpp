// SPDX-License-Identifier: Apache-2.0
// What lies behind polygons that were set up before, and so need not be set up: of an opaque picture no pixel changes (spantex/visibility.hpp, is_hidden), but what shows between pixels' centres, which a reference samples too. Span by span, a floor: the least depth of a polygon
// that covers it, or of several that cover it together. Triangles of less than a quarter of a span cover nothing here.
#pragma once
#include <stdint.h>

#include <vector>

#include <hal/kernels/masks.hpp>
#include "scene.hpp"

namespace spantex::sim {

class occlusion {
 public:
  explicit occlusion(screen_size size);

  // Whether nothing of a face is seen. False where this is not known: faces of more than three corners, and as is_hidden() has it.
  bool hides(const vertex* corners, int count, const lens& view) const;
  // A polygon that is drawn before whatever is asked for from now on: what it covers of one of so many bands of the picture, which threads may add to at once.
  void add(const polygon& p, int band, int bands);

 private:
  // Of polygons none of which covers the span alone.
  struct part {
    span_mask covered = 0;
    uint32_t least = UINT32_MAX;
  };

  screen_size size_;
  kernels::row_cover cover_ = kernels::cover_of(kernels::choice::fastest);
  std::vector<uint32_t> floors_;
  std::vector<part> parts_;
};

}  // namespace spantex::sim
