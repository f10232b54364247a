// SPDX-License-Identifier: Apache-2.0
// The bench's lines over a libgpiod 1.6 that is not there: every function of it that is used is wrapped at link time. First strictly: which calls, in which
// order, with which values. Then with a simulated device behind them: for every call n, failing in each way a chip can fail, either the right pixels or a
// status with one line that names the chip; every line an input again, everything released.
#include "tests/bench_job.hpp"

#include <errno.h>
#include <signal.h>
#include <gpiod.h>

#include <hal/gpiod_lines.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

constexpr int line_total = 15;
char handles[line_total + 1];
gpiod_chip* const the_chip = reinterpret_cast<gpiod_chip*>(&handles[line_total]);
gpiod_line* line(int k) { return reinterpret_cast<gpiod_line*>(&handles[k]); }
int index_of(const gpiod_line* l) { return int(reinterpret_cast<const char*>(l) - handles); }

// What the chip behind the mocks looks like.
struct chip_state {
  bool strict = false;              // calls are compared with what the test expects
  bool open = false;
  bool requested[line_total] = {}, output[line_total] = {};
  int taken = -1;                   // a line that somebody else holds
  const char* taken_by = nullptr;
  uint64_t calls = 0, fail_call = 0;
  int error = 0;
  simulated_bench<prof>* device = nullptr;
};
chip_state chip;

// A call of the library as text; strict tests expect these in order, none left over, each with its result.
void note_call(const char* call) { check_expected_ptr(call); }

int called(const std::string& text) {
  ++chip.calls;
  if (chip.strict) {
    note_call(text.c_str());
    const int r = mock_type(int);
    if (r < 0) errno = -r;
    return r < 0 ? -1 : r;
  }
  if (chip.calls != chip.fail_call) return 0;
  errno = chip.error;
  return -1;
}

const char* group_of(const gpiod_line_bulk* bulk) {
  const int k = index_of(bulk->lines[0]);
  return k == 0 ? "data" : k == 8 ? "control" : "status";
}
std::string bits(const gpiod_line_bulk* bulk, const int* values) {
  std::string s;
  for (unsigned k = 0; k < bulk->num_lines; ++k) s += values[k] != 0 ? '1' : '0';
  return s;
}
uint8_t to_byte(const gpiod_line_bulk* bulk, const int* values) {
  uint8_t byte = 0;
  for (unsigned k = 0; k < bulk->num_lines; ++k) byte = uint8_t(byte | values[k] << k);
  return byte;
}
void driven(const gpiod_line_bulk* bulk, const int* values) {
  for (unsigned k = 0; k < bulk->num_lines; ++k) {
    if (!chip.requested[index_of(bulk->lines[k])]) std::abort();
    chip.output[index_of(bulk->lines[k])] = true;
  }
  if (chip.device == nullptr) return;
  if (group_of(bulk)[0] == 'd') (void)chip.device->drive_data(to_byte(bulk, values));
  else (void)chip.device->set_control({values[0] != 0, values[1] != 0, values[2] != 0, values[3] != 0});
}

}  // namespace

