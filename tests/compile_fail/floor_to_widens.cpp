// SPDX-License-Identifier: Apache-2.0
// expects: spantex: floor_to widens; a plain conversion does that
// floor_to drops bits, it does not add any.
#include <spantex/fixed.hpp>

auto more(spantex::s<15, 8> x) { return spantex::floor_to<16>(x); }
