// SPDX-License-Identifier: Apache-2.0
// Write-out (spantex/shade.hpp) of what a kernel drew: a row of spans is drawn aside and mixed into the frame four pixels at once. The same bytes, depths and counts as
// shading::job::write().
#pragma once
#include <stdint.h>

#include <spantex/draw.hpp>
#include <spantex/shade.hpp>
#include "kernel.hpp"

namespace spantex::kernels {

// Whether pixels are stored as a kernel computes them.
inline bool stores_as_computed(const shading::job& j) { return j.alpha == alpha_mode::opaque && !j.modulates; }

class row_write_out {
 public:
  row_write_out(const shading::job& shade, const frame_buffer& frame) : shade_(shade), frame_(frame) {}

  // The row, as it is to be drawn: aside.
  row_work aside(row_work work);

  // Its spans that are not left, into the frame; counts those pixels that were left out or mixed.
  void write(const row_work& drawn, draw_counters& counts) const;

 private:
  static constexpr int32_t stride = max_row_spans * span_side + 16;  // rows of a span in different sets of a cache

  const shading::job& shade_;
  const frame_buffer& frame_;
  alignas(64) rgba8 row_[span_side * stride];  // where the frame has them, x from 0 on
};

}  // namespace spantex::kernels
