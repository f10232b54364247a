// SPDX-License-Identifier: Apache-2.0
// Kernels: planes that are scaled along their axes, whatever the registers. Included by the machines' files alone.
#pragma once

#include "rounded.hpp"

// What along(row) interpolates along two rows of texels: the next row of pixels lies between the same, or takes over one of them.
template <class Colours>
struct two_rows {
  const rgba8 *upper = nullptr, *lower = nullptr;
  Colours above, below;
  SPANTEX_INLINE void to(const rgba8* next_upper, const rgba8* next_lower, auto&& along) {
    const Colours before = above;
    if (next_upper == lower) above = below;
    else if (next_upper != upper) above = along(next_upper);
    if (next_lower == upper) below = before;
    else if (next_lower != lower) below = along(next_lower);
    upper = next_upper;
    lower = next_lower;
  }
};
