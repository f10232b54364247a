// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: sections of local memory of eight spans at once, a lane for each span and axis. Of spans of which what is planned tells where their
// quads lie; of others sections.hpp asks the pixels. Included by by_blocks.hpp alone.
#pragma once

SPANTEX_INLINE v16 both_axes(__m256i u, __m256i v) { return _mm512_inserti64x4(_mm512_castsi256_si512(u), v, 1); }
SPANTEX_INLINE v16 both_axes(int32_t u, int32_t v) { return both_axes(_mm256_set1_epi32(u), _mm256_set1_epi32(v)); }
template <int32_t U, int32_t V> SPANTEX_INLINE v16 both_axes() { return _mm512_load_si512(number_of_axes<U, V>); }

// Where quads lie on level 0, s15.16, u in the lower eight lanes, v in the upper: so far to either side of their centres. A 64th of a texel holds every rounding. Mantissas
// are below 2^30, the other margins as much again at most: a quarter of them is added up, so that 32 bits hold the sum.
struct quad_bounds {
  v16 middle, right, below, spread, to16, base;

  // Quarters of how far the quads' centres lie from the span's (half of quad_cut's right and below), and of how far a quad spreads.
  SPANTEX_INLINE quad_bounds(const batch& b, v16 to_right, v16 to_below, v16 of_quad) {
    const v16 x = _mm512_broadcast_i64x4(got(b.exponent));
    spread = _mm512_add_epi32(of_quad, _mm512_sllv_epi32(of32<1>(), _mm512_sub_epi32(x, of32<2 + 6>())));
    middle = _mm512_srai_epi32(both_axes(got(b.c_u), got(b.c_v)), 2);
    right = to_right;
    below = to_below;
    to16 = _mm512_sub_epi32(x, of32<2 + 16>());
    base = _mm512_slli_epi32(both_axes(got(b.base_u), got(b.base_v)), 16);
  }

  // Square ones, between the corners of the parallelogram that a quad would be if nothing were divided. 1/w moves a position by less than 2^(extent + slope + 1).
  SPANTEX_INLINE static quad_bounds undivided(const batch& b) {
    const v16 a = both_axes(got(b.a_u), got(b.a_v)), d = both_axes(got(b.b_u), got(b.b_v)), steps = _mm512_srai_epi32(_mm512_add_epi32(_mm512_abs_epi32(a), _mm512_abs_epi32(d)), 2);
    const v16 moved = _mm512_sllv_epi32(of32<1>(), _mm512_broadcast_i64x4(_mm256_add_epi32(_mm256_add_epi32(got(b.exponent), got(b.affine_log2)), _mm256_set1_epi32(-2))));
    return {b, a, d, _mm512_add_epi32(_mm512_add_epi32(steps, _mm512_slli_epi32(steps, 1)), moved)};
  }

  // plan_bounds().
  SPANTEX_INLINE static quad_bounds divided(const batch& b) { return {b, _mm512_load_si512(b.right), _mm512_load_si512(b.below), _mm512_load_si512(b.spread)}; }

  SPANTEX_INLINE v16 centre(int n) const {
    const v16 across = n & 1 ? _mm512_add_epi32(middle, right) : _mm512_sub_epi32(middle, right);
    return n & 2 ? _mm512_add_epi32(across, below) : _mm512_sub_epi32(across, below);
  }
  SPANTEX_INLINE v16 low(int n) const { return _mm512_add_epi32(base, _mm512_srav_epi32(_mm512_sub_epi32(centre(n), spread), to16)); }
  SPANTEX_INLINE v16 high(int n) const { return _mm512_add_epi32(base, _mm512_srav_epi32(_mm512_add_epi32(centre(n), spread), to16)); }

