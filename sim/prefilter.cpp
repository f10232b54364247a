// SPDX-License-Identifier: Apache-2.0
#include "prefilter.hpp"

#include <array>
#include <cstdlib>
#include <numeric>

#include <spantex/texture.hpp>
#include "window.hpp"

namespace spantex::sim {
namespace {

// The part of the finer level that coarse texel i covers.
taps covered(int32_t i, int32_t size) {
  if (size == 1) return {0, {1}};
  if (size % 2 == 0) return {2 * i, {1, 1}};
  const int32_t m = size / 2;
  return {2 * i, {m - i, m, i + 1}};
}

taps smoothed(const taps& box) {
  taps t{box.first - 1, std::vector<int32_t>(box.weight.size() + 2)};
  for (size_t k = 0; k < box.weight.size(); ++k)
    for (size_t n = 0; n < 3; ++n) t.weight[k + n] += box.weight[k] * (n == 1 ? 2 : 1);
  return t;
}

int64_t sum_of(const std::vector<int32_t>& weights) { return std::accumulate(weights.begin(), weights.end(), int64_t(0)); }

// Integer weights for the values of a kernel at the texels first, first + 1, ... with the given sum and a first moment of zero: each to
// nearest, what is missing goes to the two texels about the centre. A unit moved from one texel to the next changes the moment by
// 2 coarse, which divides every moment if it divides the sum.
taps scaled(int32_t first, const std::vector<int64_t>& values, int64_t sum, int32_t i, int32_t fine, int32_t coarse) {
  const int64_t total = std::accumulate(values.begin(), values.end(), int64_t(0));
  taps t{first, {}};
  int64_t missing = sum, moment = 0;
  size_t left = 0;
  for (size_t k = 0; k < values.size(); ++k) {
    const int64_t magnitude = (std::abs(values[k]) * sum + total / 2) / total;
    t.weight.push_back(int32_t(values[k] < 0 ? -magnitude : magnitude));
    const int64_t distance = centre_distance(first + int32_t(k), i, fine, coarse);
    if (distance <= 0) left = k;
    missing -= t.weight[k];
    moment += t.weight[k] * distance;
  }
  moment += missing * centre_distance(first + int32_t(left), i, fine, coarse);
  const int64_t moved = moment / (2 * coarse);
  t.weight[left] += int32_t(missing + moved);
  t.weight[left + 1] -= int32_t(moved);
  return t;
}

taps windowed(int32_t i, int32_t fine, int32_t coarse, int64_t sum, prefilter kind) {
  const int32_t reach = window_reach * fine / coarse + 1, centre = int32_t(int64_t(2 * i + 1) * fine / (2 * coarse));
  std::vector<int64_t> values;
  int32_t first = centre - reach;
  for (int32_t k = first; k <= centre + reach; ++k) {
    const int64_t n = centre_distance(k, i, fine, coarse), d = 2 * fine;
    const int64_t value = kind == prefilter::kaiser ? kaiser_weight(n, d) : lanczos_weight(n, d);
    const bool outside = n <= -window_reach * d || n >= window_reach * d;
    if (outside && values.empty()) first = k + 1;
    if (!outside) values.push_back(value);
  }
  return scaled(first, values, sum, i, fine, coarse);
}

// The phases of a side repeat: 2m texels have one, 2m + 1 have m.
axis_filter windowed_axis(int32_t fine, int32_t coarse, prefilter kind) {
  constexpr int64_t most = int64_t(1) << 16;
  axis_filter a{fine, coarse, {}, 1};
  const int32_t phases = fine % 2 == 0 ? 1 : coarse, units_fine = fine / (coarse / phases), units_coarse = phases;
  a.weight_sum = most / (2 * units_coarse) * (2 * units_coarse);
  for (int32_t i = 0; i < phases; ++i) a.outputs.push_back(windowed(i, units_fine, units_coarse, a.weight_sum, kind));
  for (int32_t i = phases; i < coarse; ++i) {
    a.outputs.push_back(a.outputs[0]);
    a.outputs.back().first += 2 * i;
  }
  return a;
}

using sums = std::array<int64_t, channel_count>;

sums channels(const rgba8& c, colour_space in) { return {averaged(c.r, in), averaged(c.g, in), averaged(c.b, in), c.a}; }
// Below 2^24; with the weights of both axes, whose magnitudes add up to less than 2^34, below 2^58.
sums premultiplied(const rgba8& c, colour_space in) {
  return {averaged(c.r, in) * c.a, averaged(c.g, in) * c.a, averaged(c.b, in) * c.a, c.a};
}

void add_weighted(sums& s, const sums& c, int64_t weight) {
  for (size_t k = 0; k < channel_count; ++k) s[k] += weight * c[k];
}

// One map and the two axes that halve it.
class halving {
 public:
  halving(const image& fine, prefilter kind, wrap u, wrap v, alpha_weighting alpha, colour_space colours)
      : fine_(fine), columns_(make_axis_filter(fine.width_px, kind)), rows_(make_axis_filter(fine.height_px, kind)), u_(u), v_(v),
        weighted_(alpha == alpha_weighting::weighted), in_(colours), total_(columns_.weight_sum * rows_.weight_sum) {}

