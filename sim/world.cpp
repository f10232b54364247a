// SPDX-License-Identifier: Apache-2.0
#include "world.hpp"

#include <math.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <span>
#include <stdexcept>
#include <utility>

#include "occlusion.hpp"
#include "parallel.hpp"

namespace spantex::sim {
namespace {

constexpr double engine_radius = 256;       // the world is scaled so that its radius is this in the engine's s15.16
constexpr double farthest_radii = 100;      // 25600 < 2^15
constexpr double nearest_radii = 1.0 / 4096;

vector3d unit(const vector3d& a) { return a * (1 / length(a)); }

struct frame { vector3d eye, right, down, forward; };

double radians(double degrees) { return degrees * M_PI / 180; }

frame looking(const vector3d& eye, const vector3d& forward) {
  const vector3d up = fabs(forward[1]) > 0.9999 ? vector3d{0, 0, forward[1] > 0 ? 1.0 : -1.0} : vector3d{0, 1, 0};
  const vector3d right = unit(cross(forward, up));
  return {eye, right, cross(forward, right), forward};
}

vector3d direction(double yaw, double pitch) { return {sin(yaw) * cos(pitch), sin(pitch), cos(yaw) * cos(pitch)}; }

frame stand(const world& w, const camera_options& c, screen_size size) {
  vector3d eye, target = w.centre;
  if (c.eye && c.target) {
    eye = *c.eye;
    target = *c.target;
  } else {
    const double distance = c.distance > 0 ? c.distance : c.distance_radii > 0 ? c.distance_radii * w.radius : framing_distance(w, c, size);
    eye = target + direction(radians(c.yaw_degrees), radians(c.pitch_degrees)) * distance;
  }
  if (!(length(target - eye) > 0)) throw input_error(w.name + ": camera stands at its own target");
  return looking(eye, unit(target - eye));
}

int32_t along(const vector3d& axis, const world_vertex& p, const frame& f, double scale) { return to_fixed(dot((p.position - f.eye) * scale, axis)); }

vertex to_vertex(const world_vertex& p, const frame& f, double scale) {
  return {along(f.right, p, f, scale), along(f.down, p, f, scale), along(f.forward, p, f, scale), to_fixed(p.u), to_fixed(p.v)};
}

// Depth of the nearest corner, or one below `least_wanted`.
double nearest_depth(const world& w, const frame& f, double least_wanted) {
  const double rounding = 1e-9 * w.radius;
  double least = INFINITY;
  const auto is_farther = [&](const ball& b) { return dot(b.centre - f.eye, f.forward) - b.radius > least + rounding; };
  for (const face_group& group : w.groups) {
    if (is_farther(group.bound)) continue;
    for (size_t k = group.first; k < group.end; ++k) {
      const world_face& face = w.faces[k];
      if (is_farther(face.bound)) continue;
      for (const world_vertex& p : face.corners) least = std::min(least, dot(p.position - f.eye, f.forward));
      if (least < least_wanted) return least;
    }
  }
  return least;
}

ball bound_of(const std::vector<world_vertex>& corners) {
  ball b{corners[0].position, 0};
  for (size_t k = 1; k < corners.size(); ++k) b.centre = b.centre + (corners[k].position - b.centre) * (1.0 / double(k + 1));
  for (const world_vertex& c : corners) b.radius = std::max(b.radius, length(c.position - b.centre));
  return b;
}

// In one go: of neighbours, as files have them, whose balls lie close together.
face_group group_of(const std::vector<world_face>& faces, size_t first, size_t end) {
  face_group g{first, end, {{}, 0}};
  for (size_t k = first; k < end; ++k) g.bound.centre = g.bound.centre + (faces[k].bound.centre - g.bound.centre) * (1.0 / double(k - first + 1));
  for (size_t k = first; k < end; ++k) g.bound.radius = std::max(g.bound.radius, length(faces[k].bound.centre - g.bound.centre) + faces[k].bound.radius);
  return g;
}

// Sides of the picture, and the near plane, from outside. What lies beyond one of them is_outside(), however its corners are rounded.
class picture_sides {
 public:
  picture_sides(const lens& view, const frame& f, double scale) : eye_(f.eye) {
    constexpr double rounding = 1.0 / 16384;  // corners by 2^-17 along each axis, what is projected by 2^-16 pixels times depth, half a pixel or more from the axis
    const auto real = [](int32_t fixed) { return fixed / 65536.0; };
    const auto add = [&](const vector3d& outwards, double distance) { sides_.push_back({outwards, (distance + rounding) / scale}); };
    const auto add_pair = [&](const vector3d& axis, double focal, double middle, int32_t low, int32_t high) {
      add(unit(axis * -focal + f.forward * (low - middle)), 0);
      add(unit(axis * focal + f.forward * (middle - high)), 0);
    };
    add(f.forward * -1, -real(view.camera.near_z));
    add_pair(f.right, real(view.camera.focal_x), real(view.camera.centre_x), view.clip.x0, view.clip.x1);
    add_pair(f.down, real(view.camera.focal_y), real(view.camera.centre_y), view.clip.y0, view.clip.y1);
  }
  bool leave_out(const ball& b) const {
    const vector3d r = b.centre - eye_;
    return std::any_of(sides_.begin(), sides_.end(), [&](const side& s) { return dot(s.outwards, r) - b.radius > s.distance; });
  }

