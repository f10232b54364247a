// SPDX-License-Identifier: Apache-2.0
// The simulator's ownership check: the guard of hal/ownership.hpp, which devices have too, with room for what it refused, and words for it.
#pragma once
#include <string>

#include <hal/ownership.hpp>

namespace spantex::sim {

using ownership_guard = half_ownership<16>;

inline std::string text_of(const violation& v) {
  std::string s = std::string(to_string(v.what)) + " of half " + std::to_string(int(v.which)) + " at cycle " + std::to_string(v.at) + ": " +
                  to_string(v.result);
  if (v.computing.end != 0)
    s += " (last computing in cycles " + std::to_string(v.computing.begin) + " to " + std::to_string(v.computing.end) + ")";
  return s;
}

}  // namespace spantex::sim
