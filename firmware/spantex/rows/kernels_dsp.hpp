// SPDX-License-Identifier: Apache-2.0
// Inner loops of kernels.hpp in the instructions of Cortex-M4, M7, M33 and M55 (DSP extension). Most filters take two loops, since their numbers do
// not fit 14 registers at once: the first turns positions into addresses and weights, the second filters.
//
//   instructions a pixel, loop included   nearest 6 (masked 7)   three-point 7 + 22   bilinear 13 + 22   trilinear 36 + 39, bent rows of nearest 2 more
//   along straight rows                                          three-point 26       bilinear 11 + 22   trilinear 24 + 39
//
// Input: walks in 2^-16 texel; weights of 5 bits; sums below 2^16 (bilinear), 2^20 (trilinear): nothing overflows.
#pragma once
#include <stdint.h>

#include <spantex/rows/packed.hpp>

namespace spantex::rows::dsp {

// clang-format off
#define SPANTEX_PIXEL(MASK, STEP) "pkhtb %[t], %[v], %[u], asr #16\n" MASK "smlad %[t], %[t], %[k], %[o]\n ldrh %[t], [%[t]]\n" \
                                  "add %[u], %[u], %[du]\n add %[v], %[v], %[dv]\n strh %[t], [%[out]], #2\n" STEP
#define SPANTEX_8_PIXELS(PIXEL) PIXEL PIXEL PIXEL PIXEL PIXEL PIXEL PIXEL PIXEL
#define SPANTEX_PIXELS(PIXEL) "subs %[n], %[n], #16\n blt 2f\n 1:\n" SPANTEX_8_PIXELS(PIXEL) SPANTEX_8_PIXELS(PIXEL) "subs %[n], %[n], #16\n bge 1b\n" \
                              "2: adds %[n], %[n], #16\n beq 9f\n subs %[n], %[n], #8\n blt 3f\n" SPANTEX_8_PIXELS(PIXEL) "beq 9f\n b 4f\n" \
                              "3: adds %[n], %[n], #8\n 4:\n" PIXEL "subs %[n], %[n], #1\n bne 4b\n 9:\n"
#define SPANTEX_MASK "and %[t], %[t], %[m]\n"
#define SPANTEX_BEND "add %[du], %[du], %[ddu]\n add %[dv], %[dv], %[ddv]\n"
// clang-format on

// Texels at (v : u), maybe & masks, one after the other. to_bytes, origin: kernels.hpp.
[[gnu::always_inline]] inline void nearest_straight(uint16_t* out, int count, const walk& at, uint32_t origin, uint32_t to_bytes) {
  uint32_t t;
  int32_t u = at.u, v = at.v;
  asm volatile(SPANTEX_PIXELS(SPANTEX_PIXEL("", ""))
               : [out] "+&r"(out), [n] "+&r"(count), [u] "+&r"(u), [v] "+&r"(v), [t] "=&r"(t)
               : [du] "r"(at.du), [dv] "r"(at.dv), [k] "r"(to_bytes), [o] "r"(origin)
               : "memory", "cc");
}
[[gnu::always_inline]] inline void nearest_masked_straight(uint16_t* out, int count, const walk& at, uint32_t origin, uint32_t to_bytes, uint32_t masks) {
  uint32_t t;
  int32_t u = at.u, v = at.v;
  asm volatile(SPANTEX_PIXELS(SPANTEX_PIXEL(SPANTEX_MASK, ""))
               : [out] "+&r"(out), [n] "+&r"(count), [u] "+&r"(u), [v] "+&r"(v), [t] "=&r"(t)
               : [du] "r"(at.du), [dv] "r"(at.dv), [k] "r"(to_bytes), [o] "r"(origin), [m] "r"(masks)
               : "memory", "cc");
}
[[gnu::always_inline]] inline void nearest_bent(uint16_t* out, int count, const walk& at, uint32_t origin, uint32_t to_bytes) {
  uint32_t t;
  int32_t u = at.u, v = at.v, du = at.du, dv = at.dv;
  asm volatile(SPANTEX_PIXELS(SPANTEX_PIXEL("", SPANTEX_BEND))
               : [out] "+&r"(out), [n] "+&r"(count), [u] "+&r"(u), [v] "+&r"(v), [du] "+&r"(du), [dv] "+&r"(dv), [t] "=&r"(t)
               : [ddu] "r"(at.ddu), [ddv] "r"(at.ddv), [k] "r"(to_bytes), [o] "r"(origin)
               : "memory", "cc");
}
[[gnu::always_inline]] inline void nearest_masked_bent(uint16_t* out, int count, const walk& at, uint32_t origin, uint32_t to_bytes, uint32_t masks) {
  uint32_t t;
  int32_t u = at.u, v = at.v, du = at.du, dv = at.dv;
  asm volatile(SPANTEX_PIXELS(SPANTEX_PIXEL(SPANTEX_MASK, SPANTEX_BEND))
               : [out] "+&r"(out), [n] "+&r"(count), [u] "+&r"(u), [v] "+&r"(v), [du] "+&r"(du), [dv] "+&r"(dv), [t] "=&r"(t)
               : [ddu] "r"(at.ddu), [ddv] "r"(at.ddv), [k] "r"(to_bytes), [o] "r"(origin), [m] "r"(masks)
               : "memory", "cc");
}
#undef SPANTEX_PIXEL
#undef SPANTEX_PIXELS
#undef SPANTEX_8_PIXELS
#undef SPANTEX_MASK
#undef SPANTEX_BEND

inline constexpr int trilinear_words = 6, scratch_words = trilinear_words * 16;  // between the two loops of a filter: 32 pixels of bilinear, 16 of trilinear

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
      : [to] "+&r"(to), [n] "+&r"(count), [u] "+&r"(u), [v] "+&r"(v), [w] "=&r"(w)
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
      : [to] "+&r"(to), [n] "+&r"(count), [u] "+&r"(u), [v] "+&r"(v), [du] "+&r"(du), [dv] "+&r"(dv), [w] "=&r"(w)
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
      : [out] "+&r"(out), [from] "+&r"(from), [n] "+&r"(count), [x] "=&r"(x), [y] "=&r"(y), [g] "=&r"(g), [r] "=&r"(r)
      : [five] "r"(0x001F001F), [six] "r"(0x003F003F), [half] "r"(512), [pitch] "r"(pitch_bytes)
      : "r4", "r5", "r6", "memory", "cc");
}
#undef SPANTEX_FILTER

