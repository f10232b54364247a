// SPDX-License-Identifier: Apache-2.0
// What the simulator counts. Cycles are of the clock of sim/timing.hpp; everything counts from the engine's construction.
#pragma once
#include <stdint.h>

#include <sim/timing.hpp>

namespace spantex::sim {

struct counters {
  cycle total_cycles = 0;         // until the last load or compute ends
  cycle load_cycles = 0;          // the loader is busy: latency of bursts that nothing covers, words, coefficients
  cycle compute_cycles = 0;       // the pipeline takes pixels or is held by a bank conflict
  cycle hidden_load_cycles = 0;   // of load_cycles: while the pipeline takes pixels of the other half
  cycle stall_cycles = 0;         // the pipeline could take a pixel but waits for loading, from the first start to the last
  uint64_t words_loaded = 0;      // 64-bit words into local memory
  uint64_t fetches = 0;           // 64-bit words out of local memory: one per channel per sample
  uint64_t texel_reads = 0;       // texels that samples use: 1 nearest, 3 three-point, 4 others, on each level
  uint64_t bank_conflicts = 0;    // fetches that needed a bank more than once
  uint64_t jobs = 0;              // starts
  uint64_t pixels = 0;

  constexpr cycle visible_load_cycles() const { return load_cycles - hidden_load_cycles; }
};

}  // namespace spantex::sim
