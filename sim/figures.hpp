// SPDX-License-Identifier: Apache-2.0
// Scenes by name.
//   facing, tilted, grazing   one plane with a 512-texel map: camera 1 above it, 40 x 30 degrees of view, pitched down 75, 40, 18
//                             degrees, turned by 20; coefficients for 640x480, stretched to other sizes
//   fig6                      KT88's figure 6: a surface seen at a large angle
//   fig7                      figure 7: a long surface seen at a grazing angle, up to its horizon
//   fig8, fig9                figures 8 and 9: thirty faces, two maps; a random one on the six faces of the background, squares on the
//                             twenty-four of four cubes; two views
//   turning                   figure 8 with a camera that stands still: the cube in the air turns instead
//   contour                   a contour map of a few shapes up to its horizon, from 16 pixels a texel to 16 texels a pixel; for filter contour
//   chessboard                GCK09's test: (floor X + floor Z) mod 2 on the ground, to the horizon; a map of 2x2 squares that repeats
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "image.hpp"
#include "ideal.hpp"
#include "map.hpp"
#include "world.hpp"

namespace spantex::sim {

inline constexpr int chessboard_texels = 32;  // along a square of the chessboard

struct scene_request {
  screen_size size{640, 480};
  prefilter levels = prefilter::box;
  wrap wrap_u = wrap::repeat, wrap_v = wrap::repeat;
  texel_format format = texel_format::rgba8888;  // of every map
  colour_space colours = colour_space::coded;    // likewise
  std::optional<image> texture;     // of the three planes; a photographic pattern if empty
  std::shared_ptr<const map_list> maps;  // or their map, prepared: levels and wraps above do not apply
  double turn_degrees = 0;          // of the camera, for turntables; of a cube in `turning`
  int most_levels = 0;              // of every map that is made here; 0: all
  level_making making = level_making::at_once;  // likewise
};

const std::vector<std::string>& scene_names();
bool is_scene_name(const std::string& name);
std::optional<matrix> named_plane(const std::string& name);  // facing, tilted, grazing at 640x480

// The same view of a plane at another size than 640x480: x and y scaled.
matrix stretched(matrix m, screen_size size);

// The map of a plane, as the request says.
std::shared_ptr<const map_list> plane_maps(const scene_request& request);

// For a name of scene_names().
scene make_named_scene(const std::string& name, const scene_request& request);

}  // namespace spantex::sim
