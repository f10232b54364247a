// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: levels of detail of a span's pixels. Included by ../avx512.cpp alone.
#pragma once

// Of a level in 2^-16: what rounds it to 2^-8, less the bias of -8 in full.
constexpr int32_t detail_half = (1 << 7) - (1 << 15);
// finer() of a level in 2^-8 that has the bias in full: its limits are whole numbers of those; clamped.
constexpr int32_t detail_of_ramp = 80;
SPANTEX_INLINE v16 settled(v16 biased, v16 most) {
  const v16 detail = _mm512_max_epi32(_mm512_min_epi32(_mm512_add_epi32(biased, of32<128>()), of32<detail_of_ramp>()), biased);
  return _mm512_max_epi32(_mm512_min_epi32(detail, most), _mm512_setzero_si512());
}
SPANTEX_INLINE v16 detail_of(v16 x, v16 most) { return settled(_mm512_srai_epi32(x, 8), most); }

// level_term() of log2_length() of the eight rows, then of the eight columns, s.16, half of 2^-8 added. What is squared is below 2^31 (vectors/levels.hpp). Exponents are 18 to 36:
// the upper limit of a term is not reached; a length of 0, taken for -1/2, stays below any other, and it and what is below the lower limit are levels far below 0.
// more: more_of_level, less the numbers' exponent.
constexpr int32_t more_of_level = (1 << 16) + detail_half + 32;
SPANTEX_INLINE v16 lengths16(v8 row_u, v8 row_v, v8 column_u, v8 column_v, v16 more) {
  const auto square = [&](v8 u, v8 v) { return _mm512_add_epi64(_mm512_mul_epi32(u, u), _mm512_mul_epi32(v, v)); };
  const v8 row = square(row_u, row_v), column = square(column_u, column_v);
  const v8 row_zeros = _mm512_lzcnt_epi64(row), column_zeros = _mm512_lzcnt_epi64(column);
  const v16 lower = _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30), higher = _mm512_add_epi32(lower, of32<1>());
  const v16 bits = _mm512_permutex2var_epi32(_mm512_sllv_epi64(row, row_zeros), higher, _mm512_sllv_epi64(column, column_zeros));
  const v16 zeros = _mm512_permutex2var_epi32(row_zeros, lower, column_zeros);
  const v16 length = _mm512_srai_epi32(log2_of_bits(bits, _mm512_sub_epi32(of32<63>(), zeros)), 1);
  return _mm512_and_si512(_mm512_add_epi32(length, more), of32<-64>());
}

// Of the span's rows and columns.
SPANTEX_INLINE v16 lengths_of(const batch& b, int k) {
  const v8 half = _mm512_setr_epi64(-7, -5, -3, -1, 1, 3, 5, 7);
  const v8 along_u = _mm512_mul_epi32(set(b.twist_u[k]), half), along_v = _mm512_mul_epi32(set(b.twist_v[k]), half);
  return lengths16(_mm512_add_epi64(set(b.u_x[k]), along_u), _mm512_add_epi64(set(b.v_x[k]), along_v), _mm512_sub_epi64(set(b.u_y[k]), along_u),
                   _mm512_sub_epi64(set(b.v_y[k]), along_v), set32(more_of_level - b.exponent[k] * (1 << 16)));
}

// Settled levels of eight spans of a plane that faces the viewer: rows are of one length, and columns, so that a span's pixels have one level.
SPANTEX_INLINE __m256i levels_of_facing(const batch& b, int32_t last_level) {
  const auto of = [](const int64_t (&x)[batch_size]) SPANTEX_INLINED { return _mm512_load_si512(x); };
  const v16 exponents = _mm512_broadcast_i64x4(got(b.exponent)), more = _mm512_sub_epi32(of32<more_of_level>(), _mm512_slli_epi32(exponents, 16));
  const v16 lengths = lengths16(of(b.u_x), of(b.v_x), of(b.u_y), of(b.v_y), more), longest = _mm512_max_epi32(lengths, _mm512_shuffle_i64x2(lengths, lengths, 0x4E));
  return _mm512_castsi512_si256(detail_of(longest, set32(last_level << q.level_bits)));
}

// The last level of detail at which pixels take from no level but those whose sides are level 0's, halved.
template <bool TwoLevels>
SPANTEX_INLINE int32_t last_like_level(const planar_map& map) {
  return (map.levels_in_rows().exact_count() - 1) * (1 << q.level_bits) + (TwoLevels ? 0 : 1 << (q.level_bits - 1));  // integer_level()
}

// Whether some pixel takes from others.
template <bool TwoLevels>
SPANTEX_INLINE bool on_unlike_levels(const planar_map& map, const v16 (&level)[quads]) {
  const v16 most = _mm512_max_epi32(_mm512_max_epi32(level[0], level[1]), _mm512_max_epi32(level[2], level[3]));
  return _mm512_cmpgt_epi32_mask(most, set32(last_like_level<TwoLevels>(map))) != 0;
}

// What makes a level's whole part the one that is taken: one level of detail d is ceil(d + 1/2) - 1.
template <bool TwoLevels>
constexpr int32_t to_whole = TwoLevels ? 0 : (1 << (q.level_bits - 1)) - 1;

