// SPDX-License-Identifier: Apache-2.0
// One case of the stress run in words: every stage's worst, the numbers it was made of, and the simplest that still fail.
#include <cstdio>

#include "sim/stress.hpp"
#include "sim/stress_judge.hpp"
#include "sim/stress_planes.hpp"
#include "sim/stress_polygons.hpp"
#include "sim/stress_shrink.hpp"

namespace spantex::sim {
namespace {

template <size_t N>
std::vector<int128> numbers_of(const int64_t (&values)[N]) {
  return {values, values + N};
}

std::vector<int128> numbers_of(const plane& p) { return numbers_of<9>({p.u.x, p.u.y, p.u.c, p.v.x, p.v.y, p.v.c, p.w.x, p.w.y, p.w.c}); }

plane plane_of(const std::vector<int128>& n, const plane& like) {
  const auto form = [&](size_t k) { return linear_form{int64_t(n[k]), int64_t(n[k + 1]), int64_t(n[k + 2])}; };
  plane p = like;
  p.u = form(0), p.v = form(3), p.w = form(6);
  return p;
}

std::vector<int128> numbers_of(const homography& m) {
  std::vector<int128> n;
  for (const wide& x : {m.a, m.b, m.c, m.d, m.e, m.f, m.g, m.h, m.i}) n.push_back(int128_of(x));
  return n;
}

homography homography_of(const std::vector<int128>& n) {
  const auto w = [&](size_t k) { return wide(int64_t(n[k] >> 64), uint64_t(n[k])); };
  return {w(0), w(1), w(2), w(3), w(4), w(5), w(6), w(7), w(8)};
}

std::vector<int128> numbers_of(const stress_triangle& t) {
  std::vector<int128> n;
  for (const stress_corner& c : t.corners)
    for (const int32_t x : {c.at.x, c.at.y, c.z - (1 << 16), c.u, c.v}) n.push_back(x);
  return n;
}

stress_triangle triangle_of(const std::vector<int128>& n) {
  stress_triangle t{};
  for (size_t k = 0; k < 3; ++k) {
    const auto at = [&](size_t i) { return int32_t(n[5 * k + i]); };
    t.corners[k] = {{at(0), at(1)}, (1 << 16) + at(2), at(3), at(4)};
  }
  return t;
}

std::string text_of(const plane& p) {
  char text[600];
  std::snprintf(text, sizeof text,
                "Nu = %lld x %+lld y %+lld, Nv = %lld x %+lld y %+lld, W = %lld x %+lld y %+lld about (%d, %d) half pixels",
                static_cast<long long>(p.u.x), static_cast<long long>(p.u.y), static_cast<long long>(p.u.c), static_cast<long long>(p.v.x),
                static_cast<long long>(p.v.y), static_cast<long long>(p.v.c), static_cast<long long>(p.w.x), static_cast<long long>(p.w.y),
                static_cast<long long>(p.w.c), p.origin_x, p.origin_y);
  return text;
}

std::string text_of(int128 x) {
  if (x < 0) return "-" + text_of(-x);
  return (x >= 10 ? text_of(x / 10) : std::string()) + char('0' + int(x % 10));
}

std::string text_of(const homography& m) {
  std::string text;
  for (const int128& x : numbers_of(m)) text += (text.empty() ? "" : ", ") + text_of(x);
  return text;
}

stress_stage first_failing_stage(const stress_row& row) {
  int k = 0;
  while (k + 1 < stress_stage_count && row.stages[k].failures == 0) ++k;
  return stress_stage(k);
}

std::string minimal_plane(const stress_bounds& bounds, const stress_plane_case& c, const stress_row& row, uint64_t seed) {
  const stress_stage stage = first_failing_stage(row);
  const stress_worst& at = row.stages[int(stage)].worst;
  const span_at s{at.span_x, at.span_y};
  const rectangle region{0, 0, c.width_px, c.height_px};
  const auto fails = [&](auto judge_it) {
    stress_row trial{};
    trial.family = row.family;
    stress_judge judge(bounds, seed, trial);
    judge_it(judge);
    return trial.stages[int(stage)].failures != 0;
  };
  if (stage == stress_stage::set_up) {
    const auto still_fails = [&](const std::vector<int128>& n) {
      plane map{};
      const homography m = homography_of(n);
      if (make_plane(m, region, map) != status::ok) return false;
      return fails([&](stress_judge& judge) { judge.judge_set_up(exact_plane_of(m), region, map, 16 * s.x + 8, 16 * s.y + 8); });
    };
    return "matrix " + text_of(homography_of(shrink(numbers_of(c.exact), still_fails)));
  }
  const auto still_fails = [&](const std::vector<int128>& n) {
    stress_plane_case trial = c;
    trial.map = plane_of(n, c.map);
    return fails([&](stress_judge& judge) {
      if (stage == stress_stage::row || stage == stress_stage::column) return judge.judge_walks(trial);
      judge.judge_span(trial.map, s, full_mask, false);
      judge.judge_moved(trial.map, s);
    });
  };
  char span[64];
  std::snprintf(span, sizeof span, " (span %d,%d)", s.x, s.y);
  return text_of(plane_of(shrink(numbers_of(c.map), still_fails), c.map)) + span;
}

std::string minimal_triangle(const stress_bounds& bounds, const stress_fan& fan, const stress_row& row, uint64_t seed) {
  const stress_stage stage = first_failing_stage(row);
  const auto still_fails = [&](const std::vector<int128>& n) {
    stress_row trial{};
    trial.family = row.family;
    stress_judge judge(bounds, seed, trial);
    judge_triangle(fan, triangle_of(n), judge, trial);
    return trial.stages[int(stage)].failures != 0;
  };
  for (const stress_triangle& t : fan.triangles)
    if (still_fails(numbers_of(t))) return text_of(triangle_of(shrink(numbers_of(t), still_fails)));
  return "no triangle fails alone";
}

}  // namespace

std::string describe_case(const profile& p, stress_family family, uint64_t seed) {
  const stress_row row = run_case(p, family, seed);
  const bool good = row.failures() == 0;
  char line[400];
  std::snprintf(line, sizeof line, "%s case %llu: %s\n", name_of(family), static_cast<unsigned long long>(seed),
                good ? "within bounds" : "FAILS");
  std::string text = line;
  for (int k = 0; k < stress_stage_count; ++k) {
    const stress_record& s = row.stages[k];
    if (s.judged == 0) continue;
    std::snprintf(line, sizeof line, "  %-18s %8llu judged, worst %.9g of %.9g %s (span %d,%d pixel %d)%s\n", name_of(stress_stage(k)),
                  static_cast<unsigned long long>(s.judged), s.worst.error, s.worst.bound, unit_of(stress_stage(k)), s.worst.span_x,
                  s.worst.span_y, s.worst.pixel, s.failures != 0 ? "  FAILS" : "");
    text += line;
  }
  const stress_bounds bounds(p);
  if (is_polygons(family)) {
    const stress_fan fan = make_stress_fan(family, seed);
    for (const stress_triangle& t : fan.triangles) text += "triangle: " + text_of(t) + "\n";
    if (!good) text += "minimal: " + minimal_triangle(bounds, fan, row, seed) + "\n";
    return text;
  }
  const stress_plane_case c = make_stress_plane(family, seed);
  std::snprintf(line, sizeof line, "screen %d x %d, anchor (%d, %d)\n", c.width_px, c.height_px, c.x0, c.y0);
  text += line + ("plane: " + text_of(c.map)) + "\n";
  if (!good) text += "minimal: " + minimal_plane(bounds, c, row, seed) + "\n";
  return text;
}

}  // namespace spantex::sim
