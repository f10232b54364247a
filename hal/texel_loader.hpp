// SPDX-License-Identifier: Apache-2.0
// Loaders that fill a half beside the filter: a DMA channel, a timer's interrupt, or the filter itself, a few texels a fetch. A loader is
// given a list of runs of texels and works through it:
//
//   start   takes the list and the half's texels (texel_memory.hpp), both of which are the loader's until state() is no more half_busy
//   state   half_busy while texels are missing; ok when the last one lies in the half; device_error if the copying failed
//   poll    the filter calls it once a fetch, and while it waits: time for a loader that has no other
//   stop    touches nothing from here on, whatever was under way
//
// Implementations for the emulated boards: firmware/targets/loaders.hpp. Freestanding.
#pragma once
#include <stdint.h>

#include <hal/engine.hpp>
#include <spantex/span.hpp>
#include <spantex/status.hpp>

namespace spantex {

// `count` texels from global texture memory to texel `to` of a half and those behind it.
struct texel_copy {
  const rgba8* from;
  uint16_t to, count;
};

template <class L>
concept texel_loader = requires(L& l, rgba8* texels, const texel_copy* copies, int count) {
  { l.start(texels, copies, count) } -> is_exactly<void>;
  { l.state() } -> is_exactly<status>;
  { l.poll() } -> is_exactly<void>;
  { l.stop() } -> is_exactly<void>;
};

// Where a loader stands in its list.
class copy_cursor {
 public:
  constexpr copy_cursor() = default;
  constexpr copy_cursor(rgba8* texels, const texel_copy* copies, int count) : texels_(texels), copy_(copies), end_(copies + count) {}

  constexpr bool at_end() const { return copy_ == end_; }

  // What comes next, at most `most` texels of one run. Not at the end.
  constexpr const rgba8* from() const { return copy_->from + done_; }
  constexpr rgba8* to() const { return texels_ + copy_->to + done_; }
  constexpr int run(int most) const { return copy_->count - done_ < most ? copy_->count - done_ : most; }
  constexpr void pass(int count) {
    done_ += count;
    if (done_ < copy_->count) return;
    ++copy_;
    done_ = 0;
  }

  // Moves up to `most` texels.
  constexpr void copy(int most) {
    while (most > 0 && !at_end()) {
      const int n = run(most);
      for (int k = 0; k < n; ++k) to()[k] = from()[k];
      pass(n);
      most -= n;
    }
  }

 private:
  rgba8* texels_ = nullptr;
  const texel_copy* copy_ = nullptr;
  const texel_copy* end_ = nullptr;
  int done_ = 0;  // of *copy_
};

}  // namespace spantex
