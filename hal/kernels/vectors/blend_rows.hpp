// SPDX-License-Identifier: Apache-2.0
// Vector kernels: blending on planes that are scaled along their axes, for machines that interpolate across first: what is interpolated along a row of texels serves every
// row of pixels beside it. Included by the machines' files alone.
#pragma once

// What upright_columns have `prepared` of `width` columns: where two pixels' texels begin in a row of the map, four of them or two and two; which bytes of these are a texel
// and the next, channel by channel; weights f - 128, -f as across() has them. Registers are as in blends.
constexpr int first_shuffle = width, first_weight = first_shuffle + 2 * width, numbers_of_columns = first_weight + 2 * width;
constexpr int near_texels = 4;
enum : int { near_pairs, far_pairs };  // upright_columns::way: whether all pairs of pixels have their texels within four

void prepare_blends(const row_work& work, const upright_level& l) {
  std::vector<int32_t>& to = l.columns->prepared;
  if (!to.empty()) return;
  const level_rows map(*work.texels, l.level);
  const int32_t* at = l.columns->at.data();
  const auto texel = [&](int n) { return at[n] >> q.subtexel_bits; };
  l.columns->way = near_pairs;
  for (size_t k = 0; k < l.columns->at.size(); k += 2)
    if (std::abs(texel(int(k)) - texel(int(k) + 1)) > near_texels - 2) l.columns->way = far_pairs;
  to.resize(l.columns->at.size() / width * numbers_of_columns);
  for (int32_t* columns = to.data(); columns < to.data() + to.size(); columns += numbers_of_columns, at += width) {
    alignas(sizeof(v)) int32_t fraction[width];
    for (int n = 0; n < width; ++n) fraction[n] = at[n] & ((1 << q.subtexel_bits) - 1);
    const v weights = weights_across(get(fraction));
    for (int n = 0; n < 2; ++n) put(columns + first_weight + width * n, low_words(weights, n));
    for (int n = 0; n < width; n += 2) {
      const int32_t first = min_of(texel(n), texel(n + 1));
      // Pixels 2 k and 2 k + 1 of each half of `width` are register k's.
      int32_t* const shuffle = columns + first_shuffle + (n % 4) / 2 * width + n / 4 * 4;
      for (int m = 0; m < 2; ++m) {
        const bool near = l.columns->way == near_pairs;
        columns[n + m] = map.column(near ? first : texel(n + m), near ? near_texels : 2);
        const uint32_t from = uint32_t(near ? texel(n + m) - first : 2 * m) * 0x04040404u;
        shuffle[2 * m] = int32_t(from + 0x05010400u);
        shuffle[2 * m + 1] = int32_t(from + 0x07030602u);
      }
    }
  }
}

struct upright_rows : rows_between {
  v weights[span_side];  // of the lower row, of 2^15
  upright_rows(const row_work& work, const upright_level& l) : rows_between(*work.texels, l) {
    for (int j = 0; j < span_side; ++j) weights[j] = set(fraction[j] << 24 | fraction[j] << 8);
  }
};

struct blended_row { v pixels[2]; };

// `width` columns of pixels on a level, from the first row on.
template <bool Near>
struct level_walk {
  const upright_rows& rows;
  const int32_t* columns;
  two_rows<blended_row> two;
  SPANTEX_INLINE level_walk(const upright_rows& r, const int32_t* c) : rows(r), columns(c) {}

  SPANTEX_INLINE blended_row along(const rgba8* from) const {
    blended_row r;
#pragma GCC unroll 2
    for (int k = 0; k < 2; ++k) {
      const uint32_t* const at = reinterpret_cast<const uint32_t*>(columns) + 2 * k;
      const v texels = Near ? four_texels_each(from, at) : two_texels_each(from, at);
      r.pixels[k] = across(texels, get(columns + first_shuffle + width * k), get(columns + first_weight + width * k));
    }
    return r;
  }
  SPANTEX_INLINE blends to(int j) {
    two.to(rows.upper[j], rows.lower[j], [&](const rgba8* from) SPANTEX_INLINED { return along(from); });
    blends b;
#pragma GCC unroll 2
    for (int n = 0; n < 2; ++n) {
      b.first[n] = two.above.pixels[n];
      b.change[n] = subtract16(two.above.pixels[n], two.below.pixels[n]);
      b.weight[n] = rows.weights[j];
    }
    return b;
  }
};

template <rounded How, bool FineNear, bool CoarseNear>
void blend_upright(const row_work& work, const upright_row& row) {
  const upright_level& other = How == rounded::between_levels ? row.coarse : row.fine;
  const upright_rows fine_rows(work, row.fine), coarse_rows(work, other);
  const int32_t *fine_columns = prepared_columns(work, row.fine, numbers_of_columns, width), *coarse_columns = prepared_columns(work, other, numbers_of_columns, width);
  const v fraction = set(row.fraction);
  rgba8* span = work.pixels + work.sx * span_side;
  for (int k = 0; k < work.count * parts; ++k, fine_columns += numbers_of_columns, coarse_columns += numbers_of_columns, span += width) {
    const span_mask mask = work.masks[k / parts] >> (k % parts * width);
    if (work.masks[k / parts] == 0) continue;
    level_walk<FineNear> fine(fine_rows, fine_columns);
    level_walk<CoarseNear> coarse(coarse_rows, coarse_columns);
    rgba8* to = span;
    for (int j = 0; j < span_side; ++j, to += work.stride) {
      const blends near = fine.to(j);
      v pixels;
      if constexpr (How == rounded::between_levels) pixels = rounded_pixels<How>(near, coarse.to(j), fraction);
      else pixels = rounded_pixels<How>(near, near, fraction);
      write(to, uint32_t(mask >> (span_side * j)), pixels);
    }
  }
}

template <rounded How>
void blend_upright(const row_work& work, const upright_row& row) {
  const bool fine_near = row.fine.columns->way == near_pairs, coarse_near = How == rounded::between_levels && row.coarse.columns->way == near_pairs;
  if (fine_near && coarse_near) return blend_upright<How, true, true>(work, row);
  if (fine_near) return blend_upright<How, true, false>(work, row);
  if (coarse_near) return blend_upright<How, false, true>(work, row);
  blend_upright<How, false, false>(work, row);
}
