// SPDX-License-Identifier: Apache-2.0
// Vector kernels: 32-bit lanes as the compilers have them, `width` of them, and what every machine builds on them. Included by the machines' files alone.
#pragma once

typedef int32_t v __attribute__((vector_size(4 * width)));
typedef int16_t v_words __attribute__((vector_size(4 * width)));
typedef uint32_t v_32 __attribute__((vector_size(4 * width)));
typedef uint64_t v_64 __attribute__((vector_size(4 * width)));  // half as many lanes: even ones, or odd ones shifted down
typedef int64_t v_s64 __attribute__((vector_size(4 * width)));
typedef uint16_t v_unsigned __attribute__((vector_size(4 * width)));

struct wide { v_64 first, second; };  // 64 bits a lane, in the order that the machine's products have

// A span's pixels in memory: neighbours of a row, as many as there are lanes, below them those of the next row; after the last row the next part of all rows. More lanes
// than a row has pixels are two rows.
constexpr int lanes_across = min_of(width, span_side), parts = span_side / lanes_across, rows_at_once = width / lanes_across, groups = span_pixel_count / width;
constexpr int place_of(int y, int part) { return lanes_across * (span_side * part + y); }

SPANTEX_INLINE v set(int32_t x) { return v{} + x; }
SPANTEX_INLINE v get(const int32_t* from) {
  v x;
  __builtin_memcpy(&x, from, sizeof x);
  return x;
}
template <int32_t X>
SPANTEX_INLINE v number() {  // in all lanes
#if SPANTEX_AVX2
  return get(number32<X>);
#elif SPANTEX_AVX512
  return set(number32<X>[0]);
#else
  return set(X);
#endif
}
SPANTEX_INLINE void put(void* to, v x) { __builtin_memcpy(to, &x, sizeof x); }

// All lanes shifted alike. Shifts by a number in a register of its own take two operations on Intel, shifts lane by lane one.
SPANTEX_INLINE v down_by(v x, int n) {
#if SPANTEX_AVX2
  if (!__builtin_constant_p(n)) return v(_mm256_srav_epi32(__m256i(x), __m256i(set(n))));
#elif SPANTEX_AVX512
  if (!__builtin_constant_p(n)) return v(_mm512_srav_epi32(__m512i(x), __m512i(set(n))));
#endif
  return x >> n;
}
SPANTEX_INLINE v up_by(v x, int n) {
#if SPANTEX_AVX2
  if (!__builtin_constant_p(n)) return v(_mm256_sllv_epi32(__m256i(x), __m256i(set(n))));
#elif SPANTEX_AVX512
  if (!__builtin_constant_p(n)) return v(_mm512_sllv_epi32(__m512i(x), __m512i(set(n))));
#endif
  return x << n;
}
SPANTEX_INLINE v down_by(v x, v n) { return x >> n; }
SPANTEX_INLINE v_64 down_by(v_64 x, int n) {
#if SPANTEX_AVX2
  if (!__builtin_constant_p(n)) return v_64(_mm256_srlv_epi64(__m256i(x), __m256i(v_64{} + uint64_t(n))));
#elif SPANTEX_AVX512
  if (!__builtin_constant_p(n)) return v_64(_mm512_srlv_epi64(__m512i(x), __m512i(v_64{} + uint64_t(n))));
#endif
  return x >> n;
}
SPANTEX_INLINE v_64 up_by(v_64 x, int n) {
#if SPANTEX_AVX2
  if (!__builtin_constant_p(n)) return v_64(_mm256_sllv_epi64(__m256i(x), __m256i(v_64{} + uint64_t(n))));
#elif SPANTEX_AVX512
  if (!__builtin_constant_p(n)) return v_64(_mm512_sllv_epi64(__m512i(x), __m512i(v_64{} + uint64_t(n))));
#endif
  return x << n;
}

// How many steps apart places of neighbouring texels are, and what texels become first: pixels at once. linear_light.hpp has its own.
constexpr int place_scale = 1;
using unfinished = v;
SPANTEX_INLINE v chosen(v where, v a, v b) { return where ? a : b; }

SPANTEX_INLINE v least(v a, v b) { return a < b ? a : b; }
SPANTEX_INLINE v largest(v a, v b) { return a > b ? a : b; }

struct span_slopes { v row_u, row_v, column_u, column_v, twist_u, twist_v; };  // of a span: the same in all lanes

SPANTEX_INLINE v_s64 negated_where(v_s64 x, v_s64 negative) { return (x ^ negative) - negative; }

// Both 16-bit halves of each lane.
SPANTEX_INLINE v add16(v a, v b) { return v(v_unsigned(a) + v_unsigned(b)); }
SPANTEX_INLINE v subtract16(v a, v b) { return v(v_unsigned(a) - v_unsigned(b)); }
SPANTEX_INLINE v least16(v a, v b) { return v(v_words(a) < v_words(b) ? v_words(a) : v_words(b)); }
SPANTEX_INLINE v largest16(v a, v b) { return v(v_words(a) > v_words(b) ? v_words(a) : v_words(b)); }
SPANTEX_INLINE v least16_unsigned(v a, v b) { return v(v_unsigned(a) < v_unsigned(b) ? v_unsigned(a) : v_unsigned(b)); }

SPANTEX_INLINE v half_pixels_across() {
  v x{};
  for (int k = 0; k < width; ++k) x[k] = half_pixels(k % lanes_across);
  return x;
}
// Of rows, as many as there are lanes, from the k-th on.
SPANTEX_INLINE v half_pixels_of(int k) {
  v x{};
  for (int n = 0; n < width; ++n) x[n] = half_pixels((k + n) % span_side);
  return x;
}
// From the first row that the lanes are.
SPANTEX_INLINE v half_pixels_down() {
  v x{};
  for (int k = 0; k < width; ++k) x[k] = 2 * (k / lanes_across);
  return x;
}

// s5.10 of the coefficients, s.16.
SPANTEX_INLINE v levels16(const int16_t* from) {
  v x{};
  for (int k = 0; k < width; ++k) x[k] = from[k % lanes_across];
  return x * 64;
}
