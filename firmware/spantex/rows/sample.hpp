// SPDX-License-Identifier: Apache-2.0
// One pixel of RGB565 from RGB565 texels: filters on the codes as they are, 5-6-5 bits, with weights of 5 bits and one rounding (docs/SPEC.md
// "Rows"). These functions are the specification; kernels.hpp does the same faster.
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>
#include <spantex/rows/packed.hpp>

namespace spantex::rows {

inline constexpr int weight_bits = 5;
inline constexpr int blend_bits = 4;  // fraction of the level of detail

// What is added to a position (2^-16 texel of its level) so that its whole part is the texel and the next 5 bits the weight, to nearest.
inline constexpr int32_t snap = (1 << (15 - weight_bits)) - (1 << 15);

constexpr int32_t texel_of(int32_t snapped) { return snapped >> 16; }
constexpr uint32_t fraction_of(int32_t level) { return uint32_t(level) >> (16 - blend_bits) & ((1u << blend_bits) - 1); }
constexpr uint32_t weight_of(int32_t snapped) { return uint32_t(snapped) >> (16 - weight_bits) & ((1u << weight_bits) - 1); }

struct texels { uint32_t t00, t10, t01, t11; };
struct sums { uint32_t r, g, b; };  // of channel times weight

constexpr sums weighted(uint32_t t, uint32_t w) { return {(t >> 11) * w, (t >> 5 & 63) * w, (t & 31) * w}; }
constexpr sums operator+(sums x, sums y) { return {x.r + y.r, x.g + y.g, x.b + y.b}; }
constexpr sums operator*(sums x, uint32_t w) { return {x.r * w, x.g * w, x.b * w}; }

// To nearest, halves up. Weights sum to 2^bits: a constant comes out exactly, nothing leaves the range of its texels.
constexpr uint16_t rounded(sums s, int bits) {
  const uint32_t half = 1u << bits >> 1;
  return uint16_t(((s.r + half) >> bits) << 11 | ((s.g + half) >> bits) << 5 | (s.b + half) >> bits);
}

// KT88, 4-point: weights of 10 bits.
constexpr sums four_point(const texels& t, uint32_t fu, uint32_t fv) {
  const uint32_t one = 1u << weight_bits;
  return weighted(t.t00, (one - fu) * (one - fv)) + weighted(t.t10, fu * (one - fv)) + weighted(t.t01, (one - fu) * fv) + weighted(t.t11, fu * fv);
}

// KT88, 3-point: weights of 5 bits.
constexpr sums three_point(const texels& t, uint32_t fu, uint32_t fv) {
  const uint32_t one = 1u << weight_bits;
  const bool lower = fv >= fu;
  const uint32_t low = lower ? fu : fv, high = lower ? fv : fu;
  return weighted(t.t11, low) + weighted(lower ? t.t01 : t.t10, high - low) + weighted(t.t00, one - high);
}

// Two levels of four points by the fraction of the level of detail: weights of 14 bits.
constexpr sums between_levels(sums fine, sums coarse, uint32_t fraction) { return fine * ((1u << blend_bits) - fraction) + coarse * fraction; }

}  // namespace spantex::rows
