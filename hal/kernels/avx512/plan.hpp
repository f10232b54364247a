// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: eight spans planned at once, one 64-bit lane each. Included by ../avx512.cpp alone.
// A plan is a long chain of dependent operations: it is made in three parts between the spans of the batch before, whose pixels fill the gaps.
#pragma once

SPANTEX_INLINE v8 modulo(v8 base, int32_t period) {
  if (period == 0) return base;
  if ((period & (period - 1)) == 0) return _mm512_and_si512(base, set(period - 1));
  // floor(base / period) by a reciprocal of 2^40: base is below 2^15, so the error stays below one step
  const v8 shifted = _mm512_add_epi64(base, set(int64_t(period) * (32768 / period + 1)));
  const v8 times = _mm512_srli_epi64(_mm512_mullo_epi64(shifted, set(((int64_t(1) << 40) + period - 1) / period)), 40);
  return _mm512_sub_epi64(shifted, _mm512_mullo_epi64(times, set(period)));
}

SPANTEX_INLINE v16 both_axes(__m256i u, __m256i v) { return _mm512_inserti64x4(_mm512_castsi256_si512(u), v, 1); }
SPANTEX_INLINE v16 both_axes(int32_t u, int32_t v) { return both_axes(_mm256_set1_epi32(u), _mm256_set1_epi32(v)); }

// Where quads lie on level 0, s15.16, u in the lower eight lanes, v in the upper: between the corners of the parallelogram that a quad would be if
// nothing were divided. 1/w moves a position by less than 2^(extent + slope + 1); a 64th of a texel holds every rounding.
struct quad_bounds {
  v16 middle, right, below, spread, to16, base;
  SPANTEX_INLINE quad_bounds(const batch& b, v8 error_log2) {
    const v16 a = both_axes(got(b.a_u), got(b.a_v)), d = both_axes(got(b.b_u), got(b.b_v)), x = _mm512_broadcast_i64x4(got(b.exponent));
    const v16 steps = _mm512_add_epi32(_mm512_abs_epi32(a), _mm512_abs_epi32(d));
    const v16 error = _mm512_broadcast_i64x4(_mm512_cvtepi64_epi32(error_log2)), one = of32<1>();
    const v16 margin = _mm512_add_epi32(_mm512_sllv_epi32(one, _mm512_add_epi32(x, error)), _mm512_sllv_epi32(one, _mm512_sub_epi32(x, of32<6>())));
    spread = _mm512_add_epi32(_mm512_add_epi32(steps, _mm512_slli_epi32(steps, 1)), margin);
    right = _mm512_slli_epi32(a, 2);
    below = _mm512_slli_epi32(d, 2);
    middle = both_axes(got(b.c_u), got(b.c_v));
    to16 = _mm512_sub_epi32(x, of32<16>());
    base = _mm512_slli_epi32(both_axes(got(b.base_u), got(b.base_v)), 16);
  }
  SPANTEX_INLINE v16 centre(int n) const {
    const v16 across = n & 1 ? _mm512_add_epi32(middle, right) : _mm512_sub_epi32(middle, right);
    return n & 2 ? _mm512_add_epi32(across, below) : _mm512_sub_epi32(across, below);
  }
  SPANTEX_INLINE v16 low(int n) const { return _mm512_add_epi32(base, _mm512_srav_epi32(_mm512_sub_epi32(centre(n), spread), to16)); }
  SPANTEX_INLINE v16 high(int n) const { return _mm512_add_epi32(base, _mm512_srav_epi32(_mm512_add_epi32(centre(n), spread), to16)); }
};

