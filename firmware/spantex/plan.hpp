// SPDX-License-Identifier: Apache-2.0
// The planner (docs/SPEC.md "Planner", "Sections"): turns a span and its mask into jobs for the engine. A job has one set of
// coefficients, one integer level and one map section that fits local memory (or is clamped to it, where the profile says so).
//
// With overflow_policy::split and level_scope::pixel a pixel's value depends on the plane, the span and the map only: how a span is
// cut into jobs, the size of local memory and the order of spans cannot change a bit of it.
#pragma once
#include <stdint.h>

#include <spantex/area.hpp>
#include <spantex/coordinates.hpp>
#include <spantex/datapath.hpp>
#include <spantex/footprint.hpp>
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
  bool completes = true;    // the last part of its pixel, if the coefficients are partial
};

inline constexpr int16_t no_fixed_level = INT16_MIN;

struct surface {
  const plane* map;
  const texture_view* texture;
  filter kind;
  int16_t fixed_level = no_fixed_level;  // s5.10: one level of detail for an affine map, found once; otherwise by the profile's formula
};

namespace detail {

constexpr section section_at(const texture_view& t, int level) {
  return {0, 0, t.ratio_u(level), t.ratio_v(level), uint8_t(level), t.width(level) == 1, t.height(level) == 1};
}

constexpr texel_box joined(const texel_box& a, const texel_box& b) {
  return {min_of(a.u0, b.u0), min_of(a.v0, b.v0), max_of(a.u1, b.u1), max_of(a.v1, b.v1)};
}

// Texels of the 2x2 of every sample position between two.
constexpr texel_box box_between(texel_position low, texel_position high, const section& at, filter kind, const profile& q) {
  const snapped_position a = snap(low, at, kind, q), b = snap(high, at, kind, q);
  const int32_t neighbour = kind == filter::nearest ? 0 : 1;
  return {a.u, a.v, b.u + neighbour, b.v + neighbour};
}

// Of the samples [first, last) of one pixel's footprint: exact.
template <class Prof>
constexpr texel_box samples_touch(const Prof& prof, const span_coefficients& c, int i, int j, const section& at) {
  const profile& q = prof.get();
  const texel_position centre = position_at(prof, c, i, j);
  const footprint f = footprint_at(prof, c, i, j);
  const int first = c.axis.first_sample, last = min_of(c.axis.last_sample, f.samples) - 1;
  if (c.kind == filter::squares) {
    const snapped_position p = snap(centre, at, c.kind, q);
    const auto box = [&](int k) {
      const square s = square_at(f, p.fraction, q.subtexel_bits, k);
      return texel_box{p.u + s.u, p.v + s.v, p.u + s.u + 1, p.v + s.v + 1};
    };
    return joined(box(first), box(last));
  }
  const texel_position p = sample_position(centre, f, first), r = sample_position(centre, f, last);
  const auto ordered = [](coordinate x, coordinate y, bool larger) { return (x < y) == larger ? y : x; };
  return box_between({ordered(p.u, r.u, false), ordered(p.v, r.v, false)}, {ordered(p.u, r.u, true), ordered(p.v, r.v, true)}, at, c.kind, q);
}

// How far footprints of the pixels within `pixels` reach from their centres along u and v, raw s15.16 on level 0: n is linear and 1/w^2 is
// monotone along a line, so the product of their largest corner values bounds every pixel.
struct axis_reach { int64_t u, v; };
template <class Prof>
constexpr axis_reach footprint_reach(const Prof& prof, const span_coefficients& c, mask_box pixels) {
  const axis_terms& t = c.axis;
  uint64_t u = 0, v = 0;
  uint32_t reciprocal = 0;
  for (int corner = 0; corner < 4; ++corner) {
    const int i = corner & 1 ? pixels.x1 : pixels.x0, j = corner & 2 ? pixels.y1 : pixels.y0;
    const uint64_t nu = magnitude(numerator_at<Prof>(c, t.c_u, t.a_u, t.b_u, i, j).raw());
    const uint64_t nv = magnitude(numerator_at<Prof>(c, t.c_v, t.a_v, t.b_v, i, j).raw());
    const uint32_t r = reciprocal_at(prof, c, i, j);
    u = nu > u ? nu : u;
    v = nv > v ? nv : v;
    reciprocal = r > reciprocal ? r : reciprocal;
  }
  // Half the length, and one for the roundings; the reciprocal unit is monotone to within four of its last bits.
  const auto half = [&](uint64_t n) {
    using mantissa = offset_mantissa<Prof>;
    const auto longest = mantissa::from_raw(typename mantissa::rep(n));
    return int64_t(axis_at(prof, c, longest, reciprocal + 4).raw()) / 2 + 2;
  };
  return {half(u), half(v)};
}

// Box of positions of level 0.
struct wide_box {
  wide_coordinate u0, v0, u1, v1;
  constexpr void add(const wide_position& p) {
    u0 = p.u < u0 ? p.u : u0; u1 = p.u > u1 ? p.u : u1;
    v0 = p.v < v0 ? p.v : v0; v1 = p.v > v1 ? p.v : v1;
  }
};

// Texels of step's and hat's footprints: exact for one pixel, otherwise the hull of the outermost corners.
template <class Prof>
constexpr texel_box area_touches(const Prof& prof, const span_coefficients& c, mask_box pixels, const section& at) {
  const profile& q = prof.get();
  if (pixels.x0 == pixels.x1 && pixels.y0 == pixels.y1) {
    const area_window w = area_window_at(prof, c, pixels.x0, pixels.y0, at);
    const area_tile part = tile_at(w, c.axis, q.fine_side);
    const int32_t u = w.u + part.column, v = w.v + part.row;
    return {u, v, u + part.columns - 1, v + part.rows - 1};
  }
  const auto far = int8_t(area_margin(c.kind)), near = int8_t(-far);
  const wide_position first = position_beside(prof, c, pixels.x0, pixels.y0, {near, near});
  wide_box box{first.u, first.v, first.u, first.v};
  box.add(position_beside(prof, c, pixels.x1, pixels.y0, {far, near}));
  box.add(position_beside(prof, c, pixels.x0, pixels.y1, {near, far}));
  box.add(position_beside(prof, c, pixels.x1, pixels.y1, {far, far}));
  const int32_t slack = position_slack(prof, c);
  const auto texel = [&](wide_coordinate x, int32_t more, uint32_t ratio) {
    return area_on_level(wide_coordinate::from_raw(x.raw() + more), ratio, at.level, q) >> q.subtexel_bits;
  };
  return {texel(box.u0, -slack, at.ratio_u), texel(box.v0, -slack, at.ratio_v), texel(box.u1, slack, at.ratio_u),
          texel(box.v1, slack, at.ratio_v)};
}

// The finest level on which a pixel's footprint lies in the window; the last one if none. An axis that is one texel long always does.
template <class Prof>
constexpr int area_level(const Prof& prof, const texture_view& t, const span_coefficients& c, int i, int j) {
  const profile& q = prof.get();
  const wide_position centre = position_beside(prof, c, i, j, {0, 0});
  wide_box box{centre.u, centre.v, centre.u, centre.v};
  for (int k = 0; k < corner_count(c.kind); ++k) box.add(position_beside(prof, c, i, j, area_corner(c.kind, k)));
  const auto fits = [&](wide_coordinate low, wide_coordinate high, int32_t texels, uint32_t ratio, int level) {
    const int32_t a = area_on_level(low, ratio, level, q), b = area_on_level(high, ratio, level, q);
    return texels == 1 || texels_within(a, b, q.subtexel_bits) <= 1 << q.area_side_log2;
  };
  int level = 0;
  while (level < t.last_level() && !(fits(box.u0, box.u1, t.width(level), t.ratio_u(level), level) &&
                                     fits(box.v0, box.v1, t.height(level), t.ratio_v(level), level)))
    ++level;
  return level;
}

// Box of the texels that the pixels within `pixels` touch on a section's level: the map of a convex screen area in front of the viewer
// is the hull of its corners' images, widened by what rounding can move a position and by the footprints.
template <class Prof>
constexpr texel_box touched(const Prof& prof, const span_coefficients& c, mask_box pixels, const section& at) {
  const profile& q = prof.get();
  if (uses_area(c.kind)) return area_touches(prof, c, pixels, at);
  const bool single = pixels.x0 == pixels.x1 && pixels.y0 == pixels.y1;
  if (single && uses_footprint(c.kind)) return samples_touch(prof, c, pixels.x0, pixels.y0, at);
  int64_t u0 = INT64_MAX, v0 = INT64_MAX, u1 = INT64_MIN, v1 = INT64_MIN;
  for (int corner = 0; corner < 4; ++corner) {
    const texel_position p = position_at(prof, c, corner & 1 ? pixels.x1 : pixels.x0, corner & 2 ? pixels.y1 : pixels.y0);
    const int64_t u = p.u.raw(), v = p.v.raw();
    u0 = u < u0 ? u : u0; u1 = u > u1 ? u : u1;
    v0 = v < v0 ? v : v0; v1 = v > v1 ? v : v1;
  }
  axis_reach more{};
  if (uses_footprint(c.kind)) more = footprint_reach(prof, c, pixels);
  const bool squares = c.kind == filter::squares;
  const int64_t slack = single ? 0 : position_slack(prof, c), slack_u = slack + (squares ? 0 : more.u), slack_v = slack + (squares ? 0 : more.v);
  const auto moved = [](int64_t x) { return sat_to<coordinate>(s<47, 16>::from_raw(x)); };
  texel_box box = box_between({moved(u0 - slack_u), moved(v0 - slack_v)}, {moved(u1 + slack_u), moved(v1 + slack_v)}, at, c.kind, q);
  if (squares) {  // whole squares in one of eight directions: at most half the row's length, sqrt 2 times its larger part, and two texels
    const int32_t aside = int32_t((more.u > more.v ? more.u : more.v) * 3 / 2 >> (16 + at.level)) + 3;
    box = {box.u0 - aside, box.v0 - aside, box.u1 + aside, box.v1 + aside};
  }
  return box;
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

// A single pixel whose footprint does not fit: the longest runs of its samples that do. A single sample always does. Step and hat: the
// tiles of its window.
template <class Prof, class Sink>
constexpr status split_pixel(const Prof& prof, const texture_view& t, int level, bool two_levels, span_job& part, Sink& sink) {
  span_coefficients& c = part.coefficients;
  const int k = __builtin_ctzll(part.mask), i = k % span_side, j = k / span_side;
  const bool tiles = uses_area(c.kind);
  const int samples = tiles ? tile_count(area_window_at(prof, c, i, j, c.fine), prof.get().fine_side) : footprint_at(prof, c, i, j).samples;
  c.axis.partial = true;
  for (int first = 0, count = tiles ? 1 : samples; first < samples;) {
    c.axis.first_sample = uint8_t(first);
    c.axis.last_sample = uint8_t(min_of(first + count, samples));
    if (!take_sections(prof, t, level, two_levels, part) && count > 1) { count = (count + 1) / 2; continue; }
    first += count;
    part.completes = first >= samples;
    SPANTEX_TRY(sink(part));
    part.divides = 0;
  }
  c.axis.partial = false;
  c.axis.first_sample = 0;
  c.axis.last_sample = max_footprint_samples;
  part.completes = true;
  return status::ok;
}

// Emits the largest aligned runs of the job's mask whose sections fit. A single pixel does, or is split.
template <class Prof, class Sink>
constexpr status split_job(const Prof& prof, const texture_view& t, int level, bool two_levels, const span_job& whole, Sink& sink) {
  span_job part = whole;
  for (int index = 0, count = span_pixel_count; index < span_pixel_count;) {
    part.mask = whole.mask & run_mask(index, count);
    if (part.mask != 0) {
      const bool fit = take_sections(prof, t, level, two_levels, part);
      if (!fit && count > 1) { count /= 2; continue; }
      SPANTEX_TRY(fit ? sink(part) : split_pixel(prof, t, level, two_levels, part, sink));
      part.divides = 0;
    }
    index += count;
    while (count < span_pixel_count && index % (2 * count) == 0) count *= 2;
  }
  return status::ok;
}

// What is done with a section that does not fit. Footprints need all their texels. A clamped field would draw contours thinner than asked, where
// a coarser level's field keeps their width.
constexpr overflow_policy policy_of(const profile& q, filter kind) {
  if (uses_footprint(kind) || uses_area(kind)) return overflow_policy::split;
  return kind == filter::contour && q.overflow == overflow_policy::clamp ? overflow_policy::coarser : q.overflow;
}

// One level of one span, by the profile's policy; footprints are always split: cut short or blurred they would be of no use.
template <class Prof, class Sink>
constexpr status emit_level(const Prof& prof, const texture_view& t, int level, bool two_levels, span_job& job, Sink& sink) {
  const profile& q = prof.get();
  if (take_sections(prof, t, level, two_levels, job)) return sink(job);
  switch (policy_of(q, job.coefficients.kind)) {
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

// Level of detail of a pixel, 2^-level_bits.
template <class Prof>
constexpr int32_t pixel_level(const Prof& prof, const texture_view& t, const span_coefficients& c, int i, int j) {
  if (uses_area(c.kind)) return area_level(prof, t, c, i, j) << prof.get().level_bits;
  return uses_footprint(c.kind) ? footprint_at(prof, c, i, j).level : level_at(prof, c, i, j);
}

// Row or column of the span nearest to the reference point; of the two middle ones the second.
constexpr int nearest_index(int8_t from) { return clamp_to(span_side / 2 - from / 2, 0, span_side - 1); }

// The level a whole span shares (level_scope::span): that of its reference point, where w = 1.
template <class Prof>
constexpr int32_t reference_level(const Prof& prof, const span_coefficients& c) {
  const profile& q = prof.get();
  if (uses_footprint(c.kind)) return footprint_level(prof, c);
  const int row = nearest_index(c.from_y), column = nearest_index(c.from_x);
  const int32_t term = c.level_row[row] > c.level_column[column] ? c.level_row[row] : c.level_column[column];
  const int32_t level = shift_right(finer(term * (1 << (16 - level_term_bits)), q.mip_bias) + q.level_bias * (1 << 12), 16 - q.level_bits);
  return clamp_to(level, 0, int32_t(c.last_level) << q.level_bits);
}

// Cuts a mask by integer level and emits each part.
template <class Prof, class Sink>
constexpr status emit_levels(const Prof& prof, const texture_view& t, span_job& job, Sink& sink) {
  const profile& q = prof.get();
  span_coefficients& c = job.coefficients;
  if (!uses_levels(c.kind)) return emit_level(prof, t, 0, false, job, sink);

  span_mask with_level[max_levels] = {}, with_fraction = 0;
  const bool shared = q.scope == level_scope::span && !uses_area(c.kind);  // an area's level is what bounds its texels
  const int shared_level = shared ? integer_level(c.kind, reference_level(prof, c), q.level_bits, c.last_level) : 0;
  for (span_mask rest = job.mask; rest != 0; rest &= rest - 1) {
    const int k = __builtin_ctzll(rest);
    const int32_t level = pixel_level(prof, t, c, k % span_side, k / span_side);
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

constexpr void fix_levels(int16_t level, span_coefficients& c) {
  fill(c.level_row, level);
  fill(c.level_column, level);
}

// Coordinates of a span about its centre; false if its pixels must be evaluated one by one.
// From the plane's forms; from those before set-up's rounding where that could show.
template <class Prof>
constexpr bool coordinates_of_span(const Prof& prof, const surface& s, int32_t hx, int32_t hy, reference& r, span_coefficients& c) {
  const profile& q = prof.get();
  const unit_variants& v = prof.variants();
  const auto whole = [&] { return uses_area(s.kind) ? coordinates_within(area_reach(v), r, q, false, c, v) : span_coordinates(r, q, c, v); };
  set_reference(*s.map, hx, hy, r);
  if (!whole()) return false;
  if constexpr (Prof::has_exact_set_up) {
    const int32_t extent = int32_t(2) << max_of(0, q.offset_bits - 1 - c.exponent);  // n/w, w > 1/2
    if (q.exact_set_up && !rounding_is_small(*s.map, r.w, reach_bits(r, extent))) return exact_reference_at(*s.map, hx, hy, r) && whole();
  }
  return true;
}

template <class Prof>
constexpr void coordinates_of_pixel(const Prof& prof, const surface& s, int32_t hx, int32_t hy, reference& r, span_coefficients& c) {
  const profile& q = prof.get();
  const slopes of = uses_area(s.kind) ? slopes::wanted : slopes::left_out;
  set_reference(*s.map, hx, hy, r, of);
  if constexpr (Prof::has_exact_set_up) {
    const int32_t extent = uses_area(s.kind) ? 2 << max_extent_log2 : 0;
    if (q.exact_set_up && !rounding_is_small(*s.map, r.w, reach_bits(r, extent))) (void)exact_reference_at(*s.map, hx, hy, r, of);  // a pixel may be in front by the rounded W alone
  }
  if (uses_area(s.kind)) pixel_area_coordinates(r, q, c, prof.variants());
  else pixel_coordinates(r, q, c);
}

// Reciprocals that a pixel of a span takes. A footprint's axis divides by w^2 wherever w is not 1, its position may do without.
constexpr int reciprocals_a_pixel(filter kind, evaluation how) {
  if (uses_footprint(kind)) return how == evaluation::affine ? 0 : 1;
  if (how != evaluation::divide) return 0;
  return uses_area(kind) ? 1 + corner_count(kind) : 1;
}

template <class Prof>
constexpr bool draws_contours(const profile& q, filter kind) {
  return Prof::has_contours && q.contours && kind == filter::contour;
}

constexpr span_coefficients blank_coefficients(const surface& s) {
  span_coefficients c{};
  c.kind = s.kind;
  c.last_level = uint8_t(s.texture->last_level());
  c.linear_light = s.texture->colours() == colour_space::srgb && s.kind != filter::nearest;
  if (s.kind == filter::contour) c.contour = terms_of(s.texture->contour());
  return c;
}

// The same as plan_span() about a reference point that lies (from_x, from_y) half pixels before the span's centre.
template <class Prof, class Sink>
constexpr status plan_about(const Prof& prof, const surface& s, int32_t sx, int32_t sy, span_mask mask, int8_t from_x, int8_t from_y, Sink& sink) {
  const profile& q = prof.get();
  const int32_t cx = 2 * span_side * sx + span_side, cy = 2 * span_side * sy + span_side;  // the centre, half pixels
  span_job job{detail::blank_coefficients(s), mask, {}, {}, 1, true};
  span_coefficients& c = job.coefficients;
  if (s.map->w_at(cx - from_x, cy - from_y) > 0) {
    reference r;
    c.from_x = from_x;
    c.from_y = from_y;
    if (detail::coordinates_of_span(prof, s, cx - from_x, cy - from_y, r, c)) {
      if (uses_footprint(s.kind)) {
        span_axis(q, c);
      } else if (uses_levels(s.kind) && !uses_area(s.kind)) {
        if (s.fixed_level != no_fixed_level) detail::fix_levels(s.fixed_level, c);
        else formula_levels(q, *s.map, r, c);
        if (detail::draws_contours<Prof>(q, s.kind)) span_contour(q, c);
      }
      job.divides += detail::reciprocals_a_pixel(s.kind, c.how) * __builtin_popcountll(mask);
      return detail::emit_levels(prof, *s.texture, job, sink);
    }
  }
  // The horizon crosses the span or is near: every pixel about its own centre.
  for (span_mask rest = mask; rest != 0; rest &= rest - 1) {
    const int k = __builtin_ctzll(rest);
    const int32_t hx = cx + half_pixels(k % span_side), hy = cy + half_pixels(k / span_side);
    job = {detail::blank_coefficients(s), span_mask(1) << k, {}, {}, 1, true};
    reference r;
    detail::coordinates_of_pixel(prof, s, hx, hy, r, c);
    if (uses_footprint(s.kind)) {
      pixel_axis(*s.map, q, hx, hy, c);
    } else if (uses_levels(s.kind) && !uses_area(s.kind)) {
      if (s.fixed_level != no_fixed_level) detail::fix_levels(s.fixed_level, c);
      else formula_levels_of_pixel(q, *s.map, r, hx, hy, c);
      if (detail::draws_contours<Prof>(q, s.kind)) pixel_contour(*s.map, hx, hy, c);
    }
    job.divides += detail::reciprocals_a_pixel(s.kind, c.how);
    SPANTEX_TRY(detail::emit_levels(prof, *s.texture, job, sink));
  }
  return status::ok;
}

// Spans of 4 pixels: the quarters of a span, each about its own centre. Of 16: four spans about a common centre.
template <class Prof, class Sink>
constexpr status plan_other_size(const Prof& prof, const surface& s, int32_t sx, int32_t sy, span_mask mask, Sink& sink) {
  constexpr span_mask quarter = 0x0F0F0F0F;
  if (prof.variants().span_log2 == 4) return plan_about(prof, s, sx, sy, mask, int8_t(sx % 2 == 0 ? -8 : 8), int8_t(sy % 2 == 0 ? -8 : 8), sink);
  for (int k = 0; k < 4; ++k) {
    const int x = k % 2, y = k / 2;
    const span_mask part = mask & quarter << (4 * x + 32 * y);
    if (part != 0) SPANTEX_TRY(plan_about(prof, s, sx, sy, part, int8_t(4 - 8 * x), int8_t(4 - 8 * y), sink));
  }
  return status::ok;
}

}  // namespace detail

// Plans span (sx, sy): calls sink(span_job&) -> status for every job, in a fixed order. All pixels of the mask have W > 0.
template <class Prof, class Sink>
constexpr status plan_span(const Prof& prof, const surface& s, int32_t sx, int32_t sy, span_mask mask, Sink&& sink) {
  if constexpr (Prof::has_variants)
    if (prof.variants().span_log2 != 3) return detail::plan_other_size(prof, s, sx, sy, mask, sink);
  return detail::plan_about(prof, s, sx, sy, mask, 0, 0, sink);
}

}  // namespace spantex
