// SPDX-License-Identifier: Apache-2.0
// Planes and polygons by a kernel: rows of spans go to it, and what it leaves is drawn pixel by pixel. The picture is the same bytes whoever draws a span.
#pragma once
#include <stdint.h>

#include <algorithm>
#include <optional>

#include <hal/kernels/by_pixel.hpp>
#include <hal/kernels/kernel.hpp>
#include <hal/kernels/masks.hpp>
#include <hal/kernels/shortcuts.hpp>
#include <hal/kernels/upright.hpp>
#include <hal/kernels/write_out.hpp>
#include <spantex/draw.hpp>

namespace spantex::kernels {

namespace detail {

// Where a row is drawn, aside(), and what then becomes of it, write(): here pixels are stored as they are computed; row_write_out otherwise.
struct in_place {
  row_work aside(const row_work& work) const { return work; }
  void write(const row_work&, draw_counters&) const {}
};

// What rows of spans of an area have in common.
struct of_all_rows {
  shortcut everywhere;
  upright_plane upright;
  of_all_rows(const surface& s, const planar_map& texels, rectangle area) : everywhere(shortcut_of(s, texels, area)), upright(s, area) {}
};

// What is left of a row of spans, pixel by pixel: by the kernel, what it can, and else by the specification's own functions. None of it counts as the kernel's job.
template <class Out>
void draw_left(row_kernel kernel, const row_work& row, const surface& s, const profile& numbers, draw_counters& counts, Out&& out) {
  bool* const end = row.left + row.count;
  bool* at = next_left(row.left, end);
  if (at == nullptr) return;
  span_mask in_front[max_row_spans];
  row_work rest = row;
  rest.by_pixel = true;
  rest.sx += int32_t(at - row.left);
  rest.masks = in_front;
  rest.left = at;
  for (rest.count = 0; at != end; ++at, ++rest.count) {
    const span_mask wanted = *at ? row.masks[at - row.left] : 0;
    in_front[rest.count] = wanted == 0 ? 0 : wanted & front_mask(*s.map, rest.sx + rest.count, row.sy);
    if (wanted == 0) continue;
    --counts.jobs;
    counts.pixels -= uint64_t(__builtin_popcountll(wanted & ~in_front[rest.count]));
    if (in_front[rest.count] != 0) continue;
    ++counts.spans_behind;
    *at = false;
  }
  if (next_left(rest.left, end) == nullptr) return;
  kernel(rest);
  out.write(rest, counts);
  for (at = rest.left; (at = next_left(at, end)) != nullptr; ++at) {
    *at = false;
    row_work one = rest;
    one.sx += int32_t(at - rest.left);
    one.count = 1;
    one.masks += at - rest.left;
    one.left = at;
    draw_by_pixel(s, *row.texels, numbers, one.sx, one.sy, *one.masks, one.pixels, one.stride);
    out.write(one, counts);
  }
}

// Rows of spans of an area within the frame, not empty: `cover` makes the masks of row sy of those of the row before; the kernel draws, `out` writes, and so with what is left.
template <class Cover, class Out>
status draw_rows_to(row_kernel kernel, const planar_map& texels, const profile& numbers, const surface& s, rectangle area, const frame_buffer& frame, draw_counters& counts, Cover cover, Out&& out) {
  const int32_t first = first_span(area);
  const int count = span_count(area);
  if (count > max_row_spans) return status::bad_size;
  const bool by_pixel = kernel == leave_to_pixels;  // of any numbers: shortcuts and scaled planes are of profile default's
  std::optional<of_all_rows> all;  // once something is seen, and not by pixel
  row_memory memory;
  row_masks row;
  bool left[max_row_spans];
  std::fill_n(left, count, false);
  for (int32_t sy = area.y0 / span_side; sy <= (area.y1 - 1) / span_side; ++sy) {
    cover(sy, row);
    if (row.from >= row.to) continue;
    if (!all && !by_pixel) all.emplace(s, texels, area);
    const int32_t y = sy * span_side;
    row_work work = out.aside({s.map, &texels, s.kind, s.texture->last_level(), first + row.from, sy, row.to - row.from, row.mask + row.from,
                               frame.pixels + int64_t(y) * frame.stride, frame.stride, left + row.from});
    work.most_ratio = log2_16(uint64_t(numbers.max_samples));
    shortcut known;
    if (all) known = all->everywhere.how != shortcut::way::none ? all->everywhere : shortcut_of(s, texels, intersection(area, {area.x0, y, area.x1, y + span_side}));
    if (known.how != shortcut::way::none) {
      draw_by(known, work);
      out.write(work, counts);
      continue;
    }
    work.memory = &memory;
    if (all && !in_linear_light(texels, s.kind)) work.upright = all->upright.row(sy);
    kernel(work);
    out.write(work, counts);
    draw_left(kernel, work, s, numbers, counts, out);
  }
  return status::ok;
}

template <class Shading, class Cover>
status draw_rows(row_kernel kernel, const planar_map& texels, const profile& numbers, const surface& s, rectangle area, const frame_buffer& frame, draw_counters& counts, Cover cover,
                 [[maybe_unused]] const typename Shading::job& shade) {
  if constexpr (Shading::enabled)
    if (!stores_as_computed(shade)) return draw_rows_to(kernel, texels, numbers, s, area, frame, counts, cover, row_write_out(shade, frame));
  return draw_rows_to(kernel, texels, numbers, s, area, frame, counts, cover, in_place{});
}

}  // namespace detail

// Draws the part of the plane in front of the viewer inside `area` of the frame. `texels` is made of the view `t`. Of the renderer `scalar` what counts is its numbers, by which the kernel
// draws(), and what it keeps; it may hold nothing that is still computing. Maps whose texels are opaque are drawn so whatever their facts say: nothing of them counts as blended. Counted are
// spans looked at and behind the viewer, pixels drawn, and as jobs the spans that the kernel drew itself. Errors: out_of_range for filters that no kernel draws().
template <class Renderer>
status draw_plane(row_kernel kernel, const planar_map& texels, const Renderer& scalar, const plane& p, const texture_view& t, filter kind, rectangle area,
                  const frame_buffer& frame, draw_counters& counts, const typename Renderer::shading_type& how = {}) {
  if (!draws(kind)) return status::out_of_range;
  area = intersection(area, {0, 0, frame.width, frame.height});
  if (area.empty()) return status::ok;
  const int32_t first = first_span(area);
  const int count = span_count(area);
  span_mask filled = 0;  // what the row before has in all spans but the ends; 0 where some are kept
  const auto cover_all = [&](int32_t sy, row_masks& out) {
    const int32_t y0 = max_of(area.y0, sy * span_side), y1 = min_of(area.y1, (sy + 1) * span_side);
    counts.spans_total += uint64_t(count);
    counts.jobs += uint64_t(count);
    counts.pixels += uint64_t(area.x1 - area.x0) * uint64_t(y1 - y0);
    out.from = 0;
    out.to = count;
    const span_mask inside = rectangle_mask({0, y0, span_side, y1}, 0, sy);
    if (inside == filled) return;
    std::fill(out.mask, out.mask + count, inside);
    out.mask[0] = rectangle_mask(area, first, sy);
    out.mask[count - 1] = rectangle_mask(area, first + count - 1, sy);
    if (!scalar.keeps_some()) {
      filled = inside;
      return;
    }
    for (int k = 0; k < count; ++k) {
      if (!scalar.keeps(first + k, sy)) continue;
      --counts.spans_total;
      --counts.jobs;
      counts.pixels -= uint64_t(__builtin_popcountll(out.mask[k]));
      out.mask[k] = 0;
    }
  };
  // And leaves out those behind the viewer at the row's ends: W is linear, and largest at one of a span's corners.
  const auto cover = [&](int32_t sy, row_masks& out) {
    cover_all(sy, out);
    const int32_t hx = 2 * span_side * first + (p.w.x > 0 ? 2 * span_side - 1 : 1), hy = 2 * span_side * sy + (p.w.y > 0 ? 2 * span_side - 1 : 1);
    const auto is_behind = [&](int k) {
      if (p.w_at(hx + 2 * span_side * k, hy) > 0) return false;
      if (out.mask[k] == 0) return true;  // kept
      --counts.jobs;
      ++counts.spans_behind;
      counts.pixels -= uint64_t(__builtin_popcountll(out.mask[k]));
      return true;
    };
    while (out.from < out.to && is_behind(out.from)) ++out.from;
    while (out.from < out.to && is_behind(out.to - 1)) --out.to;
  };
  auto shade = how.of(p);
  if (texels.opaque()) shade.without_alpha();
  return detail::draw_rows<typename Renderer::shading_type>(kernel, texels, scalar.numbers(), surface{&p, &t, kind}, area, frame, counts, cover, shade);
}

// lay_depths() (visibility.hpp) of the part of a polygon inside `area`, by vectors.
template <class Leaves>
uint64_t lay_depths(row_cover visible, const polygon& p, rectangle area, depth_buffer depth, int32_t frame_width, int32_t frame_height, Leaves leaves) {
  area = intersection(intersection(p.box, area), {0, 0, frame_width, frame_height});
  if (area.empty()) return 0;
  const masked_polygon masked(p, area, depth, frame_width, frame_height, true);
  draw_counters counts;
  row_masks row;
  bool left[max_row_spans];
  for (int32_t sy = area.y0 / span_side; sy <= (area.y1 - 1) / span_side; ++sy) {
    for (int k = 0; k < masked.span_count(); ++k) left[k] = leaves(masked.first_span() + k, sy);
    visible(masked, sy, left, row, counts);
  }
  return counts.spans_total;
}

// Draws the part of a polygon inside `area`, hidden parts left out. `visible` makes the masks. The same otherwise.
template <class Renderer>
status draw_polygon(row_kernel kernel, row_cover visible, const planar_map& texels, const Renderer& scalar, const polygon& p, const texture_view& t, filter kind, rectangle area,
                    depth_buffer depth, const frame_buffer& frame, draw_counters& counts, const typename Renderer::shading_type& how = {}) {
  if (!draws(kind)) return status::out_of_range;
  auto shade = how.of(p, depth.values);
  const bool stores_depth = (texels.opaque() && shade.without_alpha()) || how.stores_depth_first();
  area = intersection(intersection(p.box, area), {0, 0, frame.width, frame.height});
  if (area.empty()) return status::ok;
  const masked_polygon masked(p, area, depth, frame.width, frame.height, stores_depth);
  const bool keeps = scalar.keeps_some();
  bool leaves[max_row_spans];
  const auto cover = [&](int32_t sy, row_masks& out) {
    for (int k = 0; keeps && k < masked.span_count(); ++k) leaves[k] = scalar.keeps(masked.first_span() + k, sy);
    visible(masked, sy, keeps ? leaves : nullptr, out, counts);
  };
  return detail::draw_rows<typename Renderer::shading_type>(kernel, texels, scalar.numbers(), surface{&p.map, &t, kind}, area, frame, counts, cover, shade);
}

}  // namespace spantex::kernels
