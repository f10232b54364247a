// SPDX-License-Identifier: Apache-2.0
// The bench over wires that go wrong: for every fault at every call of the host's lines until one passes cleanly, either the right pixels or a status;
// never a wrong pixel taken for right, never without end, never a line left driven. A table says which exit each fault reached, and every exit is reached.
// Here each fault stands at every so-manyth call, and 4000 schedules of random faults run; SPANTEX_LONG=1 (`make stress-bench`): every call, 10^6.
#include "tests/bench_job.hpp"

#include <sim/parallel.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

bool long_run() { return std::getenv("SPANTEX_LONG") != nullptr; }

// Short limits in virtual time; a full retreat is some 10^5 calls.
constexpr bench_limits limits{.step_ns = 100'000, .exchange_ns = 20'000'000, .compute_ns = 2'000'000, .back_off_ns = 1'000, .attempts = 3, .recoveries = 2};
constexpr uint64_t most_calls = 2'000'000, most_ns = 3'000'000'000;

struct tally {
  uint64_t runs = 0, right = 0, refused = 0;
  bench_counters counters;
  void add(const bench_counters& c) {
    for (size_t k = 0; k < c.exits.size(); ++k) counters.exits[k] += c.exits[k];
    counters.recoveries += c.recoveries;
  }
};

// Rows of the table: kinds of wire faults, lies, and one for random schedules.
constexpr int random_row = wire_fault_kind_count + lie_count, row_count = random_row + 1;
tally table[row_count];

std::string row_name(int row) {
  static const char* const lies[lie_count] = {
      "honest", "wrong CRC", "wrong seal", "another sequence", "another command", "unknown code", "too long", "not spantex", "newer version",
      "other coefficients", "other profile", "no burst", "open refused", "other mask", "partial pixels", "short pixels", "always pending",
      "engine fails", "engine times out", "error line high", "busy line high", "refuses: incomplete", "refuses: length", "refuses: CRC",
      "refuses: seal", "refuses coefficients", "fewer fields", "more fields"};
  if (row == random_row) return "random schedules";
  return row < wire_fault_kind_count ? to_string(wire_fault_kind(row)) : lies[row - wire_fault_kind_count];
}

// Runs the job; what must never happen ends the program with the schedule that made it happen. The calls that it took.
template <class Bench>
uint64_t judge(Bench& bench, const std::vector<wire_fault>& faults, tally& sum, int lied = -1) {
  for (const wire_fault& f : faults) bench.lines().add(f);
  bench_engine engine(bench, prof::value, limits);
  const job_result r = run_job(engine);
  engine.close();
  const char* wrong = r.wrong_pixel                       ? "a wrong pixel was accepted"
                      : bench.lines().host.driven != 0    ? "lines are left driven"
                      : bench.calls() > most_calls        ? "too many calls"
                      : bench.now_ns() > most_ns          ? "too much time"
                      : bench.lines().conflicts() != 0    ? "both ends drove a sound wire"
                                                          : nullptr;
  if (wrong != nullptr) {
    fprintf(stderr, "%s: lie %d\n", wrong, lied);
    for (const wire_fault& f : faults) fprintf(stderr, "  %s, %llu ns\n", f.text().c_str(), static_cast<unsigned long long>(f.ns));
    std::abort();
  }
  ++sum.runs;
  ++(r.first_failure == status::ok ? sum.right : sum.refused);
  sum.add(engine.counters());
  return bench.calls();
}

template <int DataBits = 8>
uint64_t calls_without_faults() {
  static const uint64_t n = [] {
    tally unused;
    simulated_bench<prof, DataBits> bench;
    return judge(bench, {}, unused);
  }();
  return n;
}

