// SPDX-License-Identifier: Apache-2.0
// Vector kernels: the series' products, as x86 multiplies both halves of a lane and adds, whatever the registers. Included by the machines' files alone.
#pragma once

// The numbers of the series (coordinates.hpp: series_number): in the upper half of each lane, lower half zero.
SPANTEX_INLINE v upper(v x) { return x & number<int32_t(0xFFFF0000)>(); }
SPANTEX_INLINE v slope_lanes(v twice_e, int slope_log2) { return upper(up_by(twice_e, -1 - slope_log2)); }
SPANTEX_INLINE v slope_product(v a, v b, int slope_log2) { return upper(down_by(products(a, b), -2 - slope_log2)); }
SPANTEX_INLINE v half_slope_square(v a, int slope_log2) { return upper(down_by(products(a, a), -1 - slope_log2)); }
SPANTEX_INLINE v product_with_slope(v x, v slope, int slope_log2) { return down_by(products(x, slope), -2 - slope_log2); }
SPANTEX_INLINE v level_of_slope(v slope, int slope_log2) { return down_by(products(slope, number<int32_t(level_factor.raw()) << 16>()), 11 - slope_log2); }
SPANTEX_INLINE v small_products(v a, v b) { return products(a, b); }  // of numbers from 0 to 2^15 - 1
