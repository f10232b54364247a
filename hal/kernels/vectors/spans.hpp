// SPDX-License-Identifier: Apache-2.0
// Vector kernels: a span by each filter. Included by the machines' files alone.
#pragma once

#include "rounded.hpp"

// What a lane's level says of its map, the same for all lanes (Shift is int32_t) or not (v).
template <class Shift>
struct on_level {
  v add_u, add_v;                      // position: (what span_positions has + add) >> cut, 7 bits of fraction
  Shift cut;
  Shift down;                          // texels from y to y + 1
  v field[row_levels::field_count];
  bool within = false;                 // texels need no wrapping: span_positions::within
  // Where sides do not halve exactly (on one level in all lanes): (the upper half of ((what span_positions has + its origin, s15.16) ratio) + add) >> cut, 7 bits of fraction.
  bool scaled = false;
  v ratio_u, ratio_v;
  int cut_u, cut_v;
  int doublings = 0;                   // row_levels::far_doublings() where texels lie farther than near_limit()
};

constexpr int32_t cut_of(int level) { return q.coordinate_bits - q.subtexel_bits + level; }
SPANTEX_INLINE int32_t add_of(int level) { return (1 << (cut_of(level) - 1)) - (1 << (q.coordinate_bits - 1 + level)); }

// One axis of a level whose sides do not halve exactly. Whole periods before the base are left out.
SPANTEX_INLINE void scale_axis(int32_t origin, uint32_t ratio, int32_t period, int level, v& ratios, int& cut, v& add) {
  const bool exact = ratio >> 31 != 0;  // half of it then, so that it has a sign
  ratios = set(int32_t(exact ? ratio >> 1 : ratio));
  cut = 16 + 31 - q.subtexel_bits - 32 + level - exact;
  const int32_t texel = int32_t((int64_t(origin) * ratio) >> (q.coordinate_bits + 31 + level)), turned = period == 0 ? 0 : texel - modulo(texel, period);
  const int32_t start = turned * (1 << q.subtexel_bits) + (1 << (q.subtexel_bits - 1));  // and half a texel
  add = set((1 << (cut - 1)) - start * (1 << cut));
}

[[gnu::noinline]] void scale_level(const row_levels& map, int level, const span_positions& p, on_level<int32_t>& l) {
  const auto period = [](int32_t modulo, int32_t length) SPANTEX_INLINED { return modulo == 0 ? 0 : length; };  // of axes whose bases are reduced, whether a mask would do on this level or not
  scale_axis(p.origin_u, map.ratio_u(level), period(map.modulo_u(), map.columns(level)), level, l.ratio_u, l.cut_u, l.add_u);
  scale_axis(p.origin_v, map.ratio_v(level), period(map.modulo_v(), map.rows(level)), level, l.ratio_v, l.cut_v, l.add_v);
}

template <bool MasksOnly>
SPANTEX_INLINE void take_level(const row_levels& map, int level, const span_positions& p, on_level<int32_t>& l) {
  l.cut = cut_of(level);
  l.add_u = set(add_of(level) + p.base_u);
  l.add_v = set(add_of(level) + p.base_v);
  l.down = map.value(row_levels::step, level) >> 16;
  for (int k = 0; k < row_levels::field_count; ++k) l.field[k] = set(map.value(row_levels::field(k), level));
  if constexpr (!MasksOnly) {
    l.within = p.within;
    l.doublings = p.far ? map.far_doublings() : 0;
    l.scaled = level >= map.exact_count();
    if (l.scaled) [[unlikely]] scale_level(map, level, p, l);
  }
}
template <bool MasksOnly>
SPANTEX_INLINE on_level<int32_t> level_at_once(const row_levels& map, int level, const span_positions& p) {
  on_level<int32_t> l;
  take_level<MasksOnly>(map, level, p, l);
  return l;
}

