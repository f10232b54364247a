// SPDX-License-Identifier: Apache-2.0
// Tests the bench's wires through the echo that a device in reset gives (docs/BENCH.md): no frame has to get through. What comes back is compared with a
// dictionary of what every single fault would give, found by the same steps on simulated wires: each line stuck low or high, each pair bridged or
// exchanged.
#pragma once
#include <stdint.h>

#include <string>
#include <vector>

#include <hal/bench_lines.hpp>
#include <sim/bench_wires.hpp>

namespace spantex::sim {

struct line_report {
  status result = status::ok;           // device_error: the chip refused a call; mismatch: the wires are not sound
  int steps = 0;                        // levels compared
  std::vector<std::string> symptoms;    // what came back otherwise, one line each
  std::vector<std::string> suspects;    // the single faults that explain them best; "no device" may be one
  int unexplained = 0;                  // levels that differ even so: more than a few mean several faults
};

// `settle_ns`: how long the device may take to follow a change of the lines. Leaves every line an input.
line_report test_lines(bench_lines& lines, uint64_t settle_ns);

// The faults of the dictionary that wires of this width can have.
std::vector<wire_fault> single_line_faults(int data_bits);
std::string short_text(const wire_fault& f);

}  // namespace spantex::sim
