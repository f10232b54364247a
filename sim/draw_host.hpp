// SPDX-License-Identifier: Apache-2.0
// Drawing a scene on the host with everything chosen at run time: profile, engine, filter, threads.
// The picture depends on the scene, filter and profile only. Threads draw bands of whole span rows, each with its own engine.
#pragma once
#include <stdint.h>

#include <array>
#include <string_view>

#include <spantex/draw.hpp>
#include "counters.hpp"
#include "image.hpp"
#include "parallel.hpp"
#include "scene.hpp"
#include "timing.hpp"
#include "trace.hpp"

namespace spantex::sim {

enum class profile_choice : uint8_t { seed, compact, standard, exact };
enum class engine_choice : uint8_t { direct, simulated };

template <class T> struct named { std::string_view name; T value; };

inline constexpr std::array<named<profile_choice>, 4> profile_names{
    {{"seed", profile_choice::seed}, {"compact", profile_choice::compact},
     {"default", profile_choice::standard}, {"exact", profile_choice::exact}}};
inline constexpr std::array<named<engine_choice>, 2> engine_names{{{"direct", engine_choice::direct}, {"sim", engine_choice::simulated}}};
inline constexpr std::array<named<filter>, 6> filter_names{{{"nearest", filter::nearest}, {"bilinear", filter::bilinear},
                                                            {"three-point", filter::three_point}, {"mip-bilinear", filter::mip_bilinear},
                                                            {"trilinear", filter::trilinear}, {"trilinear3", filter::trilinear3}}};
inline constexpr std::array<named<wrap>, 3> wrap_names{{{"repeat", wrap::repeat}, {"clamp", wrap::clamp}, {"mirror", wrap::mirror}}};
inline constexpr std::array<named<prefilter>, 2> prefilter_names{{{"box", prefilter::box}, {"triangle", prefilter::triangle}}};

template <class T, size_t N>
constexpr std::string_view name_of(const std::array<named<T>, N>& names, T value) {
  for (const named<T>& n : names)
    if (n.value == value) return n.name;
  return "?";
}

struct draw_options {
  profile_choice profile = profile_choice::standard;
  engine_choice engine = engine_choice::direct;
  filter kind = filter::bilinear;
  rgba8 background{0, 0, 0, 255};
  int threads = 1;
  int repeat = 1;
  bool single_half = false;
  latencies table{};                 // engine sim
  trace_sink* sink = nullptr;        // engine sim, one thread
  progress_callback parts_done;
};

struct draw_result {
  image picture;
  draw_counters work;                // of one repetition, summed over the threads
  counters machine;                  // engine sim: summed, total_cycles the longest
  int machines = 0;                  // engines, one per thread that had a row of spans
  cycle cycles_of_all_machines = 0;  // engine sim: total_cycles, summed
  double ns_per_pixel = 0;           // median; from coefficients and prepared maps in memory to pixels in memory
};

draw_result draw(const scene& s, const draw_options& options);

int draw_parts(const scene& s, const draw_options& options);  // how many parts_done will add up to

}  // namespace spantex::sim
