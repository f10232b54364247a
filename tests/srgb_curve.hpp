// SPDX-License-Identifier: Apache-2.0
// The curve of sRGB (IEC 61966-2-1) in doubles, which the tests hold the integer tables against.
#pragma once
#include <cmath>

namespace spantex::sim {

inline double to_linear(double code) {  // 0..255 to 0..1
  const double x = code / 255;
  return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
}

inline double to_code(double linear) {  // 0..1 to 0..255
  return 255 * (linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055);
}

}  // namespace spantex::sim
