// SPDX-License-Identifier: Apache-2.0
// The loader: texels of a map section in any format, wrapped, packed into the 64-bit words of local memory (local_memory.hpp tells the
// layout).
#pragma once
#include <stdint.h>

#include <spantex/local_memory.hpp>
#include <spantex/plan.hpp>
#include <spantex/texture.hpp>

namespace spantex {

// Two load words for one aligned 2x2 of texels: channels R, G and channels B, A.
struct block_words { uint64_t red_green, blue_alpha; };

constexpr block_words pack_block(const rgba8 (&t)[4]) {
  block_words w{};
  for (int k = 0; k < 4; ++k) {
    w.red_green |= uint64_t(t[k].r) << (8 * k) | uint64_t(t[k].g) << (32 + 8 * k);
    w.blue_alpha |= uint64_t(t[k].b) << (8 * k) | uint64_t(t[k].a) << (32 + 8 * k);
  }
  return w;
}

inline constexpr int max_blocks = 16;  // 2x2 blocks along a side of the largest local memory

namespace detail {

// One axis of a section: which blocks of local memory hold the texels low..high, and which texels those blocks hold.
struct block_range {
  int first, count;                    // blocks first, first + 1, ... modulo the blocks of a side
  int32_t texel[max_blocks][2];        // wrapped; [k]: of the k-th of these blocks
};

template <class Wrap>
constexpr block_range blocks_of(int32_t low, int32_t high, int32_t origin, int side, Wrap wrapped) {
  const int32_t first = low >> 1;
  block_range r{int(first & (side / 2 - 1)), min_of(side / 2, int((high >> 1) - first + 1)), {}};
  for (int k = 0; k < r.count; ++k)
    for (int half = 0; half < 2; ++half) {
      int32_t t = 2 * (first + k) + half;
      if (t < origin) t += side;       // the section holds this cell's texel at its far end
      r.texel[k][half] = wrapped(t);
    }
  return r;
}

// One axis of a section on a map: `low` to `high` wrapped.
template <class Prof>
constexpr block_range columns_of(const Prof& prof, const texture_view& t, const section& at, const texel_box& box, bool coarse) {
  const int side = coarse ? prof.get().coarse_side() : prof.get().fine_side;
  return blocks_of(box.u0, box.u1, at.origin_u, side, [&](int32_t k) { return t.wrapped_u(k, at.level); });
}
template <class Prof>
constexpr block_range rows_of(const Prof& prof, const texture_view& t, const section& at, const texel_box& box, bool coarse) {
  const int side = coarse ? prof.get().coarse_side() : prof.get().fine_side;
  return blocks_of(box.v0, box.v1, at.origin_v, side, [&](int32_t k) { return t.wrapped_v(k, at.level); });
}

// Cells of 2x2 texels of one level. Of a compressed format it keeps the last block decoded, 64 bytes: a cell mostly lies within one block, and cells come
// along rows of blocks, so a block is decoded once for two rows of texels. Where a cell is cut (ends of a section that share a word through the torus,
// wrapped edges), its texels are read block after block, the held one first.
template <class Map>
class cell_reader {
 public:
  constexpr cell_reader(const Map& t, int level) : map_(t), level_(level), compressed_(is_compressed(t.format())) {}

  // (x0, y0) (x1, y0) (x0, y1) (x1, y1), wrapped.
  constexpr void cell(const int32_t (&x)[2], const int32_t (&y)[2], rgba8 (&out)[4]) {
    if (!compressed_) {
      if constexpr (requires { map_.cell(level_, x, y, out); }) return map_.cell(level_, x, y, out);
      for (int k = 0; k < 4; ++k) out[k] = map_.texel(level_, x[k & 1], y[k >> 1]);
      return;
    }
    // Texels in an order of neighbours, 0 1 3 2 or 0 2 3 1: along the side that is not cut first, from the held block.
    const int along = x[0] / block_side == x[1] / block_side ? 1 : 2;
    int k = index_of(x[0], y[0]) == held_ ? 0 : 3 - along;
    for (int n = 0; n < 4; ++n) {
      out[k] = texel(x[k & 1], y[k >> 1]);
      k ^= n == 1 ? 3 - along : along;
    }
  }

 private:
  static constexpr int32_t max_blocks_across = max_texture_side / block_side;
  static constexpr int32_t index_of(int32_t x, int32_t y) { return y / block_side * max_blocks_across + x / block_side; }

  constexpr rgba8 texel(int32_t x, int32_t y) {
    const int32_t index = index_of(x, y);
    if (index != held_) {
      map_.decode_block(level_, x / block_side, y / block_side, block_);
      held_ = index;
    }
    return block_.texel[y % block_side * block_side + x % block_side];
  }

  const Map& map_;
  int level_;
  bool compressed_;
  int32_t held_ = -1;
  texel_block block_;  // not set until decoded
};

}  // namespace detail

// Calls send(first word address, words, count) -> status for each run of blocks that holds texels of the box. Map: texture_view, or one
// that watches.
template <class Prof, class Map, class Send>
constexpr status load_section(const Prof& prof, const Map& t, const section& at, const texel_box& box, bool coarse, Send&& send) {
  const profile& q = prof.get();
  const int side = coarse ? q.coarse_side() : q.fine_side, blocks = side / 2;
  const int first_word = coarse ? q.fine_side * q.fine_side / 2 : 0;
  const auto columns = detail::columns_of(prof, t, at, box, coarse), rows = detail::rows_of(prof, t, at, box, coarse);
  detail::cell_reader map(t, at.level);
  for (int r = 0; r < rows.count; ++r) {
    const int row = (rows.first + r) & (blocks - 1);
    uint64_t words[2 * max_blocks];
    int count = 0, start = columns.first;
    for (int k = 0; k < columns.count; ++k) {
      rgba8 cell[4];
      map.cell(columns.texel[k], rows.texel[r], cell);
      const block_words w = pack_block(cell);
      words[count++] = w.red_green;
      words[count++] = w.blue_alpha;
      const bool at_edge = ((columns.first + k + 1) & (blocks - 1)) == 0;
      if (!at_edge && k + 1 < columns.count) continue;
      SPANTEX_TRY(send(first_word + (row * blocks + start) * 2, words, count));
      count = start = 0;
    }
  }
  return status::ok;
}

// The same of texels as they are, for a loader that copies (format rgba8888): calls send(first texel, texels, count) -> status for each run of
// the box's texels that lie side by side both in the map and in local memory (texel_memory.hpp).
template <class Prof, class Send>
constexpr status copy_section(const Prof& prof, const texture_view& t, const section& at, const texel_box& box, bool coarse, Send&& send) {
  const profile& q = prof.get();
  const int side = coarse ? q.coarse_side() : q.fine_side;
  const int first_texel = coarse ? q.fine_side * q.fine_side : 0;
  for (int32_t v = box.v0; v <= box.v1; ++v) {
    const rgba8* const row = t.colours_of(at.level) + t.wrapped_v(v, at.level) * t.width(at.level);
    const int to = first_texel + int(v & (side - 1)) * side;
    for (int32_t u = box.u0; u <= box.u1;) {
      const int32_t from = t.wrapped_u(u, at.level);
      const int column = int(u & (side - 1));
      int count = 1;
      while (u + count <= box.u1 && column + count < side && t.wrapped_u(u + count, at.level) == from + count) ++count;
      SPANTEX_TRY(send(to + column, row + from, count));
      u += count;
    }
  }
  return status::ok;
}

}  // namespace spantex
