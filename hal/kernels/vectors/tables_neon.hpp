// SPDX-License-Identifier: Apache-2.0
// NEON kernel: filters of 2x2 texels by table. The section that 4x4 pixels need of a level is up to 16x16 texels; a channel of 16x4 of them is four
// registers (byte_planes.hpp), from which one instruction looks up sixteen bytes, as VR11's local memory has them in banks. Sixteen pixels are then computed a channel at a
// time, 16 bits each (pixels.hpp). Quads whose section is larger take spans.hpp's way. Included by ../neon.cpp alone.
#pragma once

constexpr int most_table_level = 17 - cut_of(0);  // positions are shifted up, then down by 16
// log2 of texels from a base. A position's whole part fits a byte but where 1/w is nearly 2; what wraps then has left the table: each quad also has a
// pixel next to the span's centre.
constexpr int most_table_extent = 6;
static_assert(max_extent_log2 - most_table_extent <= most_table_level);
constexpr int quad_side = 4;
constexpr span_mask whole_quad = 0x0F0F0F0F;  // of a span's mask, shifted down to the quad's first pixel

// A level as a span's quads meet it. Positions on it are 8.8, not negative, their last bit without weight, from a texel before the span's base.
struct table_level {
  const byte_planes::level* plane;
  const uint8_t* values;
  int32_t from_u, from_v;  // the texel
};
constexpr int margin = 128, next_margin = 192;  // how far from the base that is, and on the next level as on_next_level() has it

SPANTEX_INLINE table_level table_of(const planar_map& map, int32_t from_u, int32_t from_v, int level) {
  const byte_planes::level& plane = map.planes().at(level);
  return {&plane, map.planes().values() + plane.first, from_u, from_v};
}

// From what span_positions has: bits 16 to 31 of (position 2^up) + add. Half of a last bit of coordinate_bits is added to all: what is rounded already has nothing there.
struct table_positions { int32x4_t add_u, add_v, up; };

SPANTEX_INLINE table_positions positions_on(const span_positions& p, const table_level& l, int level) {
  const int up = 17 - cut_of(level);  // 1 or more; a texel becomes 2^24: add_of(level) 2^16 - 2^23
  const uint32_t half = 1u << (up - 1);
  const auto add = [&](int32_t base, int32_t from) SPANTEX_INLINED { return vdupq_n_s32(int32_t(half + (1u << 16) - (1u << 23) + (uint32_t(base) << up) - (uint32_t(from) << 24))); };
  return {add(p.base_u, l.from_u), add(p.base_v, l.from_v), vdupq_n_s32(up - p.rest)};
}

// Four rows of four pixels, two rows a register.
struct quad_positions { uint16x8_t u[2], v[2]; };

// u, v: of its first pixel.
SPANTEX_INLINE quad_positions positions_of(const table_positions& on, const int32_t* u, const int32_t* v) {
  const auto rows = [&](const int32_t* position, int32x4_t add) SPANTEX_INLINED {
    const auto row = [&](int r) SPANTEX_INLINED { return vshlq_s32(vld1q_s32(position + width * r), on.up); };
    return uint16x8_t(vaddhn_high_s32(vaddhn_s32(row(0), add), row(1), add));
  };
  return {{rows(u, on.add_u), rows(u + 2 * width, on.add_u)}, {rows(v, on.add_v), rows(v + 2 * width, on.add_v)}};
}

// The same on the next level, from half the texel: half of it, to nearest, less a quarter of a texel.
SPANTEX_INLINE quad_positions on_next_level(const quad_positions& at) {
  const auto half = [](uint16x8_t x) SPANTEX_INLINED { return vhaddq_u16(x, vdupq_n_u16(uint16_t(1 - 128))); };
  return {{half(at.u[0]), half(at.u[1])}, {half(at.v[0]), half(at.v[1])}};
}

// Where sixteen pixels lie: in the table their texels, lower right one of 2x2 given by the next index; weights of 128; 2^8 the lower ones.
struct table_samples {
  const uint8_t* first;  // red of the table's texel (0, 0)
  int rows;              // that are looked at
  uint8x16_t index, across, from_left;
  int16x8_t down[2];
};

