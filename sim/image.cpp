// SPDX-License-Identifier: Apache-2.0
#include "image.hpp"

#include <libdeflate.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <memory>
#include <new>

#include "pack.hpp"

namespace {

// stb_image_write's own compressor takes three times as long and leaves a third more. Null: no memory; freed by free().
unsigned char* zlib_stream(const unsigned char* data, int size, int* stream_size, int) {
  constexpr int fastest = 1;
  const std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> compressor(libdeflate_alloc_compressor(fastest), libdeflate_free_compressor);
  if (compressor == nullptr) return nullptr;
  const size_t most = libdeflate_zlib_compress_bound(compressor.get(), size_t(size));
  unsigned char* const stream = static_cast<unsigned char*>(malloc(most));
  if (stream != nullptr) *stream_size = int(libdeflate_zlib_compress(compressor.get(), data, size_t(size), stream, most));
  return stream;
}

}  // namespace

#define STBIW_ZLIB_COMPRESS zlib_stream
#define STBIW_CRC32(data, size) libdeflate_crc32(0, data, size_t(size))
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_NO_PNG
#define STBI_FAILURE_USERMSG
#define STBI_NO_STDIO
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image.h>
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace spantex::sim {
namespace {

// A byte source that notices when a decoder wants more than there is: stb_image fills up with zeros without a word.
struct source {
  const uint8_t* data;
  size_t size, position = 0;
  bool ran_out = false;

  static int read(void* user, char* out, int count) {
    source& s = *static_cast<source*>(user);
    const size_t n = size_t(count) < s.size - s.position ? size_t(count) : s.size - s.position;
    memcpy(out, s.data + s.position, n);
    s.position += n;
    // The decoder's own buffer is filled 128 bytes at a time, so only that size may come back short.
    constexpr int buffer_size = 128;
    if (n == 0 || (n < size_t(count) && count != buffer_size)) s.ran_out = true;
    return int(n);
  }
  static void skip(void* user, int count) {
    source& s = *static_cast<source*>(user);
    if (count > 0 && size_t(count) > s.size - s.position) s.ran_out = true;
    s.position = count > 0 ? (s.ran_out ? s.size : s.position + size_t(count)) : s.position - size_t(-count);
  }
  static int eof(void* user) {
    const source& s = *static_cast<source*>(user);
    return s.position >= s.size;
  }
};

constexpr stbi_io_callbacks callbacks{source::read, source::skip, source::eof};

std::string one_line(const char* text) {
  std::string s = text != nullptr ? text : "unknown reason";
  for (char& c : s)
    if (c == '\n' || c == '\r') c = ' ';
  return s;
}

void check_size(int width, int height, const std::string& name) {
  if (width >= 1 && height >= 1 && width <= max_picture_side && height <= max_picture_side) return;
  throw input_error(name + ": picture is " + std::to_string(width) + "x" + std::to_string(height) + ", at most " +
                    std::to_string(max_picture_side) + "x" + std::to_string(max_picture_side) + " is supported");
}

// PNG by libpng: stb_image takes what its checksums say is damaged, and streams that grow without end.
struct png_source {
  const uint8_t* data;
  size_t size;
  char why[100];

  static void read(png_structp png, png_bytep out, size_t count) {
    png_source& s = *static_cast<png_source*>(png_get_io_ptr(png));
    if (count > s.size) png_error(png, truncated);
    memcpy(out, s.data, count);
    s.data += count;
    s.size -= count;
  }
  [[noreturn]] static void fail(png_structp png, png_const_charp message) {
    png_source& s = *static_cast<png_source*>(png_get_error_ptr(png));
    snprintf(s.why, sizeof s.why, "%s", message);
    png_longjmp(png, 1);
  }
  static void ignore(png_structp, png_const_charp) {}  // warnings: of what is no texel
  static constexpr char truncated[] = "truncated";
};

// False: source.why. No object of its own: libpng leaves by longjmp. Indices beyond the palette are opaque black.
bool read_png(png_structp png, png_infop info, png_source& source, const std::string& name, image& picture) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_set_read_fn(png, &source, png_source::read);
  png_set_crc_action(png, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
  png_read_info(png, info);
  check_size(int(png_get_image_width(png, info)), int(png_get_image_height(png, info)), name);
  png_set_expand(png);
  png_set_strip_16(png);
  png_set_gray_to_rgb(png);
  png_set_add_alpha(png, 255, PNG_FILLER_AFTER);
  const int passes = png_set_interlace_handling(png);
  png_read_update_info(png, info);
  picture = image(int(png_get_image_width(png, info)), int(png_get_image_height(png, info)), {});
  for (int pass = 0; pass < passes; ++pass)
    for (int y = 0; y < picture.height_px; ++y) png_read_row(png, reinterpret_cast<png_bytep>(&picture.at(0, y)), nullptr);
  png_read_end(png, nullptr);
  return true;
}

image decode_png(const uint8_t* data, size_t size, const std::string& name) {
  struct reading {
    png_structp png;
    png_infop info;
    ~reading() { png_destroy_read_struct(&png, &info, nullptr); }
  };
  png_source source{data, size, {}};
  reading r{png_create_read_struct(PNG_LIBPNG_VER_STRING, &source, png_source::fail, png_source::ignore), nullptr};
  if (r.png != nullptr) r.info = png_create_info_struct(r.png);
  image picture;
  if (r.info == nullptr) throw std::bad_alloc();
  if (read_png(r.png, r.info, source, name, picture)) return picture;
  throw input_error(name + (strcmp(source.why, png_source::truncated) == 0 ? ": picture is truncated" : ": cannot decode picture: " + one_line(source.why)));
}

void append(void* user, void* data, int size) {
  bytes& out = *static_cast<bytes*>(user);
  const uint8_t* p = static_cast<const uint8_t*>(data);
  out.insert(out.end(), p, p + size);
}

}  // namespace

image decode_image(const uint8_t* data, size_t size, const std::string& name) {
  constexpr size_t signature_bytes = 8;
  if (size == 0) throw input_error(name + ": not a picture: file is empty");
  if (size >= signature_bytes && png_sig_cmp(data, 0, signature_bytes) == 0) return decode_png(data, size, name);
  if (is_pack(data, size)) throw input_error(name + ": a texture pack; here a picture is needed");
  int width = 0, height = 0, channels = 0;
  source header{data, size};
  if (stbi_info_from_callbacks(&callbacks, &header, &width, &height, &channels) != 0) check_size(width, height, name);
  source body{data, size};
  const std::unique_ptr<stbi_uc, void (*)(void*)> texels(
      stbi_load_from_callbacks(&callbacks, &body, &width, &height, &channels, channel_count), stbi_image_free);
  const bool known_header = width >= 1 && height >= 1;
  if (known_header && body.ran_out) throw input_error(name + ": picture is truncated");
  if (texels == nullptr) throw input_error(name + ": cannot decode picture: " + one_line(stbi_failure_reason()));
  check_size(width, height, name);
  image picture(width, height, {});
  memcpy(picture.pixels.data(), texels.get(), picture.pixels.size() * sizeof(rgba8));
  return picture;
}

image load_image(const std::string& path) {
  const bytes data = read_file(path);
  return decode_image(data.data(), data.size(), path);
}

bytes encode_png(const image& picture) {
  bytes out;
  const int stride = picture.width_px * int(sizeof(rgba8));
  if (stbi_write_png_to_func(append, &out, picture.width_px, picture.height_px, channel_count, picture.pixels.data(), stride) == 0)
    throw input_error("picture: cannot encode as PNG");
  return out;
}

}  // namespace spantex::sim
