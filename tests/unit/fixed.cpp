// SPDX-License-Identifier: Apache-2.0
// Fixed point: the table of widths, and every named loss of bits against a definition in whole numbers, over all values of
// small formats and the ends of large ones.
#include <tests/support.hpp>

using namespace spantex;
using namespace spantex::sim;

// --- the table of widths (fixed.hpp) ---------------------------------------------------------------------

template <class Format, bool Signed, int I, int F>
inline constexpr bool is_format = same_type<Format, fixed<Signed, I, F>>;

static_assert(is_format<decltype(s<15, 16>{} + s<15, 16>{}), true, 16, 16>);
static_assert(is_format<decltype(u<0, 8>{} + u<0, 8>{}), false, 1, 8>);
static_assert(is_format<decltype(u<3, 8>{} + s<1, 4>{}), true, 4, 8>);
static_assert(is_format<decltype(u<0, 8>{} - u<0, 8>{}), true, 1, 8>);
static_assert(is_format<decltype(s<2, 8>{} - u<7, 1>{}), true, 8, 8>);
static_assert(is_format<decltype(-s<2, 8>{}), true, 3, 8>);
static_assert(is_format<decltype(-u<2, 8>{}), true, 3, 8>);
static_assert(is_format<decltype(u<2, 8>{} * u<3, 4>{}), false, 5, 12>);
static_assert(is_format<decltype(u<2, 8>{} * s<3, 4>{}), true, 5, 12>);
static_assert(is_format<decltype(s<2, 8>{} * s<3, 4>{}), true, 6, 12>);
static_assert(is_format<decltype(floor_to<4>(s<3, 8>{})), true, 3, 4>);
static_assert(is_format<decltype(round_to<4>(s<3, 8>{})), true, 4, 4>);
static_assert(is_format<decltype(round_to<4>(u<3, 8>{})), false, 4, 4>);
static_assert(is_format<decltype(constant<-5>()), true, 3, 0>);
static_assert(is_format<decltype(constant<255>()), false, 8, 0>);
static_assert(sizeof(s<15, 16>) == 4 && sizeof(u<16, 16>) == 4 && sizeof(s<16, 16>) == 8 && sizeof(u<32, 32>) == 8);
static_assert(s<3, 4>::raw_min() == -128 && s<3, 4>::raw_max() == 127 && u<3, 4>::raw_min() == 0 && u<3, 4>::raw_max() == 127);
static_assert(s<63, 0>::raw_max() == INT64_MAX && s<63, 0>::raw_min() == INT64_MIN && u<64, 0>::raw_max() == UINT64_MAX);

template <class From, class To>
concept converts = requires(From x, void (*take)(To)) { take(x); };
static_assert(converts<s<3, 4>, s<4, 4>> && converts<u<3, 4>, s<3, 4>> && converts<s<3, 4>, s<3, 9>>);

// --- definitions ------------------------------------------------------------------------------------------

using big = int128;

static big floor_divide(big x, big y) { return x / y - (x % y != 0 && (x < 0) != (y < 0) ? 1 : 0); }
static big power(int n) { return big(1) << n; }

// Nearest whole number to x / 2^n, by looking at both neighbours.
static big nearest_by_definition(big x, int n, rounding mode) {
  const big low = floor_divide(x, power(n)), below = x - low * power(n), above = power(n) - below;
  if (mode == rounding::floor || below < above) return low;
  if (above < below) return low + 1;
  return mode == rounding::nearest ? low + 1 : (low % 2 == 0 ? low : low + 1);
}

static big limited(big x, big low, big high) { return x < low ? low : x > high ? high : x; }

template <class Format>
static big residue(big x) {
  big r = x & (power(Format::bits) - 1);
  if (Format::is_signed && r >= power(Format::bits - 1)) r -= power(Format::bits);
  return r;
}

