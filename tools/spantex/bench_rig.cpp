// SPDX-License-Identifier: Apache-2.0
// spantex bench-rig: a device under test at the end of GPIO lines (docs/BENCH.md): who it is, whether its wires are sound, and whether it draws what the
// simulator draws, bit by bit.
#include <stdio.h>

#include <fstream>
#include <memory>
#include <optional>
#include <random>
#include <sstream>

#include <nlohmann/json.hpp>

#include <hal/bench_engine.hpp>
#include <hal/gpiod_lines.hpp>
#include <hal/recording_engine.hpp>
#include <hal/sim_engine.hpp>
#include <sim/bench_compare.hpp>
#include <sim/bench_rig.hpp>
#include <sim/bench_self_test.hpp>
#include <sim/bench_wires.hpp>
#include <sim/broken_engine.hpp>
#include "commands.hpp"
#include "options.hpp"

namespace spantex::tool {
namespace {

using json = nlohmann::ordered_json;

constexpr int exit_found = 1;  // the wires are not sound, or a pixel differs

constexpr std::array<sim::named<sim::broken_part>, 9> broken_part_names{
    {{"answers", sim::broken_part::answers}, {"fetch", sim::broken_part::fetch}, {"filter", sim::broken_part::filter},
     {"write-out", sim::broken_part::write_out}, {"coordinates", sim::broken_part::coordinates}, {"level", sim::broken_part::level},
     {"coarse-fetch", sim::broken_part::coarse_fetch}, {"footprint", sim::broken_part::footprint}, {"memory-cell", sim::broken_part::memory_cell}}};

struct rig_options {
  std::string rig, json_out, broken;
  bool simulated = false;
  int simulated_bits = 8;
  std::optional<double> patience_s;

  void add_to(CLI::App& sub) {
    sub.add_option("--rig", rig, "rig file, JSON: chip, lines, limits");
    sub.add_flag("--simulated", simulated, "instead of a chip: wires and a device in this process");
    sub.add_option("--data-bits", simulated_bits, "with --simulated: 8 or 4 data lines");
    sub.add_option("--broken", broken, "with --simulated: one part of the device's engine is wrong: " + list_of(broken_part_names));
    sub.add_option("--patience", patience_s, "seconds to wait for a device that is gone, then to go on (default: as in the rig file)");
    sub.add_option("--json", json_out, "what was found, as JSON");
  }
};

// use(fixed_profile<P>{}) with the profile that was chosen.
template <class Use>
auto with_profile(sim::profile_choice p, Use use) {
  switch (p) {
    case sim::profile_choice::seed: return use(fixed_profile<profiles::seed>{});
    case sim::profile_choice::compact: return use(fixed_profile<profiles::compact>{});
    case sim::profile_choice::exact: return use(fixed_profile<profiles::exact>{});
    case sim::profile_choice::standard: break;
  }
  return use(fixed_profile<profiles::standard>{});
}

const profile& numbers_of(sim::profile_choice p) {
  return *with_profile(p, [](auto prof) { return &decltype(prof)::value; });
}

template <class Prof, int DataBits>
std::unique_ptr<bench_lines> simulated_device(sim::broken_part broken) {
  auto made = std::make_unique<sim::simulated_bench<Prof, DataBits, sim::broken_engine<Prof>>>();
  made->engine().break_at(broken);
  return made;
}

std::unique_ptr<bench_lines> simulated_device(sim::profile_choice p, int data_bits, sim::broken_part broken) {
  return with_profile(p, [&](auto prof) {
    return data_bits == 4 ? simulated_device<decltype(prof), 4>(broken) : simulated_device<decltype(prof), 8>(broken);
  });
}

std::unique_ptr<any_engine> simulator(sim::profile_choice p) {
  return with_profile(p, [](auto prof) -> std::unique_ptr<any_engine> { return std::make_unique<any_engine_of<sim_engine<decltype(prof)>>>(); });
}

// The wires as the options name them, open.
struct connection {
  sim::bench_rig rig;
  std::unique_ptr<bench_lines> lines;
  std::string name;

