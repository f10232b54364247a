// SPDX-License-Identifier: Apache-2.0
// Inner loops of kernels.hpp for cores with eight registers (Cortex-M0, M0+). Along straight rows the fractions of u and v are accumulators of 32 bits
// whose carries step the texel's address: no position is shifted, no row multiplied by the pitch. Filters take two loops, with an address and two
// fractions a pixel in memory between them; what is only added or copied lies in the upper registers.
//
//   instructions a pixel, loop included   nearest 7, bent rows 11.4 (masked 9.4, 11.4)
//                                         places 6.2, bent rows 12.5   three-point 31   bilinear 51   trilinear 45 + 65
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
#define SPANTEX_STEP "adds %[u], %[u], %[du]\n adcs %[a], %[a], %[step]\n adds %[v], %[v], %[dv]\n bcc.n 2f\n add %[a], %[row]\n 2:\n"
#define SPANTEX_STRAIGHT(OFFSET, BEND) "ldrh %[t], [%[a], %[a]]\n strh %[t], [%[out], #" OFFSET "]\n" SPANTEX_STEP
#define SPANTEX_PIXEL(OFFSET, BEND) "asrs %[t], %[u], #16\n adds %[t], %[t], %[t]\n asrs %[s], %[v], #16\n muls %[s], %[pitch], %[s]\n adds %[t], %[t], %[s]\n" \
                                    "add %[u], %[du]\n add %[v], %[dv]\n ldrh %[t], [%[base], %[t]]\n strh %[t], [%[out], #" OFFSET "]\n" BEND
#define SPANTEX_MASKED(OFFSET, BEND) "lsrs %[t], %[u], #15\n ands %[t], %[mu]\n lsrs %[s], %[v], #15\n ands %[s], %[mv]\n adds %[t], %[t], %[s]\n" \
                                     "add %[u], %[du]\n add %[v], %[dv]\n ldrh %[t], [%[base], %[t]]\n strh %[t], [%[out], #" OFFSET "]\n" BEND
#define SPANTEX_BEND "add %[du], %[ddu]\n add %[dv], %[ddv]\n"
// Entered by a jump over `t` bytes, so that a multiple of eight pixels is left; `out` is as many pixels before the first. BYTES: of a pixel's code, which is checked.
#define SPANTEX_LOOP(PIXEL, BEND) ".syntax unified\n add pc, %[t]\n nop\n 1:\n" PIXEL("0", BEND) PIXEL("2", BEND) PIXEL("4", BEND) PIXEL("6", BEND) \
                                  PIXEL("8", BEND) PIXEL("10", BEND) PIXEL("12", BEND) PIXEL("14", BEND) SPANTEX_PIXELS_ARE("1b", "8 * %c[bytes]") \
                                  "adds %[out], %[out], #16\n cmp %[out], %[end]\n bne 1b\n"
#define SPANTEX_PIXELS_ARE(FIRST, BYTES) ".if . - " FIRST " - (" BYTES ")\n .error \"spantex: length of a pixel's code\"\n .endif\n"
// clang-format on

// count > 0. origin: the texel at (0, 0).
inline void nearest(uint16_t* to, int count, walk at, const texel565* origin, int32_t pitch_bytes) {
  const uint32_t skipped = -uint32_t(count) & 7;
  uint16_t *out = to - skipped, *const end = to + count;
  uint32_t s;
  if ((at.ddu | at.ddv) == 0) {
    carried c = carried_of(at, origin, pitch_bytes, 16);
    constexpr uint32_t bytes = 14;
    uint32_t t = skipped * bytes;
    asm volatile(SPANTEX_LOOP(SPANTEX_STRAIGHT, "")
                 : [out] "+&l"(out), [a] "+&l"(c.at), [u] "+&l"(c.u), [v] "+&l"(c.v), [t] "+&l"(t)
                 : [step] "l"(c.step), [du] "l"(c.du), [dv] "l"(c.dv), [row] "h"(c.row), [end] "h"(end), [bytes] "i"(bytes)
                 : "memory", "cc");
  } else {
    constexpr uint32_t bytes = 22;
    uint32_t t = skipped * bytes;
    asm volatile(SPANTEX_LOOP(SPANTEX_PIXEL, SPANTEX_BEND)
                 : [out] "+&l"(out), [u] "+&l"(at.u), [v] "+&l"(at.v), [t] "+&l"(t), [s] "=&l"(s), [du] "+&h"(at.du), [dv] "+&h"(at.dv)
                 : [base] "l"(origin), [pitch] "l"(pitch_bytes), [ddu] "h"(at.ddu), [ddv] "h"(at.ddv), [end] "h"(end), [bytes] "i"(bytes)
                 : "memory", "cc");
  }
}

