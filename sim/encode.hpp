// SPDX-License-Identifier: Apache-2.0
// Encoders: pictures into the texel formats of global texture memory. Integers only, the same bytes on every machine (16-bit formats: the
// same numbers). Uncompressed formats take the nearest level of each channel; the compressed ones are searched for the least sum of squares
// over r, g, b, with no claim to find the best block.
//   bc1..3   principal axis, least squares, then single steps of the end points (encode_bc.cpp)
//   etc1/2   mean of each half, single steps, all tables; ETC2 also planar, T and H (encode_etc.cpp)
//   alpha below 128 is transparent in bc1 and etc2_rgb8a1
// A level that ends inside a block repeats its last row and column there.
#pragma once
#include <stdint.h>

#include <vector>

#include <spantex/texel.hpp>
#include <spantex/texel_block.hpp>
#include "image.hpp"
#include "parallel.hpp"

namespace spantex::sim {

using palette = std::vector<rgba8>;

// At most `most` colours (1..256) for a picture: median cut, then three rounds of k-means. All of them distinct.
palette make_palette(const image& picture, int most);

// level_bytes(format, width, height) bytes. A palette is needed by formats with indices; 1..palette_size(format) colours.
// Every block_side rows are one part of the progress. Throws input_error: a palette of another size.
bytes encode_level(texel_format format, const image& level, const palette& colours = {}, int threads = 1,
                   const progress_callback& parts_done = {});

// One block, block_bytes(format) bytes.
void encode_block(texel_format format, const texel_block& block, uint8_t* out);

// What the formats decode to. For a level of encode_level, or of anybody.
image decode_level(texel_format format, const bytes& level, int width, int height, const palette& colours = {});

namespace detail {
void encode_bc_block(texel_format format, const texel_block& block, uint8_t* out);
void encode_etc_block(texel_format format, const texel_block& block, uint8_t* out);

inline int64_t colour_error(rgba8 a, rgba8 b) {
  const int64_t r = a.r - b.r, g = a.g - b.g, blue = a.b - b.b;
  return r * r + g * g + blue * blue;
}
}  // namespace detail

}  // namespace spantex::sim
