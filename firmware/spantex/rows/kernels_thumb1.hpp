// SPDX-License-Identifier: Apache-2.0
// Inner loops of kernels.hpp for cores with eight registers (Cortex-M0, M0+): nearest texels, eight at a time: 9 instructions a pixel, bent
// rows 2 more, the loop 3 for eight pixels; bilinear 76, bent rows 4 more. What is only added or copied lies in the upper registers.
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>

namespace spantex::rows::thumb1 {

// clang-format off
#define SPANTEX_PIXEL(OFFSET, BEND) "asrs %[t], %[u], #16\n adds %[t], %[t], %[t]\n asrs %[s], %[v], #16\n muls %[s], %[pitch], %[s]\n adds %[t], %[t], %[s]\n" \
                                    "add %[u], %[du]\n add %[v], %[dv]\n ldrh %[t], [%[base], %[t]]\n strh %[t], [%[out], #" OFFSET "]\n" BEND
#define SPANTEX_MASKED(OFFSET, BEND) "lsrs %[t], %[u], #15\n ands %[t], %[mu]\n lsrs %[s], %[v], #15\n ands %[s], %[mv]\n adds %[t], %[t], %[s]\n" \
                                     "add %[u], %[du]\n add %[v], %[dv]\n ldrh %[t], [%[base], %[t]]\n strh %[t], [%[out], #" OFFSET "]\n" BEND
#define SPANTEX_BEND "add %[du], %[ddu]\n add %[dv], %[ddv]\n"
#define SPANTEX_LOOP(PIXEL, BEND) ".syntax unified\n 1:\n" PIXEL("0", BEND) PIXEL("2", BEND) PIXEL("4", BEND) PIXEL("6", BEND) \
                                  PIXEL("8", BEND) PIXEL("10", BEND) PIXEL("12", BEND) PIXEL("14", BEND) \
                                  "adds %[out], %[out], #16\n cmp %[out], %[end]\n bne 1b\n"
// clang-format on

// `count` pixels, a multiple of eight and not 0; the walk goes on. origin: the texel at (0, 0).
inline void nearest(uint16_t* out, int count, walk& at, const texel565* origin, int32_t pitch_bytes) {
  uint32_t t, s;
  const uint16_t* const end = out + count;
  if ((at.ddu | at.ddv) == 0)
    asm volatile(SPANTEX_LOOP(SPANTEX_PIXEL, "")
                 : [out] "+l"(out), [u] "+l"(at.u), [v] "+l"(at.v), [t] "=&l"(t), [s] "=&l"(s)
                 : [base] "l"(origin), [pitch] "l"(pitch_bytes), [du] "h"(at.du), [dv] "h"(at.dv), [end] "h"(end)
                 : "memory", "cc");
  else
    asm volatile(SPANTEX_LOOP(SPANTEX_PIXEL, SPANTEX_BEND)
                 : [out] "+l"(out), [u] "+l"(at.u), [v] "+l"(at.v), [t] "=&l"(t), [s] "=&l"(s), [du] "+h"(at.du), [dv] "+h"(at.dv)
                 : [base] "l"(origin), [pitch] "l"(pitch_bytes), [ddu] "h"(at.ddu), [ddv] "h"(at.ddv), [end] "h"(end)
                 : "memory", "cc");
}

// The same with whole positions wrapped by masks (height - 1 : width - 1) of at most 2^16 texels: v is brought to the place where its bits are wanted.
inline bool masks_fit(uint32_t masks) { return bit_length(masks & 0xFFFF) + bit_length(masks >> 16) <= 16; }
SPANTEX_WRAPS inline void nearest_masked(uint16_t* out, int count, walk& at, const texel565* texels, uint32_t masks) {
  uint32_t t, s;
  const uint16_t* const end = out + count;
  const uint32_t columns = masks & 0xFFFF, mu = 2 * columns, mv = (masks >> 16) * 2 * (columns + 1);
  const int up = bit_length(columns);
  uint32_t v = uint32_t(at.v) << up, dv = uint32_t(at.dv) << up;
  if ((at.ddu | at.ddv) == 0) {
    asm volatile(SPANTEX_LOOP(SPANTEX_MASKED, "")
                 : [out] "+l"(out), [u] "+l"(at.u), [v] "+l"(v), [t] "=&l"(t), [s] "=&l"(s)
                 : [mu] "l"(mu), [mv] "l"(mv), [base] "l"(texels), [du] "h"(at.du), [dv] "h"(dv), [end] "h"(end)
                 : "memory", "cc");
    at.v += count * at.dv;
  } else {
    asm volatile(SPANTEX_LOOP(SPANTEX_MASKED, SPANTEX_BEND)
                 : [out] "+l"(out), [u] "+l"(at.u), [v] "+l"(v), [t] "=&l"(t), [s] "=&l"(s), [du] "+h"(at.du), [dv] "+h"(dv)
                 : [mu] "l"(mu), [mv] "l"(mv), [base] "l"(texels), [ddu] "h"(at.ddu), [ddv] "h"(uint32_t(at.ddv) << up), [end] "h"(end)
                 : "memory", "cc");
    at.v += count * at.dv + count * (count - 1) / 2 * at.ddv;
    at.dv += count * at.ddv;
  }
}

#undef SPANTEX_PIXEL
#undef SPANTEX_MASKED
#undef SPANTEX_BEND
#undef SPANTEX_LOOP

// Two texels of a row along u, each channel a half of its last bit more: 32 of them are what rounds the pixel. %[a]: address, then nothing; %[f]: fu.
// clang-format off
#define SPANTEX_ROW(TO, OTHER, TEMP) "ldrh " TO ", [%[a]]\n ldrh " OTHER ", [%[a], #2]\n" TEMP \
                                     "subs " OTHER ", " OTHER ", " TO "\n muls " OTHER ", %[f], " OTHER "\n lsls " TO ", " TO ", #5\n adds " TO ", " TO ", " OTHER "\n add " TO ", %[half]\n"
#define SPANTEX_SPREAD(X, TEMP) "lsls " TEMP ", " X ", #16\n orrs " X ", " TEMP "\n ands " X ", %[mask]\n"
#define SPANTEX_LERP(A, B) "subs " B ", " B ", " A "\n muls " B ", %[g], " B "\n lsls " A ", " A ", #5\n adds " B ", " B ", " A "\n"
#define SPANTEX_BILINEAR(OFFSET, BEND) \
  "mov %[f], %[u]\n mov %[g], %[v]\n add %[u], %[du]\n add %[v], %[dv]\n" BEND \
  "asrs %[a], %[f], #16\n adds %[a], %[a], %[a]\n asrs %[x], %[g], #16\n muls %[x], %[pitch], %[x]\n adds %[a], %[a], %[x]\n ldr %[x], %[base]\n adds %[a], %[a], %[x]\n" \
  "lsls %[f], %[f], #16\n lsrs %[f], %[f], #27\n lsls %[g], %[g], #16\n lsrs %[g], %[g], #27\n" \
  SPANTEX_ROW("%[x]", "%[y]", SPANTEX_SPREAD("%[x]", "%[z]") SPANTEX_SPREAD("%[y]", "%[z]")) \
  "adds %[a], %[a], %[pitch]\n" \
  SPANTEX_ROW("%[y]", "%[z]", SPANTEX_SPREAD("%[y]", "%[a]") SPANTEX_SPREAD("%[z]", "%[a]")) \
  /* green of both rows, then red over blue */ \
  "lsrs %[a], %[x], #21\n lsrs %[z], %[y], #21\n" SPANTEX_LERP("%[a]", "%[z]") \
  "ldr %[f], %[red]\n lsls %[a], %[x], #5\n ands %[a], %[f]\n lsls %[x], %[x], #22\n lsrs %[x], %[x], #22\n orrs %[x], %[a]\n" \
  "lsls %[a], %[y], #5\n ands %[a], %[f]\n lsls %[y], %[y], #22\n lsrs %[y], %[y], #22\n orrs %[y], %[a]\n" SPANTEX_LERP("%[x]", "%[y]") \
  "lsrs %[a], %[y], #26\n lsls %[a], %[a], #6\n lsrs %[z], %[z], #10\n orrs %[a], %[z]\n lsls %[a], %[a], #5\n" \
  "lsls %[y], %[y], #17\n lsrs %[y], %[y], #27\n orrs %[a], %[y]\n ldr %[x], %[out]\n strh %[a], [%[x], #" OFFSET "]\n"
#define SPANTEX_BILINEAR_LOOP(BEND) \
  ".syntax unified\n cmp %[f], #0\n bne 2f\n 1:\n" SPANTEX_BILINEAR("0", BEND) "2:\n" SPANTEX_BILINEAR("2", BEND) \
  "adds %[x], %[x], #4\n str %[x], %[out]\n ldr %[a], %[end]\n cmp %[x], %[a]\n beq 3f\n b 1b\n 3:\n"
#define SPANTEX_BEND "ldr %[x], %[ddu]\n add %[du], %[x]\n ldr %[x], %[ddv]\n add %[dv], %[x]\n"
// clang-format on

// count > 0. Where it is odd the first turn is its second half.
inline void bilinear(uint16_t* to, int count, const walk& at, const texel565* origin, int32_t pitch_bytes) {
  uint32_t f = uint32_t(count) & 1, a, g, x, y, z;
  const uint16_t *out = to - f, *const end = to + count;
  int32_t u = at.u, v = at.v, du = at.du, dv = at.dv;
  const int32_t ddu = at.ddu, ddv = at.ddv;
  const uint32_t red = 0x03FF0000;
  if ((at.ddu | at.ddv) == 0)
    asm volatile(SPANTEX_BILINEAR_LOOP("")
                 : [out] "+m"(out), [u] "+h"(u), [v] "+h"(v), [f] "+l"(f), [a] "=&l"(a), [g] "=&l"(g), [x] "=&l"(x), [y] "=&l"(y), [z] "=&l"(z)
                 : [pitch] "l"(pitch_bytes), [mask] "l"(spread_mask), [base] "m"(origin), [du] "h"(du), [dv] "h"(dv), [half] "h"((1u | 1u << 11 | 1u << 21) << 4),
                   [red] "m"(red), [end] "m"(end)
                 : "memory", "cc");
  else
    asm volatile(SPANTEX_BILINEAR_LOOP(SPANTEX_BEND)
                 : [out] "+m"(out), [u] "+h"(u), [v] "+h"(v), [du] "+h"(du), [dv] "+h"(dv), [f] "+l"(f), [a] "=&l"(a), [g] "=&l"(g), [x] "=&l"(x), [y] "=&l"(y),
                   [z] "=&l"(z)
                 : [pitch] "l"(pitch_bytes), [mask] "l"(spread_mask), [base] "m"(origin), [half] "h"((1u | 1u << 11 | 1u << 21) << 4), [red] "m"(red),
                   [end] "m"(end), [ddu] "m"(ddu), [ddv] "m"(ddv)
                 : "memory", "cc");
}

#undef SPANTEX_ROW
#undef SPANTEX_SPREAD
#undef SPANTEX_LERP
#undef SPANTEX_BILINEAR
#undef SPANTEX_BILINEAR_LOOP
#undef SPANTEX_BEND

}  // namespace spantex::rows::thumb1
