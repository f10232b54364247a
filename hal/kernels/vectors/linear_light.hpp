// SPDX-License-Identifier: Apache-2.0
// Vector kernels: from four 16-bit texels to a pixel, in linear light (docs/SPEC.md). A pixel is four lanes, one a channel; alpha is filtered like the others, with 8 bits, and is
// none of the codes that come out. Hides what the coded kernels have by these names. Included by the machines' files alone.
#pragma once

constexpr bool places_first = true;

SPANTEX_INLINE const linear_texel* texels_of(const row_levels& map) { return map.linear_texels(); }

constexpr bool little = __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__;

// Pixel k of every four in register k, so that its channels lie in four lanes; texels' likewise, two in eight words.
constexpr int pixels_apart = 4;

#if SPANTEX_AVX512
template <int K>
SPANTEX_INLINE v lane_of_each(v x) { return v(_mm512_shuffle_epi32(raw(x), _MM_PERM_ENUM(0x55 * K))); }
SPANTEX_INLINE v first_words(v a, v b) { return v(_mm512_unpacklo_epi16(raw(a), raw(b))); }
SPANTEX_INLINE v last_words(v a, v b) { return v(_mm512_unpackhi_epi16(raw(a), raw(b))); }
#else
#if SPANTEX_AVX2
#define SPANTEX_EACH(a, b, c, d) a, b, c, d, a + 4, b + 4, c + 4, d + 4
#define SPANTEX_WORDS(n) n, n + 16, n + 1, n + 17, n + 2, n + 18, n + 3, n + 19, n + 8, n + 24, n + 9, n + 25, n + 10, n + 26, n + 11, n + 27
#else
#define SPANTEX_EACH(a, b, c, d) a, b, c, d
#define SPANTEX_WORDS(n) n, n + 8, n + 1, n + 9, n + 2, n + 10, n + 3, n + 11
#endif

// Lane K of every four, four times.
template <int K>
SPANTEX_INLINE v lane_of_each(v x) { return __builtin_shufflevector(x, x, SPANTEX_EACH(K, K, K, K)); }
// The first or the last four words of every eight: of a in lower halves of lanes, of b in upper ones.
SPANTEX_INLINE v alternating(auto&& words, v a, v b) { return little ? words(v_words(a), v_words(b)) : words(v_words(b), v_words(a)); }
SPANTEX_INLINE v first_words(v a, v b) {
  return alternating([](v_words x, v_words y) SPANTEX_INLINED { return v(__builtin_shufflevector(x, y, SPANTEX_WORDS(0))); }, a, b);
}
SPANTEX_INLINE v last_words(v a, v b) {
  return alternating([](v_words x, v_words y) SPANTEX_INLINED { return v(__builtin_shufflevector(x, y, SPANTEX_WORDS(4))); }, a, b);
}
#endif

// Calls f.operator()<k>() for every register of pixels.
SPANTEX_INLINE void each_register(auto&& f) {
  f.template operator()<0>();
  f.template operator()<1>();
  f.template operator()<2>();
  f.template operator()<3>();
}

// A texel and the next of every pixel in a register.
SPANTEX_INLINE v pairs_at(const linear_texel* from, const uint32_t* at) {
#if SPANTEX_AVX2 || SPANTEX_AVX512
  const auto pair = [&](int k) SPANTEX_INLINED { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(from + at[k * pixels_apart])); };
  const auto two = [&](int k) SPANTEX_INLINED { return _mm256_inserti128_si256(_mm256_castsi128_si256(pair(k)), pair(k + 1), 1); };
#if SPANTEX_AVX512
  return v(_mm512_inserti64x4(_mm512_castsi256_si512(two(0)), two(2), 1));
#else
  return v(two(0));
#endif
#else
  return get(reinterpret_cast<const int32_t*>(from + at[0]));
#endif
}

struct blends { v pixel[4]; };
constexpr int blend_fraction = 2 * q.subtexel_bits;

// fraction: u in the lower half of each lane, v in the upper, of 128. Texels are less 2^15, so that they are signed words; weights add up to 2^14, and 2^15 2^14 is added back.
SPANTEX_INLINE blends blend(const linear_texel* top, const uint32_t* top_at, const linear_texel* bottom, const uint32_t* bottom_at, v fraction) {
  const v_unsigned u = v_unsigned((fraction & 0xFFFF) | (fraction << 16)), rows = v_unsigned((fraction & int32_t(0xFFFF0000)) | (128 - (fraction >> 16)));
  const v right = v(rows * u), left = v((rows << q.subtexel_bits) - v_unsigned(right));
  blends b;
  each_register([&]<int K>() SPANTEX_INLINED {
    const v above = pairs_at(top, top_at + K), below = pairs_at(bottom, bottom_at + K);
    b.pixel[K] = add_products(add_products(set(linear_texel::offset << blend_fraction), first_words(above, below), lane_of_each<K>(left)), last_words(above, below), lane_of_each<K>(right));
  });
  return b;
}