  connection(const rig_options& o, sim::profile_choice p) {
    check_outputs({{"--json", o.json_out}}, {o.rig});
    if (o.simulated == !o.rig.empty()) throw sim::input_error("bench-rig: give --rig FILE or --simulated, one of them");
    constexpr double day_s = 86400;
    if (o.patience_s && !(*o.patience_s >= 0 && *o.patience_s <= day_s)) throw sim::input_error("--patience: must be 0 to 86400 seconds");
    if (o.simulated_bits != 8 && o.simulated_bits != 4) throw sim::input_error("--data-bits: must be 8 or 4");
    if (!o.simulated && !o.broken.empty()) throw sim::input_error("--broken: goes with --simulated");
    if (o.simulated) {
      lines = simulated_device(p, o.simulated_bits, o.broken.empty() ? sim::broken_part::none : value_of(broken_part_names, o.broken, "part"));
      rig.settle_ns = 20'000;
      name = "simulated device";
    } else {
      rig = sim::load_rig(o.rig);
      name = rig.gpio.chip;
      auto gpio = std::make_unique<gpiod_lines>(rig.gpio);
      gpiod_lines::catch_signals();
      if (gpio->open() != status::ok) throw sim::input_error(gpio->trouble());
      lines = std::move(gpio);
    }
    if (o.patience_s) rig.limits.patience_ns = uint64_t(*o.patience_s * 1e9);
  }
  ~connection() { lines->release_all(); }
  connection(const connection&) = delete;
  connection& operator=(const connection&) = delete;

  [[noreturn]] void give_up(const std::string& trouble) const { throw sim::input_error(name + ": " + trouble); }
};

uint32_t some_seed() { return std::random_device{}(); }

void write_json(const rig_options& o, const json& j) {
  if (!o.json_out.empty()) sim::output_file(o.json_out).write(j.dump(2) + "\n");
}

json json_of(const bench_counters& c) {
  json exits = json::object();
  for (int k = 0; k < bench_exit_count; ++k)
    if (c.exits[size_t(k)] != 0) exits[to_string(bench_exit(k))] = c.exits[size_t(k)];
  return {{"exchanges", c.exchanges}, {"attempts", c.attempts}, {"retries", c.attempts - c.exchanges}, {"rereads", c.rereads}, {"bytes_out", c.bytes_out},
          {"bytes_in", c.bytes_in}, {"line_calls", c.line_calls}, {"resets", c.resets}, {"recoveries", c.recoveries},
          {"restored_words", c.restored_words}, {"pending_answers", c.pending_answers}, {"errors", exits}};
}

json json_of(const bench::identity& d) {
  json fields = json::object();
  int n = 0;
  detail::for_each_field(profile{}, [&](const char* name, int) { fields[name] = d.profile.value[n++]; });
  return {{"protocol_version", d.version}, {"coefficient_bytes", d.coefficient_bytes}, {"word_count", d.word_count}, {"burst_words", d.burst_words},
          {"profile", fields}};
}

// --- identify ------------------------------------------------------------------------------------------

struct identify_options {
  rig_options rig;
  std::string profile = "default";  // of the simulated device
};

void identify(const identify_options& o) {
  const auto p = value_of(sim::profile_names, o.profile, "profile");
  const connection c(o.rig, p);
  bench_engine engine(*c.lines, numbers_of(p), c.rig.limits, some_seed());
  bench_link link(*c.lines, c.rig.limits);
  bench::identity device;
  if (link.reset() != status::ok) c.give_up(link.trouble());
  if (engine.identify(device) != status::ok) c.give_up(engine.trouble());
  std::string known = "none of the library's";
  for (const auto& named : sim::profile_names) {
    const bench::profile_fields f = bench::fields_of(numbers_of(named.value));
    if (std::equal(std::begin(f.value), std::end(f.value), std::begin(device.profile.value))) known = std::string(named.name);
  }
  if (device.version != bench::protocol_version) c.give_up("protocol version " + std::to_string(device.version) + ", expected " + std::to_string(bench::protocol_version));
  printf("protocol        %d\nprofile         %s\nlocal memory    %d words a half\nburst           %d words\ncoefficients    %d bytes\n", device.version, known.c_str(),
         device.word_count, device.burst_words, device.coefficient_bytes);
  json j = json_of(device);
  j["profile_name"] = known;
  write_json(o.rig, j);
}

// --- self-test -----------------------------------------------------------------------------------------

void self_test(const identify_options& o) {
  const auto p = value_of(sim::profile_names, o.profile, "profile");
  const connection c(o.rig, p);
  const sim::line_report r = sim::test_lines(*c.lines, c.rig.settle_ns);
  if (r.result != status::ok && r.result != status::mismatch) c.give_up(c.lines->trouble());
  json j{{"levels_compared", r.steps}, {"sound", r.result == status::ok}, {"symptoms", r.symptoms}, {"suspects", r.suspects}, {"unexplained", r.unexplained}};
  if (r.result != status::ok) {
    printf("wires           not sound: %zu of %d levels differ\n", r.symptoms.size(), r.steps);
    for (size_t k = 0; k < r.symptoms.size() && k < 8; ++k) printf("                %s\n", r.symptoms[k].c_str());
    for (const std::string& s : r.suspects) printf("suspect         %s%s\n", s.c_str(), r.unexplained == 0 ? "" : " (explains most)");
    if (r.suspects.empty()) printf("suspect         no single fault explains this\n");
    write_json(o.rig, j);
    throw CLI::RuntimeError(exit_found);
  }
  printf("wires           sound: %d levels compared\n", r.steps);

  // Frames too: every byte.
  bench_engine engine(*c.lines, numbers_of(p), c.rig.limits, some_seed());
  if (engine.connect() != status::ok) c.give_up(engine.trouble());
  uint8_t bytes[16];
  for (int k = 0; k < 16; ++k) {
    for (int n = 0; n < 16; ++n) bytes[n] = uint8_t(16 * k + n);
    if (engine.loop_back(bytes, 16) != status::ok) c.give_up(engine.trouble());
  }
  engine.close();
  printf("loop-back       16 frames of 16 bytes, %llu retries\n", static_cast<unsigned long long>(engine.counters().attempts - engine.counters().exchanges));
  j["loop_back"] = json_of(engine.counters());
  write_json(o.rig, j);
}

// --- run -----------------------------------------------------------------------------------------------

struct run_options {
  rig_options rig;
  drawing_options drawing;
  subject_options subject;
  std::string out, timeline, record;
};

// Chrome trace events of every operation: what the wires were busy with.
class timeline {
 public:
  void add(const bench_engine::slice& s) {
    if (s.what == operation::mark) {
      if (s.note.kind == event_kind::span)
        events_.push_back({{"name", "span " + std::to_string(s.note.value & 0xFFFF) + "," + std::to_string(s.note.value >> 16)}, {"ph", "i"}, {"s", "p"},
                           {"ts", us(s.begin_ns)}, {"pid", 1}, {"tid", 1}});
      return;
    }
    json e{{"name", to_string(s.what)}, {"ph", "X"}, {"ts", us(s.begin_ns)}, {"dur", double(s.end_ns - s.begin_ns) / 1000}, {"pid", 1}, {"tid", 1 + int(s.which)}};
    e["args"] = {{"status", to_string(s.result)}};
    if (s.words > 0) e["args"]["words"] = s.words;
    events_.push_back(std::move(e));
  }
  std::string text() const { return json{{"displayTimeUnit", "ns"}, {"traceEvents", events_}}.dump() + "\n"; }

