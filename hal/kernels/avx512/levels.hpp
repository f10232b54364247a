// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: levels of detail of a span's pixels. Included by by_blocks.hpp alone.
#pragma once

// finer() of a level in 2^-8 that has the bias in full: its limits are whole numbers of those; clamped.
constexpr int32_t detail_of_ramp = 80;
SPANTEX_INLINE v16 settled(v16 biased, v16 most) {
  const v16 detail = _mm512_max_epi32(_mm512_min_epi32(_mm512_add_epi32(biased, of32<128>()), of32<detail_of_ramp>()), biased);
  return _mm512_max_epi32(_mm512_min_epi32(detail, most), _mm512_setzero_si512());
}
SPANTEX_INLINE v16 detail_of(v16 x, v16 most) { return settled(_mm512_srai_epi32(x, 8), most); }

// level_term() of log2_length() of eight rows or columns, then of eight others, s.16, half of 2^-8 added. What is squared is below 2^31 (vectors/levels.hpp). Exponents are 18 to 36:
// the upper limit of a term is not reached; a length of 0, taken for -1/2, stays below any other, and it and what is below the lower limit are levels far below 0.
// more: batch's more_of_level.
SPANTEX_INLINE v16 lengths16(v8 some, v8 others, v16 more) {
  const v8 some_zeros = _mm512_lzcnt_epi64(some), others_zeros = _mm512_lzcnt_epi64(others);
  const v16 lower = _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30), higher = _mm512_add_epi32(lower, of32<1>());
  const v16 bits = _mm512_permutex2var_epi32(_mm512_sllv_epi64(some, some_zeros), higher, _mm512_sllv_epi64(others, others_zeros));
  const v16 zeros = _mm512_permutex2var_epi32(some_zeros, lower, others_zeros);
  const v16 length = _mm512_srai_epi32(log2_of_bits(bits, _mm512_sub_epi32(of32<63>(), zeros)), 1);
  return _mm512_and_si512(_mm512_add_epi32(length, more), of32<-64>());
}

// Of spans' rows and columns; or, where it is known which ones are longer, of these alone, twice.
struct alignas(64) span_lengths {
  int32_t of[batch_size][16];
  uint32_t longer;             // bit k: these alone
};
SPANTEX_INLINE v8 rows_apart() { return _mm512_setr_epi64(-7, -5, -3, -1, 1, 3, 5, 7); }

SPANTEX_INLINE v16 both_lengths_of(const batch& b, int k) {
  const v8 along_u = _mm512_mul_epi32(set(b.twist_u[k]), rows_apart()), along_v = _mm512_mul_epi32(set(b.twist_v[k]), rows_apart());
  const v8 rows = squares_of(_mm512_add_epi64(set(b.u_x[k]), along_u), _mm512_add_epi64(set(b.v_x[k]), along_v));
  const v8 columns = squares_of(_mm512_sub_epi64(set(b.u_y[k]), along_u), _mm512_sub_epi64(set(b.v_y[k]), along_v));
  return lengths16(rows, columns, set32(b.more_of_level[k]));
}

// Of two spans, k and the next one.
SPANTEX_INLINE void longer_lengths_of(const batch& b, int k, span_lengths& to) {
  const auto squares = [&](int n) SPANTEX_INLINED {
    const bool rows = b.rows_longer >> n & 1;
    const v8 apart = _mm512_mask_sub_epi64(rows_apart(), __mmask8(rows - 1), _mm512_setzero_si512(), rows_apart());
    const auto along = [&](const int64_t& step, const int64_t& twist) SPANTEX_INLINED {  // g++ 12 reads values into general registers
      return _mm512_add_epi64(set(step), _mm512_mul_epi32(set(twist), apart));
    };
    return squares_of(along(*(rows ? b.u_x + n : b.u_y + n), b.twist_u[n]), along(*(rows ? b.v_x + n : b.v_y + n), b.twist_v[n]));
  };
  const v16 more = _mm512_mask_mov_epi32(set32(b.more_of_level[k]), 0xFF00, set32(b.more_of_level[k + 1]));
  const v16 lengths = lengths16(squares(k), squares(k + 1), more);
  _mm512_store_si512(to.of[k], _mm512_shuffle_i64x2(lengths, lengths, 0x44));
  _mm512_store_si512(to.of[k + 1], _mm512_shuffle_i64x2(lengths, lengths, 0xEE));
}

