// SPDX-License-Identifier: Apache-2.0
// Interpolation of one channel over every pair of weights: constants, bounds, monotonicity, and the distance from the exact rational
// value, all in whole numbers.
#include <tests/properties.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

constexpr profile halves_up() {
  profile q = profiles::exact;
  q.colour_rounding = rounding::nearest;
  return q;
}
constexpr profile floor_colours() {
  profile q = profiles::standard;
  q.colour_rounding = rounding::floor;
  q.blend_bits = 0;
  return q;
}
const profile tested[] = {profiles::seed, profiles::compact, profiles::standard, profiles::exact, halves_up(), floor_colours()};

// Exact values as whole numbers over 2^(2 S) (four points) and 2^S (three points).
int64_t exact_four(texels2x2 t, weights w, int bits) {
  const int64_t one = 1 << bits, u = w.u, v = w.v;
  return (one - u) * (one - v) * t.t00 + u * (one - v) * t.t10 + (one - u) * v * t.t01 + u * v * t.t11;
}
int64_t exact_three(texels2x2 t, weights w, int bits) {
  const int64_t one = 1 << bits, u = w.u, v = w.v;
  return v >= u ? u * t.t11 + (v - u) * t.t01 + (one - v) * t.t00 : v * t.t11 + (u - v) * t.t10 + (one - u) * t.t00;
}

texels2x2 random_texels(random_source& random) {
  const auto texel = [&] {
    const uint64_t k = random.next();
    return k % 4 == 0 ? 0u : k % 4 == 1 ? 255u : uint32_t(k >> 32) & 255u;
  };
  return {texel(), texel(), texel(), texel()};
}

uint32_t smallest(texels2x2 t) { return uint32_t(min_of(min_of(int(t.t00), int(t.t10)), min_of(int(t.t01), int(t.t11)))); }
uint32_t largest(texels2x2 t) { return uint32_t(max_of(max_of(int(t.t00), int(t.t10)), max_of(int(t.t01), int(t.t11)))); }

template <class Visit>
void for_weights(const profile& q, Visit visit) {
  const uint32_t one = 1u << q.subtexel_bits;
  for (uint32_t v = 0; v < one; ++v)
    for (uint32_t u = 0; u < one; ++u) visit(weights{u, v});
}

using blend = partial_colour (*)(texels2x2, weights, const profile&);
constexpr blend blends[] = {four_point, three_point};

}  // namespace

SPANTEX_CASE(a_constant_comes_out_as_it_is_for_every_pair_of_weights) {
  for (const profile& q : tested)
    for (const blend mix : blends)
      for (const uint32_t c : {0u, 1u, 2u, 127u, 128u, 200u, 254u, 255u})
        for_weights(q, [&](weights w) { assert_int_equal(written(mix({c, c, c, c}, w, q), q), c); });
}

SPANTEX_CASE(every_constant_comes_out_as_it_is_between_levels) {
  for (const profile& q : tested)
    for (const blend mix : blends)
      for (uint32_t c = 0; c < 256; ++c)
        for (uint32_t f = 0; f < 1u << q.level_bits; ++f) {
          const weights w{(c * 7 + f) & ((1u << q.subtexel_bits) - 1), (c + 13 * f) & ((1u << q.subtexel_bits) - 1)};
          const partial_colour fine = mix({c, c, c, c}, w, q), coarse = mix({c, c, c, c}, {w.v, w.u}, q);
          assert_int_equal(written(between_levels(fine, coarse, f, q), q), c);
        }
}

SPANTEX_CASE(the_result_lies_between_its_texels_for_every_pair_of_weights) {
  random_source random(20);
  for (const profile& q : tested)
    for (const blend mix : blends)
      for (int k = 0; k < 12; ++k) {
        const texels2x2 t = random_texels(random);
        for_weights(q, [&](weights w) {
          const uint32_t c = written(mix(t, w, q), q);
          assert_true(c >= smallest(t) && c <= largest(t));
        });
      }
}

