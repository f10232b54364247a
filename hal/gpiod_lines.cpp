// SPDX-License-Identifier: Apache-2.0
// The one file that knows libgpiod. Two layers: what differs between its APIs 1.6 and 2 (namespace gpio), and the lines of the bench on top of it.
#include "gpiod_lines.hpp"

#include <errno.h>
#include <gpiod.h>
#include <signal.h>
#include <string.h>
#include <time.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace spantex {
namespace {

constexpr char consumer[] = "spantex-bench";
constexpr int most_lines = 8;
constexpr uint64_t longest_wait_ns = 100'000'000;

uint64_t monotonic_ns() {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return uint64_t(t.tv_sec) * 1'000'000'000 + uint64_t(t.tv_nsec);
}

timespec to_timespec(uint64_t ns) { return {time_t(ns / 1'000'000'000), long(ns % 1'000'000'000)}; }

}  // namespace

// Lines that are requested, set and read together. Functions return -1 and errno like the library's.
namespace gpio {

#if SPANTEX_GPIOD_VERSION == 1

struct group {
  gpiod_line_bulk bulk = GPIOD_LINE_BULK_INITIALIZER;
  bool requested = false;
};

gpiod_chip* open(const std::string& name) { return gpiod_chip_open_lookup(name.c_str()); }
void close(gpiod_chip* chip) { gpiod_chip_close(chip); }

gpiod_line* find(gpiod_chip* chip, const std::string& name, bool is_offset) {
  return is_offset ? gpiod_chip_get_line(chip, unsigned(std::stoul(name))) : gpiod_chip_find_line(chip, name.c_str());
}
bool add(gpiod_chip* chip, group& g, const std::string& name, bool is_offset) {
  gpiod_line* line = find(chip, name, is_offset);
  if (line != nullptr) gpiod_line_bulk_add(&g.bulk, line);
  return line != nullptr;
}
// Who holds line k, as far as the kernel tells; empty: nobody.
std::string holder(gpiod_chip*, const group& g, int k) {
  gpiod_line* line = g.bulk.lines[k];
  if (!gpiod_line_is_used(line)) return {};
  const char* who = gpiod_line_consumer(line);
  return who == nullptr ? "the kernel" : std::string("'") + who + "'";
}
int request(gpiod_chip*, group& g, bool with_edges) {
  const gpiod_line_request_config config{consumer, with_edges ? GPIOD_LINE_REQUEST_EVENT_BOTH_EDGES : GPIOD_LINE_REQUEST_DIRECTION_INPUT, 0};
  const int r = gpiod_line_request_bulk(&g.bulk, &config, nullptr);
  g.requested = r == 0;
  return r;
}
void release(group& g) {
  if (g.requested) gpiod_line_release_bulk(&g.bulk);
  g = {};
}
int make_inputs(group& g) { return gpiod_line_set_direction_input_bulk(&g.bulk); }
int make_outputs(group& g, const int* values) { return gpiod_line_set_direction_output_bulk(&g.bulk, values); }
int set(group& g, const int* values) { return gpiod_line_set_value_bulk(&g.bulk, values); }
int get(group& g, int* values) { return gpiod_line_get_value_bulk(&g.bulk, values); }

// Waits for edges and takes those that came: their levels are read anew anyway.
int wait(group& g, uint64_t limit_ns) {
  const timespec limit = to_timespec(limit_ns);
  gpiod_line_bulk came = GPIOD_LINE_BULK_INITIALIZER;
  const int r = gpiod_line_event_wait_bulk(&g.bulk, &limit, &came);
  for (unsigned k = 0; r == 1 && k < came.num_lines; ++k) {
    gpiod_line_event edge;
    if (gpiod_line_event_read(came.lines[k], &edge) != 0) return -1;
  }
  return r;
}

#else

struct group {
  std::vector<unsigned> offsets;
  gpiod_line_request* request = nullptr;
  gpiod_edge_event_buffer* edges = nullptr;
  bool requested = false;
};

bool carries(gpiod_chip* chip, const std::string& name) {
  gpiod_chip_info* info = gpiod_chip_get_info(chip);
  if (info == nullptr) return false;
  const bool yes = name == gpiod_chip_info_get_name(info) || name == gpiod_chip_info_get_label(info);
  gpiod_chip_info_free(info);
  return yes;
}
// By path, name or label, as version 1 does it.
gpiod_chip* open(const std::string& name) {
  if (!name.empty() && name[0] == '/') return gpiod_chip_open(name.c_str());
  int error = ENOENT;  // or why one could not be opened that may be the one
  for (int k = 0; k < 64; ++k) {
    const std::string path = "/dev/gpiochip" + std::to_string(k);
    if (!gpiod_is_gpiochip_device(path.c_str())) continue;
    gpiod_chip* chip = gpiod_chip_open(path.c_str());
    if (chip == nullptr) error = errno;
    if (chip != nullptr && carries(chip, name)) return chip;
    if (chip != nullptr) gpiod_chip_close(chip);
  }
  errno = error;
  return nullptr;
}
void close(gpiod_chip* chip) { gpiod_chip_close(chip); }

bool add(gpiod_chip* chip, group& g, const std::string& name, bool is_offset) {
  if (is_offset) {
    gpiod_line_info* info = gpiod_chip_get_line_info(chip, unsigned(std::stoul(name)));
    if (info == nullptr) return false;
    gpiod_line_info_free(info);
    g.offsets.push_back(unsigned(std::stoul(name)));
    return true;
  }
  const int offset = gpiod_chip_get_line_offset_from_name(chip, name.c_str());
  if (offset >= 0) g.offsets.push_back(unsigned(offset));
  return offset >= 0;
}
std::string holder(gpiod_chip* chip, const group& g, int k) {
  gpiod_line_info* info = gpiod_chip_get_line_info(chip, g.offsets[size_t(k)]);
  if (info == nullptr) return {};
  const char* who = gpiod_line_info_get_consumer(info);
  const std::string name = !gpiod_line_info_is_used(info) ? "" : who == nullptr ? "the kernel" : std::string("'") + who + "'";
  gpiod_line_info_free(info);
  return name;
}
// Hands a configuration of all lines of the group to `use`.
template <class Use>
int configured(const group& g, gpiod_line_direction direction, bool with_edges, const int* values, Use use) {
  gpiod_line_settings* settings = gpiod_line_settings_new();
  gpiod_line_config* config = gpiod_line_config_new();
  int r = settings == nullptr || config == nullptr ? -1 : 0;
  if (r == 0) r = gpiod_line_settings_set_direction(settings, direction);
  if (r == 0 && with_edges) r = gpiod_line_settings_set_edge_detection(settings, GPIOD_LINE_EDGE_BOTH);
  for (size_t k = 0; r == 0 && k < g.offsets.size(); ++k) {
    if (values != nullptr) r = gpiod_line_settings_set_output_value(settings, values[k] != 0 ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE);
    if (r == 0) r = gpiod_line_config_add_line_settings(config, &g.offsets[k], 1, settings);
  }
  if (r == 0) r = use(config);
  const int error = errno;
  gpiod_line_config_free(config);
  gpiod_line_settings_free(settings);
  errno = error;
  return r;
}
int request(gpiod_chip* chip, group& g, bool with_edges) {
  const int r = configured(g, GPIOD_LINE_DIRECTION_INPUT, with_edges, nullptr, [&](gpiod_line_config* config) {
    gpiod_request_config* who = gpiod_request_config_new();
    if (who == nullptr) return -1;
    gpiod_request_config_set_consumer(who, consumer);
    g.request = gpiod_chip_request_lines(chip, who, config);
    const int error = errno;
    gpiod_request_config_free(who);
    errno = error;
    return g.request == nullptr ? -1 : 0;
  });
  g.requested = r == 0;
  if (r == 0 && with_edges && (g.edges = gpiod_edge_event_buffer_new(64)) == nullptr) return -1;
  return r;
}
void release(group& g) {
  if (g.edges != nullptr) gpiod_edge_event_buffer_free(g.edges);
  if (g.request != nullptr) gpiod_line_request_release(g.request);
  g = {};
}
int make_inputs(group& g) {
  return configured(g, GPIOD_LINE_DIRECTION_INPUT, false, nullptr, [&](gpiod_line_config* c) { return gpiod_line_request_reconfigure_lines(g.request, c); });
}
int make_outputs(group& g, const int* values) {
  return configured(g, GPIOD_LINE_DIRECTION_OUTPUT, false, values, [&](gpiod_line_config* c) { return gpiod_line_request_reconfigure_lines(g.request, c); });
}
int set(group& g, const int* values) {
  gpiod_line_value v[most_lines];
  for (size_t k = 0; k < g.offsets.size(); ++k) v[k] = values[k] != 0 ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
  return gpiod_line_request_set_values(g.request, v);
}
int get(group& g, int* values) {
  gpiod_line_value v[most_lines];
  const int r = gpiod_line_request_get_values(g.request, v);
  for (size_t k = 0; r == 0 && k < g.offsets.size(); ++k) values[k] = v[k] == GPIOD_LINE_VALUE_ACTIVE;
  return r;
}
int wait(group& g, uint64_t limit_ns) {
  const int r = gpiod_line_request_wait_edge_events(g.request, int64_t(limit_ns));
  return r == 1 && gpiod_line_request_read_edge_events(g.request, g.edges, 64) < 0 ? -1 : r;
}

#endif

}  // namespace gpio

