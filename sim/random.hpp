// SPDX-License-Identifier: Apache-2.0
// SplitMix64 (Steele, Lea, Flood 2014): small, seedable at any point, the same on every machine.
#pragma once
#include <cstdint>

#include <spantex/bits.hpp>

namespace spantex::sim {

class random_source {
 public:
  explicit constexpr random_source(uint64_t seed) : state_(seed) {}
  SPANTEX_WRAPS constexpr uint64_t next() {
    uint64_t z = (state_ += 0x9e3779b97f4a7c15);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
  }
  // Uniform in [0, n), n > 0 (the bias of 2^-32 does not matter here).
  constexpr uint32_t below(uint32_t n) { return uint32_t(((next() >> 32) * n) >> 32); }

 private:
  uint64_t state_;
};

// One number from several: the seed of a case.
SPANTEX_WRAPS constexpr uint64_t mix(uint64_t a, uint64_t b, uint64_t c) {
  random_source r(a * 0x9e3779b97f4a7c15 + b);
  r.next();
  return random_source(r.next() ^ (c * 0xd1342543de82ef95)).next();
}

}  // namespace spantex::sim
