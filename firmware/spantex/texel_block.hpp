// SPDX-License-Identifier: Apache-2.0
// A decoded 4x4 block of a compressed format, and what its decoders share. Every string of bytes is a valid block.
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>
#include <spantex/texel.hpp>

namespace spantex {

struct texel_block {
  rgba8 texel[block_side * block_side];  // rows from the top
};

// Decodes block_bytes(format) bytes.
using block_decoder = void (*)(const uint8_t* bytes, texel_block& out);

namespace detail {

constexpr uint32_t big_endian_32(const uint8_t* p) { return uint32_t(p[0]) << 24 | uint32_t(p[1]) << 16 | uint32_t(p[2]) << 8 | p[3]; }
constexpr uint32_t little_endian_16(const uint8_t* p) { return uint32_t(p[1]) << 8 | p[0]; }

// Bits high..low of x.
constexpr int32_t bits_of(uint32_t x, int high, int low) { return int32_t((x >> low) & ((1u << (high - low + 1)) - 1)); }

constexpr uint8_t byte_of(int32_t x) { return uint8_t(clamp_to(x, 0, 255)); }

// 4 to 7 bits to 8 by repeating the upper ones.
constexpr int32_t repeated(int32_t x, int bits) { return x << (8 - bits) | x >> (2 * bits - 8); }

}  // namespace detail

}  // namespace spantex
