// SPDX-License-Identifier: Apache-2.0
// expects: spantex: sat_to changes the range only; round first
// Saturation does not move the point.
#include <spantex/fixed.hpp>

auto other(spantex::s<15, 16> x) { return spantex::sat_to<spantex::s<7, 8>>(x); }
