// SPDX-License-Identifier: Apache-2.0
// The planes of `spantex bench` by name.
#pragma once

#include <optional>
#include <string>

#include <sim/figures.hpp>
#include <sim/planes.hpp>

namespace spantex::tool {

inline std::optional<sim::matrix> bench_plane(const std::string& name) {
  return name == "close" ? sim::close_plane : name == "far" ? sim::far_plane : name == "horizon" ? sim::horizon_plane : sim::named_plane(name);
}

}  // namespace spantex::tool