// False where the section is too large.
SPANTEX_INLINE bool samples_of(const table_level& l, const quad_positions& at, table_samples& s) {
  const auto texels = [](const uint16x8_t (&x)[2]) SPANTEX_INLINED { return vuzp2q_u8(uint8x16_t(x[0]), uint8x16_t(x[1])); };
  const auto weights = [](const uint16x8_t (&x)[2]) SPANTEX_INLINED { return vshrq_n_u8(vuzp1q_u8(uint8x16_t(x[0]), uint8x16_t(x[1])), 1); };
  const uint8x16_t u = texels(at.u), w = texels(at.v);
  const int left = vminvq_u8(u), top = vminvq_u8(w);
  const uint32_t column = uint32_t(l.from_u + left) & uint32_t(l.plane->mask_u), row_at = uint32_t(l.from_v + top) & uint32_t(l.plane->mask_v);
  const int begins = left - int(column % byte_planes::strip_pitch);
  s.rows = vmaxvq_u8(w) - top + 2;
  if (vmaxvq_u8(u) - begins > byte_planes::table_side - 2 || s.rows > byte_planes::table_side) return false;
  s.first = l.values + (column / byte_planes::strip_pitch * uint32_t(l.plane->strip) + row_at * byte_planes::table_side);
  s.index = vmlaq_u8(vsubq_u8(u, vdupq_n_u8(uint8_t(16 * top + begins))), w, vdupq_n_u8(16));
  s.across = weights(at.u);
  s.from_left = vsubq_u8(vdupq_n_u8(128), s.across);
  const uint8x16_t of_v = weights(at.v), zero = vdupq_n_u8(0);
  s.down[0] = int16x8_t(vzip1q_u8(zero, of_v));
  s.down[1] = int16x8_t(vzip2q_u8(zero, of_v));
  return true;
}

// Sixteen values of a channel, 8.7, and what decides a half: above 0, up.
struct table_colour { int16x8_t value[2], rest[2]; };

// Between x and y by a weight of 2^15: pixels.hpp says how and why.
template <bool Rest>
SPANTEX_INLINE table_colour between(const int16x8_t (&x)[2], const int16x8_t (&y)[2], const int16x8_t (&weight)[2]) {
  table_colour c;
#pragma GCC unroll 2
  for (int n = 0; n < 2; ++n) {
    const int16x8_t change = vsubq_s16(y[n], x[n]);
    c.value[n] = vaddq_s16(x[n], vqrdmulhq_s16(change, weight[n]));
    c.rest[n] = vandq_s16(c.value[n], vdupq_n_s16(0x80));
    if (Rest) c.rest[n] = vmlaq_s16(c.rest[n], change, vaddq_s16(weight[n], weight[n]));
  }
  return c;
}

// even() of pixels.hpp: what is not rounded up is one less, then halves go up. (0 less one is 2^16 - 1, whose rounding is 0 again in eight bits.)
SPANTEX_INLINE uint8x16_t even_bytes(const table_colour& c) {
  const auto one = [&](int n) SPANTEX_INLINED { return vaddq_u16(uint16x8_t(c.value[n]), vclezq_s16(c.rest[n])); };
  return vrshrn_high_n_u16(vrshrn_n_u16(one(0), q.blend_bits), one(1), q.blend_bits);
}

template <int Tables, bool Rest, int Channels>
SPANTEX_INLINE void blend_tables(const table_level& l, const table_samples& s, table_colour (&out)[Channels]) {
  const uint8x16_t index[4] = {s.index, vaddq_u8(s.index, vdupq_n_u8(1)), vaddq_u8(s.index, vdupq_n_u8(16)), vaddq_u8(s.index, vdupq_n_u8(17))};
  const uint8_t* from = s.first;
#pragma GCC unroll 4
  for (int m = 0; m < Channels; ++m, from += l.plane->channel) {
    uint8x16_t texel[4];
#pragma GCC unroll 4
    for (int n = 0; n < Tables; ++n) {
      const uint8x16x4_t table = vld1q_u8_x4(from + 64 * n);
#pragma GCC unroll 4
      for (int k = 0; k < 4; ++k) {
        const uint8x16_t at = vsubq_u8(index[k], vdupq_n_u8(uint8_t(64 * n)));
        texel[k] = n == 0 ? vqtbl4q_u8(table, at) : vqtbx4q_u8(texel[k], table, at);
      }
    }
    const auto low = [&](uint8x16_t a, uint8x16_t b) SPANTEX_INLINED {
      return int16x8_t(vmlal_u8(vmull_u8(vget_low_u8(a), vget_low_u8(s.from_left)), vget_low_u8(b), vget_low_u8(s.across)));
    };
    const auto high = [&](uint8x16_t a, uint8x16_t b) SPANTEX_INLINED { return int16x8_t(vmlal_high_u8(vmull_high_u8(a, s.from_left), b, s.across)); };
    const int16x8_t upper[2] = {low(texel[0], texel[1]), high(texel[0], texel[1])}, lower[2] = {low(texel[2], texel[3]), high(texel[2], texel[3])};
    out[m] = between<Rest>(upper, lower, s.down);
  }
}

