// SPDX-License-Identifier: Apache-2.0
// The vector kernel with SSE4.1: four 32-bit lanes.
#include "kernel.hpp"
#include "level_rows.hpp"
#include "linear_light.hpp"
#include "numbers.hpp"
#include "upright.hpp"

#if defined(__x86_64__)
#include <immintrin.h>

#include <spantex/coordinates.hpp>
#include <spantex/exp2.hpp>
#include <spantex/footprint.hpp>
#include <spantex/level.hpp>

#include "targets/sse41.hpp"

namespace spantex::kernels {
namespace {

#define SPANTEX_TABLES 0
#define SPANTEX_AVX2 0
#include "vectors/common.hpp"
constexpr int width = 4;
#include "vectors/lanes.hpp"
#include "vectors/x86.hpp"
#include "vectors/series_x86.hpp"
#include "vectors/reciprocal.hpp"
#include "vectors/even_odd.hpp"
#include "vectors/log2.hpp"
#include "vectors/levels.hpp"
#include "vectors/plan.hpp"
#include "vectors/positions.hpp"
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

void draw_any_row(const row_work& work) { draw_by_filter(rows, sse41_linear_light, work); }
#endif

}  // namespace
}  // namespace spantex::kernels

#include "targets/end.hpp"

namespace spantex::kernels {

#if SPANTEX_LINEAR
constinit const row_kernels sse41_linear_light = linear_light::rows;
#else
row_kernel sse41_kernel() {
  return __builtin_cpu_supports("sse4.1") ? draw_any_row : nullptr;
}
#endif

}  // namespace spantex::kernels

#elif !SPANTEX_LINEAR
namespace spantex::kernels {
row_kernel sse41_kernel() { return nullptr; }
}  // namespace spantex::kernels
#endif
