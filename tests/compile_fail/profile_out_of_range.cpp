// SPDX-License-Identifier: Apache-2.0
// expects: spantex: a profile's numbers are outside their documented ranges
// Word lengths have limits.
#include <spantex/profile.hpp>

constexpr spantex::profile too_fine{.subtexel_bits = 9};
spantex::fixed_profile<too_fine> refused;
