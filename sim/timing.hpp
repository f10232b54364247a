// SPDX-License-Identifier: Apache-2.0
// Time in the simulator: cycles of one clock, intervals of them (hal/ownership.hpp), and the table of latencies.
//
// Assumptions of the table
//  1. One clock drives everything. VR11: one pixel a clock, all four channels at once.
//  2. There is one loader port, and loading is sequential (VR11, which does not tell the port's width). The four channels have memories of
//  their
//     own with a 64-bit word each, read side by side; they are loaded side by side too: four words a clock. With one word a clock VR11's
//     40-word copy still loads within the 64 clocks of a span, but the 160 words of 16x16 + 8x8 do not (docs/DESIGN.md "Costs").
//  3. Global texture memory answers a burst (one run of consecutive local words) after burst_start_cycles. Requests queue, as deep as the
//     host likes: the latency of a burst requested while another is streaming is covered by it.
//  4. Coefficients arrive over the same port, ordered with the words.
//  5. Only pixels of the mask enter the pipeline: finding the next set bit costs nothing.
//  6. The pipeline takes the first pixel of a span right behind the last one of the span before; filling it is paid as latency, from the
//     last pixel in to the last pixel out, and that is when the half is free again.
//  7. A bank conflict holds the pipeline for one cycle per extra read of the busiest bank; the channels' memories work in lock step.
//  8. The host issues operations in no time at all, in order, and waits only in take; pixels that it writes itself (skips.hpp: fills and copies)
//     take it host_write_cycles each, while the engine goes on.
#pragma once
#include <stdint.h>

#include <hal/ownership.hpp>
#include <spantex/span.hpp>

namespace spantex::sim {

using spantex::cycle;
using spantex::earlier;
using spantex::interval;
using spantex::later;
using spantex::overlap_cycles;

struct latencies {
  int port_words = 4;              // 64-bit words the loader port moves at once: one a channel
  int cycles_per_transfer = 1;     // of port_words words
  int burst_start_cycles = 4;      // from the request of a burst to its first word
  int coefficient_words = int((sizeof(span_coefficients) - sizeof(axis_terms) - sizeof(contour_terms) + 7) / 8);  // 64-bit words of a span's coefficients
  int axis_words = int((sizeof(axis_terms) + 7) / 8);  // more, for filters with a footprint and contour
  int contour_words = int((sizeof(contour_terms) + 7) / 8);  // more, for filter contour
  int cycles_per_pixel = 1;        // issue rate of the pipeline
  int coordinate_fill_cycles = 6;  // w; three powers of e, or table and two Newton steps; product; snapping and correction
  int fetch_fill_cycles = 1;       // banks and output switch
  int filter_fill_cycles = 3;      // along u, along v, between levels
  int write_out_cycles = 1;        // from the filter to the pixels that take delivers
  int host_write_cycles = 1;       // a pixel that the host writes without the engine

  constexpr cycle transfer_cycles(int words) const {
    return cycle((words + port_words - 1) / port_words) * cycle(cycles_per_transfer);
  }
};

constexpr bool is_valid(const latencies& t) {
  return t.port_words >= 1 && t.cycles_per_transfer >= 1 && t.burst_start_cycles >= 0 && t.coefficient_words >= 0 && t.axis_words >= 0 && t.contour_words >= 0 &&
         t.cycles_per_pixel >= 1 && t.coordinate_fill_cycles >= 0 && t.fetch_fill_cycles >= 0 && t.filter_fill_cycles >= 0 &&
         t.write_out_cycles >= 0 && t.host_write_cycles >= 0;
}

}  // namespace spantex::sim
