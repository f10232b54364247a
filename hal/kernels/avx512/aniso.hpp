// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: filter aniso, rows of trilinear samples along each pixel's image (footprint.hpp). Included by ../avx512.cpp alone.
// The axis of a span is the scalar engine's own; lanes take what is done for every pixel and every sample.
#pragma once

static_assert(q.max_samples == 16 && q.sample_bias <= 0, "tables of 16");

// 2^x between two knots, less 1, and what a number of samples from 1 to 16 stands for.
struct alignas(64) sample_tables {
  uint16_t knot[64], step[64];
  int32_t half_pitch[16], inverse[16];  // floor((2^16 + n) / 2n); ceil(2^18 / n)
  constexpr sample_tables() : knot(), step(), half_pitch(), inverse() {
    for (int k = 0; k < 64; ++k) {
      knot[k] = uint16_t(exp2_knots.knot[k] - 65536);
      step[k] = uint16_t(exp2_knots.knot[k + 1] - exp2_knots.knot[k]);
    }
    for (int n = 1; n <= 16; ++n) {
      half_pitch[n - 1] = (65536 + n) / (2 * n);
      inverse[n - 1] = ((1 << 18) + n - 1) / n;
    }
  }
};
constexpr sample_tables of_samples{};

// exp2_16() for 0 <= x <= 4.
SPANTEX_INLINE v16 exp2_of(v16 x) {
  const v16 word = set32(0xFFFF), k = _mm512_and_si512(_mm512_srli_epi32(x, 10), set32(63)), t = _mm512_and_si512(x, set32(1023));
  const v16 low = _mm512_or_si512(_mm512_and_si512(look_up(of_samples.knot, k), word), set32(1 << 16)), step = _mm512_and_si512(look_up(of_samples.step, k), word);
  const v16 fraction = _mm512_add_epi32(_mm512_slli_epi32(low, 10), _mm512_mullo_epi32(step, t)), drop = _mm512_sub_epi32(set32(10), _mm512_srli_epi32(x, 16));
  return _mm512_srlv_epi32(_mm512_add_epi32(fraction, _mm512_sllv_epi32(set32(1), _mm512_sub_epi32(drop, set32(1)))), drop);
}

// shift_right_symmetric().
SPANTEX_INLINE v8 symmetric8(v8 x, int shift) {
  if (shift <= 0) return _mm512_slli_epi64(x, unsigned(-shift));
  const v8 magnitude = _mm512_srl_epi64(_mm512_add_epi64(_mm512_abs_epi64(x), set(int64_t(1) << (shift - 1))), _mm_cvtsi32_si128(shift));
  return _mm512_mask_sub_epi64(magnitude, _mm512_movepi64_mask(x), _mm512_setzero_si512(), magnitude);
}

SPANTEX_INLINE v16 interleaved(v8 even, v8 odd) { return _mm512_mask_mov_epi32(even, 0xAAAA, _mm512_slli_epi64(odd, 32)); }

// axis_at().
SPANTEX_INLINE v16 axis16(v16 n, bool affine, const reciprocals16& r, int exponent) {
  const auto one = [&](v8 x, v8 y) {
    if (!affine) x = symmetric8(_mm512_mul_epi32(symmetric8(_mm512_mul_epi32(x, y), q.reciprocal_bits), y), q.reciprocal_bits);
    return _mm512_max_epi64(_mm512_min_epi64(symmetric8(x, exponent - 17), set(INT32_MAX)), set(INT32_MIN));
  };
  const v8 even = _mm512_srai_epi64(_mm512_slli_epi64(n, 32), 32), odd = _mm512_srai_epi64(n, 32);
  return interleaved(one(even, r.even), one(odd, r.odd));
}

