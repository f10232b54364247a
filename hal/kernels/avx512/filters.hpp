// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: fetch, filter and write-out of sixteen pixels. Included by ../avx512.cpp alone.
#pragma once

// Addresses and weights of sixteen pixels on one level, four bytes a pixel: texels (0,0) (1,0) (0,1) (1,1).
struct samples {
  v16 index;           // row of 16, column of 8: what a byte permute of two registers takes
  __mmask64 right;     // in the second column of blocks
  v16 u, v;            // weights: 128 - f, f of 128 in bytes; the same of 2^(7 + Up) in words
};

SPANTEX_INLINE v16 fields(int64_t offsets_of_a_pixel) {  // for multishift: the same of both pixels of a 64-bit lane
  return set(offsets_of_a_pixel | ((offsets_of_a_pixel + 0x20202020) << 32));
}

template <int Up>
SPANTEX_INLINE samples samples16(v16 at) {
  samples s;
  const v16 x = _mm512_add_epi8(_mm512_multishift_epi64_epi8(fields(0x07070707), at), set32(0x01000100));
  const v16 y = _mm512_add_epi8(_mm512_multishift_epi64_epi8(fields(0x14141414), at), set32(0x08080000));  // times 8, three bits of fraction below
  s.index = _mm512_ternarylogic_epi32(y, x, set32(0x07070707), 0xD8);
  s.right = _mm512_test_epi8_mask(x, set32(0x08080808));
  const v16 fu = _mm512_and_si512(at, set32(0x7F)), fu4 = _mm512_shuffle_epi8(fu, _mm512_broadcast_i32x4(_mm_setr_epi8(0, 0, 0, 0, 4, 4, 4, 4, 8, 8, 8, 8, 12, 12, 12, 12)));
  s.u = _mm512_mask_sub_epi8(fu4, 0x5555555555555555, set32(int32_t(0x80808080)), fu4);
  constexpr int64_t from = 16 - Up, weights = 0x7F << Up, all = 128 << Up;
  const v16 fv = _mm512_and_si512(_mm512_multishift_epi64_epi8(fields(from | (from + 8) << 8 | from << 16 | (from + 8) << 24), at), set32(weights | weights << 16));
  s.v = _mm512_mask_sub_epi16(fv, 0x55555555, set32(all | all << 16), fv);
  return s;
}

// One channel's texels, four a pixel.
template <bool Wide>
SPANTEX_INLINE v16 fetch16(const quad_section& from, int channel, const samples& s) {
  const uint8_t* const plane = from.origin + channel * block_channel_bytes;
  const auto block = [&](int64_t at) { return _mm512_load_si512(plane + at); };
  if constexpr (Wide) {
    const v16 left = _mm512_permutex2var_epi8(block(from.near[0]), s.index, block(from.near[1]));
    return _mm512_mask_mov_epi8(left, s.right, _mm512_permutex2var_epi8(block(from.far[0]), s.index, block(from.far[1])));
  } else {
    const v16 top = _mm512_mask_loadu_epi8(block(from.near[0]), from.merged, plane + from.far[0]);
    const v16 bottom = _mm512_mask_loadu_epi8(block(from.near[1]), from.merged, plane + from.far[1]);
    return _mm512_permutex2var_epi8(top, s.index, bottom);
  }
}

// Interpolated on a level, 14 + Up bits of fraction: texels are signed, so 128 is added back with what rounds.
template <bool Wide, int Up>
SPANTEX_INLINE v16 blended16(const quad_section& at, int channel, const samples& s, int32_t rounding) {
  return _mm512_dpwssd_epi32(set32((128 << (14 + Up)) + rounding), _mm512_maddubs_epi16(s.u, fetch16<Wide>(at, channel, s)), s.v);
}

// x + 2^15 - 1 becomes x rounded to 16 bits less, halves to even; in bits 16 to 23.
SPANTEX_INLINE v16 even16(v16 x) { return _mm512_dpwssd_epi32(x, _mm512_and_si512(x, set32(0x10000)), set32(0x10000)); }
constexpr int32_t before_even = 0x7FFF;

