// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: log2 in 32-bit lanes. Included by ../avx512.cpp alone.
#pragma once

// log2 at a knot in the lower half, and how far it is to the next in the upper one.
struct alignas(64) knot_table {
  uint32_t of[64];
  constexpr knot_table() : of() {
    for (int k = 0; k < 64; ++k) of[k] = log2_knots.knot[k] | ((k == 63 ? 65536u : log2_knots.knot[k + 1]) - log2_knots.knot[k]) << 16;
  }
};
constexpr knot_table knots{};

// log2_16() of numbers whose uppermost 32 bits, from their first one on, are given, and what their whole part is.
SPANTEX_INLINE v16 log2_of_bits(v16 bits, v16 whole) {
  const v16 f = _mm512_srli_epi32(bits, 9), k = _mm512_srli_epi32(bits, 25), word = of32<0xFFFF>();  // of k, six bits are looked at
  const auto table = [](int at) SPANTEX_INLINED { return _mm512_load_si512(knots.of + at); };
  const v16 low = _mm512_permutex2var_epi32(table(0), k, table(16)), high = _mm512_permutex2var_epi32(table(32), k, table(48));
  const v16 knot = _mm512_mask_mov_epi32(low, _mm512_test_epi32_mask(k, of32<32>()), high);
  const v16 part = _mm512_srli_epi32(_mm512_add_epi32(_mm512_mullo_epi32(_mm512_srli_epi32(knot, 16), _mm512_and_si512(f, word)), of32<0x8000>()), 16);
  return _mm512_add_epi32(_mm512_slli_epi32(whole, 16), _mm512_add_epi32(_mm512_and_si512(knot, word), part));
}

SPANTEX_INLINE v16 log2_of(v16 x) {
  const v16 zeros = _mm512_lzcnt_epi32(x);
  return log2_of_bits(_mm512_sllv_epi32(x, zeros), _mm512_sub_epi32(of32<31>(), zeros));
}

// level.hpp: level_term(), in 2^-16.
SPANTEX_INLINE v16 level_term16(v16 level) {
  const v16 term = _mm512_srai_epi32(_mm512_add_epi32(level, of32<32>()), 6);
  return _mm512_slli_epi32(_mm512_max_epi32(_mm512_min_epi32(term, of32<32767>()), of32<-32768>()), 6);
}
