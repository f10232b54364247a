// SPDX-License-Identifier: Apache-2.0
// Vector kernels: the numbers of the series (coordinates.hpp: series_number) as lanes of 32 bits, for machines whose product of such lanes costs no more
// than one of 16-bit halves. x86.hpp keeps them in the upper halves instead. Included by the machines' files alone.
#pragma once

SPANTEX_INLINE v slope_lanes(v e, int slope_log2) { return (e << -slope_log2) >> 16; }
SPANTEX_INLINE v slope_product(v a, v b, int shift) { return (a * b) >> (shift + 16); }
SPANTEX_INLINE v product_with_slope(v x, v slope, int shift) { return ((x >> 16) * slope) >> shift; }
SPANTEX_INLINE v slope_times(v slope, int32_t factor, int shift) { return (slope * factor) >> shift; }
SPANTEX_INLINE v small_products(v a, v b) { return a * b; }  // of numbers from 0 to 2^15 - 1
