// SPDX-License-Identifier: Apache-2.0
// The suite of the bench's lines over libgpiod 2 as its documentation describes it (tests/gpiod2/gpiod.h), for systems that have only 1.6. Objects are counted:
// whatever is made must be freed. A chip is found by path, name or label among those that may be opened.
#include <gpiod.h>

#include "tests/gpiod_suite.hpp"

using namespace spantex;
using namespace spantex::sim;

struct gpiod_chip { std::string path; };
struct gpiod_chip_info { std::string name, label; };
struct gpiod_line_info { int line; };
struct gpiod_line_settings { gpiod_line_direction direction = GPIOD_LINE_DIRECTION_AS_IS; gpiod_line_edge edge = GPIOD_LINE_EDGE_NONE; gpiod_line_value value = GPIOD_LINE_VALUE_INACTIVE; };
struct gpiod_line_config { std::map<unsigned, gpiod_line_settings> lines; };
struct gpiod_request_config { std::string consumer; };
struct gpiod_line_request { int first = 0, count = 0; };
struct gpiod_edge_event_buffer { size_t capacity; };

namespace {

// Chips of the machine, beside the one that the suite opens by its path.
struct other_chip { std::string path, name, label; int error; };
std::vector<other_chip> chips;

template <class Object>
Object* made(const char* what, Object object) {
  if (counted(std::string("new ") + what) < 0) return nullptr;
  ++chip.objects;
  return new Object(std::move(object));
}
template <class Object>
void freed(Object* object) {
  if (object == nullptr) return;
  --chip.objects;
  delete object;
}

std::string named(const char* what, const gpiod_line_request& r) { return std::string(what) + " " + group_of(r.first); }

// The lines of a configuration, which must be one of the bench's groups, all alike.
gpiod_line_request group_in(const gpiod_line_config& c) {
  const gpiod_line_request r{int(c.lines.begin()->first), int(c.lines.size())};
  for (const auto& [offset, settings] : c.lines) {
    if (int(offset) < r.first || int(offset) >= r.first + r.count) std::abort();
    if (settings.direction != c.lines.begin()->second.direction || settings.edge != c.lines.begin()->second.edge) std::abort();
  }
  return r;
}

}  // namespace

