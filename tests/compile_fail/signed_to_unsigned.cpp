// SPDX-License-Identifier: Apache-2.0
// expects: spantex: implicit conversion would lose bits; use floor_to, round_to, sat_to or wrap_to
// A sign is not dropped by assignment.
#include <spantex/fixed.hpp>

spantex::u<16, 16> unsigned_of(spantex::s<15, 16> x) { return x; }
