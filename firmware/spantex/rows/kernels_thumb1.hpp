// SPDX-License-Identifier: Apache-2.0
// Inner loops of kernels.hpp for cores with eight registers (Cortex-M0, M0+). Along straight rows the fractions of u and v are accumulators of 32 bits
// whose carries step the texel's address: no position is shifted, no row multiplied by the pitch. Filters take two loops, with an address and two
// fractions a pixel in memory between them; what is only added or copied lies in the upper registers.
//
//   instructions a pixel, loop included   nearest 7, bent rows 11.4 (masked 9.4, 11.4)
//                                         places 6.2, bent rows 12.5   three-point 31   bilinear 55   trilinear 49 + 69
#pragma once
#include <stdint.h>

#include <spantex/rows/block.hpp>
#include <spantex/rows/packed.hpp>
#include <spantex/rows/sample.hpp>

namespace spantex::rows::thumb1 {

// A straight row: the texel's address / 2, the fractions behind it, 2^-32 texel, and their steps. `row`: texels from one row of the map to the next.
struct carried {
  uint32_t at, u, v, step, du, dv;
  int32_t row;
};
// Of positions with `bits` of fraction.
SPANTEX_WRAPS inline carried carried_of(const walk& w, const texel565* origin, int32_t pitch_bytes, int bits) {
  const int32_t row = pitch_bytes >> 1;
  const auto texels = [&](int32_t u, int32_t v) { return uint32_t(u >> bits) + uint32_t(v >> bits) * row; };
  const auto fraction = [&](int32_t x) { return uint32_t(x) << (32 - bits); };
  return {(uint32_t(reinterpret_cast<uintptr_t>(origin)) >> 1) + texels(w.u, w.v), fraction(w.u), fraction(w.v), texels(w.du, w.dv), fraction(w.du), fraction(w.dv), row};
}

// clang-format off
#define SPANTEX_STEP "adds %[u], %[u], %[du]\n adcs %[a], %[a], %[step]\n adds %[v], %[v], %[dv]\n bcc 2f\n add %[a], %[row]\n 2:\n"
#define SPANTEX_STRAIGHT(OFFSET, BEND) "ldrh %[t], [%[a], %[a]]\n strh %[t], [%[out], #" OFFSET "]\n" SPANTEX_STEP
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
  if ((at.ddu | at.ddv) == 0) {
    carried c = carried_of(at, origin, pitch_bytes, 16);
    asm volatile(SPANTEX_LOOP(SPANTEX_STRAIGHT, "")
                 : [out] "+l"(out), [a] "+l"(c.at), [u] "+l"(c.u), [v] "+l"(c.v), [t] "=&l"(t)
                 : [step] "l"(c.step), [du] "l"(c.du), [dv] "l"(c.dv), [row] "h"(c.row), [end] "h"(end)
                 : "memory", "cc");
    at.u += count * at.du;
    at.v += count * at.dv;
  } else {
    asm volatile(SPANTEX_LOOP(SPANTEX_PIXEL, SPANTEX_BEND)
                 : [out] "+l"(out), [u] "+l"(at.u), [v] "+l"(at.v), [t] "=&l"(t), [s] "=&l"(s), [du] "+h"(at.du), [dv] "+h"(at.dv)
                 : [base] "l"(origin), [pitch] "l"(pitch_bytes), [ddu] "h"(at.ddu), [ddv] "h"(at.ddv), [end] "h"(end)
                 : "memory", "cc");
  }
}

// The same with whole positions wrapped by masks (height - 1 : width - 1) of at most 2^16 texels: v is brought to the place where its bits are wanted.
inline bool masks_fit(uint32_t masks) { return ((masks & 0xFFFF) + 1) * ((masks >> 16) + 1) <= 1u << 16; }
SPANTEX_WRAPS inline void nearest_masked(uint16_t* out, int count, walk& at, const texel565* texels, uint32_t masks) {
  uint32_t t, s;
  const uint16_t* const end = out + count;
  const uint32_t width = (masks & 0xFFFF) + 1, mu = 2 * width - 2, mv = (masks >> 16) * 2 * width;
  uint32_t v = uint32_t(at.v) * width, dv = uint32_t(at.dv) * width;
  if ((at.ddu | at.ddv) == 0) {
    asm volatile(SPANTEX_LOOP(SPANTEX_MASKED, "")
                 : [out] "+l"(out), [u] "+l"(at.u), [v] "+l"(v), [t] "=&l"(t), [s] "=&l"(s)
                 : [mu] "l"(mu), [mv] "l"(mv), [base] "l"(texels), [du] "h"(at.du), [dv] "h"(dv), [end] "h"(end)
                 : "memory", "cc");
    at.v += count * at.dv;
  } else {
    asm volatile(SPANTEX_LOOP(SPANTEX_MASKED, SPANTEX_BEND)
                 : [out] "+l"(out), [u] "+l"(at.u), [v] "+l"(v), [t] "=&l"(t), [s] "=&l"(s), [du] "+h"(at.du), [dv] "+h"(dv)
                 : [mu] "l"(mu), [mv] "l"(mv), [base] "l"(texels), [ddu] "h"(at.ddu), [ddv] "h"(uint32_t(at.ddv) * width), [end] "h"(end)
                 : "memory", "cc");
    at.v += count * at.dv + count * (count - 1) / 2 * at.ddv;
    at.dv += count * at.ddv;
  }
}

