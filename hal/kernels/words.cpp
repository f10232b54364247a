// SPDX-License-Identifier: Apache-2.0
// The vector kernel for any machine: positions in whatever lanes the compiler makes of four 32-bit numbers, texels in 64-bit words.
#include "kernel.hpp"
#include "level_rows.hpp"
#include "linear_light.hpp"
#include "numbers.hpp"
#include "upright.hpp"

#include <spantex/coordinates.hpp>
#include <spantex/exp2.hpp>
#include <spantex/footprint.hpp>
#include <spantex/level.hpp>

namespace spantex::kernels {
namespace {

#define SPANTEX_TABLES 0
constexpr int width = 4;
#include "vectors/common.hpp"
#include "vectors/lanes.hpp"
#include "vectors/words.hpp"
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
#include "vectors/spans.hpp"
#include "vectors/affine_numbers.hpp"
#include "vectors/affine.hpp"
#include "vectors/aniso.hpp"
#include "vectors/two_rows.hpp"
#include "vectors/upright.hpp"
#include "vectors/blend_pixels.hpp"
#include "vectors/kernel.hpp"

void draw_any_row(const row_work& work) { draw_by_filter(rows, words_linear_light, work); }
#endif

}  // namespace

#if SPANTEX_LINEAR
constinit const row_kernels words_linear_light = linear_light::rows;
#else
row_kernel words_kernel() { return draw_any_row; }
#endif

}  // namespace spantex::kernels
