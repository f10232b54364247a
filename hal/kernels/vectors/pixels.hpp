// SPDX-License-Identifier: Apache-2.0
// Vector kernels: from four texels to a pixel, a channel a 16-bit word. Included by the machines' files alone.
//
// Between x and y, 8.7 each, by f of 2^n: x + (d f) / 2^n, d = y - x. Its whole part R = (d f + 2^(n-1)) >> n is one rounding product, of d and f 2^(15-n);
// x + R is the level's colour as the scalar filter keeps it. What R leaves out, e = d f - R 2^n in [-2^(n-1), 2^(n-1)), decides a half: the lower half of
// the product of d and f 2^(16-n) is e 2^(16-n).
#pragma once

// 8.7 and the sign of what was left out, to whole numbers: halves to even.
SPANTEX_INLINE v even(v x, v rest) {
  const v up = v(v_words(add16(rest, x & number<0x00800080>())) > 0);  // -1; rest has nothing at bit 7 and below
  return v(v_words(subtract16(add16(x, number<0x003F003F>()), up)) >> q.blend_bits);
}

SPANTEX_INLINE v level_colour(const blends& b, int k) { return from_first(rounding_products(b.change[k], b.weight[k]), b.first[k]); }

SPANTEX_INLINE v pixels_of(const blends& b) {
  const auto one = [&](int k) SPANTEX_INLINED { return even(level_colour(b, k), low_products(b.change[k], add16(b.weight[k], b.weight[k]))); };
  return packed(one(0), one(1));
}

// Two levels; fraction of 256 a lane.
SPANTEX_INLINE v pixels_between(const blends& fine, const blends& coarse, v fraction) {
  const v weights = fraction << (15 - q.level_bits);
  const auto one = [&](int k) SPANTEX_INLINED {
    const v near = level_colour(fine, k), change = subtract16(level_colour(coarse, k), near), weight = low_words(weights, k);
    return even(add16(near, rounding_products(change, weight)), low_products(change, add16(weight, weight)));
  };
  return packed(one(0), one(1));
}

// The same where the coarse level has no weight.
SPANTEX_INLINE v pixels_of_level(const blends& b) { return packed(even(level_colour(b, 0), set(0)), even(level_colour(b, 1), set(0))); }

// --- many samples --------------------------------------------------------------------------------------

// Colours of one level, 8.7, added up, two channels a lane, of two pixels a register (blends has them so): both, the odd one times 2^16, modulo 2^32; the odd one alone.
struct colour_sums {
  v both[2] = {}, odd[2] = {};
  SPANTEX_INLINE v even(int k) const { return both[k] - (odd[k] << 16); }
};

// counted: all ones where the lane's pixel has this sample; or every_one has it.
SPANTEX_INLINE void add_colours(colour_sums& s, const blends& b, v counted, bool every_one) {
#pragma GCC unroll 2
  for (int k = 0; k < 2; ++k) {
    v x = level_colour(b, k);
    if (!every_one) x &= low_words(counted, k);
    s.both[k] += x;
    s.odd[k] += v(v_32(x) >> 16);
  }
}
// Of two samples, whose sum still fits 16 bits.
static_assert(2 * (255 << q.blend_bits) < 1 << 16);
SPANTEX_INLINE void add_colours(colour_sums& s, const blends& one, v one_counted, const blends& other, v other_counted, bool every_one) {
#pragma GCC unroll 2
  for (int k = 0; k < 2; ++k) {
    v x = level_colour(one, k), y = level_colour(other, k);
    if (!every_one) {
      x &= low_words(one_counted, k);
      y &= low_words(other_counted, k);
    }
    x = add16(x, y);
    s.both[k] += x;
    s.odd[k] += v(v_32(x) >> 16);
  }
}

// Of `samples` colours between two levels, or on one; fraction of 256. inverse: ceil(2^15 / samples), 2^15 at most, so that a product's upper half is of twice a sum.
template <bool Two>
SPANTEX_INLINE v means_between(const colour_sums& fine, const colour_sums& coarse, v fraction, v samples, v inverse) {
  const auto one = [&](int k) SPANTEX_INLINED {
    const v n = low_words(samples, k), half = (n & 0xFFFF) << 15, f = low_words(fraction, k) & 0xFFFF;
    const auto twice = [&](v near, v far) SPANTEX_INLINED {  // 16 bits of fraction
      const v sum = (near << (q.level_bits + 1)) + half;
      return Two ? sum + (far - near) * (f << 1) : sum;
    };
    const v even = twice(fine.even(k), coarse.even(k)), odd = twice(fine.odd[k], coarse.odd[k]);
    const v sum = halves(v(v_32(even) >> 16), odd), rest = halves(even, odd << 16), whole = upper_products16(add16(sum, sum), low_words(inverse, k));
    const v inexact = least16_unsigned(subtract16(sum, low_products(whole, n)) | rest, number<0x00010001>());
    return subtract16(whole, whole & ~inexact & number<0x00010001>());  // a half: to even
  };
  return packed(one(0), one(1));
}
