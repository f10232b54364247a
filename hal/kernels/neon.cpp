// SPDX-License-Identifier: Apache-2.0
// The vector kernel with NEON, on arm64: four 32-bit lanes.
#include "kernel.hpp"
#include "level_rows.hpp"
#include "linear_light.hpp"
#include "numbers.hpp"
#include "upright.hpp"

#if defined(__aarch64__) && !defined(__AARCH64EB__)
#include <arm_neon.h>

#include <spantex/coordinates.hpp>
#include <spantex/exp2.hpp>
#include <spantex/footprint.hpp>
#include <spantex/level.hpp>

namespace spantex::kernels {
namespace {

#if SPANTEX_LINEAR
#define SPANTEX_TABLES 0
#else
#define SPANTEX_TABLES 1
#endif
constexpr int width = 4;
#include "vectors/common.hpp"
#include "vectors/lanes.hpp"
#include "vectors/neon.hpp"
#include "vectors/reciprocal.hpp"
#include "vectors/low_high.hpp"
#include "vectors/log2.hpp"
#include "vectors/log2_neon.hpp"
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
#include "vectors/nearest_neon.hpp"
#include "vectors/affine_numbers.hpp"
#include "vectors/affine.hpp"
#include "vectors/tables_neon.hpp"
#include "vectors/aniso.hpp"
#include "vectors/two_rows.hpp"
#include "vectors/upright.hpp"
#include "vectors/blend_pixels.hpp"
#include "vectors/kernel.hpp"

void draw_any_row(const row_work& work) { draw_by_filter(rows, neon_linear_light, work); }
#endif

}  // namespace

#if SPANTEX_LINEAR
constinit const row_kernels neon_linear_light = linear_light::rows;
#else
row_kernel neon_kernel() { return draw_any_row; }
#endif

}  // namespace spantex::kernels

#elif !SPANTEX_LINEAR
namespace spantex::kernels {
row_kernel neon_kernel() { return nullptr; }
}  // namespace spantex::kernels
#endif
