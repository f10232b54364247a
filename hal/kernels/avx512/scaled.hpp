// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: positions on levels whose sides do not halve exactly, and the sections of eight spans there. Included by by_blocks.hpp alone.
#pragma once

// The upper halves of products.
SPANTEX_INLINE v16 upper_products(v16 x, v16 y_even, v16 y_odd) {
  const v16 halves = _mm512_setr_epi32(1, 17, 3, 19, 5, 21, 7, 23, 9, 25, 11, 27, 13, 29, 15, 31);
  return _mm512_permutex2var_epi32(_mm512_mul_epi32(x, y_even), halves, _mm512_mul_epi32(_mm512_srli_epi64(x, 32), y_odd));
}

// What leads from positions from the origin, s15.16, to those on levels whose sides do not halve exactly, in lanes of either axis, each on its level: upper halves of products with
// `ratio`, with `from` added, have 2^-(7 + drop) texel. turned: the whole periods of the level that lie before the base, in texels.
struct level_scale {
  v16 ratio, drop, from;
  SPANTEX_INLINE level_scale(v16 of_level, v16 level, v16 turned) : ratio(of_level) {
    const v16 halved = _mm512_add_epi32(level, of32<16 + 31 - q.subtexel_bits - 32>());
    drop = _mm512_mask_sub_epi32(halved, _mm512_cmpeq_epi32_mask(ratio, of32<1 << 30>()), halved, of32<1>());
    const v16 start = _mm512_add_epi32(_mm512_slli_epi32(turned, q.subtexel_bits), of32<1 << (q.subtexel_bits - 1)>());  // and half a texel
    from = _mm512_sub_epi32(_mm512_setzero_si512(), _mm512_sllv_epi32(start, drop));
  }
  SPANTEX_INLINE v16 texel(v16 position) const {
    const v16 product = upper_products(position, ratio, _mm512_srli_epi64(ratio, 32));
    return _mm512_srav_epi32(_mm512_add_epi32(product, from), _mm512_add_epi32(drop, of32<q.subtexel_bits>()));
  }
  // `from` with half of what is dropped.
  SPANTEX_INLINE v16 rounding_from() const { return _mm512_add_epi32(from, _mm512_sllv_epi32(of32<1>(), _mm512_sub_epi32(drop, of32<1>()))); }
};

// Positions as snapped_by() has them: products with ratios, what is added to their upper halves, what is dropped of u, how far v is rotated.
template <class C>
SPANTEX_INLINE v16 scaled_by(const C& c, v16 u, v16 v, int32_t ratio_u, int32_t ratio_v, int32_t from_u, int32_t from_v, int32_t drop, int32_t turn) {
  const auto product = [](v16 x, int32_t ratio, int32_t from) SPANTEX_INLINED {
    const v16 by = set32(ratio);
    return _mm512_add_epi32(upper_products(x, by, by), set32(from));
  };
  return _mm512_mask_mov_epi16(_mm512_rorv_epi32(product(v, ratio_v, from_v), set32(turn)), __mmask32(c.even), _mm512_srlv_epi32(product(u, ratio_u, from_u), set32(drop)));
}

// A level whose sides do not halve exactly: positions on it are products of positions from the origin, s15.16, with the ratio of its sides to level 0's.
// Lanes and numbers are of the quads' u, then of their v.
struct alignas(32) scaling {
  static_assert(2 * quads == batch_size, "put() stores as many");
  int32_t ratio[2 * quads], from[2 * quads], drop[2 * quads];

  SPANTEX_INLINE void begin_at(__m128i column, __m128i row) {
    const __m128i subtexel = _mm_set1_epi32(q.subtexel_bits);
    begin_four(from, column, _mm_add_epi32(four(drop), subtexel));
    begin_four(from + quads, row, _mm_add_epi32(four(drop + quads), subtexel));
  }

  template <class C>
  SPANTEX_INLINE v16 at(const C& c, v16 u, v16 v, int n) const {
    return scaled_by(c, u, v, ratio[n], ratio[n + quads], from[n], from[n + quads], drop[n], drop[n + quads] - 16);
  }
};

// Of eight spans what leads to positions on such levels, and where their sections lie.
struct scaled_places {
  struct scaled_level {
    batch_sections sections;
    alignas(64) int32_t ratio[2][batch_size], drop[2][batch_size], from[quads][2][batch_size];  // of u, then of v, which is rotated; positions have coordinate_bits

