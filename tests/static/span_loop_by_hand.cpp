// SPDX-License-Identifier: Apache-2.0
// The same loop as span_loop_concept.cpp, written out: no concept, no engine class, no members; the same states and errors.
#include "span_job_list.hpp"

using namespace spantex;

struct hand_half {
  span_coefficients coefficients;
  span_mask mask;
  local_memory<8> texels;
  bool ready, busy;
};
struct hand_engine {
  hand_half halves[2];
};

status span_loop(hand_engine& engine, const planned_job* jobs, int count) {
  const profile_type prof;
  int h = 0;
  for (int k = 0; k < count; ++k) {
    const planned_job& job = jobs[k];
    hand_half& x = engine.halves[h];
    if (x.busy) return status::half_busy;
    if (const status s = x.texels.load(job.first_word, job.words, job.word_count); s != status::ok) return s;
    if (x.busy) return status::half_busy;
    x.coefficients = job.coefficients;
    x.ready = true;
    if (x.busy) return status::half_busy;
    if (!x.ready) return status::half_not_loaded;
    x.busy = true;
    x.mask = job.mask;
    if (!x.busy) return status::half_not_started;
    x.busy = x.ready = false;
    compute_span(prof, x.coefficients, x.mask, x.texels, *job.out, no_observer{});
    h = h == 0 ? 1 : 0;
  }
  return status::ok;
}
