// SPDX-License-Identifier: Apache-2.0
// Integer log2 over every mantissa it can tell apart, against the 64-bit-mantissa log2 of the host: that one errs by less than 2^-57,
// so a margin of 2^-30 of a unit (a unit is 2^-16) covers it.
//
// The bounds, in units: knots err by 1/2 and the interpolated product by 1/2, either way: less than 1 above. Below the chord lies under
// the curve by at most (1/64)^2 / (8 ln 2) = 2.886, and dropped mantissa bits cost at most 2^-22 / ln 2 = 0.023: less than 3.91.
#include <tests/support.hpp>

#include <cfloat>
#include <cmath>

using namespace spantex;
using namespace spantex::sim;

static_assert(LDBL_MANT_DIG >= 53);
static constexpr long double margin_units = 1.0L / (1 << 30), bound_above = 1.0L, bound_below = 3.91L;

namespace {
struct error_range {
  long double above = 0, below = 0;  // units of 2^-16
  void note(uint64_t x) {
    const long double error = log2_16(x) - 65536.0L * std::log2(static_cast<long double>(x));
    above = error > above ? error : above;
    below = -error > below ? -error : below;
  }
};
}  // namespace

// Every mantissa of 22 bits, with all dropped bits clear and all set.
SPANTEX_CASE(error_is_within_its_bounds_for_every_mantissa) {
  error_range worst;
  for (const int n : {22, 45, 63})
    for (uint64_t m = 1u << 22; m < 1u << 23; ++m) {
      const uint64_t x = m << (n - 22);
      worst.note(x);
      worst.note(x | ((uint64_t(1) << (n - 22)) - 1));
    }
  std::printf("# log2_16: worst %.4Lf above, %.4Lf below, in 2^-16\n", worst.above, worst.below);
  assert_true(worst.above <= bound_above + margin_units);
  assert_true(worst.below <= bound_below + margin_units);
}

SPANTEX_CASE(error_is_within_its_bounds_for_every_small_number) {
  error_range worst;
  for (uint64_t x = 1; x < 1u << 22; ++x) worst.note(x);
  assert_true(worst.above <= bound_above + margin_units);
  assert_true(worst.below <= bound_below + margin_units);
}

SPANTEX_CASE(powers_of_two_are_exact) {
  for (int n = 0; n < 64; ++n) assert_int_equal(log2_16(uint64_t(1) << n), n << 16);
}

SPANTEX_CASE(knots_are_the_nearest_16_bit_numbers) {
  for (uint32_t k = 0; k < 64; ++k) {
    const long double exact = 65536.0L * std::log2(1.0L + k / 64.0L);
    assert_true(std::fabs(log2_knots.knot[k] - exact) <= 0.5L + margin_units);
    assert_int_equal(log2_16(64 + k), (6 << 16) + log2_knots.knot[k]);
  }
}

SPANTEX_CASE(it_never_falls) {
  for (const int n : {22, 23, 63}) {
    int32_t before = log2_16((uint64_t(1) << n) - 1);
    for (uint64_t m = 1u << 22; m < 1u << 23; ++m) {
      const int32_t now = log2_16(m << (n - 22));
      assert_true(now >= before);
      before = now;
    }
  }
  for (uint64_t x = 1; x < 1u << 22; ++x) assert_true(log2_16(x + 1) >= log2_16(x));
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(error_is_within_its_bounds_for_every_mantissa),
      cmocka_unit_test(error_is_within_its_bounds_for_every_small_number),
      cmocka_unit_test(powers_of_two_are_exact),
      cmocka_unit_test(knots_are_the_nearest_16_bit_numbers),
      cmocka_unit_test(it_never_falls),
  };
  return run_suite("log2", tests);
}
