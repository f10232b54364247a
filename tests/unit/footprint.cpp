// SPDX-License-Identifier: Apache-2.0
// Footprints: the arithmetic of the row of samples, its level against the formula, and the filtered picture against an exact elliptical
// mean, for eccentricities 1 to 32 at all angles (after OpenImageIO's anisotropic tests, with colour-coded levels).
#include <cmath>

#include <sim/reference.hpp>
#include <tests/support.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr run_time_profile exact{profiles::exact};

double value(coordinate c) { return c.raw() / 65536.0; }

struct columns { double ux, uy, vx, vy; };

// The image of a unit circle: axes of lengths major and minor, the major one at `angle` on the map; the screen turned by `roll`.
columns ellipse(double major, double minor, double angle, double roll) {
  const double c = std::cos(angle), s = std::sin(angle), a = std::cos(roll), b = std::sin(roll);
  return {major * c * a - minor * s * b, -major * c * b - minor * s * a, major * s * a + minor * c * b, -major * s * b + minor * c * a};
}

double larger_stretch(const columns& j) {
  const double e = j.ux * j.ux + j.uy * j.uy, g = j.vx * j.vx + j.vy * j.vy, f = j.ux * j.vx + j.uy * j.vy;
  return std::sqrt((e + g + std::hypot(e - g, 2 * f)) / 2);
}

jacobian to_integers(const columns& j, double scale) {
  return {std::llround(j.ux * scale), std::llround(j.uy * scale), std::llround(j.vx * scale), std::llround(j.vy * scale)};
}

// An affine plane with the Jacobian everywhere and (u, v) in the picture's middle.
plane affine_plane(const columns& j, double u, double v, rectangle region) {
  const double x = (region.x0 + region.x1) / 2.0, y = (region.y0 + region.y1) / 2.0;
  const double m[9] = {j.ux, j.uy, u - j.ux * x - j.uy * y, j.vx, j.vy, v - j.vx * x - j.vy * y, 0, 0, 1};
  plane p{};
  if (make_plane(homography_of(m), region, p) != status::ok) std::abort();
  return p;
}

double random_double(random_source& r, double low, double high) { return low + (high - low) * double(r.next() >> 11) / 9007199254740992.0; }

}  // namespace

SPANTEX_CASE(exp2_is_within_its_bound_for_every_argument_and_monotone) {
  for (int whole = -3; whole <= 5; ++whole) {
    uint32_t before = 0;
    for (int32_t f = 0; f < 65536; ++f) {
      const int32_t x = whole * 65536 + f;
      const uint32_t y = exp2_16(x);
      const double expected = std::exp2(x / 65536.0) * 65536;
      assert_true(y >= before);
      before = y;
      if (std::fabs(y - expected) > expected * 0x1p-15 + 0.5) fail_msg("2^%g: %u instead of %.3f", x / 65536.0, y, expected);
    }
  }
  for (int n = -16; n < 15; ++n) assert_int_equal(exp2_16(n * 65536), n + 16 >= 0 ? uint32_t(1) << (16 + n) : 0);
}

SPANTEX_CASE(directions_are_unit_vectors_evenly_spaced) {
  for (int k = 0; k < direction_count; ++k) {
    const screen_direction d = direction_at(k);
    assert_true(std::fabs(d.cos - 16384 * std::cos(k * pi / direction_count)) <= 0.5);
    assert_true(std::fabs(d.sin - 16384 * std::sin(k * pi / direction_count)) <= 0.5);
  }
}

// The best of 32 directions is at most pi/64 off the axis: stretched by cos(pi/64) of the most at least.
SPANTEX_CASE(the_direction_stretches_within_a_thousandth_of_the_most) {
  random_source random(41);
  for (int n = 0; n < 200000; ++n) {
    const columns j = ellipse(std::exp2(random_double(random, 0, 6)), 1, random_double(random, 0, 2 * pi), random_double(random, 0, 2 * pi));
    const screen_direction d = direction_at(major_direction(to_integers(j, std::exp2(random_double(random, 8, 24)))));
    const double stretched = std::hypot(j.ux * d.cos + j.uy * d.sin, j.vx * d.cos + j.vy * d.sin) / 16384;
    assert_true(stretched >= larger_stretch(j) * (std::cos(pi / 64) - 0.0005));
  }
}

SPANTEX_CASE(a_mirrored_jacobian_gives_the_mirrored_direction) {
  random_source random(42);
  for (int n = 0; n < 100000; ++n) {
    const jacobian j{random.any_magnitude(31), random.any_magnitude(31), random.any_magnitude(31), random.any_magnitude(31)};
    const int k = major_direction(j);
    assert_int_equal(major_direction({-j.ux, j.uy, -j.vx, j.vy}), (direction_count - k) % direction_count);
    assert_int_equal(major_direction({j.ux, j.uy, -j.vx, -j.vy}), k);
  }
}

