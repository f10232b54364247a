// SPDX-License-Identifier: Apache-2.0
#include "bench_self_test.hpp"

#include <algorithm>

#include "random.hpp"

namespace spantex::sim {
namespace {

// What the steps saw, and what sound wires give.
struct observations {
  std::vector<uint16_t> seen, wanted;
  std::vector<std::string> where;
  status result = status::ok;
};

std::string levels_of(const bench::control_lines& c) {
  std::string s;
  const auto add = [&](bool on, const char* name) { if (on) s += (s.empty() ? "" : "+") + std::string(name); };
  add(c.reset, "reset"); add(c.clock, "clock"); add(c.to_host, "direction"); add(c.command, "command");
  return s.empty() ? "all low" : s;
}

constexpr uint16_t unstable = 0xFFFF;
constexpr int walk_steps = 256;

class tester {
 public:
  tester(bench_lines& lines, uint64_t settle_ns) : lines_(lines), settle_ns_(settle_ns) {}

  observations run() {
    const status s = through();
    lines_.release_all();
    o_.result = s;
    return o_;
  }

 private:
  status through() {
    SPANTEX_TRY(lines_.release_data());
    // Out of reset nothing echoes.
    SPANTEX_TRY(shows({}, {}));
    SPANTEX_TRY(shows({.command = true}, {}));
    for (int k = 0; k < 8; ++k) {
      const bench::control_lines c{(k & 1) != 0, (k & 2) != 0, (k & 4) != 0, true};
      // Each from rest, so that a step does not depend on the one before.
      SPANTEX_TRY(lines_.set_control({.reset = true}));
      SPANTEX_TRY(shows(c, {c.clock, c.command, c.to_host}));
    }
    const int all = all_data();
    for (bool plain : {true, false}) {
      SPANTEX_TRY(echoes(0, plain));
      SPANTEX_TRY(echoes(uint8_t(all), plain));
      for (int k = 0; k < lines_.data_bits(); ++k) {
        SPANTEX_TRY(echoes(uint8_t(1 << k), plain));
        SPANTEX_TRY(echoes(uint8_t(all & ~(1 << k)), plain));
      }
    }
    for (int pattern = 0; pattern <= all; ++pattern) SPANTEX_TRY(echoes(uint8_t(pattern), false));
    SPANTEX_TRY(walks());
    return lines_.set_control({});
  }

  // What the steps above cannot tell apart shows where levels meet that they keep apart: out of reset with data high, one byte after another without
  // rest, nothing driven. The same levels each time, at random; the clock falls first and rises last, and the host drives only towards the device.
  status walks() {
    random_source random(1);
    bench::control_lines c{.reset = true};
    int latched = 0;
    SPANTEX_TRY(lines_.set_control({}));
    for (int n = 0; n < walk_steps; ++n) {
      const uint64_t x = random.next();
      const bool in_reset = (x >> 8) % 8 != 0, drives = (x & 8) != 0, entered = in_reset && !c.reset;
      SPANTEX_TRY(lines_.set_control({.to_host = c.to_host, .command = c.command, .reset = c.reset}));
      if (c.reset) SPANTEX_TRY(follows({false, c.command, c.to_host}));
      SPANTEX_TRY(lines_.release_data());
      if (c.reset && !in_reset) SPANTEX_TRY(leaves_reset());
      c = {in_reset && (x & 1) != 0, in_reset && (x & 2) != 0, (x & 4) != 0, in_reset};
      SPANTEX_TRY(lines_.set_control({.to_host = c.to_host, .command = c.command, .reset = c.reset}));
      const int data = drives ? int(x >> 16) & all_data() : 0;
      if (drives && !c.to_host) SPANTEX_TRY(drives_data(uint8_t(data)));
      SPANTEX_TRY(lines_.set_control(c));
      if (entered) latched = 0;
      if (c.clock && !c.to_host) latched = data;
      const bool answers = c.clock && c.to_host;
      const bench::status_lines shown = in_reset ? bench::status_lines{c.clock, c.command, c.to_host} : bench::status_lines{};
      const int wanted = bits_of(shown) | (answers ? echo_of(latched, c.command) : 0);
      SPANTEX_TRY(observe(uint16_t(wanted), "step " + std::to_string(n) + " of the walk, " + levels_of(c), [&](uint16_t& seen) { return read_all(answers, seen); }));
    }
    return lines_.release_data();
  }