  int width() const { return columns_.coarse; }
  int height() const { return rows_.coarse; }

  void row(int y, rgba8* out) const {
    const std::vector<sums> filtered_down = column_sums(rows_.outputs[size_t(y)]);
    for (int x = 0; x < width(); ++x) {
      const taps& across = columns_.outputs[size_t(x)];
      sums s{};
      for (size_t k = 0; k < across.weight.size(); ++k) add_weighted(s, filtered_down[size_t(column(across, k))], across.weight[k]);
      out[x] = weighted_ ? divided(s, x, y) : colour(s, total_, mean(s[3], total_));
    }
  }

 private:
  rgba8 colour(const sums& s, int64_t total, uint8_t alpha) const {
    return {colour_mean(s[0], total, in_), colour_mean(s[1], total, in_), colour_mean(s[2], total, in_), alpha};
  }
  int32_t column(const taps& t, size_t k) const { return wrapped(u_, t.first + int32_t(k), fine_.width_px); }
  int32_t line(const taps& t, size_t k) const { return wrapped(v_, t.first + int32_t(k), fine_.height_px); }

  std::vector<sums> column_sums(const taps& down) const {
    std::vector<sums> line_sums(size_t(fine_.width_px));
    for (size_t k = 0; k < down.weight.size(); ++k) {
      const rgba8* texels = &fine_.at(0, line(down, k));
      for (size_t x = 0; x < line_sums.size(); ++x)
        add_weighted(line_sums[x], weighted_ ? premultiplied(texels[x], in_) : channels(texels[x], in_), down.weight[k]);
    }
    return line_sums;
  }

  rgba8 divided(const sums& s, int x, int y) const {
    const uint8_t alpha = mean(s[3], total_);
    return alpha != 0 ? colour(s, s[3], alpha) : under_magnitudes(x, y);
  }

  // Under the kernel's magnitudes, weighted by alpha; if all texels are transparent, by none.
  rgba8 under_magnitudes(int x, int y) const {
    const taps &across = columns_.outputs[size_t(x)], &down = rows_.outputs[size_t(y)];
    sums opaque{}, all{};
    int64_t weights = 0;
    for (size_t j = 0; j < down.weight.size(); ++j)
      for (size_t i = 0; i < across.weight.size(); ++i) {
        const rgba8& c = fine_.at(column(across, i), line(down, j));
        const int64_t w = std::abs(int64_t(across.weight[i]) * down.weight[j]);
        add_weighted(opaque, premultiplied(c, in_), w);
        add_weighted(all, channels(c, in_), w);
        weights += w;
      }
    const sums& s = opaque[3] > 0 ? opaque : all;
    const int64_t total = opaque[3] > 0 ? opaque[3] : weights;
    return colour(s, total, 0);
  }

  const image& fine_;
  axis_filter columns_, rows_;
  wrap u_, v_;
  bool weighted_;
  colour_space in_;
  int64_t total_;
};

}  // namespace

// Halves to even keeps the mean of a map; a sum below zero, or above, is a negative lobe's.
int64_t mean_up_to(int64_t most, int64_t x, int64_t total) {
  if (x <= 0) return 0;
  const int64_t whole = x / total, rest = x % total;
  if (whole >= most) return most;
  const bool up = rest > total - rest || (rest == total - rest && whole % 2 != 0);
  return whole + (up ? 1 : 0);
}

uint8_t mean(int64_t x, int64_t total) { return uint8_t(mean_up_to(255, x, total)); }

uint8_t colour_mean(int64_t x, int64_t total, colour_space colours) {
  return colours == colour_space::srgb ? srgb_encoded(uint32_t(mean_up_to(65535, x, total))) : mean(x, total);
}

axis_filter make_axis_filter(int32_t size, prefilter kind) {
  const int32_t coarse = level_side(size, 1);
  if (size > 1 && (kind == prefilter::kaiser || kind == prefilter::lanczos)) return windowed_axis(size, coarse, kind);
  axis_filter a{size, coarse, {}, 1};
  for (int32_t i = 0; i < coarse; ++i) {
    const taps box = covered(i, size);
    a.outputs.push_back(kind == prefilter::triangle ? smoothed(box) : box);
  }
  a.weight_sum = sum_of(a.outputs[0].weight);
  return a;
}

image halved(const image& fine, prefilter kind, wrap u, wrap v, alpha_weighting alpha, int threads, colour_space colours) {
  const halving h(fine, kind, u, v, alpha, colours);
  image coarse(h.width(), h.height(), {});
  for_each_index(h.height(), threads, [&](int y) { h.row(y, &coarse.at(0, y)); });
  return coarse;
}

}  // namespace spantex::sim
