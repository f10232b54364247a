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
#include <spantex/exp2.hpp>
#include <spantex/footprint.hpp>
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

#define SPANTEX_INLINE __attribute__((always_inline)) inline

#include "avx512/lanes.hpp"
#include "avx512/plan.hpp"
#include "avx512/positions.hpp"
#include "avx512/levels.hpp"
#include "avx512/sections.hpp"
#include "avx512/filters.hpp"
#include "avx512/spans.hpp"
#include "avx512/aniso.hpp"

template <filter Kind, int Channels>
SPANTEX_INLINE bool draw_span(const row_work& work, const batch& b, int k) {
  if constexpr (Kind == filter::nearest) return draw_nearest(work, b, k);
  else if constexpr (Kind == filter::bilinear) return draw_bilinear<Channels>(work, b, k);
  else if constexpr (Kind == filter::aniso) return draw_aniso<Channels>(work, b, k);
  else return draw_by_level<Kind == filter::trilinear, Channels>(work, b, k);
}

// A batch is drawn while the next one is planned.
template <filter Kind, int Channels>
void draw_row(const row_work& work) {
  batch two[2];
  setup next;
  const auto start = [&](int first, batch& b) {
    b.sx = work.sx + first;
    b.first = first;
    plan_bases(work, b.sx, next);
  };
  start(0, two[0]);
  plan_mantissas<Kind>(work, next, two[0]);
  plan_evaluation<Kind>(work, next, two[0]);
  for (int first = 0, turn = 0; first < work.count; first += batch_size, turn ^= 1) {
    const batch& b = two[turn];
    batch& then = two[turn ^ 1];
    const int count = min_of(batch_size, work.count - first);
    for (int k = 0; k < count; ++k) {
      if (first + batch_size < work.count) {
        if (k == 1) start(first + batch_size, then);
        if (k == 3) plan_mantissas<Kind>(work, next, then);
        if (k == 6) plan_evaluation<Kind>(work, next, then);
      }
      if (work.masks[first + k] != 0 && !((b.usable >> k & 1) && draw_span<Kind, Channels>(work, b, k))) work.left[first + k] = true;
    }
  }
}

template <filter Kind>
void draw_row(const row_work& work) {
  if (Kind != filter::nearest && work.texels->opaque()) draw_row<Kind, 3>(work);
  else draw_row<Kind, 4>(work);
}

void draw_any_row(const row_work& work) {
  draw_by_filter({draw_row<filter::nearest>, draw_row<filter::bilinear>, draw_row<filter::mip_bilinear>, draw_row<filter::trilinear>, draw_row<filter::aniso>}, work);
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