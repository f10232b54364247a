// SPDX-License-Identifier: Apache-2.0
// Vector kernels: 64-bit words for machines that nothing is known of. Two texels of a row are one word: its even bytes, then its odd ones, are four
// products each. Included by ../words.cpp alone.
#pragma once

constexpr bool places_first = true, moves_texels = true, spares_levels = true;
constexpr int row_pairs_at_once = 4;  // of positions with levels
typedef int32_t level_number;  // of a pixel, in memory

SPANTEX_INLINE v products(v a, v b) { return ((a << 16) >> 16) * ((b << 16) >> 16) + (a >> 16) * (b >> 16); }  // of both halves of a lane, added up
SPANTEX_INLINE v add_products(v c, v a, v b) { return c + products(a, b); }
SPANTEX_INLINE v halves(v low, v high) { return (low & 0xFFFF) | (high & int32_t(0xFFFF0000)); }
SPANTEX_INLINE v rounded_shift(v x, int shift) { return (x + (1 << (shift - 1))) >> shift; }  // to nearest, halves up
SPANTEX_INLINE v_32 rounded_shift(v_32 x, int shift) { return (x >> shift) + (x >> (shift - 1) & 1); }
SPANTEX_INLINE bool all_equal(v a, int32_t b) {
  const v x = a ^ b;
  uint64_t w[sizeof(v) / sizeof(uint64_t)], all = 0;
  __builtin_memcpy(w, &x, sizeof w);
  for (const uint64_t one : w) all |= one;
  return all == 0;
}

// The numbers of the series (coordinates.hpp: series_number) and their products: of two, and half of a square, numbers again; with the upper half of a
// coordinate; 2 log2 w. Machines whose products are of upper halves keep numbers shifted up.
SPANTEX_INLINE v slope_lanes(v twice_e, int slope_log2) { return (twice_e << (-1 - slope_log2)) >> 16; }
SPANTEX_INLINE v slope_product(v a, v b, int slope_log2) { return (a * b) >> (14 - slope_log2); }
SPANTEX_INLINE v half_slope_square(v a, int slope_log2) { return (a * a) >> (15 - slope_log2); }
SPANTEX_INLINE v product_with_slope(v x, v slope, int slope_log2) { return ((x >> 16) * slope) >> (-2 - slope_log2); }
SPANTEX_INLINE v level_of_slope(v slope, int slope_log2) { return (slope * int32_t(level_factor.raw())) >> (11 - slope_log2); }
SPANTEX_INLINE v small_products(v a, v b) { return a * b; }  // of numbers from 0 to 2^15 - 1

// The lower halves of one's 64-bit lanes and the upper halves of the other's.
SPANTEX_INLINE v lower_and_upper(v_64 lower, v_64 upper) { return v((lower & 0xFFFFFFFF) | (upper & 0xFFFFFFFF00000000)); }

// Of the even lanes.
SPANTEX_INLINE v_64 wide_products(v_64 a, v_64 b) { return (a & 0xFFFFFFFF) * (b & 0xFFFFFFFF); }
SPANTEX_INLINE v_64 wide_signed_products(v_64 a, v_64 b) {
  v_64 x{};
  for (size_t k = 0; k < sizeof x / sizeof x[0]; ++k) x[k] = uint64_t(int64_t(int32_t(uint32_t(a[k]))) * int32_t(uint32_t(b[k])));
  return x;
}
SPANTEX_INLINE v look_up(const int32_t* table, v at) { return v{table[at[0]], table[at[1]], table[at[2]], table[at[3]]}; }

SPANTEX_INLINE void put_words(int16_t* to, v x) {  // saturated
  for (int k = 0; k < width; ++k) to[k] = int16_t(clamp_to(x[k], INT16_MIN, INT16_MAX));
}

// 2x2 texels of each pixel interpolated: two channels a word, 32 bits each, 14 bits of fraction.
struct blends { uint64_t even[width], odd[width]; };
constexpr int blend_fraction = 14, blend_drop = blend_fraction - q.blend_bits;
constexpr uint64_t in_both = 0x0000000100000001, of_bytes = 0x00FF00FF00FF00FF, of_words = 0x0000FFFF0000FFFF;

SPANTEX_INLINE uint64_t word_at(const rgba8* from) {
  uint64_t w;
  __builtin_memcpy(&w, from, sizeof w);
  return w;
}
SPANTEX_INLINE uint64_t spread(uint32_t x) { return (x | uint64_t(x) << 16) & of_words; }

// Four 16-bit numbers, two of the first texel and two of the second, across: in memory's order.
SPANTEX_INLINE uint64_t across(uint64_t x, uint32_t f) {
  constexpr int first = __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__ ? 0 : 32;
  return spread(uint32_t(x >> first)) * (128 - f) + spread(uint32_t(x >> (32 - first))) * f;
}

