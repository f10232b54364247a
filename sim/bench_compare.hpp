// SPDX-License-Identifier: Apache-2.0
// Two engines given the same operations, their answers and pixels compared: a device under test and the simulator. Where pixels first differ, both
// compute a few simpler spans in the half that has just been emptied, and the first that differs too names the stage that is to blame.
#pragma once
#include <stdint.h>

#include <array>
#include <optional>
#include <string>

#include <hal/any_engine.hpp>
#include <hal/operation.hpp>

namespace spantex::sim {

// In the order in which they are tried: each relies on those before it.
enum class stage : uint8_t {
  answers,            // the engines' statuses differ, not pixels
  finer_memory,       // texels come back as they were loaded: loading, banks, output switch
  finer_filter,       // bilinear at known positions, where no colour needs rounding
  write_out,          // the same where colours are rounded
  coordinates,        // position, snapping and correction of the span's own coefficients
  level,              // the level's fraction
  coarser_level,      // the coarser level's memory, position and blending
  footprint,          // what the span's own filter adds
  not_repeatable,     // the same span again is right
};
const char* to_string(stage s);

struct first_difference {
  stage where = stage::answers;
  operation what = operation::take;
  half which = half::first;
  int32_t span_x = 0, span_y = 0;
  int pixel = -1;                          // in the span, 8 y + x; -1: answers differ
  rgba8 wanted{}, got{};
  status wanted_status = status::ok, got_status = status::ok;
  uint64_t operation_index = 0;            // counted from 0, marks included: as in a recording
  std::string text() const;
};

class comparing_engine final : public any_engine {
 public:
  // Both must outlive it. `fine_side` of the profile.
  comparing_engine(any_engine& tested, any_engine& wanted, int fine_side) : tested_(tested), wanted_(wanted), fine_side_(fine_side) {}

  status load_coefficients(half h, const span_coefficients& c) override;
  status load_words(half h, int first, const uint64_t* words, int count) override;
  status start(half h, span_mask mask) override;
  status take(half h, span_pixels& out) override;
  void mark(event what) override;

  const std::optional<first_difference>& difference() const { return difference_; }
  uint64_t spans() const { return spans_; }
  uint64_t differing_spans() const { return differing_spans_; }
  uint64_t differing_pixels() const { return differing_pixels_; }

 private:
  struct memory {
    std::array<uint64_t, 640> words{};
    span_coefficients coefficients{};
    span_mask mask = 0;
    uint32_t span = 0;
  };
  status both(half h, operation what, status tested, status wanted);
  int word_count() const { return (fine_side_ * fine_side_ + fine_side_ * fine_side_ / 4) * 4 / 8; }
  bool differs(half h, const span_coefficients& c, const uint64_t* words, span_mask mask);
  bool memory_differs(half h);
  bool filter_differs(half h, bool rounded);
  std::array<uint64_t, 640> two_shades(bool finer_white) const;
  stage level_or_memory(half h, span_coefficients c, span_mask mask);
  stage find_stage(half h);

  any_engine &tested_, &wanted_;
  int fine_side_;
  memory memory_[half_count];
  std::optional<first_difference> difference_;
  uint64_t spans_ = 0, differing_spans_ = 0, differing_pixels_ = 0, operations_ = 0;
  uint32_t marked_ = 0;
};

}  // namespace spantex::sim
