// SPDX-License-Identifier: Apache-2.0
// Vector kernels: what must melt into its caller.
#pragma once

#define SPANTEX_INLINED __attribute__((always_inline))
#define SPANTEX_INLINE SPANTEX_INLINED inline
