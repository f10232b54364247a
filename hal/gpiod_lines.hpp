// SPDX-License-Identifier: Apache-2.0
// The bench's lines on a Linux GPIO chip, through libgpiod (1.6 or 2). Host only; gpiod_lines.cpp is the one file that knows gpiod.h, and is left out,
// with gpiod_lines_absent.cpp in its place, where pkg-config finds no libgpiod.
//
// Every line is an input until it is needed as an output, and again after release_all(), in the destructor, and, as far as a process can, after signals:
// those that ask to stop make every call fail with interrupted(); those that end the process release the lines first. SIGKILL cannot be caught.
#pragma once
#include <stdint.h>

#include <array>
#include <memory>
#include <string>

#include <hal/bench_lines.hpp>

namespace spantex {

// Where the wires are: a chip by name, label or path, and lines of it by name or offset.
struct gpiod_rig {
  std::string chip;
  int data_bits = 8;
  std::array<std::string, 8> data;                                  // the first four if there are four
  std::string clock, direction, command, reset;                     // from the host
  std::string ready, busy, error;                                   // from the device
};

class gpiod_lines final : public bench_lines {
 public:
  explicit gpiod_lines(gpiod_rig rig);
  ~gpiod_lines() override;
  gpiod_lines(const gpiod_lines&) = delete;
  gpiod_lines& operator=(const gpiod_lines&) = delete;

  // Errors: device_error, with trouble(): no such chip or line, no permission, a line in use, a kernel or a build without what is needed.
  status open();
  // Signals that would end the process stop the bench; faults (SIGSEGV, SIGABRT, ...) release the lines of the last one opened, then end it.
  static void catch_signals();
  static bool available();  // built with libgpiod

  int data_bits() const override { return rig_.data_bits; }
  status drive_data(uint8_t value) override;
  status release_data() override;
  status read_data(uint8_t& value) override;
  status set_control(const bench::control_lines& lines) override;
  status read_status(bench::status_lines& lines) override;
  status wait_edge(uint64_t limit_ns) override;
  void pause(uint64_t ns) override;
  uint64_t now_ns() override;
  void release_all() override;
  status reopen() override;
  bool interrupted() const override;
  std::string trouble() const override;  // of the signal, once one has stopped it

 private:
  struct chip;
  status failed(const std::string& what, int error);
  status may_go_on();
  std::string data_lines() const;

  gpiod_rig rig_;
  std::unique_ptr<chip> chip_;
  std::string trouble_;
};

}  // namespace spantex
