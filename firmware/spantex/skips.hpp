// SPDX-License-Identifier: Apache-2.0
// What the draw layer leaves undone because the picture does not need it (docs/PERFORMANCE.md "What is skipped"). None changes a bit of the picture.
//
// A renderer is given its skips as a type. fixed_skips knows them at compile time: what is not in its set has neither code nor state. device_skips, the
// default, has those that cost a device less than they save whatever it draws. run_time_skips has all of them, each with a switch: for the simulator and tests.
#pragma once
#include <stdint.h>

#include <spantex/plane.hpp>

namespace spantex {

enum class skip : uint8_t {
  outside,       // spans outside a polygon's box are not looked at
  empty,         // spans of which nothing is covered are not planned
  hidden,        // nor those of which no pixel is nearer than what is there
  floors,        // nor are depths of pixels looked at where the span's floor (visibility.hpp) says so already
  held,          // a section that the half holds is not loaded
  second_level,  // nor is a coarser level of which no pixel has a fraction
  other_half,    // a section that only the other half holds is not loaded: its half is waited for. Fewer words, more cycles: on only where it is asked for
  constant,      // a job whose pixels are all alike is one pixel; a map of one texel takes no job
  uniform,       // a job whose texels are all alike is a fill: nothing is loaded, nothing computed
  one_texel,     // likewise a job that takes one texel
  copy,          // a job that meets texels exactly, steps of whole texels apart, copies them
  opaque,        // a map without alpha is stored, not blended or tested
  transparent,   // a job whose texels are all left out at write-out is not drawn
};
inline constexpr int skip_count = 13;

using skip_set = uint32_t;
constexpr skip_set only(skip s) { return skip_set(1) << int(s); }
inline constexpr skip_set all_skips = (skip_set(1) << skip_count) - 1;
inline constexpr skip_set default_skips = only(skip::outside) | only(skip::empty) | only(skip::hidden) | only(skip::floors) | only(skip::held) | only(skip::second_level);

// What run_time_skips does unless told otherwise.
inline constexpr skip_set usual_skips = all_skips & ~only(skip::other_half);

// default_skips and any of the others. Those of the default have no switch on a device.
template <skip_set Set>
struct fixed_skips {
  static_assert((Set & default_skips) == default_skips && (Set & ~all_skips) == 0, "spantex: a renderer has at least the default skips");
  static constexpr bool switchable = false, counted = Set != default_skips;
  static constexpr bool may(skip s) { return (Set & only(s)) != 0; }
  static constexpr bool on(skip s) { return may(s); }
};
using device_skips = fixed_skips<default_skips>;

struct run_time_skips {
  static constexpr bool switchable = true, counted = true;
  static constexpr bool may(skip) { return true; }
  constexpr bool on(skip s) const { return (set & only(s)) != 0; }
  skip_set set = usual_skips;
  rectangle frame{};  // what is walked for a polygon without skip::outside, and what spans_outside is counted of
  // Spans that hold their pixels already and are not looked at: a byte each, rows of `columns`. sim/unchanged.hpp finds those of the frame before.
  const uint8_t* kept = nullptr;
  int32_t columns = 0;
  constexpr bool keeps_some() const { return kept != nullptr; }
  constexpr bool keeps(int32_t sx, int32_t sy) const { return keeps_some() && kept[sy * columns + sx] != 0; }
};

struct skip_counters {
  uint64_t spans_outside = 0;         // run_time_skips: spans of its frame that no polygon's box holds, a polygon
  uint64_t spans_below_floor = 0;     // run_time_skips: of the hidden ones
  uint64_t loads_in_other_half = 0;   // jobs moved to the half that holds their sections
  uint64_t jobs_constant = 0;         // of the engine: their pixels are all alike; of a renderer that does not ask they are among the others
  uint64_t spans_constant = 0;        // of a map of one texel
  uint64_t pixels_constant = 0;       // not computed: those of constant jobs but one each
  uint64_t jobs_uniform = 0, jobs_one_texel = 0, jobs_copied = 0, jobs_transparent = 0;  // not given to the engine
  uint64_t pixels_written = 0;        // by the draw layer alone
  uint64_t pixels_opaque = 0;         // stored instead of blended or tested
};

}  // namespace spantex
