// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: eight spans planned at once, one 64-bit lane each. Included by by_blocks.hpp alone.
// A plan is a long chain of dependent operations: it is made in parts between the spans of the batch before, whose pixels fill the gaps.
#pragma once

SPANTEX_INLINE v8 modulo(v8 base, int32_t period) {
  if (period == 0) return base;
  if ((period & (period - 1)) == 0) return _mm512_and_si512(base, set(period - 1));
  // floor(base / period) by a reciprocal of 2^40: base is below 2^15, so the error stays below one step
  const v8 shifted = _mm512_add_epi64(base, set(int64_t(period) * (32768 / period + 1)));
  const v8 times = _mm512_srli_epi64(_mm512_mullo_epi64(shifted, set(((int64_t(1) << 40) + period - 1) / period)), 40);
  return _mm512_sub_epi64(shifted, _mm512_mullo_epi64(times, set(period)));
}

// A plan in parts, each a short chain of dependent operations: processors look ahead by some hundred operations alone.
//
// reference_at() of eight spans from sx: W, and what its inverse begins with.
SPANTEX_INLINE void plan_start(const row_work& work, const batch_steps& steps, int32_t sx, setup& s) {
  const plane& p = *work.map;
  const int32_t cx = 2 * span_side * sx + span_side, cy = 2 * span_side * work.sy + span_side;
  s.w = _mm512_add_epi64(set(p.value(p.w, cx, cy)), steps.w);
  s.nu = _mm512_add_epi64(set(p.value(p.u, cx, cy)), steps.nu);
  s.nv = _mm512_add_epi64(set(p.value(p.v, cx, cy)), steps.nv);
  s.usable = _mm512_cmpgt_epi64_mask(s.w, _mm512_setzero_si512());
  const uint64_t slope = 7 * (magnitude(p.w.x) + magnitude(p.w.y));
  s.usable &= _mm512_cmplt_epu64_mask(set(int64_t(slope)), _mm512_sub_epi64(_mm512_srli_epi64(s.w, 1), _mm512_srli_epi64(s.w, 8)));
  const v8 zeros = _mm512_lzcnt_epi64(s.w);
  s.w_bits = _mm512_sub_epi64(of64<64>(), zeros);
  s.inverse.exponent = _mm512_sub_epi64(of64<32>(), zeros);
  s.mantissa = _mm512_srli_epi64(_mm512_sllv_epi64(s.w, zeros), 32);
  s.seed = reciprocal_seeds16(s.mantissa);
}

SPANTEX_INLINE void plan_inverse(setup& s) { s.inverse.y = newton8(s.mantissa, s.seed); }

SPANTEX_INLINE void plan_bases(setup& s) {
  s.base_u = whole_quotient8(s.nu, s.w_bits, s.inverse, s.usable);
  s.base_v = whole_quotient8(s.nv, s.w_bits, s.inverse, s.usable);
}

// coordinates_within(): what is left of the numerators, and how far it reaches.
SPANTEX_INLINE void plan_extents(const row_work& work, setup& s) {
  const plane& p = *work.map;
  const v8 gx = set(p.w.x), gy = set(p.w.y);
  const auto less = [&](v8 x, v8 base, v8 by) { return _mm512_sub_epi64(x, _mm512_mullo_epi64(base, by)); };
  s.c_u = less(s.nu, s.base_u, s.w);
  s.a_u = less(set(p.u.x), s.base_u, gx);
  s.b_u = less(set(p.u.y), s.base_u, gy);
  s.c_v = less(s.nv, s.base_v, s.w);
  s.a_v = less(set(p.v.x), s.base_v, gx);
  s.b_v = less(set(p.v.y), s.base_v, gy);
  const v8 extent = _mm512_max_epu64(extent_of(s.c_u, s.a_u, s.b_u), extent_of(s.c_v, s.a_v, s.b_v)), extent_bits = bit_length(extent);
  s.extent_log2 = _mm512_add_epi64(_mm512_sub_epi64(extent_bits, s.w_bits), of64<1>());
  s.usable &= _mm512_cmple_epi64_mask(s.extent_log2, of64<max_extent_log2>());
  s.exponent = _mm512_min_epi64(_mm512_sub_epi64(of64<q.offset_bits - 1>(), s.extent_log2), of64<max_exponent>());
  s.drop = _mm512_max_epi64(_mm512_sub_epi64(extent_bits, of64<31>()), _mm512_setzero_si512());
  s.shift = _mm512_sub_epi64(_mm512_sub_epi64(_mm512_add_epi64(s.inverse.exponent, of64<63>()), s.drop), s.exponent);
}

template <filter Kind>
SPANTEX_INLINE void plan_mantissas(setup& s, batch& b) {
  const auto mantissa = [&](v8 n) { return quotient8(n, s.drop, s.inverse.y, s.shift); };
  keep(b.c_u, mantissa(s.c_u)); keep(b.a_u, mantissa(s.a_u)); keep(b.b_u, mantissa(s.b_u));
  keep(b.c_v, mantissa(s.c_v)); keep(b.a_v, mantissa(s.a_v)); keep(b.b_v, mantissa(s.b_v));
  b.how = cut::square;
  if constexpr (uses_levels(Kind)) b.how = best_cut(got(b.a_u), got(b.a_v), got(b.b_u), got(b.b_v), s.usable);
  keep<Kind>(b.u, got(b.c_u), got(b.a_u), got(b.b_u), b.how);
  keep<Kind>(b.v, got(b.c_v), got(b.a_v), got(b.b_v), b.how);
  keep(b.exponent, s.exponent);
}