// Bytes of two registers' lanes, side by side: a pair of bytes of each, or the third of each in the pair `at`.
SPANTEX_INLINE v16 per_lane(int32_t first) {
  const v16 lane = _mm512_setr_epi32(0x00000000, 0x04040404, 0x08080808, 0x0C0C0C0C, 0x10101010, 0x14141414, 0x18181818, 0x1C1C1C1C, 0x20202020, 0x24242424,
                                     0x28282828, 0x2C2C2C2C, 0x30303030, 0x34343434, 0x38383838, 0x3C3C3C3C);
  return _mm512_add_epi32(lane, set32(first));
}

// Channels' bits 16 to 23 as pixels; three are those of an opaque map.
template <int Channels>
SPANTEX_INLINE v16 packed16(const v16 (&c)[Channels]) {
  static_assert(Channels == 3 || Channels == 4);
  const v16 thirds = per_lane(0x42024202), low = _mm512_permutex2var_epi8(c[0], thirds, c[1]);
  if constexpr (Channels == 4) return _mm512_mask_mov_epi16(low, 0xAAAAAAAA, _mm512_permutex2var_epi8(c[2], thirds, c[3]));
  else return _mm512_mask_mov_epi16(low, 0xAAAAAAAA, _mm512_or_si512(c[2], set32(int32_t(0xFF000000))));
}

constexpr int up_of_one = 2, up_between = 1;  // what makes 16 bits of fraction, and 15: bytes 1 and 2 are then the level's 8.7

template <int Channels, bool Wide>
SPANTEX_INLINE v16 bilinear16(const quad_section& at, const samples& s) {
  v16 c[Channels];
#pragma GCC unroll 4
  for (int k = 0; k < Channels; ++k) c[k] = even16(blended16<Wide, up_of_one>(at, k, s, before_even));
  return packed16(c);
}

// Weights of two levels from a fraction of 8 bits: 512 - 2 f, 2 f of 512.
SPANTEX_INLINE v16 level_weights16(v16 fraction) {
  const v16 twice = _mm512_slli_epi32(fraction, 1);
  return _mm512_or_si512(_mm512_slli_epi32(twice, 16), _mm512_sub_epi32(set32(512), twice));
}

// Two levels, each with 15 bits of fraction and 2^7 added: rounded to 7 bits, then interpolated and written out.
SPANTEX_INLINE v16 between_levels16(v16 fine, v16 coarse, v16 weights) {
  return even16(_mm512_dpwssd_epi32(set32(before_even), _mm512_permutex2var_epi8(fine, per_lane(0x42410201), coarse), weights));
}

// The same where the coarse level has no weight.
SPANTEX_INLINE v16 on_one_level16(v16 fine) { return even16(_mm512_add_epi32(_mm512_slli_epi32(_mm512_srli_epi32(fine, 8), 9), set32(before_even))); }

// To span (sx, work.sy).
SPANTEX_INLINE void write(const row_work& work, int32_t sx, span_mask mask, const v16 (&quad)[quads]) {
  rgba8* row = work.pixels + int64_t(work.sy) * span_side * work.stride + sx * span_side;
  const v8 rows01 = _mm512_setr_epi64(0, 1, 8, 9, 2, 3, 10, 11), rows23 = _mm512_setr_epi64(4, 5, 12, 13, 6, 7, 14, 15);
  const v16 lines[quads] = {_mm512_permutex2var_epi64(quad[0], rows01, quad[1]), _mm512_permutex2var_epi64(quad[0], rows23, quad[1]),
                            _mm512_permutex2var_epi64(quad[2], rows01, quad[3]), _mm512_permutex2var_epi64(quad[2], rows23, quad[3])};
  if (mask == ~span_mask(0)) {
#pragma GCC unroll 4
    for (int n = 0; n < quads; ++n) {
      _mm256_storeu_si256(reinterpret_cast<__m256i*>(row), _mm512_castsi512_si256(lines[n]));
      _mm256_storeu_si256(reinterpret_cast<__m256i*>(row + work.stride), _mm512_extracti64x4_epi64(lines[n], 1));
      row += 2 * int64_t(work.stride);
    }
    return;
  }
  for (int n = 0; n < quads; ++n) {
    _mm256_mask_storeu_epi32(row, __mmask8(mask >> (2 * n * span_side)), _mm512_castsi512_si256(lines[n]));
    _mm256_mask_storeu_epi32(row + work.stride, __mmask8(mask >> ((2 * n + 1) * span_side)), _mm512_extracti64x4_epi64(lines[n], 1));
    row += 2 * int64_t(work.stride);
  }
}
