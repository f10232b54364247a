// SPDX-License-Identifier: Apache-2.0
#include "bench_counts.hpp"

#include <stdio.h>

#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>

#include <sim/draw_host.hpp>
#include "bench_machine.hpp"
#include "bench_scenes.hpp"

namespace spantex::tool {

// A symbol a row: what callgrind counts in it is the row's. What is stored keeps the compiler from making one function of them all.
size_t last_counted_row;
template <size_t Row>
[[gnu::noinline]] void draw_counted_row(const sim::scene& s, const sim::draw_options& o, sim::draw_result& result) {
  result = sim::draw(s, o);
  last_counted_row = Row;
}

namespace {

constexpr sim::screen_size counted_size{96, 72};

struct counted_row {
  const char* scene;
  filter kind;
  sim::profile_choice profile;
};

// Every filter with its own way through the datapath, every profile, planes of every kind, polygons behind each other.
constexpr counted_row rows[] = {
    {"facing", filter::nearest, sim::profile_choice::standard},   {"facing", filter::trilinear, sim::profile_choice::standard},
    {"tilted", filter::nearest, sim::profile_choice::standard},   {"tilted", filter::bilinear, sim::profile_choice::standard},
    {"tilted", filter::trilinear, sim::profile_choice::seed},     {"tilted", filter::trilinear, sim::profile_choice::compact},
    {"tilted", filter::trilinear, sim::profile_choice::standard}, {"tilted", filter::trilinear, sim::profile_choice::exact},
    {"tilted", filter::trilinear3, sim::profile_choice::seed},    {"grazing", filter::trilinear, sim::profile_choice::standard},
    {"grazing", filter::aniso, sim::profile_choice::standard},    {"close", filter::trilinear, sim::profile_choice::standard},
    {"far", filter::bilinear, sim::profile_choice::standard},     {"squares", filter::trilinear, sim::profile_choice::standard},
    {"layers", filter::trilinear, sim::profile_choice::standard},
};

sim::scene scene_of(const counted_row& r) {
  const std::string name = r.scene;
  if (name == "squares") return wall_of_squares(8, counted_size);
  if (name == "layers") return layers(4, true, counted_size);
  return make_bench_scene(name, counted_size, {});
}

std::string name_of(const counted_row& r) {
  return std::string(r.scene) + "-" + std::string(sim::name_of(sim::filter_names, r.kind)) + "-" + std::string(sim::name_of(sim::profile_names, r.profile));
}

sim::draw_result drawn(size_t row, const sim::scene& s, const sim::draw_options& o) {
  sim::draw_result result;
  [&]<size_t... Row>(std::index_sequence<Row...>) {
    (void)((Row == row && (draw_counted_row<Row>(s, o, result), true)) || ...);
  }(std::make_index_sequence<std::size(rows)>());
  if (last_counted_row != row) throw std::logic_error("bench: another row was drawn");
  return result;
}

void print_row(const std::string& name, const sim::draw_result& direct, const sim::draw_result& simulated) {
  const draw_counters& w = direct.work;
  using number = unsigned long long;
  printf("%s %llu %llu %llu %llu %llu %llu %llu %llu %llu %llu %llu\n", name.c_str(), number(w.pixels), number(w.spans_total), number(w.jobs),
         number(w.words_loaded), number(w.words_read), number(simulated.machine.texel_reads), number(w.divides), number(w.corrected_jobs),
         number(w.second_levels_skipped), number(w.loads_skipped), number(w.spans_hidden));
}

}  // namespace

void print_counts(bool draws_only) {
  printf("# build: %s\n", build_text(this_machine()).c_str());
  if (!draws_only)
    puts("# row pixels spans jobs words_loaded words_read texel_reads divides corrected_jobs second_levels_skipped loads_skipped spans_hidden");
  for (size_t row = 0; row < std::size(rows); ++row) {
    const counted_row& r = rows[row];
    const sim::scene s = scene_of(r);
    sim::draw_options o;
    o.kind = r.kind;
    o.profile = r.profile;
    o.kernel = kernels::choice::scalar;
    const sim::draw_result direct = drawn(row, s, o);
    if (draws_only) {
      puts(name_of(r).c_str());
      continue;
    }
    o.engine = sim::engine_choice::simulated;
    const sim::draw_result simulated = sim::draw(s, o);
    if (direct.picture.pixels != simulated.picture.pixels) throw std::logic_error(s.name + ": engines direct and sim differ");
    print_row(name_of(r), direct, simulated);
  }
}

}  // namespace spantex::tool
