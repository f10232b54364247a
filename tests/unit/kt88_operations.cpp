// SPDX-License-Identifier: Apache-2.0
// KT88 counts 6 reads, 5 multiplications and 10 additions a channel for 3-point trilinear filtering and 8, 7, 14 for 4-point. Counted
// here in the engine's own filter functions, by a number that counts what is done to it and a texel that counts when it is read.
//
// Counted: every multiplication, addition and subtraction of colours and weights. Not counted: shifts by word lengths, the roundings
// behind them (wires and a carry in hardware), the comparison that picks the triangle, and what precedes the filter (address, weights).
// The span machine fetches a word of 2x2 texels of both levels at once, whatever the filter: there the three-point filter
// leaves two of the eight bytes unused.
#include <tests/support.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

struct operation_counts {
  int reads = 0, multiplications = 0, additions = 0;
  bool operator==(const operation_counts&) const = default;
};
operation_counts done;

// Arithmetic of uint32_t, counted.
struct counted {
  uint32_t value;
  friend counted operator+(counted a, counted b) { ++done.additions; return {wrapped_sum(a.value, b.value)}; }
  friend counted operator-(counted a, counted b) { ++done.additions; return {wrapped_sum(a.value, ~b.value, 1)}; }
  friend counted operator*(counted a, counted b) { ++done.multiplications; return {uint32_t(uint64_t(a.value) * b.value)}; }
  friend counted operator<<(counted a, int n) { return {a.value << n}; }
  friend bool operator>=(counted a, counted b) { return a.value >= b.value; }
  friend counted round_off(counted a, int drop, rounding mode) { return {spantex::round_off(a.value, drop, mode)}; }

 private:
  static uint32_t wrapped_sum(uint32_t a, uint32_t b, uint32_t carry = 0) { return uint32_t(uint64_t(a) + b + carry); }
};

// A texel still in memory: turning it into a number reads it.
struct texel_in_memory {
  const uint8_t* at;
  operator counted() const { ++done.reads; return {*at}; }
};

struct eight_texels { uint8_t fine[4], coarse[4]; };

texels2x2_of<texel_in_memory> in_memory(const uint8_t (&t)[4]) { return {{&t[0]}, {&t[1]}, {&t[2]}, {&t[3]}}; }
texels2x2 in_registers(const uint8_t (&t)[4]) { return {t[0], t[1], t[2], t[3]}; }
weights_of<counted> counted_weights(weights w) { return {{w.u}, {w.v}}; }

struct sample { eight_texels t; weights fine, coarse; uint32_t fraction; };

sample random_sample(random_source& random, const profile& q) {
  sample s{};
  for (int k = 0; k < 4; ++k) {
    s.t.fine[k] = uint8_t(random.next());
    s.t.coarse[k] = uint8_t(random.next());
  }
  const auto weight = [&](int bits) { return uint32_t(random.next()) & ((1u << bits) - 1); };
  s.fine = {weight(q.subtexel_bits), weight(q.subtexel_bits)};
  s.coarse = {weight(q.subtexel_bits), weight(q.subtexel_bits)};
  s.fraction = weight(q.level_bits);
  return s;
}

template <class CountedBlend, class Blend>
void check_trilinear(const operation_counts& allowed, CountedBlend counted_blend, Blend blend) {
  random_source random(60);
  for (const named_profile& p : all_profiles)
    for (int k = 0; k < 20000; ++k) {
      const profile& q = p.value;
      const sample s = random_sample(random, q);
      done = {};
      const auto fine = counted_blend(in_memory(s.t.fine), counted_weights(s.fine), q);
      const auto coarse = counted_blend(in_memory(s.t.coarse), counted_weights(s.coarse), q);
      const auto both = between_levels(fine, coarse, counted{s.fraction}, q);
      assert_true(done == allowed);
      // The same functions on plain numbers: what was counted is what is computed.
      const partial_colour plain =
          between_levels(blend(in_registers(s.t.fine), s.fine, q), blend(in_registers(s.t.coarse), s.coarse, q), s.fraction, q);
      assert_int_equal(both.value.value, plain.value);
      assert_int_equal(both.bits, plain.bits);
    }
}

}  // namespace

SPANTEX_CASE(three_point_trilinear_takes_6_reads_5_multiplications_10_additions) {
  check_trilinear({6, 5, 10}, [](auto t, auto w, const profile& q) { return three_point(t, w, q); },
                  [](texels2x2 t, weights w, const profile& q) { return three_point(t, w, q); });
}

SPANTEX_CASE(four_point_trilinear_takes_8_reads_7_multiplications_14_additions) {
  check_trilinear({8, 7, 14}, [](auto t, auto w, const profile& q) { return four_point(t, w, q); },
                  [](texels2x2 t, weights w, const profile& q) { return four_point(t, w, q); });
}

SPANTEX_CASE(one_level_takes_2_or_3_multiplications) {
  random_source random(61);
  const sample s = random_sample(random, profiles::exact);
  done = {};
  (void)three_point(in_memory(s.t.fine), counted_weights(s.fine), profiles::exact);
  assert_true((done == operation_counts{3, 2, 4}));
  done = {};
  (void)four_point(in_memory(s.t.fine), counted_weights(s.fine), profiles::exact);
  assert_true((done == operation_counts{4, 3, 6}));
}

// The specification's form, a (2^n - f) + b f, in numbers too wide to wrap.
SPANTEX_CASE(one_multiplication_gives_what_two_give) {
  random_source random(62);
  for (int k = 0; k < 2000000; ++k) {
    const int weight_bits = 1 + int(random.next() % 8), bits = int(random.next() % uint64_t(max_blend_bits - weight_bits + 1));
    const uint64_t most = uint64_t(255) << bits;
    const uint32_t a = uint32_t(random.next() % (most + 1)), b = uint32_t(random.next() % (most + 1));
    const uint32_t f = uint32_t(random.next()) & ((1u << weight_bits) - 1);
    const uint64_t wanted = uint64_t(a) * ((uint64_t(1) << weight_bits) - f) + uint64_t(b) * f;
    assert_true(interpolated(a, b, f, weight_bits) == wanted);
  }
}

namespace {
// Counts the bank reads of a fetch.
struct bank_reads {
  int* count;
  void fetch_begin() const {}
  void bank_read(int, int, int) const { ++*count; }
};
}  // namespace

SPANTEX_CASE(the_machine_fetches_eight_texels_a_channel_in_one_word) {
  const local_memory<16> memory;
  int count = 0;
  (void)memory.fetch(0, {3, 5}, {1, 2}, bank_reads{&count});
  assert_int_equal(count, 8);
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(three_point_trilinear_takes_6_reads_5_multiplications_10_additions),
      cmocka_unit_test(four_point_trilinear_takes_8_reads_7_multiplications_14_additions),
      cmocka_unit_test(one_level_takes_2_or_3_multiplications),
      cmocka_unit_test(one_multiplication_gives_what_two_give),
      cmocka_unit_test(the_machine_fetches_eight_texels_a_channel_in_one_word),
  };
  return run_suite("kt88_operations", tests);
}
