// SPDX-License-Identifier: Apache-2.0
// Vector kernels: plan.hpp's set-up for machines with 64-bit lanes and a shift for each: as many spans side by side. Included by the machines' files alone.
#pragma once

constexpr int wide_lanes = width / 2;
constexpr int planned_at_once = wide_lanes == 4 ? 2 : 1;  // groups of lanes; two save time, but no instructions, which NEON's promise counts
static_assert(batch % (planned_at_once * wide_lanes) == 0);

SPANTEX_INLINE v_s64 all(int64_t x) { return v_s64{} + x; }
SPANTEX_INLINE v_s64 least(v_s64 a, v_s64 b) { return a < b ? a : b; }
SPANTEX_INLINE v_s64 largest(v_s64 a, v_s64 b) { return a > b ? a : b; }
SPANTEX_INLINE v_s64 signs(v_s64 x) { return x >> 63; }
SPANTEX_INLINE v_s64 times_reach(v_s64 x) { return (x << 3) - x; }
static_assert(reach == 7);

// x times bases, modulo 2^64.
SPANTEX_INLINE v_s64 times_bases(v_s64 x, v_s64 base) {
  const v_64 size = v_64(size_of(base));
  return negated_where(v_s64(wide_products(v_64(x), size) + (wide_products(v_64(x) >> 32, size) << 32)), signs(base));
}

// quotient(), the shift given: 63 + exponent - drop - scale.
SPANTEX_INLINE v_s64 quotients(v_s64 n, v_s64 drop, v_64 y, v_s64 shift) {
  return negated_where(v_s64(rounded_shift(wide_products(v_64(size_of(n)) >> v_64(drop), y), v_64(shift))), signs(n));
}

// invert(), of numbers of so many bits: 2^63 / mantissa, u0.32.
SPANTEX_INLINE v_64 inverses(v_s64 w, v_s64 bits) {
  const v_64 mantissas = v_64(w) << v_64(64 - bits) >> 32;
  return reciprocal_wide(mantissas, seeds_at(mantissas >> (31 - reciprocal_seed_bits) & ((1 << reciprocal_seed_bits) - 1)));
}