// clang-format off
#define SPANTEX_POSITION "pkhtb r4, %[v], %[u], asr #16\n smlad r4, r4, %[k], %[o]\n stmia %[to]!, {r4, r5, r6}\n add %[u], %[u], %[du]\n add %[v], %[v], %[dv]\n"
#define SPANTEX_BEND     "add %[du], %[du], %[ddu]\n add %[dv], %[dv], %[ddv]\n"
#define SPANTEX_4_PIXELS(PIXEL) PIXEL PIXEL PIXEL PIXEL
#define SPANTEX_PIXELS(PIXEL) "subs %[n], %[n], #8\n blt 2f\n 1:\n" SPANTEX_4_PIXELS(PIXEL) SPANTEX_4_PIXELS(PIXEL) "subs %[n], %[n], #8\n bge 1b\n" \
                              "2: adds %[n], %[n], #8\n beq 9f\n subs %[n], %[n], #4\n blt 3f\n" SPANTEX_4_PIXELS(PIXEL) "beq 9f\n b 4f\n" \
                              "3: adds %[n], %[n], #4\n 4:\n" PIXEL "subs %[n], %[n], #1\n bne 4b\n 9:\n"
// clang-format on

// Addresses and positions, three words a pixel.
[[gnu::always_inline]] inline void places(uint32_t* to, int count, const walk& at, uint32_t origin, uint32_t to_bytes) {
  int32_t du = at.du, dv = at.dv;
  register int32_t u asm("r5") = at.u;
  register int32_t v asm("r6") = at.v;
  asm volatile(SPANTEX_PIXELS(SPANTEX_POSITION SPANTEX_BEND)
               : [to] "+&r"(to), [n] "+&r"(count), [u] "+&r"(u), [v] "+&r"(v), [du] "+&r"(du), [dv] "+&r"(dv)
               : [ddu] "r"(at.ddu), [ddv] "r"(at.ddv), [k] "r"(to_bytes), [o] "r"(origin)
               : "r4", "memory", "cc");
}
#undef SPANTEX_POSITION
#undef SPANTEX_BEND
#undef SPANTEX_4_PIXELS
#undef SPANTEX_PIXELS

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
      : [out] "+&r"(out), [from] "+&r"(from), [n] "+&r"(count), [x] "=&r"(x), [y] "=&r"(y), [s] "=&r"(s)
      : [mask] "r"(spread_mask), [half] "r"((1u | 1u << 11 | 1u << 21) << 4), [pitch] "r"(pitch_bytes)
      : "r4", "r5", "r6", "memory", "cc");
}

