// SPDX-License-Identifier: Apache-2.0
// Start of an RV32 core on QEMU's board `virt`.
#include <stdint.h>

#include "memory.hpp"
#include "semihosting.hpp"

int main();

extern "C" {
extern uint32_t bss_begin[], bss_end[];
extern void (*init_array_begin[])();
extern void (*init_array_end[])();

[[gnu::naked, gnu::section(".start"), gnu::used]] void _start() { asm volatile("la sp, stack_top\n j start"); }

[[noreturn, gnu::used]] void start() {
  for (volatile uint32_t* to = bss_begin; to < bss_end; ++to) *to = 0;
  for (auto f = init_array_begin; f < init_array_end; ++f) (*f)();
  semihosting::leave(main());
}
}
