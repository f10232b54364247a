// SPDX-License-Identifier: Apache-2.0
// Sine and cosine against long double; the rotation against the product of its three turns; the ground's plane against the
// intersection of its rays, against GCK09's formulas (1) as corrected and their inverse (2).
#include <tests/floor_view.hpp>
#include <tests/support.hpp>

#include <spantex/camera.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

constexpr real entry_bound = 1.0L / (1 << 27);  // camera.hpp

real radians(binary_angle a) { return std::ldexp(real(a.turn), -32) * 2 * pi; }
binary_angle degrees(real d) { return {uint32_t(int64_t(std::floor(std::ldexp(d / 360, 32) + 0.5L)))}; }

struct matrix3 { real k[3][3]; };
matrix3 times(const matrix3& a, const matrix3& b) {
  matrix3 c{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int n = 0; n < 3; ++n) c.k[i][j] += a.k[i][n] * b.k[n][j];
  return c;
}

// Ry(yaw) Rz(pitch) Rx(roll); column 0 is U, 1 V, 2 W.
matrix3 ideal_attitude(binary_angle roll, binary_angle pitch, binary_angle yaw) {
  const real g = radians(roll), t = radians(pitch), y = radians(yaw);
  const matrix3 rx{{{1, 0, 0}, {0, std::cos(g), -std::sin(g)}, {0, std::sin(g), std::cos(g)}}};
  const matrix3 rz{{{std::cos(t), -std::sin(t), 0}, {std::sin(t), std::cos(t), 0}, {0, 0, 1}}};
  const matrix3 ry{{{std::cos(y), 0, std::sin(y)}, {0, 1, 0}, {-std::sin(y), 0, std::cos(y)}}};
  return times(ry, times(rz, rx));
}

attitude_camera make_camera(real roll, real pitch, real yaw, vector3 position, int32_t texels) {
  return {degrees(roll), degrees(pitch), degrees(yaw), position, texels << 16};
}

// GCK09 (1), corrected: coefficients of Ys (up) and Zs (right), rho = 1.
struct gck_forms { real ax, bx, cx, az, bz, cz, d, e, f; };
gck_forms gck_formula_1(const attitude_camera& a) {
  const real g = radians(a.roll), t = radians(a.pitch), p = radians(a.yaw);
  const real xh = std::ldexp(real(a.position.x), -16), yh = std::ldexp(real(a.position.y), -16), zh = std::ldexp(real(a.position.z), -16);
  const real sg = std::sin(g), cg = std::cos(g), st = std::sin(t), ct = std::cos(t), sp = std::sin(p), cp = std::cos(p);
  return {xh * cg * ct - yh * sg * sp + yh * cg * cp * st,
          -(xh * ct * sg + yh * cg * sp + yh * cp * sg * st),
          -yh * cp * ct + xh * st,
          zh * cg * ct - yh * cp * sg - yh * cg * sp * st,
          -(yh * cg * cp + zh * ct * sg - yh * sg * sp * st),
          yh * ct * sp + zh * st,
          cg * ct, -ct * sg, st};
}

}  // namespace

SPANTEX_CASE(sine_and_cosine_are_within_their_bound) {
  real worst = 0;
  const auto check = [&](uint32_t turn) {
    const sine_cosine s = sine_cosine_of({turn});
    const real es = std::fabs(real(s.sine) - std::ldexp(std::sin(radians({turn})), 30));
    const real ec = std::fabs(real(s.cosine) - std::ldexp(std::cos(radians({turn})), 30));
    worst = std::fmax(worst, std::fmax(es, ec));
  };
  for (uint32_t k = 0; k < 1 << 16; ++k) check(k << 16);
  random_source random(70);
  for (int k = 0; k < 3000000; ++k) check(uint32_t(random.next()));
  for (uint32_t quadrant = 0; quadrant < 8; ++quadrant)
    for (int32_t k = -2000; k <= 2000; ++k) check(uint32_t(int64_t(quadrant) * (1 << 29) + k));
  std::printf("# worst %.3Lf units of s1.30\n", worst);
  assert_true(worst <= 1.4L);
}

SPANTEX_CASE(whole_quarters_are_exact) {
  constexpr int32_t one = 1 << 30;
  const sine_cosine wanted[] = {{0, one}, {one, 0}, {0, -one}, {-one, 0}};
  for (uint32_t k = 0; k < 4; ++k) {
    const sine_cosine s = sine_cosine_of({k << 30});
    assert_int_equal(s.sine, wanted[k].sine);
    assert_int_equal(s.cosine, wanted[k].cosine);
  }
}

