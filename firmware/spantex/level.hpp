// SPDX-License-Identifier: Apache-2.0
// Level of detail (KT88, METHODS section 1; docs/SPEC.md "Level of detail").
//
// For a plane, W^2 du/dx depends on the row only and W^2 du/dy on the column only (exact algebra), so
//   level(i, j) = max(row[j], column[i]) - 2 log2 w(i, j)
// holds for Vulkan's rho (the longer column of the Jacobian), and with row = column = constant for KT88's major axis; for KT88's minor
// axis with log2 w once instead of twice. One log2 w serves them all.
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>
#include <spantex/coordinates.hpp>
#include <spantex/log2.hpp>
#include <spantex/profile.hpp>
#include <spantex/span.hpp>

namespace spantex {

inline constexpr int level_term_bits = 10;

namespace detail {

// s.16 to the s5.10 of the coefficient memory.
constexpr int16_t level_term(int32_t level_16) {
  return int16_t(clamp_to(shift_right(level_16, 16 - level_term_bits), int32_t(-32) * 1024, int32_t(32) * 1024 - 1));
}

// log2 of the length of (du, dv) 2^-exponent per half pixel, per pixel; minus infinity becomes -32.
constexpr int16_t log2_length(int64_t du, int64_t dv, int exponent) {
  const uint64_t square = uint64_t(du * du) + uint64_t(dv * dv);
  if (square == 0) return level_term(-(32 << 16));
  return level_term(log2_16(square) / 2 + (1 - exponent) * (1 << 16));
}

// x times a slope with `bits` fraction bits.
constexpr int64_t times_slope(int32_t x, int32_t slope, int bits) { return shift_right_symmetric(int64_t(x) * slope, bits); }

constexpr void fill(int16_t (&row)[span_side], int16_t value) {
  for (int k = 0; k < span_side; ++k) row[k] = value;
}

}  // namespace detail

// Terms of a span evaluated about its centre.
//   w^2 du/dx = (a - c g) + (a h - b g) hy,  w^2 du/dy = (b - c h) - (a h - b g) hx,  in texels per half pixel
constexpr void span_levels(const profile& q, span_coefficients& c) {
  const int bits = q.reciprocal_bits;
  const auto slope = [&](int32_t x, int32_t s) { return detail::times_slope(x, s, bits); };
  const int64_t ux = c.a_u - slope(c.c_u, c.g), vx = c.a_v - slope(c.c_v, c.g);
  const int64_t uy = c.b_u - slope(c.c_u, c.h), vy = c.b_v - slope(c.c_v, c.h);
  const int64_t twist_u = slope(c.a_u, c.h) - slope(c.b_u, c.g), twist_v = slope(c.a_v, c.h) - slope(c.b_v, c.g);
  for (int k = 0; k < span_side; ++k) {
    const int32_t hx = half_pixels(k) + c.from_x, hy = half_pixels(k) + c.from_y;
    c.level_row[k] = detail::log2_length(ux + twist_u * hy, vx + twist_v * hy, c.exponent);
    c.level_column[k] = detail::log2_length(uy - twist_u * hx, vy - twist_v * hx, c.exponent);
  }
}

// Terms of a single pixel about its own centre, from the plane's forms.
constexpr void pixel_levels(const gradient_logs& g, int64_t w, span_coefficients& c) {
  const int32_t per_pixel = (1 << 16) - 2 * log2_16(uint64_t(w));
  detail::fill(c.level_row, detail::level_term(g.x + per_pixel));
  detail::fill(c.level_column, detail::level_term(g.y + per_pixel));
}
constexpr void pixel_levels(const plane& p, int32_t hx, int32_t hy, span_coefficients& c) { pixel_levels(gradient_logs_at(p, hx, hy), p.w_at(hx, hy), c); }

// KT88: the same for every row and column.
constexpr void major_levels(const plane& p, const reference& r, span_coefficients& c) {
  const int16_t term = detail::level_term(p.major_log2 - 2 * log2_of_w(r));
  detail::fill(c.level_row, term);
  detail::fill(c.level_column, term);
}
constexpr void minor_levels(const plane& p, const reference& r, span_coefficients& c) {
  const int16_t term = detail::level_term(p.minor_log2 - log2_of_w(r));
  detail::fill(c.level_row, term);
  detail::fill(c.level_column, term);
}

// Terms of a span evaluated about its centre, by the profile's formula.
constexpr void formula_levels(const profile& q, const plane& p, const reference& r, span_coefficients& c) {
  switch (q.formula) {
    case level_formula::major: return major_levels(p, r, c);
    case level_formula::minor: return minor_levels(p, r, c);
    case level_formula::jacobian: return span_levels(q, c);
  }
}

// The same of a single pixel about its own centre.
constexpr void formula_levels_of_pixel(const profile& q, const plane& p, const reference& r, int32_t hx, int32_t hy, span_coefficients& c) {
  switch (q.formula) {
    case level_formula::major: return major_levels(p, r, c);
    case level_formula::minor: return minor_levels(p, r, c);
    case level_formula::jacobian: return pixel_levels(p, hx, hy, c);
  }
}

// The power of 1/w that a formula falls with.
constexpr int power_of_w(level_formula f) { return f == level_formula::minor ? 1 : 2; }

// Flat spans, |e| < 2^-4: log2(1 + e) = (e - e^2/2) / ln 2 in 16-bit products; else by the table.
inline constexpr int most_level_slope_log2 = -4;
using twice_over_ln2 = u<15, 0>;  // 2^-13
inline constexpr twice_over_ln2 level_factor = twice_over_ln2::from_raw(23637);

// t = e - e^2/2 in 2^(slope_log2 - 14), times power / ln 2, s.16: floor (proof: level_series).
constexpr int32_t power_log2_of_series(series_number e, int slope_log2, int power) {
  const auto square = e * e;
  const auto t = trust_to<series_number>(e - series_number::from_raw(square.raw() >> (series_bits + 1 - slope_log2)));
  const auto product = t * level_factor;
  return product.raw() >> (13 - power - slope_log2);
}

// power log2 w of a pixel, s.16; power is 1 or 2.
template <class Prof>
constexpr int32_t power_log2_w(const Prof& prof, const span_coefficients& c, int power, int i, int j) {
  if ((c.g | c.h) == 0) return 0;
  const relative_slope<Prof> e = slope_at<Prof>(c, i, j);
  if (c.slope_log2 <= most_level_slope_log2) return power_log2_of_series(series_slope(prof, c, e), c.slope_log2, power);
  return power * (log2_16(w_of(prof, e)) - (prof.get().reciprocal_bits << 16));
}

// Finer by `bias` sixteenths of a level, -16 to 0, but not below five eighths of -bias: a bilinear sample is wider than a texel, but
// level 0 is no mean yet (docs/decisions/0006).
constexpr int32_t finer(int32_t level_16, int bias) { return max_of(level_16 + bias * (1 << 12), min_of(level_16, -5 * bias * (1 << 9))); }

// The level of detail of a pixel before bias and clamp, s.16: negative where the map is magnified.
template <class Prof>
constexpr int32_t unbiased_level(const Prof& prof, const span_coefficients& c, int i, int j) {
  const int32_t level = int32_t(c.level_row[j] > c.level_column[i] ? c.level_row[j] : c.level_column[i]) * (1 << (16 - level_term_bits));
  return level - power_log2_w(prof, c, power_of_w(prof.get().formula), i, j);
}

// The level of detail of a pixel in 2^-level_bits, clamped to [0, last_level].
template <class Prof>
constexpr int32_t level_at(const Prof& prof, const span_coefficients& c, int i, int j) {
  const profile& q = prof.get();
  const int32_t level = finer(unbiased_level(prof, c, i, j), q.mip_bias) + q.level_bias * (1 << 12);
  return clamp_to(shift_right(level, 16 - q.level_bits), 0, int32_t(c.last_level) << q.level_bits);
}

// Integer level a pixel is computed at. Two-level filters take the finer one; mip_bilinear the nearest, ceil(d + 1/2) - 1.
constexpr int integer_level(filter kind, int32_t level, int level_bits, int last_level) {
  if (!uses_levels(kind)) return 0;
  if (uses_two_levels(kind)) return min_of(level >> level_bits, last_level);
  const int32_t half = 1 << (level_bits - 1);
  return max_of(0, ((level + half + (1 << level_bits) - 1) >> level_bits) - 1);
}

}  // namespace spantex
