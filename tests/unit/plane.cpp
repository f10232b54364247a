// SPDX-License-Identifier: Apache-2.0
// Planes from a matrix, from KT88's N, d, U, V, P0 and angles of view, and from three vertices: each against exact rational evaluation
// of what it was given, and against one another on the same geometry.
#include <tests/floor_view.hpp>
#include <tests/support.hpp>

#include <cmath>

using namespace spantex;
using namespace spantex::sim;

namespace {

constexpr int32_t one = 1 << 16;

// n/w exactly, as a fraction; the comparison |Nu/W - n/w| <= 2^-bits is by cross-multiplication.
struct fraction { int128 n, w; };

// Brings a fraction to at most 62 bits a side: a relative change below 2^-60.
fraction shortened(fraction f) {
  const auto bits = [](int128 x) { int n = 0; for (x = magnitude_of(x); x != 0; x >>= 1) ++n; return n; };
  const int drop = max_of(0, max_of(bits(f.n), bits(f.w)) - 62);
  return {f.n >> drop, f.w >> drop};
}

// |a - b| in 2^-24 of a unit, rounded up; for |a|, |b| < 2^15 the shortening adds less than 2^-40.
int64_t distance_24(int64_t n, int64_t w, fraction f) {
  const fraction e = shortened(f);
  // a - b = (n e.w - e.n w) / (w e.w): both products below 2^122
  const int128 difference = magnitude_of(int128(n) * e.w - int128(w) * e.n);
  const int128 unit = (int128(w) * e.w) >> 24;
  return unit == 0 ? INT64_MAX : int64_t((difference + unit - 1) / unit);
}

real quotient_of(int64_t n, int64_t w) { return real(n) / real(w); }

struct whole_matrix { int64_t k[9]; };

homography homography_from(const whole_matrix& m) {
  return {wide(m.k[0]), wide(m.k[1]), wide(m.k[2]), wide(m.k[3]), wide(m.k[4]), wide(m.k[5]), wide(m.k[6]), wide(m.k[7]), wide(m.k[8])};
}

// The matrix at a pixel's centre, times two: exact.
fraction evaluate(const whole_matrix& m, int row, int32_t hx, int32_t hy) {
  const auto form = [&](int r) { return int128(m.k[3 * r]) * hx + int128(m.k[3 * r + 1]) * hy + 2 * int128(m.k[3 * r + 2]); };
  return {form(row), form(2)};
}

}  // namespace

// --- from a matrix ------------------------------------------------------------------------------------------

// Every coefficient is rounded by at most half a unit, so a form at (hx, hy) by d = (|hx - ox| + |hy - oy| + 1) / 2 units, and the quotient
// by d (1 + |u|) / W.
SPANTEX_CASE(a_matrix_is_evaluated_as_it_was_given) {
  random_source random(80);
  const rectangle region{0, 0, 640, 480};
  int64_t checked = 0, worst = 0;
  for (int n = 0; n < 2000; ++n) {
    whole_matrix m{};
    for (int k = 0; k < 6; ++k) m.k[k] = random.between(-(1ll << 61), 1ll << 61) >> (k % 3 == 2 ? 0 : 8);
    m.k[6] = random.between(-(1ll << 42), 1ll << 42);
    m.k[7] = random.between(-(1ll << 42), 1ll << 42);
    m.k[8] = random.between(1ll << 50, 1ll << 52);
    plane p{};
    if (make_plane(homography_from(m), region, p) != status::ok) continue;
    for (int k = 0; k < 200; ++k) {
      const int32_t hx = 1 + 2 * int32_t(random.next() % 640), hy = 1 + 2 * int32_t(random.next() % 480);
      const int64_t w = p.w_at(hx, hy);
      if (w < 1 << 20) continue;
      for (int row = 0; row < 2; ++row) {
        const int64_t numerator = row == 0 ? p.u_at(hx, hy) : p.v_at(hx, hy);
        if (magnitude_of(numerator) >= int128(w) << 15) continue;
        const int64_t error = distance_24(numerator, w, evaluate(m, row, hx, hy));
        const int64_t units = int64_t(magnitude(hx - p.origin_x) + magnitude(hy - p.origin_y) + 1);  // two halves
        const int128 bound = ((int128(units) << 23) * (magnitude_of(numerator) / w + 2)) / w + 1;
        assert_true(error <= bound);
        worst = error > worst ? error : worst;
        ++checked;
      }
    }
  }
  std::printf("# %lld coordinates, worst %lld of 2^-24 texel\n", static_cast<long long>(checked), static_cast<long long>(worst));
  assert_true(checked > 100000);
}

