// SPDX-License-Identifier: Apache-2.0
// Drawing a scene on the host with everything chosen at run time: profile, engine, filter, threads.
// The picture depends on the scene, filter and profile only. Threads draw bands of whole span rows, each with its own engine.
#pragma once
#include <stdint.h>

#include <array>
#include <optional>
#include <string_view>

#include <hal/any_engine.hpp>
#include <hal/kernels/kernel.hpp>
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
enum class sampling_space : uint8_t {
  screen,   // spans of the screen, each pixel its own position on the map
  object,   // RD16: a grid on the polygon, spread over the screen (spantex/object_space.hpp); direct engine, one thread
};

// What may differ from a profile's own choice of method. The bytes are those of a profile that has it so.
struct profile_changes {
  std::optional<level_formula> level = {};
  std::optional<int> max_samples = {}, sample_spacing = {}, sample_slack = {}, sample_bias = {};  // profile.hpp
  bool any() const { return level || max_samples || sample_spacing || sample_slack || sample_bias; }
  friend bool operator==(const profile_changes&, const profile_changes&) = default;
};

// Polygons that are left out by the way their corners run on the screen (y down). Of a closed model seen from outside none of the backs is seen.
enum class cull : uint8_t { none, clockwise, counterclockwise };

template <class T> struct named { std::string_view name; T value; };

inline constexpr std::array<named<profile_choice>, 4> profile_names{
    {{"seed", profile_choice::seed}, {"compact", profile_choice::compact},
     {"default", profile_choice::standard}, {"exact", profile_choice::exact}}};
inline constexpr std::array<named<engine_choice>, 2> engine_names{{{"direct", engine_choice::direct}, {"sim", engine_choice::simulated}}};
inline constexpr std::array<named<filter>, 11> filter_names{{{"nearest", filter::nearest}, {"bilinear", filter::bilinear},
                                                            {"three-point", filter::three_point}, {"mip-bilinear", filter::mip_bilinear},
                                                            {"trilinear", filter::trilinear}, {"trilinear3", filter::trilinear3},
                                                            {"squares", filter::squares}, {"aniso", filter::aniso},
                                                            {"step", filter::step}, {"hat", filter::hat}, {"contour", filter::contour}}};
inline constexpr std::array<named<kernels::choice>, 9> kernel_names{
    {{"fastest", kernels::choice::fastest}, {"scalar", kernels::choice::scalar}, {"pixels", kernels::choice::pixels}, {"words", kernels::choice::words}, {"sse41", kernels::choice::sse41},
     {"avx2", kernels::choice::avx2}, {"neon", kernels::choice::neon}, {"avx512", kernels::choice::avx512},
     {"avx512-gathers", kernels::choice::avx512_gathers}}};
inline constexpr std::array<named<sampling_space>, 2> space_names{{{"screen", sampling_space::screen}, {"object", sampling_space::object}}};
inline constexpr std::array<named<level_formula>, 3> level_names{
    {{"jacobian", level_formula::jacobian}, {"major", level_formula::major}, {"minor", level_formula::minor}}};
inline constexpr std::array<named<spantex::alpha_mode>, 4> alpha_names{
    {{"opaque", spantex::alpha_mode::opaque}, {"cut-out", spantex::alpha_mode::cut_out},
     {"blended", spantex::alpha_mode::blended}, {"premultiplied", spantex::alpha_mode::premultiplied}}};
inline constexpr std::array<named<skip>, skip_count> skip_names{
    {{"outside", skip::outside}, {"empty", skip::empty}, {"hidden", skip::hidden}, {"floors", skip::floors}, {"held", skip::held}, {"second-level", skip::second_level},
     {"other-half", skip::other_half}, {"constant", skip::constant}, {"uniform", skip::uniform}, {"one-texel", skip::one_texel}, {"copy", skip::copy},
     {"opaque", skip::opaque}, {"transparent", skip::transparent}}};
inline constexpr std::array<named<cull>, 3> cull_names{
    {{"none", cull::none}, {"clockwise", cull::clockwise}, {"counterclockwise", cull::counterclockwise}}};
inline constexpr std::array<named<wrap>, 3> wrap_names{{{"repeat", wrap::repeat}, {"clamp", wrap::clamp}, {"mirror", wrap::mirror}}};
inline constexpr std::array<named<prefilter>, 4> prefilter_names{{{"box", prefilter::box}, {"triangle", prefilter::triangle},
                                                                  {"kaiser", prefilter::kaiser}, {"lanczos", prefilter::lanczos}}};

