// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: sections of local memory of eight spans at once, a lane for each span and axis. Of spans of which what is planned tells where their
// quads lie; of others sections.hpp asks the pixels. Included by ../avx512.cpp alone.
#pragma once

constexpr uint64_t columns_below[block_side] = {0, 0x0101010101010101, 0x0303030303030303, 0x0707070707070707, 0x0F0F0F0F0F0F0F0F, 0x1F1F1F1F1F1F1F1F,
                                                0x3F3F3F3F3F3F3F3F, 0x7F7F7F7F7F7F7F7F};

SPANTEX_INLINE v16 both_axes(__m256i u, __m256i v) { return _mm512_inserti64x4(_mm512_castsi256_si512(u), v, 1); }
SPANTEX_INLINE v16 both_axes(int32_t u, int32_t v) { return both_axes(_mm256_set1_epi32(u), _mm256_set1_epi32(v)); }

// Where quads lie on level 0, s15.16, u in the lower eight lanes, v in the upper: so far to either side of their centres. A 64th of a texel holds every rounding. Mantissas
// are below 2^30, the other margins as much again at most: a quarter of them is added up, so that 32 bits hold the sum.
struct quad_bounds {
  v16 middle, right, below, spread, to16, base;

  // From steps of half pixels about the span's centre, and a quarter of how far a quad spreads.
  SPANTEX_INLINE quad_bounds(const batch& b, v16 step_x, v16 step_y, v16 of_quad) {
    const v16 x = _mm512_broadcast_i64x4(got(b.exponent));
    spread = _mm512_add_epi32(of_quad, _mm512_sllv_epi32(of32<1>(), _mm512_sub_epi32(x, of32<2 + 6>())));
    middle = _mm512_srai_epi32(both_axes(got(b.c_u), got(b.c_v)), 2);
    right = step_x;
    below = step_y;
    to16 = _mm512_sub_epi32(x, of32<2 + 16>());
    base = _mm512_slli_epi32(both_axes(got(b.base_u), got(b.base_v)), 16);
  }

  // Between the corners of the parallelogram that a quad would be if nothing were divided. 1/w moves a position by less than 2^(extent + slope + 1).
  SPANTEX_INLINE static quad_bounds undivided(const batch& b) {
    const v16 a = both_axes(got(b.a_u), got(b.a_v)), d = both_axes(got(b.b_u), got(b.b_v)), steps = _mm512_srai_epi32(_mm512_add_epi32(_mm512_abs_epi32(a), _mm512_abs_epi32(d)), 2);
    const v16 moved = _mm512_sllv_epi32(of32<1>(), _mm512_broadcast_i64x4(_mm256_add_epi32(_mm256_add_epi32(got(b.exponent), got(b.affine_log2)), _mm256_set1_epi32(-2))));
    return {b, a, d, _mm512_add_epi32(_mm512_add_epi32(steps, _mm512_slli_epi32(steps, 1)), moved)};
  }

  // plan_bounds().
  SPANTEX_INLINE static quad_bounds divided(const batch& b) { return {b, _mm512_load_si512(b.step_x), _mm512_load_si512(b.step_y), _mm512_srai_epi32(_mm512_load_si512(b.spread), 2)}; }

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
  SPANTEX_INLINE explicit quad_ends(const quad_bounds& bounds) {
#pragma GCC unroll 4
    for (int n = 0; n < quads; ++n) {
      low[n] = bounds.low(n);
      high[n] = bounds.high(n);
    }
  }
};

// How spans' sections lie, bit k of span k's: all of its quads' are here; they are eight rows and eight columns at most; more than eight columns.
struct section_kinds { __mmask8 here, shallow, wide; };

