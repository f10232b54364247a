// SPDX-License-Identifier: Apache-2.0
// The banks of local texture memory, watched. A fetch reads a 2x2 of the finer and one of the coarser level; each bank has one read
// port, so a bank that is asked for two texels in one fetch answers one cycle late per extra read. The observer sees what
// local_memory's bank map asks for and counts.
//
//   position ──► bank map ──► set 0: [bank 0][bank 1][bank 2][bank 3] ──► switch ──► 4 bytes ┐
//                        └──► set 1: [bank 0][bank 1][bank 2][bank 3] ──► switch ──► 4 bytes ┴─► 64-bit word
#pragma once
#include <stdint.h>

#include <spantex/span.hpp>

namespace spantex::sim {

inline constexpr int set_count = 2, bank_count = 4;

struct bank_totals {
  uint64_t fetches = 0;
  uint64_t conflicts = 0;    // fetches with an extra read
  uint64_t extra_reads = 0;  // reads beyond the first of the busiest bank, summed over fetches
};

// Models the observer of local_memory::fetch, which is called on a constant: the totals live outside.
class bank_observer {
 public:
  explicit bank_observer(bank_totals& totals) : totals_(&totals) {}

  void fetch_begin() const {
    ++totals_->fetches;
    busiest_ = 0;
    for (int k = 0; k < set_count * bank_count; ++k) reads_[k] = 0;
  }
  void bank_read(int set, int bank, int /*address*/) const {
    const int reads = ++reads_[set * bank_count + (bank & (bank_count - 1))];
    if (reads <= 1 || reads <= busiest_) return;
    if (busiest_ == 0) ++totals_->conflicts;
    busiest_ = reads;
    ++totals_->extra_reads;
  }

  // How often a bank was read in the fetch under way.
  int reads(int set, int bank) const { return reads_[set * bank_count + bank]; }

 private:
  bank_totals* totals_;
  mutable int reads_[set_count * bank_count] = {};
  mutable int busiest_ = 0;
};

// Cycles the pipeline is held: all channels are read with the same addresses at the same time.
constexpr uint64_t held_cycles(const bank_totals& t) { return t.extra_reads / channel_count; }

}  // namespace spantex::sim
