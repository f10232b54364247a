// SPDX-License-Identifier: Apache-2.0
// Pixels of the frame buffers that displays have: formats, memory that holds a part of the screen, and writing runs of a row into it, blended over what
// is there (docs/SPEC.md "Pixels"). Colours come as RGB565 (rows) or RGBA8888 (the engine's frames).
//
//   format            bytes of a row     bits of a pixel, and what they are
//   rgb565            2 w                one 16-bit number in the machine's order: r 15..11, g 10..5, b 4..0
//   rgb565_swapped    2 w                the same in the other order: most displays on SPI, sent by a little-endian machine
//   rgb888, bgr888    3 w                bytes r g b; b g r
//   rgba8888, bgra8888  4 w              bytes r g b a; b g r a: alpha 255 from RGB565
//   grey8             w                  one byte, BT.601 luma in 256ths: (77 r + 150 g + 29 b + 128) >> 8
//   grey4             ceil(w / 2)        round(grey / 17), the even x in the upper half of its byte
//   mono1             ceil(w / 8)        1 is white; x of least number in the highest bit. Ordered dithering
//   mono1_pages       w                  eight rows a row of bytes, the topmost in the lowest bit (SSD1306). The same dithering
//
// 5 and 6 bits become 8 to nearest, and 8 bits 5 and 6, as in texel.hpp. Dithering: Bayer's 8 x 8 matrix m on the screen, not on the memory: white where
// 128 grey > 255 (2 m[y % 8][x % 8] + 1), so that round(64 grey / 255) pixels of 64 are.
#pragma once
#include <stdint.h>

#include <spantex/bits.hpp>
#include <spantex/plane.hpp>
#include <spantex/status.hpp>
#include <spantex/texel.hpp>

