// SPDX-License-Identifier: Apache-2.0
// AVX-512 in linear light: what local memory does not hold.
#include "avx512_rows.hpp"

#if defined(__x86_64__)
#define SPANTEX_LINEAR 1
#define SPANTEX_GATHERS 0
#include "avx512/by_rows.hpp"

namespace spantex::kernels {
row_reader linear_light_reader() { return reader; }
}  // namespace spantex::kernels
#endif
