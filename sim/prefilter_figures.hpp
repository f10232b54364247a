// SPDX-License-Identifier: Apache-2.0
// What a prefilter does to a map, measured on maps that it has filtered: the response to gratings, aliasing, ringing beyond an edge, and the
// quality of the three planes.
#pragma once
#include <vector>

#include "draw_host.hpp"
#include "pack.hpp"

namespace spantex::sim {

// Cycles per texel of the level. Above 1/2 is what cannot be shown there and comes back as something else: aliasing.
struct grating { int sixteenths; };
inline constexpr grating shown_gratings[] = {{1}, {2}, {4}, {6}, {8}};
inline constexpr grating aliased_gratings[] = {{10}, {12}, {14}};

struct prefilter_figures {
  std::vector<double> response;    // to shown_gratings: 1 is unchanged
  std::vector<double> aliased;     // to aliased_gratings: 0 is best
  int overshoot = 0;               // of an edge from 64 to 192, in units of 255
};

// At a level in 1..4. Gratings of amplitude 100 about 127.5 along u, fifteen phases each; 1/2 is taken 1/256 below it, where phase does not
// matter. Edges at every position relative to the level's texels.
prefilter_figures figures_of(const compile_options& options, int level);

}  // namespace spantex::sim
