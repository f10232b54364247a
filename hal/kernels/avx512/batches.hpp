// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: a row's batches, planned, placed and drawn one after another. Included by by_blocks.hpp alone.
#pragma once

// Whether quads of the row's span k take, on level 0, more texels across than two blocks hold wherever they begin: their three pixels are more than 7 texels.
// Of colours as coded, a span below that takes five sixths from local memory of what it takes by rows; beyond, what is planned in vain takes up to half as much again. `unknown`: spans
// behind the viewer, and those that a plan could not tell either.
enum class unknown : bool { held, beyond };
bool beyond_sections(const row_work& work, int k, unknown taken_for) {
  const plane& p = *work.map;
  const int32_t cx = 2 * span_side * (work.sx + k) + span_side, cy = 2 * span_side * work.sy + span_side;
  const int64_t w = p.value(p.w, cx, cy);
  if (w <= 0) return taken_for == unknown::beyond;
  const auto beyond = [&](const linear_form& f) {
    const int64_t base = p.value(f, cx, cy) / w;
    if (magnitude(base) > 32767) return taken_for == unknown::beyond;
    return magnitude(f.x - base * p.w.x) + magnitude(f.y - base * p.w.y) > uint64_t(w / 6 * 7);  // a pixel is two steps
  };
  return beyond(p.u) || beyond(p.v);
}

// Plans of spans of a row that are left, so that they need no other; aniso.
struct left_plans {
  bool known[max_row_spans] = {};
  span_coefficients of[max_row_spans];

  void keep(const row_work& work, const batch& b, int k) {
    known[b.first + k] = true;
    span_coefficients& c = of[b.first + k];
    c.base_u = b.origin_u[k]; c.base_v = b.origin_v[k];
    c.c_u = b.c_u[k]; c.a_u = b.a_u[k]; c.b_u = b.b_u[k];
    c.c_v = b.c_v[k]; c.a_v = b.a_v[k]; c.b_v = b.b_v[k];
    c.g = b.g[k]; c.h = b.h[k];
    c.axis.c_u = b.axis[0][k]; c.axis.a_u = b.axis[1][k]; c.axis.b_u = b.axis[2][k];
    c.axis.c_v = b.axis[3][k]; c.axis.a_v = b.axis[4][k]; c.axis.b_v = b.axis[5][k];
    c.axis.area_log2 = int16_t(b.area_log2[k] >> (16 - level_term_bits));
    c.axis.exponent = int8_t(b.axis_exponent[k]);
    c.exponent = int8_t(b.exponent[k]);
    c.slope_log2 = int8_t(b.slope_log2[k]);
    c.last_level = uint8_t(work.last_level);
    c.how = b.terms[k] == 0 ? evaluation::affine : b.terms[k] == divide_terms ? evaluation::divide : evaluation::series;
    c.terms = uint8_t(b.terms[k]);
  }
};
struct no_plans {
  void keep(const row_work&, const batch&, int) {}
};
template <filter Kind>
using plans_of_left = std::conditional_t<uses_footprint(Kind), left_plans, no_plans>;

// Batches of a row. Bilinear leaves the spans of those that are not worth a plan; whether there may be some is seen at the row's ends, since minification grows
// towards one of them as a rule.
class batch_order {
 public:
  batch_order(const row_work& work, filter kind)
      : work_(work), some_beyond_(kind == filter::bilinear && (beyond_sections(work, 0, unknown::beyond) || beyond_sections(work, work.count - 1, unknown::beyond))) {}

  // The first one from span `first` on; spans before it are left.
  int next(int first) const {
    if (!some_beyond_) return first;
    for (; first < work_.count; first += batch_size) {
      const int end = min_of(first + batch_size, work_.count);
      if (!beyond_sections(work_, (first + end) / 2, unknown::held)) break;
      for (int k = first; k < end; ++k) work_.left[k] = work_.masks[k] != 0;
    }
    return first;
  }

 private:
  const row_work& work_;
  const bool some_beyond_;
};

// The batch from span `first` of the row on, planned in parts, between which there is something else to do.
template <filter Kind>
struct next_batch {
  const row_work& work;
  const batch_steps& steps;
  setup& s;
  const int first;
  batch& b;

