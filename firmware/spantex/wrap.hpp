// SPDX-License-Identifier: Apache-2.0
// Wrap modes: from any texel index to one inside [0, size). Applied by the loader, so that local memory and everything below
// see neighbours side by side and no seam exists to be treated.
#pragma once
#include <stdint.h>

namespace spantex {

enum class wrap : uint8_t { repeat, clamp, mirror };

// size in [1, 4096]; index any int32_t within +-2^30.
constexpr int32_t wrapped(wrap mode, int32_t index, int32_t size) {
  if (uint32_t(index) < uint32_t(size)) return index;
  if (mode == wrap::clamp) return index < 0 ? 0 : size - 1;
  const int32_t period = mode == wrap::mirror ? 2 * size : size;
  int32_t k = (period & (period - 1)) == 0 ? index & (period - 1) : index % period;
  if (k < 0) k += period;
  return k < size ? k : period - 1 - k;
}

}  // namespace spantex
