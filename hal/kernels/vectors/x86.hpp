// SPDX-License-Identifier: Apache-2.0
// Vector kernels: what x86 has no operator for. SPANTEX_AVX2 decides between registers of 32 and 16 bytes. Included by ../avx2.cpp and ../sse41.cpp alone.
#pragma once

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
SPANTEX_INLINE v halves(v low, v high) { return v(SPANTEX_OP(blend_epi16)(raw(low), raw(high), 0xAA)); }
template <int K>
SPANTEX_INLINE v lane_of(v x) { return v(SPANTEX_OP(shuffle_epi32)(raw(x), 0x55 * K)); }
SPANTEX_INLINE bool all_equal(v a, int32_t b) { return SPANTEX_OP(movemask_epi8)(raw(a == b)) == int(width == 8 ? 0xFFFFFFFF : 0xFFFF); }

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

// Texels 0 and 1 of two rows.
SPANTEX_INLINE __m128i texels_of(const rgba8* top, const rgba8* bottom) {
  return _mm_castps_si128(_mm_loadh_pi(_mm_castsi128_ps(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(top))), reinterpret_cast<const __m64*>(bottom)));
}

// 2x2 texels of pixels interpolated: pixel k, or k and k + 4, in quad[k], a channel a lane, 22 bits of fraction.
struct blends { v quad[4]; };
constexpr int blend_fraction = 22;

// fraction: u in the lower half of each lane, v in the upper, of 128. Weights are 128 - f and f; texels are unsigned bytes, so that the other factor is
// signed, and the negative weights fit: from -128 on. In the second product the weights' bytes are the upper ones of words.
SPANTEX_INLINE blends blend(const rgba8* top, const uint32_t* top_at, const rgba8* bottom, const uint32_t* bottom_at, v fraction) {
  const v weights = add16(fraction, subtract16(set(0x00800080), v(SPANTEX_OP(slli_epi16)(raw(fraction), 8))));
  const v pairs = of_each_half(_mm_setr_epi8(0, 4, 8, 12, 1, 5, 9, 13, 2, 6, 10, 14, 3, 7, 11, 15));
  const v u_of_first = set(0x01000100), v_of_first = set(int32_t(0x03800280));
  blends b;
#pragma GCC unroll 4
  for (int k = 0; k < 4; ++k) {
#if SPANTEX_AVX2
    const raw t = _mm256_inserti128_si256(_mm256_castsi128_si256(texels_of(top + top_at[k], bottom + bottom_at[k])), texels_of(top + top_at[k + 4], bottom + bottom_at[k + 4]), 1);
#else
    const raw t = texels_of(top + top_at[k], bottom + bottom_at[k]);
#endif
    const raw wu = SPANTEX_OP(shuffle_epi8)(raw(weights), raw(u_of_first + 0x04040404 * k));
    const raw wv = SPANTEX_OP(shuffle_epi8)(raw(weights), raw(v_of_first + 0x04000400 * k));
    b.quad[k] = v(SPANTEX_OP(madd_epi16)(SPANTEX_OP(maddubs_epi16)(SPANTEX_OP(shuffle_epi8)(t, raw(pairs)), wu), wv));
  }
  return b;
}

SPANTEX_INLINE v packed(v a, v b, v c, v d) {
  return v(SPANTEX_OP(packus_epi16)(SPANTEX_OP(packs_epi32)(raw(a), raw(b)), SPANTEX_OP(packs_epi32)(raw(c), raw(d))));
}

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
