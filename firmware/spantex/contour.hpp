// SPDX-License-Identifier: Apache-2.0
// Filter `contour` (VR11, "contour textures"; docs/SPEC.md "Contours"): colours are interpolated as by `trilinear`; alpha is the coverage of a
// shape whose edge is where the map's alpha, a scalar field, crosses a threshold. The interpolated field is steepened in proportion to the texels
// per pixel across the contour, so the edge is a pixel wide and a line along it keeps its width on the screen at every magnification and tilt:
//
//   D = (field - threshold) / scale 2^-lambda                             pixels from the contour, positive inside
//   fill(D) = clamp(D + 1/2, 0, 1)                                        coverage of a half-plane by a box of one pixel
//   line(D) = fill(D + width / 2) - fill(D - width / 2)                   its integral across the contour is the width, thin lines included
//
// 2^lambda = |J^T d| / |d|: the field's screen gradient by the chain rule, J the Jacobian of the pixel, d the field's gradient on the map from the
// differences of the texels that are interpolated anyway. Only d's direction counts: the distance itself comes from the field and its scale, so
// that 8-bit texels disturb the width no more than the pixel's image is longer than wide. Where d is 0, lambda is that of the longer column of J.
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>
#include <spantex/exp2.hpp>
#include <spantex/coordinates.hpp>
#include <spantex/filter.hpp>
#include <spantex/jacobian.hpp>
#include <spantex/level.hpp>
#include <spantex/log2.hpp>
#include <spantex/plane.hpp>
#include <spantex/profile.hpp>
#include <spantex/span.hpp>

