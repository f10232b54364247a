// SPDX-License-Identifier: Apache-2.0
// Vector kernels: plan.hpp's set-up for machines with four 64-bit lanes and a shift for each: the quotients of a span side by side.
// Included by ../avx2.cpp alone.
#pragma once

typedef int64_t v_s64 __attribute__((vector_size(32)));

SPANTEX_INLINE v_s64 negated_where(v_s64 x, v_s64 negative) { return (x ^ negative) - negative; }

// x times a base, modulo 2^64.
SPANTEX_INLINE v_s64 times_base(v_s64 x, int32_t base) {
  const v_64 b = v_64{} + magnitude(base);
  const v_s64 product = v_s64(wide_products(v_64(x), b) + (wide_products(v_64(x) >> 32, b) << 32));
  return base < 0 ? -product : product;
}

// quotient() of four numerators, with shifts of their own.
SPANTEX_INLINE v_s64 quotients(v_s64 n, v_s64 size, v_64 drop, v_64 y, v_64 shift) {
  const v_64 product = wide_products(v_64(size) >> drop, y);
  return negated_where(v_s64((product + ((v_64{} + 1) << (shift - 1))) >> shift), n < 0);
}

SPANTEX_INLINE uint64_t extent_of(v_s64 size) { return uint64_t(size[0]) + uint64_t(reach) * uint64_t(size[1] + size[2]); }

// What is the same for all spans of a row.
struct row_plan {
  v_s64 w, u, v;                       // (value at the next span's centre, x, y, slope of w): w's last lane is zero, the others' are its x and y
  v_s64 next_w, next_u, next_v;        // what the next span adds
  uint64_t slope;
  int slope_drop;
};

SPANTEX_INLINE row_plan row_plan_of(const row_work& work) {
  const plane& p = *work.map;
  const int32_t hx = 2 * span_side * work.sx + span_side, hy = 2 * span_side * work.sy + span_side;
  const int64_t across = 2 * span_side;
  row_plan r{{p.w_at(hx, hy), p.w.x, p.w.y, 0}, {p.u_at(hx, hy), p.u.x, p.u.y, p.w.x}, {p.v_at(hx, hy), p.v.x, p.v.y, p.w.y},
             {across * p.w.x, 0, 0, 0}, {across * p.u.x, 0, 0, 0}, {across * p.v.x, 0, 0, 0}, uint64_t(reach) * (magnitude(p.w.x) + magnitude(p.w.y)), 0};
  r.slope_drop = max_of(0, bit_length(r.slope) - 31);
  return r;
}

// coordinates_within() and reference_at() of the span that `row` is at.
template <filter Kind>
SPANTEX_INLINE bool plan_coordinates(const plane& p, const row_plan& row, span_coefficients& c) {
  const int64_t w = row.w[0];
  if (w <= 0 || row.slope >= uint64_t(w) / 2 - uint64_t(w) / 256) return false;
  const inverse iw = invert(w);
  bool in_range = true;
  c.base_u = detail::whole_quotient(row.u[0], w, iw, in_range);
  c.base_v = detail::whole_quotient(row.v[0], w, iw, in_range);
  if (!in_range || magnitude(c.base_u) > largest_base(Kind) || magnitude(c.base_v) > largest_base(Kind)) return false;
  const v_s64 u = row.u - times_base(row.w, c.base_u), w_v = row.v - times_base(row.w, c.base_v);
  const v_s64 size_u = negated_where(u, u < 0), size_v = negated_where(w_v, w_v < 0);
  const uint64_t extent_u = extent_of(size_u), extent_v = extent_of(size_v), extent = extent_u > extent_v ? extent_u : extent_v;
  const int extent_bits = bit_length(extent), extent_log2 = extent_bits - bit_length(uint64_t(w)) + 1;
  if (extent_log2 > max_extent_log2) return false;
  const int exponent = mantissa_exponent(q, extent_log2), drop = max_of(0, extent_bits - 31);
  const int shift = 63 + iw.exponent - drop - exponent, slope_shift = 63 + iw.exponent - row.slope_drop - q.reciprocal_bits;
  const v_64 drops = {uint64_t(drop), uint64_t(drop), uint64_t(drop), uint64_t(row.slope_drop)}, y = v_64{} + iw.y;
  const v_64 shifts = {uint64_t(shift), uint64_t(shift), uint64_t(shift), uint64_t(slope_shift)};
  const v qu = v(quotients(u, size_u, drops, y, shifts)), qv = v(quotients(w_v, size_v, drops, y, shifts));
  c.c_u = qu[0]; c.a_u = qu[2]; c.b_u = qu[4]; c.g = qu[6];
  c.c_v = qv[0]; c.a_v = qv[2]; c.b_v = qv[4]; c.h = qv[6];
  c.exponent = int8_t(exponent);
  choose_evaluation(q, reach, extent_log2, true, c);
  const int beyond = max_of(0, q.offset_bits - 1 - exponent);
  return p.rounding_bits == 0 || rounding_is_small(p, w, bit_length(uint64_t(max_of(int32_t(magnitude(c.base_u)), int32_t(magnitude(c.base_v))) + (2 << beyond) + 2)));
}

template <filter Kind>
class planner {
 public:
  SPANTEX_INLINE explicit planner(const row_work& work) : plane_(*work.map), row_(row_plan_of(work)) {}
  SPANTEX_INLINE bool next(span_coefficients& c) {
    const bool usable = plan_coordinates<Kind>(plane_, row_, c);
    row_.w += row_.next_w;
    row_.u += row_.next_u;
    row_.v += row_.next_v;
    if constexpr (uses_levels(Kind) && Kind != filter::aniso)
      if (usable) plan_levels(c);
    return usable;
  }

 private:
  const plane& plane_;
  row_plan row_;
};
