// SPDX-License-Identifier: Apache-2.0
// From here on code is for AVX-512, until end.hpp; what headers define before stays compiled for any machine. Included each time it is named: no #pragma once.
#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx512f,avx512bw,avx512cd,avx512dq,avx512vl,avx512vbmi,avx512vbmi2,avx512vnni"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx512f,avx512bw,avx512cd,avx512dq,avx512vl,avx512vbmi,avx512vbmi2,avx512vnni")
#endif
