// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: filter aniso, rows of trilinear samples along each pixel's image (footprint.hpp). Local memory holds what the samples of a quad's pixels
// take together; rows of more than `most_samples` are too long for it as a rule: a span with one is left. Included by by_blocks.hpp alone.
#pragma once

static_assert(q.max_samples == 16 && q.sample_bias == -8, "row_work::most_ratio; finer() as in levels.hpp");

constexpr int most_samples = 4;

// The least ratio of the axes, log2 in 2^-16, that takes so many samples.
constexpr int32_t least_ratio_of(int samples) {
  int32_t fewer = 0, as_many = 4 << 16;
  while (as_many - fewer > 1) {
    const int32_t middle = (fewer + as_many) / 2;
    (spantex::samples_of(q, middle) >= samples ? as_many : fewer) = middle;
  }
  return as_many;
}

// By number of samples n: where the first two lie along a row, and the next two, from its middle, 2^-16 of its length: (n - 1) / 2n, (n - 3) / 2n, of
// floor((2^16 + n) / 2n); ceil(2^14 / n), ceil(2^31 / n).
struct alignas(64) sample_tables {
  int32_t from_middle[most_samples / 2][16], inverse[16], inverse_31[16];
  constexpr sample_tables() : from_middle(), inverse(), inverse_31() {
    for (int n = 1; n <= most_samples; ++n) {
      for (int k = 0; k < most_samples / 2; ++k) from_middle[k][n] = max_of(n - 1 - 2 * k, 0) * ((65536 + n) / (2 * n));
      inverse[n] = ((1 << 14) + n - 1) / n;
      inverse_31[n] = int32_t(uint32_t(((int64_t(1) << 31) + n - 1) / n));
    }
  }
};
constexpr sample_tables of_samples{};

constexpr bool inverses_divide() {
  for (int n = 1; n <= most_samples; ++n)
    for (int x = 0; x <= 255 * n + n / 2; ++x)
      if ((x * of_samples.inverse[n]) >> 14 != x / n) return false;
  return true;
}
static_assert(inverses_divide());
SPANTEX_INLINE v16 look_up(const int32_t (&table)[16], v16 k) { return _mm512_permutexvar_epi32(k, _mm512_load_si512(table)); }

// A span's rows: positions include the base, s15.16 as well as how far samples 2 k and 2 k + 1 lie to either side.
struct row_span : level_span {
  span_pixels own;
  v16 samples[quads];
  v16 along_u[most_samples / 2][quads], along_v[most_samples / 2][quads];
  int most;                           // samples

  SPANTEX_INLINE texels16 sample(int n, int k) const {
    const v16 du = along_u[k / 2][n], dv = along_v[k / 2][n];
    if (k & 1) return {_mm512_add_epi32(own.u[n], du), _mm512_add_epi32(own.v[n], dv)};
    return {_mm512_sub_epi32(own.u[n], du), _mm512_sub_epi32(own.v[n], dv)};
  }
};

// axis_log2().
SPANTEX_INLINE v16 axis_log2_16(v16 u, v16 v, int exponent) {
  const v8 even = squares_of(u, v), odd = squares_of(_mm512_srli_epi64(u, 32), _mm512_srli_epi64(v, 32));
  const v8 even_zeros = _mm512_lzcnt_epi64(even), odd_zeros = _mm512_lzcnt_epi64(odd);
  const v16 bits = _mm512_mask_mov_epi32(_mm512_srli_epi64(_mm512_sllv_epi64(even, even_zeros), 32), 0xAAAA, _mm512_sllv_epi64(odd, odd_zeros));
  const v16 zeros = _mm512_mask_mov_epi32(even_zeros, 0xAAAA, _mm512_slli_epi64(odd_zeros, 32));
  const v16 length = _mm512_add_epi32(_mm512_srli_epi32(log2_of_bits(bits, _mm512_sub_epi32(of32<63>(), zeros)), 1), set32((1 - exponent) * 65536));
  return _mm512_mask_mov_epi32(length, _mm512_cmpeq_epi32_mask(zeros, of32<64>()), of32<-32 * 65536>());
}