// Every wire or pair that a kind can have, for short and for ever.
std::vector<wire_fault> variants(wire_fault_kind kind) {
  std::vector<wire_fault> v;
  const auto add = [&](wire a, wire b, uint64_t ns = 0) {
    for (uint64_t calls : {uint64_t(1), uint64_t(40), uint64_t(0)}) v.push_back({kind, a, b, 1, calls, ns});
  };
  if (kind >= wire_fault_kind::call_fails) {
    if (kind == wire_fault_kind::sleeps) for (uint64_t ns : {10'000u, 150'000u, 30'000'000u}) v.push_back({kind, wire::d0, wire::d1, 1, 1, ns});
    else if (kind >= wire_fault_kind::edge_lost) for (uint64_t ns : {10'000u, 90'000u}) for (uint64_t calls : {3u, 40u, 0u}) v.push_back({kind, wire::d0, wire::d1, 1, calls, ns});
    else if (kind == wire_fault_kind::restarts) v.push_back({kind, wire::d0, wire::d1, 1, 1, 0});
    else add(wire::d0, wire::d1);
    return v;
  }
  const bool pairs = kind == wire_fault_kind::bridged_low || kind == wire_fault_kind::bridged_high || kind == wire_fault_kind::swapped;
  for (int a = 0; a < wire_count; ++a) {
    if (!pairs) { add(wire(a), wire(a)); continue; }
    for (int b = a + 1; b < wire_count; ++b)
      if (b == a + 1 || a >= int(wire::clock)) add(wire(a), wire(b));
  }
  return v;
}

// --- cases ---------------------------------------------------------------------------------------------

void sound_wires_give_the_right_pixels(void**) {
  tally t;
  simulated_bench<prof> bench;
  simulated_bench<prof, 4> narrow;
  const uint64_t calls = judge(bench, {}, t), narrow_calls = judge(narrow, {}, t);
  assert_int_equal(t.right, 2);
  for (uint64_t n : t.counters.exits) assert_int_equal(n, 0);
  assert_int_equal(t.counters.recoveries, 0);
  assert_true(narrow_calls > calls);
  print_message("%llu calls of the lines, %llu with four data lines\n", static_cast<unsigned long long>(calls), static_cast<unsigned long long>(narrow_calls));
}

// A fault at every `stride`th call from `first` on, up to a clean pass: one that begins after the job has ended.
template <int DataBits>
void fault_at_calls(wire_fault f, uint64_t first, uint64_t stride, tally& t) {
  const uint64_t calls = calls_without_faults<DataBits>();
  for (f.first_call = first; f.first_call <= calls; f.first_call += stride) {
    simulated_bench<prof, DataBits> bench;
    judge(bench, {f}, t);
  }
  simulated_bench<prof, DataBits> bench;
  tally clean;
  f.first_call = calls + 1;
  judge(bench, {f}, clean);
  if (clean.right != 1) std::abort();
}

bool on_narrow_wires(wire w) { return w < wire::d4 || w > wire::d7; }

void every_fault_at_every_call(void**) {
  const uint64_t calls = calls_without_faults();
  (void)calls_without_faults<4>();
  int done = 0;
  std::vector<wire_fault> all;
  for (int k = 0; k < wire_fault_kind_count; ++k)
    for (const wire_fault& f : variants(wire_fault_kind(k))) all.push_back(f);
  std::mutex lock;
  for_each_index(int(all.size()), hardware_threads(), [&](int k) {
    const wire_fault& fault = all[size_t(k)];
    tally t;
    // Strides of a prime, from another call for each fault.
    const uint64_t stride = long_run() ? 1 : 997, narrow_stride = long_run() ? 29 : 1997;
    fault_at_calls<8>(fault, 1 + uint64_t(k) * 61 % stride, stride, t);
    if (on_narrow_wires(fault.a) && on_narrow_wires(fault.b)) fault_at_calls<4>(fault, 1 + uint64_t(k) * 61 % narrow_stride, narrow_stride, t);
    const std::lock_guard guard(lock);
    // What happens once and for a moment is mended: by a repetition, or by a new session. Events of edges only save time.
    const bool momentary = (fault.calls == 1 && fault.kind >= wire_fault_kind::flipped_at_host && fault.kind <= wire_fault_kind::restarts) ||
                           fault.kind >= wire_fault_kind::edge_lost;
    if (momentary && t.refused != 0) {
      fprintf(stderr, "%s: not mended\n", fault.text().c_str());
      std::abort();
    }
    tally& row = table[int(fault.kind)];
    row.runs += t.runs;
    row.right += t.right;
    row.refused += t.refused;
    row.add(t.counters);
    if (++done % 50 == 0 && long_run()) print_message("%d of %zu faults\n", done, all.size());
  });
  uint64_t runs = 0;
  for (int k = 0; k < wire_fault_kind_count; ++k) {
    assert_true(table[k].runs > 0);
    runs += table[k].runs;
  }
  print_message("%zu faults at %s of %llu calls, and on narrow wires: %llu runs\n", all.size(), long_run() ? "each" : "every 997th",
                static_cast<unsigned long long>(calls), static_cast<unsigned long long>(runs));
}

