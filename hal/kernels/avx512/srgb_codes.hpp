// SPDX-License-Identifier: Apache-2.0
// AVX-512: pixels of codes, by rows. Included by ../vectors/linear_light.hpp alone.
#pragma once
#include "code_tables.hpp"

using in_hand = unfinished;  // tables are registers: nothing but numbers is kept for them

SPANTEX_INLINE v codes_of(v first, v second) {
  const raw a = raw(first), b = raw(second);
  raw codes[1];
  codes_of_words(&a, &b, codes);
  return v(codes[0]);
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