template <bool Rest, int Channels>
SPANTEX_INLINE void blend_tables(const table_level& l, const table_samples& s, table_colour (&out)[Channels]) {
  if (s.rows <= 4) blend_tables<1, Rest>(l, s, out);
  else if (s.rows <= 8) blend_tables<2, Rest>(l, s, out);
  else if (s.rows <= 12) blend_tables<3, Rest>(l, s, out);
  else blend_tables<4, Rest>(l, s, out);
}

// Colours of sixteen pixels on a level. False where their section is too large.
template <bool Rest, int Channels>
SPANTEX_INLINE bool level_colours(const table_level& l, const quad_positions& at, table_colour (&out)[Channels]) {
  table_samples s;
  if (!samples_of(l, at, s)) return false;
  blend_tables<Rest>(l, s, out);
  return true;
}

// Four rows of four pixels.
struct quad { v row[quad_side]; };

template <int Channels>
SPANTEX_INLINE quad quad_from(const table_colour (&c)[Channels]) {
  const uint8x16_t r = even_bytes(c[0]), g = even_bytes(c[1]), b = even_bytes(c[2]), a = Channels == 4 ? even_bytes(c[Channels - 1]) : vdupq_n_u8(255);
  const uint16x8_t rg[2] = {uint16x8_t(vzip1q_u8(r, g)), uint16x8_t(vzip2q_u8(r, g))}, ba[2] = {uint16x8_t(vzip1q_u8(b, a)), uint16x8_t(vzip2q_u8(b, a))};
  return {{v(vzip1q_u16(rg[0], ba[0])), v(vzip2q_u16(rg[0], ba[0])), v(vzip1q_u16(rg[1], ba[1])), v(vzip2q_u16(rg[1], ba[1]))}};
}

// Both: false where a section is too large, nothing drawn. Rounded: the colour of a level is rounded to blend_bits first, as between levels.
template <int Channels, bool Rounded>
SPANTEX_INLINE bool quad_of_level(const table_level& l, const quad_positions& at, auto&& draw) {
  table_colour c[Channels];
  if (!level_colours<!Rounded>(l, at, c)) return false;
  draw(quad_from(c));
  return true;
}

// fraction: of 256.
template <int Channels>
SPANTEX_INLINE bool quad_between(const table_level& fine, const table_level& coarse, const int16x8_t (&fraction)[2], const quad_positions& at, auto&& draw) {
  table_colour near[Channels], far[Channels];
  if (!level_colours<false>(fine, at, near) || !level_colours<false>(coarse, on_next_level(at), far)) return false;
  const int16x8_t weight[2] = {vshlq_n_s16(fraction[0], 15 - q.level_bits), vshlq_n_s16(fraction[1], 15 - q.level_bits)};
#pragma GCC unroll 4
  for (int m = 0; m < Channels; ++m) near[m] = between<true>(near[m].value, far[m].value, weight);
  draw(quad_from(near));
  return true;
}

// Levels of a quad's pixels: the finest whole one, what each has above it, of 256, and the most that one has.
struct quad_levels { int whole, most; int16x8_t above[2]; };

template <bool TwoLevels>
SPANTEX_INLINE quad_levels levels_of(const level_number* level) {
  uint16x8_t a = uint16x8_t(vld1q_s16(level)), b = uint16x8_t(vld1q_s16(level + 2 * width));
  if (!TwoLevels) a = vaddq_u16(a, vdupq_n_u16(127)), b = vaddq_u16(b, vdupq_n_u16(127));  // as whole_level()
  const int whole = vminvq_u16(vminq_u16(a, b)) >> q.level_bits;
  const uint16x8_t from = vdupq_n_u16(uint16_t(whole << q.level_bits)), c = vsubq_u16(a, from), d = vsubq_u16(b, from);
  return {whole, vmaxvq_u16(vmaxq_u16(c, d)), {int16x8_t(c), int16x8_t(d)}};
}

