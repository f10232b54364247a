// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: filter aniso (footprint.hpp) where no pixel of a span has more than one sample, which is trilinear then; the others are left. Included by
// ../avx512.cpp alone. The axis of a span is the scalar engine's own.
#pragma once

static_assert(q.max_samples == 16 && q.sample_bias == -8, "finer() as in levels.hpp");

// The least ratio of the axes, log2 in 2^-16, that takes two samples.
constexpr int32_t least_ratio_of_two() {
  int32_t one = 0, two = 4 << 16;
  while (two - one > 1) {
    const int32_t middle = (one + two) / 2;
    ((exp2_16(middle) - (uint32_t(q.sample_slack) << 12) + 65535) >> 16 > 1 ? two : one) = middle;
  }
  return two;
}

// axis_log2().
SPANTEX_INLINE v16 axis_log2_16(v16 u, v16 v, int exponent) {
  const auto square = [&](v8 x, v8 y) { return _mm512_add_epi64(_mm512_mul_epi32(x, x), _mm512_mul_epi32(y, y)); };
  const v8 even = square(u, v), odd = square(_mm512_srli_epi64(u, 32), _mm512_srli_epi64(v, 32));
  const v8 even_zeros = _mm512_lzcnt_epi64(even), odd_zeros = _mm512_lzcnt_epi64(odd);
  const v16 bits = _mm512_mask_mov_epi32(_mm512_srli_epi64(_mm512_sllv_epi64(even, even_zeros), 32), 0xAAAA, _mm512_sllv_epi64(odd, odd_zeros));
  const v16 zeros = _mm512_mask_mov_epi32(even_zeros, 0xAAAA, _mm512_slli_epi64(odd_zeros, 32));
  const v16 length = _mm512_add_epi32(_mm512_srli_epi32(log2_of_bits(bits, _mm512_sub_epi32(of32<63>(), zeros)), 1), set32((1 - exponent) * 65536));
  return _mm512_mask_mov_epi32(length, _mm512_cmpeq_epi32_mask(zeros, of32<64>()), of32<-32 * 65536>());
}

// Levels of shape_of() a quad's pixels; false if one of them has more samples than one.
SPANTEX_INLINE bool levels_of_shapes(const axis_terms& axis, v16 nu, v16 nv, v16 e, bool flat, int32_t last_level, v16& level) {
  const v16 zero = _mm512_setzero_si512(), log_w = flat ? zero : _mm512_sub_epi32(log2_of(_mm512_add_epi32(e, of32<1 << 30>())), of32<30 << 16>());
  const v16 length = axis_log2_16(nu, nv, axis.exponent), major = _mm512_sub_epi32(length, _mm512_slli_epi32(log_w, 1));
  constexpr int32_t bias = q.sample_bias * (1 << 12);
  const v16 area = set32(axis.area_log2 * (1 << (16 - level_term_bits)));
  const v16 stretch = _mm512_sub_epi32(_mm512_sub_epi32(_mm512_slli_epi32(length, 1), area), log_w);
  const v16 ratio = _mm512_max_epi32(_mm512_min_epi32(stretch, _mm512_sub_epi32(major, of32<bias>())), zero);
  level = detail_of(_mm512_sub_epi32(major, ratio), set32(last_level << q.level_bits));
  return _mm512_cmpge_epi32_mask(ratio, of32<least_ratio_of_two()>()) == 0;
}

template <int Channels>
SPANTEX_INLINE bool draw_aniso(const row_work& work, const batch& b, int k) {
  span_coefficients c{};
  c.c_u = b.c_u[k]; c.a_u = b.a_u[k]; c.b_u = b.b_u[k];
  c.c_v = b.c_v[k]; c.a_v = b.a_v[k]; c.b_v = b.b_v[k];
  c.g = b.g[k]; c.h = b.h[k];
  c.exponent = int8_t(b.exponent[k]);
  span_axis(q, c);
  level_span span;
  offsets o = offsets_of(b, k);
  v16 nu[quads], nv[quads];
  forms(set32(c.axis.c_u), c.axis.a_u, c.axis.b_u, nu);
  forms(set32(c.axis.c_v), c.axis.a_v, c.axis.b_v, nv);
#pragma GCC unroll 4
  for (int n = 0; n < quads; ++n)
    if (!levels_of_shapes(c.axis, nu[n], nv[n], o.e[n], (c.g | c.h) == 0, work.last_level, span.level[n])) return false;
  take(o, span);
  return draw_at_levels<true, Channels>(work, b, k, span);
}
