// SPDX-License-Identifier: Apache-2.0
// What `spantex bench` draws: the three planes of sim/figures.hpp, two of its own (close: magnified five to eight times; far: a wall to the
// side, its map minified two to six times across) and a model; and scenes that grow in one thing alone.
#pragma once
#include <string>
#include <vector>

#include <sim/scene.hpp>

namespace spantex::tool {

struct bench_maps {
  std::string texture;  // of the planes, a picture; empty: made here, the same on every machine
  std::string models = "/usr/share/assimp/models";
  colour_space colours = colour_space::coded;
};

const std::vector<std::string>& bench_scene_names();

// For a name of bench_scene_names(). Throws sim::input_error: no such name, a missing file.
sim::scene make_bench_scene(const std::string& name, sim::screen_size size, const bench_maps& maps);

// A plane of anybody's choice, named "matrix".
sim::scene make_bench_plane(const sim::matrix& m, sim::screen_size size, const bench_maps& maps);

// A wall that fills the picture, in side x side squares.
sim::scene wall_of_squares(int side, sim::screen_size size);
// So many walls one behind the other, each over the whole picture.
sim::scene layers(int count, bool nearest_first, sim::screen_size size);
// The tilted plane with a map of so many texels a side, the same view of it.
sim::scene plane_with_map(int side, sim::screen_size size);

}  // namespace spantex::tool
