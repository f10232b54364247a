// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: texture positions of a span's 64 pixels. Included by by_blocks.hpp alone.
#pragma once

// Offsets from the base texel: value 2^-bits, to be rounded by adding half and cutting.
struct offsets { v16 u[quads], v[quads], e[quads]; int bits; uint32_t half; };  // e: 2^-slope_log2 of it

// A span's offsets and levels of detail, 2^-8.
struct span_pixels { v16 u[quads], v[quads], level[quads]; };
SPANTEX_INLINE void take(const offsets& o, span_pixels& p) {
#pragma GCC unroll 4
  for (int n = 0; n < quads; ++n) {
    p.u[n] = o.u[n];
    p.v[n] = o.v[n];
  }
}

// The slope as series take it: in the upper half of each lane, lower half zero.
SPANTEX_INLINE v16 slope16(v16 e) { return _mm512_and_si512(e, upper()); }
SPANTEX_INLINE v16 slope_of(v16 e, int slope_log2) { return _mm512_srav_epi32(e, set32(-slope_log2)); }

// Of what is there, lower half zero.
SPANTEX_INLINE v16 upper_difference(v16 x, v16 y) { return _mm512_maskz_sub_epi16(0xAAAAAAAA, x, y); }

// q of the series, likewise; square: that of e16.
template <int Terms>
SPANTEX_INLINE v16 series16(v16 e16, v16 square, v16 drop) {
  v16 r = e16;
#pragma GCC unroll 4
  for (int k = 1; k < Terms; ++k) r = upper_difference(e16, _mm512_srav_epi32(k == 1 ? square : _mm512_madd_epi16(e16, r), drop));
  return r;
}

SPANTEX_INLINE v16 by_series16(v16 n, v16 r, v16 drop) {
  return _mm512_sub_epi32(n, _mm512_srav_epi32(_mm512_madd_epi16(n, r), drop));
}

// A quad's slopes and their squares.
struct slopes16 {
  v16 e16, square;
  SPANTEX_INLINE explicit slopes16(v16 e) : e16(slope16(e)), square(_mm512_madd_epi16(e16, e16)) {}
};

// 1/w of sixteen pixels, u1.30.
SPANTEX_INLINE v16 reciprocal16(v16 e) {  // reciprocal_of_w(w, 30)
  const v16 w = _mm512_add_epi32(e, of32<1 << 30>()), twice = _mm512_add_epi32(w, w);
  const __mmask16 large = _mm512_cmpge_epu32_mask(w, of32<1 << 30>());
  const v16 m = _mm512_mask_mov_epi32(_mm512_add_epi32(twice, twice), large, twice), seed = reciprocal_seeds16(m);
  const v8 even = newton8(m, _mm512_maskz_mov_epi32(0x5555, seed)), odd = newton8(_mm512_srli_epi64(m, 32), _mm512_srli_epi64(seed, 32));
  const v16 y = _mm512_mask_mov_epi32(even, 0xAAAA, _mm512_slli_epi64(odd, 32));
  const v16 t = _mm512_mask_srli_epi32(y, large, y, 1);
  return _mm512_sub_epi32(t, _mm512_srli_epi32(t, 1));  // (y + 2) >> 2 where large, else (y + 1) >> 1
}

// Those of the even and of the odd lanes, in the lower halves of 64 bits; what is above is anything.
struct reciprocals16 {
  v8 even, odd;
  SPANTEX_INLINE explicit reciprocals16(v16 all) : even(all), odd(_mm512_srli_epi64(all, 32)) {}
};

// n / w with 14 fraction bits, rounded, as for coordinate_bits.
SPANTEX_INLINE v16 by_divide16(v16 n, const reciprocals16& r, v8 shift) {
  const v8 half = _mm512_sllv_epi64(of64<1>(), _mm512_sub_epi64(shift, of64<1>()));
  const auto one = [&](v8 x, v8 y) { return _mm512_srav_epi64(_mm512_add_epi64(_mm512_mul_epi32(x, y), half), shift); };
  const v8 even = one(n, r.even), odd = one(_mm512_srli_epi64(n, 32), r.odd);
  return _mm512_mask_mov_epi32(even, 0xAAAA, _mm512_slli_epi64(odd, 32));
}

