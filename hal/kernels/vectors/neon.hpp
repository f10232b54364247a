// SPDX-License-Identifier: Apache-2.0
// Vector kernels: what NEON (arm64) has no operator for. Included by ../neon.cpp alone.
#pragma once

constexpr bool places_first = false, moves_texels = true, spares_levels = false;
constexpr int row_pairs_at_once = 1;  // of positions with levels

typedef int16_t level_number;  // of a pixel, in memory
SPANTEX_INLINE v get(const level_number* from) { return v(vmovl_s16(vld1_s16(from))); }
SPANTEX_INLINE void put(level_number* to, v x) { vst1_s16(to, vmovn_s32(int32x4_t(x))); }

// put_details() of positions.hpp; nothing is below 0, which is where the least level is.
SPANTEX_INLINE void put_details(level_number* to, v upper, v lower, int32_t most) {
  const int32x4_t a = int32x4_t(upper), b = int32x4_t(lower);
  const uint16x8_t whole = vqrshrun_high_n_s32(vqrshrun_n_s32(a, 8), b, 8);
  const uint16x8_t level = vmaxq_u16(vminq_u16(whole, vdupq_n_u16(80)), vqsubq_u16(whole, vdupq_n_u16(128)));
  vst1q_s16(to, int16x8_t(vminq_u16(level, vdupq_n_u16(uint16_t(most)))));
}

SPANTEX_INLINE v products(v a, v b) {  // of both halves of a lane, added up
  const int16x8_t x = int16x8_t(a), y = int16x8_t(b);
  return v(vpaddq_s32(vmull_s16(vget_low_s16(x), vget_low_s16(y)), vmull_high_s16(x, y)));
}
SPANTEX_INLINE v add_products(v c, v a, v b) { return c + products(a, b); }
SPANTEX_INLINE v halves(v low, v high) { return v(vbslq_s32(vdupq_n_u32(0xFFFF), int32x4_t(low), int32x4_t(high))); }
SPANTEX_INLINE v rounded_shift(v x, int shift) { return v(vrshlq_s32(int32x4_t(x), vdupq_n_s32(-shift))); }  // to nearest, halves up
SPANTEX_INLINE v_32 rounded_shift(v_32 x, int shift) { return v_32(vrshlq_u32(uint32x4_t(x), vdupq_n_s32(-shift))); }

// The numbers of the series (coordinates.hpp: series_number), shifted up by 17 + slope_log2: the upper half of a doubled product is then that of words.hpp.
SPANTEX_INLINE v number(v x, int slope_log2) { return x & -(1 << (17 + slope_log2)); }
SPANTEX_INLINE v upper_products(v a, v b) { return v(vqdmulhq_s32(int32x4_t(a), int32x4_t(b))); }  // (2 a b) >> 32
SPANTEX_INLINE v slope_lanes(v twice_e, int slope_log2) { return number(twice_e, slope_log2); }
SPANTEX_INLINE v slope_product(v a, v b, int slope_log2) { return number(upper_products(a, b), slope_log2); }
SPANTEX_INLINE v half_slope_square(v a, int slope_log2) { return number(upper_products(a, a >> 1), slope_log2); }
SPANTEX_INLINE v product_with_slope(v x, v slope, int) { return upper_products(x & int32_t(0xFFFF0000), slope); }
SPANTEX_INLINE v level_of_slope(v slope, int) { return upper_products(slope, set(int32_t(level_factor.raw()) << 3)); }
SPANTEX_INLINE v small_products(v a, v b) { return a * b; }  // of numbers from 0 to 2^15 - 1

SPANTEX_INLINE bool all_equal(v a, int32_t b) { return vminvq_u32(uint32x4_t(a == b)) != 0; }

