// SPDX-License-Identifier: Apache-2.0
// Interpolation of one channel (KT88: 3- and 4-point; VR11: trilinear from eight values). Every weight pair sums to a power of two
// and every rounding is of a convex combination: a constant comes out exactly, and the result stays between its texels.
//
// Input texels 8 bits; weights f / 2^weight_bits, 0 <= f < 2^weight_bits. Intermediate: colour with `bits` fraction bits, at most 24,
// in 32 bits unsigned: 255 * 2^24 < 2^32, so nothing overflows.
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>
#include <spantex/local_memory.hpp>
#include <spantex/profile.hpp>

namespace spantex {

inline constexpr int max_blend_bits = 24;
static_assert(8 + max_blend_bits <= 32, "a colour and its fraction fit 32 bits; is_valid() keeps blend_bits and 2 subtexel_bits within 24");

// A colour between two stages: value / 2^bits.
struct partial_colour {
  uint32_t value;
  int bits;
};

constexpr uint32_t round_off(uint32_t value, int drop, rounding mode) {
  return drop <= 0 ? value : uint32_t(shift_right(uint64_t(value), drop, mode));
}

// (1 - f) a + f b exactly: gains weight_bits.
constexpr uint32_t interpolated(uint32_t a, uint32_t b, uint32_t f, int weight_bits) {
  return a * ((1u << weight_bits) - f) + b * f;
}

struct weights { uint32_t u, v; };

// Four texels in the order (0,0) (1,0) (0,1) (1,1).
struct texels2x2 { uint32_t t00, t10, t01, t11; };

constexpr texels2x2 fine_texels(fetched f) { return {fine_texel(f, 0), fine_texel(f, 1), fine_texel(f, 2), fine_texel(f, 3)}; }
constexpr texels2x2 coarse_texels(fetched f) { return {coarse_texel(f, 0), coarse_texel(f, 1), coarse_texel(f, 2), coarse_texel(f, 3)}; }

// Keeps at most blend_bits fraction bits.
constexpr partial_colour kept(uint32_t value, int bits, const profile& q) {
  return {round_off(value, bits - q.blend_bits, q.colour_rounding), min_of(bits, q.blend_bits)};
}

// KT88, 4-point: along u, then along v; 2 subtexel_bits fraction bits before rounding.
constexpr partial_colour four_point(texels2x2 t, weights w, const profile& q) {
  const int bits = q.subtexel_bits;
  const uint32_t top = interpolated(t.t00, t.t10, w.u, bits), bottom = interpolated(t.t01, t.t11, w.u, bits);
  return kept(interpolated(top, bottom, w.v, bits), 2 * bits, q);
}

// KT88, 3-point: the plane through the three texels of the triangle the position lies in; the diagonal runs from (0,0) to (1,1).
//   v >= u:  u t11 + (v - u) t01 + (1 - v) t00        v < u:  v t11 + (u - v) t10 + (1 - u) t00
constexpr partial_colour three_point(texels2x2 t, weights w, const profile& q) {
  const bool lower = w.v >= w.u;
  const uint32_t big = lower ? w.v : w.u, small = lower ? w.u : w.v, side = lower ? t.t01 : t.t10;
  return kept(small * t.t11 + (big - small) * side + ((1u << q.subtexel_bits) - big) * t.t00, q.subtexel_bits, q);
}

// Between two levels by the fraction of the level of detail.
constexpr partial_colour between_levels(partial_colour fine, partial_colour coarse, uint32_t fraction, const profile& q) {
  // 24 + 8 bits of fraction would not fit: what exceeds 24 is rounded away before, as blend_bits says.
  const int excess = max_of(0, fine.bits + q.level_bits - max_blend_bits);
  const uint32_t a = round_off(fine.value, excess, q.colour_rounding), b = round_off(coarse.value, excess, q.colour_rounding);
  return kept(interpolated(a, b, fraction, q.level_bits), fine.bits - excess + q.level_bits, q);
}

constexpr uint8_t written(partial_colour c, const profile& q) { return uint8_t(round_off(c.value, c.bits, q.colour_rounding)); }

}  // namespace spantex