// Sections of 2x2 texels on a level of each span. Not Deep: shallow ones alone.
template <bool Deep>
SPANTEX_INLINE section_kinds find_sections(const planar_map& map, __m256i level, const quad_ends& ends, batch_sections& s) {
  constexpr __mmask16 rows = 0xFF00;
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
  const section_kinds kinds{0, __mmask8(~(large | large >> batch_size)), __mmask8(large)};
  const __mmask8 deep = __mmask8(~kinds.shallow);
  if constexpr (!Deep) bad |= deep;
  const __mmask16 strict = __mmask16((map.period_u() != 0 ? 0xFF : 0) | (map.period_v() != 0 ? rows : 0)), even_first = __mmask16(rows | kinds.wide);
  const __mmask16 from_first = __mmask16(kinds.shallow << batch_size);
  const v16 last_first = _mm512_slli_epi32(last, 3);
  const auto held = [&](v16 k) SPANTEX_INLINED { return _mm512_max_epi32(_mm512_min_epi32(k, last), of32<-apron>()); };
  // Bytes of columns of blocks, and of rows of texels.
  const auto place_of = [&](v16 k) SPANTEX_INLINED {
    const v16 stacks = _mm512_mullo_epi32(_mm512_mask_srai_epi32(k, rows, k, stack_log2 + 3), bytes);
    return _mm512_mask_add_epi32(stacks, rows, stacks, _mm512_slli_epi32(_mm512_and_si512(k, of32<(block_side << stack_log2) - 1>()), 3));
  };
#pragma GCC unroll 4
  for (int n = 0; n < quads; ++n) {
    const v16 k0 = held(block0[n]), k1 = held(block1[n]);
    bad = __mmask16(bad | (strict & (_mm512_cmpneq_epi32_mask(k0, block0[n]) | _mm512_cmpneq_epi32_mask(k1, block1[n]))));
    const __mmask16 swap = _mm512_mask_test_epi32_mask(even_first, block0[n], one);
    const v16 e = _mm512_mask_mov_epi32(k0, swap, k1), o = _mm512_mask_mov_epi32(k1, swap, k0);
    const v16 first_row = _mm512_max_epi32(_mm512_min_epi32(first[n], last_first), of32<-texel_apron>());
    const v16 even = place_of(_mm512_mask_mov_epi32(_mm512_mask_slli_epi32(e, rows, e, 3), from_first, first_row));
    const __m256i y0 = _mm256_add_epi32(_mm512_extracti64x4_epi64(even, 1), origin);
    put(s.at[0][0][n], _mm256_add_epi32(_mm512_castsi512_si256(even), y0));
    put(s.row[n], _mm512_extracti64x4_epi64(_mm512_maskz_mov_epi32(from_first, first[n]), 1));
    if (!Deep || deep == 0) {
      put(s.at[1][0][n], _mm256_add_epi32(_mm256_mullo_epi32(_mm512_castsi512_si256(o), _mm512_castsi512_si256(bytes)), y0));
    } else {
      const v16 odd = place_of(_mm512_mask_slli_epi32(o, rows, o, 3));
      const __m256i x1 = _mm512_castsi512_si256(odd), y1 = _mm256_add_epi32(_mm512_extracti64x4_epi64(odd, 1), origin);
      put(s.at[0][1][n], _mm256_add_epi32(_mm512_castsi512_si256(even), y1));
      put(s.at[1][0][n], _mm256_add_epi32(x1, y0));
      put(s.at[1][1][n], _mm256_add_epi32(x1, y1));
    }
    const v8 column = _mm512_cvtepu32_epi64(_mm256_and_si256(_mm512_castsi512_si256(first[n]), _mm256_set1_epi32(block_side - 1)));
    _mm512_store_si512(s.merged[n], _mm512_permutexvar_epi64(column, _mm512_loadu_si512(columns_below)));
  }
  return {__mmask8(~(bad | bad >> batch_size)), kinds.shallow, kinds.wide};
}

// On level 0.
SPANTEX_INLINE void place(const row_work& work, __mmask8 flat, batch& b) {
  const section_kinds kinds = find_sections<true>(*work.texels, _mm256_setzero_si256(), quad_ends(quad_bounds::undivided(b)), b.sections);
  b.placed = flat & kinds.here;
  b.shallow = kinds.shallow;
  b.wide = kinds.wide;
}

