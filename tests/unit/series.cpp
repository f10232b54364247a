// SPDX-License-Identifier: Apache-2.0
// 1/(1 + e) and log2(1 + e) of flat spans in 16-bit products, over every 16-bit e of every scale, against long double: that errs by less
// than 2^-60, where the smallest unit is 2^-29. The bounds are those of docs/ACCURACY.md, stages 6 and 8.
#include <tests/support.hpp>

#include <cmath>

using namespace spantex;
using namespace spantex::sim;

namespace {

using real = long double;

real power(int e) { return std::ldexp(real(1), e); }

// use(e16): all that |e| < 2^slope_log2 leaves after the floor.
template <class Use>
void for_every_slope(Use use) {
  for (int32_t e16 = -(1 << series_bits); e16 < 1 << series_bits; ++e16) use(e16);
}

// The series without its types: what it would be in numbers of any size.
int64_t unlimited_series(int64_t e16, int slope_log2, int terms) {
  int64_t q = e16;
  for (int k = 1; k < terms; ++k) q = e16 - ((e16 * q) >> (series_bits - slope_log2));
  return q;
}

// |1 - q - 1/(1 + e)|: the terms left out, and the floors of e and of each product.
real series_limit(int slope_log2, int terms) {
  const real reach = power(slope_log2), unit = power(slope_log2 - series_bits);
  return power(slope_log2 * (terms + 1)) / (1 - reach) + unit / ((1 - reach) * (1 - reach));
}

}  // namespace

SPANTEX_CASE(every_slope_of_every_scale_is_within_the_bound_of_its_terms) {
  for (int terms = 1; terms <= most_series_terms; ++terms) {
    real largest_share = 0;
    for (int scale = least_slope_log2; scale <= most_series_slope_log2; ++scale) {
      const real unit = power(scale - series_bits), limit = series_limit(scale, terms);
      for_every_slope([&](int32_t e16) {
        const int64_t q = unlimited_series(e16, scale, terms);
        assert_true(q == series_of(series_number::from_raw(e16), scale, terms).raw());
        assert_true(q >= INT16_MIN && q <= INT16_MAX);
        for (const int end : {0, 1}) {  // e lies in [e16, e16 + 1)
          const real error = std::fabs(1 - real(q) * unit - 1 / (1 + real(e16 + end) * unit));
          assert_true(error <= limit);
          largest_share = std::fmax(largest_share, error / limit);
        }
      });
    }
    std::printf("# %d terms: at most %.1Lf %% of the bound\n", terms, 100 * largest_share);
    assert_true(largest_share > 0.9L);
  }
}

// The product with the upper 16 bits of n, for every word length: what the planner's two conditions are made of.
SPANTEX_CASE(numerators_are_within_their_bound_for_every_word_length) {
  random_source random(71);
  real largest_share = 0;
  for (int offset_bits = 12; offset_bits <= 31; ++offset_bits)
    for (int scale = least_slope_log2; scale <= most_series_slope_log2; ++scale)
      for (int terms = 1; terms <= most_series_terms; ++terms) {
        const run_time_profile prof{{.offset_bits = offset_bits}};
        const int64_t most = (int64_t(1) << (offset_bits - 1)) + 32;
        const real limit = real(most) * series_limit(scale, terms) + power(max_of(0, offset_bits - 15) + scale) * 4 / 3 * (1 + power(-13)) + 1;
        for (int k = 0; k < 1000; ++k) {
          const int32_t e16 = int32_t(random.between(-(1 << series_bits), (1 << series_bits) - 1)) >> (k % 4 == 0 ? 0 : int(random.next() % 14));
          const auto n = int32_t(k % 3 == 0 ? (k % 2 == 0 ? most : -most) : random.between(-most, most));
          const series_number q = series_of(series_number::from_raw(e16), scale, terms);
          const real got = numerator_by_series(prof, offset_mantissa<run_time_profile>::from_raw(n), q, scale).raw();
          for (const int end : {0, 1}) {
            const real error = std::fabs(got - real(n) / (1 + real(e16 + end) * power(scale - series_bits)));
            assert_true(error <= limit);
            largest_share = std::fmax(largest_share, error / limit);
          }
        }
      }
  std::printf("# at most %.1Lf %% of the bound\n", 100 * largest_share);
  assert_true(largest_share > 0.7L);
}

