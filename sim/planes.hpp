// SPDX-License-Identifier: Apache-2.0
// Planes that pictures are made of, for 640x480 pixels and a map of 512 texels; `stretched` to other sizes. The first three are scenes (figures.hpp); close, magnified
// five to eight times, far, a wall to the side, and horizon, a floor with its horizon in the picture, are measured besides. The others' divisor is positive over the whole picture.
#pragma once
#include "ideal.hpp"

namespace spantex::sim {

inline constexpr matrix facing_plane{0.912053716, -0.314742496, -140.780791, -0.331960405, -0.8647479, 521.306321, 0, 0.000288959809, 0.896575472},
    tilted_plane{0.621854806, -0.142806403, -12.2821072, -0.226336639, -0.392357368, 585.413164, 0, 0.000855254125, 0.43752662},
    grazing_plane{0.310927403, -0.0343267394, 3.36869896, -0.11316832, -0.0943119413, 318.834413, 0, 0.00106181177, 0.0541821689},
    close_plane{0.142, -0.071, 61.3, 0.083, 0.127, 17.9, 0.00021, 0.00033, 0.871},
    far_plane{1.913, 0.307, 101.7, -0.211, 1.297, 702.3, 0.00115, 0.0001, 0.253},
    horizon_plane{0.320643884, -0.00998412842, 2.00574385, -0.11670483, -0.0274311674, 324.764068, 0, 0.00111220652, -0.179773822};

}  // namespace spantex::sim
