// SPDX-License-Identifier: Apache-2.0
// sRGB in integers: the table and its inverse against the standard's formula, and filtering in linear light against doubles.
#include <tests/support.hpp>

#include <cmath>

#include <tests/srgb_curve.hpp>
#include <tests/whole_map.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

picture shown;

const synthetic_map& coded_map() { return photographic_map(64, 64, 5); }

texture_view srgb_view() {
  texture_view t = coded_map().view(wrap::repeat, wrap::repeat);
  t.set_colours(colour_space::srgb);
  return t;
}

// Two levels at snapped positions and a quantised fraction, exactly, in doubles.
double exact_code(const texture_view& t, int level, const snapped_position& fine, const snapped_position& coarse, double fraction, int subtexel_bits, int channel) {
  const auto on = [&](int at, const snapped_position& p) {
    double sum = 0;
    for (int k = 0; k < 4; ++k) {
      const int x = k & 1, y = k >> 1;
      const rgba8 c = t.texel(at, t.wrapped_u(p.u + x, at), t.wrapped_v(p.v + y, at));
      const double wu = std::ldexp(p.fraction.u, -subtexel_bits), wv = std::ldexp(p.fraction.v, -subtexel_bits);
      sum += (x ? wu : 1 - wu) * (y ? wv : 1 - wv) * to_linear(channel_of(c, channel));
    }
    return sum;
  };
  return to_code(fraction > 0 ? (1 - fraction) * on(level, fine) + fraction * on(level + 1, coarse) : on(level, fine));
}

}  // namespace

SPANTEX_CASE(the_table_is_the_standards_formula_to_nearest) {
  for (int c = 0; c < 256; ++c) assert_int_equal(srgb_linear[c], std::lround(65535 * to_linear(c)));
}

SPANTEX_CASE(every_code_comes_back) {
  for (uint32_t c = 0; c < 256; ++c) assert_int_equal(srgb_encoded(srgb_decoded(c)), c);
}

SPANTEX_CASE(encoding_is_monotone_and_within_0_54_of_a_code) {
  double worst = 0;
  int before = 0;
  for (uint32_t x = 0; x < 65536; ++x) {
    const int code = srgb_encoded(x);
    assert_true(code >= before);
    before = code;
    worst = std::max(worst, std::fabs(code - to_code(x / 65535.0)));
  }
  print_message("worst %.4f of a code\n", worst);
  assert_true(worst < 0.54);
}

// From weights and texels to the code that is written, against doubles: 0.5 for rounding, the rest for 16-bit light.
SPANTEX_CASE(linear_filtering_is_within_0_55_of_exact) {
  const texture_view t = srgb_view();
  double worst = 0;
  for (profile value : {profiles::exact, profiles::standard}) {
    value.fine_side = 32;
    const run_time_profile prof{value};
    for (int k = 0; k < 3; ++k) {
      const plane map = sample_plane(k, {0, 0, 160, 120});
      const surface s{&map, &t, filter::trilinear};
      shown.reset(160, 120);
      SPANTEX_ASSERT_OK(render_plane_direct<32>(prof, map, t, filter::trilinear, shown));
      for (int32_t y = 0; y < 120; ++y)
        for (int32_t x = 0; x < 160; ++x) {
          const span_coefficients c = whole_map_coefficients(prof, s, x / 8, y / 8, x % 8, y % 8);
          const texel_position at = position_at(prof, c, x % 8, y % 8);
          const int32_t detail = level_at(prof, c, x % 8, y % 8);
          const int level = integer_level(s.kind, detail, 8, c.last_level), above = min_of(level + 1, t.last_level());
          const snapped_position fine = snap(at, whole_level(t, level), s.kind, value), coarse = snap(at, whole_level(t, above), s.kind, value);
          const double fraction = level < t.last_level() ? (detail - level * 256) / 256.0 : 0;
          const rgba8 got = shown.pixels[size_t(y * 160 + x)];
          for (int channel = 0; channel < 3; ++channel)
            worst = std::max(worst, std::fabs(channel_of(got, channel) - exact_code(t, level, fine, coarse, fraction, value.subtexel_bits, channel)));
        }
    }
  }
  print_message("worst %.4f of a code\n", worst);
  assert_true(worst < 0.55);
}

