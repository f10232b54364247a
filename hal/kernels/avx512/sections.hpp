// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: the sections of local memory of a span's quads. Included by by_blocks.hpp alone.
#pragma once

// A quad's corner a 16 bytes, four quads: their positions lie between these, rounding apart.
SPANTEX_INLINE v16 corners_of(const v16 (&x)[quads], v16 corners) {
  return _mm512_unpacklo_epi64(_mm512_permutex2var_epi32(x[0], corners, x[1]), _mm512_permutex2var_epi32(x[2], corners, x[3]));
}

// In s15.16 of level 0: least u, least v, most u, most v of the four quads, widened by twice the tolerance.
SPANTEX_INLINE v16 reach_of(const v16 (&of_u)[quads], const v16 (&of_v)[quads], int bits, int32_t base_u, int32_t base_v, cut how) {
  const v16 corners = _mm512_load_si512(cut_of(how).corners), u = corners_of(of_u, corners), v = corners_of(of_v, corners), some = _mm512_shuffle_i32x4(u, v, 0x44), others = _mm512_shuffle_i32x4(u, v, 0xEE);
  const v16 least = _mm512_min_epi32(some, others), most = _mm512_max_epi32(some, others);
  const v16 a = _mm512_shuffle_i32x4(least, most, 0x88), b = _mm512_shuffle_i32x4(least, most, 0xDD), all = _mm512_mask_max_epi32(_mm512_min_epi32(a, b), 0xFF00, a, b);
  constexpr int32_t slack = 1 << (17 - q.tolerance_bits);
  const v16 base = _mm512_mask_mov_epi32(set32(int32_t(uint32_t(base_u) << 16)), 0xF0F0, set32(int32_t(uint32_t(base_v) << 16)));
  const v16 start = _mm512_add_epi32(base, _mm512_setr_epi32(-slack, -slack, -slack, -slack, -slack, -slack, -slack, -slack, slack, slack, slack, slack, slack, slack, slack, slack));
  const v16 to16 = bits >= 16 ? _mm512_sra_epi32(all, _mm_cvtsi32_si128(bits - 16)) : _mm512_sll_epi32(all, _mm_cvtsi32_si128(16 - bits));
  return _mm512_add_epi32(to16, start);
}

// How sections are held: from any texel on 8x8 texels, 8 columns of 16 rows, 16 columns of 8 rows, 16x16, 8 columns of 24 rows.
enum class held_in : uint8_t { shallow, narrow, broad, full, high };
constexpr bool is_broad(held_in where) { return where == held_in::broad || where == held_in::full; }

// One quad's registers. Columns of blocks from `at` on, each up to three times eight rows; rows of two blocks are shifted by so many bits (modulo 64) that they begin where the section
// does: two blocks are one register, three are two.
template <held_in Where>
struct quad_section {
  static constexpr int blocks = is_broad(Where) ? 3 : 2, eights = Where == held_in::high ? 3 : Where == held_in::narrow || Where == held_in::full ? 2 : 1;
  const uint8_t* at[blocks][eights];
  v8 shift;
};

// One quad's section, of a span's (at: the column of blocks, which eight rows) as find_sections() left it.
template <held_in Where>
SPANTEX_INLINE quad_section<Where> section_at(const uint8_t* blocks, const auto& at, int32_t shift) {
  using section = quad_section<Where>;
  section s{{}, set32(shift)};
#pragma GCC unroll 3
  for (int c = 0; c < section::blocks; ++c)
#pragma GCC unroll 3
    for (int r = 0; r < section::eights; ++r) {
      s.at[c][r] = blocks + at(c, r);
      if constexpr (!is_broad(Where)) asm("" : "+r"(s.at[c][r]));  // channels lie at constant distances from these
    }
  return s;
}
template <held_in Where>
SPANTEX_INLINE auto section_of(const uint8_t* blocks, const batch_sections& s, int k, int n) {
  return section_at<Where>(blocks, [&](int c, int r) SPANTEX_INLINED { return s.at[c][r][n][k]; }, s.shift[n][k]);
}

// The sections of a span's four quads on a level each, from planar_map::blocks().
struct alignas(64) span_sections {
  int32_t at[3][2][quads];
  int32_t row[quads], shift[quads];              // as batch_sections'
  uint32_t fit;                                  // bit n: quad n's section is in here
  bool deep, broad;                              // some are more than eight rows, more than eight columns
};
template <held_in Where>
SPANTEX_INLINE auto section_of(const uint8_t* blocks, const span_sections& s, int n) {
  return section_at<Where>(blocks, [&](int c, int r) SPANTEX_INLINED { return s.at[c][r][n]; }, s.shift[n]);
}

// Lanes are ordered as in reach_of(): those of u, of v, of the first ends.
constexpr __mmask16 of_u = 0x0F0F, of_v = 0xF0F0, firsts = 0x00FF;

SPANTEX_INLINE v16 one_at_last_ends() { return _mm512_setr_epi32(0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1); }

