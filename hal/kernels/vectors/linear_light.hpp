// SPDX-License-Identifier: Apache-2.0
// Vector kernels: from four 16-bit texels to a pixel, in linear light (docs/SPEC.md). A pixel is four lanes, one a channel; alpha is filtered like the others, with 8 bits, and is
// none of the codes that come out. Hides what the coded kernels have by these names. Included by the machines' files alone.
#pragma once

constexpr bool places_first = true;
constexpr int place_scale = 2;  // places are counted in eight bytes, which is as far as addresses are scaled
constexpr int64_t longest_map_row = 2 * max_texture_side + 2 * texel_apron;
static_assert(longest_map_row * longest_map_row * 3 / 2 * place_scale < INT32_MAX);

// Pixel k of every four in register k, so that its channels lie in four lanes, and texels' too.
constexpr int pixels_apart = 4;

#if SPANTEX_AVX512
template <int K>
SPANTEX_INLINE v lane_of_each(v x) { return v(_mm512_shuffle_epi32(raw(x), _MM_PERM_ENUM(0x55 * K))); }
#else
#if SPANTEX_AVX2
#define SPANTEX_EACH(a, b, c, d) a, b, c, d, a + 4, b + 4, c + 4, d + 4
#else
#define SPANTEX_EACH(a, b, c, d) a, b, c, d
#endif

// Lane K of every four, four times.
template <int K>
SPANTEX_INLINE v lane_of_each(v x) { return __builtin_shufflevector(x, x, SPANTEX_EACH(K, K, K, K)); }
#endif

// Calls f.operator()<k>() for every register of pixels.
SPANTEX_INLINE void each_register(auto&& f) {
  f.template operator()<0>();
  f.template operator()<1>();
  f.template operator()<2>();
  f.template operator()<3>();
}

// Calls take.operator()<k>(left, right) for every register of pixels: their left texels, and their right ones.
SPANTEX_INLINE void each_column(const linear_column* texels, const uint32_t* at, auto&& take) {
#if SPANTEX_AVX512
  const int64_t* const from = reinterpret_cast<const int64_t*>(texels);
  constexpr int quarters = width / pixels_apart;
  const auto two_registers = [&]<int K>() SPANTEX_INLINED {
    uint64_t places[quarters];  // of pixels in both, which one load reads
#pragma GCC unroll 4
    for (int n = 0; n < quarters; ++n) __builtin_memcpy(&places[n], at + K + n * pixels_apart, sizeof places[n]);
    const auto one = [&]<int Next>() SPANTEX_INLINED {
      const auto of = [&](int n) SPANTEX_INLINED { return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from + (Next == 0 ? uint32_t(places[n]) : places[n] >> 32))); };
      const auto two = [&](int n) SPANTEX_INLINED { return _mm512_inserti64x4(_mm512_castsi256_si512(of(n)), of(n + 1), 1); };
      const raw first = two(0), second = two(2);
      take.template operator()<K + Next>(v(_mm512_shuffle_i32x4(first, second, 0x88)), v(_mm512_shuffle_i32x4(first, second, 0xDD)));
    };
    one.template operator()<0>();
    one.template operator()<1>();
  };
  two_registers.template operator()<0>();
  two_registers.template operator()<2>();
#else
  each_register([&]<int K>() SPANTEX_INLINED {
    const auto of = [&](int right) SPANTEX_INLINED {
      const auto texel = [&](int pixel) SPANTEX_INLINED { return reinterpret_cast<const int32_t*>(texels) + size_t(at[pixel]) * 2 + 4 * right; };
#if SPANTEX_AVX2
      const auto half = [&](int pixel) SPANTEX_INLINED { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(texel(pixel))); };
      return v(_mm256_inserti128_si256(_mm256_castsi128_si256(half(K)), half(K + pixels_apart), 1));
#else
      return get(texel(K));
#endif
    };
    take.template operator()<K>(of(0), of(1));
  });
#endif
}

struct blends { v pixel[4]; };
constexpr int blend_fraction = 2 * q.subtexel_bits, kept_drop = blend_fraction - q.blend_bits, between_bits = q.blend_bits + q.level_bits;
static_assert(q.blend_bits <= max_linear_blend_bits - q.level_bits && linear_bits + between_bits < 32);

// What sums of a level begin with: 2^15 for each of the weights, 2^14 together, as texels are less 2^15, so that they are signed words; and more: half of what kept_and_more() drops, so that it rounds, and kept_more of
// what it keeps, which with the ones behind them are the 2^15 - 1 that biased_to_even() takes.
constexpr int32_t kept_more = 0x7FFF >> (16 - q.blend_bits), more_of_blends = (1 << (kept_drop - 1)) + (kept_more << kept_drop), start_of_blends = (linear_column::offset << blend_fraction) + more_of_blends;

