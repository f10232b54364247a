// SPDX-License-Identifier: Apache-2.0
#include "Arduino.h"

#include <stdio.h>

serial_port Serial;
void serial_port::println(uint32_t x, int base) { printf(base == HEX ? "%X\n" : "%u\n", unsigned(x)); }

int main() {
  setup();
  loop();
}
