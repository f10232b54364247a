// SPDX-License-Identifier: Apache-2.0
// Work over rows or bands on several threads. The work must not depend on how it is divided.
#pragma once
#include <stdint.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace spantex::sim {

inline int hardware_threads() { return std::max(1, int(std::thread::hardware_concurrency())); }

// Called as work is done, from any thread: parts done since the last call.
using progress_callback = std::function<void(int parts_done)>;

// Threads that wait for work, this one among them: a picture may take less time than starting a thread does, or than waking one (20 to 50 us):
// they look out for work for a while before they sleep.
class thread_team {
 public:
  explicit thread_team(int threads) : shares_(size_t(std::max(1, threads))) {
    try {
      for (int k = 1; k < threads; ++k) others_.emplace_back([this, k] { serve(k); });
    } catch (...) {
      dismiss();
      throw;
    }
  }
  thread_team(const thread_team&) = delete;
  ~thread_team() { dismiss(); }

  // Calls work(k) for k in [0, count), each once, in this order; the first exception is thrown again here.
  template <class Work>
  void run(int count, Work work) { run_by_shares({0, count}, work); }

  // The same for k in [starts.front(), starts.back()), but a thread begins with a share of its own, from starts[thread] to the next, the same one each time, since what it
  // wrote there last may still lie in its processor's cache, and goes on with the others' then. No more shares than threads.
  template <class Work>
  void run_by_shares(const std::vector<int>& starts, Work work) {
    for (size_t k = 0; k < shares_.size(); ++k) {
      shares_[k].next = starts[std::min(k, starts.size() - 1)];
      shares_[k].end = starts[std::min(k + 1, starts.size() - 1)];
    }
    std::atomic<bool> failed{false};
    std::exception_ptr error;
    std::mutex lock;
    work_ = [&](int thread) {
      try {
        for (size_t n = 0; n < shares_.size(); ++n) {
          share& from = shares_[(size_t(thread) + n) % shares_.size()];
          for (int k; !failed && (k = from.next++) < from.end;) work(k);
        }
      } catch (...) {
        const std::lock_guard guard(lock);
        if (!error) error = std::current_exception();
        failed = true;
      }
    };
    working_ = int(others_.size());
    ++round_;
    round_.notify_all();
    work_(0);
    for (int n = working_; n != 0; n = working_) wait_for_change(working_, n);
    if (error) std::rethrow_exception(error);
  }

 private:
  static constexpr int last_round = -1;
  static constexpr std::chrono::microseconds looking_out{2000};

  // What is left of a share: in a line of the caches of its own, since others ask only once they have nothing left themselves.
  struct alignas(64) share {
    std::atomic<int> next{0};
    int end = 0;
  };

  // The processor is offered to whoever needs it more now and then: that takes half a microsecond, looking tens of nanoseconds.
  static constexpr int looks_between_yields = 500;
  static void look_again() {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
  }

  static void wait_for_change(const std::atomic<int>& value, int old) {
    const auto begun = std::chrono::steady_clock::now();
    while (std::chrono::steady_clock::now() - begun < looking_out) {
      for (int n = 0; n < looks_between_yields; ++n) {
        if (value != old) return;
        look_again();
      }
      std::this_thread::yield();
    }
    value.wait(old);
  }

  void dismiss() {
    round_ = last_round;
    round_.notify_all();
  }

  void serve(int thread) {
    for (int seen = 0;;) {
      wait_for_change(round_, seen);
      seen = round_;
      if (seen == last_round) return;
      work_(thread);
      if (--working_ == 0) working_.notify_one();
    }
  }

  std::vector<share> shares_;  // a thread's each
  std::function<void(int thread)> work_;
  std::atomic<int> round_{0}, working_{0};
  std::vector<std::jthread> others_;  // last: they end first
};

// The same with threads of its own.
template <class Work>
void for_each_index(int count, int threads, Work work) {
  thread_team(std::min(threads, count)).run(count, work);
}

}  // namespace spantex::sim
