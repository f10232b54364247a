// SPDX-License-Identifier: Apache-2.0
// Integer 2^x: the integer part shifts, a table with linear interpolation gives the fraction. The counterpart of log2.hpp.
// Relative error: a chord over 1/64 is at most 2^-16.1 high, the knots and the last rounding add less than 2^-16.
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>

namespace spantex {

inline constexpr int exp2_table_bits = 6;

// Largest r with r r <= x (compile time only).
constexpr uint64_t square_root(uint64_t x) {
  uint64_t low = 0, high = uint64_t(1) << 32;
  while (high - low > 1) {
    const uint64_t middle = (low + high) / 2;
    if (middle * middle <= x)
      low = middle;
    else
      high = middle;
  }
  return low;
}

// 2^(k/64) as u1.16 to nearest, k = 0..64, as a product of 2^(1/2), 2^(1/4) .. (compile time only).
constexpr uint32_t exp2_knot(uint32_t k) {
  if (k == 64) return 1u << 17;
  uint64_t root = 1u << 31, product = 1u << 30;  // u.30: 2^(2 bit / 64), the result
  for (uint32_t bit = 32; bit != 0; bit >>= 1) {
    root = square_root(root << 30);
    if ((k & bit) != 0) product = (product * root + (1u << 29)) >> 30;
  }
  return uint32_t((product + (1u << 13)) >> 14);
}

struct exp2_table {
  uint32_t knot[(1 << exp2_table_bits) + 1];
  constexpr exp2_table() : knot() {
    for (uint32_t k = 0; k <= 1u << exp2_table_bits; ++k) knot[k] = exp2_knot(k);
  }
};
inline constexpr exp2_table exp2_knots{};

// 2^x for x with 16 fraction bits, -16 <= x < 15; 16 fraction bits.
constexpr uint32_t exp2_16(int32_t x) {
  const int whole = x >> 16;
  const uint32_t k = (uint32_t(x) >> 10) & 63, t = uint32_t(x) & 1023;
  const uint32_t low = exp2_knots.knot[k], high = exp2_knots.knot[k + 1];
  const uint64_t fraction = (uint64_t(low) << 10) + (high - low) * t;  // u1.26
  return uint32_t(scale_down(fraction, 10 - whole));
}

}  // namespace spantex
