// SPDX-License-Identifier: Apache-2.0
#include "sweep_subjects.hpp"

#include <math.h>

#include <algorithm>
#include <filesystem>

#include "figures.hpp"
#include "pattern.hpp"
#include "quality.hpp"

namespace spantex::sim {
namespace {

constexpr const char* map_names[] = {"photo", "random", "squares", "chessboard"};
constexpr int squares_per_side = 8;
constexpr double view_degrees = 40, anchor_texels = 100.25;  // angle of view of the width; coordinates at the picture's centre

image map_picture(const sweep_subject& s) {
  if (s.map == "photo") return photographic_pattern(s.map_side, 1);
  if (s.map == "random") return random_pattern(s.map_side, 7);
  if (s.map == "squares") return squares_pattern(s.map_side, squares_per_side);
  if (s.map == "chessboard") return chessboard_pattern(s.map_side, squares_per_side);
  return load_image((std::filesystem::path(s.map_folder) / s.map).string());
}

std::string numbers(std::initializer_list<int> list) {
  std::string text;
  for (const int n : list) text += "|" + std::to_string(n);
  return text;
}

std::string name_of_map(const sweep_subject& s) {
  return s.map + numbers({s.map_side, int(s.levels), int(s.format), int(s.colours), int(s.wraps)});
}

// A plane through a point at distance 1 straight ahead, inclined by the pitch, square pixels.
matrix view_matrix(const sweep_subject& s) {
  const double pixel = 2 * tan(view_degrees * M_PI / 360) / s.size.width_px;  // of a ray per pixel
  const double scale = exp2(s.minification_16 / 16.0) / pixel, pitch = s.pitch_degrees * M_PI / 180, turn = s.turn_degrees * M_PI / 180;
  // Rays are (x', y', 1). U lies across the line of sight, V along it: u W = scale sin(pitch) x', v W = scale y', W = y' cos(pitch) + sin(pitch).
  using row = std::array<double, 3>;
  const auto of_pixels = [&](double x, double y, double one) {
    return row{x * pixel, y * pixel, one - x * pixel * s.size.width_px / 2 - y * pixel * s.size.height_px / 2};
  };
  const row w = of_pixels(0, cos(pitch), sin(pitch)), across = of_pixels(scale * sin(pitch), 0, 0), along = of_pixels(0, scale, 0);
  matrix m{};
  for (size_t k = 0; k < 3; ++k) {
    m[k] = cos(turn) * across[k] - sin(turn) * along[k] + anchor_texels * w[k];
    m[3 + k] = sin(turn) * across[k] + cos(turn) * along[k] + anchor_texels * w[k];
    m[6 + k] = w[k];
  }
  return m;
}

void move(matrix& m, camera_motion how, int frame) {
  switch (how) {
    case camera_motion::pan:
      for (size_t row = 0; row < 9; row += 3) m[row + 2] += m[row] * frame / 16 + m[row + 1] * frame / 32;
      break;
    case camera_motion::zoom:
      for (const size_t k : {0, 1, 3, 4, 6, 7}) m[k] *= 1 - frame / 512.0;
      break;
    case camera_motion::approach:
      for (size_t k = 0; k < 6; ++k) m[k] *= 1 - frame / 256.0;
      break;
    case camera_motion::none:
    case camera_motion::turn: break;
  }
}

constexpr double turn_per_frame_degrees = 0.25;

bool is_matrix_scene(const std::string& scene) { return scene == "view" || named_plane(scene).has_value(); }

scene make_scene(const sweep_subject& s, int frame, const std::shared_ptr<const map_list>& maps) {
  if (!is_matrix_scene(s.scene)) {
    scene_request r;
    r.size = s.size;
    r.levels = s.levels;
    r.wrap_u = r.wrap_v = s.wraps;
    r.format = s.format;
    r.colours = s.colours;
    r.turn_degrees = s.motion == camera_motion::turn ? frame * turn_per_frame_degrees : 0;
    return make_named_scene(s.scene, r);
  }
  matrix m = s.scene == "view" ? view_matrix(s) : *named_plane(s.scene);
  if (s.scene != "view")
    for (size_t row = 0; row < 9; row += 3) {
      m[row] *= 640.0 / s.size.width_px;
      m[row + 1] *= 480.0 / s.size.height_px;
    }
  move(m, s.motion, frame);
  scene made{s.scene, s.size, maps, {}};
  add_plane(made, m, 0);
  return made;
}

}  // namespace

const std::vector<std::string>& sweep_scene_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all = scene_names();
    std::erase(all, "turning");  // a picture of it alone is fig8's
    all.push_back("view");
    return all;
  }();
  return names;
}

bool is_sweep_map(const std::string& name) { return std::find(std::begin(map_names), std::end(map_names), name) != std::end(map_names); }

bool moves(const std::string& scene, camera_motion how) {
  if (how == camera_motion::none) return true;
  return (how == camera_motion::turn) != is_matrix_scene(scene) && scene != "contour";
}

std::string name_of(const sweep_subject& s, int frame) {
  return s.scene + "|" + name_of_map(s) + numbers({s.size.width_px, s.size.height_px, s.pitch_degrees, s.minification_16, s.turn_degrees, int(s.motion), frame});
}

std::shared_ptr<const scene> sweep_subjects::scene_of(const sweep_subject& s, int frame) {
  return scenes_.get(name_of(s, frame), [&] {
    std::shared_ptr<const map_list> maps;
    if (is_matrix_scene(s.scene))
      maps = *maps_.get(name_of_map(s), [&] {
        scene_request r;
        r.levels = s.levels;
        r.wrap_u = r.wrap_v = s.wraps;
        r.format = s.format;
        r.colours = s.colours;
        r.texture = map_picture(s);
        return plane_maps(r);
      });
    return make_scene(s, frame, maps);
  });
}

std::shared_ptr<const sweep_reference> sweep_subjects::reference_of(const sweep_subject& given, int frame) {
  sweep_subject s = given;
  s.levels = prefilter::box;
  s.format = texel_format::rgba8888;
  return references_.get(name_of(s, frame), [&] {
    const std::shared_ptr<const scene> plain = scene_of(s, frame);
    sweep_reference r{render_reference(*plain, sweep_background, 1), {}, visible_items(*plain), 0};
    r.rounded = rounded(r.ideal);
    for (const int item : r.items) r.shown += item >= 0;
    return r;
  });
}

}  // namespace spantex::sim
