// SPDX-License-Identifier: Apache-2.0
// Jobs that need no engine: what a section's texels, or a job's coefficients, say about its pixels before anything is loaded.
#pragma once
#include <stdint.h>

#include <spantex/coordinates.hpp>
#include <spantex/datapath.hpp>
#include <spantex/loader.hpp>
#include <spantex/plan.hpp>
#include <spantex/texture.hpp>

namespace spantex {

namespace detail {

// Whether `wanted` holds for every texel of a box, unwrapped, of a level; stops at the first for which it does not.
template <class Map, class Wanted>
constexpr bool every_texel(const Map& t, int level, const texel_box& box, Wanted wanted) {
  cell_reader map(t, level);
  for (int32_t v = box.v0; v <= box.v1; v += 2)
    for (int32_t u = box.u0; u <= box.u1; u += 2) {
      const int32_t x[2] = {t.wrapped_u(u, level), t.wrapped_u(min_of(u + 1, box.u1), level)};
      const int32_t y[2] = {t.wrapped_v(v, level), t.wrapped_v(min_of(v + 1, box.v1), level)};
      rgba8 cell[4];
      map.cell(x, y, cell);
      for (const rgba8& texel : cell)
        if (!wanted(texel)) return false;
    }
  return true;
}

}  // namespace detail

// A filter's result is a weighted mean: texels that are all alike give themselves, whatever the weights (docs/SPEC.md "Filters"). Contours are not:
// their alpha is a distance.
constexpr bool is_mean_of_texels(filter kind) { return kind != filter::contour; }

// Whether a box has one colour. Map: texture_view, or one that watches.
template <class Map>
constexpr bool one_colour(const Map& t, int level, const texel_box& box, rgba8& colour) {
  colour = t.texel(level, t.wrapped_u(box.u0, level), t.wrapped_v(box.v0, level));
  if (t.facts().uniform(level)) return true;
  return t.texel(level, t.wrapped_u(box.u1, level), t.wrapped_v(box.v1, level)) == colour && detail::every_texel(t, level, box, [&](const rgba8& texel) { return texel == colour; });
}

// Whether no texel of a box has an alpha of `limit` or more; the filtered alpha has not either.
template <class Map>
constexpr bool alpha_below(const Map& t, int level, const texel_box& box, int limit) {
  return !t.facts().opaque && detail::every_texel(t, level, box, [&](const rgba8& texel) { return texel.a < limit; });
}

constexpr bool is_one_texel(const section& at, const texel_box& box) { return (at.one_u || box.u0 == box.u1) && (at.one_v || box.v0 == box.v1); }

// Whether a job's pixels are all alike, because nothing depends on where they are: one texel, or coordinates that do not change.
constexpr bool is_constant(const span_coefficients& c) {
  if (uses_footprint(c.kind) || uses_area(c.kind) || c.kind == filter::contour) return false;
  const bool one_texel = c.fine.one_u && c.fine.one_v && !c.two_levels;
  const bool still = c.how == evaluation::affine && (c.a_u | c.b_u | c.a_v | c.b_v) == 0 && (!c.two_levels || (c.g | c.h) == 0);
  return one_texel || still;
}

// Texels of a job that copies: pixel (i, j) is texel (u + i du_x + j du_y, v + i dv_x + j dv_y) of the finer level.
struct texel_steps { int32_t u, v, du_x, du_y, dv_x, dv_y; };

namespace detail {

// Steps along an axis over span_side - 1 pixels; false if they are not whole texels.
constexpr bool whole_step(int32_t first, int32_t last, int32_t& step) {
  constexpr int32_t pixels = span_side - 1;
  step = (last - first) / pixels;
  return step * pixels == last - first;
}

}  // namespace detail

// Whether a job's pixels are single texels, whole steps apart: every weight is 0. An affine job's positions are linear but for the rounding to coordinate_bits,
// so what the corners are within is what all are within.
template <class Prof>
constexpr bool copies(const Prof& prof, const span_coefficients& c, texel_steps& out) {
  const profile& q = prof.get();
  if (c.how != evaluation::affine || c.two_levels || c.corrects || c.fine.level != 0 || q.position_rounding != rounding::nearest || uses_footprint(c.kind) ||
      uses_area(c.kind) || c.kind == filter::contour || c.fine.one_u || c.fine.one_v)
    return false;
  int32_t u[4], v[4];
  for (int k = 0; k < 4; ++k) {
    const texel_position corner = position_at(prof, c, k & 1 ? span_side - 1 : 0, k & 2 ? span_side - 1 : 0);
    // From the nearest texel's centre: less than half a weight's step with both roundings.
    const int32_t most = (1 << (15 - q.subtexel_bits)) - (1 << (16 - q.coordinate_bits));
    const auto centred = [&](coordinate x, int32_t& texel) {
      texel = x.raw() >> 16;
      const int32_t off = (x.raw() & 0xFFFF) - 0x8000;
      return off < most && -off < most;
    };
    if (!centred(corner.u, u[k]) || !centred(corner.v, v[k])) return false;
  }
  out.u = u[0];
  out.v = v[0];
  return detail::whole_step(u[0], u[1], out.du_x) && detail::whole_step(u[0], u[2], out.du_y) && detail::whole_step(v[0], v[1], out.dv_x) &&
         detail::whole_step(v[0], v[2], out.dv_y) && u[3] - u[2] == u[1] - u[0] && v[3] - v[2] == v[1] - v[0];
}

}  // namespace spantex