// Halves to even.
SPANTEX_INLINE v rounded_to_even(v x, int bits) { return (x + ((1 << (bits - 1)) - 1) + ((x >> bits) & 1)) >> bits; }
// The same in a lane's upper half. Whether the number is odd is asked after 2^15 - 1 is added: that carries only above a half, where one more does not carry again.
SPANTEX_INLINE v upper_half_to_even(v x, int bits) {
  const v_32 y = (v_32(x) << (16 - bits)) + 0x7FFF;
#if SPANTEX_AVX512
  const v one = number<0x10000>();
  return add_products(v(y), v(y) & one, one);
#else
  return v(y + (y >> 16 & 1));
#endif
}

SPANTEX_INLINE v kept_of_level(v x) { return (x + (1 << (blend_fraction - q.blend_bits - 1))) >> (blend_fraction - q.blend_bits); }
constexpr int between_bits = q.blend_bits + q.level_bits;
static_assert(q.blend_bits <= max_linear_blend_bits - q.level_bits && linear_bits + between_bits < 32);
template <int K>
SPANTEX_INLINE v between_levels(const blends& fine, const blends& coarse, v fraction) {
  const v near = kept_of_level(fine.pixel[K]);
  return (near << q.level_bits) + (kept_of_level(coarse.pixel[K]) - near) * lane_of_each<K>(fraction);
}

// Codes of u0.16 numbers, two words a lane; of the first in the lower byte of each word, of the second in the upper.
#if SPANTEX_AVX512
#include "../avx512/srgb_codes.hpp"
#else
SPANTEX_INLINE v codes_of(v numbers) {
  uint16_t at[2 * width];
  put(at, v(v_unsigned(numbers) >> 4));
  asm("" : "+m"(at));  // loads of words take less than extracting them
  const auto step = [&](int k) SPANTEX_INLINED { return srgb_code_of.step[at[k]]; };
#if SPANTEX_AVX2
  const v_unsigned steps = {step(0), step(1), step(2), step(3), step(4), step(5), 0, 0, step(8), step(9), step(10), step(11), step(12), step(13), 0, 0};
#else
  const v_unsigned steps = {step(0), step(1), step(2), step(3), step(4), step(5), 0, 0};  // alpha has no code
#endif
  return v((steps + (v_unsigned(numbers) & 15)) >> 4);
}
SPANTEX_INLINE v codes_of(v first, v second) { return codes_of(first) | (codes_of(second) << 8); }
#endif

// Lane c has channel c of pixels 0, 2, 1 and 3, from its lowest byte on: to pixels.
SPANTEX_INLINE v pixels_of_channels(v channels) {
#if SPANTEX_AVX512
  return v(_mm512_shuffle_epi8(raw(channels), raw(of_each_quarter(_mm_setr_epi8(0, 4, 8, 12, 2, 6, 10, 14, 1, 5, 9, 13, 3, 7, 11, 15)))));
#else
  constexpr int p0 = little ? 0 : 3, p1 = little ? 2 : 1, p2 = little ? 1 : 2, p3 = little ? 3 : 0;
  typedef uint8_t bytes __attribute__((vector_size(4 * width)));
#define SPANTEX_PIXEL(n) n, n + 4, n + 8, n + 12
#define SPANTEX_PIXELS(n) SPANTEX_PIXEL(n + p0), SPANTEX_PIXEL(n + p1), SPANTEX_PIXEL(n + p2), SPANTEX_PIXEL(n + p3)
#if SPANTEX_AVX2
  return v(__builtin_shufflevector(bytes(channels), bytes(channels), SPANTEX_PIXELS(0), SPANTEX_PIXELS(16)));
#else
  return v(__builtin_shufflevector(bytes(channels), bytes(channels), SPANTEX_PIXELS(0)));
#endif
#endif
}

// Pixels before they are codes: u0.16 numbers, of alpha whole ones, two a lane: of pixels 0 and 1 of every four, and of 2 and 3. A span's are found before the first is coded: both are long
// chains of dependent operations, which a processor does side by side of several pixels if there is nothing else between them.
struct unfinished { v first, second; };
constexpr bool finishes_later = true;

