// SPDX-License-Identifier: Apache-2.0
// Where and what was measured.
#pragma once
#include <sched.h>

#include <string>

namespace spantex::tool {

struct bench_machine {
  std::string processor, system, date;  // date: UTC
  int processors;                       // that this process may use
  int measured_on;                      // the first of them
  double load;                          // of the last minute: above `processors` somebody else measures too
  std::string compiler, flags, commit;  // of the command
};

bench_machine this_machine();

// While it lives this thread stays on the first processor that it may use: one machine's need not be equally fast (virtual ones, whose cores others share), and who is
// moved between two draws is compared by that.
class on_one_processor {
 public:
  on_one_processor();
  ~on_one_processor();
  on_one_processor(const on_one_processor&) = delete;

 private:
  cpu_set_t before_;
};

// "g++ 12.2.0, -std=c++20 -O2": what counts of instructions depend on.
std::string build_text(const bench_machine& m);

}  // namespace spantex::tool
