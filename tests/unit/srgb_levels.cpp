// SPDX-License-Identifier: Apache-2.0
// Levels of sRGB maps: averaged in linear light, against doubles; constants; what packs and maps carry.
#include <cmath>

#include <sim/inverse_filter.hpp>
#include <sim/map.hpp>
#include <sim/pack.hpp>
#include <tests/srgb_curve.hpp>
#include <tests/whole_map.hpp>  // last: cmocka.h defines fail as a macro

using namespace spantex;
using namespace spantex::sim;

namespace {

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

int main() {
  const CMUnitTest tests[] = {cmocka_unit_test(a_level_of_black_and_white_has_half_their_light),
                              cmocka_unit_test(levels_are_averaged_in_linear_light_within_0_55_of_exact),
                              cmocka_unit_test(a_constant_keeps_its_code_on_every_level),
                              cmocka_unit_test(packs_carry_their_colour_space)};
  return run_suite("srgb_levels", tests);
}
