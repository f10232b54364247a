// SPDX-License-Identifier: Apache-2.0
// AVX-512: texels that local memory does not hold are gathered.
#include "avx512_rows.hpp"

#if defined(__x86_64__)
#define SPANTEX_GATHERS 1
#include "avx512/by_rows.hpp"

namespace spantex::kernels {
row_reader gathering_reader() { return reader; }
}  // namespace spantex::kernels
#endif
