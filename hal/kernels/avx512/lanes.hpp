// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: the arithmetic of the set-up in lanes. Included by by_blocks.hpp alone, inside its target and namespace.
#pragma once

constexpr profile q = profiles::standard;
static_assert(q.offset_bits == 31 && q.reciprocal_bits == 30 && q.subtexel_bits == 7 && q.level_bits == 8 && q.blend_bits == 7 && q.fine_side == 16 &&
              q.coordinate_bits <= 16 && q.level_bias == 0 && q.mip_bias == -8 && q.formula == level_formula::jacobian && q.scope == level_scope::pixel &&
              q.overflow == overflow_policy::split && q.position_rounding == rounding::nearest && q.exact_set_up && q.colour_rounding == rounding::even,
              "the kernel is written for these");
static_assert(max_extent_log2 == 12 && reach == 7 && reciprocal_seed_bits == 7);

constexpr int batch_size = 8;           // spans
constexpr int quads = 4, quad_side = 4;  // a span's pixels, one register each (quads.hpp)

using v8 = __m512i;   // eight 64-bit lanes: a span each
using v16 = __m512i;  // sixteen 32-bit lanes: a pixel each

template <int32_t X> SPANTEX_INLINE v16 of32() { return _mm512_set1_epi32(number32<X>[0]); }
template <int64_t X> SPANTEX_INLINE v8 of64() { return _mm512_set1_epi64(number64<X>); }
// x, and the compiler knows neither what it is nor where it could be read again.
SPANTEX_INLINE v16 held(v16 x) {
  asm("" : "+v"(x));
  return x;
}

SPANTEX_INLINE v8 bit_length(v8 x) { return _mm512_sub_epi64(_mm512_set1_epi64(64), _mm512_lzcnt_epi64(x)); }
SPANTEX_INLINE v8 set(int64_t x) { return _mm512_set1_epi64(x); }

SPANTEX_INLINE v16 set32(int32_t x) { return _mm512_set1_epi32(x); }
SPANTEX_INLINE v16 upper() { return of32<int32_t(0xFFFF0000)>(); }

struct inverse8 { v8 y, exponent; };

// reciprocal_wide(): its seed, without the 16 zeros below, of 32-bit m in 32-bit lanes, whatever size the lanes are taken for.
SPANTEX_INLINE v16 reciprocal_seeds16(v16 m) {
  const v16 k = _mm512_srli_epi32(m, 31 - reciprocal_seed_bits);  // what is above is not looked at
  const uint16_t* t = reciprocal_seeds.seed;
  const v16 low = _mm512_permutex2var_epi16(_mm512_loadu_si512(t), k, _mm512_loadu_si512(t + 32));
  const v16 high = _mm512_permutex2var_epi16(_mm512_loadu_si512(t + 64), k, _mm512_loadu_si512(t + 96));
  return _mm512_and_si512(_mm512_mask_mov_epi32(low, _mm512_test_epi32_mask(k, of32<64>()), high), of32<0xFFFF>());
}

// Its two steps in 64-bit lanes, of which m's upper halves may be anything; what is above the seed stays above the result. y is never above 2^63 / m, so that it needs no limit and no error is negative after the first step.
SPANTEX_INLINE v8 newton8(v8 m, v8 seed) {
  const v8 error = _mm512_srai_epi64(_mm512_sub_epi64(of64<int64_t(1) << 47>(), _mm512_mul_epu32(m, seed)), 16);
  const v8 y = _mm512_add_epi64(_mm512_slli_epi64(seed, 16), _mm512_srai_epi64(_mm512_mul_epi32(seed, error), 15));
  const v8 rest = _mm512_srli_epi64(_mm512_sub_epi64(of64<INT64_MIN>(), _mm512_mul_epu32(m, y)), 32);
  return _mm512_add_epi64(y, _mm512_srli_epi64(_mm512_mul_epu32(y, rest), 31));
}

// quotient() with its shift given: 63 + exponent - drop - scale.
SPANTEX_INLINE v8 quotient8(v8 n, v8 drop, v8 y, v8 shift) {
  const v8 product = _mm512_mul_epu32(_mm512_srlv_epi64(_mm512_abs_epi64(n), drop), y);
  const v8 half = _mm512_sllv_epi64(of64<1>(), _mm512_sub_epi64(shift, of64<1>()));
  const v8 magnitude = _mm512_srlv_epi64(_mm512_add_epi64(product, half), shift);
  return _mm512_mask_sub_epi64(magnitude, _mm512_movepi64_mask(n), _mm512_setzero_si512(), magnitude);
}

// Of s15.16 in 32 bits half a texel of a level is taken: of the coarsest that has two texels at most.
constexpr int32_t farthest_base = largest_base(filter::aniso) - max_texture_side / 4;

SPANTEX_INLINE v8 whole_quotient8(v8 n, v8 w_bits, const inverse8& iw, __mmask8& usable) {
  const v8 bits = bit_length(_mm512_abs_epi64(n));
  const v8 drop = _mm512_max_epi64(_mm512_sub_epi64(bits, of64<31>()), _mm512_setzero_si512());
  const v8 shift = _mm512_sub_epi64(_mm512_add_epi64(iw.exponent, of64<63>()), drop);
  const v8 r = quotient8(n, drop, iw.y, shift);
  usable &= _mm512_cmple_epi64_mask(bits, _mm512_add_epi64(w_bits, of64<15>()));
  usable &= _mm512_cmple_epi64_mask(_mm512_abs_epi64(r), set(farthest_base));
  return r;
}

SPANTEX_INLINE v8 squares_of(v8 u, v8 v) { return _mm512_add_epi64(_mm512_mul_epi32(u, u), _mm512_mul_epi32(v, v)); }  // of the even lanes
SPANTEX_INLINE v8 times7(v8 x) { return _mm512_sub_epi64(_mm512_slli_epi64(x, 3), x); }
// How far c + x hx + y hy reaches within a span.
SPANTEX_INLINE v8 extent_of(v8 c, v8 x, v8 y) { return _mm512_add_epi64(_mm512_abs_epi64(c), times7(_mm512_add_epi64(_mm512_abs_epi64(x), _mm512_abs_epi64(y)))); }

SPANTEX_INLINE __m256i narrowed(v8 x) { return _mm512_cvtepi64_epi32(x); }
SPANTEX_INLINE void put(int32_t (&to)[batch_size], __m256i x) { _mm256_store_si256(reinterpret_cast<__m256i*>(to), x); }
SPANTEX_INLINE void keep(int32_t (&to)[batch_size], v8 x) { put(to, narrowed(x)); }
SPANTEX_INLINE __m256i got(const int32_t (&from)[batch_size]) { return _mm256_load_si256(reinterpret_cast<const __m256i*>(from)); }
