// SPDX-License-Identifier: Apache-2.0
// Vector kernels: a span by each filter. Included by the machines' files alone.
#pragma once

// What a lane's level says of its map, the same for all lanes (Shift is int32_t) or not (v).
template <class Shift>
struct on_level {
  v add_u, add_v;                      // position: (what span_positions has + add) >> cut, 7 bits of fraction
  Shift cut;
  Shift down;                          // texels from y to y + 1
  v field[row_levels::field_count];
};

constexpr int32_t cut_of(int level) { return q.coordinate_bits - q.subtexel_bits + level; }
SPANTEX_INLINE int32_t add_of(int level) { return (1 << (cut_of(level) - 1)) - (1 << (q.coordinate_bits - 1 + level)); }

SPANTEX_INLINE on_level<int32_t> level_at_once(const row_levels& map, int level, const span_positions& p) {
  on_level<int32_t> l;
  l.cut = cut_of(level);
  l.add_u = set(add_of(level) + p.base_u);
  l.add_v = set(add_of(level) + p.base_v);
  l.down = map.value(row_levels::step, level) >> 16;
  for (int k = 0; k < row_levels::field_count; ++k) l.field[k] = set(map.value(row_levels::field(k), level));
  return l;
}

[[gnu::noinline]] on_level<v> level_by_lane(const row_levels& map, const int32_t* level, const span_positions& p) {
  on_level<v> l;
  alignas(sizeof(v)) int32_t lane[2 + row_levels::field_count][width];
  for (int n = 0; n < width; ++n) {
    lane[0][n] = add_of(level[n]);
    lane[1][n] = cut_of(level[n]);
    for (int k = 0; k < row_levels::field_count; ++k) lane[2 + k][n] = map.value(row_levels::field(k), level[n]);
  }
  l.add_u = get(lane[0]) + p.base_u;
  l.add_v = get(lane[0]) + p.base_v;
  l.cut = get(lane[1]);
  for (int k = 0; k < row_levels::field_count; ++k) l.field[k] = get(lane[2 + k]);
  l.down = l.field[row_levels::step] >> 16;
  return l;
}

// Both axes of a texel in a lane, wrapped: see row_levels.
template <bool MasksOnly, class Shift>
SPANTEX_INLINE v wrapped_texel(v at, const on_level<Shift>& l) {
  const v kept = l.field[row_levels::mask];
  if constexpr (MasksOnly) return at & kept;
  const v turn = l.field[row_levels::period];
  at = least16_unsigned(at, add16(at, turn));
  at = least16_unsigned(at, subtract16(at, turn)) & kept;
  return least16(largest16(at, l.field[row_levels::low]), l.field[row_levels::high]);
}

// Four texels of each lane, interpolated.
template <bool MasksOnly, class Shift>
SPANTEX_INLINE blends blended_at(const row_levels& map, const on_level<Shift>& l, v position_u, v position_v) {
  const v u = (position_u + l.add_u) >> l.cut, w = (position_v + l.add_v) >> l.cut;
  const v texel = wrapped_texel<MasksOnly>(halves(u >> q.subtexel_bits, w << (16 - q.subtexel_bits)), l);
  const v top = products(texel, l.field[row_levels::step]) + l.field[row_levels::origin], fraction = halves(u, w << 16) & 0x007F007F;
  alignas(sizeof(v)) int32_t at[2][width];
  const uint32_t* const index = reinterpret_cast<const uint32_t*>(at);
  put(at[0], top);
  if constexpr (sizeof l.down == sizeof(int32_t)) {
    return blend(map.texels(), index, map.texels() + l.down, index, fraction);
  } else {
    put(at[1], top + l.down);
    return blend(map.texels(), index, map.texels(), index + width, fraction);
  }
}

template <bool MasksOnly, bool TwoLevels, class Shift>
SPANTEX_INLINE v pixels_by_level(const row_levels& map, const on_level<Shift>& fine, const on_level<Shift>& coarse, v u, v w, v fraction) {
  const blends near = blended_at<MasksOnly>(map, fine, u, w);
  if constexpr (TwoLevels) return pixels_between(near, blended_at<MasksOnly>(map, coarse, u, w), fraction);
  else return pixels_of(near);
}

template <bool MasksOnly, bool TwoLevels>
[[gnu::noinline]] v pixels_by_lane(const row_levels& map, const int32_t* fine, const int32_t* coarse, const span_positions& p, int k, const int32_t* fraction) {
  const v u = get(p.u + k), w = get(p.v + k);
  const on_level<v> near = level_by_lane(map, fine, p);
  if constexpr (TwoLevels) return pixels_by_level<MasksOnly, true>(map, near, level_by_lane(map, coarse, p), u, w, get(fraction));
  else return pixels_by_level<MasksOnly, false>(map, near, near, u, w, get(fraction));
}

// A row's part to where the mask has pixels.
SPANTEX_INLINE void write(rgba8* to, uint32_t mask, v pixels) {
  constexpr uint32_t all = (1u << width) - 1;
  if ((mask & all) == all) [[likely]] return put(to, pixels);
  alignas(sizeof(v)) int32_t one[width];
  put(one, pixels);
  for (int k = 0; k < width; ++k)
    if (mask >> k & 1) __builtin_memcpy(to + k, one + k, sizeof(rgba8));
}

