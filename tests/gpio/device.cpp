// SPDX-License-Identifier: Apache-2.0
// The device's end of the bench as a process beside the kernel's gpio-sim: what the host drives is read from the lines' values, what the device drives is
// set as their pulls.   device DIRECTORY PROFILE [BYTES FILE]   (the directory that holds sim_gpio0 ...; lines 0..7 data, 8 clock, 9 direction, 10 command,
// 11 reset, 12 ready, 13 busy, 14 error). After so many bytes it makes the file, so that something can be done to it in the middle of a picture.
#include <fcntl.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <string>

#include <firmware/bench/port.hpp>
#include <firmware/bench/responder.hpp>
#include <hal/direct_engine.hpp>

using namespace spantex;

namespace {

constexpr int clock_line = 8, direction_line = 9, command_line = 10, reset_line = 11, ready_line = 12, busy_line = 13, error_line = 14, line_count = 15;

class sysfs_pins {
 public:
  sysfs_pins(const std::string& directory, long bytes, const char* file) : bytes_left_(bytes), file_(file) {
    for (int k = 0; k < line_count; ++k) {
      const std::string line = directory + "/sim_gpio" + std::to_string(k);
      values_[k] = opened(line + "/value", O_RDONLY);
      pulls_[k] = opened(line + "/pull", O_WRONLY);
      pull(k, false);
    }
  }

  // The clock first: whatever else the host sets is set before the clock rises, and means nothing while clock and reset are low.
  bench::control_lines control() {
    bench::control_lines c;
    c.clock = is_high(clock_line);
    c.reset = is_high(reset_line);
    if (c.reset) drive(driven_);  // a line that the host let go keeps its level until it is pulled again, and the self-test lets go at any time
    if (!c.clock && !c.reset) return c;
    c.to_host = is_high(direction_line);
    c.command = is_high(command_line);
    return c;
  }
  uint8_t data() {
    int byte = 0;
    for (int k = 0; k < 8; ++k) byte |= (is_high(k) ? 1 : 0) << k;
    return uint8_t(byte);
  }
  // Every line, every time, for the same reason.
  void drive(uint8_t byte) {
    driven_ = byte;
    for (int k = 0; k < 8; ++k) pull(k, (byte >> k & 1) != 0);
  }
  void release() { drive(0); }  // as the wires' own pull-downs; a pull gives way to an output
  void show(const bench::status_lines& s) {
    // Ready last: the others are meant to be seen with it.
    if (s.busy != shown_.busy || first_) pull(busy_line, s.busy);
    if (s.error != shown_.error || first_) pull(error_line, s.error);
    if (s.ready != shown_.ready || first_) pull(ready_line, s.ready);
    if (s.ready && !shown_.ready && --bytes_left_ == 0) close(open(file_, O_CREAT | O_WRONLY, 0600));
    shown_ = s;
    first_ = false;
  }

 private:
  static int opened(const std::string& path, int how) {
    const int file = open(path.c_str(), how);
    if (file >= 0) return file;
    perror(path.c_str());
    exit(2);
  }
  bool is_high(int k) const {
    char c = '0';
    if (pread(values_[k], &c, 1, 0) != 1) exit(3);  // the chip is gone
    return c == '1';
  }
  void pull(int k, bool up) const {
    const char* const text = up ? "pull-up" : "pull-down";
    if (pwrite(pulls_[k], text, strlen(text), 0) < 0) exit(3);
  }

  int values_[line_count], pulls_[line_count];
  bench::status_lines shown_{};
  uint8_t driven_ = 0;
  bool first_ = true;
  long bytes_left_;
  const char* file_;
};

template <profile P>
[[noreturn]] void serve(sysfs_pins& pins) {
  using word_lengths = fixed_profile<P>;
  static direct_engine<word_lengths> engine;
  static bench::responder<direct_engine<word_lengths>, word_lengths> commands(engine);
  bench::port port(pins, commands);
  for (;;)
    if (!port.poll()) sched_yield();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3 && argc != 5) return fprintf(stderr, "usage: device DIRECTORY PROFILE [BYTES FILE]\n"), 2;
  sysfs_pins pins(argv[1], argc == 5 ? atol(argv[3]) : -1, argc == 5 ? argv[4] : "");
  const std::string name = argv[2];
  if (name == "seed") serve<profiles::seed>(pins);
  if (name == "default") serve<profiles::standard>(pins);
  return fprintf(stderr, "unknown profile '%s'\n", argv[2]), 2;
}
