// SPDX-License-Identifier: Apache-2.0
// Kernels: a run of pixels of one row, positions step by step, texels where they lie, RGB565 out. The caller (run.hpp) has made sure that every texel
// of the run lies in its level, or that masks wrap it. What a pixel is: sample.hpp. Instructions counted: docs/TARGETS.md.
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>
#include <spantex/rows/packed.hpp>
#include <spantex/rows/sample.hpp>

namespace spantex::rows {

// Positions of a run, 2^-16 texel of the level.
struct walk {
  int32_t u, v, du, dv, ddu, ddv;
  SPANTEX_WRAPS void step() { u += du; v += dv; du += ddu; dv += ddv; }
};

// Where a kernel reads: the texel at whole position (0, 0), and the bytes from one row of texels to the next.
struct source {
  const texel565* origin;
  int32_t pitch_bytes;
};

namespace detail {

// Texel at the whole parts (v : u).
inline const texel565* texel_at(const source& s, uint32_t to_bytes, uint32_t vu) {
#if SPANTEX_ROWS_DSP
  return reinterpret_cast<const texel565*>(uintptr_t(dot(vu, to_bytes, uint32_t(reinterpret_cast<uintptr_t>(s.origin)))));
#else
  (void)to_bytes;
  return s.origin + int32_t(int16_t(vu)) + (int32_t(vu) >> 16) * (s.pitch_bytes >> 1);
#endif
}
constexpr uint32_t to_bytes(const source& s) { return uint32_t(s.pitch_bytes) << 16 | 2u; }
inline const texel565* below(const texel565* p, const source& s) {
  return reinterpret_cast<const texel565*>(reinterpret_cast<const uint8_t*>(p) + s.pitch_bytes);
}

// Runs are long on cores with DSP instructions, code is short on those without.
template <int Unroll, class Pixel>
[[gnu::always_inline]] inline void each(int count, Pixel pixel) {
#if SPANTEX_ROWS_DSP
  for (; count >= Unroll; count -= Unroll) {
#pragma GCC unroll 8
    for (int k = 0; k < Unroll; ++k) pixel();
  }
#endif
#pragma GCC unroll 0
  for (; count > 0; --count) pixel();
}

}  // namespace detail

// Whole positions wrapped by masks (height - 1 : width - 1), both powers of two.
inline void nearest_run(uint16_t* out, int count, walk at, source s, uint32_t masks) {
  const uint32_t to_bytes = detail::to_bytes(s);
  if ((at.ddu | at.ddv) == 0) {
    detail::each<8>(count, [&] {
      *out++ = *detail::texel_at(s, to_bytes, upper_halves(at.v, at.u) & masks);
      at.u += at.du;
      at.v += at.dv;
    });
    return;
  }
  detail::each<4>(count, [&] {
    *out++ = *detail::texel_at(s, to_bytes, upper_halves(at.v, at.u) & masks);
    at.step();
  });
}

namespace detail {

struct quad { uint32_t top, bottom; };  // pairs of texels
inline quad quad_at(const texel565* p, const source& s) { return {pair_at(p), pair_at(below(p, s))}; }

// Weights of the four texels, as pairs. columns: (fu : 1 - fu), maybe times a weight of the level.
struct quad_weights { uint32_t top, bottom; };
inline uint32_t column_weights(int32_t u) { return weight_of(u) * 0xFFFFu + (1u << weight_bits); }
SPANTEX_WRAPS inline quad_weights weights_at(uint32_t columns, int32_t v) {
  const uint32_t bottom = columns * weight_of(v);
  return {(columns << weight_bits) - bottom, bottom};
}

SPANTEX_WRAPS inline sums add_quad(sums s, const quad& t, const quad_weights& w) {
  constexpr uint32_t five = 0x001F001F, six = 0x003F003F;
  s.r = dot(t.bottom >> 11 & five, w.bottom, dot(t.top >> 11 & five, w.top, s.r));
  s.g = dot(t.bottom >> 5 & six, w.bottom, dot(t.top >> 5 & six, w.top, s.g));
  s.b = dot(t.bottom & five, w.bottom, dot(t.top & five, w.top, s.b));
  return s;
}

inline constexpr int bilinear_bits = 2 * weight_bits, trilinear_bits = bilinear_bits + blend_bits;
constexpr sums halves(int bits) { return {1u << bits >> 1, 1u << bits >> 1, 1u << bits >> 1}; }
constexpr uint16_t packed(const sums& s, int bits) { return uint16_t((s.r >> bits) << 11 | (s.g >> bits) << 5 | s.b >> bits); }

// The same without DSP instructions: along u three channels in one product, exact; then along v two and one.
struct halfway { uint32_t rb, g; };  // red in the upper half, blue in the lower; 5 fraction bits
inline halfway along_u(const texel565* p, uint32_t fu) {
  const uint32_t x = spread(p[0]) * ((1u << weight_bits) - fu) + spread(p[1]) * fu;
  return {(x & 0x3FFu) | (x & 0x3FFu << 11) << 5, x >> 21};
}
SPANTEX_WRAPS inline halfway along_v(const halfway& top, const halfway& bottom, uint32_t fv) {
  return {(top.rb << weight_bits) + (bottom.rb - top.rb) * fv, (top.g << weight_bits) + (bottom.g - top.g) * fv};
}
inline halfway four_points(const texel565* p, const source& s, uint32_t fu, uint32_t fv) { return along_v(along_u(p, fu), along_u(below(p, s), fu), fv); }

}  // namespace detail

// Snapped positions (sample.hpp).
inline void bilinear_run(uint16_t* out, int count, walk at, source s) {
  const uint32_t to_bytes = detail::to_bytes(s);
  detail::each<2>(count, [&] {
    const texel565* const p = detail::texel_at(s, to_bytes, upper_halves(at.v, at.u));
#if SPANTEX_ROWS_DSP
    const detail::quad_weights w = detail::weights_at(detail::column_weights(at.u), at.v);
    *out++ = detail::packed(detail::add_quad(detail::halves(detail::bilinear_bits), detail::quad_at(p, s), w), detail::bilinear_bits);
#else
    const detail::halfway c = detail::four_points(p, s, weight_of(at.u), weight_of(at.v));
    const uint32_t rb = c.rb + 0x02000200u, g = c.g + 0x200u;
    *out++ = uint16_t((rb >> 26) << 11 | (g >> 10) << 5 | (rb >> 10 & 31));
#endif
    at.step();
  });
}

inline void three_point_run(uint16_t* out, int count, walk at, source s) {
  constexpr uint32_t one = 1u << weight_bits, half = (1u | 1u << 11 | 1u << 21) << (weight_bits - 1);
  const uint32_t to_bytes = detail::to_bytes(s);
  detail::each<2>(count, [&] {
    const texel565* const p = detail::texel_at(s, to_bytes, upper_halves(at.v, at.u));
    const texel565* const q = detail::below(p, s);
    const uint32_t fu = weight_of(at.u), fv = weight_of(at.v);
    const texel565* side = p + 1;
    uint32_t low = fv, high = fu;
    if (fv >= fu) { side = q; low = fu; high = fv; }
    const uint32_t sum = spread(q[1]) * low + spread(*side) * (high - low) + spread(p[0]) * (one - high) + half;
    *out++ = uint16_t(gathered(sum >> weight_bits & spread_mask));
    at.step();
  });
}

// Positions on the finer level; those on the coarser follow: (fine + snap) / 2, floor. level, its step: 2^-16, its whole part the same all along.
inline void trilinear_run(uint16_t* out, int count, walk at, source fine, source coarse, int32_t level, int32_t level_step) {
  const uint32_t fine_bytes = detail::to_bytes(fine), coarse_bytes = detail::to_bytes(coarse);
  detail::each<1>(count, [&] {
    const uint32_t f = uint32_t(level) >> (16 - blend_bits) & ((1u << blend_bits) - 1);
    const int32_t u = (at.u + snap) >> 1, v = (at.v + snap) >> 1;
    const texel565* const p = detail::texel_at(fine, fine_bytes, upper_halves(at.v, at.u));
    const texel565* const q = detail::texel_at(coarse, coarse_bytes, upper_halves(v, u));
#if SPANTEX_ROWS_DSP
    const detail::quad_weights w = detail::weights_at(detail::column_weights(at.u) * ((1u << blend_bits) - f), at.v);
    const detail::quad_weights x = detail::weights_at(detail::column_weights(u) * f, v);
    const sums near = detail::add_quad(detail::halves(detail::trilinear_bits), detail::quad_at(p, fine), w);
    *out++ = detail::packed(detail::add_quad(near, detail::quad_at(q, coarse), x), detail::trilinear_bits);
#else
    const detail::halfway a = detail::four_points(p, fine, weight_of(at.u), weight_of(at.v));
    const detail::halfway b = detail::four_points(q, coarse, weight_of(u), weight_of(v));
    const uint32_t e = (1u << blend_bits) - f, half = 1u << detail::trilinear_bits >> 1;
    const uint32_t red = (a.rb >> 16) * e + (b.rb >> 16) * f + half, blue = (a.rb & 0xFFFF) * e + (b.rb & 0xFFFF) * f + half;
    *out++ = detail::packed({red, a.g * e + b.g * f + half, blue}, detail::trilinear_bits);
#endif
    at.step();
    level += level_step;
  });
}

}  // namespace spantex::rows
