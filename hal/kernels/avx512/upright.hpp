// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: planes that are scaled along their axes (../upright.hpp). A row of pixels is a permutation of a row of texels, and what is interpolated along a row
// of texels serves every row of pixels beside it. Included by ../avx512.cpp alone.
#pragma once

constexpr int window = texel_apron;  // texels that a register holds
constexpr int pair_width = 2 * span_side;

// What upright_columns have `prepared`, for each pair of spans; their way is that of the windows. Spans wider than two are left to the kernel by rows.
//   near[2], far[2]    where the windows begin in a row of the map: one to a span, or two
//   nearest            of sixteen pixels texels in the span's windows
//   other filters      of each span's eight pixels: bytes in the windows as weights take them, t(0) t(1) of each channel; weights f - 128, -f of 128, negative so that both fit
enum windows : int { one, two };
constexpr int near_windows = 0, far_windows = 2, first_register = 4;  // 32-bit numbers
template <bool Blend> constexpr int pair_size = first_register + 16 * (Blend ? 4 : 1);

// A span of a pair: where its pixels lie, in the texels' windows and, to blend, between texels.
template <bool Blend>
SPANTEX_INLINE void prepare_span(__m256i in_window, __m256i position, int k, int32_t* registers) {
  if constexpr (!Blend) {
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(registers + span_side * k), in_window);
  } else {
    const auto in_turn = [](__m256i a, __m256i b) { return _mm512_or_si512(_mm512_cvtepu32_epi64(a), _mm512_slli_epi64(_mm512_cvtepu32_epi64(b), 32)); };
    const auto of8 = [](int32_t x) { return _mm256_set1_epi32(x); };
    const __m256i from = _mm256_mullo_epi32(in_window, of8(0x04040404)), f = _mm256_and_si256(position, of8((1 << q.subtexel_bits) - 1));
    const __m256i weights = _mm256_or_si256(_mm256_xor_si256(f, of8(0x80)), _mm256_slli_epi32(_mm256_and_si256(_mm256_sub_epi32(of8(256), f), of8(0xFF)), 8));
    const __m256i both = _mm256_or_si256(weights, _mm256_slli_epi32(weights, 16));
    _mm512_storeu_si512(registers + 32 * k, in_turn(_mm256_add_epi32(from, of8(0x05010400)), _mm256_add_epi32(from, of8(0x07030602))));
    _mm512_storeu_si512(registers + 32 * k + 16, in_turn(both, both));
  }
}

// False if some span takes more than two windows.
template <bool Blend>
bool prepare_windows(const level_rows& map, upright_columns& columns) {
  const int spans = int(columns.at.size()) / span_side, pairs = (spans + 1) / 2;
  columns.prepared.assign(size_t(pairs * pair_size<Blend>), 0);  // the last pair may have one span
  columns.way = windows::one;
  for (int n = 0; n < pairs; ++n) {
    int32_t* const to = columns.prepared.data() + n * pair_size<Blend>;
    for (int k = 0; k < min_of(2, spans - 2 * n); ++k) {
      const int32_t* const at = columns.at.data() + (2 * n + k) * span_side;
      const auto texel = [&](int i) { return Blend ? at[i] >> q.subtexel_bits : at[i]; };
      const int32_t start = min_of(texel(0), texel(span_side - 1)), last = max_of(texel(0), texel(span_side - 1)) - start + (Blend ? 1 : 0);
      if (last >= 2 * window) return false;
      to[near_windows + k] = map.column(start, window);
      if (last >= window) {
        columns.way = windows::two;
        to[far_windows + k] = map.column(start + window, window);
      }
      const __m256i position = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(at));
      prepare_span<Blend>(_mm256_sub_epi32(Blend ? _mm256_srai_epi32(position, q.subtexel_bits) : position, _mm256_set1_epi32(start)), position, k, to + first_register);
    }
  }
  return true;
}

