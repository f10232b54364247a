// SPDX-License-Identifier: Apache-2.0
// Loaders (hal/texel_loader.hpp) for the emulated boards. Each has a pace, so that memory can be made fast or slow:
//
//   cooperative_loader   copies `texels` at every `polls`-th poll: no hardware; the copying is paid where the filter polls
//   timed_loader         copies `texels` in every interrupt of a timer
//   pl081_loader         Arm PL081, a second bus master: bursts of `texels`, one a tick of a timer; without a timer, one behind the other. What a
//                        burst's end is known by is the controller's interrupt, and the last one's releases the half
#pragma once
#include <stdint.h>

#include <hal/texel_loader.hpp>

namespace targets {

using namespace spantex;

inline volatile uint32_t& device_register(uintptr_t address) { return *reinterpret_cast<volatile uint32_t*>(address); }

// Before what an interrupt or another bus master has written is read, and before it may read what was written here.
inline void memory_barrier() { __atomic_thread_fence(__ATOMIC_SEQ_CST); }

// What all have: a place in the list, and `texels` at a time, `wait` apart.
class paced_loader {
 public:
  constexpr void set_pace(int texels, int wait) {
    texels_ = texels;
    wait_ = wait;
  }

 protected:
  copy_cursor at_;
  int texels_ = 1, wait_ = 1;
};

// Waits for polls.
class cooperative_loader : public paced_loader {
 public:
  constexpr void start(rgba8* texels, const texel_copy* copies, int count) { at_ = {texels, copies, count}; }
  constexpr status state() const { return at_.at_end() ? status::ok : status::half_busy; }
  constexpr void poll() {
    if (at_.at_end() || ++polled_ < wait_) return;
    polled_ = 0;
    at_.copy(texels_);
  }
  constexpr void stop() { at_ = {}; }

 private:
  int polled_ = 0;
};

// CMSDK's timer, of the MPS2 boards.
template <uintptr_t Base>
struct cmsdk_timer {
  static void start(uint32_t ticks) {
    device_register(Base + 8) = ticks - 1;  // reload
    device_register(Base + 4) = ticks - 1;  // value
    device_register(Base) = 9;              // interrupt, on
  }
  static void stop() {
    device_register(Base) = 0;
    clear();
  }
  static void clear() { device_register(Base + 0xC) = 1; }
};

// Waits for ticks. on_tick is to be called by the timer's interrupt.
template <class Timer>
class timed_loader : public paced_loader {
 public:
  void start(rgba8* texels, const texel_copy* copies, int count) {
    at_ = {texels, copies, count};
    busy_ = true;
    memory_barrier();
    Timer::start(uint32_t(wait_));
  }
  status state() const {
    if (busy_) return status::half_busy;
    memory_barrier();
    return status::ok;
  }
  void poll() {}
  void stop() {
    Timer::stop();
    busy_ = false;
    memory_barrier();
  }

  void on_tick() {
    Timer::clear();
    if (!busy_) return;
    at_.copy(texels_);
    if (!at_.at_end()) return;
    Timer::stop();
    memory_barrier();
    busy_ = false;
  }

 private:
  volatile bool busy_ = false;
};

// Channel 0 of a PL081. Waits for ticks; none: bursts follow each other. on_complete, on_error, on_tick are to be called by the interrupts of its terminal count, of its errors, of the timer.
template <uintptr_t Base, class Timer>
class pl081_loader : public paced_loader {
 public:
  void start(rgba8* texels, const texel_copy* copies, int count) {
    at_ = {texels, copies, count};
    failed_ = false;
    busy_ = true;
    device_register(configuration) = 1;
    memory_barrier();
    if (wait_ != 0) Timer::start(uint32_t(wait_));
    else begin_burst();
  }
  status state() const {
    if (busy_) return status::half_busy;
    memory_barrier();
    return failed_ ? status::device_error : status::ok;
  }
  void poll() {}
  void stop() {
    Timer::stop();
    device_register(channel_configuration) = 0;
    device_register(clear_complete) = 1;
    device_register(clear_error) = 1;
    bursting_ = false;
    busy_ = false;
    memory_barrier();
  }

  void on_tick() {
    Timer::clear();
    if (busy_ && !bursting_) begin_burst();
  }

  void on_complete() {
    if ((device_register(is_complete) & 1) == 0) return;
    device_register(clear_complete) = 1;
    if (!bursting_) return;
    bursting_ = false;
    at_.pass(burst_);
    if (!at_.at_end()) {
      if (wait_ == 0) begin_burst();
      return;
    }
    Timer::stop();
    busy_ = false;
  }

  void on_error() {
    stop();
    failed_ = true;
  }

 private:
  static constexpr uintptr_t is_complete = Base + 4, clear_complete = Base + 8, clear_error = Base + 0x10, configuration = Base + 0x30;
  static constexpr uintptr_t source = Base + 0x100, destination = Base + 0x104, next_item = Base + 0x108, control = Base + 0x10C,
                             channel_configuration = Base + 0x110;

  void begin_burst() {
    burst_ = at_.run(texels_);
    bursting_ = true;
    const auto from = uint32_t(reinterpret_cast<uintptr_t>(at_.from()));
    // Words, or bytes where the map does not lie at words.
    const uint32_t width = (from & 3) == 0 ? 2 : 0, transfers = uint32_t(burst_) << (2 - width);
    device_register(source) = from;
    device_register(destination) = uint32_t(reinterpret_cast<uintptr_t>(at_.to()));
    device_register(next_item) = 0;
    device_register(control) = transfers | width << 18 | width << 21 | 3u << 26 /* both addresses go on */ | 1u << 31 /* interrupt at the end */;
    device_register(channel_configuration) = 0xC001;  // memory to memory, both interrupts, on
    device_register(configuration) = 1;  // QEMU's model looks at its interrupt lines only when one of the common registers is written
  }

  int burst_ = 0;
  volatile bool busy_ = false, bursting_ = false, failed_ = false;
};

}  // namespace targets
