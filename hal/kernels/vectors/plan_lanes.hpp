// SPDX-License-Identifier: Apache-2.0
// Vector kernels: plan.hpp's set-up for machines with 64-bit lanes and a shift for each: as many spans side by side. Included by the machines' files alone.
#pragma once

constexpr int wide_lanes = width / 2;
static_assert(batch % wide_lanes == 0);

SPANTEX_INLINE v_s64 all(int64_t x) { return v_s64{} + x; }
SPANTEX_INLINE v_s64 least(v_s64 a, v_s64 b) { return a < b ? a : b; }
SPANTEX_INLINE v_s64 largest(v_s64 a, v_s64 b) { return a > b ? a : b; }
#if !SPANTEX_AVX512
SPANTEX_INLINE v_s64 bit_lengths(v_s64 x) {
  for (int k = 0; k < wide_lanes; ++k) x[k] = x[k] == 0 ? 64 : __builtin_clzll(uint64_t(x[k]));
  return 64 - x;
}
#endif
SPANTEX_INLINE v_s64 times_reach(v_s64 x) { return (x << 3) - x; }
static_assert(reach == 7);

// x times bases, modulo 2^64.
SPANTEX_INLINE v_s64 times_bases(v_s64 x, v_s64 base) {
  const v_64 size = v_64(size_of(base));
  return negated_where(v_s64(wide_products(v_64(x), size) + (wide_products(v_64(x) >> 32, size) << 32)), base < 0);
}

// quotient(), the shift given: 63 + exponent - drop - scale.
SPANTEX_INLINE v_s64 quotients(v_s64 n, v_s64 drop, v_64 y, v_s64 shift) {
  return negated_where(v_s64(rounded_shift(wide_products(v_64(size_of(n)) >> v_64(drop), y), v_64(shift))), n < 0);
}

// Plans the spans of a row of work, from the first on: see plan.hpp.
template <filter Kind>
class planner {
 public:
  SPANTEX_INLINE explicit planner(const row_work& work) : plane_(*work.map) {
    const plane& p = plane_;
    const int32_t hx = 2 * span_side * work.sx + span_side, hy = 2 * span_side * work.sy + span_side;
    v_s64 step{};
    for (int k = 0; k < wide_lanes; ++k) step[k] = 2 * span_side * k;
    w_ = p.w_at(hx, hy) + step * p.w.x;
    u_ = p.u_at(hx, hy) + step * p.u.x;
    v_ = p.v_at(hx, hy) + step * p.v.x;
    const uint64_t slope = uint64_t(reach) * (magnitude(p.w.x) + magnitude(p.w.y));
    slope_ = int64_t(slope);
    slope_drop_ = max_of(0, bit_length(slope) - 31);
  }

  SPANTEX_INLINE void next(int count, span_coefficients* c, bool* usable) {
    for (int k = 0; k < count; k += wide_lanes) next(c + k, usable + k);
  }
  SPANTEX_INLINE void skip(int count) {  // a multiple of wide_lanes, or no more follow
    w_ += 2 * span_side * count * plane_.w.x;
    u_ += 2 * span_side * count * plane_.u.x;
    v_ += 2 * span_side * count * plane_.v.x;
  }

