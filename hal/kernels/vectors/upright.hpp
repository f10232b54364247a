// SPDX-License-Identifier: Apache-2.0
// Vector kernels: planes that are scaled along their axes (../upright.hpp). Included by the machines' files alone.
#pragma once

// What upright_columns have `prepared` of single texels: each column's place in a row of the map.
void prepare_texels(const row_work& work, const upright_level& l) {
  if (!l.columns->prepared.empty()) return;
  const level_rows map(*work.texels, l.level);
  for (const int32_t at : l.columns->at) l.columns->prepared.push_back(map.column(at, 1));
}

// From the first column of the row of spans on: so many numbers for `pixels` columns.
SPANTEX_INLINE const int32_t* prepared_columns(const row_work& work, const upright_level& l, int numbers, int pixels) {
  return l.columns->prepared.data() + (work.sx - l.columns->sx) * span_side / pixels * numbers;
}

// A row of pixels: pixels_at(column) has `width` of them.
SPANTEX_INLINE void write_row(const row_work& work, int j, auto&& pixels_at) {
  rgba8* const row = work.pixels + int64_t(j) * work.stride + work.sx * span_side;
  for (int k = 0; k < work.count; ++k) {
    const uint32_t of_row = uint32_t(work.masks[k] >> (j * span_side)) & 0xFF;
    if (of_row == 0) continue;
    for (int at = k * span_side, part = 0; part < parts; at += width, ++part) write(row + at, of_row >> (width * part), pixels_at(at));
  }
}

// The other level's are not looked at unless between levels.
template <rounded How>
SPANTEX_INLINE v rounded_pixels(const blends& fine, const blends& coarse, v fraction) {
  if constexpr (How == rounded::at_once) return pixels_of(fine);
  else if constexpr (How == rounded::after_level) return pixels_of_level(fine);
  else return pixels_between(fine, coarse, fraction);
}

// By pixels or by rows: see blend_pixels.hpp, blend_rows.hpp.
void prepare_blends(const row_work& work, const upright_level& l);
template <rounded How> void blend_upright(const row_work& work, const upright_row& row);

template <filter Kind>
void draw_upright(const row_work& work) {
  const upright_row& row = *work.upright;
  if constexpr (Kind == filter::nearest) {
    prepare_texels(work, row.fine);
    const level_rows map(*work.texels);
    const uint32_t* const place = reinterpret_cast<const uint32_t*>(prepared_columns(work, row.fine, 1, 1));
    for (int j = 0; j < span_side; ++j) {
      const rgba8* const from = map.row(row.fine.at[j]);
      write_row(work, j, [&](int x) SPANTEX_INLINED { return texels_at(from, place + x); });
    }
    return;
  }
  prepare_blends(work, row.fine);
  if (Kind != filter::trilinear) return blend_upright<rounded::at_once>(work, row);
  if (row.fraction == 0) return blend_upright<rounded::after_level>(work, row);
  prepare_blends(work, row.coarse);
  blend_upright<rounded::between_levels>(work, row);
}