namespace spantex {

enum class pixel_format : uint8_t { rgb565, rgb565_swapped, rgb888, bgr888, rgba8888, bgra8888, grey8, grey4, mono1, mono1_pages };
inline constexpr int pixel_format_count = 10;

constexpr int pixel_bits(pixel_format f) {
  switch (f) {
    case pixel_format::rgb565: case pixel_format::rgb565_swapped: return 16;
    case pixel_format::rgb888: case pixel_format::bgr888: return 24;
    case pixel_format::rgba8888: case pixel_format::bgra8888: return 32;
    case pixel_format::grey8: return 8;
    case pixel_format::grey4: return 4;
    default: return 1;
  }
}

// Rows of pixels that share a row of bytes.
constexpr int32_t rows_together(pixel_format f) { return f == pixel_format::mono1_pages ? 8 : 1; }

// Bytes of a row of `width` pixels, and of `height` such rows without gaps.
constexpr int32_t pixel_row_bytes(pixel_format f, int32_t width) { return f == pixel_format::mono1_pages ? width : (width * pixel_bits(f) + 7) / 8; }
constexpr int32_t pixel_bytes(pixel_format f, int32_t width, int32_t height) {
  return pixel_row_bytes(f, width) * ((height + rows_together(f) - 1) / rows_together(f));
}

// Memory that holds the pixels `held` of the screen, all of them (a frame), some rows (a strip) or a tile: held.x0, held.y0 lie at `bytes`. Caller's.
struct pixel_memory {
  uint8_t* bytes;
  int32_t stride_bytes;  // from one row of bytes to the next
  rectangle held;
};

// Errors: bad_pointer; bad_size (nothing held, off the screen, a stride below a row's bytes); bad_alignment (16-bit pixels at an odd address or stride; held.x0
// of grey4 odd, of mono1 not a multiple of 8; held.y0 of mono1_pages not one); out_of_range (unknown format).
constexpr status check(pixel_format f, const pixel_memory& m) {
  if (int(f) >= pixel_format_count) return status::out_of_range;
  if (m.bytes == nullptr) return status::bad_pointer;
  if (!on_screen(m.held) || m.stride_bytes < pixel_row_bytes(f, m.held.x1 - m.held.x0)) return status::bad_size;
  const bool odd = f == pixel_format::rgb565 && ((reinterpret_cast<uintptr_t>(m.bytes) | uintptr_t(m.stride_bytes)) & 1) != 0;
  const int32_t step = f == pixel_format::grey4 ? 2 : f == pixel_format::mono1 ? 8 : 1;
  return odd || m.held.x0 % step != 0 || m.held.y0 % rows_together(f) != 0 ? status::bad_alignment : status::ok;
}

// How a pixel s is written over d, which is there: left out where it is the key colour; else round((s alpha + d (255 - alpha)) / 255) in every channel, on the
// codes of RGB565 (5-6-5 bits) and on bytes of the others; grey4 and mono1 mix 8 bits of grey, d being 17 or 255 times its code, and then cut or dither.
struct blending {
  uint8_t alpha = 255;
  int32_t key = -1;  // RGB565, of pixels that come as RGB565: of use with filter nearest, others mix it with its neighbours. -1: none
  constexpr bool stores() const { return alpha == 255 && key < 0; }
};

namespace detail {

struct bayer_matrix {
  uint8_t m[8][8];
  constexpr bayer_matrix() : m() {
    for (int y = 0; y < 8; ++y)
      for (int x = 0; x < 8; ++x)
        for (int k = 0; k < 3; ++k) m[y][x] = uint8_t(m[y][x] | ((x ^ y) >> k & 1) << (5 - 2 * k) | (y >> k & 1) << (4 - 2 * k));
  }
};
inline constexpr bayer_matrix bayer{};

constexpr uint32_t mixed(uint32_t s, uint32_t d, uint32_t alpha) { return over_255(s * alpha + d * (255 - alpha)); }

constexpr uint16_t code_of(uint16_t c) { return c; }
constexpr uint16_t code_of(rgba8 c) { return pack(texel_format::rgb565, c); }
constexpr rgba8 colour_of(uint16_t c) { return unpack(texel_format::rgb565, c); }
constexpr rgba8 colour_of(rgba8 c) { return c; }
constexpr bool is_key(uint16_t c, int32_t key) { return c == key; }
constexpr bool is_key(rgba8, int32_t) { return false; }

constexpr uint16_t swapped(uint16_t x) { return uint16_t(x << 8 | x >> 8); }
constexpr uint16_t mixed_codes(uint16_t s, uint16_t d, uint32_t alpha) {
  return uint16_t(mixed(s >> 11, d >> 11, alpha) << 11 | mixed(s >> 5 & 63, d >> 5 & 63, alpha) << 5 | mixed(s & 31, d & 31, alpha));
}

// A pixel's place: `row` its row of bytes, i its column there; x, y on the screen; bit 0..7 of mono1_pages.
struct pixel_place { uint8_t* row; int32_t i, x, y; int bit; };

constexpr bool dithered(uint32_t grey, const pixel_place& at) { return 128 * grey > 255u * (2u * bayer.m[at.y & 7][at.x & 7] + 1); }

template <pixel_format F, class Colour>
[[gnu::always_inline]] constexpr void write_pixel(const pixel_place& at, Colour c, uint32_t alpha) {
  using number = uint16_t __attribute__((__may_alias__));
  const auto over = [alpha](uint8_t& d, uint32_t s) { d = uint8_t(alpha == 255 ? s : mixed(s, d, alpha)); };
  if constexpr (F == pixel_format::rgb565 || F == pixel_format::rgb565_swapped) {
    constexpr bool native = F == pixel_format::rgb565, upper_first = (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__) == native;
    uint16_t code = code_of(c);
    if constexpr (native) {
      number& d = reinterpret_cast<number*>(at.row)[at.i];
      d = alpha == 255 ? code : mixed_codes(code, d, alpha);
    } else {  // bytes: no alignment is asked for
      uint8_t* const p = at.row + 2 * at.i;
      if (alpha != 255) code = mixed_codes(code, uint16_t(upper_first ? p[0] << 8 | p[1] : p[1] << 8 | p[0]), alpha);
      p[upper_first ? 0 : 1] = uint8_t(code >> 8);
      p[upper_first ? 1 : 0] = uint8_t(code);
    }
  } else {
    const rgba8 s = colour_of(c);
    if constexpr (F == pixel_format::rgb888 || F == pixel_format::bgr888 || F == pixel_format::rgba8888 || F == pixel_format::bgra8888) {
      constexpr int size = pixel_bits(F) / 8, red = F == pixel_format::rgb888 || F == pixel_format::rgba8888 ? 0 : 2;
      uint8_t* const p = at.row + size * at.i;
      over(p[red], s.r);
      over(p[1], s.g);
      over(p[2 - red], s.b);
      if constexpr (size == 4) over(p[3], s.a);
    } else {
      const uint32_t grey = luminance(s);
      if constexpr (F == pixel_format::grey8) {
        over(at.row[at.i], grey);
      } else if constexpr (F == pixel_format::grey4) {
        uint8_t& p = at.row[at.i >> 1];
        const int shift = (at.i & 1) != 0 ? 0 : 4;
        const uint32_t g = alpha == 255 ? grey : mixed(grey, (uint32_t(p) >> shift & 15) * 17, alpha);
        p = uint8_t((uint32_t(p) & ~(15u << shift)) | narrowed_colour(uint8_t(g), 4) << shift);
      } else {
        constexpr bool pages = F == pixel_format::mono1_pages;
        uint8_t& p = at.row[pages ? at.i : at.i >> 3];
        const int bit = pages ? at.bit : 7 - (at.i & 7);
        const uint32_t g = alpha == 255 ? grey : mixed(grey, (uint32_t(p) >> bit & 1) * 255, alpha);
        p = uint8_t((uint32_t(p) & ~(1u << bit)) | uint32_t(dithered(g, at)) << bit);
      }
    }
  }
}

template <pixel_format F, class Colour>
inline void write_run_as(const pixel_memory& m, int32_t x, int32_t y, const Colour* from, int count, const blending& mix) {
  const int32_t j = y - m.held.y0, together = rows_together(F);
  pixel_place at{m.bytes + j / together * m.stride_bytes, x - m.held.x0, x, y, int(j % together)};
#ifndef __OPTIMIZE_SIZE__  // a loop that neither blends nor looks for a key
  if (mix.stores()) {
    for (; count > 0; --count, ++from, ++at.i, ++at.x) write_pixel<F>(at, *from, 255);
    return;
  }
#endif
  for (; count > 0; --count, ++from, ++at.i, ++at.x)
    if (!is_key(*from, mix.key)) write_pixel<F>(at, *from, mix.alpha);
}

}  // namespace detail

// `count` pixels of row y from x on, all of them held. `from`: uint16_t (RGB565) or rgba8. With a format known to the compiler only its code is linked.
template <class Colour>
[[gnu::always_inline]] inline void write_run(pixel_format f, const pixel_memory& m, int32_t x, int32_t y, const Colour* from, int count, const blending& mix = {}) {
  switch (f) {
    case pixel_format::rgb565: return detail::write_run_as<pixel_format::rgb565>(m, x, y, from, count, mix);
    case pixel_format::rgb565_swapped: return detail::write_run_as<pixel_format::rgb565_swapped>(m, x, y, from, count, mix);
    case pixel_format::rgb888: return detail::write_run_as<pixel_format::rgb888>(m, x, y, from, count, mix);
    case pixel_format::bgr888: return detail::write_run_as<pixel_format::bgr888>(m, x, y, from, count, mix);
    case pixel_format::rgba8888: return detail::write_run_as<pixel_format::rgba8888>(m, x, y, from, count, mix);
    case pixel_format::bgra8888: return detail::write_run_as<pixel_format::bgra8888>(m, x, y, from, count, mix);
    case pixel_format::grey8: return detail::write_run_as<pixel_format::grey8>(m, x, y, from, count, mix);
    case pixel_format::grey4: return detail::write_run_as<pixel_format::grey4>(m, x, y, from, count, mix);
    case pixel_format::mono1: return detail::write_run_as<pixel_format::mono1>(m, x, y, from, count, mix);
    case pixel_format::mono1_pages: return detail::write_run_as<pixel_format::mono1_pages>(m, x, y, from, count, mix);
  }
}

}  // namespace spantex