// What is found of quads' slopes w - 1, u2.30.
SPANTEX_INLINE void find_of_slopes(const batch& b, int k, const offsets& o, auto&& found, v16 (&out)[quads]) {
  if (b.slope_of != nullptr) {
    const v16 each = found(slope_of(slopes_along(b, k), b.slope_log2[k]));
#pragma GCC unroll 4
    for (int n = 0; n < quads; ++n) out[n] = of_quad(b, n, each);
  } else {
#pragma GCC unroll 4
    for (int n = 0; n < quads; ++n) out[n] = found(slope_of(o.e[n], b.slope_log2[k]));
  }
}

// shape_of() a quad's pixels: levels, and log2 of the ratio of the axes.
SPANTEX_INLINE void shapes_of(v16 nu, v16 nv, v16 log_w, int exponent, int32_t area_log2, const row_work& work, v16& level, v16& ratio) {
  const v16 zero = _mm512_setzero_si512(), length = axis_log2_16(nu, nv, exponent), major = _mm512_sub_epi32(length, _mm512_slli_epi32(log_w, 1));
  const v16 stretch = _mm512_sub_epi32(_mm512_sub_epi32(_mm512_slli_epi32(length, 1), set32(area_log2)), log_w);
  ratio = _mm512_max_epi32(_mm512_min_epi32(_mm512_min_epi32(stretch, major), set32(work.most_ratio)), zero);
  level = detail_of(_mm512_add_epi32(_mm512_sub_epi32(major, ratio), of32<detail_half>()), set32(work.last_level << q.level_bits));
}

SPANTEX_INLINE v16 samples_of(v16 ratio) {
  v16 n = of32<1>();
  n = _mm512_mask_add_epi32(n, _mm512_cmpge_epi32_mask(ratio, of32<least_ratio_of(2)>()), n, of32<1>());
  n = _mm512_mask_add_epi32(n, _mm512_cmpge_epi32_mask(ratio, of32<least_ratio_of(3)>()), n, of32<1>());
  return _mm512_mask_add_epi32(n, _mm512_cmpge_epi32_mask(ratio, of32<least_ratio_of(4)>()), n, of32<1>());
}

// |n| / w^2 in 2^-16 texels, even and odd lanes: both products rounded, then the scale (axis_at()). |n| is at most 2^30 + 7 and 1/w below 1.99, so products fit 32 bits again.
struct lengths32 { v8 even, odd; };
SPANTEX_INLINE lengths32 over_square(v16 n, const reciprocals16& r, int drop) {
  const v16 m = _mm512_abs_epi32(n);
  const v8 half = of64<1 << (q.reciprocal_bits - 1)>(), half_scale = set(int64_t(1) << (drop - 1)), scale = set(drop);
  const auto one = [&](v8 x, v8 y) {
    x = _mm512_srli_epi64(_mm512_add_epi64(_mm512_mul_epu32(x, y), half), q.reciprocal_bits);
    x = _mm512_srli_epi64(_mm512_add_epi64(_mm512_mul_epu32(x, y), half), q.reciprocal_bits);
    return _mm512_srlv_epi64(_mm512_add_epi64(x, half_scale), scale);
  };
  return {one(m, r.even), one(_mm512_srli_epi64(m, 32), r.odd)};
}

// sample_offset(): length m 2^-16, without its sign.
SPANTEX_INLINE v16 along16(const lengths32& length, v16 m) {
  const v8 half = of64<0x8000>();
  const v8 even = _mm512_srli_epi64(_mm512_add_epi64(_mm512_mul_epu32(length.even, m), half), 16);
  const v8 odd = _mm512_slli_epi64(_mm512_add_epi64(_mm512_mul_epu32(length.odd, _mm512_srli_epi64(m, 32)), half), 16);
  return _mm512_mask_mov_epi32(even, 0xAAAA, odd);
}

