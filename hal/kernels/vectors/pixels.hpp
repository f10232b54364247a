// SPDX-License-Identifier: Apache-2.0
// Vector kernels: write-out of interpolated texels. A machine has blends with quad[4], a channel a lane and blend_fraction bits of fraction, packed() of
// four, and lane_of<K>(): lane K of each 16 bytes, all over them. Included by the machines' files alone.
#pragma once

// To whole numbers, halves to even.
SPANTEX_INLINE v even(v x, int fraction) { return (x + ((1 << (fraction - 1)) - 1) + ((x >> fraction) & 1)) >> fraction; }

SPANTEX_INLINE v pixels_of(const blends& b) {
  return packed(even(b.quad[0], blend_fraction), even(b.quad[1], blend_fraction), even(b.quad[2], blend_fraction), even(b.quad[3], blend_fraction));
}

constexpr int blend_drop = blend_fraction - q.blend_bits;

// Two levels, each rounded to blend_bits first; fraction of 256 a lane.
template <int K>
SPANTEX_INLINE v between(const blends& fine, const blends& coarse, v weights) {
  const v near = (fine.quad[K] + (1 << (blend_drop - 1))) >> blend_drop, far = (coarse.quad[K] + (1 << (blend_drop - 1))) << (16 - blend_drop);
  return even(products(halves(near, far), lane_of<K>(weights)), q.blend_bits + q.level_bits);
}
SPANTEX_INLINE v pixels_between(const blends& fine, const blends& coarse, v fraction) {
  const v weights = (fraction << 16) + (256 - fraction);
  return packed(between<0>(fine, coarse, weights), between<1>(fine, coarse, weights), between<2>(fine, coarse, weights), between<3>(fine, coarse, weights));
}

// The same where the coarse level has no weight.
SPANTEX_INLINE v pixels_of_level(const blends& b) {
  const auto one = [](v x) SPANTEX_INLINED { return even((x + (1 << (blend_drop - 1))) >> blend_drop, q.blend_bits); };
  return packed(one(b.quad[0]), one(b.quad[1]), one(b.quad[2]), one(b.quad[3]));
}
