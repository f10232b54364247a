// SPDX-License-Identifier: Apache-2.0
// Planes in floating point: what the integer set-up approximates, and its inverse step, doubles to exact integers.
#pragma once
#include <array>
#include <optional>

#include <spantex/plane.hpp>
#include <spantex/polygon.hpp>

namespace spantex::sim {

// u = (a x + b y + c)/(g x + h y + i), v = (d x + e y + f)/(...), in the order a b c d e f g h i; x, y in pixels from the top left,
// u, v in texels. A point with divisor <= 0 is behind the viewer.
using matrix = std::array<double, 9>;

struct ideal_position { double u, v, w; };

inline ideal_position position(const matrix& m, double x, double y) {
  const double w = m[6] * x + m[7] * y + m[8];
  return {(m[0] * x + m[1] * y + m[2]) / w, (m[3] * x + m[4] * y + m[5]) / w, w};
}

// All nine times one power of two, so that the largest has 100 bits: exact unless a coefficient is below 2^-100 of it.
homography to_homography(const matrix& m);

// The matrix of the plane through three vertices of a polygon; empty if they lie on a line through the viewer.
std::optional<matrix> matrix_of(const vertex* vertices, int count, const projection& camera);

// KT88's plane (METHODS section 1) from its parameters.
matrix matrix_of(const kt88_plane& plane, const view& view);

}  // namespace spantex::sim
