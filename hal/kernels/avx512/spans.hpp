// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: a span by each filter. Included by by_blocks.hpp alone.
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

// --- spans ---------------------------------------------------------------------------------------------

// As many of the offsets' bits as what their span was placed by counts on.
SPANTEX_INLINE void keep_bits(const batch& b, int k, offsets& o) {
  if (o.bits != b.column_bits[k]) [[unlikely]] drop_bits(o.bits - b.column_bits[k], o.u, o.v);
}

template <texel_kind Texels>
SPANTEX_INLINE bool draw_bilinear(const row_work& work, const batch& b, int k) {
  const planar_map& map = *work.texels;
  offsets o = offsets_of<quad_form>(b, k);
  sampling<up_of_one> from;
  std::conditional_t<Texels.in_light(), light::constants<light::rounds::one>, colouring> as;
  v16 out[quads];
  [[maybe_unused]] v16 number[quads][Texels.channels];
  // Quad n's section, and what leads to positions in it, u and v.
  const auto drawn = [&]<held_in Where>(int bits, auto&& section, auto&& from_u, auto&& from_v) SPANTEX_INLINED {
    const offset_fields& at = fields_of_offsets.with_bits[bits];
#pragma GCC unroll 4
    for (int n = 0; n < quads; ++n) {
      const v16 u = _mm512_add_epi32(o.u[n], set32(from_u(n))), v = _mm512_add_epi32(o.v[n], set32(from_v(n)));
      const samples s = samples_of_offsets<Where>(from, at, u, v);
      if constexpr (Texels.in_light()) {
        light::blended(as, section(n), s, number[n]);
#pragma GCC unroll 4
        for (v16& each : number[n]) each = as.even(each);
      } else {
        out[n] = bilinear16<Texels.channels>(as, section(n), s);
      }
    }
    if constexpr (Texels.in_light()) light::coded(number, out);
  };
  if (b.placed >> k & 1) {
    keep_bits(b, k, o);
    const auto by_width = [&]<held_in Where>() SPANTEX_INLINED {
      drawn.template operator()<Where>(b.column_bits[k], [&](int n) SPANTEX_INLINED { return section_of<Where>(map.blocks(), b.sections, k, n); },
            [&](int n) SPANTEX_INLINED { return b.from[n][0][k]; }, [&](int n) SPANTEX_INLINED { return b.from[n][1][k]; });
    };
    const bool deep = b.deep >> k & 1, broad = b.broad >> k & 1;
    if (deep) broad ? by_width.template operator()<held_in::full>() : by_width.template operator()<held_in::narrow>();
    else broad ? by_width.template operator()<held_in::broad>() : by_width.template operator()<held_in::shallow>();
  } else {
    span_sections sections;
    const v16 level = _mm512_setzero_si512();
    find_sections<false>(map, end_texels(reach_of(o.u, o.v, o.bits, b.base_u[k], b.base_v[k], cut::square), level), level, sections);
    if (sections.fit != 0xF) return false;
    shorten(0, o.u, o.v, o.bits, o.half);
    snapping at;
    at.take_two(o.bits, o.half, b.base_u[k], b.base_v[k], _mm512_castsi512_si256(level));
    at.begin_at(_mm_srai_epi32(four(sections.shift), 3), four(sections.row), 0);
    drawn.template operator()<held_in::narrow>(o.bits, [&](int n) SPANTEX_INLINED { return section_of<held_in::narrow>(map.blocks(), sections, n); },
          [&](int n) SPANTEX_INLINED { return at.from_u[n]; }, [&](int n) SPANTEX_INLINED { return at.from_v[n]; });
  }
  write(work, b.sx + k, work.masks[b.first + k], out);
  return true;
}

// Texels in rows of eight, two rows a register.
template <int Rows>
struct texel_rows {
  v16 two[(Rows + 1) / 2];
  SPANTEX_INLINE texel_rows(const rgba8* at, int32_t stride) {
    const auto half = [&](int y) { return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(at + int64_t(y) * stride)); };
#pragma GCC unroll 4
    for (int y = 0; y < Rows; y += 2) {
      two[y / 2] = _mm512_castsi256_si512(half(y));
      if (y + 1 < Rows) two[y / 2] = _mm512_inserti64x4(two[y / 2], half(y + 1), 1);
    }
  }
  SPANTEX_INLINE v16 at(v16 index) const {
    const v16 upper_rows = _mm512_permutex2var_epi32(two[0], index, two[1]);
    if constexpr (Rows == 4) return upper_rows;
    else if constexpr (Rows <= 6) return _mm512_mask_permutexvar_epi32(upper_rows, _mm512_test_epi32_mask(index, of32<32>()), index, two[2]);
    else return _mm512_mask_mov_epi32(upper_rows, _mm512_test_epi32_mask(index, of32<32>()), _mm512_permutex2var_epi32(two[2], index, two[3]));
  }
};