// axis_log2().
SPANTEX_INLINE v16 axis_log2_16(v16 u, v16 v, int exponent) {
  const auto square = [&](v8 x, v8 y) { return _mm512_add_epi64(_mm512_mul_epi32(x, x), _mm512_mul_epi32(y, y)); };
  const v8 even = square(u, v), odd = square(_mm512_srli_epi64(u, 32), _mm512_srli_epi64(v, 32));
  const v8 even_zeros = _mm512_lzcnt_epi64(even), odd_zeros = _mm512_lzcnt_epi64(odd);
  const v16 bits = _mm512_mask_mov_epi32(_mm512_srli_epi64(_mm512_sllv_epi64(even, even_zeros), 32), 0xAAAA, _mm512_sllv_epi64(odd, odd_zeros));
  const v16 zeros = interleaved(even_zeros, odd_zeros);
  const v16 length = _mm512_add_epi32(_mm512_srli_epi32(log2_of_bits(bits, _mm512_sub_epi32(set32(63), zeros)), 1), set32((1 - exponent) * 65536));
  return _mm512_mask_mov_epi32(length, _mm512_cmpeq_epi32_mask(zeros, set32(64)), set32(-32 * 65536));
}

// shape_of() a group of pixels.
struct shapes16 { v16 level, samples; };
SPANTEX_INLINE shapes16 shapes_of(const axis_terms& axis, v16 nu, v16 nv, v16 e, bool flat, int32_t last_level) {
  const v16 zero = _mm512_setzero_si512(), log_w = flat ? zero : _mm512_sub_epi32(log2_of(_mm512_add_epi32(e, set32(1 << 30))), set32(30 << 16));
  const v16 length = axis_log2_16(nu, nv, axis.exponent), major = _mm512_sub_epi32(length, _mm512_slli_epi32(log_w, 1));
  constexpr int32_t bias = q.sample_bias * (1 << 12);
  const v16 area = set32(axis.area_log2 * (1 << (16 - level_term_bits)));
  const v16 stretch = _mm512_sub_epi32(_mm512_sub_epi32(_mm512_slli_epi32(length, 1), area), log_w);
  const v16 ratio = _mm512_max_epi32(_mm512_min_epi32(_mm512_min_epi32(stretch, _mm512_sub_epi32(major, set32(bias))), set32(4 << 16)), zero);
  const v16 minor = _mm512_sub_epi32(major, ratio), within = _mm512_max_epi32(_mm512_min_epi32(minor, set32(1 << 16)), zero);
  const v16 sharper = _mm512_srai_epi32(_mm512_add_epi32(_mm512_mullo_epi32(within, set32(q.sample_bias)), set32(8)), 4);
  const v16 level = _mm512_srai_epi32(_mm512_add_epi32(_mm512_add_epi32(minor, sharper), set32(128)), 8);
  const v16 samples = _mm512_srai_epi32(_mm512_add_epi32(exp2_of(ratio), set32(65535 - (q.sample_slack << 12))), 16);
  return {_mm512_max_epi32(_mm512_min_epi32(level, set32(last_level << q.level_bits)), zero), _mm512_max_epi32(_mm512_min_epi32(samples, set32(16)), set32(1))};
}

// sample_offset(): length m 2^-16, symmetric.
SPANTEX_INLINE v16 along16(v16 length, v16 m) {
  const auto rounded = [&](v8 x) { return _mm512_add_epi64(_mm512_add_epi64(x, set(0x8000)), _mm512_srai_epi64(x, 63)); };
  const v8 even = rounded(_mm512_mul_epi32(length, m)), odd = rounded(_mm512_mul_epi32(_mm512_srli_epi64(length, 32), _mm512_srli_epi64(m, 32)));
  return _mm512_mask_mov_epi32(_mm512_srai_epi64(even, 16), 0xAAAA, _mm512_slli_epi64(odd, 16));
}