// mean() of sums with 16 bits of fraction over n samples, halves to even; in bits 16 to 23.
SPANTEX_INLINE v16 mean16(v16 sum, v16 n, v16 inverse) {
  const v16 t = _mm512_add_epi32(sum, _mm512_slli_epi32(n, 15)), whole = _mm512_srli_epi32(_mm512_madd_epi16(_mm512_srli_epi32(t, 16), inverse), 14);
  const __mmask16 tie = _mm512_cmpeq_epi32_mask(_mm512_slli_epi32(_mm512_madd_epi16(whole, n), 16), t);
  return _mm512_slli_epi32(_mm512_mask_andnot_epi32(whole, tie, of32<1>(), whole), 16);
}
// Of one or two samples; `one`: lanes of one.
SPANTEX_INLINE v16 mean_of_two16(v16 sum, __mmask16 one) {
  const v16 t = _mm512_add_epi32(_mm512_mask_add_epi32(sum, one, sum, sum), of32<0xFFFF>());  // of 2^17
  return _mm512_srli_epi32(_mm512_add_epi32(t, _mm512_and_si512(_mm512_srli_epi32(t, 17), of32<1>())), 1);
}

template <int Channels>
SPANTEX_INLINE v16 mean_of(const colouring& as, const row_span& s, int n, v16 (&sum)[Channels]) {
  if (s.most == 2) {
    const __mmask16 one = _mm512_cmpeq_epi32_mask(s.samples[n], of32<1>());
#pragma GCC unroll 4
    for (int m = 0; m < Channels; ++m) sum[m] = mean_of_two16(sum[m], one);
  } else {
    const v16 inverse = look_up(of_samples.inverse, s.samples[n]);
#pragma GCC unroll 4
    for (int m = 0; m < Channels; ++m) sum[m] = mean16(sum[m], s.samples[n], inverse);
  }
  if constexpr (Channels < channel_count) sum[Channels - 1] = _mm512_or_si512(sum[Channels - 1], of32<opaque>());
  return as.packed(sum);
}

// How a span's quads are blended; Blending as level_blender's.
template <class Blending, taken Levels, held_in Fine, bool Scaled>
struct row_sums : Blending {
  using Blending::blocks, Blending::from;
  SPANTEX_INLINE explicit row_sums(const uint8_t* of) : Blending(of) {}

  // A sample's position, and what is fetched on its fine level.
  struct begun { texels16 at; samples fine; };
  SPANTEX_INLINE begun begin(const row_span& s, int n, int k = 0) const {
    const texels16 at = s.sample(n, k);
    return {at, samples16<Fine>(from, snapped_on<Scaled, 0>(s, from, at.u, at.v, n))};
  }

  // Of the quad whose first sample is given; add: a channel's sample to its sum where it is counted. meanwhile as level_blender's.
  template <int Channels>
  SPANTEX_INLINE void add_up(const row_span& s, int n, begun now, auto&& meanwhile, auto&& add, v16 (&sum)[Channels]) const {
#pragma GCC unroll 1
    for (int k = 0; k < s.most; ++k) {
      const texels16 at = now.at;
      v16 fine[Channels], coarse[Channels];
      this->blended(section_after<0, Fine>(blocks, s, n), now.fine, fine);
      if constexpr (Levels == taken::all) {
        asm volatile("" ::: "memory");  // addresses of two levels at once, and sums besides, are more than there are registers
        this->blended(section_after<1, row_span::after<Fine>>(blocks, s, n), samples16<row_span::after<Fine>>(from, snapped_on<Scaled, 1>(s, from, at.u, at.v, n)), coarse);
      }
      if (k + 1 < s.most) now = begin(s, n, k + 1);
      else meanwhile();
      const __mmask16 counted = _mm512_cmpgt_epi32_mask(s.samples[n], set32(k));
#pragma GCC unroll 4
      for (int m = 0; m < Channels; ++m) add(sum[m], fine[m], Levels == taken::all ? coarse[m] : fine[m], counted);
    }
  }
};

template <taken Levels, texel_kind Texels, held_in Fine, bool Scaled = false>
struct row_blender : row_sums<blending<true>, Levels, Fine, Scaled> {
  using sums_of = row_sums<blending<true>, Levels, Fine, Scaled>;
  using sums_of::as;
  static constexpr bool in_light = false;
  SPANTEX_INLINE explicit row_blender(const uint8_t* of) : sums_of(of) {}