// 64-bit lanes; a product's shift is 1 or more and rounds halves up.
SPANTEX_INLINE v_s64 size_of(v_s64 x) { return v_s64(vabsq_s64(int64x2_t(x))); }
SPANTEX_INLINE v_64 rounded_shift(v_64 x, v_64 shift) { return v_64(vrshlq_u64(uint64x2_t(x), vnegq_s64(int64x2_t(shift)))); }
SPANTEX_INLINE v_s64 bit_lengths(v_s64 x) {  // leading zeros of the upper half and, where that is 0, of the lower
  const uint32x4_t zeros = vclzq_u32(uint32x4_t(x));
  const uint64x2_t of_lower = vandq_u64(uint64x2_t(zeros), vshrq_n_u64(uint64x2_t(vceqq_u32(zeros, vdupq_n_u32(32))), 32));
  return 64 - v_s64(vsraq_n_u64(of_lower, uint64x2_t(zeros), 32));
}
SPANTEX_INLINE uint32_t signs_of(v_s64 x) { return uint32_t(x[0] < 0) | uint32_t(x[1] < 0) << 1; }
// The lower half of 128-bit numbers shifted down by as many bits, 0 to 127. What is shifted by more than a lane has is 0; by fewer bits than none, the other way.
SPANTEX_INLINE v_64 low_after(v_64 low, v_64 high, v_64 n) {
  return v_64(vorrq_u64(vshlq_u64(uint64x2_t(low), -int64x2_t(n)), vshlq_u64(uint64x2_t(high), 64 - int64x2_t(n))));
}

// Of the even lanes.
SPANTEX_INLINE v_64 wide_products(v_64 a, v_64 b) { return v_64(vmull_u32(vmovn_u64(uint64x2_t(a)), vmovn_u64(uint64x2_t(b)))); }
SPANTEX_INLINE v_64 wide_signed_products(v_64 a, v_64 b) { return v_64(vmull_s32(vmovn_s64(int64x2_t(a)), vmovn_s64(int64x2_t(b)))); }
SPANTEX_INLINE v look_up(const int32_t* table, v at) { return v{table[at[0]], table[at[1]], table[at[2]], table[at[3]]}; }

// slopes_of() of levels.hpp, u and v side by side.
SPANTEX_INLINE span_slopes slopes_of(const span_coefficients& c) {
  static_assert(offsetof(span_coefficients, b_v) - offsetof(span_coefficients, c_u) == 5 * sizeof(int32_t) && offsetof(span_coefficients, h) - offsetof(span_coefficients, g) == sizeof(int32_t));
  const char* const from = reinterpret_cast<const char*>(&c);
  const int32x2x3_t of = vld3_s32(reinterpret_cast<const int32_t*>(from + offsetof(span_coefficients, c_u)));  // c, a, b
  const int32x2_t slope = vld1_s32(reinterpret_cast<const int32_t*>(from + offsetof(span_coefficients, g)));
  const auto rounded = [](int64x2_t product) SPANTEX_INLINED { return vrshrn_n_s64(vsraq_n_s64(product, product, 63), q.reciprocal_bits); };
  const int32x2_t row = vsub_s32(of.val[1], rounded(vmull_lane_s32(of.val[0], slope, 0))), column = vsub_s32(of.val[2], rounded(vmull_lane_s32(of.val[0], slope, 1)));
  const int32x2_t twist = vsub_s32(rounded(vmull_lane_s32(of.val[1], slope, 1)), rounded(vmull_lane_s32(of.val[2], slope, 0)));
  return {v(vdupq_lane_s32(row, 0)), v(vdupq_lane_s32(row, 1)), v(vdupq_lane_s32(column, 0)), v(vdupq_lane_s32(column, 1)), v(vdupq_lane_s32(twist, 0)), v(vdupq_lane_s32(twist, 1))};
}

SPANTEX_INLINE void put_words(int16_t* to, v x) { vst1_s16(to, vqmovn_s32(int32x4_t(x))); }  // saturated

