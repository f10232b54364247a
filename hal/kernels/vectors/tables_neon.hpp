// SPDX-License-Identifier: Apache-2.0
// NEON kernel: filters of 2x2 texels by table. The section that 4x4 pixels need of a level is up to 16x16 texels; a channel of 16x4 of them is four
// registers (byte_planes.hpp), from which one instruction looks up sixteen bytes, as VR11's local memory has them in banks. Sixteen pixels are then computed a channel at a
// time, 16 bits each (pixels.hpp). Quads whose section is larger, or that lie on more than one level, take spans.hpp's way. Included by ../neon.cpp alone.
#pragma once

constexpr int most_table_level = 16 - cut_of(0);  // positions are shifted up, then down by 16
constexpr int quad_side = 4, quad_pixels = quad_side * quad_side;

// A level as a span's quads meet it. Positions on it are relative to a texel near the span's base, 7 bits of fraction.
struct table_level {
  int32x4_t add_u, add_v, up;  // position: bits 16 to 31 of (s15.14 << up) + add
  const uint8_t* values;
  byte_planes::level plane;
  int32_t from_u, from_v;  // the texel
};

SPANTEX_INLINE table_level table_of(const planar_map& map, const span_coefficients& c, int level) {
  table_level t;
  t.plane = map.planes().at(level);
  t.values = map.planes().values() + t.plane.first;
  t.from_u = c.base_u >> level;
  t.from_v = c.base_v >> level;
  const int up = max_of(0, 16 - cut_of(level));
  const auto add = [&](int32_t from) SPANTEX_INLINED { return vdupq_n_s32(int32_t(uint32_t(add_of(level) - from * (1 << (q.coordinate_bits + level))) << up)); };
  t.add_u = add(t.from_u);
  t.add_v = add(t.from_v);
  t.up = vdupq_n_s32(up);
  return t;
}

// Where sixteen pixels lie: in the table their texels, lower right one of 2x2 given by the next index; weights of 128; 2^8 the lower ones.
struct table_samples {
  const uint8_t* first;  // red of the table's texel (0, 0)
  int rows;              // that are looked at
  uint8x16_t index, across, from_left;
  int16x8_t down[2];
};

// False where the section is too large.
SPANTEX_INLINE bool samples_of(const table_level& l, const span_positions& p, int k, table_samples& s) {
  const auto rows = [&](const int32_t* position, int32x4_t add) SPANTEX_INLINED {
    const auto row = [&](int r) SPANTEX_INLINED { return vshlq_s32(vld1q_s32(position + k + span_side * r), l.up); };
    return vaddhn_high_s32(vaddhn_s32(row(0), add), row(1), add);
  };
  const int16x8_t u0 = rows(p.u, l.add_u), u1 = rows(p.u + 2 * span_side, l.add_u), v0 = rows(p.v, l.add_v), v1 = rows(p.v + 2 * span_side, l.add_v);
  const int left = vminvq_s16(vminq_s16(u0, u1)) >> q.subtexel_bits, right = vmaxvq_s16(vmaxq_s16(u0, u1)) >> q.subtexel_bits;
  const int top = vminvq_s16(vminq_s16(v0, v1)) >> q.subtexel_bits, bottom = vmaxvq_s16(vmaxq_s16(v0, v1)) >> q.subtexel_bits;
  const uint32_t column = uint32_t(l.from_u + left) & uint32_t(l.plane.mask_u), row_at = uint32_t(l.from_v + top) & uint32_t(l.plane.mask_v);
  const int begins = left - int(column % byte_planes::strip_pitch);
  if (right - begins > byte_planes::table_side - 2 || bottom - top > byte_planes::table_side - 2) return false;
  s.rows = bottom - top + 2;
  s.first = l.values + (column / byte_planes::strip_pitch * uint32_t(l.plane.strip) + row_at * byte_planes::table_side);
  const auto texels = [](int16x8_t a, int16x8_t b) SPANTEX_INLINED { return vshrn_high_n_u16(vshrn_n_u16(uint16x8_t(a), q.subtexel_bits), uint16x8_t(b), q.subtexel_bits); };
  const auto weights = [](int16x8_t a, int16x8_t b) SPANTEX_INLINED { return vandq_u8(vuzp1q_u8(uint8x16_t(a), uint8x16_t(b)), vdupq_n_u8(0x7F)); };
  s.index = vsubq_u8(vmlaq_u8(texels(u0, u1), texels(v0, v1), vdupq_n_u8(16)), vdupq_n_u8(uint8_t(16 * top + begins)));
  s.across = weights(u0, u1);
  s.from_left = vsubq_u8(vdupq_n_u8(128), s.across);
  const uint8x16_t of_v = weights(v0, v1), zero = vdupq_n_u8(0);
  s.down[0] = int16x8_t(vzip1q_u8(zero, of_v));
  s.down[1] = int16x8_t(vzip2q_u8(zero, of_v));
  return true;
}

// Colours on one level, 8.7, a channel of sixteen pixels each; and what rounding left out of them, as in pixels.hpp.
template <int Channels>
struct table_colours { int16x8_t colour[Channels][2], rest[Channels][2]; };

