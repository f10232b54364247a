// SPDX-License-Identifier: Apache-2.0
// The bench's wires in one process, with a device at their other end, and what can go wrong with either: docs/BENCH.md. The host's end is a bench_lines
// whose calls are counted from 1, so that a fault can be put at each of them; time is virtual, and a device that has nothing to do lets it jump.
#pragma once
#include <stdint.h>

#include <optional>
#include <string>
#include <vector>

#include <firmware/bench/port.hpp>
#include <firmware/bench/responder.hpp>
#include <hal/bench_lines.hpp>
#include <hal/direct_engine.hpp>

namespace spantex::sim {

enum class wire : uint8_t { d0, d1, d2, d3, d4, d5, d6, d7, clock, direction, command, reset, ready, busy, error };
inline constexpr int wire_count = 15;
inline constexpr const char* wire_names[wire_count] = {"D0", "D1", "D2", "D3", "D4", "D5", "D6", "D7", "clock", "direction", "command", "reset",
                                                       "ready", "busy", "error"};
constexpr uint16_t bit_of(wire w) { return uint16_t(1u << int(w)); }

enum class wire_fault_kind : uint8_t {
  // of wires: both ends see it
  stuck_low, stuck_high,
  bridged_low,     // a and b together: low wins
  bridged_high,    // high wins
  swapped,         // a's device end is b's and the other way round
  // of what one end sees
  flipped_at_host, flipped_at_device,
  glitch,          // the device sees the wire inverted for one step, then as it is: an edge too many
  held,            // the device sees the level of before: an edge too few
  // of the host's chip
  call_fails,
  // of the device
  restarts,        // loses all it had
  hangs,
  sleeps,          // for `ns`
  // of events of edges, while the device sleeps for `ns` too, so that somebody waits for them
  edge_lost,       // the host is not woken
  edge_doubled,    // the host is woken at once, though nothing changed
};
inline constexpr int wire_fault_kind_count = int(wire_fault_kind::edge_doubled) + 1;
const char* to_string(wire_fault_kind k);

struct wire_fault {
  wire_fault_kind kind;
  wire a = wire::d0, b = wire::d1;
  uint64_t first_call = 1, calls = 1;  // while the host makes these calls; 0 calls: for ever
  uint64_t ns = 0;
  std::string text() const;
};

// Levels of the wires, seen from both ends. A wire that nobody drives is pulled down.
class wires {
 public:
  struct end { uint16_t value = 0, driven = 0; };
  end host, device;

  void add(const wire_fault& f) { faults_.push_back(f), choose_active(); }
  void clear_faults() { faults_.clear(), choose_active(); }
  void at_call(uint64_t call) {
    call_ = call;
    if (call >= next_change_) choose_active();
  }
  bool active(wire_fault_kind k, const wire_fault** which = nullptr) const { return !active_.empty() && found(k, which); }
  bool begins(wire_fault_kind k, const wire_fault** which = nullptr) const;

  uint16_t seen_by_host() const { return active_.empty() ? sound_levels() : faulty_for_host(); }
  uint16_t seen_by_device(bool glitching = false) { return last_seen_ = active_.empty() ? sound_levels() : faulty_for_device(glitching); }
  bool glitches() const { return active(wire_fault_kind::glitch); }
  // Both ends drove a wire to different levels, though every wire was sound.
  uint64_t conflicts() const { return conflicts_; }
  void note_conflicts();

 private:
  void choose_active();
  bool found(wire_fault_kind k, const wire_fault** which) const;
  uint16_t sound_levels() const { return uint16_t((host.value & host.driven) | (device.value & device.driven)); }
  uint16_t faulty_for_host() const;
  uint16_t faulty_for_device(bool glitching) const;
  uint16_t levels() const;
  uint16_t crossed(uint16_t bits) const;  // between the device's ends and wires

  std::vector<wire_fault> faults_, active_;  // all; those of this call, in the same order
  uint64_t call_ = 0, next_change_ = UINT64_MAX, conflicts_ = 0;
  uint16_t last_seen_ = 0;
};

// What the device's port sees of the wires.
class device_end {
 public:
  explicit device_end(wires& w) : wires_(w) {}
  bench::control_lines control() {
    seen_ = wires_.seen_by_device(glitching_);
    const auto is = [&](wire w) { return (seen_ & bit_of(w)) != 0; };
    return {is(wire::clock), is(wire::direction), is(wire::command), is(wire::reset)};
  }
  uint8_t data() { return uint8_t(seen_); }
  void drive(uint8_t value) { wires_.device.value = uint16_t((wires_.device.value & 0xFF00) | value), wires_.device.driven |= data_mask_; }
  void release() { wires_.device.driven &= uint16_t(~0xFFu); }
  void show(const bench::status_lines& s) {
    constexpr uint16_t all = bit_of(wire::ready) | bit_of(wire::busy) | bit_of(wire::error);
    wires_.device.driven |= all;
    wires_.device.value = uint16_t((wires_.device.value & ~all) | (s.ready ? bit_of(wire::ready) : 0) | (s.busy ? bit_of(wire::busy) : 0) |
                                   (s.error ? bit_of(wire::error) : 0));
  }
  void glitching(bool on) { glitching_ = on; }
  void narrow() { data_mask_ = 0x0F; }

 private:
  wires& wires_;
  uint16_t seen_ = 0, data_mask_ = 0xFF;
  bool glitching_ = false;
};

// The host's end without the device.
class simulated_lines : public bench_lines {
 public:
  static constexpr uint64_t call_ns = 200, poll_ns = 200;

  int data_bits() const override { return data_bits_; }
  status reopen() override { return call(); }
  void release_all() override;
  uint64_t now_ns() override { return now_ns_; }
  void pause(uint64_t ns) override { pass(ns); }
  status wait_edge(uint64_t limit_ns) override;
  status set_control(const bench::control_lines& c) override;
  status read_status(bench::status_lines& s) override;
  status drive_data(uint8_t value) override;
  status read_data(uint8_t& value) override;
  status release_data() override;
  std::string trouble() const override { return "simulated chip: call " + std::to_string(calls_) + " failed"; }

  wires& lines() { return wires_; }
  uint64_t calls() const { return calls_; }

 protected:
  explicit simulated_lines(int data_bits) : data_bits_(data_bits) {}
  virtual bool poll_device() = 0;
  virtual void restart_device() = 0;
  wires wires_;
  device_end end_{wires_};

 private:
  status call();
  bool step();
  void pass(uint64_t ns);

  int data_bits_;
  uint64_t calls_ = 0, now_ns_ = 0, awake_ns_ = 0;
};

// With a device: an engine, the library's direct one if no other is named, behind a responder.
template <class Prof, int DataBits = 8, class Engine = direct_engine<Prof>, class Responder = bench::responder<Engine, Prof>>
class simulated_bench final : public simulated_lines {
 public:
  simulated_bench() : simulated_lines(DataBits), responder_(engine_, {}) {
    if (DataBits == 4) end_.narrow();
    port_.emplace(end_, responder_);
  }
  Engine& engine() { return engine_; }
  Responder& responder() { return responder_; }

 private:
  bool poll_device() override { return port_->poll(); }
  void restart_device() override {
    wires_.device = {};
    responder_.reset();
    port_.emplace(end_, responder_);
  }

  Engine engine_;
  Responder responder_;
  std::optional<bench::port<device_end, Responder, DataBits>> port_;
};

}  // namespace spantex::sim
