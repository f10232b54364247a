// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: the sections of local memory of a span's quads. Included by ../avx512.cpp alone.
#pragma once

// A quad's corner a 16 bytes, four quads: their positions lie between these, rounding apart.
SPANTEX_INLINE v16 corners_of(const v16 (&x)[quads]) {
  const v16 corners = _mm512_setr_epi32(0, 16, 0, 16, 3, 19, 3, 19, 12, 28, 12, 28, 15, 31, 15, 31);
  return _mm512_unpacklo_epi64(_mm512_permutex2var_epi32(x[0], corners, x[1]), _mm512_permutex2var_epi32(x[2], corners, x[3]));
}

// In s15.16 of level 0: least u, least v, most u, most v of the four quads, widened by twice the tolerance.
SPANTEX_INLINE v16 reach_of(const v16 (&of_u)[quads], const v16 (&of_v)[quads], int bits, int32_t base_u, int32_t base_v) {
  const v16 u = corners_of(of_u), v = corners_of(of_v), some = _mm512_shuffle_i32x4(u, v, 0x44), others = _mm512_shuffle_i32x4(u, v, 0xEE);
  const v16 least = _mm512_min_epi32(some, others), most = _mm512_max_epi32(some, others);
  const v16 a = _mm512_shuffle_i32x4(least, most, 0x88), b = _mm512_shuffle_i32x4(least, most, 0xDD), all = _mm512_mask_max_epi32(_mm512_min_epi32(a, b), 0xFF00, a, b);
  constexpr int32_t slack = 1 << (17 - q.tolerance_bits);
  const v16 base = _mm512_mask_mov_epi32(set32(int32_t(uint32_t(base_u) << 16)), 0xF0F0, set32(int32_t(uint32_t(base_v) << 16)));
  const v16 start = _mm512_add_epi32(base, _mm512_setr_epi32(-slack, -slack, -slack, -slack, -slack, -slack, -slack, -slack, slack, slack, slack, slack, slack, slack, slack, slack));
  const v16 to16 = bits >= 16 ? _mm512_sra_epi32(all, _mm_cvtsi32_si128(bits - 16)) : _mm512_sll_epi32(all, _mm_cvtsi32_si128(16 - bits));
  return _mm512_add_epi32(to16, start);
}

// How sections are held: up to 8 columns of two blocks; two of two; 8 of any eight rows; three of three.
enum class held_in : uint8_t { narrow, wide, shallow, large };

// One quad's registers: upper and lower block.
struct quad_section {
  const uint8_t *near[2], *far[2];
  __mmask64 merged;  // columns from far
  SPANTEX_INLINE quad_section(const uint8_t* from, int64_t near0, int64_t near1, int64_t far0, int64_t far1, __mmask64 columns) : near{from + near0, from + near1}, far{from + far0, from + far1}, merged(columns) {
    asm("" : "+r"(near[0]), "+r"(near[1]), "+r"(far[0]), "+r"(far[1]));  // channels lie at constant distances from these four
  }
};

// Of eight rows.
struct shallow_section {
  const uint8_t *near, *far;
  __mmask64 merged;
  SPANTEX_INLINE shallow_section(const uint8_t* from, int64_t near_at, int64_t far_at, __mmask64 columns) : near(from + near_at), far(from + far_at), merged(columns) {
    asm("" : "+r"(near), "+r"(far));
  }
};

// One quad's section of a span, as find_sections() left it.
template <held_in Where>
SPANTEX_INLINE auto section_of(const uint8_t* blocks, const batch_sections& s, int k, int n) {
  if constexpr (Where == held_in::shallow) return shallow_section(blocks, s.at[0][0][n][k], s.at[1][0][n][k], s.merged[n][k]);
  else return quad_section(blocks, s.at[0][0][n][k], s.at[0][1][n][k], s.at[1][0][n][k], s.at[1][1][n][k], Where == held_in::narrow ? s.merged[n][k] : 0);
}