// Along straight rows one loop does all: 14 registers are enough if the end lies in memory and the second row's address is computed. Two columns of
// code, for pixels left and right of the diagonal, so that going from one to the other is the branch that parts them; entered at the pixel that leaves a multiple of four.
// clang-format off
#define SPANTEX_BOTH "pkhtb %[s], %[v], %[u], asr #16\n smlad %[s], %[s], %[k], %[o]\n ubfx %[l], %[v], #11, #5\n ubfx %[h], %[u], #11, #5\n add %[y], %[s], %[k], asr #16\n" \
                     "ldr %[x], [%[s]]\n ldr %[y], [%[y]]\n add %[u], %[u], %[du]\n add %[v], %[v], %[dv]\n cmp %[l], %[h]\n"
#define SPANTEX_PAIR(N, NEXT) \
  "1" N ":\n" SPANTEX_BOTH "blt 4" N "f\n 3" N ":\n pkhbt %[s], %[y], %[y], lsl #16\n" SPANTEX_TAIL("%[l]", "%[h]") NEXT
#define SPANTEX_PAIR2(N, NEXT) \
  "2" N ":\n" SPANTEX_BOTH "bge 3" N "b\n 4" N ":\n pkhtb %[s], %[x], %[x], asr #16\n" SPANTEX_TAIL("%[h]", "%[l]") NEXT
#define SPANTEX_END(FIRST) "ldr %[x], %[end]\n cmp %[out], %[x]\n bne " FIRST "b\n"
// clang-format on

[[gnu::always_inline]] inline void three_points_straight(uint16_t* out, int count, const walk& at, uint32_t origin, uint32_t to_bytes) {
  const uint16_t* const end = out + count;
  int32_t u = at.u, v = at.v;
  uint32_t s = uint32_t(count) & 3, x, y, h, l;
  asm volatile(
      "cmp %[s], #2\n beq 12f\n bhi 11f\n cmp %[s], #1\n beq 13f\n"
      SPANTEX_PAIR("0", "") SPANTEX_PAIR("1", "") SPANTEX_PAIR("2", "") SPANTEX_PAIR("3", SPANTEX_END("10")) "b 9f\n"
      SPANTEX_PAIR2("0", "") SPANTEX_PAIR2("1", "") SPANTEX_PAIR2("2", "") SPANTEX_PAIR2("3", SPANTEX_END("20"))
      "9:\n"
      : [out] "+&r"(out), [u] "+&r"(u), [v] "+&r"(v), [s] "+&r"(s), [x] "=&r"(x), [y] "=&r"(y), [h] "=&r"(h), [l] "=&r"(l)
      : [du] "r"(at.du), [dv] "r"(at.dv), [k] "r"(to_bytes), [o] "r"(origin), [mask] "r"(spread_mask), [half] "r"((1u | 1u << 11 | 1u << 21) << 4), [end] "m"(end)
      : "memory", "cc");
}
#undef SPANTEX_BOTH
#undef SPANTEX_PAIR
#undef SPANTEX_PAIR2
#undef SPANTEX_END
#undef SPANTEX_HEAD
#undef SPANTEX_TAIL
#undef SPANTEX_LEFT
#undef SPANTEX_RIGHT
#undef SPANTEX_STEP

