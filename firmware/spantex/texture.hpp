// SPDX-License-Identifier: Apache-2.0
// A texture map in global texture memory: levels 0..n-1 in one of the formats of texel.hpp, rows from the top, level L of size
// max(1, floor(size / 2^L)). The view owns nothing and is validated once, when it is made; kernels trust it.
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>
#include <spantex/block_codec.hpp>
#include <spantex/contour_style.hpp>
#include <spantex/span.hpp>
#include <spantex/srgb.hpp>
#include <spantex/status.hpp>
#include <spantex/texel.hpp>
#include <spantex/wrap.hpp>

namespace spantex {

inline constexpr int max_texture_side = 4096;
inline constexpr int max_levels = 13;

constexpr int32_t level_side(int32_t side, int level) { return max_of(1, side >> level); }

// What is known of a map's texels beforehand: each holds for every texel of the levels it speaks of. Unknown is false.
struct texture_facts {
  bool opaque = false;          // alpha is 255, on every level
  uint16_t uniform_levels = 0;  // bit L: level L has one colour
  constexpr bool uniform(int level) const { return ((uniform_levels >> level) & 1) != 0; }
};

class texture_view {
 public:
  constexpr texture_view() = default;

  // `levels` are pointers to the texels of each level. Errors: bad_size (a side outside 1..4096), bad_levels (level count outside
  // 1..floor(log2(larger side)) + 1), bad_pointer.
  static constexpr status make(const rgba8* const* levels, int level_count, int32_t width, int32_t height,
                               wrap wrap_u, wrap wrap_v, texture_view& out) {
    SPANTEX_TRY(check_shape(level_count, width, height));
    for (int k = 0; k < level_count; ++k)
      if (levels[k] == nullptr) return status::bad_pointer;
    out.set_shape(texel_format::rgba8888, level_count, width, height, wrap_u, wrap_v);
    for (int k = 0; k < level_count; ++k) out.levels_[k].colours = levels[k];
    return status::ok;
  }

  // The same for a 16-bit format. Errors: also out_of_range for the other formats, whose texels are not 16-bit numbers.
  static constexpr status make(texel_format format, const uint16_t* const* levels, int level_count, int32_t width, int32_t height,
                               wrap wrap_u, wrap wrap_v, texture_view& out) {
    if (!is_16_bit(format)) return status::out_of_range;
    SPANTEX_TRY(check_shape(level_count, width, height));
    for (int k = 0; k < level_count; ++k)
      if (levels[k] == nullptr) return status::bad_pointer;
    out.set_shape(format, level_count, width, height, wrap_u, wrap_v);
    for (int k = 0; k < level_count; ++k) out.levels_[k].numbers = levels[k];
    return status::ok;
  }

  // The same for any format: level k has level_bytes(format, its width, its height) bytes. A palette is required by formats that have
  // indices and ignored by the others. Errors: also bad_alignment (a 16-bit format at an odd address; the others may lie anywhere),
  // bad_pointer for a missing palette, out_of_range (an unknown format, a palette without colours or with more than indices reach).
  static status make(texel_format format, const void* const* levels, int level_count, int32_t width, int32_t height, wrap wrap_u,
                     wrap wrap_v, texture_view& out, const rgba8* palette = nullptr, int palette_count = 0) {
    if (int(format) >= texel_format_count) return status::out_of_range;
    SPANTEX_TRY(check_shape(level_count, width, height));
    for (int k = 0; k < level_count; ++k) {
      if (levels[k] == nullptr) return status::bad_pointer;
      if (is_16_bit(format) && reinterpret_cast<uintptr_t>(levels[k]) % alignof(uint16_t) != 0) return status::bad_alignment;
    }
    const bool has_palette = palette_size(format) != 0;
    if (has_palette && palette == nullptr) return status::bad_pointer;
    if (has_palette && (palette_count < 1 || palette_count > palette_size(format))) return status::out_of_range;
    out.set_shape(format, level_count, width, height, wrap_u, wrap_v);
    for (int k = 0; k < level_count; ++k) out.levels_[k] = typed(format, levels[k]);
    if (has_palette) {
      out.palette_ = palette;
      out.palette_count_ = int16_t(palette_count);
    }
    out.decode_ = decoder_of(format);
    return status::ok;
  }

