// SPDX-License-Identifier: Apache-2.0
// AVX-512: codes of linear light, sixty-four at once, by tables of bytes that are permuted. The last number that takes a code is looked up after a guess that is the code or the one before it:
// of 4 bits of fraction, linear in pieces of 1024 numbers, below 4096 in pieces of 64. Included by ../vectors/linear_light.hpp alone.
#pragma once

// The first number that takes a code.
constexpr uint32_t first_number_of(uint32_t code) { return code == 0 ? 0 : code > 255 ? 65536 : (srgb_decoded(code - 1) + srgb_decoded(code) + 1) / 2; }

// Pieces below 4096, then the others, by where they begin: what is multiplied by a number (2^-8) and added to that, modulo 2^16.
struct alignas(64) code_guesses {
  uint8_t slope[128], base_low[128], base_high[128];
  bool valid = true;
  constexpr code_guesses() : slope(), base_low(), base_high() {
    for (uint32_t k = 0; k < 64; ++k) add(int(k), 64 * k, 64);
    for (uint32_t k = 4; k < 64; ++k) add(int(64 + k), 1024 * k, 1024);
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

SPANTEX_INLINE v codes_of(v first, v second) {
  const raw a = raw(first), b = raw(second), low_bytes = raw(number<0x00FF00FF>());
  const auto bytes = [&](raw x, raw y) SPANTEX_INLINED { return _mm512_ternarylogic_epi32(low_bytes, x, y, 0xCA); };  // words' lower bytes of x, upper bytes of y
  const auto of_128 = [](const uint8_t* from, raw k) SPANTEX_INLINED { return _mm512_permutex2var_epi8(_mm512_load_si512(from), k, _mm512_load_si512(from + 64)); };
  struct two { raw a, b; };
  const auto words = [&](raw low, raw high) SPANTEX_INLINED { return two{bytes(low, _mm512_slli_epi16(high, 8)), bytes(_mm512_srli_epi16(low, 8), high)}; };
  const __mmask64 is_light = _mm512_cmpge_epu8_mask(bytes(_mm512_srli_epi16(a, 8), b), _mm512_set1_epi8(16));
  const raw dark = bytes(_mm512_srli_epi16(a, 6), _mm512_slli_epi16(b, 2)), light = bytes(_mm512_srli_epi16(a, 10), _mm512_srli_epi16(b, 2));
  const raw piece = _mm512_mask_add_epi8(dark, is_light, light, _mm512_set1_epi8(64)), slope = of_128(code_guess.slope, piece);
  const two base = words(of_128(code_guess.base_low, piece), of_128(code_guess.base_high, piece));
  const auto guessed = [&](raw x, raw by, raw from) SPANTEX_INLINED { return _mm512_add_epi16(from, _mm512_mulhi_epu16(x, by)); };
  const raw guess = bytes(_mm512_srli_epi16(guessed(a, _mm512_slli_epi16(slope, 8), base.a), 4), _mm512_slli_epi16(guessed(b, _mm512_andnot_si512(low_bytes, slope), base.b), 4));
  const __mmask64 upper = _mm512_movepi8_mask(guess);
  const auto of_256 = [&](const uint8_t* from) SPANTEX_INLINED { return _mm512_mask_mov_epi8(of_128(from, guess), upper, of_128(from + 128, guess)); };
  const two last = words(of_256(last_number.low), of_256(last_number.high));
  const raw codes = _mm512_mask_add_epi16(guess, _mm512_cmpgt_epu16_mask(a, last.a), guess, _mm512_set1_epi16(1));
  return v(_mm512_mask_add_epi16(codes, _mm512_cmpgt_epu16_mask(b, last.b), codes, _mm512_set1_epi16(256)));
}