  // Once to make them outputs, once to set them: between the level of an output and the note that it is one, gpio-sim still takes the other end's pull.
  status drives_data(uint8_t byte) {
    SPANTEX_TRY(lines_.drive_data(byte));
    return lines_.drive_data(byte);
  }

  // As bench_link leaves it: command stays high until busy falls, for a device that reads one line after another may see command fall before reset.
  status leaves_reset() {
    SPANTEX_TRY(lines_.set_control({.command = true, .reset = true}));
    SPANTEX_TRY(follows({.busy = true}));
    SPANTEX_TRY(lines_.set_control({.command = true}));
    return follows({});
  }

  // The device takes data while it sees the clock high, so they stay until it shows that the clock has fallen.
  status follows(const bench::status_lines& shown) {
    uint16_t seen = 0;
    return settles(bits_of(shown), seen, [&](uint16_t& now) { return read_shown(now); });
  }

  // Reads until the levels are as wanted, or have had time to be: pauses are added up, so that time in which nobody ran does not count.
  template <class Read>
  status settles(uint16_t wanted, uint16_t& seen, Read read) {
    uint64_t waited = 0;
    for (uint64_t pause = settle_ns_ / 1024 + 1;; pause = std::min(2 * pause, settle_ns_ / 16 + 1)) {
      SPANTEX_TRY(read(seen));
      if (seen == wanted || waited >= settle_ns_) return status::ok;
      lines_.pause(pause);
      waited += pause;
    }
  }

  int all_data() const { return (1 << lines_.data_bits()) - 1; }
  // What comes back of a byte.
  int echo_of(int byte, bool plain) const {
    const int turned = (byte << 1 | byte >> (lines_.data_bits() - 1)) & all_data();
    return plain ? turned : turned ^ all_data();
  }
  static uint16_t bits_of(const bench::status_lines& s) {
    return uint16_t((s.ready ? bit_of(wire::ready) : 0) | (s.busy ? bit_of(wire::busy) : 0) | (s.error ? bit_of(wire::error) : 0));
  }
  status read_all(bool with_data, uint16_t& seen) {
    uint16_t byte = 0;
    SPANTEX_TRY(read_shown(seen));
    if (with_data) SPANTEX_TRY(read_byte(byte));
    seen = uint16_t(seen | byte);
    return status::ok;
  }

  template <class Read>
  status observe(uint16_t wanted, const std::string& where, Read read) {
    uint16_t seen = 0;
    SPANTEX_TRY(settles(wanted, seen, read));
    // A bridge can close a loop through the device, and then levels swing: what they are just now says nothing.
    for (uint64_t k = 1; seen != wanted && seen != unstable && k <= 8; ++k) {
      uint16_t again = 0;
      lines_.pause(k * (settle_ns_ / 64 + 1));
      SPANTEX_TRY(read(again));
      if (again != seen) seen = unstable;
    }
    o_.seen.push_back(seen);
    o_.wanted.push_back(wanted);
    o_.where.push_back(where);
    return status::ok;
  }

  status read_shown(uint16_t& seen) {
    bench::status_lines s;
    SPANTEX_TRY(lines_.read_status(s));
    seen = bits_of(s);
    return status::ok;
  }

  status read_byte(uint16_t& seen) {
    uint8_t byte = 0;
    SPANTEX_TRY(lines_.read_data(byte));
    seen = byte;
    return status::ok;
  }

  status shows(const bench::control_lines& c, const bench::status_lines& wanted) {
    SPANTEX_TRY(lines_.set_control(c));
    return observe(bits_of(wanted), levels_of(c), [&](uint16_t& seen) { return read_shown(seen); });
  }

  // A byte there and back. Lines are changed one after the other: data first, then the clock.
  status echoes(uint8_t pattern, bool plain) {
    SPANTEX_TRY(lines_.set_control({.reset = true}));
    SPANTEX_TRY(drives_data(pattern));
    SPANTEX_TRY(shows({.clock = true, .reset = true}, {.ready = true}));
    SPANTEX_TRY(shows({.reset = true}, {}));
    SPANTEX_TRY(lines_.release_data());
    SPANTEX_TRY(lines_.set_control({.to_host = true, .command = plain, .reset = true}));
    SPANTEX_TRY(shows({.clock = true, .to_host = true, .command = plain, .reset = true}, {true, plain, true}));
    const std::string where = "data " + std::to_string(pattern) + (plain ? " plain" : " complemented");
    SPANTEX_TRY(observe(uint16_t(echo_of(pattern, plain)), where, [&](uint16_t& seen) { return read_byte(seen); }));
    SPANTEX_TRY(lines_.set_control({.to_host = true, .reset = true}));
    return shows({.reset = true}, {});
  }

