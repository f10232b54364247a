// SPDX-License-Identifier: Apache-2.0
// The draw layer: what is drawn where, what is left alone, what is counted, and errors of the engine on their way up.
#include <tests/support.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

using exact_profile = fixed_profile<profiles::exact>;
using engine_type = direct_engine<exact_profile>;
using renderer_type = renderer<engine_type, exact_profile>;

constexpr int32_t one = 1 << 16;
constexpr projection camera{64 * one, 64 * one, 64 * one, 64 * one, one / 16};
constexpr exact_profile prof;
picture shown, expected;
uint32_t depth_values[640 * 480];

bool in(rectangle r, int32_t x, int32_t y) { return x >= r.x0 && x < r.x1 && y >= r.y0 && y < r.y1; }

texture_view photo() { return photographic_map(64, 64).view(wrap::repeat, wrap::repeat); }

}  // namespace

SPANTEX_CASE(only_the_area_in_front_of_the_viewer_is_drawn) {
  const texture_view t = photo();
  const rectangle areas[] = {{0, 0, 640, 480},      {3, 5, 4, 6},         {100, 130, 261, 275},
                             {-50, 200, 70, 9000}, {600, 440, 700, 600}, {639, 479, 640, 480}};
  for (const rectangle& area : areas) {
    const plane p = sample_plane(3);
    shown.reset(640, 480);
    engine_type engine;
    renderer_type r(engine, prof, shown.frame());
    SPANTEX_ASSERT_OK(r.draw(p, t, filter::bilinear, area));
    SPANTEX_ASSERT_OK(r.finish());
    int64_t drawn = 0;
    for (int32_t y = 0; y < 480; ++y)
      for (int32_t x = 0; x < 640; ++x) {
        const bool wanted = in(area, x, y) && p.w_at(2 * x + 1, 2 * y + 1) > 0;
        drawn += wanted;
        if (!wanted) assert_true(shown.pixels[size_t(y * 640 + x)] == background);
      }
    assert_int_equal(r.counters().pixels, drawn);
  }
}

SPANTEX_CASE(every_pixel_of_the_area_is_written) {
  const texture_view plain = constant_map(16, 16, {255, 254, 253, 252}).view(wrap::repeat, wrap::repeat);
  for (const filter kind : all_filters)
    for (int k = 0; k < 3; ++k) {
      shown.reset(333, 211);
      engine_type engine;
      SPANTEX_ASSERT_OK(render_plane(prof, engine, sample_plane(k), plain, kind, shown));
      for (const rgba8& c : shown.pixels)  // a contour's alpha is a distance in pixels
        assert_true((c == rgba8{255, 254, 253, kind == filter::contour ? c.a : uint8_t(252)}));
    }
}

SPANTEX_CASE(an_empty_area_draws_nothing) {
  const texture_view t = photo();
  shown.reset(64, 64);
  engine_type engine;
  renderer_type r(engine, prof, shown.frame());
  for (const rectangle area : {rectangle{5, 5, 5, 9}, {9, 9, 5, 12}, {64, 0, 80, 20}, {-9, -9, 0, 0}})
    SPANTEX_ASSERT_OK(r.draw(sample_plane(0), t, filter::bilinear, area));
  SPANTEX_ASSERT_OK(r.finish());
  assert_int_equal(r.counters().spans_total, 0);
  for (const rgba8& c : shown.pixels) assert_true(c == background);
}

SPANTEX_CASE(a_stride_longer_than_the_width_is_kept) {
  const texture_view t = photo();
  static rgba8 wide_frame[100 * 60];
  for (rgba8& c : wide_frame) c = background;
  shown.reset(77, 60);
  engine_type engine;
  SPANTEX_ASSERT_OK(render_plane(prof, engine, sample_plane(1), t, filter::trilinear, shown));
  renderer_type r(engine, prof, {wide_frame, 77, 60, 100});
  SPANTEX_ASSERT_OK(r.draw(sample_plane(1), t, filter::trilinear, {0, 0, 77, 60}));
  SPANTEX_ASSERT_OK(r.finish());
  for (int32_t y = 0; y < 60; ++y)
    for (int32_t x = 0; x < 100; ++x)
      assert_true(wide_frame[y * 100 + x] == (x < 77 ? shown.pixels[size_t(y * 77 + x)] : background));
}

