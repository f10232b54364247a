// SPDX-License-Identifier: Apache-2.0
// What the suites on the bench share: a short job whose every pixel is known, run over wires that go wrong, and the verdict on it; devices that lie.
#pragma once
#include "tests/engines.hpp"

namespace spantex::sim {

// Two halves in turn, texels used again after a take: whatever a half loses shows in some pixel.
inline constexpr int job_words = 8;
inline constexpr span_mask job_mask = 0x0303;  // these read texels of the first eight words

inline span_pixels job_pixels(const some_words& texels, int32_t shift) {
  local_memory<8> memory;
  span_pixels out{};
  if (memory.load(0, texels.word, job_words) != status::ok) std::abort();
  compute_span(prof{}, reading(shift), job_mask, memory, out, no_observer{});
  return out;
}

struct job_result {
  status first_failure = status::ok;
  bool wrong_pixel = false;
};

// One half's take, judged.
inline status judged_take(bench_engine& e, half h, const span_pixels& wanted, job_result& r) {
  span_pixels got{};
  SPANTEX_TRY(e.take(h, got));
  for (span_mask rest = job_mask; rest != 0; rest &= rest - 1) {
    const int k = __builtin_ctzll(rest);
    if (!(got.pixel[k] == wanted.pixel[k])) r.wrong_pixel = true;
  }
  return status::ok;
}

inline status run_job_once(bench_engine& e, job_result& r) {
  static const span_pixels red_0 = job_pixels(red, 0), red_1 = job_pixels(red, 1), blue_1 = job_pixels(blue, 1);
  constexpr half a = half::first, b = half::second;
  SPANTEX_TRY(e.load_words(a, 0, red.word, job_words));
  SPANTEX_TRY(e.load_coefficients(a, reading(0)));
  SPANTEX_TRY(e.start(a, job_mask));
  SPANTEX_TRY(e.load_words(b, 0, blue.word, job_words));
  SPANTEX_TRY(e.load_coefficients(b, reading(1)));
  SPANTEX_TRY(e.start(b, job_mask));
  SPANTEX_TRY(judged_take(e, a, red_0, r));
  SPANTEX_TRY(e.load_coefficients(a, reading(1)));
  SPANTEX_TRY(e.start(a, job_mask));
  SPANTEX_TRY(judged_take(e, b, blue_1, r));
  return judged_take(e, a, red_1, r);
}

// The job; after a failure both halves are told to start over, as a caller would, and the job is tried again.
inline job_result run_job(bench_engine& e) {
  job_result r;
  r.first_failure = run_job_once(e, r);
  for (int k = 0; k < 3 && r.first_failure != status::ok; ++k) {
    span_pixels dropped{};
    for (half h : halves) (void)e.take(h, dropped);
    if (run_job_once(e, r) == status::ok) break;
  }
  return r;
}

// Everything a device says passes through a lie. Answers are taken whole from an honest responder, changed, and sealed again where the lie wants it.
enum class lie : uint8_t {
  none, wrong_crc, wrong_seal, another_sequence, another_command, unknown_code, too_long, not_spantex, newer_version, other_coefficients, other_profile,
  no_burst, open_refused, other_mask, partial_pixels, short_pixels, always_pending, engine_fails, engine_times_out, error_line_high, busy_line_high,
  refuses_incomplete, refuses_length, refuses_crc, refuses_seal, refuses_coefficients, fewer_fields, more_fields
};
inline constexpr int lie_count = int(lie::more_fields) + 1;

class lying_responder {
 public:
  lying_responder(direct& engine, const prof& p) : honest_(engine, p) {}

  lie told = lie::none;
  int field = 0;  // of the profile: lie::other_profile
  int from_answer = 0, answers = 1 << 30;  // which answers are lies

  void receive(uint8_t byte, bool first) {
    if (first) request_.begin();
    if (request_.take(byte) == bench::frame_state::complete && request_.command() == uint8_t(bench::command::open)) {
      bench::field_reader in = request_.fields();
      uint16_t version = 0;
      in(version);
      in(session_);
    }
    honest_.receive(byte, first);
  }
  uint8_t answer(bool first) {
    if (first) make_answer();
    return at_ < size_ ? bytes_[at_++] : 0;
  }
  bool work() { return honest_.work(); }
  void reset() {
    honest_.reset();
    size_ = at_ = 0;
  }
  bool busy() const { return honest_.busy() || (lies() && told == lie::busy_line_high && begun_ > 4); }
  bool error() const { return honest_.error() || (lies() && told == lie::error_line_high && begun_ > 0); }

 private:
  bool lies() const { return begun_ >= from_answer && begun_ - from_answer < answers; }

