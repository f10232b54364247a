// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <stddef.h>
#include <stdint.h>

extern "C" {

// What gcc may call for copies and fills; without the library they are ours. Words where both ends are aligned.
inline __attribute__((used)) void* memcpy(void* to, const void* from, size_t n) {
  auto* out = static_cast<volatile uint8_t*>(to);
  auto* in = static_cast<const uint8_t*>(from);
  if (((reinterpret_cast<uintptr_t>(to) | reinterpret_cast<uintptr_t>(from)) & 3) == 0)
    for (; n >= 4; n -= 4, out += 4, in += 4) *reinterpret_cast<volatile uint32_t*>(out) = *reinterpret_cast<const uint32_t*>(in);
  for (; n > 0; --n) *out++ = *in++;
  return to;
}
inline __attribute__((used)) void* memset(void* to, int value, size_t n) {
  auto* out = static_cast<volatile uint8_t*>(to);
  if ((reinterpret_cast<uintptr_t>(to) & 3) == 0)
    for (; n >= 4; n -= 4, out += 4) *reinterpret_cast<volatile uint32_t*>(out) = (value & 255u) * 0x01010101u;
  for (; n > 0; --n) *out++ = uint8_t(value);
  return to;
}

}  // extern "C"