 private:
  SPANTEX_INLINE void next(span_coefficients* c, bool* usable) {
    const plane& p = plane_;
    const v_s64 w = w_, nu = u_, nv = v_;
    constexpr int across = wide_lanes * 2 * span_side;
    w_ += across * p.w.x;
    u_ += across * p.u.x;
    v_ += across * p.v.x;
    v_s64 in = (w > 0) & (all(slope_) < (w >> 1) - (w >> 8));
    const v_s64 w_bits = bit_lengths(w);
    const v_64 mantissas = v_64(w) << v_64(64 - w_bits) >> 32;
    const v_64 y = reciprocal_wide(mantissas, seeds_at(mantissas >> (31 - reciprocal_seed_bits) & ((1 << reciprocal_seed_bits) - 1)));
    const v_s64 y_exponent = w_bits - 32;
    const auto whole_quotients = [&](v_s64 n) SPANTEX_INLINED {
      const v_s64 bits = bit_lengths(size_of(n)), drop = largest(bits - 31, all(0)), r = quotients(n, drop, y, y_exponent + 63 - drop);
      in &= (bits <= w_bits + 15) & (size_of(r) <= largest_base(Kind));
      return r;
    };
    const v_s64 base_u = whole_quotients(nu), base_v = whole_quotients(nv);
    // coordinates_within()
    const v_s64 c_u = nu - times_bases(w, base_u), a_u = p.u.x - times_bases(all(p.w.x), base_u), b_u = p.u.y - times_bases(all(p.w.y), base_u);
    const v_s64 c_v = nv - times_bases(w, base_v), a_v = p.v.x - times_bases(all(p.w.x), base_v), b_v = p.v.y - times_bases(all(p.w.y), base_v);
    const auto extent_of = [](v_s64 x, v_s64 right, v_s64 down) SPANTEX_INLINED { return size_of(x) + times_reach(size_of(right) + size_of(down)); };
    const v_s64 extent_bits = bit_lengths(largest(extent_of(c_u, a_u, b_u), extent_of(c_v, a_v, b_v))), extent_log2 = extent_bits - w_bits + 1;
    in &= extent_log2 <= max_extent_log2;
    const v_s64 exponent = least(q.offset_bits - 1 - extent_log2, all(max_exponent)), drop = largest(extent_bits - 31, all(0)), shift = y_exponent + 63 - drop - exponent;
    const v_s64 slope_shift = y_exponent + (63 - slope_drop_ - q.reciprocal_bits), g = quotients(all(p.w.x), all(slope_drop_), y, slope_shift),
                h = quotients(all(p.w.y), all(slope_drop_), y, slope_shift);
    // choose_evaluation()
    const v_s64 steepness = times_reach(size_of(g) + size_of(h)), slope_log2 = largest(bit_lengths(steepness) - q.reciprocal_bits, all(least_slope_log2));
    const v_s64 steep = slope_log2 > most_series_slope_log2, affine_log2 = extent_log2 + slope_log2 + 1, resolution = (q.offset_bits - 1) - exponent + slope_log2;
    const v_s64 series = ~steep & (resolution <= series_bits - 3 - q.tolerance_bits);
    v_s64 terms = all(divide_terms), error_log2 = affine_log2 + slope_log2 * most_series_terms;
    for (int n = most_series_terms; n >= 1; --n, error_log2 -= slope_log2) terms = (series & (error_log2 <= -q.tolerance_bits - 1)) != 0 ? all(n) : terms;
    terms = ((steepness == 0) | (affine_log2 - steep <= -q.tolerance_bits)) != 0 ? all(0) : terms;
    if (p.rounding_bits != 0) {  // rounding_is_small()
      const v_s64 reached = v_s64((v_64{} + 2) << v_64(largest(q.offset_bits - 1 - exponent, all(0)))), farthest = largest(size_of(base_u), size_of(base_v)) + reached + 2;
      in &= bit_lengths(farthest) + (p.rounding_bits + set_up_tolerance_bits) < w_bits;
    }
    const auto mantissa = [&](v_s64 n) SPANTEX_INLINED { return quotients(n, drop, y, shift); };
    const v_s64 fields[] = {base_u, base_v, mantissa(c_u), mantissa(a_u), mantissa(b_u), mantissa(c_v), mantissa(a_v), mantissa(b_v), g, h, exponent, slope_log2, terms, in};
    alignas(sizeof(v)) int64_t of[sizeof fields / sizeof fields[0]][wide_lanes];
    __builtin_memcpy(of, fields, sizeof fields);
    static constexpr evaluation hows[] = {evaluation::affine, evaluation::series, evaluation::series, evaluation::series, evaluation::series, evaluation::divide};
    for (int k = 0; k < wide_lanes; ++k) {
      span_coefficients& one = c[k];
      const auto field = [&](int n) SPANTEX_INLINED { return int32_t(of[n][k]); };
      one.base_u = field(0); one.base_v = field(1);
      one.c_u = field(2); one.a_u = field(3); one.b_u = field(4);
      one.c_v = field(5); one.a_v = field(6); one.b_v = field(7);
      one.g = field(8); one.h = field(9);
      one.exponent = int8_t(field(10));
      one.slope_log2 = int8_t(field(11));
      one.how = hows[field(12)];
      one.terms = uint8_t(field(12));
      usable[k] = field(13) != 0;
    }
  }

  static constexpr int divide_terms = most_series_terms + 1;

  const plane& plane_;
  v_s64 w_, u_, v_;  // of the next spans' centres
  int64_t slope_;
  int slope_drop_;
};