#undef SPANTEX_STRAIGHT
#undef SPANTEX_PIXEL
#undef SPANTEX_MASKED
#undef SPANTEX_LOOP

// Three words a pixel: a texel's address / 2, fractions of u and v, 2^-32 texel. Four pixels at a time, the last ones in vain.
inline constexpr int pixel_words = 3, coarse_pixels_at_once = 16, scratch_words = pixel_words * (32 + coarse_pixels_at_once);

// clang-format off
#define SPANTEX_PLACE "stmia %[to]!, {%[a], %[u], %[v]}\n" SPANTEX_STEP
#define SPANTEX_BENT_PLACE "asrs r4, %[v], %[bits]\n muls r4, %[row], r4\n asrs r5, %[u], %[bits]\n adds r4, r4, r5\n adds r4, r4, %[base]\n lsls r5, %[u], %[rest]\n lsls r6, %[v], %[rest]\n" \
                           "stmia %[to]!, {r4, r5, r6}\n add %[u], %[du]\n add %[v], %[dv]\n" SPANTEX_BEND
#define SPANTEX_4_PLACES(PLACE) ".syntax unified\n 1:\n" PLACE PLACE PLACE PLACE "cmp %[to], %[end]\n bne 1b\n"
// clang-format on

[[gnu::always_inline]] inline void places(uint32_t* to, int count, const carried& c) {
  const uint32_t* const end = to + pixel_words * ((count + 3) & ~3);
  register uint32_t a asm("r4") = c.at;
  register uint32_t u asm("r5") = c.u;
  register uint32_t v asm("r6") = c.v;
  asm volatile(SPANTEX_4_PLACES(SPANTEX_PLACE)
               : [to] "+l"(to), [a] "+l"(a), [u] "+l"(u), [v] "+l"(v)
               : [step] "l"(c.step), [du] "l"(c.du), [dv] "l"(c.dv), [row] "h"(c.row), [end] "h"(end)
               : "memory", "cc");
}

template <int Bits>
[[gnu::always_inline]] inline void bent_places(uint32_t* to, int count, const walk& at, const texel565* origin, int32_t pitch_bytes) {
  const uint32_t* const end = to + pixel_words * ((count + 3) & ~3);
  int32_t u = at.u, v = at.v, du = at.du, dv = at.dv;
  asm volatile(SPANTEX_4_PLACES(SPANTEX_BENT_PLACE)
               : [to] "+l"(to), [u] "+l"(u), [v] "+l"(v), [du] "+h"(du), [dv] "+h"(dv)
               : [ddu] "h"(at.ddu), [ddv] "h"(at.ddv), [row] "l"(pitch_bytes >> 1), [base] "l"(uint32_t(reinterpret_cast<uintptr_t>(origin)) >> 1), [end] "h"(end),
                 [bits] "i"(Bits), [rest] "i"(32 - Bits)
               : "r4", "r5", "r6", "memory", "cc");
}

[[gnu::always_inline]] inline void places(uint32_t* to, int count, const walk& at, const texel565* origin, int32_t pitch_bytes) {
  if ((at.ddu | at.ddv) == 0) places(to, count, carried_of(at, origin, pitch_bytes, 16));
  else bent_places<16>(to, count, at, origin, pitch_bytes);
}

