// SPDX-License-Identifier: Apache-2.0
// Vector kernels: what x86 has no operator for. SPANTEX_AVX2 decides between registers of 32 and 16 bytes. Included by ../avx2.cpp and ../sse41.cpp alone.
#pragma once

#if SPANTEX_AVX2
#define SPANTEX_OP(name) _mm256_##name
#define SPANTEX_BITS(name) _mm256_##name##_si256
using raw = __m256i;
#else
#define SPANTEX_OP(name) _mm_##name
#define SPANTEX_BITS(name) _mm_##name##_si128
using raw = __m128i;
#endif

constexpr int width = sizeof(raw) / sizeof(int32_t);
typedef int32_t v __attribute__((vector_size(sizeof(raw))));

// Sixteen bytes in each half of a register.
SPANTEX_INLINE v of_each_half(__m128i x) {
#if SPANTEX_AVX2
  return v(_mm256_broadcastsi128_si256(x));
#else
  return v(x);
#endif
}

SPANTEX_INLINE v set(int32_t x) { return v(SPANTEX_OP(set1_epi32)(x)); }
SPANTEX_INLINE v get(const int32_t* from) { return v(SPANTEX_BITS(load)(reinterpret_cast<const raw*>(from))); }
SPANTEX_INLINE void put(int32_t* to, v x) { SPANTEX_BITS(store)(reinterpret_cast<raw*>(to), raw(x)); }
SPANTEX_INLINE void put(rgba8* to, v x) { SPANTEX_BITS(storeu)(reinterpret_cast<raw*>(to), raw(x)); }
SPANTEX_INLINE v least(v a, v b) { return v(SPANTEX_OP(min_epi32)(raw(a), raw(b))); }
SPANTEX_INLINE v largest(v a, v b) { return v(SPANTEX_OP(max_epi32)(raw(a), raw(b))); }
SPANTEX_INLINE v products(v a, v b) { return v(SPANTEX_OP(madd_epi16)(raw(a), raw(b))); }  // of both halves of a lane, added up
SPANTEX_INLINE v halves(v low, v high) { return v(SPANTEX_OP(blend_epi16)(raw(low), raw(high), 0xAA)); }
SPANTEX_INLINE v add16(v a, v b) { return v(SPANTEX_OP(add_epi16)(raw(a), raw(b))); }
SPANTEX_INLINE v subtract16(v a, v b) { return v(SPANTEX_OP(sub_epi16)(raw(a), raw(b))); }
SPANTEX_INLINE v least16(v a, v b) { return v(SPANTEX_OP(min_epi16)(raw(a), raw(b))); }
SPANTEX_INLINE v largest16(v a, v b) { return v(SPANTEX_OP(max_epi16)(raw(a), raw(b))); }
SPANTEX_INLINE v least16_unsigned(v a, v b) { return v(SPANTEX_OP(min_epu16)(raw(a), raw(b))); }
SPANTEX_INLINE v levels16(const int16_t* from) {
#if SPANTEX_AVX2
  return v(_mm256_slli_epi32(_mm256_cvtepi16_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(from))), 6));
#else
  return v(_mm_slli_epi32(_mm_cvtepi16_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(from))), 6));
#endif
}
SPANTEX_INLINE bool all_equal(v a, int32_t b) {
  return SPANTEX_OP(movemask_epi8)(SPANTEX_OP(cmpeq_epi32)(raw(a), SPANTEX_OP(set1_epi32)(b))) == int(width == 8 ? 0xFFFFFFFF : 0xFFFF);
}
SPANTEX_INLINE v half_pixels_across() {
#if SPANTEX_AVX2
  return v{-7, -5, -3, -1, 1, 3, 5, 7};
#else
  return v{-7, -5, -3, -1};
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

// To whole numbers, halves to even.
SPANTEX_INLINE v even(v x, int fraction) { return (x + ((1 << (fraction - 1)) - 1) + ((x >> fraction) & 1)) >> fraction; }

SPANTEX_INLINE v packed(const v (&x)[4]) {
  const auto words = [](v a, v b) { return SPANTEX_OP(packs_epi32)(raw(a), raw(b)); };
  return v(SPANTEX_OP(packus_epi16)(words(x[0], x[1]), words(x[2], x[3])));
}

SPANTEX_INLINE v pixels_of(const blends& b) {
  v x[4];
#pragma GCC unroll 4
  for (int k = 0; k < 4; ++k) x[k] = even(b.quad[k], blend_fraction);
  return packed(x);
}

// Two levels, each rounded to 7 bits of fraction first; fraction of 256 a lane.
SPANTEX_INLINE v pixels_between(const blends& fine, const blends& coarse, v fraction) {
  constexpr int drop = blend_fraction - q.blend_bits;
  const v weights = (fraction << 16) + (256 - fraction);
  v x[4];
#define SPANTEX_BETWEEN(k)                                                                                                            \
  x[k] = even(products(halves((fine.quad[k] + (1 << (drop - 1))) >> drop, (coarse.quad[k] + (1 << (drop - 1))) << (16 - drop)), \
                                                    v(SPANTEX_OP(shuffle_epi32)(raw(weights), 0x55 * (k)))), \
              q.blend_bits + q.level_bits)
  SPANTEX_BETWEEN(0);
  SPANTEX_BETWEEN(1);
  SPANTEX_BETWEEN(2);
  SPANTEX_BETWEEN(3);
#undef SPANTEX_BETWEEN
  return packed(x);
}

// One level of two: the coarse one has no weight.
SPANTEX_INLINE v pixels_of_level(const blends& b) {
  constexpr int drop = blend_fraction - q.blend_bits;
  v x[4];
#pragma GCC unroll 4
  for (int k = 0; k < 4; ++k) x[k] = even((b.quad[k] + (1 << (drop - 1))) >> drop, q.blend_bits);
  return packed(x);
}

SPANTEX_INLINE v texels_at(const rgba8* from, const uint32_t* at) {
  alignas(sizeof(raw)) int32_t out[width];
#pragma GCC unroll 8
  for (int k = 0; k < width; ++k) __builtin_memcpy(out + k, from + at[k], sizeof(rgba8));
  return get(out);
}