  void make_answer() {
    size_ = at_ = 0;
    bench::frame_receiver<bench_link::most_answer_bytes> whole;
    whole.begin();
    for (bool first = true; whole.state() == bench::frame_state::receiving; first = false) whole.take(bytes_[size_++] = honest_.answer(first));
    ++begun_;
    if (lies() && whole.state() == bench::frame_state::complete) change(whole);
  }

  void seal_again(int payload_bytes) {
    const uint8_t what = bytes_[0] & 0x7F;
    const bool open = what == uint8_t(bench::command::identify) || what == uint8_t(bench::command::open) || bytes_[0] == bench::refusal;
    bench::frame_builder<bench_link::most_answer_bytes> frame;
    bench::field_writer out = frame.payload();
    for (int k = 0; k < payload_bytes; ++k) out(bytes_[bench::frame_header_bytes + k]);
    frame.finish(bytes_[0], bytes_[1], open ? 0 : session_, payload_bytes);
    for (size_ = 0; size_ < frame.size(); ++size_) bytes_[size_] = frame.byte(size_);
  }

  void refuse(bench::result why) {
    bytes_[0] = bench::refusal;
    bytes_[4] = uint8_t(why);
    seal_again(1);
  }

  template <class Frame>
  void change(const Frame& whole) {
    using bench::command;
    uint8_t* const payload = bytes_ + bench::frame_header_bytes;
    const auto is = [&](command c) { return bytes_[0] == (uint8_t(c) | bench::answer_bit); };
    const int n = whole.payload_bytes();
    const bool pixels = is(command::read_span) && payload[0] == 0;
    switch (told) {
      case lie::none: case lie::error_line_high: case lie::busy_line_high: break;
      case lie::wrong_crc: bytes_[size_ - 1] ^= 1; break;
      case lie::wrong_seal: {
        bench::crc16 crc;
        bytes_[size_ - 3] ^= 1;
        for (int k = 0; k < size_ - 2; ++k) crc.add(bytes_[k]);
        bytes_[size_ - 2] = uint8_t(crc.value >> 8);
        bytes_[size_ - 1] = uint8_t(crc.value);
        break;
      }
      case lie::another_sequence: ++bytes_[1]; seal_again(n); break;
      case lie::another_command: if (is(command::start)) { bytes_[0] = uint8_t(command::abort) | bench::answer_bit; seal_again(n); } break;
      case lie::unknown_code: payload[0] = 200; seal_again(n); break;
      case lie::too_long: bytes_[3] = 0x7F; break;
      case lie::not_spantex: if (is(command::identify)) { payload[1] ^= 1; seal_again(n); } break;
      case lie::newer_version: if (is(command::identify)) { payload[5] += 1; seal_again(n); } break;
      case lie::other_coefficients: if (is(command::identify)) { payload[7] += 1; seal_again(n); } break;
      case lie::no_burst: if (is(command::identify)) { payload[11] = payload[12] = 0; seal_again(n); } break;
      case lie::other_profile: if (is(command::identify)) { payload[13 + 2 * field] ^= 1; seal_again(n); } break;
      case lie::fewer_fields: if (is(command::identify)) seal_again(n - 2); break;
      case lie::more_fields: if (is(command::identify)) seal_again(n + 2); break;
      case lie::open_refused: if (is(command::open)) { payload[0] = uint8_t(bench::result::other_profile); seal_again(1); } break;
      case lie::other_mask: if (pixels) { payload[1] ^= 1; seal_again(n - 4); } break;
      case lie::partial_pixels: if (pixels) { payload[9] = 1; seal_again(n); } break;
      case lie::short_pixels: if (pixels) seal_again(n - 1); break;
      case lie::always_pending: if (is(command::read_span)) { payload[0] = uint8_t(bench::result::pending); seal_again(1); } break;
      case lie::engine_fails: if (is(command::start)) { payload[0] = uint8_t(bench::result::engine_error); seal_again(1); } break;
      case lie::engine_times_out: if (is(command::read_span)) { payload[0] = uint8_t(bench::result::engine_timeout); seal_again(1); } break;
      case lie::refuses_coefficients: if (is(command::load_coefficients)) { payload[0] = uint8_t(bench::result::bad_payload); seal_again(1); } break;
      case lie::refuses_incomplete: refuse(bench::result::incomplete); break;
      case lie::refuses_length: refuse(bench::result::bad_length); break;
      case lie::refuses_crc: refuse(bench::result::bad_crc); break;
      case lie::refuses_seal: refuse(bench::result::bad_seal); break;
    }
  }

  bench::responder<direct, prof> honest_;
  bench::frame_receiver<1024> request_;
  uint8_t bytes_[1024] = {};
  uint32_t session_ = 0;
  int size_ = 0, at_ = 0, begun_ = 0;
};

}  // namespace spantex::sim
