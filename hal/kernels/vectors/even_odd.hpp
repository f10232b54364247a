// SPDX-License-Identifier: Apache-2.0
// Vector kernels: products of 64 bits a lane, as machines have them that multiply the lower halves of 64-bit lanes: the even lanes', then the odd ones'.
// low_high.hpp is the same for machines that multiply neighbouring lanes. Included by the machines' files alone.
#pragma once

SPANTEX_INLINE wide products_from(v a, v b, auto&& product) { return {product(v_64(a), v_64(b)), product(v_64(a) >> 32, v_64(b) >> 32)}; }
SPANTEX_INLINE wide unsigned_products(v a, v b) { return products_from(a, b, [](v_64 x, v_64 y) SPANTEX_INLINED { return wide_products(x, y); }); }
SPANTEX_INLINE wide unsigned_products(const wide& x, v y) { return {wide_products(x.first, v_64(y)), wide_products(x.second, v_64(y) >> 32)}; }  // of x below 2^32
SPANTEX_INLINE wide signed_products(v a, v b) { return products_from(a, b, [](v_64 x, v_64 y) SPANTEX_INLINED { return wide_signed_products(x, y); }); }

SPANTEX_INLINE v_64 rounded_shift(v_64 x, int shift) { return down_by(x + (uint64_t(1) << (shift - 1)), shift); }  // to nearest, halves up

SPANTEX_INLINE v narrowed(const wide& x) { return lower_and_upper(x.first, x.second << 32); }

SPANTEX_INLINE v upper_halves(const wide& x) { return lower_and_upper(x.first >> 32, x.second); }

// After a rounded shift by 32 or more.
SPANTEX_INLINE v narrowed(const wide& x, int shift) {
  const uint64_t half = uint64_t(1) << (shift - 1);
  return down_by(lower_and_upper((x.first + half) >> 32, x.second + half), shift - 32);
}

// reciprocal_wide()
SPANTEX_INLINE v reciprocal_wide(v m, v seed) {
  return narrowed({reciprocal_wide(v_64(m), v_64(seed)), reciprocal_wide(v_64(m) >> 32, v_64(seed) >> 32)});
}
