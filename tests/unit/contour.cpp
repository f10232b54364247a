// SPDX-License-Identifier: Apache-2.0
// Contour textures: coverage of fills and lines, and their width on the screen, measured on pictures.
#include <tests/support.hpp>

#include <cmath>

using namespace spantex;
using namespace spantex::sim;

namespace {

constexpr int side_px = 128;
picture shown;

double rounded_byte(double x) { return std::floor(std::min(255.0, std::max(0.0, x)) + 0.5); }

// A distance field with levels of its own: texel centres of level L lie at (k + 1/2) 2^L. distance(u, v) in texels of level 0, positive inside.
// own: every level counts in its own texels; else in those of level 0.
template <class Distance>
texture_view field_map(int side, double scale, bool own, Distance distance) {
  static std::deque<std::vector<std::vector<rgba8>>> kept;
  std::vector<std::vector<rgba8>> levels;
  for (int level = 0; side >> level > 0; ++level) {
    const int n = side >> level;
    const double size = 1 << level;
    std::vector<rgba8> texels;
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        const double d = distance((x + 0.5) * size, (y + 0.5) * size) / (own ? size : 1);
        texels.push_back({uint8_t(level), 100, 200, uint8_t(rounded_byte(128 + scale * d))});
      }
    levels.push_back(texels);
  }
  kept.push_back(levels);
  const rgba8* pointers[max_levels] = {};
  for (size_t k = 0; k < levels.size(); ++k) pointers[k] = kept.back()[k].data();
  texture_view t;
  if (texture_view::make(pointers, int(levels.size()), side, side, wrap::clamp, wrap::clamp, t) != status::ok) std::abort();
  return t;
}

contour_style style(double outline_px, bool own, double scale) {
  contour_style s;
  s.scale = uint16_t(scale * 256);
  s.outline = uint8_t(outline_px * 16);
  s.unit = own ? field_unit::own_level : field_unit::level_0;
  return s;
}

// The map turned and magnified (texels per pixel), its middle in the middle of the picture.
plane similarity(int side, double texels_per_px, double turn) {
  const double a = texels_per_px * std::cos(turn), b = texels_per_px * std::sin(turn), middle = side_px / 2.0, centre = side / 2.0;
  const double m[9] = {a, -b, centre - a * middle + b * middle, b, a, centre - b * middle - a * middle, 0, 0, 1};
  plane p{};
  if (make_plane(homography_of(m), {0, 0, side_px, side_px}, p) != status::ok) std::abort();
  return p;
}

// Mean width of a band of coverage that runs across the picture: coverage summed over pixels near the middle, per pixel of its length.
// `direction`: of the band on the screen. Sums over a strip of the band between two lines across it, no farther than `aside_px` from the middle.
double measured_width(double direction, int reach_px, double aside_px = side_px) {
  const double c = std::cos(direction), s = std::sin(direction), middle = side_px / 2.0;
  double sum = 0;
  constexpr int fine = 8;  // pixels are cut into 8x8 parts, so that the strip's ends are clean
  for (int y = 0; y < side_px; ++y)
    for (int x = 0; x < side_px; ++x) {
      const double alpha = shown.pixels[size_t(y * side_px + x)].a / 255.0;
      if (alpha == 0) continue;
      int in = 0;
      for (int n = 0; n < fine * fine; ++n) {
        const double dx = x + (n % fine + 0.5) / fine - middle, dy = y + (n / fine + 0.5) / fine - middle;
        in += std::fabs(dx * c + dy * s) < reach_px && std::fabs(dy * c - dx * s) < aside_px;
      }
      sum += alpha * in / (fine * fine);
    }
  return sum / (2 * reach_px);
}

template <class Prof>
void draw(const Prof& prof, const plane& p, const texture_view& t) {
  shown.reset(side_px, side_px);
  direct_engine<Prof> engine(prof);
  renderer<direct_engine<Prof>, Prof> r(engine, prof, shown.frame());
  SPANTEX_ASSERT_OK(r.draw(p, t, filter::contour, shown.area()));
  SPANTEX_ASSERT_OK(r.finish());
}

