// SPDX-License-Identifier: Apache-2.0
// Stress of the numerics: random and adversarial planes and polygons against exact integer arithmetic, stage by stage. Every case is a
// function of (family, seed), so one number reproduces it; a failure is shrunk to the simplest numbers that still fail.
//
//   stress_planes, stress_polygons   generate: a case from its seed, and the spans where its adversity lies
//   stress_judge                     evaluate one span as the engine does, and judge every stage
//   stress_shrink                    simplify what fails
//   stress                           deal the cases out to threads and add up
//   stress_describe                  one case in words
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include <spantex/profile.hpp>

namespace spantex::sim {

enum class stress_family {
  any_plane,        // coefficients of every size
  horizon,          // W = 0 runs through the picture: spans along it
  near_horizon,     // W passes zero within a span
  edge_on,          // nearly or exactly singular: u, v constant or on a line
  cancelling,       // numerators that cancel to a small difference of large terms
  far_coordinates,  // u, v near +-2^15
  magnified,        // a thousand pixels per texel and more
  minified,         // 4096 texels per pixel and more: beyond the last level of any map
  wide_screen,      // 4096 pixels: whole rows and columns of spans
  extremes,         // coefficients at the ends of their ranges
  fans,             // triangles that share edges and a vertex
  one_pixel,        // triangles of a pixel and less
  needles,          // triangles up to 4096 pixels long and a fraction of a pixel thick
};
inline constexpr int stress_family_count = 13;
const char* name_of(stress_family f);
constexpr bool is_polygons(stress_family f) { return f >= stress_family::fans; }

enum class stress_stage {
  set_up,      // coefficients of a plane, half units
  numerator,   // n, texels
  relative_w,  // w
  reciprocal,  // 1/w, relative
  affine,      // u, v by evaluation, texels of level 0
  series,
  divide,
  pixel,
  out_of_range,    // how far below 32767 a coordinate beyond 2^15 comes out, texels
  row,             // change of the error from the first span of a row of 4096 pixels
  column,          // and of a column
  moved,           // against the same plane moved to the screen's corner, bits of the position
  level_jacobian,  // levels
  level_major,
  log2,
  snapped,    // position on a level, texels of it
  one_wide,   // position on an axis of one texel
  nearest,    // distance from the texel taken, texels
  colour,     // against exact filtering at the snapped position and level, LSB
  write_out,  // LSB
  coverage,   // pixels of a polygon that the top-left rule gives otherwise
  in_front,   // covered pixels with W <= 0
  fan_once,   // pixels of a fan's outline not drawn exactly once
  corner,           // of a footprint of step and hat, texels of level 0
  footprint_vector,  // texels of level 0
  footprint_level,   // of aniso, levels
  sample,           // place of a sample of aniso about its footprint's centre, texels of level 0
  squares,          // colours against exact means of the specified footprint, LSB
  aniso,
  area,             // of a texel under step and hat, half square steps of the window
  step_hat,         // LSB
  contour,          // coverage, LSB
};
inline constexpr int stress_stage_count = 32;
const char* name_of(stress_stage s);
const char* unit_of(stress_stage s);

struct stress_worst {
  double error = 0, bound = 0;
  stress_family family{};
  uint64_t case_seed = 0;
  int span_x = 0, span_y = 0, pixel = 0;
  // Part of the bound; a bound of zero allows no error at all.
  double share() const { return bound > 0 ? error / bound : error > 0 ? 1e9 : 0; }
};

struct stress_record {
  uint64_t judged = 0, failures = 0;
  double share = 0;      // of `worst`
  stress_worst worst;    // the largest share of its own bound
  stress_worst largest;  // the largest error
};

struct stress_row {
  stress_family family{};
  uint64_t cases = 0;
  uint64_t evaluations = 0, adverse = 0;  // texture coordinates within s15.16, and those in spans that are what the family is for
  uint64_t undecided = 0;                 // point samples within the bound of a texel's edge: either texel passes
  uint64_t polygons = 0, refused = 0;     // refused: covers no pixel and set-up said so
  uint64_t failed_cases = 0, first_failure = 0;
  stress_record stages[stress_stage_count];

  double adverse_share() const { return evaluations == 0 ? 0 : double(adverse) / double(evaluations); }
  double undecided_share() const {
    const uint64_t judged = stages[int(stress_stage::nearest)].judged;
    return judged == 0 ? 0 : double(undecided) / double(judged);
  }
  uint64_t failures() const;
};

struct stress_options {
  uint64_t evaluations = 10'000'000;  // texture coordinates to evaluate (u and v count one each), over all families
  uint64_t seed = 1;
  double seconds = 0;  // stop after this time; 0: no limit
  int threads = 1;
  std::vector<stress_family> families;  // empty: all
};

struct stress_report {
  profile prof;
  std::vector<stress_row> rows;
  bool complete = true;  // false: stopped by time
};

// Least part of a family's evaluations that must be adverse; 0 where every case is as good as another.
double least_adverse_share(stress_family f);

// Part of the point samples that lie so near a texel's edge that the coordinate bound allows either texel, and the most of a whole run that may.
double undecided_share(const stress_report& r);
double most_undecided_share(const profile& p);

// The bound of a stage at its widest, in the stage's unit; 0 where nothing may be wrong or the bound depends on the place.
double widest_bound(const profile& p, stress_stage s);

// What a run missed although nothing broke a bound: families with too few adverse evaluations, stages never judged. Only of runs that
// are large enough to tell.
std::vector<std::string> shortfalls(const stress_report& r);

stress_report run_stress(const profile& p, const stress_options& options);

// A stage's record over all families.
stress_record over_families(const stress_report& r, stress_stage stage);

// One case again.
stress_row run_case(const profile& p, stress_family family, uint64_t seed);

// One case, what each stage made of it and, if it fails, the simplest numbers found that still do.
std::string describe_case(const profile& p, stress_family family, uint64_t seed);

}  // namespace spantex::sim