  SPANTEX_INLINE v16 finished(const row_span& s, int n, const typename sums_of::begun& now, auto&& meanwhile) const {
    v16 sum[Texels.channels] = {};
    const v16 weights = as.level_weights(s.own.level[n]);
    this->add_up(s, n, now, meanwhile, [&](v16& to, v16 fine, v16 coarse, __mmask16 counted) SPANTEX_INLINED { to = as.summed(to, fine, coarse, _mm512_maskz_mov_epi32(counted, weights)); }, sum);  // of one level, the other weight is 0
    return mean_of(as, s, n, sum);
  }
};

template <taken Levels, texel_kind Texels, held_in Fine, bool Scaled = false>
struct light_row_blender : row_sums<light_blending<light::rounds::samples>, Levels, Fine, Scaled> {
  using sums_of = row_sums<light_blending<light::rounds::samples>, Levels, Fine, Scaled>;
  using sums_of::as;
  SPANTEX_INLINE explicit light_row_blender(const uint8_t* of) : sums_of(of) {}
  static constexpr bool in_light = true;
  static constexpr int channels = Texels.channels;

  SPANTEX_INLINE void finished(const row_span& s, int n, const typename sums_of::begun& now, auto&& meanwhile, v16 (&sum)[channels]) const {
    const v16 fraction = light::fraction_of(s.own.level[n]), number = s.samples[n];
    for (v16& each : sum) each = _mm512_setzero_si512();
    this->add_up(s, n, now, meanwhile, [&](v16& to, v16 fine, v16 coarse, __mmask16 counted) SPANTEX_INLINED {
      to = _mm512_mask_add_epi32(to, counted, to, Levels == taken::one ? light::sample_of(fine) : light::sample_between(fine, coarse, fraction));
    }, sum);
    if (s.most == 2) {
      const __mmask16 one = _mm512_cmpeq_epi32_mask(number, of32<1>());
#pragma GCC unroll 4
      for (v16& each : sum) each = light::of_samples<2>(as, _mm512_mask_add_epi32(each, one, each, each));
    } else {
      const v16 inverse = look_up(of_samples.inverse_31, number);
#pragma GCC unroll 4
      for (v16& each : sum) each = light::mean_of(each, number, inverse);
    }
  }
};

template <taken Levels, texel_kind Texels, held_in Fine, bool Scaled>
SPANTEX_INLINE bool blend_rows(const row_work& work, const batch& b, int k, const row_span& s) {
  return blend_span<std::conditional_t<Texels.in_light(), light_row_blender<Levels, Texels, Fine, Scaled>, row_blender<Levels, Texels, Fine, Scaled>>>(work, b, k, s);
}

