// SPDX-License-Identifier: Apache-2.0
// Degenerate input: one case for each row of docs/SPEC.md section 12 that no other suite holds, in every profile, filter and wrap mode
// where they can matter.
#include <tests/properties.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

constexpr int32_t side = 40, one = 1 << 16;
constexpr rectangle area{0, 0, side, side};
constexpr projection camera{20 * one, 20 * one, 20 * one, 20 * one, one / 16};
picture drawn;

// The nine numbers in 2^-20.
homography matrix_of(const double (&m)[9]) {
  const auto w = [&](int k) { return wide(int64_t(m[k] * 1048576.0)); };
  return {w(0), w(1), w(2), w(3), w(4), w(5), w(6), w(7), w(8)};
}

rgba8 at(int32_t x, int32_t y) { return drawn.pixels[size_t(y * side + x)]; }

const synthetic_map& some_map() {
  static const synthetic_map& m = photographic_map(32, 16, 11);
  return m;
}

// use(prof, kind, wrap) after the plane was drawn with the map; every profile, filter and wrap mode.
template <class Use>
void for_each_picture(const plane& p, const synthetic_map& map, Use use) {
  for_each_profile([&](auto prof, const char*) {
    for (const filter kind : all_filters)
      for (const wrap mode : all_wraps) {
        const texture_view t = map.view(mode, mode);
        drawn.reset(side, side);
        SPANTEX_ASSERT_OK(render_plane_direct<decltype(prof)::max_fine_side>(prof, p, t, kind, drawn));
        use(prof, kind, t);
      }
  });
}

plane set_up(const double (&m)[9]) {
  plane p{};
  if (make_plane(matrix_of(m), area, p) != status::ok) std::abort();
  return p;
}

}  // namespace

// W = x - 20 in pixels: zero at no centre; W = x - 20.5: zero on the centres of column 20.
SPANTEX_CASE(pixels_with_w_zero_or_less_are_not_drawn) {
  const double between[9] = {3, 1, 5, 0, 2, 7, 1, 0, -20}, on_centres[9] = {3, 1, 5, 0, 2, 7, 1, 0, -20.5};
  for (const bool on : {false, true}) {
    const plane p = set_up(on ? on_centres : between);
    const synthetic_map& white_map = constant_map(8, 8, {255, 255, 255, 255});
    for_each_picture(p, white_map, [&](auto, filter, const texture_view&) {
      for (int32_t y = 0; y < side; ++y)
        for (int32_t x = 0; x < side; ++x) assert_true((at(x, y) == background) == (x < (on ? 21 : 20)));
    });
  }
}

// W vanishes beside numerators of 2^100: set-up's common scale leaves nothing of it.
SPANTEX_CASE(w_that_underflows_is_degenerate) {
  const wide large = shift_left(wide(1), 100), small(1000), zero;
  plane p{};
  SPANTEX_ASSERT_STATUS(make_plane({large, zero, zero, zero, large, zero, zero, zero, small}, area, p), degenerate);
  SPANTEX_ASSERT_OK(make_plane({large, zero, zero, zero, large, zero, zero, zero, shift_left(wide(1), 80)}, area, p));
}

// All numerators zero: u = v = 0 everywhere, level 0, one colour.
SPANTEX_CASE(a_plane_without_texture_axes_shows_one_point) {
  const double still[9] = {0, 0, 0, 0, 0, 0, 0.01, 0.02, 1};
  for_each_picture(set_up(still), some_map(), [&](auto prof, filter kind, const texture_view& t) {
    if (kind == filter::nearest) assert_true(at(0, 0) == t.texel(0, 0, 0));
    const plane p = set_up(still);
    if (prof.get().formula == level_formula::jacobian && !uses_footprint(kind) && !uses_area(kind))
      each_source(prof, {&p, &t, kind}, area, [](int32_t, int32_t, const pixel_source& s) { assert_int_equal(s.detail, 0); });
    for (const rgba8& c : drawn.pixels) assert_true(c == at(0, 0));
  });
}

// Edge-on by a matrix: v = u, a line of the map; drawn, texels by the formula.
SPANTEX_CASE(an_edge_on_plane_by_a_matrix_is_drawn_by_its_formula) {
  const double line[9] = {0.75, 0, 1.25, 0.75, 0, 1.25, 0, 0, 1};
  const synthetic_map& map = photographic_map(16, 16, 12);
  for_each_picture(set_up(line), map, [&](auto, filter kind, const texture_view& t) {
    if (kind != filter::nearest) return;
    for (int32_t x = 0; x < side; ++x) {
      const int32_t u = (3 * (2 * x + 1) + 10) / 8;  // 0.75 (x + 1/2) + 1.25
      assert_true(at(x, 3) == t.texel(0, t.wrapped_u(u, 0), t.wrapped_v(u, 0)));
    }
  });
}

