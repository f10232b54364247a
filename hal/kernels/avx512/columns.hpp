// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: how eight spans' steps on the screen lie on the map: terms of the level of detail and of the footprint. Included by by_blocks.hpp alone.
#pragma once

// shift_right_symmetric(): nothing is added where nothing is shifted, as 1 shifted by -1 is 0.
SPANTEX_INLINE v8 symmetric8(v8 x, v8 shift) {
  const v8 half = _mm512_sllv_epi64(of64<1>(), _mm512_sub_epi64(shift, of64<1>())), m = _mm512_srlv_epi64(_mm512_add_epi64(_mm512_abs_epi64(x), half), shift);
  return _mm512_mask_sub_epi64(m, _mm512_movepi64_mask(x), _mm512_setzero_si512(), m);
}

// level.hpp: the columns of W^2 J about the span's centre, and the twist.
struct columns8 { v8 u_x, v_x, u_y, v_y, twist_u, twist_v; };
SPANTEX_INLINE columns8 columns_of(const setup& s, const batch& b) {
  const auto product = [&](v8 x, v8 slope) { return symmetric8(_mm512_mul_epi32(x, slope), of64<q.reciprocal_bits>()); };  // times_slope()
  const auto wide = [&](const int32_t (&x)[batch_size]) { return _mm512_cvtepi32_epi64(got(x)); };
  const v8 cu = wide(b.c_u), cv = wide(b.c_v), au = wide(b.a_u), av = wide(b.a_v), bu = wide(b.b_u), bv = wide(b.b_v);
  return {_mm512_sub_epi64(au, product(cu, s.g)), _mm512_sub_epi64(av, product(cv, s.g)), _mm512_sub_epi64(bu, product(cu, s.h)), _mm512_sub_epi64(bv, product(cv, s.h)),
          _mm512_sub_epi64(product(au, s.h), product(bu, s.g)), _mm512_sub_epi64(product(av, s.h), product(bv, s.g))};
}

// Quads' bounds, for steepness s = 7 (|g| + |h|), the most of |1 - w|, up to 1/4: a position is c + (u_x x + u_y y) / w. At a quad's centre (X, Y) half pixels away what
// dividing by w changes is below (X |u_x| + Y |u_y|) e / (1 - e), e the most of |1 - w| there; from there on a position moves by ((u_x + twist Y) x + (u_y - twist X) y) / (w w'), by no
// more than S / ((1 - e) (1 - s)), S = x (|u_x| + Y |twist|) + y (|u_y| + X |twist|) with x, y how far a quad's pixels lie from its centre. Square: X = Y = 4, e = 4/7 s, and both together are
// below S (1 + s (5/2 + 4 s)). Flat: X = 0, Y = 6, e at most 6/7 s: they are below that and 7 s |u_y|; tall likewise.
SPANTEX_INLINE void plan_bounds(const setup& s, const columns8& j, batch& b) {
  const quad_cut& quad = cut_of(b.how);
  const auto part = [](v8 x, v8 of) { return _mm512_srai_epi64(_mm512_mul_epi32(x, of), q.reciprocal_bits); };
  const auto times = [](v8 x, int32_t by) { return _mm512_mul_epi32(x, set(by)); };
  const v8 halves = _mm512_add_epi64(s.steepness, _mm512_srli_epi64(s.steepness, 2));  // 5/4
  const v8 more = _mm512_slli_epi64(_mm512_add_epi64(_mm512_srli_epi64(halves, 1), part(s.steepness, s.steepness)), 2);
  const auto spread = [&](v8 x, v8 y, v8 twist) {
    const v8 of_x = _mm512_abs_epi64(x), of_y = _mm512_abs_epi64(y), moves = _mm512_add_epi64(times(of_x, quad.half_x), times(of_y, quad.half_y));
    const v8 all = _mm512_add_epi64(moves, times(_mm512_abs_epi64(twist), quad.half_x * quad.centre_y + quad.half_y * quad.centre_x));
    const v8 at_centre = b.how == cut::square ? _mm512_setzero_si512() : times(b.how == cut::flat ? of_y : of_x, 7);
    return _mm512_srai_epi64(_mm512_add_epi64(_mm512_add_epi64(all, part(all, more)), part(at_centre, s.steepness)), 2);
  };
  const v16 lower = _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
  const auto keep_both = [&](int32_t (&to)[2 * batch_size], v8 u, v8 v) { _mm512_store_si512(to, _mm512_permutex2var_epi32(u, lower, v)); };
  const auto between = [&](v8 x, v8 y, int32_t by_x, int32_t by_y) { return _mm512_srai_epi64(_mm512_add_epi64(times(x, by_x), times(y, by_y)), 3); };
  keep_both(b.right, between(j.u_x, j.u_y, quad.right_x, quad.right_y), between(j.v_x, j.v_y, quad.right_x, quad.right_y));
  keep_both(b.below, between(j.u_x, j.u_y, quad.below_x, quad.below_y), between(j.v_x, j.v_y, quad.below_x, quad.below_y));
  keep_both(b.spread, spread(j.u_x, j.u_y, j.twist_u), spread(j.v_x, j.v_y, j.twist_v));
}

