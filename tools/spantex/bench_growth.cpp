// SPDX-License-Identifier: Apache-2.0
#include "bench_growth.hpp"

#include <math.h>

#include "bench_scenes.hpp"

namespace spantex::tool {
namespace {

struct subject {
  double amount;
  sim::scene scene;
};

struct curve_plan {
  const char *of, *scene;     // scene: said beside the filter
  filter kind;
  kernels::choice kernel;
};

constexpr sim::screen_size small_screen{320, 240};

std::vector<subject> more_pixels() {
  std::vector<subject> all;
  for (const int width : {160, 320, 640, 1280}) {
    const sim::screen_size size{width, width * 3 / 4};
    all.push_back({double(size.width_px) * size.height_px, make_bench_scene("tilted", size, {})});
  }
  return all;
}

std::vector<subject> more_polygons() {
  std::vector<subject> all;
  for (const int side : {1, 2, 4, 8, 16, 32, 64}) all.push_back({double(side) * side, wall_of_squares(side, small_screen)});
  return all;
}

std::vector<subject> larger_maps() {
  std::vector<subject> all;
  for (const int side : {64, 128, 256, 512, 1024, 2048}) all.push_back({double(side), plane_with_map(side, small_screen)});
  return all;
}

std::vector<subject> more_layers(bool nearest_first) {
  std::vector<subject> all;
  for (const int count : {1, 2, 4, 8, 16}) all.push_back({double(count), layers(count, nearest_first, small_screen)});
  return all;
}

double slope_of(const std::vector<growth_point>& points, double (*value)(const growth_point&)) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  const double n = double(points.size());
  for (const growth_point& p : points) {
    const double x = log(p.amount), y = log(value(p));
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

// The sizes take turns too.
growth_curve measure(const std::vector<subject>& subjects, const curve_plan& plan, int rounds) {
  sim::draw_options o;
  o.kind = plan.kind;
  o.kernel = plan.kernel;
  growth_curve curve{plan.of, "", {}, 0, 0};
  std::vector<std::vector<double>> ns(subjects.size());
  for (int round = 0; round < rounds; ++round)
    for (size_t k = 0; k < subjects.size(); ++k) {
      const sim::scene& s = subjects[k].scene;
      o.repeat = plan.kernel == kernels::choice::scalar ? 1 : 5;
      const sim::draw_result r = sim::draw(s, o);
      ns[k].push_back(r.ns_per_pixel * double(r.picture.pixels.size()));
      curve.drawer = plan.scene + (" " + std::string(sim::name_of(sim::filter_names, plan.kind))) + " " + std::string(r.kernel);
    }
  o.counted = true;
  o.repeat = 1;
  for (size_t k = 0; k < subjects.size(); ++k)
    curve.points.push_back({subjects[k].amount, spread_of(ns[k]), double(sim::draw(subjects[k].scene, o).work.words_loaded)});
  curve.time_slope = slope_of(curve.points, [](const growth_point& p) { return p.ns.median; });
  curve.words_slope = slope_of(curve.points, [](const growth_point& p) { return p.words; });
  return curve;
}

}  // namespace

std::vector<growth_curve> measure_growth(int rounds, const std::function<void()>& curve_done) {
  using enum kernels::choice;
  std::vector<growth_curve> curves;
  const auto add = [&](const std::vector<subject>& subjects, const curve_plan& plan) {
    curves.push_back(measure(subjects, plan, rounds));
    curve_done();
  };
  const std::vector<subject> sizes = more_pixels(), maps = larger_maps();
  add(sizes, {"pixels", "tilted", filter::trilinear, fastest});
  add(sizes, {"pixels", "tilted", filter::trilinear, scalar});
  add(maps, {"texels a side of the map", "tilted", filter::trilinear, fastest});
  add(maps, {"texels a side of the map", "tilted", filter::nearest, fastest});
  add(maps, {"texels a side of the map", "tilted", filter::trilinear, scalar});
  add(more_polygons(), {"polygons", "wall", filter::trilinear, fastest});
  add(more_layers(true), {"layers (overdraw)", "nearest first", filter::trilinear, fastest});
  add(more_layers(false), {"layers (overdraw)", "farthest first", filter::trilinear, fastest});
  return curves;
}

}  // namespace spantex::tool
