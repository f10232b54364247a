// SPDX-License-Identifier: Apache-2.0
#include "screen_filter.hpp"

#include <math.h>

#include <algorithm>

namespace spantex::sim {
namespace {

// Samples along one axis from the middle to the kernel's end.
int reach_of(screen_kernel kernel, int samples) {
  switch (kernel) {
    case screen_kernel::step: return samples / 2;
    case screen_kernel::hat: return samples;
    case screen_kernel::gauss: break;
  }
  return 3 * samples / 2;
}

}  // namespace

double kernel_at(screen_kernel kernel, double s, double t) {
  if (kernel == screen_kernel::step) return fabs(s) <= 0.5 && fabs(t) <= 0.5 ? 1 : 0;
  if (kernel == screen_kernel::gauss) return exp(-2 * (s * s + t * t));
  if (s >= 0 && t >= 0) return std::max(0.0, 1 - std::max(s, t));
  if (s < 0 && t < 0) return std::max(0.0, 1 + std::min(s, t));
  return std::max(0.0, s >= 0 ? 1 - s + t : 1 + s - t);
}

ideal_image filter_on_screen(const matrix& m, screen_size size, const map_function& map, screen_kernel kernel, kernel_plane on, int samples,
                             rgba8 background, int threads) {
  const int reach = reach_of(kernel, samples), side = 2 * reach;
  std::vector<double> weights(size_t(side) * size_t(side));
  for (int b = 0; b < side; ++b)
    for (int a = 0; a < side; ++a)
      weights[size_t(b) * size_t(side) + size_t(a)] = kernel_at(kernel, (a - reach + 0.5) / samples, (b - reach + 0.5) / samples);
  ideal_image out{size.width_px, size.height_px, std::vector<ideal_colour>(size_t(size.width_px) * size_t(size.height_px))};
  const ideal_colour nothing{double(background.r), double(background.g), double(background.b), double(background.a)};
  for_each_index(size.height_px, threads, [&](int j) {
    for (int i = 0; i < size.width_px; ++i) {
      ideal_colour& pixel = out.pixels[size_t(j) * size_t(size.width_px) + size_t(i)];
      pixel = nothing;
      const double centre_w = position(m, i + 0.5, j + 0.5).w;
      if (!(centre_w > 0)) continue;
      double sum = 0, weight = 0;
      for (int b = 0; b < side; ++b)
        for (int a = 0; a < side; ++a) {
          double h = weights[size_t(b) * size_t(side) + size_t(a)];
          if (h == 0) continue;
          const ideal_position p = position(m, i + 0.5 + (a - reach + 0.5) / samples, j + 0.5 + (b - reach + 0.5) / samples);
          if (!(p.w > 0)) continue;
          if (on == kernel_plane::map) h *= pow(centre_w / p.w, kernel == screen_kernel::hat ? 4 : 3);
          sum += h * map(p.u, p.v);
          weight += h;
        }
      const double gray = sum / weight;
      pixel = {gray, gray, gray, 255};
    }
  });
  return out;
}

double chessboard_at(double u, double v, double side) {
  const auto square = [side](double x) { return int64_t(floor(x / side)); };
  return ((square(u) ^ square(v)) & 1) == 0 ? 0 : 255;
}

}  // namespace spantex::sim
