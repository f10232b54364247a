// SPDX-License-Identifier: Apache-2.0
// A map with its levels, owned. Level L has sides max(1, floor(size / 2^L)).
//
// Prefilters, each a weighted mean along u and along v, exact integers, rounded once per level, to nearest, halves to even
// (halves up would brighten a 2x2 mean by an eighth of a step a level):
//   box       a texel is the mean of the part of the finer level that it covers: 2x2 for even sides; for an odd side 2m+1 three
//             texels with weights m-i, m, i+1 over 2m+1 (the box moves through its phases), so a level covers the whole map
//   triangle  KT88: filtered with [1 2 1] x [1 2 1] / 16, then halved. Halving takes the same means as box (for even sides together
//             [1 3 3 1] / 8): taking every other texel instead would move the map by half a texel a level
// The triangle reads neighbours through the wrap mode, so a repeating map stays seamless on every level.
#pragma once
#include <stdint.h>

#include <vector>

#include <spantex/texture.hpp>
#include "image.hpp"

namespace spantex::sim {

enum class prefilter : uint8_t { box, triangle };

class texture_map {
 public:
  texture_map(image level0, prefilter kind, wrap u, wrap v);
  texture_map(texture_map&&) = default;
  texture_map& operator=(texture_map&&) = default;

  const texture_view& view() const { return view_; }
  const image& level(int index) const { return levels_[size_t(index)]; }
  int level_count() const { return int(levels_.size()); }

 private:
  std::vector<image> levels_;
  texture_view view_;  // points into levels_, whose texels stay where they are when the map is moved
};

// One level from the next finer one.
image halved(const image& fine, prefilter kind, wrap u, wrap v);

}  // namespace spantex::sim