void every_lie_from_every_answer(void**) {
  for (int k = 0; k < lie_count; ++k)
    for (int count : {1, 1 << 30})
      for (int from = 0; from < 16; ++from) {
        simulated_bench<prof, 8, direct, lying_responder> bench;
        bench.responder().told = lie(k);
        bench.responder().from_answer = from;
        bench.responder().answers = count;
        judge(bench, {}, table[wire_fault_kind_count + k], k);
      }
  assert_int_equal(table[wire_fault_kind_count].refused, 0);  // an honest device
  // Lies that no repetition mends are never taken for the truth.
  for (lie l : {lie::wrong_crc, lie::wrong_seal, lie::another_sequence, lie::unknown_code, lie::too_long, lie::not_spantex, lie::newer_version,
                lie::other_coefficients, lie::other_profile, lie::fewer_fields, lie::more_fields, lie::no_burst, lie::open_refused, lie::always_pending, lie::error_line_high}) {
    simulated_bench<prof, 8, direct, lying_responder> bench;
    bench.responder().told = l;
    tally t;
    judge(bench, {}, t);
    if (t.refused != 1) fail_msg("%s: accepted", row_name(wire_fault_kind_count + int(l)).c_str());
  }
}

wire_fault random_fault(random_source& r, uint64_t calls) {
  wire_fault f{wire_fault_kind(r.between(0, int(wire_fault_kind::sleeps)))};
  f.a = wire(r.between(0, wire_count - 1));
  f.b = wire((int(f.a) + int(r.between(1, wire_count - 1))) % wire_count);
  f.first_call = uint64_t(r.between(1, int64_t(calls)));
  const int length = int(r.between(0, 9));
  f.calls = length == 9 ? 0 : uint64_t(r.between(1, int64_t(1) << length));
  f.ns = uint64_t(1) << r.between(8, 25);
  return f;
}

// One to four faults each; schedule n has seed n, from 1 on.
void random_schedules(void**) {
  const uint64_t calls = calls_without_faults();
  const int blocks = long_run() ? 1000 : 4;
  std::mutex lock;
  for_each_index(blocks, hardware_threads(), [&](int block) {
    tally t;
    for (int k = 0; k < 1000; ++k) {
      random_source r(uint64_t(block) * 1000 + uint64_t(k) + 1);
      std::vector<wire_fault> faults;
      for (int64_t n = r.between(1, 4); n > 0; --n) faults.push_back(random_fault(r, calls));
      if (r.next() % 8 == 0) {
        simulated_bench<prof, 4> bench;
        judge(bench, faults, t);
      } else {
        simulated_bench<prof> bench;
        judge(bench, faults, t);
      }
    }
    const std::lock_guard guard(lock);
    table[random_row].runs += t.runs;
    table[random_row].right += t.right;
    table[random_row].refused += t.refused;
    table[random_row].add(t.counters);
  });
  const tally& t = table[random_row];
  print_message("seeds 1 to %llu: %llu right, %llu refused\n", static_cast<unsigned long long>(t.runs), static_cast<unsigned long long>(t.right),
                static_cast<unsigned long long>(t.refused));
  assert_true(t.right > 0);
  assert_true(t.refused > 0);
}