// Sections of level 0 for a filter of 2x2 texels.
SPANTEX_INLINE void place(const row_work& work, __mmask8 flat, const quad_bounds& bounds, batch& b) {
  const planar_map& map = *work.texels;
  const planar_levels& texels = map.levels();
  const v16 last = both_axes(texels.last_column[0], texels.last_row[0]), bytes = both_axes(block_bytes, texels.row_bytes[0]);
  const __mmask16 strict = __mmask16((map.period_u() != 0 ? 0xFF : 0) | (map.period_v() != 0 ? 0xFF00 : 0));
  __mmask16 fit = 0xFFFF, wide = 0;
#pragma GCC unroll 4
  for (int n = 0; n < quads; ++n) {
    const v16 low = bounds.low(n), high = bounds.high(n);
    _mm512_store_si512(b.low[n], low);
    _mm512_store_si512(b.high[n], high);
    const auto texel = [&](v16 position) { return _mm512_srai_epi32(_mm512_sub_epi32(position, of32<1 << 15>()), 16); };
    const v16 first = texel(low), end = _mm512_add_epi32(texel(high), of32<1>());
    const v16 block0 = _mm512_srai_epi32(first, 3), block1 = _mm512_srai_epi32(end, 3);
    const __mmask16 large = _mm512_cmpgt_epi32_mask(_mm512_sub_epi32(end, first), of32<7>()) & 0xFF;
    fit = __mmask16(fit & (_mm512_cmple_epi32_mask(_mm512_sub_epi32(block1, block0), of32<1>()) | (0xFF & ~large)));
    wide |= large;
    const auto held = [&](v16 k) { return _mm512_max_epi32(_mm512_min_epi32(k, last), of32<-apron>()); };
    const v16 k0 = held(block0), k1 = held(block1);
    fit = __mmask16(fit & ~(strict & (_mm512_cmpneq_epi32_mask(k0, block0) | _mm512_cmpneq_epi32_mask(k1, block1))));
    const __mmask16 swap = _mm512_test_epi32_mask(block0, of32<1>()) & (0xFF00 | large);
    const v16 even = _mm512_mullo_epi32(_mm512_mask_mov_epi32(k0, swap, k1), bytes), odd = _mm512_mullo_epi32(_mm512_mask_mov_epi32(k1, swap, k0), bytes);
    const __m256i x0 = _mm512_castsi512_si256(even), x1 = _mm512_castsi512_si256(odd);
    const __m256i y0 = _mm512_extracti64x4_epi64(even, 1), y1 = _mm512_extracti64x4_epi64(odd, 1);
    put(b.at[0][0][n], _mm256_add_epi32(x0, y0));
    put(b.at[0][1][n], _mm256_add_epi32(x0, y1));
    put(b.at[1][0][n], _mm256_add_epi32(x1, y0));
    put(b.at[1][1][n], _mm256_add_epi32(x1, y1));
    put(b.column[n], _mm256_and_si256(_mm512_castsi512_si256(first), _mm256_set1_epi32(7)));
  }
  b.flat = flat;
  b.placed = flat & fit & (fit >> 8);
  b.wide = wide;
}

// The same for single texels: 8x8 of them in rows.
SPANTEX_INLINE void place_rows(const row_work& work, __mmask8 flat, const quad_bounds& bounds, batch& b) {
  const planar_map& map = *work.texels;
  const v16 base = _mm512_srai_epi32(bounds.base, 16), seven = of32<7>();
  const v16 least = of32<-texel_apron>(), most = both_axes(map.rows_across() + texel_apron - block_side, map.rows_down() + texel_apron - block_side);
  __mmask16 fit = 0xFFFF;
#pragma GCC unroll 4
  for (int n = 0; n < quads; ++n) {
    const v16 first = _mm512_srai_epi32(bounds.low(n), 16), end = _mm512_srai_epi32(bounds.high(n), 16);
    fit = __mmask16(fit & _mm512_cmple_epi32_mask(_mm512_sub_epi32(end, first), seven) & _mm512_cmpge_epi32_mask(first, least) & _mm512_cmple_epi32_mask(first, most));
    _mm512_store_si512(b.from[n], _mm512_sub_epi32(base, first));
    const __m256i down = _mm256_mullo_epi32(_mm512_extracti64x4_epi64(first, 1), _mm256_set1_epi32(map.row_stride()));
    put(b.row_at[n], _mm256_add_epi32(_mm512_castsi512_si256(first), down));
  }
  b.flat = flat;
  b.placed = flat & fit & (fit >> 8);
}

