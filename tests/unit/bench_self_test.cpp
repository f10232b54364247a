// SPDX-License-Identifier: Apache-2.0
// The bench's self-test on wires with every single fault of its dictionary: each is noticed and named, and no fault beside it that can be told from it: a
// suspect is one whose every answer to every step that the host may make is the same.
#include <map>

#include "tests/bench_job.hpp"

#include <sim/bench_self_test.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

constexpr uint64_t settle_ns = 20'000;

template <int DataBits>
void sound_wires_pass(void**) {
  simulated_bench<prof, DataBits> bench;
  static line_report r;
  r = test_lines(bench, settle_ns);
  SPANTEX_ASSERT_OK(r.result);
  assert_true(r.symptoms.empty());
  assert_int_equal(bench.lines().host.driven, 0);
  assert_int_equal(bench.lines().conflicts(), 0);
  assert_true(r.steps > 16 * (1 << DataBits) / 8);
  bench_engine engine(bench, prof::value);
  SPANTEX_ASSERT_OK(engine.connect());  // the device is as before
}

// What a fault answers to 3000 steps at random, each as the self-test makes them: the clock falls first and rises last, the host drives only towards the
// device, and what is read has settled or swings.
template <int DataBits>
std::vector<uint16_t> answers_of(const wire_fault& fault) {
  constexpr uint16_t swinging = 0xFFFF;
  simulated_bench<prof, DataBits> bench;
  bench.lines().add(fault);
  random_source r(77);
  std::vector<uint16_t> all;
  bench::control_lines c{.reset = true};
  for (int n = 0; n < 3000; ++n) {
    const uint64_t x = r.next();
    SPANTEX_ASSERT_OK(bench.set_control({.to_host = c.to_host, .command = c.command, .reset = c.reset}));
    SPANTEX_ASSERT_OK(bench.release_data());
    c = {(x & 1) != 0, (x & 2) != 0, (x & 4) != 0, true};
    if ((x >> 8) % 8 == 0) c.clock = c.to_host = c.reset = false;
    SPANTEX_ASSERT_OK(bench.set_control({.to_host = c.to_host, .command = c.command, .reset = c.reset}));
    if (!c.to_host && (x & 8) != 0) SPANTEX_ASSERT_OK(bench.drive_data(uint8_t(x >> 16)));
    SPANTEX_ASSERT_OK(bench.set_control(c));
    uint16_t seen = 0;
    for (uint64_t k = 0; k < 9 && seen != swinging; ++k) {
      bench.pause(k == 0 ? 10'000 : 200 * k);
      bench::status_lines s;
      uint8_t byte = 0;
      SPANTEX_ASSERT_OK(bench.read_status(s));
      if (c.to_host && c.clock) SPANTEX_ASSERT_OK(bench.read_data(byte));
      const uint16_t now = uint16_t(byte | (s.ready ? 0x100 : 0) | (s.busy ? 0x200 : 0) | (s.error ? 0x400 : 0));
      seen = k == 0 || now == seen ? now : swinging;
    }
    all.push_back(seen);
  }
  return all;
}

// A fault that lets the device out of reset makes it take some steps for a frame, and once in a thousand steps it refuses one: chance, not a difference.
bool could_be_told(const std::vector<uint16_t>& a, const std::vector<uint16_t>& b) {
  size_t differing = 0;
  for (size_t k = 0; k < a.size(); ++k) differing += a[k] != b[k];
  return differing > a.size() / 1000;
}

template <int DataBits>
void every_single_fault_is_named(void**) {
  static line_report r;
  static std::vector<wire_fault> faults;
  faults = single_line_faults(DataBits);
  static std::map<std::string, std::vector<uint16_t>> answers;
  answers.clear();
  for (const wire_fault& f : faults) answers[short_text(f)] = answers_of<DataBits>(f);
  int most = 0, sum = 0, alone = 0, n = 0;
  for (size_t k = 0; k < faults.size(); ++k) {
    simulated_bench<prof, DataBits> bench;
    bench.lines().add(faults[k]);
    r = test_lines(bench, settle_ns);
    if (r.result != status::mismatch) fail_msg("%s: not noticed", short_text(faults[k]).c_str());
    bool named = false;
    for (const std::string& s : r.suspects) named = named || s == short_text(faults[k]);
    if (!named) fail_msg("%s: %zu suspects, but not this", short_text(faults[k]).c_str(), r.suspects.size());
    for (const std::string& suspect : r.suspects)
      if (could_be_told(answers[suspect], answers[short_text(faults[k])])) fail_msg("%s: could be told from '%s'", short_text(faults[k]).c_str(), suspect.c_str());
    assert_int_equal(bench.lines().host.driven, 0);
    const int count = int(r.suspects.size());
    if (count > most) most = count;
    if (count == 1) ++alone;
    sum += count;
    ++n;
  }
  print_message("%d faults: %d named alone, %.1f suspects on average, at most %d\n", n, alone, double(sum) / n, most);
}

void no_device_is_told_from_a_broken_wire(void**) {
  simulated_bench<prof> bench;
  bench.lines().add({wire_fault_kind::hangs, wire::d0, wire::d0, 1, 0});
  static line_report r;
  r = test_lines(bench, settle_ns);
  assert_int_equal(int(r.result), int(status::mismatch));
  assert_true(!r.suspects.empty() && r.suspects[0].find("no device") == 0);
}

void two_faults_are_noticed_though_not_named(void**) {
  simulated_bench<prof> bench;
  bench.lines().add({wire_fault_kind::stuck_low, wire::d3, wire::d3, 1, 0});
  bench.lines().add({wire_fault_kind::swapped, wire::d6, wire::command, 1, 0});
  static line_report r;
  r = test_lines(bench, settle_ns);
  assert_int_equal(int(r.result), int(status::mismatch));
  assert_true(r.suspects.empty() || r.unexplained > 0);
  assert_false(r.symptoms.empty());
}

void a_failing_chip_is_told(void**) {
  for (uint64_t n = 1; n < 200; n += 7) {
    simulated_bench<prof> bench;
    bench.lines().add({wire_fault_kind::call_fails, wire::d0, wire::d0, n, 1});
    static line_report r;
    r = test_lines(bench, settle_ns);
    assert_int_equal(int(r.result), int(status::device_error));
    assert_int_equal(bench.lines().host.driven, 0);
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(sound_wires_pass<8>),
      cmocka_unit_test(sound_wires_pass<4>),
      cmocka_unit_test(every_single_fault_is_named<8>),
      cmocka_unit_test(every_single_fault_is_named<4>),
      cmocka_unit_test(no_device_is_told_from_a_broken_wire),
      cmocka_unit_test(two_faults_are_noticed_though_not_named),
      cmocka_unit_test(a_failing_chip_is_told),
  };
  return sim::run_suite("bench_self_test", tests);
}
