// SPDX-License-Identifier: Apache-2.0
// The vector kernel with AVX2: eight 32-bit lanes.
#include "kernel.hpp"
#include "level_rows.hpp"
#include "linear_light.hpp"
#include "numbers.hpp"
#include "upright.hpp"

#if defined(__x86_64__)
#include <cpuid.h>
#include <immintrin.h>

#include <spantex/coordinates.hpp>
#include <spantex/exp2.hpp>
#include <spantex/footprint.hpp>
#include <spantex/level.hpp>

#include "targets/avx2.hpp"

namespace spantex::kernels {
namespace {

#define SPANTEX_TABLES 0
#define SPANTEX_AVX2 1
#include "vectors/common.hpp"
constexpr int width = 8;
#include "vectors/lanes.hpp"
#include "vectors/x86.hpp"
#include "vectors/series_x86.hpp"
#include "vectors/reciprocal.hpp"
#include "vectors/even_odd.hpp"
#include "vectors/log2.hpp"
#include "vectors/levels.hpp"
#include "vectors/plan_lanes.hpp"
#include "vectors/positions.hpp"
#include "vectors/pixel_positions.hpp"
#include "vectors/move_texels.hpp"
#if SPANTEX_LINEAR
#include "vectors/linear_rows.hpp"
#else
#include "vectors/pixels.hpp"
#include "vectors/spans.hpp"
#include "vectors/affine_numbers.hpp"
#include "vectors/affine.hpp"
#include "vectors/aniso.hpp"
#include "vectors/two_rows.hpp"
#include "vectors/upright.hpp"
#include "vectors/blend_rows.hpp"
#include "vectors/kernel.hpp"

void draw_any_row(const row_work& work) { draw_by_filter(rows, avx2_linear_light, work); }
#endif

}  // namespace
}  // namespace spantex::kernels

#include "targets/end.hpp"

namespace spantex::kernels {

#if SPANTEX_LINEAR
constinit const row_kernels avx2_linear_light = linear_light::rows;
#else
namespace {

bool has_lzcnt() {  // not every compiler has a name for it
  unsigned a, b, c, d;
  return __get_cpuid(0x80000001, &a, &b, &c, &d) != 0 && (c >> 5 & 1) != 0;
}

}  // namespace

row_kernel avx2_kernel() {
  const bool has = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2") && has_lzcnt();
  return has ? draw_any_row : nullptr;
}
#endif

}  // namespace spantex::kernels

#elif !SPANTEX_LINEAR
namespace spantex::kernels {
row_kernel avx2_kernel() { return nullptr; }
}  // namespace spantex::kernels
#endif
