// SPDX-License-Identifier: Apache-2.0
// Start of a Cortex-M: vector table, memory, FPU and MVE if there are any, main, end of the emulation.
#include <stdint.h>

#include "memory.hpp"
#include "semihosting.hpp"

int main();

extern "C" {
extern uint32_t data_in_flash[], data_begin[], data_end[], bss_begin[], bss_end[], stack_top[];
extern void (*init_array_begin[])();
extern void (*init_array_end[])();

// Before any code that may use vectors.
[[gnu::naked, noreturn]] void reset_handler() {
#if defined(__ARM_FEATURE_MVE) || (defined(__ARM_FP) && __ARM_FP)
  asm volatile("ldr r0, =0xE000ED88\n ldr r1, [r0]\n orr r1, r1, #0xF00000\n str r1, [r0]\n dsb\n isb");
#endif
#if !defined(__ARM_FEATURE_UNALIGNED)  // CCR.UNALIGN_TRP: where code for Cortex-M0+ runs on an emulated M3, it faults as on its own core
  asm volatile("ldr r0, =0xE000ED14\n ldr r1, [r0]\n movs r2, #8\n orr r1, r2\n str r1, [r0]");
#endif
  asm volatile("ldr r0, =start\n bx r0");
}

[[noreturn, gnu::used]] void start() {
  for (volatile uint32_t *to = data_begin, *from = data_in_flash; to < data_end; ++to, ++from) *to = *from;
  for (volatile uint32_t* to = bss_begin; to < bss_end; ++to) *to = 0;
  for (auto f = init_array_begin; f < init_array_end; ++f) (*f)();
  semihosting::leave(main());
}

[[noreturn]] void fault() { semihosting::leave(99); }

[[gnu::section(".vectors"), gnu::used]] const void* const vectors[16] = {
    stack_top, reinterpret_cast<const void*>(&reset_handler),
    reinterpret_cast<const void*>(&fault), reinterpret_cast<const void*>(&fault), reinterpret_cast<const void*>(&fault),
    reinterpret_cast<const void*>(&fault), reinterpret_cast<const void*>(&fault)};
}
