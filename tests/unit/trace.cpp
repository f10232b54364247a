// SPDX-License-Identifier: Apache-2.0
// The two trace writers: what they write is read back by parsers of its own and held against the engine's counters.
//
// Streams come before CMocka, whose macro `fail` hides their member.
#include <map>
#include <sstream>
#include <string>

#include <nlohmann/json.hpp>

#include "tests/support.hpp"

#include <hal/sim_engine.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

using standard_profile = fixed_profile<profiles::standard>;

// Draws a plane with a trace and tells what the engine counted.
template <class Writer>
sim::counters traced(std::ostream& out, int32_t width, int32_t height, bool single_half = false) {
  static picture p;
  p.reset(width, height);
  Writer writer(out);
  sim_engine<standard_profile> engine({}, {}, &writer);
  renderer<sim_engine<standard_profile>, standard_profile> r(engine, {}, p.frame());
  r.single_half(single_half);
  const texture_view t = photographic_map(128, 128, 3).view(wrap::repeat, wrap::repeat);
  if (r.draw(sample_plane(1), t, filter::trilinear, p.area()) != status::ok || r.finish() != status::ok) std::abort();
  writer.finish();
  return engine.counters();
}

// --- VCD -----------------------------------------------------------------------------------------------

// A waveform read back: for each signal the cycles it spent at each value. Anything against the format is a reason.
struct waveform {
  struct signal {
    std::string name;
    size_t bits = 0;
    uint64_t value = 0, since = 0;
    std::map<uint64_t, uint64_t> cycles_at;
  };
  std::map<std::string, signal> signals;  // by identifier
  std::string timescale, wrong;
  uint64_t now = 0;
  bool in_steps = false;                  // `now` is set

  const signal& named(const std::string& name) const {
    static const signal none;
    for (const auto& [id, s] : signals)
      if (s.name == name) return s;
    return none;
  }
  uint64_t cycles_at(const std::string& name, uint64_t value) const {
    const signal& s = named(name);
    const auto at = s.cycles_at.find(value);
    return at == s.cycles_at.end() ? 0 : at->second;
  }
  uint64_t value(const std::string& name) const { return named(name).value; }

  void refuse(const std::string& why) { if (wrong.empty()) wrong = why; }

  // A half that is loading while it computes would show as one signal with two values: the state is one vector, so what can be
  // checked is that loader and pipeline never work on one half.
  void check_instant() {
    const bool loads = value("engine.loader.busy") == 1, issues = value("engine.pipeline.busy") == 1;
    if (loads && issues && value("engine.loader.half") == value("engine.pipeline.half"))
      refuse("loader and pipeline work on one half at " + std::to_string(now));
    if (loads && value(value("engine.loader.half") == 0 ? "engine.half0.state" : "engine.half1.state") != 1)
      refuse("the loader's half is not in state loading at " + std::to_string(now));
    if (issues && value(value("engine.pipeline.half") == 0 ? "engine.half0.state" : "engine.half1.state") != 3)
      refuse("the pipeline's half is not in state computing at " + std::to_string(now));
    if (issues && value("engine.pipeline.stall") == 1) refuse("busy and stalled at " + std::to_string(now));
  }

  SPANTEX_WRAPS void advance(uint64_t to) {  // before the first step `since` may lie ahead: the sum comes out right
    if (in_steps && to <= now) refuse("time runs backwards at " + std::to_string(to));
    if (in_steps) check_instant();
    for (auto& [id, s] : signals) {
      s.cycles_at[s.value] += to - s.since;
      s.since = to;
    }
    now = to;
    in_steps = true;
  }

  void change(const std::string& id, const std::string& digits) {
    const auto at = signals.find(id);
    if (at == signals.end()) return refuse("undeclared identifier " + id);
    if (digits.empty() || digits.size() > at->second.bits || digits.find_first_not_of("01") != std::string::npos)
      return refuse("bad value " + digits + " for " + at->second.name);
    at->second.value = std::stoull(digits, nullptr, 2);
  }
};

