// SPDX-License-Identifier: Apache-2.0
// Who owns a half: the loader or the filter, never both. The guard answers every operation as the contract says (hal/engine.hpp), keeps a
// record of what it refused, and checks time itself: loading and computing of one half may not overlap, whatever the order of calls was.
// One rule for the simulator, whose intervals are cycles known beforehand, and for a device, whose intervals are open until the loader, or
// the filter, lets go.
//
//            load ok                 start ok
//   loader ──────────► [ half h ] ◄──────────── filter
//                 refused while it computes; the refusal is recorded
//
// Freestanding: devices use it too.
#pragma once
#include <stdint.h>

#include <hal/engine.hpp>
#include <hal/operation.hpp>

namespace spantex {

using cycle = uint64_t;  // of the simulator's clock; on a device, turns of ownership

inline constexpr cycle not_ended = UINT64_MAX;

struct interval {
  cycle begin = 0, end = 0;
  constexpr cycle length() const { return end - begin; }
};

constexpr cycle later(cycle a, cycle b) { return a > b ? a : b; }
constexpr cycle earlier(cycle a, cycle b) { return a < b ? a : b; }

constexpr cycle overlap_cycles(interval a, interval b) {
  const cycle begin = later(a.begin, b.begin), end = earlier(a.end, b.end);
  return begin < end ? end - begin : 0;
}

struct violation {
  operation what = operation::mark;
  half which = half::first;
  status result = status::ok;
  cycle at = 0;
  interval computing;  // of that half, the latest
};

template <int Kept>
class half_ownership {
 public:
  constexpr status may_load(half h, operation what, cycle now) { return noted(h, what, lives_[int(h)].may_load(), now); }
  constexpr status start(half h, cycle now) { return noted(h, operation::start, lives_[int(h)].start(), now); }
  constexpr status take(half h, cycle now) { return noted(h, operation::take, lives_[int(h)].take(), now); }
  constexpr void coefficients_loaded(half h) { lives_[int(h)].coefficients_loaded(); }

  // Records a refusal that another part decided.
  constexpr status noted(half h, operation what, status result, cycle now) {
    if (result == status::ok) return result;
    if (count_ < uint64_t(Kept)) kept_[count_] = {what, h, result, now, computing_[int(h)]};
    ++count_;
    return result;
  }

  // The loader, or the filter, has the half in that time. half_busy where the other has it: the half stays with who has it.
  constexpr status loads(half h, operation what, interval time) {
    if (overlap_cycles(time, computing_[int(h)]) != 0) return noted(h, what, status::half_busy, time.begin);
    loading_[int(h)] = time;
    return status::ok;
  }
  constexpr status computes(half h, operation what, interval time) {
    if (overlap_cycles(time, loading_[int(h)]) != 0) return noted(h, what, status::half_busy, time.begin);
    computing_[int(h)] = time;
    return status::ok;
  }
  // Ends an interval that was not_ended.
  constexpr void loaded(half h, cycle now) { loading_[int(h)].end = now; }
  constexpr void computed(half h, cycle now) { computing_[int(h)].end = now; }

  constexpr interval computing(half h) const { return computing_[int(h)]; }

  constexpr uint64_t violation_count() const { return count_; }
  // The first `Kept` of them.
  constexpr const violation& at(int k) const { return kept_[k]; }

 private:
  half_life lives_[half_count];
  interval loading_[half_count], computing_[half_count];
  violation kept_[Kept];
  uint64_t count_ = 0;
};

}  // namespace spantex