// The sections of a span's four quads on a level each, from planar_map::blocks(). Wide: up to 16 columns, the even blocks near; else up to 8, the
// first block near.
struct alignas(64) span_sections {
  int32_t at[2][2][quads];
  alignas(32) uint64_t merged[quads];           // narrow
  uint32_t fit;                                 // bit n: quad n's section is in here
};

// Lanes are ordered as in reach_of(): those of u, of v, of the first ends.
constexpr __mmask16 of_u = 0x0F0F, of_v = 0xF0F0, firsts = 0x00FF;

SPANTEX_INLINE v16 one_at_last_ends() { return _mm512_setr_epi32(0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1); }

// The texels of the level that the ends need.
SPANTEX_INLINE v16 end_texels(v16 reach, v16 level) {
  const v16 half = _mm512_sllv_epi32(of32<1 << 15>(), level);
  return _mm512_add_epi32(_mm512_srav_epi32(_mm512_sub_epi32(reach, half), _mm512_add_epi32(level, of32<16>())), one_at_last_ends());
}

SPANTEX_INLINE v16 spread_of(v16 from) { return _mm512_sub_epi32(_mm512_shuffle_i32x4(from, from, 0x4E), from); }  // in the first ends' lanes
SPANTEX_INLINE uint32_t some_axis(uint32_t lanes) { return (lanes | lanes >> 4 | lanes >> 8 | lanes >> 12) & 0xF; }  // quads

// What the axes have on each lane's level: levels of the quads, four times over.
SPANTEX_INLINE v16 of_levels(v16 level, const int32_t (&u)[max_planar_levels], const int32_t (&v)[max_planar_levels]) {
  static_assert(max_planar_levels == 16);
  const v16 axis = _mm512_setr_epi32(0, 0, 0, 0, 16, 16, 16, 16, 0, 0, 0, 0, 16, 16, 16, 16);
  return _mm512_permutex2var_epi32(_mm512_load_si512(u), _mm512_or_si512(level, axis), _mm512_load_si512(v));
}

// Where blocks repeat: there the map has those of one period alone.
SPANTEX_INLINE __mmask16 repeating_axes(const planar_map& map) { return __mmask16((map.period_u() != 0 ? of_u : 0) | (map.period_v() != 0 ? of_v : 0)); }

// The even one of block `start` and the next in the lanes of the first ends, the odd one in the others.
SPANTEX_INLINE v16 even_and_odd(v16 start) {
  const v16 one = set32(1), ends = one_at_last_ends();
  return _mm512_or_si512(_mm512_andnot_si512(one, _mm512_add_epi32(start, _mm512_sub_epi32(one, ends))), ends);
}

// What sections of any size need of the quads' ends: their texels, on the quads' levels.
struct section_ends {
  v16 texel, block, start, least, last, unit, origin;  // start: the first ends' blocks: u, v, u, v; unit: bytes from block to block
  __mmask16 outside;                                   // where the map has no block
  SPANTEX_INLINE section_ends(const planar_map& map, v16 at, v16 level) : texel(at), block(_mm512_srai_epi32(at, 3)), start(_mm512_shuffle_i32x4(block, block, 0x44)), least(of32<-apron>()) {
    const planar_levels& texels = map.levels();
    last = of_levels(level, texels.last_column, texels.last_row);
    unit = of_levels(level, texels.column_bytes, texels.row_bytes);
    origin = _mm512_permutexvar_epi32(level, _mm512_load_si512(texels.origin));
    outside = __mmask16(repeating_axes(map) & _mm512_cmpneq_epi32_mask(held(block), block));
  }
  SPANTEX_INLINE v16 held(v16 k) const { return _mm512_max_epi32(_mm512_min_epi32(k, last), least); }
  SPANTEX_INLINE v16 bytes_of(v16 k) const {
    const v16 h = held(k), stacks = _mm512_mullo_epi32(_mm512_mask_srai_epi32(h, of_v, h, stack_log2), unit);
    return _mm512_mask_add_epi32(stacks, of_v, stacks, _mm512_slli_epi32(_mm512_and_si512(h, of32<stack_blocks - 1>()), 6));
  }
  SPANTEX_INLINE uint32_t fitting(v16 from, v16 most) const {  // bit n: no more than so many from quad n's first end to its last
    const uint32_t bad = (firsts & _mm512_cmpgt_epi32_mask(spread_of(from), most)) | outside;
    return bad == 0 ? 0xF : ~some_axis(bad) & 0xF;
  }
};

