// SPDX-License-Identifier: Apache-2.0
// AVX-512: texels that local memory does not hold are loaded one by one.
#include "avx512_rows.hpp"

#if defined(__x86_64__)
#define SPANTEX_GATHERS 0
#include "avx512/by_rows.hpp"

namespace spantex::kernels {
row_reader loading_reader() { return reader; }
}  // namespace spantex::kernels
#endif