// Outlines of half-planes at five magnifications, seven orientations of the contour on the map and three of the map on the screen.
template <class Prof>
double worst_outline(const Prof& prof, double width_px, bool own, double scale) {
  double worst = 0;
  constexpr int side = 512;
  for (const double texels_per_px : {1.0 / 16, 0.25, 0.7, 1.0, 1.4, 4.0, 11.0, 16.0})
    for (const double turn : {0.0, 0.3, 0.7854})
      for (const double normal : {0.0, 0.2, 0.4636, 0.7854, 1.2, 2.0, 2.7}) {
        const double c = std::cos(normal), s = std::sin(normal), half = side / 2.0;
        texture_view t = field_map(side, scale, own, [&](double u, double v) { return (u - half - 0.21) * c + (v - half) * s; });
        SPANTEX_ASSERT_OK(t.set_contour(style(width_px, own, scale)));
        draw(prof, similarity(side, texels_per_px, turn), t);
        // On the screen the normal is turned back by the map's turn; the band runs across it.
        const int reach = texels_per_px > 8 ? 10 : 30;
        const double got = measured_width(normal - turn + M_PI / 2, reach);
        if (std::fabs(got - width_px) > worst) {
          worst = std::fabs(got - width_px);
          print_message("  %.4g texels a pixel, turn %.2f, normal %.2f: %.3f for %.2f\n", texels_per_px, turn, normal, got, width_px);
        }
      }
  return worst;
}

// A plane at an angle: at the middle of the picture a pixel's image is texels_per_px wide and `ratio` times as long, towards the
// viewer in perspective (a lens of 300 pixels); the map turned. Its texels' symmetry is broken by an offset.
struct tilted_plane {
  double texels_per_px, ratio, turn;
  static constexpr double middle_texel(int side) { return side / 2.0 + 0.21; }
  plane on(int side) const {
    const double middle = side_px / 2.0, slope = std::sqrt(ratio * ratio - 1) / 300, at = middle_texel(side);
    const double c = std::cos(turn) * texels_per_px, s = std::sin(turn) * texels_per_px;
    const double w[3] = {0, -slope, 1 + slope * middle}, x[3] = {1, 0, -middle}, y[3] = {0, ratio, -ratio * middle};
    double m[9];
    for (int k = 0; k < 3; ++k) {
      m[k] = c * x[k] - s * y[k] + at * w[k];
      m[3 + k] = s * x[k] + c * y[k] + at * w[k];
      m[6 + k] = w[k];
    }
    plane p{};
    if (make_plane(homography_of(m), {0, 0, side_px, side_px}, p) != status::ok) std::abort();
    return p;
  }
  // Screen direction at the middle of the map's line with this normal: the inverse of the Jacobian.
  double direction(double normal) const {
    const double along = normal - turn + M_PI / 2;
    return std::atan2(std::sin(along) / ratio, std::cos(along));
  }
};

// Outlines that run at every angle over planes at an angle, both axes of a pixel's image between 1/16 and 16 texels.
template <class Prof>
double worst_tilted_outline(const Prof& prof, double width_px, double scale, std::initializer_list<double> ratios) {
  double worst = 0;
  constexpr int side = 1024;
  constexpr double at = tilted_plane::middle_texel(side);
  for (const double normal : {0.0, 0.3, 0.7854, 1.2, 1.5708, 2.4}) {
    texture_view t = field_map(side, scale, true, [&](double u, double v) { return (u - at) * std::cos(normal) + (v - at) * std::sin(normal); });
    SPANTEX_ASSERT_OK(t.set_contour(style(width_px, true, scale)));
    for (const double ratio : ratios)
      for (const double texels_per_px : {1.0 / 16, 0.25, 1.0, 3.0, 16 / ratio})
        for (const double turn : {0.0, 0.5, 0.7854, 1.3}) {
          const tilted_plane tilted{texels_per_px, ratio, turn};
          draw(prof, tilted.on(side), t);
          const double got = measured_width(tilted.direction(normal), 10, 16);
          if (std::fabs(got - width_px) > worst) {
            worst = std::fabs(got - width_px);
            print_message("  %.4g texels a pixel, ratio %.1f, turn %.2f, normal %.2f: %.3f for %.2f\n", texels_per_px, ratio, turn, normal, got, width_px);
          }
        }
  }
  return worst;
}

