// SPDX-License-Identifier: Apache-2.0
// Local texture memory of one half as rows of texels, for loaders that copy and do not pack (a DMA channel): the same texels at the same
// places of the same torus as local_memory.hpp, and the same words out of a fetch, but a texel's four channels side by side:
//
//   index of (x, y) = y side + x for the finer level, Fine Fine + y (side / 2) + x for the coarser one
#pragma once
#include <stdint.h>

#include <spantex/local_memory.hpp>
#include <spantex/span.hpp>
#include <spantex/status.hpp>

namespace spantex {

template <int Fine>
class texel_memory {
 public:
  static constexpr int fine_side = Fine, coarse_side = Fine / 2;
  static constexpr int coarse_first_texel = fine_side * fine_side;
  static constexpr int texel_count = coarse_first_texel + coarse_side * coarse_side;
  static constexpr int word_count = local_memory<Fine>::word_count;

  static constexpr bool holds(int first, int count) { return first >= 0 && count >= 0 && first <= texel_count && count <= texel_count - first; }

  // For whoever fills it: texel_count of them.
  constexpr rgba8* texels() { return texels_; }

  // Load words, as the loader packs them. Errors: bad_address.
  constexpr status load(int first, const uint64_t* words, int count) {
    if (first < 0 || count < 0 || first > word_count || count > word_count - first) return status::bad_address;
    for (int k = 0; k < count; ++k) store(first + k, words[k]);
    return status::ok;
  }

  template <class Observer>
  constexpr fetched fetch(int channel, local_position fine, local_position coarse, const Observer& observer) const {
    observer.fetch_begin();
    return {uint64_t(read<coarse_side>(texels_ + coarse_first_texel, channel, coarse)) << 32 | read<fine_side>(texels_, channel, fine)};
  }

 private:
  static constexpr uint32_t value(rgba8 t, int channel) {
    return (t.r | uint32_t(t.g) << 8 | uint32_t(t.b) << 16 | uint32_t(t.a) << 24) >> (8 * channel) & 0xFF;
  }

  template <int Side>
  static constexpr uint32_t read(const rgba8* level, int channel, local_position at) {
    const int x1 = (at.x + 1) & (Side - 1);
    const rgba8* const above = level + at.y * Side;
    const rgba8* const below = level + ((at.y + 1) & (Side - 1)) * Side;
    return value(above[at.x], channel) | value(above[x1], channel) << 8 | value(below[at.x], channel) << 16 | value(below[x1], channel) << 24;
  }

  constexpr void store(int address, uint64_t word) {
    const bool coarse = address >= local_memory<Fine>::coarse_first_word;
    const int side = coarse ? coarse_side : fine_side;
    const int block = (coarse ? address - local_memory<Fine>::coarse_first_word : address) >> 1;
    rgba8* const corner = texels_ + (coarse ? coarse_first_texel : 0) + block / (side / 2) * 2 * side + block % (side / 2) * 2;
    for (int k = 0; k < 4; ++k) {
      rgba8& t = corner[(k >> 1) * side + (k & 1)];
      const uint8_t low = uint8_t(word >> (8 * k)), high = uint8_t(word >> (32 + 8 * k));
      if ((address & 1) == 0) t.r = low, t.g = high;
      else t.b = low, t.a = high;
    }
  }

  alignas(4) rgba8 texels_[texel_count] = {};  // a DMA channel moves words
};

}  // namespace spantex
