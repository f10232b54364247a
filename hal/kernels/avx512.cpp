// SPDX-License-Identifier: Apache-2.0
// AVX-512 with VBMI: eight spans of a row are planned at once, one 64-bit lane each; then each span's 64 pixels are computed, sixteen 32-bit
// lanes at a time. Local memory is registers: a channel of 16x16 texels is four of them, and a byte permute of two registers is 64 fetches.
//
// Every number equals the scalar datapath's (docs/SPEC.md). Rounding shifts are folded: floor(floor(x / 2^a) + k) / 2^b) = floor((x + k 2^a) / 2^(a + b)),
// so a position is rounded to coordinate_bits and then snapped in one addition and one shift; addresses in local memory are taken modulo its
// side, so positions may wrap around in 32 bits.
#include "kernel.hpp"

#if defined(__x86_64__)
#include <immintrin.h>

#include <spantex/coordinates.hpp>
#include <spantex/level.hpp>
#include <spantex/reciprocal.hpp>

// What the headers define stays compiled for any machine.
#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx512f,avx512bw,avx512cd,avx512dq,avx512vl,avx512vbmi,avx512vnni"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx512f,avx512bw,avx512cd,avx512dq,avx512vl,avx512vbmi,avx512vnni")
#endif

namespace spantex::kernels {
namespace {

constexpr profile q = profiles::standard;
static_assert(q.offset_bits == 31 && q.reciprocal_bits == 30 && q.subtexel_bits == 7 && q.level_bits == 8 && q.blend_bits == 7 && q.fine_side == 16 &&
              q.coordinate_bits <= 16 && q.level_bias == 0 && q.formula == level_formula::jacobian && q.scope == level_scope::pixel &&
              q.overflow == overflow_policy::split && q.position_rounding == rounding::nearest && q.exact_set_up && q.colour_rounding == rounding::even,
              "the kernel is written for these");
static_assert(max_extent_log2 == 12 && reach == 7 && reciprocal_seed_bits == 7);

using v8 = __m512i;   // eight 64-bit lanes: a span each
using v16 = __m512i;  // sixteen 32-bit lanes: a pixel each

constexpr int batch_size = 8;

// What a batch of spans needs below the planner: span_coefficients of eight spans, side by side.
struct alignas(64) batch {
  int32_t c_u[batch_size], a_u[batch_size], b_u[batch_size], c_v[batch_size], a_v[batch_size], b_v[batch_size];
  int32_t g[batch_size], h[batch_size];
  int32_t base_u[batch_size], base_v[batch_size];       // modulo the map's period
  int32_t exponent[batch_size], slope_log2[batch_size];
  int32_t terms[batch_size];                             // 0: affine, 1..4: series, 5: divide
  // Level 0: where the sections of the four quads lie (quad_sections), of spans that are flat enough to tell without their pixels.
  int32_t at[2][2][4][batch_size], column[4][batch_size];
  alignas(64) int32_t low[4][2][batch_size], high[4][2][batch_size];  // of each quad, u and v: every position, s15.16
  alignas(64) int64_t u_x[batch_size], v_x[batch_size], u_y[batch_size], v_y[batch_size], twist_u[batch_size], twist_v[batch_size];  // level.hpp: span_levels()
  uint32_t usable;                                       // bit k: span k is in here
  uint32_t flat;                                         // bit k: low and high are known
  uint32_t placed, wide;                                 // bit k: its sections are known; one of them is more than 8 texels across
};
constexpr int divide_terms = 5;

[[gnu::always_inline]] inline v8 bit_length(v8 x) { return _mm512_sub_epi64(_mm512_set1_epi64(64), _mm512_lzcnt_epi64(x)); }
[[gnu::always_inline]] inline v8 set(int64_t x) { return _mm512_set1_epi64(x); }

struct inverse8 { v8 y, exponent; };

[[gnu::always_inline]] inline v8 newton(v8 m, v8 y) {
  const v8 error = _mm512_sub_epi64(set(INT64_MIN), _mm512_mul_epu32(m, y));
  const v8 next = _mm512_add_epi64(y, _mm512_srai_epi64(_mm512_mullo_epi64(y, _mm512_srai_epi64(error, 32)), 31));
  return _mm512_min_epi64(next, set(0xFFFFFFFF));
}

// reciprocal_wide() of 32-bit m in 64-bit lanes.
[[gnu::always_inline]] inline v8 reciprocal8(v8 m) {
  const v8 k = _mm512_and_si512(_mm512_srli_epi64(m, 24), set(127));
  const uint16_t* t = reciprocal_seeds.seed;
  const v8 low = _mm512_permutex2var_epi16(_mm512_loadu_si512(t), k, _mm512_loadu_si512(t + 32));
  const v8 high = _mm512_permutex2var_epi16(_mm512_loadu_si512(t + 64), k, _mm512_loadu_si512(t + 96));
  const v8 seed = _mm512_mask_mov_epi64(low, _mm512_test_epi64_mask(k, set(64)), high);
  const v8 y = _mm512_slli_epi64(_mm512_and_si512(seed, set(0xFFFF)), 16);
  return newton(m, newton(m, y));
}

[[gnu::always_inline]] inline inverse8 invert8(v8 w) {
  const v8 zeros = _mm512_lzcnt_epi64(w);
  return {reciprocal8(_mm512_srli_epi64(_mm512_sllv_epi64(w, zeros), 32)), _mm512_sub_epi64(set(32), zeros)};
}

// quotient() with its shift given: 63 + exponent - drop - scale.
[[gnu::always_inline]] inline v8 quotient8(v8 n, v8 drop, v8 y, v8 shift) {
  const v8 product = _mm512_mul_epu32(_mm512_srlv_epi64(_mm512_abs_epi64(n), drop), y);
  const v8 half = _mm512_sllv_epi64(set(1), _mm512_sub_epi64(shift, set(1)));
  const v8 magnitude = _mm512_srlv_epi64(_mm512_add_epi64(product, half), shift);
  return _mm512_mask_sub_epi64(magnitude, _mm512_movepi64_mask(n), _mm512_setzero_si512(), magnitude);
}

[[gnu::always_inline]] inline v8 whole_quotient8(v8 n, v8 w_bits, const inverse8& iw, __mmask8& usable) {
  const v8 bits = bit_length(_mm512_abs_epi64(n));
  const v8 drop = _mm512_max_epi64(_mm512_sub_epi64(bits, set(31)), _mm512_setzero_si512());
  const v8 shift = _mm512_sub_epi64(_mm512_add_epi64(iw.exponent, set(63)), drop);
  const v8 r = quotient8(n, drop, iw.y, shift);
  usable &= _mm512_cmple_epi64_mask(bits, _mm512_add_epi64(w_bits, set(15)));
  usable &= _mm512_cmple_epi64_mask(_mm512_abs_epi64(r), set(32767 - 4098));  // no position saturates
  return r;
}

[[gnu::always_inline]] inline v8 times7(v8 x) { return _mm512_sub_epi64(_mm512_slli_epi64(x, 3), x); }

[[gnu::always_inline]] inline void keep(int32_t (&to)[batch_size], v8 x) { _mm256_store_si256(reinterpret_cast<__m256i*>(to), _mm512_cvtepi64_epi32(x)); }
[[gnu::always_inline]] inline __m256i got(const int32_t (&from)[batch_size]) { return _mm256_load_si256(reinterpret_cast<const __m256i*>(from)); }

// --- sixteen pixels ------------------------------------------------------------------------------------

[[gnu::always_inline]] inline v16 set32(int32_t x) { return _mm512_set1_epi32(x); }
[[gnu::always_inline]] inline v16 upper() { return set32(int32_t(0xFFFF0000)); }

// q of the series in the upper half of each lane, lower half zero.
template <int Terms>
[[gnu::always_inline]] inline v16 series16(v16 e, v16 slope_log2) {
  const v16 e16 = _mm512_and_si512(_mm512_sllv_epi32(e, _mm512_sub_epi32(_mm512_setzero_si512(), slope_log2)), upper());
  const v16 drop = _mm512_sub_epi32(set32(-2), slope_log2);
  v16 r = e16;
#pragma GCC unroll 4
  for (int k = 1; k < Terms; ++k)
    r = _mm512_sub_epi32(e16, _mm512_and_si512(_mm512_srav_epi32(_mm512_madd_epi16(e16, r), drop), upper()));
  return r;
}

[[gnu::always_inline]] inline v16 by_series16(v16 n, v16 r, v16 drop) {
  return _mm512_sub_epi32(n, _mm512_srav_epi32(_mm512_madd_epi16(n, r), drop));
}

// 1/w of sixteen pixels, u1.30, as even and odd lanes in 64 bits each.
struct reciprocals16 { v8 even, odd; };
[[gnu::always_inline]] inline v8 reciprocal_of_w8(v8 w) {  // reciprocal_of_w(w, 30)
  const __mmask8 small = _mm512_cmplt_epu64_mask(w, set(int64_t(1) << 30));
  const v8 one = set(1), two = _mm512_add_epi64(one, one);
  const v8 m = _mm512_sllv_epi64(w, _mm512_mask_mov_epi64(one, small, two));
  const v8 y = reciprocal8(m);
  const v8 shift = _mm512_mask_mov_epi64(two, small, one), half = _mm512_mask_mov_epi64(two, small, one);
  return _mm512_srlv_epi64(_mm512_add_epi64(y, half), shift);
}
[[gnu::always_inline]] inline reciprocals16 reciprocal16(v16 e) {
  const v16 w = _mm512_add_epi32(e, set32(1 << 30));
  return {reciprocal_of_w8(_mm512_and_si512(w, set(0xFFFFFFFF))), reciprocal_of_w8(_mm512_srli_epi64(w, 32))};
}

// n / w with 14 fraction bits, rounded, as for coordinate_bits.
[[gnu::always_inline]] inline v16 by_divide16(v16 n, const reciprocals16& r, v8 shift) {
  const v8 half = _mm512_sllv_epi64(set(1), _mm512_sub_epi64(shift, set(1)));
  const auto one = [&](v8 x, v8 y) { return _mm512_srav_epi64(_mm512_add_epi64(_mm512_mul_epi32(x, y), half), shift); };
  const v8 even = one(n, r.even), odd = one(_mm512_srli_epi64(n, 32), r.odd);
  return _mm512_mask_mov_epi32(even, 0xAAAA, _mm512_slli_epi64(odd, 32));
}

// --- eight spans ---------------------------------------------------------------------------------------

[[gnu::always_inline]] inline v8 modulo(v8 base, int32_t period) {
  if (period == 0) return base;
  if ((period & (period - 1)) == 0) return _mm512_and_si512(base, set(period - 1));
  // floor(base / period) by a reciprocal of 2^40: base is below 2^15, so the error stays below one step
  const v8 shifted = _mm512_add_epi64(base, set(int64_t(period) * (32768 / period + 1)));
  const v8 times = _mm512_srli_epi64(_mm512_mullo_epi64(shifted, set(((int64_t(1) << 40) + period - 1) / period)), 40);
  return _mm512_sub_epi64(shifted, _mm512_mullo_epi64(times, set(period)));
}

[[gnu::always_inline]] inline v16 pair_of(const int32_t (&u)[batch_size], const int32_t (&v)[batch_size]) {
  return _mm512_inserti64x4(_mm512_castsi256_si512(got(u)), got(v), 1);
}

// Sections of level 0 for a filter of 2x2 texels, from the parallelogram that a quad would be if nothing were divided: 1/w moves a position by less
// than 2^(extent + slope + 1/2), here at most half a texel. u in the lower eight lanes, v in the upper.
[[gnu::always_inline]] inline void place(const row_work& work, __mmask8 flat, batch& b) {
  const planar_map& map = *work.texels;
  const planar_level& texels = map.level(0);
  const v16 a = pair_of(b.a_u, b.a_v), d = pair_of(b.b_u, b.b_v), x = _mm512_broadcast_i64x4(got(b.exponent));
  const v16 reach_of_quad = _mm512_add_epi32(_mm512_abs_epi32(a), _mm512_abs_epi32(d));
  const v16 margin = _mm512_sllv_epi32(set32(1), _mm512_sub_epi32(x, set32(1)));  // half a texel: 1/w and every rounding
  const v16 spread = _mm512_add_epi32(_mm512_add_epi32(reach_of_quad, _mm512_slli_epi32(reach_of_quad, 1)), margin);
  const v16 right = _mm512_slli_epi32(a, 2), below = _mm512_slli_epi32(d, 2), middle = pair_of(b.c_u, b.c_v);
  const v16 to16 = _mm512_sub_epi32(x, set32(16)), base = _mm512_slli_epi32(pair_of(b.base_u, b.base_v), 16);
  const v16 last = _mm512_inserti64x4(_mm512_castsi256_si512(_mm256_set1_epi32(texels.last_column)), _mm256_set1_epi32(texels.last_row), 1);
  const __mmask16 strict = __mmask16((map.period_u() != 0 ? 0xFF : 0) | (map.period_v() != 0 ? 0xFF00 : 0));
  __mmask16 fit = 0xFFFF, wide = 0;
#pragma GCC unroll 4
  for (int n = 0; n < 4; ++n) {
    const v16 across = n & 1 ? _mm512_add_epi32(middle, right) : _mm512_sub_epi32(middle, right);
    const v16 centre = n & 2 ? _mm512_add_epi32(across, below) : _mm512_sub_epi32(across, below);
    const v16 low = _mm512_add_epi32(base, _mm512_srav_epi32(_mm512_sub_epi32(centre, spread), to16));
    const v16 high = _mm512_add_epi32(base, _mm512_srav_epi32(_mm512_add_epi32(centre, spread), to16));
    _mm512_store_si512(b.low[n], low);
    _mm512_store_si512(b.high[n], high);
    const auto texel = [&](v16 position) { return _mm512_srai_epi32(_mm512_sub_epi32(position, set32(1 << 15)), 16); };
    const v16 first = texel(low), end = _mm512_add_epi32(texel(high), set32(1));
    const v16 block0 = _mm512_srai_epi32(first, 3), block1 = _mm512_srai_epi32(end, 3);
    const __mmask16 large = _mm512_cmpgt_epi32_mask(_mm512_sub_epi32(end, first), set32(7)) & 0xFF;
    fit = __mmask16(fit & (_mm512_cmple_epi32_mask(_mm512_sub_epi32(block1, block0), set32(1)) | (0xFF & ~large)));
    wide |= large;
    const auto held = [&](v16 k) { return _mm512_max_epi32(_mm512_min_epi32(k, last), set32(-apron)); };
    const v16 k0 = held(block0), k1 = held(block1);
    fit = __mmask16(fit & ~(strict & (_mm512_cmpneq_epi32_mask(k0, block0) | _mm512_cmpneq_epi32_mask(k1, block1))));
    const __mmask16 swap = _mm512_test_epi32_mask(block0, set32(1)) & (0xFF00 | large);
    const v16 bytes = _mm512_inserti64x4(_mm512_castsi256_si512(_mm256_set1_epi32(block_bytes)), _mm256_set1_epi32(texels.stride), 1);
    const v16 even = _mm512_mullo_epi32(_mm512_mask_mov_epi32(k0, swap, k1), bytes), odd = _mm512_mullo_epi32(_mm512_mask_mov_epi32(k1, swap, k0), bytes);
    const auto store = [](int32_t (&to)[batch_size], __m256i y) { _mm256_store_si256(reinterpret_cast<__m256i*>(to), y); };
    const __m256i x0 = _mm512_castsi512_si256(even), x1 = _mm512_castsi512_si256(odd);
    const __m256i y0 = _mm512_extracti64x4_epi64(even, 1), y1 = _mm512_extracti64x4_epi64(odd, 1);
    store(b.at[0][0][n], _mm256_add_epi32(x0, y0));
    store(b.at[0][1][n], _mm256_add_epi32(x0, y1));
    store(b.at[1][0][n], _mm256_add_epi32(x1, y0));
    store(b.at[1][1][n], _mm256_add_epi32(x1, y1));
    store(b.column[n], _mm256_and_si256(_mm512_castsi512_si256(first), _mm256_set1_epi32(7)));
  }
  b.flat = flat;
  b.placed = flat & fit & (fit >> 8);
  b.wide = wide;
}

// reference_at() and coordinates_within() of eight spans from (sx, sy).
[[gnu::always_inline]] inline void plan(const row_work& work, batch& b) {
  const plane& p = *work.map;
  const int32_t cx = 2 * span_side * work.sx + span_side, cy = 2 * span_side * work.sy + span_side;
  const v8 k = _mm512_setr_epi64(0, 1, 2, 3, 4, 5, 6, 7);
  const auto along = [&](const linear_form& f) {
    return _mm512_add_epi64(set(p.value(f, cx, cy)), _mm512_mullo_epi64(k, set(2 * span_side * f.x)));
  };
  const v8 w = along(p.w), nu = along(p.u), nv = along(p.v), zero = _mm512_setzero_si512();
  __mmask8 usable = _mm512_cmpgt_epi64_mask(w, zero);
  const uint64_t slope = 7 * (magnitude(p.w.x) + magnitude(p.w.y));
  usable &= _mm512_cmplt_epu64_mask(set(int64_t(slope)), _mm512_sub_epi64(_mm512_srli_epi64(w, 1), _mm512_srli_epi64(w, 8)));
  const inverse8 iw = invert8(w);
  const v8 w_bits = bit_length(w);
  const v8 base_u = whole_quotient8(nu, w_bits, iw, usable), base_v = whole_quotient8(nv, w_bits, iw, usable);
  const auto less = [&](int64_t x, v8 base, v8 by) { return _mm512_sub_epi64(set(x), _mm512_mullo_epi64(base, by)); };
  const v8 gx = set(p.w.x), gy = set(p.w.y);
  const v8 c_u = _mm512_sub_epi64(nu, _mm512_mullo_epi64(base_u, w)), a_u = less(p.u.x, base_u, gx), b_u = less(p.u.y, base_u, gy);
  const v8 c_v = _mm512_sub_epi64(nv, _mm512_mullo_epi64(base_v, w)), a_v = less(p.v.x, base_v, gx), b_v = less(p.v.y, base_v, gy);
  const auto extent_of = [&](v8 c, v8 x, v8 y) {
    return _mm512_add_epi64(_mm512_abs_epi64(c), times7(_mm512_add_epi64(_mm512_abs_epi64(x), _mm512_abs_epi64(y))));
  };
  const v8 extent = _mm512_max_epu64(extent_of(c_u, a_u, b_u), extent_of(c_v, a_v, b_v));
  const v8 extent_bits = bit_length(extent);
  const v8 extent_log2 = _mm512_add_epi64(_mm512_sub_epi64(extent_bits, w_bits), set(1));
  usable &= _mm512_cmple_epi64_mask(extent_log2, set(max_extent_log2));
  const v8 exponent = _mm512_min_epi64(_mm512_sub_epi64(set(q.offset_bits - 1), extent_log2), set(max_exponent));
  const v8 drop = _mm512_max_epi64(_mm512_sub_epi64(extent_bits, set(31)), zero);
  const v8 whole = _mm512_add_epi64(iw.exponent, set(63)), shift = _mm512_sub_epi64(_mm512_sub_epi64(whole, drop), exponent);
  const auto mantissa = [&](v8 n) { return quotient8(n, drop, iw.y, shift); };
  const int slope_drop = max_of(0, spantex::bit_length(slope) - 31);
  const v8 slope_shift = _mm512_sub_epi64(whole, set(slope_drop + q.reciprocal_bits));
  const v8 g = quotient8(gx, set(slope_drop), iw.y, slope_shift), h = quotient8(gy, set(slope_drop), iw.y, slope_shift);

  // rounding_is_small()
  if (p.rounding_bits != 0) {
    const v8 reached = _mm512_sllv_epi64(set(2), _mm512_max_epi64(_mm512_sub_epi64(set(q.offset_bits - 1), exponent), zero));
    const v8 farthest = _mm512_add_epi64(_mm512_max_epi64(_mm512_abs_epi64(base_u), _mm512_abs_epi64(base_v)), reached);
    const v8 bits = _mm512_add_epi64(bit_length(_mm512_add_epi64(farthest, set(2))), set(p.rounding_bits + set_up_tolerance_bits));
    usable &= _mm512_cmplt_epi64_mask(bits, w_bits);
  }

  // choose_evaluation()
  const v8 steepness = times7(_mm512_add_epi64(_mm512_abs_epi64(g), _mm512_abs_epi64(h)));
  const v8 slope_log2 = _mm512_max_epi64(_mm512_sub_epi64(bit_length(steepness), set(q.reciprocal_bits)), set(least_slope_log2));
  const __mmask8 steep = _mm512_cmpgt_epi64_mask(slope_log2, set(most_series_slope_log2));
  const v8 affine_log2 = _mm512_add_epi64(_mm512_add_epi64(extent_log2, slope_log2), set(1));
  const __mmask8 affine = _mm512_cmpeq_epi64_mask(steepness, zero) |
                          _mm512_cmple_epi64_mask(_mm512_mask_add_epi64(affine_log2, steep, affine_log2, set(1)), set(-q.tolerance_bits));
  const v8 resolution = _mm512_add_epi64(_mm512_sub_epi64(set(q.offset_bits - 1), exponent), slope_log2);
  const __mmask8 series = __mmask8(~steep) & _mm512_cmple_epi64_mask(resolution, set(series_bits - 3 - q.tolerance_bits));
  v8 terms = set(divide_terms), error_log2 = _mm512_add_epi64(affine_log2, _mm512_mullo_epi64(slope_log2, set(most_series_terms)));
  for (int n = most_series_terms; n >= 1; --n) {
    terms = _mm512_mask_mov_epi64(terms, series & _mm512_cmple_epi64_mask(error_log2, set(-q.tolerance_bits - 1)), set(n));
    error_log2 = _mm512_sub_epi64(error_log2, slope_log2);
  }
  terms = _mm512_mask_mov_epi64(terms, affine, zero);

  keep(b.c_u, mantissa(c_u)); keep(b.a_u, mantissa(a_u)); keep(b.b_u, mantissa(b_u));
  keep(b.c_v, mantissa(c_v)); keep(b.a_v, mantissa(a_v)); keep(b.b_v, mantissa(b_v));
  keep(b.g, g); keep(b.h, h);
  keep(b.base_u, modulo(base_u, work.texels->period_u())); keep(b.base_v, modulo(base_v, work.texels->period_v()));
  keep(b.exponent, exponent); keep(b.slope_log2, slope_log2); keep(b.terms, terms);
  b.usable = usable & ((1u << work.count) - 1);
  const __mmask8 flat = _mm512_cmple_epi64_mask(_mm512_add_epi64(extent_log2, slope_log2), set(-3));
  if (work.kind != filter::nearest) place(work, flat, b);
  if (!uses_levels(work.kind)) return;
  const v8 g64 = g, h64 = h;
  const auto product = [&](v8 x, v8 s) {  // times_slope()
    const v8 p30 = _mm512_mul_epi32(x, s), m = _mm512_srli_epi64(_mm512_add_epi64(_mm512_abs_epi64(p30), set(1 << 29)), 30);
    return _mm512_mask_sub_epi64(m, _mm512_movepi64_mask(p30), zero, m);
  };
  const auto wide = [&](const int32_t (&x)[batch_size]) { return _mm512_cvtepi32_epi64(got(x)); };
  const v8 cu = wide(b.c_u), cv = wide(b.c_v), au = wide(b.a_u), av = wide(b.a_v), bu = wide(b.b_u), bv = wide(b.b_v);
  _mm512_store_si512(b.u_x, _mm512_sub_epi64(au, product(cu, g64)));
  _mm512_store_si512(b.v_x, _mm512_sub_epi64(av, product(cv, g64)));
  _mm512_store_si512(b.u_y, _mm512_sub_epi64(bu, product(cu, h64)));
  _mm512_store_si512(b.v_y, _mm512_sub_epi64(bv, product(cv, h64)));
  _mm512_store_si512(b.twist_u, _mm512_sub_epi64(product(au, h64), product(bu, g64)));
  _mm512_store_si512(b.twist_v, _mm512_sub_epi64(product(av, h64), product(bv, g64)));
}


// --- a span's 64 pixels --------------------------------------------------------------------------------
// In quads of 4x4 pixels, one register each: left and right of the top, left and right of the bottom. Lane 4 y + x.

constexpr int quads = 4, quad_side = 4;

// Offsets from the base texel: value 2^-bits, to be rounded by adding half and cutting.
struct offsets { v16 u[quads], v[quads], e[quads]; int bits; uint32_t half; };

[[gnu::always_inline]] inline void forms(const int32_t (&c)[batch_size], const int32_t (&x)[batch_size], const int32_t (&y)[batch_size], int k, v16 (&out)[quads]) {
  const v16 hx = _mm512_setr_epi32(-7, -5, -3, -1, -7, -5, -3, -1, -7, -5, -3, -1, -7, -5, -3, -1);
  const v16 hy = _mm512_setr_epi32(-7, -7, -7, -7, -5, -5, -5, -5, -3, -3, -3, -3, -1, -1, -1, -1);
  const v16 a = set32(x[k]), b = set32(y[k]), right = _mm512_slli_epi32(a, 3), below = _mm512_slli_epi32(b, 3);
  out[0] = _mm512_add_epi32(_mm512_add_epi32(set32(c[k]), _mm512_mullo_epi32(a, hx)), _mm512_mullo_epi32(b, hy));
  out[1] = _mm512_add_epi32(out[0], right);
  out[2] = _mm512_add_epi32(out[0], below);
  out[3] = _mm512_add_epi32(out[1], below);
}

[[gnu::always_inline]] inline void slopes(const batch& b, int k, v16 (&e)[quads]) {
  static constexpr int32_t zero[batch_size] = {};
  forms(zero, b.g, b.h, k, e);
}

template <int Terms>
[[gnu::always_inline]] inline void divide_by_series(const batch& b, int k, offsets& o) {
  const v16 slope_log2 = set32(b.slope_log2[k]), drop = _mm512_sub_epi32(set32(-2), slope_log2);
#pragma GCC unroll 4
  for (int n = 0; n < quads; ++n) {
    const v16 r = series16<Terms>(o.e[n], slope_log2);
    o.u[n] = by_series16(o.u[n], r, drop);
    o.v[n] = by_series16(o.v[n], r, drop);
  }
}

[[gnu::always_inline]] inline void divide(offsets& o) {
  const v8 shift = set(o.bits - q.coordinate_bits + q.reciprocal_bits);
#pragma GCC unroll 4
  for (int n = 0; n < quads; ++n) {
    const reciprocals16 r = reciprocal16(o.e[n]);
    o.u[n] = by_divide16(o.u[n], r, shift);
    o.v[n] = by_divide16(o.v[n], r, shift);
  }
  o.bits = q.coordinate_bits;
  o.half = 0;
}

[[gnu::always_inline]] inline offsets offsets_of(const batch& b, int k) {
  offsets o;
  forms(b.c_u, b.a_u, b.b_u, k, o.u);
  forms(b.c_v, b.a_v, b.b_v, k, o.v);
  o.bits = b.exponent[k];
  o.half = 1u << (o.bits - q.coordinate_bits - 1);
  slopes(b, k, o.e);
  switch (b.terms[k]) {
    case 0: break;
    case 1: divide_by_series<1>(b, k, o); break;
    case 2: divide_by_series<2>(b, k, o); break;
    case 3: divide_by_series<3>(b, k, o); break;
    case 4: divide_by_series<4>(b, k, o); break;
    default: divide(o); break;
  }
  return o;
}

// Fewer bits, so that positions modulo 16 texels of the level fit 32 bits.
[[gnu::always_inline]] inline v16 shortened(v16 x, int drop) { return drop > 0 ? _mm512_sra_epi32(x, _mm_cvtsi32_si128(drop)) : x; }

// Positions on a level: u in the lower half of each lane, v in the upper, 7 bits of fraction and 4 of texel each; what is above is anything.
[[gnu::always_inline]] SPANTEX_WRAPS inline v16 snapped16(const offsets& o, int n, int32_t base_u, int32_t base_v, int level) {
  const int short_by = max_of(0, o.bits + level - 28), bits = o.bits - short_by, drop = bits + level - q.subtexel_bits;
  const uint32_t start = (o.half >> short_by) + (1u << (bits + level - q.subtexel_bits - 1)) - (1u << (bits + level - 1));
  const v16 from_u = set32(int32_t((uint32_t(base_u) << bits) + start)), from_v = set32(int32_t((uint32_t(base_v) << bits) + start));
  const v16 u = _mm512_srlv_epi32(_mm512_add_epi32(shortened(o.u[n], short_by), from_u), set32(drop));
  const v16 v = _mm512_rorv_epi32(_mm512_add_epi32(shortened(o.v[n], short_by), from_v), set32(drop - 16));
  return _mm512_ternarylogic_epi32(u, v, upper(), 0xD8);  // bits of v where upper
}

// --- sections ------------------------------------------------------------------------------------------

struct extremes { __m128i least, most; };
[[gnu::always_inline]] inline extremes extremes_of(const v16 (&x)[quads]) {  // positions of a quad lie between those of its corners, rounding apart
  const v16 corners = _mm512_setr_epi32(0, 16, 0, 16, 3, 19, 3, 19, 12, 28, 12, 28, 15, 31, 15, 31);
  const v16 all = _mm512_unpacklo_epi64(_mm512_permutex2var_epi32(x[0], corners, x[1]), _mm512_permutex2var_epi32(x[2], corners, x[3]));
  const __m256i a = _mm512_castsi512_si256(all), c = _mm512_extracti64x4_epi64(all, 1), least = _mm256_min_epi32(a, c), most = _mm256_max_epi32(a, c);
  return {_mm_min_epi32(_mm256_castsi256_si128(least), _mm256_extracti128_si256(least, 1)),
          _mm_max_epi32(_mm256_castsi256_si128(most), _mm256_extracti128_si256(most, 1))};
}

// In s15.16 of level 0: least u, most u, least v, most v of the four quads, widened by twice the tolerance.
[[gnu::always_inline]] inline v16 reach_of(const offsets& o, int32_t base_u, int32_t base_v) {
  const extremes u = extremes_of(o.u), v = extremes_of(o.v);
  const v16 all = _mm512_inserti64x4(_mm512_castsi256_si512(_mm256_set_m128i(u.most, u.least)), _mm256_set_m128i(v.most, v.least), 1);
  const int32_t slack = 1 << (17 - q.tolerance_bits);
  const __m256i from = _mm256_setr_epi32(-slack, -slack, -slack, -slack, slack, slack, slack, slack);
  const v16 start = _mm512_inserti64x4(_mm512_castsi256_si512(_mm256_add_epi32(from, _mm256_set1_epi32(base_u << 16))),
                                       _mm256_add_epi32(from, _mm256_set1_epi32(base_v << 16)), 1);
  const v16 to16 = o.bits >= 16 ? _mm512_sra_epi32(all, _mm_cvtsi32_si128(o.bits - 16)) : _mm512_sll_epi32(all, _mm_cvtsi32_si128(16 - o.bits));
  return _mm512_add_epi32(to16, start);
}

// One quad's registers.
struct quad_section {
  const uint8_t* near[2];
  const uint8_t* far[2];
  __mmask64 merged;  // columns from far
};

constexpr uint64_t columns_below[block_side] = {0, 0x0101010101010101, 0x0303030303030303, 0x0707070707070707, 0x0F0F0F0F0F0F0F0F, 0x1F1F1F1F1F1F1F1F,
                                                0x3F3F3F3F3F3F3F3F, 0x7F7F7F7F7F7F7F7F};

// --- filters -------------------------------------------------------------------------------------------

// Addresses and weights of sixteen pixels on one level, four bytes a pixel: texels (0,0) (1,0) (0,1) (1,1).
struct samples {
  v16 index;           // row of 16, column of 8: what a byte permute of two registers takes
  __mmask64 right;     // in the second column of blocks
  v16 u, v;            // weights: 128 - f, f of 128 in bytes; 512 - 4 f, 4 f of 512 in words
};

[[gnu::always_inline]] inline v16 fields(int64_t offsets_of_a_pixel) {  // for multishift: the same of both pixels of a 64-bit lane
  return set(offsets_of_a_pixel | ((offsets_of_a_pixel + 0x20202020) << 32));
}

[[gnu::always_inline]] inline samples samples16(v16 at) {
  samples s;
  const v16 x = _mm512_add_epi8(_mm512_multishift_epi64_epi8(fields(0x07070707), at), set32(0x01000100));
  const v16 y = _mm512_add_epi8(_mm512_multishift_epi64_epi8(fields(0x14141414), at), set32(0x08080000));  // times 8, three bits of fraction below
  s.index = _mm512_ternarylogic_epi32(y, x, set32(0x07070707), 0xD8);
  s.right = _mm512_test_epi8_mask(x, set32(0x08080808));
  const v16 fu = _mm512_and_si512(at, set32(0x7F)), fu4 = _mm512_shuffle_epi8(fu, _mm512_broadcast_i32x4(_mm_setr_epi8(0, 0, 0, 0, 4, 4, 4, 4, 8, 8, 8, 8, 12, 12, 12, 12)));
  s.u = _mm512_mask_sub_epi8(fu4, 0x5555555555555555, set32(int32_t(0x80808080)), fu4);
  const v16 fv = _mm512_and_si512(_mm512_multishift_epi64_epi8(fields(0x160E160E), at), set32(0x01FC01FC));
  s.v = _mm512_mask_sub_epi16(fv, 0x55555555, set32(0x02000200), fv);
  return s;
}

// One channel's texels, four a pixel.
template <bool Wide>
[[gnu::always_inline]] inline v16 fetch16(const quad_section& at, int channel, const samples& s) {
  const int c = channel * block_channel_bytes;
  if constexpr (Wide) {
    const v16 left = _mm512_permutex2var_epi8(_mm512_load_si512(at.near[0] + c), s.index, _mm512_load_si512(at.near[1] + c));
    const v16 right = _mm512_permutex2var_epi8(_mm512_load_si512(at.far[0] + c), s.index, _mm512_load_si512(at.far[1] + c));
    return _mm512_mask_mov_epi8(left, s.right, right);
  } else {
    const v16 top = _mm512_mask_loadu_epi8(_mm512_load_si512(at.near[0] + c), at.merged, at.far[0] + c);
    const v16 bottom = _mm512_mask_loadu_epi8(_mm512_load_si512(at.near[1] + c), at.merged, at.far[1] + c);
    return _mm512_permutex2var_epi8(top, s.index, bottom);
  }
}

// Interpolated on a level, 16 bits of fraction: texels are signed, so 128 is added back with what rounds.
template <bool Wide>
[[gnu::always_inline]] inline v16 blended16(const quad_section& at, int channel, const samples& s, int32_t rounding) {
  return _mm512_dpwssd_epi32(set32((128 << 16) + rounding), _mm512_maddubs_epi16(s.u, fetch16<Wide>(at, channel, s)), s.v);
}

// x + 2^15 - 1 becomes x rounded to 16 bits less, halves to even; in bits 16 to 23.
[[gnu::always_inline]] inline v16 even16(v16 x) { return _mm512_dpwssd_epi32(x, _mm512_and_si512(x, set32(0x10000)), set32(0x10000)); }
constexpr int32_t before_even = 0x7FFF;

// Four channels' bits 16 to 23 as pixels.
[[gnu::always_inline]] inline v16 packed16(v16 r, v16 g, v16 b, v16 a) {
  const v16 low = _mm512_ternarylogic_epi32(_mm512_srli_epi32(r, 16), _mm512_srli_epi32(g, 8), set32(0xFF00), 0xD8);
  const v16 high = _mm512_ternarylogic_epi32(b, _mm512_slli_epi32(a, 8), set32(int32_t(0xFF000000)), 0xD8);
  return _mm512_ternarylogic_epi32(low, high, upper(), 0xD8);
}

template <bool Wide>
[[gnu::always_inline]] inline v16 bilinear16(const quad_section& at, const samples& s) {
  v16 c[channel_count];
#pragma GCC unroll 4
  for (int k = 0; k < channel_count; ++k) c[k] = even16(blended16<Wide>(at, k, s, before_even));
  return packed16(c[0], c[1], c[2], c[3]);
}

// Weights of two levels from a fraction of 8 bits: 512 - 2 f, 2 f of 512.
[[gnu::always_inline]] inline v16 level_weights16(v16 fraction) {
  const v16 twice = _mm512_slli_epi32(fraction, 1);
  return _mm512_or_si512(_mm512_slli_epi32(twice, 16), _mm512_sub_epi32(set32(512), twice));
}

// Two levels, each with 16 bits of fraction and 2^8 added: rounded to 7 bits, then interpolated and written out.
[[gnu::always_inline]] inline v16 between_levels16(const v16 (&fine)[channel_count], const v16 (&coarse)[channel_count], v16 weights) {
  v16 c[channel_count];
#pragma GCC unroll 4
  for (int k = 0; k < channel_count; ++k) {
    const v16 near = _mm512_srli_epi32(fine[k], 9), far = _mm512_slli_epi32(coarse[k], 7);
    c[k] = even16(_mm512_dpwssd_epi32(set32(before_even), _mm512_ternarylogic_epi32(near, far, upper(), 0xD8), weights));
  }
  return packed16(c[0], c[1], c[2], c[3]);
}

// --- write-out -----------------------------------------------------------------------------------------

[[gnu::always_inline]] inline void write(const row_work& work, int k, const v16 (&quad)[quads]) {
  const span_mask mask = work.masks[k];
  rgba8* row = work.pixels + int64_t(work.sy) * span_side * work.stride + (work.sx + k) * span_side;
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

// --- spans ---------------------------------------------------------------------------------------------

// One quad's section as place() left it.
[[gnu::always_inline]] inline quad_section section_of(const batch& b, const uint8_t* origin, int k, int n) {
  const auto at = [&](int column, int row) {
    const uint8_t* p = origin + b.at[column][row][n][k];
    asm("" : "+r"(p));
    return p;
  };
  return {{at(0, 0), at(0, 1)}, {at(1, 0), at(1, 1)}, columns_below[b.column[n][k]]};
}

// --- levels of detail ----------------------------------------------------------------------------------

// log2 between two knots, as differences.
struct alignas(64) knot_table {
  uint16_t knot[64], step[64];
  constexpr knot_table() : knot(), step() {
    for (int k = 0; k < 64; ++k) {
      knot[k] = log2_knots.knot[k];
      step[k] = uint16_t((k == 63 ? 65536u : log2_knots.knot[k + 1]) - log2_knots.knot[k]);
    }
  }
};
constexpr knot_table knots{};

[[gnu::always_inline]] inline v16 look_up(const uint16_t* table, v16 k) {
  return _mm512_permutex2var_epi16(_mm512_load_si512(table), k, _mm512_load_si512(table + 32));
}

// log2_16() of 64-bit lanes, not zero.
[[gnu::always_inline]] inline v8 log2_8(v8 x) {
  const v8 zeros = _mm512_lzcnt_epi64(x), f = _mm512_srli_epi64(_mm512_sllv_epi64(x, zeros), 41);
  const v8 k = _mm512_and_si512(_mm512_srli_epi64(f, 16), set(63)), t = _mm512_and_si512(f, set(0xFFFF)), word = set(0xFFFF);
  const v8 low = _mm512_and_si512(look_up(knots.knot, k), word), step = _mm512_and_si512(look_up(knots.step, k), word);
  const v8 part = _mm512_srli_epi64(_mm512_add_epi64(_mm512_mul_epu32(step, t), set(0x8000)), 16);
  return _mm512_add_epi64(_mm512_slli_epi64(_mm512_sub_epi64(set(63), zeros), 16), _mm512_add_epi64(low, part));
}

// The same of 32-bit lanes.
[[gnu::always_inline]] inline v16 log2_16_(v16 x) {
  const v16 zeros = _mm512_lzcnt_epi32(x), f = _mm512_srli_epi32(_mm512_sllv_epi32(x, zeros), 9);
  const v16 k = _mm512_and_si512(_mm512_srli_epi32(f, 16), set32(63)), t = _mm512_and_si512(f, set32(0xFFFF)), word = set32(0xFFFF);
  const v16 low = _mm512_and_si512(look_up(knots.knot, k), word), step = _mm512_and_si512(look_up(knots.step, k), word);
  const v16 part = _mm512_srli_epi32(_mm512_add_epi32(_mm512_mullo_epi32(step, t), set32(0x8000)), 16);
  return _mm512_add_epi32(_mm512_slli_epi32(_mm512_sub_epi32(set32(31), zeros), 16), _mm512_add_epi32(low, part));
}

// log2_length() of the eight rows or columns, s.10 in 32 bits.
[[gnu::always_inline]] inline __m256i lengths8(v8 du, v8 dv, int exponent) {
  const v8 square = _mm512_add_epi64(_mm512_mullo_epi64(du, du), _mm512_mullo_epi64(dv, dv));
  const v8 level = _mm512_add_epi64(_mm512_srli_epi64(log2_8(square), 1), set(int64_t(1 - exponent) * 65536));
  const v8 term = _mm512_srai_epi64(_mm512_add_epi64(level, set(32)), 6);
  const v8 held = _mm512_max_epi64(_mm512_min_epi64(term, set(32767)), set(-32768));
  return _mm512_cvtepi64_epi32(_mm512_mask_mov_epi64(held, _mm512_testn_epi64_mask(square, square), set(-32768)));
}

// level_at() of the span's pixels, 2^-8.
[[gnu::always_inline]] inline void levels_of(const row_work& work, const batch& b, int k, const offsets& o, v16 (&level)[quads]) {
  const v8 half = _mm512_setr_epi64(-7, -5, -3, -1, 1, 3, 5, 7);
  const v8 along_u = _mm512_mullo_epi64(set(b.twist_u[k]), half), along_v = _mm512_mullo_epi64(set(b.twist_v[k]), half);
  const __m256i rows = lengths8(_mm512_add_epi64(set(b.u_x[k]), along_u), _mm512_add_epi64(set(b.v_x[k]), along_v), b.exponent[k]);
  const __m256i columns = lengths8(_mm512_sub_epi64(set(b.u_y[k]), along_u), _mm512_sub_epi64(set(b.v_y[k]), along_v), b.exponent[k]);
  const v16 both = _mm512_inserti64x4(_mm512_castsi256_si512(rows), columns, 1);
  const v16 row = _mm512_setr_epi32(0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3), column = _mm512_setr_epi32(8, 9, 10, 11, 8, 9, 10, 11, 8, 9, 10, 11, 8, 9, 10, 11);
  const v16 top = _mm512_permutexvar_epi32(row, both), bottom = _mm512_permutexvar_epi32(_mm512_add_epi32(row, set32(4)), both);
  const v16 left = _mm512_permutexvar_epi32(column, both), right = _mm512_permutexvar_epi32(_mm512_add_epi32(column, set32(4)), both);
  const v16 terms[quads] = {_mm512_max_epi32(top, left), _mm512_max_epi32(top, right), _mm512_max_epi32(bottom, left), _mm512_max_epi32(bottom, right)};
  const int s = b.slope_log2[k];
  const v16 most = set32(work.last_level << q.level_bits);
#pragma GCC unroll 4
  for (int n = 0; n < quads; ++n) {
    v16 log_w;
    if (s <= most_level_slope_log2) {
      const v16 e16 = _mm512_and_si512(_mm512_sllv_epi32(o.e[n], set32(-s)), upper());
      const v16 t = _mm512_sub_epi32(e16, _mm512_and_si512(_mm512_srav_epi32(_mm512_madd_epi16(e16, e16), set32(-s - 1)), upper()));
      log_w = _mm512_srav_epi32(_mm512_madd_epi16(t, set32(int32_t(level_factor.raw()) << 16)), set32(11 - s));
    } else {
      log_w = _mm512_slli_epi32(_mm512_sub_epi32(log2_16_(_mm512_add_epi32(o.e[n], set32(1 << 30))), set32(30 << 16)), 1);
    }
    const v16 exact = _mm512_sub_epi32(_mm512_slli_epi32(terms[n], 6), log_w);
    level[n] = _mm512_max_epi32(_mm512_min_epi32(_mm512_srai_epi32(_mm512_add_epi32(exact, set32(128)), 8), most), _mm512_setzero_si512());
  }
}

// --- spans ---------------------------------------------------------------------------------------------

// What the four quads reach, s15.16: [u, v][quad].
struct quad_reach { int32_t low[2][quads], high[2][quads]; };

[[gnu::always_inline]] inline quad_reach reach_of_quads(const batch& b, int k, const offsets& o) {
  quad_reach r;
  if (b.flat >> k & 1) {
    for (int n = 0; n < quads; ++n)
      for (int axis = 0; axis < 2; ++axis) {
        r.low[axis][n] = b.low[n][axis][k];
        r.high[axis][n] = b.high[n][axis][k];
      }
    return r;
  }
  alignas(64) int32_t all[2][2][quads];
  _mm512_store_si512(all, reach_of(o, b.base_u[k], b.base_v[k]));
  for (int n = 0; n < quads; ++n)
    for (int axis = 0; axis < 2; ++axis) {
      r.low[axis][n] = all[axis][0][n];
      r.high[axis][n] = all[axis][1][n];
    }
  return r;
}

// The section of one quad on one level. False if it does not fit registers, or lies where the map has no blocks.
[[gnu::always_inline]] inline bool find_section(const planar_map& map, int level, const quad_reach& r, int n, bool always_wide, quad_section& out, bool& wide) {
  if (level >= map.level_count()) return false;
  const planar_level& texels = map.level(level);
  const int32_t half = 1 << (15 + level);
  const auto first = [&](int axis) { return (r.low[axis][n] - half) >> (16 + level); };
  const auto last = [&](int axis) { return ((r.high[axis][n] - half) >> (16 + level)) + 1; };
  const int32_t u = first(0), u1 = last(0), v = first(1), v1 = last(1);
  const int32_t bx = u >> 3, bx1 = u1 >> 3, by = v >> 3, by1 = v1 >> 3;
  wide = always_wide || u1 - u > 7;
  if ((wide && bx1 - bx > 1) || by1 - by > 1) return false;
  const auto held = [](int32_t k, int32_t most) { return clamp_to(k, -apron, most); };
  const int32_t x0 = held(bx, texels.last_column), x1 = held(bx1, texels.last_column), y0 = held(by, texels.last_row), y1 = held(by1, texels.last_row);
  if (map.period_u() != 0 && (x0 != bx || x1 != bx1)) return false;
  if (map.period_v() != 0 && (y0 != by || y1 != by1)) return false;
  const bool swap_x = wide && (bx & 1), swap_y = by & 1;
  const auto at = [&](int32_t x, int32_t y) {
    const uint8_t* p = texels.block(x, y);
    asm("" : "+r"(p));
    return p;
  };
  const int32_t near = swap_x ? x1 : x0, far = swap_x ? x0 : x1, even = swap_y ? y1 : y0, odd = swap_y ? y0 : y1;
  out = {{at(near, even), at(near, odd)}, {at(far, even), at(far, odd)}, columns_below[u & 7]};
  return true;
}

// A section too large for registers, or spread over three blocks: the pixels whose texels lie in the same 2x2 blocks together, until none is left.
// False where the map has no blocks.
[[gnu::noinline]] bool blend_in_parts(const planar_map& map, const offsets& o, int n, int32_t base_u, int32_t base_v, int level, const samples& s,
                                      int32_t rounding, v16 (&out)[channel_count]) {
  const planar_level& texels = map.level(level);
  const int up = 16 - q.coordinate_bits, cut = o.bits - q.coordinate_bits;
  const v16 from = set32((1 << (16 + level - q.subtexel_bits - 1)) - (1 << (15 + level)));
  const auto texel = [&](v16 offset, int32_t base) {
    const v16 at = _mm512_slli_epi32(_mm512_sra_epi32(_mm512_add_epi32(offset, set32(int32_t(o.half))), _mm_cvtsi32_si128(cut)), unsigned(up));
    return _mm512_sra_epi32(_mm512_add_epi32(_mm512_add_epi32(at, set32(base << 16)), from), _mm_cvtsi32_si128(16 + level));
  };
  const v16 one = set32(1), u = texel(o.u[n], base_u), v = texel(o.v[n], base_v);
  const v16 bu = _mm512_srai_epi32(u, 3), bv = _mm512_srai_epi32(v, 3), eu = _mm512_srai_epi32(_mm512_add_epi32(u, one), 3), ev = _mm512_srai_epi32(_mm512_add_epi32(v, one), 3);
  for (__mmask16 rest = 0xFFFF; rest != 0;) {
    const auto first = [&](v16 x) { return _mm_cvtsi128_si32(_mm512_castsi512_si128(_mm512_maskz_compress_epi32(rest, x))); };
    const int32_t x = first(bu), y = first(bv);
    const auto within = [&](v16 b, v16 e, int32_t k) { return _mm512_cmpge_epi32_mask(b, set32(k)) & _mm512_cmple_epi32_mask(e, set32(k + 1)); };
    const __mmask16 these = __mmask16(rest & within(bu, eu, x) & within(bv, ev, y));
    if (map.period_u() != 0 && (x < -apron || x + 1 > texels.last_column)) return false;
    if (map.period_v() != 0 && (y < -apron || y + 1 > texels.last_row)) return false;
    const auto held = [](int32_t k, int32_t most) { return clamp_to(k, -apron, most); };
    const int32_t even_x = held(x + (x & 1), texels.last_column), odd_x = held(x + (~x & 1), texels.last_column);
    const int32_t even_y = held(y + (y & 1), texels.last_row), odd_y = held(y + (~y & 1), texels.last_row);
    const quad_section at{{texels.block(even_x, even_y), texels.block(even_x, odd_y)}, {texels.block(odd_x, even_y), texels.block(odd_x, odd_y)}, 0};
    for (int k = 0; k < channel_count; ++k) out[k] = _mm512_mask_mov_epi32(out[k], these, blended16<true>(at, k, s, rounding));
    rest = __mmask16(rest & ~these);
  }
  return true;
}

// One level's colours of a quad, with what rounds added.
[[gnu::always_inline]] inline bool blend_level(const planar_map& map, const offsets& o, int n, int32_t base_u, int32_t base_v, int level, const quad_reach& r,
                                               int32_t rounding, v16 (&out)[channel_count]) {
  if (level >= map.level_count()) return false;
  const samples s = samples16(snapped16(o, n, base_u, base_v, level));
  quad_section at;
  bool wide;
  if (!find_section(map, level, r, n, true, at, wide)) {  // wide or not would be a branch that nobody can predict
    for (v16& c : out) c = _mm512_setzero_si512();
    return blend_in_parts(map, o, n, base_u, base_v, level, s, rounding, out);
  }
#pragma GCC unroll 4
  for (int k = 0; k < channel_count; ++k) out[k] = blended16<true>(at, k, s, rounding);
  return true;
}

// Texels where they are: for quads whose section is larger than registers. Level 0.
[[gnu::always_inline]] inline v16 wrapped16(v16 k, int32_t side, wrap mode) {
  if (mode == wrap::clamp) return _mm512_max_epi32(_mm512_min_epi32(k, set32(side - 1)), _mm512_setzero_si512());
  const int32_t period = mode == wrap::mirror ? 2 * side : side;
  if ((period & (period - 1)) == 0) {
    k = _mm512_and_si512(k, set32(period - 1));
  } else {
    for (__mmask16 m; (m = _mm512_movepi32_mask(k)) != 0;) k = _mm512_mask_add_epi32(k, m, k, set32(period));
    for (__mmask16 m; (m = _mm512_cmpge_epi32_mask(k, set32(period))) != 0;) k = _mm512_mask_sub_epi32(k, m, k, set32(period));
  }
  return mode == wrap::mirror ? _mm512_min_epi32(k, _mm512_sub_epi32(set32(period - 1), k)) : k;
}

[[gnu::always_inline]] inline v16 bilinear_gathered(const planar_map& map, const offsets& o, int n, int32_t base_u, int32_t base_v, const samples& s) {
  const int cut = o.bits - q.subtexel_bits;  // whole positions: (offset + rounding) / 2^cut, 7 bits of fraction
  const v16 start = set32(int32_t(o.half + (1u << (cut - 1)))), half_texel = set32(1 << (q.subtexel_bits - 1));
  const auto texel = [&](v16 offset, int32_t base) {
    const v16 at = _mm512_sub_epi32(_mm512_sra_epi32(_mm512_add_epi32(offset, start), _mm_cvtsi32_si128(cut)), half_texel);
    return _mm512_add_epi32(_mm512_srai_epi32(at, q.subtexel_bits), set32(base));
  };
  const v16 u = texel(o.u[n], base_u), v = texel(o.v[n], base_v), one = set32(1), width = set32(map.width());
  const v16 x0 = wrapped16(u, map.width(), map.wrap_u()), x1 = wrapped16(_mm512_add_epi32(u, one), map.width(), map.wrap_u());
  const v16 y0 = _mm512_mullo_epi32(wrapped16(v, map.height(), map.wrap_v()), width);
  const v16 y1 = _mm512_mullo_epi32(wrapped16(_mm512_add_epi32(v, one), map.height(), map.wrap_v()), width);
  const auto read = [&](v16 x, v16 y) { return _mm512_xor_si512(_mm512_i32gather_epi32(_mm512_add_epi32(x, y), map.level0(), 4), set32(int32_t(0x80808080))); };
  const v16 t00 = read(x0, y0), t10 = read(x1, y0), t01 = read(x0, y1), t11 = read(x1, y1);
  const v16 top_low = _mm512_unpacklo_epi8(t00, t10), top_high = _mm512_unpackhi_epi8(t00, t10);
  const v16 bottom_low = _mm512_unpacklo_epi8(t01, t11), bottom_high = _mm512_unpackhi_epi8(t01, t11);
  const v16 pixels[4] = {_mm512_unpacklo_epi16(top_low, bottom_low), _mm512_unpackhi_epi16(top_low, bottom_low),
                         _mm512_unpacklo_epi16(top_high, bottom_high), _mm512_unpackhi_epi16(top_high, bottom_high)};  // pixel n of each four: its channels
  const v16 u_of[4] = {_mm512_shuffle_epi32(s.u, _MM_PERM_AAAA), _mm512_shuffle_epi32(s.u, _MM_PERM_BBBB), _mm512_shuffle_epi32(s.u, _MM_PERM_CCCC), _mm512_shuffle_epi32(s.u, _MM_PERM_DDDD)};
  const v16 v_of[4] = {_mm512_shuffle_epi32(s.v, _MM_PERM_AAAA), _mm512_shuffle_epi32(s.v, _MM_PERM_BBBB), _mm512_shuffle_epi32(s.v, _MM_PERM_CCCC), _mm512_shuffle_epi32(s.v, _MM_PERM_DDDD)};
  v16 c[4];
#pragma GCC unroll 4
  for (int k = 0; k < 4; ++k)
    c[k] = _mm512_srli_epi32(even16(_mm512_dpwssd_epi32(set32((128 << 16) + before_even), _mm512_maddubs_epi16(u_of[k], pixels[k]), v_of[k])), 16);
  return _mm512_packus_epi16(_mm512_packus_epi32(c[0], c[1]), _mm512_packus_epi32(c[2], c[3]));
}

[[gnu::always_inline]] inline bool draw_bilinear(const row_work& work, const batch& b, int k) {
  const offsets o = offsets_of(b, k);
  const planar_level& texels = work.texels->level(0);
  const int32_t u = b.base_u[k], v = b.base_v[k];
  v16 out[quads];
  if (b.placed & ~b.wide & (1u << k)) {
#pragma GCC unroll 4
    for (int n = 0; n < quads; ++n) out[n] = bilinear16<false>(section_of(b, texels.origin, k, n), samples16(snapped16(o, n, u, v, 0)));
  } else {
    const quad_reach r = reach_of_quads(b, k, o);
    for (int n = 0; n < quads; ++n) {
      const samples s = samples16(snapped16(o, n, u, v, 0));
      quad_section at;
      bool wide;
      if (!find_section(*work.texels, 0, r, n, false, at, wide)) out[n] = bilinear_gathered(*work.texels, o, n, u, v, s);
      else out[n] = wide ? bilinear16<true>(at, s) : bilinear16<false>(at, s);
    }
  }
  write(work, k, out);
  return true;
}

[[gnu::always_inline]] inline bool draw_nearest(const row_work& work, const batch& b, int k) {
  const offsets o = offsets_of(b, k);
  const planar_map& map = *work.texels;
  const v16 half = set32(int32_t(o.half)), bits = set32(o.bits), base_u = set32(b.base_u[k]), base_v = set32(b.base_v[k]), width = set32(map.width());
  alignas(64) uint64_t at[quads][8];
#pragma GCC unroll 4
  for (int n = 0; n < quads; ++n) {
    const v16 u = _mm512_add_epi32(_mm512_srav_epi32(_mm512_add_epi32(o.u[n], half), bits), base_u);
    const v16 v = _mm512_add_epi32(_mm512_srav_epi32(_mm512_add_epi32(o.v[n], half), bits), base_v);
    const v16 x = wrapped16(u, map.width(), map.wrap_u()), y = wrapped16(v, map.height(), map.wrap_v());
    _mm512_store_si512(at[n], _mm512_add_epi32(_mm512_mullo_epi32(y, width), x));
  }
  const span_mask mask = work.masks[k];
  rgba8* const first = work.pixels + int64_t(work.sy) * span_side * work.stride + (work.sx + k) * span_side;
  const auto* const texels = reinterpret_cast<const uint32_t __attribute__((__may_alias__))*>(map.level0());
  if (mask == ~span_mask(0)) {
    for (int y = 0; y < span_side; ++y) {  // two pixels side by side
      rgba8* const row = first + int64_t(y) * work.stride;
      const uint64_t* const left = at[y / quad_side * 2] + y % quad_side * 2;
#pragma GCC unroll 4
      for (int m = 0; m < 4; ++m) {
        const uint64_t two = left[m / 2 * 8 + m % 2], pixels = texels[uint32_t(two)] | uint64_t(texels[two >> 32]) << 32;
        __builtin_memcpy(row + 2 * m, &pixels, 8);
      }
    }
    return true;
  }
  for (span_mask rest = mask; rest != 0; rest &= rest - 1) {
    const int bit = __builtin_ctzll(rest), x = bit % span_side, y = bit / span_side;
    const uint64_t two = at[y / quad_side * 2 + x / quad_side][y % quad_side * 2 + x % quad_side / 2];
    __builtin_memcpy(first + int64_t(y) * work.stride + x, &texels[x % 2 ? two >> 32 : uint32_t(two)], 4);
  }
  return true;
}

template <bool TwoLevels>
[[gnu::always_inline]] inline bool draw_by_level(const row_work& work, const batch& b, int k) {
  const offsets o = offsets_of(b, k);
  v16 level[quads], out[quads];
  levels_of(work, b, k, o, level);
  const quad_reach r = reach_of_quads(b, k, o);
  const int32_t u = b.base_u[k], v = b.base_v[k];
  for (int n = 0; n < quads; ++n) {
    const v16 whole = TwoLevels ? _mm512_srai_epi32(level[n], 8)
                                : _mm512_max_epi32(_mm512_sub_epi32(_mm512_srai_epi32(_mm512_add_epi32(level[n], set32(128 + 255)), 8), set32(1)), _mm512_setzero_si512());
    out[n] = _mm512_setzero_si512();
    for (__mmask16 rest = 0xFFFF; rest != 0;) {
      const int at = _mm_cvtsi128_si32(_mm512_castsi512_si128(_mm512_maskz_compress_epi32(rest, whole)));
      const __mmask16 these = _mm512_cmpeq_epi32_mask(whole, set32(at));
      v16 fine[channel_count], colour;
      if (!blend_level(*work.texels, o, n, u, v, at, r, TwoLevels ? 1 << 8 : before_even, fine)) return false;
      if constexpr (TwoLevels) {
        v16 coarse[channel_count];
        const int next = min_of(at + 1, work.last_level);
        if (!blend_level(*work.texels, o, n, u, v, next, r, 1 << 8, coarse)) return false;
        colour = between_levels16(fine, coarse, level_weights16(_mm512_and_si512(level[n], set32(255))));
      } else {
#pragma GCC unroll 4
        for (v16& c : fine) c = even16(c);
        colour = packed16(fine[0], fine[1], fine[2], fine[3]);
      }
      out[n] = _mm512_mask_mov_epi32(out[n], these, colour);
      rest &= __mmask16(~these);
    }
  }
  write(work, k, out);
  return true;
}

template <filter Kind>
uint32_t draw_row(const row_work& work) {
  batch b;
  plan(work, b);
  uint32_t left = 0;
  for (int k = 0; k < work.count; ++k) {
    if (work.masks[k] == 0) continue;
    bool drawn = b.usable >> k & 1;
    if (drawn) {
      if constexpr (Kind == filter::nearest) drawn = draw_nearest(work, b, k);
      else if constexpr (Kind == filter::bilinear) drawn = draw_bilinear(work, b, k);
      else drawn = draw_by_level<Kind == filter::trilinear>(work, b, k);
    }
    if (!drawn) left |= 1u << k;
  }
  return left;
}

uint32_t draw_any_row(const row_work& work) {
  switch (work.kind) {
    case filter::nearest: return draw_row<filter::nearest>(work);
    case filter::bilinear: return draw_row<filter::bilinear>(work);
    case filter::mip_bilinear: return draw_row<filter::mip_bilinear>(work);
    case filter::trilinear: return draw_row<filter::trilinear>(work);
    default: break;
  }
  return (1u << work.count) - 1;
}

}  // namespace
}  // namespace spantex::kernels

#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif

namespace spantex::kernels {

row_kernel avx512_kernel() {
  const bool has = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512cd") &&
                   __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512vbmi") &&
                   __builtin_cpu_supports("avx512vnni");
  return has ? draw_any_row : nullptr;
}

}  // namespace spantex::kernels

#else
namespace spantex::kernels {
row_kernel avx512_kernel() { return nullptr; }
}  // namespace spantex::kernels
#endif