// --- the bench's lines ---------------------------------------------------------------------------------

struct gpiod_lines::chip {
  gpiod_chip* handle = nullptr;
  gpio::group data, control, shown;
  bool data_out = false, control_out = false;        // outputs for sure: values can be set
  bool data_driven = false, control_driven = false;  // maybe outputs: to be made inputs again

  ~chip() {
    release_all();
    for (gpio::group* g : {&data, &control, &shown}) gpio::release(*g);
    if (handle != nullptr) gpio::close(handle);
  }
  void release_all() {
    if (data_driven) data_driven = gpio::make_inputs(data) != 0;
    if (control_driven) control_driven = gpio::make_inputs(control) != 0;
    data_out = control_out = false;
  }
};

namespace {

volatile sig_atomic_t stopped_by = 0;
void (*volatile release_lines)() = nullptr;  // of the last chip that was opened

void note_signal(int signal_number) { stopped_by = signal_number; }

void release_and_die(int signal_number) {
  if (release_lines != nullptr) release_lines();
  signal(signal_number, SIG_DFL);
  raise(signal_number);
}

}  // namespace

gpiod_lines::gpiod_lines(gpiod_rig rig) : rig_(std::move(rig)) {}
gpiod_lines::~gpiod_lines() { release_lines = nullptr; }
bool gpiod_lines::available() { return true; }