// fraction: u in the lower half of each lane, v in the upper, of 128.
SPANTEX_INLINE blends blend(const rgba8* top, const uint32_t* top_at, const rgba8* bottom, const uint32_t* bottom_at, v fraction) {
  blends b;
  for (int k = 0; k < width; ++k) {
    const uint64_t row0 = word_at(top + top_at[k]), row1 = word_at(bottom + bottom_at[k]);
    const uint32_t f = uint32_t(fraction[k]), fu = f & 0xFFFF, fv = f >> 16;
    b.even[k] = across((row0 & of_bytes) * (128 - fv) + (row1 & of_bytes) * fv, fu);
    b.odd[k] = across((row0 >> 8 & of_bytes) * (128 - fv) + (row1 >> 8 & of_bytes) * fv, fu);
  }
  return b;
}

// To whole numbers, halves to even.
SPANTEX_INLINE uint64_t even_words(uint64_t x, int fraction) {
  return (x + ((uint64_t(1) << (fraction - 1)) - 1) * in_both + (x >> fraction & in_both)) >> fraction & (of_bytes & of_words);
}
SPANTEX_INLINE uint64_t to_blend_bits(uint64_t x) { return (x + (uint64_t(1) << (blend_drop - 1)) * in_both) >> blend_drop & of_words; }

// Each pixel's even and odd channels, whole numbers.
SPANTEX_INLINE v pixels_from(auto&& channels) {
  v out{};
  for (int k = 0; k < width; ++k) {
    const auto one = [](uint64_t x) { return uint32_t(x) | uint32_t(x >> 16); };
    uint64_t even, odd;
    channels(k, even, odd);
    out[k] = int32_t(one(even) | one(odd) << 8);
  }
  return out;
}

SPANTEX_INLINE v pixels_of(const blends& b) {
  return pixels_from([&](int k, uint64_t& even, uint64_t& odd) {
    even = even_words(b.even[k], blend_fraction);
    odd = even_words(b.odd[k], blend_fraction);
  });
}

// Two levels, each rounded to blend_bits first; fraction of 256 a lane.
SPANTEX_INLINE v pixels_between(const blends& fine, const blends& coarse, v fraction) {
  return pixels_from([&](int k, uint64_t& even, uint64_t& odd) {
    const uint64_t f = uint32_t(fraction[k]);
    const auto one = [&](uint64_t near, uint64_t far) { return even_words(to_blend_bits(near) * (256 - f) + to_blend_bits(far) * f, q.blend_bits + q.level_bits); };
    even = one(fine.even[k], coarse.even[k]);
    odd = one(fine.odd[k], coarse.odd[k]);
  });
}

// The same where the coarse level has no weight.
SPANTEX_INLINE v pixels_of_level(const blends& b) {
  return pixels_from([&](int k, uint64_t& even, uint64_t& odd) {
    even = even_words(to_blend_bits(b.even[k]), q.blend_bits);
    odd = even_words(to_blend_bits(b.odd[k]), q.blend_bits);
  });
}

SPANTEX_INLINE v texels_at(const rgba8* from, const uint32_t* at) {
  v out{};
  for (int k = 0; k < width; ++k) {
    int32_t t;
    __builtin_memcpy(&t, from + at[k], sizeof t);
    out[k] = t;
  }
  return out;
}

// --- many samples --------------------------------------------------------------------------------------

// Colours of one level, 8.7, added up: each pixel's even and odd channels.
struct colour_sums { uint64_t even[width] = {}, odd[width] = {}; };

// counted: all ones where the lane's pixel has this sample.
SPANTEX_INLINE void add_colours(colour_sums& s, const blends& b, v counted, bool) {
  for (int k = 0; k < width; ++k) {
    const uint64_t mask = uint64_t(int64_t(counted[k]));
    s.even[k] += to_blend_bits(b.even[k]) & mask;
    s.odd[k] += to_blend_bits(b.odd[k]) & mask;
  }
}
SPANTEX_INLINE void add_colours(colour_sums& s, const blends& one, v one_counted, const blends& other, v other_counted, bool every_one) {
  add_colours(s, one, one_counted, every_one);
  add_colours(s, other, other_counted, every_one);
}

// Of `samples` colours between two levels, or on one; fraction of 256. inverse: ceil(2^15 / samples).
template <bool Two>
SPANTEX_INLINE v means_between(const colour_sums& fine, const colour_sums& coarse, v fraction, v samples, v inverse) {
  return pixels_from([&](int k, uint64_t& even, uint64_t& odd) {
    const uint64_t f = Two ? uint32_t(fraction[k]) : 0;
    const uint32_t n = uint32_t(samples[k]), y = uint32_t(inverse[k]);
    const auto mean = [&](uint32_t sum) {
      const uint32_t t = sum + (n << 14), whole = ((t >> 15) * y) >> 15;
      return whole - uint32_t((whole * n) << 15 == t) * (whole & 1);  // a half: to even
    };
    const auto both = [&](uint64_t near, uint64_t far) {
      const uint64_t sum = near * (256 - f) + far * f;
      return mean(uint32_t(sum)) | uint64_t(mean(uint32_t(sum >> 32))) << 32;
    };
    even = both(fine.even[k], coarse.even[k]);
    odd = both(fine.odd[k], coarse.odd[k]);
  });
}
