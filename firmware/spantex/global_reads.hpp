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
struct counted_reads { static constexpr bool counted = true; };

namespace detail {

// Runs first..last of consecutive indices, ascending, apart from each other.
struct index_runs {
  int count = 0;
  int32_t first[2 * max_blocks], last[2 * max_blocks];
};

// The texels of an axis, or the blocks of `unit` texels that they are in.
constexpr index_runs runs_of(const block_range& axis, int32_t unit) {
  int32_t sorted[2 * max_blocks]{};
  int n = 0;
  for (int k = 0; k < axis.count; ++k)
    for (const int32_t texel : axis.texel[k]) {
      int at = n++;
      for (; at > 0 && sorted[at - 1] > texel / unit; --at) sorted[at] = sorted[at - 1];
      sorted[at] = texel / unit;
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
  const int32_t unit = is_compressed(f) ? block_side : 1;
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