  SPANTEX_INLINE void part(int k) {
    if (first >= work.count) return;
    if (k == 0) {
      b.sx = work.sx + first;
      b.first = first;
    }
    plan_part<Kind>(k, work, steps, s, b);
  }
};

// A batch's spans that are wanted and planned, bit k for span k; others that are wanted are left.
SPANTEX_INLINE uint32_t spans_of(const row_work& work, const batch& b) {
  const __mmask8 in_row = __mmask8((1u << min_of(batch_size, work.count - b.first)) - 1);
  const v8 masks = _mm512_maskz_loadu_epi64(in_row, work.masks + b.first);
  const uint32_t wanted = _mm512_test_epi64_mask(masks, masks), unusable = wanted & ~b.usable;
  if (unusable != 0) [[unlikely]]
    for (int k = 0; k < batch_size; ++k)
      if (unusable >> k & 1) work.left[b.first + k] = true;
  return wanted & b.usable;
}

// One after another.
template <filter Kind, texel_kind Texels>
SPANTEX_INLINE void draw_batch(const row_work& work, const batch& b, uint32_t spans, next_batch<Kind>& next, plans_of_left<Kind>& left) {
  bool held = true;  // a span after one that local memory does not hold is left as well: it is like it as a rule
  for (int k = 0; k < batch_size; ++k) {
    if (k < plan_parts) next.part(k);
    if (!(spans >> k & 1)) continue;
    if constexpr (Kind == filter::bilinear) held = held && draw_bilinear<Texels>(work, b, k);
    else held = held && draw_aniso<Texels>(work, b, k);
    if (held) continue;
    work.left[b.first + k] = true;
    left.keep(work, b, k);
  }
}

// W is constant.
SPANTEX_INLINE bool faces_the_viewer(const row_work& work) { return work.map->w.x == 0 && work.map->w.y == 0; }

// What levels a batch's spans take, a bit a span.
struct batch_levels {
  __m256i level;        // the least, as of a span's first pixel where that tells (to_whole)
  uint32_t scaled;      // some pixel takes from a level whose sides do not halve exactly
  uint32_t alike;       // all take from one whole level
  uint32_t alone;       // and none from the next
  uint32_t crossing;    // all take from the whole level and the next
};

// Positions and levels of the spans' pixels. Step by step: a step is a chain of dependent operations, and those of the other spans fill its gaps.
template <bool TwoLevels>
SPANTEX_INLINE batch_levels find_levels(const row_work& work, const batch& b, uint32_t spans, span_pixels (&of)[batch_size]) {
  span_lengths lengths;
  batch_levels l{};
  lengths_of(b, spans & ~b.magnified, lengths);
  const bool some_unlike = work.texels->levels_in_rows().exact_count() <= work.last_level;
  for (int k = 0; k < batch_size; ++k) {
    __m128i least = _mm_setzero_si128();
    bool all_alike = true, all_alone = true, next_too = false;
    if ((spans & b.magnified) >> k & 1) {
      take(offsets_of<quad_form, true>(b, k), of[k]);  // their levels, all 0, are read of those alone that are drawn by themselves
    } else if (spans >> k & 1) {
      b.slope_log2[k] > most_level_slope_log2 ? find_pixels<true>(b, k, lengths, of[k]) : find_pixels<false>(b, k, lengths, of[k]);
      least = settle<TwoLevels>(of[k].level, work.last_level, all_alike, all_alone);
      if (some_unlike) l.scaled |= uint32_t(on_unlike_levels<TwoLevels>(*work.texels, of[k].level)) << k;
      if (!all_alike) [[unlikely]] least = least_level_of<TwoLevels>(of[k].level, next_too);
    }
    l.level = _mm256_alignr_epi32(_mm256_castsi128_si256(least), l.level, 1);
    l.alike |= uint32_t(all_alike) << k;
    l.alone |= uint32_t(all_alone) << k;
    l.crossing |= uint32_t(next_too) << k;
  }
  return l;
}

