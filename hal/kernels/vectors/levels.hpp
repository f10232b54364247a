// SPDX-License-Identifier: Apache-2.0
// Vector kernels: a span's terms of levels of detail, its 16 lengths in lanes. Included by the machines' files alone.
#pragma once

// row_u and the rest of span_levels(), of both axes.
template <class Coefficients>
SPANTEX_INLINE span_slopes slopes_of(const Coefficients& c) {
  const auto slope = [](int32_t x, int32_t s) SPANTEX_INLINED {  // times_slope(): to nearest, halves away from zero
    const int64_t product = int64_t(x) * s;
    return int32_t((product + (int64_t(1) << (q.reciprocal_bits - 1)) + (product >> 63)) >> q.reciprocal_bits);
  };
  return {set(c.a_u - slope(c.c_u, c.g)), set(c.a_v - slope(c.c_v, c.g)), set(c.b_u - slope(c.c_u, c.h)), set(c.b_v - slope(c.c_v, c.h)),
          set(slope(c.a_u, c.h) - slope(c.b_u, c.g)), set(slope(c.a_v, c.h) - slope(c.b_v, c.g))};
}

// span_levels(). Everything before it is squared is below 2^31: |c| + 7 (|a| + |b|) < 2^30 (give or take the roundings), 7 (|g| + |h|) < 2^29.
SPANTEX_INLINE void plan_levels(span_coefficients& c) {
  const span_slopes s = slopes_of(c);
  wide rows[parts], columns[parts];
#pragma GCC unroll 2
  for (int part = 0; part < parts; ++part) {
    const v half = half_pixels_across() + 2 * width * part, twist_u = half * s.twist_u, twist_v = half * s.twist_v;
    rows[part] = squares_of(twist_u + s.row_u, twist_v + s.row_v);
    columns[part] = squares_of(s.column_u - twist_u, s.column_v - twist_v);
  }
  v length[2 * parts];  // of rows, of columns
  if (!normalised(rows, length) || !normalised(columns, length + parts)) [[unlikely]] return span_levels(q, c);
  half_log2_of(length);
#pragma GCC unroll 2
  for (int part = 0; part < parts; ++part) {
    const auto term = [&](v x) SPANTEX_INLINED { return (x + ((1 - c.exponent) * (1 << 16) + 32)) >> 6; };
    put_words(c.level_row + width * part, term(length[part]));
    put_words(c.level_column + width * part, term(length[parts + part]));
  }
}
