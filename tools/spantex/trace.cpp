// SPDX-License-Identifier: Apache-2.0
// spantex trace: what the simulated engine does in which cycle, as a waveform or a timeline.
#include <stdio.h>

#include <memory>
#include <optional>
#include <sstream>
#include <utility>

#include <sim/trace.hpp>
#include "commands.hpp"
#include "options.hpp"

namespace spantex::tool {
namespace {

struct trace_options {
  drawing_options drawing;
  subject_options subject;
  std::string vcd, json, out, stats;
};

// Up to two writers behind one sink.
class both final : public sim::trace_sink {
 public:
  both(sim::trace_sink* a, sim::trace_sink* b) : sinks_{a, b} {}
  void load(const sim::load_record& r) override { each([&](sim::trace_sink& s) { s.load(r); }); }
  void compute(const sim::compute_record& r) override { each([&](sim::trace_sink& s) { s.compute(r); }); }
  void stall(sim::interval t) override { each([&](sim::trace_sink& s) { s.stall(t); }); }
  void mark(sim::cycle at, event what) override { each([&](sim::trace_sink& s) { s.mark(at, what); }); }
  void settled(sim::cycle before) override { each([&](sim::trace_sink& s) { s.settled(before); }); }

 private:
  template <class Call>
  void each(Call call) {
    for (sim::trace_sink* s : sinks_)
      if (s != nullptr) call(*s);
  }
  sim::trace_sink* sinks_[2];
};

void print_summary(const sim::counters& m) {
  const auto percent = [](sim::cycle part, sim::cycle whole) { return whole == 0 ? 0.0 : 100.0 * double(part) / double(whole); };
  const auto count = [](uint64_t n) { return static_cast<unsigned long long>(n); };
  printf("cycles          %llu (%llu pixels)\n", count(m.total_cycles), count(m.pixels));
  printf("loading         %llu cycles, %llu words, %.1f %% hidden by the other half\n", count(m.load_cycles), count(m.words_loaded),
         percent(m.hidden_load_cycles, m.load_cycles));
  printf("stalls          %llu cycles\n", count(m.stall_cycles));
  printf("bank conflicts  %llu\n", count(m.bank_conflicts));
}

void run(const trace_options& o) {
  sim::draw_options drawing = o.drawing.resolve();
  if (o.vcd.empty() && o.json.empty()) throw sim::input_error("trace: nothing to write: give --vcd, --json or both");
  const sim::output_file vcd = wanted_output(o.vcd), json = wanted_output(o.json), out = wanted_output(o.out), stats = wanted_output(o.stats);
  const subject_options::loaded subject(o.subject, o.drawing);
  check_outputs({{"--vcd", o.vcd}, {"--json", o.json}, {"--out", o.out}, {"--stats", o.stats}}, subject.files());
  const sim::scene s = subject.at(0);
  std::ostringstream waveform, timeline;
  sim::draw_result r;
  {
    std::optional<sim::vcd_writer> vcd_sink;
    std::optional<sim::timeline_writer> json_sink;
    if (vcd.wanted()) vcd_sink.emplace(waveform);
    if (json.wanted()) json_sink.emplace(timeline);
    both sink(vcd_sink ? &*vcd_sink : nullptr, json_sink ? &*json_sink : nullptr);
    drawing.engine = sim::engine_choice::simulated;
    drawing.sink = &sink;
    r = draw_with_bar(s, drawing);
  }
  sim::output_files files;
  if (vcd.wanted()) files.write(vcd, waveform.view());
  if (json.wanted()) files.write(json, timeline.view());
  if (out.wanted()) files.write(out, sim::encode_png(r.picture));
  if (stats.wanted()) files.write(stats, stats_json(r, drawing, {}, subject.textures_missing()));
  files.commit();
  print_summary(r.machine);
}

}  // namespace

void add_trace_command(CLI::App& app) {
  const auto o = std::make_shared<trace_options>();
  CLI::App& sub = *app.add_subcommand("trace", "draw on the simulated engine and write what it did, cycle by cycle");
  o->subject.add_to(sub, true);
  o->drawing.add_to(sub, false);
  sub.add_option("--vcd", o->vcd, "value change dump, for GTKWave");
  sub.add_option("--json", o->json, "timeline, for Perfetto or chrome://tracing");
  sub.add_option("--out", o->out, "the picture, PNG");
  sub.add_option("--stats", o->stats, "counts as JSON");
  sub.add_flag("--single-half", o->drawing.single_half, "use one half of the engine: what double buffering hides becomes visible");
  sub.callback([o] { run(*o); });
}

}  // namespace spantex::tool
