// SPDX-License-Identifier: Apache-2.0
// Semihosting: text, files and the end of a program that runs under an emulator or a debugger (Arm's and RISC-V's numbers are the same).
#pragma once
#include <stddef.h>
#include <stdint.h>

namespace semihosting {

inline uint32_t call(uint32_t operation, const void* argument) {
#if defined(__arm__)
  register uint32_t r0 asm("r0") = operation;
  register const void* r1 asm("r1") = argument;
  asm volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
  return r0;
#elif defined(__riscv)
  register uint32_t a0 asm("a0") = operation;
  register const void* a1 asm("a1") = argument;
  asm volatile(".balign 16\n .option push\n .option norvc\n slli x0, x0, 0x1f\n ebreak\n srai x0, x0, 7\n .option pop" : "+r"(a0) : "r"(a1) : "memory");
  return a0;
#endif
}

inline void print(const char* text) { call(0x04, text); }

[[noreturn]] inline void leave(int code) {
  const uint32_t arguments[] = {0x20026, uint32_t(code)};
  for (;;) call(0x20, arguments);
}

// A new file of the host, written whole. False if that failed.
inline bool write_file(const char* name, const void* bytes, uint32_t count) {
  uint32_t length = 0;
  while (name[length] != 0) ++length;
  const uintptr_t open[] = {reinterpret_cast<uintptr_t>(name), 5 /* wb */, length};
  const uint32_t handle = call(0x01, open);
  if (handle == 0xFFFFFFFFu) return false;
  const uintptr_t write[] = {handle, reinterpret_cast<uintptr_t>(bytes), count}, close[] = {handle};
  const bool good = call(0x05, write) == 0;
  return call(0x02, close) == 0 && good;
}

inline void print_hex(uint32_t x) {
  char text[9] = {};
  for (int k = 0; k < 8; ++k) text[k] = "0123456789abcdef"[x >> (28 - 4 * k) & 15];
  print(text);
}

}  // namespace semihosting
