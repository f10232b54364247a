// SPDX-License-Identifier: Apache-2.0
#include "sim/stress.hpp"

#include <spantex/accuracy.hpp>
#include <spantex/coordinates.hpp>
#include <spantex/datapath.hpp>
#include <spantex/texture.hpp>
#include <spantex/coverage.hpp>
#include <spantex/level.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <thread>

#include "sim/exact.hpp"
#include "sim/random.hpp"
#include "sim/stress_polygons.hpp"

namespace spantex::sim {
namespace {

constexpr int levels_of_interest = 12;  // level errors count where the exact level lies in [0, 12]

// A random number of at most `bits` bits whose size is spread evenly over the powers of two.
int64_t any_size(random_source& r, int bits) {
  const int n = int(r.below(uint32_t(bits) + 1));
  const int64_t x = n == 0 ? 0 : int64_t(r.next() >> (64 - n));
  return r.below(2) ? x : -x;
}

int64_t positive(random_source& r, int low_bits, int high_bits) {
  const int n = low_bits + int(r.below(uint32_t(high_bits - low_bits + 1)));
  return int64_t((r.next() >> (64 - n)) | (uint64_t(1) << (n - 1)));
}

struct sketch {
  int64_t g = 0, h = 0, w0 = 0;          // W = w0 at (x0, y0), slopes per pixel; any common scale
  int64_t u0 = 0, v0 = 0;                // texels in s.16 at (x0, y0)
  int64_t a = 0, b = 0, d = 0, e = 0;    // slopes of the numerators, in the scale of W
  int x0 = 0, y0 = 0;
};

homography about(const sketch& s) {
  const auto constant = [&](wide at, int64_t x, int64_t y) { return at - multiply(x, s.x0) - multiply(y, s.y0); };
  const auto row = [&](int64_t t) { return shift_right_nearest(multiply(s.w0, t), 16); };
  return {wide(s.a), wide(s.b), constant(row(s.u0), s.a, s.b), wide(s.d), wide(s.e), constant(row(s.v0), s.d, s.e),
          wide(s.g), wide(s.h), constant(wide(s.w0), s.g, s.h)};
}

// Slopes that move a coordinate by about `texels_16` (s.16) per pixel at the anchor.
int64_t slope(const sketch& s, int64_t texels_16, int64_t at, int64_t w_slope) {
  const wide sum = multiply(s.w0, texels_16) + multiply(at, w_slope);
  return to_int64(shift_right_nearest(sum, 16));
}

void set_slopes(sketch& s, int64_t ux, int64_t uy, int64_t vx, int64_t vy) {
  s.a = slope(s, ux, s.u0, s.g);
  s.b = slope(s, uy, s.u0, s.h);
  s.d = slope(s, vx, s.v0, s.g);
  s.e = slope(s, vy, s.v0, s.h);
}

sketch draw_sketch(stress_family family, random_source& r, int width, int height) {
  sketch s;
  s.x0 = int(r.below(uint32_t(width)));
  s.y0 = int(r.below(uint32_t(height)));
  s.w0 = positive(r, 30, 44);
  s.u0 = any_size(r, 31);
  s.v0 = any_size(r, 31);
  s.g = any_size(r, 36);
  s.h = any_size(r, 36);
  const auto gradient = [&](int bits) { return any_size(r, bits); };
  int bits = 22;
  switch (family) {
    case stress_family::horizon: s.w0 = positive(r, 34, 40); s.g = any_size(r, 34); s.h = positive(r, 26, 34); break;
    case stress_family::near_horizon: s.w0 = positive(r, 4, 36); s.g = any_size(r, 36); s.h = any_size(r, 36); break;
    case stress_family::cancelling: s.u0 = any_size(r, 10); s.v0 = any_size(r, 10); s.x0 = width - 1; s.y0 = height - 1; break;
    case stress_family::far_coordinates: {
      const auto far = [&] { return (int64_t(32767) << 16) - int64_t(r.below(1u << 20)); };
      s.u0 = r.below(2) ? far() : -far();
      s.v0 = r.below(2) ? far() : -far();
      break;
    }
    case stress_family::magnified: bits = 8; s.g = any_size(r, 24); s.h = any_size(r, 24); break;
    case stress_family::minified: bits = 30; break;
    case stress_family::wide_screen: s.x0 = width - 1 - int(r.below(64)); break;
    default: break;
  }
  set_slopes(s, gradient(bits), gradient(bits), gradient(bits), gradient(bits));
  if (family == stress_family::edge_on) {  // Nu and Nv almost a multiple of W
    const int64_t k = any_size(r, 12);
    s.a = s.g * k + any_size(r, 6); s.b = s.h * k + any_size(r, 6);
    s.d = s.g * k + any_size(r, 6); s.e = s.h * k + any_size(r, 6);
  }
  return s;
}

// One span evaluated as the planner does: its own coefficients, or those of each pixel.
class span_under_test {
 public:
  span_under_test(const profile& p, const plane& map, int sx, int sy) : prof_{p}, map_(map), cx_(16 * sx + 8), cy_(16 * sy + 8) {
    c_.last_level = levels_of_interest + 1;
    if (map.w_at(cx_, cy_) <= 0) return;
    const reference r = reference_at(map, cx_, cy_);
    whole_ = span_coordinates(map, r, p, c_);
    if (whole_ && major()) major_levels(map, r, c_);
    if (whole_ && !major()) span_levels(p, c_);
  }