void gpiod_lines::catch_signals() {
  struct sigaction stop{}, die{}, as_before{};
  stop.sa_handler = note_signal;  // without SA_RESTART: what waits wakes up
  for (int s = 1; s <= SIGRTMAX; ++s) {
    struct sigaction now{};
    if (sigaction(s, nullptr, &now) == 0 && now.sa_handler != SIG_IGN) sigaction(s, &stop, nullptr);  // nohup; SIGKILL, SIGSTOP and the C library's own refuse
  }
  as_before.sa_handler = SIG_DFL;
  for (int s : {SIGCHLD, SIGCONT, SIGTSTP, SIGTTIN, SIGTTOU, SIGURG, SIGWINCH}) sigaction(s, &as_before, nullptr);  // these end no process
  die.sa_handler = release_and_die;
  for (int s : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGSYS, SIGTRAP}) sigaction(s, &die, nullptr);
}

bool gpiod_lines::interrupted() const { return stopped_by != 0; }

status gpiod_lines::failed(const std::string& what, int error) {
  const char* meaning = "";
  switch (error) {
    case EACCES: case EPERM: meaning = "no permission, is the user in the group of the chip's device file? "; break;
    case ENODEV: case ENXIO: meaning = "the chip is gone "; break;
    case ENOTTY: case EINVAL: case EOPNOTSUPP: meaning = "the kernel or the chip does not know this request "; break;
    case ENOENT: meaning = what.empty() ? "no such chip, or none that this user may open " : ""; break;
    default: break;
  }
  trouble_ = rig_.chip + (what.empty() ? "" : ", " + what) + ": " + meaning + "(" + strerror(error) + ")";
  return status::device_error;
}

std::string gpiod_lines::data_lines() const { return "lines D0 to D" + std::to_string(rig_.data_bits - 1); }

std::string gpiod_lines::trouble() const {
  return interrupted() ? rig_.chip + ": stopped by signal " + std::to_string(int(stopped_by)) : trouble_;
}

status gpiod_lines::may_go_on() {
  if (interrupted()) return status::device_error;
  if (chip_ != nullptr) return status::ok;
  trouble_ = rig_.chip + ": not open";
  return status::device_error;
}

