// SPDX-License-Identifier: Apache-2.0
// What docs/BENCH.md says that the checksums of frames find. A CRC is linear: whether an error passes depends on the error alone, so what single bits do to
// the remainder (their syndromes) tells of all errors made of them.
#include <algorithm>
#include <set>
#include <vector>

#include <firmware/bench/frame.hpp>
#include "tests/support.hpp"

using namespace spantex;
using namespace spantex::sim;

namespace {

template <class Crc>
Crc crc_of(const char* text) {
  Crc crc;
  for (; *text != 0; ++text) crc.add(uint8_t(*text));
  return crc;
}

void checksums_give_their_published_values(void**) {
  assert_int_equal(crc_of<bench::crc16>("123456789").value, 0x29B1);
  assert_int_equal(crc_of<bench::crc32>("123456789").value(), 0xCBF43926u);
}

// In the order of transmission, the high bit of each byte first, of a frame of so many bytes.
std::vector<uint16_t> syndromes(int frame_bytes) {
  std::vector<uint16_t> s;
  for (int bit = 0; bit < 16; ++bit) s.push_back(uint16_t(1u << bit));  // of the CRC itself, from the frame's end
  for (int byte = 0; byte < frame_bytes - bench::crc_bytes; ++byte)
    for (int bit = 0; bit < 8; ++bit) {
      bench::crc16 crc{byte == 0 ? uint16_t(0) : s[s.size() - 8]};  // one byte earlier is one more to go
      crc.add(byte == 0 ? uint8_t(1u << bit) : uint8_t(0));
      s.push_back(crc.value);
    }
  std::reverse(s.begin(), s.end());
  return s;
}

void errors_of_up_to_three_bits_are_found(void**) {
  const std::vector<uint16_t> s = syndromes(4095);
  std::set<uint16_t> seen;
  for (uint16_t x : s) {
    assert_int_not_equal(x, 0);
    assert_true(seen.insert(x).second);  // else two would cancel
    assert_int_equal(__builtin_popcount(x) & 1, 1);  // of three, one remains
  }
}

int rank_of(const uint16_t* s, int count) {
  std::vector<uint16_t> basis;
  for (int k = 0; k < count; ++k) {
    uint16_t x = s[k];
    for (uint16_t b : basis) x = std::min<uint16_t>(x, uint16_t(x ^ b));
    if (x != 0) basis.push_back(x);
  }
  return int(basis.size());
}

void bursts_of_up_to_16_bits_are_found(void**) {
  const std::vector<uint16_t> s = syndromes(4095);
  for (size_t k = 0; k + 16 <= s.size(); ++k) assert_int_equal(rank_of(&s[k], 16), 16);
}

// The frames themselves: syndromes are what the receiver sees, and no two bytes in a row can be damaged unseen.
void damaged_frames_are_refused(void**) {
  bench::frame_builder<64> frame;
  bench::field_writer out = frame.payload();
  for (uint8_t k = 0; k < 24; ++k) out(uint8_t(37 * k));
  frame.finish(0x11, 9, 0x1234567, out.size());
  const auto state_of = [&](int at, int first, int second) {
    bench::frame_receiver<64> received;
    received.begin();
    for (int k = 0; k < frame.size(); ++k) received.take(uint8_t(frame.byte(k) ^ (k == at ? first : k == at + 1 ? second : 0)));
    return received.state();
  };
  assert_true(state_of(0, 0, 0) == bench::frame_state::complete);
  for (int at = 0; at + 1 < frame.size(); ++at)
    for (int damage = 1; damage < 0x10000; damage += at < frame.size() - 4 ? 251 : 1)
      if (state_of(at, damage >> 8, damage & 0xFF) == bench::frame_state::complete) fail_msg("bytes %d and %d: %04x", at, at + 1, unsigned(damage));
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(checksums_give_their_published_values),
      cmocka_unit_test(errors_of_up_to_three_bits_are_found),
      cmocka_unit_test(bursts_of_up_to_16_bits_are_found),
      cmocka_unit_test(damaged_frames_are_refused),
  };
  return sim::run_suite("bench_frames", tests);
}