// Both levels, if there are two; none if one of them does not fit.
template <filter Kind>
void prepare(const row_work& work, const upright_row& row) {
  if (!row.fine.columns->prepared.empty()) return;
  const auto fits = [&](const upright_level& l) { return prepare_windows<Kind != filter::nearest>(level_rows(*work.texels, l.level), *l.columns); };
  if (fits(row.fine) && (row.coarse.columns->at.empty() || fits(row.coarse))) return;
  row.fine.columns->prepared.clear();
  row.coarse.columns->prepared.clear();
  row.fine.columns->left = true;
}

// Pairs of spans as the table has them; bits of a row of a pair's pixels.
struct pair_masks {
  span_mask span[max_row_spans + 2];  // nothing before the first and after the last
  int first, end;
  pair_masks(const row_work& work) {
    const int before = work.sx - work.upright->fine.columns->sx;
    first = before / 2;
    end = (before + work.count + 1) / 2;
    span[0] = span[before % 2 + work.count] = 0;
    for (int k = 0; k < work.count; ++k) span[before % 2 + k] = work.masks[k];
  }
  SPANTEX_INLINE const span_mask* of(int n) const { return span + 2 * (n - first); }
  SPANTEX_INLINE bool none(int n) const { return (of(n)[0] | of(n)[1]) == 0; }
  SPANTEX_INLINE bool all(int n) const { return (of(n)[0] & of(n)[1]) == ~span_mask(0); }
  SPANTEX_INLINE __mmask16 row(int n, int j) const { return __mmask16((of(n)[0] >> (span_side * j) & 0xFF) | (of(n)[1] >> (span_side * j) & 0xFF) << span_side); }
};

struct pixel_rows { rgba8* at; int32_t stride; };  // of a pair of spans, from its first pixel on

template <bool Whole>
SPANTEX_INLINE void write_row(const pixel_rows& to, int j, __mmask16 mask, v16 pixels) {
  rgba8* const at = to.at + int64_t(j) * to.stride;
  if constexpr (Whole) _mm512_storeu_si512(at, pixels);
  else _mm512_mask_storeu_epi32(at, mask, pixels);
}

// --- nearest: sixteen pixels at a time, row by row -------------------------------------------------------

template <bool Two>
SPANTEX_INLINE v16 permuted(const rgba8* row, const int32_t* pair) {
  const auto texels = [&](int k) { return _mm512_loadu_si512(row + pair[k]); };
  const v16 index = _mm512_loadu_si512(pair + first_register);
  if constexpr (!Two) {
    const v16 second = _mm512_setr_epi32(0, 0, 0, 0, 0, 0, 0, 0, window, window, window, window, window, window, window, window);
    return _mm512_permutex2var_epi32(texels(near_windows), _mm512_or_si512(index, second), texels(near_windows + 1));
  }
  return _mm512_mask_mov_epi32(_mm512_permutex2var_epi32(texels(near_windows), index, texels(far_windows)), 0xFF00,
                               _mm512_permutex2var_epi32(texels(near_windows + 1), index, texels(far_windows + 1)));
}

template <bool Two>
void permute_rows(const pair_masks& masks, const int32_t* pairs, const rgba8* const (&rows)[span_side], rgba8* to, int32_t stride) {
  constexpr int size = pair_size<false>;
  for (int n = masks.first; n < masks.end;) {
    int end = n;
    while (end < masks.end && masks.all(end)) ++end;
    for (int j = 0; j < span_side; ++j)
      for (int k = n; k < end; ++k) write_row<true>({to + pair_width * k, stride}, j, 0, permuted<Two>(rows[j], pairs + k * size));
    for (n = end; n < masks.end && !masks.all(n); ++n)
      for (int j = 0; j < span_side; ++j)
        if (const __mmask16 mask = masks.row(n, j)) write_row<false>({to + pair_width * n, stride}, j, mask, permuted<Two>(rows[j], pairs + n * size));
  }
}

// --- other filters: eight rows of sixteen pixels at a time -----------------------------------------------

