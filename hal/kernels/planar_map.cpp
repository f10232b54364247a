// SPDX-License-Identifier: Apache-2.0
#include "planar_map.hpp"

#include <spantex/srgb.hpp>

namespace spantex::kernels {
namespace {

int32_t period(wrap mode, int32_t side) { return mode == wrap::clamp ? 0 : mode == wrap::mirror ? 2 * side : side; }
int32_t length_of(wrap mode, int32_t side) { return mode == wrap::mirror ? 2 * side : side; }
int32_t blocks_of(wrap mode, int32_t side) { return (length_of(mode, side) + block_side - 1) / block_side; }

// Stacks of so many blocks: block 0 is the first of a stack, the apron above lies in the one before.
constexpr int32_t stack_rows = stack_blocks * block_side;
int32_t stacks_of(int32_t blocks) { return 1 + (blocks + apron + stack_blocks - 1) / stack_blocks; }

// Where each texel from -before on lies on the level.
std::vector<int32_t> wrapped(int32_t before, int32_t count, const auto& of) {
  std::vector<int32_t> at(size_t(count), 0);
  for (int32_t k = 0; k < count; ++k) at[size_t(k)] = of(k - before);
  return at;
}

}  // namespace

planar_map::planar_map(const texture_view& view, layout of)
    : width_(view.width()), height_(view.height()), wrap_u_(view.wrap_u()), wrap_v_(view.wrap_v()), period_u_(period(wrap_u_, width_)),
      period_v_(period(wrap_v_, height_)) {
  levels_in_rows_ = row_levels(view, of == layout::rows_and_blocks ? texel_apron : row_apron);
  opaque_ = levels_in_rows_.opaque();
  if (of == layout::rows_and_planes && levels_in_rows_.masks_only() && !levels_in_rows_.linear_light()) planes_ = byte_planes(view, levels_in_rows_.count(), opaque_ ? 3 : 4);
  if (of == layout::rows_and_blocks) add_blocks(view);
}

void planar_map::add_blocks(const texture_view& view) {
  size_t bytes = 0;
  std::vector<size_t> starts;
  for (int k = 0; k < view.level_count(); ++k) {
    starts.push_back(bytes);
    bytes += size_t(blocks_of(wrap_u_, view.width(k)) + 2 * apron) * size_t(stacks_of(blocks_of(wrap_v_, view.height(k)))) * size_t(stack_bytes());
  }
  blocks_.resize(bytes + block_bytes);
  skew_ = (block_bytes - reinterpret_cast<uintptr_t>(blocks_.data()) % block_bytes) % block_bytes;
  for (int k = 0; k < view.level_count(); ++k) add_level(view, k, starts[size_t(k)]);
}

void planar_map::add_level(const texture_view& view, int k, size_t start) {
  const int32_t across = blocks_of(wrap_u_, view.width(k)), down = blocks_of(wrap_v_, view.height(k)), columns = across + 2 * apron, stacks = stacks_of(down);
  const std::vector<int32_t> u = wrapped(texel_apron, columns * block_side, [&](int32_t x) { return view.wrapped_u(x, k); });
  const std::vector<int32_t> v = wrapped(stack_rows, (stacks * stack_blocks + 1) * block_side, [&](int32_t y) { return view.wrapped_v(y, k); });
  uint8_t* at = blocks_.data() + skew_ + start;
  const bool in_light = levels_in_rows_.linear_light();
  const int32_t bytes = stack_bytes();
  for (int32_t stack = 0; stack < stacks; ++stack)
    for (int32_t bx = 0; bx < columns; ++bx, at += bytes)
      for (int n = 0; n < channel_bytes; ++n) {
        const rgba8 t = view.texel(k, u[size_t(bx * block_side + n % block_side)], v[size_t(stack * stack_rows + n / block_side)]);
        const auto put = [&](int plane, uint32_t byte) { at[n + plane * channel_bytes] = uint8_t(byte) ^ 0x80; };
        const uint8_t colours[] = {t.r, t.g, t.b};
        for (int m = 0; m < colour_count; ++m) {
          const uint32_t x = in_light ? srgb_decoded(colours[m]) : colours[m];
          put(m, x);
          if (in_light) put(first_upper_plane + m, x >> 8);
        }
        put(colour_count, t.a);
      }
  levels_.column_bytes[k] = bytes;
  levels_.row_bytes[k] = columns * bytes;
  levels_.origin[k] = int32_t(start) + levels_.row_bytes[k] + apron * bytes;
  levels_.last_column[k] = across + apron - 1;
  levels_.last_row[k] = down + apron - 1;
  levels_.period_u[k] = period(wrap_u_, view.width(k));
  levels_.period_v[k] = period(wrap_v_, view.height(k));
  const auto ratio = [](uint32_t r) { return int32_t(r >> 31 != 0 ? r >> 1 : r); };
  levels_.ratio_u[k] = ratio(view.ratio_u(k));
  levels_.ratio_v[k] = ratio(view.ratio_v(k));
}

}  // namespace spantex::kernels