constexpr fixed_profile<profiles::exact> exact_prof;
constexpr fixed_profile<profiles::standard> standard_prof;
constexpr fixed_profile<profiles::compact> compact_prof;
constexpr fixed_profile<profiles::seed> seed_prof;

}  // namespace

SPANTEX_CASE(coverage_is_that_of_a_box_of_one_pixel) {
  for (int outline = 0; outline < 256; ++outline)
    for (int32_t d = -(20 << 16); d <= 20 << 16; d += short_run() ? 997 : 61) {
      const double x = d / 65536.0, half = outline / 32.0;
      const auto fill = [](double a) { return std::min(1.0, std::max(0.0, a + 0.5)); };
      const double wanted = 255 * (outline == 0 ? fill(x) : fill(x + half) - fill(x - half));
      assert_true(std::fabs(contour_coverage(d, uint8_t(outline)) - wanted) <= 0.5 + 1e-9);
    }
}

SPANTEX_CASE(powers_of_two_hold_over_their_whole_domain) {
  double worst = 0;
  for (int32_t x = -16 * 65536; x < 15 * 65536; x += short_run() ? 173 : 7) {
    const double wanted = std::exp2(x / 65536.0) * 65536, got = exp2_16(x);
    worst = std::max(worst, (std::fabs(got - wanted) - 0.5) / wanted);  // the last rounding apart
  }
  print_message("worst relative error 2^%.2f\n", std::log2(worst));
  assert_true(worst < std::exp2(-15));
}

// The distance that the engine finds against doubles, from the same field, gradient, Jacobian and fraction.
SPANTEX_CASE(the_distance_is_the_formulas) {
  random_source random(5);
  double worst = 0;
  for (int n = 0; n < (short_run() ? 20000 : 400000); ++n) {
    span_coefficients c{};
    c.kind = filter::contour;
    c.contour = terms_of({uint16_t(random.next()), uint16_t(16 + random.next() % 65520), 0, field_unit(random.next() % 2)});
    c.two_levels = (random.next() & 1) != 0;
    c.fine.level = uint8_t(random.next() % 12);
    const int bits = int(random.between(18, 30));
    const auto mantissa = [&] { return int32_t(random.between(-(1 << bits), 1 << bits)); };
    c.axis.c_u = mantissa(), c.axis.c_v = mantissa(), c.axis.a_u = mantissa(), c.axis.a_v = mantissa();
    c.axis.b_u = mantissa() / 64, c.axis.b_v = mantissa() / 64;
    c.axis.exponent = int8_t(random.between(bits - 11, bits + 6));
    const partial_colour fine{uint32_t(random.next() % 16711681), 16}, coarse{uint32_t(random.next() % 16711681), 16};
    const uint32_t fraction = uint32_t(random.next() % 256);
    const field_gradient d{int32_t(random.between(-1 << 20, 1 << 20)), int32_t(random.between(-1 << 20, 1 << 20))};
    const double threshold = c.contour.threshold / 256.0, a = fine.value / 65536.0 - threshold;
    const double b = (coarse.value / 65536.0 - threshold) * (c.contour.own_units ? 2 : 1), f = fraction / 256.0;
    const double field = c.two_levels ? a * (1 - f) + b * f : a;
    const int i = 3, j = 6;
    const double ux = c.axis.c_u + double(c.axis.b_u) * (2 * j - 7), vx = c.axis.c_v + double(c.axis.b_v) * (2 * j - 7);
    const double uy = c.axis.a_u - double(c.axis.b_u) * (2 * i - 7), vy = c.axis.a_v - double(c.axis.b_v) * (2 * i - 7);
    const double gx = d.u * ux + d.v * vx, gy = d.u * uy + d.v * vy, length = std::hypot(double(d.u), double(d.v));
    const double longest = std::max(std::hypot(ux, vx), std::hypot(uy, vy)), gradient = std::hypot(gx, gy) / length;
    if (length < 4096 || gradient < longest / 32) continue;  // cut to 14 and 15 bits: a direction that shrinks more is coarser
    const double factor = std::exp2((c.contour.own_units ? c.fine.level : 0) + c.axis.exponent - 1 - c.contour.scale_log2 / 1024.0) / gradient;
    const double wanted = field * factor;
    if (std::fabs(wanted) > 31 || factor < std::exp2(-32) || factor >= std::exp2(15)) continue;
    const int32_t got = contour_distance(exact_prof, c, contour_field(fine, coarse, fraction, c, profiles::exact), d, i, j);
    // The field is rounded to 2^-12 twice at most, with factors of 1 and 2; the factor is good to 2^-13 and what the cuts of 2^-14 turn.
    const double bound = std::exp2(-12) * factor + (std::exp2(-13) + std::exp2(-13) * longest / gradient) * std::fabs(wanted) + std::exp2(-16);
    worst = std::max(worst, std::fabs(got / 65536.0 - wanted) / bound);
  }
  print_message("worst %.2f of the bound\n", worst);
  assert_true(worst <= 1);
}