// What the first loop of trilinear keeps in memory: `fine` is read forwards, what lies before it backwards.
struct two_levels {
  struct level { uint32_t origin, to_bytes, columns, one; } coarse, fine;  // columns of weights are fu * columns + one: (fu : 32 - fu) times a weight
  int32_t ddu, ddv, level_step;
};
SPANTEX_WRAPS inline two_levels levels_of(uint32_t fine_origin, uint32_t fine_to_bytes, uint32_t coarse_origin, uint32_t coarse_to_bytes, const walk& at,
                                          int32_t level_step) {
  return {{coarse_origin, coarse_to_bytes, 0xFFFF, 32}, {fine_origin, fine_to_bytes, 0xFFFF, 32}, at.ddu, at.ddv, level_step};
}

// Six words a pixel: the finer level's place and weights times 16 - f, the coarser one's times f.
inline void places_of_two(uint32_t* to, int count, walk& at, int32_t& level, const two_levels& s) {
  uint32_t w;
  asm volatile(
      "1: ldmia %[s], {r5, r6, r8, r9}\n"
      "pkhtb r4, %[v], %[u], asr #16\n"
      "smlad r4, r4, r6, r5\n"
      "ubfx r5, %[u], #11, #5\n"
      "mla r9, r5, r8, r9\n"
      "ubfx r6, %[level], #12, #4\n"
      "ubfx r5, %[v], #11, #5\n"
      "rsb r6, r6, #16\n"
      "mul r9, r9, r6\n"
      "mul r6, r9, r5\n"
      "rsb r5, r6, r9, lsl #5\n"
      "stmia %[to]!, {r4, r5, r6}\n"
      "sub r6, %[v], #0x7C00\n"
      "sub %[w], %[u], #0x7C00\n"
      "asr r4, r6, #1\n"
      "ldrd r8, r9, [%[s], #-16]\n"
      "pkhtb r4, r4, %[w], asr #17\n"
      "ubfx r6, r6, #12, #5\n"
      "smlad r4, r4, r9, r8\n"
      "ubfx %[w], %[w], #12, #5\n"
      "rsb r5, %[w], #32\n"
      "orr %[w], r5, %[w], lsl #16\n"
      "ubfx r5, %[level], #12, #4\n"
      "mul %[w], %[w], r5\n"
      "mul r6, %[w], r6\n"
      "rsb r5, r6, %[w], lsl #5\n"
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
      : [to] "+&r"(to), [n] "+&r"(count), [u] "+&r"(at.u), [v] "+&r"(at.v), [du] "+&r"(at.du), [dv] "+&r"(at.dv), [level] "+&r"(level), [w] "=&r"(w)
      : [s] "r"(&s.fine)
      : "r4", "r5", "r6", "r8", "r9", "memory", "cc");
}

// The same where neither steps nor the level of detail change: the weights of the levels are in the columns.
// clang-format off
#define SPANTEX_PLACES "ldmia %[s], {r5, r6, r8, r9}\n pkhtb r4, %[v], %[u], asr #16\n smlad r4, r4, r6, r5\n ubfx r5, %[u], #11, #5\n mla r9, r5, r8, r9\n" \
                       "ubfx r5, %[v], #11, #5\n mul r6, r9, r5\n rsb r5, r6, r9, lsl #5\n stmia %[to]!, {r4, r5, r6}\n" \
                       "ldmdb %[s], {r5, r6, r8, r9}\n sub %[y], %[v], #0x7C00\n sub %[x], %[u], #0x7C00\n asr r4, %[y], #1\n pkhtb r4, r4, %[x], asr #17\n" \
                       "smlad r4, r4, r6, r5\n ubfx %[x], %[x], #12, #5\n ubfx %[y], %[y], #12, #5\n mla r9, %[x], r8, r9\n add %[u], %[u], %[du]\n" \
                       "mul r6, r9, %[y]\n add %[v], %[v], %[dv]\n rsb r5, r6, r9, lsl #5\n stmia %[to]!, {r4, r5, r6}\n"
// clang-format on

