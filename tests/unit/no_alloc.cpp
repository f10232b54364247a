// SPDX-License-Identifier: Apache-2.0
// Nothing in set-up, drawing or the direct engine allocates: malloc, calloc, realloc and operator new are counted while every filter,
// profile and wrap mode draws planes and polygons.
#include <sim/figures.hpp>

#include <tests/support.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

constexpr int32_t one = 1 << 16, width = 96, height = 64;
constexpr projection camera{64 * one, 64 * one, 48 * one, 32 * one, one / 16};
rgba8 frame[width * height];
uint32_t depth_values[width * height];

template <profile P>
struct device {
  fixed_profile<P> prof;
  direct_engine<fixed_profile<P>> engine;
};
template <profile P>
device<P> devices;

status draw_polygons(auto& r, const texture_view& t, filter kind) {
  const vertex floor[4] = {{-9 * one, one, -2 * one, 0, 0}, {9 * one, one, -2 * one, 200 * one, 0},
                           {9 * one, one, 20 * one, 200 * one, 300 * one}, {-9 * one, one, 20 * one, 0, 300 * one}};
  const vertex wall[3] = {{-one, -one, 3 * one, 0, 0}, {2 * one, -one, 4 * one, 90 * one, 0}, {0, 2 * one, 2 * one, 0, 90 * one}};
  polygon p{};
  SPANTEX_TRY(make_polygon(floor, 4, camera, {0, 0, width, height}, p));
  SPANTEX_TRY(r.draw(p, t, kind, {depth_values}));
  SPANTEX_TRY(make_polygon(wall, 3, camera, {0, 0, width, height}, p));
  return r.draw(p, t, kind, {depth_values});
}

template <profile P>
status draw_everything(const synthetic_map& map, wrap w, filter kind) {
  const rgba8* levels[max_levels] = {};
  for (size_t k = 0; k < map.levels.size(); ++k) levels[k] = map.levels[k].texels.data();
  texture_view t;
  SPANTEX_TRY(texture_view::make(levels, int(map.levels.size()), map.levels[0].width, map.levels[0].height, w, w, t));
  device<P>& d = devices<P>;
  renderer<direct_engine<fixed_profile<P>>, fixed_profile<P>> r(d.engine, d.prof, {frame, width, height, width});
  for (int k = 0; k < sample_plane_count; ++k) {
    plane p{};
    SPANTEX_TRY(make_plane(sample_homography(k), {0, 0, 640, 480}, p));
    SPANTEX_TRY(r.draw(p, t, kind, {0, 0, width, height}));
  }
  SPANTEX_TRY(draw_polygons(r, t, kind));
  return r.finish();
}

template <profile P>
void check_profile() {
  const synthetic_map* const maps[] = {&photographic_map(64, 64), &photographic_map(100, 37)};
  for (const synthetic_map* m : maps)
    for (const wrap w : all_wraps)
      for (const filter kind : all_filters) {
        for (uint32_t& v : depth_values) v = 0;
        allocation_trap::begin();
        const status s = draw_everything<P>(*m, w, kind);
        const uint64_t allocations = allocation_trap::end();
        SPANTEX_ASSERT_OK(s);
        assert_int_equal(allocations, 0);
      }
}

}  // namespace

SPANTEX_CASE(seed_draws_without_allocating) { check_profile<profiles::seed>(); }
SPANTEX_CASE(compact_draws_without_allocating) { check_profile<profiles::compact>(); }
SPANTEX_CASE(default_draws_without_allocating) { check_profile<profiles::standard>(); }
SPANTEX_CASE(exact_draws_without_allocating) { check_profile<profiles::exact>(); }

SPANTEX_CASE(planes_from_a_camera_are_set_up_without_allocating) {
  const kt88_plane q{{0, 1 << 30, 0}, -one, {64 * one, 0, 0}, {0, 0, 64 * one}, {0, one, 0}, 0, 0};
  const view s{8 << 20, 8 << 20, width, height};
  plane p{};
  allocation_trap::begin();
  const status result = make_plane(q, s, p);
  const uint64_t allocations = allocation_trap::end();
  SPANTEX_ASSERT_OK(result);
  assert_int_equal(allocations, 0);
}

// Every scene that the command knows by name, every profile: the scene is made before, drawing happens inside the trap.
template <profile P>
static void check_scenes() {
  static direct_engine<fixed_profile<P>> engine;
  static picture out;
  static std::vector<uint32_t> depth;
  constexpr screen_size size{320, 240};
  for (const std::string& name : scene_names()) {
    scene_request request;
    request.size = size;
    static scene s;
    s = make_named_scene(name, request);
    out.reset(size.width_px, size.height_px);
    depth.assign(out.pixels.size(), 0);
    for (filter kind : {filter::bilinear, filter::trilinear}) {
      allocation_trap::begin();
      renderer<direct_engine<fixed_profile<P>>, fixed_profile<P>> r(engine, {}, out.frame());
      status result = status::ok;
      for (const drawable& item : s.items) {
        const status drawn = item.is_polygon ? r.draw(item.shape, s.texture(item), kind, {depth.data()})
                                             : r.draw(item.shape.map, s.texture(item), kind, out.area());
        if (drawn != status::ok) result = drawn;
      }
      if (r.finish() != status::ok) result = status::device_error;
      const uint64_t allocations = allocation_trap::end();
      SPANTEX_ASSERT_OK(result);
      assert_int_equal(allocations, 0);
    }
  }
}
SPANTEX_CASE(every_scene_draws_without_allocating) {
  check_scenes<profiles::seed>();
  check_scenes<profiles::compact>();
  check_scenes<profiles::standard>();
  check_scenes<profiles::exact>();
}

// The trap itself works: each way to allocate is seen.
SPANTEX_CASE(the_trap_sees_every_way_to_allocate) {
  if (short_run()) skip();  // the address sanitizer puts its own allocator in front of the trap
  void* volatile kept;
  allocation_trap::begin();
  kept = std::malloc(8);
  kept = std::realloc(kept, 16);
  std::free(kept);
  kept = std::calloc(2, 8);
  std::free(kept);
  kept = ::operator new(24);
  ::operator delete(kept);
  kept = ::operator new[](24);
  ::operator delete[](kept);
  assert_int_equal(allocation_trap::end(), 5);
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(every_scene_draws_without_allocating),
      cmocka_unit_test(the_trap_sees_every_way_to_allocate),
      cmocka_unit_test(seed_draws_without_allocating),
      cmocka_unit_test(compact_draws_without_allocating),
      cmocka_unit_test(default_draws_without_allocating),
      cmocka_unit_test(exact_draws_without_allocating),
      cmocka_unit_test(planes_from_a_camera_are_set_up_without_allocating),
  };
  return run_suite("no_alloc", tests);
}
