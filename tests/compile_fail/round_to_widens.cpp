// SPDX-License-Identifier: Apache-2.0
// expects: spantex: round_to widens; a plain conversion does that
// round_to drops bits, it does not add any.
#include <spantex/fixed.hpp>

auto more(spantex::s<15, 8> x) { return spantex::round_to<16>(x); }
