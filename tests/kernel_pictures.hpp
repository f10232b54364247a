// SPDX-License-Identifier: Apache-2.0
// Pictures by every host kernel beside the scalar engine's: for the suites that compare them.
#pragma once
#include <tests/support.hpp>

#include <hal/kernels/rows.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

using prof = fixed_profile<profiles::standard>;
using engine_type = direct_engine<prof>;
using renderer_type = renderer<engine_type, prof>;

struct named_kernel { const char* name; kernels::choice which; };
constexpr named_kernel every_kernel[] = {{"pixels", kernels::choice::pixels}, {"words", kernels::choice::words}, {"SSE4.1", kernels::choice::sse41}, {"AVX2", kernels::choice::avx2}, {"NEON", kernels::choice::neon},
                                         {"AVX-512", kernels::choice::avx512}, {"AVX-512, gathers", kernels::choice::avx512_gathers}};

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

// A map ready for every kernel that this machine has.
struct ready_map {
  texture_view view;
  kernels::planar_map blocks, rows;  // rows: with planes for whom they are for
  ready_map(const synthetic_map& map, wrap w, colour_space colours = colour_space::coded) : ready_map(map, w, w, colours) {}
  ready_map(const synthetic_map& map, wrap across, wrap down, colour_space colours) : view(view_of(map, across, down, colours)), blocks(view, kernels::layout::rows_and_blocks), rows(view, kernels::layout::rows_and_planes) {}
  static texture_view view_of(const synthetic_map& map, wrap across, wrap down, colour_space colours) {
    texture_view t = map.view(across, down);
    t.set_colours(colours);
    return t;
  }
  const kernels::planar_map& of(kernels::choice c) const { return kernels::layout_of(c) == kernels::layout::rows_and_blocks ? blocks : rows; }
};

// By the engine, then by every kernel that draws by such numbers: the same bytes. A kernel may leave so many spans.
template <class Prof, int Fine = prof::max_fine_side>
void draw_all_by(const Prof& numbers, const plane& p, const ready_map& map, filter kind, rectangle area, int32_t width, int32_t height, uint64_t most_left = UINT64_MAX) {
  using engine_by = direct_engine<Prof, Fine>;
  assert_true(kernels::draws(kernels::choice::pixels, numbers.get()));  // so that something is compared
  by_scalar.reset(width, height);
  engine_by engine(numbers);
  renderer<engine_by, Prof> r(engine, numbers, by_scalar.frame());
  SPANTEX_ASSERT_OK(r.draw(p, map.view, kind, area));
  SPANTEX_ASSERT_OK(r.finish());
  for (const named_kernel& k : every_kernel) {
    if (kernels::kernel_of(k.which) == nullptr || !kernels::draws(k.which, numbers.get())) continue;
    by_kernel.reset(width, height);
    engine_by other(numbers);
    renderer<engine_by, Prof> rest(other, numbers, by_kernel.frame());
    draw_counters counts;
    SPANTEX_ASSERT_OK(kernels::draw_plane(kernels::kernel_of(k.which), map.of(k.which), rest, p, map.view, kind, area, by_kernel.frame(), counts));
    assert_int_equal(counts.pixels, r.counters().pixels);
    assert_int_equal(counts.spans_total, r.counters().spans_total);
    assert_int_equal(counts.spans_behind, r.counters().spans_behind);
    if (by_kernel.pixels != by_scalar.pixels) fail_msg("%s, filter %d: not the engine's bytes", k.name, int(kind));
    if (k.which != kernels::choice::pixels) assert_true(span_count(area) - counts.jobs <= most_left);
  }
}

inline void draw_all(const plane& p, const ready_map& map, filter kind, rectangle area, int32_t width, int32_t height, uint64_t most_left = UINT64_MAX) {
  draw_all_by(prof{}, p, map, kind, area, width, height, most_left);
}

// Neither turned nor divided: from texel (u, v) on, steps of texels a pixel.
plane upright_plane(double u, double v, double step_u, double step_v, rectangle area) {
  const double m[9] = {step_u, 0, u, 0, step_v, v, 0, 0, 1};
  plane p{};
  SPANTEX_ASSERT_OK(make_plane(homography_of(m), area, p));
  return p;
}

// A floor: its horizon crosses the picture.
plane plane_to_the_horizon(rectangle area) {
  constexpr double m[9] = {0.5, -0.2, 31, 0.3, 0.4, 700, 0.003, 0.012, -0.5};
  plane p{};
  SPANTEX_ASSERT_OK(make_plane(homography_of(m), area, p));
  return p;
}

// --- triangles through each other, in front of the camera and across it ---

constexpr int32_t scene_width = 203, scene_height = 101;

struct depths {
  std::vector<uint32_t> values = std::vector<uint32_t>(scene_width * scene_height), floors = std::vector<uint32_t>(26 * 13);
  depth_buffer buffer() { return {values.data(), floors.data()}; }
};

