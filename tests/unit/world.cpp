// SPDX-License-Identifier: Apache-2.0
// Faces of a world seen by a camera: what is left out by its ball, sorted before it is set up or set up by threads is what the engine's own tests leave.
#include <algorithm>
#include <cmath>
#include <memory>

#include <sim/parallel.hpp>
#include <sim/reference.hpp>
#include <sim/world.hpp>
#include <tests/support.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

double within(random_source& r, double reach) { return double(r.between(-1000000, 1000000)) / 1000000 * reach; }

// Triangles of every size, far from the origin, some of them beyond the farthest that is seen.
world triangles(random_source& r) {
  world w{"triangles", std::make_shared<const map_list>(), {}, {}, 0};
  const vector3d middle{within(r, 1000), within(r, 1000), within(r, 1000)};
  for (int n = 0; n < 500; ++n) {
    const double size = std::exp2(within(r, 6));
    const vector3d at{middle[0] + within(r, 50), middle[1] + within(r, 50), middle[2] + within(r, 50)};
    world_face f{{}, 0};
    for (int k = 0; k < 3; ++k) f.corners.push_back({{at[0] + within(r, size), at[1] + within(r, size), at[2] + within(r, size)}, within(r, 200), within(r, 200)});
    w.faces.push_back(f);
  }
  w.measure();
  return w;
}

camera_options anywhere(random_source& r, const world& w) {
  const auto near_middle = [&](double reach) { return vector3d{w.centre[0] + within(r, reach), w.centre[1] + within(r, reach), w.centre[2] + within(r, reach)}; };
  camera_options c;
  c.eye = near_middle(w.radius * std::exp2(within(r, 3)));
  c.target = near_middle(w.radius);
  c.vertical_degrees = 80 + within(r, 70);
  return c;
}

bool same_items(const scene& a, const scene& b) {
  const auto same = [](const drawable& p, const drawable& q) {
    const auto same_vertex = [](const vertex& s, const vertex& t) { return s.x == t.x && s.y == t.y && s.z == t.z && s.u == t.u && s.v == t.v; };
    return p.shape == q.shape && p.map_index == q.map_index && std::equal(p.corners.begin(), p.corners.end(), q.corners.begin(), q.corners.end(), same_vertex);
  };
  return a.polygons_outside == b.polygons_outside && std::equal(a.items.begin(), a.items.end(), b.items.begin(), b.items.end(), same);
}

SPANTEX_CASE(what_is_left_out_covers_nothing) {
  random_source r(31);
  int left_out = 0, set_up = 0;
  for (int n = 0; n < 60; ++n) {
    const world w = triangles(r);
    for (int k = 0; k < 10; ++k) {
      const screen_size size{int(r.between(1, 700)), int(r.between(1, 500))};
      camera_options c = anywhere(r, w);
      const scene s = look_at(w, c, size);
      c.skips_outside = false;
      scene all = look_at(w, c, size);
      assert_int_equal(all.polygons_outside, 0);
      const auto outside = std::erase_if(all.items, [&](const drawable& d) { return is_outside(d.corners.data(), int(d.corners.size()), d.camera, {0, 0, size.width_px, size.height_px}); });
      assert_in_range(s.polygons_outside, outside, w.faces.size() - s.items.size());
      left_out += all.polygons_outside = s.polygons_outside;
      set_up += int(s.items.size());
      assert_true(same_items(s, all));
    }
  }
  assert_true(left_out > 50000);
  assert_true(set_up > 50000);
}

SPANTEX_CASE(the_near_plane_lies_before_the_nearest_corner) {
  random_source r(35);
  int nearest_in_front = 0;
  for (int n = 0; n < 200; ++n) {
    const world w = triangles(r);
    const camera_options c = anywhere(r, w);
    double way = 0, least = INFINITY;
    for (size_t k = 0; k < 3; ++k) way += std::pow((*c.target)[k] - (*c.eye)[k], 2);
    for (const world_face& f : w.faces)
      for (const world_vertex& p : f.corners) {
        double depth = 0;
        for (size_t k = 0; k < 3; ++k) depth += (p.position[k] - (*c.eye)[k]) * ((*c.target)[k] - (*c.eye)[k]) / std::sqrt(way);
        least = std::min(least, depth);
      }
    const scene s = look_at(w, c, {320, 240});
    if (s.items.empty()) continue;
    nearest_in_front += least > 0;
    const double wanted = std::max(256 * 0.99 * least / w.radius, 256 / 4096.0);
    assert_true(std::abs(s.items[0].camera.near_z - 65536 * wanted) < 0.6);
  }
  assert_true(nearest_in_front > 40);
}

SPANTEX_CASE(order_and_threads_leave_set_up_as_it_is) {
  random_source r(32);
  thread_team two(2), many(19), *const none = nullptr;
  for (int n = 0; n < 20; ++n) {
    const world w = triangles(r);
    const camera_options c = anywhere(r, w);
    const screen_size size{320, 240};
    scene s = look_at(w, c, size);
    for (thread_team* const team : {&two, &many}) assert_true(same_items(s, look_at(w, c, size, {false, team})));
    nearest_first(s);
    for (thread_team* const team : {none, &two, &many}) assert_true(same_items(s, look_at(w, c, size, {true, team})));
  }
}

