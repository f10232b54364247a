// SPDX-License-Identifier: Apache-2.0
// Reciprocals: a table of seeds and Newton's iteration y <- y (2 - m y), in integers.
// Input 1 <= m < 2, output 1/m in (1/2, 1]. Worst errors: docs/SPEC.md "Reciprocal", checked exhaustively.
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>
#include <spantex/fixed.hpp>
#include <spantex/profile.hpp>

namespace spantex {

inline constexpr int reciprocal_seed_bits = 7;

// Seed for m in [1 + k/2^bits, 1 + (k+1)/2^bits): the reciprocal of the interval's middle, u0.16. bits <= 10.
constexpr uint32_t reciprocal_seed(uint32_t k, int bits = reciprocal_seed_bits) {
  const uint32_t middle = (2u << bits) + 2 * k + 1;  // u1.bits with half steps
  return ((1u << (17 + bits)) + middle / 2) / middle;
}

struct reciprocal_table {
  uint16_t seed[1 << reciprocal_seed_bits];
  constexpr reciprocal_table() : seed() {
    for (uint32_t k = 0; k < (1u << reciprocal_seed_bits); ++k) seed[k] = uint16_t(reciprocal_seed(k));
  }
};
inline constexpr reciprocal_table reciprocal_seeds{};

// From the table; of one of another size (unit_variants) as the table would be made. m: `fraction` bits below its top bit.
constexpr uint32_t seed_of(uint32_t m, int fraction, int bits) {
  const uint32_t k = (m >> (fraction - bits)) & ((1u << bits) - 1);
  return bits == reciprocal_seed_bits ? reciprocal_seeds.seed[k] : reciprocal_seed(k, bits);
}

// One Newton step in 32 x 32 -> 64: m u1.31, y u0.32.
SPANTEX_WRAPS constexpr uint32_t newton_step(uint32_t m, uint32_t y) {
  const int64_t error = int64_t((uint64_t(1) << 63) - uint64_t(m) * y);   // 1 - m y, 63 fraction bits
  const int64_t next = int64_t(y) + ((int64_t(y) * (error >> 32)) >> 31);
  return next > 0xFFFFFFFFll ? 0xFFFFFFFFu : uint32_t(next);
}

// m: u1.31 with its top bit set. Result: u0.32, less than 4 below 2^63/m and never above it.
constexpr uint32_t reciprocal_wide(uint32_t m, const unit_variants& unit = {}) {
  uint32_t y = seed_of(m, 31, unit.reciprocal_table_log2) << 16;
  for (int k = 0; k < unit.reciprocal_iterations; ++k) y = newton_step(m, y);
  return y;
}

// The same unit with 32-bit products only: m u1.15 with its top bit set, result u0.16, less than 4 below
// 2^31/m and never above it.
SPANTEX_WRAPS constexpr uint32_t reciprocal_narrow(uint32_t m, const unit_variants& unit = {}) {
  const uint32_t y = seed_of(m, 15, unit.reciprocal_table_log2);
  if (unit.reciprocal_iterations == 0) return y;
  const int32_t error = int32_t((uint32_t(1) << 31) - m * y);             // 31 fraction bits
  const int32_t next = int32_t(y) + ((int32_t(y) * (error >> 16)) >> 15);
  return uint32_t(min_of(next, 0xFFFF));
}

// A positive divisor as mantissa and exponent, inverted once and used for every quotient of a span.
struct inverse {
  uint32_t y;    // u0.32: 2^63 / mantissa
  int exponent;  // divisor = mantissa * 2^exponent, mantissa in [2^31, 2^32)
};

// w > 0. The mantissa is w cut to 32 bits (floor): relative error below 2^-31.
constexpr inverse invert(int64_t w) {
  const int exponent = bit_length(uint64_t(w)) - 32;
  const uint32_t m = exponent >= 0 ? uint32_t(uint64_t(w) >> exponent) : uint32_t(w) << -exponent;
  return {reciprocal_wide(m), exponent};
}

// n / w * 2^scale to nearest, odd in n. |n| is cut to 31 bits by dropping `drop` bits (towards zero), so that several quotients can share
// one scale; the caller chooses drop >= bit_length(n) - 31 and a scale for which the result fits 32 bits.
constexpr int32_t quotient(int64_t n, int drop, inverse w, int scale) {
  const uint64_t product = (magnitude(n) >> drop) * w.y;                  // 63 bits
  const int shift = 63 + w.exponent - drop - scale;
  if (shift > 63) return 0;
  const auto q = int32_t((product + (uint64_t(1) << (shift - 1))) >> shift);
  return n < 0 ? -q : q;
}

}  // namespace spantex
