// SPDX-License-Identifier: Apache-2.0
// Texel formats in global texture memory. The loader turns every format into four channels of 8 bits; below it there is only one.
//
//   rgba8888    four bytes r g b a
//   rgb565      15      11 10     5 4       0     one 16-bit number in the machine's byte order
//               r r r r r  g g g g g g  b b b b b
//   argb1555    a  r r r r r  g g g g g  b b b b b
//   argb4444    a a a a  r r r r  g g g g  b b b b
//
// n bits become 8 as round(255 x / (2^n - 1)): 0 stays 0, full stays 255. (Repeating the bits, as is often done, is off by one for some
// values of 5 bits.) Packing takes the nearest level. Checked for all 2^16 numbers.
#pragma once
#include <stdint.h>

#include <spantex/span.hpp>

namespace spantex {

enum class texel_format : uint8_t { rgba8888, rgb565, argb1555, argb4444 };

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
  const uint32_t most = (1u << n) - 1;
  return (2 * x * most + 255) / 510;
}

}  // namespace detail

constexpr rgba8 unpack(texel_format format, uint16_t raw) {
  const auto field = [raw](int shift, int n) { return detail::widened((uint32_t(raw) >> shift) & ((1u << n) - 1), n); };
  switch (format) {
    case texel_format::rgb565: return {field(11, 5), field(5, 6), field(0, 5), 255};
    case texel_format::argb1555: return {field(10, 5), field(5, 5), field(0, 5), field(15, 1)};
    case texel_format::argb4444: return {field(8, 4), field(4, 4), field(0, 4), field(12, 4)};
    case texel_format::rgba8888: break;
  }
  return {};
}

// The nearest colour of a 16-bit format; rgb565 drops alpha.
constexpr uint16_t pack(texel_format format, rgba8 c) {
  const auto field = [](uint8_t x, int n, int shift) { return detail::narrowed_colour(x, n) << shift; };
  switch (format) {
    case texel_format::rgb565: return uint16_t(field(c.r, 5, 11) | field(c.g, 6, 5) | field(c.b, 5, 0));
    case texel_format::argb1555: return uint16_t(field(c.a, 1, 15) | field(c.r, 5, 10) | field(c.g, 5, 5) | field(c.b, 5, 0));
    case texel_format::argb4444: return uint16_t(field(c.a, 4, 12) | field(c.r, 4, 8) | field(c.g, 4, 4) | field(c.b, 4, 0));
    case texel_format::rgba8888: break;
  }
  return 0;
}

}  // namespace spantex
