// SPDX-License-Identifier: Apache-2.0
// A plane and its map in a file, from the machine that judges to the one that draws: this, then of each level its two sides and RGBA8888. Both are little-endian.
#pragma once
#include <stdint.h>

namespace spantex::arm64 {

struct task_header {
  int32_t width, height, level_count, unused;
  double matrix[9];  // peer.hpp
};

}  // namespace spantex::arm64
