// SPDX-License-Identifier: Apache-2.0
// Vector kernels: what AVX-512 has no operator for; sixteen lanes are two rows of a span. Included by ../avx512/by_rows.hpp alone.
#pragma once

constexpr bool places_first = true, moves_texels = SPANTEX_GATHERS == 0, spares_levels = false;
constexpr int row_pairs_at_once = 4;  // of positions with levels
typedef int32_t level_number;  // of a pixel, in memory

using raw = __m512i;
static_assert(sizeof(v) == sizeof(raw) && rows_at_once == 2);

// Sixteen bytes in each quarter of a register.
SPANTEX_INLINE v of_each_quarter(__m128i x) { return v(_mm512_broadcast_i32x4(x)); }

SPANTEX_INLINE v products(v a, v b) { return v(_mm512_madd_epi16(raw(a), raw(b))); }  // of both halves of a lane, added up
SPANTEX_INLINE v add_products(v c, v a, v b) { return v(_mm512_dpwssd_epi32(raw(c), raw(a), raw(b))); }  // the same and c
SPANTEX_INLINE v halves(v low, v high) { return v(_mm512_mask_mov_epi16(raw(low), 0xAAAAAAAA, raw(high))); }
SPANTEX_INLINE v rounded_shift(v x, int shift) { return down_by(x + (1 << (shift - 1)), shift); }  // to nearest, halves up
SPANTEX_INLINE v_32 rounded_shift(v_32 x, int shift) { return (x >> shift) + (x >> (shift - 1) & 1); }
SPANTEX_INLINE bool all_equal(v a, int32_t b) { return _mm512_cmpneq_epi32_mask(raw(a), _mm512_set1_epi32(b)) == 0; }

// 64-bit lanes; a product's shift is 1 or more and rounds halves up.
SPANTEX_INLINE v_s64 size_of(v_s64 x) { return v_s64(_mm512_abs_epi64(raw(x))); }
SPANTEX_INLINE v_64 rounded_shift(v_64 x, v_64 shift) { return (x + ((v_64{} + 1) << (shift - 1))) >> shift; }
SPANTEX_INLINE v_s64 bit_lengths(v_s64 x) { return 64 - v_s64(_mm512_lzcnt_epi64(raw(x))); }
SPANTEX_INLINE uint32_t signs_of(v_s64 x) { return _mm512_movepi64_mask(raw(x)); }
// The lower half of 128-bit numbers shifted down by as many bits, 0 to 127. What is shifted by more than a lane has is 0.
SPANTEX_INLINE v_64 low_after(v_64 low, v_64 high, v_64 n) {
  const raw up = _mm512_sllv_epi64(raw(high), raw(64 - n)), down = _mm512_srlv_epi64(raw(high), raw(n - 64));
  return v_64(_mm512_ternarylogic_epi64(_mm512_srlv_epi64(raw(low), raw(n)), up, down, 0xFE));
}

// The lower halves of one's 64-bit lanes and the upper halves of the other's.
SPANTEX_INLINE v lower_and_upper(v_64 lower, v_64 upper) { return v(_mm512_mask_mov_epi32(raw(lower), 0xAAAA, raw(upper))); }

// Of the even lanes.
SPANTEX_INLINE v_64 wide_products(v_64 a, v_64 b) { return v_64(_mm512_mul_epu32(raw(a), raw(b))); }
SPANTEX_INLINE v_64 wide_signed_products(v_64 a, v_64 b) { return v_64(_mm512_mul_epi32(raw(a), raw(b))); }

