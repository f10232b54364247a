// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: a span by each filter. Included by ../avx512.cpp alone.
#pragma once

// --- what registers do not hold ------------------------------------------------------------------------

// Positions of sixteen pixels, s15.16 of level 0.
struct texels16 { v16 u, v; };
SPANTEX_INLINE texels16 texels_of(const positions& p) {
  const auto at = [&](v16 offset, int32_t base) {
    const v16 fraction = _mm512_srav_epi32(_mm512_add_epi32(offset, set32(int32_t(p.half))), set32(p.bits - q.coordinate_bits));
    return _mm512_add_epi32(_mm512_slli_epi32(fraction, 16 - q.coordinate_bits), set32(base << 16));
  };
  return {at(p.u, p.base_u), at(p.v, p.base_v)};
}

// On each lane's level, less half a texel, 7 bits of fraction.
SPANTEX_INLINE texels16 on_levels(texels16 p, v16 level) {
  const v16 half = _mm512_sllv_epi32(of32<1 << 8>(), level), from = _mm512_sub_epi32(half, _mm512_slli_epi32(half, q.subtexel_bits)), drop = _mm512_add_epi32(level, of32<9>());
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
SPANTEX_INLINE bool blocks_at(const planar_map& map, int level, int32_t x, int32_t y, int64_t (&out)[4]) {
  const planar_levels& m = map.levels();
  const auto axis = [&](int32_t k, int32_t period, int32_t repeat, int32_t last, auto&& bytes, int64_t& even, int64_t& odd) {
    int32_t first = k + (k & 1), second = k | 1;
    if (repeat > 0) {
      const bool power = (repeat & (repeat - 1)) == 0;
      const auto within = [&](int32_t b) { return power ? b & (repeat - 1) : (b % repeat + repeat) % repeat; };
      first = within(first);
      second = within(second);
    } else if (period != 0 && (k < -apron || k + 1 > last)) {
      return false;
    }
    even = bytes(clamp_to(first, -apron, last));
    odd = bytes(clamp_to(second, -apron, last));
    return true;
  };
  int64_t left, right, top, bottom;
  if (!axis(x, map.period_u(), m.columns[level], m.last_column[level], [&](int32_t c) { return int64_t(c) * m.column_bytes[level]; }, left, right)) return false;
  if (!axis(y, map.period_v(), m.rows[level], m.last_row[level], [&](int32_t r) { return int64_t(r >> stack_log2) * m.row_bytes[level] + (r & (stack_blocks - 1)) * block_bytes; }, top, bottom)) return false;
  const int64_t origin = m.origin[level];
  out[0] = origin + left + top;
  out[1] = origin + left + bottom;
  out[2] = origin + right + top;
  out[3] = origin + right + bottom;
  return true;
}

// What is fetched for sixteen pixels on one level: addresses and weights, and the blocks of the first texel and of the last.
template <int Up>
struct fetches16 {
  samples s;
  v16 begin, end;
  SPANTEX_INLINE explicit fetches16(texels16 p) : s(samples16<Up>(halves(p))) {
    const v16 texel = of32<1 << q.subtexel_bits>();
    const auto block = [&](v16 x) { return _mm512_srai_epi32(x, q.subtexel_bits + 3); };
    begin = halves({block(p.u), block(p.v)});
    end = halves({block(_mm512_add_epi32(p.u, texel)), block(_mm512_add_epi32(p.v, texel))});
  }
};

// The least block of each axis.
SPANTEX_INLINE int32_t least_of(v16 begin, __mmask16 lanes) {
  const v16 some = _mm512_mask_mov_epi32(of32<0x7FFF7FFF>(), lanes, begin);
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
  const auto corner = [&](int32_t xy) { return _mm512_add_epi16(set32(xy), of32<0x00010001>()); };
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
      these &= _mm512_cmpeq_epi32_mask(_mm512_movm_epi16(near), of32<-1>());
    }
    int64_t places[4];
    if (!blocks_at(map, whole, int16_t(xy), xy >> 16, places)) return false;
    quad_section at(map.blocks(), places[0], places[1], places[2], places[3], 0);
    if (these == lanes) [[likely]] {
#pragma GCC unroll 4
      for (int k = 0; k < Channels; ++k) out[k] = blended16<held_in::wide, Up>(at, k, f.s, rounding);
      return true;
    }
    const __mmask16 others = rest == lanes ? 0 : __mmask16(~these);
    for (int k = 0; k < Channels; ++k) out[k] = _mm512_mask_mov_epi32(blended16<held_in::wide, Up>(at, k, f.s, rounding), others, out[k]);
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

// The quad's pixels on any levels. False where the map has no blocks.
template <bool TwoLevels>
[[gnu::noinline]] bool by_level_anywhere(const planar_map& map, positions p, int32_t last_level, v16 whole, v16 fraction, v16& out) {
  constexpr int up = TwoLevels ? up_between : up_of_one;
  constexpr int32_t rounding = TwoLevels ? 1 << 7 : before_even;
  texels16 at = texels_of(p);
  v16 fine[channel_count], coarse[channel_count];
  if (!blend_anywhere<up>(map, on_levels(at, whole), whole, 0xFFFF, rounding, fine)) return false;
  if constexpr (TwoLevels) {
    const v16 next = _mm512_min_epi32(_mm512_add_epi32(whole, of32<1>()), set32(last_level));
    if (!blend_anywhere<up>(map, on_levels(at, next), next, 0xFFFF, rounding, coarse)) return false;
  }
  const colouring as;
  for (int k = 0; k < channel_count; ++k) fine[k] = TwoLevels ? as.between_levels(fine[k], coarse[k], as.level_weights(fraction), as.half) : as.even(fine[k]);
  out = as.packed(fine);
  return true;
}

// --- spans ---------------------------------------------------------------------------------------------

template <int Channels>
SPANTEX_INLINE bool draw_bilinear(const row_work& work, const batch& b, int k) {
  const planar_map& map = *work.texels;
  offsets o = offsets_of(b, k);
  sampling<up_of_one> from;
  colouring as;
  v16 out[quads];
  const auto drawn = [&]<held_in Where>() SPANTEX_INLINED {
    shorten(0, o.u, o.v, o.bits, o.half);
#pragma GCC unroll 4
    for (int n = 0; n < quads; ++n) {
      positions at = positions_of(b, k, o, n);
      if constexpr (Where == held_in::shallow) at.base_v -= b.sections.row[n][k];
      out[n] = bilinear16<Channels, Where>(as, section_of<Where>(map.blocks(), b.sections, k, n), samples16(from, snapped16(at, 0)));
    }
  };
  if (b.placed & b.shallow & (1u << k)) {
    drawn.template operator()<held_in::shallow>();
  } else if (b.placed & ~b.wide & (1u << k)) {
    drawn.template operator()<held_in::narrow>();
  } else if (b.placed >> k & 1) {
    drawn.template operator()<held_in::wide>();
  } else {
    span_sections sections;
    const v16 level = _mm512_setzero_si512();
    find_sections<true>(section_ends(map, end_texels(reach_of(o.u, o.v, o.bits, b.base_u[k], b.base_v[k]), level), level), sections);
    if (sections.fit != 0xF) return false;
    shorten(0, o.u, o.v, o.bits, o.half);
#pragma GCC unroll 4
    for (int n = 0; n < quads; ++n)
      out[n] = bilinear16<Channels, held_in::wide>(as, section_of<held_in::wide>(map.blocks(), sections, n), samples16(from, snapped16(positions_of(b, k, o, n), 0)));
  }
  write(work, b.sx + k, work.masks[b.first + k], out);
  return true;
}

// 8x8 texels in four registers.
SPANTEX_INLINE v16 texel_of_rows(const rgba8* at, int32_t stride, v16 index) {
  const auto half = [&](int y) { return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(at + int64_t(y) * stride)); };
  const auto two = [&](int y) { return _mm512_inserti64x4(_mm512_castsi256_si512(half(y)), half(y + 1), 1); };
  const v16 upper_rows = _mm512_permutex2var_epi32(two(0), index, two(2)), lower_rows = _mm512_permutex2var_epi32(two(4), index, two(6));
  return _mm512_mask_mov_epi32(upper_rows, _mm512_test_epi32_mask(index, of32<32>()), lower_rows);
}

SPANTEX_INLINE bool draw_nearest(const row_work& work, const batch& b, int k) {
  const planar_map& map = *work.texels;
  offsets o = offsets_of(b, k);
  v16 out[quads];
  if (b.placed >> k & 1) {
    const v16 column_bits = set32(b.column_bits[k]), row_bits = set32(b.row_bits[k]), across = of32<block_side - 1>();
    if (o.bits != b.column_bits[k]) [[unlikely]] drop_bits(o.bits - b.column_bits[k], o.u, o.v);
#pragma GCC unroll 4
    for (int n = 0; n < quads; ++n) {
      const v16 u = _mm512_srlv_epi32(_mm512_add_epi32(o.u[n], set32(b.from[n][0][k])), column_bits), v = _mm512_srlv_epi32(_mm512_add_epi32(o.v[n], set32(b.from[n][1][k])), row_bits);
      out[n] = texel_of_rows(map.row(0) + b.row_at[n][k], map.row_stride(), _mm512_ternarylogic_epi32(v, u, across, 0xD8));
    }
  } else {
    const v16 half = set32(int32_t(o.half)), bits = set32(o.bits);
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
