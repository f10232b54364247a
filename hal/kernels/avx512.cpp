// SPDX-License-Identifier: Apache-2.0
// AVX-512: rows of spans from local memory (avx512/by_blocks.hpp), of colours as coded.
#include "avx512_rows.hpp"
#include "kernel.hpp"
#include "level_rows.hpp"
#include "linear_light.hpp"
#include "upright.hpp"

#if defined(__x86_64__)
#include "avx512/by_blocks.hpp"

namespace spantex::kernels {
namespace {

#include "vectors/affine_numbers.hpp"
#include "avx512/affine.hpp"
#include "avx512/upright.hpp"

// Spans of nearest are shorter than what a plan's parts would leave to each other in memory. Two batches are planned side by side instead: a plan is one chain of
// dependent operations, and two of them take little longer than one.
template <bool Gathers>
void draw_row_of_nearest(const row_work& work) {
  constexpr int pair = 2;
  constexpr int soon = 3;  // spans ahead: its lower half is prefetched; what lies above that the row of spans before has read
  const batch_steps steps(*work.map);
  batch two[2][pair];
  setup s[pair];
  const auto plan = [&](int first, batch (&to)[pair]) {
    for (int k = 0; k < plan_parts; ++k)
      for (int n = 0; n < pair; ++n) next_batch<filter::nearest>{work, steps, s[n], first + n * batch_size, to[n]}.part(k);
  };
  plan(0, two[0]);
  for (int first = 0, turn = 0; first < work.count; first += pair * batch_size, turn ^= 1) {
    plan(first + pair * batch_size, two[turn ^ 1]);
    for (int n = 0; n < pair && first + n * batch_size < work.count; ++n) {
      const batch& b = two[turn][n];
      const uint32_t spans = spans_of(work, b);
      for (int k = 0; k < batch_size; ++k)
        if (spans >> k & 1) {
          const batch& then = k + soon < batch_size ? b : n + 1 < pair ? two[turn][n + 1] : two[turn ^ 1][0];
          draw_nearest<Gathers>(work, b, k, then.row_at[quads / 2][(k + soon) & (batch_size - 1)]);
        }
    }
  }
}

// Rows that are drawn sooner from the map's rows, texel by texel: local memory holds little of them. Gathered they take 2 to 4 % more (far, grazing).
bool are_beyond(const row_work& work) {
  for (const int k : {0, work.count / 2, work.count - 1})
    if (!beyond_sections(work, k, unknown::beyond)) return false;
  return true;
}

template <filter Kind, bool Gathers>
void draw_row_by_blocks(const row_work& work, plans_of_left<Kind>& left) {
  if constexpr (Kind == filter::nearest) {
    if (draw_affine_row<Gathers>(work)) return;
    if (Gathers || !are_beyond(work)) return draw_row_of_nearest<Gathers>(work);
    for (int k = 0; k < work.count; ++k) work.left[k] = work.masks[k] != 0;
  } else if (work.texels->opaque()) {
    draw_batches<Kind, texel_kind{3, colours_as::codes}>(work, left);
  } else {
    draw_batches<Kind, texel_kind{4, colours_as::codes}>(work, left);
  }
}

template <filter Kind, bool Gathers>
void draw_row(const row_work& work) {
  const row_reader reader = Gathers ? gathering_reader() : loading_reader();
  if (work.by_pixel) return reader.any_row(work);
  if constexpr (!uses_footprint(Kind))
    if (work.upright != nullptr) return draw_upright<Kind>(work);
  plans_of_left<Kind> left;
  draw_row_by_blocks<Kind, Gathers>(work, left);
  draw_left<Kind>(work, left, reader);
}

template <bool Gathers>
void draw_any_row(const row_work& work) {
  draw_by_filter({draw_row<filter::nearest, Gathers>, draw_row<filter::bilinear, Gathers>, draw_row<filter::mip_bilinear, Gathers>, draw_row<filter::trilinear, Gathers>,
                  draw_row<filter::aniso, Gathers>}, avx512_linear_light, work);
}

}  // namespace
}  // namespace spantex::kernels

#include "targets/end.hpp"

namespace spantex::kernels {

namespace {

bool has_avx512() {
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
         __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512vbmi") && __builtin_cpu_supports("avx512vbmi2") && __builtin_cpu_supports("avx512vnni");
}

}  // namespace

row_kernel avx512_gathers_kernel() { return has_avx512() ? draw_any_row<true> : nullptr; }
row_kernel avx512_loads_kernel() { return has_avx512() ? draw_any_row<false> : nullptr; }

// Ice Lake, Tiger Lake and Rocket Lake do not tell whether their microcode slows gathers; it does where it is up to date.
bool gathers_are_fast() {
  if (!__builtin_cpu_is("intel")) return false;
  return !__builtin_cpu_is("icelake-client") && !__builtin_cpu_is("icelake-server") && !__builtin_cpu_is("tigerlake") && !__builtin_cpu_is("rocketlake");
}

}  // namespace spantex::kernels

#else
namespace spantex::kernels {
row_kernel avx512_gathers_kernel() { return nullptr; }
row_kernel avx512_loads_kernel() { return nullptr; }
bool gathers_are_fast() { return false; }
}  // namespace spantex::kernels
#endif