// SPDX-License-Identifier: Apache-2.0
// What the device does with frames (docs/BENCH.md): executes each command once, keeps its answer, and gives that answer again when the same frame
// comes again. Constant memory; the longest single step is the pixels of one span.
//
// Behind it stands any span engine. The responder keeps the life of each half itself, so that the engine is only called legally.
#pragma once
#include <stdint.h>

#include <firmware/bench/coefficient_ranges.hpp>
#include <firmware/bench/frame.hpp>
#include <firmware/bench/wire.hpp>
#include <hal/engine.hpp>

namespace spantex::bench {

// BurstWords: most words that one load_words may bring; they wait in memory until their checksums are known to be right.
template <span_engine Engine, class Prof, int BurstWords = 64>
class responder {
 public:
  static constexpr int words_header_bytes = 1 + 4 + 4 + 2;
  static constexpr int most_request_bytes = max_of(words_header_bytes + 8 * BurstWords, 1 + coefficient_bytes);
  static constexpr int most_answer_bytes = 1 + most_pixel_bytes;

  // The engine must outlive the responder and be used by nobody else.
  constexpr explicit responder(Engine& engine, const Prof& prof = {}) : engine_(engine), prof_(prof) {
    refuse_quietly();
    counts_ = {};
  }

  constexpr void receive(uint8_t byte, bool first) {
    if (first) request_.begin();
    const frame_state before = request_.state();
    const frame_state now = request_.take(byte);
    if (before != frame_state::receiving || now == frame_state::receiving) return;
    if (now == frame_state::bad) return refuse(request_.fault());
    accept();
  }

  constexpr uint8_t answer(bool first) {
    if (request_.state() == frame_state::receiving) refuse(result::incomplete);
    if (first) at_ = 0;
    const int at = at_;
    if (at_ < most_answer_bytes + frame_overhead_bytes) ++at_;
    if (refused_ || !has_executed_) return at < refusal_.size() ? refusal_.byte(at) : 0;
    return at < answer_.size() ? answer_.byte(at) : 0;
  }

  // Takes the pixels of a started half from the engine.
  constexpr bool work() {
    for (int k = 0; k < half_count; ++k)
      if (halves_[k].started && !halves_[k].computed) {
        halves_[k].outcome = engine_.take(half(k), halves_[k].pixels);
        halves_[k].computed = true;
        return true;
      }
    return false;
  }

  constexpr void reset() {
    empty(0xFF);
    session_ = 0;
    has_executed_ = false;
    request_.forget();
    answer_.clear();
    refuse_quietly();
    counts_ = {};
  }

  constexpr bool busy() const {
    return (halves_[0].started && !halves_[0].computed) || (halves_[1].started && !halves_[1].computed);
  }
  constexpr bool error() const { return refused_; }

 private:
  struct one_half {
    bool loaded = false, started = false, computed = false, partial = false;
    span_mask mask = 0;
    status outcome = status::ok;
    span_pixels pixels{};
  };

  static constexpr bool needs_session(uint8_t what) {
    return what != uint8_t(command::identify) && what != uint8_t(command::open) && what != uint8_t(command::loop_back);
  }

  constexpr void accept() {
    const uint32_t session = needs_session(request_.command()) ? session_ : 0;
    if (!request_.sealed_with(session) || (needs_session(request_.command()) && session_ == 0)) return refuse(result::bad_seal);
    refused_ = false;
    if (has_executed_ && request_.command() == executed_command_ && request_.sequence() == executed_sequence_ && request_.seal() == executed_seal_) {
      ++counts_.frames_repeated;
      return;
    }
    ++counts_.frames_accepted;
    executed_command_ = request_.command();
    executed_sequence_ = request_.sequence();
    executed_seal_ = request_.seal();
    has_executed_ = true;
    field_writer out = answer_.payload();
    out(uint8_t(result::ok));
    const result r = execute(out);
    field_writer code = answer_.payload();
    code(uint8_t(r));
    answer_.finish(uint8_t(executed_command_ | answer_bit), executed_sequence_, session, r == result::ok ? out.size() : code.size());
  }

  constexpr void refuse(result why) {
    ++counts_.frames_refused;
    refused_ = true;
    request_.forget();
    field_writer out = refusal_.payload();
    out(uint8_t(why));
    refusal_.finish(refusal, 0, 0, out.size());
  }
  // After a reset there is nothing to answer, and nobody did wrong.
  constexpr void refuse_quietly() {
    refuse(result::incomplete);
    refused_ = false;
  }

  constexpr result execute(field_writer& out) {
    field_reader in = request_.fields();
    switch (command(request_.command())) {
      case command::identify: return identify(in, out);
      case command::open: return open(in);
      case command::close: return close(in);
      case command::load_coefficients: return load_coefficients(in);
      case command::load_words: return load_words(in);
      case command::start: return start(in);
      case command::read_status: return read_status(in, out);
      case command::read_span: return read_span(in, out);
      case command::loop_back: return loop_back(in, out);
      case command::abort: return abort(in);
    }
    return result::unknown_command;
  }

  constexpr result identify(field_reader& in, field_writer& out) {
    if (!in.at_end()) return result::bad_payload;
    bench::identity self;
    self.word_count = uint16_t(word_count());
    self.burst_words = BurstWords;
    self.profile = fields_of(prof_.get());
    archive(out, self);
    return result::ok;
  }

