// SPDX-License-Identifier: Apache-2.0
// Spans that show what they showed in the frame before (docs/PERFORMANCE.md "What is skipped", unchanged): they keep their pixels and depths.
//
// A span's pixels follow from the clear colour, the options that choose the arithmetic, and the surfaces that cover pixels of it, in their order: set-up of
// position, depth, edges and colours, map and write-out. All of it is compared, number by number; a hash only finds what is worth comparing. Surfaces that
// are the same in both frames and in the same order are left out of account; a span is unchanged if none of the others shows a pixel in it. Of opaque surfaces,
// those behind what the span shows do not.
#pragma once
#include <stdint.h>

#include <memory>
#include <unordered_map>
#include <vector>

#include "draw_host.hpp"

namespace spantex::sim {

// Surfaces by their hashes: the first one of each, and the next one of the same.
struct surface_places {
  std::unordered_map<uint64_t, int> first;
  std::vector<int> next;  // -1: none
};

// What a frame leaves for the next one. An empty one keeps no span.
class frame_before {
 public:
  // A byte a span, rows of spans, not 0 where a frame of the scene drawn in that way is unchanged; none where nothing is.
  std::vector<uint8_t> unchanged(const scene& s, const draw_options& o) const;

  const image& picture() const { return picture_; }
  const frame_depths& depth() const { return depth_; }
  void keep(const scene& s, const draw_options& o, const image& picture, const frame_depths& depth);

 private:
  bool shows(const drawable& item, int32_t sx, int32_t sy) const;

  scene scene_;
  surface_places places_;
  draw_options options_;
  std::vector<uint64_t> serials_;  // of the maps as they were
  image picture_;
  frame_depths depth_;
};

}  // namespace spantex::sim