// whole_quotient(), where n, of so many bits, is not too large for it: false in `in`.
SPANTEX_INLINE v_s64 whole_quotients(v_s64 n, v_s64 bits, v_s64 w_bits, v_64 y, v_s64& in) {
  const v_s64 drop = largest(bits - 31, all(0));
  in &= v_s64((v_64(size_of(n)) >> v_64(w_bits + 15)) == 0);
  return quotients(n, drop, y, w_bits - 32 + 63 - drop);
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
    if (slope == 0) {
      w_bits_ = bit_lengths(w_);
      y_ = inverses(w_, w_bits_);
    }
  }

  // count: a multiple of wide_lanes, or no more follow.
  SPANTEX_INLINE void next(int count, span_coefficients* c, bool* usable) { faces_the_viewer() ? plan<true>(count, c, usable) : plan<false>(count, c, usable); }
  SPANTEX_INLINE void skip(int count) {
    w_ += 2 * span_side * count * plane_.w.x;
    u_ += 2 * span_side * count * plane_.u.x;
    v_ += 2 * span_side * count * plane_.v.x;
  }

 private:
  struct group {
    v_s64 w, nu, nv, w_bits, in, base_u, base_v, c_u, a_u, b_u, c_v, a_v, b_v, extent_log2, exponent, drop, shift, g, h, slope_log2, terms;
    v_64 y;
    SPANTEX_INLINE v_s64 y_exponent() const { return w_bits - 32; }
  };

  // Step by step for several groups of lanes: a plan is one chain of dependent operations, and two of them take little longer than one.
  template <bool Facing>
  SPANTEX_INLINE void plan(int count, span_coefficients* c, bool* usable) {
    for (int k = 0; k < count; k += planned_at_once * wide_lanes) {
      group planned[planned_at_once];
      const int wanted = min_of(planned_at_once, (count - k + wide_lanes - 1) / wide_lanes);
      const auto each = [&](auto&& step) SPANTEX_INLINED {
#pragma GCC unroll 2
        for (int n = 0; n < wanted; ++n) step(planned[n], k + n * wide_lanes);
      };
      each([&](group& g, int) SPANTEX_INLINED { begin<Facing>(g); });
      each([&](group& g, int) SPANTEX_INLINED { find_bases(g); });
      each([&](group& g, int) SPANTEX_INLINED { find_extents<Facing>(g); });
      each([&](group& g, int) SPANTEX_INLINED { find_slopes<Facing>(g); });
      each([&](group& g, int first) SPANTEX_INLINED { put(g, c + first, usable + first); });
    }
  }

  template <bool Facing>
  SPANTEX_INLINE void begin(group& s) {
    const plane& p = plane_;
    s.w = w_;
    s.nu = u_;
    s.nv = v_;
    constexpr int across = wide_lanes * 2 * span_side;
    w_ += across * p.w.x;
    u_ += across * p.u.x;
    v_ += across * p.v.x;
    s.in = (s.w > 0) & (all(slope_) < (s.w >> 1) - (s.w >> 8));
    if constexpr (Facing) {
      s.w_bits = w_bits_;
      s.y = y_;
    } else {
      s.w_bits = bit_lengths(s.w);
      s.y = inverses(s.w, s.w_bits);
    }
  }

  // W is constant, and so is what follows from it alone.
  SPANTEX_INLINE bool faces_the_viewer() const { return slope_ == 0; }

  SPANTEX_INLINE static void find_bases(group& s) {
    const auto base = [&](v_s64 n) SPANTEX_INLINED {
      const v_s64 r = whole_quotients(n, bit_lengths(size_of(n)), s.w_bits, s.y, s.in);
      s.in &= size_of(r) <= largest_base(Kind);
      return r;
    };
    s.base_u = base(s.nu);
    s.base_v = base(s.nv);
  }

  // coordinates_within()
  template <bool Facing>
  SPANTEX_INLINE void find_extents(group& s) const {
    const plane& p = plane_;
    s.c_u = s.nu - times_bases(s.w, s.base_u);
    s.c_v = s.nv - times_bases(s.w, s.base_v);
    s.a_u = all(p.u.x);
    s.b_u = all(p.u.y);
    s.a_v = all(p.v.x);
    s.b_v = all(p.v.y);
    if constexpr (!Facing) {
      s.a_u -= times_bases(all(p.w.x), s.base_u);
      s.b_u -= times_bases(all(p.w.y), s.base_u);
      s.a_v -= times_bases(all(p.w.x), s.base_v);
      s.b_v -= times_bases(all(p.w.y), s.base_v);
    }
    const auto extent_of = [](v_s64 x, v_s64 right, v_s64 down) SPANTEX_INLINED { return size_of(x) + times_reach(size_of(right) + size_of(down)); };
    const v_s64 extent_bits = bit_lengths(largest(extent_of(s.c_u, s.a_u, s.b_u), extent_of(s.c_v, s.a_v, s.b_v)));
    s.extent_log2 = extent_bits - s.w_bits + 1;
    s.in &= s.extent_log2 <= max_extent_log2;
    s.exponent = least(q.offset_bits - 1 - s.extent_log2, all(max_exponent));
    s.drop = largest(extent_bits - 31, all(0));
    s.shift = s.y_exponent() + 63 - s.drop - s.exponent;
  }

  // And the evaluation that they allow: choose_evaluation().
  template <bool Facing>
  SPANTEX_INLINE void find_slopes(group& s) const {
    const plane& p = plane_;
    s.g = s.h = s.terms = all(0);
    s.slope_log2 = all(least_slope_log2);
    if constexpr (!Facing) {
      const v_s64 slope_shift = s.y_exponent() + (63 - slope_drop_ - q.reciprocal_bits);
      s.g = quotients(all(p.w.x), all(slope_drop_), s.y, slope_shift);
      s.h = quotients(all(p.w.y), all(slope_drop_), s.y, slope_shift);
      const v_s64 steepness = times_reach(size_of(s.g) + size_of(s.h)), slope_log2 = largest(bit_lengths(steepness) - q.reciprocal_bits, all(least_slope_log2));
      const v_s64 steep = slope_log2 > most_series_slope_log2, affine_log2 = s.extent_log2 + slope_log2 + 1, resolution = (q.offset_bits - 1) - s.exponent + slope_log2;
      const v_s64 series = ~steep & (resolution <= series_bits - 3 - q.tolerance_bits);
      v_s64 terms = all(divide_terms), error_log2 = affine_log2 + slope_log2 * most_series_terms;
      for (int n = most_series_terms; n >= 1; --n, error_log2 -= slope_log2) terms = (series & (error_log2 <= -q.tolerance_bits - 1)) != 0 ? all(n) : terms;
      s.terms = ((steepness == 0) | (affine_log2 - steep <= -q.tolerance_bits)) != 0 ? all(0) : terms;
      s.slope_log2 = slope_log2;
    }
    if (p.rounding_bits != 0) {  // rounding_is_small()
      const v_s64 reached = v_s64((v_64{} + 2) << v_64(largest(q.offset_bits - 1 - s.exponent, all(0)))), farthest = largest(size_of(s.base_u), size_of(s.base_v)) + reached + 2;
      s.in &= bit_lengths(farthest) + (p.rounding_bits + set_up_tolerance_bits) < s.w_bits;
    }
  }

  // Mantissas, and all of it to its spans.
  SPANTEX_INLINE static void put(const group& s, span_coefficients* c, bool* usable) {
    const auto mantissa = [&](v_s64 n) SPANTEX_INLINED { return quotients(n, s.drop, s.y, s.shift); };
    const v_s64 fields[] = {s.base_u, s.base_v, mantissa(s.c_u), mantissa(s.a_u), mantissa(s.b_u), mantissa(s.c_v), mantissa(s.a_v), mantissa(s.b_v), s.g, s.h, s.exponent, s.slope_log2, s.terms, s.in};
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
  v_s64 w_bits_{};   // where W is constant
  v_64 y_{};
  int64_t slope_;
  int slope_drop_;
};
