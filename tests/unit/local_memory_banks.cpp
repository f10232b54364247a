// SPDX-License-Identifier: Apache-2.0
// Local texture memory by enumeration: every position of the finer 2x2 with every position of the coarser one, hence every parity of
// both, every channel, for sides 8, 16 and 32. Each fetch must be one word, each bank read exactly once, the texels the right ones in the
// right order. Wrong bank maps must be seen to conflict, exactly as often as a count straight from the map says.
#include "tests/support.hpp"

#include <sim/banks.hpp>

using namespace spantex;

namespace {

// Texel values that tell level, channel and place apart.
SPANTEX_WRAPS constexpr uint8_t value_at(bool coarse, int channel, int x, int y) {
  const uint32_t mixed = (uint32_t(x) * 73u + uint32_t(y) * 151u + uint32_t(channel) * 29u + (coarse ? 97u : 11u)) * 2654435761u;
  return uint8_t(mixed >> 23);
}

// Loads the whole memory word by word, packed as the layout's documentation tells (not by the library's loader).
template <class Memory>
void fill(Memory& memory) {
  for (int coarse = 0; coarse < 2; ++coarse) {
    const int blocks = (coarse ? Memory::coarse_side : Memory::fine_side) / 2;
    for (int index = 0; index < blocks * blocks; ++index)
      for (int pair = 0; pair < 2; ++pair) {
        uint64_t word = 0;
        for (int byte = 0; byte < 8; ++byte) {
          const int x = 2 * (index % blocks) + (byte & 1), y = 2 * (index / blocks) + ((byte >> 1) & 1);
          word |= uint64_t(value_at(coarse, 2 * pair + byte / 4, x, y)) << (8 * byte);
        }
        const int address = (coarse ? Memory::fine_side * Memory::fine_side / 2 : 0) + 2 * index + pair;
        SPANTEX_ASSERT_OK(memory.load(address, &word, 1));
      }
  }
}

uint64_t expected_word(int channel, local_position fine, local_position coarse, int fine_side) {
  uint64_t word = 0;
  for (int k = 0; k < 4; ++k) {
    const int fx = (fine.x + (k & 1)) % fine_side, fy = (fine.y + (k >> 1)) % fine_side;
    const int cx = (coarse.x + (k & 1)) % (fine_side / 2), cy = (coarse.y + (k >> 1)) % (fine_side / 2);
    word |= uint64_t(value_at(false, channel, fx, fy)) << (8 * k) | uint64_t(value_at(true, channel, cx, cy)) << (32 + 8 * k);
  }
  return word;
}

template <int Side, class Each>
void each_position(Each each) {
  for (int place = 0; place < Side * Side; ++place) each(local_position{place % Side, place / Side});
}

template <int Side, class Each>
void each_fetch(Each each) {
  each_position<Side>([&](local_position fine) { each_position<Side / 2>([&](local_position coarse) { each(fine, coarse); }); });
}

template <int Side>
void check_parity_banks() {
  static local_memory<Side> memory;
  fill(memory);
  sim::bank_totals totals;
  const sim::bank_observer observer(totals);
  uint64_t done = 0;
  each_fetch<Side>([&](local_position fine, local_position coarse) {
    for (int channel = 0; channel < channel_count; ++channel, ++done) {
      const fetched f = memory.fetch(channel, fine, coarse, observer);
      if (f.word != expected_word(channel, fine, coarse, Side))
        fail_msg("side %d channel %d fine (%d, %d) coarse (%d, %d): wrong word", Side, channel, fine.x, fine.y, coarse.x, coarse.y);
      for (int bank = 0; bank < sim::bank_count; ++bank)
        if (observer.reads(0, bank) != 1 || observer.reads(1, bank) != 1) fail_msg("side %d: bank %d is not read once", Side, bank);
    }
  });
  assert_int_equal(done, uint64_t(Side) * Side * (Side / 2) * (Side / 2) * channel_count);
  assert_int_equal(totals.fetches, done);
  assert_int_equal(totals.conflicts, 0);
  assert_int_equal(totals.extra_reads, 0);
}

struct column_banks {
  static constexpr int bank(int x, int) { return x & 3; }
};
struct row_banks {
  static constexpr int bank(int, int y) { return y & 3; }
};
// Right for the rows, one bit too high for the columns: conflicts only where a 2x2 stays within a pair of columns.
struct shifted_banks {
  static constexpr int bank(int x, int y) { return (y & 1) * 2 + ((x >> 1) & 1); }
};
// Differs from parity in the numbers of the banks only: as good as parity.
struct renumbered_banks {
  static constexpr int bank(int x, int y) { return 3 - ((y & 1) * 2 + (x & 1)); }
};

// Most reads of one bank for the 2x2 at a position, straight from the map.
template <class Banks>
int busiest(local_position at, int side) {
  int reads[4] = {};
  for (int k = 0; k < 4; ++k) ++reads[Banks::bank((at.x + (k & 1)) % side, (at.y + (k >> 1)) % side)];
  return max_of(max_of(reads[0], reads[1]), max_of(reads[2], reads[3]));
}

// Returns conflicts; checks them and the extra reads against the map.
template <int Side, class Banks>
uint64_t conflicts_of() {
  static local_memory<Side, Banks> memory;
  sim::bank_totals totals;
  const sim::bank_observer observer(totals);
  uint64_t conflicts = 0, extra_reads = 0;
  each_fetch<Side>([&](local_position fine, local_position coarse) {
    (void)memory.fetch(0, fine, coarse, observer);
    const int most = max_of(busiest<Banks>(fine, Side), busiest<Banks>(coarse, Side / 2));
    if (most > 1) ++conflicts;
    extra_reads += uint64_t(most - 1);
  });
  assert_int_equal(totals.conflicts, conflicts);
  assert_int_equal(totals.extra_reads, extra_reads);
  return conflicts;
}

template <int Side>
void check_wrong_banks() {
  const uint64_t all = uint64_t(Side) * Side * (Side / 2) * (Side / 2);
  assert_int_equal((conflicts_of<Side, parity_banks>()), 0);
  assert_int_equal((conflicts_of<Side, renumbered_banks>()), 0);
  assert_int_equal((conflicts_of<Side, column_banks>()), all);
  assert_int_equal((conflicts_of<Side, row_banks>()), all);
  const uint64_t shifted = conflicts_of<Side, shifted_banks>();
  assert_true(shifted > 0 && shifted < all);
}

SPANTEX_CASE(every_fetch_is_one_word_without_conflict_8) { check_parity_banks<8>(); }
SPANTEX_CASE(every_fetch_is_one_word_without_conflict_16) { check_parity_banks<16>(); }
SPANTEX_CASE(every_fetch_is_one_word_without_conflict_32) { check_parity_banks<32>(); }
SPANTEX_CASE(wrong_bank_maps_are_seen_to_conflict_8) { check_wrong_banks<8>(); }
SPANTEX_CASE(wrong_bank_maps_are_seen_to_conflict_16) { check_wrong_banks<16>(); }
SPANTEX_CASE(wrong_bank_maps_are_seen_to_conflict_32) { check_wrong_banks<32>(); }

SPANTEX_CASE(one_copy_is_2560_bits_in_40_words) {
  assert_int_equal(local_memory<8>::bits, 2560);
  assert_int_equal(local_memory<8>::word_count, 40);
  assert_int_equal(sizeof(local_memory<8>) * 8, 2560);
}

SPANTEX_CASE(words_beyond_the_end_are_refused_and_nothing_is_written) {
  static local_memory<8> memory;
  fill(memory);
  static const local_memory<8> before = memory;
  static const uint64_t words[41] = {};
  SPANTEX_ASSERT_STATUS(memory.load(39, words, 2), bad_address);
  SPANTEX_ASSERT_STATUS(memory.load(40, words, 1), bad_address);
  SPANTEX_ASSERT_STATUS(memory.load(-1, words, 1), bad_address);
  SPANTEX_ASSERT_STATUS(memory.load(0, words, -1), bad_address);
  SPANTEX_ASSERT_STATUS(memory.load(0, words, 41), bad_address);
  SPANTEX_ASSERT_STATUS(memory.load(INT32_MAX, words, 1), bad_address);
  SPANTEX_ASSERT_STATUS(memory.load(1, words, INT32_MAX), bad_address);
  assert_memory_equal(&memory, &before, sizeof memory);
  SPANTEX_ASSERT_OK(memory.load(40, words, 0));
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(every_fetch_is_one_word_without_conflict_8),
      cmocka_unit_test(every_fetch_is_one_word_without_conflict_16),
      cmocka_unit_test(every_fetch_is_one_word_without_conflict_32),
      cmocka_unit_test(wrong_bank_maps_are_seen_to_conflict_8),
      cmocka_unit_test(wrong_bank_maps_are_seen_to_conflict_16),
      cmocka_unit_test(wrong_bank_maps_are_seen_to_conflict_32),
      cmocka_unit_test(one_copy_is_2560_bits_in_40_words),
      cmocka_unit_test(words_beyond_the_end_are_refused_and_nothing_is_written),
  };
  return sim::run_suite("local_memory_banks", tests);
}
