// SPDX-License-Identifier: Apache-2.0
// Host kernels: the same bytes as the scalar datapath, for every filter they draw.
#include <tests/kernel_planes.hpp>

#include <math.h>

namespace {

SPANTEX_CASE(a_machine_has_words_and_its_own) {
  for (const named_kernel& k : every_kernel)
    if (kernels::kernel_of(k.which) == nullptr) print_message("no %s on this machine\n", k.name);
  assert_non_null(kernels::kernel_of(kernels::choice::words));
  assert_non_null(kernels::kernel_of(kernels::choice::fastest));
  assert_null(kernels::kernel_of(kernels::choice::scalar));
}

SPANTEX_CASE(numbers_choose_the_kernel) {
  using kernels::choice;
  profile fewer = profiles::standard, other = profiles::standard, other_exact = profiles::exact, bias = profiles::standard;
  fewer.max_samples = 5;
  other.sample_slack = 8;
  other_exact.sample_spacing = 3;
  bias.level_bias = 4;
  for (const profile& p : {profiles::standard, fewer}) {
    assert_true(kernels::resolved(choice::fastest, p) == kernels::resolved(choice::fastest) && kernels::draws(choice::words, p) && kernels::draws(choice::pixels, p));
  }
  for (const profile& p : {profiles::exact, other, other_exact}) {
    assert_true(kernels::resolved(choice::fastest, p) == choice::pixels && kernels::resolved(choice::words, p) == choice::words);
    assert_true(kernels::draws(choice::pixels, p) && !kernels::draws(choice::words, p));
  }
  for (const profile& p : {profiles::seed, profiles::compact, bias}) assert_true(kernels::resolved(choice::fastest, p) == choice::scalar && !kernels::draws(choice::pixels, p));
  assert_false(kernels::draws(choice::scalar, profiles::standard));
}

SPANTEX_CASE(other_filters_are_refused) {
  const ready_map map(random_map(64, 64), wrap::repeat);
  by_kernel.reset(64, 64);
  engine_type engine;
  renderer_type rest(engine, prof{}, by_kernel.frame());
  draw_counters counts;
  const kernels::row_kernel words = kernels::kernel_of(kernels::choice::words);
  for (const filter kind : {filter::three_point, filter::trilinear3, filter::squares, filter::step, filter::hat, filter::contour}) {
    assert_int_equal(kernels::draw_plane(words, map.rows, rest, sample_plane(0), map.view, kind, {0, 0, 64, 64}, by_kernel.frame(), counts), status::out_of_range);
    assert_int_equal(kernels::draw_polygon(words, kernels::words_cover(), map.rows, rest, polygon{}, map.view, kind, {0, 0, 64, 64}, depth_buffer{}, by_kernel.frame(), counts), status::out_of_range);
  }
}

SPANTEX_CASE(ordinary_planes_are_drawn_by_the_kernel_alone) { draw_ordinary_planes(colour_space::coded); }

SPANTEX_CASE(random_planes_and_maps_of_any_size) {
  static constexpr int32_t sides[][2] = {{512, 512}, {1, 1}, {2, 64}, {8, 8}, {500, 333}, {37, 5}, {1024, 16}, {3, 128}, {496, 80}};
  draw_random_planes(sides, colour_space::coded);
}

SPANTEX_CASE(rows_of_fewer_samples) {
  random_source random(21);
  for (const int32_t side : {512, 300}) draw_rows_of_samples(ready_map(random_map(side, side), side == 512 ? wrap::repeat : wrap::mirror), random);
}

SPANTEX_CASE(minified_planes) { draw_minified_planes(colour_space::coded); }

SPANTEX_CASE(turned_planes_between_levels) { draw_turned_planes_between_levels(colour_space::coded); }

// W is constant: planned by other ways, and each span's pixels have one level. Levels from below 0 to beyond the last; those of steps of 2^k (turned by 3, 4, 5) are halves,
// of 2^(k + 1/2) whole, as the bias is a half. Rows of pixels longer on the map than columns, and shorter; planes that do not grow one way, or at all.
SPANTEX_CASE(turned_planes_that_face_the_viewer) {
  static constexpr int32_t sides[][2] = {{512, 512}, {40, 24}, {500, 375}};
  const auto draw = [](const ready_map& map, const double (&m)[9], int32_t height = 24) {
    const rectangle area{0, 0, 96, height};
    plane p{};
    SPANTEX_ASSERT_OK(make_plane(homography_of(m), area, p));
    assert_true(p.w.x == 0 && p.w.y == 0);
    const bool near = magnitude(int64_t(m[0] / m[8])) < 8;  // none is left then
    for (const filter kind : {filter::nearest, filter::bilinear, filter::mip_bilinear, filter::trilinear}) draw_all(p, map, kind, area, 96, height, near ? 0 : UINT64_MAX);
  };
  for (const auto& side : sides)
    for (const wrap w : wraps) {
      const ready_map map(random_map(side[0], side[1]), w);
      for (double scale = 0.3; scale < 700; scale *= short_run() ? 1.9 : 1.1)
        for (const double stretch : {1.0, 0.4, 2.5}) draw(map, {0.866 * scale, -0.5 * stretch * scale, -100, 0.5 * scale, 0.866 * stretch * scale, 20, 0, 0, stretch * 1.7});
      for (int half_level = -2; half_level <= 20; ++half_level)
        for (const double around : {-0.001, 0.0, 0.001}) {
          const double by = exp2(half_level / 2.0) * (1 + around);
          draw(map, {0.6 * by, -0.8 * by, 7.3, 0.8 * by, 0.6 * by, 20.6, 0, 0, 1});
        }
      draw(map, {1.3, 0.7, 10.4, 0, 0, 3.2, 0, 0, 1});
      draw(map, {0, 3.3, 10.4, 0, 2.1, 3.2, 0, 0, 1});
      draw(map, {0, 0, 10.4, 0, 0, 3.2, 0, 0, 1}, 8);  // of one row of spans, which is not drawn as scaled
      draw(map, {80, -30, 1040, 30, 80, 320, 0, 0, 100});
    }
}

// What rows of such planes have in common (nearest): spans' centres on texels' borders, where the division says which texel is the nearest; next to the last that are near; sections of
// one to eight rows of texels, which spans, halves of spans, quads share; parts of spans, of texels that no section holds too.
SPANTEX_CASE(turned_planes_by_nearest) {
  const auto draw = [](const ready_map& map, const double (&m)[9], rectangle area = {0, 0, 200, 8}) {
    plane p{};
    SPANTEX_ASSERT_OK(make_plane(homography_of(m), area, p));
    draw_all(p, map, filter::nearest, area, 200, 24, 0);
  };
  for (const wrap w : wraps) {
    const ready_map map(random_map(512, 512), w), other(random_map(24, 40), w), narrow(random_map(2, 64), w), odd(random_map(3, 128), w), one(random_map(1, 1), w);
    for (const double side : {0.5, 0.75, 1.25, 2.0, 4.0})
      for (const double from : {0.0, 0.25, 0.5}) draw(map, {side, -0.5, from, 0.5, side, from - 3, 0, 0, 1});
    for (const double far : {8000.0, 16300.0, 16383.5, 16384.5, 20000.0})
      for (const double sign : {-1.0, 1.0}) draw(map, {0.8, -0.3, sign * far, 0.3, 0.8, -sign * far, 0, 0, 1});
    for (double degrees = 1; degrees < 360; degrees += short_run() ? 44 : 8)
      for (double scale = 0.03; scale < 3; scale *= short_run() ? 1.3 : 1.15) {
        const double x = scale * cos(degrees * 3.14159265358979 / 180), y = scale * sin(degrees * 3.14159265358979 / 180);
        draw(map, {x, -y, 3.7, y, x, 2.3, 0, 0, 1});
        draw(other, {x, y, 300, y, -x, -400, 0, 0, 1}, {3, 5, 187, 22});
        for (const ready_map* small : {&narrow, &odd, &one}) draw(*small, {x, -y, -2.6, y, x, 1.3, 0, 0, 1});
      }
  }
  // u of a span's centre is so little below -m - 1/2 that its division takes -m; a pixel next to it lies between two steps of coordinate_bits at a texel's border.
  const ready_map map(random_map(512, 512), wrap::repeat);
  for (const int32_t m : {8192, 10923, 12345, 14999, 16383})
    for (const int below : {18, 19, 20, 21, 22})
      for (int rest = 26; rest <= 34; ++rest) {
        const double little = exp2(-below), slope = 1 - 2 * (exp2(-17) - little);
        draw(map, {slope, 0, -m - 0.5 - little - exp2(-rest) - 68 * slope, 1, 1, 3.2, 0, 0, 1});  // of the ninth span
      }
}

SPANTEX_CASE(walls_to_the_side) { draw_walls_to_the_side(colour_space::coded); }

SPANTEX_CASE(pixels_about_their_centres) { draw_pixels_about_their_centres(colour_space::coded); }
SPANTEX_CASE(planes_to_the_horizon) { draw_planes_to_the_horizon(colour_space::coded); }

SPANTEX_CASE(other_numbers) { draw_by_other_numbers(colour_space::coded); }

SPANTEX_CASE(floors_and_walls) { draw_floors_and_walls(colour_space::coded); }

SPANTEX_CASE(sheared_and_magnified_planes) { draw_sheared_and_magnified_planes(colour_space::coded); }

// A span's texels of level 0 from less than four on a side to more than eight, on maps that are turned a little, so that no axis is upright.
SPANTEX_CASE(spans_of_four_to_nine_texels) {
  const ready_map map(random_map(256, 256), wrap::repeat);
  for (double scale = 0.3; scale < 1.2; scale += 0.03)
    for (const double turn : {0.02, -0.11, 1.4}) {
      const double across = scale * cos(turn), down = scale * sin(turn), m[9] = {across, -down, 31.3, down, across, 7.9, 0, 0.00003, 1};
      plane p{};
      SPANTEX_ASSERT_OK(make_plane(homography_of(m), {0, 0, 160, 96}, p));
      for (const filter kind : {filter::nearest, filter::bilinear}) draw_all(p, map, kind, {0, 0, 160, 96}, 160, 96);
    }
}

// W grows fast while positions hardly move: what bounds them takes all bits of an offset, and as much again for the division.
SPANTEX_CASE(positions_that_stand_still_while_w_does_not) {
  static constexpr struct { int32_t width, height; double m[9]; } every[] = {
      {500, 375, {4.7968157661003348, 1.9525313115119451, 66.893349392437415, 12.808930853713438, 5.2516022812216727, 178.82377685727567, 0.071551448077398536, 0.029308756492044542, 1}},
      {512, 512, {4.1349488401711314, 13.218981041925565, 100.90870038197508, 2.6562754015163152, 8.5236437626575476, 64.906727063426771, 0.04084894811487727, 0.13112214363255073, 1}},
      {500, 375, {2.0528054628219006, 19.620920677492112, 102.96070228131008, 0.41684758312651482, 4.006836306022775, 21.017424913680969, 0.019920084695935397, 0.19055696734715374, 1}}};
  for (const auto& one : every) {
    const ready_map map(random_map(one.width, one.height), wrap::repeat);
    plane p{};
    SPANTEX_ASSERT_OK(make_plane(homography_of(one.m), {0, 0, 136, 72}, p));
    for (const filter kind : filters) draw_all(p, map, kind, {0, 0, 136, 72}, 136, 72);
  }
  random_source random(31);
  const ready_map map(random_map(512, 512), wrap::mirror);
  const auto unit = [&] { return double(random.next() >> 11) / 9007199254740992.0; };
  for (int k = 0; k < (short_run() ? 20 : 400); ++k) {
    const double g = exp2(-unit() * 6 - 2), h = exp2(-unit() * 6 - 2), tiny = exp2(-unit() * 6 - 4), turn = unit() * 6.3, u = unit() * 200, w = unit() * 200;
    const double m[9] = {u * g + tiny * cos(turn), u * h - tiny * sin(turn), u, w * g + tiny * sin(turn), w * h + tiny * cos(turn), w, g, h, 1};
    plane p{};
    SPANTEX_ASSERT_OK(make_plane(homography_of(m), {0, 0, 136, 72}, p));
    draw_all(p, map, filters[k % 5], {0, 0, 136, 72}, 136, 72);
  }
}

SPANTEX_CASE(levels_that_do_not_halve_exactly) { draw_levels_that_do_not_halve_exactly(colour_space::coded); }

// Rows of samples on maps whose period is little more than a span, or less.
SPANTEX_CASE(long_rows_on_small_maps) {
  static constexpr int32_t sides[][2] = {{496, 80}, {48, 480}, {80, 80}, {256, 16}};
  for (const auto& side : sides)
    for (const wrap w : wraps) {
      const ready_map map(random_map(side[0], side[1]), w);
      for (int k = 0; k < 3; ++k) draw_all(sample_plane(k), map, filter::aniso, {200, 0, 320, 96}, 320, 96);
    }
}

// Spans that reach as far as one period lets them, and rows of samples further; of one level.
SPANTEX_CASE(rows_beyond_a_period) {
  static constexpr struct { int32_t side; double step; } every[] = {{69, 18.0}, {45, 36.3}};
  for (const auto [side, step] : every) {
    synthetic_map one = random_map(side, side);
    one.levels.resize(1);
    const ready_map map(one, wrap::repeat);
    const double m[9] = {step, 0.1, 0.3, 0.05, 0.9, 0.2, 0, 0, 1};
    plane p{};
    SPANTEX_ASSERT_OK(make_plane(homography_of(m), {0, 0, 640, 16}, p));
    draw_all(p, map, filter::aniso, {0, 0, 640, 16}, 640, 16);
  }
}

// Offsets grow where they are divided by w < 1: past what a period wraps, and past the range of coordinates.
plane in_65536ths(const int32_t (&m)[9]) {
  double of[9];
  for (int k = 0; k < 9; ++k) of[k] = m[k] / 65536.0;
  plane p{};
  SPANTEX_ASSERT_OK(make_plane(homography_of(of), {0, 0, 8, 8}, p));
  return p;
}

SPANTEX_CASE(texels_after_the_division) {
  synthetic_map one = random_map(67, 67);
  one.levels.resize(1);
  for (const wrap w : wraps)
    for (const filter kind : filters) draw_all(in_65536ths({512, 0, 0, 0, -17408, 69632, 0, -64, 1280}), ready_map(one, w), kind, {0, 0, 8, 8}, 8, 8);
}

SPANTEX_CASE(positions_next_to_the_end_of_the_range) {
  for (const wrap w : wraps) {
    const ready_map map(random_map(64, 64), w);
    for (const filter kind : filters) draw_all(in_65536ths({-806400, 0, 32512000, 0, 1024, 0, -64, 0, 1280}), map, kind, {0, 0, 8, 8}, 8, 8);
    // W constant: beyond it at the right; half way to it within the picture.
    for (const auto& [u, v] : {std::pair{32700, 20}, {100, 16350}}) {
      const double m[9] = {0.8, -0.3, double(u), 0.3, 0.8, double(v), 0, 0, 1};
      plane p{};
      SPANTEX_ASSERT_OK(make_plane(homography_of(m), {0, 0, 160, 96}, p));
      for (const filter kind : filters) draw_all(p, map, kind, {0, 0, 160, 96}, 160, 96);
    }
  }
}

// Samples next to the end of the range, on levels whose half texel lies beyond it.
SPANTEX_CASE(samples_next_to_the_end_of_the_range) {
  synthetic_map map = make_map(4096, 1024, [](int32_t x, int32_t) { return x < 2048 ? rgba8{0, 0, 0, 255} : rgba8{255, 255, 255, 255}; });
  map.levels.resize(11);
  const ready_map clamped(map, wrap::clamp);
  for (const auto& m : {in_65536ths({32608857, -101875900, -1266239092, -56583880, 7091680, 263504800, -2189, 6764, 47236}),
                        in_65536ths({48111024, -92501584, -1365745024, -60009856, 5960320, 281734144, -2928, 6288, 52096})})
    draw_all(m, clamped, filter::aniso, {0, 0, 8, 8}, 8, 8);
}

// W that is a little less than at the span's centre, so that its reciprocal is next to the end of its range, on spans steep enough to be divided: W falls
// along x as it rises along y, but for 2^-14 to 2^-20 of it a pixel.
SPANTEX_CASE(reciprocals_just_above_one) {
  const ready_map map(random_map(512, 512), wrap::repeat);
  for (const double less : {0.0, 1e-6, 3e-6, 1e-5, 4e-5})
    for (const double tilt : {0.02, 0.05, 0.08}) {
      const double m[9] = {1.7, 0.3, 3, -0.4, 0.9, 11, tilt, -tilt - less, 1 + 12 * less};
      plane p{};
      SPANTEX_ASSERT_OK(make_plane(homography_of(m), {0, 0, 24, 24}, p));
      for (const filter kind : filters) draw_all(p, map, kind, {0, 0, 24, 24}, 24, 24);
    }
}

SPANTEX_CASE(nothing_is_written_outside_the_area) {
  const ready_map map(random_map(64, 64), wrap::repeat);
  for (const filter kind : filters)
    for (const rectangle area : {rectangle{3, 5, 61, 44}, {9, 9, 10, 10}, {0, 0, 8, 8}, {63, 0, 65, 71}}) draw_all(sample_plane(1), map, kind, area, 67, 71);
}

void no_kernel(const kernels::row_work&) { fail_msg("a row was not drawn by its shortcut"); }

// What draw_all() drew last, without a kernel.
void draw_by_shortcut(const plane& p, const ready_map& map, filter kind, rectangle area) {
  picture drawn;
  drawn.reset(by_scalar.width, by_scalar.height);
  engine_type engine;
  renderer_type rest(engine, prof{}, drawn.frame());
  draw_counters counts;
  SPANTEX_ASSERT_OK(kernels::draw_plane(no_kernel, map.rows, rest, p, map.view, kind, area, drawn.frame(), counts));
  assert_true(drawn.pixels == by_scalar.pixels);
  assert_int_equal(counts.jobs, span_count(area));
}

SPANTEX_CASE(whole_texels_are_copied) {
  static constexpr int32_t sides[][2] = {{64, 32}, {1, 1}, {37, 5}, {300, 7}, {1, 16}};
  constexpr rectangle whole{0, 0, 203, 101}, part{3, 5, 61, 44};
  random_source random(31);
  for (const auto& side : sides)
    for (const wrap w : wraps) {
      const ready_map map(random_map(side[0], side[1]), w);
      for (const filter kind : filters)
        for (const rectangle area : {whole, part}) {
          const bool small = random.between(0, 1) == 0;
          const int32_t far = small ? 2 * side[0] : 27000;
          const auto u = double(random.between(-far, far)), v = double(random.between(-far, far));
          for (const double off : {0.0, 0.0031, -0.0037, 0.0039, -0.0041, 0.25}) {
            draw_all(upright_plane(u + off, v, 1, 1, whole), map, kind, area, 203, 101);
            draw_all(upright_plane(u, v + off, 1, 1, whole), map, kind, area, 203, 101);
          }
          for (const double more : {0.00001, 0.00004, -0.00004, 0.001}) {
            draw_all(upright_plane(u, v, 1 + more, 1, whole), map, kind, area, 203, 101);
            draw_all(upright_plane(u, v, 1, 1 + 2 * more, whole), map, kind, area, 203, 101);
          }
          const plane exact = upright_plane(u + 0.0029, v - 0.0029, 1, 1, whole);
          draw_all(exact, map, kind, area, 203, 101);
          draw_by_shortcut(exact, map, kind, area);
        }
    }
  const ready_map map(random_map(64, 64), wrap::mirror);
  for (const double end : {32760.0, 32600.0, 32000.0, -32760.0, -32700.0}) draw_all(upright_plane(end, 0, 1, 1, whole), map, filter::bilinear, whole, 203, 101);
}

// The smallest area lets steps differ most from a texel a pixel: a level of detail above 0 is next.
SPANTEX_CASE(whole_texels_of_one_span_are_copied) {
  constexpr rectangle one_span{8, 16, 16, 24}, whole{0, 0, 24, 24};
  constexpr double middle_x = 12, middle_y = 20;
  const ready_map map(random_map(64, 32), wrap::repeat);
  for (const filter kind : filters)
    for (int k = -40; k <= 40; ++k) {
      const double more = k * 0.00004;
      draw_all(upright_plane(-middle_x * more, 0, 1 + more, 1, whole), map, kind, one_span, 24, 24);
      draw_all(upright_plane(0, -middle_y * more, 1, 1 + more, whole), map, kind, one_span, 24, 24);
      draw_all(upright_plane(-middle_x * more, -middle_y * more, 1 + more, 1 + more, whole), map, kind, one_span, 24, 24);
    }
}

// A rectangle as far from the viewer as a texel is a pixel, its sides between pixels.
SPANTEX_CASE(polygons_of_whole_texels_are_copied) {
  constexpr int32_t one = 1 << 16, width = 203, height = 101, half = one / 2;
  constexpr projection camera{100 * one, 100 * one, width * half, height * half, one};
  const ready_map map(random_map(64, 48), wrap::repeat);
  const auto corner = [](int32_t x, int32_t y) { return vertex{x, y, 100 * one, x + width * half - 7 * one, y + height * half + 11 * one}; };
  const vertex corners[] = {corner(-50 * one - 20000, -30 * one - 9000), corner(61 * one, -30 * one - 9000), corner(61 * one, 40 * one + 100), corner(-50 * one - 20000, 40 * one + 100)};
  polygon p{};
  SPANTEX_ASSERT_OK(make_polygon(corners, 4, camera, {0, 0, width, height}, p));
  for (const filter kind : filters) {
    picture copied;
    copied.reset(width, height);
    by_scalar.reset(width, height);
    engine_type engine, other;
    renderer_type r(engine, prof{}, by_scalar.frame()), rest(other, prof{}, copied.frame());
    draw_counters counts;
    SPANTEX_ASSERT_OK(r.draw(p, map.view, kind, depth_buffer{}));
    SPANTEX_ASSERT_OK(r.finish());
    SPANTEX_ASSERT_OK(kernels::draw_polygon(no_kernel, kernels::words_cover(), map.rows, rest, p, map.view, kind, p.box, depth_buffer{}, copied.frame(), counts));
    assert_true(copied.pixels == by_scalar.pixels);
    assert_int_equal(counts.pixels, r.counters().pixels);
  }
}

SPANTEX_CASE(maps_of_one_colour_are_filled) {
  const ready_map map(make_map(24, 40, [](int32_t, int32_t) { return rgba8{9, 200, 77, 130}; }), wrap::clamp);
  for (const filter kind : filters)
    for (int k = 0; k < 3; ++k)
      for (const rectangle area : {rectangle{0, 0, 203, 101}, {3, 5, 61, 44}}) {
        draw_all(sample_plane(k), map, kind, area, 203, 101);
        draw_by_shortcut(sample_plane(k), map, kind, area);
      }
  constexpr double horizon[9] = {1, 0, 0, 0, 1, 0, 0, 0.02, -1};  // behind the viewer above it
  plane p{};
  SPANTEX_ASSERT_OK(make_plane(homography_of(horizon), {0, 0, 203, 101}, p));
  draw_all(p, map, filter::trilinear, {0, 0, 203, 101}, 203, 101);
}

SPANTEX_CASE(polygons_with_depth_are_the_same) {
  const ready_map map(random_map(128, 64), wrap::mirror);
  for (const filter kind : filters) draw_triangles(map, kind, 300);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_machine_has_words_and_its_own),
      cmocka_unit_test(numbers_choose_the_kernel),
      cmocka_unit_test(other_filters_are_refused),
      cmocka_unit_test(ordinary_planes_are_drawn_by_the_kernel_alone),
      cmocka_unit_test(random_planes_and_maps_of_any_size),
      cmocka_unit_test(rows_of_fewer_samples),
      cmocka_unit_test(minified_planes),
      cmocka_unit_test(turned_planes_between_levels),
      cmocka_unit_test(turned_planes_that_face_the_viewer),
      cmocka_unit_test(turned_planes_by_nearest),
      cmocka_unit_test(walls_to_the_side),
      cmocka_unit_test(planes_to_the_horizon),
      cmocka_unit_test(pixels_about_their_centres),
      cmocka_unit_test(other_numbers),
      cmocka_unit_test(floors_and_walls),
      cmocka_unit_test(sheared_and_magnified_planes),
      cmocka_unit_test(spans_of_four_to_nine_texels),
      cmocka_unit_test(positions_that_stand_still_while_w_does_not),
      cmocka_unit_test(levels_that_do_not_halve_exactly),
      cmocka_unit_test(long_rows_on_small_maps),
      cmocka_unit_test(rows_beyond_a_period),
      cmocka_unit_test(texels_after_the_division),
      cmocka_unit_test(positions_next_to_the_end_of_the_range),
      cmocka_unit_test(samples_next_to_the_end_of_the_range),
      cmocka_unit_test(reciprocals_just_above_one),
      cmocka_unit_test(nothing_is_written_outside_the_area),
      cmocka_unit_test(whole_texels_are_copied),
      cmocka_unit_test(whole_texels_of_one_span_are_copied),
      cmocka_unit_test(polygons_of_whole_texels_are_copied),
      cmocka_unit_test(maps_of_one_colour_are_filled),
      cmocka_unit_test(polygons_with_depth_are_the_same),
  };
  return run_suite("kernels", tests);
}
