// SPDX-License-Identifier: Apache-2.0
#include "bench_wires.hpp"

#include <algorithm>

namespace spantex::sim {

const char* to_string(wire_fault_kind k) {
  switch (k) {
    case wire_fault_kind::stuck_low: return "stuck low";
    case wire_fault_kind::stuck_high: return "stuck high";
    case wire_fault_kind::bridged_low: return "bridged, low wins";
    case wire_fault_kind::bridged_high: return "bridged, high wins";
    case wire_fault_kind::swapped: return "swapped";
    case wire_fault_kind::flipped_at_host: return "flipped at host";
    case wire_fault_kind::flipped_at_device: return "flipped at device";
    case wire_fault_kind::glitch: return "glitch";
    case wire_fault_kind::held: return "held";
    case wire_fault_kind::call_fails: return "call fails";
    case wire_fault_kind::restarts: return "device restarts";
    case wire_fault_kind::hangs: return "device hangs";
    case wire_fault_kind::sleeps: return "device sleeps";
    case wire_fault_kind::edge_lost: return "edge event lost";
    case wire_fault_kind::edge_doubled: return "edge event doubled";
  }
  return "unknown";
}

std::string wire_fault::text() const {
  std::string s = to_string(kind);
  if (kind < wire_fault_kind::call_fails) s = std::string(wire_names[int(a)]) + " " + s;
  if (kind == wire_fault_kind::bridged_low || kind == wire_fault_kind::bridged_high || kind == wire_fault_kind::swapped)
    s = std::string(wire_names[int(a)]) + " and " + wire_names[int(b)] + " " + to_string(kind);
  s += " from call " + std::to_string(first_call);
  return calls == 0 ? s + " on" : s + " for " + std::to_string(calls);
}

// --- levels --------------------------------------------------------------------------------------------

void wires::choose_active() {
  active_.clear();
  next_change_ = UINT64_MAX;
  for (const wire_fault& f : faults_) {
    const bool begun = call_ >= f.first_call, over = begun && f.calls != 0 && call_ - f.first_call >= f.calls;
    if (begun && !over) active_.push_back(f);
    if (!begun) next_change_ = std::min(next_change_, f.first_call);
    else if (!over && f.calls != 0) next_change_ = std::min(next_change_, f.first_call + f.calls);
  }
}

bool wires::found(wire_fault_kind k, const wire_fault** which) const {
  for (const wire_fault& f : active_)
    if (f.kind == k) {
      if (which != nullptr) *which = &f;
      return true;
    }
  return false;
}

bool wires::begins(wire_fault_kind k, const wire_fault** which) const {
  const wire_fault* f = nullptr;
  if (!active(k, &f) || f->first_call != call_) return false;
  if (which != nullptr) *which = f;
  return true;
}

uint16_t wires::crossed(uint16_t bits) const {
  for (const wire_fault& f : active_) {
    if (f.kind != wire_fault_kind::swapped) continue;
    const bool a = (bits & bit_of(f.a)) != 0, b = (bits & bit_of(f.b)) != 0;
    if (a != b) bits = uint16_t(bits ^ (bit_of(f.a) | bit_of(f.b)));
  }
  return bits;
}

uint16_t wires::levels() const {
  const uint16_t value = crossed(device.value & device.driven), driven = crossed(device.driven);
  const uint16_t all_driven = host.driven | driven;
  uint16_t level = uint16_t((host.value & host.driven) | value);
  for (const wire_fault& f : active_) {
    if (f.kind != wire_fault_kind::bridged_low && f.kind != wire_fault_kind::bridged_high) continue;
    const uint16_t both = bit_of(f.a) | bit_of(f.b), pulling = all_driven & both, high = level & both;
    const bool up = f.kind == wire_fault_kind::bridged_high ? high != 0 : pulling != 0 && (high & pulling) == pulling;
    level = uint16_t(up ? level | both : level & ~both);
  }
  for (const wire_fault& f : active_) {
    if (f.kind == wire_fault_kind::stuck_low) level &= uint16_t(~bit_of(f.a));
    if (f.kind == wire_fault_kind::stuck_high) level |= bit_of(f.a);
  }
  return level;
}

uint16_t wires::faulty_for_host() const {
  uint16_t level = levels();
  for (const wire_fault& f : active_)
    if (f.kind == wire_fault_kind::flipped_at_host) level ^= bit_of(f.a);
  return level;
}

uint16_t wires::faulty_for_device(bool glitching) const {
  uint16_t level = crossed(levels());
  for (const wire_fault& f : active_) {
    if (f.kind == wire_fault_kind::flipped_at_device || (glitching && f.kind == wire_fault_kind::glitch)) level ^= bit_of(f.a);
    if (f.kind == wire_fault_kind::held) level = uint16_t((level & ~bit_of(f.a)) | (last_seen_ & bit_of(f.a)));
  }
  return level;
}

void wires::note_conflicts() {
  if (!faults_.empty()) return;
  if ((host.driven & device.driven & (host.value ^ device.value)) != 0) ++conflicts_;
}

// --- the host's end ------------------------------------------------------------------------------------

status simulated_lines::call() {
  ++calls_;
  now_ns_ += call_ns;
  wires_.at_call(calls_);
  const wire_fault* f = nullptr;
  if (wires_.begins(wire_fault_kind::restarts)) restart_device();
  for (wire_fault_kind k : {wire_fault_kind::sleeps, wire_fault_kind::edge_lost, wire_fault_kind::edge_doubled})
    if (wires_.begins(k, &f)) awake_ns_ = now_ns_ + f->ns;
  return wires_.active(wire_fault_kind::call_fails) ? status::device_error : status::ok;
}

bool simulated_lines::step() {
  if (wires_.active(wire_fault_kind::hangs) || now_ns_ < awake_ns_) return false;
  if (wires_.glitches()) {
    end_.glitching(true);
    poll_device();
    end_.glitching(false);
  }
  const bool did = poll_device();
  wires_.note_conflicts();
  return did;
}

// The device goes on until it rests or the time is over.
void simulated_lines::pass(uint64_t ns) {
  const uint64_t end = now_ns_ + ns;
  if (now_ns_ < awake_ns_) now_ns_ = std::min(end, awake_ns_);
  while (now_ns_ < end && step()) now_ns_ += poll_ns;
  now_ns_ = std::max(now_ns_, end);
}

status simulated_lines::drive_data(uint8_t value) {
  SPANTEX_TRY(call());
  const uint16_t mask = data_bits_ == 8 ? 0xFF : 0x0F;
  wires_.host.value = uint16_t((wires_.host.value & ~mask) | (value & mask));
  wires_.host.driven |= mask;
  step();
  return status::ok;
}

status simulated_lines::release_data() {
  SPANTEX_TRY(call());
  wires_.host.driven &= uint16_t(~0xFFu);
  step();
  return status::ok;
}

status simulated_lines::read_data(uint8_t& value) {
  SPANTEX_TRY(call());
  step();
  value = uint8_t(wires_.seen_by_host() & (data_bits_ == 8 ? 0xFF : 0x0F));
  return status::ok;
}

status simulated_lines::set_control(const bench::control_lines& c) {
  SPANTEX_TRY(call());
  constexpr uint16_t all = bit_of(wire::clock) | bit_of(wire::direction) | bit_of(wire::command) | bit_of(wire::reset);
  wires_.host.driven |= all;
  wires_.host.value = uint16_t((wires_.host.value & ~all) | (c.clock ? bit_of(wire::clock) : 0) | (c.to_host ? bit_of(wire::direction) : 0) |
                               (c.command ? bit_of(wire::command) : 0) | (c.reset ? bit_of(wire::reset) : 0));
  step();
  return status::ok;
}

status simulated_lines::read_status(bench::status_lines& s) {
  SPANTEX_TRY(call());
  step();
  const uint16_t level = wires_.seen_by_host();
  const auto is = [&](wire w) { return (level & bit_of(w)) != 0; };
  s = {is(wire::ready), is(wire::busy), is(wire::error)};
  return status::ok;
}

status simulated_lines::wait_edge(uint64_t limit_ns) {
  SPANTEX_TRY(call());
  if (wires_.active(wire_fault_kind::edge_doubled)) return status::ok;
  if (wires_.active(wire_fault_kind::edge_lost)) {
    pass(limit_ns);
    return status::device_timeout;
  }
  constexpr uint16_t watched = bit_of(wire::ready) | bit_of(wire::busy) | bit_of(wire::error);
  const uint64_t end = now_ns_ + limit_ns;
  const uint16_t before = wires_.seen_by_host() & watched;
  while (now_ns_ < end) {
    if (now_ns_ < awake_ns_) now_ns_ = std::min(end, awake_ns_);
    const bool did = step();
    now_ns_ += poll_ns;
    if ((wires_.seen_by_host() & watched) != before) return status::ok;
    if (!did && now_ns_ >= awake_ns_) break;
  }
  now_ns_ = std::max(now_ns_, end);
  return status::device_timeout;
}

// Not a call that can fail: whoever stops must be able to.
void simulated_lines::release_all() {
  wires_.host = {};
  step();
}

}  // namespace spantex::sim
