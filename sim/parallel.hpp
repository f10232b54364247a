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

// Threads that wait for work, this one among them: a picture may take less time than starting a thread does.
class thread_team {
 public:
  explicit thread_team(int threads) {
    for (int k = 1; k < threads; ++k) others_.emplace_back([this] { serve(); });
  }
  thread_team(const thread_team&) = delete;
  ~thread_team() {
    round_ = last_round;
    round_.notify_all();
  }

  // Calls work(k) for k in [0, count), each once; the first exception is thrown again here.
  template <class Work>
  void run(int count, Work work) {
    std::atomic<int> next{0};
    std::exception_ptr error;
    std::mutex lock;
    share_ = [&] {
      try {
        for (int k = next++; k < count; k = next++) work(k);
      } catch (...) {
        const std::lock_guard guard(lock);
        if (!error) error = std::current_exception();
        next = count;
      }
    };
    working_ = int(others_.size());
    ++round_;
    round_.notify_all();
    share_();
    for (int n = working_; n != 0; n = working_) working_.wait(n);
    if (error) std::rethrow_exception(error);
  }

 private:
  static constexpr int last_round = -1;

  void serve() {
    for (int seen = 0;;) {
      round_.wait(seen);
      seen = round_;
      if (seen == last_round) return;
      share_();
      if (--working_ == 0) working_.notify_one();
    }
  }

  std::function<void()> share_;
  std::atomic<int> round_{0}, working_{0};
  std::vector<std::jthread> others_;  // last: they end first
};

// The same with threads of its own.
template <class Work>
void for_each_index(int count, int threads, Work work) {
  thread_team(std::min(threads, count)).run(count, work);
}

}  // namespace spantex::sim