// A linear form's values of a span's quads, asked for one after another.
class quad_form {
 public:
  SPANTEX_INLINE quad_form(const batch_forms& f, int k) : right_(f.right[k]), below_(f.below[k]) {
    const auto four = [](const int32_t (&of)[quad_side]) { return _mm_load_si128(reinterpret_cast<const __m128i*>(of)); };
    const v16 rows = _mm512_setr_epi32(0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3);
    left_ = _mm512_add_epi32(_mm512_broadcast_i32x4(four(f.across[k])), _mm512_permutexvar_epi32(rows, _mm512_castsi128_si512(four(f.down[k]))));
  }
  SPANTEX_INLINE v16 of(int n) {
    if (n == 2) left_ = _mm512_add_epi32(left_, set32(below_));
    return n & 1 ? _mm512_add_epi32(left_, set32(right_)) : left_;
  }

 private:
  const int32_t &right_, &below_;
  v16 left_;
};
SPANTEX_INLINE void forms_of(const batch_forms& f, int k, v16 (&out)[quads]) {
  quad_form form(f, k);
#pragma GCC unroll 4
  for (int n = 0; n < quads; ++n) out[n] = form.of(n);
}

// Bits of fraction that a span's offsets have.
SPANTEX_INLINE int bits_of(const batch& b, int k) { return b.terms[k] == divide_terms ? q.coordinate_bits : b.exponent[k]; }
SPANTEX_INLINE uint32_t half_of(int bits) { return bits == q.coordinate_bits ? 0 : 1u << (bits - q.coordinate_bits - 1); }

// All of them first, so that they do not wait for each other: of filters that find no more of each quad than there are registers for.
struct whole_form {
  v16 quad[quads];
  SPANTEX_INLINE whole_form(const batch_forms& f, int k) { forms_of(f, k, quad); }
  SPANTEX_INLINE v16 of(int n) const { return quad[n]; }
};

// What linear forms are divided by, found of their slopes: q of a series; reciprocals.
template <int Terms>
SPANTEX_INLINE v16 divisors_of(const batch& b, int k, v16 e, const slopes16& w) {
  if constexpr (Terms == divide_terms) return reciprocal16(slope_of(e, b.slope_log2[k]));
  else return series16<Terms>(w.e16, w.square, set32(b.series_drop[k]));
}

// Positions have 14 bits of fraction where they are divided.
template <evaluation How>
SPANTEX_INLINE void divide(const batch& b, int k, v16 divisors, v16& u, v16& v) {
  if constexpr (How == evaluation::series) {
    const v16 drop = set32(b.series_drop[k]);
    u = by_series16(u, divisors, drop);
    v = by_series16(v, divisors, drop);
  } else if constexpr (How == evaluation::divide) {
    const reciprocals16 r(divisors);
    const v8 shift = set(b.exponent[k] - q.coordinate_bits + q.reciprocal_bits);
    u = by_divide16(u, r, shift);
    v = by_divide16(v, r, shift);
  }
}

// A span's positions, quad by quad: each_quad(n, u, v, of_slopes(e, slopes)).
template <int Terms, class Form>
SPANTEX_INLINE void evaluate_quads(const batch& b, int k, auto&& of_slopes, auto&& each_quad) {
  Form form_u(b.u, k), form_v(b.v, k), form_e(b.e, k);
#pragma GCC unroll 4
  for (int n = 0; n < quads; ++n) {
    v16 u = form_u.of(n), v = form_v.of(n);
    const v16 e = form_e.of(n);
    const slopes16 w(e);
    if constexpr (Terms > 0) divide<Terms == divide_terms ? evaluation::divide : evaluation::series>(b, k, divisors_of<Terms>(b, k, e, w), u, v);
    each_quad(n, u, v, of_slopes(e, w));
  }
}

