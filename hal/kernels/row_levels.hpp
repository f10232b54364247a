// SPDX-License-Identifier: Apache-2.0
// A map as kernels read it that fetch texels from memory: each level in rows, an apron around it with what the wrap mode says lies there, so
// that neighbours are neighbours and a 2x2 is two loads. A mirrored axis is stored to its period.
#pragma once
#include <stddef.h>
#include <stdint.h>

#include <vector>

#include <spantex/texture.hpp>

namespace spantex::kernels {

inline constexpr int32_t row_apron = 3;  // texels on every side of a level at least

// A texel of an sRGB map, in the lower halves, and the one below it, in the upper ones: r, g, b decoded to u0.16 of linear light, a as it is; all less 2^15. A pixel's four texels are two of these, side by side.
struct linear_column {
  static constexpr int32_t offset = 1 << 15;
  int32_t r, g, b, a;
};

// A texel's place (x, y) is two 16-bit numbers in 32 bits, x in the lower half. To wrap it on a level, half by half:
//   min(k, k + 4 period), min(k, k - 2 period) and min(k, k - period), unsigned; & mask; max(k, low), min(k, high), signed
// for k from -4 to 4 periods, which is what near_limit() lets through; far_limit() what 2^far_doublings times as many do, from min(k, k + 2^n 4 period) on.
class row_levels {
 public:
  static constexpr int most = 16;
  enum field { period, mask, low, high, step, origin, field_count };  // step: texels from x to x + 1 and y to y + 1; origin: of texel (0, 0)

  row_levels() = default;
  explicit row_levels(const texture_view& view, int32_t apron = row_apron);
  const rgba8* texels() const { return texels_.data(); }
  const linear_column* linear_columns() const { return linear_columns_.data(); }  // where texels() has the upper one
  bool linear_light() const { return !linear_columns_.empty(); }                   // of an sRGB map
  int32_t value(field f, int level) const { return fields_[f][level]; }
  const int32_t (&values(field f) const)[most] { return fields_[f]; }
  int32_t stride(int level) const { return fields_[step][level] >> 16; }
  const rgba8* row(int level, int32_t y) const { return texels() + fields_[origin][level] + int64_t(y) * stride(level); }  // x and y within the apron
  int32_t columns(int level) const { return columns_[level]; }  // to a period or, clamped, to the level's end
  int32_t rows(int level) const { return rows_[level]; }
  int32_t apron() const { return apron_; }
  int count() const { return count_; }
  int exact_count() const { return exact_count_; }    // of levels whose sides halve exactly, from level 0 on
  uint32_t ratio_u(int level) const { return ratio_u_[level]; }  // texture_view::ratio_u()
  uint32_t ratio_v(int level) const { return ratio_v_[level]; }
  bool masks_only() const { return masks_only_; }     // both axes repeat or mirror after a power of two: k & mask is all
  bool opaque() const { return opaque_; }             // every texel of these has alpha 255
  bool uniform() const { return uniform_; }           // all of them are one colour
  int32_t modulo_u() const { return modulo_u_; }      // what bases are taken modulo, texels of level 0; 0 where they may stay
  int32_t modulo_v() const { return modulo_v_; }
  // How far texels of level 0 may lie from a base, in either axis, on levels up to this one.
  int32_t near_limit(int level) const { return limit_[0][level]; }
  int32_t far_limit(int level) const { return limit_[1][level]; }
  int far_doublings() const { return far_doublings_; }

 private:
  void add_axis(wrap mode, int32_t side, int level, int shift);
  void add_texels(const texture_view& view, int level);
  void add_linear_columns(int level);
  int32_t fields_[field_count][most] = {};
  std::vector<rgba8> texels_;
  std::vector<linear_column> linear_columns_;  // empty but of sRGB maps
  int32_t columns_[most] = {}, rows_[most] = {};
  uint32_t ratio_u_[most] = {}, ratio_v_[most] = {};
  int32_t apron_ = 0;
  int count_ = 0, exact_count_ = 0;
  bool masks_only_ = true, opaque_ = true, uniform_ = true;
  int32_t modulo_u_ = 0, modulo_v_ = 0, limit_[2][most] = {}, far_doublings_ = 0;
};

}  // namespace spantex::kernels
