// SPDX-License-Identifier: Apache-2.0
// Numbers that look random and are the same on every target (xorshift).
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>

namespace spantex::app {

SPANTEX_WRAPS inline uint32_t random_number() {
  static uint32_t seed = 1;
  seed ^= seed << 13;
  seed ^= seed >> 17;
  return seed ^= seed << 5;
}
inline int32_t between(int32_t low, int32_t high) { return low + int32_t(random_number() % uint32_t(high - low + 1)); }

}  // namespace spantex::app
