// SPDX-License-Identifier: Apache-2.0
// Scenes: what is drawn, ready for the engine. Maps are owned; items hold the integer set-up that the engine draws, and what it was
// made of, from which the reference has its planes in double precision.
#pragma once
#include <math.h>
#include <stdint.h>

#include <memory>
#include <string>
#include <vector>

#include <spantex/plane.hpp>
#include <spantex/polygon.hpp>
#include <spantex/shade.hpp>
#include "ideal.hpp"
#include "map.hpp"

namespace spantex::sim {

struct screen_size { int width_px, height_px; };

struct drawable {
  bool is_polygon;   // `shape` with coverage and depth; otherwise the plane shape.map over the whole screen
  polygon shape;
  int map_index;
  std::vector<vertex> corners{};  // of a polygon, as it was given, and its lens
  projection camera{};
  matrix plane_matrix{};          // of a plane, as it was given
  colour_forms colours{{}, white, 0};  // of a polygon's vertices
};

// The surface's plane in double precision. A polygon's is found anew by each call.
matrix ideal_of(const drawable& item);

using map_list = std::vector<texture_map>;

struct scene {
  std::string name;
  screen_size size{};
  std::shared_ptr<const map_list> maps;  // shared by the frames of a turntable
  std::vector<drawable> items;
  int polygons_outside = 0, polygons_hidden = 0;  // left out before set-up

  const texture_map& map_of(const drawable& item) const { return (*maps)[size_t(item.map_index)]; }
  const texture_view& texture(const drawable& item) const { return map_of(item).view(); }
  bool uses_depth() const { return !items.empty() && items.front().is_polygon; }
};

// Camera space: x right, y down, z forward. Square pixels; the angle, in radians, is that of the picture's height.
struct lens {
  projection camera;
  rectangle clip;
  bool skips_outside = true;  // polygons outside the picture are not set up
};
lens make_lens(screen_size size, double vertical_angle, double near_z);

// Adds a convex polygon given by vertices in camera space. One that is edge-on, outside the picture or nearer than the lens allows is
// left out. Throws input_error for vertices beyond what the engine takes.
void add_polygon(scene& s, const lens& view, const vertex* vertices, int count, int map_index);
void add_polygon(scene& s, const lens& view, const vertex* vertices, const rgba8* colours, int count, int map_index);

// A plane over the whole screen from doubles, already checked; one wholly behind the viewer is left out.
void add_plane(scene& s, const matrix& m, int map_index);
void add_plane(scene& s, const kt88_plane& q, const view& v, int map_index);

// Puts polygons in order of their nearest corner, so that what they hide is skipped before it is loaded. The picture stays but where depths are equal.
void nearest_first(scene& s);

// Of a scene of polygons: pixels that they cover, each as often as it is covered, and pixels covered at all. The first over the second is the overdraw.
struct overdraw { uint64_t pixels_tested = 0, pixels_shown = 0; };
overdraw overdraw_of(const scene& s);

[[noreturn]] void refuse_as_too_large(double x);

// Rounded, halves away from zero; throws input_error beyond 32 bits.
inline int32_t to_fixed(double x, int fraction_bits = 16) {
  const double scaled = x * double(int64_t(1) << fraction_bits);
  if (!(fabs(scaled) < 2147483647.0)) refuse_as_too_large(x);
  const int32_t whole = int32_t(scaled);
  const double rest = scaled - whole;  // exact
  return whole + (rest >= 0.5) - (rest <= -0.5);
}

}  // namespace spantex::sim
