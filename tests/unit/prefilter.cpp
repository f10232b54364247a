// SPDX-License-Identifier: Apache-2.0
// Prefilters and the inverse filter: integer windows against libm, exact sums and moments, alpha, threads, what is left of a blur.
#include <cmath>

#include <sim/inverse_filter.hpp>
#include <sim/pattern.hpp>
#include <sim/window.hpp>
#include <tests/support.hpp>  // last: cmocka.h defines fail as a macro

namespace {

using namespace spantex;
using namespace spantex::sim;

constexpr prefilter windowed[] = {prefilter::kaiser, prefilter::lanczos};
constexpr prefilter all_prefilters[] = {prefilter::box, prefilter::triangle, prefilter::kaiser, prefilter::lanczos};

double sinc_of(double t) { return t == 0 ? 1 : std::sin(M_PI * t) / (M_PI * t); }

double i0_of(double x) {
  double term = 1, sum = 1;
  for (int k = 1; k < 40; ++k) sum += term *= x * x / 4 / k / k;
  return sum;
}

double kernel(prefilter kind, double t) {
  if (std::fabs(t) >= 3) return 0;
  return sinc_of(t) * (kind == prefilter::lanczos ? sinc_of(t / 3) : i0_of(4 * std::sqrt(1 - t * t / 9)));
}

const image& noise(int width, int height) {
  static image out;
  static random_source random(21);
  out = image(width, height, {});
  for (rgba8& c : out.pixels) c = {uint8_t(random.next()), uint8_t(random.next()), uint8_t(random.next()), uint8_t(random.next())};
  return out;
}

SPANTEX_CASE(integer_functions_are_libms) {
  random_source random(5);
  for (int k = 0; k < 200000; ++k) {
    const int64_t d = random.between(1, 24576), n = random.between(-4 * d, 4 * d);
    const double t = double(n) / double(d);
    assert_true(std::fabs(std::ldexp(double(sinc(n, d)), -30) - sinc_of(t)) < std::ldexp(1.0, -27));
    const int64_t e = random.between(1, 1 << 25), m = random.between(-(int64_t(1) << 30), int64_t(1) << 30);
    assert_true(std::fabs(std::ldexp(double(cos_pi(m, e)), -30) - std::cos(std::fmod(double(m), 2.0 * double(e)) / double(e) * M_PI)) < std::ldexp(1.0, -27));
    const int64_t z = random.between(0, int64_t(4) << 28);
    assert_true(std::fabs(std::ldexp(double(bessel_i0(z)), -28) - i0_of(2 * std::sqrt(std::ldexp(double(z), -28)))) < std::ldexp(1.0, -24));
  }
  assert_true(sinc(0, 7) == one_q30 && sinc(21, 7) == 0);
}

void check_axis(int32_t size, prefilter kind) {
  const axis_filter a = make_axis_filter(size, kind);
  assert_int_equal(a.outputs.size(), a.coarse);
  assert_true(a.weight_sum <= 1 << 16 && a.weight_sum > (1 << 16) - 4096);
  for (int32_t i = 0; i < a.coarse; ++i) {
    const taps& t = a.outputs[size_t(i)];
    int64_t sum = 0, moment = 0;
    double total = 0;
    for (size_t k = 0; k < t.weight.size(); ++k) {
      const int64_t distance = centre_distance(t.first + int32_t(k), i, a.fine, a.coarse);
      sum += t.weight[k];
      moment += t.weight[k] * distance;
      total += kernel(kind, double(distance) / (2 * a.fine));
    }
    assert_true(sum == a.weight_sum);
    assert_true(moment == 0);
    // Every weight is the kernel's, to nearest (the integer kernel errs by 2^-24 of 2^16). The two about the centre differ by what balances the
    // moment: the roundings of the others for even sides; at most 0.552 % of the whole for odd ones (at 23 texels, kaiser).
    const double step = double(t.weight.size()) / 2, odd_step = 0.00553 * double(sum);
    for (size_t k = 0; k < t.weight.size(); ++k) {
      const int64_t distance = centre_distance(t.first + int32_t(k), i, a.fine, a.coarse);
      const bool central = distance > -2 * a.coarse && distance <= 2 * a.coarse;
      const double off = std::fabs(t.weight[k] - kernel(kind, double(distance) / (2 * a.fine)) / total * double(sum));
      assert_true(off < (!central ? 0.51 : size % 2 == 0 ? step : odd_step));
    }
  }
}

SPANTEX_CASE(weights_sum_up_and_balance_exactly_at_every_size) {
  for (const prefilter kind : windowed)
    for (int32_t size = 2; size <= 4096; size += size < 300 && !short_run() ? 1 : 379) check_axis(size, kind);
}

SPANTEX_CASE(even_sides_have_symmetric_weights) {
  for (const prefilter kind : windowed) {
    const axis_filter a = make_axis_filter(64, kind);
    for (const taps& t : a.outputs) {
      assert_int_equal(t.weight.size(), 12);
      for (size_t k = 0; k < 6; ++k) assert_int_equal(t.weight[k], t.weight[11 - k]);
    }
    assert_int_equal(a.outputs[5].first, 2 * 5 - 5);
  }
}

SPANTEX_CASE(threads_change_nothing) {
  for (const prefilter kind : all_prefilters)
    for (const alpha_weighting alpha : {alpha_weighting::independent, alpha_weighting::weighted}) {
      static image fine, one, four;
      fine = noise(61, 47);
      one = halved(fine, kind, wrap::mirror, wrap::repeat, alpha, 1);
      four = halved(fine, kind, wrap::mirror, wrap::repeat, alpha, 4);
      assert_true(one.pixels == four.pixels);
      one = inverse_filtered(fine, {9, 20}, wrap::clamp, wrap::repeat, alpha, 1);
      four = inverse_filtered(fine, {9, 20}, wrap::clamp, wrap::repeat, alpha, 4);
      assert_true(one.pixels == four.pixels);
    }
}

// One colour wherever anything shows, any colours below full transparency: only the one colour shows on all levels.
SPANTEX_CASE(transparent_texels_do_not_bleed) {
  constexpr rgba8 ink{200, 30, 90, 0};
  for (const prefilter kind : all_prefilters)
    for (const bool inverse : {false, true}) {
      static image level;
      level = noise(37, 24);
      for (rgba8& c : level.pixels) {
        if (c.a < 100) c.a = 0;
        else c = {ink.r, ink.g, ink.b, c.a};
      }
      while (level.width_px > 2) {
        level = halved(level, kind, wrap::repeat, wrap::clamp, alpha_weighting::weighted);
        if (inverse) level = inverse_filtered(level, {12, 12}, wrap::repeat, wrap::clamp, alpha_weighting::weighted);
        for (const rgba8& c : level.pixels) assert_true(c.a == 0 || (c.r == ink.r && c.g == ink.g && c.b == ink.b));
      }
    }
}

// Beside an opaque half, as far as the kernel reaches, the colour below alpha 0 is the opaque one's: a bilinear fetch between them shows no other.
SPANTEX_CASE(transparent_texels_beside_opaque_ones_take_their_colour) {
  constexpr int width = 32;
  for (const prefilter kind : windowed) {
    static image level;
    level = noise(width, 8);
    for (int y = 0; y < 8; ++y)
      for (int x = 0; x < width; ++x) level.at(x, y) = x < width / 2 ? rgba8{10, 20, 30, 255} : rgba8{level.at(x, y).r, level.at(x, y).g, 0, 0};
    level = halved(level, kind, wrap::clamp, wrap::clamp, alpha_weighting::weighted);
    for (int y = 0; y < 4; ++y)
      for (int x = 0; x < width / 4 + window_reach - 1; ++x) assert_true(level.at(x, y).r == 10 && level.at(x, y).g == 20 && level.at(x, y).b == 30);
    assert_int_equal(level.at(width / 4 + 1, 0).a, 0);
  }
}

SPANTEX_CASE(alpha_changes_nothing_where_all_is_opaque) {
  static image fine, a, b;
  for (const prefilter kind : all_prefilters) {
    fine = noise(33, 20);
    for (rgba8& c : fine.pixels) c.a = 255;
    a = halved(fine, kind, wrap::repeat, wrap::repeat, alpha_weighting::independent);
    b = halved(fine, kind, wrap::repeat, wrap::repeat, alpha_weighting::weighted);
    assert_true(a.pixels == b.pixels);
    assert_true(inverse_filtered(a, {9, 17}, wrap::repeat, wrap::repeat, alpha_weighting::independent).pixels ==
                inverse_filtered(a, {9, 17}, wrap::repeat, wrap::repeat, alpha_weighting::weighted).pixels);
  }
}

SPANTEX_CASE(an_all_transparent_map_keeps_its_colour) {
  static image level;
  level = halved(image(9, 9, {70, 80, 90, 0}), prefilter::kaiser, wrap::repeat, wrap::repeat, alpha_weighting::weighted);
  for (const rgba8& c : level.pixels) assert_true((c == rgba8{70, 80, 90, 0}));
}

// --- inverse filter ------------------------------------------------------------------------------------

SPANTEX_CASE(the_inverse_keeps_a_constant) {
  constexpr rgba8 colour{255, 1, 0, 128};
  for (const alpha_weighting alpha : {alpha_weighting::independent, alpha_weighting::weighted})
    for (int side = 1; side <= 5; ++side)
      for (int a = 0; a <= 32; ++a) {
        static image out;
        out = inverse_filtered(image(side, 6 - side, colour), {a, 32 - a}, wrap::repeat, wrap::mirror, alpha);
        for (const rgba8& c : out.pixels) assert_true(c == colour);
      }
}

// 4 f - 6 x f + 4 x x f - x x x f with each convolution written out, in floating point.
SPANTEX_CASE(the_inverse_is_its_formula) {
  constexpr int w = 13, h = 9;
  constexpr double au = 11 / 128.0, av = 23 / 128.0, b[] = {4, -6, 4, -1};
  static image f, out;
  f = noise(w, h);
  out = inverse_filtered(f, {11, 23}, wrap::mirror, wrap::clamp);
  static std::vector<double> power, next, sum;
  power.clear();
  for (const rgba8& c : f.pixels) power.push_back(c.g);
  sum.assign(power.size(), 0);
  for (const double factor : b) {
    for (size_t k = 0; k < sum.size(); ++k) sum[k] += factor * power[k];
    const auto at = [&](int x, int y) { return power[size_t(wrapped(wrap::clamp, y, h) * w + wrapped(wrap::mirror, x, w))]; };
    const auto across = [&](int x, int y) { return au * (at(x - 1, y) + at(x + 1, y)) + (1 - 2 * au) * at(x, y); };
    next.clear();
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) next.push_back(av * (across(x, y - 1) + across(x, y + 1)) + (1 - 2 * av) * across(x, y));
    power = next;
  }
  for (size_t k = 0; k < sum.size(); ++k) {
    const double exact = std::fmin(255, std::fmax(0, sum[k]));
    assert_true(std::fabs(out.pixels[k].g - exact) <= 0.5 + 1e-9);
  }
}

