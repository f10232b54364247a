// SPDX-License-Identifier: Apache-2.0
// Planes and polygons by a kernel: rows of spans go to it, and what it leaves goes span by span through a renderer. The picture is the same bytes whoever
// draws a span.
#pragma once
#include <stdint.h>

#include <algorithm>

#include <hal/kernels/kernel.hpp>
#include <spantex/draw.hpp>

namespace spantex::kernels {

// Draws the part of the plane in front of the viewer inside `area` of the frame. `texels` is made of the view `t`; profile default, opaque
// pixels, colours as coded. Spans looked at are counted in `counts`, and jobs and pixels of the kernel; those of
// the rest in the renderer's own counters.
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
    const rectangle row{area.x0, max_of(area.y0, sy * span_side), area.x1, min_of(area.y1, (sy + 1) * span_side)};
    std::fill(masks, masks + count, rectangle_mask({0, row.y0, span_side, row.y1}, 0, sy));
    masks[0] = rectangle_mask(row, first, sy);
    masks[count - 1] = rectangle_mask(row, first + count - 1, sy);
    kernel({&p, &texels, kind, t.last_level(), first, sy, count, masks, frame.pixels, frame.stride, left});
    uint64_t drawn = uint64_t(count), pixels = uint64_t(row.x1 - row.x0) * uint64_t(row.y1 - row.y0);
    for (int k = 0; k < count; ++k) {
      if (!left[k]) continue;
      --drawn;
      pixels -= uint64_t(__builtin_popcountll(masks[k]));
      SPANTEX_TRY(scalar.draw_span(s, first + k, sy, masks[k], how...));
    }
    counts.spans_total += uint64_t(count);
    counts.jobs += drawn;
    counts.pixels += pixels;
  }
  return status::ok;
}

// Draws a polygon, hidden parts left out, opaque. The same otherwise; `scalar` must hold nothing that is still computing, and holds nothing afterwards.
template <class Renderer, class... How>
status draw_polygon(row_kernel kernel, const planar_map& texels, Renderer& scalar, const polygon& p, const texture_view& t, filter kind, depth_buffer depth,
                    const frame_buffer& frame, draw_counters& counts, const How&... how) {
  const rectangle area = intersection(p.box, {0, 0, frame.width, frame.height});
  if (area.empty()) return status::ok;
  const surface s{&p.map, &t, kind};
  const int32_t first = area.x0 / span_side;
  const int count = (area.x1 - 1) / span_side - first + 1;
  if (count > max_row_spans) return status::bad_size;
  for (int32_t sy = area.y0 / span_side; sy <= (area.y1 - 1) / span_side; ++sy) {
    span_mask masks[max_row_spans];
    bool left[max_row_spans] = {};
    int from = count, to = 0;  // spans with something to draw
    for (int k = 0; k < count; ++k) {
      ++counts.spans_total;
      span_mask& mask = masks[k];
      mask = coverage(p.edges, first + k, sy);
      if (mask != 0) mask &= rectangle_mask(area, first + k, sy);
      if (mask == 0) { ++counts.spans_empty; continue; }
      mask &= front_mask(p.map, first + k, sy);
      if (mask == 0) { ++counts.spans_behind; continue; }
      if (depth.values != nullptr) mask = depth_test(p, first + k, sy, mask, depth, frame.width, true);
      if (mask == 0) { ++counts.spans_hidden; continue; }
      from = min_of(from, k);
      to = k + 1;
      ++counts.jobs;
      counts.pixels += uint64_t(__builtin_popcountll(mask));
    }
    if (from >= to) continue;
    kernel({&p.map, &texels, kind, t.last_level(), first + from, sy, to - from, masks + from, frame.pixels, frame.stride, left + from});
    for (int k = from; k < to; ++k) {
      if (!left[k]) continue;
      --counts.jobs;
      counts.pixels -= uint64_t(__builtin_popcountll(masks[k]));
      SPANTEX_TRY(scalar.draw_span(s, first + k, sy, masks[k], how...));
    }
  }
  return scalar.flush();
}

}  // namespace spantex::kernels
