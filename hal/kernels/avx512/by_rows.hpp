// SPDX-License-Identifier: Apache-2.0
// AVX-512 kernel: what local memory does not hold: the other machines' kernel, with sixteen lanes. Texels are gathered if SPANTEX_GATHERS, else loaded one by one.
// In linear light if SPANTEX_LINEAR. Included by ../avx512_gathers.cpp, ../avx512_loads.cpp and ../avx512_linear_light_rows.cpp alone.
#pragma once
#include "../avx512_rows.hpp"
#include "../linear_light.hpp"
#include "../numbers.hpp"

#include <immintrin.h>

#include <spantex/coordinates.hpp>
#include <spantex/footprint.hpp>
#include <spantex/level.hpp>
#include <spantex/reciprocal.hpp>

#include "../targets/avx512.hpp"

namespace spantex::kernels {
namespace {

#define SPANTEX_TABLES 0
#define SPANTEX_AVX2 0
#define SPANTEX_AVX512 1
#include "../vectors/common.hpp"
constexpr int width = 16;
#include "../vectors/lanes.hpp"
#include "../vectors/texels_avx512.hpp"
#include "../vectors/avx512.hpp"
#include "../vectors/series_x86.hpp"
#include "../vectors/reciprocal.hpp"
#include "../vectors/even_odd.hpp"
#include "../vectors/log2.hpp"
#include "../vectors/levels.hpp"
#include "../vectors/plan_lanes.hpp"
#include "../vectors/positions.hpp"
#include "../vectors/pixel_positions.hpp"
#include "../vectors/move_texels.hpp"
#if SPANTEX_LINEAR
#include "../vectors/linear_rows.hpp"
using linear_light::draw_planned;
void draw_any_row(const row_work& work) { draw_by_filter({}, linear_light::rows, work); }
#else
#include "../vectors/pixels.hpp"
#include "../vectors/spans.hpp"
#include "../vectors/aniso.hpp"
#include "../vectors/kernel.hpp"
void draw_any_row(const row_work& work) { draw_by_filter(rows, {}, work); }
#endif

constexpr row_reader reader{draw_any_row, draw_planned<filter::aniso>};

}  // namespace
}  // namespace spantex::kernels

#include "../targets/end.hpp"
