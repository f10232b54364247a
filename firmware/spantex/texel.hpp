// SPDX-License-Identifier: Apache-2.0
// Texel formats in global texture memory. The loader turns every format into four channels of 8 bits; below it there is only one.
//
//   format       bytes of a row            bits of a texel or block, and what it becomes                              alignment of a level
//   rgba8888     4 w                       four bytes r g b a                                                         1
//   rgb888       3 w                       three bytes r g b; alpha 255                                               1
//   rgb565       2 w                       15      11 10     5 4       0   one 16-bit number in the machine's order   2
//                                          r r r r r  g g g g g g  b b b b b; alpha 255
//   argb1555     2 w                       a  r r r r r  g g g g g  b b b b b                                         2
//   argb4444     2 w                       a a a a  r r r r  g g g g  b b b b                                         2
//   l8           w                         one byte l; (l, l, l, 255)                                                 1
//   la88         2 w                       two bytes l a; (l, l, l, a)                                                1
//   a8           w                         one byte a; (0, 0, 0, a)                                                   1
//   palette8     w                         one byte: index of a palette of 1..256 colours r g b a                     1
//   palette4     ceil(w / 2)               4 bits: index of 1..16 colours; even x in the upper half of the byte,      1
//                                          every row begins a byte
//   bc1, etc1,   8 ceil(w / 4) a row       blocks of 4x4 texels, 8 bytes (bc.hpp, etc.hpp)                            1
//   etc2_rgb8, etc2_rgb8a1    of blocks
//   bc2, bc3,    16 ceil(w / 4)            blocks of 4x4 texels, 16 bytes                                             1
//   etc2_rgba8
//
// n bits become 8 as round(255 x / (2^n - 1)): 0 stays 0, full stays 255. (Repeating the bits, as the compressed formats prescribe, is off
// by one for some values of 5 bits.) Packing takes the nearest level. An index beyond the palette is (0, 0, 0, 0).
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>
#include <spantex/span.hpp>

