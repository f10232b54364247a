// SPDX-License-Identifier: Apache-2.0
// A device for the bench (docs/BENCH.md) on a microcontroller whose pins are memory-mapped: one register a direction, one of outputs, one of inputs.
// Bits of all three: 0..7 data, 8 clock, 9 direction, 10 command, 11 reset (inputs), 12 ready, 13 busy, 14 error (outputs).
#include <firmware/bench/port.hpp>
#include <firmware/bench/responder.hpp>
#include <hal/direct_engine.hpp>

using namespace spantex;

#ifndef SPANTEX_PIN_REGISTERS
#define SPANTEX_PIN_REGISTERS 0x40010000
#endif

namespace {

struct register_pins {
  struct block { volatile uint32_t is_output, output, input; };
  static block& registers() { return *reinterpret_cast<block*>(uintptr_t(SPANTEX_PIN_REGISTERS)); }
  static constexpr uint32_t data_bits = 0xFF, shown_bits = 0x7000;

  bench::control_lines control() {
    seen = registers().input;
    return {(seen & 0x100) != 0, (seen & 0x200) != 0, (seen & 0x400) != 0, (seen & 0x800) != 0};
  }
  uint8_t data() { return uint8_t(registers().input); }
  void drive(uint8_t value) {
    registers().output = (registers().output & ~data_bits) | value;
    registers().is_output = registers().is_output | data_bits;
  }
  void release() { registers().is_output = (registers().is_output & ~data_bits) | shown_bits; }
  void show(const bench::status_lines& s) {
    registers().output = (registers().output & ~shown_bits) | (s.ready ? 0x1000u : 0) | (s.busy ? 0x2000u : 0) | (s.error ? 0x4000u : 0);
  }
  uint32_t seen = 0;
};

using word_lengths = fixed_profile<profiles::seed>;
using unit = direct_engine<word_lengths>;
using frames = bench::responder<unit, word_lengths>;

constinit register_pins pins;
constinit unit engine;
constinit frames commands(engine);

}  // namespace

int main() {
  bench::port port(pins, commands);
  for (;;) port.poll();
}