// mean() of sums with 16 bits of fraction over n samples, halves to even; in bits 16 to 23.
SPANTEX_INLINE v16 mean16(v16 sum, v16 n, v16 inverse) {
  const v16 t = _mm512_add_epi32(sum, _mm512_slli_epi32(n, 15)), whole = _mm512_srli_epi32(_mm512_mullo_epi32(_mm512_srli_epi32(t, 16), inverse), 18);
  const __mmask16 tie = _mm512_cmpeq_epi32_mask(_mm512_slli_epi32(_mm512_mullo_epi32(whole, n), 16), t);
  return _mm512_slli_epi32(_mm512_mask_andnot_epi32(whole, tie, set32(1), whole), 16);
}

SPANTEX_INLINE grouping grouping_of(const span_coefficients& c) {
  const jacobian j = span_jacobian(q, c);
  const auto length = [&](int64_t u, int64_t v) { return magnitude(u) + magnitude(v); };
  const uint64_t across = length(j.ux, j.vx), down = length(j.uy, j.vy);
  return down > 2 * across ? grouping::rows : across > 2 * down ? grouping::columns : grouping::square;
}

// Groups of columns become quads.
SPANTEX_INLINE void quads_of_columns(v16 (&g)[quads]) {
  const auto quad = [&](v16 left, v16 right, int first) {  // lane 8 x + y of two groups: x = 0, 1 and 2, 3
    const v16 index = _mm512_setr_epi32(0, 8, 16, 24, 1, 9, 17, 25, 2, 10, 18, 26, 3, 11, 19, 27);
    return _mm512_permutex2var_epi32(left, _mm512_add_epi32(index, set32(first)), right);
  };
  const v16 out[quads] = {quad(g[0], g[1], 0), quad(g[2], g[3], 0), quad(g[0], g[1], 4), quad(g[2], g[3], 4)};
#pragma GCC unroll 4
  for (int n = 0; n < quads; ++n) g[n] = out[n];
}
SPANTEX_INLINE void quads_of_rows(v16 (&g)[quads]) {
  const auto quad = [&](v16 top, v16 bottom, int first) {  // 128 bits are half a row
    return first == 0 ? _mm512_shuffle_i32x4(top, bottom, 0x88) : _mm512_shuffle_i32x4(top, bottom, 0xDD);
  };
  const v16 out[quads] = {quad(g[0], g[1], 0), quad(g[0], g[1], 1), quad(g[2], g[3], 0), quad(g[2], g[3], 1)};
#pragma GCC unroll 4
  for (int n = 0; n < quads; ++n) g[n] = out[n];
}

// Sums over rows of more than one sample. False where the map has no blocks or a row is too long.
template <int Channels>
SPANTEX_INLINE bool sum_of_rows(const planar_map& map, texels16 centre, v16 u, v16 v, const shapes16& shape, int most, v16 fine_level, v16 coarse_level, v16 weights,
                                __mmask16 blended, v16 (&sum)[Channels]) {
  const v16 longer = _mm512_max_epu32(_mm512_abs_epi32(u), _mm512_abs_epi32(v));
  if (_mm512_cmpgt_epu32_mask(longer, set32(longest_row << 16)) != 0) return false;
  const v16 pitch = _mm512_permutexvar_epi32(_mm512_sub_epi32(shape.samples, set32(1)), _mm512_load_si512(of_samples.half_pitch));
  v16 fine[Channels], coarse[Channels];
  for (int m = 0; m < Channels; ++m) sum[m] = coarse[m] = _mm512_setzero_si512();
#pragma GCC unroll 1
  for (int k = 0; k < most; ++k) {
    const __mmask16 lanes = _mm512_cmpgt_epi32_mask(shape.samples, set32(k)), both = __mmask16(lanes & blended);
    const v16 m = _mm512_mullo_epi32(_mm512_sub_epi32(set32(2 * k + 1), shape.samples), pitch);
    const texels16 at{_mm512_add_epi32(centre.u, along16(u, m)), _mm512_add_epi32(centre.v, along16(v, m))};
    if (!blend_anywhere<up_between>(map, on_levels(map, at, fine_level), fine_level, lanes, 1 << 7, fine)) return false;
    if (both != 0 && !blend_anywhere<up_between>(map, on_levels(map, at, coarse_level), coarse_level, both, 1 << 7, coarse)) return false;
    const v16 counted = _mm512_maskz_mov_epi32(lanes, weights);
#pragma GCC unroll 4
    for (int n = 0; n < Channels; ++n) sum[n] = _mm512_dpwssd_epi32(sum[n], _mm512_permutex2var_epi8(fine[n], per_lane(0x42410201), coarse[n]), counted);
  }
  return true;
}