// Calls f for all values of a format of at most 16 bits.
template <class Format, class Visit>
static void for_all(Visit visit) {
  static_assert(Format::bits <= 16);
  for (int64_t x = Format::raw_min(); x <= int64_t(Format::raw_max()); ++x) visit(Format::from_raw(typename Format::rep(x)));
}

#define ASSERT_EQUAL(a, b) assert_true(big(a) == big(b))

// --- cases ------------------------------------------------------------------------------------------------

template <class Format>
static void check_losses() {
  for_all<Format>([](Format x) {
    constexpr int f = Format::fraction_bits;
    if constexpr (Format::integer_bits > 0) {
      ASSERT_EQUAL(floor_to<0>(x).raw(), nearest_by_definition(x.raw(), f, rounding::floor));
      ASSERT_EQUAL(round_to<0>(x).raw(), nearest_by_definition(x.raw(), f, rounding::nearest));
    }
    ASSERT_EQUAL(floor_to<f - 1>(x).raw(), nearest_by_definition(x.raw(), 1, rounding::floor));
    ASSERT_EQUAL(round_to<f - 1>(x).raw(), nearest_by_definition(x.raw(), 1, rounding::nearest));
    ASSERT_EQUAL(round_to<f>(x).raw(), x.raw());
  });
}

SPANTEX_CASE(floor_and_round_follow_their_definition_for_every_value) {
  check_losses<s<3, 7>>();
  check_losses<u<4, 8>>();
  check_losses<s<-2, 9>>();
  check_losses<u<0, 13>>();
  check_losses<s<7, 8>>();
}

template <class Target, class Format>
static void check_ranges() {
  for_all<Format>([](Format x) {
    ASSERT_EQUAL(sat_to<Target>(x).raw(), limited(x.raw(), Target::raw_min(), Target::raw_max()));
    ASSERT_EQUAL(wrap_to<Target>(x).raw(), residue<Target>(x.raw()));
    if (big(x.raw()) >= big(Target::raw_min()) && big(x.raw()) <= big(Target::raw_max())) ASSERT_EQUAL(trust_to<Target>(x).raw(), x.raw());
  });
}

SPANTEX_CASE(saturation_and_wrapping_follow_their_definition_for_every_value) {
  check_ranges<s<2, 4>, s<8, 4>>();
  check_ranges<s<2, 4>, u<8, 4>>();
  check_ranges<u<2, 4>, s<8, 4>>();
  check_ranges<u<2, 4>, u<8, 4>>();
  check_ranges<s<8, 4>, s<2, 4>>();
  check_ranges<u<28, 4>, s<9, 4>>();
  check_ranges<s<28, 3>, u<9, 3>>();
}

template <class A, class B>
static void check_operators() {
  for_all<A>([](A a) {
    for_all<B>([a](B b) {
      constexpr int f = max_of(A::fraction_bits, B::fraction_bits);
      const big x = big(a.raw()) * power(f - A::fraction_bits), y = big(b.raw()) * power(f - B::fraction_bits);
      ASSERT_EQUAL((a + b).raw(), x + y);
      ASSERT_EQUAL((a - b).raw(), x - y);
      ASSERT_EQUAL((a * b).raw(), big(a.raw()) * big(b.raw()));
      ASSERT_EQUAL(a < b, x < y);
      ASSERT_EQUAL(a > b, x > y);
      ASSERT_EQUAL(a == b, x == y);
    });
    ASSERT_EQUAL((-a).raw(), -big(a.raw()));
  });
}

SPANTEX_CASE(operators_are_exact_for_every_pair_of_values) {
  check_operators<s<2, 4>, s<3, 3>>();
  check_operators<u<2, 4>, s<3, 3>>();
  check_operators<s<2, 4>, u<1, 7>>();
  check_operators<u<0, 8>, u<8, 0>>();
  check_operators<s<-1, 7>, u<5, -1>>();
}

template <class Format>
static void assert_fits(big exact) {
  assert_true(exact >= big(Format::raw_min()) && exact <= big(Format::raw_max()));
}