// Single texels of level 0: 8x8 of them in rows. Their places in 8x8 are the three bits above the fraction of an offset with its section's added, and so must fit 32.
SPANTEX_WRAPS SPANTEX_INLINE void place_rows(const row_work& work, __mmask8 flat, batch& b) {
  const quad_bounds bounds = quad_bounds::undivided(b);
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
  // One bit of fraction more than on the fine level: that leads to the coarse one by an addition, in both halves of a lane.
  alignas(32) int32_t from_u[batch_size], from_v[quads][batch_size], drop[batch_size], turn[batch_size], to_coarse[quads][batch_size];
  alignas(32) int32_t excess[batch_size];      // bits of the offsets to be dropped first
  uint32_t placed = 0, shallow = 0, wide = 0;  // bit k, as above; those of the coarse level are shallow
};

// Spans `alike` are on the levels `whole`; those `alone` take nothing from the next one.
SPANTEX_WRAPS SPANTEX_INLINE void place_alike(const row_work& work, const batch& b, uint32_t alike, uint32_t alone, const int32_t (&whole)[batch_size], batch_places& p) {
  const __m256i fine = got(whole), coarse = _mm256_min_epi32(_mm256_add_epi32(fine, _mm256_set1_epi32(1)), _mm256_set1_epi32(work.last_level));
  // Positions modulo 32 texels of the coarser level fit 32 bits (shorten()).
  const __m256i excess = _mm256_max_epi32(_mm256_sub_epi32(_mm256_add_epi32(got(b.exponent), coarse), _mm256_set1_epi32(27)), _mm256_setzero_si256()), bits = _mm256_sub_epi32(got(b.exponent), excess);
  // plan_bounds() holds up to a slope of 1/4.
  alike &= _mm256_cmple_epi32_mask(got(b.slope_log2), _mm256_set1_epi32(-2)) & _mm256_cmpneq_epi32_mask(got(b.terms), _mm256_set1_epi32(divide_terms));
  p.placed = 0;
  if (alike == 0) return;
  const quad_ends ends(quad_bounds::divided(b));
  const section_kinds kinds = find_sections<true>(*work.texels, fine, ends, p.fine);
  alike &= kinds.here;
  if ((alike & ~alone) != 0) alike &= alone | find_sections<false>(*work.texels, coarse, ends, p.coarse).here;
  p.placed = alike;
  p.shallow = kinds.shallow;
  p.wide = kinds.wide;
  const __m256i one = _mm256_set1_epi32(1), shift = _mm256_sub_epi32(_mm256_add_epi32(bits, fine), _mm256_set1_epi32(q.subtexel_bits + 1));
  const __m256i rounding = _mm256_sllv_epi32(one, _mm256_sub_epi32(bits, _mm256_set1_epi32(q.coordinate_bits + 1)));
  constexpr int32_t before = 1 - (1 << q.subtexel_bits);  // half of what positions are snapped to, less half a texel
  const __m256i start = _mm256_add_epi32(rounding, _mm256_sllv_epi32(_mm256_set1_epi32(before), shift));
  const auto from = [&](const int32_t (&base)[batch_size]) SPANTEX_INLINED { return _mm256_add_epi32(start, _mm256_sllv_epi32(got(base), bits)); };
  const __m256i from_v = from(b.base_v), texel = _mm256_add_epi32(bits, fine);
  put(p.excess, excess);
  put(p.from_u, from(b.base_u));
  put(p.drop, shift);
  put(p.turn, _mm256_sub_epi32(shift, _mm256_set1_epi32(16)));
#pragma GCC unroll 4
  for (int n = 0; n < quads; ++n) {
    const __m256i row = got(p.fine.row[n]);
    put(p.from_v[n], _mm256_sub_epi32(from_v, _mm256_sllv_epi32(row, texel)));
    // On the coarse level 2 and 256 take the place of 1 and 128; rows are counted from another.
    const __m256i rows = _mm256_sub_epi32(row, _mm256_slli_epi32(got(p.coarse.row[n]), 1));
    put(p.to_coarse[n], _mm256_add_epi32(_mm256_slli_epi32(rows, 16 + q.subtexel_bits + 1), _mm256_set1_epi32(int32_t(0x00010001u * uint16_t(before)))));
  }
}