// The same where slopes vary along one axis alone: what is found of them is found once, of eight rows or columns.
SPANTEX_INLINE v16 slopes_along(const batch& b, int k) { return _mm512_broadcast_i64x4(_mm256_load_si256(reinterpret_cast<const __m256i*>(b.slopes[k]))); }
SPANTEX_INLINE v16 of_quad(const batch& b, int n, v16 x) { return _mm512_permutexvar_epi32(_mm512_load_si512(b.slope_of[n]), x); }
template <evaluation How, class Form>
SPANTEX_INLINE void evaluate_along(const batch& b, int k, v16 divisors, v16 found, auto&& each_quad) {
  Form form_u(b.u, k), form_v(b.v, k);
#pragma GCC unroll 4
  for (int n = 0; n < quads; ++n) {
    v16 u = form_u.of(n), v = form_v.of(n);
    if constexpr (How != evaluation::affine) divide<How>(b, k, of_quad(b, n, divisors), u, v);
    each_quad(n, u, v, of_quad(b, n, found));
  }
}
template <class Form>
SPANTEX_INLINE void evaluate_along(const batch& b, int k, auto&& of_slopes, auto&& each_quad) {
  const v16 e = slopes_along(b, k);
  const slopes16 w(e);
  const v16 found = of_slopes(e, w);
  v16 divisors;
  switch (b.terms[k]) {
    case 0: return evaluate_along<evaluation::affine, Form>(b, k, e, found, each_quad);
    case 1: divisors = divisors_of<1>(b, k, e, w); break;
    case 2: divisors = divisors_of<2>(b, k, e, w); break;
    case 3: divisors = divisors_of<3>(b, k, e, w); break;
    case 4: divisors = divisors_of<4>(b, k, e, w); break;
    default: return evaluate_along<evaluation::divide, Form>(b, k, divisors_of<divide_terms>(b, k, e, w), found, each_quad);
  }
  evaluate_along<evaluation::series, Form>(b, k, divisors, found, each_quad);
}

// Along: of a filter whose slopes may vary along one axis alone (batch::slope_of).
template <class Form, bool Along = false>
SPANTEX_INLINE void evaluate(const batch& b, int k, auto&& of_slopes, auto&& each_quad) {
  static_assert(most_series_terms == 4 && divide_terms == 5);
  if (Along && b.slope_of != nullptr) return evaluate_along<Form>(b, k, of_slopes, each_quad);
  switch (b.terms[k]) {
    case 0: return evaluate_quads<0, Form>(b, k, of_slopes, each_quad);
    case 1: return evaluate_quads<1, Form>(b, k, of_slopes, each_quad);
    case 2: return evaluate_quads<2, Form>(b, k, of_slopes, each_quad);
    case 3: return evaluate_quads<3, Form>(b, k, of_slopes, each_quad);
    case 4: return evaluate_quads<4, Form>(b, k, of_slopes, each_quad);
    default: return evaluate_quads<divide_terms, Form>(b, k, of_slopes, each_quad);
  }
}

template <class Form, bool Along = false>
SPANTEX_INLINE offsets offsets_of(const batch& b, int k) {
  offsets o;
  evaluate<Form, Along>(b, k, [](v16 e, const slopes16&) SPANTEX_INLINED { return e; }, [&](int n, v16 u, v16 v, v16 e) SPANTEX_INLINED {
    o.u[n] = u;
    o.v[n] = v;
    o.e[n] = e;
  });
  o.bits = bits_of(b, k);
  o.half = half_of(o.bits);
  return o;
}

// One quad's offsets.
struct positions { v16 u, v; int32_t base_u, base_v; int bits; uint32_t half; };
SPANTEX_INLINE positions positions_of(const batch& b, int k, const offsets& o, int n) { return {o.u[n], o.v[n], b.base_u[k], b.base_v[k], o.bits, o.half}; }

SPANTEX_INLINE void drop_bits(int drop, v16 (&u)[quads], v16 (&v)[quads]) {
#pragma GCC unroll 4
  for (int n = 0; n < quads; ++n) {
    u[n] = _mm512_srav_epi32(u[n], set32(drop));
    v[n] = _mm512_srav_epi32(v[n], set32(drop));
  }
}

// Drops the bits that keep positions modulo 32 texels of any level up to this one from fitting 32 bits, half a dozen where a map has many levels. The last level
// that a map may have is one texel, the same wherever it is read.
constexpr int32_t last_of_several_texels = max_levels - 2;
SPANTEX_INLINE void shorten(int last_level, v16 (&u)[quads], v16 (&v)[quads], int& bits, uint32_t& half) {
  const int drop = bits + min_of(last_level, last_of_several_texels) - 27;
  if (drop <= 0) return;
  drop_bits(drop, u, v);
  bits -= drop;
  half >>= drop;
}

