// SPDX-License-Identifier: Apache-2.0
// A sweep's specification: parts, each a set of points around a base (docs/SWEEPS.md). Points are numbered from 0; the k-th is computed from its number, so
// a sweep of any size takes no memory for the points it has.
#pragma once
#include <stdint.h>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <sim/sweep_point.hpp>
#include "sweep_axes.hpp"

namespace spantex::tool {

using axis_value = std::pair<const sweep_axis*, std::string>;

struct swept_axis {
  const sweep_axis* axis;
  std::vector<std::string> values;
};

enum class sweep_sample : uint8_t {
  grid,           // every combination
  one_at_a_time,  // the base, then each value of each axis that differs from it
  random,         // so many points, every axis drawn by itself
};

struct sweep_part {
  std::string name;
  sweep_sample sample = sweep_sample::grid;
  std::vector<axis_value> base;
  std::vector<std::string> scenes;  // all points on each of them, scene by scene
  std::vector<swept_axis> axes;     // the last varies fastest
  sim::measure_groups measures;
  uint64_t seed = 1;
  uint64_t points_a_scene = 0;
  std::vector<std::pair<size_t, size_t>> steps;  // one_at_a_time: axis and value of each point but the first

  uint64_t points() const { return points_a_scene * scenes.size(); }
};

struct numbered_point {
  const sweep_part* part;
  sim::sweep_point point;
};

class sweep_spec {
 public:
  // Throws sim::input_error "file:line: reason".
  static sweep_spec parse(const std::string& file, const std::string& text);
  static sweep_spec load(const std::string& file);

  uint64_t points() const { return points_; }
  numbered_point at(uint64_t number) const;
  const std::vector<sweep_part>& parts() const { return parts_; }
  // 16 hexadecimal digits that tell this study from others: of all that its rows depend on.
  const std::string& study() const { return study_; }

 private:
  std::vector<sweep_part> parts_;
  std::string folder_, study_;
  sim::screen_size size_{160, 120};
  uint64_t points_ = 0;
  friend class spec_builder;
};

}  // namespace spantex::tool
