// SPDX-License-Identifier: Apache-2.0
// The planes of `spantex bench`, of 640x480 pixels: the named ones, `close`, magnified five to eight times, and `far`, a wall to the side.
// The divisor is positive over the whole picture: peers clip nothing.
#pragma once

#include <optional>
#include <string>

#include <sim/figures.hpp>

namespace spantex::tool {

inline std::optional<sim::matrix> bench_plane(const std::string& name) {
  if (name == "close") return sim::matrix{0.142, -0.071, 61.3, 0.083, 0.127, 17.9, 0.00021, 0.00033, 0.871};
  if (name == "far") return sim::matrix{1.913, 0.307, 101.7, -0.211, 1.297, 702.3, 0.00115, 0.0001, 0.253};
  return sim::named_plane(name);
}

}  // namespace spantex::tool
