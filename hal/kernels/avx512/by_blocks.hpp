// SPDX-License-Identifier: Apache-2.0
// AVX-512 with VBMI, VBMI2 and VNNI: eight spans of a row are planned at once, one 64-bit lane each; then each span's 64 pixels are computed, sixteen 32-bit
// lanes at a time. Local memory is registers: a channel of 16x16 texels is four of them, wherever it begins, and a byte permute of two registers is 64 fetches.
//
// Every number equals the scalar datapath's (docs/SPEC.md). Rounding shifts are folded: floor(floor(x / 2^a) + k) / 2^b) = floor((x + k 2^a) / 2^(a + b)),
// so a position is rounded to coordinate_bits and then snapped in one addition and one shift; it is counted from its section's first texel, so that
// it may wrap around in 32 bits before that is taken off.
//
// Included by ../avx512.cpp and ../avx512_linear_light.cpp alone, which end the target.
#pragma once
#include "../avx512_rows.hpp"
#include "../kernel.hpp"
#include "../numbers.hpp"

#include <immintrin.h>

#include <type_traits>

#include <spantex/coordinates.hpp>
#include <spantex/footprint.hpp>
#include <spantex/level.hpp>
#include <spantex/reciprocal.hpp>
#include <spantex/srgb.hpp>

#include "../targets/avx512.hpp"

namespace spantex::kernels {
namespace {

#include "../vectors/inlined.hpp"
#include "../vectors/texels_avx512.hpp"
#include "../vectors/two_rows.hpp"
#include "lanes.hpp"
#include "quads.hpp"
#include "log2.hpp"
#include "batch.hpp"
#include "columns.hpp"
#include "places.hpp"
#include "plan.hpp"
#include "positions.hpp"
#include "scaled.hpp"
#include "levels.hpp"
#include "sections.hpp"
#include "filters.hpp"
#include "code_tables.hpp"
#include "light.hpp"
#include "../vectors/move_texels.hpp"
#include "spans.hpp"
#include "by_level.hpp"
#include "aniso.hpp"
#include "batches.hpp"

}  // namespace
}  // namespace spantex::kernels
