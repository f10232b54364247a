// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: a span by each filter. Included by ../avx512.cpp alone.
#pragma once

// --- what registers do not hold ------------------------------------------------------------------------

// Positions of sixteen pixels, s15.16 of level 0.
struct texels16 { v16 u, v; };
SPANTEX_INLINE texels16 texels_of(const positions& p) {
  const auto at = [&](v16 offset, int32_t base) {
    const v16 fraction = _mm512_sra_epi32(_mm512_add_epi32(offset, set32(int32_t(p.half))), _mm_cvtsi32_si128(p.bits - q.coordinate_bits));
    return _mm512_add_epi32(_mm512_slli_epi32(fraction, 16 - q.coordinate_bits), set32(base << 16));
  };
  return {at(p.u, p.base_u), at(p.v, p.base_v)};
}

// on_level() where sides are not exact.
[[gnu::noinline]] v16 on_inexact_levels(v16 position, const int32_t (&ratios)[max_planar_levels], v16 level) {
  const v16 ratio = _mm512_permutexvar_epi32(level, _mm512_load_si512(ratios));
  const auto one = [&](v8 p, v8 r, v8 l) {
    const v8 half = _mm512_sllv_epi64(set(int64_t(1) << 39), l), from = _mm512_sub_epi64(half, _mm512_slli_epi64(half, q.subtexel_bits));
    return _mm512_srav_epi64(_mm512_add_epi64(_mm512_mullo_epi64(p, r), from), _mm512_add_epi64(l, set(40)));
  };
  const auto low = [&](v16 x) { return _mm512_and_si512(x, set(0xFFFFFFFF)); };
  const auto high = [&](v16 x) { return _mm512_srli_epi64(x, 32); };
  const v8 even = one(_mm512_srai_epi64(_mm512_slli_epi64(position, 32), 32), low(ratio), low(level)), odd = one(_mm512_srai_epi64(position, 32), high(ratio), high(level));
  return _mm512_mask_mov_epi32(even, 0xAAAA, _mm512_slli_epi64(odd, 32));
}

// On each lane's level, less half a texel, 7 bits of fraction.
SPANTEX_INLINE texels16 on_levels(const planar_map& map, texels16 p, v16 level) {
  if (!map.exact()) [[unlikely]] return {on_inexact_levels(p.u, map.levels().ratio_u, level), on_inexact_levels(p.v, map.levels().ratio_v, level)};
  const v16 half = _mm512_sllv_epi32(set32(1 << 8), level), from = _mm512_sub_epi32(half, _mm512_slli_epi32(half, q.subtexel_bits)), drop = _mm512_add_epi32(level, set32(9));
  return {_mm512_srav_epi32(_mm512_add_epi32(p.u, from), drop), _mm512_srav_epi32(_mm512_add_epi32(p.v, from), drop)};
}

// Moved by whole periods so that the least position of the lanes lies on the level itself, where blocks do not repeat.
[[gnu::noinline]] texels16 moved(const planar_map& map, texels16 p, int level, __mmask16 lanes) {
  const auto axis = [&](v16 x, int32_t repeat, int32_t period) {
    if (period == 0 || repeat > 0) return x;
    const int32_t least = _mm512_mask_reduce_min_epi32(lanes, x) >> q.subtexel_bits, past = least % period;
    return _mm512_sub_epi32(x, set32((least - (past < 0 ? past + period : past)) * (1 << q.subtexel_bits)));
  };
  const planar_levels& m = map.levels();
  return {axis(p.u, m.columns[level], m.period_u[level]), axis(p.v, m.rows[level], m.period_v[level])};
}

// u in the lower half of each lane, v in the upper.
SPANTEX_INLINE v16 halves(texels16 p) { return _mm512_ternarylogic_epi32(p.u, _mm512_slli_epi32(p.v, 16), upper(), 0xD8); }

