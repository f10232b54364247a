// SPDX-License-Identifier: Apache-2.0
// A map with its levels, owned: made from a picture by a prefilter, encoded in one format and uploaded into global texture memory of its own;
// or held as a compiled pack (pack.hpp). Level L has sides max(1, floor(size / 2^L)).
#pragma once
#include <stdint.h>

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <hal/kernels/planar_map.hpp>
#include <spantex/texture.hpp>
#include "encode.hpp"
#include "file.hpp"
#include "image.hpp"
#include "prefilter.hpp"

namespace spantex::sim {

// When a picture's levels are made.
enum class level_making : uint8_t {
  at_once,
  on_demand,  // encoded and uploaded when make_level() first asks for one, from the finer ones, which are averaged for it and no more than that
};

class texture_map {
 public:
  // A palette, where the format has one, is made from level 0. most_levels: no more levels are made; 0: all.
  texture_map(image level0, prefilter kind, wrap u, wrap v, texel_format format = texel_format::rgba8888,
              colour_space colours = colour_space::coded, int most_levels = 0, level_making when = level_making::at_once);
  // Levels as they are.
  texture_map(std::vector<image> levels, wrap u, wrap v, texel_format format = texel_format::rgba8888);
  // A pack as it is in a file, used in place. Throws input_error, `name` in front, for a damaged one or one of the other byte order.
  texture_map(bytes pack, const std::string& name);
  texture_map(texture_map&&) = default;
  texture_map& operator=(texture_map&&) = default;

  // With all levels: makes those that are not yet.
  const texture_view& view() const {
    if (waiting_) make_all();
    return view_;
  }
  // Of a map whose levels are made on demand: make_level() before texels of a level are read. Any thread may; returns the words that it uploaded.
  const texture_view& view_on_demand() const { return view_; }
  uint64_t make_level(int level) const;
  // As host kernels read it, with all levels: made when it is first asked for, and kept as long as the map, up to one a layout. Any thread may ask.
  const kernels::planar_map& planar(kernels::layout of) const;
  texture_facts facts() const;  // of the levels that are made
  void set_colours(colour_space space) { view_.set_colours(space); }
  void set_contour(const contour_style& style);  // throws input_error
  const image& level(int index) const {  // of a map made from a picture, before encoding
    if (waiting_) make_all();
    return levels_[size_t(index)];
  }
  int level_count() const { return view_.level_count(); }
  int levels_left_out() const;  // of a picture: not made, or by nobody asked for
  uint64_t serial() const { return serial_; }  // no other map has it, and a map's texels do not change
  friend bool same_texels(const texture_map& a, const texture_map& b);  // all of them compared, with sizes, wraps and format
  uint64_t words_uploaded() const;  // 64-bit words of global texture memory; none for a pack

 private:
  uint64_t serial_ = next_serial();
  static uint64_t next_serial();

  // What making a level takes.
  struct waiting {
    prefilter kind;
    colour_space colours;
    palette indexed;
    std::vector<size_t> first_word;        // of each level, and the end of the last
    std::mutex one_at_a_time{};
    std::atomic<uint32_t> made{0}, asked{0};  // bits of levels
    std::atomic<uint16_t> uniform{0};
  };
  struct planar_maps {
    std::map<kernels::layout, kernels::planar_map> made{};
    std::mutex one_at_a_time{};
  };
  void upload_level(int level) const;
  void make_all() const;

  mutable std::vector<image> levels_;      // on demand: empty ones from where none was needed
  mutable std::vector<uint64_t> memory_;
  std::unique_ptr<waiting> waiting_;       // levels are made on demand
  std::unique_ptr<planar_maps> planar_ = std::make_unique<planar_maps>();
  bytes pack_;
  texture_view view_;  // points into memory_ or pack_, whose bytes stay where they are when the map is moved
};

}  // namespace spantex::sim
