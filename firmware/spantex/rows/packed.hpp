// SPDX-License-Identifier: Apache-2.0
// Pairs of 16-bit numbers in one word, and RGB565 colours as numbers that can be weighted.
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>

// Loops in assembly are for gcc: clang (14) finds too few registers for them. At -O0 a frame pointer takes one that they need; with MVE gcc 12 finds too
// few at -Os (and at -O3 and -Og in places, which no macro tells: there -DSPANTEX_ROWS_DSP=0, the plain loops, the same pixels). Two neighbours are
// loaded as one word at any texel: not where words have to be aligned (-mno-unaligned-access).
#ifndef SPANTEX_ROWS_DSP
#if !defined(__clang__) && defined(__ARM_FEATURE_DSP) && __ARM_FEATURE_DSP && defined(__ARM_FEATURE_UNALIGNED) && __ARM_ARCH_PROFILE == 'M' && defined(__ARMEL__) && defined(__thumb2__) && defined(__OPTIMIZE__) && !(defined(__ARM_FEATURE_MVE) && defined(__OPTIMIZE_SIZE__))
#define SPANTEX_ROWS_DSP 1
#else
#define SPANTEX_ROWS_DSP 0
#endif
#endif

#if SPANTEX_ROWS_DSP && defined(__ARM_FEATURE_MVE) && __ARM_FEATURE_MVE
#define SPANTEX_ROWS_MVE 1
#else
#define SPANTEX_ROWS_MVE 0
#endif

// Where code is to be small the plain loops are; a frame pointer would take a register here too (-DSPANTEX_ROWS_THUMB1=0).
#ifndef SPANTEX_ROWS_THUMB1
#if !defined(__clang__) && (defined(__ARM_ARCH_6M__) || defined(__ARM_ARCH_8M_BASE__)) && defined(__ARMEL__) && defined(__OPTIMIZE__) && !defined(__OPTIMIZE_SIZE__)
#define SPANTEX_ROWS_THUMB1 1
#else
#define SPANTEX_ROWS_THUMB1 0
#endif
#endif

// Which kernels there are depends on the flags of a file. What is of another size with them has another name: files of one program may differ.
#if SPANTEX_ROWS_MVE
#define SPANTEX_ROWS_KERNELS with_mve
#elif SPANTEX_ROWS_DSP
#define SPANTEX_ROWS_KERNELS with_dsp
#elif SPANTEX_ROWS_THUMB1
#define SPANTEX_ROWS_KERNELS with_thumb1
#else
#define SPANTEX_ROWS_KERNELS plain
#endif

namespace spantex::rows {

// Texels may lie in memory that was written as words.
using texel565 = uint16_t __attribute__((__may_alias__));

// Channels far enough apart for weights of 5 bits: green 21..31, red 11..20, blue 0..10.
inline constexpr uint32_t spread_mask = 0x07E0F81F;
constexpr uint32_t spread(uint32_t texel) { return (texel | texel << 16) & spread_mask; }
constexpr uint32_t gathered(uint32_t colour) { return (colour | colour >> 16) & 0xFFFF; }

}  // namespace spantex::rows
