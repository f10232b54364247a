// SPDX-License-Identifier: Apache-2.0
// The two trace writers of sim/trace.hpp.
#include <sim/trace.hpp>

#include <limits>
#include <ostream>
#include <string>

#include <nlohmann/json.hpp>

namespace spantex::sim {

// --- VCD (IEEE 1364, section 18) -----------------------------------------------------------------------

namespace {

struct signal_info {
  const char* scope;
  const char* name;
  int bits;
};

// In the order of vcd_writer::signal; scopes stand together.
constexpr signal_info signals[vcd_writer::signal_count] = {
    {"loader", "busy", 1},          {"loader", "half", 1},         {"loader", "coefficients", 1}, {"loader", "address", 16},
    {"pipeline", "busy", 1},        {"pipeline", "half", 1},       {"pipeline", "stall", 1},      {"pipeline", "span_pixels", 8},
    {"pipeline", "pixel_count", 64}, {"pipeline", "span_x", 16},   {"pipeline", "span_y", 16},    {"half0", "state", 3},
    {"half1", "state", 3}};

enum half_state : uint64_t { empty, loading, loaded, computing, done };

constexpr int state_of(half h) { return h == half::first ? vcd_writer::half0_state : vcd_writer::half1_state; }

// VCD identifiers are printable characters from '!'.
constexpr char id_of(int which) { return char('!' + which); }

std::string binary(uint64_t value) {
  std::string digits;
  do {
    digits.insert(digits.begin(), char('0' + (value & 1)));
    value >>= 1;
  } while (value != 0);
  return digits;
}

void write_change(std::ostream& out, int which, uint64_t value) {
  if (signals[which].bits == 1) out << (value & 1) << id_of(which) << '\n';
  else out << 'b' << binary(value) << ' ' << id_of(which) << '\n';
}

void write_declarations(std::ostream& out) {
  out << "$version spantex simulator $end\n$comment state of a half: 0 empty, 1 loading, 2 loaded, 3 computing, 4 done $end\n"
         "$timescale 1ns $end\n$scope module engine $end\n";
  std::string scope;
  for (int k = 0; k < vcd_writer::signal_count; ++k) {
    if (scope != signals[k].scope) {
      if (!scope.empty()) out << "$upscope $end\n";
      scope = signals[k].scope;
      out << "$scope module " << scope << " $end\n";
    }
    out << "$var wire " << signals[k].bits << ' ' << id_of(k) << ' ' << signals[k].name;
    if (signals[k].bits > 1) out << " [" << signals[k].bits - 1 << ":0]";
    out << " $end\n";
  }
  out << "$upscope $end\n$upscope $end\n$enddefinitions $end\n#0\n$dumpvars\n";
  for (int k = 0; k < vcd_writer::signal_count; ++k) write_change(out, k, 0);
  out << "$end\n";
}

}  // namespace

vcd_writer::vcd_writer(std::ostream& out) : out_(out) { write_declarations(out_); }

void vcd_writer::set(cycle at, int which, uint64_t value) { pending_[{at, which}] = value; }

void vcd_writer::flush(cycle before) {
  while (!pending_.empty() && pending_.begin()->first.first < before) {
    const auto [key, value] = *pending_.begin();
    pending_.erase(pending_.begin());
    const auto [at, which] = key;
    if (current_[which] == value) continue;
    if (at != now_) out_ << '#' << at << '\n';
    now_ = at;
    current_[which] = value;
    write_change(out_, which, value);
  }
}

void vcd_writer::load(const load_record& r) {
  set(r.time.begin, loader_busy, 1);
  set(r.time.begin, loader_half, uint64_t(r.target));
  set(r.time.begin, loader_coefficients, r.coefficients ? 1 : 0);
  set(r.time.begin, loader_address, uint64_t(r.first_word));
  set(r.time.end, loader_busy, 0);
  set(r.time.begin, state_of(r.target), loading);
  set(r.time.end, state_of(r.target), loaded);
}

void vcd_writer::compute(const compute_record& r) {
  pixels_ += uint64_t(r.pixels);
  set(r.issue.begin, pipeline_busy, 1);
  set(r.issue.begin, pipeline_half, uint64_t(r.target));
  set(r.issue.begin, pipeline_span_pixels, uint64_t(r.pixels));
  set(r.issue.end, pipeline_busy, 0);
  set(r.end, pipeline_pixel_count, pixels_);
  set(r.issue.begin, state_of(r.target), computing);
  set(r.end, state_of(r.target), done);
}

void vcd_writer::stall(interval time) {
  set(time.begin, pipeline_stall, 1);
  set(time.end, pipeline_stall, 0);
}

void vcd_writer::mark(cycle at, event what) {
  if (what.kind != event_kind::span) return;
  set(at, pipeline_span_x, what.value & 0xFFFF);
  set(at, pipeline_span_y, what.value >> 16);
}

void vcd_writer::settled(cycle at) { flush(at); }

void vcd_writer::finish() {
  if (finished_) return;
  finished_ = true;
  const cycle last = pending_.empty() ? now_ : pending_.rbegin()->first.first;
  flush(std::numeric_limits<cycle>::max());
  if (last > now_) out_ << '#' << last << '\n';
}

// --- Chrome trace events -------------------------------------------------------------------------------

namespace {

enum track : int { loader_track = 1, pipeline_track, half_track };

constexpr int track_of(half h) { return half_track + int(h); }

nlohmann::json slice(const char* name, int on, interval time) {
  return {{"name", name}, {"ph", "X"}, {"pid", 1}, {"tid", on}, {"ts", time.begin}, {"dur", time.length()}};
}

nlohmann::json track_name(int on, const char* name) {
  return {{"name", "thread_name"}, {"ph", "M"}, {"pid", 1}, {"tid", on}, {"args", {{"name", name}}}};
}

}  // namespace

template <class Json>
void timeline_writer::write(const Json& entry) {
  out_ << (first_ ? "\n" : ",\n") << entry.dump();
  first_ = false;
}

timeline_writer::timeline_writer(std::ostream& out) : out_(out) {
  out_ << "{\"otherData\":{\"one cycle\":\"1 us\"},\"traceEvents\":[";
  write(nlohmann::json{{"name", "process_name"}, {"ph", "M"}, {"pid", 1}, {"tid", 0}, {"args", {{"name", "span engine"}}}});
  write(track_name(loader_track, "loader"));
  write(track_name(pipeline_track, "pipeline"));
  write(track_name(track_of(half::first), "half 0"));
  write(track_name(track_of(half::second), "half 1"));
}

void timeline_writer::load(const load_record& r) {
  nlohmann::json entry = slice(r.coefficients ? "coefficients" : "words", loader_track, r.time);
  entry["args"] = {{"half", int(r.target)}, {"first_word", r.first_word}, {"words", r.words}};
  write(entry);
  loading_slice& s = loading_[int(r.target)];
  if (s.open && s.time.end != r.time.begin) close_loading(r.target);
  if (!s.open) s = {r.time, 0, true};
  s.time.end = r.time.end;
  s.words += r.words;
}

void timeline_writer::close_loading(half h) {
  loading_slice& s = loading_[int(h)];
  if (!s.open) return;
  s.open = false;
  nlohmann::json entry = slice("load", track_of(h), s.time);
  entry["args"] = {{"words", s.words}};
  write(entry);
}

void timeline_writer::compute(const compute_record& r) {
  close_loading(r.target);
  nlohmann::json issue = slice("issue", pipeline_track, r.issue);
  issue["args"] = {{"half", int(r.target)}, {"pixels", r.pixels}};
  write(issue);
  nlohmann::json whole = slice("compute", track_of(r.target), {r.issue.begin, r.end});
  whole["args"] = {{"pixels", r.pixels}};
  write(whole);
}

void timeline_writer::stall(interval time) { write(slice("stall", pipeline_track, time)); }

void timeline_writer::mark(cycle at, event what) {
  nlohmann::json entry = {{"ph", "i"}, {"pid", 1}, {"tid", pipeline_track}, {"ts", at}, {"s", "t"}};
  constexpr const char* names[] = {"span", "frame end", "map upload", "write"};
  entry["name"] = names[int(what.kind)];
  if (what.kind == event_kind::span) entry["args"] = {{"x", what.value & 0xFFFF}, {"y", what.value >> 16}};
  if (what.kind == event_kind::map_upload) entry["args"] = {{"words", what.value}};
  if (what.kind == event_kind::write) entry["args"] = {{"pixels", what.value}};
  write(entry);
}

void timeline_writer::finish() {
  if (finished_) return;
  close_loading(half::first);
  close_loading(half::second);
  finished_ = true;
  out_ << "\n]}\n";
}

}  // namespace spantex::sim
