// SPDX-License-Identifier: Apache-2.0
#include "bench_link.hpp"

#include <algorithm>

namespace spantex {

using bench::command;
using bench::result;

const char* to_string(bench_exit e) {
  switch (e) {
    case bench_exit::line_failed: return "a line could not be read or set";
    case bench_exit::interrupted: return "interrupted";
    case bench_exit::ready_stuck: return "ready is high before the clock rises";
    case bench_exit::ready_did_not_rise: return "ready does not rise";
    case bench_exit::ready_did_not_fall: return "ready does not fall";
    case bench_exit::exchange_too_long: return "the exchange takes too long";
    case bench_exit::answer_too_long: return "the answer has an impossible length";
    case bench_exit::answer_bad_crc: return "the answer's CRC-16 does not match";
    case bench_exit::answer_bad_seal: return "the answer's seal does not match";
    case bench_exit::answer_of_another: return "the answer is that of another command";
    case bench_exit::answer_with_error_line: return "the error line is high beside a good answer";
    case bench_exit::refused_incomplete: return "the device received an incomplete frame";
    case bench_exit::refused_length: return "the device received an impossible length";
    case bench_exit::refused_crc: return "the device received a frame with a wrong CRC-16";
    case bench_exit::refused_seal: return "the device has another session, or received a damaged frame";
    case bench_exit::answer_malformed: return "the answer is not what the command asks for";
    case bench_exit::reset_not_entered: return "the device does not react to reset";
    case bench_exit::reset_not_left: return "the device does not leave reset";
    case bench_exit::busy_too_long: return "busy does not fall";
    case bench_exit::compute_too_long: return "the span is not finished in time";
    case bench_exit::not_a_device: return "what answers is not a spantex device";
    case bench_exit::other_version: return "the device speaks another version";
    case bench_exit::other_profile: return "the device has another profile";
    case bench_exit::device_refused: return "the device's engine refused";
  }
  return "unknown";
}

status bench_link::gave_up(bench_exit why, status as, const std::string& more) {
  ++counters_.exits[size_t(why)];
  trouble_ = to_string(why);
  if (!more.empty()) trouble_ += ": " + more;
  return as;
}

status bench_link::called(status s) {
  ++counters_.line_calls;
  if (lines_.interrupted()) return gave_up(bench_exit::interrupted, status::device_error, lines_.trouble());
  if (s == status::ok || s == status::device_timeout) return s;
  lines_failed_ = true;
  control_known_ = false;
  return gave_up(bench_exit::line_failed, status::device_error, lines_.trouble());
}

status bench_link::set(const bench::control_lines& c) {
  if (control_known_ && c == control_) return status::ok;
  control_known_ = false;  // if this fails
  SPANTEX_TRY(called(lines_.set_control(c)));
  control_ = c;
  control_known_ = true;
  return status::ok;
}

template <class Wanted>
status bench_link::wait_for(Wanted wanted, uint64_t limit_ns, bench_exit otherwise) {
  const uint64_t begun = lines_.now_ns(), step_end = begun + limit_ns, end = std::min(step_end, deadline_ns_);
  if (begun >= deadline_ns_) return gave_up(bench_exit::exchange_too_long, status::device_timeout);
  for (;;) {
    bench::status_lines s;
    SPANTEX_TRY(called(lines_.read_status(s)));
    if (wanted(s)) return status::ok;
    const uint64_t now = lines_.now_ns();
    if (now >= end) return gave_up(end == step_end ? otherwise : bench_exit::exchange_too_long, status::device_timeout);
    if (now - begun < limits_.spin_ns) continue;
    const status waited = called(lines_.wait_edge(end - now));
    if (waited != status::ok && waited != status::device_timeout) return waited;
  }
}

// --- handshakes ----------------------------------------------------------------------------------------

// The data lines are only driven while ready is low and the direction is to the device: then the device does not drive them.
status bench_link::send_bits(uint8_t bits, bool first) {
  SPANTEX_TRY(called(lines_.drive_data(bits)));
  SPANTEX_TRY(set({.command = first}));
  SPANTEX_TRY(set({.clock = true, .command = first}));
  SPANTEX_TRY(wait_for([](const auto& s) { return s.ready; }, limits_.step_ns, bench_exit::ready_did_not_rise));
  SPANTEX_TRY(set({.command = first}));
  return wait_for([](const auto& s) { return !s.ready; }, limits_.step_ns, bench_exit::ready_did_not_fall);
}

status bench_link::send(uint8_t byte, bool first) {
  ++counters_.bytes_out;
  if (lines_.data_bits() == 8) return send_bits(byte, first);
  SPANTEX_TRY(send_bits(byte & 15, first));
  return send_bits(byte >> 4, false);
}

status bench_link::receive_bits(uint8_t& bits, bool first) {
  SPANTEX_TRY(set({.to_host = true, .command = first}));
  SPANTEX_TRY(set({.clock = true, .to_host = true, .command = first}));
  SPANTEX_TRY(wait_for([](const auto& s) { return s.ready; }, limits_.step_ns, bench_exit::ready_did_not_rise));
  SPANTEX_TRY(called(lines_.read_data(bits)));
  SPANTEX_TRY(set({.to_host = true, .command = first}));
  return wait_for([](const auto& s) { return !s.ready; }, limits_.step_ns, bench_exit::ready_did_not_fall);
}

status bench_link::receive(uint8_t& byte, bool first) {
  ++counters_.bytes_in;
  if (lines_.data_bits() == 8) return receive_bits(byte, first);
  uint8_t low = 0, high = 0;
  SPANTEX_TRY(receive_bits(low, first));
  SPANTEX_TRY(receive_bits(high, false));
  byte = uint8_t((low & 15) | high << 4);
  return status::ok;
}

// Nothing is driven, the clock is low, and the device has seen it.
status bench_link::settle() {
  SPANTEX_TRY(called(lines_.release_data()));
  SPANTEX_TRY(set({}));
  return wait_for([](const auto& s) { return !s.ready; }, limits_.step_ns, bench_exit::ready_stuck);
}

// After a failure: what can be let go is let go, whatever that says.
void bench_link::let_go() {
  (void)lines_.release_data();
  control_known_ = lines_.set_control({}) == status::ok;
  control_ = {};
}

status bench_link::reset() {
  ++counters_.resets;
  deadline_ns_ = lines_.now_ns() + limits_.exchange_ns;
  const auto through = [&]() -> status {
    SPANTEX_TRY(called(lines_.release_data()));
    control_known_ = false;
    SPANTEX_TRY(set({.reset = true}));
    SPANTEX_TRY(wait_for([](const auto& s) { return !s.ready && !s.busy && !s.error; }, limits_.step_ns, bench_exit::reset_not_entered));
    SPANTEX_TRY(set({.command = true, .reset = true}));
    SPANTEX_TRY(wait_for([](const auto& s) { return s.busy; }, limits_.step_ns, bench_exit::reset_not_entered));
    SPANTEX_TRY(set({.command = true}));
    SPANTEX_TRY(wait_for([](const auto& s) { return !s.busy; }, limits_.step_ns, bench_exit::reset_not_left));
    return set({});
  };
  const status s = through();
  if (s != status::ok) let_go();
  return s;
}

// --- frames --------------------------------------------------------------------------------------------

status bench_link::send_request() {
  SPANTEX_TRY(settle());
  for (int k = 0; k < request_.size(); ++k) SPANTEX_TRY(send(request_.byte(k), k == 0));
  return called(lines_.release_data());
}

status bench_link::receive_answer() {
  answer_.begin();
  for (bool first = true; answer_.state() == bench::frame_state::receiving; first = false) {
    uint8_t byte = 0;
    SPANTEX_TRY(receive(byte, first));
    answer_.take(byte);
  }
  if (answer_.state() == bench::frame_state::complete) return status::ok;
  return gave_up(answer_.fault() == result::bad_length ? bench_exit::answer_too_long : bench_exit::answer_bad_crc, status::device_error);
}

// Whether a whole answer is this command's.
status bench_link::judge(uint8_t command, uint32_t session) {
  uint8_t code = uint8_t(bench::last_result) + 1;
  if (answer_.payload_bytes() > 0) code = answer_.payload()[0];
  const auto refuse = [&](bench_exit why) { return gave_up(why, status::device_error); };
  if (answer_.command() == bench::refusal && answer_.sealed_with(0)) {
    switch (result(code)) {
      case result::bad_length: return refuse(bench_exit::refused_length);
      case result::bad_crc: return refuse(bench_exit::refused_crc);
      case result::bad_seal: return refuse(bench_exit::refused_seal);
      default: return refuse(bench_exit::refused_incomplete);
    }
  }
  if (!answer_.sealed_with(session)) return refuse(bench_exit::answer_bad_seal);
  if (answer_.command() != (command | bench::answer_bit) || answer_.sequence() != sequence_) return refuse(bench_exit::answer_of_another);
  if (code > uint8_t(bench::last_result)) return refuse(bench_exit::answer_malformed);
  bench::status_lines lines;
  SPANTEX_TRY(called(lines_.read_status(lines)));
  if (lines.error) return refuse(bench_exit::answer_with_error_line);
  code_ = result(code);
  return status::ok;
}

// One request; an answer that came damaged is read once more, since the device still has it.
status bench_link::attempt(uint8_t command, uint32_t session) {
  ++counters_.attempts;
  SPANTEX_TRY(send_request());
  status s = receive_answer();
  if (s == status::device_error && !lines_failed_ && !lines_.interrupted()) {
    ++counters_.rereads;
    s = receive_answer();
  }
  SPANTEX_TRY(s);
  return judge(command, session);
}

status bench_link::exchange(command what, uint32_t session, int payload_bytes) {
  ++counters_.exchanges;
  ++sequence_;
  lines_failed_ = false;
  deadline_ns_ = lines_.now_ns() + limits_.exchange_ns;
  request_.finish(uint8_t(what), sequence_, session, payload_bytes);
  status s = status::ok;
  uint64_t back_off_ns = limits_.back_off_ns;
  for (int k = 0; k < limits_.attempts; ++k) {
    if (k > 0) {
      const uint64_t left_ns = deadline_ns_ - lines_.now_ns();  // more than 0, below
      lines_.pause(std::min(back_off_ns, left_ns));
      back_off_ns = std::min(2 * back_off_ns, limits_.exchange_ns);
    }
    s = attempt(uint8_t(what), session);
    if (s == status::ok) return set({});
    let_go();
    if (lines_.interrupted() || lines_.now_ns() >= deadline_ns_) break;
  }
  return s;
}

bench::field_reader bench_link::fields() const { return {answer_.payload() + 1, answer_.payload_bytes() - 1}; }

status bench_link::wait_while_busy(uint64_t limit_ns) {
  deadline_ns_ = UINT64_MAX;
  return wait_for([](const auto& s) { return !s.busy; }, limit_ns, bench_exit::busy_too_long);
}

}  // namespace spantex