// fraction: u in the lower half of each lane, v in the upper, of 128.
SPANTEX_INLINE blends blend(const linear_column* from, const uint32_t* at, v fraction) {
#if SPANTEX_AVX512
  const raw u_of_both = raw(of_each_quarter(_mm_setr_epi8(0, 1, 0, 1, 4, 5, 4, 5, 8, 9, 8, 9, 12, 13, 12, 13))), v_of_both = raw(of_each_quarter(_mm_setr_epi8(2, 3, 2, 3, 6, 7, 6, 7, 10, 11, 10, 11, 14, 15, 14, 15)));
  const raw lower = _mm512_shuffle_epi8(raw(fraction), v_of_both);
  const v_unsigned u = v_unsigned(_mm512_shuffle_epi8(raw(fraction), u_of_both)), rows = v_unsigned(_mm512_mask_sub_epi16(lower, 0x55555555, _mm512_set1_epi16(128), lower));
#else
  const v_unsigned u = v_unsigned(halves(fraction, fraction << 16)), rows = v_unsigned(halves(128 - (fraction >> 16), fraction));
#endif
  const v right = v(rows * u), left = v((rows << q.subtexel_bits) - v_unsigned(right));
  blends b;
  each_column(from, at, [&]<int K>(v of_left, v of_right) SPANTEX_INLINED {
    b.pixel[K] = add_products(add_products(set(start_of_blends), of_left, lane_of_each<K>(left)), of_right, lane_of_each<K>(right));
  });
  return b;
}

// Halves to even.
SPANTEX_INLINE v rounded_to_even(v x, int bits) { return (x + ((1 << (bits - 1)) - 1) + ((x >> bits) & 1)) >> bits; }
// The same above so many bits, 2^(Bits - 1) - 1 added already. Whether the number is odd is asked after that: it carries only above a half, where one more does not carry again.
template <int Bits = 16>
SPANTEX_INLINE v biased_to_even(v_32 y) {
#if SPANTEX_AVX512
  static_assert(Bits == 16);  // so that one operation adds it
  const v one = number<0x10000>();
  return add_products(v(y), v(y) & one, one);
#else
  return v(y + (y >> Bits & 1));
#endif
}
#if SPANTEX_AVX512
constexpr int bits_below_one_level = 16;
#else
constexpr int bits_below_one_level = blend_fraction;  // as sums have them
#endif
// Of a number with `bits` bits of fraction, and so much more than it is.
template <int Bits = 16>
SPANTEX_INLINE v above_to_even(v x, int bits, uint32_t more = 0) { return biased_to_even<Bits>((v_32(x) << (Bits - bits)) + ((1 << (Bits - 1)) - 1 - (more << (Bits - bits)))); }

SPANTEX_INLINE v kept_and_more(v x) { return x >> kept_drop; }
SPANTEX_INLINE v kept_of_level(v x) { return kept_and_more(x) - kept_more; }
template <int K>
SPANTEX_INLINE v between_levels(const blends& fine, const blends& coarse, v fraction) {
  const v near = kept_of_level(fine.pixel[K]);
  return (near << q.level_bits) + (kept_of_level(coarse.pixel[K]) - near) * lane_of_each<K>(fraction);
}

// Pixels before they are codes: u0.16 numbers, of alpha whole ones, two a lane: of pixels 0 and 1 of every four, and of 2 and 3. A span's are found before the first is coded: both are long
// chains of dependent operations, which a processor does side by side of several pixels if there is nothing else between them.
struct unfinished { v first, second; };

// number_of.operator()<k>() delivers those of register k, above `Bits` bits.
template <int Bits = 16>
SPANTEX_INLINE unfinished two_a_lane(auto&& number_of) {
  v x[4];
  each_register([&]<int K>() SPANTEX_INLINED { x[K] = number_of.template operator()<K>(); });
  const auto two = [](v a, v b) SPANTEX_INLINED { return halves(v(v_32(a) >> Bits), b << (16 - Bits)); };
  return {two(x[0], x[1]), two(x[2], x[3])};
}
SPANTEX_INLINE unfinished chosen(v where, const unfinished& a, const unfinished& b) {
  const v first = halves(lane_of_each<0>(where), lane_of_each<1>(where)), second = halves(lane_of_each<2>(where), lane_of_each<3>(where));
  return {(a.first & first) | (b.first & ~first), (a.second & second) | (b.second & ~second)};
}
#if SPANTEX_AVX512
#include "../avx512/srgb_codes.hpp"
#else
// What a group of pixels has until it is finished: places in the table of codes too, in memory, where they are read one by one a span later. Out of registers each would take another operation.
struct in_hand {
  unfinished numbers;
  uint16_t place[2][2 * width];
  SPANTEX_INLINE in_hand& operator=(const unfinished& of) {
    numbers = of;
    put(place[0], v(v_unsigned(of.first) >> 4));
    put(place[1], v(v_unsigned(of.second) >> 4));
    return *this;
  }
};