extern "C" {

gpiod_chip* __wrap_gpiod_chip_open_lookup(const char* name);
void __wrap_gpiod_chip_close(gpiod_chip* c);
gpiod_line* __wrap_gpiod_chip_get_line(gpiod_chip* c, unsigned offset);
gpiod_line* __wrap_gpiod_chip_find_line(gpiod_chip* c, const char* name);
bool __wrap_gpiod_line_is_used(gpiod_line* l);
const char* __wrap_gpiod_line_consumer(gpiod_line* l);
int __wrap_gpiod_line_request_bulk(gpiod_line_bulk* bulk, const gpiod_line_request_config* config, const int* values);
void __wrap_gpiod_line_release_bulk(gpiod_line_bulk* bulk);
int __wrap_gpiod_line_set_direction_input_bulk(gpiod_line_bulk* bulk);
int __wrap_gpiod_line_set_direction_output_bulk(gpiod_line_bulk* bulk, const int* values);
int __wrap_gpiod_line_set_value_bulk(gpiod_line_bulk* bulk, const int* values);
int __wrap_gpiod_line_get_value_bulk(gpiod_line_bulk* bulk, int* values);
int __wrap_gpiod_line_event_wait_bulk(gpiod_line_bulk* bulk, const timespec* limit, gpiod_line_bulk* came);
int __wrap_gpiod_line_event_read(gpiod_line* l, gpiod_line_event* edge);

gpiod_chip* __wrap_gpiod_chip_open_lookup(const char* name) {
  if (called(std::string("open ") + name) < 0) return nullptr;
  assert_false(chip.open);
  chip.open = true;
  return the_chip;
}
void __wrap_gpiod_chip_close(gpiod_chip* c) {
  assert_ptr_equal(c, the_chip);
  (void)called("close");
  chip.open = false;
}
gpiod_line* __wrap_gpiod_chip_get_line(gpiod_chip*, unsigned offset) {
  return called("line " + std::to_string(offset)) < 0 ? nullptr : line(int(offset));
}
gpiod_line* __wrap_gpiod_chip_find_line(gpiod_chip*, const char* name) {
  const int r = called(std::string("line ") + name);
  return r < 0 ? nullptr : line(chip.strict ? r : std::atoi(name + 1));
}
bool __wrap_gpiod_line_is_used(gpiod_line* l) { return index_of(l) == chip.taken; }
const char* __wrap_gpiod_line_consumer(gpiod_line*) { return chip.taken_by; }
int __wrap_gpiod_line_request_bulk(gpiod_line_bulk* bulk, const gpiod_line_request_config* config, const int* values) {
  assert_null(values);
  assert_string_equal(config->consumer, "spantex-bench");
  const char* how = config->request_type == GPIOD_LINE_REQUEST_EVENT_BOTH_EDGES ? "edges" : config->request_type == GPIOD_LINE_REQUEST_DIRECTION_INPUT ? "inputs" : "?";
  if (called(std::string("request ") + group_of(bulk) + " " + how) < 0) return -1;
  for (unsigned k = 0; k < bulk->num_lines; ++k) chip.requested[index_of(bulk->lines[k])] = true;
  return 0;
}
void __wrap_gpiod_line_release_bulk(gpiod_line_bulk* bulk) {
  (void)called(std::string("release ") + group_of(bulk));
  for (unsigned k = 0; k < bulk->num_lines; ++k) chip.requested[index_of(bulk->lines[k])] = false;
}
int __wrap_gpiod_line_set_direction_input_bulk(gpiod_line_bulk* bulk) {
  if (called(std::string("input ") + group_of(bulk)) < 0) return -1;
  for (unsigned k = 0; k < bulk->num_lines; ++k) chip.output[index_of(bulk->lines[k])] = false;
  if (chip.device != nullptr && group_of(bulk)[0] == 'd') (void)chip.device->release_data();
  return 0;
}
int __wrap_gpiod_line_set_direction_output_bulk(gpiod_line_bulk* bulk, const int* values) {
  if (called(std::string("output ") + group_of(bulk) + " " + bits(bulk, values)) < 0) return -1;
  driven(bulk, values);
  return 0;
}
int __wrap_gpiod_line_set_value_bulk(gpiod_line_bulk* bulk, const int* values) {
  if (called(std::string("set ") + group_of(bulk) + " " + bits(bulk, values)) < 0) return -1;
  for (unsigned k = 0; k < bulk->num_lines; ++k)
    if (!chip.strict && !chip.output[index_of(bulk->lines[k])]) std::abort();
  driven(bulk, values);
  return 0;
}
int __wrap_gpiod_line_get_value_bulk(gpiod_line_bulk* bulk, int* values) {
  const int r = called(std::string("get ") + group_of(bulk));
  if (r < 0) return -1;
  for (unsigned k = 0; k < bulk->num_lines; ++k) values[k] = r >> k & 1;
  if (chip.device == nullptr) return 0;
  bench::status_lines s;
  uint8_t byte = 0;
  if (group_of(bulk)[0] == 'd') (void)chip.device->read_data(byte);
  else (void)chip.device->read_status(s);
  for (unsigned k = 0; k < bulk->num_lines; ++k)
    values[k] = group_of(bulk)[0] == 'd' ? byte >> k & 1 : k == 0 ? s.ready : k == 1 ? s.busy : s.error;
  return 0;
}
int __wrap_gpiod_line_event_wait_bulk(gpiod_line_bulk* bulk, const timespec* limit, gpiod_line_bulk* came) {
  const int r = called("wait " + std::to_string(limit->tv_sec * 1'000'000'000 + limit->tv_nsec));
  if (r == 1) gpiod_line_bulk_add(came, bulk->lines[0]);
  if (chip.device != nullptr && r == 0) (void)chip.device->wait_edge(1000);
  return r;
}
int __wrap_gpiod_line_event_read(gpiod_line* l, gpiod_line_event*) { return called("edge of " + std::to_string(index_of(l))); }

}

namespace {

gpiod_rig rig() {
  gpiod_rig r;
  r.chip = "bench-chip";
  for (int k = 0; k < 8; ++k) r.data[size_t(k)] = "D" + std::to_string(k);
  r.clock = "8"; r.direction = "9"; r.command = "10"; r.reset = "11"; r.ready = "12"; r.busy = "13"; r.error = "14";
  return r;
}

// Text the strict tests expect must outlive the expectation.
void expect(const char* call, int result = 0) {
  expect_string(note_call, call, call);
  will_return(called, result);
}

void expect_open() {
  static const char* const names[] = {"line D0", "line D1", "line D2", "line D3", "line D4", "line D5", "line D6", "line D7"};
  expect("open bench-chip");
  for (int k = 0; k < 8; ++k) expect(names[k], k);
  expect("request data inputs");
  expect("line 8"); expect("line 9"); expect("line 10"); expect("line 11");
  expect("request control inputs");
  expect("line 12"); expect("line 13"); expect("line 14");
  expect("request status edges");
}
void expect_close() {
  expect("release data"); expect("release control"); expect("release status");
  expect("close");
}

int strict_chip(void**) {
  chip = {};
  chip.strict = true;
  return 0;
}
int simulated_chip(void**) {
  chip = {};
  return 0;
}

// --- strict --------------------------------------------------------------------------------------------

void opening_requests_inputs_only(void**) {
  expect_open();
  {
    gpiod_lines lines(rig());
    SPANTEX_ASSERT_OK(lines.open());
    for (bool output : chip.output) assert_false(output);
    expect_close();
  }
}

void lines_become_outputs_when_driven_and_inputs_again(void**) {
  expect_open();
  {
    gpiod_lines lines(rig());
    SPANTEX_ASSERT_OK(lines.open());
    SPANTEX_ASSERT_OK(lines.release_data());  // nothing to do, no call
    expect("output data 10100101");
    SPANTEX_ASSERT_OK(lines.drive_data(0xA5));
    expect("set data 01000000");
    SPANTEX_ASSERT_OK(lines.drive_data(0x02));
    expect("output control 0010");
    SPANTEX_ASSERT_OK(lines.set_control({.command = true}));
    expect("set control 1010");
    SPANTEX_ASSERT_OK(lines.set_control({.clock = true, .command = true}));
    expect("input data");
    SPANTEX_ASSERT_OK(lines.release_data());
    uint8_t byte = 0;
    expect("get data", 0x5A);
    SPANTEX_ASSERT_OK(lines.read_data(byte));
    assert_int_equal(byte, 0x5A);
    bench::status_lines s;
    expect("get status", 0b101);
    SPANTEX_ASSERT_OK(lines.read_status(s));
    assert_true(s.ready && !s.busy && s.error);
    expect("output data 11111111");
    SPANTEX_ASSERT_OK(lines.drive_data(0xFF));
    expect("input data");
    expect("input control");
    lines.release_all();
    lines.release_all();  // nothing more to do
    expect("output control 0001");
    SPANTEX_ASSERT_OK(lines.set_control({.reset = true}));
    expect("input control");  // by the destructor
    expect_close();
  }
}

void edges_are_waited_for_and_taken(void**) {
  expect_open();
  {
    gpiod_lines lines(rig());
    SPANTEX_ASSERT_OK(lines.open());
    expect("wait 5000", 1);
    expect("edge of 12");
    SPANTEX_ASSERT_OK(lines.wait_edge(5000));
    expect("wait 5000", 0);
    SPANTEX_ASSERT_STATUS(lines.wait_edge(5000), device_timeout);
    expect("wait 100000000", 0);  // never longer: a signal may have come before
    SPANTEX_ASSERT_STATUS(lines.wait_edge(UINT64_MAX), device_timeout);
    expect("wait 7", -EINTR);
    SPANTEX_ASSERT_OK(lines.wait_edge(7));
    expect("wait 7", 1);
    expect("edge of 12", -ENODEV);
    SPANTEX_ASSERT_STATUS(lines.wait_edge(7), device_error);
    expect("wait 7", -ENODEV);
    SPANTEX_ASSERT_STATUS(lines.wait_edge(7), device_error);
    expect_close();
  }
}

bool says(const gpiod_lines& lines, std::initializer_list<const char*> words) {
  const std::string text = lines.trouble();
  for (const char* word : words)
    if (text.find(word) == std::string::npos) {
      print_message("'%s' does not say '%s'\n", text.c_str(), word);
      return false;
    }
  return text.find('\n') == std::string::npos;
}

void what_cannot_be_opened_is_named(void**) {
  gpiod_lines lines(rig());
  expect("open bench-chip", -ENOENT);
  SPANTEX_ASSERT_STATUS(lines.open(), device_error);
  assert_true(says(lines, {"bench-chip", "No such file"}));
  expect("open bench-chip", -EACCES);
  SPANTEX_ASSERT_STATUS(lines.open(), device_error);
  assert_true(says(lines, {"bench-chip", "no permission"}));
  expect("open bench-chip", -ENOTTY);
  SPANTEX_ASSERT_STATUS(lines.open(), device_error);
  assert_true(says(lines, {"bench-chip", "does not know"}));
  expect("open bench-chip"); expect("line D0", 0); expect("line D1", -ENOENT); expect("close");
  SPANTEX_ASSERT_STATUS(lines.open(), device_error);
  assert_true(says(lines, {"bench-chip", "line D1 = D1", "no such line"}));
  // A closed chip is never touched.
  SPANTEX_ASSERT_STATUS(lines.drive_data(1), device_error);
  assert_true(says(lines, {"bench-chip", "not open"}));
}

// --- with a device behind the mocks ---------------------------------------------------------------------

void a_line_in_use_is_named_with_its_holder(void**) {
  chip.taken = 9;
  chip.taken_by = "thermometer";
  chip.fail_call = 15;  // request control
  chip.error = EBUSY;
  {
    gpiod_lines lines(rig());
    SPANTEX_ASSERT_STATUS(lines.open(), device_error);
    assert_true(says(lines, {"bench-chip", "direction = 9", "in use by 'thermometer'"}));
  }
  assert_false(chip.open);
  for (bool r : chip.requested) assert_false(r);
}

constexpr bench_limits limits{.step_ns = 20'000'000, .exchange_ns = 200'000'000, .compute_ns = 50'000'000, .back_off_ns = 100, .attempts = 2, .recoveries = 1};

// True once call n is not reached any more.
bool fails_at(uint64_t n, int error) {
  static std::unique_ptr<simulated_bench<prof>> device;
  device = std::make_unique<simulated_bench<prof>>();
  chip = {};
  chip.device = device.get();
  chip.fail_call = n;
  chip.error = error;
  bool right = false;
  {
    gpiod_lines lines(rig());
    const status opened = lines.open();
    if (opened != status::ok) {
      assert_true(says(lines, {"bench-chip"}));
    } else {
      bench_engine engine(lines, prof::value, limits);
      const job_result r = run_job(engine);
      assert_false(r.wrong_pixel);
      right = r.first_failure == status::ok;
      engine.close();
    }
  }
  assert_false(chip.open);
  for (bool r : chip.requested) assert_false(r);
  int outputs = 0;
  for (bool o : chip.output) outputs += o;
  const bool last_release_failed = chip.calls <= n + 6 && n <= chip.calls;  // the destructor's own, after which there is nobody to try again
  if (outputs != 0 && !last_release_failed) fail_msg("call %d: %d lines left driven", int(n), outputs);
  if (n > chip.calls) assert_true(right);
  return n > chip.calls;
}

void every_call_that_fails_is_survived(void**) {
  uint64_t n = 1;
  for (int error : {ENODEV, EIO, EBUSY})
    for (n = 1; !fails_at(n, error); n += 1 + n / 60) {}
  print_message("up to call %llu\n", static_cast<unsigned long long>(n));
}

void signals_stop_the_bench(void**) {
  static std::unique_ptr<simulated_bench<prof>> device;
  device = std::make_unique<simulated_bench<prof>>();
  chip.device = device.get();
  gpiod_lines::catch_signals();
  {
    gpiod_lines lines(rig());
    SPANTEX_ASSERT_OK(lines.open());
    bench_engine engine(lines, prof::value, limits);
    SPANTEX_ASSERT_OK(engine.load_coefficients(half::first, reading(0)));
    raise(SIGTERM);
    const uint64_t before = chip.calls;
    SPANTEX_ASSERT_STATUS(engine.start(half::first, 1), device_error);
    assert_true(says(lines, {"bench-chip", "signal 15"}));
    assert_true(chip.calls <= before + 4);
    for (bool o : chip.output) assert_false(o);
  }
  assert_false(chip.open);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test_setup(opening_requests_inputs_only, strict_chip),
      cmocka_unit_test_setup(lines_become_outputs_when_driven_and_inputs_again, strict_chip),
      cmocka_unit_test_setup(edges_are_waited_for_and_taken, strict_chip),
      cmocka_unit_test_setup(what_cannot_be_opened_is_named, strict_chip),
      cmocka_unit_test_setup(a_line_in_use_is_named_with_its_holder, simulated_chip),
      cmocka_unit_test_setup(every_call_that_fails_is_survived, simulated_chip),
      cmocka_unit_test_setup(signals_stop_the_bench, simulated_chip),
  };
  return sim::run_suite("gpiod_lines", tests);
}
