// SPDX-License-Identifier: Apache-2.0
// Textured convex faces in world space (right-handed, y up) and cameras that look at them.
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scene.hpp"
#include "vector3d.hpp"

namespace spantex::sim {

struct world_vertex {
  vector3d position;
  double u, v;  // texels of level 0
};

struct ball { vector3d centre; double radius; };

struct world_face {
  std::vector<world_vertex> corners;  // 3..8, convex, planar
  int map_index;
  ball bound{};                       // holds every corner
};

// Faces that follow each other, and their ball.
struct face_group { size_t first, end; ball bound; };

struct world {
  std::string name;
  std::shared_ptr<const map_list> maps;
  std::vector<world_face> faces;
  vector3d centre{};
  double radius = 0;  // of the sphere about the centre that holds every corner
  std::vector<std::string> files{};  // that it was read from: its own, pictures beside it, archives
  std::vector<face_group> groups{};  // of all faces, in their order

  void measure();     // sets centre (of the bounding box) and radius, the faces' bounds, and groups
  bool has_area() const;  // any face larger than the engine's smallest square; after measure()
};

struct viewpoint { vector3d eye, target; };  // world units

struct camera_options {
  double yaw_degrees = 30, pitch_degrees = 20;  // where the camera stands: about the y axis from +z, and above the centre
  double distance_radii = 0;                    // from the centre, in radii; 0: framing_distance()
  double distance = 0;                          // the same in world units, if not 0
  std::optional<vector3d> eye, target;          // in world units; both together replace the four above
  bool skips_outside = true;                    // lens
  double vertical_degrees = 40;                 // angle of view of the picture's height, 10..150
};

// Where the camera stands for every corner to be in the picture, whatever the yaw, so that a turntable does not pulsate: from the centre, in world units.
double framing_distance(const world& w, const camera_options& camera, screen_size size);

// look_at()'s camera as OpenGL takes it: from world to clip coordinates, column by column; near is where look_at() has it, far behind the farthest corner. The world has an extent.
std::array<double, 16> clip_matrix(const world& w, const camera_options& camera, screen_size size);

class thread_team;
struct set_up_options {
  bool nearest_first = false;   // nearest_first(), without moving what is set up
  thread_team* team = nullptr;  // null: by the caller's thread alone
  bool leaves_hidden = false;   // faces of which nothing is seen if all of them are drawn, opaque, are not set up (occlusion.hpp); which of them does not depend on the team
};

// `w` as it was measured. Throws input_error: a camera too far away or at its own target.
scene look_at(const world& w, const camera_options& camera, screen_size size, const set_up_options& how = {});

}  // namespace spantex::sim
