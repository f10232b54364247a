// SPDX-License-Identifier: Apache-2.0
// Vector kernels: what NEON (arm64) has no operator for. Included by ../neon.cpp alone.
#pragma once

SPANTEX_INLINE v products(v a, v b) {  // of both halves of a lane, added up
  const int16x8_t x = int16x8_t(a), y = int16x8_t(b);
  return v(vpaddq_s32(vmull_s16(vget_low_s16(x), vget_low_s16(y)), vmull_high_s16(x, y)));
}
SPANTEX_INLINE v halves(v low, v high) { return v(vbslq_s32(vdupq_n_u32(0xFFFF), int32x4_t(low), int32x4_t(high))); }
template <int K>
SPANTEX_INLINE v lane_of(v x) { return v(vdupq_laneq_s32(int32x4_t(x), K)); }
SPANTEX_INLINE bool all_equal(v a, int32_t b) { return vminvq_u32(uint32x4_t(a == b)) != 0; }

// Of the even lanes.
SPANTEX_INLINE v_64 wide_products(v_64 a, v_64 b) { return v_64(vmull_u32(vmovn_u64(uint64x2_t(a)), vmovn_u64(uint64x2_t(b)))); }
SPANTEX_INLINE v_64 wide_signed_products(v_64 a, v_64 b) { return v_64(vmull_s32(vmovn_s64(int64x2_t(a)), vmovn_s64(int64x2_t(b)))); }
SPANTEX_INLINE v look_up(const int32_t* table, v at) { return v{table[at[0]], table[at[1]], table[at[2]], table[at[3]]}; }

// 2x2 texels of pixels interpolated: pixel k in quad[k], a channel a lane, 14 bits of fraction.
struct blends { v quad[4]; };
constexpr int blend_fraction = 14;

// Down first, in bytes, then across, in words: nothing is shuffled. weights: bytes f, 128 - f of u, then of v, a lane a pixel.
template <int K>
SPANTEX_INLINE v blend_one(const rgba8* top, const rgba8* bottom, uint8x16_t weights, uint16x8_t fraction, uint16x8_t rest) {
  const uint8x8_t row0 = vld1_u8(reinterpret_cast<const uint8_t*>(top)), row1 = vld1_u8(reinterpret_cast<const uint8_t*>(bottom));
  const uint16x8_t down = vmlal_u8(vmull_u8(row0, vdup_laneq_u8(weights, 4 * K + 3)), row1, vdup_laneq_u8(weights, 4 * K + 2));
  return v(vmlal_high_laneq_u16(vmull_laneq_u16(vget_low_u16(down), rest, 2 * K), down, fraction, 2 * K));
}

// fraction: u in the lower half of each lane, v in the upper, of 128.
SPANTEX_INLINE blends blend(const rgba8* top, const uint32_t* top_at, const rgba8* bottom, const uint32_t* bottom_at, v fraction) {
  const uint16x8_t f = uint16x8_t(fraction), rest = vsubq_u16(vdupq_n_u16(128), f);
  const uint8x16_t weights = vreinterpretq_u8_u16(vsliq_n_u16(f, rest, 8));
  return {{blend_one<0>(top + top_at[0], bottom + bottom_at[0], weights, f, rest), blend_one<1>(top + top_at[1], bottom + bottom_at[1], weights, f, rest),
           blend_one<2>(top + top_at[2], bottom + bottom_at[2], weights, f, rest), blend_one<3>(top + top_at[3], bottom + bottom_at[3], weights, f, rest)}};
}

SPANTEX_INLINE v packed(v a, v b, v c, v d) {  // values below 256
  const auto even16 = [](v x, v y) SPANTEX_INLINED { return vuzp1q_u16(uint16x8_t(x), uint16x8_t(y)); };
  return v(vuzp1q_u8(vreinterpretq_u8_u16(even16(a, b)), vreinterpretq_u8_u16(even16(c, d))));
}

SPANTEX_INLINE v texels_at(const rgba8* from, const uint32_t* at) {
  const auto word = [&](int k) SPANTEX_INLINED { return reinterpret_cast<const uint32_t*>(from + at[k]); };
  return v(vld1q_lane_u32(word(3), vld1q_lane_u32(word(2), vld1q_lane_u32(word(1), vld1q_lane_u32(word(0), vdupq_n_u32(0), 0), 1), 2), 3));
}