// Slopes, and where the map's period lets positions be counted from.
SPANTEX_INLINE void plan_slopes(const row_work& work, setup& s, batch& b) {
  const plane& p = *work.map;
  const int slope_drop = max_of(0, spantex::bit_length(7 * (magnitude(p.w.x) + magnitude(p.w.y))) - 31);
  const v8 slope_shift = _mm512_sub_epi64(s.inverse.exponent, set(slope_drop + q.reciprocal_bits - 63));
  s.g = quotient8(set(p.w.x), set(slope_drop), s.inverse.y, slope_shift);
  s.h = quotient8(set(p.w.y), set(slope_drop), s.inverse.y, slope_shift);
  keep(b.origin_u, s.base_u); keep(b.origin_v, s.base_v);
  keep(b.base_u, modulo(s.base_u, work.texels->period_u())); keep(b.base_v, modulo(s.base_v, work.texels->period_v()));
  if (p.rounding_bits == 0) return;
  // rounding_is_small()
  const v8 reached = _mm512_sllv_epi64(of64<2>(), _mm512_max_epi64(_mm512_sub_epi64(of64<q.offset_bits - 1>(), s.exponent), _mm512_setzero_si512()));
  const v8 farthest = _mm512_add_epi64(_mm512_max_epi64(_mm512_abs_epi64(s.base_u), _mm512_abs_epi64(s.base_v)), reached);
  const v8 bits = _mm512_add_epi64(bit_length(_mm512_add_epi64(farthest, of64<2>())), set(p.rounding_bits + set_up_tolerance_bits));
  s.usable &= _mm512_cmplt_epi64_mask(bits, s.w_bits);
}

// choose_evaluation().
template <filter Kind>
SPANTEX_INLINE void plan_evaluation(const row_work& work, setup& s, batch& b) {
  const v8 steepness = times7(_mm512_add_epi64(_mm512_abs_epi64(s.g), _mm512_abs_epi64(s.h)));
  s.steepness = steepness;
  const v8 slope_log2 = _mm512_max_epi64(_mm512_sub_epi64(bit_length(steepness), of64<q.reciprocal_bits>()), of64<least_slope_log2>());
  const __mmask8 steep = _mm512_cmpgt_epi64_mask(slope_log2, of64<most_series_slope_log2>());
  s.slope_log2 = slope_log2;
  s.affine_log2 = _mm512_add_epi64(_mm512_add_epi64(s.extent_log2, slope_log2), of64<1>());
  const __mmask8 affine = _mm512_testn_epi64_mask(steepness, steepness) |
                          _mm512_cmple_epi64_mask(_mm512_mask_add_epi64(s.affine_log2, steep, s.affine_log2, of64<1>()), of64<-q.tolerance_bits>());
  const v8 resolution = _mm512_add_epi64(_mm512_sub_epi64(of64<q.offset_bits - 1>(), s.exponent), slope_log2);
  const __mmask8 series = __mmask8(~steep) & _mm512_cmple_epi64_mask(resolution, of64<series_bits - 3 - q.tolerance_bits>());
  v8 terms = of64<divide_terms>(), error_log2 = _mm512_add_epi64(s.affine_log2, _mm512_slli_epi64(slope_log2, 2));
  static_assert(most_series_terms == 4);
#pragma GCC unroll 4
  for (int n = most_series_terms; n >= 1; --n) {
    terms = _mm512_mask_mov_epi64(terms, series & _mm512_cmple_epi64_mask(error_log2, of64<-q.tolerance_bits - 1>()), set(n));
    error_log2 = _mm512_sub_epi64(error_log2, slope_log2);
  }
  keep(b.slope_log2, slope_log2);
  keep(b.affine_log2, s.affine_log2);
  keep(b.series_drop, _mm512_sub_epi64(of64<-2>(), slope_log2));
  const v8 up = _mm512_sub_epi64(_mm512_setzero_si512(), slope_log2);
  const __m256i along_x = narrowed(_mm512_sllv_epi64(s.g, up)), along_y = narrowed(_mm512_sllv_epi64(s.h, up));
  const bool same_in_rows = work.map->w.x == 0, same_in_columns = work.map->w.y == 0;
  b.slope_of = !uses_levels(Kind) ? nullptr : same_in_rows ? cut_of(b.how).row : same_in_columns ? cut_of(b.how).column : nullptr;
  if (b.slope_of != nullptr) keep(b.slopes, same_in_rows ? along_y : along_x);
  else keep<Kind>(b.e, _mm256_setzero_si256(), along_x, along_y, b.how);
  keep(b.terms, _mm512_mask_mov_epi64(terms, affine, _mm512_setzero_si512()));
  b.usable = s.usable;
}

// What the filter needs to know before it sees a span's pixels.
template <filter Kind>
SPANTEX_INLINE void plan_places(const row_work& work, const setup& s, batch& b) {
  if constexpr (uses_footprint(Kind)) {
    plan_axes(s, b);
  } else if constexpr (uses_levels(Kind)) {
    plan_levels(s, b);
  } else {
    const __mmask8 flat = _mm512_cmple_epi64_mask(s.affine_log2, of64<-2>());
    if constexpr (Kind == filter::nearest) place_rows(work, flat, b);
    else place(work, flat, b);
  }
}

constexpr int plan_parts = 7;
template <filter Kind>
SPANTEX_INLINE void plan_part(int k, const row_work& work, const batch_steps& steps, setup& s, batch& b) {
  switch (k) {
    case 0: return plan_start(work, steps, b.sx, s);
    case 1: return plan_inverse(s);
    case 2: return plan_bases(s);
    case 3: return plan_extents(work, s);
    case 4: return plan_mantissas<Kind>(s, b);
    case 5: plan_slopes(work, s, b); return plan_evaluation<Kind>(work, s, b);
    default: return plan_places<Kind>(work, s, b);
  }
}
