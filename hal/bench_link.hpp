// SPDX-License-Identifier: Apache-2.0
// The host's end of the bench's link (docs/BENCH.md): four-phase handshakes, frames, answers, bounded repetitions. Host only.
#pragma once
#include <stdint.h>

#include <array>
#include <string>

#include <firmware/bench/frame.hpp>
#include <hal/bench_lines.hpp>

namespace spantex {

struct bench_limits {
  uint64_t step_ns = 200'000'000;        // the device answers a change of the clock, or of reset
  uint64_t exchange_ns = 5'000'000'000;  // a command and its answer, repetitions included
  uint64_t compute_ns = 5'000'000'000;   // a span
  uint64_t back_off_ns = 50'000;         // before the second attempt; doubled before each further one
  uint64_t spin_ns = 0;                  // lines are read again and again for so long before their edges are waited for
  uint64_t patience_ns = 0;              // how long a device that is gone is waited for
  int attempts = 4;                      // of one command
  int recoveries = 3;                    // by reset, of one operation
};

// Every way in which the link gives up something: what failed, and what it takes that for.
enum class bench_exit : uint8_t {
  line_failed,           // the chip refused a call
  interrupted,
  ready_stuck,           // ready high before the clock rises
  ready_did_not_rise,
  ready_did_not_fall,
  exchange_too_long,
  answer_too_long,       // its length says so
  answer_bad_crc,
  answer_bad_seal,
  answer_of_another,     // command or sequence
  answer_with_error_line,
  refused_incomplete,    // the device did not understand the request
  refused_length,
  refused_crc,
  refused_seal,
  answer_malformed,      // whole, but not what the command is answered with
  reset_not_entered,
  reset_not_left,
  busy_too_long,
  compute_too_long,
  not_a_device,
  other_version,
  other_profile,
  device_refused,        // the device's engine reports an error of its own
};
inline constexpr int bench_exit_count = int(bench_exit::device_refused) + 1;
const char* to_string(bench_exit e);

struct bench_counters {
  uint64_t exchanges = 0, attempts = 0, rereads = 0, bytes_out = 0, bytes_in = 0, line_calls = 0;
  uint64_t resets = 0, recoveries = 0, restored_words = 0, pending_answers = 0;
  std::array<uint64_t, bench_exit_count> exits{};
};

class bench_link {
 public:
  static constexpr int most_request_bytes = 4096, most_answer_bytes = 512;
  using request = bench::frame_builder<most_request_bytes>;
  using answer = bench::frame_receiver<most_answer_bytes>;

  // The lines must outlive the link.
  bench_link(bench_lines& lines, const bench_limits& limits) : lines_(lines), limits_(limits) {}

  // The device goes back to its state after power-on, as its echo confirms. Errors: device_error, device_timeout.
  status reset();

  // Sends a command with the payload that is in request(), until an answer has come that is one: whole, sealed with the session, of this command and
  // this sequence. Its first payload byte is a bench::result. Errors: device_error, device_timeout.
  status exchange(bench::command what, uint32_t session, int payload_bytes);
  bench::field_writer payload() { return request_.payload(); }
  bench::result code() const { return code_; }
  bench::field_reader fields() const;  // of the answer, after its code

  // Until busy is low. Errors: device_error, device_timeout.
  status wait_while_busy(uint64_t limit_ns);

  // What went wrong last, in one line.
  const std::string& trouble() const { return trouble_; }
  status gave_up(bench_exit why, status as, const std::string& more = {});
  bool lines_failed() const { return lines_failed_; }

  bench_lines& lines() { return lines_; }
  const bench_limits& limits() const { return limits_; }
  bench_counters& counters() { return counters_; }

 private:
  template <class Wanted>
  status wait_for(Wanted wanted, uint64_t limit_ns, bench_exit otherwise);
  status called(status s);  // every call of a line passes through here
  status set(const bench::control_lines& c);
  status settle();
  status send(uint8_t byte, bool first);
  status send_bits(uint8_t bits, bool first);
  status receive(uint8_t& byte, bool first);
  status receive_bits(uint8_t& bits, bool first);
  status send_request();
  status receive_answer();
  status judge(uint8_t command, uint32_t session);
  status attempt(uint8_t command, uint32_t session);
  void let_go();

  bench_lines& lines_;
  bench_limits limits_;
  bench_counters counters_;
  bench::control_lines control_{};
  request request_;
  answer answer_;
  bench::result code_ = bench::result::ok;
  uint8_t sequence_ = 0;
  uint64_t deadline_ns_ = 0;
  bool lines_failed_ = false, control_known_ = false;
  std::string trouble_;
};

}  // namespace spantex
