// SPDX-License-Identifier: Apache-2.0
#include "bench_machine.hpp"

#include <stdlib.h>
#include <sys/utsname.h>
#include <time.h>

#include <fstream>

#include <sim/parallel.hpp>

#ifndef SPANTEX_COMMIT
#define SPANTEX_COMMIT "unknown"
#endif
#ifndef SPANTEX_FLAGS
#define SPANTEX_FLAGS "unknown"
#endif

namespace spantex::tool {
namespace {

std::string processor_name() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    const size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

std::string compiler_name() {
#ifdef __clang__
  return "clang++ " __clang_version__;
#else
  return "g++ " __VERSION__;
#endif
}

}  // namespace

bench_machine this_machine() {
  utsname name{};
  uname(&name);
  const time_t now = time(nullptr);
  tm utc{};
  gmtime_r(&now, &utc);
  char date[32];
  strftime(date, sizeof date, "%Y-%m-%d %H:%M UTC", &utc);
  double load = 0;
  getloadavg(&load, 1);
  return {processor_name(), std::string(name.sysname) + " " + name.release + " " + name.machine, date, sim::hardware_threads(), load,
          compiler_name(), SPANTEX_FLAGS, SPANTEX_COMMIT};
}

std::string build_text(const bench_machine& m) { return m.compiler + ", " + m.flags; }

}  // namespace spantex::tool
