// SPDX-License-Identifier: Apache-2.0
// AVX-512 in linear light: sixteen lanes, from the map's rows.
#include "linear_light.hpp"

#if defined(__x86_64__)
#define SPANTEX_LINEAR 1
#define SPANTEX_GATHERS 0
#include "avx512/by_rows.hpp"

namespace spantex::kernels {
constinit const row_kernels avx512_linear_light = linear_light::rows;
}  // namespace spantex::kernels
#endif