// Where in 8x8 texels those of a quad's pixels lie: offsets from the first, and their bits of fraction; of v less three, so that a row is 8 texels.
SPANTEX_INLINE v16 place_in_rows(v16 u, v16 v, v16 column_bits, v16 row_bits) {
  return _mm512_ternarylogic_epi32(_mm512_srlv_epi32(v, row_bits), _mm512_srlv_epi32(u, column_bits), of32<block_side - 1>(), 0xD8);
}

// A span whose texels lie anywhere; quad(n): where the n-th quad's do. Whole spans are moved texel by texel, and not through registers, but where gathers are fast.
template <bool Gathers, cut How>
SPANTEX_INLINE void draw_beyond(const row_work& work, int32_t sx, span_mask mask, auto&& quad) {
  const planar_map& map = *work.texels;
  constexpr int quad_pixels = span_pixel_count / quads;
  alignas(64) int32_t at[span_pixel_count];
#pragma GCC unroll 4
  for (int n = 0; n < quads; ++n) {
    const positions p = quad(n);
    const v16 half = set32(int32_t(p.half)), bits = set32(p.bits);
    const auto texel = [&](v16 offset, int32_t base) SPANTEX_INLINED { return _mm512_add_epi32(_mm512_srav_epi32(_mm512_add_epi32(offset, half), bits), set32(base)); };
    const v16 x = wrapped16(texel(p.u, p.base_u), map.width(), map.wrap_u()), y = wrapped16(texel(p.v, p.base_v), map.height(), map.wrap_v());
    _mm512_store_si512(at + quad_pixels * n, _mm512_add_epi32(_mm512_mullo_epi32(y, set32(map.row_stride())), x));
  }
  const rgba8* const from = map.row(0);
  if (!Gathers && mask == ~span_mask(0)) {
    return move_texels(work, sx, from, at, [](int x, int y) SPANTEX_INLINED {
      return How == cut::flat ? span_side * y + x : (y / quad_side * 2 + x / quad_side) * quad_pixels + y % quad_side * quad_side + x % quad_side;
    });
  }
  v16 out[quads];
#pragma GCC unroll 4
  for (int n = 0; n < quads; ++n) out[n] = texels_from<Gathers>(from, reinterpret_cast<const uint32_t*>(at + quad_pixels * n));
  write(work, sx, mask, out, How);
}

// soon: the first texel, in the map's rows, of eight rows that a span after this one takes; they are prefetched, but where quads have one section and rows are few.
template <bool Gathers>
SPANTEX_INLINE void draw_nearest(const row_work& work, const batch& b, int k, int32_t soon) {
  const planar_map& map = *work.texels;
  offsets o = offsets_of<whole_form>(b, k);
  if (!(b.placed >> k & 1)) [[unlikely]] return draw_beyond<Gathers, cut::square>(work, b.sx + k, work.masks[b.first + k], [&](int n) SPANTEX_INLINED { return positions_of(b, k, o, n); });
  v16 out[quads];
  const v16 column_bits = set32(b.column_bits[k]), row_bits = set32(b.row_bits[k]);
  keep_bits(b, k, o);
  const auto index = [&](int n, v16 from_u, v16 from_v) SPANTEX_INLINED { return place_in_rows(_mm512_add_epi32(o.u[n], from_u), _mm512_add_epi32(o.v[n], from_v), column_bits, row_bits); };
  const auto rows = [&]<int Rows>(int n) SPANTEX_INLINED { return texel_rows<Rows>(map.row(0) + b.row_at[n][k], map.row_stride()); };
  const auto from_one = [&]<int Rows>() SPANTEX_INLINED {
    const texel_rows<Rows> texels = rows.template operator()<Rows>(0);
    const v16 from_u = set32(b.from[0][0][k]), from_v = set32(b.from[0][1][k]);
#pragma GCC unroll 4
    for (int n = 0; n < quads; ++n) out[n] = texels.at(index(n, from_u, from_v));
  };
  if (b.together >> k & 1) [[unlikely]] {  // where it is likely, it is all along
    b.few_rows >> k & 1 ? from_one.template operator()<4>() : from_one.template operator()<8>();
  } else {
    const rgba8* const then = map.row(0) + soon;
#pragma GCC unroll 8
    for (int y = 0; y < block_side; ++y) _mm_prefetch(reinterpret_cast<const char*>(then + y * map.row_stride()), _MM_HINT_T0);
#pragma GCC unroll 4
    for (int n = 0; n < quads; ++n) out[n] = rows.template operator()<8>(n).at(index(n, set32(b.from[n][0][k]), set32(b.from[n][1][k])));
  }
  write(work, b.sx + k, work.masks[b.first + k], out);
}
