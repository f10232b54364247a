// SPDX-License-Identifier: Apache-2.0
// Work over rows or bands on several threads. The work must not depend on how it is divided.
#pragma once
#include <algorithm>
#include <atomic>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace spantex::sim {

inline int hardware_threads() { return std::max(1, int(std::thread::hardware_concurrency())); }

// Called as work is done, from any thread: parts done since the last call.
using progress_callback = std::function<void(int parts_done)>;

// Calls work(k) for k in [0, count), each once; the first exception is thrown again here.
template <class Work>
void for_each_index(int count, int threads, Work work) {
  std::atomic<int> next{0};
  std::exception_ptr error;
  std::mutex lock;
  const auto run = [&] {
    try {
      for (int k = next++; k < count; k = next++) work(k);
    } catch (...) {
      const std::lock_guard guard(lock);
      if (!error) error = std::current_exception();
      next = count;
    }
  };
  std::vector<std::jthread> others;
  for (int k = 1; k < std::min(threads, count); ++k) others.emplace_back(run);
  run();
  others.clear();
  if (error) std::rethrow_exception(error);
}

}  // namespace spantex::sim
