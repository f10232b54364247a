// SPDX-License-Identifier: Apache-2.0
// The host's end of the bench's wires: what a GPIO chip, or a simulation of one, must do. Host only.
//
// Errors: device_error for anything the chip refuses; trouble() then says in one line which chip, which line and why. wait_edge also device_timeout.
#pragma once
#include <stdint.h>

#include <string>

#include <firmware/bench/wire.hpp>
#include <spantex/status.hpp>

namespace spantex {

class bench_lines {
 public:
  virtual ~bench_lines() = default;

  virtual int data_bits() const = 0;                               // 8 or 4
  virtual status drive_data(uint8_t value) = 0;                    // the data lines become outputs, all at once
  virtual status release_data() = 0;                               // and inputs again
  virtual status read_data(uint8_t& value) = 0;
  virtual status set_control(const bench::control_lines& lines) = 0;
  virtual status read_status(bench::status_lines& lines) = 0;
  virtual status wait_edge(uint64_t limit_ns) = 0;                 // of ready, busy or error; may return early, never much later
  virtual void pause(uint64_t ns) = 0;
  virtual uint64_t now_ns() = 0;                                   // never goes back
  virtual void release_all() = 0;                                  // every line an input: nothing is driven any more
  virtual status reopen() = 0;                                     // after a failure: the chip may have gone and come back
  virtual bool interrupted() const { return false; }               // somebody wants to stop: no more attempts
  virtual std::string trouble() const = 0;
};

}  // namespace spantex
