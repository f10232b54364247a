// SPDX-License-Identifier: Apache-2.0
// Vectors of world space.
#pragma once
#include <math.h>

#include <array>

namespace spantex::sim {

using vector3d = std::array<double, 3>;

inline vector3d operator+(const vector3d& a, const vector3d& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline vector3d operator-(const vector3d& a, const vector3d& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline vector3d operator*(const vector3d& a, double k) { return {a[0] * k, a[1] * k, a[2] * k}; }
inline double dot(const vector3d& a, const vector3d& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline double length(const vector3d& a) { return sqrt(dot(a, a)); }
inline vector3d cross(const vector3d& a, const vector3d& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

}  // namespace spantex::sim
