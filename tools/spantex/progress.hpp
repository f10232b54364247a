// SPDX-License-Identifier: Apache-2.0
// A progress bar on a terminal's stderr, for work that takes longer than a moment. Silent in a pipe; gone when the work is done.
#pragma once
#include <chrono>
#include <mutex>
#include <string>

#include <sim/parallel.hpp>

namespace spantex::tool {

class progress_bar {
 public:
  progress_bar(std::string label, int total);
  ~progress_bar();
  progress_bar(const progress_bar&) = delete;
  progress_bar& operator=(const progress_bar&) = delete;

  void advance(int parts);  // from any thread
  sim::progress_callback callback();

 private:
  using clock = std::chrono::steady_clock;

  std::string label_;
  int total_, done_ = 0;
  bool on_terminal_, shown_ = false;
  clock::time_point begun_ = clock::now(), drawn_ = begun_;
  std::mutex lock_;
};

}  // namespace spantex::tool