status gpiod_lines::open() {
  release_lines = nullptr;
  chip_.reset();
  auto made = std::make_unique<chip>();
  made->handle = gpio::open(rig_.chip);
  if (made->handle == nullptr) return failed("", errno);

  using named = std::pair<const char*, const std::string*>;
  static constexpr const char* data_names[] = {"D0", "D1", "D2", "D3", "D4", "D5", "D6", "D7"};
  std::vector<named> data;
  for (int k = 0; k < rig_.data_bits; ++k) data.push_back({data_names[k], &rig_.data[size_t(k)]});
  const std::vector<named> control{{"clock", &rig_.clock}, {"direction", &rig_.direction}, {"command", &rig_.command}, {"reset", &rig_.reset}};
  const std::vector<named> shown{{"ready", &rig_.ready}, {"busy", &rig_.busy}, {"error", &rig_.error}};

  const auto request = [&](gpio::group& g, const std::vector<named>& names, bool with_edges) {
    for (const auto& [role, name] : names) {
      const bool is_offset = !name->empty() && name->size() < 6 && name->find_first_not_of("0123456789") == std::string::npos;
      if (gpio::add(made->handle, g, *name, is_offset)) continue;
      const bool unknown = errno == ENOENT || errno == EINVAL;
      return failed("line " + std::string(role) + " = " + *name + (unknown ? ": no such line" : ""), errno);
    }
    if (gpio::request(made->handle, g, with_edges) == 0) return status::ok;
    const int error = errno;
    for (size_t k = 0; error == EBUSY && k < names.size(); ++k)
      if (const std::string who = gpio::holder(made->handle, g, int(k)); !who.empty())
        return failed("line " + std::string(names[k].first) + " = " + *names[k].second + ": in use by " + who, error);
    return failed("lines " + std::string(names.front().first) + " to " + names.back().first, error);
  };
  SPANTEX_TRY(request(made->data, data, false));
  SPANTEX_TRY(request(made->control, control, false));
  SPANTEX_TRY(request(made->shown, shown, true));
  chip_ = std::move(made);
  static chip* last = nullptr;
  last = chip_.get();
  release_lines = [] { last->release_all(); };
  return status::ok;
}

status gpiod_lines::reopen() { return open(); }

void gpiod_lines::release_all() {
  if (chip_ != nullptr) chip_->release_all();
}

status gpiod_lines::drive_data(uint8_t value) {
  SPANTEX_TRY(may_go_on());
  int values[most_lines];
  for (int k = 0; k < rig_.data_bits; ++k) values[k] = value >> k & 1;
  chip_->data_driven = true;
  const int r = chip_->data_out ? gpio::set(chip_->data, values) : gpio::make_outputs(chip_->data, values);
  chip_->data_out = r == 0;
  return r == 0 ? status::ok : failed(data_lines() + ", set", errno);
}

status gpiod_lines::release_data() {
  SPANTEX_TRY(may_go_on());
  if (!chip_->data_driven) return status::ok;
  chip_->data_out = false;
  if (gpio::make_inputs(chip_->data) != 0) return failed(data_lines() + ", released", errno);
  chip_->data_driven = false;
  return status::ok;
}

status gpiod_lines::read_data(uint8_t& value) {
  SPANTEX_TRY(may_go_on());
  int values[most_lines] = {};
  if (gpio::get(chip_->data, values) != 0) return failed(data_lines() + ", read", errno);
  value = 0;
  for (int k = 0; k < rig_.data_bits; ++k) value = uint8_t(value | (values[k] != 0 ? 1 : 0) << k);
  return status::ok;
}

status gpiod_lines::set_control(const bench::control_lines& lines) {
  SPANTEX_TRY(may_go_on());
  const int values[] = {lines.clock, lines.to_host, lines.command, lines.reset};
  chip_->control_driven = true;
  const int r = chip_->control_out ? gpio::set(chip_->control, values) : gpio::make_outputs(chip_->control, values);
  chip_->control_out = r == 0;
  return r == 0 ? status::ok : failed("lines clock to reset, set", errno);
}

status gpiod_lines::read_status(bench::status_lines& lines) {
  SPANTEX_TRY(may_go_on());
  int values[3] = {};
  if (gpio::get(chip_->shown, values) != 0) return failed("lines ready to error, read", errno);
  lines = {values[0] != 0, values[1] != 0, values[2] != 0};
  return status::ok;
}

// A signal may come just before the wait: no wait is longer than a tenth of a second.
status gpiod_lines::wait_edge(uint64_t limit_ns) {
  SPANTEX_TRY(may_go_on());
  const int r = gpio::wait(chip_->shown, std::min(limit_ns, longest_wait_ns));
  if (r > 0 || (r < 0 && errno == EINTR)) return may_go_on();
  return r == 0 ? status::device_timeout : failed("lines ready to error, events", errno);
}

// A signal ends it early; one that comes just before a sleep, a tenth of a second later.
void gpiod_lines::pause(uint64_t ns) {
  const uint64_t begun = monotonic_ns();
  for (uint64_t gone = 0; gone < ns && !interrupted(); gone = monotonic_ns() - begun) {
    const timespec t = to_timespec(std::min(ns - gone, longest_wait_ns));
    nanosleep(&t, nullptr);
  }
}

uint64_t gpiod_lines::now_ns() { return monotonic_ns(); }

}  // namespace spantex
