// SPDX-License-Identifier: Apache-2.0
#include "unchanged.hpp"

#include <algorithm>
#include <utility>

#include <spantex/bits.hpp>

namespace spantex::sim {
namespace {

int32_t spans(int px) { return (px + span_side - 1) / span_side; }

// Whether pixels come from the same arithmetic. Engine, kernel, threads and skips change none.
bool draw_alike(const draw_options& a, const draw_options& b) {
  return a.profile == b.profile && a.changes == b.changes && a.kind == b.kind && a.how.alpha == b.how.alpha && a.how.threshold == b.how.threshold && a.how.colour == b.how.colour &&
         a.how.colours == nullptr && b.how.colours == nullptr && a.threshold == b.threshold && a.field_scale == b.field_scale && a.outline == b.outline && a.background == b.background;
}

bool read_alike(const texture_map& a, const texture_map& b) {
  return a.view_on_demand().colours() == b.view_on_demand().colours() && a.view_on_demand().contour() == b.view_on_demand().contour();
}

bool draws_alike(const drawable& a, const drawable& b) { return a.is_polygon == b.is_polygon && a.shape == b.shape && a.colours == b.colours; }

SPANTEX_WRAPS uint64_t hash_of(const drawable& d) {
  uint64_t h = 0;
  for (const linear_form& f : {d.shape.map.u, d.shape.map.v, d.shape.map.w})
    for (const int64_t x : {f.x, f.y, f.c}) h = (h ^ uint64_t(x)) * 0x9E3779B97F4A7C15u;
  return h;
}

// Surfaces of one frame that the other has too, in the same order.
struct common_surfaces { std::vector<bool> before, now; bool any = false; };

// As many as there can be: of pairs in the order of the one frame, the longest run that ascends in the other.
common_surfaces in_order(const std::vector<int>& partner, size_t before_count) {
  common_surfaces common{std::vector<bool>(before_count), std::vector<bool>(partner.size())};
  std::vector<int> ends, previous(partner.size(), -1);  // [n]: where the run of n + 1 pairs ends that ends soonest
  for (int k = 0; k < int(partner.size()); ++k) {
    if (partner[size_t(k)] < 0) continue;
    const auto at = std::lower_bound(ends.begin(), ends.end(), k, [&](int a, int b) { return partner[size_t(a)] < partner[size_t(b)]; });
    if (at != ends.begin()) previous[size_t(k)] = at[-1];
    if (at == ends.end()) ends.push_back(k);
    else *at = k;
  }
  for (int k = ends.empty() ? -1 : ends.back(); k >= 0; k = previous[size_t(k)]) {
    common.any = common.now[size_t(k)] = true;
    common.before[size_t(partner[size_t(k)])] = true;
  }
  return common;
}

surface_places places_of(const std::vector<drawable>& items) {
  surface_places places;
  places.first.reserve(items.size());
  places.next.assign(items.size(), -1);
  for (int k = int(items.size()) - 1; k >= 0; --k) {
    const auto [place, is_new] = places.first.try_emplace(hash_of(items[size_t(k)]), k);
    if (!is_new) places.next[size_t(k)] = std::exchange(place->second, k);
  }
  return places;
}

template <class Alike>
common_surfaces common_of(const std::vector<drawable>& before, const surface_places& places, const std::vector<drawable>& now, Alike alike) {
  std::vector<bool> taken(before.size());
  std::vector<int> partner;
  for (const drawable& d : now) {
    const auto place = places.first.find(hash_of(d));
    int k = place == places.first.end() ? -1 : place->second;
    while (k >= 0 && (taken[size_t(k)] || !alike(before[size_t(k)], d))) k = places.next[size_t(k)];
    if (k >= 0) taken[size_t(k)] = true;
    partner.push_back(k);
  }
  return in_order(partner, before.size());
}

}  // namespace

// Whether the surface decides, or would, a pixel of the span as it is.
bool frame_before::shows(const drawable& item, int32_t sx, int32_t sy) const {
  if (!item.is_polygon) return true;
  const polygon& p = item.shape;
  span_mask mask = coverage(p.edges, sx, sy) & rectangle_mask(p.box, sx, sy);
  if (mask != 0) mask &= front_mask(p.map, sx, sy);
  if (options_.how.alpha != alpha_mode::opaque || depth_.values.empty()) return mask != 0;
  for (; mask != 0; mask &= mask - 1) {
    const int k = __builtin_ctzll(mask);
    const int32_t x = sx * span_side + k % span_side, y = sy * span_side + k / span_side;
    if (depth_at(p, 2 * x + 1, 2 * y + 1) >= depth_.values[size_t(y) * size_t(picture_.width_px) + size_t(x)]) return true;
  }
  return false;
}

std::vector<uint8_t> frame_before::unchanged(const scene& s, const draw_options& o) const {
  const bool same_frame = picture_.width_px == s.size.width_px && picture_.height_px == s.size.height_px && draw_alike(options_, o) && scene_.uses_depth() == s.uses_depth();
  if (!same_frame) return {};
  std::vector<int8_t> maps_alike(s.maps->size(), -1);  // by the map now: not known, no, yes
  const auto map_alike = [&](size_t before, size_t now) {
    if (before != now || before >= serials_.size()) return false;
    const texture_map &a = (*scene_.maps)[before], &b = (*s.maps)[now];
    if (maps_alike[now] < 0) maps_alike[now] = a.serial() == serials_[before] && read_alike(a, b) && (a.serial() == b.serial() || same_texels(a, b));
    return maps_alike[now] != 0;
  };
  const common_surfaces common = common_of(scene_.items, places_, s.items, [&](const drawable& a, const drawable& b) {
    return draws_alike(a, b) && map_alike(size_t(a.map_index), size_t(b.map_index));
  });
  if (!common.any) return {};
  const int32_t columns = spans(s.size.width_px), rows = spans(s.size.height_px);
  std::vector<uint8_t> kept(size_t(columns) * size_t(rows), 1);
  const auto mark = [&](const drawable& item) {
    const rectangle all{0, 0, s.size.width_px, s.size.height_px}, box = item.is_polygon ? intersection(item.shape.box, all) : all;
    if (box.empty()) return;
    for (int32_t sy = box.y0 / span_side; sy <= (box.y1 - 1) / span_side; ++sy)
      for (int32_t sx = box.x0 / span_side; sx <= (box.x1 - 1) / span_side; ++sx) {
        uint8_t& keeps = kept[size_t(sy) * size_t(columns) + size_t(sx)];
        if (keeps != 0 && shows(item, sx, sy)) keeps = 0;
      }
  };
  for (size_t k = 0; k < s.items.size(); ++k)
    if (!common.now[k]) mark(s.items[k]);
  for (size_t k = 0; k < scene_.items.size(); ++k)
    if (!common.before[k]) mark(scene_.items[k]);
  return kept;
}

void frame_before::keep(const scene& s, const draw_options& o, const image& picture, const frame_depths& depth) {
  scene_ = s;
  places_ = places_of(scene_.items);
  options_ = o;
  options_.parts_done = nullptr;
  options_.team = nullptr;
  serials_.clear();
  for (const texture_map& map : *s.maps) serials_.push_back(map.serial());
  picture_ = picture;
  depth_ = depth;
}

}  // namespace spantex::sim