// The same with whole positions wrapped by masks (height - 1 : width - 1) of at most 2^16 texels: v is brought to the place where its bits are wanted.
inline bool masks_fit(uint32_t masks) { return ((masks & 0xFFFF) + 1) * ((masks >> 16) + 1) <= 1u << 16; }
SPANTEX_WRAPS inline void nearest_masked(uint16_t* to, int count, walk at, const texel565* texels, uint32_t masks) {
  const uint32_t skipped = -uint32_t(count) & 7, width = (masks & 0xFFFF) + 1, mu = 2 * width - 2, mv = (masks >> 16) * 2 * width;
  uint16_t *out = to - skipped, *const end = to + count;
  uint32_t s, v = uint32_t(at.v) * width, dv = uint32_t(at.dv) * width;
  if ((at.ddu | at.ddv) == 0) {
    constexpr uint32_t bytes = 18;
    uint32_t t = skipped * bytes;
    asm volatile(SPANTEX_LOOP(SPANTEX_MASKED, "")
                 : [out] "+&l"(out), [u] "+&l"(at.u), [v] "+&l"(v), [t] "+&l"(t), [s] "=&l"(s)
                 : [mu] "l"(mu), [mv] "l"(mv), [base] "l"(texels), [du] "h"(at.du), [dv] "h"(dv), [end] "h"(end), [bytes] "i"(bytes)
                 : "memory", "cc");
  } else {
    constexpr uint32_t bytes = 22;
    uint32_t t = skipped * bytes;
    asm volatile(SPANTEX_LOOP(SPANTEX_MASKED, SPANTEX_BEND)
                 : [out] "+&l"(out), [u] "+&l"(at.u), [v] "+&l"(v), [t] "+&l"(t), [s] "=&l"(s), [du] "+&h"(at.du), [dv] "+&h"(dv)
                 : [mu] "l"(mu), [mv] "l"(mv), [base] "l"(texels), [ddu] "h"(at.ddu), [ddv] "h"(uint32_t(at.ddv) * width), [end] "h"(end), [bytes] "i"(bytes)
                 : "memory", "cc");
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

// Places of `count` pixels. What they are counted from is then at the next pixel if `count` is a multiple of four.
[[gnu::always_inline]] inline void places(uint32_t* to, int count, carried& c) {
  const uint32_t* const end = to + pixel_words * ((count + 3) & ~3);
  register uint32_t a asm("r4") = c.at;
  register uint32_t u asm("r5") = c.u;
  register uint32_t v asm("r6") = c.v;
  asm volatile(SPANTEX_4_PLACES(SPANTEX_PLACE)
               : [to] "+&l"(to), [a] "+&l"(a), [u] "+&l"(u), [v] "+&l"(v)
               : [step] "l"(c.step), [du] "l"(c.du), [dv] "l"(c.dv), [row] "h"(c.row), [end] "h"(end)
               : "memory", "cc");
  c.at = a;
  c.u = u;
  c.v = v;
}

template <int Bits>
[[gnu::always_inline]] inline void bent_places(uint32_t* to, int count, walk& at, const texel565* origin, int32_t pitch_bytes) {
  const uint32_t* const end = to + pixel_words * ((count + 3) & ~3);
  asm volatile(SPANTEX_4_PLACES(SPANTEX_BENT_PLACE)
               : [to] "+&l"(to), [u] "+&l"(at.u), [v] "+&l"(at.v), [du] "+&h"(at.du), [dv] "+&h"(at.dv)
               : [ddu] "h"(at.ddu), [ddv] "h"(at.ddv), [row] "l"(pitch_bytes >> 1), [base] "l"(uint32_t(reinterpret_cast<uintptr_t>(origin)) >> 1), [end] "h"(end),
                 [bits] "i"(Bits), [rest] "i"(32 - Bits)
               : "r4", "r5", "r6", "memory", "cc");
}

[[gnu::always_inline]] inline void places(uint32_t* to, int count, const walk& from, const texel565* origin, int32_t pitch_bytes) {
  if ((from.ddu | from.ddv) == 0) {
    carried c = carried_of(from, origin, pitch_bytes, 16);
    places(to, count, c);
  } else {
    walk at = from;
    bent_places<16>(to, count, at, origin, pitch_bytes);
  }
}

// Places on one of two levels with its weight, first + sign f, in the lowest byte of v, below what the fraction fills; f: fraction of the level of detail.
template <int Bits>
struct weighted_places {
  walk at;
  level_run level;
  const texel565* origin;
  int32_t pitch_bytes;
  uint32_t first, sign;
  bool straight;
  carried straight_at{};

  [[gnu::always_inline]] weighted_places(const walk& from, const level_run& along, const texel565* map, int32_t pitch, uint32_t first_weight, uint32_t weight_sign)
      : at(from), level(along), origin(map), pitch_bytes(pitch), first(first_weight), sign(weight_sign), straight((from.ddu | from.ddv | along.step) == 0) {
    if (!straight) return;
    straight_at = carried_of(from, map, pitch, Bits);
    straight_at.v |= weight_at(along.start);
  }
  [[gnu::always_inline]] uint32_t weight_at(int32_t x) const { return first + sign * fraction_of(x); }
  // Of the next pixels; `count` is a multiple of four but for the last of them.
  [[gnu::always_inline]] void next(uint32_t* to, int count) {
    if (straight) return places(to, count, straight_at);
    bent_places<Bits>(to, count, at, origin, pitch_bytes);
    for (; count > 0; --count, to += pixel_words, level.start += level.step) to[2] |= weight_at(level.start);
  }
};
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
// Entered by a jump over `s` pixels, so that a multiple of the loop's is left; `out` is that many before the first.
#define SPANTEX_ENTER_WITH(FIRST, BYTES) ".syntax unified\n movs %[x], #" BYTES "\n muls %[x], %[s], %[x]\n" FIRST "add pc, %[x]\n nop\n 8:\n"
#define SPANTEX_ENTER(BYTES) SPANTEX_ENTER_WITH("", BYTES)
// clang-format on

// count > 0
[[gnu::always_inline]] inline void three_points(uint16_t* to, const uint32_t* from, int count, int32_t pitch_bytes) {
  uint32_t s = -uint32_t(count) & 3, x;
  const uint16_t* const end = to + count;
  uint16_t* out = to - s;
  asm volatile(
      SPANTEX_ENTER("60")
      SPANTEX_LEFT("0", "0") SPANTEX_LEFT("1", "2") SPANTEX_LEFT("2", "4") SPANTEX_LEFT("3", "6") SPANTEX_PIXELS_ARE("8b", "4 * 60") SPANTEX_NEXT("8", "bne 10b\n b 9f\n")
      SPANTEX_RIGHT("0", "0") SPANTEX_RIGHT("1", "2") SPANTEX_RIGHT("2", "4") SPANTEX_RIGHT("3", "6") SPANTEX_NEXT("8", "bne 20b\n")
      "9:\n"
      : [out] "+&h"(out), [from] "+&l"(from), [s] "+&l"(s), [x] "=&l"(x)
      : [twice] "l"(twice), [mask] "l"(spread_mask), [half] "h"((1u | 1u << 11 | 1u << 21) << 4), [pitch] "h"(pitch_bytes), [end] "h"(end)
      : "r4", "r5", "r6", "memory", "cc");
}
#undef SPANTEX_TAIL
#undef SPANTEX_LEFT
#undef SPANTEX_RIGHT

// Two texels side by side are a word, and so are their weights, the other way round: the upper half of the product of two channels with two weights,
//   (left + 2^16 right) (w_right + 2^16 w_left) = ... + 2^16 (left w_left + right w_right) + left w_right   modulo 2^32,
// is their sum: 6 bits times 10 fit a half, and what is below, of both rows, does too: nothing is carried. Red, 5 bits, is rounded by a difference modulo 2^5.
// clang-format off
#define SPANTEX_CHANNEL(T, X, W, SHIFT) "lsrs " T ", " X ", #" SHIFT "\n ands " T ", " T ", %[mask]\n muls " T ", " W ", " T "\n"
#define SPANTEX_BILINEAR(OFFSET) \
  SPANTEX_READ \
  "lsls %[y], r5, #16\n subs r5, r5, %[y]\n add r5, %[one]\n muls r6, r5, r6\n lsls r5, r5, #5\n subs r5, r5, r6\n" \
  "ldrh %[x], [r4]\n ldrh %[y], [r4, #2]\n lsls %[y], %[y], #16\n orrs %[x], %[x], %[y]\n" \
  "add r4, %[pitch]\n ldrh %[s], [r4]\n ldrh %[y], [r4, #2]\n lsls %[y], %[y], #16\n orrs %[s], %[s], %[y]\n" \
  "mov %[mask], %[six]\n" SPANTEX_CHANNEL("%[y]", "%[x]", "r5", "5") SPANTEX_CHANNEL("r4", "%[s]", "r6", "5") "adds %[y], %[y], r4\n" \
  "mov %[mask], %[five]\n" SPANTEX_CHANNEL("r4", "%[x]", "r5", "11") "ands %[x], %[x], %[mask]\n muls %[x], r5, %[x]\n" \
  SPANTEX_CHANNEL("r5", "%[s]", "r6", "11") "ands %[s], %[s], %[mask]\n muls %[s], r6, %[s]\n adds r4, r4, r5\n adds %[x], %[x], %[s]\n" \
  "lsrs r4, r4, #26\n sbcs r4, r4, %[mask]\n lsls r4, r4, #6\n lsrs %[y], %[y], #26\n adcs r4, r4, %[y]\n lsls r4, r4, #5\n" \
  "lsrs %[x], %[x], #26\n adcs r4, r4, %[x]\n mov %[s], %[out]\n strh r4, [%[s], #" OFFSET "]\n"
// clang-format on

// count > 0
[[gnu::always_inline]] inline void four_points(uint16_t* to, const uint32_t* from, int count, int32_t pitch_bytes) {
  uint32_t s = -uint32_t(count) & 7, x, y, mask;
  const uint16_t* const end = to + count;
  uint16_t* out = to - s;
  asm volatile(
      SPANTEX_ENTER("100")
      SPANTEX_BILINEAR("0") SPANTEX_BILINEAR("2") SPANTEX_BILINEAR("4") SPANTEX_BILINEAR("6")
      SPANTEX_BILINEAR("8") SPANTEX_BILINEAR("10") SPANTEX_BILINEAR("12") SPANTEX_BILINEAR("14") SPANTEX_PIXELS_ARE("8b", "8 * 100")
      "adds %[s], %[s], #16\n mov %[out], %[s]\n ldr %[x], %[end]\n cmp %[s], %[x]\n beq 9f\n b 8b\n"
      "9:\n"
      : [out] "+&h"(out), [from] "+&l"(from), [s] "+&l"(s), [x] "=&l"(x), [y] "=&l"(y), [mask] "=&l"(mask)
      : [five] "h"(0x001F001F), [six] "h"(0x003F003F), [one] "h"(32u << 16), [pitch] "h"(pitch_bytes), [end] "m"(end)
      : "r4", "r5", "r6", "memory", "cc");
}

// Two levels: sums of two rows with weights (32 - fv) w and fv w of 9 bits, w the level's. P = 2^10 G + R, G, and T modulo 2^32.
// clang-format off
#define SPANTEX_ROW(X, Y) SPANTEX_SPREAD(X, "%[s]") SPANTEX_SPREAD(Y, "%[s]") "subs " Y ", " Y ", " X "\n muls " Y ", r5, " Y "\n lsls " X ", " X ", #5\n adds " X ", " X ", " Y "\n"
#define SPANTEX_LEVEL \
  "ldr %[mask], %[spread]\n ldmia %[from]!, {r4, r5, r6}\n lsls r4, r4, #1\n lsrs r5, r5, #27\n" \
  "ldrh %[x], [r4]\n ldrh %[y], [r4, #2]\n" SPANTEX_ROW("%[x]", "%[y]") \
  "add r4, %[pitch]\n ldrh %[y], [r4]\n ldrh r4, [r4, #2]\n" SPANTEX_ROW("%[y]", "r4") \
  "uxtb r4, r6\n lsrs r6, r6, #27\n muls r6, r4, r6\n lsls r4, r4, #5\n subs %[mask], r4, r6\n" \
  "lsrs r4, %[x], #21\n lsrs r5, %[y], #21\n muls r4, %[mask], r4\n muls r5, r6, r5\n adds r5, r5, r4\n" \
  "lsrs r4, %[x], #11\n muls r4, %[mask], r4\n muls %[x], %[mask], %[x]\n lsrs %[mask], %[y], #11\n muls %[mask], r6, %[mask]\n adds r4, r4, %[mask]\n" \
  "muls %[y], r6, %[y]\n adds r6, %[x], %[y]\n"
#define SPANTEX_FINE SPANTEX_LEVEL "subs %[from], %[from], #12\n stmia %[from]!, {r4, r5, r6}\n"
#define SPANTEX_COARSE(OFFSET) "ldr %[s], %[two]\n" SPANTEX_LEVEL \
  "mov %[mask], %[fine]\n ldmia %[mask]!, {%[x], %[y], %[s]}\n mov %[fine], %[mask]\n adds r4, r4, %[x]\n adds r5, r5, %[y]\n adds r6, r6, %[s]\n" \
  "lsls %[x], r4, #11\n subs r6, r6, %[x]\n lsls %[x], r5, #10\n subs r4, r4, %[x]\n"  /* B and R alone */ \
  "add r4, %[half]\n lsrs r4, r4, #14\n lsls r4, r4, #6\n lsrs r5, r5, #14\n adcs r4, r4, r5\n lsls r4, r4, #5\n lsrs r6, r6, #14\n adcs r4, r4, r6\n" \
  "mov %[x], %[out]\n strh r4, [%[x], #" OFFSET "]\n"
// clang-format on

// The finer level's places become its sums. count > 0
[[gnu::always_inline]] inline void fine_sums(uint32_t* from, int count, int32_t pitch_bytes) {
  uint32_t s = -uint32_t(count) & 3, x, y, mask;
  const uint32_t two = twice, spread = spread_mask, *const end = from + pixel_words * count;
  asm volatile(SPANTEX_ENTER_WITH("ldr %[s], %[two]\n", "90") SPANTEX_FINE SPANTEX_FINE SPANTEX_FINE SPANTEX_FINE SPANTEX_PIXELS_ARE("8b", "4 * 90") "cmp %[from], %[end]\n beq 9f\n b 8b\n 9:\n"
               : [from] "+&l"(from), [s] "+&l"(s), [x] "=&l"(x), [y] "=&l"(y), [mask] "=&l"(mask)
               : [two] "m"(two), [spread] "m"(spread), [pitch] "h"(pitch_bytes), [end] "h"(end)
               : "r4", "r5", "r6", "memory", "cc");
}

// The coarser level's places and the finer one's sums become pixels. count > 0
[[gnu::always_inline]] inline void coarse_pixels(uint16_t* to, const uint32_t* fine, const uint32_t* from, int count, int32_t pitch_bytes) {
  register uint32_t x asm("r0");
  register uint32_t y asm("r1");
  register uint32_t s asm("r2") = -uint32_t(count) & 3;
  uint32_t mask;
  const uint32_t two = twice, spread = spread_mask;
  const uint16_t* const end = to + count;
  uint16_t* out = to - s;
  asm volatile(
      SPANTEX_ENTER("128")
      SPANTEX_COARSE("0") SPANTEX_COARSE("2") SPANTEX_COARSE("4") SPANTEX_COARSE("6") SPANTEX_PIXELS_ARE("8b", "4 * 128")
      "adds %[x], %[x], #8\n mov %[out], %[x]\n cmp %[x], %[end]\n beq 9f\n b 8b\n"
      "9:\n"
      : [out] "+&h"(out), [fine] "+&h"(fine), [from] "+&l"(from), [s] "+&l"(s), [x] "=&l"(x), [y] "=&l"(y), [mask] "=&l"(mask)
      : [two] "m"(two), [spread] "m"(spread), [half] "h"(1u << 13), [pitch] "h"(pitch_bytes), [end] "h"(end)
      : "r4", "r5", "r6", "memory", "cc");
}

#undef SPANTEX_FINE
#undef SPANTEX_COARSE
#undef SPANTEX_LEVEL
#undef SPANTEX_SPREAD
#undef SPANTEX_READ
#undef SPANTEX_NEXT
#undef SPANTEX_ENTER
#undef SPANTEX_ENTER_WITH
#undef SPANTEX_PIXELS_ARE
#undef SPANTEX_ROW
#undef SPANTEX_CHANNEL
#undef SPANTEX_BILINEAR

}  // namespace spantex::rows::thumb1