SPANTEX_CASE(samples_are_symmetric_and_evenly_spaced) {
  random_source random(43);
  for (int n = 0; n < 100000; ++n) {
    const coordinate length = coordinate::from_raw(int32_t(random.any_magnitude(31)));
    const int count = int(random.between(1, 16));
    for (int k = 0; k < count; ++k) {
      const double offset = value(sample_offset(length, k, count)), expected = value(length) * (2 * k + 1 - count) / (2.0 * count);
      assert_true(std::fabs(offset - expected) <= 0x1p-17 + std::fabs(value(length)) * 15 * 0x1p-17);
      assert_int_equal(sample_offset(length, k, count).raw(), -sample_offset(length, count - 1 - k, count).raw());
    }
  }
}

// RDV15's own numbers, and what makes them a filter: squares of a row share no texel, weights of a square are 20.
SPANTEX_CASE(squares_have_the_papers_weights_and_do_not_overlap) {
  const auto length = [](double u, double v, int n) {
    return footprint{coordinate::from_raw(int32_t(u * 65536)), coordinate::from_raw(int32_t(v * 65536)), 0, n};
  };
  const square right = square_at(length(5, 0, 3), {10, 10}, 8, 2), centre = square_at(length(5, 0, 3), {10, 10}, 8, 1);
  assert_true(right.u == 2 && right.v == 0 && right.weight[0] == 6 && right.weight[1] == 4 && right.weight[2] == 6 && right.row_weight == 3);
  assert_true(centre.u == 0 && centre.weight[0] == 5 && centre.weight[3] == 5 && centre.row_weight == 4);
  const square low = square_at(length(5, 5, 3), {10, 10}, 8, 2), high = square_at(length(5, 5, 3), {200, 10}, 8, 2);
  assert_true(low.u == 2 && low.v == 1 && high.u == 1 && high.v == 2);
  assert_true(low.weight[0] == 6 && low.weight[1] == 5 && low.weight[2] == 5 && low.weight[3] == 4);
  for (int n = 1; n <= 15; n += 2)
    for (int angle = 0; angle < 64; ++angle)
      for (const uint32_t f : {10u, 200u}) {
        const footprint row = length(100 * std::cos(angle * pi / 32), 100 * std::sin(angle * pi / 32), n);
        for (int a = 0; a < n; ++a) {
          const square s = square_at(row, {f, f}, 8, a);
          assert_int_equal(s.weight[0] + s.weight[1] + s.weight[2] + s.weight[3], 20);
          for (int b = 0; b < a; ++b) {
            const square t = square_at(row, {f, f}, 8, b);
            assert_true(std::abs(s.u - t.u) >= 2 || std::abs(s.v - t.v) >= 2);
          }
          const square opposite = square_at(row, {f, f}, 8, n - 1 - a);
          assert_true(opposite.u == -s.u && opposite.v == -s.v && opposite.row_weight == s.row_weight);
        }
      }
}

SPANTEX_CASE(a_mean_is_the_nearest_integer_and_a_constant_comes_out) {
  random_source random(44);
  const auto check = [](uint32_t sum, uint32_t weight) {
    const int64_t m = mean(sum, weight, rounding::nearest), even = mean(sum, weight, rounding::even), low = mean(sum, weight, rounding::floor);
    assert_true(2 * m * weight <= 2 * int64_t(sum) + weight && 2 * int64_t(sum) < (2 * m + 1) * weight);
    const int64_t off = 2 * std::llabs(even * weight - sum);
    assert_true(off < weight || (off == weight && even % 2 == 0));
    assert_true(low * weight <= sum && sum < (low + 1) * int64_t(weight));
  };
  for (uint32_t weight = 1; weight <= 64; ++weight)
    for (uint32_t sum = 0; sum <= 255 * weight; ++sum) check(sum, weight);
  for (int n = 0; n < 300000; ++n) {
    const uint32_t weight = uint32_t(random.between(1, 1 << 24));
    check(uint32_t(random.between(0, int64_t(255) * weight)), weight);
    assert_int_equal(mean(weight * uint32_t(n % 256), weight, rounding::nearest), n % 256);
  }
  assert_int_equal(mean(5, 0, rounding::nearest), 0);
}

