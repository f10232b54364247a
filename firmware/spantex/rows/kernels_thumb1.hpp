// SPDX-License-Identifier: Apache-2.0
// Inner loops of kernels.hpp for cores with eight registers (Cortex-M0, M0+). The fractions of u and v are accumulators of 32 bits whose carries step the
// texel's address: no position is shifted, no row multiplied by the pitch. Filters take two loops, with an address and two fractions a pixel in memory
// between them; what is only added or copied lies in the upper registers.
//
//   instructions a pixel, loop included   nearest 6.5 to 7, bent rows 2 more (masked 9.4, 11.4)
//                                         places 5.5 to 6, bent rows 2 more   three-point 31   bilinear 51   trilinear 105
#pragma once
#include <stdint.h>

#include <spantex/rows/block.hpp>
#include <spantex/rows/packed.hpp>
#include <spantex/rows/sample.hpp>

namespace spantex::rows::thumb1 {

// Along a row: the texel's address / 2, the fractions behind it, 2^-32 texel, and their steps, whose whole parts are in the address's.
struct carried { uint32_t at, u, v, step, du, dv; };
// Of positions with `Bits` of fraction; `row`: texels from one row of the map to the next.
template <int Bits>
[[gnu::always_inline]] SPANTEX_WRAPS inline carried carried_of(const walk& w, const texel565* origin, int32_t row) {
  const auto texels = [&](int32_t u, int32_t v) { return uint32_t(u >> Bits) + uint32_t(v >> Bits) * row; };
  const auto fraction = [&](int32_t x) { return uint32_t(x) << (32 - Bits); };
  return {(uint32_t(reinterpret_cast<uintptr_t>(origin)) >> 1) + texels(w.u, w.v), fraction(w.u), fraction(w.v), texels(w.du, w.dv), fraction(w.du), fraction(w.dv)};
}
// Whether the whole parts of a bent row's steps stay what they are: then fractions alone change.
template <int Bits>
constexpr bool steps_alike(const walk& w, int count) {
  const auto alike = [&](int32_t first, int32_t change) { return (first ^ (first + (count - 1) * change)) >> Bits == 0; };
  return alike(w.du, w.ddu) && alike(w.dv, w.ddv);
}

// clang-format off
#define SPANTEX_STEP "adds %[u], %[u], %[du]\n adcs %[a], %[a], %[step]\n adds %[v], %[v], %[dv]\n bcc.n 2f\n add %[a], %[row]\n 2:\n"
#define SPANTEX_BEND "add %[du], %[ddu]\n add %[dv], %[ddv]\n"
#define SPANTEX_TEXEL(OFFSET, STEP) "ldrh %[t], [%[a], %[a]]\n strh %[t], [%[out], #" OFFSET "]\n" STEP
#define SPANTEX_MASKED(OFFSET, BEND) "lsrs %[t], %[u], #15\n ands %[t], %[mu]\n lsrs %[s], %[v], #15\n ands %[s], %[mv]\n adds %[t], %[t], %[s]\n" \
                                     "add %[u], %[du]\n add %[v], %[dv]\n ldrh %[t], [%[base], %[t]]\n strh %[t], [%[out], #" OFFSET "]\n" BEND
// Entered by a jump over `t` bytes, so that a multiple of eight pixels is left; `out` is as many pixels before the first. BYTES: of a pixel's code, which is checked.
#define SPANTEX_LOOP(PIXEL, BEND) ".syntax unified\n add pc, %[t]\n nop\n 1:\n" PIXEL("0", BEND) PIXEL("2", BEND) PIXEL("4", BEND) PIXEL("6", BEND) \
                                  PIXEL("8", BEND) PIXEL("10", BEND) PIXEL("12", BEND) PIXEL("14", BEND) SPANTEX_PIXELS_ARE("1b", "8 * %c[bytes]") \
                                  "adds %[out], %[out], #16\n cmp %[out], %[end]\n bne 1b\n"
#define SPANTEX_PIXELS_ARE(FIRST, BYTES) ".if . - " FIRST " - (" BYTES ")\n .error \"spantex: length of a pixel's code\"\n .endif\n"
// clang-format on

// count > 0. origin: the texel at (0, 0).
[[gnu::noinline]] SPANTEX_WRAPS inline void nearest(uint16_t* to, int count, const walk& at, const texel565* origin, int32_t pitch_bytes) {
  const int32_t row = pitch_bytes >> 1;
  const uint32_t skipped = -uint32_t(count) & 7;
  uint16_t *out = to - skipped, *const end = to + count;
  if (is_straight(at)) {
    carried c = carried_of<16>(at, origin, row);
    constexpr uint32_t bytes = 14;
    uint32_t t = skipped * bytes;
    asm volatile(SPANTEX_LOOP(SPANTEX_TEXEL, SPANTEX_STEP)
                 : [out] "+&l"(out), [a] "+&l"(c.at), [u] "+&l"(c.u), [v] "+&l"(c.v), [t] "+&l"(t)
                 : [step] "l"(c.step), [du] "l"(c.du), [dv] "l"(c.dv), [row] "h"(row), [end] "h"(end), [bytes] "i"(bytes)
                 : "memory", "cc");
  } else if (steps_alike<16>(at, count)) {
    carried c = carried_of<16>(at, origin, row);
    constexpr uint32_t bytes = 18;
    uint32_t t = skipped * bytes;
    asm volatile(SPANTEX_LOOP(SPANTEX_TEXEL, SPANTEX_STEP SPANTEX_BEND)
                 : [out] "+&l"(out), [a] "+&l"(c.at), [u] "+&l"(c.u), [v] "+&l"(c.v), [t] "+&l"(t), [du] "+&l"(c.du), [dv] "+&l"(c.dv)
                 : [step] "l"(c.step), [ddu] "h"(uint32_t(at.ddu) << 16), [ddv] "h"(uint32_t(at.ddv) << 16), [row] "h"(row), [end] "h"(end), [bytes] "i"(bytes)
                 : "memory", "cc");
  } else {
    for (walk w = at; to != end; w.step()) *to++ = origin[texel_of(w.u) + texel_of(w.v) * row];
  }
}

// The same with whole positions wrapped by masks (height - 1 : width - 1) of at most 2^16 texels: v is brought to the place where its bits are wanted.
inline bool masks_fit(uint32_t masks) { return ((masks & 0xFFFF) + 1) * ((masks >> 16) + 1) <= 1u << 16; }
[[gnu::noinline]] SPANTEX_WRAPS inline void nearest_masked(uint16_t* to, int count, const walk& at, const texel565* texels, uint32_t masks) {
  const uint32_t skipped = -uint32_t(count) & 7, width = (masks & 0xFFFF) + 1, mu = 2 * width - 2, mv = (masks >> 16) * 2 * width;
  uint16_t *out = to - skipped, *const end = to + count;
  uint32_t s, u = uint32_t(at.u), v = uint32_t(at.v) * width, dv = uint32_t(at.dv) * width;
  if (is_straight(at)) {
    constexpr uint32_t bytes = 18;
    uint32_t t = skipped * bytes;
    asm volatile(SPANTEX_LOOP(SPANTEX_MASKED, "")
                 : [out] "+&l"(out), [u] "+&l"(u), [v] "+&l"(v), [t] "+&l"(t), [s] "=&l"(s)
                 : [mu] "l"(mu), [mv] "l"(mv), [base] "l"(texels), [du] "h"(at.du), [dv] "h"(dv), [end] "h"(end), [bytes] "i"(bytes)
                 : "memory", "cc");
  } else {
    constexpr uint32_t bytes = 22;
    uint32_t du = uint32_t(at.du), t = skipped * bytes;
    asm volatile(SPANTEX_LOOP(SPANTEX_MASKED, SPANTEX_BEND)
                 : [out] "+&l"(out), [u] "+&l"(u), [v] "+&l"(v), [t] "+&l"(t), [s] "=&l"(s), [du] "+&h"(du), [dv] "+&h"(dv)
                 : [mu] "l"(mu), [mv] "l"(mv), [base] "l"(texels), [ddu] "h"(at.ddu), [ddv] "h"(uint32_t(at.ddv) * width), [end] "h"(end), [bytes] "i"(bytes)
                 : "memory", "cc");
  }
}

#undef SPANTEX_TEXEL
#undef SPANTEX_MASKED
#undef SPANTEX_LOOP

// A pixel's place: the texel's address / 2, fractions of u and v, 2^-32 texel. `Words` from each to the next: two levels have theirs in turns. Four at a time,
// the last ones in vain.
inline constexpr int place_words = 3, trilinear_words = 2 * place_words, scratch_words = trilinear_words * longest_run;

// clang-format off
#define SPANTEX_PLACE(STEP) "stmia %[to]!, {%[a], %[u], %[v]}\n .if %c[gap]\n adds %[to], %[gap]\n .endif\n" STEP
#define SPANTEX_PLACES(STEP) ".syntax unified\n 1:\n" SPANTEX_PLACE(STEP) SPANTEX_PLACE(STEP) SPANTEX_PLACE(STEP) SPANTEX_PLACE(STEP) "subs %[n], #4\n bgt 1b\n"
// clang-format on

// count > 0. weight: in the lowest byte of v, below what the fraction fills.
template <int Bits, int Words>
[[gnu::always_inline]] SPANTEX_WRAPS inline void straight_places(uint32_t* to, int count, const walk& from, const texel565* origin, int32_t row, uint32_t weight) {
  const carried c = carried_of<Bits>(from, origin, row);
  register uint32_t a asm("r4") = c.at;
  register uint32_t u asm("r5") = c.u;
  register uint32_t v asm("r6") = c.v | weight;
  asm volatile(SPANTEX_PLACES(SPANTEX_STEP)
               : [to] "+&l"(to), [n] "+&l"(count), [a] "+&l"(a), [u] "+&l"(u), [v] "+&l"(v)
               : [step] "l"(c.step), [du] "l"(c.du), [dv] "l"(c.dv), [row] "h"(row), [gap] "i"(4 * (Words - place_words))
               : "memory", "cc");
}

template <int Bits, int Words>
[[gnu::always_inline]] SPANTEX_WRAPS inline void bent_places(uint32_t* to, int count, const walk& from, const texel565* origin, int32_t row) {
  if (!steps_alike<Bits>(from, count)) {
    for (walk at = from; count > 0; --count, at.step(), to += Words) {
      const carried c = carried_of<Bits>(at, origin, row);
      to[0] = c.at;
      to[1] = c.u;
      to[2] = c.v;
    }
    return;
  }
  carried c = carried_of<Bits>(from, origin, row);
  register uint32_t a asm("r4") = c.at;
  register uint32_t u asm("r5") = c.u;
  register uint32_t v asm("r6") = c.v;
  asm volatile(SPANTEX_PLACES(SPANTEX_STEP SPANTEX_BEND)
               : [to] "+&l"(to), [n] "+&l"(count), [a] "+&l"(a), [u] "+&l"(u), [v] "+&l"(v), [du] "+&l"(c.du), [dv] "+&l"(c.dv)
               : [step] "l"(c.step), [ddu] "h"(uint32_t(from.ddu) << (32 - Bits)), [ddv] "h"(uint32_t(from.ddv) << (32 - Bits)), [row] "h"(row),
                 [gap] "i"(4 * (Words - place_words))
               : "memory", "cc");
}

// Of one level.
[[gnu::always_inline]] inline void places(uint32_t* to, int count, const walk& from, const source& s) {
  if (is_straight(from)) straight_places<16, place_words>(to, count, from, s.origin, s.pitch_bytes >> 1, 0);
  else bent_places<16, place_words>(to, count, from, s.origin, s.pitch_bytes >> 1);
}
#undef SPANTEX_STEP
#undef SPANTEX_BEND
#undef SPANTEX_PLACE
#undef SPANTEX_PLACES

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
#define SPANTEX_ENTER(BYTES) ".syntax unified\n movs %[x], #" BYTES "\n muls %[x], %[s], %[x]\n add pc, %[x]\n nop\n 8:\n"
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

// Two levels, whose places take turns, fine first. Sums of a level's two rows with weights (32 - fv) w and fv w of 9 bits, w the level's, lie in the upper
// registers until the other level's are added: G, P = 2^10 G + R, and T = 2^11 P + B modulo 2^32.
// clang-format off
#define SPANTEX_ROW(X, Y) SPANTEX_SPREAD(X, "%[twice]") SPANTEX_SPREAD(Y, "%[twice]") "subs " Y ", " Y ", " X "\n muls " Y ", r5, " Y "\n lsls " X ", " X ", #5\n adds " X ", " X ", " Y "\n"
#define SPANTEX_LEVEL(PITCH) \
  "ldmia %[from]!, {r4, r5, r6}\n lsls r4, r4, #1\n lsrs r5, r5, #27\n" \
  "ldrh %[x], [r4]\n ldrh %[y], [r4, #2]\n" SPANTEX_ROW("%[x]", "%[y]") \
  "add r4, " PITCH "\n ldrh %[y], [r4]\n ldrh r4, [r4, #2]\n" SPANTEX_ROW("%[y]", "r4") \
  "uxtb r4, r6\n lsrs r6, r6, #27\n muls r6, r4, r6\n lsls r4, r4, #5\n subs r4, r4, r6\n"
#define SPANTEX_FINE SPANTEX_LEVEL("%[near]") \
  "lsrs r5, %[x], #21\n muls r5, r4, r5\n mov %[g], r5\n lsrs r5, %[y], #21\n muls r5, r6, r5\n add %[g], r5\n" \
  "lsrs r5, %[x], #11\n muls r5, r4, r5\n mov %[p], r5\n lsrs r5, %[y], #11\n muls r5, r6, r5\n add %[p], r5\n" \
  "muls %[x], r4, %[x]\n mov lr, %[x]\n muls %[y], r6, %[y]\n add lr, %[y]\n"
#define SPANTEX_COARSE(OFFSET) SPANTEX_LEVEL("%[far]") \
  "lsrs r5, %[x], #21\n muls r5, r4, r5\n add %[g], r5\n lsrs r5, %[x], #11\n muls r5, r4, r5\n add %[p], r5\n muls %[x], r4, %[x]\n add lr, %[x]\n" \
  "lsrs %[x], %[y], #11\n muls %[x], r6, %[x]\n add %[x], %[p]\n lsrs r4, %[y], #21\n muls r4, r6, r4\n add r4, %[g]\n muls %[y], r6, %[y]\n add %[y], lr\n" \
  "lsls r6, %[x], #11\n subs %[y], %[y], r6\n lsls r6, r4, #10\n subs %[x], %[x], r6\n"  /* R, G, B; red is rounded by a difference modulo 2^5 */ \
  "lsrs %[x], %[x], #14\n sbcs %[x], %[x], %[mask]\n lsls %[x], %[x], #6\n lsrs r4, r4, #14\n adcs %[x], %[x], r4\n lsls %[x], %[x], #5\n lsrs %[y], %[y], #14\n adcs %[x], %[x], %[y]\n" \
  "mov %[y], %[out]\n strh %[x], [%[y], #" OFFSET "]\n"
// clang-format on

// The place of texels that are copied, with a pitch of 4 bytes: where the next ones go.
inline uint32_t* place_copied(uint32_t* to, const texels& t, uint32_t* copies, uint32_t u, uint32_t v) {
  copies[0] = t.t00 | t.t10 << 16;
  copies[1] = t.t01 | t.t11 << 16;
  to[0] = uint32_t(reinterpret_cast<uintptr_t>(copies)) >> 1;
  to[1] = u;
  to[2] = v;
  return copies + 2;
}

// Weights of both levels where they change along a row.
SPANTEX_WRAPS inline void weigh(uint32_t* places_of_two, int count, const level_run& along) {
  uint8_t* to = reinterpret_cast<uint8_t*>(places_of_two);
  uint32_t level = uint32_t(along.start) << 16;  // the fraction
  const uint32_t step = uint32_t(along.step) << 16;
  for (const uint8_t* const end = to + 4 * trilinear_words * count; to != end; to += 4 * trilinear_words, level += step) {
    const uint32_t f = level >> (32 - blend_bits);
    to[8] = uint8_t((1u << blend_bits) - f);
    to[4 * place_words + 8] = uint8_t(f);
  }
}

// Positions of the coarser level follow from the finer one's: (fine + snap) / 2, here with a bit more of fraction.
constexpr walk coarser(const walk& w) { return {w.u + snap, w.v + snap, w.du, w.dv, w.ddu, w.ddv}; }

[[gnu::noinline]] SPANTEX_WRAPS inline void bent_places_of_two(uint32_t* to, int count, const walk& from, const source& fine, const source& coarse, const level_run& along) {
  bent_places<16, trilinear_words>(to, count, from, fine.origin, fine.pitch_bytes >> 1);
  bent_places<17, trilinear_words>(to + place_words, count, coarser(from), coarse.origin, coarse.pitch_bytes >> 1);
  weigh(to, count, along);
}
[[gnu::always_inline]] SPANTEX_WRAPS inline void places_of_two(uint32_t* to, int count, const walk& from, const source& fine, const source& coarse, const level_run& along) {
  if ((from.ddu | from.ddv | along.step) != 0) return bent_places_of_two(to, count, from, fine, coarse, along);
  const uint32_t f = fraction_of(along.start);
  straight_places<16, trilinear_words>(to, count, from, fine.origin, fine.pitch_bytes >> 1, (1u << blend_bits) - f);
  straight_places<17, trilinear_words>(to + place_words, count, coarser(from), coarse.origin, coarse.pitch_bytes >> 1, f);
}

// count > 0
[[gnu::always_inline]] inline void eight_points(uint16_t* to, const uint32_t* from, int count, int32_t fine_pitch_bytes, int32_t coarse_pitch_bytes) {
  constexpr uint32_t bytes = 208;
  const uint32_t skipped = -uint32_t(count) & 7;
  uint32_t x = bytes * skipped, y, g, p;
  const uint16_t* const end = to + count;
  uint16_t* out = to - skipped;
  asm volatile(
      ".syntax unified\n add pc, %[x]\n nop\n 8:\n"
      SPANTEX_FINE SPANTEX_COARSE("0") SPANTEX_FINE SPANTEX_COARSE("2") SPANTEX_FINE SPANTEX_COARSE("4") SPANTEX_FINE SPANTEX_COARSE("6")
      SPANTEX_FINE SPANTEX_COARSE("8") SPANTEX_FINE SPANTEX_COARSE("10") SPANTEX_FINE SPANTEX_COARSE("12") SPANTEX_FINE SPANTEX_COARSE("14") SPANTEX_PIXELS_ARE("8b", "8 * %c[bytes]")
      "adds %[y], %[y], #16\n mov %[out], %[y]\n ldr %[x], %[end]\n cmp %[y], %[x]\n beq 9f\n b 8b\n"
      "9:\n"
      : [out] "+&h"(out), [from] "+&l"(from), [x] "+&l"(x), [y] "=&l"(y), [g] "=&h"(g), [p] "=&h"(p)
      : [twice] "l"(twice), [mask] "l"(spread_mask), [near] "h"(fine_pitch_bytes), [far] "h"(coarse_pitch_bytes), [end] "m"(end), [bytes] "i"(bytes)
      : "r4", "r5", "r6", "lr", "memory", "cc");  // gcc gives lr to no operand
}

// Of a row, or of places that are there already.
[[gnu::noinline]] inline void trilinear(uint16_t* to, int count, const walk* from, const source& fine, const source& coarse, const level_run& along, uint32_t* words) {
  if (from != nullptr) places_of_two(words, count, *from, fine, coarse, along);
  eight_points(to, words, count, fine.pitch_bytes, coarse.pitch_bytes);
}

#undef SPANTEX_FINE
#undef SPANTEX_COARSE
#undef SPANTEX_LEVEL
#undef SPANTEX_SPREAD
#undef SPANTEX_READ
#undef SPANTEX_NEXT
#undef SPANTEX_ENTER
#undef SPANTEX_PIXELS_ARE
#undef SPANTEX_ROW
#undef SPANTEX_CHANNEL
#undef SPANTEX_BILINEAR

}  // namespace spantex::rows::thumb1