// To where the mask has pixels.
SPANTEX_INLINE void write_quad(rgba8* to, ptrdiff_t stride, span_mask of_quad, const quad& pixels) {
  if ((of_quad & whole_quad) == whole_quad) [[likely]] {
#pragma GCC unroll 4
    for (int r = 0; r < quad_side; ++r, to += stride) put(to, pixels.row[r]);
    return;
  }
  for (int r = 0; r < quad_side; ++r, to += stride) write(to, uint32_t(of_quad >> (span_side * r)), pixels.row[r]);
}

// Colours of pixels on the finer level, or (upper: all ones) on the coarser of two next to each other.
template <int Channels>
SPANTEX_INLINE void pick(const uint16x8_t (&upper)[2], const table_colour (&x)[Channels], table_colour (&out)[Channels]) {
  for (int m = 0; m < Channels; ++m)
    for (int n = 0; n < 2; ++n) out[m].value[n] = vbslq_s16(upper[n], x[m].value[n], out[m].value[n]);
}

// A quad whose pixels lie between the finer two of three levels, or between the coarser two. False where a section is too large, nothing drawn.
template <int Channels>
[[gnu::noinline]] bool quad_on_three(const row_work& work, const span_coefficients& c, const span_positions& p, int k, span_mask of_quad, rgba8* to) {
  const quad_levels at_level = levels_of<true>(p.level + k);
  const int fine = at_level.whole, coarse = fine + 1, coarsest = min_of(fine + 2, work.last_level);
  const int32_t half_u = c.base_u >> coarse, half_v = c.base_v >> coarse;
  const auto table = [&](int32_t u, int32_t w, int above, int level) SPANTEX_INLINED { return table_of(*work.texels, u - above, w - above, level); };
  const table_level level[] = {table(2 * half_u, 2 * half_v, margin, fine), table(half_u, half_v, next_margin, coarse),
                               table(c.base_u >> coarsest, c.base_v >> coarsest, margin, coarsest)};
  const quad_positions at = positions_of(positions_on(p, level[0], fine), p.u + k, p.v + k);
  table_colour near[Channels], middle[Channels], far[Channels];
  if (!level_colours<false>(level[0], at, near) || !level_colours<false>(level[1], on_next_level(at), middle) ||
      !level_colours<false>(level[2], positions_of(positions_on(p, level[2], coarsest), p.u + k, p.v + k), far)) return false;
  uint16x8_t upper[2];
  int16x8_t weight[2];
  for (int n = 0; n < 2; ++n) {
    upper[n] = vcgeq_s16(at_level.above[n], vdupq_n_s16(1 << q.level_bits));
    weight[n] = vshlq_n_s16(vandq_s16(at_level.above[n], vdupq_n_s16((1 << q.level_bits) - 1)), 15 - q.level_bits);
  }
  pick(upper, middle, near);
  pick(upper, far, middle);
  for (int m = 0; m < Channels; ++m) near[m] = between<true>(near[m].value, middle[m].value, weight);
  write_quad(to, work.stride, of_quad, quad_from(near));
  return true;
}

// Of the four rows of four pixels that lie in memory from the k-th on.
template <bool Levels>
SPANTEX_INLINE void round_positions(const span_positions& p, int k, span_positions& out) {
  const auto nearest = [&](const int32_t* x) SPANTEX_INLINED { return rounded_shift(get(x), p.rest); };
  for (int r = 0; r < quad_side; ++r, k += width) {
    put(out.u + k, nearest(p.u + k));
    put(out.v + k, nearest(p.v + k));
    if (Levels) __builtin_memcpy(out.level + k, p.level + k, width * sizeof(level_number));
  }
  out.rest = 0;
  out.base_u = p.base_u;
  out.base_v = p.base_v;
  out.far = false;
}

// The same pixels, as spans.hpp draws them.
template <filter Kind>
[[gnu::noinline]] void quad_without_tables(const row_work& work, const span_positions& p, int k, span_mask of_quad, rgba8* to) {
  const row_levels& map = work.texels->levels_in_rows();
  span_positions own;
  round_positions<uses_levels(Kind)>(p, k, own);
  pixels_on_levels<true, uses_two_levels(Kind) ? rounded::between_levels : rounded::at_once> pixels(work, own);
  if (!uses_levels(Kind)) pixels.hold(0);
  for (int r = 0; r < quad_side; ++r, k += width, to += work.stride) {
    if (uses_levels(Kind)) pixels.place(k / width);
    write(to, uint32_t(of_quad >> (span_side * r)), uses_levels(Kind) ? pixels.at(k / width) : pixels_of(blended_at<true>(map, pixels.near(), get(own.u + k), get(own.v + k), own)));
  }
}

