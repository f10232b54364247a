// SPDX-License-Identifier: Apache-2.0
#include "figures.hpp"

#include <math.h>

#include <algorithm>
#include <utility>

#include "distance_field.hpp"
#include "pattern.hpp"
#include "planes.hpp"

namespace spantex::sim {
namespace {

struct plane_by_name { const char* name; matrix coefficients; };

constexpr plane_by_name planes[] = {{"facing", facing_plane}, {"tilted", tilted_plane}, {"grazing", grazing_plane}};

constexpr int map_side = 256, squares = 8;

double radians(double degrees) { return degrees * M_PI / 180; }

std::shared_ptr<const map_list> maps_of(const scene_request& r, std::initializer_list<image> pictures) {
  map_list maps;
  for (const image& p : pictures) maps.emplace_back(p, r.levels, r.wrap_u, r.wrap_v, r.format, r.colours, r.most_levels, r.making);
  return std::make_shared<const map_list>(std::move(maps));
}

scene plane_scene(const plane_by_name& p, const scene_request& r) {
  scene s{p.name, r.size, plane_maps(r), {}};
  add_plane(s, stretched(p.coefficients, r.size), 0);
  return s;
}

// A ground plane `height` below a camera pitched down, 40 x 30 degrees of view, texture axes turned by `turn`.
scene ground_scene(const char* name, const scene_request& r, const image& map, double texels_per_unit, double height, double pitch_degrees,
                   double turn_degrees) {
  const double pitch = radians(pitch_degrees), turn = radians(turn_degrees + r.turn_degrees);
  const vector3d down{0, cos(pitch), sin(pitch)}, ahead{0, -sin(pitch), cos(pitch)}, right{1, 0, 0};
  const auto axis = [&](double along_right, double along_ahead) {
    vector3 a{};
    int32_t* const out[3] = {&a.x, &a.y, &a.z};
    for (size_t k = 0; k < 3; ++k) *out[k] = to_fixed(texels_per_unit * (along_right * right[k] + along_ahead * ahead[k]));
    return a;
  };
  const auto point = [](const vector3d& a, double scale, int bits) {
    return vector3{to_fixed(a[0] * scale, bits), to_fixed(a[1] * scale, bits), to_fixed(a[2] * scale, bits)};
  };
  const kt88_plane q{point(down, 1, 30), to_fixed(-height), axis(cos(turn), sin(turn)), axis(sin(turn), -cos(turn)),
                     point(down, height, 16), 0, 0};
  const auto step = [](double degrees, int pixels) { return uint32_t(ldexp(2.0 / pixels * tan(radians(degrees) / 2), 32)); };
  scene s{name, r.size, maps_of(r, {map}), {}};
  add_plane(s, q, {step(40, r.size.width_px), step(30, r.size.height_px), r.size.width_px, r.size.height_px}, 0);
  return s;
}

// The grazing plane with a field of 128 texels a side made of a mask eight times as fine.
scene contour_scene(const char* name, const scene_request& r) {
  constexpr int field_side = 128, reduction = 8, scale = 16, outline_16 = 32;
  constexpr double magnified = 12;
  constexpr rgba8 ink{240, 236, 216, 255};
  map_list maps;
  maps.push_back(make_field_map(shapes_mask(field_side * reduction), reduction, scale, outline_16, ink, r.wrap_u, r.wrap_v));
  scene s{name, r.size, std::make_shared<const map_list>(std::move(maps)), {}};
  matrix m = grazing_plane;
  for (size_t k = 0; k < 6; ++k) m[k] /= magnified;
  add_plane(s, stretched(m, r.size), 0);
  return s;
}

// Corners of face `axis` (0..2) on the low or high side of the box +-half.
world_face box_face(size_t axis, bool high, const vector3d& half, double texels_u, double texels_v, int map_index) {
  const size_t a = (axis + 1) % 3, b = (axis + 2) % 3;
  world_face f{{}, map_index};
  const double across[4] = {-1, 1, 1, -1}, along[4] = {-1, -1, 1, 1};
  for (size_t k = 0; k < 4; ++k) {
    world_vertex c{};
    c.position[axis] = high ? half[axis] : -half[axis];
    c.position[a] = across[k] * half[a];
    c.position[b] = along[k] * half[b];
    c.u = (across[k] + 1) / 2 * texels_u;
    c.v = (along[k] + 1) / 2 * texels_v;
    f.corners.push_back(c);
  }
  return f;
}

void add_box(world& w, const vector3d& half, const vector3d& middle, double turn, double tilt, double texels_per_unit, int map_index) {
  for (size_t axis = 0; axis < 3; ++axis)
    for (const bool high : {false, true}) {
      const size_t a = (axis + 1) % 3, b = (axis + 2) % 3;
      world_face f = box_face(axis, high, half, 2 * half[a] * texels_per_unit, 2 * half[b] * texels_per_unit, map_index);
      for (world_vertex& c : f.corners) {
        const auto [x, y, z] = c.position;
        const double ty = y * cos(tilt) - z * sin(tilt), tz = y * sin(tilt) + z * cos(tilt);
        c.position = {middle[0] + x * cos(turn) + tz * sin(turn), middle[1] + ty, middle[2] - x * sin(turn) + tz * cos(turn)};
      }
      w.faces.push_back(f);
    }
}

world thirty_faces(const char* name, const scene_request& r, double turned) {
  world w{name, maps_of(r, {random_pattern(map_side, 7), squares_pattern(map_side, squares)}), {}, {}, 0};
  constexpr double cube = 1.6;
  add_box(w, {10, 5, 10}, {0, 5, 0}, 0, 0, map_side / 5.0, 0);
  add_box(w, {cube, cube, cube}, {-3.2, cube, -1.5}, 0.4, 0, map_side / (2 * cube), 1);
  add_box(w, {cube, cube, cube}, {2.6, cube, -3.4}, -0.7, 0, map_side / (2 * cube), 1);
  add_box(w, {cube, cube, cube}, {1.8, cube, 2.4}, 1.1, 0, map_side / (2 * cube), 1);
  add_box(w, {cube, cube, cube}, {-0.6, 5.6, -2.2}, 0.5 + turned, 0.6, map_side / (2 * cube), 1);
  w.measure();
  return w;
}

scene cubes_scene(const char* name, const scene_request& r, vector3d eye, const vector3d& target, bool still = false) {
  const double turned = radians(r.turn_degrees), turn = still ? 0 : turned, x = eye[0], z = eye[2];
  eye = {x * cos(turn) + z * sin(turn), eye[1], z * cos(turn) - x * sin(turn)};
  camera_options camera;
  camera.eye = eye;
  camera.target = target;
  camera.vertical_degrees = 52;
  return look_at(thirty_faces(name, r, still ? turned : 0), camera, r.size);
}

}  // namespace

const std::vector<std::string>& scene_names() {
  static const std::vector<std::string> names{"facing", "tilted", "grazing", "fig6", "fig7", "fig8", "fig9", "turning", "contour", "chessboard"};
  return names;
}

bool is_scene_name(const std::string& name) {
  return std::find(scene_names().begin(), scene_names().end(), name) != scene_names().end();
}

std::optional<matrix> named_plane(const std::string& name) {
  for (const plane_by_name& p : planes)
    if (name == p.name) return p.coefficients;
  return std::nullopt;
}

matrix stretched(matrix m, screen_size size) {
  for (size_t row = 0; row < 9; row += 3) {
    m[row] *= 640.0 / size.width_px;
    m[row + 1] *= 480.0 / size.height_px;
  }
  return m;
}

std::shared_ptr<const map_list> plane_maps(const scene_request& r) {
  if (r.maps != nullptr) return r.maps;
  return maps_of(r, {r.texture ? *r.texture : photographic_pattern(512, 1)});
}

scene make_named_scene(const std::string& name, const scene_request& r) {
  for (const plane_by_name& p : planes)
    if (name == p.name) return plane_scene(p, r);
  if (name == "fig6") return ground_scene("fig6", r, squares_pattern(map_side, squares), map_side, 4, 60, 25);
  if (name == "fig7") return ground_scene("fig7", r, squares_pattern(map_side, squares), map_side, 1, 9, 12);
  if (name == "chessboard") return ground_scene("chessboard", r, chessboard_pattern(2 * chessboard_texels, 2), chessboard_texels, 1.5, 9, 25);
  if (name == "contour") return contour_scene("contour", r);
  if (name == "fig8") return cubes_scene("fig8", r, {-6.5, 6.2, 8.6}, {-0.2, 2.6, -1});
  if (name == "turning") return cubes_scene("turning", r, {-6.5, 6.2, 8.6}, {-0.2, 2.6, -1}, true);
  return cubes_scene("fig9", r, {8.8, 7.4, 6.2}, {-0.6, 1.9, -0.8});
}

}  // namespace spantex::sim
