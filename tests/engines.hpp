// SPDX-License-Identifier: Apache-2.0
// What the suites on engines share: a rig with a fresh engine for every backend and decorator, texels and coefficients whose pixels are
// known without any engine, a small picture, and a recording of it.
#pragma once
#include <memory>
#include <sstream>
#include <string>

#include "tests/support.hpp"

#include <hal/any_engine.hpp>
#include <hal/bench_engine.hpp>
#include <hal/faulty_engine.hpp>
#include <hal/recording_engine.hpp>
#include <hal/sim_engine.hpp>
#include <sim/bench_wires.hpp>
#include <tests/late_loader.hpp>

namespace spantex::sim {

using prof = fixed_profile<profiles::seed>;
using direct = direct_engine<prof>;
using simulated = sim_engine<prof>;

// --- rigs: a fresh engine of each kind -----------------------------------------------------------------

struct direct_rig {
  direct engine;
  direct& port() { return engine; }
};
struct loading_rig {
  late_loader loader;
  loading_engine<prof, late_loader> engine{loader};
  loading_engine<prof, late_loader>& port() { return engine; }
};
struct sim_rig {
  simulated engine;
  simulated& port() { return engine; }
};
struct recording_rig {
  direct inner;
  recording log;
  recording_engine<direct> engine{inner, log};
  recording_engine<direct>& port() { return engine; }
};
struct faulty_rig {
  simulated inner;
  faulty_engine<simulated> engine{inner};
  faulty_engine<simulated>& port() { return engine; }
};
template <int DataBits>
struct bench_rig_of {
  simulated_bench<prof, DataBits> wires;
  bench_engine engine{wires, prof::value};
  bench_engine& port() { return engine; }
};
using bench_rig = bench_rig_of<8>;
using narrow_bench_rig = bench_rig_of<4>;
struct any_rig {
  any_engine_of<direct> engine;
  any_engine& port() { return engine; }
};

// A fresh rig that outlives a failing assertion.
template <class Rig>
auto& fresh() {
  static std::unique_ptr<Rig> kept;
  kept = std::make_unique<Rig>();
  return kept->port();
}

inline constexpr half halves[] = {half::first, half::second};
inline constexpr int word_count = local_memory<8>::word_count;

// Words that differ everywhere, by seed.
struct some_words {
  uint64_t word[word_count + 1];
  explicit some_words(uint64_t seed) {
    random_source r(seed);
    for (uint64_t& w : word) w = r.next();
  }
};
inline const some_words red(1), blue(2);

// One pixel a texel from (shift, 0): nearest, affine.
inline span_coefficients reading(int32_t shift) {
  span_coefficients c{};
  c.exponent = 20;
  c.base_u = 4 + shift;
  c.base_v = 4;
  c.a_u = c.b_v = 1 << 19;
  c.how = evaluation::affine;
  c.kind = filter::nearest;
  c.fine = {0, 0, uint32_t(1) << 31, uint32_t(1) << 31, 0, false, false};
  return c;
}

// What the datapath makes of it, computed beside every engine.
inline span_pixels expected(const some_words& texels, int32_t shift) {
  static local_memory<8> memory;
  span_pixels out{};
  if (memory.load(0, texels.word, word_count) != status::ok) std::abort();
  compute_span(prof{}, reading(shift), full_mask, memory, out, no_observer{});
  return out;
}

inline void assert_pixels(const span_pixels& got, const span_pixels& wanted, span_mask mask = full_mask) {
  for (int k = 0; k < span_pixel_count; ++k)
    if (((mask >> k) & 1) != 0 && !(got.pixel[k] == wanted.pixel[k])) fail_msg("pixel %d differs", k);
}

template <class Engine>
void load_all(Engine& e, half h, const some_words& texels, int32_t shift) {
  SPANTEX_ASSERT_OK(e.load_words(h, 0, texels.word, word_count));
  SPANTEX_ASSERT_OK(e.load_coefficients(h, reading(shift)));
}

// --- pictures ------------------------------------------------------------------------------------------

inline constexpr rectangle small{0, 0, 44, 36};

inline const texture_view& some_map() {
  static const texture_view t = photographic_map(64, 64, 4).view(wrap::repeat, wrap::mirror);
  return t;
}

// What the direct engine draws.
inline picture& reference_picture(int sample, filter kind) {
  static picture p;
  p.reset(small.x1, small.y1);
  if (render_plane_direct<8>(prof{}, sample_plane(sample), some_map(), kind, p) != status::ok) std::abort();
  return p;
}

// --- recordings ----------------------------------------------------------------------------------------

// Of a picture, and of some operations that are refused.
inline const recording& some_recording() {
  static recording log;
  static direct inner;
  if (!log.operations.empty()) return log;
  recording_engine<direct> engine(inner, log);
  static picture p;
  p.reset(small.x1, small.y1);
  if (render_plane(prof{}, engine, sample_plane(1), some_map(), filter::trilinear, p) != status::ok) std::abort();
  span_pixels pixels{};
  if (engine.take(half::first, pixels) != status::half_not_started) std::abort();  // failures are recorded too
  if (engine.load_words(half::first, 40, red.word, 1) != status::bad_address) std::abort();
  if (engine.load_words(half::first, 0, red.word, -1) != status::bad_address) std::abort();
  return log;
}

}  // namespace spantex::sim
