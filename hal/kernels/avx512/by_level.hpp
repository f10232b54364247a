// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: spans on their levels of detail. Included by by_blocks.hpp alone.
#pragma once

// A span whose quads' sections are placed from its pixels.
struct level_span {
  template <held_in Fine> static constexpr held_in after = Fine == held_in::shallow ? held_in::shallow : held_in::narrow;  // texels of the levels after the fine one
  SPANTEX_INLINE int32_t first_of(int n) const { return first_level[n]; }
  span_pixels* pixels;
  int bits;                           // of the offsets
  uint32_t half;
  snapping at;
  scaling scaled[3];                  // instead of it, of the fine level, the coarse one and the next
  span_sections fine, coarse, next;
  int32_t first_level[quads];         // the least of each quad's pixels
  uint32_t fit;                       // bit n: quad n's sections are here
  bool crossing;                      // some quad's pixels lie on two whole levels: they take from three
  held_in fine_in;
  bool one_level;                     // no pixel takes anything from its coarse level
};

// A span that place_spans() placed; After: of coarser levels so much is read.
template <held_in After>
struct placed_span {
  const span_pixels* pixels;
  const batch_places& at;
  int k;
  static constexpr uint32_t fit = 0xF;
  template <held_in> static constexpr held_in after = After;
  SPANTEX_INLINE int32_t first_of(int) const { return at.level[k]; }
};

// A span that place_scaled_spans() placed.
struct placed_scaled_span {
  const span_pixels* pixels;
  const scaled_places& at;
  int k;
  static constexpr uint32_t fit = 0xF;
  template <held_in> static constexpr held_in after = held_in::shallow;
};

// Whole levels of pixels.
template <bool TwoLevels>
SPANTEX_INLINE v16 whole_of(v16 level) {
  if constexpr (TwoLevels) return _mm512_srai_epi32(level, 8);
  else return _mm512_srai_epi32(_mm512_add_epi32(level, of32<to_whole<false>>()), 8);
}

// What is added to a level's colour, 14 and more bits of fraction: texels are signed, so 128 as well as what rounds; of one that is packed next, alpha.
template <bool TwoLevels>
SPANTEX_INLINE v16 rounding_of(bool with_alpha) {
  constexpr int32_t of_one = (128 << (14 + up_of_one)) + before_even, of_two = (128 << (14 + up_between)) + (1 << 7);
  if constexpr (TwoLevels) return of32<of_two>();
  return with_alpha ? of32<opaque + of_one>() : of32<of_one>();
}

// Of the quads' first pixels, four times over.
SPANTEX_INLINE v16 of_quads(const v16 (&x)[quads]) {
  const v16 first = _mm512_setr_epi32(0, 16, 0, 16, 0, 16, 0, 16, 0, 16, 0, 16, 0, 16, 0, 16);
  return _mm512_unpacklo_epi64(_mm512_permutex2var_epi32(x[0], first, x[1]), _mm512_permutex2var_epi32(x[2], first, x[3]));
}

// Of each quad's lanes, four times over.
constexpr auto smaller = [](v16 a, v16 b) SPANTEX_INLINED { return _mm512_min_epi32(a, b); };
constexpr auto larger = [](v16 a, v16 b) SPANTEX_INLINED { return _mm512_max_epi32(a, b); };
template <auto Of>
SPANTEX_INLINE v16 of_each_quad(const v16 (&x)[quads]) {
  const auto two = [](v16 a, v16 b) SPANTEX_INLINED { return Of(_mm512_unpacklo_epi32(a, b), _mm512_unpackhi_epi32(a, b)); };
  const v16 left = two(x[0], x[1]), right = two(x[2], x[3]), rows = Of(_mm512_unpacklo_epi64(left, right), _mm512_unpackhi_epi64(left, right));
  const v16 pairs = Of(rows, _mm512_shuffle_i32x4(rows, rows, 0x4E));
  return Of(pairs, _mm512_shuffle_i32x4(pairs, pairs, 0xB1));
}