 private:
  struct side { vector3d outwards; double distance; };  // of length 1; from the eye, world units
  vector3d eye_;
  std::vector<side> sides_;
};

// In the engine's lengths.
double near_of(const world& w, const frame& f) {
  constexpr double part_of_nearest = 0.99;
  return std::max(part_of_nearest * nearest_depth(w, f, nearest_radii * w.radius) / w.radius, nearest_radii) * engine_radius;
}

// A camera, and who sets up what it sees.
struct sight {
  lens view;
  frame f;
  double scale;
  thread_team* team;

  size_t threads() const { return team == nullptr ? 1 : size_t(team->size()); }
  template <class Work>
  void run(size_t count, Work work) const {
    if (team != nullptr) return team->run(int(count), [&](int k) { work(size_t(k)); });
    for (size_t k = 0; k < count; ++k) work(k);
  }
};

// Those that set-up is to see, in the order in which they are drawn. Each thread sorts those of a part of the world.
std::vector<const world_face*> faces_in_view(const world& w, const sight& from, bool nearest_first) {
  const picture_sides sides(from.view, from.f, from.scale);
  const auto is_outside = [&](const ball& b) { return from.view.skips_outside && sides.leave_out(b); };
  std::vector<std::vector<uint64_t>> found(from.threads());  // depth, and which face
  from.run(found.size(), [&](size_t part) {
    std::vector<uint64_t>& here = found[part];
    for (size_t g = w.groups.size() * part / found.size(); g < w.groups.size() * (part + 1) / found.size(); ++g) {
      const face_group& group = w.groups[g];
      if (is_outside(group.bound)) continue;
      for (size_t k = group.first; k < group.end; ++k) {
        if (is_outside(w.faces[k].bound)) continue;
        int32_t least = INT32_MAX;
        if (nearest_first)
          for (const world_vertex& p : w.faces[k].corners) least = std::min(least, along(from.f.forward, p, from.f, from.scale));
        here.push_back((nearest_first ? uint64_t(std::max(least, from.view.camera.near_z)) << 32 : 0) | k);
      }
    }
    std::sort(here.begin(), here.end());
  });
  std::vector<uint64_t> all = std::move(found[0]);
  for (size_t part = 1; part < found.size(); ++part) {
    std::vector<uint64_t> both(all.size() + found[part].size());
    std::merge(all.begin(), all.end(), found[part].begin(), found[part].end(), both.begin());
    all = std::move(both);
  }
  std::vector<const world_face*> faces(all.size());
  std::transform(all.begin(), all.end(), faces.begin(), [&](uint64_t entry) { return &w.faces[uint32_t(entry)]; });
  return faces;
}

// before: null, where hidden ones are set up too.
void add_face(scene& s, const sight& from, const world_face& face, const occlusion* before) {
  vertex corners[max_polygon_vertices];
  int count = 0;
  for (const world_vertex& c : face.corners) corners[count++] = to_vertex(c, from.f, from.scale);
  if (before != nullptr && before->hides(corners, count, from.view)) ++s.polygons_hidden;
  else add_polygon(s, from.view, corners, count, face.map_index);
}

// Sets some faces up, a part of them a thread.
void add_faces(scene& s, std::span<const world_face* const> faces, const sight& from, const occlusion* before) {
  const size_t count = from.threads();
  std::vector<scene> others(count - 1);  // the first part goes where it belongs
  for (scene& part : others) part.name = s.name;
  from.run(count, [&](size_t k) {
    const auto at = [&](size_t part) { return faces.size() * part / count; };
    for (const world_face* face : faces.subspan(at(k), at(k + 1) - at(k))) add_face(k == 0 ? s : others[k - 1], from, *face, before);
  });
  for (scene& part : others) {
    s.items.insert(s.items.end(), std::move_iterator(part.items.begin()), std::move_iterator(part.items.end()));
    s.polygons_outside += part.polygons_outside;
    s.polygons_hidden += part.polygons_hidden;
  }
}

// Nearest ones first and in parts that double, each without what those before it hide.
void add_faces_that_show(scene& s, std::span<const world_face* const> faces, const sight& from) {
  constexpr size_t first_part = 16;
  occlusion before(s.size);
  for (size_t begin = 0, end; begin < faces.size(); begin = end) {
    end = std::min(faces.size(), begin + std::max(begin, first_part));
    const size_t known = s.items.size(), bands = from.threads();
    add_faces(s, faces.subspan(begin, end - begin), from, &before);
    from.run(bands, [&](size_t k) {
      for (size_t n = known; n < s.items.size(); ++n) before.add(s.items[n].shape, int(k), int(bands));
    });
  }
}

}  // namespace

double framing_distance(const world& w, const camera_options& c, screen_size size) {
  constexpr int yaw_steps = 32;
  constexpr double margin = 1.04;
  const double up = tan(radians(c.vertical_degrees) / 2), across = up * size.width_px / size.height_px;
  double distance = 0;
  for (int k = 0; k < yaw_steps; ++k) {
    const frame f = looking({}, direction(radians(360.0 * k / yaw_steps), radians(c.pitch_degrees)) * -1);
    for (const world_face& face : w.faces)
      for (const world_vertex& p : face.corners) {
        const vector3d r = p.position - w.centre;
        const double wanted = std::max(fabs(dot(r, f.right)) / across, fabs(dot(r, f.down)) / up);
        distance = std::max(distance, wanted * margin - dot(r, f.forward));
      }
  }
  return distance;
}

void world::measure() {
  vector3d low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};
  for (const world_face& f : faces)
    for (const world_vertex& c : f.corners)
      for (size_t k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], c.position[k]);
        high[k] = std::max(high[k], c.position[k]);
      }
  centre = (low + high) * 0.5;
  radius = 0;
  for (world_face& f : faces) {
    f.bound = bound_of(f.corners);
    for (const world_vertex& c : f.corners) radius = std::max(radius, length(c.position - centre));
  }
  constexpr size_t of_a_group = 16;
  groups.clear();
  for (size_t first = 0; first < faces.size(); first += of_a_group) groups.push_back(group_of(faces, first, std::min(first + of_a_group, faces.size())));
}

