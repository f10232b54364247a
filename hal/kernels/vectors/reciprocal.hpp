// SPDX-License-Identifier: Apache-2.0
// Vector kernels: spantex/reciprocal.hpp in lanes of 64 bits. Included by the machines' files alone.
#pragma once

struct wide_seed_table {
  int32_t seed[1 << reciprocal_seed_bits];
  constexpr wide_seed_table() : seed() {
    for (int k = 0; k < 1 << reciprocal_seed_bits; ++k) seed[k] = int32_t(uint32_t(reciprocal_seeds.seed[k]) << 16);
  }
};
constexpr wide_seed_table wide_seeds{};

// newton_step(): y (2^64 - m y) / 2^63. Less than 2^32, as y is, since m is 2^31 or more: 2^32 - (2^32 - y)^2 / 2^32 at most.
SPANTEX_INLINE v_64 newton(v_64 m, v_64 y) { return wide_products(y, -wide_products(m, y) >> 32) >> 31; }

// Seeds by the bits of m behind the first one.
SPANTEX_INLINE v_64 seeds_at(v_64 index) {
#if SPANTEX_AVX512
  return v_64(look_up(wide_seeds.seed, v(index))) & 0xFFFFFFFF;
#else
  for (size_t k = 0; k < sizeof index / sizeof index[0]; ++k) index[k] = uint32_t(wide_seeds.seed[index[k]]);
  return index;
#endif
}

// reciprocal_wide()
SPANTEX_INLINE v_64 reciprocal_wide(v_64 m, v_64 seed) { return newton(m, newton(m, seed)); }
