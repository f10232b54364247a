// SPDX-License-Identifier: Apache-2.0
// Planes: u = Nu/W, v = Nv/W with Nu, Nv, W linear on the screen (KT88; METHODS section 1).
//
// Screen positions are in half pixels, so that pixel centres and span centres are both whole numbers: pixel (i, j) has its
// centre at (2i+1, 2j+1), the centre of span (I, J) lies at (16I+8, 16J+8). Coefficients are integers with one
// common scale: |Nu|, |Nv| < 2^59 and |W| < 2^45 over the plane's region (plus at most 2^13 by rounding). What that rounding dropped is kept
// beside them, for spans where it would show (coordinates.hpp).
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>
#include <spantex/fixed.hpp>
#include <spantex/log2.hpp>
#include <spantex/status.hpp>
#include <spantex/wide.hpp>

namespace spantex {

inline constexpr int max_screen_px = 4096;

// Half-open rectangle of pixels.
struct rectangle {
  int32_t x0, y0, x1, y1;
  constexpr bool empty() const { return x0 >= x1 || y0 >= y1; }
  friend constexpr bool operator==(const rectangle&, const rectangle&) = default;
};

// Not empty, and within the largest screen.
constexpr bool on_screen(rectangle r) {
  return !r.empty() && r.x0 >= 0 && r.y0 >= 0 && r.x1 <= max_screen_px && r.y1 <= max_screen_px;
}

constexpr rectangle intersection(rectangle a, rectangle b) {
  return {max_of(a.x0, b.x0), max_of(a.y0, b.y0), min_of(a.x1, b.x1), min_of(a.y1, b.y1)};
}

// value(hx, hy) = c + x (hx - origin_x) + y (hy - origin_y)
struct linear_form {
  int64_t x, y, c;
  friend constexpr bool operator==(const linear_form&, const linear_form&) = default;
};

// The same of 128 bits.
struct wide_form {
  wide x, y, c;
  friend constexpr bool operator==(const wide_form&, const wide_form&) = default;
};

struct plane {
  linear_form u, v, w;
  int32_t origin_x, origin_y;  // half pixels
  int32_t major_log2;          // KT88's log2 K in the scale of w, s15.16: level = major_log2 - 2 log2 W
  int32_t minor_log2 = 0;      // likewise log2 K': level of the minor axis = minor_log2 - log2 W
  wide_form exact_u{}, exact_v{}, exact_w{};  // the forms before they were rounded, 2^dropped_bits times theirs; if any bits were dropped
  int16_t dropped_bits = 0;                   // 0 or less: u, v, w are exact
  int16_t rounding_bits = 0;                  // within the region and 16 pixels around a form is off by less than 2^(rounding_bits - 1) units