SPANTEX_CASE(scaling_a_matrix_by_a_power_of_two_changes_nothing) {
  for (int k = 0; k < sample_plane_count; ++k) {
    const homography m = sample_homography(k);
    const plane p = sample_plane(k);
    for (const int shift : {1, 8, 40, 60}) {
      const auto up = [shift](wide a) { return shift_left(a, shift); };
      plane q{};
      SPANTEX_ASSERT_OK(make_plane({up(m.a), up(m.b), up(m.c), up(m.d), up(m.e), up(m.f), up(m.g), up(m.h), up(m.i)}, {0, 0, 640, 480}, q));
      for (int32_t y = 1; y < 960; y += 96)
        for (int32_t x = 1; x < 1280; x += 128)
          assert_true(q.u_at(x, y) == p.u_at(x, y) && q.v_at(x, y) == p.v_at(x, y) && q.w_at(x, y) == p.w_at(x, y));
      assert_int_equal(q.major_log2, p.major_log2);
    }
  }
}

// Rounding three coefficients can carry a value past the power of two by half a unit for each step from the origin: 2^13 at most.
SPANTEX_CASE(values_stay_within_their_widths_over_the_region) {
  random_source random(81);
  for (int n = 0; n < 20000; ++n) {
    const int32_t x = int32_t(random.next() % 4000), y = int32_t(random.next() % 4000);
    const rectangle region{x, y, x + 1 + int32_t(random.next() % uint64_t(4096 - x)), y + 1 + int32_t(random.next() % uint64_t(4096 - y))};
    // Products with screen positions must fit 126 bits: slopes below 2^110, constants below 2^122.
    const auto slope = [&] { return shift_left(wide(random.any_magnitude(62)), int(random.next() % 49)); };
    const auto offset = [&] { return shift_left(wide(random.any_magnitude(62)), int(random.next() % 61)); };
    plane p{};
    const homography m{slope(), slope(), offset(), slope(), slope(), offset(), slope(), slope(), offset()};
    if (make_plane(m, region, p) != status::ok) continue;
    constexpr int128 carry = 1 << 13;
    for (const int32_t hx : {2 * region.x0 - 15, 2 * region.x1 + 15})
      for (const int32_t hy : {2 * region.y0 - 15, 2 * region.y1 + 15}) {
        assert_true(magnitude_of(p.u_at(hx, hy)) < (int128(1) << 59) + carry && magnitude_of(p.v_at(hx, hy)) < (int128(1) << 59) + carry);
        assert_true(magnitude_of(p.w_at(hx, hy)) < (int128(1) << 45) + carry);
      }
  }
}

SPANTEX_CASE(what_cannot_be_seen_is_degenerate) {
  plane p{};
  const wide zero(0), n(1000);
  const rectangle region{0, 0, 64, 64};
  SPANTEX_ASSERT_STATUS(make_plane(homography{n, n, n, n, n, n, zero, zero, zero}, region, p), degenerate);
  SPANTEX_ASSERT_STATUS(make_plane(homography{n, n, n, n, n, n, zero, zero, -n}, region, p), degenerate);
  SPANTEX_ASSERT_STATUS(make_plane(homography{n, n, n, n, n, n, wide(-1), wide(-1), zero}, region, p), degenerate);
  // In front in one corner only.
  SPANTEX_ASSERT_OK(make_plane(homography{n, n, n, n, n, n, wide(1), wide(1), wide(-120)}, region, p));
}

SPANTEX_CASE(regions_that_leave_the_screen_are_refused) {
  plane p{};
  const homography m = sample_homography(0);
  constexpr rectangle bad[] = {{0, 0, 0, 10}, {0, 0, 10, 0}, {5, 5, 4, 9}, {-1, 0, 10, 10},
                               {0, -8, 10, 10}, {0, 0, 4097, 10}, {0, 0, 10, 4097}};
  for (const rectangle& r : bad) SPANTEX_ASSERT_STATUS(make_plane(m, r, p), bad_size);
  SPANTEX_ASSERT_OK(make_plane(m, {0, 0, 4096, 4096}, p));
}

// --- KT88 ------------------------------------------------------------------------------------------------------

