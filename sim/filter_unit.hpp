// SPDX-License-Identifier: Apache-2.0
// The filter unit: the tail of the pipeline. Behind the banks and their output switches it interpolates along u, along v and between
// levels, four channels at once, and writes pixels out at the rate they enter. It never holds the pipeline; it only adds latency.
//
//   64-bit words x 4 channels ─► along u ─► along v ─► between levels ─► write-out ─► pixels of the half
#pragma once
#include <sim/timing.hpp>

namespace spantex::sim {

class filter_unit {
 public:
  explicit filter_unit(const latencies& t) : table_(t) {}

  // From addresses at the banks to the pixel written.
  cycle fill_cycles() const { return cycle(table_.fetch_fill_cycles + table_.filter_fill_cycles + table_.write_out_cycles); }

 private:
  latencies table_;
};

}  // namespace spantex::sim
