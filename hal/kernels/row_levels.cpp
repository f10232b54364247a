// SPDX-License-Identifier: Apache-2.0
#include "row_levels.hpp"

namespace spantex::kernels {
namespace {

constexpr int32_t apron = 1;

int32_t length_of(wrap mode, int32_t side) { return mode == wrap::mirror ? 2 * side : side; }
bool power_of_two(int32_t n) { return (n & (n - 1)) == 0; }
int32_t half(int32_t n, int shift) { return int32_t(uint32_t(n & 0xFFFF) << shift); }

// Bases are taken modulo the period; what comes of it is wrapped within four periods of 0, less what the smallest level needs for a neighbour.
static_assert(4 * (2 * max_texture_side) <= 1 << 15, "four periods of a mirrored map are still told apart in 16 bits");
int32_t limit_of(int32_t period, int levels) { return 3 * period - (1 << levels) - 1; }

}  // namespace

row_levels::row_levels(const texture_view& view) {
  constexpr uint32_t exact = uint32_t(1) << 31;
  while (count_ < view.level_count() && view.ratio_u(count_) == exact && view.ratio_v(count_) == exact) ++count_;
  const int32_t period_u = length_of(view.wrap_u(), view.width()), period_v = length_of(view.wrap_v(), view.height());
  if (view.wrap_u() != wrap::clamp && !power_of_two(period_u)) modulo_u_ = period_u;
  if (view.wrap_v() != wrap::clamp && !power_of_two(period_v)) modulo_v_ = period_v;
  masks_only_ = view.wrap_u() != wrap::clamp && view.wrap_v() != wrap::clamp && modulo_u_ == 0 && modulo_v_ == 0;
  if (modulo_u_ != 0) place_limit_ = min_of(place_limit_, limit_of(modulo_u_, count_));
  if (modulo_v_ != 0) place_limit_ = min_of(place_limit_, limit_of(modulo_v_, count_));
  for (int k = 0; k < count_; ++k) {
    add_axis(view.wrap_u(), view.width(k), k, 0);
    add_axis(view.wrap_v(), view.height(k), k, 16);
    add_texels(view, k);
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
  const int32_t columns = length_of(view.wrap_u(), view.width(level)) + 2 * apron, rows = length_of(view.wrap_v(), view.height(level)) + 2 * apron;
  fields_[step][level] = half(1, 0) | half(columns, 16);
  fields_[origin][level] = int32_t(texels_.size()) + apron * (columns + 1);
  std::vector<int32_t> across;
  for (int32_t x = 0; x < columns; ++x) across.push_back(view.wrapped_u(x - apron, level));
  texels_.reserve(texels_.size() + size_t(columns) * size_t(rows));
  for (int32_t y = 0; y < rows; ++y) {
    const int32_t v = view.wrapped_v(y - apron, level);
    for (const int32_t u : across) {
      texels_.push_back(view.texel(level, u, v));
      opaque_ &= texels_.back().a == 255;
    }
  }
}

}  // namespace spantex::kernels