// (1 - (1 - x)^4) / x: a grating blurred by x comes back as 1 - (1 - x)^4 of itself. At a quarter cycle x is 1 - 2a.
SPANTEX_CASE(what_is_left_of_a_blur) {
  for (const int a : {4, 10, 20, 32}) {
    const double x = 1 - 2 * a / 128.0, left = 1 - std::pow(1 - x, 4);
    static image blurred, out;
    blurred = image(64, 1, {0, 0, 0, 255});
    constexpr int wave[] = {1, 0, -1, 0};
    for (int k = 0; k < 64; ++k) blurred.at(k, 0).r = uint8_t(128 + std::lround(100 * x) * wave[k % 4]);
    out = inverse_filtered(blurred, {a, 0}, wrap::repeat, wrap::repeat);
    for (int k = 0; k < 64; ++k) assert_true(std::fabs(out.at(k, 0).r - (128 + 100 * left * wave[k % 4])) < 1.5);
  }
}

// K at a quarter cycle: box cos(pi/8) at level 1, sinc(1/4) in the limit; triangle the cube of the first.
SPANTEX_CASE(blurs_are_those_of_the_prefilters) {
  const auto units = [](double response) { return int(std::lround((1 - response) / 2 * 128)); };
  const double box1 = std::cos(M_PI / 8);
  assert_int_equal(blur_of(256, 64, 1, prefilter::box).u, units(box1));
  assert_int_equal(blur_of(256, 64, 1, prefilter::box).v, units(box1));
  assert_int_equal(blur_of(256, 256, 1, prefilter::triangle).u, units(box1 * box1 * box1));
  assert_int_equal(blur_of(4096, 4096, 9, prefilter::box).u, units(sinc_of(0.25)));
  assert_int_equal(blur_of(255, 255, 0, prefilter::box).u, 0);
  for (const int size : {256, 255, 100}) assert_true(blur_of(size, size, 1, prefilter::lanczos).u == 0);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {cmocka_unit_test(integer_functions_are_libms),
                              cmocka_unit_test(weights_sum_up_and_balance_exactly_at_every_size),
                              cmocka_unit_test(even_sides_have_symmetric_weights),
                              cmocka_unit_test(threads_change_nothing),
                              cmocka_unit_test(transparent_texels_do_not_bleed),
                              cmocka_unit_test(transparent_texels_beside_opaque_ones_take_their_colour),
                              cmocka_unit_test(alpha_changes_nothing_where_all_is_opaque),
                              cmocka_unit_test(an_all_transparent_map_keeps_its_colour),
                              cmocka_unit_test(the_inverse_keeps_a_constant),
                              cmocka_unit_test(the_inverse_is_its_formula),
                              cmocka_unit_test(what_is_left_of_a_blur),
                              cmocka_unit_test(blurs_are_those_of_the_prefilters)};
  return run_suite("prefilter", tests);
}