// Of a level in 2^-16: what rounds it to 2^-8, less the bias of -8 in full.
constexpr int32_t detail_half = (1 << 7) - (1 << 15);
// What leads from lengths' logarithms to levels, less the numbers' exponent.
constexpr int32_t more_of_level = (1 << 16) + detail_half + 32;

// span_levels(). A span is known to be magnified if no row or column is longer than half a texel a pixel on either axis and |1 - w| < 2^-4: lengths are then
// below sqrt(2) / 2 (16 / 15)^2 = 0.81, which is 0.3 of a level less than what rounds to 0.
SPANTEX_INLINE void plan_levels(const setup& s, batch& b) {
  const columns8 j = columns_of(s, b);
  _mm512_store_si512(b.u_x, j.u_x);
  _mm512_store_si512(b.v_x, j.v_x);
  _mm512_store_si512(b.u_y, j.u_y);
  _mm512_store_si512(b.v_y, j.v_y);
  _mm512_store_si512(b.twist_u, j.twist_u);
  _mm512_store_si512(b.twist_v, j.twist_v);
  // The least and the most that rows' and columns' components are long.
  const auto bounds = [](v8 step, v8 twist, v8& least, v8& most) {
    const v8 size = _mm512_abs_epi64(step), aside = times7(_mm512_abs_epi64(twist));
    least = _mm512_max_epi64(_mm512_sub_epi64(size, aside), _mm512_setzero_si512());
    most = _mm512_add_epi64(size, aside);
  };
  v8 least[4], most[4];
  bounds(j.u_x, j.twist_u, least[0], most[0]);
  bounds(j.v_x, j.twist_v, least[1], most[1]);
  bounds(j.u_y, j.twist_u, least[2], most[2]);
  bounds(j.v_y, j.twist_v, least[3], most[3]);
  const v8 longest = _mm512_max_epi64(_mm512_max_epi64(most[0], most[1]), _mm512_max_epi64(most[2], most[3])), quarter = _mm512_sllv_epi64(set(1), _mm512_sub_epi64(s.exponent, set(2)));  // steps are half pixels
  b.magnified = _mm512_cmple_epi64_mask(longest, quarter) & _mm512_cmple_epi64_mask(s.slope_log2, set(-4));
  b.rows_longer = _mm512_cmpge_epi64_mask(squares_of(least[0], least[1]), squares_of(most[2], most[3]));
  b.columns_longer = _mm512_cmpge_epi64_mask(squares_of(least[2], least[3]), squares_of(most[0], most[1]));
  put(b.more_of_level, _mm256_sub_epi32(_mm256_set1_epi32(more_of_level), _mm256_slli_epi32(narrowed(s.exponent), 16)));
  plan_bounds(s, j, b);
}

// cos, then sin of direction_at(k).
struct alignas(64) direction_table {
  int16_t cos[direction_count], sin[direction_count];
  constexpr direction_table() : cos(), sin() {
    for (int k = 0; k < direction_count; ++k) {
      cos[k] = int16_t(direction_at(k).cos);
      sin[k] = int16_t(direction_at(k).sin);
    }
  }
};
constexpr direction_table directions{};