void interrupted_engine_lets_go(void**) {
  struct interruptible final : bench_lines {
    simulated_bench<prof> inner;
    uint64_t stop_at = 0;
    bool stopped() const { return stop_at != 0 && inner.calls() >= stop_at; }
    status through(status s) const { return stopped() ? status::device_error : s; }
    int data_bits() const override { return 8; }
    status drive_data(uint8_t v) override { return through(inner.drive_data(v)); }
    status release_data() override { return through(inner.release_data()); }
    status read_data(uint8_t& v) override { return through(inner.read_data(v)); }
    status set_control(const bench::control_lines& c) override { return through(inner.set_control(c)); }
    status read_status(bench::status_lines& s) override { return through(inner.read_status(s)); }
    status wait_edge(uint64_t ns) override { return through(inner.wait_edge(ns)); }
    void pause(uint64_t ns) override { inner.pause(ns); }
    uint64_t now_ns() override { return inner.now_ns(); }
    void release_all() override { inner.release_all(); }
    status reopen() override { return inner.reopen(); }
    bool interrupted() const override { return stopped(); }
    std::string trouble() const override { return "stopped by a signal"; }
  };
  const uint64_t calls = calls_without_faults();
  for (uint64_t n = 1; n < calls - 200; n += 83) {  // the last calls close the session
    interruptible bench;
    bench.stop_at = n;
    bench_engine engine(bench, prof::value, limits);
    const job_result r = run_job(engine);
    assert_int_equal(int(r.first_failure), int(status::device_error));
    assert_false(r.wrong_pixel);
    assert_true(bench.inner.calls() < n + 200);  // nothing is tried again
    engine.close();
    assert_int_equal(bench.inner.lines().host.driven, 0);
    table[0].add(engine.counters());
  }
}

// What a half held is loaded again into a device that lost it, while the other half goes on.
void a_device_that_restarts_gets_its_state_back(void**) {
  simulated_bench<prof> bench;
  bench_engine engine(bench, prof::value, limits);
  SPANTEX_ASSERT_OK(engine.load_words(half::first, 0, red.word, word_count));
  SPANTEX_ASSERT_OK(engine.load_coefficients(half::first, reading(0)));
  SPANTEX_ASSERT_OK(engine.start(half::first, full_mask));
  SPANTEX_ASSERT_OK(engine.load_words(half::second, 0, blue.word, word_count));
  bench.lines().add({wire_fault_kind::restarts, wire::d0, wire::d1, bench.calls() + 5, 1, 0});
  span_pixels got{};
  SPANTEX_ASSERT_OK(engine.load_coefficients(half::second, reading(2)));
  SPANTEX_ASSERT_OK(engine.take(half::first, got));
  assert_pixels(got, expected(red, 0));
  SPANTEX_ASSERT_OK(engine.start(half::second, full_mask));
  SPANTEX_ASSERT_OK(engine.take(half::second, got));
  assert_pixels(got, expected(blue, 2));
  assert_int_equal(engine.counters().recoveries, 1);
  assert_int_equal(engine.counters().restored_words, 2 * word_count);
}

