// SPDX-License-Identifier: Apache-2.0
// The host's maps: sizes of levels, constants kept, brightness kept, no shift between levels, no seam where a map repeats.
#include <cmath>

#include <sim/map.hpp>
#include <sim/pattern.hpp>
#include <sim/window.hpp>
#include <tests/support.hpp>  // last: cmocka.h defines fail as a macro

namespace {

using namespace spantex;
using namespace spantex::sim;

constexpr prefilter both[] = {prefilter::box, prefilter::triangle};
constexpr prefilter all_prefilters[] = {prefilter::box, prefilter::triangle, prefilter::kaiser, prefilter::lanczos};

// How far beyond a coarse texel's own the texels lie that it is made of.
int reach(prefilter kind) { return kind == prefilter::kaiser || kind == prefilter::lanczos ? window_reach : 1; }

const image& noise(int width, int height) {
  static image out;
  static random_source random(11);
  out = image(width, height, {});
  for (rgba8& c : out.pixels) c = {uint8_t(random.next()), uint8_t(random.next()), uint8_t(random.next()), uint8_t(random.next())};
  return out;
}

double mean_red(const image& a) {
  double sum = 0;
  for (const rgba8& c : a.pixels) sum += c.r;
  return sum / double(a.pixels.size());
}

SPANTEX_CASE(level_sizes_are_floored_halves) {
  static const texture_map map(image(100, 7, {1, 2, 3, 4}), prefilter::box, wrap::repeat, wrap::repeat);
  assert_int_equal(map.level_count(), 7);
  for (int k = 0; k < map.level_count(); ++k) {
    assert_int_equal(map.level(k).width_px, level_side(100, k));
    assert_int_equal(map.level(k).height_px, level_side(7, k));
  }
}

SPANTEX_CASE(a_constant_stays) {
  constexpr rgba8 colour{255, 1, 0, 128};
  for (const prefilter kind : all_prefilters)
    for (const wrap mode : all_wraps)
      for (int width = 1; width <= 17; ++width)
        for (int height = 1; height <= 17; ++height) {
          static image level;
          level = halved(image(width, height, colour), kind, mode, mode);
          for (const rgba8& c : level.pixels) assert_true(c == colour);
        }
}

// Box: every texel counts alike, so the mean moves by rounding only. Repeating triangle likewise. (Kaiser and lanczos keep sums too, but clamp
// what their negative lobes drive out of range.)
SPANTEX_CASE(brightness_is_kept) {
  for (const prefilter kind : both)
    for (const int width : {64, 63, 37, 2, 3, 1})
      for (const int height : {32, 45, 5, 1}) {
        const image& fine = noise(width, height);
        static image coarse;
        coarse = halved(fine, kind, wrap::repeat, wrap::repeat);
        const double tolerance = 1 / std::sqrt(double(coarse.pixels.size())) + 0.01;  // three deviations of the mean of roundings
        assert_true(std::fabs(mean_red(fine) - mean_red(coarse)) < tolerance);
      }
}

// A ramp's level is the same ramp, seen at the coarse texels' centres: nothing moves by half a texel.
SPANTEX_CASE(nothing_shifts) {
  for (const prefilter kind : all_prefilters)
    for (const int size : {64, 63, 61, 48, 33, 29}) {
      static image fine, coarse;
      fine = image(size, size, {});
      for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) fine.at(x, y) = {uint8_t(3 * x + 20), uint8_t(3 * y + 20), 0, 0};
      coarse = halved(fine, kind, wrap::clamp, wrap::clamp);
      const double scale = double(size) / coarse.width_px;
      const int edge = reach(kind);
      for (int y = edge; y + edge < coarse.height_px; ++y)
        for (int x = edge; x + edge < coarse.width_px; ++x) {
          assert_true(std::fabs(coarse.at(x, y).r - (3 * ((x + 0.5) * scale - 0.5) + 20)) <= 0.51);
          assert_true(std::fabs(coarse.at(x, y).g - (3 * ((y + 0.5) * scale - 0.5) + 20)) <= 0.51);
        }
    }
}

// A repeating map turned by two texels has a level turned by one.
SPANTEX_CASE(repeating_maps_have_no_seam) {
  constexpr int side = 16;
  for (const prefilter kind : all_prefilters) {
    static image fine, turned, a, b;
    fine = noise(side, side);
    turned = fine;
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) turned.at(x, y) = fine.at((x + 2) % side, (y + 2) % side);
    a = halved(fine, kind, wrap::repeat, wrap::repeat);
    b = halved(turned, kind, wrap::repeat, wrap::repeat);
    for (int y = 0; y < side / 2; ++y)
      for (int x = 0; x < side / 2; ++x) assert_true(b.at(x, y) == a.at((x + 1) % (side / 2), (y + 1) % (side / 2)));
  }
}

// [1 3 3 1] / 8 in each direction: an impulse spreads over the four nearest coarse texels as 9, 3, 3, 1 of 64.
SPANTEX_CASE(triangle_is_kt88s) {
  static image fine, coarse;
  fine = image(8, 8, {0, 0, 0, 0});
  fine.at(4, 4).r = 192;
  coarse = halved(fine, prefilter::triangle, wrap::repeat, wrap::repeat);
  assert_int_equal(coarse.at(2, 2).r, 27);
  assert_int_equal(coarse.at(1, 2).r, 9);
  assert_int_equal(coarse.at(2, 1).r, 9);
  assert_int_equal(coarse.at(1, 1).r, 3);
  assert_int_equal(coarse.at(3, 2).r, 0);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {cmocka_unit_test(level_sizes_are_floored_halves), cmocka_unit_test(a_constant_stays),
                              cmocka_unit_test(brightness_is_kept),             cmocka_unit_test(nothing_shifts),
                              cmocka_unit_test(repeating_maps_have_no_seam),    cmocka_unit_test(triangle_is_kt88s)};
  return run_suite("mip_map", tests);
}
