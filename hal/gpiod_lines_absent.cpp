// SPDX-License-Identifier: Apache-2.0
// In place of gpiod_lines.cpp where libgpiod is not installed: says so.
#include "gpiod_lines.hpp"

#include <utility>

namespace spantex {

struct gpiod_lines::chip {};

gpiod_lines::gpiod_lines(gpiod_rig rig) : rig_(std::move(rig)) {}
gpiod_lines::~gpiod_lines() = default;
bool gpiod_lines::available() { return false; }
void gpiod_lines::catch_signals() {}
status gpiod_lines::open() { return failed("", 0); }
status gpiod_lines::failed(const std::string&, int) {
  trouble_ = rig_.chip + ": built without libgpiod (package libgpiod-dev)";
  return status::device_error;
}
status gpiod_lines::drive_data(uint8_t) { return failed("", 0); }
status gpiod_lines::release_data() { return failed("", 0); }
status gpiod_lines::read_data(uint8_t&) { return failed("", 0); }
status gpiod_lines::set_control(const bench::control_lines&) { return failed("", 0); }
status gpiod_lines::read_status(bench::status_lines&) { return failed("", 0); }
status gpiod_lines::wait_edge(uint64_t) { return failed("", 0); }
void gpiod_lines::pause(uint64_t) {}
uint64_t gpiod_lines::now_ns() { return 0; }
void gpiod_lines::release_all() {}
status gpiod_lines::reopen() { return failed("", 0); }
bool gpiod_lines::interrupted() const { return false; }
std::string gpiod_lines::trouble() const { return trouble_; }

}  // namespace spantex