// Depths as the engine's, floors at least as high.
inline void assert_depths(const depths& own, const depths& engine) {
  assert_true(own.values == engine.values);
  for (size_t k = 0; k < own.floors.size(); ++k) assert_true(own.floors[k] >= engine.floors[k]);
}

template <class Draw>
void each_triangle(Draw draw, int count, const rgba8 (&colours)[3]) {
  constexpr int32_t one = 1 << 16;
  constexpr projection camera{100 * one, 100 * one, scene_width * one / 2, scene_height * one / 2, one / 16};
  random_source random(17);
  for (int n = 0; n < count; ++n) {
    vertex v[3];
    const int32_t near = int32_t(random.between(one / 4, 20 * one));
    for (vertex& x : v) {
      const int32_t z = near + int32_t(random.between(-one, 4 * one));
      x = {int32_t(random.between(-2 * near, 2 * near)), int32_t(random.between(-near, near)), z, int32_t(random.between(-50 * one, 50 * one)),
           int32_t(random.between(-50 * one, 50 * one))};
    }
    polygon p{};
    colour_forms forms{};
    if (make_polygon(v, colours, 3, camera, {0, 0, scene_width, scene_height}, p, forms) == status::ok) SPANTEX_ASSERT_OK(draw(p, forms));
  }
}

// `count` of them: picture and depths are the engine's.
inline void draw_triangles(const ready_map& map, filter kind, int count) {
  const auto each = [&](auto draw) { each_triangle([&](const polygon& p, const colour_forms&) { return draw(p); }, count, {white, white, white}); };
  by_scalar.reset(scene_width, scene_height);
  engine_type engine;
  renderer_type r(engine, prof{}, by_scalar.frame());
  depths by_engine;
  each([&](const polygon& p) { return r.draw(p, map.view, kind, by_engine.buffer()); });
  SPANTEX_ASSERT_OK(r.finish());
  const draw_counters& want = r.counters();
  for (const named_kernel& k : every_kernel) {
    if (kernels::kernel_of(k.which) == nullptr) continue;
    by_kernel.reset(scene_width, scene_height);
    engine_type other;
    renderer_type rest(other, prof{}, by_kernel.frame());
    depths own;
    draw_counters counts;
    each([&](const polygon& p) { return kernels::draw_polygon(kernels::kernel_of(k.which), kernels::cover_of(k.which), map.of(k.which), rest, p, map.view, kind, p.box, own.buffer(), by_kernel.frame(), counts); });
    if (by_kernel.pixels != by_scalar.pixels) fail_msg("%s, filter %d: not the engine's bytes", k.name, int(kind));
    assert_depths(own, by_engine);
    assert_int_equal(counts.pixels, want.pixels);
    assert_int_equal(counts.spans_total, want.spans_total);
    assert_int_equal(counts.spans_hidden + counts.spans_empty, want.spans_hidden + want.spans_empty);
  }
}

// Planes at random, of maps of such sides that are wrapped in every way.
template <size_t Count>
void draw_random_planes(const int32_t (&sides)[Count][2], colour_space colours) {
  random_source random(11);
  for (const auto& side : sides)
    for (const wrap w : wraps) {
      const ready_map map(random_map(side[0], side[1]), w, colours);
      for (const filter kind : filters)
        for (int k = 0; k < (short_run() ? 2 : 6); ++k) {
          plane p;
          if (random_plane(random, {0, 0, 203, 101}, p)) draw_all(p, map, kind, {0, 0, 203, 101}, 203, 101);
        }
    }
}

// One span of a hundred at most is left.
inline void draw_ordinary_planes(colour_space colours) {
  for (const wrap w : {wrap::repeat, wrap::mirror}) {
    const ready_map map(random_map(512, 512), w, colours);
    for (const filter kind : filters)
      for (int k = 0; k < 3; ++k) draw_all(sample_plane(k), map, kind, {0, 0, 640, 480}, 640, 480, 4800 / 100);
  }
}

// Aniso with one sample at most, two and so on.
inline void draw_rows_of_samples(const ready_map& map, random_source& random) {
  run_time_profile few{profiles::standard};
  for (few.value.max_samples = 1; few.value.max_samples <= 16; few.value.max_samples += short_run() && few.value.max_samples > 4 ? 4 : 1)
    for (int k = 0; k < 6; ++k) {
      plane p = sample_plane(k % 3);
      if (k < 3 || random_plane(random, {0, 0, 203, 101}, p)) draw_all_by(few, p, map, filter::aniso, {0, 0, 203, 101}, 203, 101);
    }
  few.value.max_samples = 5;
  draw_all_by(few, plane_to_the_horizon({0, 0, 203, 101}), map, filter::aniso, {0, 0, 203, 101}, 203, 101);
}

}  // namespace