  const span_coefficients& at(int i, int j) {
    if (whole_) return c_;
    const reference r = reference_at(map_, hx(i), hy(j));
    pixel_coordinates(r, prof_.value, c_);
    if (major()) major_levels(map_, r, c_);
    else pixel_levels(map_, r, hx(i), hy(j), c_);
    return c_;
  }

  const run_time_profile& prof() const { return prof_; }
  bool major() const { return prof_.value.formula == level_formula::major; }
  int32_t hx(int i) const { return cx_ + half_pixels(i); }
  int32_t hy(int j) const { return cy_ + half_pixels(j); }

 private:
  run_time_profile prof_;
  const plane& map_;
  int32_t cx_, cy_;
  span_coefficients c_{};
  bool whole_ = false;
};

struct bounds { double coordinate, level; };

bounds bounds_of(const profile& p) {
  return {double(coordinate_bound(p)) / double(error_unit), double(level_bound(p)) / double(error_unit)};
}

void note(stress_worst& worst, double error, uint64_t seed, int sx, int sy, int pixel) {
  if (error > worst.error) worst = {error, seed, sx, sy, pixel};
}

// A map and a level of it: sides 1..4096, powers of two and others, on which a case's positions are snapped.
struct sampled_level {
  int32_t side_0, side;
  uint32_t ratio;
  int level;
};

sampled_level choose_level(uint64_t seed) {
  random_source r(seed ^ 0x7f4a7c15);
  const int bits = int(r.below(13));
  const int32_t side = r.below(2) ? 1 << bits : 1 + int32_t(r.below(1u << bits));
  const rgba8 texel{};
  const rgba8* levels[max_levels];
  for (const rgba8*& p : levels) p = &texel;
  texture_view t;
  const int count = bit_length(uint64_t(side));
  if (texture_view::make(levels, count, side, side, wrap::repeat, wrap::repeat, t) != status::ok) std::abort();
  const int level = int(r.below(uint32_t(count)));
  return {side, t.width(level), t.ratio_u(level), level};
}

// A snapped position against its bound (accuracy.hpp snapped_bound).
bool check_position(const profile& p, const sampled_level& at, coordinate c, int64_t numerator, int64_t w, uint64_t seed, int sx, int sy,
                    int k, stress_row& row) {
  if (at.side == 1) return true;  // position 0 by definition
  const int32_t snapped = blended(c, at.ratio, false, at.level, p);
  const double error = snapped_error(snapped, p.subtexel_bits, numerator, w, at.side, at.side_0);
  const double share = error / (double(snapped_bound(p, at.level)) / double(error_unit));
  ++row.positions;
  note(row.position, share, seed, sx, sy, k);
  return share <= 1;
}

// All pixels of one span. Levels are checked for every fifth pixel: the exact one is a logarithm of exact integers, and slow.
bool check_span(const profile& p, const plane& map, int sx, int sy, uint64_t seed, bounds limit, stress_row& row) {
  span_under_test span(p, map, sx, sy);
  const sampled_level sampled = choose_level(seed);
  bool good = true;
  for (int k = 0; k < span_pixel_count; ++k) {
    const int i = k % span_side, j = k / span_side;
    const int32_t hx = span.hx(i), hy = span.hy(j);
    const int64_t w = map.w_at(hx, hy), nu = map.u_at(hx, hy), nv = map.v_at(hx, hy);
    if (w <= 0) continue;
    const span_coefficients& c = span.at(i, j);
    const texel_position at = position_at(span.prof(), c, i, j);
    const bool u_counts = in_range(nu, w), v_counts = in_range(nv, w);
    double worst = 0;
    // The bound of this span's own reach, not of the largest one.
    const double bound = double(coordinate_bound(p, p.offset_bits - 1 - c.exponent)) / double(error_unit);
    if (u_counts) worst = coordinate_error(at.u.raw(), nu, w);
    if (v_counts) worst = std::max(worst, coordinate_error(at.v.raw(), nv, w));
    row.evaluations += uint64_t(u_counts) + uint64_t(v_counts);
    note(row.coordinate, worst, seed, sx, sy, k);
    good = good && worst <= bound;
    note(row.share, worst / bound, seed, sx, sy, k);
    if (u_counts) good = check_position(p, sampled, at.u, nu, w, seed, sx, sy, k, row) && good;
    if (v_counts) good = check_position(p, sampled, at.v, nv, w, seed, sx, sy, k, row) && good;
    if (!u_counts || !v_counts || (k % 5) != 0) continue;
    const long double exact = span.major() ? exact_major_level(map, hx, hy) : exact_level(map, hx, hy);
    const double computed = double(level_at(span.prof(), c, i, j)) / (1 << p.level_bits);
    const double error =
        double(std::fabs(std::clamp(exact, 0.0L, static_cast<long double>(levels_of_interest)) -
                         std::clamp(static_cast<long double>(computed), 0.0L, static_cast<long double>(levels_of_interest))));
    ++row.levels;
    note(row.level, error, seed, sx, sy, k);
    good = good && error <= limit.level;
  }
  return good;
}

struct span_choice { int x, y; };

// Spans to look at: the corners of the screen, one at the anchor of the family's plane, some at random.
span_choice choose_span(random_source& r, int index, int width, int height) {
  const int last_x = (width - 1) / span_side, last_y = (height - 1) / span_side;
  if (index < 4) return {index & 1 ? last_x : 0, index & 2 ? last_y : 0};
  return {int(r.below(uint32_t(last_x) + 1)), int(r.below(uint32_t(last_y) + 1))};
}

bool check_plane(const profile& p, stress_family family, uint64_t seed, bounds limit, stress_row& row) {
  int width = 0, height = 0;
  const plane map = stress_plane(family, seed, width, height);
  random_source r(seed ^ 0x5bd1e995);
  bool good = true;
  for (int k = 0; k < 12; ++k) {
    const span_choice s = choose_span(r, k, width, height);
    good = check_span(p, map, s.x, s.y, seed, limit, row) && good;
  }
  return good;
}

bool check_case(const profile& p, stress_family family, uint64_t seed, bounds limit, stress_row& row) {
  ++row.cases;
  const bool good = family == stress_family::polygons ? check_polygons(seed, row) : check_plane(p, family, seed, limit, row);
  if (!good && row.failures++ == 0) row.first_failure = seed;
  return good;
}

void merge(stress_row& into, const stress_row& from) {
  into.cases += from.cases;
  into.evaluations += from.evaluations;
  into.positions += from.positions;
  into.levels += from.levels;
  into.polygon_pixels += from.polygon_pixels;
  if (from.coordinate.error > into.coordinate.error) into.coordinate = from.coordinate;
  if (from.share.error > into.share.error) into.share = from.share;
  if (from.position.error > into.position.error) into.position = from.position;
  if (from.level.error > into.level.error) into.level = from.level;
  if (into.failures == 0) into.first_failure = from.first_failure;
  into.failures += from.failures;
}

// A family's share of the evaluations, cases dealt out to the threads by number: the set of cases does not depend on their count.
stress_row run_family(const profile& p, stress_family family, const stress_options& o, uint64_t share,
                      std::chrono::steady_clock::time_point end, bool& complete) {
  const bounds limit = bounds_of(p);
  const bool polygons = family == stress_family::polygons;
  stress_row total{};
  total.family = family;
  std::mutex lock;
  std::atomic<uint64_t> next{0}, done{0};
  std::atomic<bool> late{false};
  const auto work = [&] {
    stress_row row{};
    uint64_t counted = 0;
    while (done < share && !late) {
      check_case(p, family, mix(o.seed, uint64_t(family), next++), limit, row);
      const uint64_t now = polygons ? row.polygon_pixels : row.evaluations;
      done += now - counted;
      counted = now;
      if (o.seconds > 0 && std::chrono::steady_clock::now() > end) late = true;
    }
    const std::lock_guard<std::mutex> hold(lock);
    merge(total, row);
  };
  std::vector<std::thread> crew;
  for (int k = 0; k < o.threads; ++k) crew.emplace_back(work);
  for (std::thread& t : crew) t.join();
  complete = complete && !late;
  return total;
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

// Simplifies a failing plane: drops coefficients and low bits while the span still fails.
plane shrink(const profile& p, plane map, int sx, int sy, uint64_t seed) {
  const bounds limit = bounds_of(p);
  const auto fails = [&](const plane& candidate) {
    stress_row row{};
    return !check_span(p, candidate, sx, sy, seed, limit, row);
  };
  bool smaller = true;
  while (smaller) {
    smaller = false;
    for (linear_form plane::*form : {&plane::u, &plane::v, &plane::w})
      for (int64_t linear_form::*part : {&linear_form::x, &linear_form::y, &linear_form::c})
        for (int keep = 0; keep <= 60; ++keep) {
          plane candidate = map;
          int64_t& value = candidate.*form.*part;
          const int64_t unit = int64_t(1) << (60 - keep), simpler = value / unit * unit;  // towards zero: stays in bounds
          if (simpler == value) continue;
          value = simpler;
          if (!fails(candidate)) continue;
          map = candidate;
          smaller = true;
          break;
        }
  }
  return map;
}

}  // namespace

const char* name_of(stress_family f) {
  constexpr const char* names[stress_family_count] = {"any-plane", "horizon", "near-horizon", "edge-on", "cancelling", "far-coordinates",
                                                      "magnified", "minified", "wide-screen", "polygons"};
  return names[int(f)];
}

plane stress_plane(stress_family family, uint64_t seed, int& width_px, int& height_px) {
  random_source r(seed);
  plane map{};
  do {
    width_px = family == stress_family::wide_screen ? max_screen_px : 1 + int(r.below(max_screen_px));
    height_px = 1 + int(r.below(max_screen_px));
  } while (make_plane(about(draw_sketch(family, r, width_px, height_px)), {0, 0, width_px, height_px}, map) != status::ok);
  return map;
}

stress_report run_stress(const profile& p, const stress_options& options) {
  stress_report report;
  report.coordinate_bound = bounds_of(p).coordinate;
  report.level_bound = bounds_of(p).level;
  std::vector<stress_family> families = options.families;
  if (families.empty())
    for (int k = 0; k < stress_family_count; ++k) families.push_back(stress_family(k));
  const auto begin = std::chrono::steady_clock::now();
  const auto planes =
      uint64_t(std::count_if(families.begin(), families.end(), [](stress_family f) { return f != stress_family::polygons; }));
  const uint64_t share = options.evaluations / std::max<uint64_t>(planes, 1) + 1;
  for (size_t k = 0; k < families.size(); ++k) {
    const auto end = begin + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                 std::chrono::duration<double>(options.seconds * double(k + 1) / double(families.size())));
    report.rows.push_back(run_family(p, families[k], options, share, end, report.complete));
  }
  return report;
}

std::string describe_case(const profile& p, stress_family family, uint64_t seed) {
  stress_row row{};
  row.family = family;
  const bool good = check_case(p, family, seed, bounds_of(p), row);
  char head[400];
  std::snprintf(head, sizeof head, "%s case %llu: %s; worst coordinate error %.9f texel (span %d,%d pixel %d), worst level error %.6f\n",
                name_of(family), static_cast<unsigned long long>(seed), good ? "within bounds" : "FAILS", row.coordinate.error,
                row.coordinate.span_x, row.coordinate.span_y, row.coordinate.pixel, row.level.error);
  if (family == stress_family::polygons) return head;
  int width = 0, height = 0;
  const plane map = stress_plane(family, seed, width, height);
  std::string text = std::string(head) + "plane: " + text_of(map) + "\n";
  if (!good) {
    const stress_worst& at = row.share.error > 1 ? row.share : row.position.error > 1 ? row.position : row.level;
    text += "minimal: " + text_of(shrink(p, map, at.span_x, at.span_y, seed)) + "\n";
  }
  return text;
}

}  // namespace spantex::sim