// The 2x2 blocks from (x, y) on; false where the map has none of them.
SPANTEX_INLINE bool blocks_at(const planar_map& map, int level, int32_t x, int32_t y, quad_section& out) {
  const planar_levels& m = map.levels();
  const auto axis = [&](int32_t k, int32_t period, int32_t repeat, int32_t last, int32_t bytes, int64_t& even, int64_t& odd) {
    int32_t first = k + (k & 1), second = k | 1;
    if (repeat > 0) {
      const bool power = (repeat & (repeat - 1)) == 0;
      const auto within = [&](int32_t b) { return power ? b & (repeat - 1) : (b % repeat + repeat) % repeat; };
      first = within(first);
      second = within(second);
    } else if (period != 0 && (k < -apron || k + 1 > last)) {
      return false;
    }
    even = int64_t(clamp_to(first, -apron, last)) * bytes;
    odd = int64_t(clamp_to(second, -apron, last)) * bytes;
    return true;
  };
  int64_t left, right, top, bottom;
  if (!axis(x, map.period_u(), m.columns[level], m.last_column[level], m.column_bytes[level], left, right)) return false;
  if (!axis(y, map.period_v(), m.rows[level], m.last_row[level], m.row_bytes[level], top, bottom)) return false;
  const int64_t origin = m.origin[level];
  out = {map.blocks(), {origin + left + top, origin + left + bottom}, {origin + right + top, origin + right + bottom}, 0};
  return true;
}

// What is fetched for sixteen pixels on one level: addresses and weights, and the blocks of the first texel and of the last.
template <int Up>
struct fetches16 {
  samples s;
  v16 begin, end;
  SPANTEX_INLINE explicit fetches16(texels16 p) : s(samples16<Up>(halves(p))) {
    const v16 texel = set32(1 << q.subtexel_bits);
    const auto block = [&](v16 x) { return _mm512_srai_epi32(x, q.subtexel_bits + 3); };
    begin = halves({block(p.u), block(p.v)});
    end = halves({block(_mm512_add_epi32(p.u, texel)), block(_mm512_add_epi32(p.v, texel))});
  }
};

// The least block of each axis.
SPANTEX_INLINE int32_t least_of(v16 begin, __mmask16 lanes) {
  const v16 some = _mm512_mask_mov_epi32(set32(0x7FFF7FFF), lanes, begin);
  const __m256i four = _mm256_min_epi16(_mm512_castsi512_si256(some), _mm512_extracti64x4_epi64(some, 1));
  __m128i two = _mm_min_epi16(_mm256_castsi256_si128(four), _mm256_extracti128_si256(four, 1));
  two = _mm_min_epi16(two, _mm_shuffle_epi32(two, 0x4E));
  two = _mm_min_epi16(two, _mm_shuffle_epi32(two, 0xB1));
  return _mm_cvtsi128_si32(two);
}

// Positions anywhere on any levels: all pixels at once if their texels lie in 2x2 blocks of one level, otherwise those that lie together, until none
// is left. False where the map has no blocks.
template <int Up, int Channels>
SPANTEX_INLINE bool blend_anywhere(const planar_map& map, texels16 p, v16 level, __mmask16 lanes, int32_t rounding, v16 (&out)[Channels]) {
  const auto first_of = [&](__mmask16 some, v16 x) { return _mm_cvtsi128_si32(_mm512_castsi512_si128(_mm512_maskz_compress_epi32(some, x))); };
  const auto corner = [&](int32_t xy) { return _mm512_add_epi16(set32(xy), set32(0x00010001)); };
  fetches16<Up> f(p);
  for (__mmask16 rest = lanes; rest != 0;) {
    const int32_t whole = first_of(rest, level);
    __mmask16 these = __mmask16(rest & _mm512_cmpeq_epi32_mask(level, set32(whole)));
    if (!map.steady()) [[unlikely]] f = fetches16<Up>(moved(map, p, whole, these));
    int32_t xy = least_of(f.begin, these);
    if (_mm512_cmpgt_epi16_mask(_mm512_maskz_mov_epi32(these, f.end), _mm512_maskz_mov_epi32(these, corner(xy))) != 0) {
      if (!map.steady()) f = fetches16<Up>(moved(map, p, whole, __mmask16(these & -these)));
      xy = first_of(these, f.begin);
      const __mmask32 near = _mm512_cmpge_epi16_mask(f.begin, set32(xy)) & _mm512_cmple_epi16_mask(f.end, corner(xy));
      these &= _mm512_cmpeq_epi32_mask(_mm512_movm_epi16(near), set32(-1));
    }
    quad_section at;
    if (!blocks_at(map, whole, int16_t(xy), xy >> 16, at)) return false;
    if (these == lanes) [[likely]] {
#pragma GCC unroll 4
      for (int k = 0; k < Channels; ++k) out[k] = blended16<true, Up>(at, k, f.s, rounding);
      return true;
    }
    const __mmask16 others = rest == lanes ? 0 : __mmask16(~these);
    for (int k = 0; k < Channels; ++k) out[k] = _mm512_mask_mov_epi32(blended16<true, Up>(at, k, f.s, rounding), others, out[k]);
    rest = __mmask16(rest & ~these);
  }
  return true;
}

