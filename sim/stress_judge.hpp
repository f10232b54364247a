// SPDX-License-Identifier: Apache-2.0
// Evaluates spans as the planner and the datapath do, and judges every stage against exact integers and its bound (accuracy.hpp).
#pragma once
#include <spantex/coverage.hpp>
#include <spantex/plane.hpp>

#include "sim/exact.hpp"
#include "sim/stress.hpp"
#include "sim/stress_planes.hpp"

namespace spantex::sim {

// The forms of a plane before any rounding, at half pixels: value(hx, hy) = x hx + y hy + 2 c.
struct exact_form {
  int128 x, y, c;
  constexpr int128 at(int32_t hx, int32_t hy) const { return x * hx + y * hy + 2 * c; }
};
struct exact_plane {
  exact_form u, v, w;
};

inline exact_plane exact_plane_of(const homography& m) {
  return {{int128_of(m.a), int128_of(m.b), int128_of(m.c)},
          {int128_of(m.d), int128_of(m.e), int128_of(m.f)},
          {int128_of(m.g), int128_of(m.h), int128_of(m.i)}};
}

// Bounds of one profile as doubles, by the exponent of a span's mantissas where they depend on its reach. Of a coordinate without what set-up's
// rounding may do: that is judged at its own place.
struct stress_bounds {
  explicit stress_bounds(const profile& p);
  profile prof;
  double numerator[64], affine[64], series[64], divide[64];
  double pixel_numerator, pixel, set_up, saturation, relative_w, reciprocal, level, major_level, log2, snapping[16], colour[2];
};

struct stress_map;

class stress_judge {
 public:
  stress_judge(const stress_bounds& bounds, uint64_t seed, stress_row& row) : bounds_(bounds), seed_(seed), row_(row) {}

  // The pixels of `mask` with W > 0.
  void judge_span(const plane& map, span_at s, span_mask mask, bool adverse);
  // The row and the column of the screen through the case's anchor, from end to end: bounds, and how the error changes from the first span
  // on.
  void judge_walks(const stress_plane_case& c);
  // A span gives the same bits as the same span of the plane moved to the screen's corner.
  void judge_moved(const plane& map, span_at s);
  // The rounded coefficients against the exact forms, at one position.
  void judge_set_up(const exact_plane& exact, rectangle region, const plane& map, int32_t hx, int32_t hy);

  void note(stress_stage stage, double error, double bound, span_at s, int pixel);

 private:
  struct evaluated_pixel;
  class span_under_test;
  struct signed_error {
    double u = 0, v = 0, bound = 0;
    bool counts = false;
  };

  signed_error judge_pixel(span_under_test& span, const stress_map& sampled, int k, bool adverse);
  void judge_arithmetic(const evaluated_pixel& e);
  void judge_axis(const evaluated_pixel& e, const stress_map& sampled, bool v, double bound);
  void judge_out_of_range(const evaluated_pixel& e, bool v);
  void judge_levels(span_under_test& span, const evaluated_pixel& e);
  void judge_colour(span_under_test& span, const evaluated_pixel& e, const stress_map& sampled);
  void judge_walk(stress_stage stage, const plane& map, int line, int spans, bool down);

  const stress_bounds& bounds_;
  uint64_t seed_;
  stress_row& row_;
};

}  // namespace spantex::sim
