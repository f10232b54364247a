// SPDX-License-Identifier: Apache-2.0
// Vector kernels: AVX-512's two ways to read texels that lie anywhere. Intel's gathers take as long as these loads (but where microcode slows them, against
// leaks from them); AMD's, a sequence of loads and more, longer. Included by the machines' files alone.
#pragma once

// Sixteen.
template <bool Gathers>
SPANTEX_INLINE __m512i texels_from(const rgba8* from, const uint32_t* at) {
  if constexpr (Gathers) return _mm512_i32gather_epi32(_mm512_load_si512(at), from, sizeof(rgba8));
  const auto four = [&](const uint32_t* of) SPANTEX_INLINED {
    const auto one = [&](int n) SPANTEX_INLINED {
      int32_t texel;
      __builtin_memcpy(&texel, from + of[n], sizeof(texel));
      return texel;
    };
    return _mm_insert_epi32(_mm_insert_epi32(_mm_insert_epi32(_mm_cvtsi32_si128(one(0)), one(1), 1), one(2), 2), one(3), 3);
  };
  const auto eight = [&](const uint32_t* of) SPANTEX_INLINED { return _mm256_inserti128_si256(_mm256_castsi128_si256(four(of)), four(of + 4), 1); };
  return _mm512_inserti64x4(_mm512_castsi256_si512(eight(at)), eight(at + 8), 1);
}

// Where the bytes of a pair of texels go, channel by channel, in the quarters of a register; of two half registers, each in the lower half of one.
struct alignas(64) pair_orders {
  uint8_t whole[64], halves[64];
  constexpr pair_orders() : whole(), halves() {
    for (int n = 0; n < 64; ++n) {
      const int within = n % 16, byte = within / 8 * 8 + within % 2 * 4 + within / 2 % 4;
      whole[n] = uint8_t(byte);
      halves[n] = uint8_t(n / 32 * 64 + n / 16 % 2 * 16 + byte);
    }
  }
};
constexpr pair_orders pair_order{};

// A texel and the next of eight pixels, channel by channel: of pixels 4 n + 2 k and 4 n + 2 k + 1 in the n-th quarter.
template <bool Gathers>
SPANTEX_INLINE __m512i pairs_from(const rgba8* from, const uint32_t* at, int k) {
  if constexpr (Gathers) {
    const __m512i all = _mm512_load_si512(at), zero = _mm512_setzero_si512(), index = k == 0 ? _mm512_unpacklo_epi32(all, zero) : _mm512_unpackhi_epi32(all, zero);
    return _mm512_shuffle_epi8(_mm512_i64gather_epi64(index, from, sizeof(rgba8)), _mm512_load_si512(pair_order.whole));
  }
  const auto quarter = [&](int n) SPANTEX_INLINED {
    const auto pair = [&](int m) SPANTEX_INLINED { return from + at[4 * n + 2 * k + m]; };
    const __m128i first = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(pair(0)));
    return _mm_castps_si128(_mm_loadh_pi(_mm_castsi128_ps(first), reinterpret_cast<const __m64*>(pair(1))));
  };
  const auto half = [&](int n) SPANTEX_INLINED { return _mm512_castsi256_si512(_mm256_inserti128_si256(_mm256_castsi128_si256(quarter(n)), quarter(n + 1), 1)); };
  return _mm512_permutex2var_epi8(half(0), _mm512_load_si512(pair_order.halves), half(2));
}