// VR11: the width of an outline does not depend on magnification. 8 bits, distances counted in each level's own texels.
SPANTEX_CASE(outlines_keep_their_width_from_a_sixteenth_to_sixteen_texels_a_pixel) {
  const double one = worst_outline(exact_prof, 1, true, 16), two = worst_outline(exact_prof, 2, true, 16), three = worst_outline(standard_prof, 3, true, 16);
  print_message("worst error: width 1 %.3f, 2 %.3f, 3 (default) %.3f pixel\n", one, two, three);
  assert_true(one <= 0.25 && two <= 0.25 && three <= 0.25);
}

// seed clamps what does not fit its 8x8 and 4x4 texels, but not for contours: it takes a coarser level then, as compact does.
SPANTEX_CASE(cheaper_profiles_keep_the_width) {
  const double compact = worst_outline(compact_prof, 2, true, 16), seed = worst_outline(seed_prof, 2, true, 16);
  const double compact_tilted = worst_tilted_outline(compact_prof, 2, 16, {2, 4}), seed_tilted = worst_tilted_outline(seed_prof, 2, 16, {2, 4});
  print_message("worst error: compact %.3f, seed %.3f; on tilted planes %.3f, %.3f pixel\n", compact, seed, compact_tilted, seed_tilted);
  assert_true(compact <= 0.25 && seed <= 0.25 && compact_tilted <= 0.25 && seed_tilted <= 0.25);
}

// The same on planes at an angle, where a pixel's image is up to four times as long as wide: the line is measured by the field's screen gradient.
SPANTEX_CASE(outlines_keep_their_width_on_tilted_planes) {
  const double one = worst_tilted_outline(exact_prof, 1, 16, {1.5, 2, 4, 8}), three = worst_tilted_outline(standard_prof, 3, 16, {1.5, 2, 4, 8});
  print_message("worst error: width 1 %.3f, 3 (default) %.3f pixel\n", one, three);
  assert_true(one <= 0.25 && three <= 0.25);
}

// With levels that are means of level 0, 8 bits reach 8 texels either way at 16 units a texel: enough while 1.5 pixels are fewer texels.
SPANTEX_CASE(means_of_level_0_keep_the_width_while_the_field_reaches) {
  double worst = 0;
  constexpr int side = 512;
  for (const double texels_per_px : {1.0 / 16, 0.3, 1.0, 2.0})
    for (const double normal : {0.0, 0.4636, 0.7854}) {
      texture_view t = field_map(side, 16, false, [&](double u, double v) { return (u - 256) * std::cos(normal) + (v - 256) * std::sin(normal); });
      SPANTEX_ASSERT_OK(t.set_contour(style(2, false, 16)));
      draw(exact_prof, similarity(side, texels_per_px, 0.3), t);
      worst = std::max(worst, std::fabs(measured_width(normal - 0.3 + M_PI / 2, 30) - 2));
    }
  print_message("worst error %.3f pixel\n", worst);
  assert_true(worst <= 0.25);
}

