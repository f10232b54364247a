// SPDX-License-Identifier: Apache-2.0
#include "sweep_watch.hpp"

#include <math.h>

#include <algorithm>

#include <spantex/coordinates.hpp>
#include <spantex/level.hpp>
#include "exact.hpp"

namespace spantex::sim {

void span_watch::error_sum::add(double error) {
  worst = std::max(worst, error);
  squares += error * error;
  ++count;
}

double span_watch::error_sum::rms() const { return count == 0 ? 0 : sqrt(squares / double(count)); }

void span_watch::job(const span_coefficients& c, span_mask mask, uint64_t samples) {
  if (!c.axis.partial || c.axis.first_sample == 0)  // a pixel in parts is judged once
    for (span_mask rest = mask; rest != 0; rest &= rest - 1) {
      const int k = __builtin_ctzll(rest);
      judge_pixel(c, k % span_side, k / span_side);
    }
  count_products(c, uint64_t(__builtin_popcountll(mask)), samples);
}

void span_watch::judge_pixel(const span_coefficients& c, int i, int j) {
  const int32_t hx = 2 * (span_side * sx_ + i) + 1, hy = 2 * (span_side * sy_ + j) + 1;
  const exact_point exact = exact_at(*map_, hx, hy);
  if (exact.w <= 0) return;
  if (!c.centred && in_range(exact.u, exact.w) && in_range(exact.v, exact.w)) {
    const texel_position at = position_at(prof_, c, i, j);
    coordinate.add(std::max(coordinate_error(at.u.raw(), exact.u, exact.w), coordinate_error(at.v.raw(), exact.v, exact.w)));
  }
  if (!uses_two_levels(c.kind) || uses_footprint(c.kind) || map_->w_at(hx, hy) <= 0) return;
  const profile& q = prof_.value;
  const int32_t one = 1 << q.level_bits, fine = c.fine.level * one;
  const int32_t taken = c.two_levels ? fine + clamp_to(level_at(prof_, c, i, j) - fine, 0, one - 1) : fine;
  const long double formula = biased_level(q, exact_level(q.formula, *map_, hx, hy));
  const double wanted = double(std::clamp(formula, 0.0L, static_cast<long double>(c.last_level)));
  level.add(fabs(double(taken) / one - wanted));
}

// SPEC 4 to 10; the factors' bits without signs.
void span_watch::count_products(const span_coefficients& c, uint64_t pixels, uint64_t samples) {
  const profile& q = prof_.value;
  const int r = q.reciprocal_bits, word = r <= 15 ? 16 : 32;
  const uint64_t inversions = uses_area(c.kind) ? pixels * uint64_t(1 + (c.kind == filter::hat ? 6 : 4)) : pixels;
  const bool inverts = c.how == evaluation::divide || (uses_footprint(c.kind) && c.how == evaluation::series);
  if (inverts) products.add(inversions * 2 * uint64_t(std::min(prof_.units.reciprocal_iterations, word == 16 ? 1 : 2)), word, word);
  if (c.how == evaluation::divide) products.add(inversions * 2, q.offset_bits, r);
  if (c.how == evaluation::series) products.add(pixels * uint64_t(c.terms - 1 + 2), 16, 16);
  if (uses_footprint(c.kind) && c.how != evaluation::affine) products.add(pixels * 4, q.offset_bits, r);
  if (uses_levels(c.kind) && !uses_area(c.kind) && (c.g | c.h) != 0) products.add(pixels * (c.slope_log2 <= most_level_slope_log2 ? 2 : 1), 16, 16);
  const uint64_t channels = samples * channel_count;
  if (c.kind == filter::nearest) return;
  if (uses_area(c.kind)) return products.add(channels * 4, 8, 24);
  if (c.kind == filter::squares) return products.add(channels * 4, 8, 8);
  const uint64_t levels = c.two_levels ? 2 : 1;
  const int s = q.subtexel_bits;
  if (uses_three_points(c.kind)) {
    products.add(channels * levels * 2, 8, s);
  } else {
    products.add(channels * levels * 2, 8, s);
    products.add(channels * levels, 8 + s, s);
  }
  if (c.two_levels) products.add(channels, 8 + std::min(q.blend_bits, 2 * s), q.level_bits);
}

}  // namespace spantex::sim
