// SPDX-License-Identifier: Apache-2.0
// sRGB in integers: the table and its inverse against the standard's formula, and filtering in linear light against doubles.
#include <sim/inverse_filter.hpp>
#include <sim/pack.hpp>
#include <sim/map.hpp>

#include <cmath>

#include <tests/support.hpp>  // last: cmocka.h defines fail as a macro

#include <tests/whole_map.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

double to_linear(double code) {  // 0..255 to 0..1
  const double x = code / 255;
  return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
}

double to_code(double linear) {  // 0..1 to 0..255
  return 255 * (linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055);
}

picture shown;

const synthetic_map& coded_map() { return photographic_map(64, 64, 5); }

texture_view srgb_view() {
  texture_view t = coded_map().view(wrap::repeat, wrap::repeat);
  t.set_colours(colour_space::srgb);
  return t;
}

// Two levels at snapped positions and a quantised fraction, exactly, in doubles.
double exact_code(const texture_view& t, int level, const snapped_position& fine, const snapped_position& coarse, double fraction, int channel) {
  const auto on = [&](int at, const snapped_position& p) {
    double sum = 0;
    for (int k = 0; k < 4; ++k) {
      const int x = k & 1, y = k >> 1;
      const rgba8 c = t.texel(at, t.wrapped_u(p.u + x, at), t.wrapped_v(p.v + y, at));
      const double wu = double(p.fraction.u) / 256, wv = double(p.fraction.v) / 256;
      sum += (x ? wu : 1 - wu) * (y ? wv : 1 - wv) * to_linear(channel_of(c, channel));
    }
    return sum;
  };
  return to_code(fraction > 0 ? (1 - fraction) * on(level, fine) + fraction * on(level + 1, coarse) : on(level, fine));
}

// Noise whose colours vary from dark to light, with alpha.
image coded_noise(int width, int height) {
  image p(width, height, {});
  random_source random(uint64_t(width * 64 + height));
  for (rgba8& c : p.pixels) c = {uint8_t(random.next()), uint8_t(random.next() % 40), uint8_t(255 - random.next() % 40), uint8_t(random.next())};
  return p;
}

// Of the level's texel (x, y), exactly: the mean in linear light of what the weights take, colours times alpha where that counts.
double exact_level_code(const image& fine, prefilter kind, bool weighted, int x, int y, int channel) {
  const axis_filter columns = make_axis_filter(fine.width_px, kind), rows = make_axis_filter(fine.height_px, kind);
  double sum = 0, total = 0;
  for (size_t j = 0; j < rows.outputs[size_t(y)].weight.size(); ++j)
    for (size_t i = 0; i < columns.outputs[size_t(x)].weight.size(); ++i) {
      const rgba8& c = fine.at(wrapped(wrap::repeat, columns.outputs[size_t(x)].first + int(i), fine.width_px),
                               wrapped(wrap::repeat, rows.outputs[size_t(y)].first + int(j), fine.height_px));
      const double w = double(columns.outputs[size_t(x)].weight[i]) * rows.outputs[size_t(y)].weight[j] * (weighted ? c.a : 1);
      sum += w * to_linear(channel_of(c, channel));
      total += w;
    }
  return to_code(std::min(1.0, std::max(0.0, sum / total)));
}

}  // namespace

// The chessboard of codes 0 and 255: half the light has code 188, not 128.
SPANTEX_CASE(a_level_of_black_and_white_has_half_their_light) {
  static image board;
  board = image(8, 8, {0, 0, 0, 255});
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x)
      if ((x + y) % 2 == 0) board.at(x, y) = {255, 255, 255, 0};
  for (const prefilter kind : {prefilter::box, prefilter::triangle, prefilter::kaiser, prefilter::lanczos})
    for (const auto& [space, code] : {std::pair{colour_space::srgb, 188}, {colour_space::coded, 128}}) {
      static image level;
      level = halved(board, kind, wrap::repeat, wrap::repeat, alpha_weighting::independent, 1, space);
      for (const rgba8& c : level.pixels) assert_true(c.r == code && c.g == code && c.b == code && c.a == 128);
    }
  static texture_map map = texture_map(board, prefilter::box, wrap::repeat, wrap::repeat, texel_format::rgba8888, colour_space::srgb);
  assert_true(map.view().colours() == colour_space::srgb);
  for (int k = 1; k < map.level_count(); ++k) assert_int_equal(map.level(k).at(0, 0).r, 188);
}