// A pair of spans' part of the table.
struct column_pair {
  const int32_t* at;
  v16 index[2], weights[2];
  SPANTEX_INLINE explicit column_pair(const int32_t* pair) : at(pair) {
#pragma GCC unroll 2
    for (int k = 0; k < 2; ++k) {
      index[k] = held(_mm512_loadu_si512(pair + first_register + 32 * k));  // in registers: loads would be made for each row
      weights[k] = held(_mm512_loadu_si512(pair + first_register + 32 * k + 16));
    }
  }
};

// Interpolated along a row of texels, each channel of a pixel in 16 bits: the negative of it, 7 bits of fraction.
struct blended_row { v16 span[2]; };

template <bool Two>
SPANTEX_INLINE blended_row blended_along(const rgba8* row, const column_pair& pair) {
  blended_row r;
#pragma GCC unroll 2
  for (int k = 0; k < 2; ++k) {
    const auto texels = [&](int from) { return _mm512_loadu_si512(row + pair.at[from + k]); };
    const v16 twos = Two ? _mm512_permutex2var_epi8(texels(near_windows), pair.index[k], texels(far_windows)) : _mm512_permutexvar_epi8(pair.index[k], texels(near_windows));
    r.span[k] = _mm512_maddubs_epi16(twos, pair.weights[k]);
  }
  return r;
}

// --- in 16 bits, a channel of eight pixels each (vectors/pixels.hpp has the arithmetic) -----------------------

template <int32_t X>
SPANTEX_INLINE v16 of16() { return of32<X * 0x00010001>(); }
SPANTEX_INLINE v16 both16(int32_t x) { return set32(int32_t(uint32_t(x) * 0x00010001u)); }

// A step from x, n / 2^15 of a change: to nearest; what that leaves out, 2^-16, in sign.
struct part { v16 weights, twice; };
SPANTEX_INLINE part part_of(int32_t n) { return {both16(n), both16(2 * n)}; }
SPANTEX_INLINE v16 step(v16 change, const part& of) { return _mm512_mulhrs_epi16(change, of.weights); }
SPANTEX_INLINE v16 rest(v16 change, const part& of) { return _mm512_mullo_epi16(change, of.twice); }

// 8.7 to whole numbers, halves up but for those that are to go down, which are even then.
SPANTEX_INLINE v16 whole(v16 x, __mmask32 down) { return _mm512_mulhrs_epi16(_mm512_mask_sub_epi16(x, down, x, of16<1>()), of16<1 << (15 - q.blend_bits)>()); }
SPANTEX_INLINE v16 even(v16 x) { return whole(x, _mm512_testn_epi16_mask(x, of16<1 << q.blend_bits>())); }
SPANTEX_INLINE v16 even(v16 x, v16 rest) {
  constexpr int a_or_b_and_c = 0xF8;
  const v16 odd = of16<1 << q.blend_bits>();  // the rest has no such bits
  return whole(x, _mm512_cmple_epi16_mask(_mm512_ternarylogic_epi32(rest, x, odd, a_or_b_and_c), _mm512_setzero_si512()));
}

struct upright_rows : rows_between {
  part below[span_side];
  SPANTEX_INLINE upright_rows(const planar_map& texels, const upright_level& l) : rows_between(texels, l) {
    for (int j = 0; j < span_side; ++j) below[j] = part_of(fraction[j] << (15 - q.subtexel_bits));
  }
};

// A pair of spans on a level, from the first row of pixels on.
template <bool Two>
struct level_walk {
  const upright_rows& rows;
  column_pair columns;
  two_rows<blended_row> two;
  SPANTEX_INLINE level_walk(const upright_rows& r, const int32_t* pair) : rows(r), columns(pair) {}

  SPANTEX_INLINE void to(int j) {
    two.to(rows.upper[j], rows.lower[j], [&](const rgba8* row) SPANTEX_INLINED { return blended_along<Two>(row, columns); });
  }
  SPANTEX_INLINE v16 change(int k) const { return _mm512_sub_epi16(two.above.span[k], two.below.span[k]); }
  SPANTEX_INLINE v16 colours(int j, int k) const { return _mm512_sub_epi16(step(change(k), rows.below[j]), two.above.span[k]); }
  SPANTEX_INLINE v16 pixels(int j, int k) const { return even(colours(j, k), rest(change(k), rows.below[j])); }
};