template <int Channels>
SPANTEX_INLINE bool draw_aniso(const row_work& work, const batch& b, int k) {
  const planar_map& map = *work.texels;
  span_coefficients c{};
  c.c_u = b.c_u[k]; c.a_u = b.a_u[k]; c.b_u = b.b_u[k];
  c.c_v = b.c_v[k]; c.a_v = b.a_v[k]; c.b_v = b.b_v[k];
  c.g = b.g[k]; c.h = b.h[k];
  c.exponent = int8_t(b.exponent[k]);
  span_axis(q, c);
  const bool flat = (c.g | c.h) == 0, affine = b.terms[k] == 0;
  const grouping how = grouping_of(c);
  offsets o = offsets_of(b, k, how);
  v16 nu[quads], nv[quads], level[quads], samples[quads], out[quads] = {};
  forms(how, c.axis.c_u, c.axis.a_u, c.axis.b_u, nu);
  forms(how, c.axis.c_v, c.axis.a_v, c.axis.b_v, nv);
  __mmask16 several = 0;
#pragma GCC unroll 1
  for (int n = 0; n < quads; ++n) {
    const shapes16 shape = shapes_of(c.axis, nu[n], nv[n], o.e[n], flat, work.last_level);
    level[n] = shape.level;
    samples[n] = shape.samples;
    several |= _mm512_cmpgt_epi32_mask(shape.samples, set32(1));
  }
  if (several == 0 && how == grouping::square) return draw_at_levels<true, Channels>(work, b, k, o, level);
#pragma GCC unroll 1
  for (int n = 0; n < quads; ++n) {
    if ((work.masks[b.first + k] & pixels_of(how, n)) == 0) continue;
    const shapes16 shape{level[n], samples[n]};
    const v16 one = set32(1), fine_level = _mm512_srli_epi32(shape.level, 8), coarse_level = _mm512_min_epi32(_mm512_add_epi32(fine_level, one), set32(work.last_level));
    const v16 fraction = _mm512_and_si512(shape.level, set32(255)), weights = level_weights16(fraction);
    const int most = _mm512_reduce_max_epi32(shape.samples);
    const positions p = positions_of(b, k, o, n);
    if (most == 1) {
      if (!by_level_anywhere<true>(map, p, work.last_level, fine_level, fraction, out[n])) return false;
      continue;
    }
    const reciprocals16 r = affine ? reciprocals16{} : reciprocal16(o.e[n]);
    v16 sum[Channels];
    if (!sum_of_rows(map, texels_of(p), axis16(nu[n], affine, r, c.axis.exponent), axis16(nv[n], affine, r, c.axis.exponent), shape, most, fine_level, coarse_level, weights,
                     _mm512_test_epi32_mask(fraction, fraction), sum)) return false;
    const v16 inverse = _mm512_permutexvar_epi32(_mm512_sub_epi32(shape.samples, one), _mm512_load_si512(of_samples.inverse));
#pragma GCC unroll 4
    for (int m = 0; m < Channels; ++m) sum[m] = mean16(sum[m], shape.samples, inverse);
    out[n] = packed16(sum);
  }
  if (how == grouping::rows) quads_of_rows(out);
  if (how == grouping::columns) quads_of_columns(out);
  write(work, b.sx + k, work.masks[b.first + k], out);
  return true;
}