// pixels_at(k) delivers `width` pixels from the span's k-th on.
SPANTEX_INLINE void write_span(const row_work& work, int32_t sx, span_mask mask, auto&& pixels_at) {
  rgba8* row = work.pixels + int64_t(work.sy) * span_side * work.stride + sx * span_side;
  if (mask == ~span_mask(0)) [[likely]] {
#pragma GCC unroll 2
    for (int y = 0; y < span_side; ++y, row += work.stride)
      for (int part = 0; part < parts; ++part) put(row + width * part, pixels_at(span_side * y + width * part));
    return;
  }
  for (int y = 0; y < span_side; ++y, row += work.stride) {
    const uint32_t of_row = uint32_t(mask >> (y * span_side)) & 0xFF;
    if (of_row == 0) continue;
    for (int part = 0; part < parts; ++part) write(row + width * part, of_row >> (width * part), pixels_at(span_side * y + width * part));
  }
}

template <bool MasksOnly>
SPANTEX_INLINE void draw_nearest(const row_work& work, int32_t sx, span_mask mask, const span_positions& p) {
  const row_levels& map = work.texels->levels_in_rows();
  const on_level<int32_t> l = level_at_once(map, 0, p);
  const v base = halves(set(p.base_u >> q.coordinate_bits), set(p.base_v << (16 - q.coordinate_bits)));
  write_span(work, sx, mask, [&](int k) SPANTEX_INLINED {
    const v texel = wrapped_texel<MasksOnly>(add16(base, halves(get(p.u + k) >> q.coordinate_bits, get(p.v + k) << (16 - q.coordinate_bits))), l);
    alignas(sizeof(v)) int32_t at[width];
    put(at, products(texel, l.field[row_levels::step]) + l.field[row_levels::origin]);
    return texels_at(map.texels(), reinterpret_cast<const uint32_t*>(at));
  });
}

template <bool MasksOnly>
SPANTEX_INLINE void draw_bilinear(const row_work& work, int32_t sx, span_mask mask, const span_positions& p) {
  const row_levels& map = work.texels->levels_in_rows();
  const on_level<int32_t> l = level_at_once(map, 0, p);
  write_span(work, sx, mask, [&](int k) SPANTEX_INLINED { return pixels_of(blended_at<MasksOnly>(map, l, get(p.u + k), get(p.v + k))); });
}

// integer_level() of a level of detail, lanes or one: ceil(d + 1/2) - 1 is floor(d + 127/256).
template <bool TwoLevels>
SPANTEX_INLINE auto whole_level(auto level) { return (TwoLevels ? level : level + 127) >> q.level_bits; }

// `width` pixels of a span at a time, on their levels of detail.
template <bool MasksOnly, bool TwoLevels>
class pixels_on_levels {
 public:
  SPANTEX_INLINE pixels_on_levels(const row_work& work, const span_positions& p) : map_(work.texels->levels_in_rows()), positions_(p), last_(work.last_level) {}

  // False where pixels lie on levels that are no exact halves.
  SPANTEX_INLINE bool all_in() const {
    if (map_.count() > last_) return true;
    bool in = true;
    for (int k = 0; k < span_pixel_count; ++k) in &= min_of(whole_level<TwoLevels>(positions_.level[k]) + (TwoLevels ? 1 : 0), last_) < map_.count();
    return in;
  }

  SPANTEX_INLINE v at(int k) {
    const v level = get(positions_.level + k), u = get(positions_.u + k), w = get(positions_.v + k);
    const v whole = whole_level<TwoLevels>(level), fraction = level & 255;
    const int32_t first = whole[0];
    if (!all_equal(whole, first)) [[unlikely]] {
      alignas(sizeof(v)) int32_t fine[width], coarse[width], of[width];
      put(fine, whole);
      put(coarse, least(whole + 1, set(last_)));
      put(of, fraction);
      return pixels_by_lane<MasksOnly, TwoLevels>(map_, fine, coarse, positions_, k, of);
    }
    hold(first);
    if (TwoLevels && all_equal(fraction, 0)) return pixels_of_level(blended_at<MasksOnly>(map_, near_, u, w));
    return pixels_by_level<MasksOnly, TwoLevels>(map_, near_, far_, u, w, fraction);
  }

  // What every lane's level is has been found: near() and far() are of it.
  SPANTEX_INLINE void hold(int32_t level) {
    if (level == held_) return;
    held_ = level;
    near_ = level_at_once(map_, level, positions_);
    if (TwoLevels) far_ = level_at_once(map_, min_of(level + 1, last_), positions_);
  }
  SPANTEX_INLINE const on_level<int32_t>& near() const { return near_; }
  SPANTEX_INLINE const on_level<int32_t>& far() const { return far_; }

 private:
  const row_levels& map_;
  const span_positions& positions_;
  int32_t last_, held_ = -1;
  on_level<int32_t> near_, far_;
};

template <bool MasksOnly, bool TwoLevels>
SPANTEX_INLINE bool draw_by_level(const row_work& work, int32_t sx, span_mask mask, const span_positions& p) {
  pixels_on_levels<MasksOnly, TwoLevels> pixels(work, p);
  if (!pixels.all_in()) return false;
  write_span(work, sx, mask, [&](int k) SPANTEX_INLINED { return pixels.at(k); });
  return true;
}