void read_declarations(std::istream& in, waveform& w) {
  std::string word, scope;
  std::vector<std::string> scopes;
  while (in >> word && word != "$enddefinitions") {
    std::vector<std::string> body;
    for (std::string next; in >> next && next != "$end";) body.push_back(next);
    if (word == "$timescale") w.timescale = body.at(0);
    else if (word == "$scope") scopes.push_back(body.at(1));
    else if (word == "$upscope") scopes.pop_back();
    else if (word == "$var") {
      std::string name;
      for (const std::string& s : scopes) name += s + ".";
      if (w.signals.count(body.at(2)) != 0) w.refuse("identifier declared twice");
      w.signals[body.at(2)] = {name + body.at(3), size_t(std::stoi(body.at(1))), 0, 0, {}};
    } else if (word != "$version" && word != "$comment") w.refuse("unknown declaration " + word);
  }
  if (!scopes.empty()) w.refuse("scopes left open");
  in >> word;  // the $end of $enddefinitions
}

waveform read_vcd(std::istream& in) {
  waveform w;
  read_declarations(in, w);
  for (std::string word; in >> word;) {
    if (word[0] == '#') w.advance(std::stoull(word.substr(1)));
    else if (word == "$dumpvars" || word == "$end") continue;
    else if (word[0] == 'b') {
      std::string id;
      in >> id;
      w.change(id, word.substr(1));
    } else w.change(word.substr(1), word.substr(0, 1));
  }
  w.check_instant();
  return w;
}

void check_waveform(bool single_half) {
  static std::stringstream text;
  text.str({});
  text.clear();
  const sim::counters c = traced<vcd_writer>(text, 96, 64, single_half);
  static waveform w;
  w = read_vcd(text);
  if (!w.wrong.empty()) fail_msg("%s", w.wrong.c_str());
  assert_string_equal(w.timescale.c_str(), "1ns");
  assert_int_equal(w.signals.size(), vcd_writer::signal_count);
  assert_int_equal(w.now, c.total_cycles);
  assert_int_equal(w.cycles_at("engine.loader.busy", 1), c.load_cycles);
  assert_int_equal(w.cycles_at("engine.pipeline.busy", 1), c.compute_cycles);
  assert_int_equal(w.cycles_at("engine.pipeline.stall", 1), c.stall_cycles);
  assert_int_equal(w.value("engine.pipeline.pixel_count"), c.pixels);
  assert_int_equal(w.cycles_at("engine.half0.state", 1) + w.cycles_at("engine.half1.state", 1), c.load_cycles);
  assert_true((w.cycles_at("engine.half1.state", 3) == 0) == single_half);
}

SPANTEX_CASE(waveform_reads_back_and_agrees_with_the_counters) { check_waveform(false); }
SPANTEX_CASE(waveform_of_one_half) { check_waveform(true); }

SPANTEX_CASE(waveform_of_nothing_is_complete) {
  static std::stringstream text;
  { vcd_writer writer(text); }
  static waveform w;
  w = read_vcd(text);
  if (!w.wrong.empty()) fail_msg("%s", w.wrong.c_str());
  assert_int_equal(w.signals.size(), vcd_writer::signal_count);
}

// The reader must be able to say no.
SPANTEX_CASE(waveform_reader_refuses_what_is_wrong) {
  const char* head = "$timescale 1ns $end $scope module engine $end $scope module loader $end $var wire 1 ! busy $end "
                     "$upscope $end $upscope $end $enddefinitions $end ";
  for (const char* body : {"#0 0! #5 1! #5 0!", "#0 0! #5 1! #4 0!", "#0 0\"", "#0 b10 !", "#0 x!"}) {
    std::stringstream text(std::string(head) + body);
    const std::string wrong = read_vcd(text).wrong;
    if (wrong.empty()) fail_msg("accepted: %s", body);
  }
}

SPANTEX_CASE(waveform_reader_refuses_a_half_loaded_while_computing) {
  static std::stringstream text;
  {
    vcd_writer writer(text);
    writer.compute({half::first, 64, {10, 74}, 85});
    writer.load({half::first, false, 0, 8, {20, 30}});
  }
  assert_false(read_vcd(text).wrong.empty());
}

// --- timeline ------------------------------------------------------------------------------------------

struct track_totals {
  std::string name, wrong;
  uint64_t end = 0;
  std::map<std::string, uint64_t> cycles;  // by slice name
};

std::map<int, track_totals> read_timeline(const std::string& text) {
  std::map<int, track_totals> tracks;
  const nlohmann::json document = nlohmann::json::parse(text);
  for (const nlohmann::json& e : document.at("traceEvents")) {
    track_totals& t = tracks[e.at("tid").get<int>()];
    const std::string phase = e.at("ph");
    if (phase == "M") t.name = e.at("args").at("name");
    if (phase != "X") continue;
    const uint64_t begin = e.at("ts"), length = e.at("dur");
    if (begin < t.end) t.wrong = "slices overlap at " + std::to_string(begin);
    t.end = begin + length;
    t.cycles[e.at("name")] += length;
  }
  return tracks;
}

