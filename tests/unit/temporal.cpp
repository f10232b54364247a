// SPDX-License-Identifier: Apache-2.0
// A slowly moving camera: 128 frames each of a pan, a zoom and an approach in sub-pixel steps, profile exact. Texels do not swim: every
// position stays within the coordinate bound of the exact one in every frame. Levels do not pop: from frame to frame no pixel changes by
// more than ideal filtering (exact positions and levels, real weights) does, plus one unit of colour, at span borders and elsewhere.
#include "tests/support.hpp"

#include <algorithm>
#include <cmath>

#include <spantex/accuracy.hpp>

#include "sim/exact.hpp"

using namespace spantex;
using namespace spantex::sim;

namespace {

constexpr int32_t width = 96, height = 64;
constexpr int frame_count = 128;

using profile_under_test = fixed_profile<profiles::exact>;

enum class motion { pan, zoom, approach };

// Frame k of a motion over the tilted sample plane, in 2^-48.
homography frame_of(motion how, int k) {
  homography m = sample_homography(1);
  for (wide* c : {&m.a, &m.b, &m.d, &m.e, &m.g, &m.h}) *c = multiply(*c, 5);
  const auto sixteenths = [&](wide c, int64_t n) { return shift_right_floor(multiply(c, n), 4); };
  switch (how) {
    case motion::pan:  // 1/16 pixel a frame to the right, 1/32 down
      m.c = m.c + sixteenths(m.a, k) + sixteenths(m.b, k / 2);
      m.f = m.f + sixteenths(m.d, k) + sixteenths(m.e, k / 2);
      m.i = m.i + sixteenths(m.g, k) + sixteenths(m.h, k / 2);
      break;
    case motion::zoom:  // 1/512 a frame
      for (wide* c : {&m.a, &m.b, &m.d, &m.e, &m.g, &m.h}) *c = *c - shift_right_floor(multiply(*c, k), 9);
      break;
    case motion::approach:  // nearer to the plane: u and v shrink about their origin, level by level
      for (wide* c : {&m.a, &m.b, &m.c, &m.d, &m.e, &m.f}) *c = *c - shift_right_floor(multiply(*c, k), 8);
      break;
  }
  return m;
}

// At most 2.5 units a texel of level 0: what half a step of a weight changes is small against a unit, so that what is left is rounding,
// and a jump of level or position would stand out.
const synthetic_map& soft_map() {
  static const synthetic_map& map = make_map(256, 256, [](int32_t x, int32_t y) {
    const auto wave = [](double t) { return uint8_t(127.5 + 100 * std::sin(t)); };
    constexpr double turn = 2 * 3.14159265358979323846 / 256;
    return rgba8{wave(turn * x), wave(turn * y), wave(turn * (x + y)), 255};
  });
  return map;
}

struct exact_place { double u, v, level; };

exact_place place_at(const plane& p, int x, int y) {
  const int32_t hx = 2 * x + 1, hy = 2 * y + 1;
  const auto w = static_cast<long double>(p.w_at(hx, hy));
  return {double(p.u_at(hx, hy) / w), double(p.v_at(hx, hy) / w), double(exact_level(p, hx, hy))};
}

double ideal_bilinear(const texture_view& t, int level, double u, double v, uint8_t rgba8::*channel) {
  u = u * t.width(level) / t.width() - 0.5;
  v = v * t.height(level) / t.height() - 0.5;
  const double x = std::floor(u), y = std::floor(v), fx = u - x, fy = v - y;
  const auto texel = [&](int i, int j) {
    return double(t.texel(level, t.wrapped_u(int(x) + i, level), t.wrapped_v(int(y) + j, level)).*channel);
  };
  return (1 - fy) * ((1 - fx) * texel(0, 0) + fx * texel(1, 0)) + fy * ((1 - fx) * texel(0, 1) + fx * texel(1, 1));
}

double ideal_trilinear(const texture_view& t, exact_place p, uint8_t rgba8::*channel) {
  const double d = std::clamp(p.level, 0.0, double(t.last_level()));
  const int level = std::min(int(d), t.last_level());
  const double fine = ideal_bilinear(t, level, p.u, p.v, channel);
  if (level == t.last_level()) return fine;
  return fine + (d - level) * (ideal_bilinear(t, level + 1, p.u, p.v, channel) - fine);
}

constexpr uint8_t rgba8::*channels[] = {&rgba8::r, &rgba8::g, &rgba8::b};

struct frame_state {
  uint8_t drawn[height][width][3];
  double ideal[height][width][3];
};
frame_state before, now;
picture drawn;

void check_positions(const plane& p) {
  const double bound = double(coordinate_bound(profiles::exact)) / double(error_unit);
  const texture_view t = soft_map().view(wrap::repeat, wrap::repeat);
  const surface s{&p, &t, filter::trilinear};
  for (int sy = 0; sy < height / span_side; ++sy)
    for (int sx = 0; sx < width / span_side; ++sx)
      SPANTEX_ASSERT_OK(plan_span(profile_under_test{}, s, sx, sy, full_mask, [&](span_job& job) {
        for (span_mask rest = job.mask; rest != 0; rest &= rest - 1) {
          const int k = __builtin_ctzll(rest), i = k % span_side, j = k / span_side;
          const texel_position at = position_at(profile_under_test{}, job.coefficients, i, j);
          const int32_t hx = 2 * (sx * span_side + i) + 1, hy = 2 * (sy * span_side + j) + 1;
          assert_true(coordinate_error(at.u.raw(), p.u_at(hx, hy), p.w_at(hx, hy)) <= bound);
          assert_true(coordinate_error(at.v.raw(), p.v_at(hx, hy), p.w_at(hx, hy)) <= bound);
        }
        return status::ok;
      }));
}

void take_frame(const plane& p, const texture_view& t, frame_state& out) {
  drawn.reset(width, height);
  SPANTEX_ASSERT_OK(render_plane_direct<32>(profile_under_test{}, p, t, filter::trilinear, drawn));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c) {
        out.drawn[y][x][c] = drawn.pixels[size_t(y * width + x)].*channels[c];
        out.ideal[y][x][c] = ideal_trilinear(t, place_at(p, x, y), channels[c]);
      }
}

