// SPDX-License-Identifier: Apache-2.0
// Wrap modes against definitions that walk: repeat steps by the size, mirror reflects at every end, clamp stops at it.
#include <tests/support.hpp>

using namespace spantex;
using namespace spantex::sim;

static int32_t slow_repeat(int32_t k, int32_t size) {
  while (k < 0) k += size;
  while (k >= size) k -= size;
  return k;
}

static int32_t slow_mirror(int32_t k, int32_t size) {
  while (k < 0 || k >= size) k = k < 0 ? -1 - k : 2 * size - 1 - k;
  return k;
}

static int32_t slow_clamp(int32_t k, int32_t size) {
  while (k < 0) ++k;
  while (k >= size) --k;
  return k;
}

static void check_index(int32_t k, int32_t size) {
  assert_int_equal(wrapped(wrap::repeat, k, size), slow_repeat(k, size));
  assert_int_equal(wrapped(wrap::mirror, k, size), slow_mirror(k, size));
  assert_int_equal(wrapped(wrap::clamp, k, size), slow_clamp(k, size));
}

SPANTEX_CASE(every_size_to_64_follows_the_definition) {
  for (int32_t size = 1; size <= 64; ++size)
    for (int32_t k = -5 * size - 3; k <= 5 * size + 3; ++k) check_index(k, size);
}

SPANTEX_CASE(large_sizes_follow_the_definition) {
  for (const int32_t size : {4095, 4096, 1000, 1023})
    for (int32_t k = -3 * size - 3; k <= 3 * size + 3; ++k) check_index(k, size);
}

SPANTEX_CASE(far_indices_are_wrapped_by_whole_periods) {
  random_source random(10);
  for (int k = 0; k < 200000; ++k) {
    const int32_t size = k % 8 == 0 ? 4096 : int32_t(random.between(1, 4096));
    const int32_t index = k % 64 == 0 ? (k % 128 == 0 ? -1 : 1) * (1 << 30) : int32_t(random.between(-(1 << 30), 1 << 30));
    const int64_t period = 2 * size, away = ((int64_t(index) % period) + period) % period;
    assert_int_equal(wrapped(wrap::repeat, index, size), away % size);
    assert_int_equal(wrapped(wrap::mirror, index, size), away < size ? away : period - 1 - away);
    assert_int_equal(wrapped(wrap::clamp, index, size), index < 0 ? 0 : index >= size ? size - 1 : index);
  }
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(every_size_to_64_follows_the_definition),
      cmocka_unit_test(large_sizes_follow_the_definition),
      cmocka_unit_test(far_indices_are_wrapped_by_whole_periods),
  };
  return run_suite("wrap", tests);
}