struct upright_levels { upright_rows fine, coarse; const int32_t *fine_pairs, *coarse_pairs; part between; };

template <rounded How, bool Two, bool Whole>
SPANTEX_INLINE void blend_pair(const upright_levels& l, const pair_masks& masks, int n, const pixel_rows& to) {
  level_walk<Two> fine(l.fine, l.fine_pairs + n * pair_size<true>), coarse(l.coarse, l.coarse_pairs + n * pair_size<true>);
  for (int j = 0; j < span_side; ++j) {
    fine.to(j);
    if constexpr (How == rounded::between_levels) coarse.to(j);
    const auto span = [&](int k) SPANTEX_INLINED {
      if constexpr (How == rounded::at_once) return fine.pixels(j, k);
      const v16 near = fine.colours(j, k);
      if constexpr (How == rounded::after_level) return even(near);
      const v16 change = _mm512_sub_epi16(coarse.colours(j, k), near);
      return even(_mm512_add_epi16(near, step(change, l.between)), rest(change, l.between));
    };
    const v16 in_order = _mm512_setr_epi64(0, 2, 4, 6, 1, 3, 5, 7);
    write_row<Whole>(to, j, Whole ? 0 : masks.row(n, j), _mm512_permutexvar_epi64(in_order, _mm512_packus_epi16(span(0), span(1))));
  }
}

template <rounded How, bool Two>
__attribute__((noinline)) void blend_rows(const pair_masks& masks, const upright_levels& l, rgba8* to, int32_t stride) {
  for (int n = masks.first; n < masks.end; ++n) {
    const pixel_rows at{to + pair_width * n, stride};
    if (masks.all(n)) blend_pair<How, Two, true>(l, masks, n, at);
    else if (!masks.none(n)) blend_pair<How, Two, false>(l, masks, n, at);
  }
}

template <rounded How>
void draw_levels(const row_work& work, const upright_row& row, bool two_windows) {
  const pair_masks masks(work);
  rgba8* const to = first_of_span(work, row.fine.columns->sx);
  const upright_level& other = How == rounded::between_levels ? row.coarse : row.fine;
  const upright_levels l{{*work.texels, row.fine}, {*work.texels, other}, row.fine.columns->prepared.data(), other.columns->prepared.data(),
                         part_of(row.fraction << (15 - q.level_bits))};
  if (two_windows) blend_rows<How, true>(masks, l, to, work.stride);
  else blend_rows<How, false>(masks, l, to, work.stride);
}

// --- rows of spans ---------------------------------------------------------------------------------------

template <filter Kind>
void draw_upright(const row_work& work) {
  const upright_row& row = *work.upright;
  if (!row.fine.columns->left) prepare<Kind>(work, row);
  if (row.fine.columns->left) return avx2_kernel()(work);
  const bool two_windows = max_of(row.fine.columns->way, row.coarse.columns->way) == windows::two;
  if constexpr (Kind == filter::nearest) {
    const level_rows map(*work.texels);
    const rgba8* rows[span_side];
    for (int j = 0; j < span_side; ++j) rows[j] = map.row(row.fine.at[j]);
    rgba8* const to = first_of_span(work, row.fine.columns->sx);
    const int32_t* const pairs = row.fine.columns->prepared.data();
    if (two_windows) permute_rows<true>(pair_masks(work), pairs, rows, to, work.stride);
    else permute_rows<false>(pair_masks(work), pairs, rows, to, work.stride);
  } else if (Kind != filter::trilinear) {
    draw_levels<rounded::at_once>(work, row, two_windows);
  } else if (row.fraction == 0) {
    draw_levels<rounded::after_level>(work, row, two_windows);
  } else {
    draw_levels<rounded::between_levels>(work, row, two_windows);
  }
}