SPANTEX_CASE(the_rotation_is_the_product_of_its_three_turns) {
  random_source random(71);
  real worst = 0;
  for (int k = 0; k < 200000; ++k) {
    const binary_angle g{uint32_t(random.next())}, t{uint32_t(random.next())}, y{uint32_t(random.next())};
    const attitude r = attitude_of(g, t, y);
    const matrix3 m = ideal_attitude(g, t, y);
    const int64_t entries[3][3] = {{r.xu, r.xv, r.xw}, {r.yu, r.yv, r.yw}, {r.zu, r.zv, r.zw}};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) worst = std::fmax(worst, std::fabs(std::ldexp(real(entries[i][j]), -spantex::detail::camera_bits) - m.k[i][j]));
  }
  std::printf("# worst 2^%.2Lf\n", std::log2(worst));
  assert_true(worst <= entry_bound);
}

// A coefficient errs by entry_bound times what it is multiplied with, u by the numerator's and u times the divisor's error over W.
SPANTEX_CASE(rays_meet_the_ground_where_the_plane_says) {
  random_source random(72);
  const view s = make_view(640, 480);
  int64_t checked = 0;
  for (int n = 0; n < 3000; ++n) {
    const attitude_camera a{{uint32_t(random.next())}, {uint32_t(random.next())}, {uint32_t(random.next())},
                            {int32_t(random.between(-100 << 16, 100 << 16)), int32_t(random.between(-30 << 16, 30 << 16)), int32_t(random.between(-100 << 16, 100 << 16))},
                            int32_t(random.between(1 << 14, 300 << 16))};
    plane p{};
    if (make_plane(a, s, p) != status::ok) continue;
    const matrix3 m = ideal_attitude(a.roll, a.pitch, a.yaw);
    const real t = std::ldexp(real(a.texels_per_unit), -16), h[3] = {std::ldexp(real(a.position.x), -16), std::ldexp(real(a.position.y), -16), std::ldexp(real(a.position.z), -16)};
    const gck_forms f = gck_formula_1(a);
    for (int k = 0; k < 40; ++k) {
      const int32_t hx = 1 + 2 * int32_t(random.next() % 640), hy = 1 + 2 * int32_t(random.next() % 480);
      const double_vector q = ray(s, hx / 2.0L, hy / 2.0L);  // x right, y down
      const auto world = [&](int i) { return m.k[i][0] - m.k[i][1] * q.y + m.k[i][2] * q.x; };
      const real down = world(1), along = -h[1] / down;
      if (std::fabs(down) < 1.0L / 4096) continue;
      assert_true((p.w_at(hx, hy) > 0) == (along > 0));
      if (along <= 0) continue;
      const real ray_size = 1 + std::fabs(q.x) + std::fabs(q.y);
      for (int axis = 0; axis < 3; axis += 2) {
        const real want = t * (h[axis] + along * world(axis));
        const real got = real(axis == 0 ? p.u_at(hx, hy) : p.v_at(hx, hy)) / real(p.w_at(hx, hy));
        const real bound = ray_size * entry_bound * (t * (std::fabs(h[axis]) + std::fabs(h[1])) + std::fabs(want)) / std::fabs(down);
        const real set_up = std::ldexp(1 + std::fabs(want), -12);  // make_plane's rounding of a homography, docs/ACCURACY.md section 1
        assert_true(std::fabs(got - want) <= bound + set_up / std::fabs(down));
        // GCK09's printed form of the same, in X_T, Z_T.
        const real up = -q.y, right = q.x;
        const real formula = axis == 0 ? (up * f.ax + right * f.bx + f.cx) / (up * f.d + right * f.e + f.f) : (up * f.az + right * f.bz + f.cz) / (up * f.d + right * f.e + f.f);
        assert_true(std::fabs(t * formula - want) <= 1e-9L * (1 + std::fabs(want)) / std::fabs(down));
        ++checked;
      }
    }
  }
  assert_true(checked > 50000);
}