  // Of all quads.
  SPANTEX_INLINE v16 aside() const { return _mm512_add_epi32(_mm512_add_epi32(_mm512_abs_epi32(right), _mm512_abs_epi32(below)), spread); }
  SPANTEX_INLINE v16 lowest() const { return _mm512_add_epi32(base, _mm512_srav_epi32(_mm512_sub_epi32(middle, aside()), to16)); }
  SPANTEX_INLINE v16 highest() const { return _mm512_add_epi32(base, _mm512_srav_epi32(_mm512_add_epi32(middle, aside()), to16)); }
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

// How spans' sections lie, bit k of span k's: all of its quads' are here; they are more than eight rows, more than sixteen, more than eight columns (16 at most).
struct section_kinds { __mmask8 here, deep, high, broad; };

// What the axes have on each span's level.
SPANTEX_INLINE v16 of_both_axes(v16 levels, const int32_t (&u)[max_planar_levels], const int32_t (&v)[max_planar_levels]) {
  return _mm512_permutex2var_epi32(_mm512_load_si512(u), _mm512_or_si512(levels, both_axes<0, max_planar_levels>()), _mm512_load_si512(v));
}

// Sections of 2x2 texels on a level of each span, which begin anywhere: of 16x16 texels at most or, High, 8 columns of 24 rows.
// texel: the one of the level that a bound needs. all: what sections of 16x16 have is left of smaller ones too.
template <bool High>
SPANTEX_INLINE section_kinds find_sections(const planar_map& map, v16 levels, const quad_ends& ends, bool all, batch_sections& s, auto&& texel) {
  constexpr __mmask16 columns = 0x00FF, rows = 0xFF00;
  const planar_levels& texels = map.levels();
  const auto of_axes = [&](const int32_t (&u)[max_planar_levels], const int32_t (&v)[max_planar_levels]) SPANTEX_INLINED { return of_both_axes(levels, u, v); };
  const v16 bytes = of_axes(texels.column_bytes, texels.row_bytes), one = of32<1>();
  const __m256i origin = _mm512_castsi512_si256(_mm512_permutexvar_epi32(levels, _mm512_load_si512(texels.origin)));
  // Columns of blocks are counted, and rows of texels.
  const auto counted = [&](v16 k) SPANTEX_INLINED { return _mm512_mask_srai_epi32(k, columns, k, 3); };
  const v16 last_block = of_axes(texels.last_column, texels.last_row), last = _mm512_mask_slli_epi32(last_block, rows, last_block, 3), step = both_axes<1, block_side>();
  const auto held = [&](v16 k) SPANTEX_INLINED { return _mm512_max_epi32(_mm512_min_epi32(k, last), both_axes<-apron, -texel_apron>()); };
  const auto place_of = [&](v16 k) SPANTEX_INLINED {
    const v16 stacks = _mm512_mullo_epi32(_mm512_mask_srai_epi32(k, rows, k, stack_log2 + 3), bytes);
    return _mm512_mask_add_epi32(stacks, rows, stacks, _mm512_slli_epi32(_mm512_and_si512(k, of32<(block_side << stack_log2) - 1>()), 3));
  };
  const __mmask16 periodic = __mmask16((map.period_u() != 0 ? columns : 0) | (map.period_v() != 0 ? rows : 0));
  const v16 most = both_axes<2 * block_side - 1, (High ? 3 : 2) * block_side - 1>();
  v16 first[quads], sizes[quads];
  __mmask16 more = 0, higher = 0, bad = 0;
#pragma GCC unroll 4
  for (int n = 0; n < quads; ++n) {
    const v16 end = _mm512_add_epi32(texel(ends.high[n]), one), from = texel(ends.low[n]), size = _mm512_sub_epi32(end, from);
    first[n] = from;
    sizes[n] = size;
    const __mmask16 two = _mm512_cmpgt_epi32_mask(size, of32<block_side - 1>());
    more |= two;
    // Where blocks repeat, the last one that is read must be one of the map's: that of the end's column, or of the last eight rows.
    const v16 begun = counted(from);
    v16 next = _mm512_mask_add_epi32(begun, two, begun, step);
    if constexpr (High) {
      const __mmask16 three = _mm512_cmpgt_epi32_mask(size, of32<2 * block_side - 1>());
      higher |= three;
      next = _mm512_mask_add_epi32(next, three, next, step);
    }
    const v16 reached = _mm512_mask_mov_epi32(next, columns, counted(end));
    const __mmask16 outside = _mm512_cmpneq_epi32_mask(held(begun), begun) | _mm512_cmpgt_epi32_mask(reached, last);
    bad |= __mmask16(_mm512_cmpgt_epu32_mask(size, most) | (periodic & outside));
  }
  const __mmask8 deep = __mmask8(more >> batch_size), high = __mmask8(higher >> batch_size), broad = __mmask8(more);
  const bool large = all || more != 0;
  if (High && deep != 0) {
    // Loads of eight rows take half as long again where one of their halves lies across two lines of memory: rows begin at a multiple of four where they need no more eights for it,
    // of a batch of which some need two (where none does, it costs as much as it saves).
#pragma GCC unroll 4
    for (int n = 0; n < quads; ++n) {
      const v16 before = _mm512_maskz_and_epi32(rows, first[n], of32<3>()), class_changes = _mm512_xor_si512(sizes[n], _mm512_add_epi32(sizes[n], before));
      first[n] = _mm512_mask_sub_epi32(first[n], _mm512_testn_epi32_mask(class_changes, of32<-block_side>()), first[n], before);
    }
  }
#pragma GCC unroll 4
  for (int n = 0; n < quads; ++n) {
    const v16 begun = counted(first[n]), next = _mm512_add_epi32(begun, step);
    const auto lower = [](v16 x) SPANTEX_INLINED { return _mm512_castsi512_si256(x); };
    const auto column_at = [&](v16 k) SPANTEX_INLINED { return _mm256_mullo_epi32(lower(held(k)), lower(bytes)); };
    const v16 at = place_of(held(begun));
    const __m256i x0 = lower(at), x1 = column_at(next), y0 = _mm256_add_epi32(_mm512_extracti64x4_epi64(at, 1), origin);
    put(s.at[0][0][n], _mm256_add_epi32(x0, y0));
    put(s.at[1][0][n], _mm256_add_epi32(x1, y0));
    put(s.row[n], _mm512_extracti64x4_epi64(first[n], 1));
    if (large) {
      const __m256i x2 = column_at(_mm512_add_epi32(next, one)), y1 = _mm256_add_epi32(_mm512_extracti64x4_epi64(place_of(held(next)), 1), origin);
      put(s.at[2][0][n], _mm256_add_epi32(x2, y0));
      put(s.at[0][1][n], _mm256_add_epi32(x0, y1));
      put(s.at[1][1][n], _mm256_add_epi32(x1, y1));
      put(s.at[2][1][n], _mm256_add_epi32(x2, y1));
    }
    if (High && high != 0) {
      const __m256i y2 = _mm256_add_epi32(_mm512_extracti64x4_epi64(place_of(held(_mm512_add_epi32(next, step))), 1), origin);
      put(s.at[0][2][n], _mm256_add_epi32(x0, y2));
      put(s.at[1][2][n], _mm256_add_epi32(x1, y2));
    }
    put(s.shift[n], _mm256_slli_epi32(lower(first[n]), 3));
  }
  return {__mmask8(~(bad | bad >> batch_size | (high & broad))), deep, high, broad};
}

// On levels whose sides halve exactly.
template <bool High>
SPANTEX_INLINE section_kinds find_sections(const planar_map& map, __m256i level, const quad_ends& ends, bool all, batch_sections& s) {
  const v16 levels = both_axes(level, level), half = _mm512_sllv_epi32(of32<1 << 15>(), levels), drop = _mm512_add_epi32(levels, of32<16>());
  return find_sections<High>(map, levels, ends, all, s, [&](v16 position) SPANTEX_INLINED { return _mm512_srav_epi32(_mm512_sub_epi32(position, half), drop); });
}

// Bits of fraction that spans' offsets have.
SPANTEX_INLINE __m256i bits_of(const batch& b) {
  const __mmask8 divided = _mm256_cmpeq_epi32_mask(got(b.terms), _mm256_set1_epi32(divide_terms));
  return _mm256_mask_mov_epi32(got(b.exponent), divided, _mm256_set1_epi32(q.coordinate_bits));
}

// What rounds offsets with so many bits of fraction to coordinate_bits, and then snaps them: half of what they are snapped to, 2^shift, less half a texel.
constexpr int32_t before_texel = 1 - (1 << q.subtexel_bits);
SPANTEX_INLINE __m256i start_of(__m256i bits, __m256i shift) {
  const __m256i rounding = _mm256_sllv_epi32(_mm256_set1_epi32(1), _mm256_sub_epi32(bits, _mm256_set1_epi32(q.coordinate_bits + 1)));  // 0 where they are divided: nothing is left to round
  return _mm256_add_epi32(rounding, _mm256_sllv_epi32(_mm256_set1_epi32(before_texel), shift));
}

// On level 0, and what leads from offsets to positions in sections, to be snapped: fields_of_offsets.
SPANTEX_WRAPS SPANTEX_INLINE void place(const row_work& work, __mmask8 flat, batch& b) {
  const section_kinds kinds = find_sections<false>(*work.texels, _mm256_setzero_si256(), quad_ends(quad_bounds::undivided(b)), false, b.sections);
  b.placed = flat & kinds.here;
  b.deep = kinds.deep;
  b.broad = kinds.broad;
  // Positions modulo 16 texels fit 32 bits, of sections of 8x8 modulo 8.
  const __m256i most = _mm256_mask_mov_epi32(_mm256_set1_epi32(29), kinds.deep | kinds.broad, _mm256_set1_epi32(28)), bits = _mm256_min_epi32(bits_of(b), most);
  const __m256i start = start_of(bits, _mm256_sub_epi32(bits, _mm256_set1_epi32(q.subtexel_bits + 1)));
  const auto from = [&](const int32_t (&base)[batch_size], __m256i first) SPANTEX_INLINED { return _mm256_add_epi32(start, _mm256_sllv_epi32(_mm256_sub_epi32(got(base), first), bits)); };
#pragma GCC unroll 4
  for (int n = 0; n < quads; ++n) {
    put(b.from[n][0], from(b.base_u, _mm256_srai_epi32(got(b.sections.shift[n]), 3)));
    put(b.from[n][1], from(b.base_v, got(b.sections.row[n])));
  }
  put(b.column_bits, bits);
}

// Single texels of level 0: 8x8 of them in rows. Their places in 8x8 are the three bits above the fraction of an offset with its section's added, and so must fit 32.
SPANTEX_WRAPS SPANTEX_INLINE void place_rows(const row_work& work, __mmask8 flat, batch& b) {
  const quad_bounds bounds = quad_bounds::undivided(b);
  const planar_map& map = *work.texels;
  const __m256i fraction = _mm256_min_epi32(got(b.exponent), _mm256_set1_epi32(32 - 3));
  const v16 base = _mm512_srai_epi32(bounds.base, 16), seven = of32<7>(), bits = both_axes(fraction, fraction), one = of32<1>();
  const v16 half = _mm512_sllv_epi32(one, _mm512_sub_epi32(bits, of32<q.coordinate_bits + 1>()));
  const v16 least = of32<-texel_apron>(), most = both_axes(map.rows_across() + texel_apron - block_side, map.rows_down() + texel_apron - block_side);
  // Where all quads of a span take from one 8x8, they have it in common.
  const v16 span_first = _mm512_srai_epi32(bounds.lowest(), 16), reached = _mm512_sub_epi32(_mm512_srai_epi32(bounds.highest(), 16), span_first);
  const auto both = [](__mmask16 axes) SPANTEX_INLINED { return __mmask8(axes & axes >> batch_size); };
  b.together = both(_mm512_cmple_epi32_mask(reached, seven));
  b.few_rows = _mm512_cmple_epi32_mask(reached, of32<block_side / 2 - 1>()) >> batch_size;
  const __mmask16 together = __mmask16(b.together | b.together << batch_size);
  __mmask16 fit = 0xFFFF;
#pragma GCC unroll 4
  for (int n = 0; n < quads; ++n) {
    const v16 first = _mm512_mask_mov_epi32(_mm512_srai_epi32(bounds.low(n), 16), together, span_first), end = _mm512_srai_epi32(bounds.high(n), 16);
    fit = __mmask16(fit & _mm512_cmple_epi32_mask(_mm512_sub_epi32(end, first), seven) & _mm512_cmpge_epi32_mask(first, least) & _mm512_cmple_epi32_mask(first, most));
    _mm512_store_si512(b.from[n], _mm512_add_epi32(half, _mm512_sllv_epi32(_mm512_sub_epi32(base, first), bits)));
    const __m256i down = _mm256_mullo_epi32(_mm512_extracti64x4_epi64(first, 1), _mm256_set1_epi32(map.row_stride()));
    put(b.row_at[n], _mm256_add_epi32(_mm512_castsi512_si256(first), down));
  }
  put(b.column_bits, fraction);
  put(b.row_bits, _mm256_sub_epi32(fraction, _mm256_set1_epi32(3)));
  b.placed = flat & _mm256_cmpneq_epi32_mask(got(b.terms), _mm256_set1_epi32(divide_terms)) & both(fit);
}

// Where the quads of spans lie on their pixels' whole level and the one after it; and, where some pixels' whole level is that one, on a third; and what snaps positions to them
// (snapping).
struct batch_places {
  batch_sections fine, coarse, next;
  static constexpr int more_bits = 1;          // of fraction that positions have beyond those that they are snapped to (sampling)
  alignas(32) int32_t from_u[quads][batch_size], from_v[quads][batch_size], drop[batch_size], turn[batch_size];
  // What is added to positions on the fine level, in both halves of a lane: a half of the sum is that on the coarse one, a quarter that on the next. to_coarse is one less: its half is a mean, which is rounded up.
  alignas(32) int32_t to_coarse[quads][batch_size], to_next[quads][batch_size];
  alignas(32) int32_t level[batch_size];       // the fine one
  alignas(32) int32_t excess[batch_size];      // bits of the offsets to be dropped first
  uint32_t placed = 0, deep = 0, high = 0, broad = 0;  // bit k, as above
  uint32_t coarse_deep = 0, coarse_broad = 0;          // those of coarser levels
};

// Where the spans `some` lie, on the levels `fine`; of those `alone` on that level, of those `crossing` on the two after it (one, of filters that take one level) as well.
template <bool TwoLevels>
SPANTEX_WRAPS SPANTEX_INLINE void place_spans(const row_work& work, const batch& b, uint32_t some, uint32_t alone, uint32_t crossing, __m256i fine, batch_places& p) {
  const auto after = [&](__m256i level) SPANTEX_INLINED { return _mm256_min_epi32(_mm256_add_epi32(level, _mm256_set1_epi32(1)), _mm256_set1_epi32(work.last_level)); };
  const __m256i coarse = after(fine);
  // plan_bounds() holds up to a slope of 1/4.
  some &= _mm256_cmple_epi32_mask(got(b.slope_log2), _mm256_set1_epi32(-2));
  if (some == 0) return;
  const quad_ends ends(quad_bounds::divided(b));
  const section_kinds kinds = find_sections<true>(*work.texels, fine, ends, false, p.fine);
  some &= kinds.here;
  const uint32_t high = kinds.high & some;
  // Positions modulo 16 texels of the last level that is taken fit 32 bits, and modulo 32 of one whose sections are high.
  const __m256i given = bits_of(b);
  const __m256i after_fine = _mm256_mask_mov_epi32(_mm256_maskz_set1_epi32(__mmask8(~alone | high), 1), __mmask8(crossing), _mm256_set1_epi32(2)), bits_and_level = _mm256_add_epi32(given, _mm256_add_epi32(fine, after_fine));
  const __m256i excess = _mm256_max_epi32(_mm256_sub_epi32(bits_and_level, _mm256_set1_epi32(28)), _mm256_setzero_si256()), bits = _mm256_sub_epi32(given, excess);
  const auto find_after = [&](uint32_t without, __m256i level, batch_sections& out) SPANTEX_INLINED {
    if ((some & ~without) == 0) return;
    const section_kinds found = find_sections<false>(*work.texels, level, ends, (crossing | high) != 0, out);
    some &= without | found.here;
    p.coarse_deep |= found.deep & ~without;
    p.coarse_broad |= found.broad & ~without;
  };
  find_after(alone & ~crossing, coarse, p.coarse);
  if constexpr (TwoLevels) find_after(~crossing, after(coarse), p.next);
  p.placed = some;
  p.deep = kinds.deep;
  p.high = high;
  p.broad = kinds.broad;
  put(p.level, fine);
  const __m256i shift = _mm256_sub_epi32(_mm256_add_epi32(bits, fine), _mm256_set1_epi32(q.subtexel_bits + 1));
  const __m256i start = start_of(bits, shift);
  const auto from = [&](const int32_t (&base)[batch_size]) SPANTEX_INLINED { return _mm256_add_epi32(start, _mm256_sllv_epi32(got(base), bits)); };
  const __m256i from_u = from(b.base_u), from_v = from(b.base_v), texel = _mm256_add_epi32(bits, fine);
  put(p.excess, excess);
  put(p.drop, shift);
  put(p.turn, _mm256_sub_epi32(shift, _mm256_set1_epi32(16)));
  // Before they are halved 2 and 256 take the place of 1 and 128 on the coarse level, then 4 and 512; columns and rows are counted from others.
  const auto column = [](const batch_sections& s, int n) SPANTEX_INLINED { return _mm256_srai_epi32(got(s.shift[n]), 3); };
  const auto to = [&](const batch_sections& s, int n, int levels) SPANTEX_INLINED {
    const auto moved = [&](__m256i fine_first, __m256i first) SPANTEX_INLINED {
      const __m256i less = _mm256_sub_epi32(fine_first, _mm256_slli_epi32(first, levels));
      return _mm256_add_epi32(_mm256_slli_epi32(less, q.subtexel_bits + batch_places::more_bits), _mm256_set1_epi32(before_texel * ((1 << levels) - 1) - (levels == 1)));
    };
    return _mm256_mask_mov_epi16(_mm256_slli_epi32(moved(got(p.fine.row[n]), got(s.row[n])), 16), 0x5555, moved(column(p.fine, n), column(s, n)));
  };
#pragma GCC unroll 4
  for (int n = 0; n < quads; ++n) {
    put(p.from_u[n], _mm256_sub_epi32(from_u, _mm256_sllv_epi32(column(p.fine, n), texel)));
    put(p.from_v[n], _mm256_sub_epi32(from_v, _mm256_sllv_epi32(got(p.fine.row[n]), texel)));
    put(p.to_coarse[n], to(p.coarse, n, 1));
  }
  if (TwoLevels && crossing != 0) [[unlikely]]
    for (int n = 0; n < quads; ++n) put(p.to_next[n], to(p.next, n, 2));
}
