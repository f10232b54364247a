// SPDX-License-Identifier: Apache-2.0
#include "map.hpp"

#include <array>
#include <utility>

namespace spantex::sim {
namespace {

// Texels of the finer level that make up one texel of the coarser one, along one axis.
struct taps {
  static constexpr int max_count = 5;
  int count = 0;
  std::array<int32_t, max_count> texel{};
  std::array<uint32_t, max_count> weight{};

  void add(int32_t t, uint32_t w) {
    texel[size_t(count)] = t;
    weight[size_t(count++)] = w;
  }
};

struct axis {
  std::vector<taps> outputs;
  uint32_t weight_sum = 1;
};

// The part of the finer level that coarse texel i covers: unwrapped, in [0, size).
taps covered(int32_t i, int32_t size) {
  taps t;
  if (size == 1) {
    t.add(0, 1);
  } else if (size % 2 == 0) {
    t.add(2 * i, 1);
    t.add(2 * i + 1, 1);
  } else {
    const int32_t m = size / 2;
    t.add(2 * i, uint32_t(m - i));
    t.add(2 * i + 1, uint32_t(m));
    t.add(2 * i + 2, uint32_t(i + 1));
  }
  return t;
}

taps smoothed(const taps& box, int32_t size, wrap mode) {
  std::array<uint32_t, taps::max_count> weight{};
  for (int k = 0; k < box.count; ++k)
    for (int n = 0; n < 3; ++n) weight[size_t(k + n)] += box.weight[size_t(k)] * (n == 1 ? 2u : 1u);
  taps t;
  for (int k = 0; k < box.count + 2; ++k) t.add(wrapped(mode, box.texel[0] - 1 + k, size), weight[size_t(k)]);
  return t;
}

axis make_axis(int32_t size, prefilter kind, wrap mode) {
  axis a;
  for (int32_t i = 0; i < level_side(size, 1); ++i) {
    const taps box = covered(i, size);
    a.outputs.push_back(kind == prefilter::box ? box : smoothed(box, size, mode));
  }
  a.weight_sum = 0;
  for (int k = 0; k < a.outputs[0].count; ++k) a.weight_sum += a.outputs[0].weight[size_t(k)];
  return a;
}

using sums = std::array<uint64_t, channel_count>;

void accumulate(sums& s, const rgba8& c, uint64_t weight) {
  s[0] += weight * c.r;
  s[1] += weight * c.g;
  s[2] += weight * c.b;
  s[3] += weight * c.a;
}

rgba8 mean(const sums& s, uint64_t total) {
  const auto rounded = [&](uint64_t x) {
    const uint64_t whole = x / total, twice_rest = 2 * (x % total);
    return uint8_t(whole + (twice_rest > total || (twice_rest == total && whole % 2 != 0) ? 1 : 0));
  };
  return {rounded(s[0]), rounded(s[1]), rounded(s[2]), rounded(s[3])};
}

}  // namespace

image halved(const image& fine, prefilter kind, wrap u, wrap v) {
  const axis columns = make_axis(fine.width_px, kind, u), rows = make_axis(fine.height_px, kind, v);
  image coarse(int(columns.outputs.size()), int(rows.outputs.size()), {});
  const uint64_t total = uint64_t(columns.weight_sum) * rows.weight_sum;
  for (int y = 0; y < coarse.height_px; ++y)
    for (int x = 0; x < coarse.width_px; ++x) {
      const taps &across = columns.outputs[size_t(x)], &down = rows.outputs[size_t(y)];
      sums s{};
      for (size_t j = 0; j < size_t(down.count); ++j)
        for (size_t i = 0; i < size_t(across.count); ++i)
          accumulate(s, fine.at(across.texel[i], down.texel[j]), uint64_t(across.weight[i]) * down.weight[j]);
      coarse.at(x, y) = mean(s, total);
    }
  return coarse;
}

texture_map::texture_map(image level0, prefilter kind, wrap u, wrap v) {
  levels_.push_back(std::move(level0));
  while (levels_.back().width_px > 1 || levels_.back().height_px > 1) levels_.push_back(halved(levels_.back(), kind, u, v));
  std::vector<const rgba8*> texels;
  for (const image& level : levels_) texels.push_back(level.pixels.data());
  const image& top = levels_.front();
  const status s = texture_view::make(texels.data(), int(texels.size()), top.width_px, top.height_px, u, v, view_);
  if (s != status::ok) throw input_error(std::string("map: ") + to_string(s));
}

}  // namespace spantex::sim