SPANTEX_INLINE v16 modulo16(v16 k, int32_t period) {
  if ((period & (period - 1)) == 0) return _mm512_and_si512(k, set32(period - 1));
  for (__mmask16 m; (m = _mm512_movepi32_mask(k)) != 0;) k = _mm512_mask_add_epi32(k, m, k, set32(period));
  for (__mmask16 m; (m = _mm512_cmpge_epi32_mask(k, set32(period))) != 0;) k = _mm512_mask_sub_epi32(k, m, k, set32(period));
  return k;
}

// A column or row of the map's rows.
SPANTEX_INLINE v16 wrapped16(v16 k, int32_t side, wrap mode) {
  return mode == wrap::clamp ? _mm512_max_epi32(_mm512_min_epi32(k, set32(side - 1)), _mm512_setzero_si512()) : modulo16(k, mode == wrap::mirror ? 2 * side : side);
}

// Texels of level 0 where they are, for quads whose section is larger than registers: two neighbours a gather.
[[gnu::noinline]] v16 bilinear_gathered(const planar_map& map, positions p) {
  const int cut = p.bits - q.subtexel_bits;  // whole positions: (offset + rounding) / 2^cut, 7 bits of fraction
  const v16 start = set32(int32_t(p.half + (1u << (cut - 1)))), half_texel = set32(1 << (q.subtexel_bits - 1)), weight_bits = set32(0x7F);
  const auto snapped = [&](v16 offset) { return _mm512_sub_epi32(_mm512_sra_epi32(_mm512_add_epi32(offset, start), _mm_cvtsi32_si128(cut)), half_texel); };
  const auto texel = [&](v16 position, int32_t base, int32_t side, wrap mode) {
    const v16 k = _mm512_add_epi32(_mm512_srai_epi32(position, q.subtexel_bits), set32(base));
    return mode == wrap::clamp ? _mm512_max_epi32(_mm512_min_epi32(k, set32(side - 1)), set32(-1)) : modulo16(k, mode == wrap::mirror ? 2 * side : side);
  };
  const v16 u = snapped(p.u), v = snapped(p.v), x = texel(u, p.base_u, map.width(), map.wrap_u()), y = texel(v, p.base_v, map.height(), map.wrap_v());
  const v16 at = _mm512_add_epi32(_mm512_mullo_epi32(y, set32(map.row_stride())), x), fu = _mm512_and_si512(u, weight_bits), fv = _mm512_and_si512(v, weight_bits);
  const v16 pairs = _mm512_broadcast_i32x4(_mm_setr_epi8(0, 4, 1, 5, 2, 6, 3, 7, 8, 12, 9, 13, 10, 14, 11, 15)), sign = set32(int32_t(0x80808080));
  const v16 u_of_pixels = _mm512_or_si512(_mm512_slli_epi32(fu, 8), _mm512_sub_epi32(set32(128), fu));                    // words: 128 - f, f
  const v16 v_of_pixels = _mm512_or_si512(_mm512_slli_epi32(fv, 18), _mm512_sub_epi32(set32(512), _mm512_slli_epi32(fv, 2)));  // 512 - 4 f, 4 f
  const auto row = [&](int y1, __m256i index, v16 weights) {  // of eight pixels: four words each
    const v8 two = _mm512_i32gather_epi64(index, reinterpret_cast<const long long*>(map.row(y1)), 4);
    return _mm512_maddubs_epi16(weights, _mm512_xor_si512(_mm512_shuffle_epi8(two, pairs), sign));
  };
  const v16 low_word = _mm512_setr_epi32(0x00000000, 0x00000000, 0x00020002, 0x00020002, 0x00040004, 0x00040004, 0x00060006, 0x00060006, 0x00080008, 0x00080008,
                                         0x000A000A, 0x000A000A, 0x000C000C, 0x000C000C, 0x000E000E, 0x000E000E);
  v16 half[2];
#pragma GCC unroll 2
  for (int n = 0; n < 2; ++n) {
    const __m256i index = n == 0 ? _mm512_castsi512_si256(at) : _mm512_extracti64x4_epi64(at, 1);
    const v16 weights = _mm512_permutexvar_epi16(_mm512_add_epi16(low_word, _mm512_set1_epi16(int16_t(16 * n))), u_of_pixels);
    const v16 top = row(0, index, weights), bottom = row(1, index, weights);
    const v16 first = _mm512_setr_epi32(0, 0, 0, 0, 2, 2, 2, 2, 4, 4, 4, 4, 6, 6, 6, 6), one = set32(1), from = set32(8 * n);  // unpacking takes every other pixel
    const auto blended = [&](v16 words, v16 pixel) {
      const v16 x1 = _mm512_dpwssd_epi32(set32((128 << 16) + before_even), words, _mm512_permutexvar_epi32(_mm512_add_epi32(pixel, from), v_of_pixels));
      return _mm512_srli_epi32(even16(x1), 16);
    };
    half[n] = _mm512_packus_epi32(blended(_mm512_unpacklo_epi16(top, bottom), first), blended(_mm512_unpackhi_epi16(top, bottom), _mm512_add_epi32(first, one)));
  }
  const v16 bytes = _mm512_packus_epi16(half[0], half[1]);  // of each 128 bits: pixels 2 n and 2 n + 1, then 8 more
  return _mm512_permutexvar_epi32(_mm512_setr_epi32(0, 1, 4, 5, 8, 9, 12, 13, 2, 3, 6, 7, 10, 11, 14, 15), bytes);
}