// The planner's conditions against that bound: whatever is chosen leaves at most 3/4 of the tolerance, and a unit of the mantissas.
SPANTEX_CASE(what_the_planner_chooses_keeps_the_tolerance) {
  real largest_share = 0;
  int64_t chosen[most_series_terms + 1] = {}, affine = 0;
  for (int offset_bits = 12; offset_bits <= 31; ++offset_bits)
    for (int tolerance = 0; tolerance <= 16; ++tolerance)
      for (int extent = -20; extent <= max_extent_log2; ++extent)
        for (int bits = 1; bits <= 29; ++bits) {  // of the slopes
          const profile q{.offset_bits = offset_bits, .reciprocal_bits = 30, .tolerance_bits = tolerance};
          span_coefficients c{};
          c.exponent = int8_t(mantissa_exponent(q, extent));
          c.g = int32_t(((int64_t(1) << bits) - 1) / 7);
          choose_evaluation(q, 7, extent, true, c);
          if (c.how == evaluation::divide) continue;
          const real most = power(extent) + 32 * power(-c.exponent), e = 7 * real(c.g) * power(-30);
          const real cut = offset_bits > 15 ? power(offset_bits - 15 - c.exponent + c.slope_log2) * 4 / 3 * (1 + power(-13)) : 0;
          const real left_out = c.how == evaluation::affine ? most * e / (1 - e) : most * series_limit(c.slope_log2, c.terms) + cut;
          const real tolerated = 0.75L * power(-tolerance);
          assert_true(left_out <= tolerated);
          largest_share = std::fmax(largest_share, left_out / tolerated);
          if (c.how == evaluation::affine) ++affine;
          else ++chosen[c.terms];
        }
  std::printf("# affine %lld, series %lld %lld %lld %lld; at most %.1Lf %% of 3/4 of the tolerance\n", static_cast<long long>(affine),
              static_cast<long long>(chosen[1]), static_cast<long long>(chosen[2]), static_cast<long long>(chosen[3]),
              static_cast<long long>(chosen[4]), 100 * largest_share);
  assert_true(largest_share > 0.8L && affine > 1000);
  for (int terms = 1; terms <= most_series_terms; ++terms) assert_true(chosen[terms] > 1000);
}

// log2 w twice and once, in 2^-16 level.
SPANTEX_CASE(every_logarithm_of_a_flat_span_is_within_its_bound) {
  for (const int times : {1, 2}) {
    real worst = 0;
    for (int scale = least_slope_log2; scale <= most_level_slope_log2; ++scale)
      for_every_slope([&](int32_t e16) {
        const real got = power_log2_of_series(series_number::from_raw(e16), scale, times);
        for (const int end : {0, 1})
          worst = std::fmax(worst, std::fabs(got - times * 65536 * std::log2(1 + real(e16 + end) * power(scale - series_bits))));
      });
    std::printf("# %d log2 w: %.3Lf units of 2^-16\n", times, worst);
    const real limit = real(twice_log2_w_bound()) / real(error_unit) * 65536;
    assert_true(worst <= (times == 2 ? limit : limit / 2 + 1));
    assert_true(worst >= 0.9L * limit / (3 - times));
  }
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(every_slope_of_every_scale_is_within_the_bound_of_its_terms),
      cmocka_unit_test(numerators_are_within_their_bound_for_every_word_length),
      cmocka_unit_test(what_the_planner_chooses_keeps_the_tolerance),
      cmocka_unit_test(every_logarithm_of_a_flat_span_is_within_its_bound),
  };
  return run_suite("series", tests);
}
