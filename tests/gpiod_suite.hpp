// SPDX-License-Identifier: Apache-2.0
// The bench's lines over a libgpiod that is not there: the suite that both versions of it pass. A file of tests includes this after <gpiod.h>, and defines the
// library's functions: each says what it is asked as a text ("output data 10100101"), and does what the chip would. First strictly: which calls, in which
// order, with which values. Then every call fails in turn, in each way a chip can fail: a status and one line that names chip and lines, or the right pixels;
// every line an input again, everything released.
#pragma once
#include "tests/bench_job.hpp"

#include <errno.h>
#include <signal.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <map>

#include <hal/gpiod_lines.hpp>

namespace spantex::sim {

inline constexpr int line_total = 15;
inline constexpr char chip_path[] = "/dev/gpiochip3";
inline constexpr uint64_t chip_release_calls = 20;  // the destructor's

// What the chip behind the mocks looks like.
struct chip_state {
  bool strict = false;              // calls are compared with what the test expects
  bool open = false;
  bool requested[line_total] = {}, output[line_total] = {};
  bool edges = false;               // there is always one to be taken
  int taken = -1;                   // a line that somebody else holds
  const char* taken_by = nullptr;
  int objects = 0;                  // of the library's, that somebody must free
  uint64_t calls = 0, asked = 0, fail_call = 0;  // all; of the chip
  uint64_t last_told = UINT64_MAX;  // the last call that can say that it failed: then all is let go
  int error = 0;
  std::string fail_at;              // or a call by its text
  std::string failed;               // the call that was made to fail
  simulated_bench<prof>* device = nullptr;
  int* outputs_told = nullptr;      // how many lines are outputs, for another process
};
inline chip_state chip;

// A call of the library as text; strict tests expect these in order, none left over, each with its result.
inline void note_call(const char* call) { check_expected_ptr(call); }

// A call that fails in its turn, and is not worth a line in the strict tests: it asks the chip nothing.
inline int counted(const std::string& text) {
  ++chip.calls;
  if (chip.strict || (chip.calls != chip.fail_call && text != chip.fail_at)) return 0;
  chip.failed = text;
  errno = chip.error;
  return -1;
}

inline int called(const std::string& text) {
  ++chip.asked;
  if (!chip.strict) return counted(text);
  note_call(text.c_str());
  const int r = mock_type(int);
  if (r < 0) errno = -r;
  return r < 0 ? -1 : r;
}

inline const char* group_of(int first_line) { return first_line == 0 ? "data" : first_line == 8 ? "control" : "status"; }

// --- what the chip does, of `count` lines from `first` on ------------------------------------------------

inline void set_outputs(int first, int count, bool yes) {
  for (int k = first; k < first + count; ++k) chip.output[k] = yes;
  if (chip.outputs_told != nullptr) *chip.outputs_told = int(std::count(std::begin(chip.output), std::end(chip.output), true));
}

inline void become_requested(int first, int count, bool yes) {
  for (int k = first; k < first + count; ++k) chip.requested[k] = yes;  // whoever lets go of an output leaves it as it is
}

template <class Values>
std::string bits(const Values* values, int count) {
  std::string s;
  for (int k = 0; k < count; ++k) s += int(values[k]) != 0 ? '1' : '0';
  return s;
}

template <class Values>
void become_driven(int first, int count, const Values* values) {
  for (int k = first; k < first + count; ++k)
    if (!chip.requested[k]) std::abort();
  set_outputs(first, count, true);
  if (chip.device == nullptr) return;
  uint8_t byte = 0;
  for (int k = 0; k < count; ++k) byte = uint8_t(byte | (int(values[k]) != 0 ? 1 : 0) << k);
  if (first == 0) (void)chip.device->drive_data(byte);
  else (void)chip.device->set_control({(byte & 1) != 0, (byte & 2) != 0, (byte & 4) != 0, (byte & 8) != 0});
}

inline void become_inputs(int first, int count) {
  set_outputs(first, count, false);
  if (chip.device != nullptr && first == 0) (void)chip.device->release_data();
}

// Only outputs can be set: the kernel refuses others.
inline void must_be_outputs(int first, int count) {
  for (int k = first; k < first + count; ++k)
    if (!chip.strict && !chip.output[k]) std::abort();
}

// The levels; `scripted` in strict tests.
inline uint8_t levels_of(int first, int scripted) {
  if (chip.device == nullptr) return uint8_t(scripted);
  uint8_t byte = 0;
  bench::status_lines s;
  if (first == 0) {
    (void)chip.device->read_data(byte);
    return byte;
  }
  (void)chip.device->read_status(s);
  return uint8_t((s.ready ? 1 : 0) | (s.busy ? 2 : 0) | (s.error ? 4 : 0));
}

// Whether an edge came.
inline int waited(const std::string& text) {
  const int r = called(text);
  if (chip.strict || r < 0) return r;
  if (chip.device != nullptr) (void)chip.device->wait_edge(1000);
  return chip.edges ? 1 : 0;
}

// --- strict --------------------------------------------------------------------------------------------

inline gpiod_rig rig() {
  gpiod_rig r;
  r.chip = chip_path;
  for (int k = 0; k < 8; ++k) r.data[size_t(k)] = "D" + std::to_string(k);
  r.clock = "8"; r.direction = "9"; r.command = "10"; r.reset = "11"; r.ready = "12"; r.busy = "13"; r.error = "14";
  return r;
}

// Text the strict tests expect must outlive the expectation.
inline void expect(const char* call, int result = 0) {
  expect_string(note_call, call, call);
  will_return(called, result);
}

inline void expect_open() {
  static const char* const names[] = {"line D0", "line D1", "line D2", "line D3", "line D4", "line D5", "line D6", "line D7"};
  expect("open /dev/gpiochip3");
  for (int k = 0; k < 8; ++k) expect(names[k], k);
  expect("request data inputs");
  expect("line 8"); expect("line 9"); expect("line 10"); expect("line 11");
  expect("request control inputs");
  expect("line 12"); expect("line 13"); expect("line 14");
  expect("request status edges");
}
inline void expect_close() {
  expect("release data"); expect("release control"); expect("release status");
  expect("close");
}

inline int strict_chip(void**) {
  chip = {};
  chip.strict = true;
  return 0;
}
inline int simulated_chip(void**) {
  chip = {};
  return 0;
}

inline void opening_requests_inputs_only(void**) {
  expect_open();
  {
    gpiod_lines lines(rig());
    SPANTEX_ASSERT_OK(lines.open());
    for (bool output : chip.output) assert_false(output);
    expect_close();
  }
}

inline void lines_become_outputs_when_driven_and_inputs_again(void**) {
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

inline void narrow_wires_have_four_data_lines(void**) {
  gpiod_rig narrow = rig();
  narrow.data_bits = 4;
  expect("open /dev/gpiochip3");
  expect("line D0", 0); expect("line D1", 1); expect("line D2", 2); expect("line D3", 3);
  expect("request data inputs");
  expect("line 8"); expect("line 9"); expect("line 10"); expect("line 11");
  expect("request control inputs");
  expect("line 12"); expect("line 13"); expect("line 14");
  expect("request status edges");
  {
    gpiod_lines lines(narrow);
    SPANTEX_ASSERT_OK(lines.open());
    expect("output data 0101");
    SPANTEX_ASSERT_OK(lines.drive_data(0xFA));
    expect("input data", -EIO);
    SPANTEX_ASSERT_STATUS(lines.release_data(), device_error);
    assert_non_null(strstr(lines.trouble().c_str(), "lines D0 to D3, released"));
    expect("input data");
    expect_close();
  }
}

inline void edges_are_waited_for_and_taken(void**) {
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

inline bool says(const gpiod_lines& lines, std::initializer_list<const char*> words) {
  const std::string text = lines.trouble();
  for (const char* word : words)
    if (text.find(word) == std::string::npos) {
      print_message("'%s' does not say '%s'\n", text.c_str(), word);
      return false;
    }
  return text.find('\n') == std::string::npos;
}

inline void what_cannot_be_opened_is_named(void**) {
  gpiod_lines lines(rig());
  expect("open /dev/gpiochip3", -ENOENT);
  SPANTEX_ASSERT_STATUS(lines.open(), device_error);
  assert_true(says(lines, {chip_path, "No such file"}));
  expect("open /dev/gpiochip3", -EACCES);
  SPANTEX_ASSERT_STATUS(lines.open(), device_error);
  assert_true(says(lines, {chip_path, "no permission"}));
  expect("open /dev/gpiochip3", -ENOTTY);
  SPANTEX_ASSERT_STATUS(lines.open(), device_error);
  assert_true(says(lines, {chip_path, "does not know"}));
  expect("open /dev/gpiochip3"); expect("line D0", 0); expect("line D1", -ENOENT); expect("close");
  SPANTEX_ASSERT_STATUS(lines.open(), device_error);
  assert_true(says(lines, {chip_path, "line D1 = D1", "no such line"}));
  // A closed chip is never touched.
  SPANTEX_ASSERT_STATUS(lines.drive_data(1), device_error);
  assert_true(says(lines, {chip_path, "not open"}));
}

inline void a_line_in_use_is_named_with_its_holder(void**) {
  chip.taken = 9;
  chip.taken_by = "thermometer";
  chip.fail_at = "request control inputs";
  chip.error = EBUSY;
  {
    gpiod_lines lines(rig());
    SPANTEX_ASSERT_STATUS(lines.open(), device_error);
    assert_true(says(lines, {chip_path, "direction = 9", "in use by 'thermometer'"}));
  }
  assert_false(chip.open);
  for (bool r : chip.requested) assert_false(r);
}

// --- every call fails in turn, in every way --------------------------------------------------------------

struct failure { int error; const char* name; const char* told; };
inline constexpr failure failures[] = {
    {ENOENT, "no chip", "No such file"}, {EACCES, "no permission", "no permission"}, {EBUSY, "in use", "busy"},
    {ENODEV, "unplugged", "the chip is gone"}, {ENOTTY, "kernel without the ABI", "does not know"}, {EIO, "broken", "Input/output error"}};
inline constexpr int failure_count = int(std::size(failures));

inline void nothing_is_left() {
  assert_false(chip.open);
  for (bool r : chip.requested) assert_false(r);
  assert_int_equal(chip.objects, 0);
}

// Everything the lines do, once. The first status that is not ok.
inline status use_all(gpiod_lines& lines) {
  uint8_t byte = 0;
  bench::status_lines s;
  SPANTEX_TRY(lines.open());
  SPANTEX_TRY(lines.drive_data(0xA5));
  SPANTEX_TRY(lines.drive_data(0x5A));
  SPANTEX_TRY(lines.release_data());
  SPANTEX_TRY(lines.read_data(byte));
  SPANTEX_TRY(lines.set_control({.command = true}));
  SPANTEX_TRY(lines.set_control({.clock = true}));
  SPANTEX_TRY(lines.read_status(s));
  SPANTEX_TRY(lines.wait_edge(5000));
  chip.last_told = chip.calls;
  lines.release_all();
  return status::ok;
}

// Which lines a call is about, as the message must say it.
inline const char* lines_of(const std::string& call) {
  static constexpr const char* roles[] = {"D0", "D1", "D2", "D3", "D4", "D5", "D6", "D7", "clock", "direction", "command", "reset", "ready", "busy", "error"};
  if (call.find("data") != std::string::npos) return "lines D0 to D7";
  if (call.find("control") != std::string::npos) return "lines clock to reset";
  if (call.find("status") != std::string::npos || call.rfind("wait", 0) == 0 || call.rfind("edge", 0) == 0) return "lines ready to error";
  if (call.rfind("line D", 0) == 0) return roles[call[6] - '0'];
  if (call.rfind("line ", 0) == 0) return roles[std::stoi(call.substr(5))];
  return "";
}

inline void every_failing_call_is_told(void**) {
  static std::map<std::string, int> reached[failure_count];
  static std::map<std::string, std::string> told;
  for (int f = 0; f < failure_count; ++f) {
    reached[f].clear();
    for (uint64_t n = 1;; ++n) {
      chip = {};
      chip.edges = true;
      chip.fail_call = n;
      chip.error = failures[f].error;
      {
        gpiod_lines lines(rig());
        const status s = use_all(lines);
        if (n > chip.last_told) {
          SPANTEX_ASSERT_OK(s);
        } else {
          SPANTEX_ASSERT_STATUS(s, device_error);
          if (!says(lines, {chip_path, lines_of(chip.failed), failures[f].told})) fail_msg("call %d, %s", int(n), chip.failed.c_str());
          const std::string place = chip.failed.substr(0, chip.failed.find_first_of("0123456789D"));
          if (++reached[f][place] == 1 && failures[f].error == ENODEV) told[place] = lines.trouble();
        }
      }
      nothing_is_left();
      if (chip.calls < n) break;
    }
  }
  for (const auto& [place, text] : told) {
    std::string row;
    for (int f = 0; f < failure_count; ++f) {
      row += " " + std::string(failures[f].name) + " " + std::to_string(reached[f][place]);
      if (reached[f][place] == 0) fail_msg("%s never failed with '%s'", place.c_str(), failures[f].name);
    }
    print_message("%-16s%s\n                 %s\n", place.c_str(), row.c_str(), text.c_str());
  }
  for (const char* place : {"open /dev/gpiochip", "line ", "request data inputs", "request control inputs", "request status edges", "output data ", "set data ",
                            "input data", "get data", "output control ", "set control ", "get status", "wait ", "edge of "})
    if (told.count(place) == 0) fail_msg("'%s' never failed", place);
}

inline constexpr bench_limits limits{.step_ns = 20'000'000, .exchange_ns = 200'000'000, .compute_ns = 50'000'000, .back_off_ns = 100, .attempts = 2, .recoveries = 1};

inline std::unique_ptr<simulated_bench<prof>>& device() {
  static std::unique_ptr<simulated_bench<prof>> kept;
  return kept;
}

// A device behind the mocks, and a job. True once call n is not reached any more.
inline bool fails_at(uint64_t n, int error) {
  device() = std::make_unique<simulated_bench<prof>>();
  chip = {};
  chip.device = device().get();
  chip.fail_call = n;
  chip.error = error;
  bool right = false;
  {
    gpiod_lines lines(rig());
    const status opened = lines.open();
    if (opened != status::ok) {
      assert_true(says(lines, {chip_path}));
    } else {
      bench_engine engine(lines, prof::value, limits);
      const job_result r = run_job(engine);
      assert_false(r.wrong_pixel);
      right = r.first_failure == status::ok;
      engine.close();
    }
  }
  nothing_is_left();
  int outputs = 0;
  for (bool o : chip.output) outputs += o;
  // Where letting go itself fails at the very end there is nobody to try again.
  const bool last_release_failed = chip.calls <= n + chip_release_calls && n <= chip.calls;
  if (outputs != 0 && !last_release_failed) fail_msg("call %d: %d lines left driven", int(n), outputs);
  if (n > chip.calls) assert_true(right);
  return n > chip.calls;
}

// Every so-manyth call; SPANTEX_LONG: every one.
inline void every_call_that_fails_is_survived(void**) {
  uint64_t n = 1;
  const bool all = std::getenv("SPANTEX_LONG") != nullptr;
  for (const failure& f : failures)
    for (n = 1; !fails_at(n, f.error); n += all ? 1 : 1 + n / 30) {}
  print_message("up to call %llu\n", static_cast<unsigned long long>(n));
}

inline void signals_stop_the_bench(void**) {
  device() = std::make_unique<simulated_bench<prof>>();
  chip.device = device().get();
  gpiod_lines::catch_signals();
  {
    gpiod_lines lines(rig());
    SPANTEX_ASSERT_OK(lines.open());
    bench_engine engine(lines, prof::value, limits);
    SPANTEX_ASSERT_OK(engine.load_coefficients(half::first, reading(0)));
    raise(SIGTERM);
    const uint64_t before = chip.asked;
    SPANTEX_ASSERT_STATUS(engine.start(half::first, 1), device_error);
    assert_true(says(lines, {chip_path, "signal 15"}));
    assert_true(chip.asked <= before + 4);
    for (bool o : chip.output) assert_false(o);
  }
  assert_false(chip.open);
}

// Each signal that ends a process, in one of its own: those that ask to stop are noted and the next call fails, faults end it with the lines let go.
inline void every_signal_lets_go(void**) {
  void* shared = mmap(nullptr, sizeof(int), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  assert_true(shared != MAP_FAILED);
  int* const outputs = static_cast<int*>(shared);
  int stopped = 0, died = 0;
  for (int s = 1; s <= SIGRTMAX; ++s) {
    const bool ends_nothing = s == SIGCHLD || s == SIGCONT || s == SIGTSTP || s == SIGTTIN || s == SIGTTOU || s == SIGURG || s == SIGWINCH;
    if (ends_nothing || s == SIGKILL || s == SIGSTOP || (s > 31 && s < SIGRTMIN)) continue;
    const pid_t child = fork();
    if (child == 0) {
      chip = {};
      chip.outputs_told = outputs;
      signal(s, SIG_DFL);  // whatever the caller ignores
      gpiod_lines::catch_signals();
      gpiod_lines lines(rig());
      if (lines.open() != status::ok || lines.drive_data(0xFF) != status::ok || lines.set_control({.reset = true}) != status::ok || *outputs != 12) _exit(3);
      raise(s);
      if (lines.drive_data(0) != status::device_error || !lines.interrupted()) _exit(4);
      lines.release_all();
      _exit(0);
    }
    int end = 0;
    assert_int_equal(waitpid(child, &end, 0), child);
    if (WIFSIGNALED(end)) assert_int_equal(WTERMSIG(end), s);
    else assert_int_equal(WEXITSTATUS(end), 0);
    ++(WIFSIGNALED(end) ? died : stopped);
    if (*outputs != 0) fail_msg("signal %d: %d lines left driven", s, *outputs);
  }
  munmap(shared, sizeof(int));
  print_message("%d signals stop the bench, %d end it\n", stopped, died);
  assert_int_equal(died, 7);
}

// `own`: of one version.
template <class... Own>
int run_gpiod_suite(const char* name, Own... own) {
  const CMUnitTest tests[] = {
      cmocka_unit_test_setup(opening_requests_inputs_only, strict_chip),
      cmocka_unit_test_setup(lines_become_outputs_when_driven_and_inputs_again, strict_chip),
      cmocka_unit_test_setup(edges_are_waited_for_and_taken, strict_chip),
      cmocka_unit_test_setup(narrow_wires_have_four_data_lines, strict_chip),
      cmocka_unit_test_setup(what_cannot_be_opened_is_named, strict_chip),
      cmocka_unit_test_setup(a_line_in_use_is_named_with_its_holder, simulated_chip),
      cmocka_unit_test_setup(every_failing_call_is_told, simulated_chip),
      cmocka_unit_test_setup(every_call_that_fails_is_survived, simulated_chip),
      cmocka_unit_test_setup(every_signal_lets_go, simulated_chip),
      own...,
      cmocka_unit_test_setup(signals_stop_the_bench, simulated_chip),  // nothing runs after a signal
  };
  return run_suite(name, tests);
}

}  // namespace spantex::sim