// Codes of u0.16 numbers, two words a lane, and alpha as it is.
SPANTEX_INLINE v codes_of(v numbers, const uint16_t* place) {
  const auto step = [&](int k) SPANTEX_INLINED { return srgb_code_of.step[place[k]]; };
#if SPANTEX_AVX2
  const v_unsigned steps = {step(0), step(1), step(2), step(3), step(4), step(5), 0, 0, step(8), step(9), step(10), step(11), step(12), step(13), 0, 0};
#else
  const v_unsigned steps = {step(0), step(1), step(2), step(3), step(4), step(5), 0, 0};
#endif
  return __builtin_shufflevector(v((steps + (v_unsigned(numbers) & 15)) >> 4), numbers, SPANTEX_EACH(0, 1, 2, width + 3));
}

// Lane c has channel c of pixels 0, 2, 1 and 3, from its lowest byte on: to pixels.
SPANTEX_INLINE v pixels_of_channels(v channels) {
  constexpr bool little = __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__;
  constexpr int p0 = little ? 0 : 3, p1 = little ? 2 : 1, p2 = little ? 1 : 2, p3 = little ? 3 : 0;
  typedef uint8_t bytes __attribute__((vector_size(4 * width)));
#define SPANTEX_PIXEL(n) n, n + 4, n + 8, n + 12
#define SPANTEX_PIXELS(n) SPANTEX_PIXEL(n + p0), SPANTEX_PIXEL(n + p1), SPANTEX_PIXEL(n + p2), SPANTEX_PIXEL(n + p3)
#if SPANTEX_AVX2
  return v(__builtin_shufflevector(bytes(channels), bytes(channels), SPANTEX_PIXELS(0), SPANTEX_PIXELS(16)));
#else
  return v(__builtin_shufflevector(bytes(channels), bytes(channels), SPANTEX_PIXELS(0)));
#endif
}

SPANTEX_INLINE v finished(const in_hand& of) { return pixels_of_channels(codes_of(of.numbers.first, of.place[0]) | (codes_of(of.numbers.second, of.place[1]) << 8)); }
#endif

SPANTEX_INLINE unfinished pixels_of(const blends& b) {
  constexpr int bits = bits_below_one_level;
  return two_a_lane<bits>([&]<int K>() SPANTEX_INLINED { return above_to_even<bits>(b.pixel[K], blend_fraction, more_of_blends); });
}

// In upper halves, what kept_and_more() kept: ones behind it make 2^15 - 1 of kept_more.
SPANTEX_INLINE v_32 with_rounding(v x) {
  constexpr int ones = 16 - q.blend_bits;
  return (v_32(x) << ones) + ((1 << ones) - 1);
}

// Two levels; fraction of 256 a lane.
SPANTEX_INLINE unfinished pixels_between(const blends& fine, const blends& coarse, v fraction) {
  const v weights = fraction << (16 - between_bits);
  return two_a_lane([&]<int K>() SPANTEX_INLINED {
    const v near = kept_and_more(fine.pixel[K]);
    return biased_to_even(with_rounding(near) + v_32(kept_and_more(coarse.pixel[K]) - near) * v_32(lane_of_each<K>(weights)));
  });
}

// The same where the coarse level has no weight.
SPANTEX_INLINE unfinished pixels_of_level(const blends& b) {
  return two_a_lane([&]<int K>() SPANTEX_INLINED { return biased_to_even(with_rounding(kept_and_more(b.pixel[K]))); });
}

// --- many samples --------------------------------------------------------------------------------------

// A sample is rounded to 12 bits before it is added, and the mean once more: a row of one sample is not what a filter of one sample makes of it. (What is on one level has fewer bits.)
constexpr rounded one_sample = rounded::as_sample;
template <int K>
SPANTEX_INLINE v sample(const blends& fine, const blends& coarse, v fraction) { return rounded_to_even(between_levels<K>(fine, coarse, fraction), between_bits - max_linear_sum_bits); }
SPANTEX_INLINE unfinished sample_between(const blends& fine, const blends& coarse, v fraction) {
  return two_a_lane([&]<int K>() SPANTEX_INLINED { return above_to_even(sample<K>(fine, coarse, fraction), max_linear_sum_bits); });
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
