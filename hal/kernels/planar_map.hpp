// SPDX-License-Identifier: Apache-2.0
// A map as the host kernels read it: local texture memory's layout made ready, so that filling it is a load a block. Each level is cut into
// blocks of 8x8 texels, 64 bytes a channel, so that one 512-bit register is one channel of one block and a byte permute is 64 of the papers' banked
// fetches. Blocks below each other are a stack: channel by channel eight of them and the next one again, so that any eight rows are 64 bytes, wherever they begin. Levels are there a second time, row by row, for filters that take single texels and planes of which a
// row of pixels lies in one row of texels.
// Around a level lies an apron with what the wrap mode says lies there.
#pragma once
#include <stddef.h>
#include <stdint.h>

#include <vector>

#include <spantex/texture.hpp>
#include "byte_planes.hpp"
#include "row_levels.hpp"

namespace spantex::kernels {

inline constexpr int block_side = 8, block_bytes = 64;     // of one channel
inline constexpr int stack_log2 = 3, stack_blocks = 1 << stack_log2, channel_bytes = (stack_blocks + 1) * block_bytes;
inline constexpr int colour_count = 3, first_upper_plane = colour_count + 1;  // planes: red, green, blue, alpha; of sRGB maps the lower bytes of the colours' numbers, and after alpha their upper ones
inline constexpr int apron = 2;                           // blocks on every side of a level
inline constexpr int texel_apron = apron * block_side;    // texels on every side of the rows
inline constexpr int max_planar_levels = 16;              // as many as one register of 32-bit lanes numbers

// The blocks of all levels, a lane each: what a section's address is made of.
struct alignas(64) planar_levels {
  int32_t origin[max_planar_levels] = {};                 // of block (0, 0), texels 0..7 of rows 0..7, in bytes from planar_map::blocks()
  int32_t column_bytes[max_planar_levels] = {}, row_bytes[max_planar_levels] = {};     // from one stack to the next
  int32_t last_column[max_planar_levels] = {}, last_row[max_planar_levels] = {};       // blocks from -apron to these hold something
  int32_t period_u[max_planar_levels] = {}, period_v[max_planar_levels] = {};          // texels repeat so; 0 for clamp
  int32_t ratio_u[max_planar_levels] = {}, ratio_v[max_planar_levels] = {};            // texture_view::ratio_u(); 1, which is 2^31, as 2^30
};

// What a kernel reads: all levels in rows; and of maps whose axes wrap at powers of two, planes of bytes; or blocks, and a wide apron around the rows. Of sRGB maps no planes.
enum class layout : uint8_t { rows, rows_and_planes, rows_and_blocks };

// A period is what positions may be taken modulo: the side, twice the side for mirror; 0 for clamp, where blocks are clamped instead.
class planar_map {
 public:
  explicit planar_map(const texture_view& view, layout of = layout::rows);
  planar_map(planar_map&&) = default;  // and no copy: the blocks are aligned where they are
  const planar_levels& levels() const { return levels_; }    // where there are blocks
  const uint8_t* blocks() const { return blocks_.data() + skew_; }  // 64-byte aligned; values are texels ^ 0x80, signed bytes (of sRGB maps bytes of linear numbers); none but for layout::rows_and_blocks
  const rgba8* row(int32_t y) const { return levels_in_rows_.row(0, y); }  // of level 0; layout::rows_and_blocks: x and y from -texel_apron
  const row_levels& levels_in_rows() const { return levels_in_rows_; }
  const byte_planes& planes() const { return planes_; }   // empty but for layout::rows_and_planes of coded maps
  bool opaque() const { return opaque_; }                 // every texel of every level that is held has alpha 255
  int32_t row_stride() const { return levels_in_rows_.stride(0); }
  int32_t rows_across() const { return levels_in_rows_.columns(0); }
  int32_t rows_down() const { return levels_in_rows_.rows(0); }
  int32_t width() const { return width_; }
  int32_t height() const { return height_; }
  wrap wrap_u() const { return wrap_u_; }
  wrap wrap_v() const { return wrap_v_; }
  int32_t period_u() const { return period_u_; }
  int32_t period_v() const { return period_v_; }

 private:
  void add_blocks(const texture_view& view);
  void add_level(const texture_view& view, int k, size_t at);
  int32_t stack_bytes() const { return (levels_in_rows_.linear_light() ? first_upper_plane + colour_count : first_upper_plane) * channel_bytes; }
  planar_levels levels_;
  std::vector<uint8_t> blocks_;
  size_t skew_ = 0;
  row_levels levels_in_rows_;
  byte_planes planes_;
  bool opaque_ = true;
  int32_t width_, height_;
  wrap wrap_u_, wrap_v_;
  int32_t period_u_, period_v_;
};

}  // namespace spantex::kernels
