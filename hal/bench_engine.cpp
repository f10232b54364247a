// SPDX-License-Identifier: Apache-2.0
#include "bench_engine.hpp"

#include <algorithm>

namespace spantex {

using bench::result;
using bench_command = bench::command;

namespace {

// Words [from, end) of those that go to [first, first + count).
auto words_payload(half h, int first, const uint64_t* words, int count, int from, int end) {
  return [=](bench::field_writer& out) {
    out.one_of(h, half::second);
    out(int32_t(first));
    out(int32_t(count));
    out(uint16_t(from));
    for (int k = from; k < end; ++k) out(words[k]);
  };
}

}  // namespace

bench_engine::bench_engine(bench_lines& lines, const profile& wanted, const bench_limits& limits, uint32_t seed)
    : link_(lines, limits),
      wanted_(wanted),
      word_count_((wanted.fine_side * wanted.fine_side + wanted.coarse_side() * wanted.coarse_side()) * channel_count / 8),
      next_session_(seed) {}

// One command in the session that is open, without recovery. `fill` writes the payload. Ok: the answer is there, its code in link_.code().
template <class Fill>
status bench_engine::exchange(bench_command what, Fill fill) {
  bench::field_writer out = link_.payload();
  fill(out);
  const bool in_session = what != bench_command::identify && what != bench_command::open && what != bench_command::loop_back;
  return link_.exchange(what, in_session ? session_ : 0, out.size());
}

// --- sessions ------------------------------------------------------------------------------------------

// Other versions and libraries may say more, less or other things after the bytes of coefficients: check() tells which.
status bench_engine::identify(bench::identity& out) {
  SPANTEX_TRY(exchange(bench_command::identify, [](auto&) {}));
  bench::field_reader in = link_.fields();
  out = {.magic = 0, .version = 0};
  archive(in, out);
  whole_identity_ = in.at_end();
  if (link_.code() != result::ok || out.magic != bench::identity_magic) return link_.gave_up(bench_exit::not_a_device, status::mismatch);
  return status::ok;
}

status bench_engine::check(const bench::identity& d) {
  const auto differs = [&](bench_exit why, const std::string& what, int theirs, int ours) {
    return link_.gave_up(why, status::mismatch, what + " " + std::to_string(theirs) + ", expected " + std::to_string(ours));
  };
  if (d.version != bench::protocol_version) return differs(bench_exit::other_version, "protocol version", d.version, bench::protocol_version);
  if (d.coefficient_bytes != bench::coefficient_bytes)
    return differs(bench_exit::other_version, "bytes of coefficients", d.coefficient_bytes, bench::coefficient_bytes);
  if (!whole_identity_) return link_.gave_up(bench_exit::other_version, status::mismatch, "its profile has other fields");
  status s = status::ok;
  int n = 0;
  detail::for_each_field(wanted_, [&](const char* name, int value) {
    const int theirs = d.profile.value[n++];
    if (s == status::ok && theirs != value) s = differs(bench_exit::other_profile, name, theirs, value);
  });
  SPANTEX_TRY(s);
  if (d.word_count != word_count_) return differs(bench_exit::other_profile, "words of local memory", d.word_count, word_count_);
  if (d.burst_words < 1) return differs(bench_exit::not_a_device, "words in a burst", d.burst_words, 1);
  burst_words_ = std::min<int>(d.burst_words, (bench_link::most_request_bytes - 16) / 8);
  return status::ok;
}

status bench_engine::open_session() {
  if (link_.lines_failed()) SPANTEX_TRY(link_.lines().reopen() == status::ok ? status::ok : link_.gave_up(bench_exit::line_failed, status::device_error,
                                                                                                       link_.lines().trouble()));
  SPANTEX_TRY(link_.reset());
  bench::identity device;
  SPANTEX_TRY(identify(device));
  SPANTEX_TRY(check(device));
  session_ = ++next_session_ == 0 ? ++next_session_ : next_session_;
  SPANTEX_TRY(exchange(bench_command::open, [&](auto& out) {
    bench::profile_fields fields = bench::fields_of(wanted_);
    out(bench::protocol_version);
    out(session_);
    bench::archive(out, fields);
  }));
  if (link_.code() != result::ok) return link_.gave_up(bench_exit::device_refused, bench::to_status(link_.code()), to_string(link_.code()));
  for (bool& d : dirty_) d = false;
  for (half h : {half::first, half::second}) SPANTEX_TRY(restore(h));
  connected_ = true;
  return status::ok;
}

// Gives a half of a fresh session what it held.
status bench_engine::restore(half h) {
  const memory& m = memory_[int(h)];
  const auto accepted = [&] {
    return link_.code() == result::ok ? status::ok : link_.gave_up(bench_exit::device_refused, status::device_error, to_string(link_.code()));
  };
  for (int k = 0; k < word_count_;) {
    int end = k;
    while (end < word_count_ && end - k < burst_words_ && m.known[size_t(end)]) ++end;
    if (end > k) {
      SPANTEX_TRY(exchange(bench_command::load_words, words_payload(h, k, m.words.data() + k, end - k, 0, end - k)));
      SPANTEX_TRY(accepted());
      link_.counters().restored_words += uint64_t(end - k);
    }
    k = std::max(end, k + 1);
  }
  if (m.loaded) {
    SPANTEX_TRY(exchange(bench_command::load_coefficients, [&](auto& out) {
      span_coefficients c = m.coefficients;
      out.one_of(h, half::second);
      detail::archive(out, c);
    }));
    SPANTEX_TRY(accepted());
  }
  if (m.started) {
    SPANTEX_TRY(exchange(bench_command::start, [&](auto& out) { out.one_of(h, half::second); out(m.mask); }));
    SPANTEX_TRY(accepted());
  }
  return status::ok;
}

status bench_engine::connect() {
  connected_ = false;
  const status s = open_session();
  if (s != status::ok) link_.lines().release_all();
  return s;
}

void bench_engine::close() {
  if (connected_ && !link_.lines().interrupted()) (void)exchange(bench_command::close, [](auto&) {});
  connected_ = false;
  for (half h : {half::first, half::second}) {
    memory_[int(h)] = {};
    unreported_[int(h)] = dirty_[int(h)] = false;
  }
  link_.lines().release_all();
}

// --- commands ------------------------------------------------------------------------------------------

// A command with recovery: where the link fails, everything is opened anew and the command repeated.
template <class Fill>
status bench_engine::command(half h, bench_command what, Fill fill) {
  const bench_limits& limits = link_.limits();
  const uint64_t begun = link_.lines().now_ns();
  constexpr uint64_t longest_back_off_ns = 500'000'000;
  uint64_t back_off_ns = std::min(limits.back_off_ns, longest_back_off_ns);
  for (int k = 0;; ++k) {
    status s = connected_ ? status::ok : open_session();
    if (s == status::ok && dirty_[int(h)]) {
      s = exchange(bench_command::abort, [&](auto& out) { out(uint8_t(1 << int(h))); });
      if (s == status::ok) dirty_[int(h)] = false;
    }
    if (s == status::ok) s = exchange(what, fill);
    if (s == status::ok) return s;
    connected_ = false;
    const bool wait_longer = link_.lines().now_ns() - begun < limits.patience_ns;
    if (s == status::mismatch || link_.lines().interrupted() || (k >= limits.recoveries && !wait_longer)) return lost(h, s);
    ++link_.counters().recoveries;
    link_.lines().pause(back_off_ns);
    back_off_ns = std::min(2 * back_off_ns, longest_back_off_ns);
  }
}

// The device is gone: both halves are empty. Nothing is driven while nobody answers.
status bench_engine::lost(half h, status why) {
  for (half k : {half::first, half::second}) {
    if (k != h && !memory_[int(k)].empty()) unreported_[int(k)] = true;
    memory_[int(k)] = {};
  }
  connected_ = false;
  link_.lines().release_all();
  return why == status::device_timeout ? status::device_timeout : status::device_error;
}

// Whether the half was emptied unheard.
status bench_engine::ready_for(half h) {
  if (!unreported_[int(h)]) return status::ok;
  unreported_[int(h)] = false;
  return status::device_error;
}

// What the device answered is the operation's status; an error of its engine empties the half.
template <class Call>
status bench_engine::timed(operation what, half h, int words, Call call) {
  const uint64_t begin = observer_ ? link_.lines().now_ns() : 0;
  status s = ready_for(h);
  if (s == status::ok) s = call();
  if (s == status::ok && link_.code() != result::ok) {
    s = bench::to_status(link_.code());
    if (s == status::device_error || s == status::device_timeout) {
      (void)link_.gave_up(bench_exit::device_refused, s, to_string(link_.code()));
      memory_[int(h)] = {};
      dirty_[int(h)] = true;
    }
  }
  if (observer_) observer_({what, h, words, begin, link_.lines().now_ns(), s, {}});
  return s;
}

// --- operations ----------------------------------------------------------------------------------------

status bench_engine::load_coefficients(half h, const span_coefficients& c) {
  const status s = timed(operation::load_coefficients, h, 0, [&] {
    return command(h, bench_command::load_coefficients, [&](auto& out) {
      span_coefficients copy = c;
      out.one_of(h, half::second);
      detail::archive(out, copy);
    });
  });
  if (s != status::ok) return s;
  memory_[int(h)].coefficients = c;
  memory_[int(h)].loaded = true;
  return s;
}

status bench_engine::load_words(half h, int first, const uint64_t* words, int count) {
  // What cannot fit is asked without words: the device judges it, after it judged whether the half may be loaded at all.
  const bool fits = first >= 0 && count >= 0 && first <= word_count_ && count <= word_count_ - first;
  const status s = timed(operation::load_words, h, count, [&]() -> status {
    int from = 0;
    do {
      // Not known before the first connection: then one word.
      const int end = fits ? std::min(count, from + std::max(1, burst_words_)) : from;
      SPANTEX_TRY(command(h, bench_command::load_words, words_payload(h, first, words, count, from, end)));
      if (!fits || link_.code() != result::ok) return status::ok;
      for (int k = from; k < end; ++k) {
        memory_[int(h)].words[size_t(first + k)] = words[k];
        memory_[int(h)].known[size_t(first + k)] = true;
      }
      from = end;
    } while (from < count);
    return status::ok;
  });
  return s;
}

status bench_engine::start(half h, span_mask mask) {
  const status s = timed(operation::start, h, 0, [&] {
    return command(h, bench_command::start, [&](auto& out) { out.one_of(h, half::second); out(mask); });
  });
  if (s != status::ok) return s;
  memory_[int(h)].mask = mask;
  memory_[int(h)].started = true;
  return s;
}

status bench_engine::take(half h, span_pixels& out) {
  return timed(operation::take, h, 0, [&]() -> status {
    const uint64_t end = link_.lines().now_ns() + link_.limits().compute_ns;
    for (;;) {
      // Nothing to wait for if nothing was started; a busy line that does not fall is no reason not to ask.
      const uint64_t now = link_.lines().now_ns();
      if (connected_ && memory_[int(h)].started && now < end) (void)link_.wait_while_busy(end - now);
      SPANTEX_TRY(command(h, bench_command::read_span, [&](auto& f) { f.one_of(h, half::second); }));
      if (link_.code() == result::ok) return read_pixels(h, out);
      if (link_.code() != result::pending) return status::ok;
      ++link_.counters().pending_answers;
      if (link_.lines().now_ns() < end && !link_.lines().interrupted()) continue;
      memory_[int(h)] = {};
      dirty_[int(h)] = true;
      return link_.gave_up(bench_exit::compute_too_long, status::device_timeout);
    }
  });
}

status bench_engine::read_pixels(half h, span_pixels& out) {
  memory& m = memory_[int(h)];
  bench::field_reader in = link_.fields();
  span_mask mask = 0;
  bool partial = false;
  span_pixels got{};
  in(mask);
  in(partial);
  if (partial) detail::archive(in, got.sums);
  else
    for (span_mask rest = mask; in.good() && rest != 0; rest &= rest - 1) {
      rgba8& p = got.pixel[__builtin_ctzll(rest)];
      in(p.r); in(p.g); in(p.b); in(p.a);
    }
  if (!in.at_end() || !m.started || mask != m.mask || partial != m.coefficients.axis.partial) {
    m = {};
    dirty_[int(h)] = true;
    return link_.gave_up(bench_exit::answer_malformed, status::device_error);
  }
  if (partial) out.sums = got.sums;
  else
    for (span_mask rest = mask; rest != 0; rest &= rest - 1) out.pixel[__builtin_ctzll(rest)] = got.pixel[__builtin_ctzll(rest)];
  m.loaded = m.started = false;
  return status::ok;
}

void bench_engine::mark(event what) {
  if (!observer_) return;
  const uint64_t now = link_.lines().now_ns();
  observer_({operation::mark, half::first, 0, now, now, status::ok, what});
}

// --- beside the contract -------------------------------------------------------------------------------

status bench_engine::read_device_status(bench::device_status& out) {
  if (!connected_) SPANTEX_TRY(connect());
  SPANTEX_TRY(exchange(bench_command::read_status, [](auto&) {}));
  bench::field_reader in = link_.fields();
  archive(in, out);
  return link_.code() == result::ok && in.at_end() ? status::ok : link_.gave_up(bench_exit::answer_malformed, status::device_error);
}

status bench_engine::loop_back(const uint8_t* bytes, int count) {
  SPANTEX_TRY(exchange(bench_command::loop_back, [&](auto& out) {
    for (int k = 0; k < count; ++k) out(bytes[k]);
  }));
  bench::field_reader in = link_.fields();
  bool same = link_.code() == result::ok && in.left() == count;
  for (int k = 0; same && k < count; ++k) {
    uint8_t back = 0;
    in(back);
    same = back == uint8_t(~bytes[k]);
  }
  return same ? status::ok : link_.gave_up(bench_exit::answer_malformed, status::device_error);
}

}  // namespace spantex
