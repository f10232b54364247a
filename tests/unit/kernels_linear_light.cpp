// SPDX-License-Identifier: Apache-2.0
// Host kernels in linear light: sRGB maps, the same bytes as the scalar datapath.
#include <tests/kernel_planes.hpp>

#include <algorithm>
#include <vector>

#include <hal/kernels/linear_light.hpp>

namespace {

constexpr filter blending[] = {filter::bilinear, filter::mip_bilinear, filter::trilinear, filter::aniso};

ready_map srgb_map(const synthetic_map& map, wrap w) { return ready_map(map, w, colour_space::srgb); }

// Codes from `first` to `last`, alpha from 0 to 255, or 255.
const synthetic_map& noise_map(int32_t width, int32_t height, uint32_t first, uint32_t last, bool opaque = false) {
  static random_source random(8);
  return make_map(width, height, [&](int32_t, int32_t) {
    const auto code = [&] { return uint8_t(random.between(first, last)); };
    return rgba8{code(), code(), code(), opaque ? uint8_t(255) : uint8_t(random.next())};
  });
}

SPANTEX_CASE(every_number_has_its_code) {
  for (uint32_t x = 0; x < 65536; ++x) assert_int_equal((kernels::srgb_code_of.step[x >> 4] + (x & 15)) >> 4, srgb_encoded(x));
}

SPANTEX_CASE(ordinary_planes_are_drawn_by_the_kernel_alone) { draw_ordinary_planes(colour_space::srgb); }

// Of dark codes every 20th number is a threshold, which is odd: sums that end half way to it, and samples whose rounding decides it, are there.
SPANTEX_CASE(dark_maps) {
  const ready_map map = srgb_map(noise_map(512, 512, 5, 10), wrap::repeat);
  for (const filter kind : blending)
    for (int k = 0; k < 3; ++k) draw_all(sample_plane(k), map, kind, {0, 0, 640, 480}, 640, 480);
}

// Every number there is: texels a code apart, one of four less or one more, so that products of weights tell them apart; a 128th of a texel from pixel to pixel.
SPANTEX_CASE(every_number_is_coded) {
  constexpr int32_t width = 16, height = 26, weight = 128;
  const auto code = [](int32_t x, int32_t y, int32_t channel) { return min_of(85 * channel + 7 * (y / 2) + x / 2, 254) + (x % 2 != 0 || y % 2 != 0); };
  std::vector<bool> found(65536);
  for (int32_t channel = 0; channel < 3; ++channel)
    for (int32_t y = 0; y + 1 < height; ++y)
      for (int32_t x = 0; x + 1 < width; ++x) {
        const auto light = [&](int32_t right, int32_t down) { return srgb_decoded(uint32_t(code(x + right, y + down, channel))); };
        for (uint32_t u = 0; u < weight; ++u)
          for (uint32_t v = 0; v < weight; ++v) {
            const uint32_t sum = (light(0, 0) * (weight - u) + light(1, 0) * u) * (weight - v) + (light(0, 1) * (weight - u) + light(1, 1) * u) * v, half = weight * weight / 2;
            found[(sum + half - 1 + (sum / (2 * half) & 1)) / (2 * half)] = true;
          }
      }
  assert_int_equal(std::count(found.begin(), found.end(), true), 65536);
  const rectangle all{0, 0, width * weight, height * weight};
  for (const uint8_t alpha : {uint8_t(255), uint8_t(97)}) {
    const ready_map map = srgb_map(make_map(width, height, [&](int32_t x, int32_t y) { return rgba8{uint8_t(code(x, y, 0)), uint8_t(code(x, y, 1)), uint8_t(code(x, y, 2)), alpha}; }), wrap::clamp);
    draw_all(upright_plane(0.5 - 0.5 / weight, 0.5 - 0.5 / weight, 1.0 / weight, 1.0 / weight, all), map, filter::bilinear, all, all.x1, all.y1);
  }
}

// Every pixel another number: magnified, so that weights take all their values.
SPANTEX_CASE(numbers_of_every_size) {
  const ready_map map = srgb_map(random_map(64, 64), wrap::repeat);
  const rectangle all{0, 0, 1024, 1024};
  draw_all(upright_plane(0.3, 0.7, 1 / 127.0, 1 / 129.0, all), map, filter::bilinear, all, 1024, 1024);
}

// Their alpha has no number: whole spans' are finished without, those at the sides of an area with it.
SPANTEX_CASE(opaque_maps) {
  const rectangle all{0, 0, 1024, 1024}, ragged{3, 5, 637, 475};
  for (const auto& [first, last] : {std::pair{0u, 255u}, {5u, 10u}}) {
    const ready_map map = srgb_map(noise_map(256, 256, first, last, true), wrap::repeat);
    draw_all(upright_plane(0.3, 0.7, 1 / 31.0, 1 / 33.0, all), map, filter::bilinear, all, 1024, 1024);
    for (const filter kind : blending) {
      for (int k = 0; k < 3; ++k) draw_all(sample_plane(k), map, kind, ragged, 640, 480);
      draw_triangles(map, kind, 20);
    }
  }
}

SPANTEX_CASE(black_and_white) {
  const ready_map map = srgb_map(make_map(256, 128, [](int32_t x, int32_t y) {
    const auto one = [&](int32_t k) { return uint8_t(((x * 7 + y * (k + 3)) / (k + 2)) % 2 * 255); };
    return rgba8{one(0), one(1), one(2), one(3)};
  }), wrap::clamp);
  for (const filter kind : blending)
    for (int k = 0; k < sample_plane_count; ++k) draw_all(sample_plane(k), map, kind, {0, 0, 320, 240}, 320, 240);
}

SPANTEX_CASE(random_planes_and_maps_of_any_size) {
  static constexpr int32_t sides[][2] = {{512, 512}, {1, 1}, {2, 64}, {8, 8}, {500, 333}, {37, 5}, {1024, 16}, {3, 128}, {257, 129}};
  draw_random_planes(sides, colour_space::srgb);
}

// A row of one sample is rounded twice, unlike a filter's one sample; of many, a sum of them all takes all 32 bits.
SPANTEX_CASE(rows_of_any_number_of_samples) {
  random_source random(21);
  for (const auto& [first, last] : {std::pair{0, 255}, {5, 10}, {255, 255}}) draw_rows_of_samples(srgb_map(noise_map(300, 512, uint32_t(first), uint32_t(last)), wrap::repeat), random);
}

// Turned, upright, copied texel by texel, and of one colour: ways that colours as coded have of their own.
SPANTEX_CASE(planes_that_face_the_viewer) {
  const rectangle all{0, 0, 203, 101};
  for (const wrap w : wraps)
    for (const ready_map& map : {srgb_map(random_map(128, 64), w), srgb_map(random_map(100, 75), w), srgb_map(constant_map(24, 40, {9, 200, 77, 130}), w)})
      for (const filter kind : filters) {
        for (const plane& p : {upright_plane(0, 0, 1, 1, all), upright_plane(-30, 7, 1, 1, all), upright_plane(0.3, 7, 0.4, 1.7, all), upright_plane(300, 20, 3.3, 5, all)}) draw_all(p, map, kind, all, 203, 101);
        const double turned[9] = {0.866, -0.5, -100, 0.5, 0.866, 20, 0, 0, 1};
        plane p{};
        SPANTEX_ASSERT_OK(make_plane(homography_of(turned), all, p));
        draw_all(p, map, kind, all, 203, 101);
      }
}

SPANTEX_CASE(minified_planes) { draw_minified_planes(colour_space::srgb); }
SPANTEX_CASE(turned_planes_between_levels) { draw_turned_planes_between_levels(colour_space::srgb); }
SPANTEX_CASE(walls_to_the_side) { draw_walls_to_the_side(colour_space::srgb); }
SPANTEX_CASE(pixels_about_their_centres) { draw_pixels_about_their_centres(colour_space::srgb); }
SPANTEX_CASE(planes_to_the_horizon) { draw_planes_to_the_horizon(colour_space::srgb); }

SPANTEX_CASE(other_numbers) { draw_by_other_numbers(colour_space::srgb); }

SPANTEX_CASE(floors_and_walls) { draw_floors_and_walls(colour_space::srgb); }
SPANTEX_CASE(sheared_and_magnified_planes) { draw_sheared_and_magnified_planes(colour_space::srgb); }
SPANTEX_CASE(levels_that_do_not_halve_exactly) { draw_levels_that_do_not_halve_exactly(colour_space::srgb); }

SPANTEX_CASE(polygons_with_depth) {
  const ready_map map = srgb_map(random_map(128, 64), wrap::mirror);
  for (const filter kind : filters) draw_triangles(map, kind, 100);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(every_number_has_its_code),
      cmocka_unit_test(ordinary_planes_are_drawn_by_the_kernel_alone),
      cmocka_unit_test(dark_maps),
      cmocka_unit_test(every_number_is_coded),
      cmocka_unit_test(numbers_of_every_size),
      cmocka_unit_test(opaque_maps),
      cmocka_unit_test(black_and_white),
      cmocka_unit_test(random_planes_and_maps_of_any_size),
      cmocka_unit_test(rows_of_any_number_of_samples),
      cmocka_unit_test(planes_that_face_the_viewer),
      cmocka_unit_test(minified_planes),
      cmocka_unit_test(turned_planes_between_levels),
      cmocka_unit_test(walls_to_the_side),
      cmocka_unit_test(planes_to_the_horizon),
      cmocka_unit_test(pixels_about_their_centres),
      cmocka_unit_test(other_numbers),
      cmocka_unit_test(floors_and_walls),
      cmocka_unit_test(sheared_and_magnified_planes),
      cmocka_unit_test(levels_that_do_not_halve_exactly),
      cmocka_unit_test(polygons_with_depth),
  };
  return run_suite("kernels_linear_light", tests);
}
