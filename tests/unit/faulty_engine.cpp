// SPDX-License-Identifier: Apache-2.0
// Faults: an engine that fails its n-th operation, for every n until nothing fails any more, under the renderer. Each failure must come
// back as it was made; a wrong picture may never be reported ok. And the decorator itself: it breaks what it is told to, nothing else.
#include "tests/engines.hpp"

using namespace spantex;
using namespace spantex::sim;

namespace {

// Draws with the n-th operation failing; false when nothing failed any more. The failure must come back as it was made, and where the same
// renderer then draws again, either it says what is wrong or the picture is right.
template <class Inner>
bool fails_honestly(uint64_t n, status failure, int (&reached)[4]) {
  static picture got;
  static const picture wanted = reference_picture(1, filter::trilinear);
  static std::unique_ptr<Inner> inner;
  inner = std::make_unique<Inner>();
  faulty_engine<Inner> engine(*inner, {.fail_operation = n, .failure = failure});
  renderer<faulty_engine<Inner>, prof> r(engine, prof{}, (got.reset(small.x1, small.y1), got.frame()));
  const plane p = sample_plane(1);
  status result = r.draw(p, some_map(), filter::trilinear, small);
  if (result == status::ok) result = r.finish();
  if (engine.log().failed == 0) {
    SPANTEX_ASSERT_OK(result);
    assert_true(got == wanted);
    return false;
  }
  if (result != failure)
    fail_msg("operation %llu failed with '%s' but '%s' came back", static_cast<unsigned long long>(n), to_string(failure),
             to_string(result));
  ++reached[int(engine.log().failed_operation)];
  got.reset(small.x1, small.y1);
  result = r.draw(p, some_map(), filter::trilinear, small);
  if (result == status::ok) result = r.finish();
  if (result == status::ok && !(got == wanted))
    fail_msg("%s, operation %llu, failed with '%s'; drawn again: a wrong picture reported ok", to_string(engine.log().failed_operation),
             static_cast<unsigned long long>(n), to_string(failure));
  return true;
}

template <class Inner>
void every_failure_comes_back(void**) {
  for (status failure : {status::device_error, status::device_timeout}) {
    int reached[4] = {};
    uint64_t n = 1;
    while (fails_honestly<Inner>(n, failure, reached)) ++n;
    print_message("%s: %llu operations, failed at load_coefficients %d, load_words %d, start %d, take %d\n", to_string(failure),
                  static_cast<unsigned long long>(n - 1), reached[0], reached[1], reached[2], reached[3]);
    for (int count : reached) assert_true(count > 0);
  }
}

template <class Engine>
bool picture_differs(Engine& engine) {
  static picture got;
  got.reset(small.x1, small.y1);
  SPANTEX_ASSERT_OK(render_plane(prof{}, engine, sample_plane(1), some_map(), filter::nearest, got));
  return !(got == reference_picture(1, filter::nearest));
}

SPANTEX_CASE(faulty_corrupts_the_nth_word_and_take_only) {
  int visible = 0;
  for (uint64_t n = 1; n < 200; ++n) {
    static std::unique_ptr<direct> inner;
    inner = std::make_unique<direct>();
    faulty_engine<direct> engine(*inner, {.corrupt_word = n, .word_flips = ~uint64_t(0)});
    visible += picture_differs(engine) ? 1 : 0;
    assert_int_equal(engine.log().corrupted, 1);
  }
  assert_true(visible > 100);  // the others hold texels that no pixel reads
  static direct inner;
  faulty_engine<direct> engine(inner, {.corrupt_take = 3});
  assert_true(picture_differs(engine));
  assert_int_equal(engine.log().corrupted, 1);
  static direct sound;
  faulty_engine<direct> clean(sound);
  assert_false(picture_differs(clean));
}

SPANTEX_CASE(faulty_delays_the_simulated_host) {
  static simulated plain, late;
  faulty_engine<simulated> none(plain), some(late, {.delay_operation = 5, .delay_cycles = 1000});
  assert_false(picture_differs(none));
  assert_false(picture_differs(some));
  assert_int_equal(some.log().delayed_cycles, 1000);
  assert_true(late.counters().total_cycles > plain.counters().total_cycles + 900);
}

SPANTEX_CASE(faulty_empties_the_half_it_fails_on) {
  static direct inner;
  faulty_engine<direct> e(inner, {.fail_operation = 4, .failure = status::device_timeout});
  span_pixels got{};
  load_all(e, half::first, red, 0);
  SPANTEX_ASSERT_OK(e.start(half::first, full_mask));
  SPANTEX_ASSERT_STATUS(e.take(half::first, got), device_timeout);
  SPANTEX_ASSERT_STATUS(e.take(half::first, got), half_not_started);
  SPANTEX_ASSERT_STATUS(e.start(half::first, full_mask), half_not_loaded);
  load_all(e, half::first, blue, 1);
  SPANTEX_ASSERT_OK(e.start(half::first, full_mask));
  SPANTEX_ASSERT_OK(e.take(half::first, got));
  assert_pixels(got, expected(blue, 1));
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      {"every_failure_comes_back_direct", every_failure_comes_back<direct>, nullptr, nullptr, nullptr},
      {"every_failure_comes_back_sim", every_failure_comes_back<simulated>, nullptr, nullptr, nullptr},
      cmocka_unit_test(faulty_corrupts_the_nth_word_and_take_only),
      cmocka_unit_test(faulty_delays_the_simulated_host),
      cmocka_unit_test(faulty_empties_the_half_it_fails_on),
  };
  return sim::run_suite("faulty_engine", tests);
}
