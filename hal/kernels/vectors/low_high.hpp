// SPDX-License-Identifier: Apache-2.0
// Vector kernels: products of 64 bits a lane with NEON: the lower lanes', then the upper ones'. See even_odd.hpp. Included by ../neon.cpp alone.
#pragma once

SPANTEX_INLINE wide unsigned_products(v a, v b) {
  const uint32x4_t x = uint32x4_t(a), y = uint32x4_t(b);
  return {v_64(vmull_u32(vget_low_u32(x), vget_low_u32(y))), v_64(vmull_high_u32(x, y))};
}
SPANTEX_INLINE wide signed_products(v a, v b) {
  const int32x4_t x = int32x4_t(a), y = int32x4_t(b);
  return {v_64(vmull_s32(vget_low_s32(x), vget_low_s32(y))), v_64(vmull_high_s32(x, y))};
}

SPANTEX_INLINE v_64 rounded_shift(v_64 x, int shift) { return v_64(vrshlq_u64(uint64x2_t(x), vdupq_n_s64(-shift))); }  // to nearest, halves up

SPANTEX_INLINE v narrowed(const wide& x) { return v(vuzp1q_s32(int32x4_t(x.first), int32x4_t(x.second))); }
SPANTEX_INLINE wide unsigned_products(const wide& x, v y) { return unsigned_products(narrowed(x), y); }  // of x below 2^32

SPANTEX_INLINE v upper_halves(const wide& x) { return v(vuzp2q_s32(int32x4_t(x.first), int32x4_t(x.second))); }

// After a rounded shift, of signed numbers.
SPANTEX_INLINE v narrowed(const wide& x, int shift) {
  const int64x2_t down = vdupq_n_s64(-shift);
  return narrowed({v_64(vrshlq_s64(int64x2_t(x.first), down)), v_64(vrshlq_s64(int64x2_t(x.second), down))});
}

// newton() of reciprocal.hpp.
SPANTEX_INLINE v newton(v m, v y) {
  const wide product = unsigned_products(m, y);
  const uint64x2_t two{};
  const uint32x4_t two_minus = vsubhn_high_u64(vsubhn_u64(two, uint64x2_t(product.first)), two, uint64x2_t(product.second));
  const wide next = unsigned_products(y, v(two_minus));
  return v(vshrn_high_n_u64(vshrn_n_u64(uint64x2_t(next.first), 31), uint64x2_t(next.second), 31));
}

// reciprocal_wide()
SPANTEX_INLINE v reciprocal_wide(v m, v seed) { return newton(m, newton(m, seed)); }
