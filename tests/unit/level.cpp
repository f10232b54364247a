// SPDX-License-Identifier: Apache-2.0
// Level of detail against the formulas it implements. The Jacobian's numerators A W - Nu G are exact (128 bits); lengths and logarithms
// are taken in long double, which errs by less than 2^-50 of a level: nothing beside 2^-8.
#include <sim/exact.hpp>
#include <tests/floor_view.hpp>
#include <tests/support.hpp>

#include <cmath>
#include <utility>

using namespace spantex;
using namespace spantex::sim;

namespace {

// W^2 times the longer column of the Jacobian, texels per pixel.
real longer_column(const plane& p, int32_t hx, int32_t hy) {
  const int64_t w = p.w_at(hx, hy), nu = p.u_at(hx, hy), nv = p.v_at(hx, hy);
  const auto numerator = [&](int64_t slope, int64_t n, int64_t w_slope) { return real(int128(slope) * w - int128(n) * w_slope) * 2; };
  const real x = std::hypot(numerator(p.u.x, nu, p.w.x), numerator(p.v.x, nv, p.w.x));
  const real y = std::hypot(numerator(p.u.y, nu, p.w.y), numerator(p.v.y, nv, p.w.y));
  return x > y ? x : y;
}

real jacobian_level(const plane& p, int32_t hx, int32_t hy) {
  const real column = longer_column(p, hx, hy);
  return column == 0 ? real(-100) : std::log2(column) - 2 * std::log2(real(p.w_at(hx, hy)));
}

// KT88's formula anchored where set-up anchors it: twice the longer column at (ax, ay).
real major_level(const plane& p, int32_t ax, int32_t ay, int32_t hx, int32_t hy) {
  return 1 + std::log2(longer_column(p, ax, ay)) - 2 * std::log2(real(p.w_at(hx, hy)));
}

__extension__ typedef __float128 quad;

// |det| of the plane's nine coefficients: exact 2x2 minors, then 113 bits.
real determinant(const plane& p) {
  const auto minor = [](int64_t a, int64_t b, int64_t c, int64_t d) { return quad(int128(a) * d - int128(b) * c); };
  const quad det = minor(p.u.x, p.u.y, p.v.x, p.v.y) * quad(p.w.c) + minor(p.u.y, p.u.c, p.v.y, p.v.c) * quad(p.w.x) +
                   minor(p.u.c, p.u.x, p.v.c, p.v.x) * quad(p.w.y);
  return real(det < 0 ? -det : det);
}

// The image of a circle of diameter two pixel intervals has the area of its axes' product, 4 |det J| a square pixel; divided by the major
// axis of KT88's formula anchored at (ax, ay).
real minor_level(const plane& p, int32_t ax, int32_t ay, int32_t hx, int32_t hy) {
  const real axes = std::log2(16 * determinant(p)) - 3 * std::log2(real(p.w_at(hx, hy)));
  return axes - major_level(p, ax, ay, hx, hy);
}

real limited(real level, int last) { return level < 0 ? 0 : level > last ? last : level; }

struct level_statistics {
  int64_t pixels = 0, inside = 0, pixel_mode = 0;
  real worst = 0;
  void print(const char* what) const {
    std::printf("# %s: %lld pixels (%lld between the ends, %lld about their own centre), worst 1/%.1Lf level\n", what,
                static_cast<long long>(pixels), static_cast<long long>(inside), static_cast<long long>(pixel_mode),
                worst == 0 ? 0 : 1 / worst);
  }
};

bool is_in_range(const plane& p, int32_t hx, int32_t hy) {
  const int128 limit = int128(p.w_at(hx, hy)) << 15;
  return magnitude_of(p.u_at(hx, hy)) < limit && magnitude_of(p.v_at(hx, hy)) < limit;
}

template <class Prof, class Exact>
void measure_span(const Prof& prof, const plane& p, const texture_view& t, int32_t sx, int32_t sy, Exact exact, level_statistics& s) {
  const profile& q = prof.get();
  const span_mask mask = front_mask(p, sx, sy);
  if (mask == 0) return;
  const surface what{&p, &t, filter::trilinear};
  SPANTEX_ASSERT_OK(plan_span(prof, what, sx, sy, mask, [&](span_job& job) {
    for (span_mask rest = job.mask; rest != 0; rest &= rest - 1) {
      const int k = __builtin_ctzll(rest), i = k % span_side, j = k / span_side;
      const int32_t hx = 2 * (sx * span_side + i) + 1, hy = 2 * (sy * span_side + j) + 1;
      if (!is_in_range(p, hx, hy)) continue;
      const real want = limited(biased_level(q, exact(hx, hy)), t.last_level());
      const real error = std::fabs(real(level_at(prof, job.coefficients, i, j)) / (1 << q.level_bits) - want);
      ++s.pixels;
      if (want > 0 && want < t.last_level()) ++s.inside;
      if ((job.coefficients.a_u | job.coefficients.b_u | job.coefficients.a_v | job.coefficients.b_v) == 0) ++s.pixel_mode;
      if (error > s.worst) s.worst = error;
    }
    return status::ok;
  }));
}

template <class Prof>
level_statistics measure_random(const Prof& prof, int planes) {
  const texture_view t = unread_view(4096, 4096);
  const rectangle screen{0, 0, 4096, 4096};
  level_statistics s;
  random_source random(40);
  plane p{};
  for (int k = 0; k < planes; ++k) {
    const int32_t x = 8 * int32_t(random.next() % 500), y = 8 * int32_t(random.next() % 500);
    const bool whole = k % 2 == 0;
    if (!random_plane(random, whole ? screen : rectangle{x, y, x + 64, y + 64}, p)) continue;
    const auto exact = [&](int32_t hx, int32_t hy) { return jacobian_level(p, hx, hy); };
    const int32_t row = int32_t(random.next() % 512);
    for (int n = 0; n < 16; ++n) {
      const int32_t sx = whole ? int32_t(random.next() % 512) : x / 8 + int32_t(random.next() % 8);
      const int32_t sy = whole ? int32_t(random.next() % 512) : y / 8 + int32_t(random.next() % 8);
      measure_span(prof, p, t, sx, sy, exact, s);
    }
    for (int32_t sx = 0; whole && sx < 512; ++sx) {  // along the horizon
      const span_mask front = front_mask(p, sx, row);
      if (front != 0 && front != full_mask) measure_span(prof, p, t, sx, row, exact, s);
    }
  }
  return s;
}

}  // namespace

