// SPDX-License-Identifier: Apache-2.0
// The map view: what it refuses, sizes and ratios of levels, and which texel an index means.
#include <tests/support.hpp>

using namespace spantex;
using namespace spantex::sim;

static const rgba8 one_texel[1] = {{1, 2, 3, 4}};

static status make_view(int levels, int32_t width, int32_t height, texture_view& t) {
  const rgba8* pointers[32];
  for (const rgba8*& p : pointers) p = one_texel;
  return texture_view::make(pointers, levels, width, height, wrap::repeat, wrap::clamp, t);
}

SPANTEX_CASE(sizes_outside_1_to_4096_are_refused) {
  texture_view t;
  for (const int32_t bad : {0, -1, 4097, INT32_MAX, INT32_MIN}) {
    SPANTEX_ASSERT_STATUS(make_view(1, bad, 16, t), bad_size);
    SPANTEX_ASSERT_STATUS(make_view(1, 16, bad, t), bad_size);
  }
  SPANTEX_ASSERT_OK(make_view(1, 1, 1, t));
  SPANTEX_ASSERT_OK(make_view(13, 4096, 4096, t));
  SPANTEX_ASSERT_OK(make_view(13, 4096, 1, t));
}

SPANTEX_CASE(level_counts_that_do_not_fit_the_size_are_refused) {
  texture_view t;
  for (int32_t side = 1; side <= 4096; ++side) {
    int most = 1;
    while (side >> most != 0) ++most;
    SPANTEX_ASSERT_OK(make_view(most, side, 1, t));
    SPANTEX_ASSERT_OK(make_view(most, 1, side, t));
    SPANTEX_ASSERT_STATUS(make_view(most + 1, side, 1, t), bad_levels);
    SPANTEX_ASSERT_STATUS(make_view(0, side, 1, t), bad_levels);
    SPANTEX_ASSERT_STATUS(make_view(-1, 1, side, t), bad_levels);
  }
}

SPANTEX_CASE(a_missing_level_is_refused_and_the_view_is_left_alone) {
  for (int missing = 0; missing < 5; ++missing) {
    const rgba8* pointers[5] = {one_texel, one_texel, one_texel, one_texel, one_texel};
    pointers[missing] = nullptr;
    texture_view t;
    SPANTEX_ASSERT_OK(make_view(1, 7, 9, t));
    SPANTEX_ASSERT_STATUS(texture_view::make(pointers, 5, 16, 16, wrap::repeat, wrap::repeat, t), bad_pointer);
    assert_int_equal(t.width(), 7);
    assert_int_equal(t.height(), 9);
  }
}

SPANTEX_CASE(levels_halve_rounding_down_and_end_at_1) {
  for (int32_t side = 1; side <= 4096; ++side) {
    int32_t expected = side;
    for (int level = 0; level < max_levels; ++level) {
      assert_int_equal(level_side(side, level), expected);
      expected = expected > 1 ? expected / 2 : 1;
    }
  }
}

// ratio = side_L 2^L / side_0 in u1.31 to nearest, limited to 1; |ratio s0 - s_L 2^(31+L)| <= s0 / 2.
SPANTEX_CASE(ratios_are_the_nearest_31_bit_numbers) {
  for (int32_t side = 1; side <= 4096; ++side) {
    texture_view t;
    const int levels = bit_length(uint64_t(side));
    SPANTEX_ASSERT_OK(make_view(levels, side, 1, t));
    for (int level = 0; level < levels; ++level) {
      const int128 exact = int128(level_side(side, level)) << (31 + level), got = int128(t.ratio_u(level)) * side;
      assert_true(2 * magnitude_of(got - exact) <= side);
      if ((level_side(side, level) << level) == side) assert_true(t.ratio_u(level) == 1u << 31);
      assert_true(t.ratio_v(level) == 1u << 31);
    }
  }
}

SPANTEX_CASE(an_index_means_its_row_and_column_of_its_level) {
  const synthetic_map& m = make_map(24, 9, [](int32_t x, int32_t y) { return rgba8{uint8_t(x), uint8_t(y), 7, 8}; });
  const texture_view t = m.view(wrap::repeat, wrap::mirror);
  for (int level = 0; level < t.level_count(); ++level)
    for (int32_t y = 0; y < t.height(level); ++y)
      for (int32_t x = 0; x < t.width(level); ++x) assert_true(t.texel(level, x, y) == m.levels[size_t(level)].at(x, y));
  assert_true((t.texel(0, 23, 8) == rgba8{23, 8, 7, 8}));
}

SPANTEX_CASE(each_axis_wraps_in_its_own_mode_by_the_size_of_the_level) {
  const texture_view t = photographic_map(24, 9).view(wrap::repeat, wrap::mirror);
  for (int level = 0; level < t.level_count(); ++level)
    for (int32_t k = -60; k <= 60; ++k) {
      assert_int_equal(t.wrapped_u(k, level), wrapped(wrap::repeat, k, level_side(24, level)));
      assert_int_equal(t.wrapped_v(k, level), wrapped(wrap::mirror, k, level_side(9, level)));
    }
}

SPANTEX_CASE(views_are_the_same_only_if_nothing_differs) {
  const synthetic_map &m = photographic_map(16, 16), &n = photographic_map(16, 16, 2);
  const texture_view t = m.view(wrap::repeat, wrap::repeat);
  assert_true(t.id(0) == m.view(wrap::repeat, wrap::repeat).id(0));
  assert_false(t.id(0) == m.view(wrap::mirror, wrap::repeat).id(0));
  assert_false(t.id(0) == m.view(wrap::repeat, wrap::clamp).id(0));
  assert_false(t.id(0) == n.view(wrap::repeat, wrap::repeat).id(0));
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(sizes_outside_1_to_4096_are_refused),
      cmocka_unit_test(level_counts_that_do_not_fit_the_size_are_refused),
      cmocka_unit_test(a_missing_level_is_refused_and_the_view_is_left_alone),
      cmocka_unit_test(levels_halve_rounding_down_and_end_at_1),
      cmocka_unit_test(ratios_are_the_nearest_31_bit_numbers),
      cmocka_unit_test(an_index_means_its_row_and_column_of_its_level),
      cmocka_unit_test(each_axis_wraps_in_its_own_mode_by_the_size_of_the_level),
      cmocka_unit_test(views_are_the_same_only_if_nothing_differs),
  };
  return run_suite("texture", tests);
}
