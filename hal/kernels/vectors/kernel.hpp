// SPDX-License-Identifier: Apache-2.0
// Vector kernels: rows of spans, planned and drawn. Included by the machines' files alone.
#pragma once

template <filter Kind, bool MasksOnly>
SPANTEX_INLINE bool draw_span(const row_in_hand& work, int32_t sx, span_mask mask, const span_coefficients& c) {
  span_positions p;
  p.far = false;
  p.base_u = c.base_u * (1 << q.coordinate_bits);
  p.base_v = c.base_v * (1 << q.coordinate_bits);
  constexpr bool by_tables = SPANTEX_TABLES && MasksOnly && Kind != filter::nearest && Kind != filter::aniso;
  constexpr bool finds_them_itself = Kind == filter::nearest || Kind == filter::bilinear || by_tables;
  if constexpr (!finds_them_itself) find_positions<uses_levels(Kind) && Kind != filter::aniso>(c, p);
  if constexpr (!MasksOnly) {
    const row_levels& levels = work.texels->levels_in_rows();
    p.origin_u = p.base_u;
    p.origin_v = p.base_v;
    p.base_u = modulo(c.base_u, levels.modulo_u()) * (1 << q.coordinate_bits);
    p.base_v = modulo(c.base_v, levels.modulo_v()) * (1 << q.coordinate_bits);
    if (!in_reach(levels, 0, reach_of(c), p)) return false;
    p.within = !uses_footprint(Kind) && is_within(levels, reach_of(c), p);
  }
  if constexpr (Kind == filter::nearest) draw_nearest<MasksOnly>(work, sx, mask, p, c);
#if SPANTEX_TABLES
  else if constexpr (by_tables) draw_by_tables<Kind>(work, sx, mask, p, c);
#endif
  else if constexpr (Kind == filter::bilinear) draw_bilinear<MasksOnly>(work, sx, mask, p, c);
  else if constexpr (Kind == filter::aniso) return draw_aniso<MasksOnly>(work, sx, mask, p, c);
  else return draw_by_level<MasksOnly, Kind == filter::trilinear>(work, sx, mask, p, c);
  return true;
}

SPANTEX_INLINE bool any_of(const span_mask* masks, int count) {
  span_mask any = 0;
  for (int k = 0; k < count; ++k) any |= masks[k];
  return any != 0;
}

// Plans are long chains of dependent operations: several are made one after another, so that they overlap.
template <filter Kind, bool MasksOnly>
void draw_row(const row_work& row) {
  const row_in_hand work{row};
  span_coefficients c[batch];
  bool usable[batch];
  planner<Kind> plans(work);
  for (int first = 0; first < work.count; first += batch) {
    const int count = min_of(batch, work.count - first);
    if (!any_of(work.masks + first, count)) {
      plans.skip(count);
      continue;
    }
    plans.next(count, c, usable);
    for (int k = 0; k < count; ++k) {
      c[k].last_level = uint8_t(work.last_level);
      if (!usable[k]) continue;
      if constexpr (Kind == filter::aniso) span_axis(q, c[k]);
      else if constexpr (uses_levels(Kind)) plan_levels(c[k]);
    }
    for (int k = 0; k < count; ++k)
      if (work.masks[first + k] != 0 && !(usable[k] && draw_span<Kind, MasksOnly>(work, work.sx + first + k, work.masks[first + k], c[k]))) work.left[first + k] = true;
  }
  finish(work);
}

#if SPANTEX_PIXEL_POSITIONS
// Spans next to the horizon, of filters without levels.
template <filter Kind, bool MasksOnly>
[[gnu::noinline]] void draw_by_pixel(const row_work& row) {
  const row_in_hand work{row};
  const pixel_positions<MasksOnly> pixels(work);
  span_positions p{};
  for (int k = 0; k < work.count; ++k) {
    const span_mask mask = work.masks[k];
    if (mask == 0 || !pixels.are_wanted(k)) continue;
    pixels.find(k, mask, p);
    if constexpr (Kind == filter::nearest) {
      const row_levels& map = work.texels->levels_in_rows();
      alignas(sizeof(v)) int32_t places[span_pixel_count];
      find_places<MasksOnly>(map, p, places);
      write_texels(work, work.sx + k, mask, map.texels(), places);
    } else {
      draw_bilinear_at<MasksOnly>(work, work.sx + k, mask, p);
    }
    work.left[k] = false;
  }
  finish(work);
}
template <filter Kind>
void draw_by_pixel(const row_work& work) {
  if constexpr (uses_levels(Kind)) return;
  else work.texels->levels_in_rows().masks_only() ? draw_by_pixel<Kind, true>(work) : draw_by_pixel<Kind, false>(work);
}
#else
template <filter Kind>
void draw_by_pixel(const row_work&) {}
#endif

template <filter Kind>
void draw_row(const row_work& work) {
  if (work.by_pixel) return draw_by_pixel<Kind>(work);
#if !SPANTEX_LINEAR
  if constexpr (!uses_footprint(Kind) && rows_at_once == 1)  // AVX-512 has its own
    if (work.upright != nullptr) return draw_upright<Kind>(work);
#endif
  if (work.texels->levels_in_rows().masks_only()) {
#if !SPANTEX_AVX512 && !SPANTEX_LINEAR
    if constexpr (Kind == filter::nearest)
      if (draw_affine_row(work)) return;
#endif
    return draw_row<Kind, true>(work);
  }
  draw_row<Kind, false>(work);
}

// A span of the row that is planned already.
template <filter Kind>
[[maybe_unused]] bool draw_planned(const row_work& row, int k, const span_coefficients& c) {
  const row_in_hand work{row};
  const bool masks_only = work.texels->levels_in_rows().masks_only();
  const bool drawn = masks_only ? draw_span<Kind, true>(work, work.sx + k, work.masks[k], c) : draw_span<Kind, false>(work, work.sx + k, work.masks[k], c);
  finish(work);
  return drawn;
}

#if SPANTEX_LINEAR
constexpr row_kernels rows{nullptr, draw_row<filter::bilinear>, draw_row<filter::mip_bilinear>, draw_row<filter::trilinear>, draw_row<filter::aniso>};
#else
constexpr row_kernels rows{draw_row<filter::nearest>, draw_row<filter::bilinear>, draw_row<filter::mip_bilinear>, draw_row<filter::trilinear>, draw_row<filter::aniso>};
#endif
