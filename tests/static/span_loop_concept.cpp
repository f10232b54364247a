// SPDX-License-Identifier: Apache-2.0
// A span loop over any engine that models the HAL's concept, with the direct engine. tests/scripts/span_loop_size.py compares its code
// with span_loop_by_hand.cpp.
#include "span_job_list.hpp"

using namespace spantex;

// Inlined, so that what is compared is one function each.
template <span_engine Engine>
[[gnu::always_inline]] static inline status run_jobs(Engine& engine, const planned_job* jobs, int count) {
  half h = half::first;
  for (int k = 0; k < count; ++k) {
    const planned_job& job = jobs[k];
    SPANTEX_TRY(engine.load_words(h, job.first_word, job.words, job.word_count));
    SPANTEX_TRY(engine.load_coefficients(h, job.coefficients));
    SPANTEX_TRY(engine.start(h, job.mask));
    SPANTEX_TRY(engine.take(h, *job.out));
    h = other(h);
  }
  return status::ok;
}

status span_loop(direct_engine<profile_type>& engine, const planned_job* jobs, int count) { return run_jobs(engine, jobs, count); }