// How much more than the ideal picture the drawn one changed, at most.
double worst_excess() {
  double worst = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c)
        worst = std::max(
            worst, std::abs(double(now.drawn[y][x][c]) - before.drawn[y][x][c]) - std::abs(now.ideal[y][x][c] - before.ideal[y][x][c]));
  return worst;
}

void moves_without_swimming_or_popping(motion how) {
  const texture_view t = soft_map().view(wrap::repeat, wrap::repeat);
  double worst = 0;
  for (int k = 0; k < frame_count; ++k) {
    plane p{};
    SPANTEX_ASSERT_OK(make_plane(frame_of(how, k), {0, 0, width, height}, p));
    check_positions(p);
    take_frame(p, t, now);
    if (k > 0) worst = std::max(worst, worst_excess());
    before = now;
  }
  std::fprintf(stderr, "# largest change beyond the ideal one: %.3f\n", worst);
  // One unit for two roundings, and half a step of two weights in two frames on levels up to 3 (20 units a texel): 4 * 20 / 512.
  assert_true(worst <= 1.157);
  assert_true(worst > 0.5);  // the measure sees roundings at all
}

}  // namespace

SPANTEX_CASE(pan_in_sixteenths_of_a_pixel) { moves_without_swimming_or_popping(motion::pan); }
SPANTEX_CASE(slow_zoom) { moves_without_swimming_or_popping(motion::zoom); }
SPANTEX_CASE(slow_approach_through_levels) { moves_without_swimming_or_popping(motion::approach); }

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(pan_in_sixteenths_of_a_pixel),
      cmocka_unit_test(slow_zoom),
      cmocka_unit_test(slow_approach_through_levels),
  };
  return run_suite("temporal", tests);
}
