// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: eight spans side by side. Included by ../avx512.cpp alone.
#pragma once

// What a batch of spans needs below the planner: span_coefficients of eight spans, side by side.
struct alignas(64) batch {
  int32_t c_u[batch_size], a_u[batch_size], b_u[batch_size], c_v[batch_size], a_v[batch_size], b_v[batch_size];
  int32_t g[batch_size], h[batch_size];
  int32_t base_u[batch_size], base_v[batch_size];       // modulo the map's period
  int32_t origin_u[batch_size], origin_v[batch_size];   // before that
  int32_t exponent[batch_size], slope_log2[batch_size];
  int32_t terms[batch_size];                             // 0: affine, 1..4: series, 5: divide
  // Level 0, of spans that are flat enough to tell without their pixels: where the quads' sections lie.
  int32_t at[2][2][quads][batch_size], column[quads][batch_size];                 // bilinear: quad_section
  alignas(64) int32_t low[quads][2][batch_size], high[quads][2][batch_size];      // bilinear: u and v of every position, s15.16
  int32_t row_at[quads][batch_size];                                              // nearest: the section's first texel in the rows of the map
  alignas(64) int32_t from[quads][2][batch_size];                                 // nearest: from it to the base texel, u and v
  alignas(64) int64_t u_x[batch_size], v_x[batch_size], u_y[batch_size], v_y[batch_size], twist_u[batch_size], twist_v[batch_size];  // level.hpp: span_levels()
  alignas(64) int32_t axis_c_u[batch_size], axis_a_u[batch_size], axis_b_u[batch_size], axis_c_v[batch_size], axis_a_v[batch_size], axis_b_v[batch_size];  // axis_terms
  int32_t axis_exponent[batch_size], area_log2[batch_size];  // the area's in 2^-16
  int32_t sx, first;                                     // the first span: on the screen, and of the row's work
  uint32_t usable;                                       // bit k: span k is in here
  uint32_t flat;                                         // bit k: low and high are known
  uint32_t magnified;                                    // bit k: every pixel's level of detail is 0
  uint32_t placed, wide;                                 // bit k: its sections are known; one of them is more than 8 texels across
};
constexpr int divide_terms = 5;

// What one part of a plan leaves to the next.
struct setup {
  v8 w, nu, nv, w_bits, base_u, base_v, g, h, extent_log2, exponent;
  inverse8 inverse;
  __mmask8 usable;
};
