// SPDX-License-Identifier: Apache-2.0
// Planes that take every way that host kernels have from the map's levels to pixels: sections of every size, one level to three.
#pragma once
#include <tests/kernel_pictures.hpp>

#include <math.h>

namespace {

// Levels of detail other than the first two, and from one to the next.
inline void draw_minified_planes(colour_space colours) {
  static constexpr int32_t sides[][2] = {{512, 512}, {500, 375}};
  for (const auto& side : sides) {
    const ready_map map(random_map(side[0], side[1]), wrap::repeat, colours);
    for (const double scale : {2.5, 4.5}) {
      const double m[9] = {0.62 * scale, -0.14 * scale, -12 * scale, -0.23 * scale, -0.39 * scale, 585 * scale, 0, 0.00085, 0.44};
      plane p{};
      SPANTEX_ASSERT_OK(make_plane(homography_of(m), {0, 0, 64, 480}, p));
      for (const filter kind : filters) draw_all(p, map, kind, {0, 0, 64, 480}, 64, 480);
    }
  }
}

// Quads of two and of three blocks either way, before they take the next level; thirteen levels.
inline void draw_turned_planes_between_levels(colour_space colours) {
  static constexpr int32_t sides[][2] = {{512, 512}, {40, 24}, {4096, 8}, {500, 375}};
  for (const auto& side : sides)
    for (const wrap w : wraps) {
      const ready_map map(random_map(side[0], side[1]), w, colours);
      for (const double scale : {1.6, 2.2, 2.8})
        for (const double stretch : {1.0, 3.0}) {
          const double m[9] = {0.866 * scale * stretch, -0.5 * scale, -100, 0.5 * scale * stretch, 0.866 * scale, 20, 0, 0.0002, 1};
          plane p{};
          SPANTEX_ASSERT_OK(make_plane(homography_of(m), {0, 0, 96, 72}, p));
          for (const filter kind : filters) draw_all(p, map, kind, {0, 0, 96, 72}, 96, 72);
        }
    }
}

// A wall to the side, minified across: quads that reach more than eight rows of a span's second level too.
inline void draw_walls_to_the_side(colour_space colours) {
  const double m[9] = {1.913, 0.307, 101.7, -0.211, 1.297, 702.3, 0.00115, 0.0001, 0.253};
  plane p{};
  SPANTEX_ASSERT_OK(make_plane(homography_of(m), {0, 0, 640, 160}, p));
  static constexpr int32_t sides[][2] = {{512, 512}, {500, 375}};
  for (const auto& side : sides) {
    const ready_map map(random_map(side[0], side[1]), wrap::repeat, colours);
    for (const filter kind : {filter::mip_bilinear, filter::trilinear}) draw_all(p, map, kind, {0, 0, 640, 160}, 640, 160);
  }
}

// Up to the horizon and beyond, whichever way it runs: W falls to nothing within the picture. Near it kernels leave spans, which are drawn pixel by pixel: whose texels are far apart, out of range,
// on the last level; and, far from the origin, whose rounding at set-up would show.
inline void draw_planes_to_the_horizon(colour_space colours) {
  static constexpr int32_t sides[][2] = {{512, 512}, {500, 375}, {1, 1}, {2048, 2}, {1, 64}, {3, 5}};
  constexpr rectangle area{0, 0, 203, 101};
  random_source random(41);
  for (const auto& side : sides)
    for (const wrap w : wraps) {
      const ready_map map(random_map(side[0], side[1]), w, colours);
      for (int k = 0; k < (short_run() ? 4 : 24); ++k) {
        const double turn = double(random.between(0, 6283)) / 1000, far = k % 4 == 0 ? 32000 : k % 4 == 1 ? 9000 : 700, closeness = k % 3 == 0 ? 0.0004 : 0.01;
        const double horizon_x = double(random.between(10, 190)), horizon_y = double(random.between(10, 90)), g = k % 5 == 2 ? 0 : closeness * cos(turn), h = closeness * sin(turn);  // level, now and then
        const double m[9] = {0.7 * cos(turn + 1), 0.4, far * (k % 2 == 0 ? 1 : -0.3), -0.2, 0.9 * sin(turn + 2), 0.01 * far, g, h, -g * horizon_x - h * horizon_y};
        plane p{};
        SPANTEX_ASSERT_OK(make_plane(homography_of(m), area, p));
        for (const filter kind : filters) draw_all(p, map, kind, area, 203, 101);
      }
    }
}

// With all bits of the numbers: the largest has 100.
inline homography exact_homography_of(const double (&m)[9]) {
  const auto log2_of = [](double x) {
    int log2 = 0;
    frexp(x, &log2);
    return log2;
  };
  int largest = log2_of(m[0]);
  for (const double x : m) largest = max_of(largest, log2_of(x));
  const auto w = [&](int k) { return scale_down(wide(int64_t(ldexp(m[k], 53 - log2_of(m[k])))), largest - log2_of(m[k]) + 53 - 100); };
  return {w(0), w(1), w(2), w(3), w(4), w(5), w(6), w(7), w(8)};
}

// Pixels about their own centres, of planes with a hundred bits: far away set-up's rounding shows, and in the same row of pixels does not; positions next to 2^15 and beyond; a horizon through
// pixels' centres, where W is 0 but for rounding.
inline void draw_pixels_about_their_centres(colour_space colours) {
  static constexpr int32_t sides[][2] = {{512, 512}, {500, 375}, {4096, 24}};
  constexpr rectangle area{0, 0, 203, 101};
  const auto few_bits = [](double x) { return double(int64_t(x * 0x1p50)) * 0x1p-50; };
  random_source random(47);
  for (const auto& side : sides)
    for (const wrap w : wraps) {
      const ready_map map(random_map(side[0], side[1]), w, w == wrap::clamp ? wrap::repeat : w == wrap::mirror ? wrap::clamp : w, colours);
      for (int k = 0; k < 24; ++k) {
        const bool is_level = k % 3 != 0;
        const double g = is_level ? 0 : few_bits(0.013 * double(random.between(-9, 9)) / 7), h = few_bits(0.011 * double(random.between(3, 11)) / 7 * (k % 2 == 0 ? 1 : -1));
        const int32_t x = int32_t(random.between(20, 180)), y = int32_t(random.between(20, 80));
        const double through = k % 4 == 3 ? 0.37 : 0.5, far = k % 5 == 0 ? 900 : k % 5 == 1 ? 90 : 7;
        const double m[9] = {0.61 * far / 9, 0.23 / 7, -0.61 * far / 9 * x, -0.17, 0.43 / 3, far * 11 / 3., g, h, -g * (x + 0.5) - h * (y + through)};
        plane p{};
        SPANTEX_ASSERT_OK(make_plane(exact_homography_of(m), area, p));
        for (const filter kind : {filter::nearest, filter::bilinear}) draw_all(p, map, kind, area, 203, 101);
      }
    }
}

// Numbers that are `pixels`' alone: profile exact, and aniso's other than how many samples at most.
inline void draw_by_other_numbers(colour_space colours) {
  const ready_map even(random_map(256, 512), wrap::repeat, colours), uneven(random_map(300, 200), wrap::mirror, colours), held(random_map(64, 64), wrap::clamp, colours);
  constexpr rectangle area{0, 0, 203, 101};
  random_source random(43);
  run_time_profile samples{profiles::standard};
  for (const ready_map* map : {&even, &uneven, &held})
    for (int k = 0; k < (short_run() ? 5 : 12); ++k) {
      plane p = sample_plane(k % 3);
      if (k >= 3 && !random_plane(random, area, p)) continue;
      for (const filter kind : filters) draw_all_by<fixed_profile<profiles::exact>, profiles::exact.fine_side>({}, p, *map, kind, area, 203, 101);
      samples.value.sample_spacing = k % 2 == 0 ? 0 : 16;
      samples.value.sample_slack = 5 * (k % 4);
      samples.value.sample_bias = -4 * (k % 5);
      samples.value.max_samples = 16 - k;
      draw_all_by(samples, p, *map, filter::aniso, area, 203, 101);
    }
  // Where profile default's kernels have other ways: texels next to copies, scaled planes. And to the horizon, by exact with other samples too.
  run_time_profile exact{profiles::exact};
  exact.value.sample_spacing = 9;
  exact.value.sample_slack = 11;
  for (const plane& p : {upright_plane(7 + 1 / 400., 3, 1, 1, area), upright_plane(0.3, 7, 0.4, 1.7, area), plane_to_the_horizon(area)})
    for (const ready_map* map : {&even, &uneven}) {
      for (const filter kind : filters) draw_all_by<fixed_profile<profiles::exact>, profiles::exact.fine_side>({}, p, *map, kind, area, 203, 101);
      draw_all_by<run_time_profile, profiles::exact.fine_side>(exact, p, *map, filter::aniso, area, 203, 101);
    }
}

// Floors and walls seen by a camera that is not rolled: W varies along one axis of the screen alone, hardly or up to what only a division holds; the map is turned, and denser across or down.
inline void draw_floors_and_walls(colour_space colours) {
  const ready_map even(random_map(512, 512), wrap::repeat, colours), held(random_map(256, 512), wrap::clamp, colours), uneven(random_map(500, 375), wrap::mirror, colours);
  for (const double slope : {0.0001, 0.0006, 0.0022, 0.009, -0.0022, -0.009})
    for (const double denser : {1., 2.6}) {
      const double last = slope < 0 ? 0.6 : 0.09;  // of the last one's, half of the picture lies behind the viewer
      const double both[][9] = {{0.41 * denser, -0.11, 7.3, 0.13, 0.37, 585.4, 0, slope, last}, {0.41, -0.11 * denser, 7.3, 0.13, 0.37 * denser, 585.4, slope, 0, last}};
      for (const double (&m)[9] : both) {
        plane p{};
        SPANTEX_ASSERT_OK(make_plane(homography_of(m), {0, 0, 160, 96}, p));
        for (const filter kind : filters) draw_all(p, even, kind, {0, 0, 160, 96}, 160, 96);
        for (const ready_map* other : {&held, &uneven})
          for (const filter kind : {filter::trilinear, filter::aniso}) draw_all(p, *other, kind, {0, 0, 160, 96}, 160, 96);
      }
    }
}

// Quads wider than their pixels' steps let one expect: u grows across and down alike. And texels that take many pixels: offsets are smaller than one, with many bits.
inline void draw_sheared_and_magnified_planes(colour_space colours) {
  const ready_map map(random_map(512, 512), wrap::repeat, colours), small(random_map(64, 64), wrap::repeat, colours), uneven(random_map(500, 375), wrap::repeat, colours);
  for (const double scale : {1.35, 1.9, 2.7, 5.4, 0.11, 0.021, 0.006, 0.0013})
    for (const double other : {0.04, -0.3}) {
      const double m[9] = {scale, scale, 100.4, other * scale, -other * scale, 20.4, 0, 0.0001 * scale, 1};
      plane p{};
      SPANTEX_ASSERT_OK(make_plane(homography_of(m), {0, 0, 160, 96}, p));
      for (const filter kind : filters) draw_all(p, map, kind, {0, 0, 160, 96}, 160, 96);
      if (scale < 1) continue;
      for (const filter kind : {filter::mip_bilinear, filter::trilinear}) draw_all(p, uneven, kind, {0, 0, 160, 96}, 160, 96);
      const double turned[9] = {m[3], m[4], m[5], m[0], m[1], m[2], m[6], m[7], m[8]};  // more rows than columns
      SPANTEX_ASSERT_OK(make_plane(homography_of(turned), {0, 0, 160, 96}, p));
      for (const ready_map* each : {&map, &small, &uneven})
        for (const filter kind : {filter::mip_bilinear, filter::trilinear}) draw_all(p, *each, kind, {0, 0, 160, 96}, 160, 96);
    }
}

// Sides whose halves are rounded down, to powers of two too: positions on their levels are products, of positions from the origin, however far.
inline void draw_levels_that_do_not_halve_exactly(colour_space colours) {
  static constexpr int32_t sides[][2] = {{500, 375}, {640, 480}, {100, 37}, {7, 300}, {300, 250}, {96, 80}, {257, 129}, {1080, 512}};
  for (const auto& side : sides)
    for (const wrap w : wraps) {
      const ready_map map(random_map(side[0], side[1]), w, colours);
      for (const double far : {0.0, 19777.3, -20011.9})
        for (const double scale : {0.6, 3.1, 11.0}) {
          const double stretch = scale < 3 ? 4.3 : 1;  // rows of samples
          const double m[9] = {0.81 * scale * stretch, 0.33 * scale * stretch, far, -0.29 * scale, 0.77 * scale, 0.7 * far + 13, 0.0003, 0.0007, 1};
          plane p{};
          SPANTEX_ASSERT_OK(make_plane(homography_of(m), {0, 0, 96, 40}, p));
          for (const filter kind : {filter::mip_bilinear, filter::trilinear, filter::aniso}) draw_all(p, map, kind, {0, 0, 96, 40}, 96, 40);
        }
    }
  for (const wrap w : wraps) {
    const ready_map map(random_map(500, 375), w, colours);
    for (const filter kind : filters)
      for (int k = 0; k < 2; ++k) draw_all(sample_plane(k), map, kind, {0, 0, 640, 480}, 640, 480, 4800 / 100);
  }
}

}  // namespace
