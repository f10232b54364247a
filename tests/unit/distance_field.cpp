// SPDX-License-Identifier: Apache-2.0
// Distance fields of masks: the exact transform against all pairs, signed distances of known shapes, levels of a field map.
#include <algorithm>
#include <cmath>

#include <sim/distance_field.hpp>
#include <sim/pack.hpp>
#include <tests/support.hpp>  // last: cmocka.h defines fail as a macro

using namespace spantex;
using namespace spantex::sim;

namespace {

int64_t nearest_by_hand(const mask& m, int x, int y, bool of) {
  int64_t best = no_distance;
  for (int v = 0; v < m.height_px; ++v)
    for (int u = 0; u < m.width_px; ++u)
      if (m.at(u, v) == of) best = std::min<int64_t>(best, int64_t(u - x) * (u - x) + int64_t(v - y) * (v - y));
  return best;
}

}  // namespace

SPANTEX_CASE(the_transform_equals_all_pairs) {
  random_source random(2);
  for (int n = 0; n < 60; ++n) {
    mask m{int(random.between(1, 40)), int(random.between(1, 40)), {}};
    const uint64_t rare = 1 + random.next() % 200;
    for (int k = 0; k < m.width_px * m.height_px; ++k) m.inside.push_back(random.next() % rare == 0);
    if (n == 0) std::fill(m.inside.begin(), m.inside.end(), 0);
    for (const bool of : {false, true}) {
      const std::vector<int64_t> got = squared_distances(m, of);
      for (int y = 0; y < m.height_px; ++y)
        for (int x = 0; x < m.width_px; ++x) assert_true(got[size_t(y * m.width_px + x)] == nearest_by_hand(m, x, y, of));
    }
  }
}

SPANTEX_CASE(signed_distances_of_a_half_plane_and_a_disc) {
  mask half{64, 8, {}}, disc{200, 200, {}};
  for (int k = 0; k < 64 * 8; ++k) half.inside.push_back(k % 64 >= 20);
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x) disc.inside.push_back(std::hypot(x - 99.5, y - 99.5) < 60);
  const std::vector<int32_t> a = signed_distances(half), b = signed_distances(disc);
  for (int k = 0; k < 64 * 8; ++k) assert_int_equal(a[size_t(k)], (2 * (k % 64) + 1 - 40) * 128);
  double worst = 0;
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x) worst = std::max(worst, std::fabs(b[size_t(y * 200 + x)] / 256.0 - (60 - std::hypot(x - 99.5, y - 99.5))));
  print_message("disc: worst %.3f pixel of the mask\n", worst);
  assert_true(worst < 0.75);  // half a diagonal: a mask knows its outline no better
}

// A half-plane's field is linear, so its mean over a texel is its middle: on every level 128 + scale * distance in texels of the level.
SPANTEX_CASE(levels_hold_distances_in_their_own_texels) {
  image picture(256, 256, {0, 0, 0, 255});
  for (int y = 0; y < 256; ++y)
    for (int x = 128; x < 256; ++x) picture.at(x, y) = {255, 255, 255, 255};
  const texture_map map = make_field_map(picture, 4, 16, 24, {1, 2, 3, 0}, wrap::clamp, wrap::clamp);
  assert_int_equal(map.view().width(), 64);
  assert_int_equal(map.level_count(), 7);
  assert_int_equal(map.view().contour().outline, 24);
  assert_true(map.view().contour().unit == field_unit::own_level);
  for (int level = 0; level < map.level_count(); ++level)
    for (int x = 0; x < map.level(level).width_px; ++x) {
      const double texels = x + 0.5 - 32.0 / (1 << level);
      const rgba8 c = map.level(level).at(x, 0);
      assert_int_equal(c.a, int(std::clamp(std::floor(128.5 + 16 * texels), 0.0, 255.0)));
      assert_true(c.r == 1 && c.g == 2 && c.b == 3);
    }
}

SPANTEX_CASE(the_inside_is_what_the_rule_says) {
  image picture(3, 1, {255, 255, 255, 255});
  picture.at(1, 0) = {0, 0, 0, 255};
  picture.at(2, 0) = {0, 0, 0, 0};
  const auto inside = [&](inside_by rule) {
    const mask m = make_mask(picture, rule);
    return 100 * m.at(0, 0) + 10 * m.at(1, 0) + m.at(2, 0);
  };
  assert_int_equal(inside(inside_by::alpha), 110);
  assert_int_equal(inside(inside_by::either), 110);
  assert_int_equal(inside(inside_by::light), 100);
  assert_int_equal(inside(inside_by::dark), 11);
}

// A pack of a contour map holds the levels as they are, and their style.
SPANTEX_CASE(packs_hold_levels_and_style) {
  image picture(64, 32, {0, 0, 0, 255});
  for (int y = 8; y < 20; ++y)
    for (int x = 10; x < 50; ++x) picture.at(x, y) = {255, 255, 255, 255};
  static std::vector<image> levels;
  levels = make_field_levels(picture, 2, 24, {9, 8, 7, 0});
  for (const texel_format format : {texel_format::rgba8888, texel_format::a8, texel_format::la88}) {
    compile_options o;
    o.format = format;
    static bytes pack;
    pack = compile_contour_pack(levels, field_style(24, 40), o);
    texture_pack p;
    SPANTEX_ASSERT_OK(texture_pack::open(pack.data(), pack.size(), p));
    assert_true(p.contour() && !p.srgb());
    const contour_style& s = p.view().contour();
    assert_true(s.threshold == 128 << 8 && s.scale == 24 << 8 && s.outline == 40 && s.unit == field_unit::own_level);
    assert_int_equal(p.view().level_count(), levels.size());
    for (int k = 0; k < p.view().level_count(); ++k)
      for (int y = 0; y < p.view().height(k); ++y)
        for (int x = 0; x < p.view().width(k); ++x) assert_int_equal(p.view().texel(k, x, y).a, levels[size_t(k)].at(x, y).a);
  }
}

SPANTEX_CASE(alpha_is_the_mask_where_a_picture_has_any) {
  image picture(2, 1, {255, 255, 255, 255});
  picture.at(1, 0) = {0, 0, 0, 255};
  mask m = make_mask(picture);
  assert_true(m.at(0, 0) && !m.at(1, 0));
  picture.at(0, 0).a = 127;
  m = make_mask(picture);
  assert_true(!m.at(0, 0) && m.at(1, 0));
}

int main() {
  const CMUnitTest tests[] = {cmocka_unit_test(the_transform_equals_all_pairs), cmocka_unit_test(signed_distances_of_a_half_plane_and_a_disc),
                              cmocka_unit_test(levels_hold_distances_in_their_own_texels),
                              cmocka_unit_test(the_inside_is_what_the_rule_says), cmocka_unit_test(packs_hold_levels_and_style),
                              cmocka_unit_test(alpha_is_the_mask_where_a_picture_has_any)};
  return run_suite("distance_field", tests);
}
