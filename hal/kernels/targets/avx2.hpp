// SPDX-License-Identifier: Apache-2.0
// From here on code is for AVX2, until end.hpp; what headers define before stays compiled for any machine. Included each time it is named: no #pragma once.
#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2,bmi,bmi2,lzcnt"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2,bmi,bmi2,lzcnt")
#endif
