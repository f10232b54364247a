// SPDX-License-Identifier: Apache-2.0
// Scenes by name.
//   facing, tilted, grazing   one plane with a 512-texel map: camera 1 above it, 40 x 30 degrees of view, pitched down 75, 40, 18
//                             degrees, turned by 20; coefficients for 640x480, stretched to other sizes
//   fig6                      KT88's figure 6: a surface seen at a large angle
//   fig7                      figure 7: a long surface seen at a grazing angle, up to its horizon
//   fig8, fig9                figures 8 and 9: thirty faces, two maps; a random one on the six faces of the background, squares on the
//                             twenty-four of four cubes; two views
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "image.hpp"
#include "ideal.hpp"
#include "map.hpp"
#include "world.hpp"

namespace spantex::sim {

struct scene_request {
  screen_size size{640, 480};
  prefilter levels = prefilter::box;
  wrap wrap_u = wrap::repeat, wrap_v = wrap::repeat;
  std::optional<image> texture;     // of the three planes; a photographic pattern if empty
  double turn_degrees = 0;          // of the camera, for turntables
};

const std::vector<std::string>& scene_names();
bool is_scene_name(const std::string& name);
std::optional<matrix> named_plane(const std::string& name);  // facing, tilted, grazing at 640x480

// For a name of scene_names().
scene make_named_scene(const std::string& name, const scene_request& request);

}  // namespace spantex::sim
