// SPDX-License-Identifier: Apache-2.0
// The axes of sweeps: every number and choice of a point by name, with its range and how it is written.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <sim/sweep_point.hpp>

namespace spantex::tool {

struct sweep_axis {
  std::string_view name, unit;
  int low = 0, high = 0;                 // of whole numbers
  std::vector<std::string_view> names;   // of choices; empty for whole numbers and texts
  bool is_text = false;                  // a name or a file
  std::string (*get)(const sim::sweep_point&) = nullptr;
  void (*set)(sim::sweep_point&, const std::string&) = nullptr;  // of a value that `why_not` passes
};

// In the order of the record's columns, which is the order they are applied in: a profile first, then what differs from it.
const std::vector<sweep_axis>& sweep_axes();
const sweep_axis* find_axis(std::string_view name);

// Why a value will not do, or nothing.
std::optional<std::string> why_not(const sweep_axis& axis, const std::string& value);

}  // namespace spantex::tool
