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

inline constexpr int longest_run = 32;

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

// Along u three channels in one product, exact; then along v two and one.
struct halfway { uint32_t rb, g; };  // red in the upper half, blue in the lower; 5 fraction bits
inline halfway along_u(uint32_t left, uint32_t right, uint32_t fu) {
  const uint32_t x = spread(left) * ((1u << weight_bits) - fu) + spread(right) * fu;
  return {(x & 0x3FFu) | (x & 0x3FFu << 11) << 5, x >> 21};
}
SPANTEX_WRAPS inline halfway along_v(const halfway& top, const halfway& bottom, uint32_t fv) {
  return {(top.rb << weight_bits) + (bottom.rb - top.rb) * fv, (top.g << weight_bits) + (bottom.g - top.g) * fv};
}
inline halfway four_points(const texels& t, uint32_t fu, uint32_t fv) { return along_v(along_u(t.t00, t.t10, fu), along_u(t.t01, t.t11, fu), fv); }
inline uint16_t pixel_of(const halfway& sum) {
  const uint32_t rb = sum.rb + 0x02000200u, g = sum.g + 0x200u;
  return uint16_t((rb >> 26) << 11 | (g >> 10) << 5 | (rb >> 10 & 31));
}

// Two levels by the fraction f of the level of detail, 4 bits.
inline uint16_t pixel_between(const halfway& fine, const halfway& coarse, uint32_t f) {
  const uint32_t e = (1u << blend_bits) - f, half = 1u << trilinear_bits >> 1;
  const uint32_t red = (fine.rb >> 16) * e + (coarse.rb >> 16) * f + half, blue = (fine.rb & 0xFFFF) * e + (coarse.rb & 0xFFFF) * f + half;
  const uint32_t green = fine.g * e + coarse.g * f + half;
  return uint16_t((red >> trilinear_bits) << 11 | (green >> trilinear_bits) << 5 | blue >> trilinear_bits);
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

// Texel at the whole parts (v : u).
inline const texel565* texel_at(const source& s, uint32_t vu) { return s.origin + int32_t(int16_t(vu)) + (int32_t(vu) >> 16) * (s.pitch_bytes >> 1); }
inline const texel565* below(const texel565* p, const source& s) {
  return reinterpret_cast<const texel565*>(reinterpret_cast<const uint8_t*>(p) + s.pitch_bytes);
}

inline halfway four_points(const texel565* p, const source& s, uint32_t fu, uint32_t fv) {
  const texel565* const q = below(p, s);
  return along_v(along_u(p[0], p[1], fu), along_u(q[0], q[1], fu), fv);
}

#endif

}  // namespace detail

inline void nearest_run(uint16_t* out, int count, const walk& from, const source& s) {
#if SPANTEX_ROWS_DSP
  if ((from.ddu | from.ddv) == 0) dsp::nearest_straight(out, count, from, detail::address(s), detail::to_bytes(s));
  else dsp::nearest_bent(out, count, from, detail::address(s), detail::to_bytes(s));
#else
  walk at = from;
#if SPANTEX_ROWS_THUMB1
  if (const int most = count & ~7; most != 0) {
    thumb1::nearest(out, most, at, s.origin, s.pitch_bytes);
    out += most;
    count -= most;
  }
#endif
  for (; count > 0; --count, at.step()) *out++ = *detail::texel_at(s, upper_halves(at.v, at.u));
#endif
}

// Whole positions wrapped by masks (height - 1 : width - 1), both powers of two.
inline void nearest_masked_run(uint16_t* out, int count, const walk& from, const source& s, uint32_t masks) {
#if SPANTEX_ROWS_DSP
  if ((from.ddu | from.ddv) == 0) dsp::nearest_masked_straight(out, count, from, detail::address(s), detail::to_bytes(s), masks);
  else dsp::nearest_masked_bent(out, count, from, detail::address(s), detail::to_bytes(s), masks);
#else
  walk at = from;
#if SPANTEX_ROWS_THUMB1
  if (const int most = count & ~7; most != 0 && thumb1::masks_fit(masks)) {
    thumb1::nearest_masked(out, most, at, s.origin, masks);
    out += most;
    count -= most;
  }
#endif
  for (; count > 0; --count, at.step()) *out++ = *detail::texel_at(s, upper_halves(at.v, at.u) & masks);
#endif
}