namespace spantex {

enum class texel_format : uint8_t {
  rgba8888, rgb565, argb1555, argb4444, rgb888, l8, la88, a8, palette8, palette4, bc1, bc2, bc3, etc1, etc2_rgb8, etc2_rgba8, etc2_rgb8a1
};
inline constexpr int texel_format_count = 17;

constexpr bool is_compressed(texel_format f) { return f >= texel_format::bc1; }
constexpr bool is_16_bit(texel_format f) {
  return f == texel_format::rgb565 || f == texel_format::argb1555 || f == texel_format::argb4444;
}

// Whether alpha can be other than 255.
constexpr bool has_alpha(texel_format f) {
  switch (f) {
    case texel_format::rgb565: case texel_format::rgb888: case texel_format::l8: return false;
    case texel_format::etc1: case texel_format::etc2_rgb8: return false;
    default: return true;
  }
}

// Colours that a format's indices reach: 0 for formats without a palette.
constexpr int palette_size(texel_format f) { return f == texel_format::palette8 ? 256 : f == texel_format::palette4 ? 16 : 0; }

// Of uncompressed formats; 0 for blocks.
constexpr int texel_bits(texel_format f) {
  switch (f) {
    case texel_format::rgba8888: return 32;
    case texel_format::rgb888: return 24;
    case texel_format::rgb565: case texel_format::argb1555: case texel_format::argb4444: case texel_format::la88: return 16;
    case texel_format::l8: case texel_format::a8: case texel_format::palette8: return 8;
    case texel_format::palette4: return 4;
    default: return 0;
  }
}

inline constexpr int block_side = 4;  // of compressed formats, texels
constexpr uint32_t block_bytes(texel_format f) {
  return f == texel_format::bc2 || f == texel_format::bc3 || f == texel_format::etc2_rgba8 ? 16 : 8;
}
constexpr int32_t blocks_across(int32_t texels) { return (texels + block_side - 1) / block_side; }

// Bytes of one row of texels, or of blocks. w in 1..4096.
constexpr uint32_t row_bytes(texel_format f, int32_t w) {
  return is_compressed(f) ? uint32_t(blocks_across(w)) * block_bytes(f) : (uint32_t(w) * uint32_t(texel_bits(f)) + 7) / 8;
}

// Bytes of one level; w, h in 1..4096.
constexpr uint32_t level_bytes(texel_format f, int32_t w, int32_t h) {
  return row_bytes(f, w) * uint32_t(is_compressed(f) ? blocks_across(h) : h);
}

namespace detail {

// n bits to 8, to nearest, n = 1, 4, 5, 6: 255 / 31 and 255 / 63 as a product and a shift that give the same for every x.
constexpr uint8_t widened(uint32_t x, int n) {
  switch (n) {
    case 5: return uint8_t((x * 527 + 23) >> 6);
    case 6: return uint8_t((x * 259 + 33) >> 6);
    case 4: return uint8_t(x * 17);
    default: return uint8_t(x * 255);
  }
}

// 8 bits to n, to nearest (halves cannot occur: 255 is odd).
constexpr uint32_t narrowed_colour(uint8_t x, int n) {
  return over_255(x * ((1u << n) - 1));
}

constexpr int32_t squared_difference(int32_t a, int32_t b) { return (a - b) * (a - b); }

}  // namespace detail

// The formats of 16-bit numbers.
constexpr rgba8 unpack(texel_format format, uint16_t raw) {
  const auto field = [raw](int shift, int n) { return detail::widened((uint32_t(raw) >> shift) & ((1u << n) - 1), n); };
  switch (format) {
    case texel_format::rgb565: return {field(11, 5), field(5, 6), field(0, 5), 255};
    case texel_format::argb1555: return {field(10, 5), field(5, 5), field(0, 5), field(15, 1)};
    case texel_format::argb4444: return {field(8, 4), field(4, 4), field(0, 4), field(12, 4)};
    default: return {};
  }
}

// The nearest colour of a 16-bit format; rgb565 drops alpha.
constexpr uint16_t pack(texel_format format, rgba8 c) {
  const auto field = [](uint8_t x, int n, int shift) { return detail::narrowed_colour(x, n) << shift; };
  switch (format) {
    case texel_format::rgb565: return uint16_t(field(c.r, 5, 11) | field(c.g, 6, 5) | field(c.b, 5, 0));
    case texel_format::argb1555: return uint16_t(field(c.a, 1, 15) | field(c.r, 5, 10) | field(c.g, 5, 5) | field(c.b, 5, 0));
    case texel_format::argb4444: return uint16_t(field(c.a, 4, 12) | field(c.r, 4, 8) | field(c.g, 4, 4) | field(c.b, 4, 0));
    default: return 0;
  }
}

// The formats of whole bytes: rgba8888, rgb888, l8, la88, a8.
constexpr rgba8 unpack(texel_format format, const uint8_t* p) {
  switch (format) {
    case texel_format::rgba8888: return {p[0], p[1], p[2], p[3]};
    case texel_format::rgb888: return {p[0], p[1], p[2], 255};
    case texel_format::l8: return {p[0], p[0], p[0], 255};
    case texel_format::la88: return {p[0], p[0], p[0], p[1]};
    case texel_format::a8: return {0, 0, 0, p[0]};
    default: return {};
  }
}

// BT.601 luma in 256ths, to nearest: 77 + 150 + 29 = 256, so grey stays what it is.
constexpr uint8_t luminance(rgba8 c) { return uint8_t((77 * c.r + 150 * c.g + 29 * c.b + 128) >> 8); }

// What unpacks nearest; l8, la88 keep the luminance, a8 alpha alone. Writes texel_bits / 8 bytes.
constexpr void pack(texel_format format, rgba8 c, uint8_t* p) {
  switch (format) {
    case texel_format::rgba8888: p[3] = c.a; [[fallthrough]];
    case texel_format::rgb888: p[0] = c.r; p[1] = c.g; p[2] = c.b; break;
    case texel_format::la88: p[1] = c.a; [[fallthrough]];
    case texel_format::l8: p[0] = luminance(c); break;
    case texel_format::a8: p[0] = c.a; break;
    default: break;
  }
}

// The index of texel x in a row of palette4.
constexpr uint8_t nibble(const uint8_t* row, int32_t x) { return uint8_t(row[x >> 1] >> (x & 1 ? 0 : 4) & 15); }

// The palette's colour nearest in the sum of squares over r, g, b, a; the first of equals. count >= 1.
constexpr int nearest_colour(const rgba8* palette, int count, rgba8 c) {
  int best = 0;
  int32_t least = INT32_MAX;
  for (int k = 0; k < count; ++k) {
    const rgba8& p = palette[k];
    const int32_t d = detail::squared_difference(p.r, c.r) + detail::squared_difference(p.g, c.g) +
                      detail::squared_difference(p.b, c.b) + detail::squared_difference(p.a, c.a);
    if (d < least) { least = d; best = k; }
  }
  return best;
}

}  // namespace spantex