// Functions of their own, so that what others keep in registers leaves it all of them.
template <filter Kind, int Channels>
[[gnu::noinline]] void quads_by_tables(const row_work& work, int32_t sx, span_mask mask, const span_positions& p, const span_coefficients& c) {
  constexpr bool by_level = uses_levels(Kind), two = uses_two_levels(Kind);
  const planar_map& map = *work.texels;
  const int least_level = max_of(q.offset_bits - 1 - c.exponent - most_table_extent, 0);
  table_level fine, coarse;
  table_positions on;
  int held = -1;
  const auto hold = [&](int level) SPANTEX_INLINED {
    held = level;
    const int32_t half_u = c.base_u >> (level + 1), half_v = c.base_v >> (level + 1);
    fine = table_of(map, 2 * half_u - margin, 2 * half_v - margin, level);
    if constexpr (two) coarse = table_of(map, half_u - next_margin, half_v - next_margin, min_of(level + 1, work.last_level));
    on = positions_on(p, fine, level);
  };
  const ptrdiff_t stride = work.stride;
  rgba8* row = work.pixels + sx * span_side;
  for (int y = 0; y < span_side; y += quad_side, row += quad_side * stride) {
#pragma GCC unroll 2
    for (int part = 0; part < parts; ++part, mask >>= quad_side) {
      const span_mask of_quad = mask;
      const int k = place_of(y, part);
      if ((of_quad & whole_quad) == 0) continue;
      rgba8* const to = row + quad_side * part;
      const auto draw = [&](const quad& out) SPANTEX_INLINED { write_quad(to, stride, of_quad, out); };
      bool drawn = false;
      quad_levels level{};
      if constexpr (by_level) level = levels_of<two>(p.level + k);
      if (uint32_t(level.whole - least_level) < uint32_t(most_table_level - least_level)) {
        if (level.most < 1 << q.level_bits) [[likely]] {
          if (level.whole != held) hold(level.whole);
          const quad_positions at = positions_of(on, p.u + k, p.v + k);
          if constexpr (!two) drawn = quad_of_level<Channels, false>(fine, at, draw);
          else if (level.most == 0) drawn = quad_of_level<Channels, true>(fine, at, draw);
          else drawn = quad_between<Channels>(fine, coarse, level.above, at, draw);
        } else if (two && level.most < 2 << q.level_bits && level.whole + 2 < most_table_level) {
          drawn = quad_on_three<Channels>(work, c, p, k, of_quad, to);
        }
      }
      if (!drawn) [[unlikely]] quad_without_tables<Kind>(work, p, k, of_quad, to);
    }
    mask >>= quad_side * span_side - parts * quad_side;
  }
}

// Whether level 0 is so minified at the span's centre that quads fit a table only where a strip begins well for them.
SPANTEX_INLINE bool too_wide(const span_coefficients& c) {
  const auto across = [](int32_t a, int32_t b) SPANTEX_INLINED { return 2 * (quad_side - 1) * (magnitude(a) + magnitude(b)); };
  const uint64_t u = across(c.a_u, c.b_u), w = across(c.a_v, c.b_v);
  return (u > w ? u : w) >> c.exponent >= byte_planes::strip_pitch;
}

template <filter Kind>
SPANTEX_INLINE void quads_on_levels(const row_work& work, int32_t sx, span_mask mask, const span_positions& p, const span_coefficients& c) {
  if (work.texels->opaque()) quads_by_tables<Kind, 3>(work, sx, mask, p, c);
  else quads_by_tables<Kind, 4>(work, sx, mask, p, c);
}

// Of maps whose axes wrap at powers of two: all of their levels halve exactly.
template <filter Kind>
SPANTEX_INLINE void draw_by_tables(const row_work& work, int32_t sx, span_mask mask, span_positions& p, const span_coefficients& c) {
  if constexpr (Kind == filter::bilinear)
    if (too_wide(c)) return draw_bilinear<true>(work, sx, mask, p, c);
  find_positions<uses_levels(Kind), false>(c, p);
  quads_on_levels<Kind>(work, sx, mask, p, c);
}
