// SPDX-License-Identifier: Apache-2.0
// Bilinear runs with M-profile vectors (MVE, Cortex-M55): eight pixels at a time in 16-bit lanes, four gathers, exact sums of 16 bits (63 * 1024 + 512).
// The only header of the library that includes a compiler's own (arm_mve.h).
#pragma once
#include <arm_mve.h>
#include <stdint.h>

#include <spantex/bits.hpp>

namespace spantex::rows::mve {

// Whether offsets from the run's corner fit 16 bits: `rows` texel rows of `pitch` texels.
constexpr bool offsets_fit(int32_t rows, int32_t pitch) { return rows * pitch <= 0xFFFF; }

// One coordinate of pixels 0 2 4 6 and 1 3 5 7, and what eight pixels add.
struct lanes { int32x4_t even, odd, even_step, odd_step; };
inline lanes lanes_of(int32_t u, int32_t du, int32_t ddu) {
  const int32x4_t i = vreinterpretq_s32_u32(vidupq_n_u32(0, 2)), j = vaddq_n_s32(i, 1);
  const auto at = [&](int32x4_t n) {  // u + n du + n (n - 1)/2 ddu
    const int32x4_t pairs = vshrq_n_s32(vmulq_s32(n, vsubq_n_s32(n, 1)), 1);
    return vaddq_n_s32(vaddq_s32(vmulq_n_s32(n, du), vmulq_n_s32(pairs, ddu)), u);
  };
  const auto step = [&](int32x4_t n) { return vaddq_n_s32(vmulq_n_s32(n, 8 * ddu), 8 * du + 28 * ddu); };
  return {at(i), at(j), step(i), step(j)};
}
// Whole part and 5 bits of fraction of eight pixels, in their order.
inline int16x8_t narrowed(const lanes& x) { return vshrntq_n_s32(vshrnbq_n_s32(vuninitializedq_s16(), x.even, 11), x.odd, 11); }
inline void step(lanes& x, int32_t ddu) {
  x.even = vaddq_s32(x.even, x.even_step);
  x.odd = vaddq_s32(x.odd, x.odd_step);
  if (ddu != 0) {
    x.even_step = vaddq_n_s32(x.even_step, 64 * ddu);
    x.odd_step = vaddq_n_s32(x.odd_step, 64 * ddu);
  }
}

struct weights { uint16x8_t w00, w10, w01, w11; };
inline uint16x8_t sum_of(uint16x8_t t00, uint16x8_t t10, uint16x8_t t01, uint16x8_t t11, const weights& w) {
  const uint16x8_t top = vaddq_u16(vmulq_u16(t00, w.w00), vmulq_u16(t10, w.w10)), bottom = vaddq_u16(vmulq_u16(t01, w.w01), vmulq_u16(t11, w.w11));
  return vrshrq_n_u16(vaddq_u16(top, bottom), 10);
}

// Positions are at least 0 from `corner`.
[[gnu::noinline]] inline void bilinear(uint16_t* out, int count, const walk& at, const texel565* corner, int32_t pitch) {
  lanes u = lanes_of(at.u, at.du, at.ddu), v = lanes_of(at.v, at.dv, at.ddv);
  const uint16_t* const t = reinterpret_cast<const uint16_t*>(corner);
  for (; count > 0; count -= 8, out += 8) {
    const mve_pred16_t inside = vctp16q(uint32_t(count));
    const uint16x8_t pu = vreinterpretq_u16_s16(narrowed(u)), pv = vreinterpretq_u16_s16(narrowed(v));
    const uint16x8_t at_texel = vmlaq_n_u16(vshrq_n_u16(pu, 5), vshrq_n_u16(pv, 5), uint16_t(pitch));
    const uint16x8_t t00 = vldrhq_gather_shifted_offset_z_u16(t, at_texel, inside), t10 = vldrhq_gather_shifted_offset_z_u16(t + 1, at_texel, inside);
    const uint16x8_t t01 = vldrhq_gather_shifted_offset_z_u16(t + pitch, at_texel, inside), t11 = vldrhq_gather_shifted_offset_z_u16(t + pitch + 1, at_texel, inside);
    const uint16x8_t five = vdupq_n_u16(31), fu = vandq_u16(pu, five), fv = vandq_u16(pv, five);
    weights w;
    w.w11 = vmulq_u16(fu, fv);
    const uint16x8_t columns = vshlq_n_u16(fu, 5);
    w.w10 = vsubq_u16(columns, w.w11);
    w.w01 = vsubq_u16(vshlq_n_u16(fv, 5), w.w11);
    w.w00 = vsubq_u16(vsubq_u16(vdupq_n_u16(1024), columns), w.w01);
    const auto green = [](uint16x8_t x) { return vshrq_n_u16(vshlq_n_u16(x, 5), 10); };
    const uint16x8_t b = sum_of(vandq_u16(t00, five), vandq_u16(t10, five), vandq_u16(t01, five), vandq_u16(t11, five), w);
    const uint16x8_t g = sum_of(green(t00), green(t10), green(t01), green(t11), w);
    const uint16x8_t r = sum_of(vshrq_n_u16(t00, 11), vshrq_n_u16(t10, 11), vshrq_n_u16(t01, 11), vshrq_n_u16(t11, 11), w);
    vstrhq_p_u16(out, vsliq_n_u16(vsliq_n_u16(b, g, 5), r, 11), inside);
    step(u, at.ddu);
    step(v, at.ddv);
  }
}

}  // namespace spantex::rows::mve