SPANTEX_INLINE v rounding_products(v a, v b) { return v(vqrdmulhq_s16(int16x8_t(a), int16x8_t(b))); }  // (a b + 2^14) >> 15
SPANTEX_INLINE v low_products(v a, v b) { return v(vmulq_s16(int16x8_t(a), int16x8_t(b))); }
SPANTEX_INLINE v upper_products16(v a, v b) {  // unsigned
  const uint16x8_t x = uint16x8_t(a), y = uint16x8_t(b);
  return v(vuzp2q_u16(uint16x8_t(vmull_u16(vget_low_u16(x), vget_low_u16(y))), uint16x8_t(vmull_high_u16(x, y))));
}

// The lower half of lanes 2 k and 2 k + 1, four times each.
SPANTEX_INLINE v low_words(v x, int k) {
  const uint8x16_t first = {0, 1, 0, 1, 0, 1, 0, 1, 4, 5, 4, 5, 4, 5, 4, 5};
  return v(vqtbl1q_u8(uint8x16_t(x), vaddq_u8(first, vdupq_n_u8(uint8_t(8 * k)))));
}

// Two columns of texels, interpolated down: pixels 2 k and 2 k + 1 in register k, a channel a word. change is from the first to the second, weight f of 2^15.
struct blends { v first[2], change[2], weight[2]; };
SPANTEX_INLINE v from_first(v x, v first) { return add16(x, first); }

// weights: bytes f and 128 - f of u, then of v, a lane a pixel.
template <int K>
SPANTEX_INLINE uint64x2_t columns_of(const uint8_t* top, const uint8_t* bottom, uint8x16_t weights) {
  return uint64x2_t(vmlal_u8(vmull_u8(vld1_u8(top), vdup_laneq_u8(weights, 4 * K + 3)), vld1_u8(bottom), vdup_laneq_u8(weights, 4 * K + 2)));
}
SPANTEX_INLINE void put_columns(blends& b, int k, uint64x2_t one, uint64x2_t other) {
  b.first[k] = v(vzip1q_u64(one, other));
  b.change[k] = subtract16(v(vzip2q_u64(one, other)), b.first[k]);
}

// fraction: u in the lower half of each lane, v in the upper, of 128.
SPANTEX_INLINE blends blend(const rgba8* top, const uint32_t* top_at, const rgba8* bottom, const uint32_t* bottom_at, v fraction) {
  const uint16x8_t f = uint16x8_t(fraction);
  const uint8x16_t weights = vreinterpretq_u8_u16(vsliq_n_u16(f, vsubq_u16(vdupq_n_u16(128), f), 8));
  const v of_u = fraction << (15 - q.subtexel_bits);
  const v_32 upper = v_32(get(reinterpret_cast<const int32_t*>(top_at))) * sizeof(rgba8), lower = v_32(get(reinterpret_cast<const int32_t*>(bottom_at))) * sizeof(rgba8);
  const uint8_t *const row0 = reinterpret_cast<const uint8_t*>(top), *const row1 = reinterpret_cast<const uint8_t*>(bottom);
  blends b;
  put_columns(b, 0, columns_of<0>(row0 + upper[0], row1 + lower[0], weights), columns_of<1>(row0 + upper[1], row1 + lower[1], weights));
  put_columns(b, 1, columns_of<2>(row0 + upper[2], row1 + lower[2], weights), columns_of<3>(row0 + upper[3], row1 + lower[3], weights));
  b.weight[0] = low_words(of_u, 0);
  b.weight[1] = low_words(of_u, 1);
  return b;
}

SPANTEX_INLINE v packed(v a, v b) { return v(vuzp1q_u8(uint8x16_t(a), uint8x16_t(b))); }  // values below 256

SPANTEX_INLINE v texels_at(const rgba8* from, const uint32_t* at) {
  const auto word = [&](int k) SPANTEX_INLINED { return reinterpret_cast<const uint32_t*>(from + at[k]); };
  return v(vld1q_lane_u32(word(3), vld1q_lane_u32(word(2), vld1q_lane_u32(word(1), vld1q_lane_u32(word(0), vdupq_n_u32(0), 0), 1), 2), 3));
}
