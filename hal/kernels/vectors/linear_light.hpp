// SPDX-License-Identifier: Apache-2.0
// Vector kernels: from four 16-bit texels to a pixel, in linear light (docs/SPEC.md). A pixel is four lanes, one a channel; alpha is filtered like the others, with 8 bits, and is
// none of the codes that come out. Hides what the coded kernels have by these names. Included by the machines' files alone.
#pragma once

constexpr bool places_first = true;

SPANTEX_INLINE const linear_texel* texels_of(const row_levels& map) { return map.linear_texels(); }

// Pixel k of the first four and, where there are eight lanes, pixel k + 4 in register k.
constexpr int pixels_apart = 4;

#if SPANTEX_AVX2
#define SPANTEX_LANES(a, b, c, d) a, b, c, d, a, b, c, d
#define SPANTEX_EACH(a, b, c, d) a, b, c, d, a + 4, b + 4, c + 4, d + 4
#define SPANTEX_WORDS(n) n, n + 16, n + 1, n + 17, n + 2, n + 18, n + 3, n + 19, n + 8, n + 24, n + 9, n + 25, n + 10, n + 26, n + 11, n + 27
#else
#define SPANTEX_LANES(a, b, c, d) a, b, c, d
#define SPANTEX_EACH(a, b, c, d) a, b, c, d
#define SPANTEX_WORDS(n) n, n + 8, n + 1, n + 9, n + 2, n + 10, n + 3, n + 11
#endif

// Lane K of every four, four times.
template <int K>
SPANTEX_INLINE v lane_of_each(v x) { return __builtin_shufflevector(x, x, SPANTEX_EACH(K, K, K, K)); }
SPANTEX_INLINE v first_words(v a, v b) { return v(__builtin_shufflevector(v_words(a), v_words(b), SPANTEX_WORDS(0))); }  // of every eight, alternating
SPANTEX_INLINE v last_words(v a, v b) { return v(__builtin_shufflevector(v_words(a), v_words(b), SPANTEX_WORDS(4))); }

// Calls f.operator()<k>() for every register of pixels.
SPANTEX_INLINE void each_register(auto&& f) {
  f.template operator()<0>();
  f.template operator()<1>();
  f.template operator()<2>();
  f.template operator()<3>();
}

// A texel and the next of every pixel in a register.
SPANTEX_INLINE v pairs_at(const linear_texel* from, const uint32_t* at) {
#if SPANTEX_AVX2
  const auto pair = [&](int k) SPANTEX_INLINED { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(from + at[k])); };
  return v(_mm256_inserti128_si256(_mm256_castsi128_si256(pair(0)), pair(pixels_apart), 1));
#else
  return get(reinterpret_cast<const int32_t*>(from + at[0]));
#endif
}

struct blends { v pixel[4]; };
constexpr int blend_fraction = 2 * q.subtexel_bits;

// fraction: u in the lower half of each lane, v in the upper, of 128. Texels lie around 0, so that products of words do; weights add up to 2^14, and what was taken off is added with them.
SPANTEX_INLINE blends blend(const linear_texel* top, const uint32_t* top_at, const linear_texel* bottom, const uint32_t* bottom_at, v fraction) {
  const v_unsigned u = v_unsigned((fraction & 0xFFFF) | (fraction << 16)), rows = v_unsigned((fraction & int32_t(0xFFFF0000)) | (128 - (fraction >> 16)));
  const v right = v(rows * u), left = v((rows << q.subtexel_bits) - v_unsigned(right));
  blends b;
  each_register([&]<int K>() SPANTEX_INLINED {
    const v above = pairs_at(top, top_at + K), below = pairs_at(bottom, bottom_at + K);
    b.pixel[K] = products(first_words(above, below), lane_of_each<K>(left)) + products(last_words(above, below), lane_of_each<K>(right)) + (linear_texel::offset << blend_fraction);
  });
  return b;
}

// Halves to even.
SPANTEX_INLINE v rounded_to_even(v x, int bits) { return (x + ((1 << (bits - 1)) - 1) + ((x >> bits) & 1)) >> bits; }

SPANTEX_INLINE v kept_of_level(v x) { return (x + (1 << (blend_fraction - q.blend_bits - 1))) >> (blend_fraction - q.blend_bits); }
constexpr int between_bits = q.blend_bits + q.level_bits;
static_assert(q.blend_bits <= max_linear_blend_bits - q.level_bits && linear_bits + between_bits < 32);
template <int K>
SPANTEX_INLINE v between_levels(const blends& fine, const blends& coarse, v fraction) {
  const v near = kept_of_level(fine.pixel[K]);
  return (near << q.level_bits) + (kept_of_level(coarse.pixel[K]) - near) * lane_of_each<K>(fraction);
}

