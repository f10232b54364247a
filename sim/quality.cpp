// SPDX-License-Identifier: Apache-2.0
#include "quality.hpp"

#include <math.h>
#include <stdlib.h>

#include <algorithm>
#include <array>
#include <limits>

namespace spantex::sim {
namespace {

constexpr int colour_count = 3;

double to_db(double squares, size_t samples) {
  if (squares == 0) return std::numeric_limits<double>::infinity();
  return 10 * log10(255.0 * 255.0 * double(samples) / squares);
}

std::array<int, channel_count> channels(rgba8 c) { return {c.r, c.g, c.b, c.a}; }

struct field {
  int width, height;
  std::vector<double> values;
  double at(int x, int y) const { return values[size_t(y) * size_t(width) + size_t(x)]; }
};

field luma(const image& a) {
  field f{a.width_px, a.height_px, {}};
  for (const rgba8& c : a.pixels) f.values.push_back(0.299 * c.r + 0.587 * c.g + 0.114 * c.b);
  return f;
}

field product(const field& a, const field& b) {
  field f = a;
  for (size_t k = 0; k < f.values.size(); ++k) f.values[k] *= b.values[k];
  return f;
}

constexpr int window_reach = 5;

// Gaussian mean along one axis, cut and renormalised at the ends.
field smoothed(const field& in, int dx, int dy) {
  std::array<double, 2 * window_reach + 1> gauss;
  for (int k = -window_reach; k <= window_reach; ++k) gauss[size_t(k + window_reach)] = exp(-k * k / (2 * 1.5 * 1.5));
  field out = in;
  for (int y = 0; y < in.height; ++y)
    for (int x = 0; x < in.width; ++x) {
      double sum = 0, weight = 0;
      for (int k = -window_reach; k <= window_reach; ++k) {
        const int px = x + k * dx, py = y + k * dy;
        if (px < 0 || py < 0 || px >= in.width || py >= in.height) continue;
        sum += gauss[size_t(k + window_reach)] * in.at(px, py);
        weight += gauss[size_t(k + window_reach)];
      }
      out.values[size_t(y) * size_t(in.width) + size_t(x)] = sum / weight;
    }
  return out;
}

field windowed(const field& in) { return smoothed(smoothed(in, 1, 0), 0, 1); }

}  // namespace

double psnr_db(const image& a, const ideal_image& b) {
  double squares = 0;
  for (size_t k = 0; k < a.pixels.size(); ++k) {
    const auto ca = channels(a.pixels[k]);
    for (size_t n = 0; n < colour_count; ++n) {
      const double d = ca[n] - b.pixels[k][n];
      squares += d * d;
    }
  }
  return to_db(squares, a.pixels.size() * colour_count);
}

double psnr_db(const image& a, const image& b) {
  double squares = 0;
  for (size_t k = 0; k < a.pixels.size(); ++k) {
    const auto ca = channels(a.pixels[k]), cb = channels(b.pixels[k]);
    for (size_t n = 0; n < colour_count; ++n) squares += double((ca[n] - cb[n]) * (ca[n] - cb[n]));
  }
  return to_db(squares, a.pixels.size() * colour_count);
}

double ssim(const image& a, const image& b) {
  constexpr double c1 = (0.01 * 255) * (0.01 * 255), c2 = (0.03 * 255) * (0.03 * 255);
  const field x = luma(a), y = luma(b);
  const field mx = windowed(x), my = windowed(y);
  const field xx = windowed(product(x, x)), yy = windowed(product(y, y)), xy = windowed(product(x, y));
  double sum = 0;
  for (size_t k = 0; k < x.values.size(); ++k) {
    const double ux = mx.values[k], uy = my.values[k];
    const double vx = xx.values[k] - ux * ux, vy = yy.values[k] - uy * uy, cov = xy.values[k] - ux * uy;
    sum += (2 * ux * uy + c1) * (2 * cov + c2) / ((ux * ux + uy * uy + c1) * (vx + vy + c2));
  }
  return sum / double(x.values.size());
}

difference compare(const image& a, const image& b) {
  difference d;
  for (size_t k = 0; k < a.pixels.size(); ++k) {
    const auto ca = channels(a.pixels[k]), cb = channels(b.pixels[k]);
    for (size_t n = 0; n < channel_count; ++n) d.worst = std::max(d.worst, abs(ca[n] - cb[n]));
    d.differing_px += a.pixels[k] == b.pixels[k] ? 0 : 1;
  }
  return d;
}

image difference_picture(const image& a, const image& b) {
  image out(a.width_px, a.height_px, {0, 0, 0, 255});
  for (size_t k = 0; k < a.pixels.size(); ++k) {
    const auto ca = channels(a.pixels[k]), cb = channels(b.pixels[k]);
    out.pixels[k] = {uint8_t(abs(ca[0] - cb[0])), uint8_t(abs(ca[1] - cb[1])), uint8_t(abs(ca[2] - cb[2])), 255};
  }
  return out;
}

double flat_psnr_db(const ideal_image& reference) {
  ideal_colour mean{};
  for (const ideal_colour& c : reference.pixels)
    for (size_t k = 0; k < c.size(); ++k) mean[k] += c[k] / double(reference.pixels.size());
  const auto byte = [&](size_t k) { return uint8_t(lround(mean[k])); };
  return psnr_db(image(reference.width_px, reference.height_px, {byte(0), byte(1), byte(2), byte(3)}), reference);
}

double worst_error(const image& a, const ideal_image& b) {
  double worst = 0;
  for (size_t k = 0; k < a.pixels.size(); ++k) {
    const std::array<int, channel_count> c = channels(a.pixels[k]);
    for (size_t n = 0; n < colour_count; ++n) worst = std::max(worst, fabs(c[n] - b.pixels[k][n]));
  }
  return worst;
}

image rounded(const ideal_image& a) {
  image out(a.width_px, a.height_px, {});
  const auto byte = [](double x) { return uint8_t(std::clamp(floor(x + 0.5), 0.0, 255.0)); };
  for (size_t k = 0; k < a.pixels.size(); ++k) {
    const ideal_colour& c = a.pixels[k];
    out.pixels[k] = {byte(c[0]), byte(c[1]), byte(c[2]), byte(c[3])};
  }
  return out;
}

}  // namespace spantex::sim
