// SPDX-License-Identifier: Apache-2.0
// Interpolation of one channel (KT88: 3- and 4-point; VR11: trilinear from eight values). Every weight pair sums to a power of two
// and every rounding is of a convex combination: a constant comes out exactly, and the result stays between its texels. Interpolation on
// a level is exact; two levels are rounded to blend_bits, then interpolated exactly; write-out rounds once.
//
// Input texels 8 bits; weights f / 2^weight_bits, 0 <= f < 2^weight_bits. Intermediate: colour with `bits` fraction bits, at most 24,
// in 32 bits unsigned: 255 * 2^24 < 2^32, so nothing overflows. Differences are taken modulo 2^32: a convex combination comes back into range.
// In linear light (srgb.hpp) texels have 16 bits and a colour at most 16 of fraction.
//
// Operations, a channel, shifts, roundings and the comparison of the two weights not counted (docs/METHODS.md; shown by tests/unit/kt88_operations.cpp,
// which is why the number and the texel are types of their own here):
//
//                    texels used   multiplications   additions
//   three_point           3               2              4
//   four_point            4               3              6
//   between_levels        -               1              2
//   3-point trilinear     6               5             10       KT88's counts
//   4-point trilinear     8               7             14
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>
#include <spantex/local_memory.hpp>
#include <spantex/profile.hpp>
#include <spantex/srgb.hpp>