// The quad's pixels on any levels. False where the map has no blocks.
template <bool TwoLevels>
[[gnu::noinline]] bool by_level_anywhere(const planar_map& map, positions p, int32_t last_level, v16 whole, v16 fraction, v16& out) {
  constexpr int up = TwoLevels ? up_between : up_of_one;
  constexpr int32_t rounding = TwoLevels ? 1 << 7 : before_even;
  const texels16 at = texels_of(p);
  v16 fine[channel_count], coarse[channel_count];
  if (!blend_anywhere<up>(map, on_levels(map, at, whole), whole, 0xFFFF, rounding, fine)) return false;
  if constexpr (TwoLevels) {
    const v16 next = _mm512_min_epi32(_mm512_add_epi32(whole, set32(1)), set32(last_level));
    if (!blend_anywhere<up>(map, on_levels(map, at, next), next, 0xFFFF, rounding, coarse)) return false;
  }
  for (int k = 0; k < channel_count; ++k) fine[k] = TwoLevels ? between_levels16(fine[k], coarse[k], level_weights16(fraction)) : even16(fine[k]);
  out = packed16(fine);
  return true;
}

// --- spans ---------------------------------------------------------------------------------------------

template <int Channels>
SPANTEX_INLINE bool draw_bilinear(const row_work& work, const batch& b, int k) {
  const planar_map& map = *work.texels;
  offsets o = offsets_of(b, k);
  v16 out[quads];
  if (b.placed & ~b.wide & (1u << k)) {
    const uint8_t* const origin = map.blocks() + map.levels().origin[0];
    shorten(0, o);
#pragma GCC unroll 4
    for (int n = 0; n < quads; ++n) out[n] = bilinear16<Channels, false>(section_of(b, origin, k, n), samples16<up_of_one>(snapped16(positions_of(b, k, o, n), 0)));
  } else {
    span_sections sections;
    find_sections<true>(map, reach_of(o, b.base_u[k], b.base_v[k]), _mm512_setzero_si512(), sections);
    shorten(0, o);
    for (int n = 0; n < quads; ++n) {
      const positions p = positions_of(b, k, o, n);
      out[n] = sections.fit >> n & 1 ? bilinear16<Channels, true>(section_of<true>(map, sections, n), samples16<up_of_one>(snapped16(p, 0))) : bilinear_gathered(map, p);
    }
  }
  write(work, b.sx + k, work.masks[b.first + k], out);
  return true;
}