 private:
  double us(uint64_t ns) {
    if (!begun_) begin_ns_ = ns;
    begun_ = true;
    return double(ns - begin_ns_) / 1000;
  }
  json events_ = json::array();
  uint64_t begin_ns_ = 0;
  bool begun_ = false;
};

std::string bytes_of(const recording& log) {
  std::ostringstream stream;
  if (!save(stream, log)) throw sim::input_error("--record: not enough memory");
  return stream.str();
}

void run(const run_options& o) {
  sim::draw_options drawing = o.drawing.resolve();
  if (o.drawing.space != "screen") throw sim::input_error("bench-rig: draws in screen space only");
  const sim::output_file out = wanted_output(o.out), report = wanted_output(o.rig.json_out), trace = wanted_output(o.timeline), record = wanted_output(o.record);
  const subject_options::loaded subject(o.subject, o.drawing);
  std::vector<std::string> inputs = subject.files();
  inputs.push_back(o.rig.rig);
  check_outputs({{"--out", o.out}, {"--json", o.rig.json_out}, {"--timeline", o.timeline}, {"--record", o.record}}, inputs);
  const sim::scene s = subject.at(0);

  const connection c(o.rig, drawing.profile);
  any_engine_of<bench_engine> device(*c.lines, numbers_of(drawing.profile), c.rig.limits, some_seed());
  bench_engine& bench = device.engine();
  timeline events;
  if (trace.wanted()) bench.observe([&](const bench_engine::slice& slice) { events.add(slice); });
  if (bench.connect() != status::ok) c.give_up(bench.trouble());
  recording log;
  any_engine_of<recording_engine<any_engine>> recorded(device, log);
  const std::unique_ptr<any_engine> reference = simulator(drawing.profile);
  any_engine& tested = record.wanted() ? static_cast<any_engine&>(recorded) : device;
  sim::comparing_engine both(tested, *reference, numbers_of(drawing.profile).fine_side);

  drawing.port = &both;
  drawing.threads = 1;
  const uint64_t begun = c.lines->now_ns();
  sim::draw_result r;
  std::string trouble;
  try {
    r = draw_with_bar(s, drawing);
  } catch (const sim::input_error&) {  // the device failed, or the two no longer agree on what a half holds
    trouble = bench.trouble();
  }
  const double seconds = double(c.lines->now_ns() - begun) * 1e-9;
  bench.close();

  const auto& d = both.difference();
  json j{{"scene", s.name}, {"profile", o.drawing.profile}, {"filter", o.drawing.filter}, {"width", s.size.width_px}, {"height", s.size.height_px},
         {"spans", both.spans()}, {"spans_differing", both.differing_spans()}, {"pixels_differing", both.differing_pixels()},
         {"words_loaded", r.work.words_loaded}, {"seconds", seconds}, {"words_per_second", seconds > 0 ? double(r.work.words_loaded) / seconds : 0.0},
         {"link", json_of(bench.counters())}};
  if (d)
    j["first_difference"] = {{"text", d->text()}, {"span_x", d->span_x}, {"span_y", d->span_y}, {"pixel", d->pixel}, {"stage", to_string(d->where)},
                             {"operation", d->operation_index}, {"half", int(d->which)}};
  if (!trouble.empty()) j["failed"] = trouble;
  sim::output_files files;
  if (report.wanted()) files.write(report, j.dump(2) + "\n");
  if (trace.wanted()) files.write(trace, events.text());
  if (record.wanted()) files.write(record, bytes_of(log));
  if (out.wanted() && trouble.empty()) files.write(out, sim::encode_png(r.picture));
  files.commit();
  if (!trouble.empty() && !d) c.give_up(trouble);

  const bench_counters& k = bench.counters();
  const auto count = [](uint64_t n) { return static_cast<unsigned long long>(n); };
  printf("%s, %dx%d\n", s.name.c_str(), s.size.width_px, s.size.height_px);
  printf("spans           %llu, %llu differ in %llu pixels\n", count(both.spans()), count(both.differing_spans()), count(both.differing_pixels()));
  printf("wires           %llu words loaded, %.0f a second; %llu bytes out, %llu in\n", count(r.work.words_loaded), seconds > 0 ? double(r.work.words_loaded) / seconds : 0.0,
         count(k.bytes_out), count(k.bytes_in));
  printf("retries         %llu, %llu answers read again, %llu recoveries\n", count(k.attempts - k.exchanges), count(k.rereads), count(k.recoveries));
  if (!d) return;
  printf("first difference: %s\n", d->text().c_str());
  throw CLI::RuntimeError(exit_found);
}

// --- replay --------------------------------------------------------------------------------------------

struct replay_options { std::string file, profile = "default"; };

void replay_recording(const replay_options& o) {
  const auto p = value_of(sim::profile_names, o.profile, "profile");
  const sim::bytes bytes = sim::read_file(o.file);
  std::istringstream stream(std::string(bytes.begin(), bytes.end()));
  recording log;
  if (const std::string why = load(stream, log); !why.empty()) throw sim::input_error(o.file + ": " + why);
  const std::unique_ptr<any_engine> engine = simulator(p);
  const replay_result r = replay(log, *engine);
  printf("%s\n", r.text().c_str());
  if (r.result != status::ok) throw CLI::RuntimeError(exit_found);
}

}  // namespace

void add_bench_rig_command(CLI::App& app) {
  CLI::App& sub = *app.add_subcommand("bench-rig", "a device under test at the end of GPIO lines, against the simulator");
  sub.require_subcommand(1);

  const auto who = std::make_shared<identify_options>();
  CLI::App& identify_sub = *sub.add_subcommand("identify", "what the device says about itself");
  who->rig.add_to(identify_sub);
  identify_sub.add_option("--profile", who->profile, "of the simulated device");
  identify_sub.callback([who] { identify(*who); });

  const auto test = std::make_shared<identify_options>();
  CLI::App& test_sub = *sub.add_subcommand("self-test", "stuck, bridged and exchanged wires, then frames there and back; exit code 1 if the wires are not sound");
  test->rig.add_to(test_sub);
  test_sub.add_option("--profile", test->profile, "of the device");
  test_sub.callback([test] { self_test(*test); });

  const auto draw = std::make_shared<run_options>();
  CLI::App& run_sub = *sub.add_subcommand("run", "draw a scene on the device and compare every span with the simulator; exit code 1 if one differs");
  draw->subject.add_to(run_sub, false);
  draw->rig.add_to(run_sub);
  draw->drawing.add_to(run_sub, false);
  run_sub.add_option("--out", draw->out, "the device's picture, PNG");
  run_sub.add_option("--timeline", draw->timeline, "what the wires did when, for Perfetto or chrome://tracing");
  run_sub.add_option("--record", draw->record, "every operation with the device's answers, for bench-rig replay");
  run_sub.callback([draw] { run(*draw); });

  const auto again = std::make_shared<replay_options>();
  CLI::App& replay_sub = *sub.add_subcommand("replay", "a recording's operations on the simulator; exit code 1 where an answer differs");
  replay_sub.add_option("FILE", again->file, "made by run --record")->required();
  replay_sub.add_option("--profile", again->profile, "of the device");
  replay_sub.callback([again] { replay_recording(*again); });
}

}  // namespace spantex::tool
