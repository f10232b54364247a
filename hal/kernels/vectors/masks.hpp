// SPDX-License-Identifier: Apache-2.0
// cover_row() of masks.hpp, in a namespace that has, of spans_at_once spans of a row from span k on,
//   empty(p, row, k)          bits of those that lie outside of an edge
//   hidden(p, row, k, count)  bits of those that are nowhere nearer than their floors, which there are for `count` of them
// and of a span
//   class pixel_lanes         what the two below take of the polygon; made by prepare(p), which may be called again
//   covered(p, row, lanes, k)                its pixels inside of all edges
//   nearer(p, lanes, depth, sx, sy, mask)    depth_test(), where it lies within the frame and its depths, which is the first one, do not saturate

// What is visible of span (sx, sy), the row's span k of so many, where edges do not say that it is empty.
span_mask visible_of(const masked_polygon& p, const masked_row& row, const pixel_lanes& lanes, int k, int count, int32_t sx, int32_t sy, draw_counters& counts) {
  span_mask mask = covered(p, row, lanes, k) & row.rows;
  if (k == 0) mask &= p.first_columns;
  if (k == count - 1) mask &= p.last_columns;
  if (mask == 0) { ++counts.spans_empty; return 0; }
  if (!p.in_front) mask &= front_mask(p.shape.map, sx, sy);
  if (mask == 0) { ++counts.spans_behind; return 0; }
  if (p.depth.values == nullptr) return mask;
  const bool whole = (sx + 1) * span_side <= p.frame_width && (sy + 1) * span_side <= p.frame_height;
  if (!whole || row.saturates(p, k)) mask = depth_test(p.shape, sx, sy, mask, p.depth, p.frame_width, p.stores);
  else mask = nearer(p, lanes, row.depth_of(p, k), sx, sy, mask);
  counts.spans_hidden += mask == 0;
  return mask;
}

void cover_row(const masked_polygon& p, int32_t sy, const bool* leaves, row_masks& out, draw_counters& counts) {
  const int32_t first = p.first_span(), count = p.span_count();
  const masked_row row(p, sy);
  pixel_lanes lanes;
  out.from = count;
  out.to = 0;
  counts.spans_total += uint64_t(count);
  for (int k = 0; k < count; k += spans_at_once) {
    const int some = min_of(spans_at_once, count - k);
    uint32_t wanted = (1u << some) - 1;
    for (int n = 0; n < spans_at_once; ++n) out.mask[k + n] = 0;
    for (int n = 0; leaves != nullptr && n < some; ++n)
      if (leaves[k + n]) wanted &= ~(1u << n);
    if (leaves != nullptr) counts.spans_total -= uint64_t(some - __builtin_popcount(wanted));
    const uint32_t outside = empty(p, row, k) & wanted, hiding = hidden(p, row, k, some) & wanted & ~outside;
    counts.spans_empty += uint64_t(__builtin_popcount(outside));
    counts.spans_hidden += uint64_t(__builtin_popcount(hiding));
    wanted &= ~(outside | hiding);
    if (wanted == 0) continue;
    lanes.prepare(p);
    do {
      const int n = k + __builtin_ctz(wanted);
      const span_mask mask = visible_of(p, row, lanes, n, count, first + n, sy, counts);
      if (mask == 0) continue;
      out.mask[n] = mask;
      out.from = min_of(out.from, n);
      out.to = n + 1;
      ++counts.jobs;
      counts.pixels += uint64_t(__builtin_popcountll(mask));
    } while ((wanted &= wanted - 1) != 0);
  }
}
