// SPDX-License-Identifier: Apache-2.0
// Models from any file that assimp reads, with their own textures.
//
// Textures: embedded ones, else files. A name is taken relative to the model's folder, with either kind of slash, then by
// its last part alone; case is ignored where the exact name does not exist. Assimp's texture coordinates have their origin bottom
// left, so v is turned over. Faces are triangles. Wrap modes are the material's. A material without a texture becomes a map of
// one texel, its diffuse colour. Models are drawn opaque.
#pragma once
#include <optional>
#include <string>

#include "map.hpp"
#include "world.hpp"

namespace spantex::sim {

struct model_options {
  prefilter levels = prefilter::box;
  std::optional<wrap> wrap_u, wrap_v;  // instead of the material's
  texel_format format = texel_format::rgba8888;
  colour_space colours = colour_space::coded;
  int most_levels = 0;                  // of every map; 0: all
  level_making making = level_making::at_once;
};

// Throws input_error: unreadable file, no face that has an area, no texture coordinates at all or none in a mesh with a texture, a
// texture that is missing or unreadable, a missing material library of an OBJ file.
world load_model(const std::string& path, const model_options& options);

// Appends a face of 3 or 4 corners whose coordinates are widths and heights of its map, in texels, whole periods taken off; where they exceed 32768 texels it is cut along lines of the map, the same
// lines for every face that is cut. Throws input_error where that does not help (a clamped map), takes more than 1024 parts, or makes more than 2^20 faces.
void add_in_texels(std::vector<world_face>& to, world_face whole, const texture_view& map, const std::string& path);

}  // namespace spantex::sim
