// SPDX-License-Identifier: Apache-2.0
// Double buffering on a device: small pictures (picture_hashes.hpp) whose texels a loader brings from flash while the other half is filtered,
// at several paces of the loader; then a loader that never ends, and a picture after it. Lines: a picture's as in
// tests/golden/picture_hashes.txt; "counts" and a pace's counters in hexadecimal; "never" and the status.
//   -DSPANTEX_LOADER=cooperative, timed, pl081   -DSPANTEX_PROFILE, -DSPANTEX_NAME as golden_pictures.cpp
#include "picture_hashes.hpp"

#include <firmware/targets/console.hpp>
#include <firmware/targets/loaders.hpp>
#include <hal/loading_engine.hpp>

using namespace spantex;
using word_lengths = fixed_profile<profiles::SPANTEX_PROFILE>;

namespace boards {

// Paces: texels a step, polls or ticks a step; the last of each is fast.
struct pace { const char* name; int texels, ticks; };

namespace cooperative {
inline targets::cooperative_loader loader;
inline void connect() {}
inline void disable(bool off) { loader.set_pace(off ? 0 : 1, 1); }
constexpr pace paces[] = {{"1 texel in 64 polls", 1, 64}, {"1 texel in 4 polls", 1, 4}, {"4 texels a poll", 4, 1}, {"32 texels a poll", 32, 1}};
}  // namespace cooperative

#if defined(__arm__) && __ARM_ARCH >= 7 || defined(__ARM_ARCH_8M_MAIN__)
}  // namespace boards
#include <firmware/targets/interrupts.hpp>
namespace boards {

namespace timed {  // mps2-an386
using timer = targets::cmsdk_timer<0x40000000>;
constexpr int timer_line = 8;
inline targets::timed_loader<timer> loader;
inline void disable(bool off) { interrupts::enable(timer_line, !off); }
inline void connect() {
  interrupts::connect(timer_line, [] { loader.on_tick(); });
  disable(false);
}
constexpr pace paces[] = {{"1 texel in 2048 ticks", 1, 2048}, {"4 texels in 1024 ticks", 4, 1024}, {"32 texels in 512 ticks", 32, 512}};
}  // namespace timed

namespace pl081 {  // mps2-an505, secure aliases; its master is secure after reset
using timer = targets::cmsdk_timer<0x50000000>;
constexpr int timer_line = 3, error_line = 56, complete_line = 57;
inline targets::pl081_loader<0x50110000, timer> loader;
inline void disable(bool off) { interrupts::enable(complete_line, !off); }
inline void connect() {
  interrupts::connect(timer_line, [] { loader.on_tick(); });
  interrupts::connect(error_line, [] { loader.on_error(); });
  interrupts::connect(complete_line, [] { loader.on_complete(); });
  interrupts::enable(timer_line, true);
  interrupts::enable(error_line, true);
  disable(false);
}
constexpr pace paces[] = {{"4 texels in 2048 ticks", 4, 2048}, {"16 texels in 512 ticks", 16, 512}, {"16 texels in 128 ticks", 16, 128}, {"16 texels, no timer", 16, 0}};
}  // namespace pl081
#endif

}  // namespace boards

namespace board = boards::SPANTEX_LOADER;

namespace {

using unit = loading_engine<word_lengths, decltype(board::loader)>;

constinit app::scratch pictures;
constinit unit engine(board::loader, {}, 200000);
loading_counters before;  // counts of the paces so far

constexpr filter filters[] = {filter::nearest, filter::bilinear, filter::trilinear, filter::aniso};

constexpr app::picture planes[] = {app::picture::facing, app::picture::tilted, app::picture::horizon};

void print_picture(app::picture p, filter f, wrap w, bool odd, uint32_t hash) {
  const char* const words[] = {SPANTEX_NAME, app::name_of(p), app::name_of(f), app::name_of(w), odd ? "20x12" : "32x32"};
  for (const char* word : words) {
    console::print(word);
    console::print(" ");
  }
  console::print_hex(hash);
  console::print("\n");
}

void draw(app::picture p, filter f, wrap w, bool odd) { print_picture(p, f, w, odd, app::hash_of<word_lengths>(p, f, w, odd, engine, pictures)); }

void print_counts(const char* name) {
  const loading_counters c = engine.counters();
  const uint32_t counts[] = {c.jobs - before.jobs, c.loads - before.loads, c.hidden - before.hidden, c.stalls - before.stalls, c.failed - before.failed,
                             c.polls_waited - before.polls_waited, c.beside - before.beside, c.texels_loaded - before.texels_loaded,
                             c.texels_copied - before.texels_copied, uint32_t(engine.ownership().violation_count())};
  before = c;
  console::print("counts");
  for (const uint32_t n : counts) {
    console::print(" ");
    console::print_hex(n);
  }
  console::print(" ");
  console::print(name);
  console::print("\n");
}

status draw_in_vain() {
  texture_view map;
  plane p{};
  SPANTEX_TRY(app::square_map.view(wrap::repeat, map));
  const rectangle screen{0, 0, app::frame_width, app::frame_height};
  SPANTEX_TRY(make_plane(app::plane_of(app::picture::facing), screen, p));
  renderer<unit, word_lengths> r(engine, word_lengths{}, {pictures.frame, app::frame_width, app::frame_height, app::frame_width});
  const status result = r.draw(p, map, filter::bilinear, screen);
  if (result != status::ok) (void)r.flush();  // the other half's load has failed too
  return result;
}

}  // namespace

int main() {
  board::connect();
  for (const boards::pace& pace : board::paces) {
    board::loader.set_pace(pace.texels, pace.ticks);
    for (const app::picture p : planes)
      for (const filter f : filters) {
        draw(p, f, wrap::repeat, false);
        draw(p, f, wrap::mirror, true);
      }
    print_counts(pace.name);
  }
  board::disable(true);
  console::print("never ");
  console::print(to_string(draw_in_vain()));
  console::print("\n");
  print_counts("never");
  board::disable(false);
  draw(app::picture::facing, filter::bilinear, wrap::repeat, false);
  print_counts("after that");
  return 0;
}
