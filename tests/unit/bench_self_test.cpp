// SPDX-License-Identifier: Apache-2.0
// The bench's self-test on wires with every single fault of its dictionary: each is noticed and named, with few others that look the same.
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

template <int DataBits>
void every_single_fault_is_named(void**) {
  static line_report r;
  static std::vector<wire_fault> faults;
  faults = single_line_faults(DataBits);
  int most = 0, sum = 0, alone = 0, n = 0;
  for (size_t k = 0; k < faults.size(); ++k) {
    simulated_bench<prof, DataBits> bench;
    bench.lines().add(faults[k]);
    r = test_lines(bench, settle_ns);
    if (r.result != status::mismatch) fail_msg("%s: not noticed", short_text(faults[k]).c_str());
    bool named = false;
    for (const std::string& s : r.suspects) named = named || s == short_text(faults[k]);
    if (!named) fail_msg("%s: %zu suspects, but not this", short_text(faults[k]).c_str(), r.suspects.size());
    assert_int_equal(bench.lines().host.driven, 0);
    const int count = int(r.suspects.size());
    if (count > most) most = count;
    if (count == 1) ++alone;
    sum += count;
    ++n;
  }
  print_message("%d faults: %d named alone, %.1f suspects on average, at most %d\n", n, alone, double(sum) / n, most);
  assert_true(most <= 6);
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
