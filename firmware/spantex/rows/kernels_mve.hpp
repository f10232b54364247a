// SPDX-License-Identifier: Apache-2.0
// With M-profile vectors (MVE, Cortex-M55): coordinates of four rows at once, and bilinear runs, eight pixels at a time in 16-bit lanes with four gathers.
// A run takes two loops: the first writes positions, 9 instructions for eight pixels of straight rows, 13 of bent ones; the second filters, 55, or 67 where
// masks wrap.
// The only header of the library that includes a compiler's own (arm_mve.h).
#pragma once
#include <arm_mve.h>
#include <stdint.h>

#include <spantex/bits.hpp>
#include <spantex/rows/block.hpp>
#include <spantex/rows/packed.hpp>

namespace spantex::rows::mve {

// One number of four walks that follow each other.
[[gnu::always_inline]] inline void store_four(int32_t* first, int32x4_t x) { vstrwq_scatter_offset_s32(first, vmulq_n_u32(vidupq_n_u32(0, 1), sizeof(walk)), x); }
[[gnu::always_inline]] inline int32x4_t shifted_down(uint32x4_t x, int32_t down) { return vshlq_r_s32(vreinterpretq_s32_u32(x), -down); }

// As add_rows() of run.hpp: four lanes go on by four rows.
template <int32_t walk::*U, int32_t walk::*Du, int32_t walk::*Ddu>
[[gnu::always_inline]] inline void add_rows(const block_axis& x, const detail::row_numbers<uint32x4_t>& j, int k, walk* to, const walk* end) {
  const row_differences& r = x.rows;
  const auto along = [](uint32_t at_0, uint32_t by_row, uint32x4_t n) { return vmlaq_n_u32(vdupq_n_u32(at_0), n, by_row); };
  {
    const uint32_t x1 = r.start[1], x2 = r.start[2], x3 = r.start[3];
    uint32x4_t start = vmlaq_n_u32(vmlaq_n_u32(along(r.start[0], x1, j.one), j.two, x2), j.three, x3);
    uint32x4_t first = vmlaq_n_u32(along(4 * x1 + 6 * x2 + 4 * x3, 4 * x2 + 6 * x3, j.one), j.two, 4 * x3), second = along(16 * x2 + 48 * x3, 16 * x3, j.one);
    for (walk* w = to; w < end; w += 4) {
      store_four(&(w->*U), vaddq_n_s32(vshrq_n_s32(vreinterpretq_s32_u32(start), row_bits), x.offset));
      start = vaddq_u32(start, first);
      first = vaddq_u32(first, second);
      second = vaddq_n_u32(second, 64 * x3);
    }
  }
  const uint32_t y1 = r.step[1], y2 = r.step[2], by_row = r.bend[1];
  uint32x4_t step = vmlaq_n_u32(along(r.step[0], y1, j.one), j.two, y2), first = along(4 * y1 + 6 * y2, 4 * y2, j.one), bend = along(r.bend[0], by_row, j.one);
  const int32_t down = row_bits + k - 1, columns = (1 << (k - 1)) - 1;
  for (walk* w = to; w < end; w += 4) {
    const int32x4_t bent = shifted_down(bend, down);
    store_four(&(w->*Ddu), bent);
    store_four(&(w->*Du), vmlaq_n_s32(shifted_down(step, down), bent, -columns));
    bend = vaddq_n_u32(bend, 4 * by_row);
    step = vaddq_u32(step, first);
    first = vaddq_n_u32(first, 16 * y2);
  }
}

// Rows of a block from row j on, a multiple of 4; k > 0.
[[gnu::noinline]] inline void rows_from(const block& b, int32_t j, walk* to, const walk* end) {
  const detail::row_numbers<uint32x4_t> numbers = detail::numbers_of(vidupq_n_u32(uint32_t(j), 1));
  add_rows<&walk::u, &walk::du, &walk::ddu>(b.u, numbers, b.k, to, end);
  add_rows<&walk::v, &walk::dv, &walk::ddv>(b.v, numbers, b.k, to, end);
}

// A map as lanes address it: by offsets of 16 bits from `texels`, at positions of 11 bits and 5 of fraction.
struct source {
  const texel565* texels;
  int32_t pitch;
  uint16_t columns, rows;  // masks that wrap: width - 1, (height - 1) * pitch; no columns: nothing is wrapped
  uint32_t u, v;           // what is added to positions; without masks they are at least 0 then
};
inline constexpr int32_t longest_side = 1 << 11;

// Whether offsets within `rows` texel rows fit.
constexpr bool offsets_fit(int32_t rows, int32_t pitch) { return rows * pitch <= 0xFFFF; }

// Eight pixels' positions between the two loops, in their order.
struct eight { uint16_t u[8], v[8]; };

// A walk in 2^-21 texel: the upper half of a number is a position as above. Lanes are pixels 0 2 4 6.
struct fine_walk { uint32_t u, v, du, dv, ddu, ddv; };
[[gnu::always_inline]] inline uint32x4_t lanes_of(uint32_t start, uint32_t step, uint32x4_t i) { return vaddq_n_u32(vmulq_n_u32(i, step), start); }

[[gnu::always_inline]] inline void places_straight(eight* to, int count, const fine_walk& at) {
  const uint32x4_t i = vidupq_n_u32(0, 2);
  uint32x4_t u = lanes_of(at.u, at.du, i), v = lanes_of(at.v, at.dv, i), x;
  asm volatile(
      "dlstp.16 lr, %[n]\n"
      "1: vadd.i32 %q[x], %q[u], %[du]\n"
      "vsri.32 %q[x], %q[u], #16\n"
      "vadd.i32 %q[u], %q[u], %[du8]\n"
      "vstrh.16 %q[x], [%[to]], #16\n"
      "vadd.i32 %q[x], %q[v], %[dv]\n"
      "vsri.32 %q[x], %q[v], #16\n"
      "vadd.i32 %q[v], %q[v], %[dv8]\n"
      "vstrh.16 %q[x], [%[to]], #16\n"
      "letp lr, 1b\n"
      : [to] "+&r"(to), [u] "+&w"(u), [v] "+&w"(v), [x] "=&w"(x)
      : [n] "r"(count), [du] "r"(at.du), [dv] "r"(at.dv), [du8] "r"(8 * at.du), [dv8] "r"(8 * at.dv)
      : "lr", "memory", "cc");
}

// Eight pixels on a position gains 8 of its steps and 28 bends.
[[gnu::always_inline]] inline void places_bent(eight* to, int count, const fine_walk& at) {
  const uint32x4_t i = vidupq_n_u32(0, 2), pairs = vshrq_n_u32(vmulq_u32(i, vsubq_n_u32(i, 1)), 1);
  uint32x4_t u = vaddq_u32(lanes_of(at.u, at.du, i), vmulq_n_u32(pairs, at.ddu)), du = lanes_of(at.du, at.ddu, i);
  uint32x4_t v = vaddq_u32(lanes_of(at.v, at.dv, i), vmulq_n_u32(pairs, at.ddv)), dv = lanes_of(at.dv, at.ddv, i), x;
  asm volatile(
      "dlstp.16 lr, %[n]\n"
      "1: vadd.i32 %q[x], %q[u], %q[du]\n"
      "vsri.32 %q[x], %q[u], #16\n"
      "vmla.u32 %q[u], %q[du], %[r8]\n"
      "vadd.i32 %q[u], %q[u], %[ddu28]\n"
      "vadd.i32 %q[du], %q[du], %[ddu8]\n"
      "vstrh.16 %q[x], [%[to]], #16\n"
      "vadd.i32 %q[x], %q[v], %q[dv]\n"
      "vsri.32 %q[x], %q[v], #16\n"
      "vmla.u32 %q[v], %q[dv], %[r8]\n"
      "vadd.i32 %q[v], %q[v], %[ddv28]\n"
      "vadd.i32 %q[dv], %q[dv], %[ddv8]\n"
      "vstrh.16 %q[x], [%[to]], #16\n"
      "letp lr, 1b\n"
      : [to] "+&r"(to), [u] "+&w"(u), [v] "+&w"(v), [du] "+&w"(du), [dv] "+&w"(dv), [x] "=&w"(x)
      : [n] "r"(count), [r8] "r"(8), [ddu8] "r"(8 * at.ddu), [ddv8] "r"(8 * at.ddv), [ddu28] "r"(28 * at.ddu), [ddv28] "r"(28 * at.ddv)
      : "lr", "memory", "cc");
}

// clang-format off
// Positions to q0 and q1, then weights; whole positions to q2 and q3.
#define SPANTEX_WEIGHTS "vldrh.u16 q0, [%[from]], #16\n vldrh.u16 q1, [%[from]], #16\n vshr.u16 q2, q0, #5\n vshr.u16 q3, q1, #5\n" \
                        "vmla.u16 q0, q2, %[m32]\n vmla.u16 q1, q3, %[m32]\n"
// 32 a + (b - a) f; B may be TO.
#define SPANTEX_LERP(TO, A, B, F) "vsub.i16 " TO ", " B ", " A "\n vmul.i16 " TO ", " TO ", " F "\n vmla.u16 " TO ", " A ", %[r32]\n"
#define SPANTEX_SHIFT(A, B, N) "vshr.u16 " A ", " A ", #" N "\n vshr.u16 " B ", " B ", #" N "\n"
// Sums modulo 2^16 of whole texels, of texels without blue, of red: along u from q3 and q4 into q5, q6, q4, then from q3 and q7, and along v, into q2, q5, q7.
#define SPANTEX_UPPER SPANTEX_LERP("q5", "q3", "q4", "q0") SPANTEX_SHIFT("q3", "q4", "5") SPANTEX_LERP("q6", "q3", "q4", "q0") \
                      SPANTEX_SHIFT("q3", "q4", "6") SPANTEX_LERP("q4", "q3", "q4", "q0")
#define SPANTEX_LOWER SPANTEX_LERP("q2", "q3", "q7", "q0") SPANTEX_LERP("q2", "q5", "q2", "q1") \
                      SPANTEX_SHIFT("q3", "q7", "5") SPANTEX_LERP("q5", "q3", "q7", "q0") SPANTEX_LERP("q5", "q6", "q5", "q1") \
                      SPANTEX_SHIFT("q3", "q7", "6") SPANTEX_LERP("q7", "q3", "q7", "q0") SPANTEX_LERP("q7", "q4", "q7", "q1")
// Less what is above them, those are blue, green, red, all below 2^16: rounded and packed.
#define SPANTEX_PACK "vmla.u16 q2, q5, %[m32]\n vmla.u16 q5, q7, %[m64]\n vrshr.u16 q2, q2, #10\n vrshr.u16 q5, q5, #10\n vrshr.u16 q7, q7, #10\n" \
                     "vsli.16 q2, q5, #5\n vsli.16 q2, q7, #11\n vstrh.16 q2, [%[out]], #16\n"
// clang-format on

// Eight pixels a turn, the last turn's lanes beyond `count` left alone.
[[gnu::always_inline]] inline void four_points(uint16_t* out, const eight* from, int count, const source& map) {
  const texel565* const below = map.texels + map.pitch;
  asm volatile(
      "dlstp.16 lr, %[n]\n"
      "1:\n" SPANTEX_WEIGHTS
      "vmla.u16 q2, q3, %[pitch]\n"
      "vldrh.u16 q3, [%[t00], q2, uxtw #1]\n"
      "vldrh.u16 q4, [%[t10], q2, uxtw #1]\n" SPANTEX_UPPER
      "vldrh.u16 q3, [%[t01], q2, uxtw #1]\n"
      "vldrh.u16 q7, [%[t11], q2, uxtw #1]\n" SPANTEX_LOWER SPANTEX_PACK
      "letp lr, 1b\n"
      : [out] "+&r"(out), [from] "+&r"(from)
      : [n] "r"(count), [pitch] "r"(map.pitch), [t00] "r"(map.texels), [t10] "r"(map.texels + 1), [t01] "r"(below), [t11] "r"(below + 1), [r32] "r"(32),
        [m32] "r"(-32), [m64] "r"(-64)
      : "q0", "q1", "q2", "q3", "q4", "q5", "q6", "q7", "lr", "memory", "cc");
}

// Both columns in q7 and q2, both rows in q3 and q6 are wrapped.
[[gnu::always_inline]] inline void four_points_wrapped(uint16_t* out, const eight* from, int count, const source& map) {
  asm volatile(
      "dlstp.16 lr, %[n]\n"
      "1:\n" SPANTEX_WEIGHTS
      "vdup.16 q5, %[columns]\n"
      "vand q7, q2, q5\n"
      "vadd.i16 q2, q7, %[one]\n"
      "vand q2, q2, q5\n"
      "vdup.16 q5, %[rows]\n"
      "vmul.i16 q3, q3, %[pitch]\n"
      "vand q3, q3, q5\n"
      "vadd.i16 q6, q3, %[pitch]\n"
      "vand q6, q6, q5\n"
      "vadd.i16 q5, q7, q3\n"
      "vadd.i16 q3, q2, q3\n"
      "vldrh.u16 q4, [%[texels], q3, uxtw #1]\n"
      "vldrh.u16 q3, [%[texels], q5, uxtw #1]\n"
      "vadd.i16 q7, q7, q6\n"
      "vadd.i16 q2, q2, q6\n" SPANTEX_UPPER
      "vldrh.u16 q3, [%[texels], q7, uxtw #1]\n"
      "vldrh.u16 q7, [%[texels], q2, uxtw #1]\n" SPANTEX_LOWER SPANTEX_PACK
      "letp lr, 1b\n"
      : [out] "+&r"(out), [from] "+&r"(from)
      : [n] "r"(count), [pitch] "r"(map.pitch), [texels] "r"(map.texels), [columns] "r"(map.columns), [rows] "r"(map.rows), [one] "r"(1), [r32] "r"(32),
        [m32] "r"(-32), [m64] "r"(-64)
      : "q0", "q1", "q2", "q3", "q4", "q5", "q6", "q7", "lr", "memory", "cc");
}
#undef SPANTEX_WEIGHTS
#undef SPANTEX_LERP
#undef SPANTEX_SHIFT
#undef SPANTEX_UPPER
#undef SPANTEX_LOWER
#undef SPANTEX_PACK

// One function: the vector registers of the caller are saved once.
[[gnu::noinline]] inline void bilinear(uint16_t* out, int count, const walk& at, const source& map, uint32_t* between) {
  eight* const places = reinterpret_cast<eight*>(between);
  const auto fine = [](int32_t x) { return uint32_t(x) * 32; };
  const fine_walk from{fine(at.u) + 32 * map.u, fine(at.v) + 32 * map.v, fine(at.du), fine(at.dv), fine(at.ddu), fine(at.ddv)};
  if (is_straight(at)) places_straight(places, count, from);
  else places_bent(places, count, from);
  if (map.columns == 0) four_points(out, places, count, map);
  else four_points_wrapped(out, places, count, map);
}

}  // namespace spantex::rows::mve
