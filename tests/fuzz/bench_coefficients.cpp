// SPDX-License-Identifier: Apache-2.0
// libFuzzer: coefficients, words and masks that any host may send, sealed rightly, to a device with the real engine behind it. What the device accepts is
// computed: under the sanitizers and with every trusted width checked (SPANTEX_CHECK_TRUST), so nothing leaves its memory, its type or its loop.
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <firmware/bench/responder.hpp>
#include <hal/direct_engine.hpp>

using namespace spantex;

namespace {

constexpr uint32_t session = 0x1234567;

template <profile P>
class device {
 public:
  using engine_type = direct_engine<fixed_profile<P>>;
  using responder_type = bench::responder<engine_type, fixed_profile<P>>;
  static constexpr int fields = bench::coefficient_bytes, words_at_most = 16;

  device() {
    say(bench::command::open, 0, [](auto& out) {
      bench::profile_fields own = bench::fields_of(P);
      out(bench::protocol_version);
      out(session);
      bench::archive(out, own);
    });
    if (code() != bench::result::ok) abort();
  }

  // Coefficients, mask, then words.
  void feed(const uint8_t* data, size_t size) {
    uint8_t coefficients[fields] = {};
    memcpy(coefficients, data, size < sizeof coefficients ? size : sizeof coefficients);
    data += size < sizeof coefficients ? size : sizeof coefficients;
    size -= size < sizeof coefficients ? size : sizeof coefficients;
    const uint8_t first = size > 0 ? data[0] : 0, pixels = size > 1 ? data[1] : 0;
    say(bench::command::load_words, session, [&](auto& out) {
      out(uint8_t(0));
      out(int32_t(first) - 64);
      out(int32_t(size / 8));
      out(uint16_t(0));
      for (size_t k = 0; k < size / 8 && k < words_at_most; ++k) {
        uint64_t word = 0;
        memcpy(&word, data + 8 * k, 8);
        out(word);
      }
    });
    say(bench::command::load_coefficients, session, [&](auto& out) {
      out(uint8_t(0));
      for (uint8_t byte : coefficients) out(byte);
    });
    const bool accepted = code() == bench::result::ok;
    // Three pixels at the most: a corner and two that the input chooses.
    say(bench::command::start, session, [&](auto& out) {
      out(uint8_t(0));
      out(uint64_t(1) << 63 | uint64_t(1) << (pixels & 63) | uint64_t(1) << (first & 63));
    });
    if ((code() == bench::result::ok) != accepted) abort();
    while (responder_.work()) {}
    say(bench::command::read_span, session, [](auto& out) { out(uint8_t(0)); });
    if ((code() == bench::result::ok) != accepted) abort();
    say(bench::command::abort, session, [](auto& out) { out(uint8_t(0xFF)); });
  }

 private:
  template <class Fill>
  void say(bench::command what, uint32_t of, Fill fill) {
    bench::frame_builder<1024> frame;
    bench::field_writer out = frame.payload();
    fill(out);
    frame.finish(uint8_t(what), sequence_++, of, out.size());
    for (int k = 0; k < frame.size(); ++k) responder_.receive(frame.byte(k), k == 0);
    answer_.begin();
    for (bool first = true; answer_.state() == bench::frame_state::receiving; first = false) answer_.take(responder_.answer(first));
    if (answer_.state() != bench::frame_state::complete || !answer_.sealed_with(of)) abort();
  }
  bench::result code() const { return bench::result(answer_.payload()[0]); }

  engine_type engine_;
  responder_type responder_{engine_};
  bench::frame_receiver<responder_type::most_answer_bytes> answer_;
  uint8_t sequence_ = 0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static device<profiles::seed> seed;
  static device<profiles::compact> compact;
  static device<profiles::standard> standard;
  static device<profiles::exact> exact;
  if (size == 0) return 0;
  switch (data[0] % 4) {
    case 0: seed.feed(data + 1, size - 1); break;
    case 1: compact.feed(data + 1, size - 1); break;
    case 2: standard.feed(data + 1, size - 1); break;
    default: exact.feed(data + 1, size - 1); break;
  }
  return 0;
}