// Of a batch's spans that are asked for.
SPANTEX_INLINE void lengths_of(const batch& b, uint32_t spans, span_lengths& to) {
  const uint32_t known = b.rows_longer | b.columns_longer, of_pair = known & known >> 1 & 0x55;
  to.longer = of_pair | of_pair << 1;
#pragma GCC unroll 1
  for (int k = 0; k < batch_size; k += 2) {
    if (!(spans >> k & 3)) continue;
    if (to.longer >> k & 1) {
      longer_lengths_of(b, k, to);
      continue;
    }
    for (int n = k; n < k + 2; ++n) _mm512_store_si512(to.of[n], both_lengths_of(b, n));
  }
}

// Settled levels of eight spans of a plane that faces the viewer: rows are of one length, and columns, so that a span's pixels have one level.
SPANTEX_INLINE __m256i levels_of_facing(const batch& b, int32_t last_level) {
  const auto squares = [](const int64_t (&u)[batch_size], const int64_t (&v)[batch_size]) SPANTEX_INLINED { return squares_of(_mm512_load_si512(u), _mm512_load_si512(v)); };
  const v16 lengths = lengths16(squares(b.u_x, b.v_x), squares(b.u_y, b.v_y), _mm512_broadcast_i64x4(got(b.more_of_level))), longest = _mm512_max_epi32(lengths, _mm512_shuffle_i64x2(lengths, lengths, 0x4E));
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
SPANTEX_INLINE void longest_of(const batch& b, int k, const span_lengths& of_spans, v16 (&out)[quads]) {
  const quad_cut& quad = cut_of(b.how);
  const v16 lengths = _mm512_load_si512(of_spans.of[k]);
  const auto each = [](const int32_t (&lanes)[16], v16 of) SPANTEX_INLINED { return _mm512_permutexvar_epi32(_mm512_load_si512(lanes), of); };
  if (of_spans.longer >> k & 1) [[likely]] {
    const auto& lanes = b.rows_longer >> k & 1 ? quad.row : quad.column;
#pragma GCC unroll 4
    for (int n = 0; n < quads; ++n) out[n] = each(lanes[n], lengths);
  } else {
    const v16 of_columns = _mm512_shuffle_i64x2(lengths, lengths, 0x4E);
#pragma GCC unroll 4
    for (int n = 0; n < quads; ++n) out[n] = _mm512_max_epi32(each(quad.row[n], lengths), each(quad.column[n], of_columns));
  }
}

// Of level_at(), before it is settled(): what pixels' lengths have less for their slopes.
template <bool Steep>
struct level_of_slopes {
  v16 square_drop, log_drop;
  int slope_log2;
  SPANTEX_INLINE level_of_slopes(const batch& b, int k) : square_drop(_mm512_add_epi32(set32(b.series_drop[k]), of32<1>())), log_drop(_mm512_add_epi32(square_drop, of32<12>())), slope_log2(b.slope_log2[k]) {}
  SPANTEX_INLINE v16 operator()(v16 e, const slopes16& w) const {
    if constexpr (Steep) return _mm512_slli_epi32(log2_of_w(slope_of(e, slope_log2)), 1);
    const v16 t = upper_difference(w.e16, _mm512_srav_epi32(w.square, square_drop));
    return _mm512_srav_epi32(_mm512_madd_epi16(t, of32<int32_t(level_factor.raw()) << 16>()), log_drop);
  }
};

// Positions and levels of a span's pixels, those not settled().
template <bool Steep>
SPANTEX_INLINE void find_pixels(const batch& b, int k, const span_lengths& lengths, span_pixels& p) {
  v16 longest[quads];
  longest_of(b, k, lengths, longest);
  evaluate<quad_form, true>(b, k, level_of_slopes<Steep>(b, k), [&](int n, v16 u, v16 v, v16 log_w) SPANTEX_INLINED {
    p.u[n] = u;
    p.v[n] = v;
    p.level[n] = _mm512_srai_epi32(_mm512_sub_epi32(longest[n], log_w), 8);
  });
}