// Rows of pixels whose shapes are known; nu, nv: J times the major axis' direction. False where they are too long.
template <texel_kind Texels, bool Scaled>
SPANTEX_INLINE bool draw_rows(const row_work& work, const batch& b, int k, const offsets& o, const v16 (&nu)[quads], const v16 (&nv)[quads], row_span& s) {
  constexpr int32_t half_of_longest = longest_row << 15;
  const int drop = b.axis_exponent[k] - 17;  // 3 or more
  v16 inverse[quads];
  if (b.terms[k] == 0) {
    for (v16& each : inverse) each = of32<1 << q.reciprocal_bits>();
  } else {
    find_of_slopes(b, k, o, [](v16 slope) SPANTEX_INLINED { return reciprocal16(slope); }, inverse);
  }
  v16 far_u[quads], far_v[quads];
  __mmask16 beyond = 0;
#pragma GCC unroll 1
  for (int n = 0; n < quads; ++n) {
    const reciprocals16 r(inverse[n]);
    const lengths32 u = over_square(nu[n], r, drop), v = over_square(nv[n], r, drop);
    const __mmask16 opposed = _mm512_movepi32_mask(_mm512_xor_si512(nu[n], nv[n]));  // rows are symmetric: only whether their signs are alike matters
    for (int at = 0; 2 * at < s.most; ++at) {
      const v16 m = look_up(of_samples.from_middle[at], s.samples[n]), du = along16(u, m), dv = along16(v, m);
      if (at == 0) {
        far_u[n] = du;
        far_v[n] = dv;
      }
      s.along_u[at][n] = du;
      s.along_v[at][n] = _mm512_mask_sub_epi32(dv, opposed, _mm512_setzero_si512(), dv);
    }
    beyond |= _mm512_cmpgt_epu32_mask(_mm512_or_si512(far_u[n], far_v[n]), of32<half_of_longest - 1>());
    const texels16 p = texels_of({o.u[n], o.v[n], Scaled ? b.origin_u[k] : b.base_u[k], Scaled ? b.origin_v[k] : b.base_v[k], o.bits, o.half});
    s.own.u[n] = p.u;
    s.own.v[n] = p.v;
  }
  if (beyond != 0) return false;
  s.bits = 16;
  s.half = 0;
  const v16 aside = _mm512_mask_mov_epi32(of_each_quad<larger>(far_u), 0xF0F0, of_each_quad<larger>(far_v)), middle = reach_of(s.own.u, s.own.v, 16, 0, 0, b.how);
  const v16 reach = _mm512_mask_add_epi32(_mm512_sub_epi32(middle, aside), 0xFF00, middle, aside);
  static_assert(16 + last_of_several_texels <= 27, "no position is shortened");
  place<true, Scaled>(*work.texels, work.last_level, 0, 0, reach, s, Scaled ? turns_of(*work.texels, b, k) : v16{});
  for (int n = 0; s.crossing && n < quads; ++n)
    if (_mm512_cmpneq_epi32_mask(whole_of<true>(s.own.level[n]), set32(s.first_level[n])) != 0) s.fit &= ~(1u << n);
  const auto by_width = [&]<taken Levels>() SPANTEX_INLINED {
    switch (s.fine_in) {
      case held_in::shallow: return blend_rows<Levels, Texels, held_in::shallow, Scaled>(work, b, k, s);
      case held_in::narrow: return blend_rows<Levels, Texels, held_in::narrow, Scaled>(work, b, k, s);
      default: return blend_rows<Levels, Texels, held_in::full, Scaled>(work, b, k, s);
    }
  };
  return s.one_level ? by_width.template operator()<taken::one>() : by_width.template operator()<taken::all>();
}

template <texel_kind Texels>
[[gnu::noinline]] bool draw_scaled_rows(const row_work& work, const batch& b, int k, const offsets& o, const v16 (&nu)[quads], const v16 (&nv)[quads], row_span& s) {
  return draw_rows<Texels, true>(work, b, k, o, nu, nv, s);
}

template <texel_kind Texels>
SPANTEX_INLINE bool draw_aniso(const row_work& work, const batch& b, int k) {
  const bool flat = b.level >> k & 1;
  row_span span;
  span.pixels = &span.own;
  offsets o = offsets_of<quad_form, true>(b, k);
  v16 log_w[quads] = {};
  if (!flat) find_of_slopes(b, k, o, [](v16 slope) SPANTEX_INLINED { return log2_of_w(slope); }, log_w);
  v16 nu[quads], nv[quads], largest = _mm512_setzero_si512();
  const auto some_take = [&](v16 ratio) SPANTEX_INLINED { return _mm512_cmpge_epi32_mask(largest, ratio) != 0; };
  forms_of(b.axis_u, k, nu);
  forms_of(b.axis_v, k, nv);
#pragma GCC unroll 4
  for (int n = 0; n < quads; ++n) {
    v16 ratio;
    shapes_of(nu[n], nv[n], log_w[n], b.axis_exponent[k], b.area_log2[k], work, span.own.level[n], ratio);
    span.samples[n] = samples_of(ratio);
    largest = _mm512_max_epi32(largest, ratio);
    if (some_take(of32<least_ratio_of(most_samples + 1)>())) return false;
  }
  const bool scaled = on_unlike_levels<true>(*work.texels, span.own.level);
  if (!some_take(of32<least_ratio_of(2)>())) {
    take(o, span.own);
    span.bits = o.bits;
    span.half = o.half;
    return scaled ? draw_at_scaled_levels<true, Texels>(work, b, k, span) : draw_at_levels<true, Texels>(work, b, k, span);
  }
  span.most = some_take(of32<least_ratio_of(4)>()) ? 4 : some_take(of32<least_ratio_of(3)>()) ? 3 : 2;
  return scaled ? draw_scaled_rows<Texels>(work, b, k, o, nu, nv, span) : draw_rows<Texels, false>(work, b, k, o, nu, nv, span);
}
