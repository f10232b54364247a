// SPDX-License-Identifier: Apache-2.0
// Footprints: the pixel's image on the map as a row of samples (RDV15; METHODS section 3; docs/SPEC.md "Footprints").
//
// Set-up side: the direction on the screen that the span's centre maps to the ellipse's major axis, one of 32, and J times that
// direction as a linear form: W^2 J is linear on the screen (level.hpp), so for a fixed direction (c, s)
//   W^2 J (c, s) = c P + s Q + T (c hy - s hx),   P = a - c g, Q = b - c h, T = a h - b g at the centre.
// Datapath side, per pixel, from one log2 of w: the length of that vector, the pixel's area A / w^3, hence
//   level of the major axis  M = log2|n| - 2 log2 w,  ratio of the axes  R = M - (log2 A - 3 log2 w - M) = 2 log2|n| - log2 A - log2 w.
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>
#include <spantex/coordinates.hpp>
#include <spantex/exp2.hpp>
#include <spantex/filter.hpp>
#include <spantex/jacobian.hpp>
#include <spantex/level.hpp>
#include <spantex/log2.hpp>
#include <spantex/plane.hpp>
#include <spantex/profile.hpp>
#include <spantex/span.hpp>

namespace spantex {

inline constexpr int max_footprint_samples = 16;
inline constexpr int direction_count = 32;  // over half a turn
inline constexpr int direction_bits = 14;

// cos and sin of k pi/32, s1.14.
struct screen_direction {
  int32_t cos, sin;
};

namespace detail {

// cos(k pi/32), k = 0..16, s1.14 to nearest.
inline constexpr int16_t direction_cosines[17] = {16384, 16305, 16069, 15679, 15137, 14449, 13623, 12665, 11585,
                                                  10394, 9102,  7723,  6270,  4756,  3196,  1606,  0};

// tan of (2k + 1) pi/32, k = 0..3, u1.15 to nearest: between the directions of the doubled angle.
inline constexpr uint32_t direction_borders[4] = {3227, 9940, 17515, 26892};

}  // namespace detail

constexpr screen_direction direction_at(int k) {
  return {k <= 16 ? detail::direction_cosines[k] : -detail::direction_cosines[32 - k],
          detail::direction_cosines[k <= 16 ? 16 - k : k - 16]};
}

// The direction nearest to that of the largest stretch: half the angle of (|P|^2 - |Q|^2, 2 P.Q), P and Q the columns. Folded into one
// octant, so that a mirrored Jacobian gives the mirrored direction. 0 where all directions are alike.
constexpr int major_direction(jacobian j) {
  const int drop = max_of(0, max_of(max_of(bit_length(magnitude(j.ux)), bit_length(magnitude(j.uy))),
                                    max_of(bit_length(magnitude(j.vx)), bit_length(magnitude(j.vy)))) -
                                 30);
  const auto cut = [drop](int64_t x) { return shift_right_symmetric(x, drop); };
  const int64_t ux = cut(j.ux), uy = cut(j.uy), vx = cut(j.vx), vy = cut(j.vy);
  const int64_t across = ux * ux + vx * vx - uy * uy - vy * vy, twice = 2 * (ux * uy + vx * vy);
  uint64_t p = magnitude(across), q = magnitude(twice);
  const bool steep = q > p;
  if (steep) {
    const uint64_t t = p;
    p = q;
    q = t;
  }
  const int shift = max_of(0, bit_length(p) - 48);
  p >>= shift;
  q >>= shift;
  int k = 0;
  while (k < 4 && (q << 15) > p * detail::direction_borders[k]) ++k;  // 0..4: eighths of a quarter turn of the doubled angle
  if (steep) k = 8 - k;
  if (across < 0) k = 16 - k;
  return twice < 0 ? (direction_count - k) % direction_count : k;
}

namespace detail {

// log2 of |det J| per pixel, to s5.10. The elements are per half pixel in 2^-exponent texels.
constexpr int16_t area_log2(jacobian j, int exponent) {
  const int64_t determinant = j.ux * j.vy - j.uy * j.vx;
  return determinant == 0 ? level_term(-(32 << 16)) : level_term(log2_16(magnitude(determinant)) + 2 * (1 - exponent) * (1 << 16));
}

inline constexpr int max_axis_exponent = 60;

// The axis terms from the columns at the point, per half pixel in 2^-exponent texels, and from the twist. A vector of more than 2^14 texels
// per half pixel is cut to that: its level lies beyond the last one either way.
constexpr axis_terms axis_of(const profile& q, jacobian j, int64_t twist_u, int64_t twist_v, int exponent, int reach = spantex::reach) {
  const screen_direction d = direction_at(major_direction(j));
  const int64_t c_u = d.cos * j.ux + d.sin * j.uy, c_v = d.cos * j.vx + d.sin * j.vy;
  const int64_t a_u = -d.sin * twist_u, b_u = d.cos * twist_u, a_v = -d.sin * twist_v, b_v = d.cos * twist_v;
  const uint64_t reach_u = magnitude(c_u) + reach * (magnitude(a_u) + magnitude(b_u));
  const uint64_t reach_v = magnitude(c_v) + reach * (magnitude(a_v) + magnitude(b_v));
  const int bits = q.offset_bits - 1, given = exponent + direction_bits;
  const int fitting = given - max_of(0, bit_length(reach_u > reach_v ? reach_u : reach_v) - bits);
  const int kept = clamp_to(fitting, bits - 14, max_axis_exponent), drop = min_of(given - kept, 62);
  const int64_t most = (int64_t(1) << bits) - 1;
  const auto mantissa = [&](int64_t x) {
    if (x == 0) return int32_t(0);
    if (drop >= 0) return int32_t(clamp_to(shift_right_symmetric(x, drop), -most, most));
    const bool fits = bit_length(magnitude(x)) - drop <= bits;
    return int32_t(fits ? x * (int64_t(1) << -drop) : x < 0 ? -most : most);
  };
  return {mantissa(c_u),          mantissa(a_u), mantissa(b_u),
          mantissa(c_v),          mantissa(a_v), mantissa(b_v),
          area_log2(j, exponent), int8_t(kept),  0,
          max_footprint_samples,  false};
}

}  // namespace detail

// W^2 J about a span's centre over W0^2, per half pixel in 2^-exponent texels; the coordinate part is filled.
constexpr jacobian span_jacobian(const profile& q, const span_coefficients& c) {
  const auto slope = [&](int32_t x, int32_t s) { return detail::times_slope(x, s, q.reciprocal_bits); };
  return {c.a_u - slope(c.c_u, c.g), c.b_u - slope(c.c_u, c.h), c.a_v - slope(c.c_v, c.g), c.b_v - slope(c.c_v, c.h)};
}

constexpr void span_axis(const profile& q, span_coefficients& c) {
  const auto slope = [&](int32_t x, int32_t s) { return detail::times_slope(x, s, q.reciprocal_bits); };
  c.axis = detail::axis_of(q, span_jacobian(q, c), slope(c.a_u, c.h) - slope(c.b_u, c.g), slope(c.a_v, c.h) - slope(c.b_v, c.g), c.exponent,
                           reach + int(magnitude(c.from_x)));
}

// Of a single pixel about its own centre, from the plane's forms: W^2 J over W^2.
constexpr void pixel_axis(const scaled_jacobian& j, const profile& q, span_coefficients& c) { c.axis = detail::axis_of(q, j.columns, 0, 0, j.exponent); }
constexpr void pixel_axis(const plane& p, const profile& q, int32_t hx, int32_t hy, span_coefficients& c) { pixel_axis(jacobian_at(p, hx, hy), q, c); }

// --- datapath side -------------------------------------------------------------------------------------

struct footprint {
  coordinate u, v;  // the row's length and direction, texels of level 0
  int32_t level;    // 2^-level_bits; squares: whole
  int samples;      // 1 to max_footprint_samples
};

namespace detail {

// n / w^2 in s15.16 per pixel: two products with the reciprocal, each rounded, then the scale; saturated.
template <class Prof>
constexpr coordinate axis_at(const Prof& prof, const span_coefficients& c, offset_mantissa<Prof> n, uint32_t reciprocal) {
  const int bits = prof.get().reciprocal_bits;
  int64_t x = n.raw();
  if (c.how != evaluation::affine)
    for (int k = 0; k < 2; ++k) x = shift_right_symmetric(x * int64_t(reciprocal), bits);
  const int drop = c.axis.exponent - 17;
  x = drop >= 0 ? shift_right_symmetric(x, drop) : x * (int64_t(1) << -drop);
  return sat_to<coordinate>(s<47, 16>::from_raw(x));
}

// log2 of the vector's length per pixel at w = 1, s.16.
template <class Prof>
constexpr int32_t axis_log2(offset_mantissa<Prof> u, offset_mantissa<Prof> v, int exponent) {
  const uint64_t square = uint64_t(int64_t(u.raw()) * u.raw()) + uint64_t(int64_t(v.raw()) * v.raw());
  return square == 0 ? -(32 << 16) : log2_16(square) / 2 + (1 - exponent) * (1 << 16);
}

// Squares on either side of the centre so that the row of 2x2 squares is as long as 2^length_log2 texels of the level.
constexpr int squares_aside(int32_t length_log2) {
  const int32_t texels = int32_t(exp2_16(clamp_to(length_log2, -16 * 65536, 4 * 65536 + 65535)));
  return clamp_to((texels - 2 * 65536 + 4 * 65536 - 1) >> 18, 0, (max_footprint_samples - 1) / 2);
}

}  // namespace detail

// Of aniso, by log2 of the axes' ratio, s.16: a minor axis apart, what is beyond two of them 2^(sample_spacing / 16) (decisions/0011).
constexpr int samples_of(const profile& q, int32_t ratio) {
  const int32_t widths = int32_t(exp2_16(ratio)), near = min_of(widths, 2 << 16);
  const int32_t pitches = near + int32_t(int64_t(widths - near) * exp2_16(-q.sample_spacing * (1 << 12)) >> 16);
  return clamp_to((pitches + 65535 - (q.sample_slack << 12)) >> 16, 1, q.max_samples);
}

// Level of detail and number of samples from n = (u, v) and log2 w.
struct footprint_shape {
  int32_t level;  // 2^-level_bits; squares: whole
  int samples;
};

template <class Prof>
constexpr footprint_shape shape_of(const Prof& prof, const span_coefficients& c, offset_mantissa<Prof> u, offset_mantissa<Prof> v,
                                   int32_t log2_w) {
  const profile& q = prof.get();
  const int32_t length = detail::axis_log2<Prof>(u, v, c.axis.exponent), major = length - 2 * log2_w;
  const int32_t area = c.axis.area_log2 * (1 << (16 - level_term_bits));
  // Where the minor axis is magnified samples need not be closer than texels: major.
  const int32_t ratio = clamp_to(min_of(2 * length - area - log2_w, major), 0, log2_16(uint64_t(q.max_samples)));
  const int32_t minor = major - ratio;  // level 0 is no mean over texels, so not too wide yet: finer() comes in over the first level
  const int32_t detail_16 = finer(minor, c.kind == filter::aniso ? q.sample_bias : 0) + q.level_bias * (1 << 12);
  const int32_t level = clamp_to(shift_right(detail_16, 16 - q.level_bits), 0, int32_t(c.last_level) << q.level_bits);
  if (c.kind == filter::squares) {
    const int whole = integer_level(c.kind, level, q.level_bits, c.last_level);
    return {whole << q.level_bits, 2 * detail::squares_aside(major - whole * (1 << 16)) + 1};
  }
  return {level, samples_of(q, ratio)};
}

template <class Prof>
constexpr footprint footprint_at(const Prof& prof, const span_coefficients& c, int i, int j) {
  const axis_terms& t = c.axis;
  const auto u = numerator_at<Prof>(c, t.c_u, t.a_u, t.b_u, i, j), v = numerator_at<Prof>(c, t.c_v, t.a_v, t.b_v, i, j);
  const int bits = prof.get().reciprocal_bits;
  const int32_t log2_w = (c.g | c.h) != 0 ? log2_16(w_at(prof, c, i, j)) - (bits << 16) : 0;
  const uint32_t reciprocal = reciprocal_at(prof, c, i, j);
  const footprint_shape s = shape_of(prof, c, u, v, log2_w);
  return {detail::axis_at(prof, c, u, reciprocal), detail::axis_at(prof, c, v, reciprocal), s.level, s.samples};
}

// At the span's reference point.
template <class Prof>
constexpr int32_t footprint_level(const Prof& prof, const span_coefficients& c) {
  using mantissa = offset_mantissa<Prof>;
  return shape_of(prof, c, mantissa::from_raw(c.axis.c_u), mantissa::from_raw(c.axis.c_v), 0).level;
}

// From the footprint's centre to sample k along one axis: length (2k + 1 - n) / 2n.
constexpr coordinate sample_offset(coordinate length, int k, int n) {
  const int32_t step = (65536 + n) / (2 * n);  // 1/2n, u0.16
  return coordinate::from_raw(int32_t(shift_right_symmetric(int64_t(length.raw()) * ((2 * k + 1 - n) * step), 16)));
}

constexpr texel_position sample_position(texel_position centre, const footprint& f, int k) {
  return {sat_to<coordinate>(centre.u + sample_offset(f.u, k, f.samples)), sat_to<coordinate>(centre.v + sample_offset(f.v, k, f.samples))};
}

// RDV15's row: square k of n relative to the centre one, whole texels, and the weights of its texels in the order of texels2x2, out of 20.
struct square {
  int32_t u, v;
  uint8_t weight[4];
  int row_weight;  // falls with the distance from the centre by one a square, from (n - 1)/2 + 3: 3 4 3 for three squares
};

constexpr square square_at(const footprint& f, weights fraction, int subtexel_bits, int k) {
  const int aside = (f.samples - 1) / 2, index = k - aside, distance = index < 0 ? -index : index;
  const int row_weight = aside + 3 - distance;
  if (index == 0) return {0, 0, {5, 5, 5, 5}, row_weight};
  const uint64_t along_u = magnitude(f.u.raw()), along_v = magnitude(f.v.raw());
  // Within 22.5 degrees of an axis: tan 22.5 = 13573/32768.
  const bool flat = along_v * 32768 < along_u * 13573, steep = along_u * 32768 < along_v * 13573;
  if (flat) {
    return index > 0 ? square{2 * index, 0, {6, 4, 6, 4}, row_weight} : square{2 * index, 0, {4, 6, 4, 6}, row_weight};
  }
  if (steep) {
    return index > 0 ? square{0, 2 * index, {6, 6, 4, 4}, row_weight} : square{0, 2 * index, {4, 4, 6, 6}, row_weight};
  }
  // Diagonal: by (1, 2) or (2, 1) for the first square on each side, alternating, so that the row keeps to the diagonal.
  const bool high = 2 * fraction.u > 1u << subtexel_bits;
  const int even = distance / 2, odd = distance - even;
  const int32_t u = high ? odd + 2 * even : 2 * odd + even, v = high ? 2 * odd + even : odd + 2 * even;
  const bool falling = (f.u.raw() < 0) != (f.v.raw() < 0), right = index > 0, down = right != falling;
  const int nearest = (right ? 0 : 1) + (down ? 0 : 2);
  square s{right ? u : -u, down ? v : -v, {5, 5, 5, 5}, row_weight};
  s.weight[nearest] = 6;
  s.weight[3 - nearest] = 4;
  return s;
}

}  // namespace spantex