SPANTEX_CASE(exact_profile_is_within_a_256th_of_a_level) {
  const level_statistics s = measure_random(fixed_profile<profiles::exact>{}, 2000);
  s.print("exact");
  assert_true(s.pixels > 500000 && s.inside > 100000 && s.pixel_mode > 5000);
  assert_true(s.worst <= real(1) / 256);
}

SPANTEX_CASE(default_profile_is_within_a_128th_of_a_level) {
  const level_statistics s = measure_random(fixed_profile<profiles::standard>{}, 2000);
  s.print("default");
  assert_true(s.worst <= real(1) / 128);
}

// Rows and columns of the simulator's other spans lie elsewhere about their reference point (unit_variants::span_log2).
SPANTEX_CASE(spans_of_4_and_16_are_within_a_256th_of_a_level) {
  for (const int span_log2 : {2, 4}) {
    const level_statistics s = measure_random(run_time_profile{profiles::exact, {.span_log2 = span_log2}}, 200);
    s.print(span_log2 == 2 ? "exact, spans of 4" : "exact, spans of 16");
    assert_true(s.pixels > 50000 && s.inside > 10000);
    assert_true(s.worst <= real(1) / 256);
  }
}

// The corners of what is_valid() allows: short mantissas with long slopes, and the reverse.
SPANTEX_CASE(extreme_word_lengths_keep_the_bound_of_their_numbers) {
  for (const auto& [offset, reciprocal] : {std::pair(13, 12), std::pair(31, 12), std::pair(19, 12), std::pair(15, 30), std::pair(24, 16)}) {
    run_time_profile prof{profiles::exact};
    prof.value.offset_bits = offset;
    prof.value.reciprocal_bits = reciprocal;
    const level_statistics s = measure_random(prof, 200);
    s.print("extreme");
    std::printf("#   %d, %d bits: bound 1/%.1f level\n", offset, reciprocal, double(error_unit) / double(level_bound(prof.value)));
    assert_true(s.pixels > 50000);
    assert_true(s.worst <= real(level_bound(prof.value)) / real(error_unit));
  }
}

SPANTEX_CASE(the_bias_is_added_in_sixteenths) {
  for (const int bias : {-128, -17, 1, 40, 127}) {
    run_time_profile prof{profiles::exact};
    prof.value.level_bias = bias;
    const level_statistics s = measure_random(prof, 60);
    assert_true(s.pixels > 5000);
    assert_true(s.worst <= real(1) / 256);
  }
}

SPANTEX_CASE(the_mip_bias_comes_in_over_the_first_level) {
  constexpr int32_t one = 1 << 16;
  assert_int_equal(finer(-1, -8), -1);
  assert_int_equal(finer(0, -8), 0);
  assert_int_equal(finer(one * 5 / 16, -8), one * 5 / 16);
  assert_int_equal(finer(one * 5 / 8, -8), one * 5 / 16);
  assert_int_equal(finer(one * 13 / 16, -8), one * 5 / 16);
  assert_int_equal(finer(one, -8), one / 2);
  assert_int_equal(finer(5 * one, -8), 5 * one - one / 2);
  assert_int_equal(finer(one, -16), one * 5 / 8);
  for (const int32_t level : {-one, 0, 1, one, 7 * one}) assert_int_equal(finer(level, 0), level);
  for (const int bias : {-16, -8, -3, 0}) {
    run_time_profile prof{profiles::exact};
    prof.value.mip_bias = bias;
    const level_statistics s = measure_random(prof, 60);
    assert_true(s.pixels > 5000);
    assert_true(s.worst <= real(1) / 256);
  }
}

