// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: fetch, filter and write-out of sixteen pixels. Included by by_blocks.hpp alone.
#pragma once

// Of opaque maps alpha is not interpolated: the last channel has it above its bits, from what is added to it.
constexpr int32_t opaque = int32_t(0xFF000000);
template <int Channels> constexpr bool with_alpha(int channel) { return Channels < channel_count && channel == Channels - 1; }

// What is drawn of a map's texels: three channels of opaque maps, four of others; colours as they are coded or in linear light, and there as samples of footprints (aniso), which are rounded by themselves.
enum class colours_as : uint8_t { codes, light, samples_in_light };
struct texel_kind {
  int channels;
  colours_as colours;
  constexpr bool in_light() const { return colours != colours_as::codes; }
};

// What a level's weights are shifted up by: it makes 16 bits of fraction, and 15, bytes 1 and 2 of which are the level's 8.7.
constexpr int up_of_one = 2, up_between = 1;

// Addresses and weights of sixteen pixels on one level, four bytes a pixel: texels (0,0) (1,0) (0,1) (1,1).
struct samples {
  v16 index;           // column + 8 row: what a byte permute takes of one register or two
  __mmask64 second;    // of broad sections: those that lie in the second eight columns; of high ones, in the third eight rows
  v16 u, v;            // weights: 128 - f, f of 128 in bytes; the same of 2^(7 + Up) in words
};

// For multishift: the same of both pixels of a 64-bit lane.
constexpr int64_t fields(int64_t offsets_of_a_pixel) { return offsets_of_a_pixel | ((offsets_of_a_pixel + 0x20202020) << 32); }

// What samples16() takes (some of it samples_of_offsets() too), made once, so that it stays in registers: compilers make constants anew where they are needed, and on Zen 4 a load takes longer than
// what it is for. More: bits of fraction that positions have beyond those that they are snapped to.
template <int Up, int More = 0>
struct sampling {
  v16 next, all_u, all_v, row;
  v16 fractions, texels;     // a position's bits
  v16 at_texel, at_u, at_v;  // where its numbers lie
  __mmask64 even;            // bytes or words
  SPANTEX_INLINE sampling() {
    constexpr int32_t all = 128 << Up;
    next = of32<0x09080100>();
    all_u = of32<int32_t(0x80808080)>();
    all_v = of32<all | all << 16>();
    row = of32<0x00080001>();
    constexpr int64_t from = 16 + More - Up;
    fractions = held(of32<0x007F007F << More>());
    texels = held(of32<0x07800780 << More>());
    at_texel = held(of64<fields(0x01010101 * (7 + More))>());
    at_u = held(of64<fields(0x01010101 * More)>());
    at_v = held(of64<fields(from | (from + 8) << 8 | from << 16 | (from + 8) << 24)>());
    __mmask64 every_other = 0x5555555555555555;
    asm("" : "+k"(every_other));
    even = every_other;
  }
};

// Of column + 16 row of sections of 16 columns, four times a pixel: the columns' uppermost bit is no part of the index.
SPANTEX_INLINE samples placed_in_broad(v16 first) {
  const v16 index = _mm512_add_epi8(first, of32<0x11100100>());
  samples s;
  s.index = _mm512_ternarylogic_epi32(_mm512_srli_epi16(index, 1), index, of32<0x07070707>(), 0xD8);
  s.second = _mm512_test_epi8_mask(index, of32<0x08080808>());
  return s;
}

template <held_in Where, int Up, int More>
SPANTEX_INLINE samples samples16(const sampling<Up, More>& c, v16 at) {
  constexpr bool high = Where == held_in::high;  // rows have five bits, not four
  samples s;
  const v16 texels = _mm512_and_si512(at, high ? of32<0x0F800780 << More>() : c.texels), fractions = _mm512_and_si512(at, c.fractions);
  if constexpr (is_broad(Where)) {
    s = placed_in_broad(_mm512_multishift_epi64_epi8(c.at_texel, _mm512_madd_epi16(texels, of32<0x00100001>())));
  } else {
    s.index = _mm512_add_epi8(_mm512_multishift_epi64_epi8(c.at_texel, _mm512_madd_epi16(texels, c.row)), c.next);
    s.second = high ? _mm512_movepi8_mask(s.index) : 0;
  }
  const v16 u = _mm512_multishift_epi64_epi8(c.at_u, fractions), v = _mm512_multishift_epi64_epi8(c.at_v, fractions);
  s.u = _mm512_mask_sub_epi8(u, c.even, c.all_u, u);
  s.v = _mm512_mask_sub_epi16(v, __mmask32(c.even), c.all_v, v);
  return s;
}

