// SPDX-License-Identifier: Apache-2.0
// Reciprocals over all their inputs, and quotients against exact division. All comparisons are between whole numbers.
//
// Bound of both reciprocals, in last places: never above the true value, and less than 4 below it. Newton's iteration approaches from
// below; its last step leaves less than 1 (the squared error of the step before), the cut error term costs less than 2 (y < 2 of its
// unit's scale), the cut product less than 1.
#include <tests/support.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

// Largest errors seen, in 1/1024 of the result's last place, below and above.
struct worst_error {
  int64_t below = 0, above = 0;
  // difference = (result - exact) m, so that difference / m is the error in last places.
  void note(int64_t difference, int64_t m) {
    if (difference < 0 && -difference * 1024 > (below + 1) * m) below = -difference * 1024 / m;
    if (difference > 0 && difference * 1024 > (above + 1) * m) above = difference * 1024 / m;
  }
  void print(const char* what) const {
    std::printf("# %s: worst %.3f below, %.3f above, in last places\n", what, double(below) / 1024, double(above) / 1024);
  }
};

}  // namespace

SPANTEX_CASE(narrow_reciprocal_is_within_4_for_every_input) {
  worst_error worst;
  for (uint32_t m = 1u << 15; m < 1u << 16; ++m) {
    const uint32_t y = reciprocal_narrow(m);
    const int64_t difference = int64_t(m) * y - (int64_t(1) << 31);
    worst.note(difference, m);
    assert_true(y > (1u << 15) - 4 && y <= 0xFFFF);
    if (difference > 0 || difference <= -4 * int64_t(m)) fail_msg("m = %u gives %u", unsigned(m), unsigned(y));
  }
  worst.print("reciprocal_narrow");
}

// reciprocal_wide() as AVX-512's kernel has it: the seed multiplied before its 16 zeros are there, errors that are not negative after the first step, no limit.
SPANTEX_WRAPS static uint64_t without_limits(uint32_t m) {
  const int64_t seed = seed_of(m, 31, reciprocal_seed_bits), error = ((int64_t(1) << 47) - int64_t(m) * seed) >> 16;
  const uint64_t y = uint64_t((seed << 16) + ((seed * error) >> 15)), rest = ((uint64_t(1) << 63) - m * y) >> 32;
  return y + ((y * rest) >> 31);
}

SPANTEX_WRAPS SPANTEX_CASE(wide_reciprocal_is_within_4_for_every_input) {
  worst_error worst;
  bool good = true, unlimited = true;
  // Under sanitizers every 997th only: the values are the same there, and all of them are seen in the ordinary run.
  const uint32_t step = short_run() ? 997 : 1;
  uint32_t m = 1u << 31;
  do {
    const uint32_t y = reciprocal_wide(m);
    const int64_t difference = int64_t(uint64_t(m) * y - (uint64_t(1) << 63));
    worst.note(difference, m);
    good = good && difference <= 0 && difference > -4 * int64_t(m);
    unlimited = unlimited && without_limits(m) == y;
  } while ((m += step) >= 1u << 31);
  worst.print("reciprocal_wide");
  assert_true(good);
  assert_true(unlimited);
}

SPANTEX_CASE(inverse_holds_mantissa_and_exponent) {
  random_source random(7);
  for (int k = 0; k < 1000000; ++k) {
    const int64_t w = 1 + int64_t(magnitude(random.any_magnitude(62)));
    const inverse i = invert(w);
    // w = mantissa 2^exponent (1 + e), 0 <= e < 2^-31; y within 4 of 2^63 / mantissa: |y w / 2^(63 + exponent) - 1| <= 2^-29
    const int shift = 63 + i.exponent;
    const int128 product = int128(i.y) * w, one = int128(1) << shift;
    assert_true(magnitude_of(product - one) <= (shift >= 29 ? one >> 29 : 0));
  }
}

// |quotient - n 2^scale / w| <= 1/2 + 2^-29 of the value (the reciprocal) + the dropped bits of n.
static void check_quotient(int64_t n, int drop, int64_t w, int scale) {
  const int128 exact = int128(n) * (int128(1) << scale);
  if (magnitude_of(exact) >= int128(w) << 31) return;  // the result must fit 32 bits
  if (63 + invert(w).exponent - drop - scale < 1) return;  // n = 0 at a scale nobody asks for
  const int128 result = quotient(n, drop, invert(w), scale);
  const int128 dropped = drop == 0 ? 0 : (int128(1) << (drop + scale));
  const int128 bound = int128(w) / 2 + 1 + (magnitude_of(exact) >> 29) + 1 + dropped + (dropped >> 29);
  if (magnitude_of(result * w - exact) > bound)
    fail_msg("quotient(%lld, %d, %lld, %d)", static_cast<long long>(n), drop, static_cast<long long>(w), scale);
}

SPANTEX_CASE(quotients_are_within_their_bound_of_exact_division) {
  random_source random(8);
  for (int k = 0; k < 2000000; ++k) {
    const int64_t w = 1 + int64_t(magnitude(random.any_magnitude(45)));
    const int64_t n = random.any_magnitude(59);
    const int drop = max_of(0, bit_length(magnitude(n)) - 31);
    check_quotient(n, drop, w, int(random.next() % 41));
    check_quotient(n, drop + int(random.next() % 4), w, int(random.next() % 41));
  }
}

SPANTEX_CASE(quotients_of_hard_operands_are_within_their_bound) {
  const auto near_power = [](auto check) {
    for (int n = 0; n < 58; ++n)
      for (int d = -1; d <= 1; ++d) check((int64_t(1) << n) + d);
  };
  near_power([&](int64_t w) {
    if (w <= 0 || w >= int64_t(1) << 45) return;
    near_power([&](int64_t n) {
      for (const int scale : {0, 12, 30, 40}) {
        check_quotient(n, max_of(0, bit_length(magnitude(n)) - 31), w, scale);
        check_quotient(-n, max_of(0, bit_length(magnitude(n)) - 31), w, scale);
      }
    });
  });
}

SPANTEX_CASE(one_over_relative_w_is_within_its_bound) {
  // The datapath's form: w in (1/2, 3/2) with R fraction bits; relative error as accuracy.hpp states it.
  random_source random(9);
  for (int bits = 10; bits <= 30; ++bits) {
    profile q = profiles::exact;
    q.reciprocal_bits = bits;
    const uint64_t bound = reciprocal_unit_bound(q);
    const uint32_t low = (1u << (bits - 1)) + 1, high = 3u << (bits - 1);
    const uint32_t steps = bits <= 18 ? high - low : 400000;
    for (uint32_t k = 0; k < steps; ++k) {
      const uint32_t w = bits <= 18 ? low + k : uint32_t(random.between(low, high - 1));
      const uint32_t r = reciprocal_of_w(w, bits);
      // relative error (r w - 2^2R) / 2^2R
      const int128 difference = magnitude_of(int128(r) * w - (int128(1) << (2 * bits)));
      if (difference << error_unit_log2 > int128(bound) << (2 * bits)) fail_msg("R = %d, w = %u gives %u", bits, unsigned(w), unsigned(r));
    }
  }
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(narrow_reciprocal_is_within_4_for_every_input),
      cmocka_unit_test(wide_reciprocal_is_within_4_for_every_input),
      cmocka_unit_test(inverse_holds_mantissa_and_exponent),
      cmocka_unit_test(quotients_are_within_their_bound_of_exact_division),
      cmocka_unit_test(quotients_of_hard_operands_are_within_their_bound),
      cmocka_unit_test(one_over_relative_w_is_within_its_bound),
  };
  return run_suite("reciprocal", tests);
}
