// SPDX-License-Identifier: Apache-2.0
// expects: spantex: local memory holds 8x8, 16x16 or 32x32 texels of the finer level
// Sides of local memory are powers of two.
#include <spantex/local_memory.hpp>

spantex::local_memory<12> refused;
