// SPDX-License-Identifier: Apache-2.0
#include "ideal.hpp"

#include <math.h>

#include <algorithm>

namespace spantex::sim {
namespace {

// m 2^shift, rounded to nearest where bits are lost.
wide to_wide(double m, int shift) {
  int exponent = 0;
  const double fraction = frexp(m, &exponent);  // m = fraction 2^exponent, 1/2 <= |fraction| < 1
  const int64_t mantissa = int64_t(ldexp(fraction, 53));
  const int up = exponent - 53 + shift;
  if (up >= 0) return shift_left(wide(mantissa), up);
  return up < -62 ? wide() : shift_right_nearest(wide(mantissa), -up);
}

struct point3 { long double x, y, z; };

point3 cross(const point3& p, const point3& q) {
  return {p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
}

long double dot(const point3& p, const point3& q) { return p.x * q.x + p.y * q.y + p.z * q.z; }

// The homogeneous screen position the engine starts from, which is what the vertex means.
point3 projected(const vertex& v, const projection& camera) {
  const homogeneous_point p = project(v, camera);
  return {(long double)p.x, (long double)p.y, (long double)p.z};
}

}  // namespace

homography to_homography(const matrix& m) {
  double largest = 0;
  for (const double x : m) largest = std::max(largest, fabs(x));
  int exponent = 0;
  frexp(largest, &exponent);
  homography h;
  wide* const out[9] = {&h.a, &h.b, &h.c, &h.d, &h.e, &h.f, &h.g, &h.h, &h.i};
  for (int k = 0; k < 9; ++k) *out[k] = to_wide(m[size_t(k)], 100 - exponent);
  return h;
}

std::optional<matrix> matrix_of(const vertex* vertices, int count, const projection& camera) {
  for (int second = 1; second + 1 < count; ++second) {
    const vertex* const corner[3] = {&vertices[0], &vertices[second], &vertices[second + 1]};
    const point3 p[3] = {projected(*corner[0], camera), projected(*corner[1], camera), projected(*corner[2], camera)};
    const point3 rows[3] = {cross(p[1], p[2]), cross(p[2], p[0]), cross(p[0], p[1])};
    const long double determinant = dot(rows[0], p[0]);
    if (determinant == 0) continue;
    long double sum[9] = {};
    for (int k = 0; k < 3; ++k) {
      const long double t[3] = {corner[k]->u / 65536.0L, corner[k]->v / 65536.0L, 1.0L};
      for (int n = 0; n < 3; ++n) {
        sum[3 * n] += rows[k].x / determinant * t[n];
        sum[3 * n + 1] += rows[k].y / determinant * t[n];
        sum[3 * n + 2] += rows[k].z / determinant * t[n];
      }
    }
    matrix m;
    std::copy(sum, sum + 9, m.begin());
    return m;
  }
  return std::nullopt;
}

matrix matrix_of(const kt88_plane& q, const view& s) {
  const auto real = [](const vector3& a, double scale) { return std::array<double, 3>{a.x / scale, a.y / scale, a.z / scale}; };
  const auto n = real(q.normal, 1 << 30), p0 = real(q.anchor, 65536);
  const double d = q.d / 65536.0, step[3] = {ldexp(s.step_x, -32), ldexp(s.step_y, -32), 1};
  const double toward = d > 0 ? -1 : 1;  // -d/W > 0 in front of the viewer
  const auto row = [&](const std::array<double, 3>& k) {
    const double x = toward * k[0] * step[0], y = toward * k[1] * step[1];
    return std::array<double, 3>{x, y, toward * k[2] - x * s.width_px / 2 - y * s.height_px / 2};
  };
  const auto numerator = [&](const std::array<double, 3>& axis, double t0) {
    const double offset = t0 - (p0[0] * axis[0] + p0[1] * axis[1] + p0[2] * axis[2]);
    return std::array<double, 3>{n[0] * offset - d * axis[0], n[1] * offset - d * axis[1], n[2] * offset - d * axis[2]};
  };
  const auto u = row(numerator(real(q.axis_u, 65536), q.u0 / 65536.0)), v = row(numerator(real(q.axis_v, 65536), q.v0 / 65536.0));
  const auto w = row(n);
  return {u[0], u[1], u[2], v[0], v[1], v[2], w[0], w[1], w[2]};
}

}  // namespace spantex::sim
