// SPDX-License-Identifier: Apache-2.0
#include "sim/stress_polygons.hpp"

#include <spantex/polygon.hpp>

#include <algorithm>
#include <cstdio>

#include "sim/random.hpp"

namespace spantex::sim {
namespace {

constexpr projection camera{1 << 16, 1 << 16, 0, 0, 1 << 10};
constexpr int32_t one_px = 1 << subpixel_bits;

// --- generate ------------------------------------------------------------------------------------------

// Rectangle with further points on its sides, clockwise.
std::vector<screen_point> cut_rectangle(random_source& r, screen_point from, screen_point to, int cuts) {
  std::vector<screen_point> rim;
  for (int side = 0; side < 4; ++side) {
    const bool across = side % 2 == 0;
    const int32_t length = across ? to.x - from.x : to.y - from.y;
    std::vector<int32_t> at{0};
    for (int k = int(r.below(uint32_t(cuts))); k > 0; --k) at.push_back(int32_t(r.below(uint32_t(length))));
    std::sort(at.begin(), at.end());
    for (const int32_t t : at)
      rim.push_back(side == 0   ? screen_point{from.x + t, from.y}
                    : side == 1 ? screen_point{to.x, from.y + t}
                    : side == 2 ? screen_point{to.x - t, to.y}
                                : screen_point{from.x, to.y - t});
  }
  return rim;
}

int32_t within(random_source& r, int32_t low, int32_t high) { return low + int32_t(r.below(uint32_t(high - low) + 1)); }

class fan_maker {
 public:
  fan_maker(uint64_t seed, int width_px, int height_px) : r(seed), fan_{width_px, height_px, {}, {}}, z_spread_(1u << r.below(15)) {}

  // Triangles around a point inside (or on) the rim; with `hub` a corner of the rim itself those beside it have no area.
  stress_fan around(std::vector<screen_point> rim, screen_point hub) {
    std::vector<stress_corner> corners;
    for (const screen_point& p : rim) corners.push_back(corner(p));
    const stress_corner middle = corner(hub);
    for (size_t k = 0; k < corners.size(); ++k) fan_.triangles.push_back({{middle, corners[k], corners[(k + 1) % corners.size()]}});
    fan_.outline = std::move(rim);
    return fan_;
  }

  stress_fan rectangle(screen_point from, screen_point to, int cuts) {
    const std::vector<screen_point> rim = cut_rectangle(r, from, to, cuts);
    return around(rim, {within(r, from.x, to.x), within(r, from.y, to.y)});
  }

  // A parallelogram p, p + d, p + d + t, p + t, in two triangles.
  stress_fan sliver(screen_point p, screen_point d, screen_point t) {
    const stress_corner a = corner(p), b = corner({p.x + d.x, p.y + d.y}), c = corner({p.x + d.x + t.x, p.y + d.y + t.y}),
                        e = corner({p.x + t.x, p.y + t.y});
    fan_.outline = {a.at, b.at, c.at, e.at};
    fan_.triangles = {{{a, b, c}}, {{a, c, e}}};
    return fan_;
  }

  random_source r;

 private:
  stress_corner corner(screen_point p) {
    const auto texels = [&] {
      const int bits = 10 + int(r.below(22));
      const auto x = int32_t(r.next() >> (64 - bits));
      return r.below(2) ? x : -x;
    };
    return {p, (1 << 16) + int32_t(r.below(z_spread_)), texels(), texels()};
  }

