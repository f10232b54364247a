// SPDX-License-Identifier: Apache-2.0
// Who owns a half: the loader or the pipeline, never both. The guard answers every operation as the contract says (hal/engine.hpp), keeps a
// record of each one it refused, and checks the schedule itself: a load and a compute of one half may not overlap in time, whatever the
// order of calls was.
//
//            load ok                 start ok
//   loader ──────────► [ half h ] ◄──────────── pipeline
//                 refused while it computes; the refusal is recorded
#pragma once
#include <stdint.h>

#include <string>

#include <hal/engine.hpp>
#include <hal/operation.hpp>
#include <sim/timing.hpp>

namespace spantex::sim {

struct violation {
  operation what = operation::mark;
  half which = half::first;
  status result = status::ok;
  cycle at = 0;
  interval computing;  // of that half, the latest

  std::string text() const {
    std::string s = std::string(to_string(what)) + " of half " + std::to_string(int(which)) + " at cycle " + std::to_string(at) + ": " +
                    to_string(result);
    if (computing.end != 0)
      s += " (last computing in cycles " + std::to_string(computing.begin) + " to " + std::to_string(computing.end) + ")";
    return s;
  }
};

class ownership_guard {
 public:
  static constexpr int kept_violations = 16;

  status may_load(half h, operation what, cycle now) { return noted(h, what, lives_[int(h)].may_load(), now); }
  status start(half h, cycle now) { return noted(h, operation::start, lives_[int(h)].start(), now); }
  status take(half h, cycle now) { return noted(h, operation::take, lives_[int(h)].take(), now); }
  void coefficients_loaded(half h) { lives_[int(h)].coefficients_loaded(); }

  // Records a refusal that another part decided.
  status noted(half h, operation what, status result, cycle now) {
    if (result == status::ok) return result;
    if (count_ < kept_violations) kept_[count_] = {what, h, result, now, computing_[int(h)]};
    ++count_;
    return result;
  }

  // The schedule: called with the time a load or a compute was given.
  void loads(half h, operation what, interval time) {
    loading_[int(h)] = time;
    if (overlap_cycles(time, computing_[int(h)]) != 0) (void)noted(h, what, status::half_busy, time.begin);
  }
  void computes(half h, interval time) {
    computing_[int(h)] = time;
    if (overlap_cycles(time, loading_[int(h)]) != 0) (void)noted(h, operation::start, status::half_busy, time.begin);
  }
  interval computing(half h) const { return computing_[int(h)]; }

  uint64_t violation_count() const { return count_; }
  // The first kept_violations of them.
  const violation& at(int k) const { return kept_[k]; }

 private:
  half_life lives_[half_count];
  interval loading_[half_count], computing_[half_count];
  violation kept_[kept_violations];
  uint64_t count_ = 0;
};

}  // namespace spantex::sim