// Vector, level and number of samples against the formula in floating point, over random planes.
SPANTEX_CASE(footprints_are_what_the_formula_says_on_random_planes) {
  random_source random(45);
  const rectangle area{0, 0, 256, 256};
  double worst_level = 0, worst_vector = 0;
  int64_t seen = 0;
  const texture_view t = unread_view(4096, 4096);
  for (int n = 0; n < 4000; ++n) {
    plane p{};
    if (!random_plane(random, area, p)) continue;
    const int32_t sx = int32_t(random.between(0, 31)), sy = int32_t(random.between(0, 31)), cx = 16 * sx + 8, cy = 16 * sy + 8;
    if (p.w_at(cx, cy) <= 0) continue;
    span_coefficients c = spantex::detail::blank_coefficients({&p, &t, filter::aniso});
    if (!span_coordinates(reference_at(p, cx, cy), profiles::exact, c)) continue;
    span_axis(profiles::exact, c);
    for (int k = 0; k < 64; k += 9) {
      const int i = k % 8, j = k / 8;
      const double w = double(p.w_at(cx + half_pixels(i), cy + half_pixels(j)));
      const double u = double(p.u_at(cx + half_pixels(i), cy + half_pixels(j))) / w, v = double(p.v_at(cx + half_pixels(i), cy + half_pixels(j))) / w;
      const columns J{2 * (double(p.u.x) - u * double(p.w.x)) / w, 2 * (double(p.u.y) - u * double(p.w.y)) / w,
                      2 * (double(p.v.x) - v * double(p.w.x)) / w, 2 * (double(p.v.y) - v * double(p.w.y)) / w};
      const footprint f = footprint_at(exact, c, i, j);
      // The direction is the engine's choice: the vector must be the Jacobian's image of one of the 32.
      double best = 1e9, length = 0;
      for (int k2 = 0; k2 < direction_count; ++k2) {
        const screen_direction d = direction_at(k2);
        const double eu = (J.ux * d.cos + J.uy * d.sin) / 16384, ev = (J.vx * d.cos + J.vy * d.sin) / 16384;
        const double error = std::fmin(std::hypot(value(f.u) - eu, value(f.v) - ev), std::hypot(value(f.u) + eu, value(f.v) + ev));
        if (error < best) { best = error; length = std::hypot(eu, ev); }
      }
      if (length > 16000) continue;  // saturates
      worst_vector = std::fmax(worst_vector, best / (length / 1024 + 0x1p-15));
      const double major = std::log2(length), area_log2 = std::log2(std::fabs(J.ux * J.vy - J.uy * J.vx));
      const double ratio = std::fmin(std::fmax(std::fmin(2 * major - area_log2, major), 0), 4);
      const double minor = major - ratio, level = std::fmin(std::fmax(std::fmax(minor - 0.5, std::fmin(minor, 5.0 / 16)), 0), 12);
      if (std::isfinite(level)) worst_level = std::fmax(worst_level, std::fabs(f.level / 256.0 - level));
      assert_true(f.samples >= 1 && f.samples <= 16 && std::fabs(f.samples - std::ceil(std::exp2(ratio))) <= 1);
      ++seen;
    }
  }
  printf("footprints: %lld, worst level error 1/%.0f, worst vector error %.4f of (length/1024 + 2^-15 texel)\n", static_cast<long long>(seen),
         1 / worst_level, worst_vector);
  assert_true(seen > 5000);
  assert_true(worst_level <= 1.0 / 256);
  assert_true(worst_vector <= 1);
}

// --- eccentricity x angle ------------------------------------------------------------------------------

namespace {

picture drawn;

// Every level one colour: red tells the level of detail, 16 a level.
const synthetic_map& coded_map() {
  static synthetic_map m = [] {
    synthetic_map base = constant_map(1024, 1024, {0, 0, 0, 255});
    for (size_t level = 0; level < base.levels.size(); ++level)
      for (rgba8& texel : base.levels[level].texels) texel = {uint8_t(16 * level), uint8_t(255 - 16 * level), 7, 255};
    return base;
  }();
  return m;
}

}  // namespace

SPANTEX_CASE(colour_coded_levels_show_the_minor_axis_for_every_eccentricity_and_angle) {
  const texture_view t = coded_map().view(wrap::repeat, wrap::repeat);
  for (int e = 1; e <= 32; ++e)
    for (int angle = 0; angle < 24; ++angle) {
      const double minor = 3;
      const plane p = affine_plane(ellipse(e * minor, minor, angle * pi / 12, angle * 0.7), 500, 300, {0, 0, 16, 16});
      drawn.reset(16, 16);
      SPANTEX_ASSERT_OK(render_plane_direct<16>(fixed_profile<profiles::standard>{}, p, t, filter::aniso, drawn));
      // Beyond 16 the row is not longer: the level follows major/16.
      const double level = std::log2(e <= 16 ? minor : e * minor / 16) - 0.5;
      for (const rgba8& c : drawn.pixels) {
        if (std::fabs(c.r - 16 * level) > 1.1) fail_msg("eccentricity %d, angle %d: red %d instead of %.2f", e, angle, c.r, 16 * level);
        assert_int_equal(c.b, 7);
      }
    }
}