// Positions on a level, from a section's first texel: u in the lower half of each lane, v in the upper, 7 bits of fraction (one more in batch_places) and 4 of texel each (5 of v where sections are high); what is above is anything.
// `from`: what they are relative to, and half of what they are snapped to.
template <class C>
SPANTEX_INLINE v16 snapped_by(const C& c, v16 u, v16 v, int32_t from_u, int32_t from_v, int32_t drop, int32_t turn) {
  const v16 x = _mm512_srlv_epi32(_mm512_add_epi32(u, set32(from_u)), set32(drop)), y = _mm512_rorv_epi32(_mm512_add_epi32(v, set32(from_v)), set32(turn));
  return _mm512_mask_mov_epi16(y, __mmask32(c.even), x);
}

// What leads to positions, less so many texels.
SPANTEX_INLINE __m128i four(const int32_t* of) { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(of)); }
SPANTEX_INLINE void begin_four(int32_t* from, __m128i texels, __m128i texel_bits) {
  _mm_storeu_si128(reinterpret_cast<__m128i*>(from), _mm_sub_epi32(four(from), _mm_sllv_epi32(texels, texel_bits)));
}

// The same for a span's quads on several levels each: what to add and how far to shift. Fine levels of the four quads, then the coarse ones, then those after them.
struct alignas(32) snapping {
  int32_t from_u[3 * quads], from_v[3 * quads], drop[3 * quads], turn[3 * quads];

  SPANTEX_INLINE SPANTEX_WRAPS void take_two(int bits, uint32_t rounding, int32_t base_u, int32_t base_v, __m256i level) {
    const __m256i shift = _mm256_add_epi32(level, _mm256_set1_epi32(bits - q.subtexel_bits));
    const __m256i half = _mm256_sllv_epi32(_mm256_set1_epi32(1), _mm256_sub_epi32(shift, _mm256_set1_epi32(1)));
    const __m256i start = _mm256_sub_epi32(half, _mm256_slli_epi32(half, q.subtexel_bits));
    const auto put = [](int32_t* to, __m256i x) { _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), x); };
    put(from_u, _mm256_add_epi32(start, _mm256_set1_epi32(int32_t((uint32_t(base_u) << bits) + rounding))));
    put(from_v, _mm256_add_epi32(start, _mm256_set1_epi32(int32_t((uint32_t(base_v) << bits) + rounding))));
    put(drop, shift);
    put(turn, _mm256_sub_epi32(shift, _mm256_set1_epi32(16)));
  }

  // What two levels have is known.
  SPANTEX_INLINE SPANTEX_WRAPS void take_next(int bits, uint32_t rounding, int32_t base_u, int32_t base_v, __m128i level) {
    const __m128i shift = _mm_add_epi32(level, _mm_set1_epi32(bits - q.subtexel_bits)), half = _mm_sllv_epi32(_mm_set1_epi32(1), _mm_sub_epi32(shift, _mm_set1_epi32(1)));
    const __m128i start = _mm_sub_epi32(half, _mm_slli_epi32(half, q.subtexel_bits));
    const auto put = [](int32_t* to, __m128i x) { _mm_storeu_si128(reinterpret_cast<__m128i*>(to + 2 * quads), x); };
    put(from_u, _mm_add_epi32(start, _mm_set1_epi32(int32_t((uint32_t(base_u) << bits) + rounding))));
    put(from_v, _mm_add_epi32(start, _mm_set1_epi32(int32_t((uint32_t(base_v) << bits) + rounding))));
    put(drop, shift);
    put(turn, _mm_sub_epi32(shift, _mm_set1_epi32(16)));
  }

  // Columns and rows are counted from these, on the level that lies so many after the fine one.
  SPANTEX_INLINE void begin_at(__m128i column, __m128i row, int after) {
    const __m128i texel = _mm_add_epi32(four(drop + after * quads), _mm_set1_epi32(q.subtexel_bits));
    begin_four(from_u + after * quads, column, texel);
    begin_four(from_v + after * quads, row, texel);
  }

  template <class C>
  SPANTEX_INLINE v16 at(const C& c, v16 u, v16 v, int k) const { return snapped_by(c, u, v, from_u[k], from_v[k], drop[k], turn[k]); }
};
