// SPDX-License-Identifier: Apache-2.0
// How the proofs ask the library: constants first, a line 'name low high' each, then 'end'; then a line of numbers for every line
// 'step number number ...' on standard input.
#pragma once
#include <spantex/profile.hpp>

#include <cstdint>
#include <cstdio>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

namespace spantex::identity {

using numbers = std::vector<int64_t>;

// Found by trying: the interval about the default that is_valid() accepts.
inline void print_range(const char* name, int profile::*field) {
  profile p{};
  int low = p.*field, high = low;
  while (p.*field = low - 1, is_valid(p)) --low;
  while (p.*field = high + 1, is_valid(p)) ++high;
  std::printf("%s %d %d\n", name, low, high);
}

inline void print_constant(const char* name, int value) { std::printf("%s %d 0\n", name, value); }

template <class Answer>
void answer_questions(Answer answer) {
  std::puts("end");
  for (std::string line; std::getline(std::cin, line);) {
    std::istringstream in(line);
    std::string step;
    in >> step;
    numbers x;
    for (int64_t n; in >> n;) x.push_back(n);
    for (const int64_t n : answer(step, x)) std::printf("%lld ", static_cast<long long>(n));
    std::puts("");
  }
}

}  // namespace spantex::identity
