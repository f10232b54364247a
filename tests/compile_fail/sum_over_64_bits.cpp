// SPDX-License-Identifier: Apache-2.0
// expects: spantex: a format of more than 64 bits; narrow an operand by name first
// A sum whose carry has no place is refused.
#include <spantex/fixed.hpp>

auto sum(spantex::u<64, 0> a, spantex::u<64, 0> b) { return a + b; }