// 8x8 texels in four registers.
SPANTEX_INLINE v16 texel_of_rows(const rgba8* at, int32_t stride, v16 index) {
  const auto half = [&](int y) { return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(at + int64_t(y) * stride)); };
  const auto two = [&](int y) { return _mm512_inserti64x4(_mm512_castsi256_si512(half(y)), half(y + 1), 1); };
  const v16 upper_rows = _mm512_permutex2var_epi32(two(0), index, two(2)), lower_rows = _mm512_permutex2var_epi32(two(4), index, two(6));
  return _mm512_mask_mov_epi32(upper_rows, _mm512_test_epi32_mask(index, set32(32)), lower_rows);
}

SPANTEX_INLINE bool draw_nearest(const row_work& work, const batch& b, int k) {
  const planar_map& map = *work.texels;
  const offsets o = offsets_of(b, k);
  const v16 half = set32(int32_t(o.half)), bits = set32(o.bits);
  v16 out[quads];
  if (b.placed >> k & 1) {
#pragma GCC unroll 4
    for (int n = 0; n < quads; ++n) {
      const v16 u = _mm512_add_epi32(_mm512_srav_epi32(_mm512_add_epi32(o.u[n], half), bits), set32(b.from[n][0][k]));
      const v16 v = _mm512_add_epi32(_mm512_srav_epi32(_mm512_add_epi32(o.v[n], half), bits), set32(b.from[n][1][k]));
      out[n] = texel_of_rows(map.row(0) + b.row_at[n][k], map.row_stride(), _mm512_add_epi32(_mm512_slli_epi32(v, 3), u));
    }
  } else {
    const v16 base_u = set32(b.base_u[k]), base_v = set32(b.base_v[k]), stride = set32(map.row_stride());
    for (int n = 0; n < quads; ++n) {
      const v16 u = _mm512_add_epi32(_mm512_srav_epi32(_mm512_add_epi32(o.u[n], half), bits), base_u);
      const v16 v = _mm512_add_epi32(_mm512_srav_epi32(_mm512_add_epi32(o.v[n], half), bits), base_v);
      const v16 x = wrapped16(u, map.width(), map.wrap_u()), y = wrapped16(v, map.height(), map.wrap_v());
      out[n] = _mm512_i32gather_epi32(_mm512_add_epi32(_mm512_mullo_epi32(y, stride), x), map.row(0), 4);
    }
  }
  write(work, b.sx + k, work.masks[b.first + k], out);
  return true;
}

// Whole levels of the quads' first pixels, four times over.
SPANTEX_INLINE v16 of_quads(const v16 (&whole)[quads]) {
  const v16 first = _mm512_setr_epi32(0, 16, 0, 16, 0, 16, 0, 16, 0, 16, 0, 16, 0, 16, 0, 16);
  return _mm512_unpacklo_epi64(_mm512_permutex2var_epi32(whole[0], first, whole[1]), _mm512_permutex2var_epi32(whole[2], first, whole[3]));
}

