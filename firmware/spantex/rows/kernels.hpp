// SPDX-License-Identifier: Apache-2.0
// Kernels: a run of pixels of one row, positions step by step, texels where they lie, RGB565 out. The caller (run.hpp) has made sure that every texel
// of the run lies in its level, or that masks wrap it. What a pixel is: sample.hpp. Instructions counted: docs/TARGETS.md.
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>
#include <spantex/rows/block.hpp>
#include <spantex/rows/packed.hpp>
#include <spantex/rows/sample.hpp>

namespace spantex::rows {

// Where a kernel reads: the texel at whole position (0, 0), and the bytes from one row of texels to the next.
struct source {
  const texel565* origin;
  int32_t pitch_bytes;
};

inline constexpr int longest_run = 32;

}  // namespace spantex::rows

#if SPANTEX_ROWS_DSP
#include <spantex/rows/kernels_dsp.hpp>
#if SPANTEX_ROWS_MVE
#include <spantex/rows/kernels_mve.hpp>
#endif
#elif SPANTEX_ROWS_THUMB1
#include <spantex/rows/kernels_thumb1.hpp>
#endif

namespace spantex::rows {

inline namespace SPANTEX_ROWS_KERNELS {

// Memory that a kernel works in, between its two loops where it takes two.
struct scratch {
#if SPANTEX_ROWS_DSP
  uint32_t words[dsp::scratch_words];
#elif SPANTEX_ROWS_THUMB1
  uint32_t words[thumb1::scratch_words];
#endif
};

}  // namespace SPANTEX_ROWS_KERNELS

namespace detail {

constexpr uint32_t to_bytes(const source& s) { return uint32_t(s.pitch_bytes) << 16 | 2u; }

inline constexpr int bilinear_bits = 2 * weight_bits, trilinear_bits = bilinear_bits + blend_bits;

// Of two texels side by side, left + 2^16 right, one channel is a pair; pairs of weights are the other way round, left in the upper half. Then
//   pair weights = ... 2^32 + (left w_left + right w_right) 2^16 + left w_right,
// and of both rows together neither sum leaves its half: 63 2^10 < 2^16.
constexpr uint32_t pair_of(uint32_t left, uint32_t right) { return left | right << 16; }
struct pair_weights { uint32_t top, bottom; };
constexpr pair_weights weights_of(uint32_t fu, uint32_t fv) {
  const uint32_t along_u = (1u << weight_bits << 16) - fu * 0xFFFF, bottom = along_u * fv;
  return {(along_u << weight_bits) - bottom, bottom};
}

// Channels times weights, 10 fraction bits, in the upper halves; what is below is none of theirs.
struct upper_sums { uint32_t r, g, b; };
SPANTEX_WRAPS constexpr upper_sums four_points(uint32_t top, uint32_t bottom, const pair_weights& w) {
  constexpr uint32_t five = 0x001F001F, six = 0x003F003F;
  return {(top >> 11 & five) * w.top + (bottom >> 11 & five) * w.bottom, (top >> 5 & six) * w.top + (bottom >> 5 & six) * w.bottom, (top & five) * w.top + (bottom & five) * w.bottom};
}
constexpr upper_sums four_points(const texels& t, uint32_t fu, uint32_t fv) { return four_points(pair_of(t.t00, t.t10), pair_of(t.t01, t.t11), weights_of(fu, fv)); }
constexpr uint16_t pixel_of(const upper_sums& sum) {
  constexpr uint32_t half = 1u << bilinear_bits >> 1 << 16;
  return uint16_t((sum.r + half) >> 26 << 11 | (sum.g + half) >> 26 << 5 | (sum.b + half) >> 26);
}

// Two levels by the fraction f of the level of detail, 4 bits.
constexpr uint16_t pixel_between(const upper_sums& fine, const upper_sums& coarse, uint32_t f) {
  const uint32_t e = (1u << blend_bits) - f, half = 1u << trilinear_bits >> 1;
  const auto channel = [&](uint32_t x, uint32_t y) { return ((x >> 16) * e + (y >> 16) * f + half) >> trilinear_bits; };
  return uint16_t(channel(fine.r, coarse.r) << 11 | channel(fine.g, coarse.g) << 5 | channel(fine.b, coarse.b));
}

// The texel beside t00 that the triangle has, and the weights of its edges.
inline uint16_t three_points(uint32_t t00, uint32_t side, uint32_t t11, uint32_t high, uint32_t low) {
  constexpr uint32_t one = 1u << weight_bits, half = (1u | 1u << 11 | 1u << 21) << (weight_bits - 1);
  const uint32_t sum = spread(t11) * low + spread(side) * (high - low) + spread(t00) * (one - high) + half;
  return uint16_t(gathered(sum >> weight_bits & spread_mask));
}

#if SPANTEX_ROWS_DSP

inline uint32_t address(const source& s) { return uint32_t(reinterpret_cast<uintptr_t>(s.origin)); }

#else

// `pixel` of each position from `at` on; of straight rows in a loop of its own, where code need not be small.
template <class Pixel>
SPANTEX_WRAPS inline void draw_along(uint16_t* out, int count, walk at, const Pixel& pixel) {
#if !SPANTEX_ROWS_THUMB1 && !defined(__OPTIMIZE_SIZE__)
  if (is_straight(at)) {
    for (; count > 0; --count, at.u += at.du, at.v += at.dv) *out++ = pixel(at);
    return;
  }
#endif
  for (; count > 0; --count, at.step()) *out++ = pixel(at);
}

// Texel at whole parts.
inline const texel565* texel_at(const source& s, int32_t u, int32_t v) { return s.origin + (u + v * (s.pitch_bytes >> 1)); }
inline const texel565* below(const texel565* p, const source& s) {
  return reinterpret_cast<const texel565*>(reinterpret_cast<const uint8_t*>(p) + s.pitch_bytes);
}

// The texel and its neighbour to the right.
#if defined(__ARMEL__) && defined(__ARM_FEATURE_UNALIGNED)
inline uint32_t pair_at(const texel565* p) {
  struct [[gnu::packed, gnu::may_alias]] word { uint32_t value; };
  return reinterpret_cast<const word*>(p)->value;
}
#else
inline uint32_t pair_at(const texel565* p) { return pair_of(p[0], p[1]); }
#endif

inline upper_sums four_points(const texel565* p, const source& s, uint32_t fu, uint32_t fv) { return four_points(pair_at(p), pair_at(below(p, s)), weights_of(fu, fv)); }

#endif

}  // namespace detail

inline void nearest_run(uint16_t* out, int count, const walk& from, const source& s) {
#if SPANTEX_ROWS_DSP
  if (is_straight(from)) dsp::nearest_straight(out, count, from, detail::address(s), detail::to_bytes(s));
  else dsp::nearest_bent(out, count, from, detail::address(s), detail::to_bytes(s));
#elif SPANTEX_ROWS_THUMB1
  thumb1::nearest(out, count, from, s.origin, s.pitch_bytes);
#else
  detail::draw_along(out, count, from, [&](const walk& at) { return *detail::texel_at(s, texel_of(at.u), texel_of(at.v)); });
#endif
}

// Whole positions wrapped by masks (height - 1 : width - 1), both powers of two.
inline void nearest_masked_run(uint16_t* out, int count, const walk& from, const source& s, uint32_t masks) {
#if SPANTEX_ROWS_DSP
  if (is_straight(from)) dsp::nearest_masked_straight(out, count, from, detail::address(s), detail::to_bytes(s), masks);
  else dsp::nearest_masked_bent(out, count, from, detail::address(s), detail::to_bytes(s), masks);
#else
#if SPANTEX_ROWS_THUMB1
  if (thumb1::masks_fit(masks)) return thumb1::nearest_masked(out, count, from, s.origin, masks);
#endif
  detail::draw_along(out, count, from, [&](const walk& at) {
    return *detail::texel_at(s, texel_of(at.u) & int32_t(masks & 0xFFFF), texel_of(at.v) & int32_t(masks >> 16));
  });
#endif
}

// Rows of pixels `stride` pixels apart, and their walks: all of them straight, or any.
struct row_list {
  uint16_t* out;
  int32_t stride;
  const walk *first, *end;
  bool straight;
};
template <class Row>
[[gnu::always_inline]] inline void each_row_of(row_list rows, const Row& draw) {
  for (; rows.first != rows.end; ++rows.first, rows.out += rows.stride) draw(rows.out, *rows.first);
}

// nearest_run() of several rows.
#if SPANTEX_ROWS_DSP
[[gnu::noinline]] inline void nearest_rows(const row_list& rows, int count, const source& s) {
  const uint32_t origin = detail::address(s), to_bytes = detail::to_bytes(s);
  if (rows.straight) each_row_of(rows, [&](uint16_t* out, const walk& at) __attribute__((always_inline)) { dsp::nearest_straight(out, count, at, origin, to_bytes); });
  else each_row_of(rows, [&](uint16_t* out, const walk& at) __attribute__((always_inline)) { dsp::nearest_bent(out, count, at, origin, to_bytes); });
}
#else
inline void nearest_rows(const row_list& rows, int count, const source& s) {
  each_row_of(rows, [&](uint16_t* out, const walk& at) { nearest_run(out, count, at, s); });
}
#endif

// Snapped positions (sample.hpp).
[[gnu::noinline]] inline void bilinear_run(uint16_t* out, int count, const walk& from, const source& s, scratch& between) {
#if SPANTEX_ROWS_DSP
  if (is_straight(from)) dsp::weighted_places_straight(between.words, count, from, detail::address(s), detail::to_bytes(s));
  else dsp::weighted_places(between.words, count, from, detail::address(s), detail::to_bytes(s));
  dsp::four_points(out, between.words, count, uint32_t(s.pitch_bytes));
#elif SPANTEX_ROWS_THUMB1
  thumb1::places(between.words, count, from, s);
  thumb1::four_points(out, between.words, count, s.pitch_bytes);
#else
  (void)between;
  detail::draw_along(out, count, from, [&](const walk& at) {
    return detail::pixel_of(detail::four_points(detail::texel_at(s, texel_of(at.u), texel_of(at.v)), s, weight_of(at.u), weight_of(at.v)));
  });
#endif
}

[[gnu::noinline]] inline void three_point_run(uint16_t* out, int count, const walk& from, const source& s, scratch& between) {
#if SPANTEX_ROWS_DSP
  if (is_straight(from)) return dsp::three_points_straight(out, count, from, detail::address(s), detail::to_bytes(s));
  dsp::places(between.words, count, from, detail::address(s), detail::to_bytes(s));
  dsp::three_points(out, between.words, count, uint32_t(s.pitch_bytes));
#elif SPANTEX_ROWS_THUMB1
  thumb1::places(between.words, count, from, s);
  thumb1::three_points(out, between.words, count, s.pitch_bytes);
#else
  (void)between;
  detail::draw_along(out, count, from, [&](const walk& at) {
    const texel565* const p = detail::texel_at(s, texel_of(at.u), texel_of(at.v));
    const texel565* const q = detail::below(p, s);
    const uint32_t fu = weight_of(at.u), fv = weight_of(at.v);
    const texel565* side = p + 1;
    uint32_t low = fv, high = fu;
    if (fv >= fu) { side = q; low = fu; high = fv; }
    return detail::three_points(p[0], *side, q[1], high, low);
  });
#endif
}

// Positions on the finer level; those on the coarser follow: (fine + snap) / 2, floor. The whole part of the level is the same all along.
#if SPANTEX_ROWS_THUMB1
inline void trilinear_run(uint16_t* out, int count, const walk& from, const source& fine, const source& coarse, const level_run& along, scratch& between) {
  thumb1::trilinear(out, count, &from, fine, coarse, along, between.words);
}
#else
[[gnu::noinline]] inline void trilinear_run(uint16_t* out, int count, const walk& from, const source& fine, const source& coarse, const level_run& along, scratch& between) {
#if SPANTEX_ROWS_DSP
  walk at = from;
  level_run level = along;
  constexpr int most = dsp::scratch_words / dsp::trilinear_words;
  const bool straight = (at.ddu | at.ddv | level.step) == 0;
  dsp::two_levels levels = dsp::levels_of(detail::address(fine), detail::to_bytes(fine), detail::address(coarse), detail::to_bytes(coarse), at, level.step);
  for (; count > 0; count -= most, out += most) {
    const int n = min_of(count, most);
    if (straight) dsp::places_of_two_straight(between.words, n, at, level.start, levels);
    else dsp::places_of_two(between.words, n, at, level.start, levels);
    dsp::eight_points(out, between.words, n, uint32_t(fine.pitch_bytes));
  }
#else
  (void)between;
  level_run level = along;
  for (walk at = from; count > 0; --count, at.step(), level.start += level.step) {
    const int32_t u = (at.u + snap) >> 1, v = (at.v + snap) >> 1;
    const detail::upper_sums a = detail::four_points(detail::texel_at(fine, texel_of(at.u), texel_of(at.v)), fine, weight_of(at.u), weight_of(at.v));
    const detail::upper_sums b = detail::four_points(detail::texel_at(coarse, texel_of(u), texel_of(v)), coarse, weight_of(u), weight_of(v));
    *out++ = detail::pixel_between(a, b, fraction_of(level.start));
  }
#endif
}
#endif

}  // namespace spantex::rows
