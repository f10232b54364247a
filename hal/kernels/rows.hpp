// SPDX-License-Identifier: Apache-2.0
// Planes by a kernel: rows of spans go to it, and what it leaves goes span by span through a renderer. The picture is the same bytes whoever
// draws a span.
#pragma once
#include <stdint.h>

#include <hal/kernels/kernel.hpp>
#include <spantex/draw.hpp>

namespace spantex::kernels {

// Draws the part of the plane in front of the viewer inside `area` of the frame. `texels` is made of the view `t`; profile default, opaque
// pixels, colours as coded. Spans and pixels that the kernel draws are counted in `counts`, the rest in the renderer's own counters.
template <class Renderer, class... How>
status draw_plane(row_kernel kernel, const planar_map& texels, Renderer& scalar, const plane& p, const texture_view& t, filter kind, rectangle area,
                  const frame_buffer& frame, draw_counters& counts, const How&... how) {
  area = intersection(area, {0, 0, frame.width, frame.height});
  if (area.empty()) return status::ok;
  const surface s{&p, &t, kind};
  const int32_t first = area.x0 / span_side;
  const int count = (area.x1 - 1) / span_side - first + 1;
  if (count > max_row_spans) return status::bad_size;
  for (int32_t sy = area.y0 / span_side; sy <= (area.y1 - 1) / span_side; ++sy) {
    span_mask masks[max_row_spans];
    bool left[max_row_spans] = {};
    for (int k = 0; k < count; ++k) masks[k] = rectangle_mask(area, first + k, sy);
    kernel({&p, &texels, kind, t.last_level(), first, sy, count, masks, frame.pixels, frame.stride, left});
    for (int k = 0; k < count; ++k)
      if (left[k]) {
        SPANTEX_TRY(scalar.draw_span(s, first + k, sy, masks[k], how...));
      } else {
        ++counts.spans_total;
        ++counts.jobs;
        counts.pixels += uint64_t(__builtin_popcountll(masks[k]));
      }
  }
  return status::ok;
}

}  // namespace spantex::kernels