  stress_fan fan_;
  uint32_t z_spread_;
};

stress_fan make_needle(fan_maker& m) {
  const int32_t screen = max_screen_px * one_px, thick = 1 + int32_t(m.r.below(m.r.below(2) ? 16 : 2 * one_px));
  const int32_t length = within(m.r, screen / 2, screen - 1), start = within(m.r, 0, screen - 1 - length);
  const int32_t side = within(m.r, 0, screen - thick);
  switch (m.r.below(4)) {
    case 0:
      return m.rectangle({start, side}, {start + length, side + thick}, 6);
    case 1:
      return m.rectangle({side, start}, {side + thick, start + length}, 6);
    default:
      break;
  }
  const int32_t rise = within(m.r, 0, screen - 1), top = within(m.r, 0, screen - 1 - rise);
  const bool steep = m.r.below(2) != 0, falls = m.r.below(2) != 0;
  const screen_point p{start, falls ? top + rise : top}, d{length, falls ? -rise : rise},
      t = steep ? screen_point{thick, 0} : screen_point{0, thick};
  return steep ? m.sliver({p.y, p.x}, {d.y, d.x}, t) : m.sliver(p, d, t);
}

// --- exact coverage --------------------------------------------------------------------------------------

int64_t cross(screen_point p, screen_point q, int64_t x, int64_t y) {
  return int64_t(q.x - p.x) * (y - p.y) - int64_t(q.y - p.y) * (x - p.x);
}

// The top-left rule as geometry: a centre counts as lying an infinitesimal step to the right of itself, and far less of one below.
bool inside(screen_point p, screen_point q, int64_t x, int64_t y) {
  const int64_t side = cross(p, q, x, y);
  if (side != 0) return side > 0;
  return q.y != p.y ? q.y < p.y : q.x > p.x;
}

struct pixel_run {
  int32_t begin, end;
};  // half open

// Pixels of row y inside a clockwise convex outline.
pixel_run row_of(const std::vector<screen_point>& outline, int32_t y, int width_px) {
  pixel_run run{0, width_px};
  const int64_t cy = centre_subpixels(y);
  for (size_t k = 0; k < outline.size(); ++k) {
    const screen_point p = outline[k], q = outline[(k + 1) % outline.size()];
    if (p.x == q.x && p.y == q.y) continue;
    const auto in = [&](int32_t x) { return inside(p, q, centre_subpixels(x), cy); };
    if (q.y == p.y) {
      if (!in(0)) return {0, 0};
      continue;
    }
    // The first pixel right of the edge, or one beside it, then put right by the exact test.
    const int64_t at = p.x + int64_t(q.x - p.x) * (cy - p.y) / (q.y - p.y);
    auto x = int32_t(std::clamp<int64_t>(at >> subpixel_bits, 0, width_px));
    if (q.y < p.y) {  // inside is to the right
      while (x > 0 && in(x - 1)) --x;
      while (x < width_px && !in(x)) ++x;
      run.begin = std::max(run.begin, x);
    } else {
      while (x < width_px && in(x)) ++x;
      while (x > 0 && !in(x - 1)) --x;
      run.end = std::min(run.end, x);
    }
  }
  return run.begin < run.end ? run : pixel_run{0, 0};
}

int64_t twice_area(const stress_triangle& t) { return cross(t.corners[0].at, t.corners[1].at, t.corners[2].at.x, t.corners[2].at.y); }

std::vector<screen_point> clockwise(const stress_triangle& t) {
  const screen_point a = t.corners[0].at, b = t.corners[1].at, c = t.corners[2].at;
  return twice_area(t) > 0 ? std::vector{a, b, c} : std::vector{a, c, b};
}

struct row_range {
  int32_t begin, end;
};
row_range rows_of(const std::vector<screen_point>& outline, int height_px) {
  const auto [low, high] = std::minmax_element(outline.begin(), outline.end(), [](screen_point a, screen_point b) { return a.y < b.y; });
  return {std::clamp(low->y >> subpixel_bits, 0, height_px), std::clamp((high->y >> subpixel_bits) + 1, 0, height_px)};
}

// --- exact plane -----------------------------------------------------------------------------------------

vertex vertex_of(const stress_corner& c) {
  const auto away = [&](int32_t subpixels) { return int32_t((int64_t(subpixels) << (16 - subpixel_bits)) * c.z >> 16); };
  return {away(c.at.x), away(c.at.y), c.z, c.u, c.v};
}

// u/z, v/z and 1/z times the determinant, from the adjugate in 128-bit integers: at most 34 + 18 + 31 + 3 bits.
exact_plane plane_through(const vertex (&t)[3]) {
  exact_plane p{};
  int128 determinant = 0;
  for (int k = 0; k < 3; ++k) {
    const vertex &a = t[(k + 1) % 3], &b = t[(k + 2) % 3];
    const int128 x = int128(a.y) * b.z - int128(a.z) * b.y, y = int128(a.z) * b.x - int128(a.x) * b.z,
                 c = int128(a.x) * b.y - int128(a.y) * b.x;
    determinant += x * t[k].x + y * t[k].y + c * t[k].z;
    const auto add = [&](exact_form& f, int128 value) { f.x += x * value, f.y += y * value, f.c += c * value; };
    add(p.u, t[k].u);
    add(p.v, t[k].v);
    add(p.w, 1 << 16);
  }
  if (determinant < 0)
    for (exact_form* f : {&p.u, &p.v, &p.w}) f->x = -f->x, f->y = -f->y, f->c = -f->c;
  return p;
}

bool is_adverse_triangle(stress_family family, const stress_triangle& t, int64_t pixels) {
  if (family == stress_family::one_pixel) return pixels == 1;
  if (family != stress_family::needles) return true;
  int64_t longest = 0;
  for (int k = 0; k < 3; ++k) {
    const screen_point a = t.corners[k].at, b = t.corners[(k + 1) % 3].at;
    longest = std::max<int64_t>(longest, std::max(std::abs(a.x - b.x), std::abs(a.y - b.y)));
  }
  return longest >= 1024 * one_px && std::abs(twice_area(t)) <= 2 * one_px * longest;  // no more than two pixels thick
}

}  // namespace

stress_fan make_stress_fan(stress_family family, uint64_t seed) {
  fan_maker m(seed, max_screen_px, max_screen_px);
  if (family == stress_family::needles) return make_needle(m);
  const int32_t most = family == stress_family::one_pixel ? 2 * one_px : 256 * one_px,
                least = family == stress_family::one_pixel ? 1 : 8 * one_px;
  const screen_point size{within(m.r, least, most), within(m.r, least, most)};
  const int32_t screen = max_screen_px * one_px;
  const screen_point from{within(m.r, 0, screen - size.x), within(m.r, 0, screen - size.y)};
  return m.rectangle(from, {from.x + size.x, from.y + size.y}, family == stress_family::one_pixel ? 2 : 7);
}

int64_t judge_triangle(const stress_fan& fan, const stress_triangle& t, stress_judge& judge, stress_row& row) {
  ++row.polygons;
  vertex vertices[3];
  for (int k = 0; k < 3; ++k) vertices[k] = vertex_of(t.corners[k]);
  const std::vector<screen_point> outline = clockwise(t);
  const row_range rows = twice_area(t) == 0 ? row_range{0, 0} : rows_of(outline, fan.height_px);
  polygon p{};
  const bool drawn = make_polygon(vertices, 3, camera, {0, 0, fan.width_px, fan.height_px}, p) == status::ok;
  row.refused += !drawn;
  const exact_plane exact = plane_through(vertices);
  if (drawn) judge.judge_set_up(exact, p.box, p.map, p.box.x0 + p.box.x1, p.box.y0 + p.box.y1);

  struct covered_span {
    span_at at;
    span_mask mask;
  };
  std::vector<covered_span> covered;
  int64_t pixels = 0;
  for (int32_t sy = rows.begin / span_side; sy * span_side < rows.end; ++sy) {
    pixel_run runs[span_side] = {};
    int32_t begin = fan.width_px, end = 0;
    for (int j = 0; j < span_side; ++j) {
      const int32_t y = sy * span_side + j;
      if (y >= rows.begin && y < rows.end) runs[j] = row_of(outline, y, fan.width_px);
      if (runs[j].begin == runs[j].end) continue;
      begin = std::min(begin, runs[j].begin);
      end = std::max(end, runs[j].end);
    }
    if (begin >= end) begin = end = std::clamp(outline[0].x >> subpixel_bits, 0, fan.width_px - 1);
    // One span more on either side: pixels that should not be there.
    for (int32_t sx = std::max(0, begin / span_side - 1); sx <= std::min((fan.width_px - 1) / span_side, end / span_side + 1); ++sx) {
      span_mask expected = 0;
      for (int j = 0; j < span_side; ++j)
        expected |= rectangle_mask({runs[j].begin, sy * span_side + j, runs[j].end, sy * span_side + j + 1}, sx, sy);
      const span_mask mask = drawn ? coverage(p.edges, sx, sy) & rectangle_mask(p.box, sx, sy) : 0;
      judge.note(stress_stage::coverage, __builtin_popcountll(mask ^ expected), 0, {sx, sy}, 0);
      if (mask == 0) continue;
      covered.push_back({{sx, sy}, mask});
      pixels += __builtin_popcountll(mask);
      judge.note(stress_stage::in_front, __builtin_popcountll(mask & ~front_mask(p.map, sx, sy)), 0, {sx, sy}, 0);
    }
  }
  const bool adverse = is_adverse_triangle(row.family, t, pixels);
  constexpr size_t most_spans = 12;  // of a large triangle; the others only by their masks
  const size_t step = 1 + covered.size() / most_spans;
  for (size_t k = 0; k < covered.size(); k += step) {
    const span_at s = covered[k].at;
    judge.judge_set_up(exact, p.box, p.map, 16 * s.x + 8, 16 * s.y + 8);
    judge.judge_span(p.map, s, covered[k].mask, adverse);
  }
  return pixels;
}

void judge_fan(const stress_fan& fan, stress_judge& judge, stress_row& row) {
  int64_t drawn = 0, expected = 0;
  for (const stress_triangle& t : fan.triangles) drawn += judge_triangle(fan, t, judge, row);
  std::vector<screen_point> outline = fan.outline;
  int64_t area = 0;
  for (size_t k = 0; k < outline.size(); ++k)
    area += cross({0, 0}, outline[k], outline[(k + 1) % outline.size()].x, outline[(k + 1) % outline.size()].y);
  if (area < 0) std::reverse(outline.begin(), outline.end());
  const row_range rows = rows_of(outline, fan.height_px);
  for (int32_t y = rows.begin; area != 0 && y < rows.end; ++y) {
    const pixel_run run = row_of(outline, y, fan.width_px);
    expected += run.end - run.begin;
  }
  judge.note(stress_stage::fan_once, double(std::abs(drawn - expected)), 0, {0, 0}, 0);
}

std::string text_of(const stress_triangle& t) {
  std::string text;
  for (const stress_corner& c : t.corners) {
    char corner[160];
    std::snprintf(corner, sizeof corner, "%s(%d, %d)/256 px, z %d/65536, u %d/65536, v %d/65536", text.empty() ? "" : "; ", c.at.x, c.at.y,
                  c.z, c.u, c.v);
    text += corner;
  }
  return text;
}

}  // namespace spantex::sim
