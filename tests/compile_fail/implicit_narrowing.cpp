// SPDX-License-Identifier: Apache-2.0
// expects: spantex: implicit conversion would lose bits; use floor_to, round_to, sat_to or wrap_to
// Fewer integer bits only by name.
#include <spantex/fixed.hpp>

spantex::s<15, 16> narrowed(spantex::s<16, 16> x) { return x; }