// The same fields in u and v of sixteen pixels from their section's first texel, not yet snapped: 32 bits with so many of fraction. What is above and below fields is dropped with them.
struct offset_fields { int64_t texel, row, row_of_broad, u, v; };
struct offset_field_table {
  static constexpr int least_bits = q.coordinate_bits, most_bits = 29;
  offset_fields with_bits[most_bits + 1]{};
  constexpr offset_field_table() {
    for (int bits = least_bits; bits <= most_bits; ++bits) {
      const auto bytes = [](int64_t from) { return fields(0x01010101 * from); };
      const int64_t v = bits - q.subtexel_bits - up_of_one;
      with_bits[bits] = {bytes(bits), bytes(bits - 3), bytes(bits - 4), bytes(bits - q.subtexel_bits), fields(v | (v + 8) << 8 | v << 16 | (v + 8) << 24)};
    }
  }
};
constexpr offset_field_table fields_of_offsets{};

template <held_in Where>
SPANTEX_INLINE samples samples_of_offsets(const sampling<up_of_one>& c, const offset_fields& at, v16 u, v16 v) {
  const auto field = [](int64_t of, v16 x) SPANTEX_INLINED { return _mm512_multishift_epi64_epi8(set(of), x); };
  samples s;
  if constexpr (is_broad(Where)) {
    s = placed_in_broad(_mm512_ternarylogic_epi32(field(at.row_of_broad, v), field(at.texel, u), of32<0x0F0F0F0F>(), 0xD8));
  } else {
    s.index = _mm512_add_epi8(_mm512_ternarylogic_epi32(field(at.row, v), field(at.texel, u), of32<0x07070707>(), 0xD8), c.next);
    s.second = 0;
  }
  const v16 part_u = _mm512_and_si512(field(at.u, u), of32<0x7F7F7F7F>()), part_v = _mm512_and_si512(field(at.v, v), of32<0x007F007F << up_of_one>());
  s.u = _mm512_mask_sub_epi8(part_u, c.even, c.all_u, part_u);
  s.v = _mm512_mask_sub_epi16(part_v, __mmask32(c.even), c.all_v, part_v);
  return s;
}

// One channel's texels, four a pixel.
template <held_in Where>
SPANTEX_INLINE v16 fetch16(const quad_section<Where>& from, int channel, const samples& s) {
  const auto half = [&](int c) SPANTEX_INLINED {
    const auto rows = [&](int r) SPANTEX_INLINED {
      const auto block = [&](int at) SPANTEX_INLINED { return _mm512_loadu_si512(from.at[at][r] + channel * channel_bytes); };
      return _mm512_shrdv_epi64(block(c), block(c + 1), from.shift);
    };
    if constexpr (quad_section<Where>::eights == 1) {
      return _mm512_permutexvar_epi8(s.index, rows(0));
    } else {
      const v16 upper_rows = _mm512_permutex2var_epi8(rows(0), s.index, rows(1));
      if constexpr (Where == held_in::high) return _mm512_mask_permutexvar_epi8(upper_rows, s.second, s.index, rows(2));
      else return upper_rows;
    }
  };
  if constexpr (is_broad(Where)) return _mm512_mask_mov_epi8(half(0), s.second, half(1));
  else return half(0);
}

template <held_in Where, int Channels>
SPANTEX_INLINE void blended16(const quad_section<Where>& at, const samples& s, v16 rounding, v16 (&out)[Channels], v16 of_last) {
#pragma GCC unroll 4
  for (int m = 0; m < Channels; ++m) out[m] = _mm512_dpwssd_epi32(with_alpha<Channels>(m) ? of_last : rounding, _mm512_maddubs_epi16(s.u, fetch16(at, m, s)), s.v);
}