// number_of.operator()<k>() delivers those of register k, in upper halves of lanes.
SPANTEX_INLINE unfinished two_a_lane(auto&& number_of) {
  v x[4];
  each_register([&]<int K>() SPANTEX_INLINED { x[K] = number_of.template operator()<K>(); });
  const auto two = [](v a, v b) SPANTEX_INLINED { return halves(v(v_32(a) >> 16), b); };
  return {two(x[0], x[1]), two(x[2], x[3])};
}
SPANTEX_INLINE unfinished chosen(v where, const unfinished& a, const unfinished& b) {
  const v first = halves(lane_of_each<0>(where), lane_of_each<1>(where)), second = halves(lane_of_each<2>(where), lane_of_each<3>(where));
  return {(a.first & first) | (b.first & ~first), (a.second & second) | (b.second & ~second)};
}
SPANTEX_INLINE v finished(const unfinished& of) {
  v alpha{};
  for (int k = 3; k < width; k += 4) alpha[k] = -1;
  return pixels_of_channels((codes_of(of.first, of.second) & ~alpha) | ((of.first | (of.second << 8)) & alpha));
}

SPANTEX_INLINE unfinished pixels_of(const blends& b) {
  return two_a_lane([&]<int K>() SPANTEX_INLINED { return upper_half_to_even(b.pixel[K], blend_fraction); });
}

// Two levels; fraction of 256 a lane.
SPANTEX_INLINE unfinished pixels_between(const blends& fine, const blends& coarse, v fraction) {
  return two_a_lane([&]<int K>() SPANTEX_INLINED { return upper_half_to_even(between_levels<K>(fine, coarse, fraction), between_bits); });
}

// The same where the coarse level has no weight.
SPANTEX_INLINE unfinished pixels_of_level(const blends& b) {
  return two_a_lane([&]<int K>() SPANTEX_INLINED { return upper_half_to_even(kept_of_level(b.pixel[K]), q.blend_bits); });
}

// --- many samples --------------------------------------------------------------------------------------

// A sample is rounded to 12 bits before it is added, and the mean once more: a row of one sample is not what a filter of one sample makes of it. (What is on one level has fewer bits.)
constexpr rounded one_sample = rounded::as_sample;
template <int K>
SPANTEX_INLINE v sample(const blends& fine, const blends& coarse, v fraction) { return rounded_to_even(between_levels<K>(fine, coarse, fraction), between_bits - max_linear_sum_bits); }
SPANTEX_INLINE unfinished sample_between(const blends& fine, const blends& coarse, v fraction) {
  return two_a_lane([&]<int K>() SPANTEX_INLINED { return upper_half_to_even(sample<K>(fine, coarse, fraction), max_linear_sum_bits); });
}

static_assert(q.max_samples <= 16 && between_bits > max_linear_sum_bits && q.blend_bits <= max_linear_sum_bits);
struct colour_sums { v_32 pixel[4] = {}; };

// counted: all ones where the lane's pixel has this sample.
SPANTEX_INLINE void add_sample(colour_sums& s, const blends& fine, const blends& coarse, v fraction, v counted) {
  each_register([&]<int K>() SPANTEX_INLINED { s.pixel[K] += v_32(sample<K>(fine, coarse, fraction) & lane_of_each<K>(counted)); });
}
SPANTEX_INLINE void add_sample(colour_sums& s, const blends& b, v counted) {
  each_register([&]<int K>() SPANTEX_INLINED { s.pixel[K] += v_32((kept_of_level(b.pixel[K]) << (max_linear_sum_bits - q.blend_bits)) & lane_of_each<K>(counted)); });
}

// By number of samples: ceil(2^31 / n), which divides what is below 2^27.
struct sample_inverses {
  int32_t of[17];
  constexpr sample_inverses() : of() {
    for (int64_t n = 1; n <= 16; ++n) of[n] = int32_t(uint32_t(((int64_t(1) << 31) + n - 1) / n));
  }
};
constexpr sample_inverses inverses{};

// Halves to even.
SPANTEX_INLINE unfinished means_of(const colour_sums& s, v samples) {
  const v inverse = look_up(inverses.of, samples);
  return two_a_lane([&]<int K>() SPANTEX_INLINED {
    const v_32 sum = s.pixel[K], n = v_32(lane_of_each<K>(samples));
    const v whole = upper_halves(unsigned_products(v(sum >> max_linear_sum_bits << 1), lane_of_each<K>(inverse)));
    const v_32 rest = sum - ((v_32(whole) * n) << max_linear_sum_bits);
    return (whole - v(v((rest << 1) + (v_32(whole) & 1)) > v(n << max_linear_sum_bits))) << 16;
  });
}