// Pixels of u0.16 numbers, of alpha whole ones: number_of.operator()<k>() delivers those of register k.
SPANTEX_INLINE v coded(auto&& number_of) {
  v x[4];
  each_register([&]<int K>() SPANTEX_INLINED { x[K] = number_of.template operator()<K>(); });
  constexpr v alpha = {SPANTEX_LANES(0, 0, 0, -1)};
  const auto two = [&](v a, v b) SPANTEX_INLINED {  // codes of both, the latter's in upper halves
    const v words = a | (b << 16);
    uint16_t at[2 * width];
    put(at, v(v_unsigned(words) >> 4));
    asm("" : "+m"(at));
    const auto step = [&](int k) SPANTEX_INLINED { return srgb_code_of.step[at[k]]; };
#if SPANTEX_AVX2
    const v_unsigned steps = {step(0), step(1), step(2), step(3), step(4), step(5), 0, 0, step(8), step(9), step(10), step(11), step(12), step(13), 0, 0};
#else
    const v_unsigned steps = {step(0), step(1), step(2), step(3), step(4), step(5), 0, 0};
#endif
    const v codes = v((steps + (v_unsigned(words) & 15)) >> 4);
    return (codes & ~alpha) | (words & alpha);
  };
  typedef uint8_t bytes __attribute__((vector_size(4 * width)));
  const bytes channels = bytes(two(x[0], x[1]) | (two(x[2], x[3]) << 8));  // a channel of pixels 0, 2, 1, 3 in a lane, from its lowest byte on
  constexpr bool little = __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__;
  constexpr int p0 = little ? 0 : 3, p1 = little ? 2 : 1, p2 = little ? 1 : 2, p3 = little ? 3 : 0;
#define SPANTEX_PIXELS(n) n + p0, n + p0 + 4, n + p0 + 8, n + p0 + 12, n + p1, n + p1 + 4, n + p1 + 8, n + p1 + 12, n + p2, n + p2 + 4, n + p2 + 8, n + p2 + 12, n + p3, n + p3 + 4, n + p3 + 8, n + p3 + 12
#if SPANTEX_AVX2
  return v(__builtin_shufflevector(channels, channels, SPANTEX_PIXELS(0), SPANTEX_PIXELS(16)));
#else
  return v(__builtin_shufflevector(channels, channels, SPANTEX_PIXELS(0)));
#endif
}
SPANTEX_INLINE v pixels_of(const blends& b) {
  return coded([&]<int K>() SPANTEX_INLINED { return rounded_to_even(b.pixel[K], blend_fraction); });
}

// Two levels; fraction of 256 a lane.
SPANTEX_INLINE v pixels_between(const blends& fine, const blends& coarse, v fraction) {
  return coded([&]<int K>() SPANTEX_INLINED { return rounded_to_even(between_levels<K>(fine, coarse, fraction), between_bits); });
}

// The same where the coarse level has no weight.
SPANTEX_INLINE v pixels_of_level(const blends& b) {
  return coded([&]<int K>() SPANTEX_INLINED { return rounded_to_even(kept_of_level(b.pixel[K]), q.blend_bits); });
}

// --- many samples --------------------------------------------------------------------------------------

// A sample is rounded to 12 bits before it is added, and the mean once more: a row of one sample is not what a filter of one sample makes of it.
constexpr bool rounds_samples = true;
static_assert(q.max_samples <= 16 && between_bits > max_linear_sum_bits && q.blend_bits <= max_linear_sum_bits);
struct colour_sums { v_32 pixel[4] = {}; };

// counted: all ones where the lane's pixel has this sample.
SPANTEX_INLINE void add_sample(colour_sums& s, const blends& fine, const blends& coarse, v fraction, v counted) {
  each_register([&]<int K>() SPANTEX_INLINED { s.pixel[K] += v_32(rounded_to_even(between_levels<K>(fine, coarse, fraction), between_bits - max_linear_sum_bits) & lane_of_each<K>(counted)); });
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
SPANTEX_INLINE v means_of(const colour_sums& s, v samples) {
  const v inverse = look_up(inverses.of, samples);
  return coded([&]<int K>() SPANTEX_INLINED {
    const v_32 sum = s.pixel[K], n = v_32(lane_of_each<K>(samples));
    const v whole = upper_halves(unsigned_products(v(sum >> max_linear_sum_bits << 1), lane_of_each<K>(inverse)));
    const v_32 rest = sum - ((v_32(whole) * n) << max_linear_sum_bits);
    return whole - v(v((rest << 1) + (v_32(whole) & 1)) > v(n << max_linear_sum_bits));
  });
}