SPANTEX_CASE(spans_across_the_horizon_are_within_a_256th_of_a_level) {
  const fixed_profile<profiles::exact> prof;
  const texture_view t = unread_view(512, 512);
  const plane p = sample_plane(3);
  level_statistics s;
  for (int32_t sy = 0; sy < 60; ++sy)
    for (int32_t sx = 0; sx < 80; ++sx)
      measure_span(prof, p, t, sx, sy, [&](int32_t hx, int32_t hy) { return jacobian_level(p, hx, hy); }, s);
  s.print("horizon");
  assert_true(s.pixel_mode > 500);
  assert_true(s.worst <= real(1) / 256);
}

// Every pixel of the sample planes whose middles are in front of the viewer.
template <class Level>
static level_statistics measure_samples(const run_time_profile& prof, const char* name, Level level) {
  const texture_view t = unread_view(4096, 4096);
  level_statistics s;
  for (int k = 0; k < 3; ++k) {
    const plane p = sample_plane(k);
    for (int32_t sy = 0; sy < 60; ++sy)
      for (int32_t sx = 0; sx < 80; ++sx)
        measure_span(prof, p, t, sx, sy, [&](int32_t hx, int32_t hy) { return level(p, hx, hy); }, s);
  }
  s.print(name);
  return s;
}

SPANTEX_CASE(the_major_axis_formula_is_within_a_256th_of_a_level) {
  run_time_profile prof{profiles::exact};
  prof.value.formula = level_formula::major;
  const level_statistics s = measure_samples(prof, "major", [](const plane& p, int32_t hx, int32_t hy) { return major_level(p, 640, 480, hx, hy); });
  assert_true(s.pixels > 800000);
  assert_true(s.worst <= real(1) / 256);
}

SPANTEX_CASE(the_minor_axis_formula_is_within_a_256th_of_a_level) {
  run_time_profile prof{profiles::exact};
  prof.value.formula = level_formula::minor;
  prof.value.level_bias = 48;  // three levels up: most of a magnified plane's minor axes would be below level 0
  const level_statistics s = measure_samples(prof, "minor", [](const plane& p, int32_t hx, int32_t hy) { return minor_level(p, 640, 480, hx, hy); });
  assert_true(s.pixels > 800000 && s.inside > 500000);
  assert_true(s.worst <= real(1) / 256);
}

// Set-up's log2 K', on planes of every shape: 2^-16 (4 for the determinant's logarithm, 2 for half a logarithm in log2 K, its own unit).
SPANTEX_CASE(the_minor_axis_of_random_planes_is_their_area_over_the_major_axis) {
  random_source random(41);
  real worst = 0;
  int64_t checked = 0;
  plane p{};
  for (int k = 0; k < 200000; ++k) {
    const int32_t x = 8 * int32_t(random.next() % 500), y = 8 * int32_t(random.next() % 500);
    const rectangle region = k % 2 == 0 ? rectangle{0, 0, 4096, 4096} : rectangle{x, y, x + 64, y + 64};
    if (!random_plane(random, region, p) || determinant(p) == 0 || p.w_at(p.origin_x, p.origin_y) <= 0) continue;
    const real want = std::log2(16 * determinant(p)) - 1 - std::log2(longer_column(p, p.origin_x, p.origin_y));
    const real error = std::fabs(real(p.minor_log2) / 65536 - want);
    worst = error > worst ? error : worst;
    ++checked;
  }
  std::printf("# %lld planes, worst %.2Lf of 2^-16\n", static_cast<long long>(checked), worst * 65536);
  assert_true(checked > 150000);
  assert_true(worst <= real(7) / 65536);
}