// reference_at() of eight spans from sx.
SPANTEX_INLINE void plan_bases(const row_work& work, int32_t sx, setup& s) {
  const plane& p = *work.map;
  const int32_t cx = 2 * span_side * sx + span_side, cy = 2 * span_side * work.sy + span_side;
  const v8 k = _mm512_setr_epi64(0, 1, 2, 3, 4, 5, 6, 7);
  const auto along = [&](const linear_form& f) {
    return _mm512_add_epi64(set(p.value(f, cx, cy)), _mm512_mullo_epi64(k, set(2 * span_side * f.x)));
  };
  s.w = along(p.w);
  s.nu = along(p.u);
  s.nv = along(p.v);
  s.usable = _mm512_cmpgt_epi64_mask(s.w, _mm512_setzero_si512());
  const uint64_t slope = 7 * (magnitude(p.w.x) + magnitude(p.w.y));
  s.usable &= _mm512_cmplt_epu64_mask(set(int64_t(slope)), _mm512_sub_epi64(_mm512_srli_epi64(s.w, 1), _mm512_srli_epi64(s.w, 8)));
  s.inverse = invert8(s.w);
  s.w_bits = bit_length(s.w);
  s.base_u = whole_quotient8(s.nu, s.w_bits, s.inverse, s.usable);
  s.base_v = whole_quotient8(s.nv, s.w_bits, s.inverse, s.usable);
}

// coordinates_within(), but for the evaluation.
template <filter Kind>
SPANTEX_INLINE void plan_mantissas(const row_work& work, setup& s, batch& b) {
  const plane& p = *work.map;
  const v8 zero = _mm512_setzero_si512(), gx = set(p.w.x), gy = set(p.w.y);
  const auto less = [&](int64_t x, v8 base, v8 by) { return _mm512_sub_epi64(set(x), _mm512_mullo_epi64(base, by)); };
  const v8 c_u = _mm512_sub_epi64(s.nu, _mm512_mullo_epi64(s.base_u, s.w)), a_u = less(p.u.x, s.base_u, gx), b_u = less(p.u.y, s.base_u, gy);
  const v8 c_v = _mm512_sub_epi64(s.nv, _mm512_mullo_epi64(s.base_v, s.w)), a_v = less(p.v.x, s.base_v, gx), b_v = less(p.v.y, s.base_v, gy);
  const v8 extent = _mm512_max_epu64(extent_of(c_u, a_u, b_u), extent_of(c_v, a_v, b_v)), extent_bits = bit_length(extent);
  s.extent_log2 = _mm512_add_epi64(_mm512_sub_epi64(extent_bits, s.w_bits), of64<1>());
  s.usable &= _mm512_cmple_epi64_mask(s.extent_log2, of64<max_extent_log2>());
  s.exponent = _mm512_min_epi64(_mm512_sub_epi64(of64<q.offset_bits - 1>(), s.extent_log2), of64<max_exponent>());
  const v8 drop = _mm512_max_epi64(_mm512_sub_epi64(extent_bits, of64<31>()), zero);
  const v8 whole = _mm512_add_epi64(s.inverse.exponent, of64<63>()), shift = _mm512_sub_epi64(_mm512_sub_epi64(whole, drop), s.exponent);
  const auto mantissa = [&](v8 n) { return quotient8(n, drop, s.inverse.y, shift); };
  keep(b.c_u, mantissa(c_u)); keep(b.a_u, mantissa(a_u)); keep(b.b_u, mantissa(b_u));
  keep(b.c_v, mantissa(c_v)); keep(b.a_v, mantissa(a_v)); keep(b.b_v, mantissa(b_v));
  const int slope_drop = max_of(0, spantex::bit_length(7 * (magnitude(p.w.x) + magnitude(p.w.y))) - 31);
  const v8 slope_shift = _mm512_sub_epi64(whole, set(slope_drop + q.reciprocal_bits));
  s.g = quotient8(gx, set(slope_drop), s.inverse.y, slope_shift);
  s.h = quotient8(gy, set(slope_drop), s.inverse.y, slope_shift);
  keep(b.g, s.g); keep(b.h, s.h); keep(b.exponent, s.exponent);
  keep(b.origin_u, s.base_u); keep(b.origin_v, s.base_v);
  keep(b.base_u, modulo(s.base_u, work.texels->period_u())); keep(b.base_v, modulo(s.base_v, work.texels->period_v()));
  if (p.rounding_bits == 0) return;
  // rounding_is_small()
  const v8 reached = _mm512_sllv_epi64(of64<2>(), _mm512_max_epi64(_mm512_sub_epi64(of64<q.offset_bits - 1>(), s.exponent), zero));
  const v8 farthest = _mm512_add_epi64(_mm512_max_epi64(_mm512_abs_epi64(s.base_u), _mm512_abs_epi64(s.base_v)), reached);
  const v8 bits = _mm512_add_epi64(bit_length(_mm512_add_epi64(farthest, of64<2>())), set(p.rounding_bits + set_up_tolerance_bits));
  s.usable &= _mm512_cmplt_epi64_mask(bits, s.w_bits);
}

