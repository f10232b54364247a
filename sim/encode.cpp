// SPDX-License-Identifier: Apache-2.0
#include "encode.hpp"

#include <string.h>

#include <algorithm>
#include <string>

#include <spantex/texture.hpp>

namespace spantex::sim {
namespace {

texel_block block_at(const image& level, int bx, int by) {
  texel_block b;
  for (int k = 0; k < 16; ++k)
    b.texel[k] = level.at(std::min(4 * bx + k % 4, level.width_px - 1), std::min(4 * by + k / 4, level.height_px - 1));
  return b;
}

void encode_block_row(texel_format format, const image& level, int by, uint8_t* row) {
  for (int bx = 0; bx < blocks_across(level.width_px); ++bx, row += block_bytes(format)) encode_block(format, block_at(level, bx, by), row);
}

void encode_texel(texel_format format, rgba8 c, const palette& colours, uint8_t* row, int x) {
  if (is_16_bit(format)) {
    const uint16_t number = pack(format, c);
    memcpy(row + 2 * x, &number, sizeof number);
  } else if (palette_size(format) != 0) {
    const int index = nearest_colour(colours.data(), int(colours.size()), c);
    if (format == texel_format::palette8) row[x] = uint8_t(index);
    else row[x / 2] = uint8_t(row[x / 2] | index << (x % 2 == 0 ? 4 : 0));
  } else {
    pack(format, c, row + x * (texel_bits(format) / 8));
  }
}

}  // namespace

void encode_block(texel_format format, const texel_block& block, uint8_t* out) {
  const bool is_bc = format == texel_format::bc1 || format == texel_format::bc2 || format == texel_format::bc3;
  if (is_bc) detail::encode_bc_block(format, block, out);
  else detail::encode_etc_block(format, block, out);
}

bytes encode_level(texel_format format, const image& level, const palette& colours, int threads, const progress_callback& parts_done) {
  if (palette_size(format) != 0 && (colours.empty() || int(colours.size()) > palette_size(format)))
    throw input_error("palette has " + std::to_string(colours.size()) + " colours, not 1.." + std::to_string(palette_size(format)));
  bytes out(level_bytes(format, level.width_px, level.height_px), 0);
  const size_t row = row_bytes(format, level.width_px);
  for_each_index(blocks_across(level.height_px), threads, [&](int part) {
    if (is_compressed(format)) {
      encode_block_row(format, level, part, out.data() + size_t(part) * row);
    } else {
      for (int y = block_side * part; y < std::min(block_side * (part + 1), level.height_px); ++y)
        for (int x = 0; x < level.width_px; ++x) encode_texel(format, level.at(x, y), colours, out.data() + size_t(y) * row, x);
    }
    if (parts_done) parts_done(1);
  });
  return out;
}

image decode_level(texel_format format, const bytes& level, int width, int height, const palette& colours) {
  const void* const levels[] = {level.data()};
  texture_view t;
  const rgba8* const first = colours.empty() ? nullptr : colours.data();
  const status s = texture_view::make(format, levels, 1, width, height, wrap::repeat, wrap::repeat, t, first, int(colours.size()));
  if (s != status::ok) throw input_error(std::string("level: ") + to_string(s));
  if (level.size() < level_bytes(format, width, height)) throw input_error("level: too few bytes");
  image out(width, height, {});
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) out.at(x, y) = t.texel(0, x, y);
  return out;
}

}  // namespace spantex::sim
