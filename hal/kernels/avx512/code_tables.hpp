// SPDX-License-Identifier: Apache-2.0
// AVX-512: codes of linear light, sixty-four at once, by tables of bytes that are permuted. The last number that takes a code is looked up after a guess that is the code or the one before it:
// of 4 bits of fraction, linear in pieces: of 64 numbers below 4352, one of 768, then of 1024. Included by by_blocks.hpp and srgb_codes.hpp alone.
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

// Of so many channels, step by step side by side: each is a chain of dependent operations, and a step's table is loaded once. In each quarter the codes of the first's words, then of the second's.
template <int Channels>
SPANTEX_INLINE void codes_of_words(const __m512i* first, const __m512i* second, __m512i (&codes)[Channels]) {
  using raw = __m512i;
  struct words { raw first, second; };
  const raw no_bytes = _mm512_setzero_si512();
  const auto each = [](auto&& of) SPANTEX_INLINED {
#pragma GCC unroll 3
    for (int m = 0; m < Channels; ++m) of(m);
  };
  const auto together = [](raw low, raw high) SPANTEX_INLINED { return words{_mm512_unpacklo_epi8(low, high), _mm512_unpackhi_epi8(low, high)}; };
  const auto of_128 = [](const uint8_t* from, raw k) SPANTEX_INLINED { return _mm512_permutex2var_epi8(_mm512_load_si512(from), k, _mm512_load_si512(from + 64)); };
  raw piece[Channels], low[Channels], high[Channels];
  words slope[Channels];
  each([&](int m) SPANTEX_INLINED {
    const auto down = [&](int by) SPANTEX_INLINED { return _mm512_packus_epi16(_mm512_srli_epi16(first[m], by), _mm512_srli_epi16(second[m], by)); };
    piece[m] = _mm512_min_epu8(down(6), _mm512_add_epi8(down(10), _mm512_set1_epi32(number32<0x40404040>[0])));
  });
  each([&](int m) SPANTEX_INLINED { slope[m] = together(no_bytes, of_128(code_guess.slope, piece[m])); });
  each([&](int m) SPANTEX_INLINED { low[m] = of_128(code_guess.base_low, piece[m]); });
  each([&](int m) SPANTEX_INLINED { high[m] = of_128(code_guess.base_high, piece[m]); });
  each([&](int m) SPANTEX_INLINED {
    const auto guessed = [](raw x, raw by, raw from) SPANTEX_INLINED { return _mm512_srli_epi16(_mm512_add_epi16(from, _mm512_mulhi_epu16(x, by)), 4); };
    const words base = together(low[m], high[m]);
    codes[m] = _mm512_packus_epi16(guessed(first[m], slope[m].first, base.first), guessed(second[m], slope[m].second, base.second));
  });
  const auto look_up_last = [&](const uint8_t* table, raw (&last)[Channels]) SPANTEX_INLINED {
    each([&](int m) SPANTEX_INLINED { last[m] = of_128(table, codes[m]); });
    each([&](int m) SPANTEX_INLINED { last[m] = _mm512_mask_mov_epi8(last[m], _mm512_movepi8_mask(codes[m]), of_128(table + 128, codes[m])); });
  };
  look_up_last(last_number.low, low);
  look_up_last(last_number.high, high);
  each([&](int m) SPANTEX_INLINED {
    const words last = together(low[m], high[m]);
    const raw beyond = _mm512_packus_epi16(_mm512_subs_epu16(first[m], last.first), _mm512_subs_epu16(second[m], last.second));
    codes[m] = _mm512_add_epi8(codes[m], _mm512_min_epu8(beyond, _mm512_set1_epi32(number32<0x01010101>[0])));
  });
}
