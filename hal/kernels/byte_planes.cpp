// SPDX-License-Identifier: Apache-2.0
#include "byte_planes.hpp"

namespace spantex::kernels {

byte_planes::byte_planes(const texture_view& view, int levels, int channels) {
  constexpr uint8_t rgba8::*members[] = {&rgba8::r, &rgba8::g, &rgba8::b, &rgba8::a};
  for (int k = 0; k < levels; ++k) {
    const auto period = [](wrap mode, int32_t side) { return mode == wrap::mirror ? 2 * side : side; };
    const int32_t across = period(view.wrap_u(), view.width(k)), down = period(view.wrap_v(), view.height(k)), strips = (across + strip_pitch - 1) / strip_pitch, rows = down + table_side;
    const int32_t strip = rows * table_side;
    levels_.push_back({values_.size(), strip, strips * strip, across - 1, down - 1});
    values_.reserve(values_.size() + size_t(channels) * size_t(strips) * size_t(strip));
    for (int m = 0; m < channels; ++m)
      for (int32_t n = 0; n < strips; ++n)
        for (int32_t y = 0; y < rows; ++y) {
          const int32_t v = view.wrapped_v(y, k);
          for (int32_t x = 0; x < table_side; ++x) values_.push_back(view.texel(k, view.wrapped_u(n * strip_pitch + x, k), v).*members[m]);
        }
  }
}

}  // namespace spantex::kernels
