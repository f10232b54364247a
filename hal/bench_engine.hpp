// SPDX-License-Identifier: Apache-2.0
// The bench backend: a span engine at the other end of wires (docs/BENCH.md). Host only.
//
//   operation -> command frame -> bench_link -> bench_lines ======== wires ======== device
//
// What the device was given is remembered here, so that a device that lost it (reset, power, cable) gets it again: the link is reset, the device
// identified, a new session opened, both halves restored, and the operation done again. Pixels depend on nothing else, so they are the same.
// Where that does not help within the limits, the operation reports device_error or device_timeout, and every half that held something is empty and
// says so once: the other one by device_error at its next operation.
#pragma once
#include <stdint.h>

#include <array>
#include <bitset>
#include <functional>
#include <string>

#include <hal/bench_link.hpp>
#include <hal/engine.hpp>
#include <hal/operation.hpp>

namespace spantex {

class bench_engine {
 public:
  // An operation as it was on the wires.
  struct slice {
    operation what;
    half which;
    int words;  // load_words
    uint64_t begin_ns, end_ns;
    status result;
    event note;  // mark
  };
  using observer = std::function<void(const slice&)>;

  // The lines must outlive the engine. `seed` makes the numbers of sessions: another one for each process.
  bench_engine(bench_lines& lines, const profile& wanted, const bench_limits& limits = {}, uint32_t seed = 1);

  // Resets the device, identifies it and opens a session; operations do so themselves if need be. Errors: device_error, device_timeout; mismatch:
  // another version or profile.
  status connect();
  status identify(bench::identity& out);
  status read_device_status(bench::device_status& out);
  // Bytes go to the device and come back as their complements. Errors: device_error (others came back), device_timeout.
  status loop_back(const uint8_t* bytes, int count);
  // The device's halves are emptied; the lines become inputs.
  void close();

  status load_coefficients(half h, const span_coefficients& c);
  status load_words(half h, int first, const uint64_t* words, int count);
  status start(half h, span_mask mask);
  status take(half h, span_pixels& out);
  void mark(event what);

  void observe(observer o) { observer_ = std::move(o); }
  const bench_counters& counters() { return link_.counters(); }
  const std::string& trouble() const { return link_.trouble(); }
  int word_count() const { return word_count_; }

 private:
  static constexpr int most_words = 640;

  // What a half of the device holds.
  struct memory {
    std::array<uint64_t, most_words> words{};
    std::bitset<most_words> known;
    span_coefficients coefficients{};
    span_mask mask = 0;
    bool loaded = false, started = false;
    bool empty() const { return known.none() && !loaded && !started; }
  };

  template <class Fill>
  status exchange(bench::command what, Fill fill);
  template <class Fill>
  status command(half h, bench::command what, Fill fill);
  template <class Call>
  status timed(operation what, half h, int words, Call call);
  status open_session();
  status check(const bench::identity& d);
  status restore(half h);
  status ready_for(half h);
  status read_pixels(half h, span_pixels& out);
  status lost(half h, status why);

  bench_link link_;
  profile wanted_;
  int word_count_, burst_words_ = 0;
  uint32_t session_ = 0, next_session_;
  bool connected_ = false, whole_identity_ = false;
  memory memory_[half_count];
  bool unreported_[half_count] = {};  // emptied by another half's failure
  bool dirty_[half_count] = {};       // to be aborted on the device before it is used again
  observer observer_;
};

static_assert(span_engine<bench_engine>);

}  // namespace spantex
