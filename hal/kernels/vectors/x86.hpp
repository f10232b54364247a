// SPDX-License-Identifier: Apache-2.0
// Vector kernels: what x86 has no operator for. SPANTEX_AVX2 decides between registers of 32 and 16 bytes. Included by ../avx2.cpp and ../sse41.cpp alone.
#pragma once

constexpr bool places_first = true, moves_texels = true, spares_levels = false;
constexpr int row_pairs_at_once = 4;  // of positions with levels
typedef int32_t level_number;  // of a pixel, in memory

#if SPANTEX_AVX2
#define SPANTEX_OP(name) _mm256_##name
using raw = __m256i;
#else
#define SPANTEX_OP(name) _mm_##name
using raw = __m128i;
#endif

static_assert(sizeof(v) == sizeof(raw));

// Sixteen bytes in each half of a register.
SPANTEX_INLINE v of_each_half(__m128i x) {
#if SPANTEX_AVX2
  return v(_mm256_broadcastsi128_si256(x));
#else
  return v(x);
#endif
}

SPANTEX_INLINE v products(v a, v b) { return v(SPANTEX_OP(madd_epi16)(raw(a), raw(b))); }  // of both halves of a lane, added up
SPANTEX_INLINE v add_products(v c, v a, v b) { return c + products(a, b); }
SPANTEX_INLINE v halves(v low, v high) { return v(SPANTEX_OP(blend_epi16)(raw(low), raw(high), 0xAA)); }
SPANTEX_INLINE v rounded_shift(v x, int shift) { return down_by(x + (1 << (shift - 1)), shift); }  // to nearest, halves up
SPANTEX_INLINE v_32 rounded_shift(v_32 x, int shift) { return (x >> shift) + (x >> (shift - 1) & 1); }
SPANTEX_INLINE bool all_equal(v a, int32_t b) { return SPANTEX_OP(movemask_epi8)(raw(a == b)) == int(width == 8 ? 0xFFFFFFFF : 0xFFFF); }

// 64-bit lanes; a product's shift is 1 or more and rounds halves up.
SPANTEX_INLINE v_s64 size_of(v_s64 x) { return negated_where(x, x < 0); }
#if SPANTEX_AVX2
SPANTEX_INLINE v_s64 bit_lengths(v_s64 x) {
  for (int k = 0; k < width / 2; ++k) x[k] = int64_t(_lzcnt_u64(uint64_t(x[k])));
  return 64 - x;
}
SPANTEX_INLINE uint32_t signs_of(v_s64 x) { return uint32_t(_mm256_movemask_pd(__m256d(x))); }
// The lower half of 128-bit numbers shifted down by as many bits, 0 to 127. What is shifted by more than a lane has is 0.
SPANTEX_INLINE v_64 low_after(v_64 low, v_64 high, v_64 n) {
  const raw up = _mm256_sllv_epi64(raw(high), raw(64 - n)), down = _mm256_srlv_epi64(raw(high), raw(n - 64));
  return v_64(_mm256_or_si256(_mm256_srlv_epi64(raw(low), raw(n)), _mm256_or_si256(up, down)));
}
#endif
SPANTEX_INLINE v_64 rounded_shift(v_64 x, v_64 shift) { return (x + ((v_64{} + 1) << (shift - 1))) >> shift; }

// The lower halves of one's 64-bit lanes and the upper halves of the other's.
SPANTEX_INLINE v lower_and_upper(v_64 lower, v_64 upper) {
#if SPANTEX_AVX2
  return v(_mm256_blend_epi32(raw(lower), raw(upper), 0xAA));
#else
  return v(_mm_blend_epi16(raw(lower), raw(upper), 0xCC));
#endif
}

// Of the even lanes.
SPANTEX_INLINE v_64 wide_products(v_64 a, v_64 b) { return v_64(SPANTEX_OP(mul_epu32)(raw(a), raw(b))); }
SPANTEX_INLINE v_64 wide_signed_products(v_64 a, v_64 b) { return v_64(SPANTEX_OP(mul_epi32)(raw(a), raw(b))); }
SPANTEX_INLINE v look_up(const int32_t* table, v at) {
#if SPANTEX_AVX2
  return v(_mm256_i32gather_epi32(table, raw(at), 4));
#else
  return v{table[at[0]], table[at[1]], table[at[2]], table[at[3]]};
#endif
}

// The lanes as 16-bit numbers, saturated.
SPANTEX_INLINE void put_words(int16_t* to, v x) {
  const raw words = SPANTEX_OP(packs_epi32)(raw(x), raw(x));
#if SPANTEX_AVX2
  _mm_storeu_si128(reinterpret_cast<__m128i*>(to), _mm256_castsi256_si128(_mm256_permute4x64_epi64(words, 0xD8)));
#else
  _mm_storel_epi64(reinterpret_cast<__m128i*>(to), words);
#endif
}

// Two texels each.
SPANTEX_INLINE __m128i texels_of(const rgba8* first, const rgba8* second) {
  return _mm_castps_si128(_mm_loadh_pi(_mm_castsi128_ps(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(first))), reinterpret_cast<const __m64*>(second)));
}

