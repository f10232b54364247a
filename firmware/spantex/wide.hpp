// SPDX-License-Identifier: Apache-2.0
// 128-bit signed integers for set-up, where the products of exact coordinates need up to 123 bits. Portable: every target computes the same, with a compiler's own
// product of 64 by 64 bits or without. Two's complement, wrapping; callers keep |x| < 2^126.
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>

namespace spantex {

struct wide {
  int64_t high = 0;
  uint64_t low = 0;

  constexpr wide() = default;
  constexpr wide(int64_t x) : high(x < 0 ? -1 : 0), low(uint64_t(x)) {}
  constexpr wide(int64_t h, uint64_t l) : high(h), low(l) {}

  constexpr bool negative() const { return high < 0; }
  constexpr bool zero() const { return high == 0 && low == 0; }
  friend constexpr bool operator==(const wide&, const wide&) = default;
};

SPANTEX_WRAPS constexpr wide operator+(const wide& a, const wide& b) {
  const uint64_t low = a.low + b.low;
  return {int64_t(uint64_t(a.high) + uint64_t(b.high) + (low < a.low ? 1u : 0u)), low};
}

SPANTEX_WRAPS constexpr wide operator-(const wide& a) {
  return {int64_t(~uint64_t(a.high) + (a.low == 0 ? 1u : 0u)), 0 - a.low};
}

constexpr wide operator-(const wide& a, const wide& b) { return a + -b; }

// Without branches, which would be taken as often as not. sign: all ones, or 0.
constexpr uint64_t sign_of(int64_t x) { return uint64_t(x >> 63); }
SPANTEX_FRAME_APART SPANTEX_WRAPS constexpr void negate_if(wide& a, uint64_t sign) {
  a.low = (a.low ^ sign) - sign;
  a.high = int64_t((uint64_t(a.high) ^ sign) - (a.low == 0 ? sign : 0));
}
SPANTEX_WRAPS constexpr wide magnitude(const wide& a) {
  const uint64_t sign = sign_of(a.high), low = (a.low ^ sign) - sign;
  return {int64_t((uint64_t(a.high) ^ sign) - (low == 0 ? sign : 0)), low};
}

SPANTEX_WRAPS constexpr void add_words(wide& sum, uint64_t low, uint64_t high) {
  sum.low += low;
  sum.high = int64_t(uint64_t(sum.high) + high + (sum.low < low ? 1u : 0u));
}

// sum += a b, unsigned: four products of 32 bits, each added where it belongs.
SPANTEX_FRAME_APART constexpr void accumulate_by_words(wide& sum, uint64_t a, uint64_t b) {
  if (products_are_calls && (a == 0 || b == 0)) return;  // planes that face the viewer have many
  const uint32_t a0 = uint32_t(a), a1 = uint32_t(a >> 32), b0 = uint32_t(b), b1 = uint32_t(b >> 32);
  add_words(sum, multiply_32(a0, b0), multiply_32(a1, b1));
  const uint64_t first = multiply_32(a0, b1);
  add_words(sum, first << 32, first >> 32);
  const uint64_t second = multiply_32(a1, b0);
  add_words(sum, second << 32, second >> 32);
}

// The same by one product, where the compiler has it.
constexpr void accumulate(wide& sum, uint64_t a, uint64_t b) {
#ifdef __SIZEOF_INT128__
  __extension__ using product = unsigned __int128;
  const product p = product(a) * b;
  add_words(sum, uint64_t(p), uint64_t(p >> 64));
#else
  accumulate_by_words(sum, a, b);
#endif
}

// sum += a b: exact, as the product. In two's complement: a negative factor is 2^64 too large as an unsigned one.
SPANTEX_FRAME_APART SPANTEX_WRAPS constexpr void add_product(wide& sum, int64_t a, int64_t b) {
  sum.high = int64_t(uint64_t(sum.high) - (sign_of(a) & uint64_t(b)) - (sign_of(b) & uint64_t(a)));
  accumulate(sum, uint64_t(a), uint64_t(b));
}

// The same of 128 x 64 bits. The caller guarantees that the product fits.
SPANTEX_FRAME_APART SPANTEX_WRAPS constexpr void add_product(wide& sum, const wide& a, int64_t b) {
  const bool small = products_are_calls && (a.high == 0 || a.high == -1);
  const uint64_t top = small ? uint64_t(a.high) & (0 - uint64_t(b)) : uint64_t(a.high) * uint64_t(b);
  sum.high = int64_t(uint64_t(sum.high) + top - (sign_of(b) & a.low));
  accumulate(sum, a.low, uint64_t(b));
}

// 64 x 64 -> 128, signed, exact.
constexpr wide multiply(int64_t a, int64_t b) {
  wide p;
  add_product(p, a, b);
  return p;
}

// 128 x 64 -> 128. The caller guarantees that the product fits.
constexpr wide multiply(const wide& a, int64_t b) {
  wide p;
  add_product(p, a, b);
  return p;
}

constexpr int bit_length(const wide& a) {
  const wide m = magnitude(a);
  return m.high != 0 ? 64 + bit_length(uint64_t(m.high)) : bit_length(m.low);
}

constexpr wide shift_left(const wide& a, int n) {
  if (n == 0) return a;
  if (n >= 64) return {int64_t(a.low << (n - 64)), 0};
  return {int64_t((uint64_t(a.high) << n) | (a.low >> (64 - n))), a.low << n};
}

constexpr wide shift_right_floor(const wide& a, int n) {
  if (n == 0) return a;
  if (n >= 64) return wide(a.high >> (n == 64 ? 0 : n - 64));
  return {a.high >> n, (uint64_t(a.high) << (64 - n)) | (a.low >> n)};
}

// The low 64 bits of that.
constexpr uint64_t low_after(const wide& a, int n) { return n >= 64 ? uint64_t(a.high >> (n - 64)) : n == 0 ? a.low : (uint64_t(a.high) << (64 - n)) | (a.low >> n); }

// a / 2^n to nearest, halves away from zero; in place.
SPANTEX_FRAME_APART SPANTEX_WRAPS constexpr void round_off(wide& a, int n) {
  if (n == 0) return;
  const uint64_t sign = sign_of(a.high);
  negate_if(a, sign);
  const uint64_t half = (n > 64 ? uint64_t(a.high) >> (n - 65) : a.low >> (n - 1)) & 1;
  a = shift_right_floor(a, n);
  add_words(a, half, 0);
  negate_if(a, sign);
}
constexpr wide shift_right_nearest(const wide& a, int n) {
  wide out = a;
  round_off(out, n);
  return out;
}

// a * 2^-n for any sign of n, to nearest.
constexpr wide scale_down(const wide& a, int n) { return n >= 0 ? shift_right_nearest(a, n) : shift_left(a, -n); }

constexpr bool operator<(const wide& a, const wide& b) { return (a - b).negative(); }

// The low 64 bits as a signed number. The caller guarantees that the value fits.
constexpr int64_t to_int64(const wide& a) { return int64_t(a.low); }

// Quotient a / b to nearest (halves away from zero), b > 0, |quotient| < 2^63. One bit a step: set-up only.
SPANTEX_FRAME_APART SPANTEX_WRAPS constexpr int64_t divide_nearest(const wide& a, int64_t b) {
  const wide m = magnitude(a);
  uint64_t remainder = 0, quotient = 0;
  for (int i = bit_length(m) - 1; i >= 0; --i) {
    const uint64_t bit = i >= 64 ? (uint64_t(m.high) >> (i - 64)) & 1 : (m.low >> i) & 1;
    remainder = (remainder << 1) | bit;
    quotient <<= 1;
    if (remainder >= uint64_t(b)) { remainder -= uint64_t(b); quotient |= 1; }
  }
  if (remainder >= uint64_t(b) - remainder) ++quotient;
  return a.negative() ? int64_t(0 - quotient) : int64_t(quotient);
}

}  // namespace spantex
