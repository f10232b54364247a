// SPDX-License-Identifier: Apache-2.0
// Local texture memory of one half (VR11): for each channel two sets of four banks, Fine x Fine values of the finer level and
// half that side of the coarser, interleaved by the parity of the two coordinates, so that any 2x2 of both levels is
// read at once: one 64-bit word per channel, four bytes finer, four coarser.
//
//   bank of (x, y) = (y & 1) 2 + (x & 1),  address in the bank = (y >> 1) (side / 2) + (x >> 1)
//
// Local coordinates are texel indices modulo the side: a torus, so that a section may start at any texel and still use
// every cell, and a 2x2 may straddle the edge.
//
// The word comes in bank order; the output switch, steered by the two lowest coordinate bits, puts it in texel order:
//
//   byte   0        1        2        3        4..7
//          (0,0)    (1,0)    (0,1)    (1,1)    the same of the coarser level
//
// Loading is sequential. A load word fills one address of the four banks of two channels (one aligned 2x2 of texels):
//
//   byte   0..3: channel 2p at (0,0) (1,0) (0,1) (1,1)     4..7: channel 2p + 1 likewise
//   word address = 2 (row-major index of the 2x2 block) + p, finer level first, then the coarser one
#pragma once
#include <stdint.h>

#include <spantex/profile.hpp>
#include <spantex/span.hpp>
#include <spantex/status.hpp>

namespace spantex {

// Which bank holds a texel. Any other map makes fetches collide: the simulator's tests show it.
struct parity_banks {
  static constexpr int bank(int x, int y) { return (y & 1) * 2 + (x & 1); }
};

// Watches fetches. This one costs nothing; the simulator's counts conflicts.
struct no_observer {
  constexpr void fetch_begin() const {}
  constexpr void bank_read(int /*set: 0 finer, 1 coarser*/, int /*bank*/, int /*address*/) const {}
};

// Eight bytes: what one fetch delivers for one channel.
struct fetched { uint64_t word; };

constexpr uint32_t fine_texel(fetched f, int k) { return uint32_t(f.word >> (8 * k)) & 0xFF; }
constexpr uint32_t coarse_texel(fetched f, int k) { return uint32_t(f.word >> (32 + 8 * k)) & 0xFF; }

// Reorders four bytes: output byte k is input byte k ^ select.
constexpr uint32_t output_switch(uint32_t banks, int select) {
  const uint32_t pairs = (select & 1) ? ((banks & 0x00FF00FFu) << 8) | ((banks >> 8) & 0x00FF00FFu) : banks;
  return (select & 2) ? (pairs << 16) | (pairs >> 16) : pairs;
}

struct local_position { int x, y; };  // of the upper left texel of a 2x2, each in [0, side)

template <int Fine, class Banks = parity_banks>
class local_memory {
 public:
  static_assert(Fine == 8 || Fine == 16 || Fine == 32, "spantex: local memory holds 8x8, 16x16 or 32x32 texels of the finer level");
  static constexpr int fine_side = Fine, coarse_side = Fine / 2;
  static constexpr int bits = (fine_side * fine_side + coarse_side * coarse_side) * 8 * channel_count;
  static constexpr int word_count = bits / 64;
  static constexpr int coarse_first_word = fine_side * fine_side / 4 * 2;

  // Errors: bad_address.
  constexpr status load(int first, const uint64_t* words, int count) {
    if (first < 0 || count < 0 || first > word_count || count > word_count - first) return status::bad_address;
    for (int k = 0; k < count; ++k) store(first + k, words[k]);
    return status::ok;
  }

  // The 2x2 of the finer level at `fine` and of the coarser one at `coarse`, one channel, through banks and output switches.
  template <class Observer>
  constexpr fetched fetch(int channel, local_position fine, local_position coarse, const Observer& observer) const {
    observer.fetch_begin();
    const uint32_t low = read<fine_side>(fine_[channel], 0, fine, observer);
    const uint32_t high = read<coarse_side>(coarse_[channel], 1, coarse, observer);
    return {uint64_t(output_switch(high, parity_banks::bank(coarse.x, coarse.y))) << 32 |
            output_switch(low, parity_banks::bank(fine.x, fine.y))};
  }

 private:
  template <int Side>
  using bank_set = uint8_t[4][Side * Side / 4];

  constexpr void store(int address, uint64_t word) {
    const int pair = address & 1;
    const bool coarse = address >= coarse_first_word;
    const int block = (coarse ? address - coarse_first_word : address) >> 1;
    for (int k = 0; k < 8; ++k) {
      const int channel = 2 * pair + (k >> 2), x = k & 1, y = (k >> 1) & 1;
      const uint8_t value = uint8_t(word >> (8 * k));
      if (coarse) coarse_[channel][parity_banks::bank(x, y)][block] = value;
      else fine_[channel][parity_banks::bank(x, y)][block] = value;
    }
  }

  // Reads the four texels of a 2x2: each comes from the bank that Banks says; with parity each bank is read exactly once.
  template <int Side, class Observer>
  static constexpr uint32_t read(const bank_set<Side>& banks, int set, local_position at, const Observer& observer) {
    uint32_t result = 0;
    for (int b = 0; b < 4; ++b) {
      // The texel of the 2x2 whose parities are b's: address bits grow by one where the 2x2 straddles blocks.
      const int x = (at.x + ((at.x ^ b) & 1)) & (Side - 1), y = (at.y + ((at.y ^ (b >> 1)) & 1)) & (Side - 1);
      const int address = (y >> 1) * (Side / 2) + (x >> 1);
      observer.bank_read(set, Banks::bank(x, y), address);
      result |= uint32_t(banks[b][address]) << (8 * b);
    }
    return result;
  }

  uint8_t fine_[channel_count][4][fine_side * fine_side / 4] = {};
  uint8_t coarse_[channel_count][4][coarse_side * coarse_side / 4] = {};
};

}  // namespace spantex
