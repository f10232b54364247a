// SPDX-License-Identifier: Apache-2.0
#include "bench_scenes.hpp"

#include <math.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <utility>

#include <sim/figures.hpp>
#include <sim/model.hpp>
#include <sim/pattern.hpp>
#include <sim/world.hpp>
#include <tools/bench_planes.hpp>
#include "options.hpp"

namespace spantex::tool {
namespace {

constexpr int plane_map_side = 512;

std::shared_ptr<const sim::map_list> one_map(sim::image picture, colour_space colours) {
  sim::map_list maps;
  maps.emplace_back(std::move(picture), sim::prefilter::box, wrap::repeat, wrap::repeat, texel_format::rgba8888, colours);
  return std::make_shared<const sim::map_list>(std::move(maps));
}

// Made once.
std::shared_ptr<const sim::map_list> built_in_map(int side, colour_space colours = colour_space::coded) {
  static std::map<std::pair<int, colour_space>, std::shared_ptr<const sim::map_list>> made;
  std::shared_ptr<const sim::map_list>& map = made[{side, colours}];
  if (map == nullptr) map = one_map(sim::photographic_pattern(side, 1), colours);
  return map;
}

sim::scene plane_scene(const std::string& name, const sim::matrix& m, sim::screen_size size, const bench_maps& maps) {
  sim::scene s{name, size, maps.texture.empty() ? built_in_map(plane_map_side, maps.colours) : one_map(sim::load_image(maps.texture), maps.colours), {}};
  sim::add_plane(s, m, 0);
  return s;
}

sim::scene spider_scene(sim::screen_size size, const bench_maps& maps) {
  const std::string file = maps.models + "/OBJ/spider.obj";
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) throw sim::input_error(file + ": missing; it is part of the Debian package assimp-testmodels");
  sim::camera_options camera;
  camera.yaw_degrees = 35;
  camera.pitch_degrees = 30;
  sim::model_options options;
  options.colours = maps.colours;
  sim::scene s = sim::look_at(sim::load_model(file, options), camera, size);
  s.name = "spider";
  return s;
}

// A rectangle of a wall `depth` in front of the camera, leaning back by a quarter; in fractions of the wall from the top left.
struct part { double left, top, right, bottom; };

constexpr double wall_view_radians = 0.7, wall_near = 1, wall_lean = 0.25;
constexpr int wall_map_side = 256;

void add_wall_part(sim::scene& s, const sim::lens& view, double depth, const part& p) {
  // Half sides of a wall that reaches beyond the picture where it leans away.
  const double half_height = depth * tan(wall_view_radians / 2) * (1 + wall_lean), half_width = half_height * s.size.width_px / s.size.height_px;
  const auto corner = [&](double x, double y) {
    const double down = (2 * y - 1) * half_height;
    return vertex{sim::to_fixed((2 * x - 1) * half_width), sim::to_fixed(down), sim::to_fixed(depth - wall_lean * down),
                  sim::to_fixed(x * 2 * wall_map_side), sim::to_fixed(y * 2 * wall_map_side)};
  };
  const vertex corners[] = {corner(p.left, p.top), corner(p.right, p.top), corner(p.right, p.bottom), corner(p.left, p.bottom)};
  sim::add_polygon(s, view, corners, 4, 0);
}

sim::scene empty_wall_scene(const char* name, sim::screen_size size) {
  return {name, size, built_in_map(wall_map_side), {}};
}

}  // namespace

const std::vector<std::string>& bench_scene_names() {
  static const std::vector<std::string> names{"facing", "tilted", "grazing", "close", "far", "horizon", "spider"};
  return names;
}

sim::scene make_bench_scene(const std::string& name, sim::screen_size size, const bench_maps& maps) {
  const std::vector<std::string>& known = bench_scene_names();
  if (std::find(known.begin(), known.end(), name) == known.end())
    throw sim::input_error("--scenes: unknown scene '" + name + "' (known: " + joined(known) + ")");
  return name == "spider" ? spider_scene(size, maps) : plane_scene(name, sim::stretched(*bench_plane(name), size), size, maps);
}

sim::scene make_bench_plane(const sim::matrix& m, sim::screen_size size, const bench_maps& maps) { return plane_scene("matrix", m, size, maps); }

sim::scene wall_of_squares(int side, sim::screen_size size) {
  sim::scene s = empty_wall_scene("squares", size);
  const sim::lens view = sim::make_lens(size, wall_view_radians, wall_near);
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      add_wall_part(s, view, 8, {double(x) / side, double(y) / side, double(x + 1) / side, double(y + 1) / side});
  return s;
}

sim::scene layers(int count, bool nearest_first, sim::screen_size size) {
  sim::scene s = empty_wall_scene("layers", size);
  const sim::lens view = sim::make_lens(size, wall_view_radians, wall_near);
  for (int k = 0; k < count; ++k) add_wall_part(s, view, 4 + (nearest_first ? k : count - 1 - k), {0, 0, 1, 1});
  return s;
}

sim::scene plane_with_map(int side, sim::screen_size size) {
  sim::scene s{"map", size, built_in_map(side), {}};
  sim::matrix m = sim::stretched(*sim::named_plane("tilted"), size);
  for (size_t k = 0; k < 6; ++k) m[k] *= double(side) / plane_map_side;
  sim::add_plane(s, m, 0);
  return s;
}

}  // namespace spantex::tool
