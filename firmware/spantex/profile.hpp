// SPDX-License-Identifier: Apache-2.0
// Profiles: every word length and memory size in one place. On a device a profile is a type and all of it is known at
// compile time; in the simulator the same numbers arrive at run time and pass through the same arithmetic.
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>

namespace spantex {

// What happens when a span's map section does not fit local texture memory (VR11; docs/SPEC.md "Sections").
enum class overflow_policy : uint8_t {
  coarser,  // the level is raised until the section fits: blur
  clamp,    // the correction clamps coordinates to the section: error, as in VR11
  split,    // the span is computed in parts, each with its own section: cost
};

// Where the integer part of the level of detail is decided.
enum class level_scope : uint8_t { span, pixel };

// Which formula gives the level of detail (METHODS section 1).
enum class level_formula : uint8_t {
  major,     // KT88: log2 K - 2 log2 W, K fixed per plane; major axis of a circle of diameter two pixel intervals
  jacobian,  // the longer column of the Jacobian, as Vulkan's rho
  minor,     // KT88: log2 K' - log2 W; minor axis of the same circle: its image's area over the major axis
};

struct profile {
  int fine_side = 16;                               // texels per side of the finer bank set; the coarser has half
  overflow_policy overflow = overflow_policy::split;
  level_scope scope = level_scope::pixel;
  level_formula formula = level_formula::jacobian;
  int level_bias = 0;                               // s3.4: added to the level of detail, in 1/16 level
  int mip_bias = 0;                                 // s3.4: of filters with one sample a pixel, 1/16 level (-16 to 0): level.hpp, finer()
  int coordinate_bits = 16;                         // fraction bits of u, v in texels of level 0 (at most 16)
  int offset_bits = 31;                             // magnitude bits of the span-relative numerators (at most 31)
  int reciprocal_bits = 30;                         // fraction bits of 1/w and of the slopes g, h (12 to 30)
  int tolerance_bits = 12;                          // cheaper evaluations may err by 2^-tolerance_bits texel
  int subtexel_bits = 8;                            // fraction bits of a snapped position: the weights of the filter
  int level_bits = 8;                               // fraction bits of the level of detail
  int blend_bits = 16;                              // fraction bits of each level's colour, kept before two are interpolated (at most 16)
  int max_samples = 16;                             // filter aniso: samples along a footprint, and the axes' ratio that they follow, 1 to 16
  int sample_spacing = 0;                           // a minor axis apart; what is beyond two of them, 2^(this / 16) (0 to 16)
  int sample_slack = 2;                             // of so many pitches, less this many 1/16, rounded up, their number is (0 to 15)
  int sample_bias = -8;                             // s3.4: the same of a footprint's samples (aniso)
  int area_side_log2 = 4;                           // filters step, hat: a footprint lies within 2^this texels a side (1 to 4)
  bool contours = true;                             // filter contour; false leaves its code out: alpha comes as from trilinear
  bool exact_set_up = true;                         // coordinates keep their bound against the caller's integers where set-up's rounding would
                                                    // show (near the horizon, far from the origin); false leaves the code out
  bool linear_light = true;                         // sRGB maps in linear light; false leaves code and table out: filtered as coded
  rounding position_rounding = rounding::nearest;   // when a position is snapped to subtexel_bits
  rounding colour_rounding = rounding::even;        // at write-out, and of means: halves are the rule with weights of 1/2 and 1/4

