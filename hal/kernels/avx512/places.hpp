// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: sections of local memory of eight spans at once, a lane for each span and axis. Of spans that are flat enough to tell where their quads lie
// from what is planned; of others sections.hpp asks the pixels. Included by ../avx512.cpp alone.
#pragma once

constexpr uint64_t columns_below[block_side] = {0, 0x0101010101010101, 0x0303030303030303, 0x0707070707070707, 0x0F0F0F0F0F0F0F0F, 0x1F1F1F1F1F1F1F1F,
                                                0x3F3F3F3F3F3F3F3F, 0x7F7F7F7F7F7F7F7F};

SPANTEX_INLINE v16 both_axes(__m256i u, __m256i v) { return _mm512_inserti64x4(_mm512_castsi256_si512(u), v, 1); }
SPANTEX_INLINE v16 both_axes(int32_t u, int32_t v) { return both_axes(_mm256_set1_epi32(u), _mm256_set1_epi32(v)); }

// Where quads lie on level 0, s15.16, u in the lower eight lanes, v in the upper: between the corners of the parallelogram that a quad would be if
// nothing were divided. 1/w moves a position by less than 2^(extent + slope + 1); a 64th of a texel holds every rounding. Mantissas are below 2^30, each of the two margins
// is as much again at most: a quarter of them is added up, so that 32 bits hold the sum.
struct quad_bounds {
  v16 middle, right, below, spread, to16, base;
  SPANTEX_INLINE explicit quad_bounds(const batch& b) {
    const auto quarter = [](const int32_t (&u)[batch_size], const int32_t (&v)[batch_size]) SPANTEX_INLINED { return _mm512_srai_epi32(both_axes(got(u), got(v)), 2); };
    const v16 a = quarter(b.a_u, b.a_v), d = quarter(b.b_u, b.b_v), x = _mm512_sub_epi32(_mm512_broadcast_i64x4(got(b.exponent)), of32<2>());
    const v16 steps = _mm512_add_epi32(_mm512_abs_epi32(a), _mm512_abs_epi32(d));
    const v16 error = _mm512_broadcast_i64x4(got(b.affine_log2)), one = of32<1>();
    const v16 margin = _mm512_add_epi32(_mm512_sllv_epi32(one, _mm512_add_epi32(x, error)), _mm512_sllv_epi32(one, _mm512_sub_epi32(x, of32<6>())));
    spread = _mm512_add_epi32(_mm512_add_epi32(steps, _mm512_slli_epi32(steps, 1)), margin);
    right = _mm512_slli_epi32(a, 2);
    below = _mm512_slli_epi32(d, 2);
    middle = quarter(b.c_u, b.c_v);
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

// All quads' bounds: a section on any level takes them.
struct quad_ends {
  v16 low[quads], high[quads];
  SPANTEX_INLINE explicit quad_ends(const batch& b) {
    const quad_bounds bounds(b);
#pragma GCC unroll 4
    for (int n = 0; n < quads; ++n) {
      low[n] = bounds.low(n);
      high[n] = bounds.high(n);
    }
  }
};

// Sections of 2x2 texels on a level of each span. Bit k of what is given back: those of span k's quads are all in here; of `wide`: one of them is more than 8 texels
// across. Not MayBeWide: such ones are not in here.
template <bool MayBeWide>
SPANTEX_INLINE __mmask8 find_sections(const planar_map& map, __m256i level, const quad_ends& ends, batch_sections& s, __mmask8& wide) {
  const planar_levels& texels = map.levels();
  const v16 levels = both_axes(level, level), axis = _mm512_or_si512(levels, both_axes(0, max_planar_levels));
  const auto of_axes = [&](const int32_t (&u)[max_planar_levels], const int32_t (&v)[max_planar_levels]) SPANTEX_INLINED {
    return _mm512_permutex2var_epi32(_mm512_load_si512(u), axis, _mm512_load_si512(v));
  };
  const v16 last = of_axes(texels.last_column, texels.last_row), bytes = of_axes(texels.column_bytes, texels.row_bytes);
  const __m256i origin = _mm512_castsi512_si256(_mm512_permutexvar_epi32(levels, _mm512_load_si512(texels.origin)));
  const v16 half = _mm512_sllv_epi32(of32<1 << 15>(), levels), drop = _mm512_add_epi32(levels, of32<16>()), one = of32<1>();
  const auto texel = [&](v16 position) SPANTEX_INLINED { return _mm512_srav_epi32(_mm512_sub_epi32(position, half), drop); };
  v16 first[quads], block0[quads], block1[quads];
  __mmask16 large = 0, bad = 0;
#pragma GCC unroll 4
  for (int n = 0; n < quads; ++n) {
    const v16 end = _mm512_add_epi32(texel(ends.high[n]), one);
    first[n] = texel(ends.low[n]);
    block0[n] = _mm512_srai_epi32(first[n], 3);
    block1[n] = _mm512_srai_epi32(end, 3);
    large |= _mm512_cmpgt_epi32_mask(_mm512_sub_epi32(end, first[n]), of32<block_side - 1>());
    bad |= _mm512_cmpgt_epi32_mask(_mm512_sub_epi32(block1[n], block0[n]), one);
  }
  large &= 0xFF;
  if (!MayBeWide) bad |= large;
  wide = MayBeWide ? __mmask8(large) : __mmask8(0);
  const __mmask16 strict = __mmask16((map.period_u() != 0 ? 0xFF : 0) | (map.period_v() != 0 ? 0xFF00 : 0)), even_first = __mmask16(0xFF00 | wide);
#pragma GCC unroll 4
  for (int n = 0; n < quads; ++n) {
    const auto held = [&](v16 k) SPANTEX_INLINED { return _mm512_max_epi32(_mm512_min_epi32(k, last), of32<-apron>()); };
    const v16 k0 = held(block0[n]), k1 = held(block1[n]);
    bad = __mmask16(bad | (strict & (_mm512_cmpneq_epi32_mask(k0, block0[n]) | _mm512_cmpneq_epi32_mask(k1, block1[n]))));
    const __mmask16 swap = _mm512_mask_test_epi32_mask(even_first, block0[n], one);
    const v16 even = _mm512_mullo_epi32(_mm512_mask_mov_epi32(k0, swap, k1), bytes), odd = _mm512_mullo_epi32(_mm512_mask_mov_epi32(k1, swap, k0), bytes);
    const __m256i x0 = _mm256_add_epi32(_mm512_castsi512_si256(even), origin), x1 = _mm256_add_epi32(_mm512_castsi512_si256(odd), origin);
    const __m256i y0 = _mm512_extracti64x4_epi64(even, 1), y1 = _mm512_extracti64x4_epi64(odd, 1);
    put(s.at[0][0][n], _mm256_add_epi32(x0, y0));
    put(s.at[0][1][n], _mm256_add_epi32(x0, y1));
    put(s.at[1][0][n], _mm256_add_epi32(x1, y0));
    put(s.at[1][1][n], _mm256_add_epi32(x1, y1));
    const v8 column = _mm512_cvtepu32_epi64(_mm256_and_si256(_mm512_castsi512_si256(first[n]), _mm256_set1_epi32(block_side - 1)));
    _mm512_store_si512(s.merged[n], _mm512_permutexvar_epi64(column, _mm512_loadu_si512(columns_below)));
  }
  return __mmask8(~(bad | bad >> batch_size));
}

// On level 0.
SPANTEX_INLINE void place(const row_work& work, __mmask8 flat, batch& b) {
  __mmask8 wide;
  b.placed = flat & find_sections<true>(*work.texels, _mm256_setzero_si256(), quad_ends(b), b.sections, wide);
  b.wide = wide;
}

// Single texels of level 0: 8x8 of them in rows. Their places in 8x8 are the three bits above the fraction of an offset with its section's added, and so must fit 32.
SPANTEX_WRAPS SPANTEX_INLINE void place_rows(const row_work& work, __mmask8 flat, batch& b) {
  const quad_bounds bounds(b);
  const planar_map& map = *work.texels;
  const __m256i fraction = _mm256_min_epi32(got(b.exponent), _mm256_set1_epi32(32 - 3));
  const v16 base = _mm512_srai_epi32(bounds.base, 16), seven = of32<7>(), bits = both_axes(fraction, fraction), one = of32<1>();
  const v16 half = _mm512_sllv_epi32(one, _mm512_sub_epi32(bits, of32<q.coordinate_bits + 1>()));
  const v16 least = of32<-texel_apron>(), most = both_axes(map.rows_across() + texel_apron - block_side, map.rows_down() + texel_apron - block_side);
  __mmask16 fit = 0xFFFF;
#pragma GCC unroll 4
  for (int n = 0; n < quads; ++n) {
    const v16 first = _mm512_srai_epi32(bounds.low(n), 16), end = _mm512_srai_epi32(bounds.high(n), 16);
    fit = __mmask16(fit & _mm512_cmple_epi32_mask(_mm512_sub_epi32(end, first), seven) & _mm512_cmpge_epi32_mask(first, least) & _mm512_cmple_epi32_mask(first, most));
    _mm512_store_si512(b.from[n], _mm512_add_epi32(half, _mm512_sllv_epi32(_mm512_sub_epi32(base, first), bits)));
    const __m256i down = _mm256_mullo_epi32(_mm512_extracti64x4_epi64(first, 1), _mm256_set1_epi32(map.row_stride()));
    put(b.row_at[n], _mm256_add_epi32(_mm512_castsi512_si256(first), down));
  }
  put(b.column_bits, fraction);
  put(b.row_bits, _mm256_sub_epi32(fraction, _mm256_set1_epi32(3)));
  b.placed = flat & _mm256_cmpneq_epi32_mask(got(b.terms), _mm256_set1_epi32(divide_terms)) & fit & (fit >> 8);
}

// Where the quads of spans lie whose pixels are all on one whole level: on that and on the next one, and what snaps positions to them (snapping).
struct batch_places {
  batch_sections fine, coarse;
  alignas(64) int32_t from_u[2][batch_size], from_v[2][batch_size], drop[2][batch_size], turn[2][batch_size];
  uint32_t placed = 0, wide = 0;   // bit k, as above
};

// Spans `alike` are on the levels `whole`; those `alone` take nothing from the next one.
SPANTEX_WRAPS SPANTEX_INLINE void place_alike(const row_work& work, const batch& b, uint32_t alike, uint32_t alone, const int32_t (&whole)[batch_size], batch_places& p) {
  const __m256i fine = got(whole), coarse = _mm256_min_epi32(_mm256_add_epi32(fine, _mm256_set1_epi32(1)), _mm256_set1_epi32(work.last_level)), bits = got(b.exponent);
  // Flat: a quarter of the level's texel at most; positions modulo 32 texels of the coarser one fit 32 bits (shorten()).
  alike &= _mm256_cmple_epi32_mask(_mm256_sub_epi32(got(b.affine_log2), fine), _mm256_set1_epi32(-2)) &
           _mm256_cmple_epi32_mask(_mm256_add_epi32(bits, coarse), _mm256_set1_epi32(27)) & _mm256_cmpneq_epi32_mask(got(b.terms), _mm256_set1_epi32(divide_terms));
  p.placed = 0;
  if (alike == 0) return;
  const quad_ends ends(b);
  __mmask8 wide, no_coarse;
  alike &= find_sections<true>(*work.texels, fine, ends, p.fine, wide);
  if ((alike & ~alone) != 0) alike &= alone | find_sections<false>(*work.texels, coarse, ends, p.coarse, no_coarse);
  p.placed = alike;
  p.wide = wide;
  const v16 shift = _mm512_add_epi32(both_axes(fine, coarse), _mm512_sub_epi32(both_axes(bits, bits), of32<q.subtexel_bits>())), one = of32<1>();
  const v16 half = _mm512_sllv_epi32(one, _mm512_sub_epi32(shift, one));
  const v16 rounding = _mm512_sllv_epi32(one, _mm512_sub_epi32(both_axes(bits, bits), of32<q.coordinate_bits + 1>()));
  const v16 start = _mm512_add_epi32(rounding, _mm512_sub_epi32(half, _mm512_slli_epi32(half, q.subtexel_bits)));
  const auto from = [&](const int32_t (&base)[batch_size]) SPANTEX_INLINED { return _mm512_add_epi32(start, _mm512_sllv_epi32(both_axes(got(base), got(base)), both_axes(bits, bits))); };
  _mm512_store_si512(p.from_u, from(b.base_u));
  _mm512_store_si512(p.from_v, from(b.base_v));
  _mm512_store_si512(p.drop, shift);
  _mm512_store_si512(p.turn, _mm512_sub_epi32(shift, of32<16>()));
}