// The texels of the quads' levels that the ends need, where sides do not halve exactly: reach is from the origin. turns: the whole periods of the map
// before the base, which are as many of the level's (of a side that has become 1 they may be others, but there all texels are one).
SPANTEX_INLINE v16 scale_ends(const planar_map& map, v16 reach, v16 level, v16 turns, scaling& s) {
  const planar_levels& texels = map.levels();
  const level_scale scale(of_levels(level, texels.ratio_u, texels.ratio_v), level, _mm512_mullo_epi32(turns, of_levels(level, texels.period_u, texels.period_v)));
  put(s.ratio, _mm512_castsi512_si256(scale.ratio));
  put(s.from, _mm512_castsi512_si256(scale.rounding_from()));
  put(s.drop, _mm512_castsi512_si256(scale.drop));
  return _mm512_add_epi32(scale.texel(reach), one_at_last_ends());
}

// Where the levels of a span's quads lie in the map. `crossing`: some quad's pixels have two whole levels. Scaled: u and v are from the origin, s15.16, and
// turns as above.
template <bool TwoLevels, bool Scaled = false>
SPANTEX_INLINE void place(const planar_map& map, int32_t last_level, int32_t base_u, int32_t base_v, v16 reach, level_span& s, v16 turns = v16{}) {
  const v16 last = set32(last_level);
  const v16 (&detail)[quads] = s.pixels->level;
  const v16 whole[quads] = {whole_of<TwoLevels>(detail[0]), whole_of<TwoLevels>(detail[1]), whole_of<TwoLevels>(detail[2]), whole_of<TwoLevels>(detail[3])};
  const auto first_of = [](v16 x) { return _mm512_broadcastd_epi32(_mm512_castsi512_si128(x)); };
  const auto differs = [&](int n) { return _mm512_cmpneq_epi32_mask(whole[n], first_of(whole[n])); };
  const auto further = [&](v16 level) { return _mm512_min_epi32(_mm512_add_epi32(level, of32<1>()), last); };
  v16 fine_level = of_quads(whole);
  s.crossing = (differs(0) | differs(1) | differs(2) | differs(3)) != 0;
  if (s.crossing) [[unlikely]] fine_level = of_each_quad<smaller>(whole);
  const v16 coarse_level = further(fine_level);
  _mm_store_si128(reinterpret_cast<__m128i*>(s.first_level), _mm512_castsi512_si128(fine_level));
  if constexpr (!Scaled) {
    shorten(last_level, s.pixels->u, s.pixels->v, s.bits, s.half);
    s.at.take_two(s.bits, s.half, base_u, base_v, _mm256_set_m128i(_mm512_castsi512_si128(coarse_level), _mm512_castsi512_si128(fine_level)));
  }
  const auto find = [&]<bool Broad>(v16 level, int after, span_sections& out) SPANTEX_INLINED {
    find_sections<Broad>(map, Scaled ? scale_ends(map, reach, level, turns, s.scaled[after]) : end_texels(reach, level), level, out);
    const __m128i column = _mm_srai_epi32(four(out.shift), 3), row = four(out.row);
    Scaled ? s.scaled[after].begin_at(column, row) : s.at.begin_at(column, row, after);
  };
  find.template operator()<true>(fine_level, 0, s.fine);
  s.fit = s.fine.fit;
  bool deep = s.fine.deep;
  s.one_level = TwoLevels && !s.crossing && _mm512_test_epi32_mask(_mm512_or_si512(_mm512_or_si512(detail[0], detail[1]), _mm512_or_si512(detail[2], detail[3])), of32<255>()) == 0;
  if (!s.one_level && (TwoLevels || s.crossing)) {
    find.template operator()<false>(coarse_level, 1, s.coarse);
    s.fit &= s.coarse.fit;
    deep |= s.coarse.deep;
  }
  s.fine_in = s.fine.broad ? held_in::full : deep ? held_in::narrow : held_in::shallow;
  if (!s.crossing) [[likely]] return;
  if constexpr (TwoLevels) {
    const v16 next_level = further(coarse_level);
    if constexpr (!Scaled) s.at.take_next(s.bits, s.half, base_u, base_v, _mm512_castsi512_si128(next_level));
    find.template operator()<false>(next_level, 2, s.next);
    s.fit &= s.next.fit;
    if (s.next.deep && s.fine_in == held_in::shallow) s.fine_in = held_in::narrow;
  }
  for (int n = 0; n < quads; ++n)
    if (_mm512_cmpgt_epi32_mask(whole[n], set32(s.first_level[n] + 1)) != 0) s.fit &= ~(1u << n);
}

