// SPDX-License-Identifier: Apache-2.0
// Host kernels: the same bytes as the scalar datapath, for every filter they draw.
#include <tests/support.hpp>

#include <hal/kernels/rows.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

using prof = fixed_profile<profiles::standard>;
using engine_type = direct_engine<prof>;
using renderer_type = renderer<engine_type, prof>;

constexpr filter filters[] = {filter::nearest, filter::bilinear, filter::mip_bilinear, filter::trilinear, filter::aniso};
constexpr wrap wraps[] = {wrap::repeat, wrap::clamp, wrap::mirror};

picture by_kernel, by_scalar;

// Neighbours as different as can be: no error hides.
const synthetic_map& random_map(int32_t width, int32_t height) {
  static random_source random(5);
  return make_map(width, height, [](int32_t, int32_t) {
    const uint64_t n = random.next();
    return rgba8{uint8_t(n), uint8_t(n >> 8), uint8_t(n >> 16), uint8_t(n >> 24)};
  });
}

uint64_t span_count(rectangle r) { return uint64_t((r.x1 - 1) / span_side - r.x0 / span_side + 1) * uint64_t((r.y1 - 1) / span_side - r.y0 / span_side + 1); }

// Both ways; the number of spans that the kernel left.
uint64_t draw_both(const plane& p, const texture_view& t, const kernels::planar_map& texels, filter kind, rectangle area, int32_t width, int32_t height) {
  by_kernel.reset(width, height);
  by_scalar.reset(width, height);
  engine_type engine;
  renderer_type r(engine, prof{}, by_scalar.frame());
  SPANTEX_ASSERT_OK(r.draw(p, t, kind, area));
  SPANTEX_ASSERT_OK(r.finish());
  engine_type other;
  renderer_type rest(other, prof{}, by_kernel.frame());
  draw_counters counts;
  SPANTEX_ASSERT_OK(kernels::draw_plane(kernels::avx512_kernel(), texels, rest, p, t, kind, area, by_kernel.frame(), counts));
  SPANTEX_ASSERT_OK(rest.finish());
  assert_int_equal(counts.pixels + rest.counters().pixels, r.counters().pixels);
  return span_count(area) - counts.jobs;
}

bool missing() {
  if (kernels::avx512_kernel() != nullptr) return false;
  print_message("no AVX-512 VBMI on this machine: the scalar engine draws everything\n");
  return true;
}

SPANTEX_CASE(ordinary_planes_are_drawn_by_the_kernel_alone) {
  if (missing()) skip();
  const synthetic_map& map = random_map(512, 512);
  for (const wrap w : {wrap::repeat, wrap::mirror}) {
    const texture_view t = map.view(w, w);
    const kernels::planar_map texels(t);
    for (const filter kind : filters)
      for (int k = 0; k < 3; ++k) {
        const uint64_t left = draw_both(sample_plane(k), t, texels, kind, {0, 0, 640, 480}, 640, 480);
        assert_true(by_kernel.pixels == by_scalar.pixels);
        assert_in_range(left, 0, 4800 / 100);
      }
  }
}

SPANTEX_CASE(random_planes_and_maps_of_any_size) {
  if (missing()) skip();
  static constexpr int32_t sides[][2] = {{512, 512}, {1, 1}, {2, 64}, {8, 8}, {500, 333}, {37, 5}, {1024, 16}, {3, 128}};
  random_source random(11);
  for (const auto& side : sides) {
    const synthetic_map& map = random_map(side[0], side[1]);
    for (const wrap w : wraps) {
      const texture_view t = map.view(w, w);
      const kernels::planar_map texels(t);
      for (const filter kind : filters)
        for (int k = 0; k < 6; ++k) {
          plane p;
          if (!random_plane(random, {0, 0, 203, 101}, p)) continue;
          draw_both(p, t, texels, kind, {0, 0, 203, 101}, 203, 101);
          assert_true(by_kernel.pixels == by_scalar.pixels);
        }
    }
  }
}

SPANTEX_CASE(nothing_is_written_outside_the_area) {
  if (missing()) skip();
  const synthetic_map& map = random_map(64, 64);
  const texture_view t = map.view(wrap::repeat, wrap::repeat);
  const kernels::planar_map texels(t);
  for (const filter kind : filters)
    for (const rectangle area : {rectangle{3, 5, 61, 44}, {9, 9, 10, 10}, {0, 0, 8, 8}, {63, 0, 65, 71}}) {
      draw_both(sample_plane(1), t, texels, kind, area, 67, 71);
      assert_true(by_kernel.pixels == by_scalar.pixels);
    }
}

// Hundreds of triangles through each other, in front of the camera and across it: picture, depths and floors are the engine's.
SPANTEX_CASE(polygons_with_depth_are_the_same) {
  if (missing()) skip();
  constexpr int32_t one = 1 << 16, width = 203, height = 101, floor_count = 26 * 13;
  constexpr projection camera{100 * one, 100 * one, width * one / 2, height * one / 2, one / 16};
  const synthetic_map& map = random_map(128, 64);
  const texture_view t = map.view(wrap::repeat, wrap::mirror);
  const kernels::planar_map texels(t);
  std::vector<uint32_t> depths[2], floors[2];
  for (const filter kind : filters) {
    random_source random(17);
    for (int n = 0; n < 2; ++n) {
      depths[n].assign(width * height, 0);
      floors[n].assign(floor_count, 0);
    }
    by_kernel.reset(width, height);
    by_scalar.reset(width, height);
    engine_type engine, other;
    renderer_type r(engine, prof{}, by_scalar.frame()), rest(other, prof{}, by_kernel.frame());
    draw_counters counts;
    for (int n = 0; n < 300; ++n) {
      vertex v[3];
      const int32_t near = int32_t(random.between(one / 4, 20 * one));
      for (vertex& x : v) {
        const int32_t z = near + int32_t(random.between(-one, 4 * one));
        x = {int32_t(random.between(-2 * near, 2 * near)), int32_t(random.between(-near, near)), z, int32_t(random.between(-50 * one, 50 * one)),
             int32_t(random.between(-50 * one, 50 * one))};
      }
      polygon p{};
      if (make_polygon(v, 3, camera, {0, 0, width, height}, p) != status::ok) continue;
      SPANTEX_ASSERT_OK(r.draw(p, t, kind, {depths[0].data(), floors[0].data()}));
      SPANTEX_ASSERT_OK(kernels::draw_polygon(kernels::avx512_kernel(), texels, rest, p, t, kind, {depths[1].data(), floors[1].data()}, by_kernel.frame(), counts));
    }
    SPANTEX_ASSERT_OK(r.finish());
    SPANTEX_ASSERT_OK(rest.finish());
    assert_true(by_kernel.pixels == by_scalar.pixels);
    assert_true(depths[0] == depths[1] && floors[0] == floors[1]);
    const draw_counters& engine_counts = r.counters();
    assert_int_equal(counts.pixels + rest.counters().pixels, engine_counts.pixels);
    assert_int_equal(counts.spans_total + rest.counters().spans_total, engine_counts.spans_total);
    assert_int_equal(counts.spans_hidden, engine_counts.spans_hidden);
    assert_int_equal(counts.spans_empty, engine_counts.spans_empty);
    assert_true(counts.pixels > engine_counts.pixels / 2);  // the rest are spans close to the camera's plane
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(ordinary_planes_are_drawn_by_the_kernel_alone),
      cmocka_unit_test(random_planes_and_maps_of_any_size),
      cmocka_unit_test(nothing_is_written_outside_the_area),
      cmocka_unit_test(polygons_with_depth_are_the_same),
  };
  return run_suite("kernels", tests);
}
