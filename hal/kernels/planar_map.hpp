// SPDX-License-Identifier: Apache-2.0
// A map as the host kernels read it: local texture memory's layout made ready, so that filling it is a load a block. Each level is cut into
// blocks of 8x8 texels; a block holds its four channels one after another, 64 bytes each, so that one 512-bit register is one channel of one
// block and a byte permute is 64 of the papers' banked fetches. Around the level lie blocks with what the wrap mode says lies there.
#pragma once
#include <stddef.h>
#include <stdint.h>

#include <vector>

#include <spantex/texture.hpp>

namespace spantex::kernels {

inline constexpr int block_side = 8, block_channel_bytes = 64, block_bytes = 4 * block_channel_bytes;
inline constexpr int apron = 2;  // blocks on every side of a level

struct planar_level {
  const uint8_t* origin = nullptr;  // block (0, 0): texels 0..7 of rows 0..7; values are texels ^ 0x80, signed bytes
  int32_t stride = 0;               // bytes from one row of blocks to the next
  int32_t last_column = 0, last_row = 0;  // blocks from -apron to these hold something
  const uint8_t* block(int32_t bx, int32_t by) const { return origin + int64_t(by) * stride + int64_t(bx) * block_bytes; }
};

// Levels whose sides halve exactly from level 0, in any wrap mode. A period is what positions may be taken modulo: the side, twice the side for
// mirror; 0 for clamp, where blocks are clamped instead.
class planar_map {
 public:
  explicit planar_map(const texture_view& view);
  const planar_level& level(int k) const { return levels_[size_t(k)]; }
  int level_count() const { return int(levels_.size()); }  // from 0 on, as many as halve exactly
  const rgba8* level0() const { return level0_.data(); }  // rows from the top, as they are
  int32_t width() const { return width_; }
  int32_t height() const { return height_; }
  wrap wrap_u() const { return wrap_u_; }
  wrap wrap_v() const { return wrap_v_; }
  int32_t period_u() const { return period_u_; }
  int32_t period_v() const { return period_v_; }

 private:
  std::vector<std::vector<uint8_t>> storage_;
  std::vector<planar_level> levels_;
  std::vector<rgba8> level0_;
  int32_t width_, height_;
  wrap wrap_u_, wrap_v_;
  int32_t period_u_, period_v_;
};

}  // namespace spantex::kernels