// The whole periods before a span's base, in the lanes of either axis.
SPANTEX_INLINE v16 turns_of(const planar_map& map, const batch& b, int k) {
  const auto turns = [](int32_t origin, int32_t base, int32_t period) { return period == 0 ? 0 : (origin - base) / period; };
  return _mm512_mask_mov_epi32(set32(turns(b.origin_u[k], b.base_u[k], map.period_u())), of_v, set32(turns(b.origin_v[k], b.base_v[k], map.period_v())));
}

// What is on levels whose sides do not halve exactly: positions from the origin.
template <bool TwoLevels>
SPANTEX_INLINE void place_scaled_span(const row_work& work, const batch& b, int k, level_span& s) {
#pragma GCC unroll 4
  for (int n = 0; n < quads; ++n) {
    v16 &u = s.pixels->u[n], &v = s.pixels->v[n];
    const texels16 p = texels_of({u, v, b.origin_u[k], b.origin_v[k], s.bits, s.half});
    u = p.u;
    v = p.v;
  }
  place<TwoLevels, true>(*work.texels, work.last_level, 0, 0, reach_of(s.pixels->u, s.pixels->v, 16, 0, 0, b.how), s, turns_of(*work.texels, b, k));
}

// What a span's quads take: one level, no pixel any other; or as many as the filter takes; or one more, as some quad's pixels lie on two whole levels.
enum class taken : uint8_t { one, all, more };

// What all quads of a span take; More as sampling's.
template <bool TwoLevels, int More = 0>
struct blending {
  const uint8_t* blocks;
  sampling<TwoLevels ? up_between : up_of_one, More> from;
  colouring as;
  v16 rounding, of_last;  // of channels, and of one that has alpha
  SPANTEX_INLINE explicit blending(const uint8_t* of) : blocks(of), rounding(rounding_of<TwoLevels>(false)), of_last(rounding_of<TwoLevels>(true)) {}

  template <held_in Where, int Channels>
  SPANTEX_INLINE void blended(const quad_section<Where>& at, const samples& s, v16 (&out)[Channels]) const { blended16(at, s, rounding, out, of_last); }
};

// The same in linear light.
template <light::rounds What, int More = 0>
struct light_blending {
  const uint8_t* blocks;
  sampling<light::up_of(What), More> from;
  light::constants<What> as;
  SPANTEX_INLINE explicit light_blending(const uint8_t* of) : blocks(of) {}

  template <held_in Where, int Channels>
  SPANTEX_INLINE void blended(const quad_section<Where>& at, const samples& s, v16 (&out)[Channels]) const { light::blended(as, at, s, out); }
};