template <int Channels, int Tables, bool Rest>
SPANTEX_INLINE void blend_tables(const table_level& l, const table_samples& s, table_colours<Channels>& out) {
  const uint8x16_t index[4] = {s.index, vaddq_u8(s.index, vdupq_n_u8(1)), vaddq_u8(s.index, vdupq_n_u8(16)), vaddq_u8(s.index, vdupq_n_u8(17))};
#pragma GCC unroll 4
  for (int m = 0; m < Channels; ++m) {
    const uint8_t* from = s.first + m * l.plane.channel;
    uint8x16_t texel[4];
#pragma GCC unroll 4
    for (int n = 0; n < Tables; ++n, from += 64) {
      const uint8x16x4_t table = vld1q_u8_x4(from);
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
#pragma GCC unroll 2
    for (int n = 0; n < 2; ++n) {
      const int16x8_t change = vsubq_s16(lower[n], upper[n]);
      out.colour[m][n] = vaddq_s16(upper[n], vqrdmulhq_s16(change, s.down[n]));
      if (Rest) out.rest[m][n] = vmulq_s16(change, vaddq_s16(s.down[n], s.down[n]));
    }
  }
}

template <int Channels, bool Rest>
SPANTEX_INLINE void blend_tables(const table_level& l, const table_samples& s, table_colours<Channels>& out) {
  if (s.rows <= 4) blend_tables<Channels, 1, Rest>(l, s, out);
  else if (s.rows <= 8) blend_tables<Channels, 2, Rest>(l, s, out);
  else if (s.rows <= 12) blend_tables<Channels, 3, Rest>(l, s, out);
  else blend_tables<Channels, 4, Rest>(l, s, out);
}

// even() of pixels.hpp: what is not rounded up is one less, then halves go up. (0 less one is 2^16 - 1, whose rounding is 0 again in eight bits.)
SPANTEX_INLINE uint8x16_t even_bytes(const int16x8_t (&x)[2], const int16x8_t (&rest)[2]) {
  const auto one = [&](int n) SPANTEX_INLINED { return vaddq_u16(uint16x8_t(x[n]), vclezq_s16(vaddq_s16(rest[n], vandq_s16(x[n], vdupq_n_s16(0x80))))); };
  return vrshrn_high_n_u16(vrshrn_n_u16(one(0), q.blend_bits), one(1), q.blend_bits);
}

// Four rows of four pixels.
using quad = uint32_t[quad_pixels];

template <int Channels>
SPANTEX_INLINE void put_quad(const uint8x16_t (&channel)[Channels], quad& out) {
  vst4q_u8(reinterpret_cast<uint8_t*>(out), uint8x16x4_t{{channel[0], channel[1], channel[2], Channels == 4 ? channel[Channels - 1] : vdupq_n_u8(255)}});
}

// Rounded: the colour of a level is rounded to blend_bits first, as between levels.
template <int Channels, bool Rounded>
SPANTEX_INLINE bool quad_of_level(const table_level& l, const span_positions& p, int k, quad& out) {
  table_samples s;
  if (!samples_of(l, p, k, s)) return false;
  table_colours<Channels> c;
  blend_tables<Channels, !Rounded>(l, s, c);
  uint8x16_t channel[Channels];
  const int16x8_t none[2] = {vdupq_n_s16(0), vdupq_n_s16(0)};
#pragma GCC unroll 4
  for (int m = 0; m < Channels; ++m) channel[m] = even_bytes(c.colour[m], Rounded ? none : c.rest[m]);
  put_quad<Channels>(channel, out);
  return true;
}

// fraction: of 256.
template <int Channels>
SPANTEX_INLINE bool quad_between(const table_level& fine, const table_level& coarse, const int16x8_t (&fraction)[2], const span_positions& p, int k, quad& out) {
  table_samples s, t;
  if (!samples_of(fine, p, k, s) || !samples_of(coarse, p, k, t)) return false;
  table_colours<Channels> near, far;
  blend_tables<Channels, false>(fine, s, near);
  blend_tables<Channels, false>(coarse, t, far);
  uint8x16_t channel[Channels];
  const int16x8_t weight[2] = {vshlq_n_s16(fraction[0], 15 - q.level_bits), vshlq_n_s16(fraction[1], 15 - q.level_bits)};
#pragma GCC unroll 4
  for (int m = 0; m < Channels; ++m) {
    int16x8_t x[2], rest[2];
#pragma GCC unroll 2
    for (int n = 0; n < 2; ++n) {
      const int16x8_t change = vsubq_s16(far.colour[m][n], near.colour[m][n]);
      x[n] = vaddq_s16(near.colour[m][n], vqrdmulhq_s16(change, weight[n]));
      rest[n] = vmulq_s16(change, vaddq_s16(weight[n], weight[n]));
    }
    channel[m] = even_bytes(x, rest);
  }
  put_quad<Channels>(channel, out);
  return true;
}

// Levels of a quad's pixels: whether they lie on one, which one, and the fraction above it.
template <bool TwoLevels>
SPANTEX_INLINE bool one_level(const int32_t* level, int& whole, int16x8_t (&fraction)[2]) {
  const auto row = [&](int r) SPANTEX_INLINED {
    const v x = get(level + span_side * r);
    return int32x4_t(TwoLevels ? x : x + 127);  // as whole_level()
  };
  const int16x8_t a = vuzp1q_s16(int16x8_t(row(0)), int16x8_t(row(1))), b = vuzp1q_s16(int16x8_t(row(2)), int16x8_t(row(3)));
  whole = vgetq_lane_u16(uint16x8_t(a), 0) >> q.level_bits;
  const int16x8_t from = vdupq_n_s16(int16_t(whole << q.level_bits));
  fraction[0] = vsubq_s16(a, from);
  fraction[1] = vsubq_s16(b, from);
  return vmaxvq_u16(vorrq_u16(uint16x8_t(fraction[0]), uint16x8_t(fraction[1]))) < 256;
}

template <filter Kind, int Channels>
SPANTEX_INLINE void quads_by_tables(const row_work& work, int32_t sx, span_mask mask, const span_positions& p, const span_coefficients& c) {
  constexpr bool by_level = uses_levels(Kind), two = uses_two_levels(Kind);
  const planar_map& map = *work.texels;
  pixels_on_levels<true, two> others(work);
  const int extent_log2 = q.offset_bits - 1 - c.exponent;
  const on_level<int32_t> first = level_at_once(map.levels_in_rows(), 0);
  table_level fine = table_of(map, c, 0), coarse = fine;
  int held = 0;
  if constexpr (two) coarse = table_of(map, c, min_of(1, work.last_level));
  rgba8* const corner = work.pixels + int64_t(work.sy) * span_side * work.stride + sx * span_side;
  for (int n = 0; n < 4; ++n) {
    const int k = quad_side * (n & 1) + quad_side * span_side * (n >> 1);
    const span_mask of_quad = mask >> k;
    if ((of_quad & 0x0F0F0F0F) == 0) continue;
    alignas(16) quad out;
    bool drawn = false;
    int whole = 0;
    int16x8_t fraction[2];
    if (!by_level || one_level<two>(p.level + k, whole, fraction)) {
      if (by_level && whole != held) {
        held = whole;
        fine = table_of(map, c, whole);
        if constexpr (two) coarse = table_of(map, c, min_of(whole + 1, work.last_level));
      }
      if (extent_log2 - whole <= 7 && whole < most_table_level) {  // positions fit 16 bits
        if constexpr (two) {
          const bool mixed = vmaxvq_u16(vorrq_u16(uint16x8_t(fraction[0]), uint16x8_t(fraction[1]))) != 0;
          drawn = mixed ? quad_between<Channels>(fine, coarse, fraction, p, k, out) : quad_of_level<Channels, true>(fine, p, k, out);
        } else {
          drawn = quad_of_level<Channels, false>(fine, p, k, out);
        }
      }
    }
    rgba8* to = corner + int64_t(quad_side * (n >> 1)) * work.stride + quad_side * (n & 1);
    if (drawn && (of_quad & 0x0F0F0F0F) == 0x0F0F0F0F) [[likely]] {
#pragma GCC unroll 4
      for (int r = 0; r < quad_side; ++r, to += work.stride) put(to, get(reinterpret_cast<const int32_t*>(out) + quad_side * r));
      continue;
    }
    for (int r = 0; r < quad_side; ++r, to += work.stride) {
      const int at = k + span_side * r;
      const v pixels = drawn ? get(reinterpret_cast<const int32_t*>(out) + quad_side * r)
                             : by_level ? others.at(get(p.level + at), p.u + at, p.v + at) : pixels_of(blended_at<true>(map.levels_in_rows(), first, get(p.u + at), get(p.v + at)));
      write(to, uint32_t(of_quad >> (span_side * r)), pixels);
    }
  }
}

// Whether level 0 is so minified at the span's centre that quads fit a table only where a strip begins well for them.
SPANTEX_INLINE bool too_wide(const span_coefficients& c) {
  const auto across = [](int32_t a, int32_t b) SPANTEX_INLINED { return 2 * (quad_side - 1) * (magnitude(a) + magnitude(b)); };
  const uint64_t u = across(c.a_u, c.b_u), w = across(c.a_v, c.b_v);
  return (u > w ? u : w) >> c.exponent >= byte_planes::strip_pitch;
}

// Of maps whose axes wrap at powers of two: all of their levels halve exactly.
template <filter Kind>
SPANTEX_INLINE void draw_by_tables(const row_work& work, int32_t sx, span_mask mask, const span_positions& p, const span_coefficients& c) {
  if constexpr (Kind == filter::bilinear)
    if (too_wide(c)) return draw_bilinear<true>(work, sx, mask, p);
  if (work.texels->opaque()) quads_by_tables<Kind, 3>(work, sx, mask, p, c);
  else quads_by_tables<Kind, 4>(work, sx, mask, p, c);
}
