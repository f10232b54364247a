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

// newton_step() from a seed: y is 2^31 or more, so that its signed value is 2^32 less.
SPANTEX_INLINE v_64 first_newton(v_64 m, v_64 y) {
  const v_64 error = ((uint64_t(1) << 63) - wide_products(m, y)) >> 32;
  const v_64 next = ((y << 31) + wide_signed_products(y, error) + (error << 32)) >> 31;
  return next - (next >> 32);
}

// The same from what it delivered: y may be less than 2^31, but is never above 2^63 / m, so that the error is not negative.
SPANTEX_INLINE v_64 next_newton(v_64 m, v_64 y) {
  const v_64 next = ((y << 31) + wide_products(y, ((uint64_t(1) << 63) - wide_products(m, y)) >> 32)) >> 31;
  return next - (next >> 32);
}

// Seeds by the bits of m behind the first one.
SPANTEX_INLINE v_64 seeds_at(v_64 index) {
  for (size_t k = 0; k < sizeof index / sizeof index[0]; ++k) index[k] = uint32_t(wide_seeds.seed[index[k]]);
  return index;
}

// reciprocal_wide()
SPANTEX_INLINE v_64 reciprocal_wide(v_64 m, v_64 seed) { return next_newton(m, first_newton(m, seed)); }