// Positions on the level that lies so many after the fine one.
template <bool Scaled, int After, int Up>
SPANTEX_INLINE v16 snapped_on(const level_span& s, const sampling<Up>& c, v16 u, v16 v, int n) {
  if constexpr (Scaled) return s.scaled[After].at(c, u, v, n);
  else return s.at.at(c, u, v, n + After * quads);
}
template <bool Scaled, int After, int Up, held_in Coarser>
SPANTEX_INLINE v16 snapped_on(const placed_span<Coarser>& s, const sampling<Up, batch_places::more_bits>& c, v16 u, v16 v, int n) {
  static_assert(After == 0 && !Scaled);
  const batch_places& p = s.at;
  return snapped_by(c, u, v, p.from_u[n][s.k], p.from_v[n][s.k], p.drop[s.k], p.turn[s.k]);
}

template <bool Scaled, int After, int Up>
SPANTEX_INLINE v16 snapped_on(const placed_scaled_span& s, const sampling<Up>& c, v16 u, v16 v, int n) {
  return s.at.on[After].at(c, u, v, s.k, n);
}

// Those of a quad where they are known on the fine level.
template <bool Scaled, int After, class C>
SPANTEX_INLINE v16 snapped_after(const level_span& s, const C& c, v16, int n) { return snapped_on<Scaled, After>(s, c, s.pixels->u[n], s.pixels->v[n], n); }
template <bool Scaled, int After, class C>
SPANTEX_INLINE v16 snapped_after(const placed_scaled_span& s, const C& c, v16, int n) { return snapped_on<Scaled, After>(s, c, s.pixels->u[n], s.pixels->v[n], n); }
template <bool Scaled, int After, class C, held_in Coarser>
SPANTEX_INLINE v16 snapped_after(const placed_span<Coarser>& s, const C&, v16 fine, int n) {
  if constexpr (After == 1) return _mm512_avg_epu16(fine, set32(s.at.to_coarse[n][s.k]));
  else return _mm512_srli_epi16(_mm512_add_epi16(fine, set32(s.at.to_next[n][s.k])), After);
}

// Their sections.
template <int After, held_in Where>
SPANTEX_INLINE auto section_after(const uint8_t* blocks, const level_span& s, int n) { return section_of<Where>(blocks, After == 0 ? s.fine : After == 1 ? s.coarse : s.next, n); }
template <int After, held_in Where, held_in Coarser>
SPANTEX_INLINE auto section_after(const uint8_t* blocks, const placed_span<Coarser>& s, int n) { return section_of<Where>(blocks, After == 0 ? s.at.fine : After == 1 ? s.at.coarse : s.at.next, s.k, n); }
template <int After, held_in Where>
SPANTEX_INLINE auto section_after(const uint8_t* blocks, const placed_scaled_span& s, int n) { return section_of<Where>(blocks, s.at.on[After].sections, s.k, n); }

// How a span's quads are blended; Blending: one of the two. Whether the fine sections are as narrow as the coarse ones is much the same from one span to the next.
template <class Blending, bool TwoLevels, taken Levels, held_in Fine, bool Scaled>
struct level_blender : Blending {
  using Blending::blocks, Blending::from;
  SPANTEX_INLINE explicit level_blender(const uint8_t* of) : Blending(of) {}

  // A quad's positions on its fine level, and what is fetched there.
  struct begun { v16 at; samples fine; };
  template <class Span>
  SPANTEX_INLINE begun begin(const Span& s, int n) const {
    const v16 at = snapped_on<Scaled, 0>(s, from, s.pixels->u[n], s.pixels->v[n], n);
    return {at, samples16<Fine>(from, at)};
  }

  // Its colours on the levels that it takes; in the midst there is time for something else.
  template <class Span, int Channels>
  SPANTEX_INLINE void on_levels(const Span& s, int n, const begun& now, auto&& meanwhile, v16 (&fine)[Channels], v16 (&coarse)[Channels]) const {
    this->blended(section_after<0, Fine>(blocks, s, n), now.fine, fine);
    if constexpr (Levels == taken::more || (TwoLevels && Levels == taken::all)) blended_on<1>(s, n, now.at, coarse);
    meanwhile();
    if constexpr (Levels == taken::more) {
      const __mmask16 second = _mm512_cmpneq_epi32_mask(whole_of<TwoLevels>(s.pixels->level[n]), set32(s.first_of(n)));
#pragma GCC unroll 4
      for (int m = 0; m < Channels; ++m) fine[m] = _mm512_mask_mov_epi32(fine[m], second, coarse[m]);
      if constexpr (TwoLevels) {
        v16 next[Channels];
        blended_on<2>(s, n, now.at, next);
#pragma GCC unroll 4
        for (int m = 0; m < Channels; ++m) coarse[m] = _mm512_mask_mov_epi32(coarse[m], second, next[m]);
      }
    }
  }

