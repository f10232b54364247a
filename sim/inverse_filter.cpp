// SPDX-License-Identifier: Apache-2.0
#include "inverse_filter.hpp"

#include <algorithm>

#include <spantex/texture.hpp>
#include "window.hpp"

namespace spantex::sim {
namespace {

constexpr int32_t one = 1 << blur_bits;

// Response of one halving to coarsest / 4 cycles along the map, a quarter cycle per texel of a level that has `coarsest` of them: the mean over
// the phases of sum w cos(2 pi f t), t the distance from the coarse texel's centre. 30 fraction bits.
int64_t response(const axis_filter& a, int32_t coarsest) {
  const int64_t per = int64_t(4) * a.coarse * a.fine;
  const size_t phases = a.fine % 2 == 0 ? 1 : a.outputs.size();
  int64_t mean = 0;
  for (size_t i = 0; i < phases; ++i) {
    int64_t sum = 0;
    for (size_t k = 0; k < a.outputs[i].weight.size(); ++k) {
      const int64_t distance = centre_distance(a.outputs[i].first + int32_t(k), int32_t(i), a.fine, a.coarse);
      sum += a.outputs[i].weight[k] * cos_pi(distance * coarsest, per);
    }
    mean += sum / a.weight_sum;
  }
  return mean / int64_t(phases);
}

int32_t side_blur(int32_t size, int level, prefilter kind) {
  const int32_t coarsest = level_side(size, level);
  int64_t chain = one_q30;
  for (int k = 0; k < level && level_side(size, k) > 1; ++k)
    chain = detail::product_q30(chain, response(make_axis_filter(level_side(size, k), kind), coarsest));
  const int64_t a = (one_q30 - chain + (int64_t(1) << (30 - blur_bits))) >> (31 - blur_bits);
  return int32_t(std::clamp<int64_t>(a, 0, one / 4));
}

// One channel, exact. Each blur adds 2 blur_bits fraction bits.
struct field {
  int width, height;
  std::vector<int64_t> values;
  const int64_t* row(int y) const { return &values[size_t(y) * size_t(width)]; }
  int64_t* row(int y) { return &values[size_t(y) * size_t(width)]; }
};

class inverse {
 public:
  inverse(blur x, wrap u, wrap v, int threads) : x_(x), u_(u), v_(v), threads_(threads) {}

  static constexpr int fraction_bits = 6 * blur_bits;

  // By Horner's rule: 4 f + x (-6 f + x (4 f - x f)). |f| < 2^16, the magnitudes of b add up to 15, 42 fraction bits: below 2^62.
  field applied(const field& f) const { return step(4, f, step(-6, f, step(4, f, scaled(f, -1), 1), 2), 3); }

 private:
  static field scaled(field f, int64_t by) {
    for (int64_t& x : f.values) x *= by;
    return f;
  }

  // b f + x g, in 2 blur_bits j fraction bits; g has 2 blur_bits less.
  field step(int64_t b, const field& f, const field& g, int j) const {
    field out{f.width, f.height, std::vector<int64_t>(f.values.size())};
    for_each_index(f.height, threads_, [&](int y) {
      const int64_t* const rows[3] = {g.row(wrapped(v_, y - 1, f.height)), g.row(y), g.row(wrapped(v_, y + 1, f.height))};
      for (int x = 0; x < f.width; ++x) {
        const int left = wrapped(u_, x - 1, f.width), right = wrapped(u_, x + 1, f.width);
        const auto across = [&](const int64_t* r) { return x_.u * (r[left] + r[right]) + (one - 2 * x_.u) * r[x]; };
        const int64_t blurred = x_.v * (across(rows[0]) + across(rows[2])) + (one - 2 * x_.v) * across(rows[1]);
        out.row(y)[x] = b * f.row(y)[x] * (int64_t(1) << (2 * blur_bits * j)) + blurred;
      }
    });
    return out;
  }

  blur x_;
  wrap u_, v_;
  int threads_;
};

using channel = uint8_t rgba8::*;
constexpr channel colour_channels[] = {&rgba8::r, &rgba8::g, &rgba8::b};

field field_of(const image& level, channel c) {
  field f{level.width_px, level.height_px, std::vector<int64_t>(level.pixels.size())};
  for (size_t k = 0; k < f.values.size(); ++k) f.values[k] = level.pixels[k].*c;
  return f;
}

// A colour in the units that it is averaged in, alpha-weighted where that is asked for: codes times 0..255, linear light times 0..1 to nearest, so
// that both stay below 2^16.
field colour_field(const image& level, channel c, bool times_alpha, colour_space colours) {
  field f{level.width_px, level.height_px, std::vector<int64_t>(level.pixels.size())};
  for (size_t k = 0; k < f.values.size(); ++k) {
    const int64_t x = averaged(level.pixels[k].*c, colours), alpha = level.pixels[k].a;
    if (!times_alpha) f.values[k] = x;
    else f.values[k] = colours == colour_space::srgb ? (2 * x * alpha + 255) / 510 : x * alpha;
  }
  return f;
}

}  // namespace

blur blur_of(int width, int height, int level, prefilter kind) {
  return {side_blur(width, level, kind), side_blur(height, level, kind)};
}

image inverse_filtered(const image& level, blur x, wrap u, wrap v, alpha_weighting alpha, int threads, colour_space space) {
  if (x.u == 0 && x.v == 0) return level;
  constexpr int64_t unit = int64_t(1) << inverse::fraction_bits;
  const inverse filter(x, u, v, threads);
  const bool weighted = alpha == alpha_weighting::weighted;
  const field alphas = filter.applied(field_of(level, &rgba8::a));
  const int64_t unit_of_alpha = space == colour_space::srgb ? 255 : 1;  // that colours were multiplied by
  image out = level;
  for (size_t k = 0; k < out.pixels.size(); ++k) out.pixels[k].a = mean(alphas.values[k], unit);
  for (const channel c : colour_channels) {
    const field f = filter.applied(colour_field(level, c, weighted, space));
    for (size_t k = 0; k < out.pixels.size(); ++k) {
      if (!weighted) out.pixels[k].*c = colour_mean(f.values[k], unit, space);
      else if (out.pixels[k].a != 0) out.pixels[k].*c = colour_mean(f.values[k], alphas.values[k] / unit_of_alpha, space);
    }
  }
  return out;
}

}  // namespace spantex::sim
