// SPDX-License-Identifier: Apache-2.0
// The 128-bit integers of set-up against the compiler's own: random and adversarial operands.
#include <tests/support.hpp>

using namespace spantex;
using namespace spantex::sim;

using big = int128;
using unsigned_big = uint128;

static big value(wide a) { return to_int128(a); }
static wide of(big x) { return to_wide(x); }

static const int64_t hard_words[] = {0, 1, -1, 2, -2, 3, 0xFFFF, 0x10000, 0x7FFFFFFF, 0x80000000ll, 0xFFFFFFFFll, 0x100000000ll,
                                     -0x80000000ll, -0xFFFFFFFFll, -0x100000000ll, INT64_MAX, -INT64_MAX, INT64_MAX - 1,
                                     0x5555555555555555ll, -0x5555555555555555ll};

// Every pair of hard words, then random ones of every magnitude.
template <class Check>
static void for_word_pairs(Check check) {
  for (const int64_t a : hard_words)
    for (const int64_t b : hard_words) check(a, b);
  random_source random(2);
  for (int k = 0; k < 400000; ++k) check(random.any_magnitude(63), random.any_magnitude(63));
}

// Every magnitude below 2^126, with runs of ones and zeros among them.
static big any_big(random_source& random) {
  const int kept = int(random.next() % 127);
  big x = big((unsigned_big(random.next()) << 64 | random.next()) >> (128 - kept) * (kept > 0 ? 1 : 0));
  if (kept == 0) x = 0;
  const uint64_t kind = random.next() % 4;
  if (kind == 0 && kept > 0) x = (big(1) << (kept - 1)) - 1;
  if (kind == 1 && kept > 0) x = big(1) << (kept - 1);
  return (random.next() & 1) != 0 ? -x : x;
}

SPANTEX_WRAPS static unsigned_big wrapping_sum(unsigned_big a, unsigned_big b) { return a + b; }

template <class Check>
static void for_wide(Check check) {
  for (const int64_t a : hard_words) check(big(a));
  for (int n = 0; n < 126; ++n)
    for (int d = -1; d <= 1; ++d) { check((big(1) << n) + d); check(-(big(1) << n) + d); }
  random_source random(3);
  for (int k = 0; k < 200000; ++k) check(any_big(random));
}

SPANTEX_CASE(products_of_words_are_exact) {
  for_word_pairs([](int64_t a, int64_t b) { assert_true(value(multiply(a, b)) == big(a) * b); });
  for_word_pairs([](int64_t a, int64_t b) {
    wide sum(a, uint64_t(b)), by_words = sum;
    accumulate(sum, uint64_t(a), uint64_t(b));
    accumulate_by_words(by_words, uint64_t(a), uint64_t(b));
    const unsigned_big exact = wrapping_sum(unsigned_big(value(wide(a, uint64_t(b)))), unsigned_big(uint64_t(a)) * uint64_t(b));
    assert_true(unsigned_big(value(sum)) == exact && by_words == sum);
  });
}

// As cores without products of 64 bits make them.
SPANTEX_CASE(products_by_32_bits_are_those_of_64) {
  const auto check = [](int64_t a, int64_t word) {
    for (const int32_t b : {int32_t(word), int32_t(word >> 32)}) {
      const big exact = big(a) * b;
      if (exact == big(int64_t(exact))) assert_true(multiply_in_pieces(a, b) == int64_t(exact) && multiply_by_32(a, b) == int64_t(exact));
    }
  };
  for_word_pairs(check);
  random_source random(5);
  for (int k = 0; k < 400000; ++k) check(random.any_magnitude(40), random.any_magnitude(24));
}

SPANTEX_CASE(products_with_a_word_are_exact_where_they_fit) {
  random_source random(4);
  int checked = 0;
  for (int k = 0; k < 400000; ++k) {
    const big a = any_big(random);
    const int64_t b = random.any_magnitude(63);
    if (bit_length(of(a)) + bit_length(magnitude(b)) > 126) continue;
    assert_true(value(multiply(of(a), b)) == a * b);
    ++checked;
  }
  assert_true(checked > 100000);
}

