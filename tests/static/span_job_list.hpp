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

using profile_type = spantex::fixed_profile<spantex::profiles::seed>;