inline void places_of_two_straight(uint32_t* to, int count, walk& at, int32_t level, two_levels& s) {
  uint32_t x, y;
  const uint32_t f = uint32_t(level) >> 12 & 15, e = 16 - f;
  s.fine.columns = 0xFFFF * e;
  s.fine.one = 32 * e;
  s.coarse.columns = 0xFFFF * f;
  s.coarse.one = 32 * f;
  asm volatile(
      "subs %[n], %[n], #2\n blt 2f\n"
      "1:\n" SPANTEX_PLACES SPANTEX_PLACES
      "subs %[n], %[n], #2\n bge 1b\n"
      "2: adds %[n], %[n], #2\n beq 4f\n" SPANTEX_PLACES
      "4:\n"
      : [to] "+&r"(to), [n] "+&r"(count), [u] "+&r"(at.u), [v] "+&r"(at.v), [x] "=&r"(x), [y] "=&r"(y)
      : [du] "r"(at.du), [dv] "r"(at.dv), [s] "r"(&s.fine)
      : "r4", "r5", "r6", "r8", "r9", "memory", "cc");
}
#undef SPANTEX_PLACES

// The count of pairs left stands in the top of the mask for green, which meets only numbers that are shifted down: a register more for the half.
// clang-format off
#define SPANTEX_FILTER "ldmia %[from]!, {r4, r5, r6}\n ldr %[x], [r4]\n ldr %[y], [r4, %[pitch]]\n" \
                       "and %[g], %[six], %[x], lsr #5\n and %[r], %[five], %[x], lsr #11\n and %[x], %[x], %[five]\n" \
                       "smlad %[g], %[g], r5, %[half]\n smlad %[r], %[r], r5, %[half]\n smlad %[x], %[x], r5, %[half]\n" \
                       "and %[t], %[six], %[y], lsr #5\n smlad %[g], %[t], r6, %[g]\n and %[t], %[five], %[y], lsr #11\n smlad %[r], %[t], r6, %[r]\n" \
                       "and %[y], %[y], %[five]\n smlad %[x], %[y], r6, %[x]\n" \
                       "ldmia %[from]!, {r4, r5, r6}\n ldr %[y], [r4]\n add r4, r4, %[pitch], lsr #1\n ldr r4, [r4]\n" \
                       "and %[t], %[six], %[y], lsr #5\n smlad %[g], %[t], r5, %[g]\n and %[t], %[five], %[y], lsr #11\n smlad %[r], %[t], r5, %[r]\n" \
                       "and %[y], %[y], %[five]\n smlad %[x], %[y], r5, %[x]\n" \
                       "and %[t], %[six], r4, lsr #5\n smlad %[g], %[t], r6, %[g]\n and %[t], %[five], r4, lsr #11\n smlad %[r], %[t], r6, %[r]\n" \
                       "and r4, r4, %[five]\n smlad %[x], r4, r6, %[x]\n" \
                       "lsr %[r], %[r], #14\n lsr %[x], %[x], #14\n orr %[x], %[x], %[r], lsl #11\n lsr %[g], %[g], #14\n orr %[x], %[x], %[g], lsl #5\n strh %[x], [%[out]], #2\n"
// clang-format on

// count in 1..64
inline void eight_points(uint16_t* out, const uint32_t* from, int count, uint32_t fine_pitch_bytes) {
  uint32_t x, y, g, r, t = uint32_t(count) & 1, six = uint32_t(count - 1) >> 1 << 27 | 0x003F003F;
  asm volatile(
      "cmp %[t], #0\n bne 2f\n"
      "1:\n" SPANTEX_FILTER
      "2:\n" SPANTEX_FILTER
      "subs %[six], %[six], #0x08000000\n bhs 1b\n"
      : [out] "+&r"(out), [from] "+&r"(from), [six] "+&r"(six), [t] "+&r"(t), [x] "=&r"(x), [y] "=&r"(y), [g] "=&r"(g), [r] "=&r"(r)
      : [five] "r"(0x001F001F), [half] "r"(0x2000), [pitch] "r"(fine_pitch_bytes)
      : "r4", "r5", "r6", "memory", "cc");
}
#undef SPANTEX_FILTER

}  // namespace spantex::rows::dsp