// A point P0 + s U + t V of the plane needs N.U = N.V = 0 and N.P0 = -d; the rounded numbers keep that to 2^-16 only, and KT88's formula
// differs from the intersection by that times the distance: compare where both mean the same, at a tolerance of 2^-16 |P| texels a unit.
SPANTEX_CASE(kt88_coefficients_give_the_point_where_the_ray_meets_the_plane) {
  const view s = make_view(640, 480);
  int64_t checked = 0;
  for (const int d_sign : {1, -1})
    for (const real pitch : {80.0L, 40.0L, 18.0L})
      for (const real turn : {0.0L, 20.0L, -65.0L}) {
        const real texels = 64;
        const kt88_plane q = make_floor(pitch, turn, texels, d_sign);
        plane p{};
        SPANTEX_ASSERT_OK(make_plane(q, s, p));
        for (int32_t y = 1; y < 960; y += 38)
          for (int32_t x = 1; x < 1280; x += 58) {
            const int64_t w = p.w_at(x, y);
            const texture_point want = intersect(q, s, x / 2.0L, y / 2.0L);
            if (want.z <= 0 || want.z > 50) continue;
            assert_true(w > 0);
            const real tolerance = texels * want.z * 4 / 65536 + 1.0L / 1024;
            assert_true(std::fabs(quotient_of(p.u_at(x, y), w) - want.u) <= tolerance);
            assert_true(std::fabs(quotient_of(p.v_at(x, y), w) - want.v) <= tolerance);
            ++checked;
          }
      }
  assert_true(checked > 5000);
}

// The formula itself, U'k = Nk U0' - d Uk, in exact 128-bit numbers, then the quotient.
SPANTEX_CASE(kt88_coefficients_follow_the_formula) {
  const view s = make_view(640, 480);
  int64_t worst = 0;
  for (const real pitch : {80.0L, 40.0L, 18.0L}) {
    const kt88_plane q = make_floor(pitch, 20, 64, 1);
    plane p{};
    SPANTEX_ASSERT_OK(make_plane(q, s, p));
    const auto u_prime = [](const kt88_plane& k, const vector3& axis, int32_t t0, int32_t n, int32_t a) {
      const int128 offset = (int128(t0) << 16) - (int128(k.anchor.x) * axis.x + int128(k.anchor.y) * axis.y + int128(k.anchor.z) * axis.z);
      return n * offset - (int128(k.d) * a << 30);  // 62 fraction bits
    };
    for (int32_t y = 1; y < 960; y += 38)
      for (int32_t x = 1; x < 1280; x += 58) {
        // r in 34 fraction bits: step (u0.32) times (hx - width) / 2, and twice for the common factor
        const int64_t rx = int64_t(s.step_x) * (x - s.width_px), ry = int64_t(s.step_y) * (y - s.height_px), rz = int64_t(1) << 33;
        const auto along = [&](int128 kx, int128 ky, int128 kz) { return (kx >> 24) * rx + (ky >> 24) * ry + (kz >> 24) * rz; };
        const int128 nu = along(u_prime(q, q.axis_u, q.u0, q.normal.x, q.axis_u.x), u_prime(q, q.axis_u, q.u0, q.normal.y, q.axis_u.y),
                                u_prime(q, q.axis_u, q.u0, q.normal.z, q.axis_u.z));
        const int128 w = along(int128(q.normal.x) << 32, int128(q.normal.y) << 32, int128(q.normal.z) << 32);
        if (p.w_at(x, y) < int64_t(1) << 40) continue;
        const int64_t error = distance_24(p.u_at(x, y), p.w_at(x, y), {w < 0 ? -nu : nu, magnitude_of(w)});
        worst = error > worst ? error : worst;
      }
  }
  std::printf("# worst %lld of 2^-24 texel\n", static_cast<long long>(worst));
  assert_true(worst <= (int64_t(1) << 24) >> 16);
}

