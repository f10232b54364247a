// SPDX-License-Identifier: Apache-2.0
// Inner loops of kernels.hpp in the instructions of Cortex-M4, M7, M33 and M55 (DSP extension). A filter takes two loops, since its numbers do not
// fit 14 registers at once: the first turns positions into addresses and weights, the second filters.
//
//   instructions a pixel   nearest 8 (masked 9)   three-point 7 + 21   bilinear 13 + 21   trilinear 36 + 40; 2 to 8 less along straight rows
//
// Input: walks in 2^-16 texel; weights of 5 bits; sums below 2^16 (bilinear), 2^20 (trilinear): nothing overflows.
#pragma once
#include <stdint.h>

#include <spantex/rows/packed.hpp>

namespace spantex::rows::dsp {

// clang-format off
#define SPANTEX_PIXEL(MASK, STEP) "pkhtb %[t], %[v], %[u], asr #16\n" MASK "smlad %[t], %[t], %[k], %[o]\n ldrh %[t], [%[t]]\n" \
                                  "add %[u], %[u], %[du]\n add %[v], %[v], %[dv]\n strh %[t], [%[out]], #2\n" STEP
#define SPANTEX_8_PIXELS(PIXEL) "subs %[n], %[n], #8\n blt 2f\n 1:\n" PIXEL PIXEL PIXEL PIXEL PIXEL PIXEL PIXEL PIXEL "subs %[n], %[n], #8\n bge 1b\n" \
                                "2: adds %[n], %[n], #8\n beq 4f\n 3:\n" PIXEL "subs %[n], %[n], #1\n bne 3b\n 4:\n"
#define SPANTEX_MASK "and %[t], %[t], %[m]\n"
#define SPANTEX_BEND "add %[du], %[du], %[ddu]\n add %[dv], %[dv], %[ddv]\n"
// clang-format on

// Texels at (v : u), maybe & masks, one after the other. to_bytes, origin: kernels.hpp.
inline void nearest_straight(uint16_t* out, int count, const walk& at, uint32_t origin, uint32_t to_bytes) {
  uint32_t t;
  int32_t u = at.u, v = at.v;
  asm volatile(SPANTEX_8_PIXELS(SPANTEX_PIXEL("", ""))
               : [out] "+r"(out), [n] "+r"(count), [u] "+r"(u), [v] "+r"(v), [t] "=&r"(t)
               : [du] "r"(at.du), [dv] "r"(at.dv), [k] "r"(to_bytes), [o] "r"(origin)
               : "memory", "cc");
}
inline void nearest_masked_straight(uint16_t* out, int count, const walk& at, uint32_t origin, uint32_t to_bytes, uint32_t masks) {
  uint32_t t;
  int32_t u = at.u, v = at.v;
  asm volatile(SPANTEX_8_PIXELS(SPANTEX_PIXEL(SPANTEX_MASK, ""))
               : [out] "+r"(out), [n] "+r"(count), [u] "+r"(u), [v] "+r"(v), [t] "=&r"(t)
               : [du] "r"(at.du), [dv] "r"(at.dv), [k] "r"(to_bytes), [o] "r"(origin), [m] "r"(masks)
               : "memory", "cc");
}
inline void nearest_bent(uint16_t* out, int count, const walk& at, uint32_t origin, uint32_t to_bytes) {
  uint32_t t;
  int32_t u = at.u, v = at.v, du = at.du, dv = at.dv;
  asm volatile(SPANTEX_8_PIXELS(SPANTEX_PIXEL("", SPANTEX_BEND))
               : [out] "+r"(out), [n] "+r"(count), [u] "+r"(u), [v] "+r"(v), [du] "+r"(du), [dv] "+r"(dv), [t] "=&r"(t)
               : [ddu] "r"(at.ddu), [ddv] "r"(at.ddv), [k] "r"(to_bytes), [o] "r"(origin)
               : "memory", "cc");
}
inline void nearest_masked_bent(uint16_t* out, int count, const walk& at, uint32_t origin, uint32_t to_bytes, uint32_t masks) {
  uint32_t t;
  int32_t u = at.u, v = at.v, du = at.du, dv = at.dv;
  asm volatile(SPANTEX_8_PIXELS(SPANTEX_PIXEL(SPANTEX_MASK, SPANTEX_BEND))
               : [out] "+r"(out), [n] "+r"(count), [u] "+r"(u), [v] "+r"(v), [du] "+r"(du), [dv] "+r"(dv), [t] "=&r"(t)
               : [ddu] "r"(at.ddu), [ddv] "r"(at.ddv), [k] "r"(to_bytes), [o] "r"(origin), [m] "r"(masks)
               : "memory", "cc");
}
#undef SPANTEX_PIXEL
#undef SPANTEX_8_PIXELS
#undef SPANTEX_MASK
#undef SPANTEX_BEND

inline constexpr int scratch_words = 6 * 16;  // between the two loops of a filter: 32 pixels of bilinear, 16 of trilinear

// clang-format off
#define SPANTEX_STEP "add %[u], %[u], %[du]\n add %[v], %[v], %[dv]\n add %[du], %[du], %[ddu]\n add %[dv], %[dv], %[ddv]\n"
// Address, and weights of the four texels in pairs, 10 bits: (columns << 5) - bottom, bottom = columns * fv, columns = (fu : 32 - fu).
#define SPANTEX_PLACE "pkhtb r4, %[v], %[u], asr #16\n ubfx r5, %[u], #11, #5\n smlad r4, r4, %[k], %[o]\n rsb %[w], r5, #32\n" \
                      "orr %[w], %[w], r5, lsl #16\n ubfx r5, %[v], #11, #5\n mul r6, %[w], r5\n rsb r5, r6, %[w], lsl #5\n stmia %[to]!, {r4, r5, r6}\n" SPANTEX_STEP
// clang-format on

// Along straight rows two registers are free for a product that makes the columns.
// clang-format off
#define SPANTEX_STRAIGHT "pkhtb r4, %[v], %[u], asr #16\n ubfx r5, %[u], #11, #5\n smlad r4, r4, %[k], %[o]\n mla %[w], r5, %[ffff], %[one]\n" \
                         "ubfx r5, %[v], #11, #5\n add %[u], %[u], %[du]\n mul r6, %[w], r5\n add %[v], %[v], %[dv]\n rsb r5, r6, %[w], lsl #5\n stmia %[to]!, {r4, r5, r6}\n"
// clang-format on

// count > 0; three words a pixel.
[[gnu::always_inline]] inline void weighted_places_straight(uint32_t* to, int count, const walk& at, uint32_t origin, uint32_t to_bytes) {
  uint32_t w;
  int32_t u = at.u, v = at.v;
  asm volatile(
      "subs %[n], %[n], #4\n blt 2f\n"
      "1:\n" SPANTEX_STRAIGHT SPANTEX_STRAIGHT SPANTEX_STRAIGHT SPANTEX_STRAIGHT
      "subs %[n], %[n], #4\n bge 1b\n"
      "2: adds %[n], %[n], #4\n beq 4f\n"
      "3:\n" SPANTEX_STRAIGHT "subs %[n], %[n], #1\n bne 3b\n"
      "4:\n"
      : [to] "+r"(to), [n] "+r"(count), [u] "+r"(u), [v] "+r"(v), [w] "=&r"(w)
      : [du] "r"(at.du), [dv] "r"(at.dv), [k] "r"(to_bytes), [o] "r"(origin), [ffff] "r"(0xFFFF), [one] "r"(32)
      : "r4", "r5", "r6", "memory", "cc");
}
#undef SPANTEX_STRAIGHT

[[gnu::always_inline]] inline void weighted_places(uint32_t* to, int count, const walk& at, uint32_t origin, uint32_t to_bytes) {
  uint32_t w;
  int32_t u = at.u, v = at.v, du = at.du, dv = at.dv;
  asm volatile(
      "subs %[n], %[n], #4\n blt 2f\n"
      "1:\n" SPANTEX_PLACE SPANTEX_PLACE SPANTEX_PLACE SPANTEX_PLACE
      "subs %[n], %[n], #4\n bge 1b\n"
      "2: adds %[n], %[n], #4\n beq 4f\n"
      "3:\n" SPANTEX_PLACE "subs %[n], %[n], #1\n bne 3b\n"
      "4:\n"
      : [to] "+r"(to), [n] "+r"(count), [u] "+r"(u), [v] "+r"(v), [du] "+r"(du), [dv] "+r"(dv), [w] "=&r"(w)
      : [ddu] "r"(at.ddu), [ddv] "r"(at.ddv), [k] "r"(to_bytes), [o] "r"(origin)
      : "r4", "r5", "r6", "memory", "cc");
}
#undef SPANTEX_PLACE

// clang-format off
#define SPANTEX_FILTER "ldmia %[from]!, {r4, r5, r6}\n ldr %[x], [r4]\n ldr %[y], [r4, %[pitch]]\n" \
                       "and %[g], %[six], %[x], lsr #5\n and r4, %[six], %[y], lsr #5\n smlad %[g], %[g], r5, %[half]\n smlad %[g], r4, r6, %[g]\n" \
                       "and %[r], %[five], %[x], lsr #11\n and r4, %[five], %[y], lsr #11\n smlad %[r], %[r], r5, %[half]\n smlad %[r], r4, r6, %[r]\n" \
                       "and %[x], %[x], %[five]\n and %[y], %[y], %[five]\n smlad %[x], %[x], r5, %[half]\n smlad %[x], %[y], r6, %[x]\n" \
                       "lsr %[r], %[r], #10\n lsr %[x], %[x], #10\n orr %[x], %[x], %[r], lsl #11\n lsr %[g], %[g], #10\n orr %[x], %[x], %[g], lsl #5\n strh %[x], [%[out]], #2\n"
// clang-format on

[[gnu::always_inline]] inline void four_points(uint16_t* out, const uint32_t* from, int count, uint32_t pitch_bytes) {
  uint32_t x, y, g, r;
  asm volatile(
      "subs %[n], %[n], #2\n blt 2f\n"
      "1:\n" SPANTEX_FILTER SPANTEX_FILTER
      "subs %[n], %[n], #2\n bge 1b\n"
      "2: adds %[n], %[n], #2\n beq 4f\n" SPANTEX_FILTER
      "4:\n"
      : [out] "+r"(out), [from] "+r"(from), [n] "+r"(count), [x] "=&r"(x), [y] "=&r"(y), [g] "=&r"(g), [r] "=&r"(r)
      : [five] "r"(0x001F001F), [six] "r"(0x003F003F), [half] "r"(512), [pitch] "r"(pitch_bytes)
      : "r4", "r5", "r6", "memory", "cc");
}
#undef SPANTEX_FILTER

// clang-format off
#define SPANTEX_POSITION "pkhtb r4, %[v], %[u], asr #16\n smlad r4, r4, %[k], %[o]\n stmia %[to]!, {r4, r5, r6}\n add %[u], %[u], %[du]\n add %[v], %[v], %[dv]\n"
#define SPANTEX_BEND     "add %[du], %[du], %[ddu]\n add %[dv], %[dv], %[ddv]\n"
#define SPANTEX_4_PIXELS(PIXEL) "subs %[n], %[n], #4\n blt 2f\n 1:\n" PIXEL PIXEL PIXEL PIXEL "subs %[n], %[n], #4\n bge 1b\n" \
                                "2: adds %[n], %[n], #4\n beq 4f\n 3:\n" PIXEL "subs %[n], %[n], #1\n bne 3b\n 4:\n"
// clang-format on

// Addresses and positions, three words a pixel.
[[gnu::always_inline]] inline void places(uint32_t* to, int count, const walk& at, uint32_t origin, uint32_t to_bytes) {
  int32_t du = at.du, dv = at.dv;
  register int32_t u asm("r5") = at.u;
  register int32_t v asm("r6") = at.v;
  asm volatile(SPANTEX_4_PIXELS(SPANTEX_POSITION SPANTEX_BEND)
               : [to] "+r"(to), [n] "+r"(count), [u] "+r"(u), [v] "+r"(v), [du] "+r"(du), [dv] "+r"(dv)
               : [ddu] "r"(at.ddu), [ddv] "r"(at.ddv), [k] "r"(to_bytes), [o] "r"(origin)
               : "r4", "memory", "cc");
}
[[gnu::always_inline]] inline void places_straight(uint32_t* to, int count, const walk& at, uint32_t origin, uint32_t to_bytes) {
  register int32_t u asm("r5") = at.u;
  register int32_t v asm("r6") = at.v;
  asm volatile(SPANTEX_4_PIXELS(SPANTEX_POSITION)
               : [to] "+r"(to), [n] "+r"(count), [u] "+r"(u), [v] "+r"(v)
               : [du] "r"(at.du), [dv] "r"(at.dv), [k] "r"(to_bytes), [o] "r"(origin)
               : "r4", "memory", "cc");
}
#undef SPANTEX_POSITION
#undef SPANTEX_BEND
#undef SPANTEX_4_PIXELS

// t00 (32 - high) + side d1 + ... as 32 t00 + (side - t00) high + (t11 - side) low; the two triangles part by a branch.
// clang-format off
#define SPANTEX_HEAD "ldmia %[from]!, {r4, r5, r6}\n ldr %[x], [r4]\n ldr %[y], [r4, %[pitch]]\n ubfx r5, r5, #11, #5\n ubfx r6, r6, #11, #5\n cmp r6, r5\n"
#define SPANTEX_TAIL(HIGH, LOW) "and %[s], %[s], %[mask]\n pkhtb %[y], %[y], %[y], asr #16\n pkhbt %[x], %[x], %[x], lsl #16\n" \
                      "and %[y], %[y], %[mask]\n and %[x], %[x], %[mask]\n" \
                      "sub %[y], %[y], %[s]\n sub %[s], %[s], %[x]\n add %[x], %[half], %[x], lsl #5\n mla %[x], %[s], " HIGH ", %[x]\n mla %[x], %[y], " LOW ", %[x]\n" \
                      "and %[x], %[mask], %[x], lsr #5\n orr %[x], %[x], %[x], lsr #16\n strh %[x], [%[out]], #2\n"
#define SPANTEX_LEFT  "pkhbt %[s], %[y], %[y], lsl #16\n" SPANTEX_TAIL("r6", "r5")
#define SPANTEX_RIGHT "pkhtb %[s], %[x], %[x], asr #16\n" SPANTEX_TAIL("r5", "r6")
// clang-format on

[[gnu::always_inline]] inline void three_points(uint16_t* out, const uint32_t* from, int count, uint32_t pitch_bytes) {
  uint32_t x, y, s;
  asm volatile(
      "tst %[n], #1\n beq 1f\n"
      SPANTEX_HEAD "blt 2f\n" SPANTEX_LEFT "subs %[n], %[n], #1\n bne 1f\n b 9f\n"
      "2:\n" SPANTEX_RIGHT "subs %[n], %[n], #1\n beq 9f\n"
      "1:\n" SPANTEX_HEAD "blt 4f\n" SPANTEX_LEFT SPANTEX_HEAD "blt 5f\n" SPANTEX_LEFT "subs %[n], %[n], #2\n bne 1b\n b 9f\n"
      "4:\n" SPANTEX_RIGHT SPANTEX_HEAD "blt 5f\n" SPANTEX_LEFT "subs %[n], %[n], #2\n bne 1b\n b 9f\n"
      "5:\n" SPANTEX_RIGHT "subs %[n], %[n], #2\n bne 1b\n"
      "9:\n"
      : [out] "+r"(out), [from] "+r"(from), [n] "+r"(count), [x] "=&r"(x), [y] "=&r"(y), [s] "=&r"(s)
      : [mask] "r"(spread_mask), [half] "r"((1u | 1u << 11 | 1u << 21) << 4), [pitch] "r"(pitch_bytes)
      : "r4", "r5", "r6", "memory", "cc");
}
#undef SPANTEX_HEAD
#undef SPANTEX_TAIL
#undef SPANTEX_LEFT
#undef SPANTEX_RIGHT
#undef SPANTEX_STEP

// What the first loop of trilinear keeps in memory.
struct two_levels {
  uint32_t fine_origin, fine_to_bytes, coarse_origin, coarse_to_bytes;
  int32_t ddu, ddv, level_step;
};

// Six words a pixel: the finer level's place and weights times 16 - f, the coarser one's times f.
inline void places_of_two(uint32_t* to, int count, walk& at, int32_t& level, const two_levels& s) {
  uint32_t w;
  asm volatile(
      "1: ldrd r5, r6, [%[s], #0]\n"
      "pkhtb r4, %[v], %[u], asr #16\n"
      "smlad r4, r4, r6, r5\n"
      "ubfx r5, %[u], #11, #5\n"
      "ubfx r6, %[level], #12, #4\n"
      "rsb %[w], r5, #32\n"
      "rsb r6, r6, #16\n"
      "orr %[w], %[w], r5, lsl #16\n"
      "ubfx r5, %[v], #11, #5\n"
      "mul %[w], %[w], r6\n"
      "mul r6, %[w], r5\n"
      "rsb r5, r6, %[w], lsl #5\n"
      "stmia %[to]!, {r4, r5, r6}\n"
      "sub r6, %[v], #0x7C00\n"
      "sub r5, %[u], #0x7C00\n"
      "asr r4, r6, #1\n"
      "pkhtb r4, r4, r5, asr #17\n"
      "ubfx r6, r6, #12, #5\n"
      "ubfx r5, r5, #12, #5\n"
      "rsb %[w], r5, #32\n"
      "orr %[w], %[w], r5, lsl #16\n"
      "ubfx r5, %[level], #12, #4\n"
      "mul %[w], %[w], r5\n"
      "mul r6, %[w], r6\n"
      "rsb r5, r6, %[w], lsl #5\n"
      "ldrd r8, r9, [%[s], #8]\n"
      "smlad r4, r4, r9, r8\n"
      "stmia %[to]!, {r4, r5, r6}\n"
      "ldrd r4, r5, [%[s], #16]\n"
      "ldr r6, [%[s], #24]\n"
      "add %[u], %[u], %[du]\n"
      "add %[v], %[v], %[dv]\n"
      "add %[du], %[du], r4\n"
      "add %[dv], %[dv], r5\n"
      "add %[level], %[level], r6\n"
      "subs %[n], %[n], #1\n"
      "bne 1b\n"
      : [to] "+r"(to), [n] "+r"(count), [u] "+r"(at.u), [v] "+r"(at.v), [du] "+r"(at.du), [dv] "+r"(at.dv), [level] "+r"(level), [w] "=&r"(w)
      : [s] "r"(&s)
      : "r4", "r5", "r6", "r8", "r9", "memory", "cc");
}

// The same where neither steps nor the level of detail change.
inline void places_of_two_straight(uint32_t* to, int count, walk& at, int32_t level, const two_levels& s) {
  uint32_t w;
  const uint32_t f = uint32_t(level) >> 12 & 15;
  asm volatile(
      "1: ldrd r5, r6, [%[s], #0]\n"
      "pkhtb r4, %[v], %[u], asr #16\n"
      "smlad r4, r4, r6, r5\n"
      "ubfx r5, %[u], #11, #5\n"
      "rsb r6, %[f], #16\n"
      "rsb %[w], r5, #32\n"
      "orr %[w], %[w], r5, lsl #16\n"
      "ubfx r5, %[v], #11, #5\n"
      "mul %[w], %[w], r6\n"
      "mul r6, %[w], r5\n"
      "rsb r5, r6, %[w], lsl #5\n"
      "stmia %[to]!, {r4, r5, r6}\n"
      "ldrd r8, r9, [%[s], #8]\n"
      "sub r6, %[v], #0x7C00\n"
      "sub r5, %[u], #0x7C00\n"
      "asr r4, r6, #1\n"
      "add %[u], %[u], %[du]\n"
      "pkhtb r4, r4, r5, asr #17\n"
      "add %[v], %[v], %[dv]\n"
      "smlad r4, r4, r9, r8\n"
      "ubfx r6, r6, #12, #5\n"
      "ubfx r5, r5, #12, #5\n"
      "rsb %[w], r5, #32\n"
      "orr %[w], %[w], r5, lsl #16\n"
      "mul %[w], %[w], %[f]\n"
      "subs %[n], %[n], #1\n"
      "mul r6, %[w], r6\n"
      "rsb r5, r6, %[w], lsl #5\n"
      "stmia %[to]!, {r4, r5, r6}\n"
      "bne 1b\n"
      : [to] "+r"(to), [n] "+r"(count), [u] "+r"(at.u), [v] "+r"(at.v), [w] "=&r"(w)
      : [du] "r"(at.du), [dv] "r"(at.dv), [f] "r"(f), [s] "r"(&s)
      : "r4", "r5", "r6", "r8", "r9", "memory", "cc");
}

inline void eight_points(uint16_t* out, const uint32_t* from, int count, uint32_t fine_pitch_bytes) {
  uint32_t x, y, g, r, b;
  asm volatile(
      "1: ldmia %[from]!, {r4, r5, r6}\n"
      "ldr %[x], [r4]\n"
      "ldr %[y], [r4, %[pitch]]\n"
      "and %[g], %[six], %[x], lsr #5\n"
      "and %[r], %[five], %[x], lsr #11\n"
      "and %[x], %[x], %[five]\n"
      "smuad %[g], %[g], r5\n"
      "smuad %[r], %[r], r5\n"
      "smuad %[b], %[x], r5\n"
      "and r4, %[six], %[y], lsr #5\n"
      "smlad %[g], r4, r6, %[g]\n"
      "and r4, %[five], %[y], lsr #11\n"
      "smlad %[r], r4, r6, %[r]\n"
      "and %[y], %[y], %[five]\n"
      "smlad %[b], %[y], r6, %[b]\n"
      "ldmia %[from]!, {r4, r5, r6}\n"
      "ldr %[x], [r4]\n"
      "add r4, r4, %[pitch], lsr #1\n"
      "ldr %[y], [r4]\n"
      "and r4, %[six], %[x], lsr #5\n"
      "smlad %[g], r4, r5, %[g]\n"
      "and r4, %[five], %[x], lsr #11\n"
      "smlad %[r], r4, r5, %[r]\n"
      "and %[x], %[x], %[five]\n"
      "smlad %[b], %[x], r5, %[b]\n"
      "and r4, %[six], %[y], lsr #5\n"
      "smlad %[g], r4, r6, %[g]\n"
      "and r4, %[five], %[y], lsr #11\n"
      "smlad %[r], r4, r6, %[r]\n"
      "and %[y], %[y], %[five]\n"
      "smlad %[b], %[y], r6, %[b]\n"
      "add %[r], %[r], #0x2000\n"
      "add %[b], %[b], #0x2000\n"
      "add %[g], %[g], #0x2000\n"
      "lsr %[r], %[r], #14\n"
      "lsr %[b], %[b], #14\n"
      "orr %[b], %[b], %[r], lsl #11\n"
      "lsr %[g], %[g], #14\n"
      "orr %[b], %[b], %[g], lsl #5\n"
      "subs %[n], %[n], #1\n"
      "strh %[b], [%[out]], #2\n"
      "bne 1b\n"
      : [out] "+r"(out), [from] "+r"(from), [n] "+r"(count), [x] "=&r"(x), [y] "=&r"(y), [g] "=&r"(g), [r] "=&r"(r), [b] "=&r"(b)
      : [five] "r"(0x001F001F), [six] "r"(0x003F003F), [pitch] "r"(fine_pitch_bytes)
      : "r4", "r5", "r6", "memory", "cc");
}

}  // namespace spantex::rows::dsp