SPANTEX_CASE(sums_differences_and_order_are_exact) {
  random_source random(5);
  for_wide([&random](big a) {
    const big b = any_big(random) / 2, half = a / 2;
    assert_true(value(of(a)) == a);
    assert_true(value(of(half) + of(b)) == half + b);
    assert_true(value(of(half) - of(b)) == half - b);
    assert_true(value(-of(a)) == -a);
    assert_true(value(magnitude(of(a))) == (a < 0 ? -a : a));
    assert_true((of(half) < of(b)) == (half < b));
    assert_true(of(a).negative() == (a < 0) && of(a).zero() == (a == 0));
  });
}

SPANTEX_CASE(carries_cross_the_middle) {
  assert_true(value(wide(0, UINT64_MAX) + wide(1)) == big(1) << 64);
  assert_true(value(wide(1, 0) - wide(1)) == (big(1) << 64) - 1);
  assert_true(value(-wide(0, 1)) == -1);
  assert_true(value(wide(-1)) == -1 && value(wide(INT64_MIN)) == big(INT64_MIN));
}

SPANTEX_CASE(bit_lengths_count_the_magnitude) {
  for_wide([](big a) {
    int bits = 0;
    for (big m = a < 0 ? -a : a; m != 0; m >>= 1) ++bits;
    assert_int_equal(bit_length(of(a)), bits);
  });
}

SPANTEX_CASE(shifts_follow_their_definition) {
  for_wide([](big a) {
    const int bits = bit_length(of(a));
    for (const int n : {0, 1, 7, 31, 32, 63, 64, 65, 100, 125}) {
      assert_true(value(shift_right_floor(of(a), n)) == a >> n);
      const big m = a < 0 ? -a : a, nearest = n == 0 ? m : (m + (big(1) << (n - 1))) >> n, rounded = a < 0 ? -nearest : nearest;
      assert_true(value(shift_right_nearest(of(a), n)) == rounded);
      assert_true(value(scale_down(of(a), n)) == rounded);
      if (bits + n > 126) continue;
      assert_true(value(shift_left(of(a), n)) == a * (big(1) << n));
      assert_true(value(scale_down(of(a), -n)) == a * (big(1) << n));
    }
  });
}

// Nearest whole quotient, halves away from zero.
static big nearest_quotient(big a, big b) {
  const big m = a < 0 ? -a : a, q = m / b, r = m % b, rounded = 2 * r >= b ? q + 1 : q;
  return a < 0 ? -rounded : rounded;
}

SPANTEX_CASE(quotients_are_nearest_with_halves_away_from_zero) {
  random_source random(6);
  int checked = 0;
  for (int k = 0; k < 100000; ++k) {
    const int64_t b = int64_t(magnitude(random.any_magnitude(62))) + 1;
    big a = any_big(random);
    if (k % 4 == 0) a = big(b) * random.any_magnitude(62) + b / 2 + int64_t(random.next() % 3) - 1;
    const big q = nearest_quotient(a, b);
    if (q > INT64_MAX || q < -big(INT64_MAX)) continue;
    assert_true(big(divide_nearest(of(a), b)) == q);
    ++checked;
  }
  assert_true(checked > 50000);
}

SPANTEX_CASE(the_low_word_comes_back) {
  for_word_pairs([](int64_t a, int64_t b) {
    assert_true(to_int64(wide(a)) == a && to_int64(of(big(b))) == b);
  });
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(products_of_words_are_exact),
      cmocka_unit_test(products_by_32_bits_are_those_of_64),
      cmocka_unit_test(products_with_a_word_are_exact_where_they_fit),
      cmocka_unit_test(sums_differences_and_order_are_exact),
      cmocka_unit_test(carries_cross_the_middle),
      cmocka_unit_test(bit_lengths_count_the_magnitude),
      cmocka_unit_test(shifts_follow_their_definition),
      cmocka_unit_test(quotients_are_nearest_with_halves_away_from_zero),
      cmocka_unit_test(the_low_word_comes_back),
  };
  return run_suite("wide", tests);
}
