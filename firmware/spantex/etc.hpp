// SPDX-License-Identifier: Apache-2.0
// ETC1 and ETC2 (Khronos Data Format Specification, OpenGL ES 3.0 appendix C): decoding. A colour block is 64 bits, big-endian; bit 63 is
// the top bit of the first byte. Two sets of four colours, one a half of the block, except in the planar mode.
//
//   bit                63   59   55   51   47   43   39  36  33 32
//   individual         R1   R2   G1   G2   B1   B2   t1  t2  0  f       4 bits a base channel, x 17
//   bit                63     58   55     50   47     42   39  36  33 32
//   differential       R      dR   G      dG   B      dB   t1  t2  1  f 5 bits, repeated; second half R + dR, dR signed 3 bits
//     f = 0: halves are columns 0-1 and 2-3; f = 1: rows 0-1 and 2-3
//     paint 0..3 = base + a, + b, - a, - b, (a, b) by t: (2,8) (5,17) (9,29) (13,42) (18,60) (24,80) (33,106) (47,183)
//   differential with R + dR outside 0..31: T;  else G: H;  else B: planar (ETC1 leaves these undefined; here it decodes them likewise)
//   T        R1 60-59 57-56  G1 55-52  B1 51-48  R2 47-44  G2 43-40  B2 39-36  d 35-34 32        4 bits a channel, x 17
//            paint = c1, c2 + d, c2, c2 - d
//   H        R1 62-59  G1 58-56 52  B1 51 49-47  R2 46-43  G2 42-39  B2 38-35  d 34 32 and, lowest, c1 >= c2 (as 24-bit RGB)
//            paint = c1 + d, c1 - d, c2 + d, c2 - d;  d by number: 3 6 11 16 23 32 41 64
//   planar   RO 62-57  GO 56 54-49  BO 48 44-43 41-39  RH 38-34 32  GH 31-25  BH 24-19  RV 18-13  GV 12-6  BV 5-0; repeated to 8 bits
//            channel(x, y) = (x (H - O) + y (V - O) + 4 O + 2) >> 2
//   Every sum is clamped to 0..255. Texel (x, y): n = 4 x + y, paint = bit 16 + n, bit n.
//   etc2_rgb8a1  bit 33 says opaque; there is no individual mode. Not opaque: paint 2 is (0, 0, 0, 0), and a is 0. Planar is opaque.
//   etc2_rgba8   8 bytes of EAC alpha before the colours: base 63-56, multiplier 55-52, table 51-48, texel n 47-3n .. 45-3n;
//                alpha = base + multiplier modifier[table][number], clamped
#pragma once
#include <stdint.h>

#include <spantex/texel_block.hpp>