extern "C" {

bool gpiod_is_gpiochip_device(const char* path) {
  return std::any_of(chips.begin(), chips.end(), [&](const other_chip& c) { return c.path == path; });
}
gpiod_chip* gpiod_chip_open(const char* path) {
  for (const other_chip& c : chips)
    if (c.path == path) {
      errno = c.error;
      if (c.error != 0) return nullptr;
      ++chip.objects;
      return new gpiod_chip{path};
    }
  if (called(std::string("open ") + path) < 0) return nullptr;
  assert_false(chip.open);
  chip.open = true;
  ++chip.objects;
  return new gpiod_chip{path};
}
void gpiod_chip_close(gpiod_chip* c) {
  if (chips.empty()) {
    (void)called("close");
    chip.open = false;
  }
  freed(c);
}
gpiod_chip_info* gpiod_chip_get_info(gpiod_chip* c) {
  for (const other_chip& o : chips)
    if (o.path == c->path) return made("chip info", gpiod_chip_info{o.name, o.label});
  return nullptr;
}
const char* gpiod_chip_info_get_name(gpiod_chip_info* i) { return i->name.c_str(); }
const char* gpiod_chip_info_get_label(gpiod_chip_info* i) { return i->label.c_str(); }
void gpiod_chip_info_free(gpiod_chip_info* i) { freed(i); }

gpiod_line_info* gpiod_chip_get_line_info(gpiod_chip*, unsigned offset) {
  // Asked before a request, to see that there is such a line, and after one that failed, for its holder.
  if (chip.failed.empty() && called("line " + std::to_string(offset)) < 0) return nullptr;
  ++chip.objects;
  return new gpiod_line_info{int(offset)};
}
int gpiod_chip_get_line_offset_from_name(gpiod_chip*, const char* name) {
  const int r = called(std::string("line ") + name);
  return r < 0 || chip.strict ? r : std::atoi(name + 1);
}
const char* gpiod_line_info_get_consumer(gpiod_line_info*) { return chip.taken_by; }
bool gpiod_line_info_is_used(gpiod_line_info* i) { return i->line == chip.taken; }
void gpiod_line_info_free(gpiod_line_info* i) { freed(i); }

gpiod_line_settings* gpiod_line_settings_new() { return made("settings", gpiod_line_settings{}); }
void gpiod_line_settings_free(gpiod_line_settings* s) { freed(s); }
int gpiod_line_settings_set_direction(gpiod_line_settings* s, gpiod_line_direction d) { return s->direction = d, counted("direction"); }
int gpiod_line_settings_set_edge_detection(gpiod_line_settings* s, gpiod_line_edge e) { return s->edge = e, counted("detection"); }
int gpiod_line_settings_set_output_value(gpiod_line_settings* s, gpiod_line_value v) { return s->value = v, counted("value"); }

gpiod_line_config* gpiod_line_config_new() { return made("configuration", gpiod_line_config{}); }
void gpiod_line_config_free(gpiod_line_config* c) { freed(c); }
int gpiod_line_config_add_line_settings(gpiod_line_config* c, const unsigned* offsets, size_t count, gpiod_line_settings* s) {
  for (size_t k = 0; k < count; ++k) c->lines[offsets[k]] = *s;
  return counted("add");
}

gpiod_request_config* gpiod_request_config_new() { return made("request configuration", gpiod_request_config{}); }
void gpiod_request_config_free(gpiod_request_config* c) { freed(c); }
void gpiod_request_config_set_consumer(gpiod_request_config* c, const char* consumer) { c->consumer = consumer; }

gpiod_line_request* gpiod_chip_request_lines(gpiod_chip*, gpiod_request_config* who, gpiod_line_config* config) {
  assert_string_equal(who->consumer.c_str(), "spantex-bench");
  const gpiod_line_request r = group_in(*config);
  const gpiod_line_settings& s = config->lines.begin()->second;
  const char* how = s.direction != GPIOD_LINE_DIRECTION_INPUT ? " ?" : s.edge == GPIOD_LINE_EDGE_BOTH ? " edges" : s.edge == GPIOD_LINE_EDGE_NONE ? " inputs" : " ?";
  if (called(named("request", r) + how) < 0) return nullptr;
  become_requested(r.first, r.count, true);
  ++chip.objects;
  return new gpiod_line_request(r);
}
void gpiod_line_request_release(gpiod_line_request* r) {
  (void)called(named("release", *r));
  become_requested(r->first, r->count, false);
  freed(r);
}

// Replaces the whole configuration, so it must name every line.
int gpiod_line_request_reconfigure_lines(gpiod_line_request* r, gpiod_line_config* config) {
  const gpiod_line_request all = group_in(*config);
  if (all.first != r->first || all.count != r->count) std::abort();
  gpiod_line_value values[line_total] = {};
  for (int k = 0; k < r->count; ++k) values[k] = config->lines[unsigned(r->first + k)].value;
  const bool out = config->lines.begin()->second.direction == GPIOD_LINE_DIRECTION_OUTPUT;
  if (called(out ? named("output", *r) + " " + bits(values, r->count) : named("input", *r)) < 0) return -1;
  if (out) become_driven(r->first, r->count, values);
  else become_inputs(r->first, r->count);
  return 0;
}
int gpiod_line_request_set_values(gpiod_line_request* r, const gpiod_line_value* values) {
  if (called(named("set", *r) + " " + bits(values, r->count)) < 0) return -1;
  must_be_outputs(r->first, r->count);
  become_driven(r->first, r->count, values);
  return 0;
}
int gpiod_line_request_get_values(gpiod_line_request* r, gpiod_line_value* values) {
  const int scripted = called(named("get", *r));
  if (scripted < 0) return -1;
  const uint8_t levels = levels_of(r->first, scripted);
  for (int k = 0; k < r->count; ++k) values[k] = (levels >> k & 1) != 0 ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
  return 0;
}
int gpiod_line_request_wait_edge_events(gpiod_line_request*, int64_t limit_ns) { return waited("wait " + std::to_string(limit_ns)); }
// The number of events that were read.
int gpiod_line_request_read_edge_events(gpiod_line_request* r, gpiod_edge_event_buffer* buffer, size_t most) {
  if (most == 0 || most > buffer->capacity) std::abort();
  return called("edge of " + std::to_string(r->first)) < 0 ? -1 : 1;
}
gpiod_edge_event_buffer* gpiod_edge_event_buffer_new(size_t capacity) { return made("buffer", gpiod_edge_event_buffer{capacity}); }
void gpiod_edge_event_buffer_free(gpiod_edge_event_buffer* b) { freed(b); }

}

namespace {

status opened(const char* name, std::string& told) {
  gpiod_rig r = rig();
  r.chip = name;
  gpiod_lines lines(r);
  const status s = lines.open();
  told = lines.trouble();
  return s;
}

// Version 2 opens by path only: names and labels are looked up here. A chip that may not be opened could be the one.
void a_chip_is_found_by_name_and_label(void**) {
  static std::string told;
  chip = {};
  chips = {{"/dev/gpiochip0", "gpiochip0", "first-label", 0}, {"/dev/gpiochip5", "gpiochip5", "second-label", 0}};
  SPANTEX_ASSERT_OK(opened("gpiochip5", told));
  SPANTEX_ASSERT_OK(opened("first-label", told));
  SPANTEX_ASSERT_OK(opened("/dev/gpiochip5", told));
  SPANTEX_ASSERT_STATUS(opened("third-label", told), device_error);
  assert_true(told.find("third-label: no such chip") == 0);
  chips[1].error = EACCES;
  SPANTEX_ASSERT_OK(opened("first-label", told));
  SPANTEX_ASSERT_STATUS(opened("second-label", told), device_error);
  assert_true(told.find("second-label: no permission") == 0);
  SPANTEX_ASSERT_STATUS(opened("gpiochip5", told), device_error);
  assert_true(told.find("gpiochip5: no permission") == 0);
  chips.clear();
  assert_int_equal(chip.objects, 0);
}

}  // namespace

int main() {
  const CMUnitTest own = cmocka_unit_test(a_chip_is_found_by_name_and_label);
  return run_gpiod_suite("gpiod2_lines", own);
}
