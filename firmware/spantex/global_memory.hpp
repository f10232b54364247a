// SPDX-License-Identifier: Apache-2.0
// Global texture memory: the caller's words, handed out from the front. Uploading copies a map in, each level and the palette at the
// beginning of a word, and gives a view of the copy: VR11's loading of maps into global texture memory, apart from loading sections of
// them into local memory.
//
//   | level 0 ....... 0 0 | level 1 .. | level 2 0 | ... | palette | next map ...
#pragma once
#include <stddef.h>
#include <stdint.h>

#include <spantex/texture.hpp>

namespace spantex {

class global_memory {
 public:
  // The words must outlive every view of what is uploaded.
  constexpr global_memory(uint64_t* words, size_t word_count) : words_(words), word_count_(word_count) {}

  // Words that a map takes: whole words for each level and the palette.
  static constexpr size_t words_for(texel_format format, int level_count, int32_t width, int32_t height, int palette_count = 0) {
    size_t n = palette_size(format) == 0 ? 0 : words_of(uint32_t(palette_count) * sizeof(rgba8));
    for (int k = 0; k < level_count; ++k) n += words_of(level_bytes(format, level_side(width, k), level_side(height, k)));
    return n;
  }

  // Errors: those of texture_view::make, out_of_memory; nothing is copied then.
  status upload(texel_format format, const void* const* levels, int level_count, int32_t width, int32_t height, wrap wrap_u, wrap wrap_v,
                texture_view& out, const rgba8* palette = nullptr, int palette_count = 0) {
    texture_view t;
    SPANTEX_TRY(texture_view::make(format, levels, level_count, width, height, wrap_u, wrap_v, t, palette, palette_count));
    if (words_for(format, level_count, width, height, palette_count) > words_free()) return status::out_of_memory;
    const void* copies[max_levels] = {};
    for (int k = 0; k < level_count; ++k) copies[k] = copy(levels[k], level_bytes(format, level_side(width, k), level_side(height, k)));
    const void* colours = nullptr;
    if (palette_size(format) != 0) colours = copy(palette, uint32_t(palette_count) * sizeof(rgba8));
    return texture_view::make(format, copies, level_count, width, height, wrap_u, wrap_v, out, static_cast<const rgba8*>(colours),
                              palette_count);
  }

  // Forgets every map. Views of them, and sections loaded from them, must not be used any more.
  constexpr void reset() { used_ = 0; }

  constexpr size_t words_used() const { return used_; }
  constexpr size_t words_free() const { return word_count_ - used_; }
  constexpr uint64_t words_moved() const { return moved_; }  // by all uploads

 private:
  static constexpr size_t words_of(size_t bytes) { return (bytes + 7) / 8; }

  // The rest of the last word is zero.
  void* copy(const void* from, uint32_t bytes) {
    uint64_t* const to = words_ + used_;
    const size_t count = words_of(bytes);
    to[count - 1] = 0;
    uint8_t* const out = reinterpret_cast<uint8_t*>(to);
    const uint8_t* const in = static_cast<const uint8_t*>(from);
    for (uint32_t k = 0; k < bytes; ++k) out[k] = in[k];
    used_ += count;
    moved_ += count;
    return to;
  }

  uint64_t* words_;
  size_t word_count_, used_ = 0;
  uint64_t moved_ = 0;
};

}  // namespace spantex
