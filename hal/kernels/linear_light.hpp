// SPDX-License-Identifier: Apache-2.0
// Kernels: sRGB maps, filtered in linear light (docs/SPEC.md).
#pragma once
#include <stdint.h>

#include <spantex/srgb.hpp>
#include "kernel.hpp"

namespace spantex::kernels {

// srgb_encoded() by one look-up: thresholds lie at least 16 apart, so that of x's neighbours with the same upper 12 bits one at most takes the next code. step[x >> 4] is 16 times the first
// one's code, and 16 less what has the next one added, if any: the code is (step[x >> 4] + (x & 15)) >> 4.
struct srgb_steps {
  uint16_t step[4096];
  constexpr srgb_steps() : step() {
    uint32_t code = 0;
    for (uint32_t k = 0; k < 4096; ++k) {
      const auto below = [&](uint32_t x) { return code == 255 || 2 * x < srgb_decoded(code) + srgb_decoded(code + 1); };
      uint32_t same = 0;
      while (same < 16 && below(16 * k + same)) ++same;
      step[k] = uint16_t(16 * code + 16 - same);
      code += same < 16;
    }
  }
};
inline constexpr srgb_steps srgb_code_of;

// One machine's, of filters that blend.
extern const row_kernels words_linear_light, sse41_linear_light, avx2_linear_light, avx512_linear_light, neon_linear_light;

}  // namespace spantex::kernels
