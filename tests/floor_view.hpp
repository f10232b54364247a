// SPDX-License-Identifier: Apache-2.0
// A floor seen by KT88's camera, in long double: the scene of the tests of planes, and where its rays meet it.
#pragma once
#include <cmath>

#include <spantex/plane.hpp>

namespace spantex::sim {

using real = long double;
struct double_vector { real x, y, z; };
inline real dot(double_vector a, double_vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

inline double_vector value(const vector3& a, int bits) {
  const real unit = std::ldexp(real(1), -bits);
  return {a.x * unit, a.y * unit, a.z * unit};
}

// 40 x 30 degrees of view at 640 x 480.
inline constexpr real pi = 3.14159265358979323846L;
inline view make_view(int32_t width, int32_t height) {
  const auto step = [](real degrees, int32_t px) { return uint32_t(std::ldexp(std::tan(degrees / 2 * pi / 180) / px, 33) + 0.5L); };
  return {step(40, width), step(30, height), width, height};
}

// A floor seen from a height of 1, pitched down and turned; `texels` a unit of length.
inline kt88_plane make_floor(real pitch_degrees, real turn_degrees, real texels, int32_t d_sign) {
  const real a = pitch_degrees * pi / 180, b = turn_degrees * pi / 180;
  const double_vector n{0, std::cos(a), std::sin(a)};                                         // y down, towards the floor
  const double_vector e1{1, 0, 0}, e2{0, -std::sin(a), std::cos(a)};
  const double_vector u{std::cos(b) * e1.x + std::sin(b) * e2.x, std::sin(b) * e2.y, std::sin(b) * e2.z};
  const double_vector v{-std::sin(b) * e1.x, std::cos(b) * e2.y, std::cos(b) * e2.z};
  const auto raw = [](double_vector w, real scale, int bits) {
    const auto r = [&](real x) { return int32_t(std::floor(std::ldexp(x * scale, bits) + 0.5L)); };
    return vector3{r(w.x), r(w.y), r(w.z)};
  };
  const real s = d_sign > 0 ? -1 : 1;  // N.P + d = 0 with P = n on the floor: d = -N.n
  return {raw(n, s, 30), d_sign * 65536, raw(u, texels, 16), raw(v, texels, 16), raw(n, 1, 16), 100 * 65536 + 321, 50 * 65536 + 77};
}

// u, v where the ray through (x, y) meets the plane, from the same rounded numbers, by intersecting: P = r Z, Z = -d / (N.r).
struct texture_point { real u, v, z; };
inline double_vector ray(const view& s, real x, real y) {
  return {std::ldexp(real(s.step_x), -32) * (x - s.width_px / 2.0L), std::ldexp(real(s.step_y), -32) * (y - s.height_px / 2.0L), 1};
}
inline texture_point intersect(const kt88_plane& q, const view& s, real x, real y) {
  const double_vector r = ray(s, x, y);
  const real z = -std::ldexp(real(q.d), -16) / dot(value(q.normal, 30), r);
  const double_vector anchor = value(q.anchor, 16), p{r.x * z - anchor.x, r.y * z - anchor.y, z - anchor.z};
  return {dot(p, value(q.axis_u, 16)) + std::ldexp(real(q.u0), -16), dot(p, value(q.axis_v, 16)) + std::ldexp(real(q.v0), -16), z};
}

}  // namespace spantex::sim
