// SPDX-License-Identifier: Apache-2.0
// A map as kernels read it that look texels up in tables: each level as strips of sixteen columns of bytes, a channel each, so that sixteen by four texels
// are 64 bytes in a row, from any row on. A strip begins every eight columns: each column is in two of them. Axes repeat or mirror after a power of two; a
// mirrored one is stored to its period, opaque maps have no alpha, and behind the last row come as many more as a table has.
#pragma once
#include <stddef.h>
#include <stdint.h>

#include <vector>

#include <spantex/texture.hpp>

namespace spantex::kernels {

class byte_planes {
 public:
  static constexpr int table_side = 16, strip_pitch = 8;  // texels

  struct level {
    size_t first;            // red of texel (0, 0), in bytes from values()
    int32_t strip;           // from a strip to the next
    int32_t channel;         // from a channel to the next
    int32_t mask_u, mask_v;  // what texels are taken modulo
  };

  byte_planes() = default;
  byte_planes(const texture_view& view, int levels, int channels);
  int count() const { return int(levels_.size()); }
  const level& at(int k) const { return levels_[size_t(k)]; }
  const uint8_t* values() const { return values_.data(); }

 private:
  std::vector<level> levels_;
  std::vector<uint8_t> values_;
};

}  // namespace spantex::kernels