// The same of planes that face the viewer.
template <bool TwoLevels>
SPANTEX_INLINE batch_levels find_facing_levels(const row_work& work, const batch& b, uint32_t spans, span_pixels (&of)[batch_size]) {
  const __m256i level = levels_of_facing(b, work.last_level);
  alignas(32) int32_t each[batch_size];
  put(each, level);
  for (int k = 0; k < batch_size; ++k) {
    if (!(spans >> k & 1)) continue;
    take(offsets_of<quad_form, true>(b, k), of[k]);
    for (v16& same : of[k].level) same = set32(each[k]);
  }
  const uint32_t all = (1u << batch_size) - 1;
  const uint32_t scaled = spans & _mm256_cmpgt_epi32_mask(level, _mm256_set1_epi32(last_like_level<TwoLevels>(*work.texels)));
  const uint32_t alone = TwoLevels ? _mm256_testn_epi32_mask(level, _mm256_set1_epi32((1 << q.level_bits) - 1)) : all;
  return {_mm256_add_epi32(level, _mm256_set1_epi32(to_whole<TwoLevels>)), scaled, all, alone, 0};
}

template <filter Kind, texel_kind Texels>
SPANTEX_INLINE void draw_batch_on_levels(const row_work& work, const batch& b, uint32_t spans, next_batch<Kind>& next) {
  constexpr bool two = Kind == filter::trilinear;
  alignas(64) span_pixels of[batch_size];
  const bool some_unmagnified = (spans & ~b.magnified) != 0;
  const auto [level, scaled, alike, alone, crossing] = some_unmagnified && faces_the_viewer(work) ? find_facing_levels<two>(work, b, spans, of) : find_levels<two>(work, b, spans, of);
  batch_places places;
  const __m256i whole = _mm256_srai_epi32(level, q.level_bits);
  place_spans<two>(work, b, spans & ~scaled & (alike | crossing), alone, crossing, whole, places);
  scaled_places others;
  if (scaled != 0) [[unlikely]] place_scaled_spans<two>(work, b, spans & scaled & alike, alone, whole, others);
  for (int k = 0; k < batch_size; ++k) {
    if (k < plan_parts) next.part(k);
    if (places.placed >> k & 1) blend_placed<two, Texels>(work, b, k, alone >> k & 1, crossing >> k & 1, of[k], places);
  }
  spans &= ~places.placed;
  for (int k = 0; spans >> k != 0; ++k) {
    if (!(spans >> k & 1)) continue;
    if (others.placed >> k & 1) {
      blend_scaled<two, Texels>(work, b, k, alone >> k & 1, of[k], others);
      continue;
    }
    if (b.magnified >> k & 1)
      for (v16& each : of[k].level) each = _mm512_setzero_si512();
    work.left[b.first + k] = !draw_by_itself<two, Texels>(work, b, k, scaled >> k & 1, of[k]);
  }
}

// A batch is drawn while the next one is planned.
template <filter Kind, texel_kind Texels>
void draw_batches(const row_work& work, plans_of_left<Kind>& left) {
  const batch_order order(work, Kind);
  int planned = order.next(0);
  if (planned >= work.count) return;  // without an operation of 512 bits: what draws the row instead is slower after one
  const batch_steps steps(*work.map);
  batch two[2];
  setup s;
  uint32_t spans = 0;  // of the batch that is drawn: none while the row's first one is planned
  for (int turn = 0;; turn ^= 1) {
    const batch& b = two[turn];
    next_batch<Kind> next{work, steps, s, planned, two[turn ^ 1]};
    if constexpr (uses_levels(Kind) && !uses_footprint(Kind)) draw_batch_on_levels<Kind, Texels>(work, b, spans, next);
    else draw_batch<Kind, Texels>(work, b, spans, next, left);
    if (planned >= work.count) return;
    spans = spans_of(work, next.b);
    planned = order.next(planned + batch_size);
  }
}

// What local memory does not hold is drawn from the map's rows.
template <filter Kind>
void draw_left(const row_work& work, const plans_of_left<Kind>& left, const row_reader& reader) {
  if (next_left(work.left, work.left + work.count) == nullptr) return;
  span_mask rest[max_row_spans];
  int from = work.count, to = 0;
  for (int k = 0; k < work.count; ++k) {
    if constexpr (uses_footprint(Kind))
      if (left.known[k]) work.left[k] = !reader.planned_aniso(work, k, left.of[k]);
    rest[k] = work.left[k] ? work.masks[k] : 0;
    if (!work.left[k]) continue;
    work.left[k] = false;
    from = min_of(from, k);
    to = k + 1;
  }
  if (from >= to) return;
  row_work more = work;
  more.sx += from;
  more.count = to - from;
  more.masks = rest + from;
  more.left += from;
  reader.any_row(more);
}
