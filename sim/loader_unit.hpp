// SPDX-License-Identifier: Apache-2.0
// The loader: one port from global texture memory (and the set-up processor) into the local memories and coefficient memories of both
// halves. Bursts are served in the order of their requests. A burst that finds the port idle waits for its first word; one requested
// while another streams follows it without a gap.
//
//   requests ──► [ queue ] ──► port, port_words x 64 bits ──► half 0: local memory, coefficients
//                                                        └──► half 1: local memory, coefficients
#pragma once
#include <sim/timing.hpp>

namespace spantex::sim {

class loader_unit {
 public:
  explicit loader_unit(const latencies& t) : table_(t) {}

  // When a burst of `words` words, requested at `request`, occupies the port.
  interval load(cycle request, int words) {
    const cycle begin = later(free_at_, request);
    const cycle first_word = later(free_at_, request + cycle(table_.burst_start_cycles));
    free_at_ = first_word + table_.transfer_cycles(words);
    return {begin, free_at_};
  }

  cycle free_at() const { return free_at_; }

 private:
  latencies table_;
  cycle free_at_ = 0;
};

}  // namespace spantex::sim
