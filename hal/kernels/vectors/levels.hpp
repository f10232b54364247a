// SPDX-License-Identifier: Apache-2.0
// Vector kernels: a span's terms of levels of detail, its 16 lengths in lanes. Included by the machines' files alone.
#pragma once

// span_levels(). Everything before it is squared is below 2^31: |c| + 7 (|a| + |b|) < 2^30 (give or take the roundings), 7 (|g| + |h|) < 2^29.
SPANTEX_INLINE void plan_levels(span_coefficients& c) {
  const auto slope = [](int32_t x, int32_t s) SPANTEX_INLINED {  // times_slope(): to nearest, halves away from zero
    const int64_t product = int64_t(x) * s;
    return int32_t((product + (int64_t(1) << (q.reciprocal_bits - 1)) + (product >> 63)) >> q.reciprocal_bits);
  };
  const int32_t row_u = c.a_u - slope(c.c_u, c.g), row_v = c.a_v - slope(c.c_v, c.g), column_u = c.b_u - slope(c.c_u, c.h), column_v = c.b_v - slope(c.c_v, c.h);
  const int32_t more_u = slope(c.a_u, c.h) - slope(c.b_u, c.g), more_v = slope(c.a_v, c.h) - slope(c.b_v, c.g);
  wide rows[parts], columns[parts];
#pragma GCC unroll 2
  for (int part = 0; part < parts; ++part) {
    const v half = half_pixels_across() + 2 * width * part, twist_u = half * more_u, twist_v = half * more_v;
    rows[part] = squares_of(twist_u + row_u, twist_v + row_v);
    columns[part] = squares_of(column_u - twist_u, column_v - twist_v);
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
