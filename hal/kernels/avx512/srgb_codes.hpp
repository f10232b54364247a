// SPDX-License-Identifier: Apache-2.0
// AVX-512: codes of linear light, sixty-four at once, by tables of bytes that are permuted. The last number that takes a code is looked up after a guess that is the code or the one before it:
// of 4 bits of fraction, linear in pieces: of 64 numbers below 4352, one of 768, then of 1024. Included by ../vectors/linear_light.hpp alone.
#pragma once

// The first number that takes a code.
constexpr uint32_t first_number_of(uint32_t code) { return code == 0 ? 0 : code > 255 ? 65536 : (srgb_decoded(code - 1) + srgb_decoded(code) + 1) / 2; }

// Pieces by the lesser of x / 64 and 64 + x / 1024: what is multiplied by a number x (2^-8) and added to that, modulo 2^16.
struct alignas(64) code_guesses {
  static constexpr uint32_t fine_pieces = 68;
  uint8_t slope[128], base_low[128], base_high[128];
  bool valid = true;
  constexpr code_guesses() : slope(), base_low(), base_high() {
    for (uint32_t k = 0; k < 128; ++k) {
      const uint32_t begin = k <= fine_pieces ? 64 * k : 1024 * (k - 64), end = k < fine_pieces ? 64 * (k + 1) : 1024 * (k - 63);
      add(int(k), begin, end - begin);
    }
  }

 private:
  constexpr void add(int k, uint32_t begin, uint32_t count) {
    const uint32_t end = begin + count;
    uint32_t first = 0;
    while (first_number_of(first + 1) <= begin) ++first;
    uint32_t last = first;
    while (first_number_of(last + 1) < end) ++last;
    const uint32_t apart = first_number_of(last) - first_number_of(first);
    slope[k] = apart == 0 ? 0 : uint8_t((((last - first) << 12) + apart / 2) / apart);
    const auto product = [&](uint32_t x) { return int32_t(x * slope[k] >> 8); };
    int32_t base = INT32_MAX;  // as large as guesses let it that are no larger than the codes
    for (uint32_t c = first; c <= last; ++c) base = min_of(base, int32_t(16 * c + 15) - product(min_of(first_number_of(c + 1), end) - 1));
    for (uint32_t c = first; c <= last; ++c) valid &= base + product(max_of(first_number_of(c), begin)) >= 16 * max_of(int32_t(c) - 1, 0);
    base_low[k] = uint8_t(uint32_t(base));
    base_high[k] = uint8_t(uint32_t(base) >> 8);
  }
};
constexpr code_guesses code_guess;
static_assert(code_guess.valid);

struct alignas(64) last_numbers {
  uint8_t low[256], high[256];
  constexpr last_numbers() : low(), high() {
    for (uint32_t c = 0; c < 256; ++c) {
      low[c] = uint8_t(first_number_of(c + 1) - 1);
      high[c] = uint8_t((first_number_of(c + 1) - 1) >> 8);
    }
  }
};
constexpr last_numbers last_number;

// Two words a lane: of the first in the lower halves of each quarter's bytes, of the second in the upper ones.
SPANTEX_INLINE v codes_of(v first, v second) {
  const raw a = raw(first), b = raw(second), low_bytes = _mm512_setzero_si512();
  struct two { raw a, b; };
  const auto down = [&](int by) SPANTEX_INLINED { return _mm512_packus_epi16(_mm512_srli_epi16(a, by), _mm512_srli_epi16(b, by)); };
  const auto words = [](raw low, raw high) SPANTEX_INLINED { return two{_mm512_unpacklo_epi8(low, high), _mm512_unpackhi_epi8(low, high)}; };
  const auto of_128 = [](const uint8_t* from, raw k) SPANTEX_INLINED { return _mm512_permutex2var_epi8(_mm512_load_si512(from), k, _mm512_load_si512(from + 64)); };
  const raw piece = _mm512_min_epu8(down(6), _mm512_add_epi8(down(10), raw(number<0x40404040>())));
  const two slope = words(low_bytes, of_128(code_guess.slope, piece)), base = words(of_128(code_guess.base_low, piece), of_128(code_guess.base_high, piece));
  const auto guessed = [](raw x, raw by, raw from) SPANTEX_INLINED { return _mm512_srli_epi16(_mm512_add_epi16(from, _mm512_mulhi_epu16(x, by)), 4); };
  const raw guess = _mm512_packus_epi16(guessed(a, slope.a, base.a), guessed(b, slope.b, base.b));
  const __mmask64 upper = _mm512_movepi8_mask(guess);
  const auto of_256 = [&](const uint8_t* from) SPANTEX_INLINED { return _mm512_mask_mov_epi8(of_128(from, guess), upper, of_128(from + 128, guess)); };
  const two last = words(of_256(last_number.low), of_256(last_number.high));
  const raw beyond = _mm512_packus_epi16(_mm512_subs_epu16(a, last.a), _mm512_subs_epu16(b, last.b));
  return v(_mm512_add_epi8(guess, _mm512_min_epu8(beyond, raw(number<0x01010101>()))));
}

// Bytes as codes_of() has them, of pixels 0 and 1 of every four, then 2 and 3, a channel after the other; to pixels.
SPANTEX_INLINE v pixel_order() { return of_each_quarter(_mm_setr_epi8(0, 2, 4, 6, 1, 3, 5, 7, 8, 10, 12, 14, 9, 11, 13, 15)); }

SPANTEX_INLINE v finished(const unfinished& of) {
  constexpr __mmask64 alpha = 0xC0C0C0C0C0C0C0C0;
  const raw all = _mm512_mask_mov_epi8(raw(codes_of(of.first, of.second)), alpha, _mm512_packus_epi16(raw(of.first), raw(of.second)));
  return v(_mm512_shuffle_epi8(all, raw(pixel_order())));
}

// A span of an opaque map: three groups of pixels have one more of the fourth's channels each in place of alpha, which has no code.
constexpr int groups_together = 4;
SPANTEX_INLINE void finish_opaque(const unfinished (&of)[groups_together], v (&pixels)[groups_together]) {
  constexpr int last = groups_together - 1;
  constexpr __mmask16 alpha = 0x8888;
  constexpr __mmask64 of_pixels = 0x1111111111111111;  // a channel's bytes
  const raw opaque = _mm512_set1_epi32(-1), alphas = raw(of_each_quarter(_mm_setr_epi8(6, 6, 6, 6, 7, 7, 7, 7, 14, 14, 14, 14, 15, 15, 15, 15)));
  raw of_last = opaque;
  const auto finish = [&]<int N>() SPANTEX_INLINED {
    const auto with = [&](v x, v of_the_last) SPANTEX_INLINED { return v(_mm512_mask_shuffle_epi32(raw(x), alpha, raw(of_the_last), _MM_PERM_ENUM(0x55 * N))); };
    const raw codes = raw(codes_of(with(of[N].first, of[last].first), with(of[N].second, of[last].second)));
    pixels[N] = v(_mm512_mask_shuffle_epi8(opaque, 7 * of_pixels, codes, raw(pixel_order())));
    of_last = _mm512_mask_shuffle_epi8(of_last, of_pixels << N, codes, alphas);
  };
  finish.template operator()<0>();
  finish.template operator()<1>();
  finish.template operator()<2>();
  pixels[last] = v(of_last);
}