// With a level's weight, first + sign f, in the lowest bits of v, below what the fraction fills; f: fraction of the level of detail.
template <int Bits>
[[gnu::always_inline]] inline void weighted_places(uint32_t* to, int count, const walk& at, const texel565* origin, int32_t pitch_bytes, const level_run& level, uint32_t first, uint32_t sign) {
  const auto weight_at = [&](int32_t x) { return first + sign * fraction_of(x); };
  if ((at.ddu | at.ddv | level.step) == 0) {
    carried c = carried_of(at, origin, pitch_bytes, Bits);
    c.v |= weight_at(level.start);
    return places(to, count, c);
  }
  bent_places<Bits>(to, count, at, origin, pitch_bytes);
  for (int32_t x = level.start; count > 0; --count, to += pixel_words, x += level.step) to[2] |= weight_at(x);
}
#undef SPANTEX_STEP
#undef SPANTEX_BEND
#undef SPANTEX_PLACE
#undef SPANTEX_BENT_PLACE
#undef SPANTEX_4_PLACES

inline constexpr uint32_t twice = 0x10001;  // a texel times this and spread_mask is spread()

// clang-format off
#define SPANTEX_SPREAD(X, TWICE) "muls " X ", " TWICE ", " X "\n ands " X ", " X ", %[mask]\n"
#define SPANTEX_READ "ldmia %[from]!, {r4, r5, r6}\n lsls r4, r4, #1\n lsrs r5, r5, #27\n lsrs r6, r6, #27\n"  // address, fu, fv
#define SPANTEX_NEXT(BYTES, LOOP) "adds %[s], %[s], #" BYTES "\n mov %[out], %[s]\n cmp %[s], %[end]\n " LOOP
// t00 (32 - high) + side d1 + ... as 32 t00 + (side - t00) high + (t11 - side) low. Two columns of code, for pixels left and right of the diagonal: going
// from one to the other is the branch that parts them.
#define SPANTEX_TAIL(HIGH, LOW, OFFSET) SPANTEX_SPREAD("%[x]", "%[twice]") SPANTEX_SPREAD("%[s]", "%[twice]") SPANTEX_SPREAD("r4", "%[twice]") \
                      "subs r4, r4, %[s]\n muls r4, " LOW ", r4\n subs %[s], %[s], %[x]\n muls %[s], " HIGH ", %[s]\n lsls %[x], %[x], #5\n add %[x], %[half]\n" \
                      "adds %[x], %[x], %[s]\n adds %[x], %[x], r4\n lsrs %[x], %[x], #5\n ands %[x], %[x], %[mask]\n lsrs %[s], %[x], #16\n orrs %[x], %[x], %[s]\n" \
                      "mov %[s], %[out]\n strh %[x], [%[s], #" OFFSET "]\n"
#define SPANTEX_LEFT(N, OFFSET) "1" N ":\n" SPANTEX_READ "ldrh %[x], [r4]\n cmp r6, r5\n blt.n 4" N "f\n 3" N ":\n" \
                      "add r4, %[pitch]\n ldrh %[s], [r4]\n ldrh r4, [r4, #2]\n" SPANTEX_TAIL("r6", "r5", OFFSET)
#define SPANTEX_RIGHT(N, OFFSET) "2" N ":\n" SPANTEX_READ "ldrh %[x], [r4]\n cmp r6, r5\n bge.n 3" N "b\n 4" N ":\n" \
                      "ldrh %[s], [r4, #2]\n add r4, %[pitch]\n ldrh r4, [r4, #2]\n" SPANTEX_TAIL("r5", "r6", OFFSET)
// Entered by a jump over `s` pixels, so that a multiple of the loop's is left; `out` is that many before the first. BYTES: of a pixel's code, which is checked.
#define SPANTEX_ENTER(BYTES) ".syntax unified\n movs %[x], #" BYTES "\n muls %[x], %[s], %[x]\n add pc, %[x]\n nop\n 8:\n"
#define SPANTEX_PIXELS_ARE(BYTES) ".if . - 8b - (" BYTES ")\n .error \"spantex: length of a pixel's code\"\n .endif\n"
// clang-format on

// count > 0
[[gnu::always_inline]] inline void three_points(uint16_t* to, const uint32_t* from, int count, int32_t pitch_bytes) {
  uint32_t s = -uint32_t(count) & 3, x;
  const uint16_t* const end = to + count;
  uint16_t* out = to - s;
  asm volatile(
      SPANTEX_ENTER("60")
      SPANTEX_LEFT("0", "0") SPANTEX_LEFT("1", "2") SPANTEX_LEFT("2", "4") SPANTEX_LEFT("3", "6") SPANTEX_PIXELS_ARE("4 * 60") SPANTEX_NEXT("8", "bne 10b\n b 9f\n")
      SPANTEX_RIGHT("0", "0") SPANTEX_RIGHT("1", "2") SPANTEX_RIGHT("2", "4") SPANTEX_RIGHT("3", "6") SPANTEX_NEXT("8", "bne 20b\n")
      "9:\n"
      : [out] "+h"(out), [from] "+l"(from), [s] "+l"(s), [x] "=&l"(x)
      : [twice] "l"(twice), [mask] "l"(spread_mask), [half] "h"((1u | 1u << 11 | 1u << 21) << 4), [pitch] "h"(pitch_bytes), [end] "h"(end)
      : "r4", "r5", "r6", "memory", "cc");
}
#undef SPANTEX_TAIL
#undef SPANTEX_LEFT
#undef SPANTEX_RIGHT