// The extremes of two formats must fit the result's: no pair of values can overflow.
template <class A, class B>
static void check_extremes() {
  for (const A a : {A::from_raw(A::raw_min()), A::from_raw(A::raw_max())})
    for (const B b : {B::from_raw(B::raw_min()), B::from_raw(B::raw_max())}) {
      assert_fits<decltype(a * b)>(big(a.raw()) * big(b.raw()));
      ASSERT_EQUAL((a * b).raw(), big(a.raw()) * big(b.raw()));
      ASSERT_EQUAL((a + b).raw(), big(a.raw()) + big(b.raw()));
      ASSERT_EQUAL((a - b).raw(), big(a.raw()) - big(b.raw()));
    }
}

SPANTEX_CASE(extremes_of_wide_formats_do_not_overflow) {
  check_extremes<s<15, 16>, s<15, 16>>();
  check_extremes<u<32, 0>, u<32, 0>>();
  check_extremes<s<31, 0>, u<32, 0>>();
  check_extremes<u<16, 16>, s<15, 16>>();
  check_extremes<s<15, 0>, u<16, 0>>();
}

SPANTEX_CASE(widening_keeps_the_value) {
  for_all<s<3, 4>>([](s<3, 4> x) {
    ASSERT_EQUAL((s<3, 9>(x)).raw(), big(x.raw()) * 32);
    ASSERT_EQUAL((s<20, 40>(x)).raw(), big(x.raw()) * power(36));
  });
  for_all<u<3, 4>>([](u<3, 4> x) { ASSERT_EQUAL((s<3, 9>(x)).raw(), big(x.raw()) * 32); });
}

SPANTEX_CASE(shifts_round_as_asked) {
  random_source random(1);
  for (const rounding mode : {rounding::floor, rounding::nearest, rounding::even})
    for (int shift = 0; shift <= 62; ++shift)
      for (int k = 0; k < 2000; ++k) {
        const int64_t x = random.any_magnitude(62) + (k % 2 == 0 ? 0 : (int64_t(1) << shift) / 2);
        if (big(x) > big(INT64_MAX) - power(max_of(0, shift - 1)) - 1) continue;
        ASSERT_EQUAL(shift_right(x, shift, mode), nearest_by_definition(x, shift, mode));
        const big m = x < 0 ? -big(x) : big(x), away = nearest_by_definition(m, shift, rounding::nearest);
        if (x > -INT64_MAX / 2) ASSERT_EQUAL(shift_right_symmetric(x, shift), x < 0 ? -away : away);
      }
  for (int32_t x = -4096; x < 4096; ++x)
    for (int shift = -3; shift <= 14; ++shift)
      for (const rounding mode : {rounding::floor, rounding::nearest, rounding::even})
        ASSERT_EQUAL(scale_down(x, shift, mode), shift < 0 ? big(x) * power(-shift) : nearest_by_definition(x, shift, mode));
}

SPANTEX_CASE(constants_hold_their_value) {
  ASSERT_EQUAL(constant<0>().raw(), 0);
  ASSERT_EQUAL(constant<1>().raw(), 1);
  ASSERT_EQUAL(constant<-1>().raw(), -1);
  ASSERT_EQUAL(constant<256>().raw(), 256);
  ASSERT_EQUAL(constant<-2147483648ll>().raw(), -2147483648ll);
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(floor_and_round_follow_their_definition_for_every_value),
      cmocka_unit_test(saturation_and_wrapping_follow_their_definition_for_every_value),
      cmocka_unit_test(operators_are_exact_for_every_pair_of_values),
      cmocka_unit_test(extremes_of_wide_formats_do_not_overflow),
      cmocka_unit_test(widening_keeps_the_value),
      cmocka_unit_test(shifts_round_as_asked),
      cmocka_unit_test(constants_hold_their_value),
  };
  return run_suite("fixed", tests);
}
