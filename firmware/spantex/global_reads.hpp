// SPDX-License-Identifier: Apache-2.0
// How much of global texture memory loading a section reads: the aligned 64-bit words that hold the texels or blocks it needs, each counted
// once a section. A level's storage begins at a word (global_memory.hpp puts it there). A palette is held by the loader: not counted.
//
// Counted from the section's box, not texel by texel, and only by a renderer that asks for it: with uncounted_reads nothing of this is
// compiled in.
#pragma once
#include <stdint.h>

#include <spantex/loader.hpp>

namespace spantex {

struct uncounted_reads { static constexpr bool counted = false; };
struct counted_reads {
  static constexpr bool counted = true;
  constexpr void touch(int) {}   // told of each level before it is read
  uint64_t blocks_decoded = 0;   // of compressed formats, each as often as it is decoded
};

// A map that counts the blocks that it decodes.
class counting_map {
 public:
  constexpr counting_map(const texture_view& map, uint64_t& blocks) : map_(map), blocks_(blocks) {}
  constexpr operator const texture_view&() const { return map_; }
  constexpr texel_format format() const { return map_.format(); }
  constexpr const texture_facts& facts() const { return map_.facts(); }
  constexpr int32_t wrapped_u(int32_t k, int level) const { return map_.wrapped_u(k, level); }
  constexpr int32_t wrapped_v(int32_t k, int level) const { return map_.wrapped_v(k, level); }
  constexpr rgba8 texel(int level, int32_t x, int32_t y) const {
    blocks_ += is_compressed(map_.format());
    return map_.texel(level, x, y);
  }
  // Of an uncompressed map. On a host the format is asked for once a cell, not once a texel.
  constexpr void cell(int level, const int32_t (&x)[2], const int32_t (&y)[2], rgba8 (&out)[4]) const {
    if (map_.format() == texel_format::rgba8888)
      for (int k = 0; k < 4; ++k) out[k] = map_.texel(level, x[k & 1], y[k >> 1]);
    else
      for (int k = 0; k < 4; ++k) out[k] = map_.texel(level, x[k & 1], y[k >> 1]);
  }
  constexpr void decode_block(int level, int32_t bx, int32_t by, texel_block& out) const {
    ++blocks_;
    map_.decode_block(level, bx, by, out);
  }

 private:
  const texture_view& map_;
  uint64_t& blocks_;
};

namespace detail {

// Runs first..last of consecutive indices, ascending, apart from each other.
struct index_runs {
  int count = 0;
  int32_t first[2 * max_blocks], last[2 * max_blocks];
};

// The texels of an axis, or the blocks of 2^unit_log2 texels that they are in.
constexpr index_runs runs_of(const block_range& axis, int unit_log2) {
  int32_t sorted[2 * max_blocks]{};
  int n = 0;
  for (int k = 0; k < axis.count; ++k)
    for (const int32_t texel : axis.texel[k]) {
      const int32_t index = texel >> unit_log2;
      int at = n++;
      for (; at > 0 && sorted[at - 1] > index; --at) sorted[at] = sorted[at - 1];
      sorted[at] = index;
    }
  index_runs r;
  for (int k = 0; k < n; ++k) {
    if (r.count == 0 || sorted[k] > r.last[r.count - 1] + 1) r.first[r.count++] = sorted[k];
    r.last[r.count - 1] = sorted[k];
  }
  return r;
}

}  // namespace detail

// Words that load_section reads for the same arguments.
template <class Prof>
constexpr uint32_t section_reads(const Prof& prof, const texture_view& t, const section& at, const texel_box& box, bool coarse) {
  const texel_format f = t.format();
  static_assert(block_side == 4);
  const int unit = is_compressed(f) ? 2 : 0;
  const uint32_t unit_bits = is_compressed(f) ? 8 * block_bytes(f) : uint32_t(texel_bits(f));
  const uint32_t row_bits = 8 * row_bytes(f, t.width(at.level));
  const detail::index_runs columns = detail::runs_of(detail::columns_of(prof, t, at, box, coarse), unit);
  const detail::index_runs rows = detail::runs_of(detail::rows_of(prof, t, at, box, coarse), unit);
  uint32_t words = 0, next = 0;  // the first word that is not counted yet: rows and columns ascend, so addresses do
  for (int r = 0; r < rows.count; ++r)
    for (int32_t y = rows.first[r]; y <= rows.last[r]; ++y)
      for (int c = 0; c < columns.count; ++c) {
        const uint32_t begin = uint32_t(y) * row_bits + uint32_t(columns.first[c]) * unit_bits;
        const uint32_t end = uint32_t(y) * row_bits + uint32_t(columns.last[c] + 1) * unit_bits;
        const uint32_t first = begin / 64 > next ? begin / 64 : next, past = (end + 63) / 64;
        if (past <= first) continue;
        words += past - first;
        next = past;
      }
  return words;
}

}  // namespace spantex
