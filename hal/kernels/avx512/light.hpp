// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: sRGB maps, filtered in linear light (docs/SPEC.md), from local memory: u0.16 numbers, two bytes each, are in two planes, lower and upper bytes. Included by by_blocks.hpp alone.
#pragma once

namespace light {

constexpr int kept_drop = 2 * q.subtexel_bits - q.blend_bits, between_bits = q.blend_bits + q.level_bits, sample_drop = between_bits - max_linear_sum_bits;
static_assert(q.blend_bits <= max_linear_sum_bits && sample_drop > 0);

// What sums of a level begin with, so that they are rounded: one level is, half to even; each of two is rounded to what is kept of it, and what they become, half to even; each of a sample's is.
enum class rounds : uint8_t { one, two, samples };
constexpr int up_of(rounds what) { return what == rounds::one ? up_of_one : up_between; }
// Of texels that are less by `offset`.
constexpr uint32_t start_of(rounds what, uint32_t offset) {
  static_assert(2 * q.subtexel_bits + up_of_one == 16);
  constexpr uint32_t half_of_kept = 1 << (kept_drop - 1), half_of_two = (before_even >> (16 - q.blend_bits)) << kept_drop;
  return (offset << (2 * q.subtexel_bits + up_of(what))) + (what == rounds::one ? uint32_t(before_even) : (half_of_kept + (what == rounds::two ? half_of_two : 0)) << up_between);
}

// What all quads take. Texels are less by 0x8080, as both their bytes are signed.
template <rounds What>
struct constants : to_even {
  static constexpr uint32_t start = start_of(What, 0x8080);
  v16 start_of_upper, lowest_of_start, start_of_alpha;
  SPANTEX_INLINE constants() {
    start_of_upper = of32<int32_t(start >> 8)>();
    lowest_of_start = of32<int32_t(start << 24)>();
    start_of_alpha = of32<int32_t(start_of(What, 0x80))>();
  }
};

// Four texels of each pixel: the sum of their upper bytes, 256 times, and of their lower ones. Alpha has no upper ones.
template <rounds What, held_in Where, int Channels>
SPANTEX_INLINE void blended(const constants<What>& c, const quad_section<Where>& from, const samples& s, v16 (&out)[Channels]) {
  const auto added = [&](v16 sum, int plane) SPANTEX_INLINED { return _mm512_dpwssd_epi32(sum, _mm512_maddubs_epi16(s.u, fetch16(from, plane, s)), s.v); };
#pragma GCC unroll 4
  for (int m = 0; m < Channels; ++m) {
    const v16 start = m < colour_count ? _mm512_shldi_epi32(added(c.start_of_upper, first_upper_plane + m), c.lowest_of_start, 8) : c.start_of_alpha;
    out[m] = added(start, m);
  }
}

// What is kept of a level.
SPANTEX_INLINE v16 kept(v16 x) { return _mm512_srli_epi32(x, kept_drop + up_between); }
// Of 8 bits, a pixel's level's.
SPANTEX_INLINE v16 fraction_of(v16 level) { return _mm512_and_si512(level, of32<(1 << q.level_bits) - 1>()); }

// u0.16 in upper halves: of one level, between two. What is kept has ones behind it: together they are before_even.
SPANTEX_INLINE v16 with_ones(v16 x) { return _mm512_shldi_epi32(x, _mm512_set1_epi32(-1), 16 - q.blend_bits); }
SPANTEX_INLINE v16 of_one_level(const constants<rounds::two>& c, v16 x) { return c.even(with_ones(kept(x))); }
SPANTEX_INLINE v16 between(const constants<rounds::two>& c, v16 fine, v16 coarse, v16 fraction) {
  const v16 near = kept(fine);
  return c.even(_mm512_add_epi32(with_ones(near), _mm512_mullo_epi32(_mm512_sub_epi32(kept(coarse), near), _mm512_slli_epi32(fraction, 16 - between_bits))));
}

// Samples: max_linear_sum_bits of fraction, halves to even.
SPANTEX_INLINE v16 sample_of(v16 x) { return _mm512_slli_epi32(kept(x), max_linear_sum_bits - q.blend_bits); }
SPANTEX_INLINE v16 sample_between(v16 fine, v16 coarse, v16 fraction) {
  const v16 near = kept(fine), begun = _mm512_shldi_epi32(near, of32<((1 << (sample_drop - 1)) - 1) << (32 - q.level_bits)>(), q.level_bits);
  const v16 sum = _mm512_add_epi32(begun, _mm512_mullo_epi32(_mm512_sub_epi32(kept(coarse), near), fraction));
  return _mm512_srli_epi32(_mm512_add_epi32(sum, _mm512_and_si512(_mm512_srli_epi32(sum, sample_drop), of32<1>())), sample_drop);
}
// One of them alone, twice one, or the sum of two: u0.16 in upper halves.
template <int Samples = 1>
SPANTEX_INLINE v16 of_samples(const constants<rounds::samples>& c, v16 sum) { return c.even(_mm512_add_epi32(_mm512_slli_epi32(sum, 16 - max_linear_sum_bits - (Samples - 1)), of32<before_even>())); }
// The mean of up to four: inverse is ceil(2^31 / n), which divides what is below 2^29.
SPANTEX_INLINE v16 mean_of(v16 sum, v16 n, v16 inverse) {
  const v16 t = _mm512_add_epi32(sum, _mm512_slli_epi32(n, max_linear_sum_bits - 1)), twice = _mm512_srli_epi32(t, max_linear_sum_bits - 1);
  const v16 even = _mm512_srli_epi64(_mm512_mul_epu32(twice, inverse), 32), odd = _mm512_mul_epu32(_mm512_srli_epi64(twice, 32), _mm512_srli_epi64(inverse, 32));
  const v16 whole = _mm512_mask_mov_epi32(even, 0xAAAA, odd);
  const __mmask16 tie = _mm512_cmpeq_epi32_mask(_mm512_mullo_epi32(whole, _mm512_slli_epi32(n, max_linear_sum_bits)), t);
  return _mm512_slli_epi32(_mm512_mask_andnot_epi32(whole, tie, of32<1>(), whole), 16);
}

// A span's pixels: codes of their numbers, a channel of 64 at once.
template <int Channels>
SPANTEX_INLINE void coded(const v16 (&number)[quads][Channels], v16 (&out)[quads]) {
  // Upper halves of two quads: in each quarter a row of the one, and of the other.
  const v16 rows = _mm512_setr_epi32(0x00030001, 0x00070005, 0x00230021, 0x00270025, 0x000B0009, 0x000F000D, 0x002B0029, 0x002F002D, 0x00130011, 0x00170015, 0x00330031, 0x00370035, 0x001B0019, 0x001F001D, 0x003B0039, 0x003F003D);
  v16 upper[Channels], lower[Channels], codes[colour_count];
#pragma GCC unroll 4
  for (int m = 0; m < Channels; ++m) {
    upper[m] = _mm512_permutex2var_epi16(number[0][m], rows, number[1][m]);
    lower[m] = _mm512_permutex2var_epi16(number[2][m], rows, number[3][m]);
  }
  codes_of_words<colour_count>(upper, lower, codes);
  const v16 alpha = Channels == 4 ? _mm512_packus_epi16(upper[Channels - 1], lower[Channels - 1]) : _mm512_set1_epi32(-1);
#pragma GCC unroll 2
  for (int n = 0; n < quads; n += 2) {
    const auto two = [&](v16 a, v16 b) SPANTEX_INLINED { return n == 0 ? _mm512_unpacklo_epi8(a, b) : _mm512_unpackhi_epi8(a, b); };
    const v16 red_green = two(codes[0], codes[1]), blue_alpha = two(codes[2], alpha);
    out[n] = _mm512_unpacklo_epi16(red_green, blue_alpha);
    out[n + 1] = _mm512_unpackhi_epi16(red_green, blue_alpha);
  }
}

}  // namespace light
