// SPDX-License-Identifier: Apache-2.0
#include "occlusion.hpp"

#include <algorithm>

namespace spantex::sim {
namespace {

int spans_of(int px) { return (px + span_side - 1) / span_side; }

// Whether a triangle is less than a quarter of a span: only together with many others it would cover one, which what these hide is seldom worth.
bool is_small(const polygon& p) {
  if (p.edges.count != 3) return false;
  constexpr int64_t least_area = span_side * span_side / 4;
  const edge &e = p.edges.edges[0], &f = p.edges.edges[1];
  return int64_t(magnitude(e.a * f.b - f.a * e.b)) < (2 * least_area) << (2 * subpixel_bits);
}

}  // namespace

occlusion::occlusion(screen_size size)
    : size_(size), floors_(size_t(spans_of(size.width_px)) * size_t(spans_of(size.height_px))), parts_(floors_.size()) {}

bool occlusion::hides(const vertex* corners, int count, const lens& view) const {
  return count == 3 && is_hidden(corners, view.camera, view.clip, floors_.data(), size_.width_px, size_.height_px);
}

void occlusion::add(const polygon& p, int band, int bands) {
  const auto begin_of = [&](int k) { return std::min(spans_of(size_.height_px) * k / bands * span_side, size_.height_px); };
  const rectangle area = intersection(p.box, {0, begin_of(band), size_.width_px, begin_of(band + 1)});
  if (area.empty() || is_small(p)) return;
  const kernels::masked_polygon masked(p, area, {nullptr, floors_.data()}, size_.width_px, size_.height_px, false);
  for (int32_t sy = area.y0 / span_side; sy <= (area.y1 - 1) / span_side; ++sy) {
    kernels::row_masks row;
    draw_counters ignored;
    cover_(masked, sy, nullptr, row, ignored);
    for (int k = row.from; k < row.to; ++k) {
      const span_mask mask = row.mask[k];
      if (mask == 0) continue;
      const int32_t sx = masked.first_span() + k;
      const size_t at = size_t(sy) * size_t(spans_of(size_.width_px)) + size_t(sx);
      const uint32_t least = depth_range_of(p, sx, sy).least;
      part& together = parts_[at];
      together.covered |= mask;
      together.least = std::min(together.least, least);
      if (mask == full_mask) floors_[at] = std::max(floors_[at], least);
      if (together.covered != full_mask) continue;
      floors_[at] = std::max(floors_[at], together.least);
      together = {};
    }
  }
}

}  // namespace spantex::sim
