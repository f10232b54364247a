// SPDX-License-Identifier: Apache-2.0
// Drawing planes on a host: rows of spans go to the fastest kernel this machine has, what it leaves goes span by span through the scalar engine. The
// picture is the same bytes whoever draws a span.
#pragma once
#include <stdint.h>

#include <hal/direct_engine.hpp>
#include <hal/kernels/kernel.hpp>
#include <spantex/draw.hpp>

namespace spantex {

// Profile default. The planar map, made of the same view as is drawn, may be shared between renderers.
class host_renderer {
 public:
  using prof = fixed_profile<profiles::standard>;

  host_renderer(kernels::row_kernel kernel, const frame_buffer& frame) : kernel_(kernel), frame_(frame), scalar_(engine_, prof{}, frame) {}

  status draw(const plane& p, const texture_view& t, const kernels::planar_map& texels, filter kind, rectangle area) {
    area = intersection(area, {0, 0, frame_.width, frame_.height});
    if (area.empty()) return status::ok;
    const surface s{&p, &t, kind};
    const int32_t first = area.x0 / span_side, last = (area.x1 - 1) / span_side;
    for (int32_t sy = area.y0 / span_side; sy <= (area.y1 - 1) / span_side; ++sy)
      for (int32_t sx = first; sx <= last; sx += row_spans) {
        span_mask masks[row_spans];
        const int count = min_of(row_spans, last - sx + 1);
        for (int k = 0; k < count; ++k) masks[k] = rectangle_mask(area, sx + k, sy);
        const kernels::row_result r = kernel_({&p, &texels, kind, t.last_level(), sx, sy, count, masks, frame_.pixels, frame_.stride});
        left_ += uint64_t(__builtin_popcount(r.left));
        for (uint32_t left = r.left; left != 0; left &= left - 1) {
          const int k = __builtin_ctz(left);
          SPANTEX_TRY(scalar_.draw_span(s, sx + k, sy, masks[k]));
        }
      }
    return status::ok;
  }

  status finish() { return scalar_.finish(); }
  uint64_t spans_left() const { return left_; }

 private:
  static constexpr int row_spans = 8;
  kernels::row_kernel kernel_;
  frame_buffer frame_;
  direct_engine<prof> engine_;
  renderer<direct_engine<prof>, prof> scalar_;
  uint64_t left_ = 0;
};

}  // namespace spantex
