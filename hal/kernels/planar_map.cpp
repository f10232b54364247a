// SPDX-License-Identifier: Apache-2.0
#include "planar_map.hpp"

namespace spantex::kernels {
namespace {

int32_t period(wrap mode, int32_t side) { return mode == wrap::clamp ? 0 : mode == wrap::mirror ? 2 * side : side; }

int32_t blocks_of(wrap mode, int32_t side) {
  const int32_t length = mode == wrap::mirror ? 2 * side : side;
  return (length + block_side - 1) / block_side;
}

}  // namespace

planar_map::planar_map(const texture_view& view)
    : width_(view.width()), height_(view.height()), wrap_u_(view.wrap_u()), wrap_v_(view.wrap_v()), period_u_(period(wrap_u_, width_)),
      period_v_(period(wrap_v_, height_)) {
  level0_.reserve(size_t(width_) * size_t(height_));
  for (int32_t y = 0; y < height_; ++y)
    for (int32_t x = 0; x < width_; ++x) level0_.push_back(view.texel(0, x, y));
  constexpr uint32_t exact = uint32_t(1) << 31;
  for (int k = 0; k < view.level_count(); ++k) {
    if (view.ratio_u(k) != exact || view.ratio_v(k) != exact) break;
    const int32_t across = blocks_of(view.wrap_u(), view.width(k)), down = blocks_of(view.wrap_v(), view.height(k));
    const int32_t columns = across + 2 * apron, rows = down + 2 * apron;
    std::vector<uint8_t> bytes(size_t(columns) * size_t(rows) * block_bytes + block_channel_bytes);
    const size_t skew = (block_channel_bytes - reinterpret_cast<uintptr_t>(bytes.data()) % block_channel_bytes) % block_channel_bytes;
    uint8_t* const first = bytes.data() + skew;
    for (int32_t by = 0; by < rows; ++by)
      for (int32_t bx = 0; bx < columns; ++bx)
        for (int n = 0; n < block_side * block_side; ++n) {
          const int32_t u = (bx - apron) * block_side + n % block_side, v = (by - apron) * block_side + n / block_side;
          const rgba8 t = view.texel(k, view.wrapped_u(u, k), view.wrapped_v(v, k));
          uint8_t* const at = first + (size_t(by) * size_t(columns) + size_t(bx)) * block_bytes + n;
          at[0] = t.r ^ 0x80;
          at[64] = t.g ^ 0x80;
          at[128] = t.b ^ 0x80;
          at[192] = t.a ^ 0x80;
        }
    planar_level level;
    level.stride = columns * block_bytes;
    level.origin = first + int64_t(apron) * level.stride + apron * block_bytes;
    level.last_column = across + apron - 1;
    level.last_row = down + apron - 1;
    storage_.push_back(std::move(bytes));
    levels_.push_back(level);
  }
}

}  // namespace spantex::kernels