  constexpr int coarse_side() const { return fine_side / 2; }
  friend constexpr bool operator==(const profile&, const profile&) = default;
};

constexpr bool is_valid(const profile& p) {
  return (p.fine_side == 8 || p.fine_side == 16 || p.fine_side == 32) &&
         p.level_bias >= -128 && p.level_bias <= 127 && p.mip_bias >= -16 && p.mip_bias <= 0 &&
         p.coordinate_bits >= 4 && p.coordinate_bits <= 16 && p.offset_bits >= 12 && p.offset_bits <= 31 &&
         p.reciprocal_bits >= 12 && p.reciprocal_bits <= 30 && p.tolerance_bits >= 0 && p.tolerance_bits <= 16 &&
         p.subtexel_bits >= 1 && p.subtexel_bits <= 8 && p.level_bits >= 1 && p.level_bits <= 8 &&
         p.blend_bits >= 0 && p.blend_bits <= 16 && p.max_samples >= 1 && p.max_samples <= 16 &&
         p.sample_spacing >= 0 && p.sample_spacing <= 16 && p.sample_slack >= 0 && p.sample_slack <= 15 && p.sample_bias >= -16 && p.sample_bias <= 0 &&
         p.area_side_log2 >= 1 && p.area_side_log2 <= 4;
}

namespace profiles {

// VR11's own machine: 8x8 + 4x4 texels, 2560 bits a copy, clamping correction, KT88 level of detail, one integer level a span.
inline constexpr profile seed{.fine_side = 8, .overflow = overflow_policy::clamp, .scope = level_scope::span,
                              .formula = level_formula::major, .coordinate_bits = 12, .offset_bits = 23,
                              .reciprocal_bits = 22, .tolerance_bits = 8, .exact_set_up = false};

// 32-bit products only: 16-bit numerators and reciprocals.
inline constexpr profile compact{.fine_side = 8, .overflow = overflow_policy::coarser, .coordinate_bits = 10,
                                 .offset_bits = 15, .reciprocal_bits = 14, .tolerance_bits = 7, .subtexel_bits = 6,
                                 .level_bits = 6, .blend_bits = 8, .exact_set_up = false};

// Quality for its cost: the longest tolerance that keeps the promise of 1/256 texel, colours of 15 bits between levels.
inline constexpr profile standard{.fine_side = 16, .mip_bias = -8, .coordinate_bits = 14, .tolerance_bits = 8, .subtexel_bits = 7, .blend_bits = 7,
                                  .sample_spacing = 12};

// The promised accuracy everywhere.
inline constexpr profile exact{.fine_side = 32, .mip_bias = -8, .sample_slack = 0};

}  // namespace profiles

// How 1/w is evaluated on a span.
enum class evaluation_order : uint8_t {
  by_tolerance,                        // the cheapest that keeps the tolerance: every profile of a device
  affine,                              // no division at all: what perspective bends within a span is lost
  series1, series2, series3, series4,  // so many terms; a divide where |w - 1| may reach 1/4
  divide,                              // everywhere but where w is 1
};

// What all devices have alike, and the simulator may vary beside a profile's numbers (docs/SWEEPS.md): the same arithmetic with other constants.
struct unit_variants {
  int reciprocal_table_log2 = 7;  // the datapath's reciprocal unit: 2^this seeds (3 to 10) ...
  int reciprocal_iterations = 2;  // ... and Newton steps (0 to 2; of a unit of 16 bits at most 1)
  evaluation_order order = evaluation_order::by_tolerance;
  int span_log2 = 3;              // pixels along a side of what shares a reference point, a level's terms and an evaluation: 4, 8 or 16
  friend constexpr bool operator==(const unit_variants&, const unit_variants&) = default;
};

constexpr bool is_valid(const unit_variants& v) {
  return v.reciprocal_table_log2 >= 3 && v.reciprocal_table_log2 <= 10 && v.reciprocal_iterations >= 0 && v.reciprocal_iterations <= 2 && v.span_log2 >= 2 &&
         v.span_log2 <= 4;
}

// A profile known at compile time.
template <profile P>
struct fixed_profile {
  static_assert(is_valid(P), "spantex: a profile's numbers are outside their documented ranges");
  static constexpr int max_fine_side = P.fine_side;
  static constexpr int max_offset_bits = P.offset_bits;
  static constexpr int max_reciprocal_bits = P.reciprocal_bits;
  static constexpr bool has_contours = P.contours, has_linear_light = P.linear_light, has_exact_set_up = P.exact_set_up;
  static constexpr bool has_variants = false;
  constexpr const profile& get() const { return value; }
  static constexpr unit_variants variants() { return {}; }
  static constexpr profile value = P;
};

// A profile known at run time (simulator and sweeps): the widest formats, quantised to the numbers given.
struct run_time_profile {
  static constexpr int max_fine_side = 32;
  static constexpr int max_offset_bits = 31;
  static constexpr int max_reciprocal_bits = 30;
  static constexpr bool has_contours = true, has_linear_light = true, has_exact_set_up = true, has_variants = true;
  constexpr const profile& get() const { return value; }
  constexpr const unit_variants& variants() const { return units; }
  profile value;
  unit_variants units{};
};

}  // namespace spantex