namespace spantex {

inline constexpr int max_blend_bits = 24;
static_assert(8 + max_blend_bits <= 32, "a colour and its fraction fit 32 bits; is_valid() keeps blend_bits + level_bits and 2 subtexel_bits within 24");

inline constexpr int max_linear_blend_bits = 16;
static_assert(linear_bits + max_linear_blend_bits <= 32, "the same for 16-bit texels; is_valid() keeps 2 subtexel_bits within 16");

// A colour between two stages: value / 2^bits.
template <class Number> struct partial_colour_of {
  Number value;
  int bits;
};
using partial_colour = partial_colour_of<uint32_t>;

constexpr uint32_t round_off(uint32_t value, int drop, rounding mode) {
  return drop <= 0 ? value : uint32_t(shift_right(uint64_t(value), drop, mode));
}

// (1 - f) a + f b exactly: gains weight_bits.
template <class Number>
SPANTEX_WRAPS constexpr Number interpolated(Number a, Number b, Number f, int weight_bits) {
  return (a << weight_bits) + (b - a) * f;
}

template <class Number> struct weights_of { Number u, v; };
using weights = weights_of<uint32_t>;

// Four texels in the order (0,0) (1,0) (0,1) (1,1). Each is read once, where it is turned into a number.
template <class Texel> struct texels2x2_of { Texel t00, t10, t01, t11; };
using texels2x2 = texels2x2_of<uint32_t>;

constexpr texels2x2 fine_texels(fetched f) { return {fine_texel(f, 0), fine_texel(f, 1), fine_texel(f, 2), fine_texel(f, 3)}; }
constexpr texels2x2 coarse_texels(fetched f) { return {coarse_texel(f, 0), coarse_texel(f, 1), coarse_texel(f, 2), coarse_texel(f, 3)}; }

constexpr texels2x2 srgb_decoded(texels2x2 t) {
  return {srgb_decoded(t.t00), srgb_decoded(t.t10), srgb_decoded(t.t01), srgb_decoded(t.t11)};
}

// KT88, 4-point: along u, then along v; 2 subtexel_bits fraction bits.
template <class Number = uint32_t, class Texel = Number>
constexpr partial_colour_of<Number> four_point(texels2x2_of<Texel> t, weights_of<Number> w, const profile& q) {
  const int bits = q.subtexel_bits;
  const Number top = interpolated<Number>(t.t00, t.t10, w.u, bits), bottom = interpolated<Number>(t.t01, t.t11, w.u, bits);
  return {interpolated(top, bottom, w.v, bits), 2 * bits};
}

// KT88, 3-point: the plane through the three texels of the triangle the position lies in; the diagonal runs from (0,0) to (1,1).
//   v >= u:  u t11 + (v - u) t01 + (1 - v) t00 = t00 + v (t01 - t00) + u (t11 - t01)        v < u:  u and v, t01 and t10 exchanged
template <class Number = uint32_t, class Texel = Number>
SPANTEX_WRAPS constexpr partial_colour_of<Number> three_point(texels2x2_of<Texel> t, weights_of<Number> w, const profile& q) {
  if (!(w.v >= w.u)) {  // the other triangle, mirrored on the diagonal
    const Number u = w.u;
    w.u = w.v;
    w.v = u;
    t.t01 = t.t10;
  }
  const Number side = t.t01, t00 = t.t00;
  return {(t00 << q.subtexel_bits) + (side - t00) * w.v + (Number(t.t11) - side) * w.u, q.subtexel_bits};
}

// What a filter of two levels keeps of each level's colour: blend_bits (halves up, or down if colours are cut), also where one level is all it
// needs, so that a pixel does not depend on its neighbours' fractions. In linear light 16-bit texels leave fewer bits.
template <class Number = uint32_t>
constexpr partial_colour_of<Number> kept_of_level(partial_colour_of<Number> c, const profile& q, int most_bits = max_blend_bits) {
  const int bits = min_of(c.bits, min_of(q.blend_bits, most_bits - q.level_bits));
  return {round_off(c.value, c.bits - bits, q.colour_rounding == rounding::floor ? rounding::floor : rounding::nearest), bits};
}

// Between two levels by the fraction of the level of detail: exact but for what each keeps.
template <class Number = uint32_t>
constexpr partial_colour_of<Number> between_levels(partial_colour_of<Number> fine, partial_colour_of<Number> coarse, Number fraction,
                                                   const profile& q, int most_bits = max_blend_bits) {
  const partial_colour_of<Number> a = kept_of_level(fine, q, most_bits), b = kept_of_level(coarse, q, most_bits);
  return {interpolated(a.value, b.value, fraction, q.level_bits), a.bits + q.level_bits};
}

constexpr uint8_t written(partial_colour c, const profile& q) { return uint8_t(round_off(c.value, c.bits, q.colour_rounding)); }

// The same from linear light.
constexpr uint8_t written_linear(partial_colour c, const profile& q) { return srgb_encoded(round_off(c.value, c.bits, q.colour_rounding)); }

// --- footprints: sums of samples, divided once ---------------------------------------------------------

inline constexpr int max_sum_bits = 20;  // fraction bits of a summed colour: 16 samples of 255 2^20 stay below 2^32
inline constexpr int max_linear_sum_bits = 12;  // 16 samples of 65535 2^12 likewise

constexpr partial_colour summable(partial_colour c, const profile& q, int most_bits = max_sum_bits) {
  return {round_off(c.value, c.bits - most_bits, q.colour_rounding), min_of(c.bits, most_bits)};
}

constexpr uint32_t square_sum(texels2x2 t, const uint8_t (&w)[4]) { return t.t00 * w[0] + t.t10 * w[1] + t.t01 * w[2] + t.t11 * w[3]; }

// sum / weight, rounded: a weighted mean, so a constant comes out exactly and nothing leaves the range of the texels. 0 for a weight of 0,
// which only a faulty device delivers.
constexpr uint16_t mean(uint32_t sum, uint32_t weight, rounding mode) {
  if (weight == 0) return 0;
  const uint32_t whole = sum / weight, rest = sum % weight;
  if (mode == rounding::floor) return uint16_t(whole);
  const bool up = mode == rounding::nearest ? rest >= weight - rest : rest + (whole & 1) > weight - rest;
  return uint16_t(whole + (up ? 1 : 0));
}

constexpr rgba8 mean_colour(const footprint_sums& s, rounding mode) {
  const auto channel = [&](int k) { return uint8_t(mean(s.channel[k], s.weight, mode)); };
  return {channel(0), channel(1), channel(2), channel(3)};
}

constexpr rgba8 mean_linear_colour(const footprint_sums& s, rounding mode) {
  const auto channel = [&](int k) { return srgb_encoded(mean(s.channel[k], s.weight, mode)); };
  return {channel(0), channel(1), channel(2), uint8_t(mean(s.channel[alpha_channel], s.weight, mode))};
}

constexpr void add(footprint_sums& a, const footprint_sums& b) {
  for (int k = 0; k < channel_count; ++k) a.channel[k] += b.channel[k];
  a.weight += b.weight;
}

}  // namespace spantex
