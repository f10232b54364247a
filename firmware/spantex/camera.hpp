// SPDX-License-Identifier: Apache-2.0
// A camera given by roll, pitch and yaw above (or below) a textured ground plane (GCK09; derivation in docs/METHODS.md, "Camera by angles").
//
// World axes X ahead, Y up, Z right; the map lies on Y = 0 with u along X and v along Z. Camera axes U ahead, V up, W right, turned from
// the world's by R = Ry(yaw) Rz(pitch) Rx(roll): roll about X lifts the right side's V towards W, pitch about Z raises the view, yaw about Y turns it
// towards -Z. The screen lies at U = 1: x grows along W, y downwards against V, its middle on the U axis.
//
// Angles are binary: u0.32 of a turn, so that they wrap as angles do. Errors: sine and cosine within 1.4 units of s1.30 (no more than 0.9 found),
// entries of R, sums of a product of two and one of three of them, within 2^-27.
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>
#include <spantex/plane.hpp>
#include <spantex/status.hpp>
#include <spantex/wide.hpp>

namespace spantex {

struct binary_angle { uint32_t turn; };  // u0.32: 2^30 is a right angle

struct sine_cosine { int32_t sine, cosine; };  // s1.30

namespace detail {

// Product of two u0.32, to nearest; below 1 for factors below 1.
constexpr uint32_t times_fraction(uint32_t a, uint32_t b) { return uint32_t((uint64_t(a) * b + (uint64_t(1) << 31)) >> 32); }

// Taylor series about 0 in nested form, 0 <= x <= pi/4 as u0.32; x^13/13! < 2^-37 and x^14/14! < 2^-41 are left out. In units of 2^-32 a step adds
// at most 0.9 (its quotient) + 0.5 (its product) + 1 (its one) to x^2/n times the error of the step inside: 2.7 for n >= 6, 3.4 for the
// cosine's n = 2; the sine's last product makes 3.1.
consteval uint32_t inverse_of(uint32_t n) { return uint32_t(((uint64_t(1) << 32) + n / 2) / n); }
constexpr uint32_t one_less(uint32_t x) { return 0xFFFFFFFFu - x; }  // 1 - x, u0.32; 1 is 2^-32 short
constexpr uint32_t series_step(uint32_t square, uint32_t over_n, uint32_t inner) { return one_less(times_fraction(times_fraction(square, over_n), inner)); }

constexpr uint32_t small_sine(uint32_t x) {
  const uint32_t square = times_fraction(x, x);
  uint32_t y = series_step(square, inverse_of(110), 0xFFFFFFFFu);
  y = series_step(square, inverse_of(72), y);
  y = series_step(square, inverse_of(42), y);
  y = series_step(square, inverse_of(20), y);
  y = series_step(square, inverse_of(6), y);
  return times_fraction(x, y);
}

constexpr uint32_t small_cosine(uint32_t x) {
  const uint32_t square = times_fraction(x, x);
  uint32_t y = series_step(square, inverse_of(132), 0xFFFFFFFFu);
  y = series_step(square, inverse_of(90), y);
  y = series_step(square, inverse_of(56), y);
  y = series_step(square, inverse_of(30), y);
  y = series_step(square, inverse_of(12), y);
  return series_step(square, inverse_of(2), y);
}

// u0.32 to s1.30 to nearest: 1 - 2^-32 becomes 1.
constexpr int32_t to_s1_30(uint32_t x) { return int32_t((uint64_t(x) + 2) >> 2); }

// Of 0 <= t < 1/4 turn, u0.32; beyond 1/8 as the complement.
constexpr sine_cosine first_quadrant(uint32_t t) {
  constexpr uint32_t eighth = uint32_t(1) << 29;
  const bool beyond = t > eighth;
  const uint32_t part = beyond ? 2 * eighth - t : t;
  // Radians: part 2 pi; 2 pi as u3.29.
  constexpr uint64_t two_pi = 3373259426u;
  const uint32_t x = uint32_t((part * two_pi + (uint64_t(1) << 28)) >> 29);
  const int32_t s = to_s1_30(small_sine(x)), c = to_s1_30(small_cosine(x));
  return beyond ? sine_cosine{c, s} : sine_cosine{s, c};
}

}  // namespace detail

SPANTEX_FRAME_APART constexpr sine_cosine sine_cosine_of(binary_angle a) {
  const sine_cosine q = detail::first_quadrant(a.turn & 0x3FFFFFFFu);
  switch (a.turn >> 30) {
    case 0: return q;
    case 1: return {q.cosine, -q.sine};
    case 2: return {-q.sine, -q.cosine};
    default: return {-q.cosine, q.sine};
  }
}

// Where the camera stands, s15.16, which way it looks, and the map's scale, texels per unit of length, s15.16.
struct attitude_camera {
  binary_angle roll, pitch, yaw;
  vector3 position;
  int32_t texels_per_unit;
};

namespace detail {

// a b + c d e, s1.30 each: exact in 60 and 90 fraction bits, then rounded once.
SPANTEX_FRAME_APART constexpr int64_t attitude_entry(int32_t a, int32_t b, int32_t c, int32_t d, int32_t e) {
  wide sum = shift_left(multiply(a, b), 30);
  add_product(sum, int64_t(c) * d, e);
  round_off(sum, 90 - camera_bits);
  return to_int64(sum);
}

// World from camera: the world's axes along the camera's, x: U, y: V, c: W, camera_bits fraction bits.
SPANTEX_FRAME_APART constexpr void set_attitude(binary_angle roll, binary_angle pitch, binary_angle yaw, linear_form& x, linear_form& y, linear_form& z) {
  const sine_cosine g = sine_cosine_of(roll), t = sine_cosine_of(pitch), h = sine_cosine_of(yaw);
  const auto entry = attitude_entry;
  const auto one = [](int32_t a) { return int64_t(a) * (int64_t(1) << (camera_bits - 30)); };
  x.x = entry(t.cosine, h.cosine, 0, 0, 0);
  x.y = entry(g.sine, h.sine, -g.cosine, h.cosine, t.sine);
  x.c = entry(g.cosine, h.sine, g.sine, h.cosine, t.sine);
  y.x = one(t.sine);
  y.y = entry(g.cosine, t.cosine, 0, 0, 0);
  y.c = entry(-g.sine, t.cosine, 0, 0, 0);
  z.x = entry(-t.cosine, h.sine, 0, 0, 0);
  z.y = entry(g.sine, h.cosine, g.cosine, h.sine, t.sine);
  z.c = entry(g.cosine, h.cosine, -g.sine, h.sine, t.sine);
}

}  // namespace detail

// World from camera: columns are the camera's axes, camera_bits fraction bits.
struct attitude {
  int64_t xu, xv, xw, yu, yv, yw, zu, zv, zw;
};
constexpr attitude attitude_of(binary_angle roll, binary_angle pitch, binary_angle yaw) {
  linear_form x{}, y{}, z{};
  detail::set_attitude(roll, pitch, yaw, x, y, z);
  return {x.x, x.y, x.c, y.x, y.y, y.c, z.x, z.y, z.c};
}

namespace detail {

// T (h Ry - y_h R): numerator of a texture coordinate on the camera's axes, below 2^74; one rounding at 2^-camera_bits.
struct ground { int32_t height, texels_per_unit; };
SPANTEX_FRAME_APART constexpr void set_ground_numerator(wide& out, const ground& g, int32_t along, int64_t r, int64_t ry) {
  wide difference;
  set_difference(difference, ry, along, r, g.height);
  out = {};
  add_product(out, difference, g.texels_per_unit);
  round_off(out, 32);
}

}  // namespace detail

// The ground as the camera sees it: u = T X, v = T Z where the pixel's ray meets Y = 0. Errors: degenerate (camera on the ground, no texels, or no
// ground in view), bad_size (of the view); `out` is undefined then.
constexpr status make_plane(const attitude_camera& a, const view& s, plane& out) {
  if (a.position.y == 0 || a.texels_per_unit == 0) return status::degenerate;
  detail::set_attitude(a.roll, a.pitch, a.yaw, out.u, out.v, out.w);  // the plane's memory serves for the rotation
  // Rays are (x, y, 1) on the axes W, -V, U.
  const linear_form &x = out.u, &y = out.v, &z = out.w;
  const auto set_row = [&](wide_form& row, int32_t along, const linear_form& r) {
    const detail::ground g{a.position.y, a.texels_per_unit};
    detail::set_ground_numerator(row.x, g, along, r.c, y.c);
    detail::set_ground_numerator(row.y, g, along, -r.y, -y.y);
    detail::set_ground_numerator(row.c, g, along, r.x, y.x);
  };
  set_row(out.exact_u, a.position.x, x);
  set_row(out.exact_v, a.position.z, z);
  out.exact_w = {wide(y.c), wide(-y.y), wide(y.x)};
  return detail::seen_plane({a.position.y, detail::log2_major(uint64_t(int64_t(a.texels_per_unit) * a.texels_per_unit), a.position.y, s)}, s, out);
}

}  // namespace spantex
