// SPDX-License-Identifier: Apache-2.0
// NEON kernel: places of single texels, of maps whose texels a mask wraps: two rows of four pixels as one vector of 16 bits. Included by ../neon.cpp alone.
#pragma once

template <>
class single_texels<true> {
 public:
  SPANTEX_INLINE single_texels(const row_levels& map, const span_positions& p, int fraction)
      : up_(vdupq_n_s32(16 - fraction)), add_u_(added(p.base_u)), add_v_(added(p.base_v)), stride_(vdup_n_u16(uint16_t(map.stride(0)))),
        origin_(vdupq_n_u32(uint32_t(map.value(row_levels::origin, 0)))) {
    const auto mask = uint32_t(map.value(row_levels::mask, 0));
    mask_u_ = vdupq_n_u16(uint16_t(mask));
    mask_v_ = vdupq_n_u16(uint16_t(mask >> 16));
  }

  SPANTEX_INLINE void put_places(const v (&u)[2], const v (&w)[2], int32_t* to) const {
    const uint16x8_t x = vandq_u16(texels(u, add_u_), mask_u_), y = vandq_u16(texels(w, add_v_), mask_v_);
    put(to, v(vmlal_u16(vaddw_u16(origin_, vget_low_u16(x)), vget_low_u16(y), stride_)));
    put(to + width, v(vmlal_high_u16(vaddw_high_u16(origin_, x), y, vcombine_u16(stride_, stride_))));
  }

 private:
  // Where a texel is 2^16; half of a last of coordinate_bits is whole there.
  SPANTEX_INLINE static int32x4_t added(int32_t base) { return vdupq_n_s32(int32_t(uint32_t(base) << (16 - q.coordinate_bits)) + (1 << (16 - q.coordinate_bits - 1))); }
  SPANTEX_INLINE uint16x8_t texels(const v (&x)[2], int32x4_t add) const {
    return uint16x8_t(vaddhn_high_s32(vaddhn_s32(vshlq_s32(int32x4_t(x[0]), up_), add), vshlq_s32(int32x4_t(x[1]), up_), add));
  }

  int32x4_t up_, add_u_, add_v_;
  uint16x8_t mask_u_, mask_v_;
  uint16x4_t stride_;
  uint32x4_t origin_;
};
