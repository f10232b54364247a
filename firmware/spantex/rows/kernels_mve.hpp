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

// Eight pixels' positions between the two loops: whole part and 5 bits of fraction, in their order.
struct eight { uint16_t u[8], v[8]; };

inline void store(uint16_t* to, int32x4_t even, int32x4_t odd) {
  vst1q_u16(to, vreinterpretq_u16_s16(vshrntq_n_s32(vshrnbq_n_s32(vuninitializedq_s16(), even, 11), odd, 11)));
}

// Lanes are pixels 0 2 4 6, then 1 3 5 7, a step further.
[[gnu::always_inline]] inline void places_straight(eight* to, int count, const walk& at) {
  const uint32x4_t i = vidupq_n_u32(0, 2);
  uint32x4_t u = vaddq_n_u32(vmulq_n_u32(i, uint32_t(at.du)), uint32_t(at.u)), v = vaddq_n_u32(vmulq_n_u32(i, uint32_t(at.dv)), uint32_t(at.v)), x;
  asm volatile(
      "dlstp.16 lr, %[n]\n"
      "1: vshrnb.i32 %q[x], %q[u], #11\n"
      "vadd.i32 %q[u], %q[u], %[du]\n"
      "vshrnt.i32 %q[x], %q[u], #11\n"
      "vadd.i32 %q[u], %q[u], %[du7]\n"
      "vstrh.16 %q[x], [%[to]], #16\n"
      "vshrnb.i32 %q[x], %q[v], #11\n"
      "vadd.i32 %q[v], %q[v], %[dv]\n"
      "vshrnt.i32 %q[x], %q[v], #11\n"
      "vadd.i32 %q[v], %q[v], %[dv7]\n"
      "vstrh.16 %q[x], [%[to]], #16\n"
      "letp lr, 1b\n"
      : [to] "+r"(to), [u] "+w"(u), [v] "+w"(v), [x] "=&w"(x)
      : [n] "r"(count), [du] "r"(at.du), [dv] "r"(at.dv), [du7] "r"(7 * at.du), [dv7] "r"(7 * at.dv)
      : "lr", "memory", "cc");
}

// u + n du + n (n - 1)/2 ddu of one coordinate.
inline void places_bent(uint16_t* to, int count, int32_t u, int32_t du, int32_t ddu) {
  const int32x4_t i = vreinterpretq_s32_u32(vidupq_n_u32(0, 2)), j = vaddq_n_s32(i, 1);
  const auto at = [&](int32x4_t n) {
    const int32x4_t pairs = vshrq_n_s32(vmulq_s32(n, vsubq_n_s32(n, 1)), 1);
    return vaddq_n_s32(vaddq_s32(vmulq_n_s32(n, du), vmulq_n_s32(pairs, ddu)), u);
  };
  const auto step = [&](int32x4_t n) { return vaddq_n_s32(vmulq_n_s32(n, 8 * ddu), 8 * du + 28 * ddu); };
  int32x4_t even = at(i), odd = at(j), even_step = step(i), odd_step = step(j);
  for (; count > 0; count -= 8, to += 16) {
    store(to, even, odd);
    even = vaddq_s32(even, even_step);
    odd = vaddq_s32(odd, odd_step);
    even_step = vaddq_n_s32(even_step, 64 * ddu);
    odd_step = vaddq_n_s32(odd_step, 64 * ddu);
  }
}