inline constexpr std::array<named<texel_format>, texel_format_count> format_names{
    {{"rgba8888", texel_format::rgba8888}, {"rgb565", texel_format::rgb565}, {"argb1555", texel_format::argb1555},
     {"argb4444", texel_format::argb4444}, {"rgb888", texel_format::rgb888}, {"l8", texel_format::l8}, {"la88", texel_format::la88},
     {"a8", texel_format::a8}, {"palette8", texel_format::palette8}, {"palette4", texel_format::palette4}, {"bc1", texel_format::bc1},
     {"bc2", texel_format::bc2}, {"bc3", texel_format::bc3}, {"etc1", texel_format::etc1}, {"etc2_rgb8", texel_format::etc2_rgb8},
     {"etc2_rgba8", texel_format::etc2_rgba8}, {"etc2_rgb8a1", texel_format::etc2_rgb8a1}}};

template <class T, size_t N>
constexpr std::string_view name_of(const std::array<named<T>, N>& names, T value) {
  for (const named<T>& n : names)
    if (n.value == value) return n.name;
  return "?";
}

profile profile_of(profile_choice choice, const profile_changes& changes);

struct frame_depths {
  std::vector<uint32_t> values, floors;  // empty where no polygon is drawn
};

class thread_team;

struct draw_options {
  profile_choice profile = profile_choice::standard;
  profile_changes changes;
  engine_choice engine = engine_choice::direct;
  filter kind = filter::bilinear;
  sampling_space space = sampling_space::screen;
  shading how{};                     // alpha; colour where an item has none of its own
  std::optional<uint16_t> threshold, field_scale;  // of contours, u8.8, instead of the maps' own
  std::optional<uint8_t> outline;                  // 1/16 pixel, likewise
  rgba8 background{0, 0, 0, 255};
  bool counted = false;              // work is the engine's also where a kernel drew: the engine draws once more, untimed, the same picture
  kernels::choice kernel = kernels::choice::fastest;  // where kernel_for() takes it: same bytes
  int threads = 1;
  thread_team* team = nullptr;       // of so many threads, for more than one picture: starting threads takes as long as many a picture; null: threads of this one's own
  int repeat = 1;
  bool single_half = false;
  cull culled = cull::none;
  bool depths_first = false;         // of all polygons, before any is filtered (visibility.hpp); opaque ones
  skip_set skips = usual_skips;      // of the scalar engine; kernels have their own, and draw only where none is switched off
  latencies table{};                 // engine sim
  trace_sink* sink = nullptr;        // engine sim, one thread
  any_engine* port = nullptr;        // instead of an engine made here: one thread, and of the skips those of a device, so that the engine draws every pixel
  progress_callback parts_done;
};

// The kernel that draws a scene's planes and polygons in that way, by the profile's numbers (kernels::draws()): engine direct, screen space, no skip off. Scalar: the engine does.
kernels::choice kernel_for(const draw_options& o);

struct draw_result {
  image picture;
  draw_counters work;                // of one repetition, summed over the threads
  skip_counters skipped;
  int polygons_outside = 0, polygons_hidden = 0, polygons_culled = 0, levels_left_out = 0, spans_unchanged = 0;
  texel_format format = texel_format::rgba8888;  // of the first map
  colour_space colours = colour_space::coded;    // likewise
  std::string_view kernel = "scalar";            // what drew: see kernel_names
  uint64_t words_uploaded = 0;       // 64-bit words of all maps into global texture memory: of levels made on demand those that spans read, so far, or all of a map that a kernel draws
  uint64_t blocks_decoded = 0;       // of compressed formats, by the scalar engine
  counters machine;                  // engine sim: summed, total_cycles the longest
  int machines = 0;                  // engines, one per thread that had a row of spans
  cycle cycles_of_all_machines = 0;  // engine sim: total_cycles, summed
  int items_left_out = 0;            // object space: too large a grid, or nothing in front
  double ns_per_pixel = 0;           // median; from coefficients and prepared maps in memory to pixels in memory
};

// before: the frame before, whose pixels are kept where nothing changes, and then this one; null: every span is drawn. In screen space, by an engine made here.
class frame_before;
draw_result draw(const scene& all, const draw_options& options, frame_before* before = nullptr);

int draw_parts(const scene& s, const draw_options& options);  // how many parts_done will add up to

}  // namespace spantex::sim
