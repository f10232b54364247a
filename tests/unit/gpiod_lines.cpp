// SPDX-License-Identifier: Apache-2.0
// The suite of the bench's lines over libgpiod 1.6, each function of which that is used is wrapped at link time.
#include <gpiod.h>

#include "tests/gpiod_suite.hpp"

using namespace spantex;
using namespace spantex::sim;

namespace {

char handles[line_total + 1];
gpiod_chip* const the_chip = reinterpret_cast<gpiod_chip*>(&handles[line_total]);
gpiod_line* line(int k) { return reinterpret_cast<gpiod_line*>(&handles[k]); }
int index_of(const gpiod_line* l) { return int(reinterpret_cast<const char*>(l) - handles); }

int first_of(const gpiod_line_bulk* bulk) { return index_of(bulk->lines[0]); }
int count_of(const gpiod_line_bulk* bulk) { return int(bulk->num_lines); }
std::string named(const char* what, const gpiod_line_bulk* bulk) { return std::string(what) + " " + group_of(first_of(bulk)); }

}  // namespace

extern "C" {

gpiod_chip* __wrap_gpiod_chip_open_lookup(const char* name);
void __wrap_gpiod_chip_close(gpiod_chip* c);
gpiod_line* __wrap_gpiod_chip_get_line(gpiod_chip* c, unsigned offset);
gpiod_line* __wrap_gpiod_chip_find_line(gpiod_chip* c, const char* name);
bool __wrap_gpiod_line_is_used(gpiod_line* l);
const char* __wrap_gpiod_line_consumer(gpiod_line* l);
int __wrap_gpiod_line_request_bulk(gpiod_line_bulk* bulk, const gpiod_line_request_config* config, const int* values);
void __wrap_gpiod_line_release_bulk(gpiod_line_bulk* bulk);
int __wrap_gpiod_line_set_direction_input_bulk(gpiod_line_bulk* bulk);
int __wrap_gpiod_line_set_direction_output_bulk(gpiod_line_bulk* bulk, const int* values);
int __wrap_gpiod_line_set_value_bulk(gpiod_line_bulk* bulk, const int* values);
int __wrap_gpiod_line_get_value_bulk(gpiod_line_bulk* bulk, int* values);
int __wrap_gpiod_line_event_wait_bulk(gpiod_line_bulk* bulk, const timespec* limit, gpiod_line_bulk* came);
int __wrap_gpiod_line_event_read(gpiod_line* l, gpiod_line_event* edge);

gpiod_chip* __wrap_gpiod_chip_open_lookup(const char* name) {
  if (called(std::string("open ") + name) < 0) return nullptr;
  assert_false(chip.open);
  chip.open = true;
  return the_chip;
}
void __wrap_gpiod_chip_close(gpiod_chip* c) {
  assert_ptr_equal(c, the_chip);
  (void)called("close");
  chip.open = false;
}
gpiod_line* __wrap_gpiod_chip_get_line(gpiod_chip*, unsigned offset) {
  return called("line " + std::to_string(offset)) < 0 ? nullptr : line(int(offset));
}
gpiod_line* __wrap_gpiod_chip_find_line(gpiod_chip*, const char* name) {
  const int r = called(std::string("line ") + name);
  return r < 0 ? nullptr : line(chip.strict ? r : std::atoi(name + 1));
}
bool __wrap_gpiod_line_is_used(gpiod_line* l) { return index_of(l) == chip.taken; }
const char* __wrap_gpiod_line_consumer(gpiod_line*) { return chip.taken_by; }
int __wrap_gpiod_line_request_bulk(gpiod_line_bulk* bulk, const gpiod_line_request_config* config, const int* values) {
  assert_null(values);
  assert_string_equal(config->consumer, "spantex-bench");
  const int type = config->request_type;
  const char* how = type == GPIOD_LINE_REQUEST_EVENT_BOTH_EDGES ? " edges" : type == GPIOD_LINE_REQUEST_DIRECTION_INPUT ? " inputs" : " ?";
  if (called(named("request", bulk) + how) < 0) return -1;
  become_requested(first_of(bulk), count_of(bulk), true);
  return 0;
}
void __wrap_gpiod_line_release_bulk(gpiod_line_bulk* bulk) {
  (void)called(named("release", bulk));
  become_requested(first_of(bulk), count_of(bulk), false);
}
int __wrap_gpiod_line_set_direction_input_bulk(gpiod_line_bulk* bulk) {
  if (called(named("input", bulk)) < 0) return -1;
  become_inputs(first_of(bulk), count_of(bulk));
  return 0;
}
int __wrap_gpiod_line_set_direction_output_bulk(gpiod_line_bulk* bulk, const int* values) {
  if (called(named("output", bulk) + " " + bits(values, count_of(bulk))) < 0) return -1;
  become_driven(first_of(bulk), count_of(bulk), values);
  return 0;
}
int __wrap_gpiod_line_set_value_bulk(gpiod_line_bulk* bulk, const int* values) {
  if (called(named("set", bulk) + " " + bits(values, count_of(bulk))) < 0) return -1;
  must_be_outputs(first_of(bulk), count_of(bulk));
  become_driven(first_of(bulk), count_of(bulk), values);
  return 0;
}
int __wrap_gpiod_line_get_value_bulk(gpiod_line_bulk* bulk, int* values) {
  const int r = called(named("get", bulk));
  if (r < 0) return -1;
  const uint8_t levels = levels_of(first_of(bulk), r);
  for (int k = 0; k < count_of(bulk); ++k) values[k] = levels >> k & 1;
  return 0;
}
int __wrap_gpiod_line_event_wait_bulk(gpiod_line_bulk* bulk, const timespec* limit, gpiod_line_bulk* came) {
  const int r = waited("wait " + std::to_string(limit->tv_sec * 1'000'000'000 + limit->tv_nsec));
  if (r == 1) gpiod_line_bulk_add(came, bulk->lines[0]);
  return r;
}
int __wrap_gpiod_line_event_read(gpiod_line* l, gpiod_line_event*) { return called("edge of " + std::to_string(index_of(l))); }

}

int main() { return run_gpiod_suite("gpiod_lines"); }
