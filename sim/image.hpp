// SPDX-License-Identifier: Apache-2.0
// Pictures: RGBA8888 in memory, PNG (libpng) and what stb_image reads else from disk, PNG to disk.
#pragma once
#include <stdint.h>

#include <string>
#include <vector>

#include <spantex/span.hpp>
#include "file.hpp"

namespace spantex::sim {

inline constexpr int max_picture_side = 4096;

struct image {
  int width_px = 0, height_px = 0;
  std::vector<rgba8> pixels;  // rows from the top

  image() = default;
  image(int width, int height, rgba8 fill) : width_px(width), height_px(height), pixels(size_t(width) * size_t(height), fill) {}
  rgba8& at(int x, int y) { return pixels[size_t(y) * size_t(width_px) + size_t(x)]; }
  const rgba8& at(int x, int y) const { return pixels[size_t(y) * size_t(width_px) + size_t(x)]; }
};

// Gray, gray with alpha and RGB become RGBA; 16-bit and HDR pictures 8-bit as stb_image does it; PNG of 16 bits is cut to 8, its gamma left alone.
// Throw input_error: missing, not a picture, truncated, damaged (PNG), a side above 4096. `name` is for the message.
image load_image(const std::string& path);
image decode_image(const uint8_t* data, size_t size, const std::string& name);

bytes encode_png(const image& picture);

}  // namespace spantex::sim