// Snapped positions (sample.hpp).
[[gnu::noinline]] inline void bilinear_run(uint16_t* out, int count, const walk& from, const source& s, scratch& between) {
#if SPANTEX_ROWS_DSP
  if ((from.ddu | from.ddv) == 0) dsp::weighted_places_straight(between.words, count, from, detail::address(s), detail::to_bytes(s));
  else dsp::weighted_places(between.words, count, from, detail::address(s), detail::to_bytes(s));
  dsp::four_points(out, between.words, count, uint32_t(s.pitch_bytes));
#elif SPANTEX_ROWS_THUMB1
  thumb1::places(between.words, count, from, s.origin, s.pitch_bytes);
  thumb1::four_points(out, between.words, count, s.pitch_bytes);
#else
  (void)between;
  for (walk at = from; count > 0; --count, at.step()) {
    *out++ = detail::pixel_of(detail::four_points(detail::texel_at(s, upper_halves(at.v, at.u)), s, weight_of(at.u), weight_of(at.v)));
  }
#endif
}

[[gnu::noinline]] inline void three_point_run(uint16_t* out, int count, const walk& from, const source& s, scratch& between) {
#if SPANTEX_ROWS_DSP
  if ((from.ddu | from.ddv) == 0) return dsp::three_points_straight(out, count, from, detail::address(s), detail::to_bytes(s));
  dsp::places(between.words, count, from, detail::address(s), detail::to_bytes(s));
  dsp::three_points(out, between.words, count, uint32_t(s.pitch_bytes));
#elif SPANTEX_ROWS_THUMB1
  thumb1::places(between.words, count, from, s.origin, s.pitch_bytes);
  thumb1::three_points(out, between.words, count, s.pitch_bytes);
#else
  (void)between;
  for (walk at = from; count > 0; --count, at.step()) {
    const texel565* const p = detail::texel_at(s, upper_halves(at.v, at.u));
    const texel565* const q = detail::below(p, s);
    const uint32_t fu = weight_of(at.u), fv = weight_of(at.v);
    const texel565* side = p + 1;
    uint32_t low = fv, high = fu;
    if (fv >= fu) { side = q; low = fu; high = fv; }
    *out++ = detail::three_points(p[0], *side, q[1], high, low);
  }
#endif
}

// Positions on the finer level; those on the coarser follow: (fine + snap) / 2, floor. The whole part of the level is the same all along.
[[gnu::noinline]] inline void trilinear_run(uint16_t* out, int count, const walk& from, const source& fine, const source& coarse, const level_run& along, scratch& between) {
  walk at = from;
  level_run level = along;
#if SPANTEX_ROWS_DSP
  constexpr int most = dsp::scratch_words / 6;
  const bool straight = (at.ddu | at.ddv | level.step) == 0;
  dsp::two_levels levels = dsp::levels_of(detail::address(fine), detail::to_bytes(fine), detail::address(coarse), detail::to_bytes(coarse), at, level.step);
  for (; count > 0; count -= most, out += most) {
    const int n = min_of(count, most);
    if (straight) dsp::places_of_two_straight(between.words, n, at, level.start, levels);
    else dsp::places_of_two(between.words, n, at, level.start, levels);
    dsp::eight_points(out, between.words, n, uint32_t(fine.pitch_bytes));
  }
#elif SPANTEX_ROWS_THUMB1
  constexpr int most = thumb1::coarse_pixels_at_once;
  uint32_t *near = between.words, *const far = near + thumb1::pixel_words * longest_run;
  thumb1::weighted_places<16>(near, count, at, fine.origin, fine.pitch_bytes, level, 1u << blend_bits, ~0u);
  thumb1::fine_sums(near, count, fine.pitch_bytes);
  at.u += snap;
  at.v += snap;
  for (; count > 0; count -= most, out += most, near += thumb1::pixel_words * most) {
    const int n = min_of(count, most);
    thumb1::weighted_places<17>(far, n, at, coarse.origin, coarse.pitch_bytes, level, 0, 1);
    thumb1::coarse_pixels(out, near, far, n, coarse.pitch_bytes);
    at = advanced(at, n);
    level.start += n * level.step;
  }
#else
  (void)between;
  for (; count > 0; --count, at.step(), level.start += level.step) {
    const int32_t u = (at.u + snap) >> 1, v = (at.v + snap) >> 1;
    const detail::halfway a = detail::four_points(detail::texel_at(fine, upper_halves(at.v, at.u)), fine, weight_of(at.u), weight_of(at.v));
    const detail::halfway b = detail::four_points(detail::texel_at(coarse, upper_halves(v, u)), coarse, weight_of(u), weight_of(v));
    *out++ = detail::pixel_between(a, b, fraction_of(level.start));
  }
#endif
}

}  // namespace spantex::rows