// A device that is gone empties both halves, and each says so once.
void a_device_that_is_gone_empties_both_halves(void**) {
  simulated_bench<prof> bench;
  bench_engine engine(bench, prof::value, limits);
  for (half h : halves) load_all(engine, h, red, 0);
  SPANTEX_ASSERT_OK(engine.start(half::second, full_mask));
  bench.lines().add({wire_fault_kind::hangs, wire::d0, wire::d1, bench.calls() + 1, 0, 0});
  SPANTEX_ASSERT_STATUS(engine.start(half::first, full_mask), device_timeout);
  assert_int_equal(bench.lines().host.driven, 0);
  bench.lines().clear_faults();  // it comes back
  SPANTEX_ASSERT_STATUS(engine.start(half::first, full_mask), half_not_loaded);
  span_pixels got{};
  SPANTEX_ASSERT_STATUS(engine.take(half::second, got), device_error);
  SPANTEX_ASSERT_STATUS(engine.take(half::second, got), half_not_started);
  load_all(engine, half::second, blue, 1);
  SPANTEX_ASSERT_OK(engine.start(half::second, full_mask));
  SPANTEX_ASSERT_OK(engine.take(half::second, got));
  assert_pixels(got, expected(blue, 1));
}

// A device that sleeps longer than all recoveries last: patience waits for it, and what the halves held is there again.
void patience_waits_for_a_device_that_comes_back(void**) {
  for (uint64_t patience_ns : {uint64_t(0), uint64_t(2'000'000'000)}) {
    simulated_bench<prof> bench;
    bench_limits patient = limits;
    patient.patience_ns = patience_ns;
    bench_engine engine(bench, prof::value, patient);
    load_all(engine, half::first, red, 0);
    bench.lines().add({wire_fault_kind::sleeps, wire::d0, wire::d1, bench.calls() + 1, 1, 1'000'000'000});
    const uint64_t begun = bench.now_ns();
    const status s = engine.start(half::first, full_mask);
    assert_int_equal(int(s), int(patience_ns == 0 ? status::device_timeout : status::ok));
    assert_true(patience_ns == 0 ? bench.now_ns() - begun < 200'000'000 : bench.now_ns() - begun >= 1'000'000'000);
    if (s != status::ok) continue;
    span_pixels got{};
    SPANTEX_ASSERT_OK(engine.take(half::first, got));
    assert_pixels(got, expected(red, 0));
    assert_true(engine.counters().recoveries > 2);
  }
}

// However long a rig file lets it back off.
void backing_off_ends_with_the_exchange(void**) {
  simulated_bench<prof> bench;
  bench_limits slow = limits;
  slow.back_off_ns = 3'600'000'000'000;
  slow.attempts = 100;
  slow.recoveries = 100;
  bench_engine engine(bench, prof::value, slow);
  SPANTEX_ASSERT_OK(engine.connect());
  bench.lines().add({wire_fault_kind::stuck_low, wire::ready, wire::ready, bench.calls() + 1, 0, 0});
  const uint64_t begun = bench.now_ns();
  SPANTEX_ASSERT_STATUS(engine.load_coefficients(half::first, reading(0)), device_timeout);
  assert_true(bench.now_ns() - begun < 101 * (500'000'000 + 2 * limits.exchange_ns));
}

// --- profiles ------------------------------------------------------------------------------------------

constexpr profile sharper = [] {
  profile p = prof::value;
  p.mip_bias = -8;
  return p;
}();

void a_device_of_another_mip_bias_is_refused(void**) {
  simulated_bench<fixed_profile<sharper>> bench;
  bench_engine engine(bench, prof::value, limits);
  SPANTEX_ASSERT_STATUS(engine.connect(), mismatch);
  assert_string_equal(engine.trouble().c_str(), "the device has another profile: mip_bias -8, expected 0");
  assert_int_equal(bench.lines().host.driven, 0);
  bench_engine same(bench, sharper, limits);
  SPANTEX_ASSERT_OK(same.connect());
}

// By the host, which names the field, and by a device that is asked for another than its own.
void every_field_of_a_profile_is_compared(void**) {
  int k = 0;
  spantex::detail::for_each_field(prof::value, [&](const char* name, int) {
    simulated_bench<prof, 8, direct, lying_responder> bench;
    bench.responder().told = lie::other_profile;
    bench.responder().field = k;
    bench_engine engine(bench, prof::value, limits);
    SPANTEX_ASSERT_STATUS(engine.connect(), mismatch);
    if (engine.trouble().find(": " + std::string(name) + " ") == std::string::npos) fail_msg("field %s: %s", name, engine.trouble().c_str());

    simulated_bench<prof> asked;
    bench_link link(asked, limits);
    SPANTEX_ASSERT_OK(link.reset());
    bench::profile_fields fields = bench::fields_of(prof::value);
    fields.value[k++] ^= 1;
    bench::field_writer out = link.payload();
    out(bench::protocol_version);
    out(uint32_t(7));
    bench::archive(out, fields);
    SPANTEX_ASSERT_OK(link.exchange(bench::command::open, 0, out.size()));
    assert_int_equal(int(link.code()), int(bench::result::other_profile));
  });
  assert_int_equal(k, bench::profile_field_count);
}

// A library whose profile has other fields is another version, not an unknown device.
void a_profile_of_other_fields_is_another_version(void**) {
  for (lie l : {lie::fewer_fields, lie::more_fields}) {
    simulated_bench<prof, 8, direct, lying_responder> bench;
    bench.responder().told = l;
    bench_engine engine(bench, prof::value, limits);
    SPANTEX_ASSERT_STATUS(engine.connect(), mismatch);
    assert_string_equal(engine.trouble().c_str(), "the device speaks another version: its profile has other fields");
  }
}

// However often single steps are in time.
void an_exchange_has_an_end(void**) {
  simulated_bench<prof> bench;
  bench_limits short_exchange = limits;
  short_exchange.exchange_ns = 20 * simulated_lines::call_ns;
  bench_engine engine(bench, prof::value, short_exchange);
  SPANTEX_ASSERT_STATUS(engine.load_coefficients(half::first, reading(0)), device_timeout);
  assert_true(engine.counters().exits[size_t(bench_exit::exchange_too_long)] > 0);
  assert_int_equal(bench.lines().host.driven, 0);
  table[random_row].add(engine.counters());
}

// The last case: which exit each fault reached.
void every_exit_is_reached(void**) {
  uint64_t reached[bench_exit_count] = {};
  for (int row = 0; row < row_count; ++row) {
    const tally& t = table[row];
    print_message("%-20s %8llu runs %8llu right %8llu refused\n", row_name(row).c_str(), static_cast<unsigned long long>(t.runs),
                  static_cast<unsigned long long>(t.right), static_cast<unsigned long long>(t.refused));
    for (int e = 0; e < bench_exit_count; ++e) {
      reached[e] += t.counters.exits[size_t(e)];
      if (t.counters.exits[size_t(e)] != 0)
        print_message("    %10llu  %s\n", static_cast<unsigned long long>(t.counters.exits[size_t(e)]), to_string(bench_exit(e)));
    }
  }
  for (int e = 0; e < bench_exit_count; ++e)
    if (reached[e] == 0) fail_msg("no fault reached '%s'", to_string(bench_exit(e)));
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(sound_wires_give_the_right_pixels),
      cmocka_unit_test(a_device_that_restarts_gets_its_state_back),
      cmocka_unit_test(a_device_that_is_gone_empties_both_halves),
      cmocka_unit_test(interrupted_engine_lets_go),
      cmocka_unit_test(patience_waits_for_a_device_that_comes_back),
      cmocka_unit_test(backing_off_ends_with_the_exchange),
      cmocka_unit_test(a_device_of_another_mip_bias_is_refused),
      cmocka_unit_test(every_field_of_a_profile_is_compared),
      cmocka_unit_test(a_profile_of_other_fields_is_another_version),
      cmocka_unit_test(an_exchange_has_an_end),
      cmocka_unit_test(every_fault_at_every_call),
      cmocka_unit_test(every_lie_from_every_answer),
      cmocka_unit_test(random_schedules),
      cmocka_unit_test(every_exit_is_reached),
  };
  return sim::run_suite("bench_faults", tests);
}