constexpr int32_t before_even = 0x7FFF;

// Made once, so that it stays in a register.
struct to_even {
  v16 one;
  SPANTEX_INLINE to_even() : one(of32<0x10000>()) {}
  // x + before_even becomes x rounded to 16 bits less, halves to even; in bits 16 to 23 or, of linear light, all of the upper half.
  SPANTEX_INLINE v16 even(v16 x) const { return _mm512_dpwssd_epi32(x, _mm512_and_si512(x, one), one); }
};

// What all colours take: made once too.
struct colouring : to_even {
  v16 half, half_of_last, to_upper, level_words, level_signs, level_all;
  v16 from_third;
  __mmask64 upper_words, first_bytes, second_bytes;
  SPANTEX_INLINE colouring() {
    half = of32<before_even>();
    to_upper = held(_mm512_broadcast_i32x4(_mm_setr_epi8(-1, -1, 1, 2, -1, -1, 5, 6, -1, -1, 9, 10, -1, -1, 13, 14)));
    __mmask64 words = 0xCCCCCCCCCCCCCCCC;
    asm("" : "+k"(words));
    upper_words = words;
    half_of_last = of32<opaque + before_even>();
    level_words = held(_mm512_broadcast_i32x4(_mm_setr_epi8(0, -1, 0, -1, 4, -1, 4, -1, 8, -1, 8, -1, 12, -1, 12, -1)));
    level_signs = of32<0x0002FFFE>();
    level_all = of32<512>();
    __mmask64 first = 0x1111111111111111, second = 0x2222222222222222;
    asm("" : "+k"(first), "+k"(second));
    first_bytes = first;
    second_bytes = second;
    from_third = held(_mm512_broadcast_i32x4(_mm_setr_epi8(2, 2, -1, -1, 6, 6, -1, -1, 10, 10, -1, -1, 14, 14, -1, -1)));
  }

  // Channels' bits 16 to 23 as pixels; three are those of an opaque map, the last of which has alpha above its bits.
  template <int Channels>
  SPANTEX_INLINE v16 packed(const v16 (&c)[Channels]) const {
    static_assert(Channels == 3 || Channels == 4);
    const v16 two = _mm512_mask_shuffle_epi8(c[2], second_bytes, c[1], from_third), three = _mm512_mask_shuffle_epi8(two, first_bytes, c[0], from_third);
    if constexpr (Channels == 4) return _mm512_ternarylogic_epi32(of32<0xFFFFFF>(), three, _mm512_slli_epi32(c[3], 8), 0xCA);
    else return three;
  }

  // Weights of two levels from the lowest 8 bits: 512 - 2 f, 2 f of 512.
  SPANTEX_INLINE v16 level_weights(v16 level) const { return _mm512_add_epi16(_mm512_mullo_epi16(_mm512_shuffle_epi8(level, level_words), level_signs), level_all); }

  // Two levels, each with 15 bits of fraction and 2^7 added: rounded to 7 bits, then interpolated and added to a sum, 16 bits of fraction.
  SPANTEX_INLINE v16 summed(v16 sum, v16 fine, v16 coarse, v16 weights) const {
    return _mm512_dpwssd_epi32(sum, _mm512_mask_shuffle_epi8(_mm512_srli_epi32(fine, 8), upper_words, coarse, to_upper), weights);
  }

  // The same written out.
  SPANTEX_INLINE v16 between_levels(v16 fine, v16 coarse, v16 weights, v16 rounding) const { return even(summed(rounding, fine, coarse, weights)); }

  // The same where the coarse level has no weight.
  SPANTEX_INLINE v16 on_one_level(v16 fine, v16 rounding) const { return even(_mm512_add_epi32(_mm512_slli_epi32(_mm512_srli_epi32(fine, 8), 9), rounding)); }

  // What is added to channel m's 16 bits of fraction: what rounds, and what packed() takes for alpha.
  template <int Channels>
  SPANTEX_INLINE v16 rounding_of(int m) const { return with_alpha<Channels>(m) ? half_of_last : half; }
};

