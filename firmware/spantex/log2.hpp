// SPDX-License-Identifier: Apache-2.0
// Integer log2: a count of leading zeros for the integer part, a table with linear interpolation for the fraction
// (KT88 takes the level of detail from log2|W| this way). In units of 2^-16: exact at powers of two, less than
// 1 above the true value, at most 3.91 below it; monotone.
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>

namespace spantex {

inline constexpr int log2_table_bits = 6;

// log2(1 + k/64) as u0.16 to nearest, by repeated squaring (compile time only).
constexpr uint32_t log2_knot(uint32_t k) {
  uint64_t x = (uint64_t(64 + k)) << 25;  // u1.31
  uint32_t result = 0;
  for (int i = 0; i < 18; ++i) {          // two guard bits
    x = (x * x) >> 31;
    result <<= 1;
    if (x >= (uint64_t(1) << 32)) { result |= 1; x >>= 1; }
  }
  return (result + 2) >> 2;
}

struct log2_table {
  uint16_t knot[1 << log2_table_bits];
  constexpr log2_table() : knot() {
    for (uint32_t k = 0; k < (1u << log2_table_bits); ++k) knot[k] = uint16_t(log2_knot(k));
  }
};
inline constexpr log2_table log2_knots{};

// log2(x) for x > 0, 16 fraction bits (s6.16 as an int32_t).
constexpr int32_t log2_16(uint64_t x) {
  const int n = bit_length(x) - 1;
  const uint32_t f = n >= 22 ? uint32_t(x >> (n - 22)) : uint32_t(x) << (22 - n);   // u1.22
  const uint32_t k = (f >> 16) & 63, t = f & 0xFFFF;
  const uint32_t low = log2_knots.knot[k];
  const uint32_t high = k == 63 ? 65536u : log2_knots.knot[k + 1];
  return int32_t((uint32_t(n) << 16) + low + (((high - low) * t + 0x8000) >> 16));
}

}  // namespace spantex