  bench_lines& lines_;
  uint64_t settle_ns_;
  observations o_;
};

// What the steps see on simulated wires with a fault. The device is the library's: a fault may take it out of reset, and then it answers.
template <int DataBits>
std::vector<uint16_t> simulated(const wire_fault& fault) {
  simulated_bench<fixed_profile<profiles::seed>, DataBits> bench;
  bench.lines().add(fault);
  return tester(bench, 50 * simulated_lines::call_ns).run().seen;
}

int differing(const std::vector<uint16_t>& a, const std::vector<uint16_t>& b) {
  int n = 0;
  for (size_t k = 0; k < a.size(); ++k) n += a[k] != b[k];
  return n;
}

struct dictionary_entry { std::string name; std::vector<uint16_t> seen; };

template <int DataBits>
const std::vector<dictionary_entry>& dictionary() {
  static const std::vector<dictionary_entry> entries = [] {
    std::vector<dictionary_entry> all{{"no device, or one that does not echo", simulated<DataBits>({wire_fault_kind::hangs, wire::d0, wire::d0, 1, 0})}};
    for (const wire_fault& f : single_line_faults(DataBits)) all.push_back({short_text(f), simulated<DataBits>(f)});
    return all;
  }();
  return entries;
}

// The faults that come nearest: exactly, unless a bridge makes levels swing, which no two runs do alike.
void explain(const std::vector<dictionary_entry>& entries, const observations& o, line_report& r) {
  r.unexplained = int(r.symptoms.size()) / 2;  // what explains less explains nothing
  for (const dictionary_entry& e : entries) {
    const int n = e.seen.size() == o.seen.size() ? differing(e.seen, o.seen) : INT32_MAX;
    if (n > r.unexplained) continue;
    if (n < r.unexplained) r.suspects.clear();
    r.unexplained = n;
    r.suspects.push_back(e.name);
  }
}

std::string lines_in(uint16_t bits) {
  if (bits == unstable) return "not steady";
  std::string s;
  for (int k = 0; k < wire_count; ++k)
    if ((bits >> k & 1) != 0) s += (s.empty() ? "" : " ") + std::string(wire_names[k]);
  return s.empty() ? "none" : s;
}

}  // namespace

std::vector<wire_fault> single_line_faults(int data_bits) {
  std::vector<wire_fault> all;
  const auto exists = [&](int k) { return k < data_bits || k >= int(wire::clock); };
  for (int a = 0; a < wire_count; ++a) {
    if (!exists(a)) continue;
    for (wire_fault_kind k : {wire_fault_kind::stuck_low, wire_fault_kind::stuck_high}) all.push_back({k, wire(a), wire(a), 1, 0});
    for (int b = a + 1; b < wire_count; ++b)
      for (wire_fault_kind k : {wire_fault_kind::bridged_low, wire_fault_kind::bridged_high, wire_fault_kind::swapped})
        if (exists(b)) all.push_back({k, wire(a), wire(b), 1, 0});
  }
  return all;
}

std::string short_text(const wire_fault& f) {
  const std::string a = wire_names[int(f.a)], b = wire_names[int(f.b)];
  return f.kind <= wire_fault_kind::stuck_high ? a + " " + to_string(f.kind) : a + " and " + b + " " + to_string(f.kind);
}

line_report test_lines(bench_lines& lines, uint64_t settle_ns) {
  const observations o = tester(lines, settle_ns).run();
  line_report r;
  r.result = o.result;
  r.steps = int(o.seen.size());
  if (o.result != status::ok) return r;
  for (size_t k = 0; k < o.seen.size(); ++k)
    if (o.seen[k] != o.wanted[k]) r.symptoms.push_back(o.where[k] + ": high: " + lines_in(o.seen[k]) + ", expected " + lines_in(o.wanted[k]));
  if (r.symptoms.empty()) return r;
  r.result = status::mismatch;
  explain(lines.data_bits() == 8 ? dictionary<8>() : dictionary<4>(), o, r);
  return r;
}

}  // namespace spantex::sim