// The texels of the level that the ends need.
SPANTEX_INLINE v16 end_texels(v16 reach, v16 level) {
  const v16 half = _mm512_sllv_epi32(of32<1 << 15>(), level);
  return _mm512_add_epi32(_mm512_srav_epi32(_mm512_sub_epi32(reach, half), _mm512_add_epi32(level, of32<16>())), one_at_last_ends());
}

SPANTEX_INLINE uint32_t some_axis(uint32_t lanes) { return (lanes | lanes >> 4 | lanes >> 8 | lanes >> 12) & 0xF; }  // quads

// What the axes have on each lane's level: levels of the quads, four times over.
SPANTEX_INLINE v16 of_levels(v16 level, const int32_t (&u)[max_planar_levels], const int32_t (&v)[max_planar_levels]) {
  static_assert(max_planar_levels == 16);
  const v16 axis = _mm512_setr_epi32(0, 0, 0, 0, 16, 16, 16, 16, 0, 0, 0, 0, 16, 16, 16, 16);
  return _mm512_permutex2var_epi32(_mm512_load_si512(u), _mm512_or_si512(level, axis), _mm512_load_si512(v));
}

// Of the texels that the quads' ends need, on the quads' levels: up to 16 rows, up to 8 columns or, Broad, 16. The columns of blocks are counted, and the rows of texels.
template <bool Broad>
SPANTEX_INLINE void find_sections(const planar_map& map, v16 texel, v16 level, span_sections& s) {
  constexpr __mmask16 last_columns = 0x0F00, second_rows = 0xF000;
  const planar_levels& texels = map.levels();
  const v16 block = of_levels(level, texels.last_column, texels.last_row), last = _mm512_mask_slli_epi32(block, of_v, block, 3), unit = of_levels(level, texels.column_bytes, texels.row_bytes);
  const v16 origin = _mm512_permutexvar_epi32(level, _mm512_load_si512(texels.origin));
  const auto counted = [](v16 x) SPANTEX_INLINED { return _mm512_mask_srai_epi32(x, of_u, x, 3); };
  const auto held = [&](v16 k) SPANTEX_INLINED {
    const v16 least = _mm512_setr_epi32(-apron, -apron, -apron, -apron, -texel_apron, -texel_apron, -texel_apron, -texel_apron, -apron, -apron, -apron, -apron, -texel_apron, -texel_apron, -texel_apron, -texel_apron);
    return _mm512_max_epi32(_mm512_min_epi32(k, last), least);
  };
  // The first column of blocks and the first eight rows, and the next ones.
  const v16 first = _mm512_shuffle_i32x4(texel, texel, 0x44), begun = _mm512_add_epi32(counted(first), _mm512_setr_epi32(0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 8, 8, 8, 8)), at = held(begun);
  const v16 stacks = _mm512_mullo_epi32(_mm512_mask_srai_epi32(at, of_v, at, stack_log2 + 3), unit);
  const v16 bytes = _mm512_mask_add_epi32(stacks, of_v, stacks, _mm512_slli_epi32(_mm512_and_si512(at, of32<(block_side << stack_log2) - 1>()), 3));
  const v16 down = _mm512_add_epi32(_mm512_shuffle_i32x4(bytes, bytes, 0xDD), origin);
  _mm512_storeu_si512(s.at, _mm512_add_epi32(_mm512_shuffle_i32x4(bytes, bytes, 0xA0), down));
  const __m256i both = _mm512_castsi512_si256(first);
  _mm_storeu_si128(reinterpret_cast<__m128i*>(s.row), _mm256_extracti128_si256(both, 1));
  _mm_storeu_si128(reinterpret_cast<__m128i*>(s.shift), _mm_slli_epi32(_mm256_castsi256_si128(both), 3));
  const v16 size = _mm512_sub_epi32(texel, first);  // in the last ends' lanes
  const __mmask16 two = __mmask16(~firsts & _mm512_cmpgt_epi32_mask(size, of32<block_side - 1>()));
  s.deep = (two & of_v) != 0;
  s.broad = (two & of_u) != 0;
  // Where blocks repeat, the map has those of one period and the apron alone.
  const __mmask16 periodic = __mmask16((map.period_u() != 0 ? of_u : 0) | (map.period_v() != 0 ? of_v : 0));
  const __mmask16 outside = __mmask16((firsts & _mm512_cmpneq_epi32_mask(at, begun)) | (last_columns & _mm512_cmpgt_epi32_mask(counted(texel), last)) |
                                      (second_rows & two & _mm512_cmpgt_epi32_mask(begun, last)));
  const __mmask16 large = Broad ? _mm512_mask_cmpgt_epi32_mask(two, size, of32<2 * block_side - 1>()) : __mmask16(two & (of_u | _mm512_cmpgt_epi32_mask(size, of32<2 * block_side - 1>())));
  s.fit = ~some_axis(large | (periodic & outside)) & 0xF;
  if constexpr (!Broad) return;
  const v16 third = _mm512_mullo_epi32(held(_mm512_add_epi32(begun, of32<2>())), unit);
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(s.at[2]), _mm256_add_epi32(_mm512_castsi512_si256(_mm512_shuffle_i32x4(third, third, 0x00)), _mm512_castsi512_si256(down)));
}