// A polygon is its plane seen through a mask.
SPANTEX_CASE(a_polygon_shows_its_plane_where_it_covers) {
  const texture_view t = photo();
  const vertex v[3] = {{-3 * one, -one, 4 * one, 0, 0}, {2 * one, -2 * one, 5 * one, 300 * one, 0},
                       {2 * one, one, 2 * one, 300 * one, 200 * one}};
  polygon p{};
  SPANTEX_ASSERT_OK(make_polygon(v, 3, camera, {0, 0, 128, 128}, p));
  for (const filter kind : all_filters) {
    expected.reset(128, 128);
    shown.reset(128, 128);
    engine_type engine;
    SPANTEX_ASSERT_OK(render_plane(prof, engine, p.map, t, kind, expected));
    renderer_type r(engine, prof, shown.frame());
    SPANTEX_ASSERT_OK(r.draw(p, t, kind));
    SPANTEX_ASSERT_OK(r.finish());
    int64_t covered = 0;
    for (int32_t y = 0; y < 128; ++y)
      for (int32_t x = 0; x < 128; ++x) {
        const bool inside = in(p.box, x, y) && ((coverage(p.edges, x / 8, y / 8) >> (y % 8 * 8 + x % 8)) & 1) != 0;
        covered += inside;
        assert_true(shown.pixels[size_t(y * 128 + x)] == (inside ? expected.pixels[size_t(y * 128 + x)] : background));
      }
    assert_true(covered > 500);
    assert_int_equal(r.counters().pixels, covered);
  }
}

SPANTEX_CASE(hidden_spans_are_skipped_and_counted) {
  const texture_view t = photo();
  const auto wall = [](int32_t z, polygon& p) {
    const vertex v[4] = {{-z, -z, z, 0, 0}, {z, -z, z, 64 * one, 0}, {z, z, z, 64 * one, 64 * one}, {-z, z, z, 0, 64 * one}};
    SPANTEX_ASSERT_OK(make_polygon(v, 4, camera, {0, 0, 128, 128}, p));
  };
  polygon near{}, far{};
  wall(one, near);
  wall(3 * one, far);
  for (uint32_t& d : depth_values) d = 0;
  shown.reset(128, 128);
  engine_type engine;
  renderer_type r(engine, prof, shown.frame());
  SPANTEX_ASSERT_OK(r.draw(near, t, filter::bilinear, {depth_values}));
  const uint64_t drawn = r.counters().pixels;
  assert_int_equal(drawn, 128 * 128);
  SPANTEX_ASSERT_OK(r.draw(far, t, filter::bilinear, {depth_values}));
  SPANTEX_ASSERT_OK(r.draw(near, t, filter::bilinear, {depth_values}));  // the same again: not nearer than itself
  SPANTEX_ASSERT_OK(r.finish());
  assert_int_equal(r.counters().pixels, drawn);
  assert_int_equal(r.counters().spans_hidden, 2 * 256);
}

SPANTEX_CASE(spans_are_counted_once_each_way) {
  const texture_view t = photo();
  const plane p = sample_plane(3);
  shown.reset(640, 480);
  engine_type engine;
  renderer_type r(engine, prof, shown.frame());
  SPANTEX_ASSERT_OK(r.draw(p, t, filter::trilinear, {0, 0, 640, 480}));
  SPANTEX_ASSERT_OK(r.finish());
  uint64_t behind = 0;
  for (int32_t sy = 0; sy < 60; ++sy)
    for (int32_t sx = 0; sx < 80; ++sx) behind += front_mask(p, sx, sy) == 0;
  assert_int_equal(r.counters().spans_total, 4800);
  assert_int_equal(r.counters().spans_behind, behind);
  assert_true(behind > 0 && behind < 4800);
  assert_int_equal(r.counters().corrected_jobs, 0);
}

// What stays in local memory is not loaded again: two magnified spans side by side share a section's texels.
SPANTEX_CASE(a_section_that_is_held_is_not_loaded_again) {
  const texture_view t = constant_map(4, 4, {9, 9, 9, 9}).view(wrap::clamp, wrap::clamp);
  const double magnified[9] = {0.001, 0, 1.5, 0, 0.001, 1.5, 0, 0, 1};
  plane p{};
  SPANTEX_ASSERT_OK(make_plane(homography_of(magnified), {0, 0, 256, 256}, p));
  shown.reset(256, 256);
  engine_type engine;
  renderer_type r(engine, prof, shown.frame());
  SPANTEX_ASSERT_OK(r.draw(p, t, filter::nearest, {0, 0, 256, 256}));
  SPANTEX_ASSERT_OK(r.finish());
  assert_true(r.counters().loads_skipped >= 1024 - 2);
  assert_true(r.counters().words_loaded <= 4);
}

SPANTEX_CASE(a_map_that_changes_between_draws_is_loaded_anew) {
  const synthetic_map &red = constant_map(8, 8, {255, 0, 0, 255}), &blue = constant_map(8, 8, {0, 0, 255, 255});
  shown.reset(64, 64);
  engine_type engine;
  renderer_type r(engine, prof, shown.frame());
  const double magnified[9] = {0.001, 0, 1.5, 0, 0.001, 1.5, 0, 0, 1};
  plane p{};
  SPANTEX_ASSERT_OK(make_plane(homography_of(magnified), {0, 0, 64, 64}, p));
  SPANTEX_ASSERT_OK(r.draw(p, red.view(wrap::repeat, wrap::repeat), filter::bilinear, {0, 0, 64, 32}));
  SPANTEX_ASSERT_OK(r.draw(p, blue.view(wrap::repeat, wrap::repeat), filter::bilinear, {0, 32, 64, 64}));
  SPANTEX_ASSERT_OK(r.finish());
  for (int32_t y = 0; y < 64; ++y)
    for (int32_t x = 0; x < 64; ++x) assert_true(shown.pixels[size_t(y * 64 + x)].r == (y < 32 ? 255 : 0));
}