// Along u, three channels at once: X = 32 X + (Y - X) fu.
// Along v the sums of 10 fraction bits overlap: T = 2^21 G + 2^11 R + B modulo 2^32, R modulo 2^10, and G alone. Then
//   (T >> 10) - 2 r - 2^11 G + 2^5 g = 2^11 (R >> 10) + 2^5 g + (B >> 10) modulo 2^16,   r = R modulo 2^10, g = G >> 10;
// r from -512, the carry of T >> 10 and 512 in G round.
// clang-format off
#define SPANTEX_ROW(X, Y) SPANTEX_SPREAD(X, "%[s]") SPANTEX_SPREAD(Y, "%[s]") "subs " Y ", " Y ", " X "\n muls " Y ", r5, " Y "\n lsls " X ", " X ", #5\n adds " X ", " X ", " Y "\n"
#define SPANTEX_LERP(A, B) "subs " B ", " B ", " A "\n muls " B ", r6, " B "\n"
#define SPANTEX_SUM(A, B) "lsls " A ", " A ", #5\n adds " B ", " B ", " A "\n"
#define SPANTEX_BILINEAR(OFFSET) \
  "mov %[s], %[twice]\n" SPANTEX_READ \
  "ldrh %[x], [r4]\n ldrh %[y], [r4, #2]\n" SPANTEX_ROW("%[x]", "%[y]") \
  "add r4, %[pitch]\n ldrh %[y], [r4]\n ldrh r4, [r4, #2]\n" SPANTEX_ROW("%[y]", "r4") \
  "lsrs r4, %[x], #21\n lsrs r5, %[y], #21\n" SPANTEX_LERP("r4", "r5") "adds r4, r4, #16\n" SPANTEX_SUM("r4", "r5") \
  "lsrs r4, %[x], #11\n lsrs %[s], %[y], #11\n" SPANTEX_LERP("r4", "%[s]") SPANTEX_SUM("r4", "%[s]") \
  SPANTEX_LERP("%[x]", "%[y]") SPANTEX_SUM("%[x]", "%[y]") \
  "lsls %[s], %[s], #22\n asrs %[s], %[s], #21\n lsls r4, r5, #6\n lsrs r5, r5, #10\n subs r5, r5, r4\n lsls r5, r5, #5\n" \
  "lsrs %[y], %[y], #10\n adcs %[y], %[y], r5\n subs %[y], %[y], %[s]\n mov %[s], %[out]\n strh %[y], [%[s], #" OFFSET "]\n"
// clang-format on

// count > 0
[[gnu::always_inline]] inline void four_points(uint16_t* to, const uint32_t* from, int count, int32_t pitch_bytes) {
  uint32_t s = -uint32_t(count) & 7, x, y;
  const uint16_t* const end = to + count;
  uint16_t* out = to - s;
  asm volatile(
      SPANTEX_ENTER("108")
      SPANTEX_BILINEAR("0") SPANTEX_BILINEAR("2") SPANTEX_BILINEAR("4") SPANTEX_BILINEAR("6")
      SPANTEX_BILINEAR("8") SPANTEX_BILINEAR("10") SPANTEX_BILINEAR("12") SPANTEX_BILINEAR("14") SPANTEX_PIXELS_ARE("8 * 108")
      SPANTEX_NEXT("16", "beq 9f\n b 8b\n")
      "9:\n"
      : [out] "+h"(out), [from] "+l"(from), [s] "+l"(s), [x] "=&l"(x), [y] "=&l"(y)
      : [twice] "h"(twice), [mask] "l"(spread_mask), [pitch] "h"(pitch_bytes), [end] "h"(end)
      : "r4", "r5", "r6", "memory", "cc");
}

