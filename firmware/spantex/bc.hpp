// SPDX-License-Identifier: Apache-2.0
// BC1, BC2, BC3 (S3TC DXT1, DXT3, DXT5): decoding, bit for bit as libsquish does. Numbers are little-endian.
//
//   colours, 8 bytes   u16 c0, u16 c1 (565), u32 indices: texel (x, y) has bits 2 (4 y + x) + 1 .. 2 (4 y + x)
//                      565 to 8 bits by repeating the upper bits: r << 3 | r >> 2, g << 2 | g >> 4
//     four colours     c0, c1, (2 c0 + c1) / 3, (c0 + 2 c1) / 3         of the widened channels, quotients rounded down
//     three colours    c0, c1, (c0 + c1) / 2, (0, 0, 0, alpha 0)
//   bc1   colours; three if c0 <= c1 as numbers, else four
//   bc2   8 bytes of alpha: texel (x, y) has 4 bits, a u16 a row, x = 0 lowest, times 17; then colours, always four
//   bc3   u8 a0, u8 a1, 48 bits of indices, 3 a texel, texel 0 lowest; then colours, always four
//           a0 > a1    a0, a1, ((7 - k) a0 + k a1) / 7 for k = 1..6, rounded down
//           a0 <= a1   a0, a1, ((5 - k) a0 + k a1) / 5 for k = 1..4, rounded down, 0, 255
#pragma once
#include <stdint.h>

#include <spantex/texel_block.hpp>

namespace spantex {

// A 565 number as 8-bit channels, alpha 255.
constexpr rgba8 bc_endpoint(uint32_t c) {
  const auto wide = [c](int high, int low) { return uint8_t(detail::repeated(detail::bits_of(c, high, low), high - low + 1)); };
  return {wide(15, 11), wide(10, 5), wide(4, 0), 255};
}

// The colours that the indices 0..3 mean.
constexpr void bc_colours(uint32_t c0, uint32_t c1, bool three_allowed, rgba8 (&colour)[4]) {
  const rgba8 a = bc_endpoint(c0), b = bc_endpoint(c1);
  colour[0] = a;
  colour[1] = b;
  if (three_allowed && c0 <= c1) {
    const auto middle = [](int x, int y) { return uint8_t((x + y) / 2); };
    colour[2] = {middle(a.r, b.r), middle(a.g, b.g), middle(a.b, b.b), 255};
    colour[3] = {0, 0, 0, 0};
    return;
  }
  const auto third = [](int x, int y) { return uint8_t((2 * x + y) / 3); };
  colour[2] = {third(a.r, b.r), third(a.g, b.g), third(a.b, b.b), 255};
  colour[3] = {third(b.r, a.r), third(b.g, a.g), third(b.b, a.b), 255};
}

// The values that the indices 0..7 of bc3 mean.
constexpr void bc3_alphas(int a0, int a1, uint8_t (&alpha)[8]) {
  alpha[0] = uint8_t(a0);
  alpha[1] = uint8_t(a1);
  const int steps = a0 > a1 ? 7 : 5;
  for (int k = 1; k < steps; ++k) alpha[k + 1] = uint8_t(((steps - k) * a0 + k * a1) / steps);
  if (steps == 7) return;
  alpha[6] = 0;
  alpha[7] = 255;
}

namespace detail {

constexpr void decode_bc_colours(const uint8_t* p, bool three_allowed, texel_block& out) {
  rgba8 colour[4]{};
  bc_colours(little_endian_16(p), little_endian_16(p + 2), three_allowed, colour);
  for (int k = 0; k < 16; ++k) out.texel[k] = colour[p[4 + k / 4] >> (2 * (k % 4)) & 3];
}

}  // namespace detail

constexpr void decode_bc1(const uint8_t* p, texel_block& out) { detail::decode_bc_colours(p, true, out); }

constexpr void decode_bc2(const uint8_t* p, texel_block& out) {
  detail::decode_bc_colours(p + 8, false, out);
  for (int k = 0; k < 16; ++k) out.texel[k].a = uint8_t((p[k / 2] >> (4 * (k % 2)) & 15) * 17);
}

constexpr void decode_bc3(const uint8_t* p, texel_block& out) {
  detail::decode_bc_colours(p + 8, false, out);
  uint8_t alpha[8]{};
  bc3_alphas(p[0], p[1], alpha);
  for (int half = 0; half < 2; ++half) {
    const uint8_t* const q = p + 2 + 3 * half;
    uint32_t indices = detail::little_endian_16(q) | uint32_t(q[2]) << 16;
    for (int k = 8 * half; k < 8 * half + 8; ++k, indices >>= 3) out.texel[k].a = alpha[indices & 7];
  }
}

}  // namespace spantex
