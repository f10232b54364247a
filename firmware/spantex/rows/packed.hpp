// SPDX-License-Identifier: Apache-2.0
// Pairs of 16-bit numbers in one word, and RGB565 colours as numbers that can be weighted: with the DSP instructions of Cortex-M4, M7, M33 and M55
// where there are any, else in plain C++; the same numbers either way (tests/unit/rows.cpp, and the hashes of `make targets`).
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>

#if defined(__ARM_FEATURE_DSP) && __ARM_FEATURE_DSP && defined(__ARMEL__)
#define SPANTEX_ROWS_DSP 1
#else
#define SPANTEX_ROWS_DSP 0
#endif

namespace spantex::rows {

// Texels may lie in memory that was written as words.
using texel565 = uint16_t __attribute__((__may_alias__));

// v's upper half over u's: the whole parts of two positions.
inline uint32_t upper_halves(int32_t v, int32_t u) {
#if SPANTEX_ROWS_DSP
  uint32_t result;
  asm("pkhtb %0, %1, %2, asr #16" : "=r"(result) : "r"(v), "r"(u));
  return result;
#else
  return (uint32_t(v) & 0xFFFF0000u) | uint32_t(u) >> 16;
#endif
}

// Sum of the products of the two halves (signed), and an addend; modulo 2^32.
SPANTEX_WRAPS inline uint32_t dot(uint32_t x, uint32_t y, uint32_t addend) {
#if SPANTEX_ROWS_DSP
  uint32_t result;
  asm("smlad %0, %1, %2, %3" : "=r"(result) : "r"(x), "r"(y), "r"(addend));
  return result;
#else
  return addend + uint32_t(int32_t(int16_t(x)) * int16_t(y)) + uint32_t((int32_t(x) >> 16) * (int32_t(y) >> 16));
#endif
}

// Two texels side by side, the left one in the lower half.
inline uint32_t pair_at(const texel565* p) {
#if defined(__ARM_FEATURE_UNALIGNED) && defined(__ARMEL__)
  struct __attribute__((packed, may_alias)) unaligned { uint32_t word; };
  return reinterpret_cast<const unaligned*>(p)->word;
#else
  return p[0] | uint32_t(p[1]) << 16;
#endif
}

// Channels far enough apart for weights of 5 bits: green 21..31, red 11..20, blue 0..10.
inline constexpr uint32_t spread_mask = 0x07E0F81F;
constexpr uint32_t spread(uint32_t texel) { return (texel | texel << 16) & spread_mask; }
constexpr uint32_t gathered(uint32_t colour) { return (colour | colour >> 16) & 0xFFFF; }

}  // namespace spantex::rows