namespace spantex {

namespace detail {

inline constexpr int field_bits = 12;                      // fraction bits of the field
inline constexpr int32_t most_distance = 32 << 16;         // s5.16 pixels

// Field less threshold, s8.12.
constexpr int32_t centred_field(partial_colour f, uint32_t threshold, rounding mode) {
  const uint32_t value = f.bits > field_bits ? round_off(f.value, f.bits - field_bits, mode) : f.value << (field_bits - f.bits);
  return int32_t(value) - int32_t(threshold << (field_bits - 8));
}

// Coverage of a half-plane, u1.16.
constexpr int32_t filled(int32_t distance) { return clamp_to(distance + (1 << 15), 0, 1 << 16); }

}  // namespace detail

// Field of one pixel on its level, or of two levels; s9.12 with level_bits more. Below 2^29: 8 + 1 + 12 + 8 bits.
constexpr int32_t contour_field(partial_colour fine, partial_colour coarse, uint32_t fraction, const span_coefficients& c, const profile& q) {
  const int32_t one = 1 << q.level_bits, a = detail::centred_field(fine, c.contour.threshold, q.colour_rounding);
  if (!c.two_levels) return a * one;
  const int32_t b = detail::centred_field(coarse, c.contour.threshold, q.colour_rounding) * (c.contour.own_units ? 2 : 1);
  return a * (one - int32_t(fraction)) + b * int32_t(fraction);
}

// --- set-up side: the Jacobian as the datapath reads it, in c.axis ---------------------------------------
// W^2 times the columns of J, per half pixel in 2^-exponent texels: (du, dv)/dx = c + b hy, (du, dv)/dy = a - b hx (level.hpp); b is the twist.

// Of a span evaluated about its centre. All fit 31 bits: they are bounded as the numerators are.
constexpr void span_contour(const profile& q, span_coefficients& c) {
  const auto slope = [&](int32_t x, int32_t s) { return int32_t(detail::times_slope(x, s, q.reciprocal_bits)); };
  c.axis.c_u = c.a_u - slope(c.c_u, c.g);
  c.axis.c_v = c.a_v - slope(c.c_v, c.g);
  c.axis.a_u = c.b_u - slope(c.c_u, c.h);
  c.axis.a_v = c.b_v - slope(c.c_v, c.h);
  c.axis.b_u = slope(c.a_u, c.h) - slope(c.b_u, c.g);
  c.axis.b_v = slope(c.a_v, c.h) - slope(c.b_v, c.g);
  c.axis.exponent = c.exponent;
}

// Of a single pixel about its own centre.
constexpr void pixel_contour(const plane& p, int32_t hx, int32_t hy, span_coefficients& c) {
  const scaled_jacobian j = jacobian_at(p, hx, hy);
  c.axis.c_u = int32_t(j.columns.ux);
  c.axis.c_v = int32_t(j.columns.vx);
  c.axis.a_u = int32_t(j.columns.uy);
  c.axis.a_v = int32_t(j.columns.vy);
  c.axis.b_u = c.axis.b_v = 0;
  c.axis.exponent = int8_t(j.exponent);
}

// --- datapath side -------------------------------------------------------------------------------------

// The field's gradient on the map in any unit: only its direction counts.
struct field_gradient { int32_t u, v; };

// Of the surface that four_point() interpolates, at its position; below 2^(9 + subtexel_bits).
constexpr field_gradient gradient_of(texels2x2 t, weights w, int bits) {
  const int32_t one = 1 << bits, fu = int32_t(w.u), fv = int32_t(w.v);
  const int32_t top = int32_t(t.t10) - int32_t(t.t00), bottom = int32_t(t.t11) - int32_t(t.t01);
  const int32_t left = int32_t(t.t01) - int32_t(t.t00), right = int32_t(t.t11) - int32_t(t.t10);
  return {top * (one - fv) + bottom * fv, left * (one - fu) + right * fu};
}
constexpr field_gradient between_levels(field_gradient fine, field_gradient coarse, uint32_t fraction, int bits) {
  const int32_t f = int32_t(fraction), rest = (1 << bits) - f;
  return {fine.u * rest + coarse.u * f, fine.v * rest + coarse.v * f};
}

namespace detail {

inline constexpr int gradient_bits = 14, column_bits = 15;  // so that products of 32 bits do

constexpr int excess_bits(int64_t a, int64_t b, int bits) { return max_of(0, max_of(bit_length(magnitude(a)), bit_length(magnitude(b))) - bits); }
constexpr uint64_t squares(int32_t a, int32_t b) { return uint64_t(int64_t(a) * a) + uint64_t(int64_t(b) * b); }
constexpr int32_t half_log2(uint64_t square) { return square == 0 ? -(32 << 16) : log2_16(square) / 2; }

}  // namespace detail

// log2 of the texels of level 0 that a step of one pixel across the contour takes, s.16.
template <class Prof>
constexpr int32_t across_log2(const Prof& prof, const span_coefficients& c, field_gradient d, int i, int j) {
  const axis_terms& t = c.axis;
  const int32_t hx = half_pixels_x<Prof>(c, i), hy = half_pixels_y<Prof>(c, j);
  const jacobian m{t.c_u + t.b_u * hy, t.a_u - t.b_u * hx, t.c_v + t.b_v * hy, t.a_v - t.b_v * hx};
  const int drop = max_of(detail::excess_bits(m.ux, m.vx, detail::column_bits), detail::excess_bits(m.uy, m.vy, detail::column_bits));
  const auto cut = [drop](int64_t x) { return int32_t(shift_right_symmetric(x, drop)); };
  const int32_t ux = cut(m.ux), uy = cut(m.uy), vx = cut(m.vx), vy = cut(m.vy);
  const int gradient_drop = detail::excess_bits(d.u, d.v, detail::gradient_bits);
  d.u = int32_t(shift_right_symmetric(d.u, gradient_drop));
  d.v = int32_t(shift_right_symmetric(d.v, gradient_drop));
  const uint64_t length = detail::squares(d.u, d.v), x = detail::squares(ux, vx), y = detail::squares(uy, vy);
  int32_t across = length == 0 ? detail::half_log2(x > y ? x : y)
                               : detail::half_log2(detail::squares(d.u * ux + d.v * vx, d.u * uy + d.v * vy)) - detail::half_log2(length);
  across += (drop + 1 - t.exponent) * (1 << 16);
  if ((c.g | c.h) != 0) across -= 2 * (log2_16(w_at(prof, c, i, j)) - (prof.get().reciprocal_bits << 16));
  return across;
}

// log2 of the factor from field units to pixels, s.16, -32 to 15.
template <class Prof>
constexpr int32_t steepness_log2(const Prof& prof, const span_coefficients& c, field_gradient d, int i, int j) {
  const int32_t unit = c.contour.own_units ? int32_t(c.fine.level) << 16 : 0;
  return clamp_to(unit - across_log2(prof, c, d, i, j) - c.contour.scale_log2 * (1 << (16 - level_term_bits)), -32 * 65536, 15 * 65536);
}

// Pixels from the contour, s5.16, positive inside; cut to 32. The product with the factor's mantissa stays below 2^(29 + 17), up by at most 2 bits.
constexpr int32_t scaled_distance(int32_t field, int32_t log2, int level_bits) {
  const int64_t product = int64_t(field) * exp2_16(log2 & 0xFFFF);
  const int64_t distance = scale_down(product, detail::field_bits + level_bits - int(log2 >> 16));
  return int32_t(clamp_to(distance, -int64_t(detail::most_distance), int64_t(detail::most_distance)));
}
template <class Prof>
constexpr int32_t contour_distance(const Prof& prof, const span_coefficients& c, int32_t field, field_gradient d, int i, int j) {
  return scaled_distance(field, steepness_log2(prof, c, d, i, j), prof.get().level_bits);
}

// Coverage, 0..255 to nearest.
constexpr uint8_t contour_coverage(int32_t distance, uint8_t outline) {
  const int32_t half = outline * (1 << 11);  // 1/16 pixel, halved, in 2^-16
  const int32_t coverage = outline == 0 ? detail::filled(distance) : detail::filled(distance + half) - detail::filled(distance - half);
  return uint8_t((coverage * 255 + (1 << 15)) >> 16);
}

}  // namespace spantex