 private:
  // On the level that lies so many after the fine one.
  template <int After, class Span, int Channels>
  SPANTEX_INLINE void blended_on(const Span& s, int n, v16 at, v16 (&out)[Channels]) const {
    constexpr held_in where = Span::template after<Fine>;
    this->blended(section_after<After, where>(blocks, s, n), samples16<where>(from, snapped_after<Scaled, After>(s, from, at, n)), out);
  }
};

template <bool TwoLevels, taken Levels, texel_kind Texels, held_in Fine, bool Scaled = false, int More = 0>
struct quad_blender : level_blender<blending<TwoLevels, More>, TwoLevels, Levels, Fine, Scaled> {
  using on_levels_of = level_blender<blending<TwoLevels, More>, TwoLevels, Levels, Fine, Scaled>;
  using on_levels_of::as;
  static constexpr bool in_light = false;
  static constexpr int channels = Texels.channels;
  SPANTEX_INLINE explicit quad_blender(const uint8_t* of) : on_levels_of(of) {}

  // A quad's pixels.
  template <class Span>
  SPANTEX_INLINE v16 finished(const Span& s, int n, const typename on_levels_of::begun& now, auto&& meanwhile) const {
    v16 fine[channels], coarse[channels];
    this->on_levels(s, n, now, meanwhile, fine, coarse);
    const v16 weights = as.level_weights(s.pixels->level[n]);
#pragma GCC unroll 4
    for (int m = 0; m < channels; ++m) {
      const v16 half = as.template rounding_of<channels>(m);
      fine[m] = !TwoLevels ? as.even(fine[m]) : Levels == taken::one ? as.on_one_level(fine[m], half) : as.between_levels(fine[m], coarse[m], weights, half);
    }
    return as.packed(fine);
  }
};

template <bool TwoLevels, texel_kind Texels>
constexpr light::rounds light_rounds = Texels.colours == colours_as::samples_in_light ? light::rounds::samples : TwoLevels ? light::rounds::two : light::rounds::one;

template <bool TwoLevels, taken Levels, texel_kind Texels, held_in Fine, bool Scaled = false, int More = 0>
struct light_blender : level_blender<light_blending<light_rounds<TwoLevels, Texels>, More>, TwoLevels, Levels, Fine, Scaled> {
  using on_levels_of = level_blender<light_blending<light_rounds<TwoLevels, Texels>, More>, TwoLevels, Levels, Fine, Scaled>;
  using on_levels_of::as;
  SPANTEX_INLINE explicit light_blender(const uint8_t* of) : on_levels_of(of) {}
  static constexpr bool in_light = true;
  static constexpr int channels = Texels.channels;

  // A quad's numbers.
  template <class Span>
  SPANTEX_INLINE void finished(const Span& s, int n, const typename on_levels_of::begun& now, auto&& meanwhile, v16 (&fine)[channels]) const {
    v16 coarse[channels];
    this->on_levels(s, n, now, meanwhile, fine, coarse);
    const v16 fraction = light::fraction_of(s.pixels->level[n]);
    constexpr bool one = Levels == taken::one;
#pragma GCC unroll 4
    for (int m = 0; m < channels; ++m) {
      if constexpr (!TwoLevels) fine[m] = as.even(fine[m]);
      else if constexpr (Texels.colours == colours_as::samples_in_light) fine[m] = light::of_samples(as, one ? light::sample_of(fine[m]) : light::sample_between(fine[m], coarse[m], fraction));
      else fine[m] = one ? light::of_one_level(as, fine[m]) : light::between(as, fine[m], coarse[m], fraction);
    }
  }
};

