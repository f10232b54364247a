// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: the sections of local memory of a span's quads. Included by ../avx512.cpp alone.
#pragma once

struct extremes { __m128i least, most; };
SPANTEX_INLINE extremes extremes_of(const v16 (&x)[quads]) {  // positions of a quad lie between those of its corners, rounding apart
  const v16 corners = _mm512_setr_epi32(0, 16, 0, 16, 3, 19, 3, 19, 12, 28, 12, 28, 15, 31, 15, 31);
  const v16 all = _mm512_unpacklo_epi64(_mm512_permutex2var_epi32(x[0], corners, x[1]), _mm512_permutex2var_epi32(x[2], corners, x[3]));
  const __m256i a = _mm512_castsi512_si256(all), c = _mm512_extracti64x4_epi64(all, 1), least = _mm256_min_epi32(a, c), most = _mm256_max_epi32(a, c);
  return {_mm_min_epi32(_mm256_castsi256_si128(least), _mm256_extracti128_si256(least, 1)),
          _mm_max_epi32(_mm256_castsi256_si128(most), _mm256_extracti128_si256(most, 1))};
}

// In s15.16 of level 0: least u, most u, least v, most v of the four quads, widened by twice the tolerance.
SPANTEX_INLINE v16 reach_of(const offsets& o, int32_t base_u, int32_t base_v) {
  const extremes u = extremes_of(o.u), v = extremes_of(o.v);
  const v16 all = both_axes(_mm256_set_m128i(u.most, u.least), _mm256_set_m128i(v.most, v.least));
  const int32_t slack = 1 << (17 - q.tolerance_bits);
  const __m256i from = _mm256_setr_epi32(-slack, -slack, -slack, -slack, slack, slack, slack, slack);
  const v16 start = both_axes(_mm256_add_epi32(from, _mm256_set1_epi32(base_u << 16)), _mm256_add_epi32(from, _mm256_set1_epi32(base_v << 16)));
  const v16 to16 = o.bits >= 16 ? _mm512_sra_epi32(all, _mm_cvtsi32_si128(o.bits - 16)) : _mm512_sll_epi32(all, _mm_cvtsi32_si128(16 - o.bits));
  return _mm512_add_epi32(to16, start);
}

// One quad's registers, in bytes from an origin.
struct quad_section {
  const uint8_t* origin;
  int64_t near[2], far[2];
  __mmask64 merged;  // columns from far
};

constexpr uint64_t columns_below[block_side] = {0, 0x0101010101010101, 0x0303030303030303, 0x0707070707070707, 0x0F0F0F0F0F0F0F0F, 0x1F1F1F1F1F1F1F1F,
                                                0x3F3F3F3F3F3F3F3F, 0x7F7F7F7F7F7F7F7F};

// One quad's section as place() left it.
SPANTEX_INLINE quad_section section_of(const batch& b, const uint8_t* origin, int k, int n) {
  return {origin, {b.at[0][0][n][k], b.at[0][1][n][k]}, {b.at[1][0][n][k], b.at[1][1][n][k]}, columns_below[b.column[n][k]]};
}

// The sections of a span's four quads on a level each, from planar_map::blocks(). Wide: up to 16 columns, the even blocks near; else up to 8, the
// first block near.
struct alignas(64) span_sections {
  int32_t at[2][2][quads], first[2][2][quads];  // first texel: u; the rest is of no use
  uint32_t fit;                                 // bit n: quad n's section is in here
};

// Levels of the quads, four times over.
template <bool Wide>
SPANTEX_INLINE void find_sections(const planar_map& map, v16 reach, v16 level, span_sections& s) {
  const planar_levels& texels = map.levels();
  const v16 one = set32(1), axis = both_axes(0, max_planar_levels), index = _mm512_or_si512(level, axis);
  const auto of_level = [&](const int32_t* u, const int32_t* v) { return _mm512_permutex2var_epi32(_mm512_load_si512(u), index, _mm512_load_si512(v)); };
  // first texel and, in groups 1 and 3, the last
  const v16 half = _mm512_sllv_epi32(set32(1 << 15), level), ends = _mm512_setr_epi32(0, 0, 0, 0, 1, 1, 1, 1, 0, 0, 0, 0, 1, 1, 1, 1);
  const v16 texel = _mm512_add_epi32(_mm512_srav_epi32(_mm512_sub_epi32(reach, half), _mm512_add_epi32(level, set32(16))), ends);
  const v16 block = _mm512_srai_epi32(texel, 3), least = set32(-apron), last = of_level(texels.last_column, texels.last_row);
  const auto distance = [&](v16 x) { return _mm512_sub_epi32(_mm512_shuffle_i32x4(x, x, 0xB1), x); };
  const v16 spread = Wide ? distance(block) : _mm512_mask_mov_epi32(distance(block), 0x00FF, distance(texel));
  const v16 most = Wide ? one : both_axes(block_side - 1, 1);
  __mmask16 bad = __mmask16(0x0F0F & _mm512_cmpgt_epi32_mask(spread, most));
  const __mmask16 strict = __mmask16((map.period_u() != 0 ? 0xFF : 0) | (map.period_v() != 0 ? 0xFF00 : 0));
  bad = __mmask16(bad | (strict & _mm512_cmpneq_epi32_mask(_mm512_max_epi32(_mm512_min_epi32(block, last), least), block)));
  const v16 start = _mm512_shuffle_i32x4(block, block, 0xA0);  // of u, u, v, v
  v16 parity = _mm512_or_si512(_mm512_andnot_si512(one, _mm512_add_epi32(start, _mm512_sub_epi32(one, ends))), ends);  // the even one, the odd one
  if constexpr (!Wide) parity = _mm512_mask_mov_epi32(parity, 0x00FF, block);
  const v16 held = _mm512_max_epi32(_mm512_min_epi32(parity, last), least);
  const v16 bytes = _mm512_mullo_epi32(held, of_level(texels.column_bytes, texels.row_bytes));
  const v16 origin = _mm512_permutexvar_epi32(level, _mm512_load_si512(texels.origin));
  const v16 across = _mm512_shuffle_i32x4(bytes, bytes, 0x50), down = _mm512_shuffle_i32x4(bytes, bytes, 0xEE);
  _mm512_store_si512(s.at, _mm512_add_epi32(_mm512_add_epi32(across, down), origin));
  if constexpr (!Wide) _mm512_store_si512(s.first, texel);
  s.fit = bad == 0 ? 0xF : ~uint32_t(bad | bad >> 4 | bad >> 8 | bad >> 12) & 0xF;
}

template <bool Wide>
SPANTEX_INLINE quad_section section_of(const planar_map& map, const span_sections& s, int n) {
  return {map.blocks(), {s.at[0][0][n], s.at[0][1][n]}, {s.at[1][0][n], s.at[1][1][n]}, Wide ? 0 : columns_below[s.first[0][0][n] & 7]};
}
