// SPDX-License-Identifier: Apache-2.0
// Inner loops of kernels.hpp for cores with eight registers (Cortex-M0, M0+): nearest texels, eight at a time: 9 instructions a pixel, bent
// rows 2 more, the loop 3 for eight pixels. Steps, which are only added, lie in the upper registers.
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

}  // namespace spantex::rows::thumb1
