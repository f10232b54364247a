// SPDX-License-Identifier: Apache-2.0
#include "object_space_host.hpp"

#include <math.h>

#include <algorithm>
#include <memory>
#include <utility>

#include <hal/direct_engine.hpp>

namespace spantex::sim {
namespace {

struct shown_polygon {
  std::vector<vertex> corners;
  projection camera;
};

struct screen_position { double x, y, w; };

double w_at(const matrix& m, double x, double y) { return m[6] * x + m[7] * y + m[8]; }

// The part of a convex outline where W is at least, or at most, a limit. A cut is computed from its nearer end, so that both parts get
// the same points.
std::vector<screen_position> cut_at(const matrix& m, const std::vector<screen_position>& in, double limit, bool nearer) {
  std::vector<screen_position> out;
  const auto kept = [&](const screen_position& p) { return nearer ? p.w >= limit : p.w < limit; };
  for (size_t k = 0; k < in.size(); ++k) {
    const screen_position &a = in[k], &b = in[(k + 1) % in.size()];
    if (kept(a)) out.push_back(a);
    if (kept(a) == kept(b)) continue;
    const screen_position &from = a.w >= b.w ? a : b, &to = a.w >= b.w ? b : a;
    const double t = (limit - from.w) / (to.w - from.w), x = from.x + t * (to.x - from.x), y = from.y + t * (to.y - from.y);
    out.push_back({x, y, w_at(m, x, y)});
  }
  return out;
}

using screen_outline = std::vector<screen_position>;

std::pair<double, double> range_of_w(const screen_outline& o) {
  const auto [low, high] = std::minmax_element(o.begin(), o.end(), [](const screen_position& a, const screen_position& b) { return a.w < b.w; });
  return {low->w, high->w};
}

// From the nearest band to the farthest.
std::vector<screen_outline> bands_of(const matrix& m, screen_outline rest, double ratio) {
  std::vector<screen_outline> bands;
  if (rest.empty()) return bands;
  const auto [least, most] = range_of_w(rest);
  const int count = ratio > 1 ? std::max(1, int(ceil(log(most / least) / log(ratio)))) : 1;
  for (int k = 1; k < count; ++k) {
    const double limit = most * pow(least / most, double(k) / count);
    bands.push_back(cut_at(m, rest, limit, true));
    rest = cut_at(m, rest, limit, false);
  }
  bands.push_back(rest);
  return bands;
}

bool within_coordinates(const matrix& m, const std::vector<screen_position>& outline) {
  return std::all_of(outline.begin(), outline.end(), [&](const screen_position& p) {
    const ideal_position t = position(m, p.x, p.y);
    return fabs(t.u) < 30000 && fabs(t.v) < 30000;
  });
}

// The picture's outline, two pixels larger, as far as it is in front.
std::vector<screen_position> plane_outline(const matrix& m, screen_size size) {
  std::vector<screen_position> frame;
  double nearest = 0;
  for (const auto& [x, y] : {std::pair{-2.0, -2.0}, {size.width_px + 2.0, -2.0}, {size.width_px + 2.0, size.height_px + 2.0}, {-2.0, size.height_px + 2.0}}) {
    frame.push_back({x, y, w_at(m, x, y)});
    nearest = std::max(nearest, frame.back().w);
  }
  if (nearest <= 0) return {};
  for (double ratio = 512; ratio > 1; ratio /= 1.25) {
    const std::vector<screen_position> outline = cut_at(m, frame, nearest / ratio, true);
    if (outline.size() >= 3 && within_coordinates(m, outline)) return outline;
  }
  return {};
}

constexpr double farthest = 4096;  // camera units: leaves s15.16 the most significant bits

std::vector<shown_polygon> polygons_of_plane(const matrix& m, screen_size size, double band_ratio) {
  std::vector<shown_polygon> out;
  const screen_outline whole = plane_outline(m, size);
  if (whole.empty()) return out;
  const double fx = size.width_px / 2.0 / tan(20 * M_PI / 180), fy = size.height_px / 2.0 / tan(15 * M_PI / 180);
  const auto [least, most] = range_of_w(whole);
  const projection camera{to_fixed(fx), to_fixed(fy), to_fixed(size.width_px / 2.0), to_fixed(size.height_px / 2.0), to_fixed(farthest * least / most / 2)};
  for (const screen_outline& band : bands_of(m, whole, band_ratio)) {
    shown_polygon polygon{{}, camera};
    for (const screen_position& p : band) {
      const ideal_position t = position(m, p.x, p.y);
      const double z = farthest * least / p.w;
      polygon.corners.push_back({to_fixed((p.x - size.width_px / 2.0) * z / fx), to_fixed((p.y - size.height_px / 2.0) * z / fy), to_fixed(z), to_fixed(t.u), to_fixed(t.v)});
    }
    out.push_back(polygon);
  }
  return out;
}

std::vector<shown_polygon> polygons_of(const drawable& item, screen_size size, double band_ratio) {
  if (item.is_polygon) return {{item.corners, item.camera}};
  return polygons_of_plane(item.plane_matrix, size, band_ratio);
}

template <profile P>
void draw_with(const scene& s, const object_space_options& o, object_space_result& out) {
  using prof = fixed_profile<P>;
  using engine_type = direct_engine<prof>;
  const auto engine = std::make_unique<engine_type>();
  const int width = s.size.width_px, height = s.size.height_px;
  std::vector<pixel_sums> sums(size_t(width) * size_t(o.strip_rows > 0 ? o.strip_rows : height));
  std::vector<uint32_t> depth(s.uses_depth() ? out.picture.pixels.size() : 0, 0);
  const auto r = std::make_unique<object_space_renderer<engine_type, prof>>(*engine, prof{}, frame_buffer{out.picture.pixels.data(), width, height, width}, sums.data(), sums.size());
  const auto draw_one = [&](const drawable& item, const shown_polygon& p) {
    const draw_counters before = r->texturing();
    const status done = r->draw(p.corners.data(), int(p.corners.size()), p.camera, {0, 0, width, height}, s.texture(item), o.kind, o.share, {depth.empty() ? nullptr : depth.data()});
    if (done == status::degenerate || done == status::out_of_range) { ++out.items_left_out; return; }
    if (done != status::ok) throw input_error(s.name + ": " + to_string(done));
    const draw_counters& after = r->texturing();
    const bool two_levels = uses_two_levels(o.kind) && after.second_levels_skipped - before.second_levels_skipped < after.jobs - before.jobs;
    out.texel_reads += (after.pixels - before.pixels) * (o.kind == filter::nearest ? 1 : two_levels ? 8 : 4);
  };
  for (const drawable& item : s.items) {
    const std::vector<shown_polygon> polygons = polygons_of(item, s.size, o.band_ratio);
    out.items_left_out += polygons.empty() ? 1 : 0;
    for (const shown_polygon& p : polygons) draw_one(item, p);
  }
  if (const status done = r->finish(); done != status::ok) throw input_error(s.name + ": " + to_string(done));
  out.samples = r->counters();
  out.texturing = r->texturing();
}

}  // namespace

object_space_result render_object_space(const scene& s, const object_space_options& o) {
  object_space_result out{};
  out.picture = image(s.size.width_px, s.size.height_px, o.background);
  switch (o.profile) {
    case profile_choice::seed: draw_with<profiles::seed>(s, o, out); break;
    case profile_choice::compact: draw_with<profiles::compact>(s, o, out); break;
    case profile_choice::standard: draw_with<profiles::standard>(s, o, out); break;
    case profile_choice::exact: draw_with<profiles::exact>(s, o, out); break;
  }
  return out;
}

}  // namespace spantex::sim
