// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: log2 in 32-bit lanes. Included by by_blocks.hpp alone.
#pragma once

// log2 at the 64 knots, and how far it is to the next: u.16.
struct alignas(64) knot_table {
  uint16_t at[64], step[64];
  constexpr knot_table() : at(), step() {
    for (int k = 0; k < 64; ++k) {
      at[k] = uint16_t(log2_knots.knot[k]);
      step[k] = uint16_t((k == 63 ? 65536u : log2_knots.knot[k + 1]) - log2_knots.knot[k]);
    }
  }
};
constexpr knot_table knots{};

// log2_16() of numbers whose uppermost 32 bits, from their first one on, are given, and what their whole part is.
SPANTEX_INLINE v16 log2_of_bits(v16 bits, v16 whole) {
  const v16 f = _mm512_and_si512(_mm512_srli_epi32(bits, 9), of32<0xFFFF>()), k = _mm512_srli_epi32(bits, 25);  // of k, six bits are looked at
  const auto of = [&](const uint16_t (&table)[64]) { return _mm512_maskz_permutex2var_epi16(0x55555555, _mm512_load_si512(table), k, _mm512_load_si512(table + 32)); };
  const v16 part = _mm512_srli_epi32(_mm512_add_epi32(_mm512_mullo_epi32(of(knots.step), f), of32<0x8000>()), 16);
  return _mm512_add_epi32(_mm512_slli_epi32(whole, 16), _mm512_add_epi32(of(knots.at), part));
}

SPANTEX_INLINE v16 log2_of(v16 x) {
  const v16 zeros = _mm512_lzcnt_epi32(x);
  return log2_of_bits(_mm512_sllv_epi32(x, zeros), _mm512_sub_epi32(of32<31>(), zeros));
}

// Of w, told of w - 1, both u2.30.
SPANTEX_INLINE v16 log2_of_w(v16 slope) { return _mm512_sub_epi32(log2_of(_mm512_add_epi32(slope, of32<1 << 30>())), of32<30 << 16>()); }

// level.hpp: level_term(), in 2^-16.
SPANTEX_INLINE v16 level_term16(v16 level) {
  const v16 term = _mm512_srai_epi32(_mm512_add_epi32(level, of32<32>()), 6);
  return _mm512_slli_epi32(_mm512_max_epi32(_mm512_min_epi32(term, of32<32767>()), of32<-32768>()), 6);
}
