// SPDX-License-Identifier: Apache-2.0
// One suite over every backend and decorator: each clause of the contract in hal/engine.hpp, on both halves, and identical pixels.
#include "tests/engines.hpp"

using namespace spantex;
using namespace spantex::sim;

namespace {

// --- clauses -------------------------------------------------------------------------------------------

template <class Rig>
void computes_the_pixels_of_the_mask(void**) {
  auto& e = fresh<Rig>();
  const span_pixels a = expected(red, 0), b = expected(blue, 0), c = expected(red, 1);
  assert_memory_not_equal(&a, &b, sizeof a);  // else the cases below would prove nothing
  assert_memory_not_equal(&a, &c, sizeof a);
  for (half h : halves)
    for (span_mask mask : {full_mask, span_mask(1), span_mask(1) << 63, span_mask(0x00FF00FF12345678), span_mask(0)}) {
      load_all(e, h, red, 0);
      SPANTEX_ASSERT_OK(e.start(h, mask));
      span_pixels got{};
      SPANTEX_ASSERT_OK(e.take(h, got));
      assert_pixels(got, expected(red, 0), mask);
    }
}

template <class Rig>
void refuses_loads_while_computing(void**) {
  auto& e = fresh<Rig>();
  for (half h : halves) {
    load_all(e, h, red, 0);
    SPANTEX_ASSERT_OK(e.start(h, full_mask));
    SPANTEX_ASSERT_STATUS(e.load_words(h, 0, blue.word, 8), half_busy);
    SPANTEX_ASSERT_STATUS(e.load_coefficients(h, reading(1)), half_busy);
    load_all(e, other(h), blue, 1);  // the other half is free
    span_pixels got{};
    SPANTEX_ASSERT_OK(e.take(h, got));
    assert_pixels(got, expected(red, 0));
    // Refused words were not written either.
    SPANTEX_ASSERT_OK(e.load_coefficients(h, reading(0)));
    SPANTEX_ASSERT_OK(e.start(h, full_mask));
    SPANTEX_ASSERT_OK(e.take(h, got));
    assert_pixels(got, expected(red, 0));
    SPANTEX_ASSERT_OK(e.start(other(h), full_mask));
    SPANTEX_ASSERT_OK(e.take(other(h), got));
    assert_pixels(got, expected(blue, 1));
  }
}

template <class Rig>
void refuses_words_beyond_memory_and_writes_none(void**) {
  auto& e = fresh<Rig>();
  for (half h : halves) {
    load_all(e, h, red, 0);
    SPANTEX_ASSERT_STATUS(e.load_words(h, 0, blue.word, word_count + 1), bad_address);
    SPANTEX_ASSERT_STATUS(e.load_words(h, word_count - 1, blue.word, 2), bad_address);
    SPANTEX_ASSERT_STATUS(e.load_words(h, word_count, blue.word, 1), bad_address);
    SPANTEX_ASSERT_STATUS(e.load_words(h, -1, blue.word, 2), bad_address);
    SPANTEX_ASSERT_STATUS(e.load_words(h, 0, blue.word, -1), bad_address);
    SPANTEX_ASSERT_STATUS(e.load_words(h, INT32_MAX, blue.word, 1), bad_address);
    SPANTEX_ASSERT_OK(e.load_words(h, 0, blue.word, 0));
    SPANTEX_ASSERT_OK(e.start(h, full_mask));
    span_pixels got{};
    SPANTEX_ASSERT_OK(e.take(h, got));
    assert_pixels(got, expected(red, 0));
  }
}

template <class Rig>
void start_needs_coefficients(void**) {
  auto& e = fresh<Rig>();
  for (half h : halves) {
    SPANTEX_ASSERT_STATUS(e.start(h, full_mask), half_not_loaded);
    SPANTEX_ASSERT_OK(e.load_words(h, 0, red.word, word_count));
    SPANTEX_ASSERT_STATUS(e.start(h, full_mask), half_not_loaded);  // words alone do not do
    SPANTEX_ASSERT_OK(e.load_coefficients(h, reading(0)));
    SPANTEX_ASSERT_STATUS(e.start(other(h), full_mask), half_not_loaded);  // nor another half's
    SPANTEX_ASSERT_OK(e.start(h, full_mask));
    span_pixels got{};
    SPANTEX_ASSERT_OK(e.take(h, got));
    SPANTEX_ASSERT_STATUS(e.start(h, full_mask), half_not_loaded);  // take used them up
  }
}

template <class Rig>
void start_twice_is_refused(void**) {
  auto& e = fresh<Rig>();
  for (half h : halves) {
    load_all(e, h, red, 0);
    SPANTEX_ASSERT_OK(e.start(h, 1));
    SPANTEX_ASSERT_STATUS(e.start(h, full_mask), half_busy);
    span_pixels got{};
    SPANTEX_ASSERT_OK(e.take(h, got));
    assert_pixels(got, expected(red, 0), 1);
  }
}

template <class Rig>
void take_needs_a_start(void**) {
  auto& e = fresh<Rig>();
  span_pixels got{};
  for (half h : halves) {
    SPANTEX_ASSERT_STATUS(e.take(h, got), half_not_started);
    load_all(e, h, red, 0);
    SPANTEX_ASSERT_STATUS(e.take(h, got), half_not_started);
    SPANTEX_ASSERT_OK(e.start(h, full_mask));
    SPANTEX_ASSERT_STATUS(e.take(other(h), got), half_not_started);
    SPANTEX_ASSERT_OK(e.take(h, got));
    SPANTEX_ASSERT_STATUS(e.take(h, got), half_not_started);
  }
}

template <class Rig>
void texels_stay_loaded_after_take(void**) {
  auto& e = fresh<Rig>();
  span_pixels got{};
  for (half h : halves) {
    load_all(e, h, red, 0);
    for (int32_t shift = 0; shift < 3; ++shift) {
      SPANTEX_ASSERT_OK(e.load_coefficients(h, reading(shift)));
      SPANTEX_ASSERT_OK(e.start(h, full_mask));
      SPANTEX_ASSERT_OK(e.take(h, got));
      assert_pixels(got, expected(red, shift));
    }
  }
}

template <class Rig>
void last_loaded_wins_in_any_order(void**) {
  auto& e = fresh<Rig>();
  span_pixels got{};
  for (half h : halves) {
    SPANTEX_ASSERT_OK(e.load_coefficients(h, reading(1)));
    SPANTEX_ASSERT_OK(e.load_words(h, 0, blue.word, word_count));
    SPANTEX_ASSERT_OK(e.load_coefficients(h, reading(2)));
    for (int k = word_count - 1; k >= 0; --k) SPANTEX_ASSERT_OK(e.load_words(h, k, red.word + k, 1));
    SPANTEX_ASSERT_OK(e.start(h, full_mask));
    SPANTEX_ASSERT_OK(e.take(h, got));
    assert_pixels(got, expected(red, 2));
  }
}

template <class Rig>
void halves_are_independent(void**) {
  auto& e = fresh<Rig>();
  span_pixels got{};
  for (half started_first : halves)
    for (half taken_first : halves) {
      load_all(e, half::first, red, 1);
      load_all(e, half::second, blue, 2);
      SPANTEX_ASSERT_OK(e.start(started_first, full_mask));
      SPANTEX_ASSERT_OK(e.start(other(started_first), full_mask));
      for (half h : {taken_first, other(taken_first)}) {
        SPANTEX_ASSERT_OK(e.take(h, got));
        assert_pixels(got, h == half::first ? expected(red, 1) : expected(blue, 2));
      }
    }
}

template <class Rig>
void marks_change_nothing(void**) {
  auto& e = fresh<Rig>();
  span_pixels got{};
  for (half h : halves) {
    e.mark({event_kind::span, 0x00020001});
    load_all(e, h, red, 1);
    e.mark({event_kind::frame_end, 0});
    SPANTEX_ASSERT_OK(e.start(h, full_mask));
    e.mark({event_kind::span, UINT32_MAX});
    SPANTEX_ASSERT_OK(e.take(h, got));
    e.mark({event_kind::frame_end, 7});
    assert_pixels(got, expected(red, 1));
  }
}

// --- pictures ------------------------------------------------------------------------------------------

template <class Rig>
void draws_the_same_picture(void**) {
  static picture got;
  for (int sample = 0; sample < 3; ++sample)
    for (filter kind : all_filters) {
      got.reset(small.x1, small.y1);
      SPANTEX_ASSERT_OK(render_plane(prof{}, fresh<Rig>(), sample_plane(sample), some_map(), kind, got));
      assert_true(got == reference_picture(sample, kind));
    }
}

template <class Rig>
void replays_a_recording(void**) {
  static replay_result r;
  r = replay(some_recording(), fresh<Rig>());
  if (r.result != status::ok) fail_msg("%s", r.text().c_str());
  assert_int_equal(r.operation_index, some_recording().operations.size());
}

#define SPANTEX_OVER(rig, test) {#rig "_" #test, test<rig>, nullptr, nullptr, nullptr}
#define SPANTEX_ALL_CLAUSES(rig)                                                                                                \
  SPANTEX_OVER(rig, computes_the_pixels_of_the_mask), SPANTEX_OVER(rig, refuses_loads_while_computing),                         \
      SPANTEX_OVER(rig, refuses_words_beyond_memory_and_writes_none), SPANTEX_OVER(rig, start_needs_coefficients),              \
      SPANTEX_OVER(rig, start_twice_is_refused), SPANTEX_OVER(rig, take_needs_a_start),                                         \
      SPANTEX_OVER(rig, texels_stay_loaded_after_take), SPANTEX_OVER(rig, last_loaded_wins_in_any_order),                       \
      SPANTEX_OVER(rig, halves_are_independent), SPANTEX_OVER(rig, marks_change_nothing),                                       \
      SPANTEX_OVER(rig, draws_the_same_picture), SPANTEX_OVER(rig, replays_a_recording)

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      SPANTEX_ALL_CLAUSES(direct_rig),
      SPANTEX_ALL_CLAUSES(loading_rig),
      SPANTEX_ALL_CLAUSES(sim_rig),
      SPANTEX_ALL_CLAUSES(recording_rig),
      SPANTEX_ALL_CLAUSES(faulty_rig),
      SPANTEX_ALL_CLAUSES(any_rig),
      SPANTEX_ALL_CLAUSES(bench_rig),
      SPANTEX_ALL_CLAUSES(narrow_bench_rig),
  };
  return sim::run_suite("hal_conformance", tests);
}
