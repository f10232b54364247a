// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: levels of detail of a span's pixels. Included by ../avx512.cpp alone.
#pragma once

// log2_length() of the eight rows, then of the eight columns, s.16.
SPANTEX_INLINE v16 lengths16(v8 row_u, v8 row_v, v8 column_u, v8 column_v, int exponent) {
  const auto square = [&](v8 u, v8 v) { return _mm512_add_epi64(_mm512_mullo_epi64(u, u), _mm512_mullo_epi64(v, v)); };
  const v8 row = square(row_u, row_v), column = square(column_u, column_v);
  const v8 row_zeros = _mm512_lzcnt_epi64(row), column_zeros = _mm512_lzcnt_epi64(column);
  const v16 lower = _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30), higher = _mm512_add_epi32(lower, of32<1>());
  const v16 bits = _mm512_permutex2var_epi32(_mm512_sllv_epi64(row, row_zeros), higher, _mm512_sllv_epi64(column, column_zeros));
  const v16 zeros = _mm512_permutex2var_epi32(row_zeros, lower, column_zeros);
  const v16 level = _mm512_add_epi32(_mm512_srli_epi32(log2_of_bits(bits, _mm512_sub_epi32(of32<63>(), zeros)), 1), set32((1 - exponent) * 65536));
  return level_term16(_mm512_mask_mov_epi32(level, _mm512_cmpeq_epi32_mask(zeros, of32<64>()), of32<-32 * 65536>()));
}

// Of the span's rows and columns.
SPANTEX_INLINE v16 lengths_of(const batch& b, int k) {
  const v8 half = _mm512_setr_epi64(-7, -5, -3, -1, 1, 3, 5, 7);
  const v8 along_u = _mm512_mullo_epi64(set(b.twist_u[k]), half), along_v = _mm512_mullo_epi64(set(b.twist_v[k]), half);
  return lengths16(_mm512_add_epi64(set(b.u_x[k]), along_u), _mm512_add_epi64(set(b.v_x[k]), along_v), _mm512_sub_epi64(set(b.u_y[k]), along_u),
                   _mm512_sub_epi64(set(b.v_y[k]), along_v), b.exponent[k]);
}

// To 2^-8, then finer() with a bias of -8: its limits are whole numbers of those; clamped.
SPANTEX_INLINE v16 detail_of(v16 x, v16 most) {
  const v16 level = _mm512_srai_epi32(_mm512_add_epi32(x, of32<128>()), 8);
  const v16 detail = _mm512_max_epi32(_mm512_min_epi32(level, of32<80>()), _mm512_sub_epi32(level, of32<128>()));
  return _mm512_max_epi32(_mm512_min_epi32(detail, most), _mm512_setzero_si512());
}

// Whether some pixel takes from a level whose sides are not level 0's, halved.
template <bool TwoLevels>
SPANTEX_INLINE bool on_unlike_levels(const planar_map& map, const v16 (&level)[quads]) {
  const v16 most = _mm512_max_epi32(_mm512_max_epi32(level[0], level[1]), _mm512_max_epi32(level[2], level[3]));
  const int32_t last = (map.levels_in_rows().exact_count() - 1) * (1 << q.level_bits) + (TwoLevels ? 0 : 1 << (q.level_bits - 1));  // integer_level()
  return _mm512_cmpgt_epi32_mask(most, set32(last)) != 0;
}

// level_at() of the span's pixels, 2^-8.
SPANTEX_INLINE void levels_of(const row_work& work, v16 lengths, int s, const v16 (&e)[quads], v16 (&level)[quads]) {
  const v16 row = _mm512_setr_epi32(0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3), column = _mm512_setr_epi32(8, 9, 10, 11, 8, 9, 10, 11, 8, 9, 10, 11, 8, 9, 10, 11);
  const v16 top = _mm512_permutexvar_epi32(row, lengths), bottom = _mm512_permutexvar_epi32(_mm512_add_epi32(row, set32(4)), lengths);
  const v16 left = _mm512_permutexvar_epi32(column, lengths), right = _mm512_permutexvar_epi32(_mm512_add_epi32(column, set32(4)), lengths);
  const v16 terms[quads] = {_mm512_max_epi32(top, left), _mm512_max_epi32(top, right), _mm512_max_epi32(bottom, left), _mm512_max_epi32(bottom, right)};
  const v16 most = set32(work.last_level << q.level_bits), slope_log2 = set32(s);
#pragma GCC unroll 4
  for (int n = 0; n < quads; ++n) {
    v16 log_w;
    if (s <= most_level_slope_log2) {
      const v16 e16 = slope16(e[n], slope_log2);
      const v16 t = upper_difference(e16, _mm512_srav_epi32(_mm512_madd_epi16(e16, e16), set32(-s - 1)));
      log_w = _mm512_srav_epi32(_mm512_madd_epi16(t, of32<int32_t(level_factor.raw()) << 16>()), set32(11 - s));
    } else {
      log_w = _mm512_slli_epi32(_mm512_sub_epi32(log2_of(_mm512_add_epi32(e[n], of32<1 << 30>())), of32<30 << 16>()), 1);
    }
    level[n] = detail_of(_mm512_sub_epi32(terms[n], log_w), most);
  }
}
