// SPDX-License-Identifier: Apache-2.0
// One point of a sweep: what is drawn, by which machine, and what is measured. Every number of it is an axis (docs/SWEEPS.md).
#pragma once
#include <stdint.h>

#include <array>
#include <limits>
#include <string>
#include <string_view>

#include <spantex/profile.hpp>
#include "map.hpp"
#include "scene.hpp"
#include "timing.hpp"

namespace spantex::sim {

enum class camera_motion : uint8_t {
  none,
  pan,       // planes: 1/16 pixel a frame to the right, 1/32 down
  zoom,      // planes: closer by 1/512 a frame
  approach,  // planes: texels a pixel fall by 1/256 of the first frame's a frame: through the levels
  turn,      // scenes with a camera: a quarter of a degree a frame
};

// Which bank of local memory holds a texel (local_memory.hpp).
enum class bank_map : uint8_t {
  parity,   // VR11: by the parities of both coordinates
  columns,  // by the column alone: what it would cost
};

struct sweep_subject {
  std::string scene = "tilted";  // a name of figures.hpp, or view: a plane seen at a pitch and a distance
  std::string map = "photo";     // of planes: photo, random, squares, chessboard, or a file ...
  std::string map_folder{};      // ... in this folder
  int map_side = 512;            // texels, of maps that are made here
  screen_size size{160, 120};
  prefilter levels = prefilter::box;
  texel_format format = texel_format::rgba8888;
  colour_space colours = colour_space::coded;
  wrap wraps = wrap::repeat;
  int pitch_degrees = 45;        // view: between the plane and the line of sight, 1..90; 90 faces the viewer
  int minification_16 = 0;       // view: log2 of texels a pixel at the picture's centre, across the line of sight, in 1/16
  int turn_degrees = 20;         // view: of the map on its plane
  camera_motion motion = camera_motion::none;
  int frames = 8;                // of a motion
};

struct sweep_point {
  sweep_subject subject;
  std::string profile = "default";  // that the numbers began as
  run_time_profile machine{profiles::standard};
  filter kind = filter::trilinear;
  bank_map banks = bank_map::parity;
  bool single_half = false;
  latencies table{};
};

// What a point is judged by. Columns of the record, in this order; units in docs/SWEEPS.md. A value is NaN where it is not defined or was not asked for.
enum class measure : uint8_t {
  psnr_db, ssim, oklab, rms_lsb, worst_lsb,
  twin_psnr_db, twin_rms_lsb, twin_worst_lsb, border_ratio,
  coordinate_rms_texels, coordinate_worst_texels, level_worst,
  swim_lsb, twin_swim_lsb,
  cycles_per_pixel, stalls_per_pixel, conflicts_per_pixel, words_per_pixel, reads_per_pixel, jobs_per_pixel, divides_per_pixel,
  short_products_per_pixel, long_products_per_pixel, product_bits_per_pixel, memory_bits, word_bits,
  ns_per_pixel,
};
inline constexpr int measure_count = int(measure::ns_per_pixel) + 1;

// Measured together; one that is not asked for costs nothing.
enum class measure_group : uint8_t { picture, twin, coordinates, motion, cost, time };
inline constexpr int measure_group_count = 6;

struct measure_column {
  std::string_view name;
  measure_group group;
  int decimals;
};
inline constexpr std::array<measure_column, measure_count> measure_columns{{
    {"psnr_db", measure_group::picture, 4}, {"ssim", measure_group::picture, 6}, {"oklab", measure_group::picture, 5},
    {"rms_lsb", measure_group::picture, 5}, {"worst_lsb", measure_group::picture, 3},
    {"twin_psnr_db", measure_group::twin, 4}, {"twin_rms_lsb", measure_group::twin, 6}, {"twin_worst_lsb", measure_group::twin, 0},
    {"border_ratio", measure_group::twin, 4},
    {"coordinate_rms_texels", measure_group::coordinates, 9}, {"coordinate_worst_texels", measure_group::coordinates, 9}, {"level_worst", measure_group::coordinates, 7},
    {"swim_lsb", measure_group::motion, 5}, {"twin_swim_lsb", measure_group::motion, 5},
    {"cycles_per_pixel", measure_group::cost, 5}, {"stalls_per_pixel", measure_group::cost, 5}, {"conflicts_per_pixel", measure_group::cost, 5},
    {"words_per_pixel", measure_group::cost, 5}, {"reads_per_pixel", measure_group::cost, 5}, {"jobs_per_pixel", measure_group::cost, 5},
    {"divides_per_pixel", measure_group::cost, 5}, {"short_products_per_pixel", measure_group::cost, 4}, {"long_products_per_pixel", measure_group::cost, 4},
    {"product_bits_per_pixel", measure_group::cost, 2}, {"memory_bits", measure_group::cost, 0}, {"word_bits", measure_group::cost, 0},
    {"ns_per_pixel", measure_group::time, 2},
}};

inline constexpr std::array<std::string_view, measure_group_count> measure_group_names{"picture", "twin", "coordinates", "motion", "cost", "time"};

struct measure_groups {
  std::array<bool, measure_group_count> wanted{true, true, true, true, true, false};
  bool has(measure_group g) const { return wanted[size_t(g)]; }
};

struct sweep_result {
  std::array<double, measure_count> value;
  sweep_result() { value.fill(std::numeric_limits<double>::quiet_NaN()); }
  double& operator[](measure m) { return value[size_t(m)]; }
  double operator[](measure m) const { return value[size_t(m)]; }
};

}  // namespace spantex::sim