bool world::has_area() const {
  const double unit_length = ldexp(radius / engine_radius, -16);
  for (const world_face& f : faces)
    for (size_t k = 2; k < f.corners.size(); ++k) {
      const vector3d& origin = f.corners[0].position;
      if (length(cross(f.corners[k - 1].position - origin, f.corners[k].position - origin)) > unit_length * unit_length) return true;
    }
  return false;
}

std::array<double, 16> clip_matrix(const world& w, const camera_options& camera, screen_size size) {
  const frame f = stand(w, camera, size);
  const double near = near_of(w, f) * w.radius / engine_radius, far = 2 * (length(w.centre - f.eye) + w.radius);
  const double up = 1 / tan(radians(camera.vertical_degrees) / 2), across = up * size.height_px / size.width_px;
  const double depth = (far + near) / (far - near), depth_at_0 = -2 * far * near / (far - near);
  const auto row = [&](const vector3d& axis, double constant) { return std::array<double, 4>{axis[0], axis[1], axis[2], constant - dot(axis, f.eye)}; };
  const std::array<double, 4> rows[] = {row(f.right * across, 0), row(f.down * -up, 0), row(f.forward * depth, depth_at_0), row(f.forward, 0)};
  std::array<double, 16> columns;
  for (size_t k = 0; k < columns.size(); ++k) columns[k] = rows[k % 4][k / 4];
  return columns;
}

scene look_at(const world& w, const camera_options& camera, screen_size size, const set_up_options& how) {
  scene s{w.name, size, w.maps, {}};
  if (!(w.radius > 0)) return s;
  if (w.groups.empty() || w.groups.back().end != w.faces.size()) throw std::logic_error(w.name + ": not measured");
  const frame f = stand(w, camera, size);
  const double scale = engine_radius / w.radius, distance = length(w.centre - f.eye) / w.radius;
  if (distance > farthest_radii - 1) throw input_error(w.name + ": camera is more than 99 radii away from the model's centre");
  sight from{make_lens(size, radians(camera.vertical_degrees), near_of(w, f)), f, scale, how.team};
  from.view.skips_outside = camera.skips_outside;
  const std::vector<const world_face*> faces = faces_in_view(w, from, how.nearest_first);
  if (how.leaves_hidden) {
    add_faces_that_show(s, faces, from);
  } else {
    s.items.reserve(faces.size());
    add_faces(s, faces, from, nullptr);
  }
  s.polygons_outside += int(w.faces.size() - faces.size());
  return s;
}

}  // namespace spantex::sim