template <bool TwoLevels, taken Levels, texel_kind Texels, held_in Fine, bool Scaled = false, int More = 0>
using blender_of = std::conditional_t<Texels.in_light(), light_blender<TwoLevels, Levels, Texels, Fine, Scaled, More>, quad_blender<TwoLevels, Levels, Texels, Fine, Scaled, More>>;

// All of a span. No function is called here: it would take the constants out of their registers.
template <class Blender, class Span>
SPANTEX_INLINE void write_quads(const uint8_t* blocks, const Span& s, cut how, rgba8* row, int64_t stride) {
  Blender blended(blocks);
  v16 columns[quads];  // tall ones
  auto now = blended.begin(s, 0);  // one quad is begun while another's colours are waited for
#pragma GCC unroll 1
  for (int n = 0; n < quads; n += 2) {
    auto next = now;
    const v16 first = blended.finished(s, n, now, [&]() SPANTEX_INLINED { next = blended.begin(s, n + 1); });
    const v16 second = blended.finished(s, n + 1, next, [&]() SPANTEX_INLINED {
      if (n + 2 < quads) now = blended.begin(s, n + 2);
    });
    rgba8* const to = row + n * 2 * stride;
    if (how == cut::square) {
      write_half(to, stride, first, second);
    } else if (how == cut::flat) {
      write_rows(to, stride, first);
      write_rows(to + 2 * stride, stride, second);
    } else {
      columns[n] = first;
      columns[n + 1] = second;
    }
  }
  if (how == cut::tall) write_tall(row, stride, columns);
}

template <class Blender, class Span>
SPANTEX_INLINE void blend_quads(const uint8_t* blocks, const Span& s, uint32_t some, v16 (&out)[quads]) {
  Blender blended(blocks);
#pragma GCC unroll 1
  for (int n = 0; n < quads; ++n)
    if (some >> n & 1) out[n] = blended.finished(s, n, blended.begin(s, n), []() SPANTEX_INLINED {});
}

// Quads with pixels in a mask.
SPANTEX_INLINE uint32_t quads_of(span_mask mask, cut how) {
  uint32_t in = 0;
  for (int n = 0; n < quads; ++n) in |= uint32_t((mask & cut_of(how).pixels[n]) != 0) << n;
  return in;
}

// Those of a span that is not wanted whole, or whose quads are not all here. False where one that is wanted is not. Seldom called: inlined it would be in the way of what is.
template <class Blender, class Span>
[[gnu::noinline]] bool blend_some(const row_work& work, const batch& b, int k, Span s) {
  const span_mask mask = work.masks[b.first + k];
  const uint32_t wanted = quads_of(mask, b.how);
  if ((wanted & ~s.fit) != 0) return false;
  v16 out[quads];
  blend_quads<Blender>(work.texels->blocks(), s, wanted, out);
  write(work, b.sx + k, mask, out, b.how);
  return true;
}

// Numbers in upper halves to pixels. Not inlined: there would be a copy of it for each way to blend a span, of which there are many. (Bilinear has few, and would take 2 to 4 % more.)
template <int Channels>
[[gnu::noinline]] void write_coded(const row_work& work, int32_t sx, span_mask mask, const v16 (&number)[quads][Channels], cut how) {
  v16 out[quads];
  light::coded(number, out);
  write(work, sx, mask, out, how);
}