SPANTEX_CASE(a_map_of_one_texel_is_that_texel) {
  const rgba8 texel{3, 250, 127, 64};
  for (int k = 0; k < sample_plane_count; ++k) {
    const plane p = plane_of(shrunk(sample_homography(k), 16), side, side);
    for_each_picture(p, constant_map(1, 1, texel), [&](auto, filter kind, const texture_view&) {
      for (int32_t y = 0; y < side; ++y)
        for (int32_t x = 0; x < side; ++x) {
          rgba8 wanted = p.w_at(2 * x + 1, 2 * y + 1) > 0 ? texel : background;
          if (kind == filter::contour) wanted.a = at(x, y).a;  // a coverage: depends on the level of detail
          assert_true(at(x, y) == wanted);
        }
    });
  }
}

// An axis of one texel: position 0 on it, whatever the coordinate.
SPANTEX_CASE(an_axis_of_one_texel_has_position_0) {
  const plane p = plane_of(shrunk(sample_homography(1), 16), side, side);
  for (const synthetic_map* m : {&photographic_map(1, 64), &photographic_map(64, 1)})
    for_each_profile([&](auto prof, const char*) {
      for (const filter kind : one_sample_filters)
        for (const wrap mode : all_wraps) {
          const texture_view t = m->view(mode, mode);
          each_source(prof, {&p, &t, kind}, area, [&](int32_t, int32_t, const pixel_source& s) {
            if (t.width() == 1)
              assert_true(s.fine.u == 0 && s.fine.fraction.u == 0);
            else
              assert_true(s.fine.v == 0 && s.fine.fraction.v == 0);
          });
        }
    });
}

// |u| >= 2^15 is +-32767, v stays; in range at one end of the picture only.
SPANTEX_CASE(huge_coordinates_become_32767_on_their_axis_only) {
  for (const int sign : {1, -1}) {
    const double far[9] = {0, 0, sign * 40000.0, 0, 0.5, 0.125, 0, 0, 1},
                 endless[9] = {0, 0, sign * 1048576.0, 0, 0.5, 0.125, 0, 0, 0.0001};
    for (const bool is_endless : {false, true}) {
      const plane p = set_up(is_endless ? endless : far);
      for_each_picture(p, some_map(), [&](auto prof, filter kind, const texture_view& t) {
        if (uses_area(kind)) return;  // a polygon around it
        each_source(prof, {&p, &t, kind}, area,
                    [&](int32_t, int32_t, const pixel_source& s) { assert_int_equal(s.at.u.raw(), sign * 32767 * one); });
        if (kind != filter::nearest || is_endless) return;
        for (int32_t y = 0; y < side; ++y)
          assert_true(at(5, y) == t.texel(0, t.wrapped_u(sign * 32767, 0), t.wrapped_v((4 * (2 * y + 1) + 2) / 16, 0)));
      });
    }
  }
}

// In range at a span's centre, out of it further on: the largest s15.16 number.
SPANTEX_CASE(positions_saturate_within_a_span) {
  for (const int sign : {1, -1}) {
    const double over_the_edge[9] = {sign * 2.0, 0, sign * (32764.0 - 2 * 20), 0, 1, 3, 0, 0, 1};  // u = +-32764 at x = 20, a span's centre
    const plane p = set_up(over_the_edge);
    int saturated = 0;
    for_each_profile([&](auto prof, const char*) {
      const texture_view t = some_map().view(wrap::repeat, wrap::repeat);
      each_source(prof, {&p, &t, filter::nearest}, {16, 0, 24, 8}, [&](int32_t x, int32_t y, const pixel_source& s) {
        const bool is_beyond = 32764 + 2 * x + 1 - 40 >= 32768;
        saturated += is_beyond;
        if (is_beyond)
          assert_int_equal(s.at.u.raw(), sign > 0 ? INT32_MAX : INT32_MIN);
        else
          assert_int_equal(s.at.u.raw(), sign * (32764 + 2 * x + 1 - 40) * one);
        assert_int_equal(s.at.v.raw(), (2 * y + 7) * one / 2);
      });
    });
    assert_true(saturated == 4 * 2 * 8);
  }
}

