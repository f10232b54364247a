// SPDX-License-Identifier: Apache-2.0
#include "prefilter_figures.hpp"

#include <math.h>

#include <algorithm>
#include <complex>

namespace spantex::sim {
namespace {

constexpr int coarse_width = 256, phases = 15;
constexpr double middle = 127.5, amplitude = 100;

image level_of(const image& fine, compile_options o, int level) {
  o.level_count = level + 1;
  return compile_levels(fine, o)[size_t(level)];
}

image stripes(int width, const auto& value) {
  image out(width, 1, {});
  for (int x = 0; x < width; ++x) out.at(x, 0) = {uint8_t(value(x)), 0, 0, 255};
  return out;
}

double response(const compile_options& o, int level, grating g) {
  const int cycles = std::min(coarse_width * g.sixteenths / 16, coarse_width) - (g.sixteenths == 8 ? 1 : 0);
  double sum = 0;
  for (int k = 0; k < phases; ++k) {
    const double phase = 2 * M_PI * k / phases;
    const int width = coarse_width << level;
    const image coarse = level_of(stripes(width, [&](int x) {
      return lround(middle + amplitude * cos(2 * M_PI * cycles * (x + 0.5) / width + phase));
    }), o, level);
    std::complex<double> found = 0;
    for (int x = 0; x < coarse.width_px; ++x)
      found += (coarse.at(x, 0).r - middle) * std::polar(2.0 / coarse_width / amplitude, -(2 * M_PI * cycles * (x + 0.5) / coarse_width + phase));
    sum += found.real();
  }
  return sum / phases;
}

int overshoot(const compile_options& o, int level) {
  constexpr int low = 64, high = 192;
  const int width = coarse_width << level;
  int most = 0;
  for (int at = width / 2; at < width / 2 + (1 << level); ++at) {
    compile_options clamped = o;
    clamped.wrap_u = wrap::clamp;
    const image coarse = level_of(stripes(width, [&](int x) { return x < at ? low : high; }), clamped, level);
    for (const rgba8& c : coarse.pixels) most = std::max({most, c.r - high, low - c.r});
  }
  return most;
}

}  // namespace

prefilter_figures figures_of(const compile_options& options, int level) {
  prefilter_figures f;
  for (const grating g : shown_gratings) f.response.push_back(response(options, level, g));
  for (const grating g : aliased_gratings) f.aliased.push_back(response(options, level, g));
  f.overshoot = overshoot(options, level);
  return f;
}

}  // namespace spantex::sim