  constexpr int64_t value(const linear_form& f, int32_t hx, int32_t hy) const {
    return f.c + multiply_by_32(f.x, hx - origin_x) + multiply_by_32(f.y, hy - origin_y);
  }
  constexpr wide value(const wide_form& f, int32_t hx, int32_t hy) const {
    return f.c + multiply(f.x, hx - origin_x) + multiply(f.y, hy - origin_y);
  }
  constexpr int64_t u_at(int32_t hx, int32_t hy) const { return value(u, hx, hy); }
  constexpr int64_t v_at(int32_t hx, int32_t hy) const { return value(v, hx, hy); }
  constexpr int64_t w_at(int32_t hx, int32_t hy) const { return value(w, hx, hy); }
  friend constexpr bool operator==(const plane&, const plane&) = default;
};

// Homogeneous coefficients before normalisation: u = (a x + b y + c)/(g x + h y + i), v = (d x + e y + f)/(...), x and y in
// pixels, origin top left. Only ratios matter, and the sign: a point is in front where g x + h y + i > 0. |c|, |f|, |i| < 2^122, the others
// < 2^110.
struct homography {
  wide a, b, c, d, e, f, g, h, i;
};

namespace detail {

// From pixels to half pixels about (ox, oy): x and y stay, c doubles and moves.
SPANTEX_FRAME_APART constexpr void move_origin(wide_form& f, int32_t ox, int32_t oy) {
  f.c = f.c + f.c;
  add_product(f.c, f.x, ox);
  add_product(f.c, f.y, oy);
}

// Bits of the largest |value| within rx, ry half pixels of the origin (a bound: the sum of the magnitudes).
SPANTEX_FRAME_APART constexpr int bound_bits(const wide_form& f, int32_t rx, int32_t ry) {
  wide sum = magnitude(f.c);
  add_product(sum, magnitude(f.x), rx);
  add_product(sum, magnitude(f.y), ry);
  return bit_length(sum);
}

SPANTEX_FRAME_APART constexpr int64_t narrowed(const wide& a, int drop) { return to_int64(scale_down(a, drop)); }
constexpr linear_form narrowed(const wide_form& f, int drop) { return {narrowed(f.x, drop), narrowed(f.y, drop), narrowed(f.c, drop)}; }

// a b - c d
SPANTEX_FRAME_MERGED constexpr void set_difference(wide& out, int64_t a, int64_t b, int64_t c, int64_t d) {
  out = {};
  add_product(out, a, b);
  add_product(out, -c, d);
}

}  // namespace detail

// W^2 d(u, v)/dx and W^2 d(u, v)/dy per half pixel at a point, in the plane's scale: W^2 du/dx = A W - Nu G, exact in 128 bits, whatever
// the size of u; then the magnitudes cut to 31 bits of the largest of the four. value 2^drop.
struct scaled_gradients {
  int32_t ux, uy, vx, vy;
  int drop;
};
inline constexpr int gradient_bits = 31;  // of a magnitude

// The four, each cut by itself: value 2^dropped. 0 du/dx, 1 du/dy, 2 dv/dx, 3 dv/dy: those by x depend on the row alone, those by y on the column.
struct cut_gradients {
  int32_t value[4];
  int8_t dropped[4];
};
// One of them, W given.
constexpr void cut_gradient(const plane& p, int k, int64_t w, int32_t hx, int32_t hy, cut_gradients& out) {
  const linear_form& f = k < 2 ? p.u : p.v;
  wide exact;
  detail::set_difference(exact, (k & 1) != 0 ? f.y : f.x, w, p.value(f, hx, hy), (k & 1) != 0 ? p.w.y : p.w.x);
  const uint64_t sign = sign_of(exact.high);
  negate_if(exact, sign);
  const int bits = max_of(gradient_bits, bit_length(exact));
  out.value[k] = (int32_t(low_after(exact, bits - gradient_bits)) ^ int32_t(sign)) - int32_t(sign);
  out.dropped[k] = int8_t(bits - gradient_bits);
}
constexpr scaled_gradients on_one_scale(const cut_gradients& g) {
  int drop = 0;
  for (int k = 0; k < 4; ++k) drop = max_of(drop, int(g.dropped[k]));
  const auto alike = [&](int k) {
    const int more = min_of(drop - g.dropped[k], gradient_bits), sign = g.value[k] >> 31;
    return (((g.value[k] ^ sign) - sign) >> more ^ sign) - sign;
  };
  return {alike(0), alike(1), alike(2), alike(3), drop};
}
constexpr scaled_gradients scaled_gradients_at(const plane& p, int32_t hx, int32_t hy) {
  const int64_t w = p.w_at(hx, hy);
  cut_gradients g;
  for (int k = 0; k < 4; ++k) cut_gradient(p, k, w, hx, hy, g);
  return on_one_scale(g);
}

// log2 of the lengths of the two columns, s.16; minus 100 for zero.
struct gradient_logs { int32_t x, y; };
constexpr gradient_logs gradient_logs_of(const scaled_gradients& g) {
  const auto half_log2 = [&g](int64_t u, int64_t v) {
    const uint64_t s = uint64_t(u * u) + uint64_t(v * v);
    return s == 0 ? -(100 << 16) : log2_16(s) / 2 + (g.drop << 16);
  };
  return {half_log2(g.ux, g.vx), half_log2(g.uy, g.vy)};
}
constexpr gradient_logs gradient_logs_at(const plane& p, int32_t hx, int32_t hy) { return gradient_logs_of(scaled_gradients_at(p, hx, hy)); }

// log2 of KT88's K such that K/W^2 is twice the longer column of the Jacobian (per pixel) at a point where W > 0. For a plane seen by
// KT88's camera K = 2 T Delta d is the same everywhere; for any other the formula is anchored at this point.
constexpr int32_t major_log2_at(const plane& p, int32_t hx, int32_t hy) {
  const gradient_logs g = gradient_logs_at(p, hx, hy);
  return max_of(g.x, g.y) + (2 << 16);
}

namespace detail {

// |det| of the plane's nine coefficients, in units of 2^drop. The 2x2 minors of the rows u, v are exact (114 bits); cut to 79 of the largest they meet 45 bits
// of w in 126. Error: three cuts of 2^-78 of the largest product, which only a plane that is edge-on to 2^-50 can feel, and its minor axis is none.
SPANTEX_FRAME_APART constexpr int set_determinant(const plane& p, wide& det) {
  wide minors[3];
  set_difference(minors[0], p.u.y, p.v.c, p.u.c, p.v.y);
  set_difference(minors[1], p.u.c, p.v.x, p.u.x, p.v.c);
  set_difference(minors[2], p.u.x, p.v.y, p.u.y, p.v.x);
  int bits = 79;
  for (const wide& m : minors) bits = max_of(bits, bit_length(m));
  det = {};
  for (int k = 0; k < 3; ++k) {
    round_off(minors[k], bits - 79);
    add_product(det, minors[k], k == 0 ? p.w.x : k == 1 ? p.w.y : p.w.c);
  }
  negate_if(det, sign_of(det.high));
  return bits - 79;
}

// log2 of that, s.16; minus 200 for zero.
SPANTEX_FRAME_APART constexpr int32_t determinant_log2(const plane& p) {
  wide det;
  const int drop = set_determinant(p, det);
  if (det.zero()) return -(200 << 16);
  const int cut = max_of(0, bit_length(det) - 62);
  return log2_16(low_after(det, cut)) + ((cut + drop) << 16);
}

}  // namespace detail

// log2 of KT88's K' of the minor axis. The Jacobian's determinant of a homography is |det M| / W^3, so the circle of diameter two pixel
// intervals has an image whose axes multiply to 4 |det M| / W^3 (16 in half pixels); divided by the major axis K / W^2 that is K' / W.
constexpr int32_t minor_log2_of(const plane& p) { return detail::determinant_log2(p) + (4 << 16) - p.major_log2; }

namespace detail {

// By number: u, v, w.
constexpr wide_form& exact_form(plane& p, int k) { return k == 0 ? p.exact_u : k == 1 ? p.exact_v : p.exact_w; }
constexpr linear_form& rounded_form(plane& p, int k) { return k == 0 ? p.u : k == 1 ? p.v : p.w; }

// The forms about the region's middle, and what fits of them; `drop` (may be negative): W of the plane = 2 W of the homography / 2^drop.
SPANTEX_FRAME_APART constexpr status narrow_forms(const rectangle& region, plane& p, int& drop) {
  p.origin_x = region.x0 + region.x1;
  p.origin_y = region.y0 + region.y1;
  // Spans are evaluated at their centres, which may lie 8 pixels outside the region.
  const int32_t rx = region.x1 - region.x0 + 32, ry = region.y1 - region.y0 + 32;
  int bits[3] = {};
  for (int k = 0; k < 3; ++k) {
    move_origin(exact_form(p, k), p.origin_x, p.origin_y);
    bits[k] = bound_bits(exact_form(p, k), rx, ry);
  }
  if (bits[2] == 0) return status::degenerate;
  drop = max_of(max_of(bits[0], bits[1]) - 59, bits[2] - 45);
  for (int k = 0; k < 3; ++k) {
    rounded_form(p, k) = narrowed(exact_form(p, k), drop);
    if (drop <= 0) exact_form(p, k) = {};
  }
  p.dropped_bits = int16_t(max_of(drop, 0));
  p.rounding_bits = drop > 0 ? int16_t(bit_length(uint64_t(rx + ry + 1))) : int16_t(0);  // three coefficients, half a unit each
  return status::ok;
}

// A point in front of the viewer: the region's middle or else its nearest corner (largest W). False if there is none.
constexpr bool find_front(const rectangle& region, const plane& p, int32_t& hx, int32_t& hy) {
  hx = p.origin_x;
  hy = p.origin_y;
  if (p.w_at(hx, hy) > 0) return true;
  hx = p.w.x > 0 ? 2 * region.x1 - 1 : 2 * region.x0 + 1;
  hy = p.w.y > 0 ? 2 * region.y1 - 1 : 2 * region.y0 + 1;
  return p.w_at(hx, hy) > 0;
}
// log2 K there. Errors: degenerate.
SPANTEX_FRAME_APART constexpr status set_major_log2(const rectangle& region, plane& p) {
  int32_t hx = 0, hy = 0;
  if (!find_front(region, p, hx, hy)) return status::degenerate;
  p.major_log2 = major_log2_at(p, hx, hy);
  return status::ok;
}

// The plane of the homography whose rows are its exact forms, in the plane itself: set-up takes no other memory to speak of.
SPANTEX_FRAME_MERGED constexpr status normalise(const rectangle& region, plane& p, int& drop) {
  if (!on_screen(region)) return status::bad_size;
  SPANTEX_TRY(narrow_forms(region, p, drop));
  SPANTEX_TRY(set_major_log2(region, p));
  p.minor_log2 = minor_log2_of(p);
  return status::ok;
}
SPANTEX_FRAME_MERGED constexpr status normalise(const rectangle& region, plane& p) {
  int drop = 0;
  return normalise(region, p, drop);
}

// Rows as exact forms, one coefficient after the other.
SPANTEX_FRAME_APART constexpr void hold(const homography& m, plane& out) {
  out.exact_u.x = m.a;
  out.exact_u.y = m.b;
  out.exact_u.c = m.c;
  out.exact_v.x = m.d;
  out.exact_v.y = m.e;
  out.exact_v.c = m.f;
  out.exact_w.x = m.g;
  out.exact_w.y = m.h;
  out.exact_w.c = m.i;
}
constexpr status normalise(const homography& m, const rectangle& region, plane& out, int& drop) {
  hold(m, out);
  return normalise(region, out, drop);
}

}  // namespace detail

// Normalises a homography for use within `region` (pixels). Errors: degenerate if W is zero everywhere or not positive where it
// is largest in the region; bad_size if the region is empty or leaves the screen limits; what is left in `out` then is undefined.
// Rounding: every coefficient once, to nearest, at 2^-59 of the largest numerator or 2^-45 of the largest divisor; the exact ones are kept.
constexpr status make_plane(const homography& m, rectangle region, plane& out) {
  int drop = 0;
  return detail::normalise(m, region, out, drop);
}

// KT88's plane (METHODS section 1): camera at the origin looking along +Z, plane N.P + d = 0, texture axes U and V on it,
// anchor P0 with texture coordinates (u0, v0). Lengths s15.16; N is a unit vector s1.30; U and V are unit vectors times
// the texels per unit of length, s15.16; the pixel steps dx = (2/M) tan(alpha/2), dy = (2/N) tan(beta/2) are u0.32.
struct vector3 { int32_t x, y, z; };
struct kt88_plane {
  vector3 normal;      // s1.30
  int32_t d;           // s15.16
  vector3 axis_u, axis_v;  // s15.16
  vector3 anchor;      // s15.16
  int32_t u0, v0;      // s15.16, texels
};
struct view {
  uint32_t step_x, step_y;  // u0.32: ray slope per pixel
  int32_t width_px, height_px;  // 1..4096
};

namespace detail {

constexpr wide dot(const vector3& a, const vector3& b) {
  return multiply(a.x, b.x) + multiply(a.y, b.y) + multiply(a.z, b.z);
}

inline constexpr int camera_bits = 40;  // fraction bits of U'k, V'k, Nk below

// U'k = Nk U0' - d Uk with U0' = u0 - P0.U: exact in 62 fraction bits, then rounded to camera_bits.
SPANTEX_FRAME_APART constexpr void set_component(wide& out, const wide& offset, int32_t n, int32_t d, int32_t a) {
  out = multiply(offset, n) - shift_left(multiply(d, a), 30);
  round_off(out, 62 - camera_bits);
}
SPANTEX_FRAME_APART constexpr void set_numerator(wide_form& out, const kt88_plane& q, const vector3& axis, int32_t t0) {
  const wide offset = shift_left(wide(t0), 16) - dot(q.anchor, axis);       // s33.32
  set_component(out.x, offset, q.normal.x, q.d, axis.x);
  set_component(out.y, offset, q.normal.y, q.d, axis.y);
  set_component(out.c, offset, q.normal.z, q.d, axis.z);
}

// A coefficient triple on rays r = (dx X0, dy Y0, 1), X0 = x - M/2: to pixels from the top left. Gains 33 fraction bits.
SPANTEX_FRAME_APART constexpr void put_on_screen(wide_form& k, const view& s) {
  k.x = multiply(k.x, int64_t(s.step_x));
  k.y = multiply(k.y, int64_t(s.step_y));
  k.c = shift_left(k.c, 33) - multiply(k.x, s.width_px);
  k.c = k.c - multiply(k.y, s.height_px);
  k.x = k.x + k.x;
  k.y = k.y + k.y;
}

// log2(2 T Delta d), 16 fraction bits: T the texels per unit of length (squared, 32 fraction bits), Delta the larger pixel step.
constexpr int32_t log2_major(uint64_t t, int32_t d, const view& s) {
  const uint32_t step = s.step_x > s.step_y ? s.step_x : s.step_y;
  if (t == 0 || step == 0) return -(100 << 16);
  return ((log2_16(t) - (32 << 16)) / 2) + (log2_16(step) - (32 << 16)) + (log2_16(magnitude(d)) - (16 << 16)) + (1 << 16);
}

// With the longer of the texture axes.
constexpr int32_t log2_major(const kt88_plane& q, const view& s) {
  const auto squared = [](const vector3& a) {
    const auto square = [](int32_t x) { return uint64_t(int64_t(x) * x); };
    return square(a.x) + square(a.y) + square(a.z);                         // 32 fraction bits, below 2^64
  };
  const uint64_t tu = squared(q.axis_u), tv = squared(q.axis_v);
  return log2_major(tu > tv ? tu : tv, q.d, s);
}

// A plane at a signed distance d from a camera, from rows of camera_bits on its rays, held as the plane's exact forms.
struct seen_from { int32_t d, log2_k; };
constexpr status seen_plane(seen_from from, const view& s, plane& out) {
  for (int k = 0; k < 3; ++k) {
    wide_form& row = exact_form(out, k);
    put_on_screen(row, s);
    // A ray meets the plane in front of the viewer where -d/W > 0: with d > 0 every sign turns.
    const uint64_t turned = from.d > 0 ? ~uint64_t(0) : 0;
    negate_if(row.x, turned);
    negate_if(row.y, turned);
    negate_if(row.c, turned);
  }
  int drop = 0;
  SPANTEX_TRY(normalise({0, 0, s.width_px, s.height_px}, out, drop));
  // The plane's W carries camera_bits + 33 + 1 - drop fraction bits.
  out.major_log2 = from.log2_k + 2 * ((camera_bits + 34 - drop) << 16);
  out.minor_log2 = minor_log2_of(out);
  return status::ok;
}

}  // namespace detail

// Errors: degenerate (d = 0, or nothing in front of the viewer), bad_size; `out` is undefined then.
constexpr status make_plane(const kt88_plane& q, const view& s, plane& out) {
  if (q.d == 0) return status::degenerate;
  const auto normal = [](int32_t n) { return shift_left(wide(n), detail::camera_bits - 30); };
  detail::set_numerator(out.exact_u, q, q.axis_u, q.u0);
  detail::set_numerator(out.exact_v, q, q.axis_v, q.v0);
  out.exact_w = {normal(q.normal.x), normal(q.normal.y), normal(q.normal.z)};
  return detail::seen_plane({q.d, detail::log2_major(q, s)}, s, out);
}

}  // namespace spantex