  // Errors of a number of levels and a size, as make() has them.
  static constexpr status check_shape(int level_count, int32_t width, int32_t height) {
    if (width < 1 || height < 1 || width > max_texture_side || height > max_texture_side) return status::bad_size;
    if (level_count < 1 || level_count > bit_length(uint64_t(max_of(width, height)))) return status::bad_levels;
    return status::ok;
  }

  // As constructed: no levels.
  constexpr void reset() { set_shape(texel_format::rgba8888, 0, 0, 0, wrap::repeat, wrap::repeat); }

  constexpr int32_t width(int level = 0) const { return level_side(width_, level); }
  constexpr int32_t height(int level = 0) const { return level_side(height_, level); }
  constexpr int level_count() const { return level_count_; }
  constexpr int last_level() const { return level_count_ - 1; }
  constexpr wrap wrap_u() const { return wrap_u_; }
  constexpr wrap wrap_v() const { return wrap_v_; }

  // How many texels of the level one texel of level 0 is, times 2^level, u1.31: 2^31 where sizes halve exactly.
  constexpr uint32_t ratio_u(int level) const { return ratio_u_[level]; }
  constexpr uint32_t ratio_v(int level) const { return ratio_v_[level]; }

  constexpr int32_t wrapped_u(int32_t k, int level) const { return wrapped(wrap_u_, k, width(level)); }
  constexpr int32_t wrapped_v(int32_t k, int level) const { return wrapped(wrap_v_, k, height(level)); }

  // x and y already wrapped. For a compressed format the whole block is decoded: the loader keeps blocks instead.
  constexpr rgba8 texel(int level, int32_t x, int32_t y) const {
    if (format_ == texel_format::rgba8888) return levels_[level].colours[y * width(level) + x];
    return is_16_bit(format_) ? unpack(format_, levels_[level].numbers[y * width(level) + x]) : other_texel(level, x, y);
  }
  constexpr texel_format format() const { return format_; }

  // Of a 16-bit format: the level's texels, for who samples them where they lie.
  constexpr const uint16_t __attribute__((__may_alias__))* numbers(int level) const { return levels_[level].numbers; }

  // Of rgba8888: the level's texels, for loaders that copy them.
  constexpr const rgba8* colours_of(int level) const { return levels_[level].colours; }

  // Of a compressed format: the block with texels (4 bx .. 4 bx + 3, 4 by .. 4 by + 3).
  constexpr void decode_block(int level, int32_t bx, int32_t by, texel_block& out) const {
    decode_(levels_[level].bytes + (by * blocks_across(width(level)) + bx) * int32_t(block_bytes(format_)), out);
  }

  // How texels are read: neither changes what is loaded. Filter nearest delivers them as they are.
  constexpr colour_space colours() const { return colours_; }
  constexpr void set_colours(colour_space space) { colours_ = space; }
  constexpr const contour_style& contour() const { return contour_; }
  // Errors: out_of_range (scale).
  constexpr status set_contour(const contour_style& style) {
    SPANTEX_TRY(check(style));
    contour_ = style;
    return status::ok;
  }

  constexpr const texture_facts& facts() const { return facts_; }
  constexpr void set_facts(const texture_facts& facts) { facts_ = facts; }  // of the caller's care: a fact that does not hold is drawn

