// SPDX-License-Identifier: Apache-2.0
// rgb565_to_png IN WIDTH HEIGHT OUT: a file of RGB565 numbers, little-endian, as a PNG.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>

#include <spantex/texel.hpp>

int main(int count, char** arguments) {
  if (count != 5) return std::fprintf(stderr, "rgb565_to_png IN WIDTH HEIGHT OUT\n"), 2;
  const int width = std::atoi(arguments[2]), height = std::atoi(arguments[3]);
  std::FILE* const in = std::fopen(arguments[1], "rb");
  std::vector<uint8_t> bytes(size_t(width) * size_t(height) * 2);
  const bool read = in != nullptr && std::fread(bytes.data(), 1, bytes.size(), in) == bytes.size();
  if (in != nullptr) std::fclose(in);
  if (!read) return std::fprintf(stderr, "%s: not a picture of %d x %d\n", arguments[1], width, height), 2;
  std::vector<uint8_t> rgb;
  for (size_t k = 0; k < bytes.size(); k += 2) {
    const spantex::rgba8 c = spantex::unpack(spantex::texel_format::rgb565, uint16_t(bytes[k] | bytes[k + 1] << 8));
    rgb.insert(rgb.end(), {c.r, c.g, c.b});
  }
  return stbi_write_png(arguments[4], width, height, 3, rgb.data(), width * 3) != 0 ? 0 : 2;
}
