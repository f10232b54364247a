// SPDX-License-Identifier: Apache-2.0
// The coordinate unit with its correction: the head of the pipeline. It takes the pixels of a mask, one every cycles_per_pixel, and sends
// local addresses to the banks. A span enters when the last pixel of the span before has entered; bank conflicts hold it.
//
//   coefficients ─► n, e ─┬─► q (series) ──► n - n q ─┬─► u, v, level ─► correction ─► local addresses
//   mask ─► next set bit ┘ └─► 1/w (divide) ► n r ────┘
//
// Multipliers that a pixel's u and v take:
//              16x16 -> 32                       32x32 -> 64 (16x16 -> 32 in profiles of 16-bit reciprocals)
//   affine     -                                 -
//   series     terms - 1 powers of e, 2 for n q  -
//   divide     -                                 4 (2) of Newton's iteration, 2 for n r
// log2 w takes two of 16x16 (e e, and the constant) where |e| < 2^-4, the table's one elsewhere.
#pragma once
#include <stdint.h>

#include <sim/timing.hpp>

namespace spantex::sim {

class coordinate_unit {
 public:
  explicit coordinate_unit(const latencies& t) : table_(t) {}

  // When a span of `samples` samples (pixels, or the samples of their footprints), ready at `ready` and held for `held_cycles`, enters.
  interval issue(cycle ready, int samples, cycle held_cycles) {
    const cycle begin = later(free_at_, ready);
    free_at_ = begin + cycle(samples) * cycle(table_.cycles_per_pixel) + held_cycles;
    return {begin, free_at_};
  }

  // From a pixel's entry to its addresses.
  cycle fill_cycles() const { return cycle(table_.coordinate_fill_cycles); }
  cycle free_at() const { return free_at_; }

 private:
  latencies table_;
  cycle free_at_ = 0;
};

}  // namespace spantex::sim
