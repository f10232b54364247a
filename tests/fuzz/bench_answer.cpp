// SPDX-License-Identifier: Apache-2.0
// libFuzzer: bytes of a device that may say anything, to the host's link and engine. The host must not crash, must give up in bounded time, and must never
// take for pixels what was not sealed with its session.
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <hal/bench_engine.hpp>

using namespace spantex;

namespace {

// A device whose handshakes are perfect and whose bytes are the fuzzer's. With `seals`, answers are sealed rightly: the first three bytes of each choose
// code and length, so that the parsers of payloads are reached.
class fuzzed_lines final : public bench_lines {
 public:
  fuzzed_lines(const uint8_t* data, size_t size, bool seals) : data_(data), size_(size), seals_(seals) {}

  int data_bits() const override { return 8; }
  status drive_data(uint8_t v) override { driven_ = v; return tick(); }
  status release_data() override { return tick(); }
  status read_data(uint8_t& v) override {
    v = at_ < answer_.size() ? answer_.byte(at_) : next();
    ++at_;
    return tick();
  }
  status set_control(const bench::control_lines& c) override {
    if (c.clock && !last_.clock && !c.to_host) heard(c.command);
    if (c.clock && !last_.clock && c.to_host && c.command) make_answer();
    last_ = c;
    return tick();
  }
  status read_status(bench::status_lines& s) override {
    s.ready = last_.clock;
    s.busy = last_.reset && last_.command;
    s.error = false;
    return tick();
  }
  status wait_edge(uint64_t ns) override { now_ += ns; return status::device_timeout; }
  void pause(uint64_t ns) override { now_ += ns; }
  uint64_t now_ns() override { return now_; }
  void release_all() override {}
  status reopen() override { return status::ok; }
  std::string trouble() const override { return "fuzzed"; }
  uint64_t calls() const { return calls_; }
  bool sealed_once() const { return sealed_; }

 private:
  uint8_t next() { return taken_ < size_ ? data_[taken_++] : 0; }
  status tick() { ++calls_; now_ += 100; return status::ok; }
  void heard(bool first) {
    if (first) request_.begin();
    if (request_.take(driven_) != bench::frame_state::complete || request_.command() != uint8_t(bench::command::open)) return;
    bench::field_reader in = request_.fields();
    uint16_t version = 0;
    in(version);
    in(session_);
  }
  void make_answer() {
    at_ = 0;
    answer_.clear();
    if (!seals_) return;
    sealed_ = true;
    const uint8_t what = request_.command();
    bench::field_writer out = answer_.payload();
    const uint8_t choice = next();
    if (what == uint8_t(bench::command::identify) && choice < 250) {  // else nothing beyond is reached
      bench::identity d;
      d.word_count = 40;
      d.burst_words = uint16_t(1 + choice % 64);
      d.profile = bench::fields_of(profiles::seed);
      out(uint8_t(0));
      archive(out, d);
    } else {
      out(uint8_t(choice < 200 ? 0 : choice));
      const size_t n = next() * size_t(2);
      for (size_t k = 0; k < n && k < 400; ++k) out(next());
    }
    const bool open = what == uint8_t(bench::command::identify) || what == uint8_t(bench::command::open) || what == uint8_t(bench::command::loop_back);
    answer_.finish(uint8_t(what | 0x80), request_.sequence(), open ? 0 : session_, out.size());
  }

  const uint8_t* data_;
  size_t size_, taken_ = 0;
  bool seals_, sealed_ = false;
  bench::control_lines last_{};
  uint8_t driven_ = 0;
  uint32_t session_ = 0;
  int at_ = 0;
  uint64_t now_ = 0, calls_ = 0;
  bench::frame_receiver<bench_link::most_request_bytes> request_;
  bench::frame_builder<512> answer_;
};

constexpr bench_limits limits{.step_ns = 10'000, .exchange_ns = 2'000'000, .compute_ns = 10'000, .back_off_ns = 100, .attempts = 1, .recoveries = 0};
constexpr uint64_t most_calls = 50'000;

}  // namespace

// The first byte chooses: bit 0, whether answers are sealed rightly; bit 1, whether words are loaded, bit 2, coefficients (their bytes cost most of a run).
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return 0;
  fuzzed_lines lines(data + 1, size - 1, (data[0] & 1) != 0);
  bench_engine engine(lines, profiles::seed, limits);
  span_pixels out{};
  span_coefficients c{};
  const uint64_t words[2] = {1, 2};
  bool taken = false;
  const bool with_words = (data[0] & 2) != 0, with_coefficients = (data[0] & 4) != 0;
  if ((!with_words || engine.load_words(half::first, 0, words, 2) == status::ok) &&
      (!with_coefficients || engine.load_coefficients(half::first, c) == status::ok) && engine.start(half::first, 3) == status::ok)
    taken = engine.take(half::first, out) == status::ok;
  // 48 bits of checksums: a chance hit is not to be expected in a lifetime of runs.
  if (taken && !lines.sealed_once()) abort();
  if (lines.calls() > most_calls) abort();
  engine.close();
  return 0;
}