SPANTEX_INLINE v rounding_products(v a, v b) { return v(SPANTEX_OP(mulhrs_epi16)(raw(a), raw(b))); }  // (a b + 2^14) >> 15
SPANTEX_INLINE v low_products(v a, v b) { return v(SPANTEX_OP(mullo_epi16)(raw(a), raw(b))); }
SPANTEX_INLINE v upper_products16(v a, v b) { return v(SPANTEX_OP(mulhi_epu16)(raw(a), raw(b))); }  // unsigned

// The lower half of lanes 2 k and 2 k + 1 of each 16 bytes, four times each.
SPANTEX_INLINE v low_words(v x, int k) {
  const v first = of_each_half(_mm_setr_epi8(0, 1, 0, 1, 0, 1, 0, 1, 4, 5, 4, 5, 4, 5, 4, 5));
  return v(SPANTEX_OP(shuffle_epi8)(raw(x), raw(first + 0x08080808 * k)));
}

// Two rows of texels, interpolated across: pixels 2 k and 2 k + 1 (and 2 k + 4, 2 k + 5) in register k, a channel a word. first is the upper row, negative, change from it
// to the lower one, weight is f of 2^15.
struct blends { v first[2], change[2], weight[2]; };
SPANTEX_INLINE v from_first(v x, v first) { return subtract16(x, first); }

// Two pixels' texels in each half of a register: two of each pixel, or four from the first one on.
SPANTEX_INLINE v two_texels_each(const rgba8* from, const uint32_t* at) {
#if SPANTEX_AVX2
  return v(_mm256_inserti128_si256(_mm256_castsi128_si256(texels_of(from + at[0], from + at[1])), texels_of(from + at[4], from + at[5]), 1));
#else
  return v(texels_of(from + at[0], from + at[1]));
#endif
}
SPANTEX_INLINE v four_texels_each(const rgba8* from, const uint32_t* at) {
  const auto four = [&](int k) { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(from + at[k])); };
#if SPANTEX_AVX2
  return v(_mm256_inserti128_si256(_mm256_castsi128_si256(four(0)), four(4), 1));
#else
  return v(four(0));
#endif
}

// A row of texels interpolated across: as blends has them, negative. Weights are 128 - f and f; texels are unsigned bytes, so that the other factor is signed, and the negative
// weights fit: from -128 on. shuffle: which bytes are a texel and the next, channel by channel.
SPANTEX_INLINE v weights_across(v fraction) { return add16(fraction, subtract16(number<0x00800080>(), v(SPANTEX_OP(slli_epi16)(raw(fraction), 8)))); }
SPANTEX_INLINE v across(v texels, v shuffle, v weights) { return v(SPANTEX_OP(maddubs_epi16)(SPANTEX_OP(shuffle_epi8)(raw(texels), raw(shuffle)), raw(weights))); }

// fraction: u in the lower half of each lane, v in the upper, of 128.
SPANTEX_INLINE blends blend(const rgba8* top, const uint32_t* top_at, const rgba8* bottom, const uint32_t* bottom_at, v fraction) {
  const v pairs = of_each_half(_mm_setr_epi8(0, 4, 1, 5, 2, 6, 3, 7, 8, 12, 9, 13, 10, 14, 11, 15));
  const v weights = weights_across(fraction), v_of_first = of_each_half(_mm_setr_epi8(-1, 2, -1, 2, -1, 2, -1, 2, -1, 6, -1, 6, -1, 6, -1, 6));
  blends b;
#pragma GCC unroll 2
  for (int k = 0; k < 2; ++k) {
    const v of_u = low_words(weights, k);
    b.first[k] = across(two_texels_each(top, top_at + 2 * k), pairs, of_u);
    b.change[k] = subtract16(b.first[k], across(two_texels_each(bottom, bottom_at + 2 * k), pairs, of_u));
    b.weight[k] = v(SPANTEX_OP(shuffle_epi8)(raw(fraction), raw(v_of_first + 0x08000800 * k)));
  }
  return b;
}

SPANTEX_INLINE v packed(v a, v b) { return v(SPANTEX_OP(packus_epi16)(raw(a), raw(b))); }

SPANTEX_INLINE __m128i four_texels(const rgba8* from, const uint32_t* at) {  // by insertion: single stores would be waited for by the load of all
  const auto texel = [&](int k) {
    int32_t t;
    __builtin_memcpy(&t, from + at[k], sizeof t);
    return t;
  };
  return _mm_insert_epi32(_mm_insert_epi32(_mm_insert_epi32(_mm_cvtsi32_si128(texel(0)), texel(1), 1), texel(2), 2), texel(3), 3);
}
SPANTEX_INLINE v texels_at(const rgba8* from, const uint32_t* at) {
#if SPANTEX_AVX2
  return v(_mm256_inserti128_si256(_mm256_castsi128_si256(four_texels(from, at)), four_texels(from, at + 4), 1));
#else
  return v(four_texels(from, at));
#endif
}