[[gnu::noinline]] on_level<v> level_by_lane(const row_levels& map, const int32_t* level, const span_positions& p) {
  on_level<v> l;
#if SPANTEX_AVX512
  const v of = get(level), half = set(1 << (q.coordinate_bits - 1)) << of;
  l.cut = of + cut_of(0);
  l.add_u = (half >> q.subtexel_bits) - half;
  l.add_v = l.add_u + p.base_v;
  l.add_u += p.base_u;
  for (int k = 0; k < row_levels::field_count; ++k) l.field[k] = look_up(map.values(row_levels::field(k)), of);
#else
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
#endif
  l.down = l.field[row_levels::step] >> 16;
  if (p.far) l.doublings = map.far_doublings();
  return l;
}

// Both axes of a texel in a lane, wrapped: see row_levels.
template <bool MasksOnly, class Shift>
SPANTEX_INLINE v wrapped_texel(v at, const on_level<Shift>& l) {
  const v kept = l.field[row_levels::mask];
  if constexpr (MasksOnly) return at & kept;
  if (l.within) return at;
  const v turn = l.field[row_levels::period];
  const v two = add16(turn, turn);
  v four = add16(two, two);
  if (l.doublings > 0) [[unlikely]] {
    for (int k = 0; k < l.doublings; ++k) four = add16(four, four);
    at = least16_unsigned(at, add16(at, four));
    for (int k = 0; k < l.doublings; ++k) {
      four = v(v_unsigned(four) >> 1);
      at = least16_unsigned(at, subtract16(at, four));
    }
  } else {
    at = least16_unsigned(at, add16(at, four));
  }
  at = least16_unsigned(at, subtract16(at, two));
  at = least16_unsigned(at, subtract16(at, turn)) & kept;
  return least16(largest16(at, l.field[row_levels::low]), l.field[row_levels::high]);
}

// Where in the map texels lie, both axes in a lane.
template <bool MasksOnly, class Shift>
SPANTEX_INLINE v places_of(v texels, const on_level<Shift>& l) {
  return add_products(l.field[row_levels::origin], wrapped_texel<MasksOnly>(texels, l), l.field[row_levels::step]);
}

// What positions have below span_positions' last bit, where they have it: only products with ratios tell.
constexpr int rest_bits = 16 - q.coordinate_bits;

// Where `width` lanes have their four texels on a level: the upper left ones' places in the map, times place_scale; weights of 128, u in the lower half, v in the upper.
struct alignas(sizeof(v)) lanes_places { int32_t top[width], fraction[width]; };

// A base, whole texels, both axes in a lane.
SPANTEX_INLINE v base_texels(const span_positions& p) { return halves(set(p.base_u >> q.coordinate_bits), set(p.base_v << (16 - q.coordinate_bits))); }

// Of positions on the level, with subtexel_bits of fraction; base: whole texels more, both axes in a lane.
template <bool MasksOnly, class Shift>
SPANTEX_INLINE void put_places(const on_level<Shift>& l, v u, v w, lanes_places& out, v base = v{}) {
  put(out.top, places_of<MasksOnly>(add16(base, halves(u >> q.subtexel_bits, w << (16 - q.subtexel_bits))), l) * place_scale);
  put(out.fraction, halves(u, w << 16) & number<0x007F007F>());
}

template <bool MasksOnly, class Shift>
SPANTEX_INLINE void place_lanes(const on_level<Shift>& l, v position_u, v position_v, const span_positions& p, lanes_places& out, v rest_u = v{}, v rest_v = v{}) {
  v u = down_by(position_u + l.add_u, l.cut), w = down_by(position_v + l.add_v, l.cut);
  if constexpr (!MasksOnly && sizeof(Shift) == sizeof(int32_t)) {
    if (l.scaled) {
      u = down_by(upper_halves(signed_products(((position_u + p.origin_u) << rest_bits) + rest_u, l.ratio_u)) + l.add_u, l.cut_u);
      w = down_by(upper_halves(signed_products(((position_v + p.origin_v) << rest_bits) + rest_v, l.ratio_v)) + l.add_v, l.cut_v);
    }
  }
  put_places<MasksOnly>(l, u, w, out);
}