// choose_evaluation(), and what the filter needs to know before it sees a span's pixels.
template <filter Kind>
SPANTEX_INLINE void plan_evaluation(const row_work& work, const setup& s, batch& b) {
  const v8 steepness = times7(_mm512_add_epi64(_mm512_abs_epi64(s.g), _mm512_abs_epi64(s.h)));
  const v8 slope_log2 = _mm512_max_epi64(_mm512_sub_epi64(bit_length(steepness), of64<q.reciprocal_bits>()), of64<least_slope_log2>());
  const __mmask8 steep = _mm512_cmpgt_epi64_mask(slope_log2, of64<most_series_slope_log2>());
  const v8 affine_log2 = _mm512_add_epi64(_mm512_add_epi64(s.extent_log2, slope_log2), of64<1>());
  const __mmask8 affine = _mm512_testn_epi64_mask(steepness, steepness) |
                          _mm512_cmple_epi64_mask(_mm512_mask_add_epi64(affine_log2, steep, affine_log2, of64<1>()), of64<-q.tolerance_bits>());
  const v8 resolution = _mm512_add_epi64(_mm512_sub_epi64(of64<q.offset_bits - 1>(), s.exponent), slope_log2);
  const __mmask8 series = __mmask8(~steep) & _mm512_cmple_epi64_mask(resolution, of64<series_bits - 3 - q.tolerance_bits>());
  v8 terms = of64<divide_terms>(), error_log2 = _mm512_add_epi64(affine_log2, _mm512_mullo_epi64(slope_log2, of64<most_series_terms>()));
#pragma GCC unroll 4
  for (int n = most_series_terms; n >= 1; --n) {
    terms = _mm512_mask_mov_epi64(terms, series & _mm512_cmple_epi64_mask(error_log2, of64<-q.tolerance_bits - 1>()), set(n));
    error_log2 = _mm512_sub_epi64(error_log2, slope_log2);
  }
  keep(b.slope_log2, slope_log2);
  keep(b.terms, _mm512_mask_mov_epi64(terms, affine, _mm512_setzero_si512()));
  b.usable = s.usable;
  if constexpr (uses_footprint(Kind)) {
    plan_axes(s, b);
  } else if constexpr (uses_levels(Kind)) {
    plan_levels(s, slope_log2, b);
  } else {
    const __mmask8 flat = _mm512_cmple_epi64_mask(affine_log2, of64<-2>());
    quad_bounds bounds(b, affine_log2);
    if constexpr (Kind == filter::nearest) place_rows(work, flat, bounds, b);
    else place(work, flat, bounds, b);
  }
}