SPANTEX_CASE(levels_are_averaged_in_linear_light_within_0_55_of_exact) {
  double worst = 0;
  for (const prefilter kind : {prefilter::box, prefilter::triangle, prefilter::kaiser, prefilter::lanczos})
    for (const alpha_weighting alpha : {alpha_weighting::independent, alpha_weighting::weighted})
      for (const int width : {16, 13}) {
        static image fine, level;
        fine = coded_noise(width, 10);
        level = halved(fine, kind, wrap::repeat, wrap::repeat, alpha, 1, colour_space::srgb);
        for (int y = 0; y < level.height_px; ++y)
          for (int x = 0; x < level.width_px; ++x)
            for (int channel = 0; channel < 3; ++channel) {
              const bool weighted = alpha == alpha_weighting::weighted;
              if (weighted && level.at(x, y).a == 0) continue;
              const double exact = exact_level_code(fine, kind, weighted, x, y, channel);
              worst = std::max(worst, std::fabs(channel_of(level.at(x, y), channel) - exact));
            }
      }
  print_message("worst %.4f of a code\n", worst);
  assert_true(worst < 0.55);
}

SPANTEX_CASE(a_constant_keeps_its_code_on_every_level) {
  for (int code = 0; code < 256; ++code)
    for (const prefilter kind : {prefilter::box, prefilter::triangle, prefilter::kaiser, prefilter::lanczos})
      for (const alpha_weighting alpha : {alpha_weighting::independent, alpha_weighting::weighted}) {
        static image level;
        const rgba8 colour{uint8_t(code), uint8_t(255 - code), 7, 90};
        level = halved(image(9, 6, colour), kind, wrap::clamp, wrap::mirror, alpha, 1, colour_space::srgb);
        for (const rgba8& c : level.pixels) assert_true(c == colour);
        level = inverse_filtered(image(9, 6, colour), {11, 23}, wrap::clamp, wrap::mirror, alpha, 1, colour_space::srgb);
        for (const rgba8& c : level.pixels) assert_true(c == colour);
      }
}

// A pack says what its colours are, and a map made of it filters so.
SPANTEX_CASE(packs_carry_their_colour_space) {
  static image picture;
  picture = coded_noise(16, 8);
  for (const bool srgb : {false, true}) {
    compile_options o;
    o.srgb = srgb;
    static texture_map map = texture_map(compile_pack(picture, o), "noise");
    map = texture_map(compile_pack(picture, o), "noise");
    assert_true(map.view().colours() == (srgb ? colour_space::srgb : colour_space::coded));
    static image level;
    level = halved(picture, prefilter::box, wrap::repeat, wrap::repeat, alpha_weighting::independent, 1, map.view().colours());
    for (int y = 0; y < 4; ++y)
      for (int x = 0; x < 8; ++x) assert_true(map.view().texel(1, x, y) == level.at(x, y));
  }
}

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
            worst = std::max(worst, std::fabs(channel_of(got, channel) - exact_code(t, level, fine, coarse, fraction, channel)));
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
        shown.reset(16, 16);
        SPANTEX_ASSERT_OK(render_plane_direct<32>(run_time_profile{value}, sample_plane(1, {0, 0, 16, 16}), t, kind, shown));
        for (const rgba8& got : shown.pixels)
          assert_true((got == rgba8{uint8_t(c), uint8_t(255 - c), uint8_t(c / 2), uint8_t(c)}));
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
  const CMUnitTest tests[] = {cmocka_unit_test(a_level_of_black_and_white_has_half_their_light),
                              cmocka_unit_test(levels_are_averaged_in_linear_light_within_0_55_of_exact),
                              cmocka_unit_test(a_constant_keeps_its_code_on_every_level),
                              cmocka_unit_test(packs_carry_their_colour_space),
                              
      cmocka_unit_test(the_table_is_the_standards_formula_to_nearest), cmocka_unit_test(every_code_comes_back),
      cmocka_unit_test(encoding_is_monotone_and_within_0_54_of_a_code), cmocka_unit_test(linear_filtering_is_within_0_55_of_exact),
      cmocka_unit_test(a_constant_map_keeps_its_codes), cmocka_unit_test(light_is_averaged_and_alpha_is_not_decoded),
      cmocka_unit_test(split_footprints_agree_in_linear_light)};
  return run_suite("srgb", tests);
}