// The four texels, interpolated; down: to the texels below, where they are not in the same place.
#if SPANTEX_LINEAR
SPANTEX_INLINE blends blended(const row_levels& map, const lanes_places& at, auto&&) { return blend(map.linear_columns(), reinterpret_cast<const uint32_t*>(at.top), get(at.fraction)); }
#else
SPANTEX_INLINE blends blended(const row_levels& map, const lanes_places& at, int32_t down) {
  const uint32_t* const index = reinterpret_cast<const uint32_t*>(at.top);
  return blend(map.texels(), index, map.texels() + down, index, get(at.fraction));
}
SPANTEX_INLINE blends blended(const row_levels& map, const lanes_places& at, v down) {
  alignas(sizeof(v)) int32_t below[width];
  put(below, get(at.top) + down);
  return blend(map.texels(), reinterpret_cast<const uint32_t*>(at.top), map.texels(), reinterpret_cast<const uint32_t*>(below), get(at.fraction));
}
#endif

template <bool MasksOnly, class Shift>
SPANTEX_INLINE blends blended_at(const row_levels& map, const on_level<Shift>& l, v position_u, v position_v, const span_positions& p) {
  lanes_places at;
  place_lanes<MasksOnly>(l, position_u, position_v, p, at);
  return blended(map, at, l.down);
}

constexpr bool is_between(rounded how) { return how == rounded::between_levels || how == rounded::as_sample; }
template <rounded How>
SPANTEX_INLINE unfinished joined(const blends& near, const blends& far, v fraction) {
#if SPANTEX_LINEAR
  if constexpr (How == rounded::as_sample) return sample_between(near, far, fraction);
#endif
  return pixels_between(near, far, fraction);
}

// Lanes on levels of their own.
template <bool MasksOnly, rounded How>
[[gnu::noinline]] unfinished pixels_by_lane(const row_levels& map, const int32_t* fine, const int32_t* coarse, const span_positions& p, int n, v fraction) {
  const v u = get(p.u + width * n), w = get(p.v + width * n);
  const blends near = blended_at<MasksOnly>(map, level_by_lane(map, fine, p), u, w, p);
  if constexpr (is_between(How)) return joined<How>(near, blended_at<MasksOnly>(map, level_by_lane(map, coarse, p), u, w, p), fraction);
  else return pixels_of(near);
}