// level = log2(T 2 Delta d) - 2 log2 |W| with W = N.r.
SPANTEX_CASE(kt88_levels_follow_the_formula_of_the_major_axis) {
  const view s = make_view(640, 480);
  run_time_profile prof{profiles::exact};
  prof.value.formula = level_formula::major;
  prof.value.mip_bias = 0;
  const texture_view t = unread_view(4096, 4096);
  int64_t checked = 0;
  for (const real pitch : {80.0L, 40.0L, 18.0L}) {
    const real texels = 512;
    const kt88_plane q = make_floor(pitch, 20, texels, 1);
    plane p{};
    SPANTEX_ASSERT_OK(make_plane(q, s, p));
    const surface what{&p, &t, filter::trilinear};
    const real delta = std::ldexp(real(s.step_x > s.step_y ? s.step_x : s.step_y), -32), d = std::ldexp(real(q.d), -16);
    for (int32_t sy = 0; sy < 60; ++sy)
      SPANTEX_ASSERT_OK(plan_span(prof, what, sy + 7, sy, front_mask(p, sy + 7, sy), [&](span_job& job) {
        for (span_mask m = job.mask; m != 0; m &= m - 1) {
          const int k = __builtin_ctzll(m), px = (sy + 7) * 8 + k % 8, py = sy * 8 + k / 8;
          const real w = dot(value(q.normal, 30), ray(s, px + 0.5L, py + 0.5L));
          const real want = std::log2(texels * 2 * delta * d) - 2 * std::log2(std::fabs(w));
          if (want <= 0 || want >= 12) continue;
          const real got = real(level_at(prof, job.coefficients, k % 8, k / 8)) / 256;
          assert_true(std::fabs(got - want) <= 1.0L / 256);
          ++checked;
        }
        return status::ok;
      }));
  }
  assert_true(checked > 5000);
}

SPANTEX_CASE(kt88_planes_that_cannot_be_seen_are_refused) {
  const view s = make_view(640, 480);
  plane p{};
  kt88_plane q = make_floor(40, 20, 64, 1);
  q.d = 0;
  SPANTEX_ASSERT_STATUS(make_plane(q, s, p), degenerate);
  q = make_floor(40, 20, 64, 1);
  q.d = -q.d;  // the plane behind the viewer
  SPANTEX_ASSERT_STATUS(make_plane(q, s, p), degenerate);
  q = make_floor(40, 20, 64, 1);
  view bad = s;
  bad.width_px = 0;
  SPANTEX_ASSERT_STATUS(make_plane(q, bad, p), bad_size);
  bad.width_px = 5000;
  SPANTEX_ASSERT_STATUS(make_plane(q, bad, p), bad_size);
}

// --- three vertices -----------------------------------------------------------------------------------------------

namespace {

int128 cofactor(int64_t a, int64_t b, int64_t c, int64_t d) { return int128(a) * d - int128(b) * c; }

// u at a pixel's centre by the adjugate of three homogeneous points, in 128 bits: points below 2^31, u below 2^24.
fraction vertex_fraction(const homogeneous_point (&h)[3], const int32_t (&attribute)[3], int32_t hx, int32_t hy) {
  int128 n = 0, w = 0;
  for (int k = 0; k < 3; ++k) {
    const homogeneous_point &a = h[(k + 1) % 3], &b = h[(k + 2) % 3];
    const int128 weight = cofactor(a.y, a.z, b.y, b.z) * hx + cofactor(a.z, a.x, b.z, b.x) * hy + 2 * cofactor(a.x, a.y, b.x, b.y);
    n += weight * attribute[k];
    w += weight << 16;
  }
  return w < 0 ? fraction{-n, -w} : fraction{n, w};
}

}  // namespace

SPANTEX_CASE(vertices_are_interpolated_perspective_correctly) {
  random_source random(82);
  const projection camera{200 * one, 200 * one, 64 * one, 64 * one, one / 4};
  int64_t checked = 0, worst = 0;
  const auto within = [&](int32_t low, int32_t high) { return int32_t(random.between(low, high)); };
  for (int n = 0; n < 5000; ++n) {
    vertex v[3];
    homogeneous_point h[3];
    int32_t us[3], vs[3];
    for (int k = 0; k < 3; ++k) {
      v[k] = {within(-2 * one, 2 * one), within(-2 * one, 2 * one), within(one / 2, 5 * one), within(0, 512 * one), within(0, 512 * one)};
      h[k] = project(v[k], camera);
      us[k] = v[k].u;
      vs[k] = v[k].v;
    }
    polygon p{};
    if (make_polygon(v, 3, camera, {0, 0, 128, 128}, p) != status::ok) continue;
    for (int m = 0; m < 40; ++m) {
      const int32_t x = within(p.box.x0, p.box.x1 - 1), y = within(p.box.y0, p.box.y1 - 1);
      if (((coverage(p.edges, x / 8, y / 8) >> (y % 8 * 8 + x % 8)) & 1) == 0) continue;
      const int32_t hx = 2 * x + 1, hy = 2 * y + 1;
      const int64_t w = p.map.w_at(hx, hy);
      assert_true(w > 0);
      for (const bool second : {false, true}) {
        const int64_t n_at = second ? p.map.v_at(hx, hy) : p.map.u_at(hx, hy);
        const int64_t error = distance_24(n_at, w, vertex_fraction(h, second ? vs : us, hx, hy));
        worst = error > worst ? error : worst;
        ++checked;
      }
    }
  }
  std::printf("# %lld coordinates, worst %lld of 2^-24 texel\n", static_cast<long long>(checked), static_cast<long long>(worst));
  assert_true(checked > 20000);
  assert_true(worst <= (int64_t(1) << 24) >> 16);
}

