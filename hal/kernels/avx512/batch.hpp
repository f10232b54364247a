// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: eight spans side by side. Included by by_blocks.hpp alone.
#pragma once

// c + x hx + y hy of a span's pixels, eight spans: what is added up to the lanes of the first quad, and what leads from quad to quad (quad_cut).
struct alignas(64) batch_forms {
  int32_t across[batch_size][quad_side], down[batch_size][quad_side];
  int32_t right[batch_size], below[batch_size];
};

// Only filters with levels take other quads than square ones, which most spans take: their steps are constants (1 to 7 % of a plan's filter otherwise).
template <filter Kind>
SPANTEX_INLINE void keep(batch_forms& f, __m256i c, __m256i x, __m256i y, cut how) {
  const auto of_four = [&](auto&& lanes_of) SPANTEX_INLINED {
#pragma GCC unroll 2
    for (int k = 0; k < batch_size; k += batch_size / 2) {
      const v16 lanes = _mm512_add_epi32(_mm512_setr_epi32(0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3), set32(k));
      const auto spread = [&](__m256i of) SPANTEX_INLINED { return _mm512_permutexvar_epi32(lanes, _mm512_castsi256_si512(of)); };
      lanes_of(k, spread(c), spread(x), spread(y));
    }
  };
  if (!uses_levels(Kind) || how == cut::square) [[likely]] {
    const v16 steps = _mm512_setr_epi32(-7, -5, -3, -1, -7, -5, -3, -1, -7, -5, -3, -1, -7, -5, -3, -1);
    of_four([&](int k, v16 of_c, v16 of_x, v16 of_y) SPANTEX_INLINED {
      _mm512_store_si512(f.across[k], _mm512_add_epi32(of_c, _mm512_mullo_epi32(of_x, steps)));
      _mm512_store_si512(f.down[k], _mm512_mullo_epi32(of_y, steps));
    });
    put(f.right, _mm256_slli_epi32(x, 3));
    put(f.below, _mm256_slli_epi32(y, 3));
    return;
  }
  const quad_cut& quad = cut_of(how);
  of_four([&](int k, v16 of_c, v16 of_x, v16 of_y) SPANTEX_INLINED {
    const auto along = [&](const quad_cut::steps& s) SPANTEX_INLINED {
      const auto steps = [](const int32_t (&of)[quad_side]) SPANTEX_INLINED { return _mm512_broadcast_i32x4(_mm_loadu_si128(reinterpret_cast<const __m128i*>(of))); };
      return _mm512_add_epi32(_mm512_mullo_epi32(of_x, steps(s.x)), _mm512_mullo_epi32(of_y, steps(s.y)));
    };
    _mm512_store_si512(f.across[k], _mm512_add_epi32(of_c, along(quad.across)));
    _mm512_store_si512(f.down[k], along(quad.down));
  });
  const auto between = [&](int32_t along_x, int32_t along_y) SPANTEX_INLINED {
    return _mm256_add_epi32(_mm256_mullo_epi32(x, _mm256_set1_epi32(along_x)), _mm256_mullo_epi32(y, _mm256_set1_epi32(along_y)));
  };
  put(f.right, between(quad.right_x, quad.right_y));
  put(f.below, between(quad.below_x, quad.below_y));
}

// x (2 n - 7) of eight spans, n a row or a column.
SPANTEX_INLINE void keep(int32_t (&to)[batch_size][span_side], __m256i x) {
  const v16 steps = _mm512_setr_epi32(-7, -5, -3, -1, 1, 3, 5, 7, -7, -5, -3, -1, 1, 3, 5, 7);
#pragma GCC unroll 4
  for (int k = 0; k < batch_size; k += 2) {
    const v16 lanes = _mm512_setr_epi32(k, k, k, k, k, k, k, k, k + 1, k + 1, k + 1, k + 1, k + 1, k + 1, k + 1, k + 1);
    _mm512_store_si512(to[k], _mm512_mullo_epi32(_mm512_permutexvar_epi32(lanes, _mm512_castsi256_si512(x)), steps));
  }
}

// Sections of local memory of the quads of eight spans, on a level each (quad_section).
struct alignas(64) batch_sections {
  int32_t at[3][3][quads][batch_size];                // columns of blocks, from each the first eight rows, the next eight and those after them: from planar_map::blocks()
  int32_t row[quads][batch_size];                     // the first
  int32_t shift[quads][batch_size];                   // the first column, times 8 (quad_section)
};

