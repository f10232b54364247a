// SPDX-License-Identifier: Apache-2.0
// Vector kernels: spantex/log2.hpp in lanes. Included by the machines' files alone.
#pragma once

struct knot_table {
  int32_t pair[1 << log2_table_bits];  // a knot, and in the upper half how far the next one is
  constexpr knot_table() : pair() {
    for (int k = 0; k < 1 << log2_table_bits; ++k) {
      const uint32_t low = log2_knots.knot[k], high = k == (1 << log2_table_bits) - 1 ? 65536u : log2_knots.knot[k + 1];
      pair[k] = int32_t(low | (high - low) << 16);
    }
  }
};
constexpr knot_table knots{};

constexpr int significand_bits = 22;  // that log2_16() looks at

// The fraction of log2_16(), from the bits behind the first one.
SPANTEX_INLINE v log2_fraction(v bits) {
  const v pair = look_up(knots.pair, (bits >> 16) & 63);
  return (pair & 0xFFFF) + (v((v_32(pair) >> 16) * v_32(bits & 0xFFFF) + 0x8000) >> 16);
}

// log2 of w in (1/2, 3/2), s.16.
SPANTEX_INLINE v log2_of_w(v w) {
  const v below_one = (w >> 30) - 1;
  return (below_one << 16) + log2_fraction((w + (w & below_one)) >> (30 - significand_bits));
}

// Where the first bit is, and those behind it.
SPANTEX_INLINE int32_t normalised(uint64_t x) {
  const int zeros = __builtin_clzll(x + (x == 0));
  return int32_t((x << zeros) >> (63 - significand_bits)) + (62 - zeros) * (1 << significand_bits);
}

// Half of log2_16() of what was normalised, not zero: log2 of a length from its square.
SPANTEX_INLINE v half_log2_of(v x) { return (((x >> significand_bits) << 16) + log2_fraction(x)) >> 1; }

// Squares of lengths.
SPANTEX_INLINE wide squares_of(v x, v y) {
  const wide a = signed_products(x, x), b = signed_products(y, y);
  return {a.first + b.first, a.second + b.second};
}

template <int N>
SPANTEX_INLINE void half_log2_of(v (&x)[N]) {
  for (v& one : x) one = half_log2_of(one);
}

#if SPANTEX_AVX512
// Normalised. False where one of them is zero.
template <int N>
SPANTEX_INLINE bool normalised(const wide (&s)[N], v* out) {
  __mmask8 zero = 0;
  const auto one = [&](v_64 x) SPANTEX_INLINED {
    zero |= _mm512_testn_epi64_mask(raw(x), raw(x));
    const v_64 zeros = v_64(_mm512_lzcnt_epi64(raw(x)));
    return ((x << zeros) >> (63 - significand_bits)) + ((62 - zeros) << significand_bits);
  };
  for (int n = 0; n < N; ++n) out[n] = narrowed({one(s[n].first), one(s[n].second)});
  return zero == 0;
}
#else
// Normalised. False where one of them is zero.
template <int N>
SPANTEX_INLINE bool normalised(const wide (&s)[N], v* out) {
  constexpr int half = width / 2, drop = 63 - significand_bits;
  uint64_t any = 0, all = UINT64_MAX;
  v_64 either{}, both = ~either;
  for (const wide& one : s) either |= one.first | one.second;
  for (int k = 0; k < half; ++k) any |= either[k];
  const int zeros = __builtin_clzll(any | 1);
  for (const wide& one : s) both &= up_by(one.first & one.second, zeros);
  for (int k = 0; k < half; ++k) all &= both[k];
  if (all >> 63 != 0) [[likely]] {  // one shift for all of them, as their lengths are much the same
    for (int n = 0; n < N; ++n) out[n] = narrowed({up_by(s[n].first, zeros) >> drop, up_by(s[n].second, zeros) >> drop}) + (62 - zeros) * (1 << significand_bits);
    return true;
  }
  bool nonzero = true;
  for (int n = 0; n < N; ++n) {
    wide one = s[n];
    for (int k = 0; k < half; ++k) {
      nonzero &= one.first[k] != 0 && one.second[k] != 0;
      one.first[k] = uint32_t(normalised(one.first[k]));
      one.second[k] = uint32_t(normalised(one.second[k]));
    }
    out[n] = narrowed(one);
  }
  return nonzero;
}
#endif