// Eight pixels a turn, the last turn's lanes beyond `count` left alone. Along u, then along v, a channel as 32 a + (b - a) f; green is what red and
// blue leave of the whole texel, modulo 2^16.
[[gnu::always_inline]] inline void four_points(uint16_t* out, eight* from, int count, const texel565* corner, int32_t pitch) {
  const texel565* const below = corner + pitch;
  asm volatile(
      "dlstp.16 lr, %[n]\n"
      "1: vldrh.u16 q0, [%[from]], #16\n"
      "vldrh.u16 q1, [%[from]], #16\n"
      "vshr.u16 q2, q0, #5\n"
      "vshr.u16 q3, q1, #5\n"
      "vmov.i16 q4, #31\n"
      "vmla.u16 q2, q3, %[pitch]\n"  // texel
      "vand q0, q0, q4\n"            // fu
      "vand q1, q1, q4\n"            // fv
      "vldrh.u16 q3, [%[t00], q2, uxtw #1]\n"
      "vldrh.u16 q5, [%[t10], q2, uxtw #1]\n"
      "vstrh.16 q1, [%[from], #-16]\n"
      "vshr.u16 q1, q3, #11\n"       // red
      "vshr.u16 q6, q5, #11\n"
      "vsub.i16 q6, q6, q1\n"
      "vmul.i16 q6, q6, q0\n"
      "vmla.u16 q6, q1, %[r32]\n"
      "vand q1, q3, q4\n"            // blue
      "vand q7, q5, q4\n"
      "vsub.i16 q7, q7, q1\n"
      "vmul.i16 q7, q7, q0\n"
      "vmla.u16 q7, q1, %[r32]\n"
      "vsub.i16 q5, q5, q3\n"        // all, less red, less blue: 32 green
      "vmul.i16 q5, q5, q0\n"
      "vmla.u16 q5, q3, %[r32]\n"
      "vmla.u16 q5, q6, %[red]\n"
      "vsub.i16 q5, q5, q7\n"
      "vshr.u16 q5, q5, #5\n"
      "vldrh.u16 q1, [%[t01], q2, uxtw #1]\n"
      "vldrh.u16 q3, [%[t11], q2, uxtw #1]\n"
      "vshr.u16 q2, q1, #11\n"
      "vshr.u16 q4, q3, #11\n"
      "vsub.i16 q4, q4, q2\n"
      "vmul.i16 q4, q4, q0\n"
      "vmla.u16 q4, q2, %[r32]\n"
      "vldrh.u16 q2, [%[from], #-16]\n"
      "vsub.i16 q4, q4, q6\n"
      "vmlas.u16 q4, q2, %[half]\n"
      "vmla.u16 q4, q6, %[r32]\n"    // red, done
      "vbic.i16 q1, #0xF800\n"
      "vbic.i16 q3, #0xF800\n"
      "vmov.i16 q6, #31\n"
      "vand q2, q1, q6\n"
      "vand q6, q3, q6\n"
      "vsub.i16 q6, q6, q2\n"
      "vmul.i16 q6, q6, q0\n"
      "vmla.u16 q6, q2, %[r32]\n"
      "vsub.i16 q3, q3, q1\n"
      "vmul.i16 q3, q3, q0\n"
      "vmla.u16 q3, q1, %[r32]\n"
      "vldrh.u16 q2, [%[from], #-16]\n"
      "vsub.i16 q3, q3, q6\n"
      "vshr.u16 q3, q3, #5\n"
      "vsub.i16 q3, q3, q5\n"
      "vmlas.u16 q3, q2, %[half]\n"
      "vmla.u16 q3, q5, %[r32]\n"    // green, done
      "vsub.i16 q6, q6, q7\n"
      "vmlas.u16 q6, q2, %[half]\n"
      "vmla.u16 q6, q7, %[r32]\n"    // blue, done
      "vshl.i16 q4, q4, #1\n"
      "vshl.i16 q6, q6, #1\n"
      "vsri.16 q4, q3, #5\n"
      "vsri.16 q4, q6, #11\n"
      "vstrh.16 q4, [%[out]], #16\n"
      "letp lr, 1b\n"
      : [out] "+r"(out), [from] "+r"(from)
      : [n] "r"(count), [pitch] "r"(pitch), [t00] "r"(corner), [t10] "r"(corner + 1), [t01] "r"(below), [t11] "r"(below + 1), [r32] "r"(32), [half] "r"(512),
        [red] "r"(-2048)
      : "q0", "q1", "q2", "q3", "q4", "q5", "q6", "q7", "lr", "memory", "cc");
}

// Positions are at least 0 from `corner`. One function: the vector registers of the caller are saved once.
[[gnu::noinline]] inline void bilinear(uint16_t* out, int count, const walk& at, const texel565* corner, int32_t pitch, uint32_t* between) {
  eight* const places = reinterpret_cast<eight*>(between);
  if ((at.ddu | at.ddv) == 0) {
    places_straight(places, count, at);
  } else {
    places_bent(places->u, count, at.u, at.du, at.ddu);
    places_bent(places->v, count, at.v, at.dv, at.ddv);
  }
  four_points(out, places, count, corner, pitch);
}

}  // namespace spantex::rows::mve