// Of walls before a crowd of small triangles, most are hidden: every pixel shows what it showed, as deep; which are left out does not depend on order or threads.
SPANTEX_CASE(what_others_hide_is_not_set_up) {
  random_source r(36);
  thread_team two(2), many(5), *const none = nullptr;
  int set_up = 0, hidden = 0;
  for (int n = 0; n < 40; ++n) {
    world w = triangles(r);
    w.faces.resize(50);
    for (int k = 0; k < 800; ++k) {  // walls, and small ones, as meshes have them, some of four corners
      const vector3d at{w.centre[0] + within(r, 50), w.centre[1] + within(r, 50), w.centre[2] + within(r, 50)};
      const double size = k < 60 ? 70 : 3;
      world_face f{{}, 0};
      for (int c = 0; c < 3; ++c) f.corners.push_back({{at[0] + within(r, size), at[1] + within(r, size), at[2] + within(r, size)}, within(r, 2000), within(r, 2000)});
      if (k % 16 == 0) {
        world_vertex fourth = f.corners[2];
        for (size_t axis = 0; axis < 3; ++axis) fourth.position[axis] += f.corners[0].position[axis] - f.corners[1].position[axis];
        f.corners.push_back(fourth);
      }
      w.faces.push_back(f);
    }
    w.measure();
    for (int k = 0; k < 4; ++k) {
      const screen_size size{int(r.between(1, 400)), int(r.between(1, 300))};
      const camera_options c = anywhere(r, w);
      const bool nearest = r.between(0, 3) != 0;
      const scene all = look_at(w, c, size, {nearest, none, false}), some = look_at(w, c, size, {nearest, none, true});
      assert_int_equal(all.polygons_hidden, 0);
      for (thread_team* const team : {&two, &many}) {
        const scene by_team = look_at(w, c, size, {nearest, team, true});
        assert_true(same_items(some, by_team));
        assert_int_equal(by_team.polygons_hidden, some.polygons_hidden);
      }
      const std::vector<int> seen = visible_items(all), still = visible_items(some);
      for (size_t at = 0; at < seen.size(); ++at) {
        assert_int_equal(seen[at] < 0, still[at] < 0);
        if (seen[at] >= 0) assert_true(all.items[size_t(seen[at])].shape == some.items[size_t(still[at])].shape);
      }
      set_up += int(some.items.size());
      hidden += some.polygons_hidden;
      assert_true(all.items.size() <= some.items.size() + size_t(some.polygons_hidden));  // some of the hidden would have been found outside, or degenerate
    }
  }
  print_message("%d hidden, %d set up\n", hidden, set_up);
  assert_true(hidden > 5000 && set_up > 5000);
}

SPANTEX_CASE(a_turntable_s_distance_is_found_once) {
  random_source r(33);
  const world w = triangles(r);
  camera_options c;
  c.pitch_degrees = 35;
  static scene s, t;
  s = look_at(w, c, {200, 100});
  assert_int_equal(s.polygons_outside, 0);
  c.distance = framing_distance(w, c, {200, 100});
  t = look_at(w, c, {200, 100});
  assert_true(same_items(s, t));
  c.distance = 3 * w.radius;
  t = look_at(w, c, {200, 100});
  assert_false(same_items(s, t));
  c.distance = 0;
  c.distance_radii = 3;
  s = look_at(w, c, {200, 100});
  assert_true(same_items(s, t));
}

SPANTEX_CASE(numbers_are_rounded_as_by_lround) {
  random_source r(34);
  for (const double x : {0.0, 0.5, -0.5, 1.5, -1.5, 2.5, 0.49999999999999994, -0.49999999999999994, 32767.999984741211, -32767.999984741211, 2147483646.5, -2147483646.5, 2147483646.4})
    assert_int_equal(to_fixed(x, 0), std::lround(x));
  for (int n = 0; n < 1000000; ++n) {
    const double x = std::ldexp(double(int64_t(r.next())), -int(r.between(48, 80)));
    assert_int_equal(to_fixed(x), std::lround(x * 65536));
    const double half = double(r.between(-2147483646, 2147483645)) + 0.5;
    assert_int_equal(to_fixed(half, 0), std::lround(half));
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(what_is_left_out_covers_nothing),
      cmocka_unit_test(the_near_plane_lies_before_the_nearest_corner),
      cmocka_unit_test(order_and_threads_leave_set_up_as_it_is),
      cmocka_unit_test(what_others_hide_is_not_set_up),
      cmocka_unit_test(a_turntable_s_distance_is_found_once),
      cmocka_unit_test(numbers_are_rounded_as_by_lround),
  };
  return run_suite("world", tests);
}