// The same floor three ways: KT88's numbers; three points of it with their texture coordinates; a matrix made of the KT88 plane's forms.
SPANTEX_CASE(three_ways_to_the_same_plane_agree) {
  const view s = make_view(640, 480);
  const auto focal = [](uint32_t step) { return int32_t(std::ldexp(1 / real(step), 32 + 16) + 0.5L); };
  const projection camera{focal(s.step_x), focal(s.step_y), 320 * one, 240 * one, one / 16};
  for (const real pitch : {60.0L, 30.0L}) {
    const kt88_plane q = make_floor(pitch, 20, 64, 1);
    plane by_camera{};
    SPANTEX_ASSERT_OK(make_plane(q, s, by_camera));

    // Points of the floor on the rays through three corners; texture coordinates where those rays meet it.
    vertex v[3];
    const real corner[3][2] = {{0, 480}, {640, 480}, {320, 300}};
    for (int k = 0; k < 3; ++k) {
      const texture_point t = intersect(q, s, corner[k][0], corner[k][1]);
      const double_vector r = ray(s, corner[k][0], corner[k][1]);
      const auto raw = [](real x) { return int32_t(std::floor(x * one + 0.5L)); };
      v[k] = {raw(r.x * t.z), raw(r.y * t.z), raw(t.z), raw(t.u), raw(t.v)};
    }
    polygon by_vertices{};
    SPANTEX_ASSERT_OK(make_polygon(v, 3, camera, {0, 0, 640, 480}, by_vertices));

    const plane& c = by_camera;
    const auto at_origin = [&](const linear_form& f) { return wide(c.value(f, 0, 0)); };
    const homography m{wide(2 * c.u.x), wide(2 * c.u.y), at_origin(c.u), wide(2 * c.v.x), wide(2 * c.v.y), at_origin(c.v),
                       wide(2 * c.w.x), wide(2 * c.w.y), at_origin(c.w)};
    plane by_matrix{};
    SPANTEX_ASSERT_OK(make_plane(m, {0, 0, 640, 480}, by_matrix));

    int64_t checked = 0;
    for (int32_t y = 600; y < 950; y += 14)
      for (int32_t x = 1; x < 1280; x += 32) {
        const int64_t wc = c.w_at(x, y), wm = by_matrix.w_at(x, y), wv = by_vertices.map.w_at(x, y);
        assert_true(wc > 0 && wm > 0 && wv > 0);
        const real u = quotient_of(c.u_at(x, y), wc), tv = quotient_of(c.v_at(x, y), wc);
        assert_true(std::fabs(quotient_of(by_matrix.u_at(x, y), wm) - u) <= 1.0L / 65536);
        assert_true(std::fabs(quotient_of(by_matrix.v_at(x, y), wm) - tv) <= 1.0L / 65536);
        // Vertices are rounded to 2^-16 of a unit, 64 texels a unit: far less than a 64th of a texel inside and beside the triangle.
        assert_true(std::fabs(quotient_of(by_vertices.map.u_at(x, y), wv) - u) <= 1.0L / 64);
        assert_true(std::fabs(quotient_of(by_vertices.map.v_at(x, y), wv) - tv) <= 1.0L / 64);
        ++checked;
      }
    assert_true(checked == 1000);
  }
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_matrix_is_evaluated_as_it_was_given),
      cmocka_unit_test(scaling_a_matrix_by_a_power_of_two_changes_nothing),
      cmocka_unit_test(values_stay_within_their_widths_over_the_region),
      cmocka_unit_test(what_cannot_be_seen_is_degenerate),
      cmocka_unit_test(regions_that_leave_the_screen_are_refused),
      cmocka_unit_test(kt88_coefficients_give_the_point_where_the_ray_meets_the_plane),
      cmocka_unit_test(kt88_coefficients_follow_the_formula),
      cmocka_unit_test(kt88_levels_follow_the_formula_of_the_major_axis),
      cmocka_unit_test(kt88_planes_that_cannot_be_seen_are_refused),
      cmocka_unit_test(vertices_are_interpolated_perspective_correctly),
      cmocka_unit_test(three_ways_to_the_same_plane_agree),
  };
  return run_suite("plane", tests);
}