// The mean of bilinear samples of level 0 over the ellipse that a disc of one pixel's area maps to.
static ideal_colour elliptical_mean(const texture_view& t, const columns& j, double u, double v) {
  constexpr int side = 48;
  const double radius = 1 / std::sqrt(pi);
  ideal_colour sum{};
  int count = 0;
  for (int b = 0; b < side; ++b)
    for (int a = 0; a < side; ++a) {
      const double x = radius * (2 * (a + 0.5) / side - 1), y = radius * (2 * (b + 0.5) / side - 1);
      if (x * x + y * y > radius * radius) continue;
      const ideal_colour c = sample_bilinear(t, 0, u + j.ux * x + j.uy * y, v + j.vx * x + j.vy * y);
      for (size_t k = 0; k < c.size(); ++k) sum[k] += c[k];
      ++count;
    }
  for (double& x : sum) x /= count;
  return sum;
}

// Of each pixel of 32 x 32 about (260.3, 251.7).
static std::vector<ideal_colour> elliptical_means(const texture_view& t, const columns& j) {
  std::vector<ideal_colour> means;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      const double dx = x + 0.5 - 16, dy = y + 0.5 - 16;
      means.push_back(elliptical_mean(t, j, 260.3 + j.ux * dx + j.uy * dy, 251.7 + j.vx * dx + j.vy * dy));
    }
  return means;
}

SPANTEX_CASE(aniso_is_near_the_elliptical_mean_where_trilinear_is_not) {
  const texture_view t = photographic_map(512, 512).view(wrap::repeat, wrap::repeat);
  const filter kinds[] = {filter::trilinear, filter::squares, filter::aniso};
  printf("eccentricity   trilinear  squares  aniso: PSNR against the elliptical mean, dB, worst of 12 angles\n");
  for (const int e : {1, 2, 3, 4, 6, 8, 12, 16, 24, 32}) {
    double worst[3] = {1e9, 1e9, 1e9};
    for (int angle = 0; angle < 12; ++angle) {
      const columns j = ellipse(e * 1.2, 1.2, angle * pi / 12, 0.3 + angle);
      const rectangle area{0, 0, 32, 32};
      const plane p = affine_plane(j, 260.3, 251.7, area);
      static std::vector<ideal_colour> expected;  // a failing assertion leaves by longjmp
      expected = elliptical_means(t, j);
      for (int n = 0; n < 3; ++n) {
        drawn.reset(32, 32);
        SPANTEX_ASSERT_OK(render_plane_direct<32>(fixed_profile<profiles::exact>{}, p, t, kinds[n], drawn));
        double squares = 0;
        for (size_t k = 0; k < expected.size(); ++k) {
          const rgba8 c = drawn.pixels[k];
          const ideal_colour& mean = expected[k];
          squares += (c.r - mean[0]) * (c.r - mean[0]) + (c.g - mean[1]) * (c.g - mean[1]) + (c.b - mean[2]) * (c.b - mean[2]);
        }
        worst[n] = std::fmin(worst[n], 10 * std::log10(255.0 * 255 * 3 * 1024 / squares));
      }
    }
    printf("%12d   %9.2f  %7.2f  %5.2f\n", e, worst[0], worst[1], worst[2]);
    assert_true(worst[2] >= 36);
    assert_true(e == 1 || worst[2] >= worst[0] + 3);
  }
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(exp2_is_within_its_bound_for_every_argument_and_monotone),
      cmocka_unit_test(directions_are_unit_vectors_evenly_spaced),
      cmocka_unit_test(the_direction_stretches_within_a_thousandth_of_the_most),
      cmocka_unit_test(a_mirrored_jacobian_gives_the_mirrored_direction),
      cmocka_unit_test(samples_are_symmetric_and_evenly_spaced),
      cmocka_unit_test(squares_have_the_papers_weights_and_do_not_overlap),
      cmocka_unit_test(a_mean_is_the_nearest_integer_and_a_constant_comes_out),
      cmocka_unit_test(footprints_are_what_the_formula_says_on_random_planes),
      cmocka_unit_test(colour_coded_levels_show_the_minor_axis_for_every_eccentricity_and_angle),
      cmocka_unit_test(aniso_is_near_the_elliptical_mean_where_trilinear_is_not),
  };
  return run_suite("footprint", tests);
}