SPANTEX_CASE(a_constant_map_keeps_its_codes) {
  for (profile value : {profiles::seed, profiles::compact, profiles::standard, profiles::exact})
    for (int c = 0; c < 256; c += short_run() ? 17 : 1) {
      value.fine_side = 32;
      texture_view t = constant_map(16, 16, {uint8_t(c), uint8_t(255 - c), uint8_t(c / 2), uint8_t(c)}).view(wrap::repeat, wrap::repeat);
      t.set_colours(colour_space::srgb);
      for (const filter kind : all_filters) {
        if (kind == filter::contour) continue;
        for (const int magnified_log2 : {0, 4}) {  // two levels, and one
          homography m = sample_homography(1);
          for (wide* x : {&m.a, &m.b, &m.c, &m.d, &m.e, &m.f}) *x = shift_right_floor(*x, magnified_log2);
          plane p{};
          SPANTEX_ASSERT_OK(make_plane(m, {0, 0, 16, 16}, p));
          shown.reset(16, 16);
          SPANTEX_ASSERT_OK(render_plane_direct<32>(run_time_profile{value}, p, t, kind, shown));
          for (const rgba8& got : shown.pixels)
            assert_true((got == rgba8{uint8_t(c), uint8_t(255 - c), uint8_t(c / 2), uint8_t(c)}));
        }
      }
    }
}

// Half black, half white: half the light is code 188, not 128. Alpha is linear, nearest takes codes as they are.
SPANTEX_CASE(light_is_averaged_and_alpha_is_not_decoded) {
  const synthetic_map& stripes = make_map(16, 16, [](int32_t x, int32_t) { const uint8_t c = x % 2 ? 255 : 0; return rgba8{c, c, c, c}; });
  for (const bool linear : {false, true}) {
    texture_view t = stripes.view(wrap::repeat, wrap::repeat);
    if (linear) t.set_colours(colour_space::srgb);
    plane q{};  // u = x - 1/2: every pixel between two texels
    SPANTEX_ASSERT_OK(make_plane(homography{2, 0, -1, 0, 2, 0, 0, 0, 2}, {0, 0, 8, 8}, q));
    shown.reset(8, 8);
    for (const filter kind : {filter::bilinear, filter::three_point, filter::trilinear}) {
      SPANTEX_ASSERT_OK(render_plane_direct<32>(run_time_profile{profiles::exact}, q, t, kind, shown));
      for (const rgba8& got : shown.pixels) {
        assert_int_equal(got.r, linear ? 188 : 128);
        assert_int_equal(got.a, 128);
      }
    }
    SPANTEX_ASSERT_OK(render_plane_direct<32>(run_time_profile{profiles::exact}, q, t, filter::nearest, shown));
    for (const rgba8& got : shown.pixels) assert_true(got.r == 0 || got.r == 255);
  }
}

// Footprints cut into parts (8x8 texels of local memory) and whole (32x32) agree, so sums in linear light add up.
SPANTEX_CASE(split_footprints_agree_in_linear_light) {
  const texture_view t = srgb_view();
  static picture whole;
  for (const filter kind : {filter::aniso, filter::squares})
    for (int k = 0; k < 3; ++k) {
      profile narrow = profiles::exact;
      narrow.fine_side = 8;
      shown.reset(160, 120);
      whole.reset(160, 120);
      const plane p = sample_plane(k, {0, 0, 160, 120});
      SPANTEX_ASSERT_OK(render_plane_direct<32>(run_time_profile{profiles::exact}, p, t, kind, whole));
      SPANTEX_ASSERT_OK(render_plane_direct<8>(run_time_profile{narrow}, p, t, kind, shown));
      assert_int_equal(differing_pixels(shown, whole), 0);
    }
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(the_table_is_the_standards_formula_to_nearest), cmocka_unit_test(every_code_comes_back),
      cmocka_unit_test(encoding_is_monotone_and_within_0_54_of_a_code), cmocka_unit_test(linear_filtering_is_within_0_55_of_exact),
      cmocka_unit_test(a_constant_map_keeps_its_codes), cmocka_unit_test(light_is_averaged_and_alpha_is_not_decoded),
      cmocka_unit_test(split_footprints_agree_in_linear_light)};
  return run_suite("srgb", tests);
}
