// SPDX-License-Identifier: Apache-2.0
// Convolution in double precision, on the screen (GCK09, formula 4) and as filters step and hat mean it, on the map (formula 9).
//
// A pixel is sum(S H) / sum(H) over n x n samples a unit pixel, at ((a + 1/2)/n, (b + 1/2)/n) of each, n even; S is a function of the map's
// plane. Samples with W <= 0 are left out; a pixel whose centre has W <= 0 is background.
#pragma once
#include <stdint.h>

#include <functional>

#include "ideal.hpp"
#include "parallel.hpp"
#include "reference.hpp"
#include "scene.hpp"

namespace spantex::sim {

// step   1 on the unit square
// hat    1 - max(s, t) for s, t >= 0, 1 + min(s, t) for s, t < 0, 1 - s + t for s >= 0 > t, 1 + s - t for s < 0 <= t; never below 0
// gauss  a Gaussian of standard deviation 1/2 on the square +-3/2: judges both without being either
enum class screen_kernel : uint8_t { step, hat, gauss };
double kernel_at(screen_kernel kernel, double s, double t);

// Where the kernel is built. The map's sample has the Jacobian's weight 1/W^3 that the screen's substitution cancels; a height that is
// linear on a triangle of the map is the screen's times W0/W. So on the map step is weighted by (W0/W)^3, hat by (W0/W)^4.
enum class kernel_plane : uint8_t { screen, map };

using map_function = std::function<double(double u, double v)>;  // gray, 0..255

ideal_image filter_on_screen(const matrix& m, screen_size size, const map_function& map, screen_kernel kernel, kernel_plane on, int samples,
                             rgba8 background, int threads);

// GCK09's chessboard, squares of `side` texels: black where floor(u / side) and floor(v / side) have the same parity, else white.
double chessboard_at(double u, double v, double side);

}  // namespace spantex::sim