// The same for levels whose sides do not halve exactly: by each that a lane is on, of which the lanes on it are taken. on(level): all lanes' values on it.
SPANTEX_INLINE unfinished each_level_in_turn(v whole, auto&& on) {
  alignas(sizeof(v)) int32_t level[width];
  put(level, whole);
  unfinished out = on(level[0]);
  for (int k = 1; k < width; ++k) {
    bool drawn = false;
    for (int before = 0; before < k; ++before) drawn |= level[before] == level[k];
    if (!drawn) out = chosen(whole == set(level[k]), on(level[k]), out);
  }
  return out;
}
template <rounded How>
[[gnu::noinline]] unfinished pixels_in_turn(const row_levels& map, v whole, int32_t last, const span_positions& p, int n, v fraction) {
  const v u = get(p.u + width * n), w = get(p.v + width * n);
  return each_level_in_turn(whole, [&](int32_t level) {
    const blends near = blended_at<false>(map, level_at_once<false>(map, level, p), u, w, p);
    if constexpr (is_between(How)) return joined<How>(near, blended_at<false>(map, level_at_once<false>(map, min_of(level + 1, last), p), u, w, p), fraction);
    else return pixels_of(near);
  });
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

// The same of the rows that the lanes are.
SPANTEX_INLINE void write_rows(rgba8* to, int64_t stride, uint32_t mask, v pixels) {
#if SPANTEX_AVX512
  _mm256_mask_storeu_epi32(to, __mmask8(mask), _mm512_castsi512_si256(raw(pixels)));
  _mm256_mask_storeu_epi32(to + stride, __mmask8(mask >> span_side), _mm512_extracti64x4_epi64(raw(pixels), 1));
#else
  static_cast<void>(stride);
  write(to, mask, pixels);
#endif
}

// pixels_at(k) delivers the `width` pixels that lie in memory from the k-th on.
SPANTEX_INLINE void write_span(const row_work& work, int32_t sx, span_mask mask, auto&& pixels_at) {
  rgba8* row = work.pixels + sx * span_side;
  if (mask == ~span_mask(0)) [[likely]] {
#pragma GCC unroll 2
    for (int y = 0; y < span_side; y += rows_at_once, row += rows_at_once * work.stride)
      for (int part = 0; part < parts; ++part) write_rows(row + width * part, work.stride, ~0u, pixels_at(place_of(y, part)));
    return;
  }
  constexpr uint32_t whole = (1u << (rows_at_once * span_side)) - 1;
  for (int y = 0; y < span_side; y += rows_at_once, row += rows_at_once * work.stride) {
    const uint32_t of_rows = uint32_t(mask >> (y * span_side)) & whole;
    if (of_rows == 0) continue;
    for (int part = 0; part < parts; ++part)
      if (const uint32_t of_part = of_rows >> (width * part) & (whole >> (rows_at_once * span_side - width)); of_part != 0) write_rows(row + width * part, work.stride, of_part, pixels_at(place_of(y, part)));
  }
}

// A span's texels by place(n) and pixels by at(n), for each of its groups of `width` pixels. Machines that place first find all places before they read
// the first texel, so that reading does not wait for them; the others have memory for one group.
constexpr int placed_groups = places_first ? groups : 1;

// Whether the mask has pixels of the n-th group.
SPANTEX_INLINE bool has_group(span_mask mask, int n) {
  constexpr int of_part = span_side / rows_at_once;
  return (mask >> (n % of_part * rows_at_once * span_side + n / of_part * lanes_across) & ((uint64_t(1) << width) - 1)) != 0;
}

#if SPANTEX_LINEAR
// A row of spans, and the last one before its pixels are codes: they are finished when the places of the next one are found. Both are long chains of dependent operations, that a processor does side by side.
struct row_in_hand : row_work {
  mutable in_hand before[groups];
  mutable int32_t before_sx;
  mutable span_mask before_mask = 0;  // 0: there is none
  SPANTEX_INLINE explicit row_in_hand(const row_work& row) : row_work(row) {}
};

SPANTEX_INLINE void finish(const row_in_hand& work) {
  const span_mask mask = work.before_mask;
  if (mask == 0) return;
  work.before_mask = 0;
#if SPANTEX_AVX512
  if (mask == ~span_mask(0) && work.texels->opaque()) [[likely]] {
    v pixels[groups];
    finish_opaque(work.before, pixels);
    return write_span(work, work.before_sx, mask, [&](int k) SPANTEX_INLINED { return pixels[k / width]; });
  }
#endif
  write_span(work, work.before_sx, mask, [&](int k) SPANTEX_INLINED { return finished(work.before[k / width]); });
}
#else
using row_in_hand = row_work;
SPANTEX_INLINE void finish(const row_in_hand&) {}
#endif

SPANTEX_INLINE void draw_groups(const row_in_hand& work, int32_t sx, span_mask mask, auto&& place, auto&& at) {
  if (places_first)
#pragma GCC unroll 2
    for (int n = 0; n < groups; ++n) place(n);
#if SPANTEX_LINEAR
  finish(work);
  for (int n = 0; n < groups; ++n)
    if (has_group(mask, n)) [[likely]] work.before[n] = at(n);
  work.before_sx = sx;
  work.before_mask = mask;
#else
  write_span(work, sx, mask, [&](int k) SPANTEX_INLINED {
    if (!places_first) place(k / width);
    return at(k / width);
  });
#endif
}

// Single texels of `from`, by the places of all pixels, as span_positions has them. Whole spans are moved texel by texel, and not put together in vectors, where that is faster.
SPANTEX_INLINE void write_texels(const row_work& work, int32_t sx, span_mask mask, const rgba8* from, const int32_t* places) {
  if (moves_texels && mask == ~span_mask(0)) return move_texels(work, sx, from, places, [](int x, int y) SPANTEX_INLINED { return place_of(y, x / lanes_across) + x % lanes_across; });
  write_span(work, sx, mask, [&](int k) SPANTEX_INLINED { return texels_at(from, reinterpret_cast<const uint32_t*>(places + k)); });
}

// Single texels: from a span's positions, with so many bits of fraction and no more than 31 in all, to places in the map. Rounding to coordinate_bits and cutting off to whole
// texels are one: positions take half of a last of these bits, and the texel is the whole number below. (What is rounded already has nothing there.)
template <bool MasksOnly>
class single_texels {
 public:
  SPANTEX_INLINE single_texels(const row_levels& map, const span_positions& p, int fraction)
      : level_(level_at_once<MasksOnly>(map, 0, p)), base_(base_texels(p)), fraction_(fraction) {}

  // Of two vectors of pixels.
  SPANTEX_INLINE void put_places(const v (&u)[2], const v (&w)[2], int32_t* to) const {
    const int32_t half = 1 << (fraction_ - q.coordinate_bits - 1);
#pragma GCC unroll 2
    for (int k = 0; k < 2; ++k) {
      const v texels = halves(down_by(u[k] + half, min_of(fraction_, 31)), down_by(w[k] + half, fraction_ - 16));  // of less than 2^-31 nothing is left but the sign
      put(to + width * k, places_of<MasksOnly>(add16(base_, texels), level_));
    }
  }

 private:
  on_level<int32_t> level_;
  v base_;
  int fraction_;
};

template <int Terms, bool MasksOnly>
SPANTEX_INLINE void find_places(const span_coefficients& c, const single_texels<MasksOnly>& to, int32_t* places) {
  series_rows<Terms> left(c, 0), right(c, parts - 1);
  const auto put_two = [&](series_rows<Terms>& rows, int at) SPANTEX_INLINED {
    v u[2], w[2];
#pragma GCC unroll 2
    for (int k = 0; k < 2; ++k)
      rows.next([&](v of_u, v of_v) SPANTEX_INLINED {
        u[k] = of_u;
        w[k] = of_v;
      });
    to.put_places(u, w, places + at);
  };
#pragma GCC unroll 2
  for (int y = 0; y < span_side; y += 2 * rows_at_once) {
    put_two(left, place_of(y, 0));
    if constexpr (parts > 1) put_two(right, place_of(y, 1));
  }
}

// Of rounded positions.
template <bool MasksOnly>
[[gnu::noinline]] void find_places(const row_levels& map, const span_positions& p, int32_t* places) {
  const single_texels<MasksOnly> to(map, p, 16);
  for (int k = 0; k < span_pixel_count; k += 2 * width) {
    const auto from = [](const int32_t* at) SPANTEX_INLINED { return get(at) << (16 - q.coordinate_bits); };
    const v u[2] = {from(p.u + k), from(p.u + k + width)}, w[2] = {from(p.v + k), from(p.v + k + width)};
    to.put_places(u, w, places + k);
  }
}

template <bool MasksOnly>
SPANTEX_INLINE void draw_nearest(const row_work& work, int32_t sx, span_mask mask, span_positions& p, const span_coefficients& c) {
  static_assert(q.offset_bits - 1 - max_extent_log2 >= 16);
  const row_levels& map = work.texels->levels_in_rows();
  const single_texels<MasksOnly> to(map, p, c.exponent);
  alignas(sizeof(v)) int32_t places[span_pixel_count];
  if (!by_terms(c, [&]<int Terms>() SPANTEX_INLINED { find_places<Terms>(c, to, places); })) {
    divide_positions(c, p);
    find_places<MasksOnly>(map, p, places);
  }
  write_texels(work, sx, mask, map.texels(), places);
}

// Bilinear's places on level 0 straight from a span's series: rounding to coordinate_bits and snapping are one, and the base is whole texels.
template <int Terms, bool MasksOnly>
SPANTEX_INLINE void find_places(const span_coefficients& c, const span_positions& p, const on_level<int32_t>& l, lanes_places* out) {
  const int cut = c.exponent - q.subtexel_bits, below_position = c.exponent - q.coordinate_bits;
  const int32_t start = (1 << (below_position - 1)) + add_of(0) * (1 << below_position);
  const v base = base_texels(p);
  for (int part = 0; part < parts; ++part) {
    series_rows<Terms> rows(c, part);
#pragma GCC unroll 4
    for (int y = 0; y < span_side; y += rows_at_once)
      rows.next([&](v u, v w) SPANTEX_INLINED { put_places<MasksOnly>(l, down_by(u + start, cut), down_by(w + start, cut), out[place_of(y, part) / width], base); });
  }
}

// By rounded positions, from level 0.
template <bool MasksOnly>
SPANTEX_INLINE void draw_bilinear_at(const row_in_hand& work, int32_t sx, span_mask mask, const span_positions& p) {
  const row_levels& map = work.texels->levels_in_rows();
  const on_level<int32_t> l = level_at_once<MasksOnly>(map, 0, p);
  lanes_places places[placed_groups];
  draw_groups(work, sx, mask, [&](int n) SPANTEX_INLINED { place_lanes<MasksOnly>(l, get(p.u + width * n), get(p.v + width * n), p, places[n % placed_groups]); },
              [&](int n) SPANTEX_INLINED { return pixels_of(blended(map, places[n % placed_groups], l.down)); });
}

template <bool MasksOnly>
SPANTEX_INLINE void draw_bilinear(const row_in_hand& work, int32_t sx, span_mask mask, span_positions& p, const span_coefficients& c) {
  if constexpr (places_first) {
    constexpr int most_bits = 30;  // an offset, below 2^30, and half a texel are below 2^31
    const row_levels& map = work.texels->levels_in_rows();
    const on_level<int32_t> l = level_at_once<MasksOnly>(map, 0, p);
    lanes_places places[placed_groups];
    if (c.exponent <= most_bits && by_terms(c, [&]<int Terms>() SPANTEX_INLINED { find_places<Terms, MasksOnly>(c, p, l, places); }))
      return draw_groups(work, sx, mask, [](int) {}, [&](int n) SPANTEX_INLINED { return pixels_of(blended(map, places[n % placed_groups], l.down)); });
  }
  find_positions<false>(c, p);
  draw_bilinear_at<MasksOnly>(work, sx, mask, p);
}

// Whether the map holds every texel that lies up to `reach` texels of level 0 from the base: of any level, as one before the first and one after the last are in its apron.
SPANTEX_INLINE bool is_within(const row_levels& map, int32_t reach, const span_positions& p) {
  static_assert(row_apron > 1);
  const int32_t u = p.base_u >> q.coordinate_bits, w = p.base_v >> q.coordinate_bits;
  return u >= reach && w >= reach && u + reach < map.columns(0) && w + reach < map.rows(0);
}

// False where texels so far from the base are not wrapped on levels up to this one; else whether it takes more than the usual.
SPANTEX_INLINE bool in_reach(const row_levels& map, int level, int32_t reach, span_positions& p) {
  p.far = reach > map.near_limit(level);
  return !p.far || reach <= map.far_limit(level);
}

// integer_level() of a level of detail, lanes or one: ceil(d + 1/2) - 1 is floor(d + 127/256).
template <bool TwoLevels>
SPANTEX_INLINE auto whole_level(auto level) { return (TwoLevels ? level : level + 127) >> q.level_bits; }

// `width` pixels of a span at a time, on their levels of detail: place(n) for the n-th of them, then at(n).
template <bool MasksOnly, rounded How>
class pixels_on_levels {
  static constexpr bool TwoLevels = is_between(How);

 public:
  SPANTEX_INLINE pixels_on_levels(const row_work& work, const span_positions& p) : map_(work.texels->levels_in_rows()), positions_(p), last_(work.last_level) {}

  // The coarsest level that the span takes.
  SPANTEX_INLINE int32_t coarsest() const {
    int32_t most = 0;
    for (int k = 0; k < span_pixel_count; ++k) most = max_of(most, whole_level<TwoLevels>(int32_t(positions_.level[k])));
    return min_of(most + (TwoLevels ? 1 : 0), last_);
  }

  SPANTEX_INLINE void place(int n) {
    const v level = get(positions_.level + width * n), u = get(positions_.u + width * n), w = get(positions_.v + width * n), whole = whole_level<TwoLevels>(level);
    const int32_t first = whole[0];
    group& g = groups_[n % placed_groups];
    g.taken = levels_taken::several;
    if (!all_equal(whole, first)) [[unlikely]] return;
    hold(first);
    place_lanes<MasksOnly>(near_, u, w, positions_, g.near);
    g.near_down = near_.down;
    g.taken = levels_taken::one;
    if (!TwoLevels || all_equal(level & number<255>(), 0)) return;
    place_lanes<MasksOnly>(far_, u, w, positions_, g.far);
    g.far_down = far_.down;
    g.taken = levels_taken::two;
  }

  SPANTEX_INLINE unfinished at(int n) const {
    const group& g = groups_[n % placed_groups];
    if (g.taken == levels_taken::several) [[unlikely]] return by_lane(n);
    const blends near = blended(map_, g.near, g.near_down);
    if constexpr (!TwoLevels) return pixels_of(near);
    if (g.taken == levels_taken::one) return pixels_of_level(near);
    return joined<How>(near, blended(map_, g.far, g.far_down), get(positions_.level + width * n) & number<255>());
  }

  // What every lane's level is has been found: near() and far() are of it.
  SPANTEX_INLINE void hold(int32_t level) {
    if (level == held_) return;
    held_ = level;
    take_level<MasksOnly>(map_, level, positions_, near_);  // in place: compilers copy what is returned
    if (TwoLevels) take_level<MasksOnly>(map_, min_of(level + 1, last_), positions_, far_);
  }
  SPANTEX_INLINE const on_level<int32_t>& near() const { return near_; }
  SPANTEX_INLINE const on_level<int32_t>& far() const { return far_; }

 private:
  enum class levels_taken : int32_t { one, two, several };
  struct group {
    lanes_places near, far;
    int32_t near_down, far_down;
    levels_taken taken;
  };

  SPANTEX_INLINE unfinished by_lane(int n) const {
    const v level = get(positions_.level + width * n), whole = whole_level<TwoLevels>(level);
    if (!MasksOnly && map_.exact_count() <= last_) return pixels_in_turn<How>(map_, whole, last_, positions_, n, level & 255);
    alignas(sizeof(v)) int32_t fine[width], coarse[width];
    put(fine, whole);
    put(coarse, least(whole + 1, set(last_)));
    return pixels_by_lane<MasksOnly, How>(map_, fine, coarse, positions_, n, level & 255);
  }

  const row_levels& map_;
  const span_positions& positions_;
  int32_t last_, held_ = -1;
  on_level<int32_t> near_, far_;
  group groups_[placed_groups];
};

// Whether all pixels of a span are on one whole level, and whether some are between it and the next.
struct alike_levels { bool alike, between; };
template <bool TwoLevels>
SPANTEX_INLINE alike_levels compared(const span_positions& p) {
  const auto from = [&](int n) SPANTEX_INLINED { return TwoLevels ? get(p.level + width * n) : get(p.level + width * n) + 127; };  // whole_level()
  const v first = from(0);
  v differs = first ^ set(first[0]), any = first;
#pragma GCC unroll 8
  for (int n = 1; n < groups; ++n) {
    differs |= from(n) ^ first;
    any |= from(n);
  }
  return {all_equal(differs >> q.level_bits, 0), TwoLevels && !all_equal(any & number<255>(), 0)};
}

// A span whose pixels are all on one whole level, or on it and the next. Machines that spare levels (words) ask each group of pixels whether the next one has weight: a level's
// colours cost them more than to ask.
template <bool MasksOnly, rounded How>
SPANTEX_INLINE void draw_on_level(const row_in_hand& work, int32_t sx, span_mask mask, const span_positions& p, int32_t level) {
  constexpr bool two = is_between(How);
  const row_levels& map = work.texels->levels_in_rows();
  on_level<int32_t> near, far;
  take_level<MasksOnly>(map, level, p, near);
  if constexpr (two) take_level<MasksOnly>(map, level + 1, p, far);  // some pixel lies beyond `level`, which is not the last one then
  lanes_places at_near[placed_groups], at_far[placed_groups];
  draw_groups(work, sx, mask,
              [&](int n) SPANTEX_INLINED {
                const v u = get(p.u + width * n), w = get(p.v + width * n);
                place_lanes<MasksOnly>(near, u, w, p, at_near[n % placed_groups]);
                if (two) place_lanes<MasksOnly>(far, u, w, p, at_far[n % placed_groups]);
              },
              [&](int n) SPANTEX_INLINED {
                const blends fine = blended(map, at_near[n % placed_groups], near.down);
                if constexpr (two) {
                  const v fraction = get(p.level + width * n) & number<255>();
                  if (spares_levels && all_equal(fraction, 0)) return pixels_of_level(fine);
                  return joined<How>(fine, blended(map, at_far[n % placed_groups], far.down), fraction);
                } else return How == rounded::at_once ? pixels_of(fine) : pixels_of_level(fine);
              });
}

// Pixels by their levels of detail, a sample each.
template <bool MasksOnly, rounded How>
SPANTEX_INLINE void draw_on_levels(const row_in_hand& work, int32_t sx, span_mask mask, const span_positions& p, pixels_on_levels<MasksOnly, How>& pixels) {
  if (const alike_levels of = compared<is_between(How)>(p); of.alike) {
    const int32_t level = whole_level<is_between(How)>(int32_t(p.level[0]));
    if constexpr (!is_between(How)) draw_on_level<MasksOnly, How>(work, sx, mask, p, level);
    else if (of.between) draw_on_level<MasksOnly, How>(work, sx, mask, p, level);
    else draw_on_level<MasksOnly, rounded::after_level>(work, sx, mask, p, level);
    return;
  }
  draw_groups(work, sx, mask, [&](int n) SPANTEX_INLINED { pixels.place(n); }, [&](int n) SPANTEX_INLINED { return pixels.at(n); });
}

template <bool MasksOnly, bool TwoLevels>
SPANTEX_INLINE bool draw_by_level(const row_in_hand& work, int32_t sx, span_mask mask, span_positions& p, const span_coefficients& c) {
  pixels_on_levels<MasksOnly, TwoLevels ? rounded::between_levels : rounded::at_once> pixels(work, p);
  if constexpr (!MasksOnly) {
    const row_levels& map = work.texels->levels_in_rows();
    if (reach_of(c) > map.near_limit(work.last_level) && !in_reach(map, pixels.coarsest(), reach_of(c), p)) return false;  // limits of coarser levels are no larger
  }
  draw_on_levels(work, sx, mask, p, pixels);
  return true;
}
