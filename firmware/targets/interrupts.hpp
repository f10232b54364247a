// SPDX-License-Identifier: Apache-2.0
// Interrupts of a Cortex-M with VTOR: a vector table in RAM, which programs without interrupts do not carry.
#pragma once
#include <stdint.h>

namespace interrupts {

inline constexpr int exceptions = 16, lines = 64;

// Exceptions keep the handlers that they have.
inline void connect(int line, void (*handler)()) {
  alignas(512) static const void* table[exceptions + lines];
  volatile uint32_t& vtor = *reinterpret_cast<volatile uint32_t*>(0xE000ED08);
  const auto here = uint32_t(reinterpret_cast<uintptr_t>(table));
  if (vtor != here) {
    for (int k = 0; k < exceptions; ++k) table[k] = reinterpret_cast<const void* const*>(uintptr_t(vtor))[k];
    vtor = here;
  }
  table[exceptions + line] = reinterpret_cast<const void*>(handler);
}

// Lines that were disabled keep what they have to tell until they are enabled.
inline void enable(int line, bool on) {
  reinterpret_cast<volatile uint32_t*>(on ? 0xE000E100 : 0xE000E180)[line / 32] = 1u << (line % 32);
  asm volatile("dsb\n isb" ::: "memory");
}

}  // namespace interrupts