// Far beyond the last level: that level, fraction 0; with a map of one level, level 0.
SPANTEX_CASE(beyond_the_last_level_the_last_level_stays) {
  const double tiny[9] = {300, 7, 1, -5, 200, 3, 0, 0, 1};
  const plane p = set_up(tiny);
  for (const synthetic_map* m : {&some_map(), &photographic_map(1, 1)})
    for_each_profile([&](auto prof, const char*) {
      for (const filter kind : {filter::mip_bilinear, filter::trilinear, filter::trilinear3}) {
        const texture_view t = m->view(wrap::repeat, wrap::repeat);
        each_source(prof, {&p, &t, kind}, area, [&](int32_t, int32_t, const pixel_source& s) {
          assert_int_equal(s.level, t.last_level());
          assert_false(s.two_levels);
          assert_int_equal(s.fraction, 0);
        });
      }
    });
  const rgba8* const only[] = {some_map().levels[0].texels.data()};
  texture_view t;
  SPANTEX_ASSERT_OK(texture_view::make(only, 1, 32, 16, wrap::repeat, wrap::repeat, t));
  for_each_profile([&](auto prof, const char*) {
    for (const filter kind : one_sample_filters)
      each_source(prof, {&p, &t, kind}, area, [](int32_t, int32_t, const pixel_source& s) { assert_true(s.level == 0 && !s.two_levels); });
  });
}

// Magnified: level 0 alone, and the coarser level is not loaded.
SPANTEX_CASE(magnified_maps_use_level_0_alone) {
  const double close[9] = {0.125, 0, 3, 0, 0.125, 2, 0, 0, 1};
  const plane p = set_up(close);
  for_each_profile([&](auto prof, const char*) {
    for (const filter kind : {filter::mip_bilinear, filter::trilinear, filter::trilinear3}) {
      const texture_view t = some_map().view(wrap::repeat, wrap::repeat);
      each_source(prof, {&p, &t, kind}, area, [](int32_t, int32_t, const pixel_source& s) { assert_true(s.level == 0 && !s.two_levels); });
    }
  });
}

// A ray step of 0: every pixel sees the same point.
SPANTEX_CASE(a_camera_without_opening_shows_one_point) {
  const kt88_plane q{{0, 0, 1 << 30}, -2 * one, {8 * one, 0, 0}, {0, 8 * one, 0}, {0, 0, 2 * one}, 5 * one, 6 * one};
  plane p{};
  SPANTEX_ASSERT_OK(make_plane(q, {0, 0, side, side}, p));
  for_each_picture(p, some_map(), [&](auto, filter kind, const texture_view& t) {
    if (kind == filter::nearest) assert_true(at(0, 0) == t.texel(0, 5, 6));
    for (const rgba8& c : drawn.pixels) assert_true(c == at(0, 0));
  });
  plane none{};
  kt88_plane flat = q;
  flat.normal = {0, 0, 0};
  SPANTEX_ASSERT_STATUS(make_plane(flat, {1 << 20, 1 << 20, side, side}, none), degenerate);
}

// No pixels, no work: a frame of size 0 is never touched.
SPANTEX_CASE(a_frame_of_no_pixels_is_left_alone) {
  const texture_view t = some_map().view(wrap::repeat, wrap::repeat);
  using prof = fixed_profile<profiles::exact>;
  for (const frame_buffer& frame : {frame_buffer{nullptr, 0, 0, 0}, {nullptr, 0, 40, 0}, {nullptr, 40, 0, 40}}) {
    direct_engine<prof, 32> engine;
    renderer<direct_engine<prof, 32>, prof> r(engine, prof{}, frame);
    SPANTEX_ASSERT_OK(r.draw(sample_plane(0), t, filter::trilinear, {0, 0, 640, 480}));
    SPANTEX_ASSERT_OK(r.finish());
    assert_int_equal(r.counters().pixels, 0);
    assert_int_equal(r.counters().spans_total, 0);
  }
}

