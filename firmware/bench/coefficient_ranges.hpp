// SPDX-License-Identifier: Apache-2.0
// The ranges in which the datapath is defined, checked for coefficients that come over wires: whatever is accepted here, every shift, sum, index and
// loop of compute_span stays within its type, its table and its bound, for every mask and any texels. What the planner makes is accepted (both:
// tests/unit/coefficient_ranges.cpp, and fuzzed). Input: coefficients as archived, so that enumerations and bools have values that exist.
//
// Offsets are counted in half pixels from the reference point: 7 to the outermost pixel centres, 9 to their corners (step, hat), 2 about one pixel.
#pragma once
#include <stdint.h>

#include <spantex/accuracy.hpp>
#include <spantex/area.hpp>
#include <spantex/bits.hpp>
#include <spantex/coordinates.hpp>
#include <spantex/footprint.hpp>
#include <spantex/level.hpp>
#include <spantex/profile.hpp>
#include <spantex/span.hpp>

namespace spantex::bench {

inline constexpr int most_level = 12;              // of maps of 4096
inline constexpr int32_t most_base = 32768;        // texels of level 0
inline constexpr int32_t most_origin = 1 << 17;    // of a section: positions and what lies beside them

namespace detail {

constexpr bool in_range(int64_t x, int64_t least, int64_t most) { return least <= x && x <= most; }

// The farthest that c + a hx + b hy gets from 0. Below 2^37.
constexpr uint64_t reach_of(int32_t c, int32_t a, int32_t b, int farthest) {
  return magnitude(c) + uint64_t(farthest) * (magnitude(a) + magnitude(b));
}

constexpr int farthest_offset(const span_coefficients& c) {
  if (!uses_area(c.kind)) return reach;
  return c.centred ? 2 : area_reach({});
}

// Numerators fit their mantissas, reach no farther than the planner lets them (their roundings allowed for), and every shift to
// coordinate_bits is one that the profile's numbers have.
constexpr bool position_in_range(const profile& q, const span_coefficients& c, int farthest) {
  if (!in_range(c.base_u, -most_base, most_base) || !in_range(c.base_v, -most_base, most_base)) return false;
  if (!in_range(c.exponent, 0, max_exponent)) return false;
  const uint64_t u = reach_of(c.c_u, c.a_u, c.b_u, farthest), v = reach_of(c.c_v, c.a_v, c.b_v, farthest), n = u > v ? u : v;
  if (n >= uint64_t(1) << q.offset_bits || n > (uint64_t(1) << (c.exponent + max_extent_log2)) + 16) return false;
  // A series multiplies by up to 4/3 where w falls to 3/4.
  if (c.how == evaluation::series && n > (uint64_t(1) << (q.offset_bits - 1)) + 16) return false;
  const int shift = c.exponent - q.coordinate_bits + (c.how == evaluation::divide ? q.reciprocal_bits : 0);
  return shift <= longest_position_shift(q);
}

// w stays in (1/2, 3/2), |w - 1| below 2^slope_log2; a series has the slopes and terms that its 16-bit products hold.
constexpr bool w_in_range(const profile& q, const span_coefficients& c, int farthest) {
  const uint64_t slope = reach_of(0, c.g, c.h, farthest);
  if (!in_range(c.slope_log2, least_slope_log2, 0) || slope >= uint64_t(1) << (q.reciprocal_bits - 1)) return false;
  if (slope >> max_of(0, q.reciprocal_bits + c.slope_log2) != 0) return false;
  return c.how != evaluation::series || (c.slope_log2 <= most_series_slope_log2 && in_range(c.terms, 1, most_series_terms));
}

constexpr bool section_in_range(const section& s) {
  return in_range(s.origin_u, -most_origin, most_origin) && in_range(s.origin_v, -most_origin, most_origin) && s.ratio_u <= uint32_t(1) << 31 &&
         s.ratio_v <= uint32_t(1) << 31 && s.level <= most_level;
}

// A footprint's vector fits the mantissas, a contour's Jacobian 32 bits.
constexpr bool axis_in_range(const profile& q, const span_coefficients& c) {
  const axis_terms& t = c.axis;
  if (uses_footprint(c.kind)) {
    const uint64_t most = uint64_t(1) << q.offset_bits;
    return reach_of(t.c_u, t.a_u, t.b_u, reach) < most && reach_of(t.c_v, t.a_v, t.b_v, reach) < most &&
           in_range(t.exponent, q.offset_bits - 15, spantex::detail::max_axis_exponent);
  }
  if (c.kind == filter::contour) {
    constexpr uint64_t most = INT32_MAX;
    return reach_of(t.c_u, t.b_u, 0, reach) <= most && reach_of(t.c_v, t.b_v, 0, reach) <= most && reach_of(t.a_u, t.b_u, 0, reach) <= most &&
           reach_of(t.a_v, t.b_v, 0, reach) <= most;
  }
  return true;
}

}  // namespace detail

constexpr bool coefficients_in_range(const profile& q, const span_coefficients& c) {
  if (c.centred && !uses_area(c.kind)) return false;
  if (c.axis.partial && !uses_area(c.kind) && !uses_footprint(c.kind)) return false;
  const int farthest = detail::farthest_offset(c);
  return c.last_level <= most_level && detail::position_in_range(q, c, farthest) && detail::w_in_range(q, c, farthest) &&
         detail::section_in_range(c.fine) && detail::section_in_range(c.coarse) && detail::axis_in_range(q, c);
}

}  // namespace spantex::bench
