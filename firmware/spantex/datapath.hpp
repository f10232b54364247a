// SPDX-License-Identifier: Apache-2.0
// The span engine's datapath: coordinates, level, correction, banked fetch, filter. One pixel a step, no state.
#pragma once
#include <stdint.h>

#include <spantex/coordinates.hpp>
#include <spantex/filter.hpp>
#include <spantex/level.hpp>
#include <spantex/local_memory.hpp>
#include <spantex/profile.hpp>
#include <spantex/span.hpp>

namespace spantex {

// A position on one level, snapped: whole texel and weight.
struct snapped_position {
  int32_t u, v;        // texel index of the level (unwrapped) of the upper left texel
  weights fraction;    // 2^-subtexel_bits; zero for nearest
};

namespace detail {

// Half a texel of the level, in texels of level 0: 2^(level - 1).
using half_texel = u<12, 1>;
constexpr half_texel half_texel_of(int level) { return half_texel::from_raw(uint32_t(1) << level); }

// A position in texels of level 0 to the level's texels with `bits` fraction bits: position size_L / size_0 - 1/2, rounded once. The two
// sums are in texels of level 0 (times at most 1), so the shift by the level is part of the rounding. Proof: on_level.
constexpr int32_t on_level(coordinate position, uint32_t ratio, int level, int bits, rounding mode) {
  if (ratio == uint32_t(1) << 31) {
    const auto u = position - half_texel_of(level);
    return int32_t(scale_down(int64_t(u.raw()), decltype(u)::fraction_bits + level - bits, mode));
  }
  const auto u = position * spantex::u<0, 31>::from_raw(ratio) - half_texel_of(level);
  return int32_t(shift_right(int64_t(u.raw()), decltype(u)::fraction_bits + level - bits, mode));
}

}  // namespace detail

// Texel and weights for filters that blend: texel centres lie at k + 1/2.
constexpr int32_t blended(coordinate c, uint32_t ratio, bool one, int level, const profile& q) {
  return one ? 0 : detail::on_level(c, ratio, level, q.subtexel_bits, q.position_rounding);
}

// The texel that holds the position (level 0 only).
constexpr int32_t nearest_texel(coordinate c, bool one) { return one ? 0 : c.raw() >> 16; }

constexpr snapped_position snap(const texel_position& p, const section& at, filter kind, const profile& q) {
  if (kind == filter::nearest) return {nearest_texel(p.u, at.one_u), nearest_texel(p.v, at.one_v), {0, 0}};
  const int32_t u = blended(p.u, at.ratio_u, at.one_u, at.level, q), v = blended(p.v, at.ratio_v, at.one_v, at.level, q);
  const int32_t mask = (1 << q.subtexel_bits) - 1;
  return {u >> q.subtexel_bits, v >> q.subtexel_bits, {uint32_t(u & mask), uint32_t(v & mask)}};
}

// What leaves the correction unit: a position inside the section, as a local address and weights.
struct corrected { local_position at; weights fraction; };

// Clamps one axis to the section: beyond its ends the outermost texels with the outermost weight (VR11's correction). `last` is the
// last offset a 2x2 may start at, `most` the largest weight.
constexpr void correct_axis(int32_t& texel, uint32_t& fraction, int32_t origin, int32_t last, uint32_t most) {
  if (texel < origin) {
    texel = origin;
    fraction = 0;
  } else if (texel - origin > last) {
    texel = origin + last;
    fraction = most;
  }
}

constexpr corrected correct(snapped_position p, const section& at, int side, filter kind, const profile& q) {
  const int32_t last = side - (kind == filter::nearest ? 1 : 2);
  const uint32_t most = kind == filter::nearest ? 0 : (1u << q.subtexel_bits) - 1;
  correct_axis(p.u, p.fraction.u, at.origin_u, last, most);
  correct_axis(p.v, p.fraction.v, at.origin_v, last, most);
  return {{p.u & (side - 1), p.v & (side - 1)}, p.fraction};
}

// Pixel (i, j) of a span.
template <class Prof, class Memory, class Observer>
constexpr rgba8 compute_pixel(const Prof& prof, const span_coefficients& c, const Memory& memory, int i, int j, const Observer& observer) {
  const profile& q = prof.get();
  const texel_position p = position_at(prof, c, i, j);
  const corrected fine = correct(snap(p, c.fine, c.kind, q), c.fine, Memory::fine_side, c.kind, q);
  corrected coarse{};
  uint32_t level_fraction = 0;
  if (c.two_levels) {
    coarse = correct(snap(p, c.coarse, c.kind, q), c.coarse, Memory::coarse_side, c.kind, q);
    const int32_t level = level_at(prof, c, i, j) - (int32_t(c.fine.level) << q.level_bits);
    level_fraction = uint32_t(clamp_to(level, 0, (1 << q.level_bits) - 1));
  }
  uint8_t out[channel_count];
  for (int channel = 0; channel < channel_count; ++channel) {
    const fetched f = memory.fetch(channel, fine.at, coarse.at, observer);
    if (c.kind == filter::nearest) {
      out[channel] = uint8_t(fine_texel(f, 0));
      continue;
    }
    const bool three = uses_three_points(c.kind);
    const auto blend = [&](texels2x2 t, weights w) { return three ? three_point(t, w, q) : four_point(t, w, q); };
    partial_colour colour = blend(fine_texels(f), fine.fraction);
    if (c.two_levels) colour = between_levels(colour, blend(coarse_texels(f), coarse.fraction), level_fraction, q);
    out[channel] = written(colour, q);
  }
  return {out[0], out[1], out[2], out[3]};
}

// All pixels of the mask, in order of their bits.
template <class Prof, class Memory, class Observer>
constexpr void compute_span(const Prof& prof, const span_coefficients& c, span_mask mask, const Memory& memory, span_pixels& out,
                            const Observer& observer) {
  for (; mask != 0; mask &= mask - 1) {
    const int k = __builtin_ctzll(mask);
    out.pixel[k] = compute_pixel(prof, c, memory, k % span_side, k / span_side, observer);
  }
}

}  // namespace spantex
