// SPDX-License-Identifier: Apache-2.0
#include "row_levels.hpp"

namespace spantex::kernels {
namespace {

int32_t length_of(wrap mode, int32_t side) { return mode == wrap::mirror ? 2 * side : side; }
bool power_of_two(int32_t n) { return (n & (n - 1)) == 0; }
int32_t half(int32_t n, int shift) { return int32_t(uint32_t(n & 0xFFFF) << shift); }

static_assert(4 * (2 * max_texture_side) <= 1 << 15, "four periods of a mirrored map are still told apart in 16 bits");

}  // namespace

row_levels::row_levels(const texture_view& view, int32_t apron) : apron_(apron) {
  constexpr uint32_t exact = uint32_t(1) << 31;
  count_ = view.level_count();
  while (exact_count_ < count_ && view.ratio_u(exact_count_) == exact && view.ratio_v(exact_count_) == exact) ++exact_count_;
  const int32_t period_u = length_of(view.wrap_u(), view.width()), period_v = length_of(view.wrap_v(), view.height());
  if (view.wrap_u() != wrap::clamp && !power_of_two(period_u)) modulo_u_ = period_u;
  if (view.wrap_v() != wrap::clamp && !power_of_two(period_v)) modulo_v_ = period_v;
  masks_only_ = view.wrap_u() != wrap::clamp && view.wrap_v() != wrap::clamp && modulo_u_ == 0 && modulo_v_ == 0;
  if (const int32_t longest = max_of(modulo_u_, modulo_v_); longest != 0)
    while (longest << (far_doublings_ + 3) <= 1 << 15) ++far_doublings_;
  int32_t limit[2] = {INT32_MAX, INT32_MAX};
  for (int k = 0; k < count_; ++k) {
    ratio_u_[k] = view.ratio_u(k);
    ratio_v_[k] = view.ratio_v(k);
    // What a base is left with lies within a period of 0; a texel of the level is lost to rounding, another to a neighbour.
    for (const int32_t side : {modulo_u_ != 0 ? length_of(view.wrap_u(), view.width(k)) : 0, modulo_v_ != 0 ? length_of(view.wrap_v(), view.height(k)) : 0})
      for (int far = 0; far < 2 && side != 0 && !power_of_two(side); ++far) {
        const int32_t texels = ((far ? 4 << far_doublings_ : 4) - 1) * side;
        limit[far] = min_of(limit[far], k < exact_count_ ? (texels - 1) * (1 << k) - 1 : (texels - 4) * (1 << k));
      }
    limit_[0][k] = limit[0];
    limit_[1][k] = limit[1];
    add_axis(view.wrap_u(), view.width(k), k, 0);
    add_axis(view.wrap_v(), view.height(k), k, 16);
    add_texels(view, k);
  }
  if (view.colours() == colour_space::coded) return;
  linear_columns_.reserve(texels_.size());
  for (int k = 0; k < count_; ++k) add_linear_columns(k);
}

void row_levels::add_linear_columns(int level) {
  const rgba8* row = this->row(level, -apron_) - apron_;
  const int32_t rows = rows_[level] + 2 * apron_;
  for (int32_t y = 0; y < rows; ++y, row += stride(level))
    for (int32_t x = 0; x < stride(level); ++x) {
      const rgba8 upper = row[x], lower = y + 1 < rows ? row[x + stride(level)] : upper;  // of the last row, an apron's, nobody reads it
      const auto both = [](int32_t of_upper, int32_t of_lower) { return half(of_upper - linear_column::offset, 0) | half(of_lower - linear_column::offset, 16); };
      const auto decoded = [&](uint8_t rgba8::*c) { return both(int32_t(srgb_decoded(upper.*c)), int32_t(srgb_decoded(lower.*c))); };
      linear_columns_.push_back({decoded(&rgba8::r), decoded(&rgba8::g), decoded(&rgba8::b), both(upper.a, lower.a)});
    }
}

void row_levels::add_axis(wrap mode, int32_t side, int level, int shift) {
  const int32_t length = length_of(mode, side);
  const bool clamped = mode == wrap::clamp, masked = !clamped && power_of_two(length);
  fields_[period][level] |= half(clamped || masked ? 0 : length, shift);
  fields_[mask][level] |= half(masked ? length - 1 : -1, shift);
  fields_[low][level] |= half(clamped ? -1 : INT16_MIN, shift);
  fields_[high][level] |= half(clamped ? side - 1 : INT16_MAX, shift);
}

void row_levels::add_texels(const texture_view& view, int level) {
  columns_[level] = length_of(view.wrap_u(), view.width(level));
  rows_[level] = length_of(view.wrap_v(), view.height(level));
  const int32_t columns = columns_[level] + 2 * apron_, rows = rows_[level] + 2 * apron_;
  fields_[step][level] = half(1, 0) | half(columns, 16);
  fields_[origin][level] = int32_t(texels_.size()) + apron_ * (columns + 1);
  std::vector<int32_t> across;
  for (int32_t x = 0; x < columns; ++x) across.push_back(view.wrapped_u(x - apron_, level));
  texels_.reserve(texels_.size() + size_t(columns) * size_t(rows));
  for (int32_t y = 0; y < rows; ++y) {
    const int32_t v = view.wrapped_v(y - apron_, level);
    for (const int32_t u : across) {
      texels_.push_back(view.texel(level, u, v));
      opaque_ &= texels_.back().a == 255;
      uniform_ &= texels_.back() == texels_.front();
    }
  }
}

}  // namespace spantex::kernels
