// SPDX-License-Identifier: Apache-2.0
// Vector kernels: what they are written for. Included by the machines' files alone.
#pragma once

#include "inlined.hpp"
#include "rounded.hpp"

constexpr profile q = profiles::standard;
using prof = fixed_profile<q>;
static_assert(q.offset_bits == 31 && q.reciprocal_bits == 30 && q.subtexel_bits == 7 && q.level_bits == 8 && q.blend_bits == 7 && q.coordinate_bits == 14 &&
              q.level_bias == 0 && q.mip_bias == -8 && q.formula == level_formula::jacobian && q.scope == level_scope::pixel && q.overflow == overflow_policy::split &&
              q.position_rounding == rounding::nearest && q.exact_set_up && q.colour_rounding == rounding::even, "the kernels are written for these");

constexpr int batch = 8;  // spans that are planned before they are drawn

// Of colours as coded; linear_light.hpp has its own.
constexpr rounded one_sample = rounded::between_levels;  // of a row of samples

SPANTEX_INLINE int32_t modulo(int32_t base, int32_t period) {
  if (period == 0) return base;
  const int32_t k = base % period;
  return k < 0 ? k + period : k;
}

// How far texels of level 0 lie from a span's base at most: offsets are below 2^extent_log2 before the division, and 1 / (1 - x) <= 1 + 2 x for
// x = 2^slope_log2, 1/2 or less.
SPANTEX_INLINE int32_t reach_of(const span_coefficients& c) {
  const int32_t extent = 1 << max_of(0, q.offset_bits - 1 - c.exponent);
  return extent + (extent >> (-1 - c.slope_log2)) + 1;
}
