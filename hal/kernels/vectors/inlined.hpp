// SPDX-License-Identifier: Apache-2.0
// Vector kernels: what must melt into its caller.
#pragma once

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define SPANTEX_INLINED  // it takes minutes over functions as large as these
#endif
#endif
#if !defined(SPANTEX_INLINED)
#define SPANTEX_INLINED __attribute__((always_inline))
#endif
#define SPANTEX_INLINE SPANTEX_INLINED inline