template <bool Wide>
SPANTEX_INLINE void find_sections(const section_ends& e, span_sections& s) {
  const v16 one = set32(1), two = even_and_odd(e.start);
  const v16 bytes = e.bytes_of(Wide ? two : _mm512_mask_mov_epi32(two, of_u, e.block));
  const v16 across = _mm512_shuffle_i32x4(bytes, bytes, 0xA0), down = _mm512_shuffle_i32x4(bytes, bytes, 0xDD);
  _mm512_store_si512(s.at, _mm512_add_epi32(_mm512_add_epi32(across, down), e.origin));
  if constexpr (Wide) {
    s.fit = e.fitting(e.block, one);
  } else {
    s.fit = e.fitting(_mm512_mask_mov_epi32(e.block, of_u, e.texel), _mm512_mask_mov_epi32(one, of_u, of32<block_side - 1>()));  // columns are counted
    const __m512i column = _mm512_cvtepi32_epi64(_mm512_castsi512_si256(_mm512_and_si512(e.texel, of32<7>())));
    _mm256_store_si256(reinterpret_cast<__m256i*>(s.merged), _mm512_castsi512_si256(_mm512_permutexvar_epi64(column, _mm512_loadu_si512(columns_below))));
  }
}

// 24x24 texels, where two blocks either way are too few: the even one of the first two, the odd one, the third.
struct large_section {
  const uint8_t* blocks;
  int32_t at[3][3];      // column, row
  int32_t column, row;   // the first block
};

struct alignas(64) large_sections {
  int32_t two[2][2][quads];    // the even and the odd column; their even and odd row
  int32_t third[2][2][quads];  // the third column: its even and odd row; the third row: its even and odd column
  int32_t corner[quads], first[2][quads];  // both third; the first column and row
  uint32_t fit;                // bit n: quad n's section is in here
  SPANTEX_INLINE large_section of(const uint8_t* blocks, int n) const {
    return {blocks,
            {{two[0][0][n], two[0][1][n], third[1][0][n]}, {two[1][0][n], two[1][1][n], third[1][1][n]}, {third[0][0][n], third[0][1][n], corner[n]}},
            first[0][n],
            first[1][n]};
  }
};

SPANTEX_INLINE void find_large_sections(const section_ends& e, large_sections& s) {
  const v16 two = e.bytes_of(even_and_odd(e.start)), third = e.bytes_of(_mm512_add_epi32(e.start, of32<2>()));
  const v16 columns = _mm512_add_epi32(two, e.origin), third_columns = _mm512_add_epi32(third, e.origin);
  _mm512_store_si512(s.two, _mm512_add_epi32(_mm512_shuffle_i32x4(columns, columns, 0xA0), _mm512_shuffle_i32x4(two, two, 0xDD)));
  _mm512_store_si512(s.third, _mm512_add_epi32(_mm512_shuffle_i32x4(third_columns, columns, 0x80), _mm512_shuffle_i32x4(two, third, 0x5D)));
  _mm_store_si128(reinterpret_cast<__m128i*>(s.corner), _mm512_castsi512_si128(_mm512_add_epi32(third_columns, _mm512_shuffle_i32x4(third, third, 0x55))));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(s.first), _mm512_castsi512_si256(e.block));
  s.fit = e.fitting(e.block, of32<2>());
}

template <held_in Where>
SPANTEX_INLINE quad_section section_of(const uint8_t* blocks, const span_sections& s, int n) {
  return {blocks, s.at[0][0][n], s.at[0][1][n], s.at[1][0][n], s.at[1][1][n], Where == held_in::narrow ? s.merged[n] : 0};
}