// A disc: the area of its fill and of its outline.
SPANTEX_CASE(a_disc_has_its_area_and_its_outline) {
  for (const double texels_per_px : {0.25, 1.0, 3.0}) {
    const double radius_px = 40, radius = radius_px * texels_per_px;
    texture_view t = field_map(512, 16, true, [&](double u, double v) { return radius - std::hypot(u - 256, v - 256); });
    for (const double outline : {0.0, 1.5}) {
      SPANTEX_ASSERT_OK(t.set_contour(style(outline, true, 16)));
      draw(exact_prof, similarity(512, texels_per_px, 0.5), t);
      double sum = 0;
      for (const rgba8& c : shown.pixels) sum += c.a / 255.0;
      if (outline == 0) {
        const double radius_got = std::sqrt(sum / M_PI);
        print_message("%.2f texels a pixel: radius %.3f of %.0f\n", texels_per_px, radius_got, radius_px);
        assert_true(std::fabs(radius_got - radius_px) < 0.25);
      } else {
        const double width = sum / (2 * M_PI * radius_px);
        print_message("%.2f texels a pixel: outline %.3f of %.1f\n", texels_per_px, width, outline);
        assert_true(std::fabs(width - outline) < 0.25);
      }
    }
  }
}

// The edge of a fill: from 5 % to 95 % within about a pixel, however magnified; plain bilinear alpha is 16 pixels wide there.
SPANTEX_CASE(an_edge_is_a_pixel_wide) {
  for (const double texels_per_px : {1.0 / 16, 1.0, 7.0}) {
    texture_view t = field_map(512, 16, true, [](double u, double) { return u - 256.2; });
    SPANTEX_ASSERT_OK(t.set_contour(style(0, true, 16)));
    draw(exact_prof, similarity(512, texels_per_px, 0), t);
    for (int y = 0; y < side_px; ++y) {
      int between = 0;
      for (int x = 0; x < side_px; ++x) {
        const uint8_t a = shown.pixels[size_t(y * side_px + x)].a;
        between += a > 12 && a < 243;
      }
      assert_true(between <= 2);
    }
  }
}

SPANTEX_CASE(colours_are_those_of_trilinear) {
  static picture plain;
  for (int k = 0; k < 3; ++k) {
    const texture_view t = photographic_map(64, 64).view(wrap::repeat, wrap::mirror);
    const plane p = sample_plane(k, {0, 0, side_px, side_px});
    draw(exact_prof, p, t);
    plain.reset(side_px, side_px);
    SPANTEX_ASSERT_OK(render_plane_direct<32>(exact_prof, p, t, filter::trilinear, plain));
    for (size_t n = 0; n < plain.pixels.size(); ++n) {
      const rgba8 a = shown.pixels[n], b = plain.pixels[n];
      assert_true(a.r == b.r && a.g == b.g && a.b == b.b);
    }
  }
}

SPANTEX_CASE(scales_without_a_distance_are_refused) {
  texture_view t = photographic_map(8, 8).view(wrap::repeat, wrap::repeat);
  contour_style s;
  s.scale = 15;
  SPANTEX_ASSERT_STATUS(t.set_contour(s), out_of_range);
  s.scale = 0;
  SPANTEX_ASSERT_STATUS(t.set_contour(s), out_of_range);
  s.scale = 16;
  SPANTEX_ASSERT_OK(t.set_contour(s));
}

int main() {
  const CMUnitTest tests[] = {cmocka_unit_test(coverage_is_that_of_a_box_of_one_pixel),
                              cmocka_unit_test(powers_of_two_hold_over_their_whole_domain),
                              cmocka_unit_test(the_distance_is_the_formulas),
                              cmocka_unit_test(outlines_keep_their_width_from_a_sixteenth_to_sixteen_texels_a_pixel),
                              cmocka_unit_test(cheaper_profiles_keep_the_width),
                              cmocka_unit_test(outlines_keep_their_width_on_tilted_planes),
                              cmocka_unit_test(means_of_level_0_keep_the_width_while_the_field_reaches),
                              cmocka_unit_test(a_disc_has_its_area_and_its_outline),
                              cmocka_unit_test(an_edge_is_a_pixel_wide),
                              cmocka_unit_test(colours_are_those_of_trilinear),
                              cmocka_unit_test(scales_without_a_distance_are_refused)};
  return run_suite("contour", tests);
}