// What a batch of spans needs below the planner: span_coefficients of eight spans, side by side.
struct alignas(64) batch {
  int32_t c_u[batch_size], a_u[batch_size], b_u[batch_size], c_v[batch_size], a_v[batch_size], b_v[batch_size];
  batch_forms u, v, e;                                   // of those; e 2^-slope_log2 takes the whole of 31 bits
  alignas(64) int32_t slopes[batch_size][span_side];     // instead of e, of filters with levels where it varies along one axis alone: rows' or columns'
  const int32_t (*slope_of)[16];                         // which of them quads' lanes have; none where e is there
  batch_forms axis_u, axis_v;                            // aniso
  int32_t base_u[batch_size], base_v[batch_size];       // modulo the map's period
  int32_t origin_u[batch_size], origin_v[batch_size];   // before that
  int32_t exponent[batch_size], slope_log2[batch_size] = {};  // read, like `magnified`, `rows_longer` and `columns_longer`, of a batch of which nothing is drawn, before it is planned
  int32_t series_drop[batch_size];                       // 14 - s as of 32-bit lanes whose upper halves are multiplied: -2 - s
  int32_t terms[batch_size];                             // 0: affine, 1..4: series, 5: divide
  int32_t affine_log2[batch_size];                       // a position lies within 2^this texels of where it would if nothing were divided
  // Level 0, of spans that are flat enough to tell without their pixels: where the quads' sections lie.
  batch_sections sections;                                                        // bilinear
  int32_t row_at[quads][batch_size] = {};                                         // nearest: the section's first texel in the rows of the map; of spans that are not planned anything, to be prefetched at most
  int32_t column_bits[batch_size], row_bits[batch_size];                          // bits of fraction that offsets are left; nearest: of v, so that a row is 8 texels
  alignas(64) int32_t from[quads][2][batch_size];                                 // from a section's first texel to the base texel, u and v, as offsets, and what rounds
  alignas(64) int64_t u_x[batch_size], v_x[batch_size], u_y[batch_size], v_y[batch_size], twist_u[batch_size], twist_v[batch_size];  // level.hpp: span_levels()
  int32_t more_of_level[batch_size];                    // what leads from a length's logarithm to a level
  alignas(64) int32_t right[2 * batch_size], below[2 * batch_size], spread[2 * batch_size];  // quad_bounds of filters with levels: u, then v
  int32_t axis_exponent[batch_size], area_log2[batch_size];  // the area's in 2^-16
  int32_t g[batch_size], h[batch_size], axis[6][batch_size];  // aniso: axis_terms::c_u to b_v
  cut how;                                               // its quads
  int32_t sx, first;                                     // the first span: on the screen, and of the row's work
  uint32_t usable;                                       // bit k: span k is in here
  uint32_t level;                                        // aniso; bit k: w is constant
  uint32_t magnified = 0;                                // bit k: every pixel's level of detail is 0
  uint32_t rows_longer = 0, columns_longer = 0;          // bit k: no column is longer than any row; no row than any column
  uint32_t placed, deep, broad;                         // bit k: its sections are known; how they lie (section_kinds)
  uint32_t together, few_rows;                          // nearest; bit k: its quads have one section; which is no more than four rows
};
constexpr int divide_terms = 5;

// What one part of a plan leaves to the next.
struct setup {
  v8 w, nu, nv, mantissa, seed, w_bits, base_u, base_v, c_u, a_u, b_u, c_v, a_v, b_v, g, h, drop, shift, steepness, slope_log2, affine_log2, extent_log2, exponent;
  inverse8 inverse;
  __mmask8 usable;
};

// What every batch of a row adds to its first span's W and numerators.
struct batch_steps {
  v8 w, nu, nv;
  SPANTEX_INLINE explicit batch_steps(const plane& p) {
    const auto along = [](const linear_form& f) { return _mm512_mullo_epi64(_mm512_setr_epi64(0, 1, 2, 3, 4, 5, 6, 7), set(2 * span_side * f.x)); };
    w = along(p.w);
    nu = along(p.u);
    nv = along(p.v);
  }
};
