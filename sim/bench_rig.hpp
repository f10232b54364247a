// SPDX-License-Identifier: Apache-2.0
// Rig files: where the bench's wires are, JSON (docs/BENCH.md). Lines by name, or by offset as a number.
#pragma once
#include <string>

#include <hal/bench_link.hpp>
#include <hal/gpiod_lines.hpp>

namespace spantex::sim {

struct bench_rig {
  gpiod_rig gpio;
  bench_limits limits{.spin_ns = 200'000};  // waking up from an edge takes longer than most devices
  uint64_t settle_ns = 5'000'000;  // self-test: the device's longest time to follow a change of the lines
};

// Throws input_error that names the file and what is wrong: unreadable, not JSON, a key unknown, missing, twice or of the wrong kind, a line used twice.
bench_rig load_rig(const std::string& path);

}  // namespace spantex::sim
