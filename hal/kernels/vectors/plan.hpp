// SPDX-License-Identifier: Apache-2.0
// Vector kernels: spans planned by the specification's own set-up (spantex/coordinates.hpp, spantex/level.hpp). Included by the machines' files alone.
#pragma once

constexpr profile q = profiles::standard;
using prof = fixed_profile<q>;
static_assert(q.offset_bits == 31 && q.reciprocal_bits == 30 && q.subtexel_bits == 7 && q.level_bits == 8 && q.blend_bits == 7 && q.coordinate_bits == 14 &&
              q.level_bias == 0 && q.formula == level_formula::jacobian && q.scope == level_scope::pixel && q.overflow == overflow_policy::split &&
              q.position_rounding == rounding::nearest && q.exact_set_up && q.colour_rounding == rounding::even, "the kernels are written for these");

constexpr int32_t largest_base = 32767 - 4098;  // no position saturates: they lie within 2^max_extent_log2 texels

SPANTEX_INLINE int32_t modulo(int32_t base, int32_t period) {
  if (period == 0) return base;
  const int32_t k = base % period;
  return k < 0 ? k + period : k;
}

// False where the scalar engine must draw the span: behind or across the horizon, out of range, or with set-up's rounding in sight.
template <filter Kind>
SPANTEX_INLINE bool plan_span(const row_work& work, int32_t sx, span_coefficients& c) {
  const plane& p = *work.map;
  const row_levels& levels = work.texels->levels_in_rows();
  const int32_t hx = 2 * span_side * sx + span_side, hy = 2 * span_side * work.sy + span_side;
  if (p.w_at(hx, hy) <= 0) return false;
  const reference r = reference_at(p, hx, hy);
  if (!span_coordinates(r, q, c)) return false;
  const int extent_log2 = max_of(0, q.offset_bits - 1 - c.exponent);
  if (!rounding_is_small(p, r.w, reach_bits(r, 2 << extent_log2))) return false;
  if (magnitude(r.base_u) > largest_base || magnitude(r.base_v) > largest_base || (1 << extent_log2) > levels.place_limit()) return false;
  c.base_u = modulo(c.base_u, levels.modulo_u());
  c.base_v = modulo(c.base_v, levels.modulo_v());
  c.last_level = uint8_t(work.last_level);
  if constexpr (uses_levels(Kind)) span_levels(q, c);
  return true;
}
