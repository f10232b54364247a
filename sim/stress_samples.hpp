// SPDX-License-Identifier: Apache-2.0
// What the stress run samples: maps of every size, random texels as a fetch delivers them, and their exact blend.
#pragma once
#include <spantex/filter.hpp>
#include <spantex/local_memory.hpp>
#include <spantex/texture.hpp>

#include <algorithm>
#include <cstdlib>

#include "sim/random.hpp"

namespace spantex::sim {

// A map of sides 1..4096, powers of two and others, and a level of it, on which a span's positions are snapped.
struct stress_map {
  explicit stress_map(uint64_t seed) {
    random_source r(seed);
    const auto side = [&] {
      const int bits = int(r.below(13));
      return r.below(2) ? 1 << bits : 1 + int32_t(r.below(1u << bits));
    };
    static const rgba8 unread{};
    const rgba8* levels[max_levels];
    for (const rgba8*& p : levels) p = &unread;
    const int32_t width = side(), height = r.below(8) == 0 ? width : side();
    const int count = bit_length(uint64_t(std::max(width, height)));
    if (texture_view::make(levels, count, width, height, wrap::repeat, wrap::repeat, view) != status::ok) std::abort();
    level = int(r.below(uint32_t(count)));
  }
  texture_view view;
  int level;
};

// What the filter reads: the four texels of each level and channel, as the fetch delivers them.
struct four_texel_memory {
  static constexpr int fine_side = 32, coarse_side = 16;
  uint64_t words[channel_count];
  template <class Observer>
  fetched fetch(int channel, local_position, local_position, const Observer&) const {
    return {words[channel]};
  }
};

inline four_texel_memory random_texels(random_source& r) {
  four_texel_memory m{};
  for (uint64_t& word : m.words) {
    word = r.next();
    if (r.below(2)) word = ((word >> 7) & 0x0101010101010101u) * 255;  // black or white
  }
  return m;
}

// Four bytes blended exactly, times 2^(2 bits).
inline int64_t exact_blend(uint32_t texels, weights w, int bits, bool three) {
  const auto t = [&](int k) { return int64_t((texels >> (8 * k)) & 255); };
  const int64_t one = int64_t(1) << bits, x = w.u, y = w.v;
  if (!three) return (one - y) * ((one - x) * t(0) + x * t(1)) + y * ((one - x) * t(2) + x * t(3));
  const int64_t plane_through =
      y >= x ? one * t(0) + y * (t(2) - t(0)) + x * (t(3) - t(2)) : one * t(0) + x * (t(1) - t(0)) + y * (t(3) - t(1));
  return plane_through * one;
}

}  // namespace spantex::sim
