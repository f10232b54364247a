// SPDX-License-Identifier: Apache-2.0
// Recordings: saved and loaded without loss, refused with a reason when damaged, and replayed to the first difference.
#include "tests/engines.hpp"

using namespace spantex;
using namespace spantex::sim;

namespace {

std::string saved(const recording& log) {
  std::ostringstream out;
  if (!save(out, log)) std::abort();
  return out.str();
}

// Why the bytes are refused, or nothing.
std::string refusal(const std::string& bytes) {
  std::istringstream in(bytes);
  recording log;
  std::string why = load(in, log);
  if (!why.empty() && !log.operations.empty()) std::abort();
  return why;
}

SPANTEX_CASE(recording_survives_a_stream) {
  static std::string bytes, again;
  bytes = saved(some_recording());
  static recording log;
  static std::istringstream in;
  in.str(bytes);
  assert_string_equal(load(in, log).c_str(), "");
  again = saved(log);
  assert_true(bytes == again);
  static direct engine;
  static replay_result r;
  r = replay(log, engine);
  assert_string_equal(r.text().c_str(), ("all " + std::to_string(log.operations.size()) + " operations as recorded").c_str());
  assert_string_equal(refusal(saved({})).c_str(), "");
}

SPANTEX_CASE(damaged_recordings_are_refused_with_a_reason) {
  static std::string bytes, b;
  bytes = saved(some_recording());
  const auto refused_for = [](const std::string& damaged, const char* reason) {
    const std::string why = refusal(damaged);
    if (why.find(reason) == std::string::npos) fail_msg("expected '%s', got '%s'", reason, why.c_str());
  };
  refused_for("", "not a recording");
  refused_for("P6 640 480 255", "not a recording");
  refused_for(bytes.substr(0, 20), "cut off in its header");
  refused_for(bytes.substr(0, bytes.size() - 1), "cut off: ");
  refused_for(bytes + "x", "followed by 1 bytes");
  b = bytes;
  b[8] = 2;
  refused_for(b, "version 2, known is 5");
  b = bytes;
  b[bytes.size() / 2] = char(b[bytes.size() / 2] ^ 0x10);
  refused_for(b, "checksum");
  // Every cut and every flipped bit of the head, and many beyond.
  for (size_t k = 0; k < bytes.size(); k += k < 300 ? 1 : 997) {
    if (refusal(bytes.substr(0, k)).empty()) fail_msg("accepted when cut at byte %zu", k);
    for (int bit = 0; bit < 8; ++bit) {
      b = bytes;
      b[k] = char(b[k] ^ (1 << bit));
      if (refusal(b).empty()) fail_msg("accepted with bit %d of byte %zu flipped", bit, k);
    }
  }
}

// A checksum only says that nothing happened on the way: what it covers is checked as well.
SPANTEX_CASE(malformed_recordings_with_a_right_checksum_are_refused) {
  static std::string bytes, b;
  bytes = saved(some_recording());
  const size_t body = spantex::detail::header_length;
  const auto with = [&](size_t at, char value) {
    b = bytes.substr(0, bytes.size() - spantex::detail::checksum_length);
    b[at] = value;
    const uint32_t sum = spantex::detail::crc_of(b, b.size());
    for (int k = 0; k < 4; ++k) b.push_back(char(sum >> (8 * k)));
    return refusal(b);
  };
  assert_string_equal(with(body, 5).c_str(), "recording is malformed at operation 0, before byte 29");       // no such operation
  assert_true(with(body + 1, 2).find("malformed at operation 0") != std::string::npos);                     // no third half
  assert_true(with(body + 2, 99).find("malformed at operation 0") != std::string::npos);                    // no such status
  const size_t count = spantex::detail::magic_length + 4;  // of operations
  assert_true(with(count, char(bytes[count] - 1)).find("after its last operation") != std::string::npos);
  assert_true(with(count, char(bytes[count] + 1)).find("malformed at operation") != std::string::npos);
}

SPANTEX_CASE(replay_tells_the_first_difference) {
  static replay_result r;
  static std::unique_ptr<direct> inner;
  inner = std::make_unique<direct>();
  faulty_engine<direct> pale(*inner, {.corrupt_take = 4, .colour_flips = 0x80});
  r = replay(some_recording(), pale);
  assert_int_equal(int(r.result), int(status::mismatch));
  // Which operation is the fourth take, and which span it belongs to, straight from the recording.
  const recording& log = some_recording();
  size_t index = 0, takes = 0;
  std::vector<uint32_t> spans;
  for (;; ++index) {
    const recorded_operation& op = log.operations[index];
    if (op.what == operation::mark && op.note.kind == event_kind::span) spans.push_back(op.note.value);
    if (op.what == operation::take && ++takes == 4) break;
  }
  assert_int_equal(r.operation_index, index);
  assert_int_equal(int(r.what), int(operation::take));
  assert_int_equal(r.span_y << 16 | r.span_x, spans[3]);
  assert_int_equal(r.pixel, __builtin_ctzll(log.operations[index].mask));
  assert_true(r.text().find("take of half") != std::string::npos && r.text().find("pixel (") != std::string::npos);

  inner = std::make_unique<direct>();
  faulty_engine<direct> failing(*inner, {.fail_operation = 7});
  r = replay(log, failing);
  assert_int_equal(int(r.result), int(status::mismatch));
  assert_int_equal(r.pixel, -1);
  assert_true(r.text().find("recorded 'ok', got 'engine failed'") != std::string::npos);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(recording_survives_a_stream),
      cmocka_unit_test(damaged_recordings_are_refused_with_a_reason),
      cmocka_unit_test(malformed_recordings_with_a_right_checksum_are_refused),
      cmocka_unit_test(replay_tells_the_first_difference),
  };
  return sim::run_suite("recording", tests);
}
