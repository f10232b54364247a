// SPDX-License-Identifier: Apache-2.0
// Simplifies the numbers of a failing case while it still fails.
#pragma once
#include <vector>

#include "sim/exact.hpp"

namespace spantex::sim {

// Tries zero for each number, then the number with only its upper bits, until nothing more can go. Numbers only move towards zero, so sums
// of magnitudes that were in range stay there. fails(numbers) must be true on entry.
template <class Fails>
std::vector<int128> shrink(std::vector<int128> numbers, Fails fails) {
  for (bool smaller = true; smaller;) {
    smaller = false;
    for (int128& number : numbers) {
      const int128 original = number;
      for (int kept = 0; kept < bits_of(original); ++kept) {
        const int128 unit = int128(1) << (bits_of(original) - kept);
        number = original / unit * unit;
        if (number != original && fails(numbers)) {
          smaller = true;
          break;
        }
        number = original;
      }
    }
  }
  return numbers;
}

}  // namespace spantex::sim