// Two levels: sums of two rows with weights (32 - fv) w and fv w of 9 bits, w the level's. P = 2^10 G + R, G, and T modulo 2^32.
// clang-format off
#define SPANTEX_LEVEL \
  "ldr %[s], %[twice]\n ldr %[mask], %[spread]\n ldmia %[from]!, {r4, r5, r6}\n lsls r4, r4, #1\n lsrs r5, r5, #27\n" \
  "ldrh %[x], [r4]\n ldrh %[y], [r4, #2]\n" SPANTEX_ROW("%[x]", "%[y]") \
  "add r4, %[pitch]\n ldrh %[y], [r4]\n ldrh r4, [r4, #2]\n" SPANTEX_ROW("%[y]", "r4") \
  "lsls r4, r6, #27\n lsrs %[mask], r4, #22\n lsrs r4, r4, #27\n lsrs r6, r6, #27\n muls r6, r4, r6\n subs %[mask], %[mask], r6\n" \
  "lsrs r4, %[x], #21\n lsrs r5, %[y], #21\n muls r4, %[mask], r4\n muls r5, r6, r5\n adds r5, r5, r4\n" \
  "lsrs r4, %[x], #11\n lsrs %[s], %[y], #11\n muls r4, %[mask], r4\n muls %[s], r6, %[s]\n adds r4, r4, %[s]\n" \
  "muls %[x], %[mask], %[x]\n muls %[y], r6, %[y]\n adds r6, %[x], %[y]\n"
// clang-format on

// The finer level's places become its sums. count > 0
[[gnu::always_inline]] inline void fine_sums(uint32_t* from, int count, int32_t pitch_bytes) {
  uint32_t s, x, y, mask;
  const uint32_t two = twice, spread = spread_mask, *const end = from + pixel_words * count;
  asm volatile(".syntax unified\n 1:\n" SPANTEX_LEVEL "subs %[from], %[from], #12\n stmia %[from]!, {r4, r5, r6}\n cmp %[from], %[end]\n bne 1b\n"
               : [from] "+l"(from), [s] "=&l"(s), [x] "=&l"(x), [y] "=&l"(y), [mask] "=&l"(mask)
               : [twice] "m"(two), [spread] "m"(spread), [pitch] "h"(pitch_bytes), [end] "h"(end)
               : "r4", "r5", "r6", "memory", "cc");
}

// The coarser level's places and the finer one's sums become pixels. count > 0
[[gnu::always_inline]] inline void coarse_pixels(uint16_t* out, const uint32_t* fine, const uint32_t* from, int count, int32_t pitch_bytes) {
  register uint32_t x asm("r0");
  register uint32_t y asm("r1");
  register uint32_t s asm("r2");
  uint32_t mask;
  const uint32_t two = twice, spread = spread_mask;
  const uint16_t* const end = out + count;
  asm volatile(
      ".syntax unified\n 1:\n" SPANTEX_LEVEL
      "mov %[mask], %[fine]\n ldmia %[mask]!, {%[x], %[y], %[s]}\n mov %[fine], %[mask]\n adds r4, r4, %[x]\n adds r5, r5, %[y]\n adds r6, r6, %[s]\n"
      "lsls %[x], r4, #11\n subs r6, r6, %[x]\n lsls %[x], r5, #10\n subs r4, r4, %[x]\n"  // B and R alone
      "add r4, %[half]\n lsrs r4, r4, #14\n lsls r4, r4, #6\n lsrs r5, r5, #14\n adcs r4, r4, r5\n lsls r4, r4, #5\n lsrs r6, r6, #14\n adcs r4, r4, r6\n"
      "mov %[x], %[out]\n strh r4, [%[x]]\n adds %[x], %[x], #2\n mov %[out], %[x]\n cmp %[x], %[end]\n bne 1b\n"
      : [out] "+h"(out), [fine] "+h"(fine), [from] "+l"(from), [s] "=&l"(s), [x] "=&l"(x), [y] "=&l"(y), [mask] "=&l"(mask)
      : [twice] "m"(two), [spread] "m"(spread), [half] "h"(1u << 13), [pitch] "h"(pitch_bytes), [end] "h"(end)
      : "r4", "r5", "r6", "memory", "cc");
}

#undef SPANTEX_LEVEL
#undef SPANTEX_SPREAD
#undef SPANTEX_READ
#undef SPANTEX_NEXT
#undef SPANTEX_ENTER
#undef SPANTEX_PIXELS_ARE
#undef SPANTEX_ROW
#undef SPANTEX_LERP
#undef SPANTEX_SUM
#undef SPANTEX_BILINEAR

}  // namespace spantex::rows::thumb1
