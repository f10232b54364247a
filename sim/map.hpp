// SPDX-License-Identifier: Apache-2.0
// A map with its levels, owned: made from a picture by a prefilter, encoded in one format and uploaded into global texture memory of its own;
// or held as a compiled pack (pack.hpp). Level L has sides max(1, floor(size / 2^L)).
#pragma once
#include <stdint.h>

#include <string>
#include <vector>

#include <spantex/texture.hpp>
#include "encode.hpp"
#include "file.hpp"
#include "image.hpp"
#include "prefilter.hpp"

namespace spantex::sim {

class texture_map {
 public:
  // A palette, where the format has one, is made from level 0.
  texture_map(image level0, prefilter kind, wrap u, wrap v, texel_format format = texel_format::rgba8888,
              colour_space colours = colour_space::coded);
  // Levels as they are.
  texture_map(std::vector<image> levels, wrap u, wrap v, texel_format format = texel_format::rgba8888);
  // A pack as it is in a file, used in place. Throws input_error, `name` in front, for a damaged one or one of the other byte order.
  texture_map(bytes pack, const std::string& name);
  texture_map(texture_map&&) = default;
  texture_map& operator=(texture_map&&) = default;

  const texture_view& view() const { return view_; }
  void set_colours(colour_space space) { view_.set_colours(space); }
  void set_contour(const contour_style& style);  // throws input_error
  const image& level(int index) const { return levels_[size_t(index)]; }  // of a map made from a picture, before encoding
  int level_count() const { return view_.level_count(); }
  uint64_t words_uploaded() const { return memory_.size(); }  // 64-bit words of global texture memory; none for a pack

 private:
  std::vector<image> levels_;
  std::vector<uint64_t> memory_;
  bytes pack_;
  texture_view view_;  // points into memory_ or pack_, whose bytes stay where they are when the map is moved
};

}  // namespace spantex::sim