// The level of a span's first pixel, whole above its fraction, and whether the whole one is all of theirs; whether, besides, none of them takes anything from the next one.
template <bool TwoLevels>
SPANTEX_INLINE __m128i common_level_of(const v16 (&level)[quads], bool& alike, bool& alone) {
  const auto of = [&](int n) SPANTEX_INLINED { return TwoLevels ? level[n] : _mm512_add_epi32(level[n], of32<to_whole<false>>()); };
  const v16 first = _mm512_broadcastd_epi32(_mm512_castsi512_si128(of(0)));
  const auto differing = [&](v16 so_far, v16 x) SPANTEX_INLINED { return _mm512_ternarylogic_epi32(so_far, x, first, 0xF6); };  // so_far | (x ^ first)
  const v16 differs = differing(differing(differing(_mm512_xor_si512(of(0), first), of(1)), of(2)), of(3));
  constexpr int32_t fraction = (1 << q.level_bits) - 1;
  const __m128i told = _mm512_castsi512_si128(of(0));
  alike = _mm512_test_epi32_mask(differs, of32<~fraction>()) == 0;
  alone = !TwoLevels || ((_mm_cvtsi128_si32(told) & fraction) == 0 && _mm512_test_epi32_mask(differs, of32<fraction>()) == 0);
  return told;
}

// The same of levels that are not settled(). Of pixels that are all on one whole level before the last it is the bias in full, on the first of them 80 at least.
template <bool TwoLevels>
SPANTEX_INLINE __m128i settle(v16 (&level)[quads], int32_t last_level, bool& alike, bool& alone) {
  if (_mm512_cvtsi512_si32(level[0]) >= 0) [[likely]] {
    const __m128i first = common_level_of<TwoLevels>(level, alike, alone);
    const int32_t whole = _mm_cvtsi128_si32(first) >> q.level_bits;
    if (alike && whole < last_level) [[likely]] {
      if (whole > 0) return first;
#pragma GCC unroll 4
      for (v16& each : level) each = _mm512_max_epi32(each, of32<detail_of_ramp>());
      alone = !TwoLevels;
      return first;
    }
  }
  const v16 most = set32(last_level << q.level_bits);
#pragma GCC unroll 4
  for (v16& each : level) each = settled(each, most);
  return common_level_of<TwoLevels>(level, alike, alone);
}

// Of a span whose pixels are not all on one: the least level; whether they are on its whole one and the next.
template <bool TwoLevels>
SPANTEX_INLINE __m128i least_level_of(const v16 (&level)[quads], bool& next_too) {
  const v16 least = _mm512_min_epi32(_mm512_min_epi32(level[0], level[1]), _mm512_min_epi32(level[2], level[3]));
  const v16 most = _mm512_max_epi32(_mm512_max_epi32(level[0], level[1]), _mm512_max_epi32(level[2], level[3]));
  const int32_t from = _mm512_reduce_min_epi32(least) + to_whole<TwoLevels>, to = _mm512_reduce_max_epi32(most) + to_whole<TwoLevels>;
  next_too = (to >> q.level_bits) - (from >> q.level_bits) == 1;
  return _mm_cvtsi32_si128(from);
}

// Each pixel's longer one of its row's and its column's length.
SPANTEX_INLINE void longest_of(v16 lengths, cut how, v16 (&out)[quads]) {
  const auto of = [&](v16 lanes, int first) SPANTEX_INLINED { return _mm512_permutexvar_epi32(_mm512_add_epi32(lanes, set32(first)), lengths); };
  constexpr int columns = span_side;
  if (how == cut::square) [[likely]] {
    const v16 row = _mm512_setr_epi32(0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3), column = _mm512_setr_epi32(0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3);
    const v16 top = of(row, 0), bottom = of(row, 4), left = of(column, columns), right = of(column, columns + 4);
    out[0] = _mm512_max_epi32(top, left);
    out[1] = _mm512_max_epi32(top, right);
    out[2] = _mm512_max_epi32(bottom, left);
    out[3] = _mm512_max_epi32(bottom, right);
  } else if (how == cut::flat) {
    const v16 all = of(_mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7), columns), row = _mm512_setr_epi32(0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1);
#pragma GCC unroll 4
    for (int n = 0; n < quads; ++n) out[n] = _mm512_max_epi32(of(row, 2 * n), all);
  } else {
    const v16 all = of(_mm512_setr_epi32(0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7), 0), column = _mm512_setr_epi32(0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1);
#pragma GCC unroll 4
    for (int n = 0; n < quads; ++n) out[n] = _mm512_max_epi32(of(column, columns + 2 * n), all);
  }
}

// level_at() of the span's pixels before it is settled(): quad by quad, told of its slopes.
template <bool Steep>
struct levels_of {
  v16 square_drop, log_drop, terms[quads];
  SPANTEX_INLINE levels_of(const batch& b, int k, v16 lengths) : square_drop(set32(b.series_drop[k] + 1)), log_drop(set32(b.series_drop[k] + 13)) {
    longest_of(lengths, b.how, terms);
  }
  SPANTEX_INLINE v16 operator()(int n, v16 e, int slope_log2, const slopes16& w) const {
    v16 log_w;
    if constexpr (Steep) {
      log_w = _mm512_slli_epi32(_mm512_sub_epi32(log2_of(_mm512_add_epi32(slope_of(e, slope_log2), of32<1 << 30>())), of32<30 << 16>()), 1);
    } else {
      const v16 t = upper_difference(w.e16, _mm512_srav_epi32(w.square, square_drop));
      log_w = _mm512_srav_epi32(_mm512_madd_epi16(t, of32<int32_t(level_factor.raw()) << 16>()), log_drop);
    }
    return _mm512_srai_epi32(_mm512_sub_epi32(terms[n], log_w), 8);
  }
};

// Positions and levels of a span's pixels, those not settled().
template <bool Steep>
SPANTEX_INLINE void find_pixels(const batch& b, int k, v16 lengths, span_pixels& p) {
  const levels_of<Steep> levels(b, k, lengths);
  evaluate<forms_in_turn>(b, k, [&](int n, v16 u, v16 v, v16 e, const slopes16& w) SPANTEX_INLINED {
    p.u[n] = u;
    p.v[n] = v;
    p.level[n] = levels(n, e, b.slope_log2[k], w);
  });
}
