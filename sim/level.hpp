// SPDX-License-Identifier: Apache-2.0
// Levels of Quake III (.bsp, version 46): drawn faces, curved patches as triangles, textures by name, places where somebody may stand.
//
// Why not by assimp, whose importer takes .pk3 alone (5.2.5): it reads an archive's first map only (the name after a comma is lost), leaves the indices of
// faces uninitialised, drops curved patches, entities and the names of textures in other archives, and believes every offset of a damaged file.
//
// Textures: NAME, NAME.tga, .jpg, .jpeg or .png in the map's archive, in the folder that holds maps/ (or the archive), in the archives there. A name without a
// picture, such as that of a shader script, becomes grey. Left out: light maps, shader scripts, billboards, and faces of the sky, whose place is background, or
// marked as not to be drawn. Everything is opaque. Quake's z axis becomes y, its y axis -z.
#pragma once
#include <string>
#include <vector>

#include "model.hpp"
#include "world.hpp"

namespace spantex::sim {

struct level {
  world drawn;
  std::vector<vector3d> places;       // eyes above players' starts, then things lying about
  std::vector<std::string> missing;   // textures that are grey
};

bool is_level(const std::string& path);  // by its end, of any case: .bsp, .pk3

// `map`: which one of an archive, without folder and .bsp, in any case; may be empty if there is one only. Throws input_error: unreadable, not a map, damaged, nothing to
// draw, a texture that is no picture, more than 2^20 triangles (1.5 GB with what a frame sets up of them; the largest of OpenArena's levels has 41 151).
level load_level(const std::string& path, const std::string& map, const model_options& options);

// A walk from place to place, the nearest that can be seen from the last one, eyes ahead; a leap where none can. Frames are equally far apart.
// Through the first 512 places, fewer where there are more than 32768 faces (90 of 2^20), so that it takes seconds; OpenArena's levels have 198 at most, of 34 497 faces.
// `l` as its world was measured. Throws input_error: no place.
std::vector<viewpoint> tour(const level& l, int frames);

}  // namespace spantex::sim