    template <class C>
    SPANTEX_INLINE v16 at(const C& c, v16 u, v16 v, int k, int n) const {
      return scaled_by(c, u, v, ratio[0][k], ratio[1][k], from[n][0][k], from[n][1][k], drop[0][k], drop[1][k]);
    }
  };
  scaled_level on[2];  // the fine one, the coarse one
  uint32_t placed = 0, deep = 0, broad = 0;
};

// A span's positions from the origin, with coordinate_bits.
SPANTEX_INLINE void count_from_origin(const batch& b, int k, span_pixels& p) {
  const int bits = bits_of(b, k);
  const v16 half = set32(int32_t(half_of(bits))), drop = set32(bits - q.coordinate_bits);
  const auto counted = [&](v16 offset, int32_t origin) SPANTEX_INLINED { return _mm512_add_epi32(_mm512_srav_epi32(_mm512_add_epi32(offset, half), drop), set32(origin << q.coordinate_bits)); };
#pragma GCC unroll 4
  for (int n = 0; n < quads; ++n) {
    p.u[n] = counted(p.u[n], b.origin_u[k]);
    p.v[n] = counted(p.v[n], b.origin_v[k]);
  }
}

// As place_spans(), of spans `some` whose pixels are on one whole level each, with eight rows at most of the coarse one. Others are seldom; those on two whole levels are no faster here.
template <bool TwoLevels>
[[gnu::noinline]] SPANTEX_WRAPS void place_scaled_spans(const row_work& work, const batch& b, uint32_t some, uint32_t alone, __m256i fine, scaled_places& p) {
  some &= _mm256_cmple_epi32_mask(got(b.slope_log2), _mm256_set1_epi32(-2));  // plan_bounds()
  if (some == 0) return;
  const planar_map& map = *work.texels;
  const planar_levels& texels = map.levels();
  // The whole periods before the base.
  const auto turns = [](const int32_t (&origin)[batch_size], const int32_t (&base)[batch_size], int32_t period) SPANTEX_INLINED {
    if (period == 0) return _mm256_setzero_si256();
    const v8 rounded = _mm512_add_epi64(_mm512_cvtepi32_epi64(_mm256_sub_epi32(got(origin), got(base))), set(period / 2));
    return narrowed(_mm512_srai_epi64(_mm512_mullo_epi64(rounded, set(((int64_t(1) << 40) + period - 1) / period)), 40));
  };
  const v16 turned = both_axes(turns(b.origin_u, b.base_u, map.period_u()), turns(b.origin_v, b.base_v, map.period_v()));
  quad_bounds bounds = quad_bounds::divided(b);
  bounds.base = _mm512_slli_epi32(both_axes(got(b.origin_u), got(b.origin_v)), 16);
  const quad_ends ends(bounds);
  const auto find = [&](__m256i level, scaled_places::scaled_level& to) SPANTEX_INLINED {
    const v16 levels = both_axes(level, level);
    const level_scale scale(of_both_axes(levels, texels.ratio_u, texels.ratio_v), levels, _mm512_mullo_epi32(turned, of_both_axes(levels, texels.period_u, texels.period_v)));
    const section_kinds kinds = find_sections<false>(map, levels, ends, false, to.sections, [&](v16 position) SPANTEX_INLINED { return scale.texel(position); });
    constexpr int fewer = 16 - q.coordinate_bits;
    const v16 drop = _mm512_sub_epi32(scale.drop, of32<fewer>()), from = _mm512_srai_epi32(scale.rounding_from(), fewer), texel = _mm512_add_epi32(drop, of32<q.subtexel_bits>());
    _mm512_store_si512(to.ratio, scale.ratio);
    _mm512_store_si512(to.drop, _mm512_sub_epi32(drop, both_axes<0, 16>()));
#pragma GCC unroll 4
    for (int n = 0; n < quads; ++n) {
      const v16 first = both_axes(_mm256_srai_epi32(got(to.sections.shift[n]), 3), got(to.sections.row[n]));
      _mm512_store_si512(to.from[n], _mm512_sub_epi32(from, _mm512_sllv_epi32(first, texel)));
    }
    return kinds;
  };
  const section_kinds kinds = find(fine, p.on[0]);
  some &= kinds.here;
  if (TwoLevels && (some & ~alone) != 0) {
    const section_kinds coarse = find(_mm256_min_epi32(_mm256_add_epi32(fine, _mm256_set1_epi32(1)), _mm256_set1_epi32(work.last_level)), p.on[1]);
    some &= alone | (coarse.here & ~(coarse.deep | coarse.broad));
  }
  p.placed = some;
  p.deep = kinds.deep;
  p.broad = kinds.broad;
}