// KT88's own statement: seen by its camera with square pixels and a map as fine along U as along V, the minor axis is 2 T Delta d / W = the major
// one times W = cos of the angle to the normal (times the ray's length): one log2 W gives both.
SPANTEX_CASE(kt88_minor_axis_is_the_major_one_times_w) {
  const view s = make_view(640, 640 * 3 / 4);
  const view square{s.step_x, s.step_x, s.width_px, s.height_px};
  for (const real pitch : {80.0L, 40.0L, 18.0L}) {
    const kt88_plane q = make_floor(pitch, 20, 512, 1);
    plane p{};
    SPANTEX_ASSERT_OK(make_plane(q, square, p));
    for (int32_t y = 1; y < 960; y += 38)
      for (int32_t x = 1; x < 1280; x += 58) {
        const real w = std::fabs(dot(value(q.normal, 30), ray(square, x / 2.0L, y / 2.0L)));
        const real t = 512 * 2 * std::ldexp(real(square.step_x), -32) * std::ldexp(real(q.d), -16);
        if (p.w_at(x, y) <= 0) continue;
        assert_true(std::fabs(exact_minor_level(p, x, y) - std::log2(t / w)) <= 1.0L / 4096);
        assert_true(std::fabs(exact_minor_level(p, x, y) - exact_major_level(p, x, y) - std::log2(w)) <= 1.0L / 4096);
      }
  }
}

// ceil(d + 1/2) - 1, found by counting up.
SPANTEX_CASE(the_nearest_level_follows_its_rule_for_every_level_of_detail) {
  for (int bits = 1; bits <= 8; ++bits)
    for (int last = 0; last < max_levels; ++last)
      for (int32_t level = 0; level <= last << bits; ++level) {
        int expected = 0;  // the smallest n with n + 1 >= d + 1/2
        while ((2 * expected + 2) << bits < 2 * level + (1 << bits)) ++expected;
        assert_int_equal(integer_level(filter::mip_bilinear, level, bits, last), expected);
        assert_true(expected <= last);
      }
}

SPANTEX_CASE(two_level_filters_take_the_finer_level_for_every_level_of_detail) {
  for (const filter kind : {filter::trilinear, filter::trilinear3})
    for (int bits = 1; bits <= 8; ++bits)
      for (int last = 0; last < max_levels; ++last)
        for (int32_t level = 0; level <= last << bits; ++level) {
          int expected = 0;
          while ((expected + 1) << bits <= level) ++expected;
          assert_int_equal(integer_level(kind, level, bits, last), expected);
        }
}

SPANTEX_CASE(filters_without_levels_stay_on_the_full_map) {
  for (const filter kind : {filter::nearest, filter::bilinear, filter::three_point})
    for (int32_t level = 0; level <= 12 << 8; ++level) assert_int_equal(integer_level(kind, level, 8, 12), 0);
}

// A map seen face on, one texel a pixel, two, four: whole levels, exactly, less the bias.
SPANTEX_CASE(powers_of_two_of_texels_per_pixel_are_whole_levels) {
  const fixed_profile<profiles::exact> prof;
  const texture_view t = unread_view(4096, 4096);
  for (int level = 0; level <= 6; ++level) {
    const wide step(int64_t(1) << (20 + level)), zero(0), one(int64_t(1) << 20);
    const homography m{step, zero, zero, zero, step, zero, zero, zero, one};
    plane p{};
    SPANTEX_ASSERT_OK(make_plane(m, {0, 0, 256, 256}, p));
    const surface what{&p, &t, filter::trilinear};
    SPANTEX_ASSERT_OK(plan_span(prof, what, 5, 7, full_mask, [&](span_job& job) {
      for (span_mask rest = job.mask; rest != 0; rest &= rest - 1)
        assert_int_equal(level_at(prof, job.coefficients, __builtin_ctzll(rest) % 8, __builtin_ctzll(rest) / 8), level == 0 ? 0 : (level << 8) + profiles::exact.mip_bias * 16);
      return status::ok;
    }));
  }
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(exact_profile_is_within_a_256th_of_a_level),
      cmocka_unit_test(default_profile_is_within_a_128th_of_a_level),
      cmocka_unit_test(spans_of_4_and_16_are_within_a_256th_of_a_level),
      cmocka_unit_test(extreme_word_lengths_keep_the_bound_of_their_numbers),
      cmocka_unit_test(the_bias_is_added_in_sixteenths),
      cmocka_unit_test(the_mip_bias_comes_in_over_the_first_level),
      cmocka_unit_test(spans_across_the_horizon_are_within_a_256th_of_a_level),
      cmocka_unit_test(the_major_axis_formula_is_within_a_256th_of_a_level),
      cmocka_unit_test(the_minor_axis_formula_is_within_a_256th_of_a_level),
      cmocka_unit_test(the_minor_axis_of_random_planes_is_their_area_over_the_major_axis),
      cmocka_unit_test(kt88_minor_axis_is_the_major_one_times_w),
      cmocka_unit_test(the_nearest_level_follows_its_rule_for_every_level_of_detail),
      cmocka_unit_test(two_level_filters_take_the_finer_level_for_every_level_of_detail),
      cmocka_unit_test(filters_without_levels_stay_on_the_full_map),
      cmocka_unit_test(powers_of_two_of_texels_per_pixel_are_whole_levels),
  };
  return run_suite("level", tests);
}
