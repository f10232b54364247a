// SPDX-License-Identifier: Apache-2.0
// A texture map in global texture memory: levels 0..n-1 of texels (texel.hpp: RGBA8888 or a 16-bit format), rows from the top, level L of size
// max(1, floor(size / 2^L)). The view owns nothing and is validated once, when it is made; kernels trust it.
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>
#include <spantex/span.hpp>
#include <spantex/status.hpp>
#include <spantex/texel.hpp>
#include <spantex/wrap.hpp>

namespace spantex {

inline constexpr int max_texture_side = 4096;
inline constexpr int max_levels = 13;

constexpr int32_t level_side(int32_t side, int level) { return max_of(1, side >> level); }

class texture_view {
 public:
  constexpr texture_view() = default;

  // `levels` are pointers to the texels of each level. Errors: bad_size (a side outside 1..4096), bad_levels (level count outside
  // 1..floor(log2(larger side)) + 1), bad_pointer.
  static constexpr status make(const rgba8* const* levels, int level_count, int32_t width, int32_t height,
                               wrap wrap_u, wrap wrap_v, texture_view& out) {
    SPANTEX_TRY(check_shape(level_count, width, height));
    texture_view t;
    for (int k = 0; k < level_count; ++k) {
      if (levels[k] == nullptr) return status::bad_pointer;
      t.levels_[k] = levels[k];
    }
    out = shaped(t, level_count, width, height, wrap_u, wrap_v);
    return status::ok;
  }

  // The same for a 16-bit format. Errors: also out_of_range for rgba8888, whose texels are not 16-bit numbers.
  static constexpr status make(texel_format format, const uint16_t* const* levels, int level_count, int32_t width, int32_t height,
                               wrap wrap_u, wrap wrap_v, texture_view& out) {
    if (format == texel_format::rgba8888) return status::out_of_range;
    SPANTEX_TRY(check_shape(level_count, width, height));
    texture_view t;
    for (int k = 0; k < level_count; ++k) {
      if (levels[k] == nullptr) return status::bad_pointer;
      t.packed_[k] = levels[k];
    }
    t.format_ = format;
    out = shaped(t, level_count, width, height, wrap_u, wrap_v);
    return status::ok;
  }

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

  // x and y already wrapped.
  constexpr rgba8 texel(int level, int32_t x, int32_t y) const {
    const int32_t index = y * width(level) + x;
    return format_ == texel_format::rgba8888 ? levels_[level][index] : unpack(format_, packed_[level][index]);
  }
  constexpr texel_format format() const { return format_; }

  // What tells two maps apart, for reuse of what is loaded: the same texels, wrapped in the same way.
  struct identity {
    const void* texels = nullptr;
    int32_t width = 0, height = 0;
    wrap wrap_u = wrap::repeat, wrap_v = wrap::repeat;
    texel_format format = texel_format::rgba8888;
    friend constexpr bool operator==(const identity&, const identity&) = default;
  };
  constexpr identity id() const {
    const void* const texels = format_ == texel_format::rgba8888 ? static_cast<const void*>(levels_[0]) : packed_[0];
    return {texels, width_, height_, wrap_u_, wrap_v_, format_};
  }

 private:
  static constexpr status check_shape(int level_count, int32_t width, int32_t height) {
    if (width < 1 || height < 1 || width > max_texture_side || height > max_texture_side) return status::bad_size;
    if (level_count < 1 || level_count > bit_length(uint64_t(max_of(width, height)))) return status::bad_levels;
    return status::ok;
  }

  static constexpr texture_view shaped(texture_view t, int level_count, int32_t width, int32_t height, wrap wrap_u, wrap wrap_v) {
    for (int k = 0; k < level_count; ++k) {
      t.ratio_u_[k] = ratio(width, k);
      t.ratio_v_[k] = ratio(height, k);
    }
    t.width_ = width;
    t.height_ = height;
    t.level_count_ = uint8_t(level_count);
    t.wrap_u_ = wrap_u;
    t.wrap_v_ = wrap_v;
    return t;
  }

  // A side that has shrunk to 1 has no ratio to keep: the position on it is always texel 0.
  static constexpr uint32_t ratio(int32_t side, int level) {
    const uint64_t scaled = uint64_t(level_side(side, level)) << (31 + level);
    const uint64_t r = (scaled + uint64_t(side) / 2) / uint64_t(side);
    return r > (uint64_t(1) << 31) ? uint32_t(1) << 31 : uint32_t(r);
  }

  const rgba8* levels_[max_levels] = {};     // rgba8888
  const uint16_t* packed_[max_levels] = {};  // the other formats
  uint32_t ratio_u_[max_levels] = {}, ratio_v_[max_levels] = {};
  int32_t width_ = 0, height_ = 0;
  uint8_t level_count_ = 0;
  texel_format format_ = texel_format::rgba8888;
  wrap wrap_u_ = wrap::repeat, wrap_v_ = wrap::repeat;
};

}  // namespace spantex