  constexpr result open(field_reader& in) {
    uint16_t version = 0;
    uint32_t session = 0;
    profile_fields wanted{};
    in(version);
    in(session);
    archive(in, wanted);
    if (!in.at_end() || session == 0) return result::bad_payload;
    if (version != protocol_version) return result::other_version;
    const profile_fields own = fields_of(prof_.get());
    for (int k = 0; k < profile_field_count; ++k)
      if (wanted.value[k] != own.value[k]) return result::other_profile;
    empty(0xFF);
    session_ = session;
    return result::ok;
  }

  constexpr result close(field_reader& in) {
    if (!in.at_end()) return result::bad_payload;
    empty(0xFF);
    return result::ok;
  }

  // A half by its number in the payload.
  constexpr one_half* half_in(field_reader& in, half& h) {
    in.one_of(h, half::second);
    return in.good() ? &halves_[int(h)] : nullptr;
  }

  constexpr result load_coefficients(field_reader& in) {
    half h{};
    one_half* x = half_in(in, h);
    span_coefficients c{};
    spantex::detail::archive(in, c);
    if (x == nullptr || !in.at_end()) return result::bad_payload;
    if (x->started) return result::half_busy;
    if (!coefficients_in_range(prof_.get(), c)) return result::bad_coefficients;
    const status s = engine_.load_coefficients(h, c);
    x->loaded = s == status::ok;
    x->partial = c.axis.partial;
    return to_result(s);
  }

  constexpr result load_words(field_reader& in) {
    half h{};
    one_half* x = half_in(in, h);
    int32_t first = 0, count = 0;
    uint16_t offset = 0;
    in(first);
    in(count);
    in(offset);
    if (x == nullptr || !in.good() || in.left() % 8 != 0) return result::bad_payload;
    if (x->started) return result::half_busy;
    if (first < 0 || count < 0 || first > word_count() || count > word_count() - first) return result::bad_address;
    const int here = in.left() / 8;
    if (here > BurstWords || offset > count || here > count - offset) return result::bad_payload;
    for (int k = 0; k < here; ++k) in(words_[k]);
    return to_result(engine_.load_words(h, first + offset, words_, here));
  }

  constexpr result start(field_reader& in) {
    half h{};
    one_half* x = half_in(in, h);
    span_mask mask = 0;
    in(mask);
    if (x == nullptr || !in.at_end()) return result::bad_payload;
    if (x->started) return result::half_busy;
    if (!x->loaded) return result::half_not_loaded;
    const status s = engine_.start(h, mask);
    if (s != status::ok) return to_result(s);
    x->mask = mask;
    x->started = true;
    x->computed = false;
    return result::ok;
  }

  constexpr result read_span(field_reader& in, field_writer& out) {
    half h{};
    one_half* x = half_in(in, h);
    if (x == nullptr || !in.at_end()) return result::bad_payload;
    if (!x->started) return result::half_not_started;
    if (!x->computed) return result::pending;
    x->started = x->computed = x->loaded = false;
    if (x->outcome != status::ok) return to_result(x->outcome);
    out(x->mask);
    out(x->partial);
    if (x->partial) {
      spantex::detail::archive(out, x->pixels.sums);
      return result::ok;
    }
    for (span_mask rest = x->mask; rest != 0; rest &= rest - 1) {
      const rgba8 p = x->pixels.pixel[__builtin_ctzll(rest)];
      out(p.r); out(p.g); out(p.b); out(p.a);
    }
    return result::ok;
  }

  constexpr result read_status(field_reader& in, field_writer& out) {
    if (!in.at_end()) return result::bad_payload;
    device_status s = counts_;
    for (int k = 0; k < half_count; ++k) {
      s.started[k] = halves_[k].started;
      s.computed[k] = halves_[k].computed;
    }
    archive(out, s);
    return result::ok;
  }

  constexpr result loop_back(field_reader& in, field_writer& out) {
    if (in.left() > most_answer_bytes - 1) return result::bad_payload;
    for (uint8_t byte = 0; in.left() > 0;) {
      in(byte);
      out(uint8_t(~byte));
    }
    return result::ok;
  }

  constexpr result abort(field_reader& in) {
    uint8_t which = 0;
    in(which);
    if (!in.at_end()) return result::bad_payload;
    empty(which);
    return result::ok;
  }

  // What a half computes is taken and dropped: the engine has no other way to be free again.
  constexpr void empty(uint8_t which) {
    for (int k = 0; k < half_count; ++k) {
      if (((which >> k) & 1) == 0) continue;
      one_half& x = halves_[k];
      if (x.started && !x.computed) (void)engine_.take(half(k), x.pixels);
      x.loaded = x.started = x.computed = false;
    }
  }

  static constexpr int word_count() { return local_memory<Prof::max_fine_side>::word_count; }

  Engine& engine_;
  [[no_unique_address]] Prof prof_;
  one_half halves_[half_count];
  frame_receiver<most_request_bytes> request_;
  frame_builder<most_answer_bytes> answer_;
  frame_builder<1> refusal_;
  uint64_t words_[BurstWords] = {};
  device_status counts_{};
  uint32_t session_ = 0, executed_seal_ = 0;
  uint8_t executed_command_ = 0, executed_sequence_ = 0;
  bool has_executed_ = false, refused_ = false;
  int at_ = 0;
};

}  // namespace spantex::bench
