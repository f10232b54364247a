// SPDX-License-Identifier: Apache-2.0
// expects: spantex: a format of more than 64 bits; narrow an operand by name first
// A product that needs more than 64 bits is refused, not cut.
#include <spantex/fixed.hpp>

auto product(spantex::s<31, 8> a, spantex::s<31, 8> b) { return a * b; }