// Tables of up to 128 numbers: registers that are permuted.
template <int Count>
SPANTEX_INLINE v look_up(const int32_t (&table)[Count], v at) {
  const auto sixteen = [&](int from) SPANTEX_INLINED {
    return from + 16 <= Count ? _mm512_loadu_si512(table + from) : _mm512_maskz_loadu_epi32(__mmask16((1u << max_of(Count - from, 0)) - 1), table + min_of(from, Count));
  };
  const auto of_32 = [&](int from) SPANTEX_INLINED { return _mm512_permutex2var_epi32(sixteen(from), raw(at), sixteen(from + 16)); };
  raw x = of_32(0);
  if constexpr (Count > 32) x = _mm512_mask_mov_epi32(x, _mm512_test_epi32_mask(raw(at), _mm512_set1_epi32(32)), of_32(32));
  if constexpr (Count > 64) {
    const raw upper_half = Count > 96 ? _mm512_mask_mov_epi32(of_32(64), _mm512_test_epi32_mask(raw(at), _mm512_set1_epi32(32)), of_32(96)) : of_32(64);
    x = _mm512_mask_mov_epi32(x, _mm512_test_epi32_mask(raw(at), _mm512_set1_epi32(64)), upper_half);
  }
  return v(x);
}

// The first lanes as 16-bit numbers, saturated: a span's row or column of them.
SPANTEX_INLINE void put_words(int16_t* to, v x) { _mm_storeu_si128(reinterpret_cast<__m128i*>(to), _mm256_cvtsepi32_epi16(_mm512_castsi512_si256(raw(x)))); }

SPANTEX_INLINE v rounding_products(v a, v b) { return v(_mm512_mulhrs_epi16(raw(a), raw(b))); }  // (a b + 2^14) >> 15
SPANTEX_INLINE v low_products(v a, v b) { return v(_mm512_mullo_epi16(raw(a), raw(b))); }
SPANTEX_INLINE v upper_products16(v a, v b) { return v(_mm512_mulhi_epu16(raw(a), raw(b))); }  // unsigned

// The lower half of lanes 2 k and 2 k + 1 of each 16 bytes, four times each.
SPANTEX_INLINE v low_words(v x, int k) {
  const v first = of_each_quarter(_mm_setr_epi8(0, 1, 0, 1, 0, 1, 0, 1, 4, 5, 4, 5, 4, 5, 4, 5));
  return v(_mm512_shuffle_epi8(raw(x), raw(first + 0x08080808 * k)));
}

// Two rows of texels, interpolated across: pixels 2 k and 2 k + 1 of every four in register k, a channel a word. first is the upper row, negative, change from it
// to the lower one, weight is f of 2^15.
struct blends { v first[2], change[2], weight[2]; };
SPANTEX_INLINE v from_first(v x, v first) { return subtract16(x, first); }

// fraction: u in the lower half of each lane, v in the upper, of 128. Texels are unsigned bytes, and weights negative, so that -128 fits; as in x86.hpp.
SPANTEX_INLINE blends blend(const rgba8* top, const uint32_t* top_at, const rgba8* bottom, const uint32_t* bottom_at, v fraction) {
  const v weights = add16(low_products(fraction, number<int32_t(0xFF01FF01)>()), number<0x00800080>());  // bytes f - 128, -f
  const v v_of_first = of_each_quarter(_mm_setr_epi8(-1, 2, -1, 2, -1, 2, -1, 2, -1, 6, -1, 6, -1, 6, -1, 6));
  const auto across = [&](const rgba8* from, const uint32_t* at, int k, v of_u) SPANTEX_INLINED {
    return v(_mm512_maddubs_epi16(pairs_from<SPANTEX_GATHERS>(from, at, k), raw(of_u)));
  };
  blends b;
#pragma GCC unroll 2
  for (int k = 0; k < 2; ++k) {
    const v of_u = low_words(weights, k);
    b.first[k] = across(top, top_at, k, of_u);
    b.change[k] = subtract16(b.first[k], across(bottom, bottom_at, k, of_u));
    b.weight[k] = v(_mm512_shuffle_epi8(raw(fraction), raw(v_of_first + 0x08000800 * k)));
  }
  return b;
}

SPANTEX_INLINE v packed(v a, v b) { return v(_mm512_packus_epi16(raw(a), raw(b))); }

SPANTEX_INLINE v texels_at(const rgba8* from, const uint32_t* at) { return v(texels_from<SPANTEX_GATHERS>(from, at)); }
