// SPDX-License-Identifier: Apache-2.0
// A walk through a level, seen from its places.
#include <math.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include "level.hpp"

namespace spantex::sim {
namespace {

double distance(const vector3d& a, const vector3d& b) { return length(a - b); }

// Moeller and Trumbore 1997, from both sides.
bool crosses(const vector3d& from, const vector3d& way, const world_face& triangle) {
  const vector3d& a = triangle.corners[0].position;
  const vector3d one = triangle.corners[1].position - a, two = triangle.corners[2].position - a, p = cross(way, two);
  const double volume = dot(one, p);
  if (volume == 0) return false;
  const vector3d s = from - a, q = cross(s, one);
  const double u = dot(s, p) / volume, v = dot(way, q) / volume, t = dot(two, q) / volume;
  return u >= 0 && v >= 0 && u + v <= 1 && t >= 0 && t <= 1;
}

// Balls first: few faces are near the line.
bool sees(const world& w, const vector3d& from, const vector3d& to) {
  const double rounding = 1e-9 * w.radius;
  const vector3d way = to - from;
  const double part_a_unit = 1 / dot(way, way);
  return std::none_of(w.faces.begin(), w.faces.end(), [&](const world_face& f) {
    const vector3d centre = f.bound.centre - from, off = centre - way * std::clamp(dot(centre, way) * part_a_unit, 0.0, 1.0);
    const double reach = f.bound.radius + rounding;
    return dot(off, off) <= reach * reach && crosses(from, way, f);
  });
}

using walk = std::vector<vector3d>;

// No more places than take 2^32 tests of a face where none is seen from another.
std::vector<vector3d> places_to_walk(const level& l) {
  constexpr double most = 512, most_tests = 1ull << 32;
  const double n = std::min(most, sqrt(2 * most_tests / double(l.drawn.faces.size())));
  return {l.places.begin(), l.places.begin() + std::ptrdiff_t(std::min(double(l.places.size()), n))};
}

std::vector<walk> walks_of(const level& l) {
  std::vector<vector3d> left = places_to_walk(l);
  std::vector<walk> walks;
  while (!left.empty()) {
    walk w{left.front()};
    left.erase(left.begin());
    for (bool found = true; found;) {
      std::sort(left.begin(), left.end(), [&](const vector3d& a, const vector3d& b) { return distance(a, w.back()) < distance(b, w.back()); });
      const auto next = std::find_if(left.begin(), left.end(), [&](const vector3d& p) { return distance(p, w.back()) > 1 && sees(l.drawn, w.back(), p); });
      found = next != left.end();
      if (found) w.push_back(*next), left.erase(next);
    }
    walks.push_back(std::move(w));
  }
  return walks;
}

double length_of(const walk& w) {
  double sum = 0;
  for (size_t k = 1; k < w.size(); ++k) sum += distance(w[k - 1], w[k]);
  return sum;
}

struct on_walk { vector3d position, ahead; };  // ahead: of length 1

// Beyond the end straight on.
on_walk at(const walk& w, double way) {
  size_t k = 1;
  for (; k + 1 < w.size() && way > distance(w[k - 1], w[k]); ++k) way -= distance(w[k - 1], w[k]);
  const vector3d ahead = (w[k] - w[k - 1]) * (1 / distance(w[k - 1], w[k]));
  return {w[k - 1] + ahead * way, ahead};
}

viewpoint look_ahead(const walk& w, double way) {
  constexpr double eyes_ahead = 160, least = 16;  // Quake's units; a player is 56 tall
  const on_walk here = at(w, way), there = at(w, way + eyes_ahead);
  return {here.position, distance(here.position, there.position) < least ? here.position + here.ahead : there.position};
}

// Where nobody can go anywhere: once around on the first place.
std::vector<viewpoint> turn_about(const vector3d& eye, int frames) {
  std::vector<viewpoint> views;
  for (int k = 0; k < frames; ++k) views.push_back({eye, eye + vector3d{sin(2 * M_PI * k / frames), 0, -cos(2 * M_PI * k / frames)}});
  return views;
}

}  // namespace

std::vector<viewpoint> tour(const level& l, int frames) {
  if (l.places.empty()) throw input_error(l.drawn.name + ": the level has no place to stand; give a camera");
  std::vector<walk> walks = walks_of(l);
  std::erase_if(walks, [](const walk& w) { return w.size() < 2; });
  double total = 0;
  for (const walk& w : walks) total += length_of(w);
  if (walks.empty()) return turn_about(l.places.front(), frames);
  std::vector<viewpoint> views;
  for (int k = 0; k < frames; ++k) {
    double way = total * k / frames;
    size_t n = 0;
    for (; n + 1 < walks.size() && way >= length_of(walks[n]); ++n) way -= length_of(walks[n]);
    views.push_back(look_ahead(walks[n], way));
  }
  return views;
}

}  // namespace spantex::sim