SPANTEX_CASE(timeline_reads_back_and_agrees_with_the_counters) {
  static std::stringstream text;
  const sim::counters c = traced<timeline_writer>(text, 96, 64);
  static std::map<int, track_totals> tracks;
  tracks = read_timeline(text.str());
  assert_int_equal(tracks.size(), 5);
  const char* names[] = {"span engine", "loader", "pipeline", "half 0", "half 1"};
  for (int k = 0; k < 5; ++k) {
    assert_string_equal(tracks[k].name.c_str(), names[k]);
    if (!tracks[k].wrong.empty()) fail_msg("%s: %s", names[k], tracks[k].wrong.c_str());
  }
  assert_int_equal(tracks[1].cycles["words"] + tracks[1].cycles["coefficients"], c.load_cycles);
  assert_int_equal(tracks[2].cycles["issue"], c.compute_cycles);
  assert_int_equal(tracks[2].cycles["stall"], c.stall_cycles);
  assert_int_equal(tracks[3].cycles["load"] + tracks[4].cycles["load"], c.load_cycles);
  const latencies t;
  const uint64_t way = uint64_t(t.coordinate_fill_cycles + t.fetch_fill_cycles + t.filter_fill_cycles + t.write_out_cycles);
  assert_int_equal(tracks[3].cycles["compute"] + tracks[4].cycles["compute"], c.compute_cycles + c.jobs * way);
}

SPANTEX_CASE(timeline_of_nothing_is_a_document) {
  static std::stringstream text;
  { timeline_writer writer(text); }
  assert_int_equal(nlohmann::json::parse(text.str()).at("traceEvents").size(), 5);
}

// --- both ----------------------------------------------------------------------------------------------

// Counts bytes, keeps none.
struct counting_buffer : std::streambuf {
  uint64_t bytes = 0;
  int overflow(int c) override { ++bytes; return c; }
  std::streamsize xsputn(const char*, std::streamsize n) override { bytes += uint64_t(n); return n; }
};

template <class Writer>
uint64_t bytes_of_a_frame() {
  counting_buffer buffer;
  std::ostream out(&buffer);
  (void)traced<Writer>(out, 640, 480);
  return buffer.bytes;
}

SPANTEX_CASE(whole_frame_stays_small) {
  const uint64_t vcd = bytes_of_a_frame<vcd_writer>(), timeline = bytes_of_a_frame<timeline_writer>();
  print_message("640x480: VCD %.1f MB, timeline %.1f MB\n", double(vcd) * 1e-6, double(timeline) * 1e-6);
  assert_true(vcd < 64'000'000);
  assert_true(timeline < 64'000'000);
}

SPANTEX_CASE(tracing_changes_no_counter) {
  static std::stringstream vcd, timeline;
  const sim::counters a = traced<vcd_writer>(vcd, 96, 64), b = traced<timeline_writer>(timeline, 96, 64);
  static picture p;
  p.reset(96, 64);
  sim_engine<standard_profile> engine;
  const texture_view t = photographic_map(128, 128, 3).view(wrap::repeat, wrap::repeat);
  SPANTEX_ASSERT_OK(render_plane(standard_profile{}, engine, sample_plane(1), t, filter::trilinear, p));
  assert_memory_equal(&a, &engine.counters(), sizeof a);
  assert_memory_equal(&b, &engine.counters(), sizeof b);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(waveform_reads_back_and_agrees_with_the_counters),
      cmocka_unit_test(waveform_of_one_half),
      cmocka_unit_test(waveform_of_nothing_is_complete),
      cmocka_unit_test(waveform_reader_refuses_what_is_wrong),
      cmocka_unit_test(waveform_reader_refuses_a_half_loaded_while_computing),
      cmocka_unit_test(timeline_reads_back_and_agrees_with_the_counters),
      cmocka_unit_test(timeline_of_nothing_is_a_document),
      cmocka_unit_test(whole_frame_stays_small),
      cmocka_unit_test(tracing_changes_no_counter),
  };
  return sim::run_suite("trace", tests);
}