// footprint.hpp: major_direction(). Columns are below 2^28: no bits are dropped before they are squared.
SPANTEX_INLINE v8 major_directions(const columns8& j) {
  const v8 zero = _mm512_setzero_si512(), one = of64<1>();
  const auto sum = [](v8 a, v8 b, v8 c, v8 d) { return _mm512_add_epi64(_mm512_mul_epi32(a, b), _mm512_mul_epi32(c, d)); };
  const v8 across = _mm512_sub_epi64(sum(j.u_x, j.u_x, j.v_x, j.v_x), sum(j.u_y, j.u_y, j.v_y, j.v_y)), half_twice = sum(j.u_x, j.u_y, j.v_x, j.v_y);
  const v8 difference = _mm512_abs_epi64(across), twice = _mm512_slli_epi64(_mm512_abs_epi64(half_twice), 1);
  const v8 larger = _mm512_max_epu64(difference, twice), shift = _mm512_max_epi64(_mm512_sub_epi64(bit_length(larger), of64<48>()), zero);
  const v8 most = _mm512_srlv_epi64(larger, shift), least = _mm512_slli_epi64(_mm512_srlv_epi64(_mm512_min_epu64(difference, twice), shift), 15);
  v8 k = zero;
#pragma GCC unroll 4
  for (const uint32_t border : spantex::detail::direction_borders)
    k = _mm512_mask_add_epi64(k, _mm512_cmpgt_epu64_mask(least, _mm512_mullo_epi64(most, set(border))), k, one);
  k = _mm512_mask_sub_epi64(k, _mm512_cmpgt_epu64_mask(twice, difference), of64<8>(), k);
  k = _mm512_mask_sub_epi64(k, _mm512_movepi64_mask(across), of64<16>(), k);
  return _mm512_and_si512(_mm512_mask_sub_epi64(k, _mm512_movepi64_mask(half_twice), zero, k), of64<direction_count - 1>());
}

// footprint.hpp: axis_of(). Exponents are 18 to 36 and vectors below 2^43, so that what is kept lies within the limits of the axis' exponent.
SPANTEX_INLINE void plan_axes(const setup& s, batch& b) {
  const columns8 j = columns_of(s, b);
  const v8 k = major_directions(j);
  const auto of = [&](const int16_t* table) { return _mm512_srai_epi64(_mm512_slli_epi64(_mm512_permutexvar_epi16(k, _mm512_load_si512(table)), 48), 48); };
  const v8 cos = of(directions.cos), sin = of(directions.sin), minus_sin = _mm512_sub_epi64(_mm512_setzero_si512(), sin);
  const auto centre = [&](v8 x, v8 y) { return _mm512_add_epi64(_mm512_mul_epi32(cos, x), _mm512_mul_epi32(sin, y)); };
  const v8 c_u = centre(j.u_x, j.u_y), c_v = centre(j.v_x, j.v_y);
  const v8 a_u = _mm512_mul_epi32(minus_sin, j.twist_u), b_u = _mm512_mul_epi32(cos, j.twist_u), a_v = _mm512_mul_epi32(minus_sin, j.twist_v), b_v = _mm512_mul_epi32(cos, j.twist_v);
  constexpr int bits = q.offset_bits - 1;
  const v8 longest = bit_length(_mm512_or_si512(extent_of(c_u, a_u, b_u), extent_of(c_v, a_v, b_v))), given = _mm512_add_epi64(s.exponent, set(direction_bits));
  const v8 drop = _mm512_max_epi64(_mm512_sub_epi64(longest, set(bits)), _mm512_setzero_si512());
  const v8 most = set((int64_t(1) << bits) - 1), least = set(-((int64_t(1) << bits) - 1));
  const auto mantissa = [&](v8 x) { return _mm512_max_epi64(_mm512_min_epi64(symmetric8(x, drop), most), least); };
  const __m256i axis[] = {narrowed(mantissa(c_u)), narrowed(mantissa(a_u)), narrowed(mantissa(b_u)), narrowed(mantissa(c_v)), narrowed(mantissa(a_v)), narrowed(mantissa(b_v))};
  for (int n = 0; n < 6; ++n) put(b.axis[n], axis[n]);
  keep<filter::aniso>(b.axis_u, axis[0], axis[1], axis[2], b.how);
  keep<filter::aniso>(b.axis_v, axis[3], axis[4], axis[5], b.how);
  keep(b.g, s.g);
  keep(b.h, s.h);
  b.level = _mm512_testn_epi64_mask(_mm512_or_si512(s.g, s.h), _mm512_or_si512(s.g, s.h));
  keep(b.axis_exponent, _mm512_sub_epi64(given, drop));
  const v8 area = _mm512_abs_epi64(_mm512_sub_epi64(_mm512_mul_epi32(j.u_x, j.v_y), _mm512_mul_epi32(j.u_y, j.v_x))), zeros = _mm512_lzcnt_epi64(area);
  const v8 log2 = log2_of_bits(_mm512_srli_epi64(_mm512_sllv_epi64(area, zeros), 32), _mm512_sub_epi64(of64<63>(), zeros));
  const v8 level = _mm512_mask_mov_epi64(_mm512_add_epi32(log2, _mm512_slli_epi32(_mm512_sub_epi64(of64<1>(), s.exponent), 17)), _mm512_testn_epi64_mask(area, area), of32<-32 * 65536>());
  keep(b.area_log2, level_term16(level));
}
