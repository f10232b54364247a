// SPDX-License-Identifier: Apache-2.0
// Text out: semihosting on a device, stdout on a host.
#pragma once
#include <stdint.h>

#if defined(__linux__)
#include <stdio.h>
namespace console {
inline void print(const char* text) { fputs(text, stdout); }
inline void print_hex(uint32_t x) { printf("%08x", unsigned(x)); }
}  // namespace console
#else
#include "semihosting.hpp"
namespace console {
using semihosting::print;
using semihosting::print_hex;
}  // namespace console
#endif