// Whether a span's fine sections are as narrow as the coarse ones is much the same from one span to the next.
template <bool TwoLevels, int Channels, bool Wide>
SPANTEX_INLINE bool blend_quads(const row_work& work, const batch& b, int k, const offsets& o, const v16 (&level)[quads], const v16 (&whole)[quads], v16 fine_level, v16 coarse_level,
                                uint32_t fit, const span_sections& fine, const span_sections& coarse, v16 (&out)[quads]) {
  const planar_map& map = *work.texels;
  const snapping positions_at(o, b.base_u[k], b.base_v[k], _mm256_set_m128i(_mm512_castsi512_si128(coarse_level), _mm512_castsi512_si128(fine_level)));
  alignas(16) int32_t fine_of[quads];
  _mm_store_si128(reinterpret_cast<__m128i*>(fine_of), _mm512_castsi512_si128(fine_level));
  const span_mask mask = work.masks[b.first + k];
#pragma GCC unroll 1
  for (int n = 0; n < quads; ++n) {
    if ((mask & pixels_of(grouping::square, n)) == 0) continue;
    const v16 fraction = _mm512_and_si512(level[n], set32(255));
    if (!(fit >> n & 1) || _mm512_cmpneq_epi32_mask(whole[n], set32(fine_of[n])) != 0) [[unlikely]] {
      if (!by_level_anywhere<TwoLevels>(map, positions_of(b, k, o, n), work.last_level, whole[n], fraction, out[n])) return false;
      continue;
    }
    const quad_section near = section_of<Wide>(map, fine, n);
    v16 c[Channels];
    if (TwoLevels && _mm512_testn_epi32_mask(fraction, fraction) == 0xFFFF) {
      const samples s = samples16<up_between>(positions_at.at(o.u[n], o.v[n], n));
#pragma GCC unroll 4
      for (int m = 0; m < Channels; ++m) c[m] = on_one_level16(blended16<Wide, up_between>(near, m, s, 1 << 7));
    } else if constexpr (TwoLevels) {
      const quad_section far = section_of<false>(map, coarse, n);
      const samples s = samples16<up_between>(positions_at.at(o.u[n], o.v[n], n)), t = samples16<up_between>(positions_at.at(o.u[n], o.v[n], n + quads));
      const v16 weights = level_weights16(fraction);
#pragma GCC unroll 4
      for (int m = 0; m < Channels; ++m)
        c[m] = between_levels16(blended16<Wide, up_between>(near, m, s, 1 << 7), blended16<false, up_between>(far, m, t, 1 << 7), weights);
    } else {
      const samples s = samples16<up_of_one>(positions_at.at(o.u[n], o.v[n], n));
#pragma GCC unroll 4
      for (int m = 0; m < Channels; ++m) c[m] = even16(blended16<Wide, up_of_one>(near, m, s, before_even));
    }
    out[n] = packed16(c);
  }
  return true;
}

// The pixels of quads, levels given.
template <bool TwoLevels, int Channels>
SPANTEX_INLINE bool draw_at_levels(const row_work& work, const batch& b, int k, offsets& o, const v16 (&level)[quads]) {
  const planar_map& map = *work.texels;
  v16 whole[quads], out[quads] = {};
#pragma GCC unroll 4
  for (int n = 0; n < quads; ++n)
    whole[n] = TwoLevels ? _mm512_srai_epi32(level[n], 8)
                         : _mm512_max_epi32(_mm512_sub_epi32(_mm512_srai_epi32(_mm512_add_epi32(level[n], set32(128 + 255)), 8), set32(1)), _mm512_setzero_si512());
  const v16 fine_level = of_quads(whole), reach = reach_of(o, b.base_u[k], b.base_v[k]), last = set32(work.last_level);
  const v16 coarse_level = TwoLevels ? _mm512_min_epi32(_mm512_add_epi32(fine_level, set32(1)), last) : fine_level;
  shorten(work.last_level, o);
  span_sections fine, coarse;
  if (!map.exact()) [[unlikely]] {
#pragma GCC unroll 1
    for (int n = 0; n < quads; ++n) {
      if ((work.masks[b.first + k] & pixels_of(grouping::square, n)) == 0) continue;
      if (!by_level_anywhere<TwoLevels>(map, positions_of(b, k, o, n), work.last_level, whole[n], _mm512_and_si512(level[n], set32(255)), out[n])) return false;
    }
    write(work, b.sx + k, work.masks[b.first + k], out);
    return true;
  }
  find_sections<false>(map, reach, fine_level, fine);
  const bool wide = fine.fit != 0xF;
  if (wide) find_sections<true>(map, reach, fine_level, fine);
  uint32_t fit = fine.fit;
  if constexpr (TwoLevels) {
    find_sections<false>(map, reach, coarse_level, coarse);
    fit &= coarse.fit;
  }
  const bool drawn = wide ? blend_quads<TwoLevels, Channels, true>(work, b, k, o, level, whole, fine_level, coarse_level, fit, fine, coarse, out)
                          : blend_quads<TwoLevels, Channels, false>(work, b, k, o, level, whole, fine_level, coarse_level, fit, fine, coarse, out);
  if (drawn) write(work, b.sx + k, work.masks[b.first + k], out);
  return drawn;
}

template <bool TwoLevels, int Channels>
SPANTEX_INLINE bool draw_by_level(const row_work& work, const batch& b, int k) {
  offsets o = offsets_of(b, k);
  v16 level[quads];
  levels_of(work, b, k, o, level);
  return draw_at_levels<TwoLevels, Channels>(work, b, k, o, level);
}
