// SPDX-License-Identifier: Apache-2.0
// libFuzzer: bytes of a host that may say anything, to a device. The first byte of the input chooses; see below. The device must not crash, must answer in
// bounded time, and must never execute what is not sealed: the engine behind it counts, and an honest receiver here says what was well-formed.
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <firmware/bench/responder.hpp>

using namespace spantex;

namespace {

// An engine that only counts what it is asked to do.
struct counting_engine {
  int calls = 0;
  status load_coefficients(half, const span_coefficients&) { ++calls; return status::ok; }
  status load_words(half, int first, const uint64_t* words, int count) {
    ++calls;
    if (first < 0 || count < 0 || count > 64 || first + count > 40) abort();
    uint64_t sum = 0;
    for (int k = 0; k < count; ++k) sum ^= words[k];
    return sum == 1 ? status::device_error : status::ok;
  }
  status start(half, span_mask) { ++calls; return status::ok; }
  status take(half, span_pixels& out) { out = {}; return status::ok; }
  void mark(event) {}
};

using word_lengths = fixed_profile<profiles::seed>;
using device = bench::responder<counting_engine, word_lengths>;
using receiver = bench::frame_receiver<device::most_request_bytes>;

// Reads an answer whole; it must be a frame.
void read_answer(device& d) {
  bench::frame_receiver<device::most_answer_bytes> answer;
  answer.begin();
  int n = 0;
  for (bool first = true; answer.state() == bench::frame_state::receiving; first = false, ++n) answer.take(d.answer(first));
  if (answer.state() != bench::frame_state::complete) abort();
}

constexpr uint32_t session = 0x1234567;

void open_session(device& d) {
  bench::frame_builder<256> open;
  bench::field_writer out = open.payload();
  bench::profile_fields fields = bench::fields_of(profiles::seed);
  out(bench::protocol_version);
  out(session);
  bench::archive(out, fields);
  open.finish(uint8_t(bench::command::open), 0, 0, out.size());
  for (int k = 0; k < open.size(); ++k) d.receive(open.byte(k), k == 0);
  if (d.error()) abort();
}

}  // namespace

// Raw: each pair of bytes is one of the wires: bit 0 of the first, the byte is the first of a frame; bit 1, it is read instead; the second, the byte.
// Framed: command, length, payload; sealed rightly, so that the commands themselves are reached.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  counting_engine engine;
  device d(engine);
  if (size == 0) return 0;
  const bool framed = (data[0] & 1) != 0;
  if ((data[0] & 2) != 0) open_session(d);
  ++data, --size;
  if (!framed) {
    receiver honest;
    int executed = 0;
    for (size_t k = 0; k + 1 < size; k += 2) {
      if ((data[k] & 2) != 0) { (void)d.answer((data[k] & 1) != 0); honest.forget(); continue; }
      if ((data[k] & 1) != 0) honest.begin();
      if (honest.take(data[k + 1]) == bench::frame_state::complete) {
        executed += honest.sealed_with(session) || honest.sealed_with(0);
        honest.forget();
      }
      d.receive(data[k + 1], (data[k] & 1) != 0);
      if (engine.calls > 2 * executed) abort();  // a wrong acceptance
      if ((data[k] & 4) != 0) d.work();
    }
  } else {
    uint8_t sequence = 1;
    while (size >= 2) {
      bench::frame_builder<1024> frame;
      bench::field_writer out = frame.payload();
      const uint8_t what = data[0];
      const size_t wanted = data[1] * size_t(3), n = wanted < size - 2 ? wanted : size - 2;
      for (size_t k = 0; k < n; ++k) out(data[2 + k]);
      const bool open = what == uint8_t(bench::command::identify) || what == uint8_t(bench::command::open) || what == uint8_t(bench::command::loop_back);
      frame.finish(what, sequence++, open ? 0 : session, out.size());
      for (int k = 0; k < frame.size(); ++k) d.receive(frame.byte(k), k == 0);
      if ((n & 1) != 0) d.work();
      data += 2 + n;
      size -= 2 + n;
      read_answer(d);
    }
  }
  read_answer(d);
  return 0;
}
