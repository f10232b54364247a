// SPDX-License-Identifier: Apache-2.0
// The decoder of each compressed format. A map carries a pointer to its own, so a program links only those of the formats that it names;
// one that opens texture packs (pack.hpp) links all.
#pragma once
#include <spantex/bc.hpp>
#include <spantex/etc.hpp>

namespace spantex {

// Null for uncompressed formats.
constexpr block_decoder decoder_of(texel_format f) {
  switch (f) {
    case texel_format::bc1: return decode_bc1;
    case texel_format::bc2: return decode_bc2;
    case texel_format::bc3: return decode_bc3;
    case texel_format::etc1: case texel_format::etc2_rgb8: return decode_etc2_rgb8;
    case texel_format::etc2_rgba8: return decode_etc2_rgba8;
    case texel_format::etc2_rgb8a1: return decode_etc2_rgb8a1;
    default: return nullptr;
  }
}

}  // namespace spantex
