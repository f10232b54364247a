// SPDX-License-Identifier: Apache-2.0
// Vector kernels: spans planned by the specification's own set-up (spantex/coordinates.hpp, spantex/level.hpp). Included by the machines' files alone.
#pragma once

// Plans the spans of a row of work, one after another, from the first on. Not usable where the span is left: behind or across the
// horizon, out of range, or with set-up's rounding in sight.
template <filter Kind>
class planner {
 public:
  SPANTEX_INLINE explicit planner(const row_work& work) : work_(work), sx_(work.sx) {}
  SPANTEX_INLINE void next(int count, span_coefficients* c, bool* usable) {
    for (int k = 0; k < count; ++k) usable[k] = next(c[k]);
  }
  SPANTEX_INLINE void skip(int count) { sx_ += count; }

 private:
  SPANTEX_INLINE bool next(span_coefficients& c) {
    const plane& p = *work_.map;
    const int32_t hx = 2 * span_side * sx_++ + span_side, hy = 2 * span_side * work_.sy + span_side;
    if (p.w_at(hx, hy) <= 0) return false;
    const reference r = reference_at(p, hx, hy);
    if (!span_coordinates(r, q, c)) return false;
    const int extent_log2 = max_of(0, q.offset_bits - 1 - c.exponent);
    return rounding_is_small(p, r.w, reach_bits(r, 2 << extent_log2)) && magnitude(r.base_u) <= largest_base(Kind) && magnitude(r.base_v) <= largest_base(Kind);
  }

  const row_work& work_;
  int32_t sx_;
};