// A span in linear light, where codes are found of all of it at once: quads outside of the mask are blended too, and all of them must be here.
template <class Blender, class Span>
SPANTEX_INLINE bool blend_in_light(const row_work& work, const batch& b, int k, const Span& s) {
  if (s.fit != 0xF) return false;
  Blender blended(work.texels->blocks());
  v16 number[quads][Blender::channels];
  auto now = blended.begin(s, 0);
#pragma GCC unroll 1
  for (int n = 0; n < quads; ++n) {
    auto next = now;
    blended.finished(s, n, now, [&]() SPANTEX_INLINED {
      if (n + 1 < quads) next = blended.begin(s, n + 1);
    }, number[n]);
    now = next;
  }
  write_coded(work, b.sx + k, work.masks[b.first + k], number, b.how);
  return true;
}

// False where a quad's sections are not here.
template <class Blender, class Span>
SPANTEX_INLINE bool blend_span(const row_work& work, const batch& b, int k, const Span& s) {
  if constexpr (Blender::in_light) {
    return blend_in_light<Blender>(work, b, k, s);
  } else if (work.masks[b.first + k] == ~span_mask(0) && s.fit == 0xF) [[likely]] {
    write_quads<Blender>(work.texels->blocks(), s, b.how, first_of_span(work, b.sx + k), work.stride);
    return true;
  } else {
    using given = std::conditional_t<sizeof(Span) <= 32, Span, const Span&>;
    return blend_some<Blender, given>(work, b, k, s);
  }
}

template <bool TwoLevels, texel_kind Texels, bool Scaled = false>
SPANTEX_INLINE bool blend_span(const row_work& work, const batch& b, int k, const level_span& s) {
  const auto blended = [&]<taken Levels, held_in Fine>() SPANTEX_INLINED {
    return blend_span<blender_of<TwoLevels, Levels, Texels, Fine, Scaled>>(work, b, k, s);
  };
  const auto by_width = [&]<taken Levels>() SPANTEX_INLINED {
    switch (s.fine_in) {
      case held_in::shallow: return blended.template operator()<Levels, held_in::shallow>();
      case held_in::narrow: return blended.template operator()<Levels, held_in::narrow>();
      default: return blended.template operator()<Levels, held_in::full>();
    }
  };
  if (s.crossing) [[unlikely]] return by_width.template operator()<taken::more>();
  return s.one_level ? by_width.template operator()<taken::one>() : by_width.template operator()<taken::all>();
}

// blended, of what span k takes, and of how its fine sections lie.
template <bool TwoLevels>
SPANTEX_INLINE void by_places(const auto& p, int k, bool alone, auto&& blended) {
  const bool deep = p.deep >> k & 1, broad = p.broad >> k & 1;
  const auto by_width = [&]<taken Levels>() SPANTEX_INLINED {
    if (deep) broad ? blended.template operator()<Levels, held_in::full>() : blended.template operator()<Levels, held_in::narrow>();
    else broad ? blended.template operator()<Levels, held_in::broad>() : blended.template operator()<Levels, held_in::shallow>();
  };
  if constexpr (TwoLevels)
    if (!alone) return by_width.template operator()<taken::all>();
  by_width.template operator()<taken::one>();
}

template <bool TwoLevels, texel_kind Texels, taken Levels, held_in Fine, held_in After>
SPANTEX_INLINE void blend_placed(const row_work& work, const batch& b, int k, const span_pixels& pixels, const batch_places& p) {
  blend_span<blender_of<TwoLevels, Levels, Texels, Fine, false, batch_places::more_bits>>(work, b, k, placed_span<After>{&pixels, p, k});
}

