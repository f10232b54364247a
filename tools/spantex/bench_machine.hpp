// SPDX-License-Identifier: Apache-2.0
// Where and what was measured.
#pragma once
#include <string>

namespace spantex::tool {

struct bench_machine {
  std::string processor, system, date;  // date: UTC
  int processors;                       // that this process may use
  double load;                          // of the last minute: above `processors` somebody else measures too
  std::string compiler, flags, commit;  // of the command
};

bench_machine this_machine();
// "g++ 12.2.0, -std=c++20 -O2 -mstringop-strategy=libcall": what counts of instructions depend on.
std::string build_text(const bench_machine& m);

}  // namespace spantex::tool
