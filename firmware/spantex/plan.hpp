// SPDX-License-Identifier: Apache-2.0
// The planner (docs/SPEC.md "Planner", "Sections"): turns a span and its mask into jobs for the engine. A job has one set of
// coefficients, one integer level and one map section that fits local memory (or is clamped to it, where the profile says so).
//
// With overflow_policy::split and level_scope::pixel a pixel's value depends on the plane, the span and the map only: how a span is
// cut into jobs, the size of local memory and the order of spans cannot change a bit of it.
#pragma once
#include <stdint.h>

#include <spantex/coordinates.hpp>
#include <spantex/datapath.hpp>
#include <spantex/level.hpp>
#include <spantex/plane.hpp>
#include <spantex/profile.hpp>
#include <spantex/span.hpp>
#include <spantex/texture.hpp>

namespace spantex {

// Texels of one level, inclusive, unwrapped.
struct texel_box { int32_t u0, v0, u1, v1; };

struct span_job {
  span_coefficients coefficients;
  span_mask mask;
  texel_box fine, coarse;   // what must be loaded; `coarse` only with two_levels
  int32_t divides;          // reciprocals spent above and below the HAL
};

struct surface {
  const plane* map;
  const texture_view* texture;
  filter kind;
};

namespace detail {

constexpr section section_at(const texture_view& t, int level) {
  return {0, 0, t.ratio_u(level), t.ratio_v(level), uint8_t(level), t.width(level) == 1, t.height(level) == 1};
}

// Box of the texels that the pixels within `pixels` touch on a section's level: the map of a convex screen area in front of the viewer
// is the hull of its corners' images, widened by what rounding can move a position.
template <class Prof>
constexpr texel_box touched(const Prof& prof, const span_coefficients& c, mask_box pixels, const section& at) {
  const profile& q = prof.get();
  int64_t u0 = INT64_MAX, v0 = INT64_MAX, u1 = INT64_MIN, v1 = INT64_MIN;
  for (int corner = 0; corner < 4; ++corner) {
    const texel_position p = position_at(prof, c, corner & 1 ? pixels.x1 : pixels.x0, corner & 2 ? pixels.y1 : pixels.y0);
    const int64_t u = p.u.raw(), v = p.v.raw();
    u0 = u < u0 ? u : u0; u1 = u > u1 ? u : u1;
    v0 = v < v0 ? v : v0; v1 = v > v1 ? v : v1;
  }
  const bool single = pixels.x0 == pixels.x1 && pixels.y0 == pixels.y1;
  const int32_t slack = single ? 0 : position_slack(prof, c);
  const auto moved = [](int64_t x) { return sat_to<coordinate>(s<32, 16>::from_raw(x)); };
  const snapped_position low = snap({moved(u0 - slack), moved(v0 - slack)}, at, c.kind, q);
  const snapped_position high = snap({moved(u1 + slack), moved(v1 + slack)}, at, c.kind, q);
  const int32_t neighbour = c.kind == filter::nearest ? 0 : 1;
  return {low.u, low.v, high.u + neighbour, high.v + neighbour};
}

constexpr bool fits(int32_t low, int32_t high, int side) { return high - low < side; }
constexpr bool fits(const texel_box& b, int side) { return fits(b.u0, b.u1, side) && fits(b.v0, b.v1, side); }

// Where the section starts: at the box, or, if that is too large, so that both have the same middle.
constexpr int32_t section_origin(int32_t low, int32_t high, int side) {
  return fits(low, high, side) ? low : (low + high + 1 - side) >> 1;
}

constexpr void place(section& at, texel_box& box, int side) {
  at.origin_u = section_origin(box.u0, box.u1, side);
  at.origin_v = section_origin(box.v0, box.v1, side);
  box.u0 = max_of(box.u0, at.origin_u);
  box.v0 = max_of(box.v0, at.origin_v);
  box.u1 = min_of(box.u1, at.origin_u + side - 1);
  box.v1 = min_of(box.v1, at.origin_v + side - 1);
}

// Sets a job's sections for its level and mask. False if one of them does not fit.
template <class Prof>
constexpr bool take_sections(const Prof& prof, const texture_view& t, int level, bool two_levels, span_job& job) {
  const profile& q = prof.get();
  span_coefficients& c = job.coefficients;
  const mask_box pixels = box_of(job.mask);
  c.fine = section_at(t, level);
  c.two_levels = two_levels;
  job.fine = touched(prof, c, pixels, c.fine);
  bool fit = fits(job.fine, q.fine_side);
  place(c.fine, job.fine, q.fine_side);
  if (two_levels) {
    c.coarse = section_at(t, level + 1);
    job.coarse = touched(prof, c, pixels, c.coarse);
    fit = fits(job.coarse, q.coarse_side()) && fit;
    place(c.coarse, job.coarse, q.coarse_side());
  }
  return fit;
}

// Pixels in Morton order: index to bit. Aligned runs of 2^k are rectangles, squares or two squares side by side.
constexpr int morton_bit(int index) {
  const int x = (index & 1) | ((index >> 1) & 2) | ((index >> 2) & 4);
  const int y = ((index >> 1) & 1) | ((index >> 2) & 2) | ((index >> 3) & 4);
  return y * span_side + x;
}

// Mask of the aligned run of `count` pixels that begins at a Morton index; count a power of two.
constexpr span_mask run_mask(int index, int count) {
  const int first = morton_bit(index), last = morton_bit(index + count - 1);
  const int width = last % span_side - first % span_side + 1, height = last / span_side - first / span_side + 1;
  span_mask mask = 0;
  for (int j = 0; j < height; ++j) mask |= span_mask((1u << width) - 1) << (first + j * span_side);
  return mask;
}

// Emits the largest aligned runs of the job's mask whose sections fit. A single pixel always does.
template <class Prof, class Sink>
constexpr status split_job(const Prof& prof, const texture_view& t, int level, bool two_levels, const span_job& whole, Sink& sink) {
  span_job part = whole;
  for (int index = 0, count = span_pixel_count; index < span_pixel_count;) {
    part.mask = whole.mask & run_mask(index, count);
    if (part.mask != 0) {
      if (!take_sections(prof, t, level, two_levels, part) && count > 1) { count /= 2; continue; }
      SPANTEX_TRY(sink(part));
      part.divides = 0;
    }
    index += count;
    while (count < span_pixel_count && index % (2 * count) == 0) count *= 2;
  }
  return status::ok;
}

// One level of one span, by the profile's policy.
template <class Prof, class Sink>
constexpr status emit_level(const Prof& prof, const texture_view& t, int level, bool two_levels, span_job& job, Sink& sink) {
  const profile& q = prof.get();
  if (take_sections(prof, t, level, two_levels, job)) return sink(job);
  switch (q.overflow) {
    case overflow_policy::clamp:
      job.coefficients.corrects = true;
      return sink(job);
    case overflow_policy::coarser:
      while (uses_levels(job.coefficients.kind) && level < t.last_level()) {
        ++level;
        if (take_sections(prof, t, level, false, job)) return sink(job);
      }
      break;
    case overflow_policy::split: break;
  }
  return split_job(prof, t, level, two_levels && level < t.last_level(), job, sink);
}

// The level a whole span shares (level_scope::span): that of its reference point, where w = 1.
constexpr int32_t reference_level(const profile& q, const span_coefficients& c) {
  const int32_t term =
      c.level_row[span_side / 2] > c.level_column[span_side / 2] ? c.level_row[span_side / 2] : c.level_column[span_side / 2];
  const int32_t level = shift_right(term * (1 << (16 - level_term_bits)) + q.level_bias * (1 << 12), 16 - q.level_bits);
  return clamp_to(level, 0, int32_t(c.last_level) << q.level_bits);
}

// Cuts a mask by integer level and emits each part.
template <class Prof, class Sink>
constexpr status emit_levels(const Prof& prof, const texture_view& t, span_job& job, Sink& sink) {
  const profile& q = prof.get();
  span_coefficients& c = job.coefficients;
  if (!uses_levels(c.kind)) return emit_level(prof, t, 0, false, job, sink);

  span_mask with_level[max_levels] = {}, with_fraction = 0;
  const bool shared = q.scope == level_scope::span;
  const int shared_level = integer_level(c.kind, reference_level(q, c), q.level_bits, c.last_level);
  for (span_mask rest = job.mask; rest != 0; rest &= rest - 1) {
    const int k = __builtin_ctzll(rest);
    const int32_t level = level_at(prof, c, k % span_side, k / span_side);
    const int whole = shared ? shared_level : integer_level(c.kind, level, q.level_bits, c.last_level);
    with_level[whole] |= span_mask(1) << k;
    if (level > whole << q.level_bits) with_fraction |= span_mask(1) << k;
  }
  for (int level = 0; level <= c.last_level; ++level) {
    if (with_level[level] == 0) continue;
    job.mask = with_level[level];
    const bool two = uses_two_levels(c.kind) && level < c.last_level && (with_level[level] & with_fraction) != 0;
    SPANTEX_TRY(emit_level(prof, t, level, two, job, sink));
    job.divides = 0;
  }
  return status::ok;
}

constexpr span_coefficients blank_coefficients(const surface& s) {
  span_coefficients c{};
  c.kind = s.kind;
  c.last_level = uint8_t(s.texture->last_level());
  return c;
}

}  // namespace detail

// Plans span (sx, sy): calls sink(span_job&) -> status for every job, in a fixed order. All pixels of the mask have W > 0.
template <class Prof, class Sink>
constexpr status plan_span(const Prof& prof, const surface& s, int32_t sx, int32_t sy, span_mask mask, Sink&& sink) {
  const profile& q = prof.get();
  const int32_t cx = 2 * span_side * sx + span_side, cy = 2 * span_side * sy + span_side;  // the centre, half pixels
  span_job job{detail::blank_coefficients(s), mask, {}, {}, 1};
  span_coefficients& c = job.coefficients;
  if (s.map->w_at(cx, cy) > 0) {
    const reference r = reference_at(*s.map, cx, cy);
    if (span_coordinates(*s.map, r, q, c)) {
      if (uses_levels(s.kind)) {
        if (q.formula == level_formula::major) major_levels(*s.map, r, c);
        else span_levels(q, c);
      }
      if (c.how == evaluation::divide) job.divides += __builtin_popcountll(mask);
      return detail::emit_levels(prof, *s.texture, job, sink);
    }
  }
  // The horizon crosses the span or is near: every pixel about its own centre.
  for (span_mask rest = mask; rest != 0; rest &= rest - 1) {
    const int k = __builtin_ctzll(rest);
    const int32_t hx = cx + half_pixels(k % span_side), hy = cy + half_pixels(k / span_side);
    const reference r = reference_at(*s.map, hx, hy);
    job = {detail::blank_coefficients(s), span_mask(1) << k, {}, {}, 1};
    pixel_coordinates(r, q, c);
    if (uses_levels(s.kind)) {
      if (q.formula == level_formula::major) major_levels(*s.map, r, c);
      else pixel_levels(*s.map, r, hx, hy, c);
    }
    SPANTEX_TRY(detail::emit_levels(prof, *s.texture, job, sink));
  }
  return status::ok;
}

}  // namespace spantex