// (2): screen from ground, the adjugate of (1) up to sign.
SPANTEX_CASE(the_printed_inverse_mapping_inverts_the_corrected_forward_one) {
  random_source random(73);
  for (int n = 0; n < 20000; ++n) {
    const attitude_camera a{{uint32_t(random.next())}, {uint32_t(random.next())}, {uint32_t(random.next())},
                            {int32_t(random.between(-9 << 16, 9 << 16)), int32_t(random.between(1 << 16, 9 << 16)), int32_t(random.between(-9 << 16, 9 << 16))}, 1 << 16};
    const gck_forms k = gck_formula_1(a);
    const real y = real(random.between(-1000, 1000)) / 1000, z = real(random.between(-1000, 1000)) / 1000, w = y * k.d + z * k.e + k.f;
    if (std::fabs(w) < 0.01L) continue;
    const real x_t = (y * k.ax + z * k.bx + k.cx) / w, z_t = (y * k.az + z * k.bz + k.cz) / w;
    const real ay = k.cz * k.e - k.bz * k.f, by = -k.cx * k.e + k.bx * k.f, cy = k.bz * k.cx - k.bx * k.cz;
    const real az = -k.cz * k.d + k.az * k.f, bz = k.cx * k.d - k.ax * k.f, cz = -k.az * k.cx + k.ax * k.cz;
    const real d = k.bz * k.d - k.az * k.e, e = -k.bx * k.d + k.ax * k.e, f = k.az * k.bx - k.ax * k.bz;
    const real divisor = x_t * d + z_t * e + f;
    assert_true(std::fabs((x_t * ay + z_t * by + cy) / divisor - y) < 1e-9L);
    assert_true(std::fabs((x_t * az + z_t * bz + cz) / divisor - z) < 1e-9L);
  }
}

// Its major axis is KT88's log2(2 T Delta d) - 2 log2 |W|.
SPANTEX_CASE(levels_of_the_ground_follow_kt88) {
  const view s = make_view(640, 480);
  plane p{};
  SPANTEX_ASSERT_OK(make_plane(make_camera(10, -40, 30, {0, 3 << 16, 0}, 200), s, p));
  const matrix3 m = ideal_attitude(degrees(10), degrees(-40), degrees(30));
  const real k = std::log2(200 * 2 * std::ldexp(real(s.step_x > s.step_y ? s.step_x : s.step_y), -32) * 3);
  for (int32_t y = 1; y < 960; y += 38) {
    const double_vector q = ray(s, 300.5L, y / 2.0L);
    const real w = std::fabs(m.k[1][0] - m.k[1][1] * q.y + m.k[1][2] * q.x);
    const real got = std::ldexp(real(p.major_log2), -16) - 2 * std::log2(real(p.w_at(601, y)));
    assert_true(std::fabs(got - (k - 2 * std::log2(w))) < 1.0L / 4096);
  }
}

// Looking straight ahead and down with no other turn: up on the screen is ahead, right is right.
SPANTEX_CASE(the_picture_is_the_right_way_round) {
  const view s = make_view(640, 480);
  plane p{};
  SPANTEX_ASSERT_OK(make_plane(make_camera(0, -60, 0, {0, 2 << 16, 0}, 64), s, p));
  const auto u = [&](int32_t x, int32_t y) { return real(p.u_at(x, y)) / real(p.w_at(x, y)); };
  const auto v = [&](int32_t x, int32_t y) { return real(p.v_at(x, y)) / real(p.w_at(x, y)); };
  assert_true(u(641, 101) > u(641, 801));
  assert_true(v(1001, 481) > 0 && v(201, 481) < 0);
}

SPANTEX_CASE(grounds_that_cannot_be_seen_are_refused) {
  const view s = make_view(640, 480);
  plane p{};
  SPANTEX_ASSERT_STATUS(make_plane(make_camera(0, -40, 0, {0, 0, 0}, 64), s, p), degenerate);
  SPANTEX_ASSERT_STATUS(make_plane(make_camera(0, -40, 0, {0, 1 << 16, 0}, 0), s, p), degenerate);
  SPANTEX_ASSERT_STATUS(make_plane(make_camera(0, 60, 0, {0, 1 << 16, 0}, 64), s, p), degenerate);
  view bad = s;
  bad.height_px = 5000;
  SPANTEX_ASSERT_STATUS(make_plane(make_camera(0, -40, 0, {0, 1 << 16, 0}, 64), bad, p), bad_size);
  SPANTEX_ASSERT_OK(make_plane(make_camera(0, 60, 0, {0, -1 << 16, 0}, 64), s, p));
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(sine_and_cosine_are_within_their_bound),
      cmocka_unit_test(whole_quarters_are_exact),
      cmocka_unit_test(the_rotation_is_the_product_of_its_three_turns),
      cmocka_unit_test(rays_meet_the_ground_where_the_plane_says),
      cmocka_unit_test(the_printed_inverse_mapping_inverts_the_corrected_forward_one),
      cmocka_unit_test(levels_of_the_ground_follow_kt88),
      cmocka_unit_test(the_picture_is_the_right_way_round),
      cmocka_unit_test(grounds_that_cannot_be_seen_are_refused),
  };
  return run_suite("camera", tests);
}