// Polygons of no vertices, no area, in line, seen edge-on, or all in one point; and one that is smaller than a pixel.
SPANTEX_CASE(polygons_without_area_are_refused) {
  polygon p{};
  vertex v[8] = {};
  for (int k = 0; k < 8; ++k) v[k] = {k * one, 2 * k * one, 3 * one, k * one, 0};
  for (const int count : {INT32_MIN, -1, 0, 1, 2, 9, INT32_MAX}) SPANTEX_ASSERT_STATUS(make_polygon(v, count, camera, area, p), bad_size);
  for (int count = 3; count <= 8; ++count) SPANTEX_ASSERT_STATUS(make_polygon(v, count, camera, area, p), degenerate);
  const vertex back_and_forth[4] = {v[0], v[1], v[0], v[1]}, all_one[3] = {v[2], v[2], v[2]};
  SPANTEX_ASSERT_STATUS(make_polygon(back_and_forth, 4, camera, area, p), degenerate);
  SPANTEX_ASSERT_STATUS(make_polygon(all_one, 3, camera, area, p), degenerate);
  const vertex edge_on[3] = {{0, 0, one, 0, 0}, {0, one, one, 0, one}, {0, 0, 2 * one, one, 0}};
  SPANTEX_ASSERT_STATUS(make_polygon(edge_on, 3, camera, area, p), degenerate);
  const vertex through_viewer[3] = {{one, one, one, 0, 0}, {2 * one, 2 * one, 2 * one, 0, 0}, {-one, 0, 0, 0, 0}};
  SPANTEX_ASSERT_STATUS(make_polygon(through_viewer, 3, camera, area, p), degenerate);
}

// The fourth vertex lies off the plane of the first three, which counts.
SPANTEX_CASE(a_polygon_that_is_not_plane_shows_the_plane_of_its_first_three_vertices) {
  const vertex v[4] = {{-one, -one, 2 * one, 0, 0},
                       {one, -one, 3 * one, 30 * one, 0},
                       {one, one, 2 * one, 30 * one, 20 * one},
                       {-one, one, 5 * one, 77 * one, 5 * one}};
  polygon three{}, four{};
  SPANTEX_ASSERT_OK(make_polygon(v, 3, camera, area, three));
  SPANTEX_ASSERT_OK(make_polygon(v, 4, camera, area, four));
  for (int32_t y = 1; y < 2 * side; y += 2)
    for (int32_t x = 1; x < 2 * side; x += 2) {
      const auto u = [&](const polygon& p) { return double(p.map.u_at(x, y)) / double(p.map.w_at(x, y)); };
      assert_true(std::fabs(u(three) - u(four)) < 1e-6);
    }
}

SPANTEX_CASE(a_polygon_smaller_than_a_pixel_is_drawn_where_it_covers_a_centre) {
  const texture_view t = constant_map(4, 4, {9, 8, 7, 6}).view(wrap::repeat, wrap::repeat);
  for (const bool on_centre : {false, true}) {
    const int32_t x = on_centre ? 0 : one / 64, h = one / 320;  // centre of pixel 20 at x = 1/40
    const int32_t m = on_centre ? one / 40 : x;
    const vertex v[4] = {
        {m - h, m - h, one, 0, 0}, {m + h, m - h, one, one, 0}, {m + h, m + h, one, one, one}, {m - h, m + h, one, 0, one}};
    polygon p{};
    SPANTEX_ASSERT_OK(make_polygon(v, 4, camera, area, p));
    drawn.reset(side, side);
    using prof = fixed_profile<profiles::standard>;
    direct_engine<prof, 16> engine;
    renderer<direct_engine<prof, 16>, prof> r(engine, prof{}, drawn.frame());
    SPANTEX_ASSERT_OK(r.draw(p, t, filter::trilinear));
    SPANTEX_ASSERT_OK(r.finish());
    int64_t covered = 0;
    for (const rgba8& c : drawn.pixels) covered += !(c == background);
    assert_int_equal(covered, on_centre ? 1 : 0);
    if (on_centre) assert_true((at(20, 20) == rgba8{9, 8, 7, 6}));
  }
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(pixels_with_w_zero_or_less_are_not_drawn),
      cmocka_unit_test(w_that_underflows_is_degenerate),
      cmocka_unit_test(a_plane_without_texture_axes_shows_one_point),
      cmocka_unit_test(an_edge_on_plane_by_a_matrix_is_drawn_by_its_formula),
      cmocka_unit_test(a_map_of_one_texel_is_that_texel),
      cmocka_unit_test(an_axis_of_one_texel_has_position_0),
      cmocka_unit_test(huge_coordinates_become_32767_on_their_axis_only),
      cmocka_unit_test(positions_saturate_within_a_span),
      cmocka_unit_test(beyond_the_last_level_the_last_level_stays),
      cmocka_unit_test(magnified_maps_use_level_0_alone),
      cmocka_unit_test(a_camera_without_opening_shows_one_point),
      cmocka_unit_test(a_frame_of_no_pixels_is_left_alone),
      cmocka_unit_test(polygons_without_area_are_refused),
      cmocka_unit_test(a_polygon_that_is_not_plane_shows_the_plane_of_its_first_three_vertices),
      cmocka_unit_test(a_polygon_smaller_than_a_pixel_is_drawn_where_it_covers_a_centre),
  };
  return run_suite("degenerate", tests);
}