SPANTEX_CASE(two_levels_stay_between_all_eight_texels) {
  random_source random(21);
  for (const profile& q : tested)
    for (int k = 0; k < 300000; ++k) {
      const texels2x2 s = random_texels(random), t = random_texels(random);
      const uint32_t mask = (1u << q.subtexel_bits) - 1, f = uint32_t(random.next()) & ((1u << q.level_bits) - 1);
      const weights w{uint32_t(random.next()) & mask, uint32_t(random.next()) & mask};
      const blend mix = blends[k & 1];
      const uint32_t c = written(between_levels(mix(s, w, q), mix(t, {w.v, w.u}, q), f, q), q);
      assert_true(c >= uint32_t(min_of(int(smallest(s)), int(smallest(t)))) && c <= uint32_t(max_of(int(largest(s)), int(largest(t)))));
    }
}

// Along a line of weights a result either never falls or never rises.
template <class Value>
static void assert_monotone(uint32_t first, uint32_t last, Value value) {
  const bool rises = value(first) <= value(last);
  for (uint32_t k = first; k < last; ++k) assert_true(rises ? value(k) <= value(k + 1) : value(k) >= value(k + 1));
}

SPANTEX_CASE(four_points_are_monotone_in_each_weight) {
  random_source random(22);
  for (const profile& q : tested)
    for (int k = 0; k < 12; ++k) {
      const texels2x2 t = random_texels(random);
      const uint32_t one = 1u << q.subtexel_bits;
      for (uint32_t fixed_weight = 0; fixed_weight < one; ++fixed_weight) {
        assert_monotone(0, one - 1, [&](uint32_t f) { return written(four_point(t, {f, fixed_weight}, q), q); });
        assert_monotone(0, one - 1, [&](uint32_t f) { return written(four_point(t, {fixed_weight, f}, q), q); });
      }
    }
}

// Three points make two planes that meet on the diagonal: monotone along each.
SPANTEX_CASE(three_points_are_monotone_in_each_weight_on_either_side_of_the_diagonal) {
  random_source random(23);
  for (const profile& q : tested)
    for (int k = 0; k < 12; ++k) {
      const texels2x2 t = random_texels(random);
      const uint32_t one = 1u << q.subtexel_bits;
      for (uint32_t m = 0; m < one; ++m) {
        assert_monotone(0, m, [&](uint32_t f) { return written(three_point(t, {f, m}, q), q); });
        assert_monotone(m, one - 1, [&](uint32_t f) { return written(three_point(t, {f, m}, q), q); });
        assert_monotone(0, m, [&](uint32_t f) { return written(three_point(t, {m, f}, q), q); });
        assert_monotone(m, one - 1, [&](uint32_t f) { return written(three_point(t, {m, f}, q), q); });
      }
    }
}

SPANTEX_CASE(two_levels_are_monotone_in_the_fraction) {
  random_source random(24);
  for (const profile& q : tested)
    for (int k = 0; k < 3000; ++k) {
      const uint32_t mask = (1u << q.subtexel_bits) - 1;
      const weights w{uint32_t(random.next()) & mask, uint32_t(random.next()) & mask};
      const partial_colour a = blends[k & 1](random_texels(random), w, q), b = blends[k & 1](random_texels(random), w, q);
      assert_monotone(0, (1u << q.level_bits) - 1, [&](uint32_t f) { return written(between_levels(a, b, f, q), q); });
    }
}

SPANTEX_CASE(a_brighter_texel_never_darkens_the_result) {
  random_source random(25);
  for (const profile& q : tested)
    for (int k = 0; k < 100000; ++k) {
      const texels2x2 t = random_texels(random);
      texels2x2 brighter = t;
      uint32_t* const texel[4] = {&brighter.t00, &brighter.t10, &brighter.t01, &brighter.t11};
      uint32_t& one = *texel[k % 4];
      one = one < 255 ? one + 1 : 255;
      const uint32_t mask = (1u << q.subtexel_bits) - 1;
      const weights w{uint32_t(random.next()) & mask, uint32_t(random.next()) & mask};
      for (const blend mix : blends) assert_true(written(mix(brighter, w, q), q) >= written(mix(t, w, q), q));
    }
}

static void check(const char* profile_name, const char* what, const rounding_error& e, const profile& q, bool two_levels) {
  std::printf("# %s, %s: worst %.5f LSB, mean %.6f LSB\n", profile_name, what, e.worst_lsb(), e.mean_lsb());
  assert_true(e.worst <= int64_t(1) << 32);
  assert_true(e.is_within_bound(q, two_levels));
  assert_true(e.is_unbiased());
}

