// SPDX-License-Identifier: Apache-2.0
// The span engine's datapath: coordinates, level, correction, banked fetch, filter. One pixel a step, no state.
#pragma once
#include <stdint.h>

#include <spantex/area.hpp>
#include <spantex/contour.hpp>
#include <spantex/coordinates.hpp>
#include <spantex/filter.hpp>
#include <spantex/footprint.hpp>
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

// One sample: where it lies on each level, and how the two levels are blended.
struct sample_point {
  corrected fine, coarse;
  uint32_t level_fraction;
};

namespace detail {

// Whether a channel is decoded before it is filtered, and encoded after.
template <class Prof>
constexpr bool decodes(const Prof& prof, const span_coefficients& c, int channel) {
  return Prof::has_linear_light && prof.get().linear_light && c.linear_light && channel != alpha_channel;
}

template <class Memory>
constexpr sample_point sample_at(const texel_position& p, const span_coefficients& c, int32_t level, const profile& q) {
  sample_point s{correct(snap(p, c.fine, c.kind, q), c.fine, Memory::fine_side, c.kind, q), {}, 0};
  if (c.two_levels) {
    s.coarse = correct(snap(p, c.coarse, c.kind, q), c.coarse, Memory::coarse_side, c.kind, q);
    s.level_fraction = uint32_t(clamp_to(level - (int32_t(c.fine.level) << q.level_bits), 0, (1 << q.level_bits) - 1));
  }
  return s;
}

// LinearLight: texels are decoded first, and the colour stays linear.
template <bool LinearLight>
constexpr partial_colour blended_texels(fetched f, const sample_point& s, const span_coefficients& c, const profile& q) {
  const bool three = uses_three_points(c.kind);
  const auto blend = [&](texels2x2 t, weights w) {
    if constexpr (LinearLight) t = srgb_decoded(t);
    return three ? three_point(t, w, q) : four_point(t, w, q);
  };
  const partial_colour fine = blend(fine_texels(f), s.fine.fraction);
  constexpr int most_bits = LinearLight ? max_linear_blend_bits : max_blend_bits;
  if (!uses_two_levels(c.kind)) return fine;
  if (!c.two_levels) return kept_of_level(fine, q, most_bits);
  return between_levels(fine, blend(coarse_texels(f), s.coarse.fraction), s.level_fraction, q, most_bits);
}

// All channels of a sum have one weight: in linear light colours keep fewer bits of a level than alpha does.
constexpr partial_colour linear_sum(partial_colour c, const profile& q) {
  const partial_colour s = summable(c, q, max_linear_sum_bits);
  return {s.value << (max_linear_sum_bits - s.bits), max_linear_sum_bits};
}

// One channel of a sample, ready to be summed.
template <class Prof>
constexpr partial_colour summable_texels(const Prof& prof, fetched f, const sample_point& s, const span_coefficients& c, int channel) {
  const profile& q = prof.get();
  if constexpr (Prof::has_linear_light) {
    if (decodes(prof, c, channel)) return linear_sum(blended_texels<true>(f, s, c, q), q);
    if (decodes(prof, c, 0)) return linear_sum(blended_texels<false>(f, s, c, q), q);
  }
  return summable(blended_texels<false>(f, s, c, q), q);
}

template <class Prof>
constexpr rgba8 mean_of(const Prof& prof, const footprint_sums& sums, const span_coefficients& c) {
  if constexpr (Prof::has_linear_light)
    if (decodes(prof, c, 0)) return mean_linear_colour(sums, prof.get().colour_rounding);
  return mean_colour(sums, prof.get().colour_rounding);
}

template <class Prof>
constexpr uint8_t contour_alpha(const Prof& prof, fetched f, const sample_point& s, const span_coefficients& c, int i, int j) {
  const profile& q = prof.get();
  const partial_colour fine = four_point(fine_texels(f), s.fine.fraction, q);
  field_gradient gradient = gradient_of(fine_texels(f), s.fine.fraction, q.subtexel_bits);
  partial_colour coarse = fine;
  if (c.two_levels) {
    coarse = four_point(coarse_texels(f), s.coarse.fraction, q);
    gradient = between_levels(gradient, gradient_of(coarse_texels(f), s.coarse.fraction, q.subtexel_bits), s.level_fraction, q.level_bits);
  }
  const int32_t field = contour_field(fine, coarse, s.level_fraction, c, q);
  return contour_coverage(contour_distance(prof, c, field, gradient, i, j), c.contour.outline);
}

}  // namespace detail

namespace detail {

// One channel of a filter of one sample that blends.
template <class Prof>
constexpr uint8_t channel_value(const Prof& prof, fetched f, const sample_point& s, const span_coefficients& c, int channel, int i, int j) {
  const profile& q = prof.get();
  if constexpr (Prof::has_contours)
    if (c.kind == filter::contour && channel == alpha_channel && q.contours) return contour_alpha(prof, f, s, c, i, j);
  if constexpr (Prof::has_linear_light)
    if (decodes(prof, c, channel)) return written_linear(blended_texels<true>(f, s, c, q), q);
  return written(blended_texels<false>(f, s, c, q), q);
}

}  // namespace detail

