// SPDX-License-Identifier: Apache-2.0
// expects: spantex: a format needs at least one bit
// A format without bits holds nothing.
#include <spantex/fixed.hpp>

spantex::s<-4, 4> nothing{};