template <int Channels, held_in Where>
SPANTEX_INLINE v16 bilinear16(const colouring& as, const quad_section<Where>& at, const samples& s) {
  v16 c[Channels];
  constexpr int32_t rounding = (128 << (14 + up_of_one)) + before_even;
  blended16(at, s, of32<rounding>(), c, of32<opaque + rounding>());
#pragma GCC unroll 4
  for (int k = 0; k < Channels; ++k) c[k] = as.even(c[k]);
  return as.packed(c);
}

// The left and right quad of a span's upper or lower half, from its first row on.
SPANTEX_INLINE void write_half(rgba8* row, int64_t stride, v16 left, v16 right) {
  const v16 lines[2] = {_mm512_permutex2var_epi64(left, _mm512_setr_epi64(0, 1, 8, 9, 2, 3, 10, 11), right),
                        _mm512_permutex2var_epi64(left, _mm512_setr_epi64(4, 5, 12, 13, 6, 7, 14, 15), right)};
#pragma GCC unroll 2
  for (int n = 0; n < 2; ++n) {
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(row + 2 * n * stride), _mm512_castsi512_si256(lines[n]));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(row + (2 * n + 1) * stride), _mm512_extracti64x4_epi64(lines[n], 1));
  }
}

SPANTEX_INLINE rgba8* first_of_span(const row_work& work, int32_t sx) { return work.pixels + sx * span_side; }

// Quads of two columns: rows of each are pairs of pixels.
SPANTEX_INLINE void write_tall(rgba8* row, int64_t stride, const v16 (&quad)[quads]) {
  const v16 first[2] = {_mm512_unpacklo_epi64(quad[0], quad[1]), _mm512_unpackhi_epi64(quad[0], quad[1])}, last[2] = {_mm512_unpacklo_epi64(quad[2], quad[3]), _mm512_unpackhi_epi64(quad[2], quad[3])};
#pragma GCC unroll 2
  for (int odd = 0; odd < 2; ++odd)
#pragma GCC unroll 2
    for (int half = 0; half < 2; ++half) {
      const v16 lanes = half == 0 ? _mm512_setr_epi64(0, 1, 8, 9, 2, 3, 10, 11) : _mm512_setr_epi64(4, 5, 12, 13, 6, 7, 14, 15), rows = _mm512_permutex2var_epi64(first[odd], lanes, last[odd]);
      rgba8* const to = row + (4 * half + odd) * stride;
      _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), _mm512_castsi512_si256(rows));
      _mm256_storeu_si256(reinterpret_cast<__m256i*>(to + 2 * stride), _mm512_extracti64x4_epi64(rows, 1));
    }
}

// A flat quad's two.
SPANTEX_INLINE void write_rows(rgba8* row, int64_t stride, v16 quad) {
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(row), _mm512_castsi512_si256(quad));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(row + stride), _mm512_extracti64x4_epi64(quad, 1));
}

// To span (sx, work.sy).
SPANTEX_INLINE void write(const row_work& work, int32_t sx, span_mask mask, const v16 (&quad)[quads], cut how = cut::square) {
  alignas(64) rgba8 pixels[span_pixel_count];
  rgba8* row = first_of_span(work, sx);
  const bool all = mask == ~span_mask(0);
  rgba8* const to = all ? row : pixels;
  const int64_t stride = all ? work.stride : span_side;
  if (how == cut::flat) {
#pragma GCC unroll 4
    for (int n = 0; n < quads; ++n) write_rows(to + 2 * n * stride, stride, quad[n]);
  } else if (how == cut::tall) {
    write_tall(to, stride, quad);
  } else {
    write_half(to, stride, quad[0], quad[1]);
    write_half(to + quad_side * stride, stride, quad[2], quad[3]);
  }
  if (all) return;
  for (int y = 0; y < span_side; ++y, row += work.stride)
    _mm256_mask_storeu_epi32(row, __mmask8(mask >> (y * span_side)), _mm256_load_si256(reinterpret_cast<const __m256i*>(pixels + y * span_side)));
}
