// SPDX-License-Identifier: Apache-2.0
// Vector kernels: blending on planes that are scaled along their axes, for machines that interpolate down first. Included by the machines' files alone.
#pragma once

// Of `width` columns their places, then their weights, f of 128.
void prepare_blends(const row_work& work, const upright_level& l) {
  std::vector<int32_t>& to = l.columns->prepared;
  if (!to.empty()) return;
  const level_rows map(*work.texels, l.level);
  for (size_t k = 0; k < l.columns->at.size(); k += width) {
    for (int n = 0; n < width; ++n) to.push_back(map.column(l.columns->at[k + n] >> q.subtexel_bits, 2));
    for (int n = 0; n < width; ++n) to.push_back(l.columns->at[k + n] & ((1 << q.subtexel_bits) - 1));
  }
}

// A row of pixels on a level.
struct upright_blends {
  const int32_t* columns;
  const rgba8 *upper, *lower;
  v below;
  SPANTEX_INLINE upright_blends(const int32_t* c, const rows_between& rows, int j) : columns(c), upper(rows.upper[j]), lower(rows.lower[j]), below(set(rows.fraction[j] << 16)) {}
  SPANTEX_INLINE blends at(int x) const {
    const uint32_t* const place = reinterpret_cast<const uint32_t*>(columns + 2 * x);
    return blend(upper, place, lower, place, get(columns + 2 * x + width) | below);
  }
};

template <rounded How>
void blend_upright(const row_work& work, const upright_row& row) {
  const upright_level& other = How == rounded::between_levels ? row.coarse : row.fine;
  const rows_between fine_rows(*work.texels, row.fine), coarse_rows(*work.texels, other);
  const int32_t *fine_columns = prepared_columns(work, row.fine, 2, 1), *coarse_columns = prepared_columns(work, other, 2, 1);
  const v fraction = set(row.fraction);
  for (int j = 0; j < span_side; ++j) {
    const upright_blends fine(fine_columns, fine_rows, j), coarse(coarse_columns, coarse_rows, j);
    write_row(work, j, [&](int x) SPANTEX_INLINED {
      if constexpr (How == rounded::between_levels) return rounded_pixels<How>(fine.at(x), coarse.at(x), fraction);
      else return rounded_pixels<How>(fine.at(x), blends{}, fraction);
    });
  }
}