namespace spantex {

inline constexpr uint8_t etc_modifiers[8][2] = {{2, 8}, {5, 17}, {9, 29}, {13, 42}, {18, 60}, {24, 80}, {33, 106}, {47, 183}};
inline constexpr uint8_t etc_distances[8] = {3, 6, 11, 16, 23, 32, 41, 64};
inline constexpr int8_t eac_modifiers[16][8] = {
    {-3, -6, -9, -15, 2, 5, 8, 14}, {-3, -7, -10, -13, 2, 6, 9, 12}, {-2, -5, -8, -13, 1, 4, 7, 12}, {-2, -4, -6, -13, 1, 3, 5, 12},
    {-3, -6, -8, -12, 2, 5, 7, 11}, {-3, -7, -9, -11, 2, 6, 8, 10},  {-4, -7, -8, -11, 3, 6, 7, 10}, {-3, -5, -8, -11, 2, 4, 7, 10},
    {-2, -6, -8, -10, 1, 5, 7, 9},  {-2, -5, -8, -10, 1, 4, 7, 9},   {-2, -4, -8, -10, 1, 3, 7, 9},  {-2, -5, -7, -10, 1, 4, 6, 9},
    {-3, -4, -7, -10, 2, 3, 6, 9},  {-1, -2, -3, -10, 0, 1, 2, 9},   {-4, -6, -8, -9, 3, 5, 7, 8},   {-3, -5, -7, -9, 2, 4, 6, 8}};

// c + d in every channel, clamped.
constexpr rgba8 etc_moved(rgba8 c, int d) { return {detail::byte_of(c.r + d), detail::byte_of(c.g + d), detail::byte_of(c.b + d), 255}; }

constexpr rgba8 etc_colour(int32_t r, int32_t g, int32_t b, int bits) {
  return {uint8_t(detail::repeated(r, bits)), uint8_t(detail::repeated(g, bits)), uint8_t(detail::repeated(b, bits)), 255};
}

// One channel of a planar block: o, h, v as 8-bit values.
constexpr uint8_t etc_planar(int32_t o, int32_t h, int32_t v, int x, int y) {
  return detail::byte_of((x * (h - o) + y * (v - o) + 4 * o + 2) >> 2);
}

namespace detail {

struct etc_paints { rgba8 paint[2][4]; };

// A block's bits 63..32 and 31..0.
struct etc_bits {
  uint32_t upper, lower;
  constexpr int32_t field(int high, int low) const { return low >= 32 ? bits_of(upper, high - 32, low - 32) : bits_of(lower, high, low); }
};

inline constexpr rgba8 etc_transparent{0, 0, 0, 0};

constexpr void etc_half(rgba8 base, int table, bool opaque, rgba8 (&paint)[4]) {
  const int a = opaque ? etc_modifiers[table][0] : 0, b = etc_modifiers[table][1];
  paint[0] = etc_moved(base, a);
  paint[1] = etc_moved(base, b);
  paint[2] = opaque ? etc_moved(base, -a) : etc_transparent;
  paint[3] = etc_moved(base, -b);
}

constexpr void etc_t_mode(etc_bits e, rgba8 (&paint)[4]) {
  const rgba8 c1 = etc_colour(e.field(60, 59) << 2 | e.field(57, 56), e.field(55, 52), e.field(51, 48), 4);
  const rgba8 c2 = etc_colour(e.field(47, 44), e.field(43, 40), e.field(39, 36), 4);
  const int d = etc_distances[e.field(35, 34) << 1 | e.field(32, 32)];
  paint[0] = c1;
  paint[1] = etc_moved(c2, d);
  paint[2] = c2;
  paint[3] = etc_moved(c2, -d);
}

constexpr int32_t rgb_number(rgba8 c) { return int32_t(c.r) << 16 | int32_t(c.g) << 8 | c.b; }

constexpr void etc_h_mode(etc_bits e, rgba8 (&paint)[4]) {
  const rgba8 c1 = etc_colour(e.field(62, 59), e.field(58, 56) << 1 | e.field(52, 52), e.field(51, 51) << 3 | e.field(49, 47), 4);
  const rgba8 c2 = etc_colour(e.field(46, 43), e.field(42, 39), e.field(38, 35), 4);
  const int order = rgb_number(c1) >= rgb_number(c2) ? 1 : 0;
  const int d = etc_distances[e.field(34, 34) << 2 | e.field(32, 32) << 1 | order];
  paint[0] = etc_moved(c1, d);
  paint[1] = etc_moved(c1, -d);
  paint[2] = etc_moved(c2, d);
  paint[3] = etc_moved(c2, -d);
}

constexpr void decode_planar(etc_bits e, texel_block& out) {
  const rgba8 o{uint8_t(repeated(e.field(62, 57), 6)), uint8_t(repeated(e.field(56, 56) << 6 | e.field(54, 49), 7)),
                uint8_t(repeated(e.field(48, 48) << 5 | e.field(44, 43) << 3 | e.field(41, 39), 6)), 255};
  const rgba8 h{uint8_t(repeated(e.field(38, 34) << 1 | e.field(32, 32), 6)), uint8_t(repeated(e.field(31, 25), 7)),
                uint8_t(repeated(e.field(24, 19), 6)), 255};
  const rgba8 v{uint8_t(repeated(e.field(18, 13), 6)), uint8_t(repeated(e.field(12, 6), 7)), uint8_t(repeated(e.field(5, 0), 6)), 255};
  for (int k = 0; k < 16; ++k) {
    const int x = k % 4, y = k / 4;
    out.texel[k] = {etc_planar(o.r, h.r, v.r, x, y), etc_planar(o.g, h.g, v.g, x, y), etc_planar(o.b, h.b, v.b, x, y), 255};
  }
}

constexpr void decode_etc(const uint8_t* p, bool punch_through, texel_block& out) {
  const etc_bits e{big_endian_32(p), big_endian_32(p + 4)};
  const bool bit_33 = e.field(33, 33) != 0, differential = punch_through || bit_33, opaque = !punch_through || bit_33;
  const bool by_rows = e.field(32, 32) != 0;
  etc_paints all{};
  if (!differential) {
    etc_half(etc_colour(e.field(63, 60), e.field(55, 52), e.field(47, 44), 4), e.field(39, 37), true, all.paint[0]);
    etc_half(etc_colour(e.field(59, 56), e.field(51, 48), e.field(43, 40), 4), e.field(36, 34), true, all.paint[1]);
  } else {
    const auto moved = [&](int top) { return e.field(top, top - 4) + (e.field(top - 5, top - 7) ^ 4) - 4; };
    const int32_t r = moved(63), g = moved(55), b = moved(47);
    const bool t_mode = (r & ~31) != 0, h_mode = !t_mode && (g & ~31) != 0;
    if (!t_mode && !h_mode && (b & ~31) != 0) return decode_planar(e, out);
    if (t_mode || h_mode) {
      if (t_mode) etc_t_mode(e, all.paint[0]);
      else etc_h_mode(e, all.paint[0]);
      if (!opaque) all.paint[0][2] = etc_transparent;
      for (int k = 0; k < 4; ++k) all.paint[1][k] = all.paint[0][k];
    } else {
      etc_half(etc_colour(e.field(63, 59), e.field(55, 51), e.field(47, 43), 5), e.field(39, 37), opaque, all.paint[0]);
      etc_half(etc_colour(r, g, b, 5), e.field(36, 34), opaque, all.paint[1]);
    }
  }
  for (int k = 0; k < 16; ++k) {
    const int x = k % 4, y = k / 4, n = 4 * x + y;
    out.texel[k] = all.paint[(by_rows ? y : x) / 2][(e.lower >> (15 + n) & 2) | (e.lower >> n & 1)];
  }
}

}  // namespace detail

constexpr void decode_etc2_rgb8(const uint8_t* p, texel_block& out) { detail::decode_etc(p, false, out); }
constexpr void decode_etc2_rgb8a1(const uint8_t* p, texel_block& out) { detail::decode_etc(p, true, out); }

constexpr void decode_etc2_rgba8(const uint8_t* p, texel_block& out) {
  detail::decode_etc(p + 8, false, out);
  const int base = p[0], multiplier = p[1] >> 4;
  const int8_t(&modifier)[8] = eac_modifiers[p[1] & 15];
  for (int half = 0; half < 2; ++half) {
    const uint8_t* const q = p + 2 + 3 * half;
    const uint32_t numbers = uint32_t(q[0]) << 16 | uint32_t(q[1]) << 8 | q[2];
    for (int n = 0; n < 8; ++n)  // columns 2 half and 2 half + 1
      out.texel[4 * (n % 4) + 2 * half + n / 4].a = detail::byte_of(base + multiplier * modifier[numbers >> (21 - 3 * n) & 7]);
  }
}

}  // namespace spantex
