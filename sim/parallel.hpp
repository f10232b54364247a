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
#include <utility>
#include <vector>

namespace spantex::sim {

inline int hardware_threads() { return std::max(1, int(std::thread::hardware_concurrency())); }

// Called as work is done, from any thread: parts done since the last call.
using progress_callback = std::function<void(int parts_done)>;

// Threads that wait for work, this one among them: a picture may take less time than starting a thread does, or than waking one (20 to 50 us):
// they look out for work for a while before they sleep. A line of the caches may take a third of a microsecond from one processor to another, so that what a thread is told,
// and what is left of its share, is one.
class thread_team {
 public:
  explicit thread_team(int threads) : boxes_(size_t(std::max(1, threads))) {
    try {
      for (int k = 1; k < threads; ++k) others_.emplace_back([this, k] { serve(k); });
    } catch (...) {
      dismiss();
      throw;
    }
  }
  thread_team(const thread_team&) = delete;
  ~thread_team() { dismiss(); }
  int size() const { return int(boxes_.size()); }

  // Calls work(k) for k in [0, count), each once, in this order; the first exception is thrown again here.
  template <class Work>
  void run(int count, Work work) {
    run_by_shares({0, count}, [&](int k, int) { work(k); });
  }

  // The same for k in [starts.front(), starts.back()), by work(k, thread), but a thread begins with a share of its own, from starts[thread] to the next, the same one each time, since what it
  // wrote there last may still lie in its processor's cache, and goes on with the others' then. No more shares than threads.
  template <class Work>
  void run_by_shares(const std::vector<int>& starts, Work work) {
    for (size_t k = 0; k < boxes_.size(); ++k) {
      boxes_[k].next = starts[std::min(k, starts.size() - 1)];
      boxes_[k].end = starts[std::min(k + 1, starts.size() - 1)];
      boxes_[k].take = [](thread_team& team, void* of, int thread) { team.take_shares(*static_cast<Work*>(of), thread); };
      boxes_[k].work = &work;
    }
    const int round = ++boxes_[0].round;
    for (size_t k = 1; k < boxes_.size(); ++k) {
      boxes_[k].round = round;
      boxes_[k].round.notify_one();
    }
    take_shares(work, 0);
    for (size_t k = 1; k < boxes_.size(); ++k)
      for (int done = boxes_[k].done; done != round; done = boxes_[k].done) wait_for_change(boxes_[k].done, done);
    if (!failed_) return;
    failed_ = false;
    std::rethrow_exception(std::exchange(error_, nullptr));
  }

 private:
  static constexpr int last_round = -1;
  static constexpr std::chrono::microseconds looking_out{2000};

  struct alignas(64) mailbox {
    std::atomic<int> round{0}, done{0};  // that the thread is to begin; that it has ended
    std::atomic<int> next{0};            // of its share
    int end = 0;
    void (*take)(thread_team& team, void* work, int thread) = nullptr;
    void* work = nullptr;
  };

  template <class Work>
  void take_shares(Work& work, int thread) {
    try {
      for (size_t n = 0; n < boxes_.size(); ++n) {
        mailbox& from = boxes_[(size_t(thread) + n) % boxes_.size()];
        for (int k; !failed_ && (k = from.next++) < from.end;) work(k, thread);
      }
    } catch (...) {
      const std::lock_guard guard(lock_);
      if (!error_) error_ = std::current_exception();
      failed_ = true;
    }
  }

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
    for (mailbox& box : boxes_) {
      box.round = last_round;
      box.round.notify_one();
    }
  }

  void serve(int thread) {
    mailbox& box = boxes_[size_t(thread)];
    for (int seen = 0;;) {
      wait_for_change(box.round, seen);
      seen = box.round;
      if (seen == last_round) return;
      box.take(*this, box.work, thread);
      box.done = seen;
      box.done.notify_one();
    }
  }

  std::vector<mailbox> boxes_;  // a thread's each
  std::atomic<bool> failed_{false};
  std::exception_ptr error_;
  std::mutex lock_;
  std::vector<std::jthread> others_;  // last: they end first
};

// The same with threads of its own.
template <class Work>
void for_each_index(int count, int threads, Work work) {
  thread_team(std::min(threads, count)).run(count, work);
}

}  // namespace spantex::sim