static void check_single_level(const char* name, const profile& q) {
  random_source random(26);
  rounding_error four, three;
  for (int k = 0; k < 24; ++k) {
    const texels2x2 t = random_texels(random);
    for_weights(q, [&](weights w) {
      four.note(written(four_point(t, w, q), q), exact_four(t, w, q.subtexel_bits), 2 * q.subtexel_bits);
      three.note(written(three_point(t, w, q), q), exact_three(t, w, q.subtexel_bits), q.subtexel_bits);
    });
  }
  check(name, "four points", four, q, false);
  check(name, "three points", three, q, false);
}

SPANTEX_CASE(one_level_is_within_1_lsb_of_the_exact_value) {
  for (const named_profile& p : all_profiles) check_single_level(p.name, p.value);
}

static void check_two_levels(const char* name, const profile& q) {
  random_source random(27);
  rounding_error four, three;
  const uint32_t mask = (1u << q.subtexel_bits) - 1;
  const int s = q.subtexel_bits, m = q.level_bits;
  for (int k = 0; k < 2000000; ++k) {
    const texels2x2 a = random_texels(random), b = random_texels(random);
    const uint64_t r = random.next();
    const weights w{uint32_t(r) & mask, uint32_t(r >> 8) & mask}, x{uint32_t(r >> 16) & mask, uint32_t(r >> 24) & mask};
    const uint32_t f = uint32_t(r >> 32) & ((1u << m) - 1);
    const auto exact = [&](auto value) { return value(a, w, s) * ((1 << m) - int64_t(f)) + value(b, x, s) * int64_t(f); };
    four.note(written(between_levels(four_point(a, w, q), four_point(b, x, q), f, q), q), exact(exact_four), 2 * s + m);
    three.note(written(between_levels(three_point(a, w, q), three_point(b, x, q), f, q), q), exact(exact_three), s + m);
  }
  check(name, "four points, two levels", four, q, true);
  check(name, "three points, two levels", three, q, true);
}

SPANTEX_CASE(two_levels_are_within_1_lsb_of_the_exact_value) {
  for (const named_profile& p : all_profiles) check_two_levels(p.name, p.value);
}

// Every profile that is valid must keep its intermediates in 32 bits: the largest texels, every combination of widths.
SPANTEX_CASE(white_stays_white_for_every_word_length) {
  for (int s = 1; s <= 8; ++s)
    for (int m = 1; m <= 8; ++m)
      for (int b = 0; b <= 16; ++b)
        for (const rounding mode : {rounding::floor, rounding::nearest, rounding::even}) {
          profile q = profiles::exact;
          q.subtexel_bits = s;
          q.level_bits = m;
          q.blend_bits = b;
          q.colour_rounding = mode;
          assert_true(is_valid(q));
          const uint32_t top = (1u << s) - 1;
          for (const weights w : {weights{0, 0}, weights{top, top}, weights{top, 0}, weights{top / 2, top}})
            for (const blend mix : blends) {
              const partial_colour c = mix({255, 255, 255, 255}, w, q);
              assert_int_equal(written(c, q), 255);
              assert_int_equal(written(between_levels(c, c, (1u << m) - 1, q), q), 255);
            }
        }
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_constant_comes_out_as_it_is_for_every_pair_of_weights),
      cmocka_unit_test(every_constant_comes_out_as_it_is_between_levels),
      cmocka_unit_test(the_result_lies_between_its_texels_for_every_pair_of_weights),
      cmocka_unit_test(two_levels_stay_between_all_eight_texels),
      cmocka_unit_test(four_points_are_monotone_in_each_weight),
      cmocka_unit_test(three_points_are_monotone_in_each_weight_on_either_side_of_the_diagonal),
      cmocka_unit_test(two_levels_are_monotone_in_the_fraction),
      cmocka_unit_test(a_brighter_texel_never_darkens_the_result),
      cmocka_unit_test(one_level_is_within_1_lsb_of_the_exact_value),
      cmocka_unit_test(two_levels_are_within_1_lsb_of_the_exact_value),
      cmocka_unit_test(white_stays_white_for_every_word_length),
  };
  return run_suite("filter", tests);
}