// Pixel (i, j) of a span, filters of one sample.
template <class Prof, class Memory, class Observer>
constexpr rgba8 compute_pixel(const Prof& prof, const span_coefficients& c, const Memory& memory, int i, int j, const Observer& observer) {
  const profile& q = prof.get();
  const int32_t level = c.two_levels ? level_at(prof, c, i, j) : 0;
  const sample_point s = detail::sample_at<Memory>(position_at(prof, c, i, j), c, level, q);
  uint8_t out[channel_count];
  for (int channel = 0; channel < channel_count; ++channel) {
    const fetched f = memory.fetch(channel, s.fine.at, s.coarse.at, observer);
    out[channel] = c.kind == filter::nearest ? uint8_t(fine_texel(f, 0)) : detail::channel_value(prof, f, s, c, channel, i, j);
  }
  return {out[0], out[1], out[2], out[3]};
}

// Samples [first, last) of the footprint of pixel (i, j).
template <class Prof, class Memory, class Observer>
constexpr footprint_sums compute_footprint(const Prof& prof, const span_coefficients& c, const Memory& memory, int i, int j,
                                           const Observer& observer) {
  const profile& q = prof.get();
  const texel_position centre = position_at(prof, c, i, j);
  const footprint f = footprint_at(prof, c, i, j);
  footprint_sums sums{};
  for (int k = c.axis.first_sample; k < min_of(c.axis.last_sample, f.samples); ++k) {
    if (c.kind == filter::squares) {
      snapped_position p = snap(centre, c.fine, c.kind, q);
      const square s = square_at(f, p.fraction, q.subtexel_bits, k);
      p.u += s.u;
      p.v += s.v;
      const corrected at = correct(p, c.fine, Memory::fine_side, c.kind, q);
      for (int channel = 0; channel < channel_count; ++channel) {
        texels2x2 t = fine_texels(memory.fetch(channel, at.at, {}, observer));
        if constexpr (Prof::has_linear_light)
          if (detail::decodes(prof, c, channel)) t = srgb_decoded(t);
        sums.channel[channel] += square_sum(t, s.weight) * uint32_t(s.row_weight);
      }
      sums.weight += 20u * uint32_t(s.row_weight);
    } else {
      const sample_point s = detail::sample_at<Memory>(sample_position(centre, f, k), c, f.level, q);
      partial_colour colour{};
      for (int channel = 0; channel < channel_count; ++channel) {
        colour = detail::summable_texels(prof, memory.fetch(channel, s.fine.at, s.coarse.at, observer), s, c, channel);
        sums.channel[channel] += colour.value;
      }
      sums.weight += 1u << colour.bits;
    }
  }
  return sums;
}

// The texels under pixel (i, j), or those in one tile of its window, weighted by area: four a fetch, the outermost ones maybe beyond the
// section with weight zero. The section holds all that have a weight, so there is nothing to correct.
template <class Prof, class Memory, class Observer>
constexpr footprint_sums compute_area(const Prof& prof, const span_coefficients& c, const Memory& memory, int i, int j,
                                      const Observer& observer) {
  constexpr int side = Memory::fine_side;
  const area_window window = area_window_at(prof, c, i, j, c.fine);
  const area_tile tile = tile_at(window, c.axis, side);
  area_weights area(window, c.kind);
  const bool linear = detail::decodes(prof, c, 0);
  const int drop = linear ? linear_weight_drop(window) : 0;
  footprint_sums sums{};
  for (int row = 0; row < tile.row + tile.rows; row += 2) {
    int32_t weight[2][max_area_side] = {};
    area.next_row(weight[0]);
    if (row + 1 < window.rows) area.next_row(weight[1]);
    if (row < tile.row) continue;
    if constexpr (Prof::has_linear_light)
      for (int n = 0; n < max_area_side && linear; ++n)
        for (auto& line : weight) line[n] = linear_weight(line[n], drop);
    for (int column = tile.column; column < tile.column + tile.columns; column += 2) {
      const uint32_t w00 = uint32_t(weight[0][column]), w10 = uint32_t(weight[0][column + 1]), w01 = uint32_t(weight[1][column]),
                     w11 = uint32_t(weight[1][column + 1]);
      if ((w00 | w10 | w01 | w11) == 0) continue;
      const local_position at{(window.u + column) & (side - 1), (window.v + row) & (side - 1)};
      for (int channel = 0; channel < channel_count; ++channel) {
        texels2x2 t = fine_texels(memory.fetch(channel, at, {}, observer));
        if constexpr (Prof::has_linear_light)
          if (detail::decodes(prof, c, channel)) t = srgb_decoded(t);
        sums.channel[channel] += t.t00 * w00 + t.t10 * w10 + t.t01 * w01 + t.t11 * w11;
      }
      sums.weight += w00 + w10 + w01 + w11;
    }
  }
  return sums;
}

// All pixels of the mask, in order of their bits. A function of its own: a call a job, and code is smaller than where it melts into its caller.
template <class Prof, class Memory, class Observer>
[[gnu::noinline]] constexpr void compute_span(const Prof& prof, const span_coefficients& c, span_mask mask, const Memory& memory, span_pixels& out,
                            const Observer& observer) {
  for (; mask != 0; mask &= mask - 1) {
    const int k = __builtin_ctzll(mask), i = k % span_side, j = k / span_side;
    if (!uses_footprint(c.kind) && !uses_area(c.kind)) {
      out.pixel[k] = compute_pixel(prof, c, memory, i, j, observer);
      continue;
    }
    const footprint_sums sums =
        uses_area(c.kind) ? compute_area(prof, c, memory, i, j, observer) : compute_footprint(prof, c, memory, i, j, observer);
    if (c.axis.partial) out.sums = sums;
    else out.pixel[k] = detail::mean_of(prof, sums, c);
  }
}

}  // namespace spantex
