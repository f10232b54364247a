// SPDX-License-Identifier: Apache-2.0
// From here on code is for SSE4.1, until end.hpp; what headers define before stays compiled for any machine. Included each time it is named: no #pragma once.
#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("sse4.1"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("sse4.1")
#endif