  // What tells levels of maps apart, for reuse of what is loaded: the same memory, read and wrapped in the same way. Not what lies there: renderer (draw.hpp).
  struct identity {
    const void* texels = nullptr;
    int32_t width = 0, height = 0;
    wrap wrap_u = wrap::repeat, wrap_v = wrap::repeat;
    texel_format format = texel_format::rgba8888;
    const rgba8* palette = nullptr;
    friend constexpr bool operator==(const identity&, const identity&) = default;
  };
  constexpr identity id(int level) const {
    const void* const texels = format_ == texel_format::rgba8888 ? static_cast<const void*>(levels_[level].colours)
                               : is_16_bit(format_)              ? static_cast<const void*>(levels_[level].numbers)
                                                                 : levels_[level].bytes;
    return {texels, width_, height_, wrap_u_, wrap_v_, format_, palette_};
  }

 private:
  // Everything but levels, palette and decoder, which are none. In place: a view is 190 bytes, which a small core's stack is not to hold too.
  SPANTEX_FRAME_APART constexpr void set_shape(texel_format format, int level_count, int32_t width, int32_t height, wrap wrap_u, wrap wrap_v) {
    for (int k = 0; k < max_levels; ++k) {
      levels_[k] = {};
      ratio_u_[k] = k < level_count ? ratio(width, k) : 0;
      ratio_v_[k] = k < level_count ? ratio(height, k) : 0;
    }
    palette_ = nullptr;
    decode_ = nullptr;
    width_ = width;
    height_ = height;
    palette_count_ = 0;
    level_count_ = uint8_t(level_count);
    format_ = format;
    wrap_u_ = wrap_u;
    wrap_v_ = wrap_v;
    colours_ = colour_space::coded;
    contour_ = {};
    facts_ = {};
  }

  // A side that has shrunk to 1 has no ratio to keep: the position on it is always texel 0.
  static constexpr uint32_t ratio(int32_t side, int level) {
    const uint64_t scaled = uint64_t(level_side(side, level)) << (31 + level);
    const uint64_t r = (scaled + uint64_t(side) / 2) / uint64_t(side);
    return r > (uint64_t(1) << 31) ? uint32_t(1) << 31 : uint32_t(r);
  }

  // 16-bit numbers may lie in memory that was written as words (global_memory.hpp).
  using number = uint16_t __attribute__((__may_alias__));
  union storage {
    const rgba8* colours = nullptr;  // rgba8888
    const number* numbers;           // a 16-bit format
    const uint8_t* bytes;            // the other formats
  };

  static storage typed(texel_format format, const void* level) {
    storage t;
    if (format == texel_format::rgba8888) t.colours = static_cast<const rgba8*>(level);
    else if (is_16_bit(format)) t.numbers = static_cast<const number*>(level);
    else t.bytes = static_cast<const uint8_t*>(level);
    return t;
  }

  constexpr rgba8 colour(int index) const { return index < palette_count_ ? palette_[index] : rgba8{0, 0, 0, 0}; }

  constexpr rgba8 other_texel(int level, int32_t x, int32_t y) const {
    if (is_compressed(format_)) {
      texel_block block;
      decode_block(level, x / block_side, y / block_side, block);
      return block.texel[y % block_side * block_side + x % block_side];
    }
    const uint8_t* const row = levels_[level].bytes + y * int32_t(row_bytes(format_, width(level)));
    if (format_ == texel_format::palette4) return colour(nibble(row, x));
    if (format_ == texel_format::palette8) return colour(row[x]);
    return unpack(format_, row + x * (texel_bits(format_) / 8));
  }

  storage levels_[max_levels] = {};
  const rgba8* palette_ = nullptr;
  block_decoder decode_ = nullptr;  // of a compressed format
  uint32_t ratio_u_[max_levels] = {}, ratio_v_[max_levels] = {};
  int32_t width_ = 0, height_ = 0;
  int16_t palette_count_ = 0;
  uint8_t level_count_ = 0;
  texel_format format_ = texel_format::rgba8888;
  wrap wrap_u_ = wrap::repeat, wrap_v_ = wrap::repeat;
  colour_space colours_ = colour_space::coded;
  contour_style contour_{};
  texture_facts facts_{};
};

}  // namespace spantex
