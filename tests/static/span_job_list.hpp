// SPDX-License-Identifier: Apache-2.0
// What the two span loops below this folder are given: a list of jobs, planned already.
#pragma once
#include <hal/direct_engine.hpp>

struct planned_job {
  spantex::span_coefficients coefficients;
  spantex::span_mask mask;
  const uint64_t* words;
  int first_word, word_count;
  spantex::span_pixels* out;
};

// Without what a program may leave out: it must not cost anything then.
constexpr spantex::profile seed_without_options() {
  spantex::profile p = spantex::profiles::seed;
  p.contours = p.linear_light = false;
  return p;
}
using profile_type = spantex::fixed_profile<seed_without_options()>;