// Coarse levels may differ where the finest one is shared; texels may change once a picture is finished.
SPANTEX_CASE(what_is_loaded_is_used_again_of_the_same_texels_only) {
  static rgba8 finest[64 * 64], red[32 * 32], blue[32 * 32];
  for (rgba8& c : red) c = {255, 0, 0, 255};
  for (rgba8& c : blue) c = {0, 0, 255, 255};
  const auto view_of = [](const rgba8* coarse) {
    const rgba8* const levels[] = {finest, coarse};
    texture_view t;
    SPANTEX_ASSERT_OK(texture_view::make(levels, 2, 64, 64, wrap::repeat, wrap::repeat, t));
    return t;
  };
  const double minified[9] = {4, 0, 0, 0, 4, 0, 0, 0, 1};
  plane p{};
  SPANTEX_ASSERT_OK(make_plane(homography_of(minified), {0, 0, 8, 8}, p));
  shown.reset(8, 8);
  engine_type engine;
  using fills_uniform = renderer<engine_type, std::remove_const_t<decltype(prof)>, opaque_only, uncounted_reads, fixed_skips<default_skips | only(skip::uniform)>>;
  const auto draw_all = [&](auto&& r) {
    const auto draws = [&](const rgba8* coarse, const rgba8& colour) {
      for (int in_both_halves = 0; in_both_halves < 2; ++in_both_halves) {
        SPANTEX_ASSERT_OK(r.draw(p, view_of(coarse), filter::mip_bilinear, {0, 0, 8, 8}));
        SPANTEX_ASSERT_OK(r.flush());
        for (const rgba8& c : shown.pixels) assert_true(c == colour);
      }
    };
    draws(red, {255, 0, 0, 255});
    draws(blue, {0, 0, 255, 255});
    SPANTEX_ASSERT_OK(r.finish());
    for (rgba8& c : blue) c = {0, 255, 0, 255};
    draws(blue, {0, 255, 0, 255});
    for (rgba8& c : blue) c = {0, 0, 255, 255};
    SPANTEX_ASSERT_OK(r.finish());
  };
  draw_all(renderer_type(engine, prof, shown.frame()));
  draw_all(fills_uniform(engine, prof, shown.frame()));
}

// --- errors ---------------------------------------------------------------------------------------------------

namespace {

// Fails its n-th operation, once.
class failing_engine {
 public:
  explicit failing_engine(int64_t n) : left_(n) {}
  status load_coefficients(half h, const span_coefficients& c) { return fails() ? status::device_error : inner_.load_coefficients(h, c); }
  status load_words(half h, int first, const uint64_t* words, int count) {
    return fails() ? status::device_error : inner_.load_words(h, first, words, count);
  }
  status start(half h, span_mask mask) { return fails() ? status::device_error : inner_.start(h, mask); }
  status take(half h, span_pixels& out) { return fails() ? status::device_error : inner_.take(h, out); }
  void mark(event) {}
  bool has_failed() const { return left_ < 0; }
  int64_t left() const { return left_; }

 private:
  bool fails() { return left_ >= 0 && left_-- == 0; }
  engine_type inner_;
  int64_t left_;
};
static_assert(span_engine<failing_engine>);

status draw_with(failing_engine& engine) {
  const texture_view t = photo();
  shown.reset(24, 16);
  renderer<failing_engine, exact_profile> r(engine, prof, shown.frame());
  SPANTEX_TRY(r.draw(sample_plane(1), t, filter::trilinear, {0, 0, 24, 16}));
  return r.finish();
}

}  // namespace

SPANTEX_CASE(every_failing_operation_is_reported) {
  failing_engine sound(INT32_MAX);
  SPANTEX_ASSERT_OK(draw_with(sound));
  const int64_t operations = INT32_MAX - sound.left();
  assert_true(operations > 30);
  for (int64_t n = 0; n < operations; ++n) {
    failing_engine engine(n);
    SPANTEX_ASSERT_STATUS(draw_with(engine), device_error);
    assert_true(engine.has_failed());
  }
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(only_the_area_in_front_of_the_viewer_is_drawn),
      cmocka_unit_test(every_pixel_of_the_area_is_written),
      cmocka_unit_test(an_empty_area_draws_nothing),
      cmocka_unit_test(a_stride_longer_than_the_width_is_kept),
      cmocka_unit_test(a_polygon_shows_its_plane_where_it_covers),
      cmocka_unit_test(hidden_spans_are_skipped_and_counted),
      cmocka_unit_test(spans_are_counted_once_each_way),
      cmocka_unit_test(a_section_that_is_held_is_not_loaded_again),
      cmocka_unit_test(what_is_loaded_is_used_again_of_the_same_texels_only),
      cmocka_unit_test(a_map_that_changes_between_draws_is_loaded_anew),
      cmocka_unit_test(every_failing_operation_is_reported),
  };
  return run_suite("draw", tests);
}
