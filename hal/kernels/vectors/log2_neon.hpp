// SPDX-License-Identifier: Apache-2.0
// Vector kernels: sixteen lengths of a span at once, their knots looked up by bytes in registers. Included by ../neon.cpp alone.
#pragma once

struct knot_bytes {
  uint8_t plane[4][1 << log2_table_bits];
  constexpr knot_bytes() : plane() {
    for (int k = 0; k < 1 << log2_table_bits; ++k)
      for (int n = 0; n < 4; ++n) plane[n][k] = uint8_t(knots.pair[k] >> (8 * n));
  }
};
static_assert(sizeof knot_bytes{}.plane[0] == 64);
constexpr knot_bytes bytes_of_knots{};

SPANTEX_INLINE void half_log2_of(v (&x)[4]) {
  const auto upper = [&](int n) SPANTEX_INLINED { return uint8x16_t(vshrn_high_n_s32(vshrn_n_s32(int32x4_t(x[n]), 16), int32x4_t(x[n + 1]), 16)); };
  const auto lower = [&](int n) SPANTEX_INLINED { return vuzp1q_u16(uint16x8_t(x[n]), uint16x8_t(x[n + 1])); };
  const uint8x16_t index = vandq_u8(vuzp1q_u8(upper(0), upper(2)), vdupq_n_u8(63));
  const auto plane = [&](int n) SPANTEX_INLINED { return vqtbl4q_u8(vld1q_u8_x4(bytes_of_knots.plane[n]), index); };
  const uint8x16_t low = plane(0), high = plane(1), change_low = plane(2), change_high = plane(3);
  const uint16x8_t knot[] = {uint16x8_t(vzip1q_u8(low, high)), uint16x8_t(vzip2q_u8(low, high))};
  const uint16x8_t change[] = {uint16x8_t(vzip1q_u8(change_low, change_high)), uint16x8_t(vzip2q_u8(change_low, change_high))}, bits[] = {lower(0), lower(2)};
#pragma GCC unroll 4
  for (int n = 0; n < 4; ++n) {
    const int h = n / 2;
    const uint32x4_t product = n & 1 ? vmull_high_u16(change[h], bits[h]) : vmull_u16(vget_low_u16(change[h]), vget_low_u16(bits[h]));
    const uint32x4_t fraction = vaddl_u16(n & 1 ? vget_high_u16(knot[h]) : vget_low_u16(knot[h]), vrshrn_n_u32(product, 16));
    x[n] = (((x[n] >> significand_bits) << 16) + v(fraction)) >> 1;
  }
}