// Those that are on two whole levels, have more than sixteen rows of the fine one, or more than eight rows or columns of coarser ones. Seldom called: see blend_some().
template <bool TwoLevels, texel_kind Texels>
[[gnu::noinline]] void blend_rare(const row_work& work, const batch& b, int k, bool alone, bool crossing, const span_pixels& pixels, const batch_places& p) {
  const bool deep = p.deep >> k & 1, high = p.high >> k & 1, broad = p.broad >> k & 1, coarse_broad = p.coarse_broad >> k & 1;
  const auto blended = [&]<taken Levels, held_in Fine, held_in After>() SPANTEX_INLINED { blend_placed<TwoLevels, Texels, Levels, Fine, After>(work, b, k, pixels, p); };
  const auto by_width = [&]<taken Levels>() SPANTEX_INLINED {  // coarser sections are broad where the fine one is, and high nowhere
    if (coarse_broad) blended.template operator()<Levels, held_in::full, held_in::full>();
    else if (high) blended.template operator()<Levels, held_in::high, held_in::narrow>();
    else broad ? blended.template operator()<Levels, held_in::full, held_in::narrow>() : blended.template operator()<Levels, held_in::narrow, held_in::narrow>();
  };
  if (crossing) {
    if (deep || broad) by_width.template operator()<taken::more>();
    else blended.template operator()<taken::more, held_in::shallow, held_in::shallow>();
  } else if (!TwoLevels || alone) {
    blended.template operator()<taken::one, held_in::high, held_in::shallow>();
  } else {
    by_width.template operator()<taken::all>();
  }
}

template <bool TwoLevels, texel_kind Texels>
SPANTEX_INLINE void blend_placed(const row_work& work, const batch& b, int k, bool alone, bool crossing, span_pixels& pixels, const batch_places& p) {
  if (p.excess[k] > 0) [[unlikely]] drop_bits(p.excess[k], pixels.u, pixels.v);
  if (crossing || ((p.coarse_deep | p.coarse_broad | p.high) >> k & 1)) [[unlikely]] return blend_rare<TwoLevels, Texels>(work, b, k, alone, crossing, pixels, p);
  by_places<TwoLevels>(p, k, alone, [&]<taken Levels, held_in Fine>() SPANTEX_INLINED { blend_placed<TwoLevels, Texels, Levels, Fine, held_in::shallow>(work, b, k, pixels, p); });
}

// On levels whose sides do not halve exactly.
template <bool TwoLevels, texel_kind Texels>
[[gnu::noinline]] void blend_scaled(const row_work& work, const batch& b, int k, bool alone, span_pixels& pixels, const scaled_places& p) {
  count_from_origin(b, k, pixels);
  by_places<TwoLevels>(p, k, alone, [&]<taken Levels, held_in Fine>() SPANTEX_INLINED {
    blend_span<blender_of<TwoLevels, Levels, Texels, Fine>>(work, b, k, placed_scaled_span{&pixels, p, k});
  });
}
template <bool TwoLevels, texel_kind Texels>
[[gnu::noinline]] bool draw_at_scaled_levels(const row_work& work, const batch& b, int k, level_span& s) {
  place_scaled_span<TwoLevels>(work, b, k, s);
  return blend_span<TwoLevels, Texels, true>(work, b, k, s);
}

// Pixels whose positions and levels are known.
template <bool TwoLevels, texel_kind Texels>
SPANTEX_INLINE bool draw_at_levels(const row_work& work, const batch& b, int k, level_span& s) {
  place<TwoLevels>(*work.texels, work.last_level, b.base_u[k], b.base_v[k], reach_of(s.pixels->u, s.pixels->v, s.bits, b.base_u[k], b.base_v[k], b.how), s);
  return blend_span<TwoLevels, Texels>(work, b, k, s);
}

// A span that was not placed with those of its batch.
template <bool TwoLevels, texel_kind Texels>
[[gnu::noinline]] bool draw_by_itself(const row_work& work, const batch& b, int k, bool scaled, span_pixels& pixels) {
  level_span s;
  s.pixels = &pixels;
  s.bits = bits_of(b, k);
  s.half = half_of(s.bits);
  return scaled ? draw_at_scaled_levels<TwoLevels, Texels>(work, b, k, s) : draw_at_levels<TwoLevels, Texels>(work, b, k, s);
}
