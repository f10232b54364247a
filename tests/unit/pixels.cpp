// SPDX-License-Identifier: Apache-2.0
// Pixel formats of frame buffers: every RGB565 colour into every format against the formulas of docs/SPEC.md "Pixels" in rational arithmetic, every
// blend, the dither matrix, and that nothing beside a run is touched.
#include <tests/support.hpp>

#include <algorithm>

#include <spantex/pixels.hpp>

using namespace spantex;
using namespace spantex::sim;

static constexpr pixel_format formats[] = {pixel_format::rgb565, pixel_format::rgb565_swapped, pixel_format::rgb888, pixel_format::bgr888, pixel_format::rgba8888,
                                           pixel_format::bgra8888, pixel_format::grey8, pixel_format::grey4, pixel_format::mono1, pixel_format::mono1_pages};
static_assert(std::size(formats) == pixel_format_count);

// --- the formulas, by other means ------------------------------------------------------------------------

// x / y to nearest, halves up; of what cannot be a half too.
static int nearest(int64_t x, int64_t y) { return int((2 * x + y) / (2 * y)); }

struct colour { int r, g, b; };
static colour bytes_of(uint16_t c) { return {nearest((c >> 11) * 255, 31), nearest((c >> 5 & 63) * 255, 63), nearest((c & 31) * 255, 31)}; }
static int grey_of(colour c) { return nearest(77 * c.r + 150 * c.g + 29 * c.b, 256); }
static int blend(int s, int d, int alpha) { return nearest(s * alpha + d * (255 - alpha), 255); }

// Bayer's matrix by its recursion: M of 2n is 4 M of n, plus 0 2 / 3 1 for the quarter.
static int bayer(int x, int y, int n = 8) {
  if (n == 1) return 0;
  const int half = n / 2, quarter[2][2] = {{0, 2}, {3, 1}};
  return 4 * bayer(x % half, y % half, half) + quarter[y / half][x / half];
}
static bool is_white(int grey, int x, int y) { return 128 * grey > 255 * (2 * bayer(x % 8, y % 8) + 1); }

// What a pixel in memory says, as numbers, and what the SPEC wants there.
struct numbers {
  int n[4] = {};
  bool operator==(const numbers&) const = default;
};

static numbers read(pixel_format f, const pixel_memory& m, int x, int y) {
  const int i = x - m.held.x0, j = y - m.held.y0;
  const uint8_t* const row = m.bytes + (f == pixel_format::mono1_pages ? j / 8 : j) * m.stride_bytes;
  const auto number = [&](bool upper_first) { return upper_first ? row[2 * i] << 8 | row[2 * i + 1] : row[2 * i + 1] << 8 | row[2 * i]; };
  constexpr bool big = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__;
  switch (f) {
    case pixel_format::rgb565: return {{number(big)}};
    case pixel_format::rgb565_swapped: return {{number(!big)}};
    case pixel_format::rgb888: return {{row[3 * i], row[3 * i + 1], row[3 * i + 2]}};
    case pixel_format::bgr888: return {{row[3 * i + 2], row[3 * i + 1], row[3 * i]}};
    case pixel_format::rgba8888: return {{row[4 * i], row[4 * i + 1], row[4 * i + 2], row[4 * i + 3]}};
    case pixel_format::bgra8888: return {{row[4 * i + 2], row[4 * i + 1], row[4 * i], row[4 * i + 3]}};
    case pixel_format::grey8: return {{row[i]}};
    case pixel_format::grey4: return {{i % 2 == 0 ? row[i / 2] >> 4 : row[i / 2] & 15}};
    case pixel_format::mono1: return {{row[i / 8] >> (7 - i % 8) & 1}};
    case pixel_format::mono1_pages: return {{row[i] >> j % 8 & 1}};
  }
  return {};
}

static numbers expected(pixel_format f, uint16_t s, const numbers& d, int alpha, int x, int y) {
  const colour c = bytes_of(s);
  switch (f) {
    case pixel_format::rgb565: case pixel_format::rgb565_swapped:
      return {{blend(s >> 11, d.n[0] >> 11, alpha) << 11 | blend(s >> 5 & 63, d.n[0] >> 5 & 63, alpha) << 5 | blend(s & 31, d.n[0] & 31, alpha)}};
    case pixel_format::rgb888: case pixel_format::bgr888: return {{blend(c.r, d.n[0], alpha), blend(c.g, d.n[1], alpha), blend(c.b, d.n[2], alpha)}};
    case pixel_format::rgba8888: case pixel_format::bgra8888:
      return {{blend(c.r, d.n[0], alpha), blend(c.g, d.n[1], alpha), blend(c.b, d.n[2], alpha), blend(255, d.n[3], alpha)}};
    case pixel_format::grey8: return {{blend(grey_of(c), d.n[0], alpha)}};
    case pixel_format::grey4: return {{nearest(blend(grey_of(c), 17 * d.n[0], alpha), 17)}};
    case pixel_format::mono1: case pixel_format::mono1_pages: return {{int(is_white(blend(grey_of(c), 255 * d.n[0], alpha), x, y))}};
  }
  return {};
}

// --- cases -----------------------------------------------------------------------------------------------

alignas(2) static uint8_t memory[16384], before[16384];

SPANTEX_CASE(every_colour_in_every_format) {
  const pixel_memory m{memory, 64, {0, 0, 16, 8}};
  for (pixel_format f : formats)
    for (int c = 0; c < 65536; ++c) {
      const uint16_t code = uint16_t(c);
      const int x = c % 16, y = c / 16 % 8;
      write_run(f, m, x, y, &code, 1);
      assert_true(read(f, m, x, y) == expected(f, code, {}, 255, x, y));
    }
}

// Every alpha and every pair of values of a channel, all channels of a pixel at once with values of their own.
SPANTEX_CASE(every_blend_of_every_pair_of_values) {
  const pixel_memory m{memory, 64, {0, 0, 16, 8}};
  const int step = short_run() ? 51 : 1;
  for (pixel_format f : formats) {
    if (f == pixel_format::bgr888 || f == pixel_format::bgra8888) continue;  // channels are told apart by the case above
    const bool narrow = f == pixel_format::rgb565 || f == pixel_format::rgb565_swapped;
    const int there = narrow ? 64 : f == pixel_format::grey4 ? 16 : pixel_bits(f) == 1 ? 2 : 256;
    for (int alpha = 0; alpha < 256; alpha += step)
      for (int s = 0; s < 64; ++s)
        for (int d = 0; d < there; ++d) {
          const uint16_t code = uint16_t((s & 31) << 11 | s << 5 | (31 - (s & 31)));
          const int x = (s + d) % 16, y = (s * 5 + d) / 3 % 8, i = x;
          const uint16_t both = uint16_t((31 - (d & 31)) << 11 | d << 5 | (d & 31));
          uint8_t* const p = memory + (f == pixel_format::mono1_pages ? 0 : 64 * y) + (f == pixel_format::mono1_pages ? i : i * pixel_bits(f) / 8);
          if (narrow) __builtin_memcpy(p, &both, 2);
          else for (int k = 0; k < (pixel_bits(f) + 7) / 8; ++k) p[k] = uint8_t(pixel_bits(f) == 1 ? 255 * d : pixel_bits(f) == 4 ? 17 * d : d);
          const numbers old = read(f, m, x, y);
          write_run(f, m, x, y, &code, 1, {uint8_t(alpha), -1});
          const numbers now = read(f, m, x, y);
          if (now == expected(f, code, old, alpha, x, y) && (alpha > 0 || now == old)) continue;
          fail_msg("format %d: %d over %d by %d gives %d", int(f), s, d, alpha, now.n[0]);
        }
  }
}

SPANTEX_CASE(dithering_turns_the_right_share_of_pixels_white) {
  const pixel_memory m{memory, 1, {0, 0, 8, 8}};
  bool used[64] = {};
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) {
      assert_int_equal(int(spantex::detail::bayer.m[y][x]), bayer(x, y));
      used[bayer(x, y)] = true;
    }
  for (bool u : used) assert_true(u);
  for (pixel_format f : {pixel_format::mono1, pixel_format::mono1_pages})
    for (int grey = 0; grey < 256; ++grey) {
      const rgba8 c{uint8_t(grey), uint8_t(grey), uint8_t(grey), 255};
      int count = 0;
      for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x) {
          write_run(f, m, x, y, &c, 1);
          count += read(f, m, x, y).n[0];
        }
      assert_int_equal(count, nearest(64 * grey, 255));
    }
}

SPANTEX_CASE(colours_of_the_engine_keep_their_bytes) {
  const pixel_memory m{memory, 64, {0, 0, 16, 8}};
  random_source random(1);
  for (int n = 0; n < 20000; ++n) {
    const rgba8 c{uint8_t(random.next()), uint8_t(random.next()), uint8_t(random.next()), uint8_t(random.next())};
    const auto written = [&](pixel_format f) {
      write_run(f, m, 3, 2, &c, 1);
      return read(f, m, 3, 2);
    };
    assert_true((written(pixel_format::rgba8888) == numbers{{c.r, c.g, c.b, c.a}}));
    assert_true((written(pixel_format::bgr888) == numbers{{c.r, c.g, c.b}}));
    assert_true((written(pixel_format::rgb565) == numbers{{nearest(c.r * 31, 255) << 11 | nearest(c.g * 63, 255) << 5 | nearest(c.b * 31, 255)}}));
    assert_true((written(pixel_format::grey4) == numbers{{nearest(grey_of({c.r, c.g, c.b}), 17)}}));
  }
}

SPANTEX_CASE(a_run_touches_its_own_pixels_only_and_the_key_none) {
  random_source random(2);
  for (int n = 0; n < (short_run() ? 400 : 4000); ++n) {
    const pixel_format f = formats[n % pixel_format_count];
    const rectangle held{8 * int32_t(random.between(0, 3)), 8 * int32_t(random.between(0, 3)), int32_t(random.between(40, 60)), int32_t(random.between(33, 40))};
    const int32_t stride = pixel_row_bytes(f, held.x1 - held.x0) + 2 * int32_t(random.between(0, 4));
    const pixel_memory m{memory + 16, (stride + 1) / 2 * 2, held};
    SPANTEX_ASSERT_OK(check(f, m));
    for (uint8_t& b : memory) b = uint8_t(random.next());
    std::copy(std::begin(memory), std::end(memory), before);
    const pixel_memory old{before + 16, m.stride_bytes, held};
    const int32_t y = int32_t(random.between(held.y0, held.y1 - 1)), x0 = int32_t(random.between(held.x0, held.x1 - 1)), x1 = int32_t(random.between(x0, held.x1));
    uint16_t from[64];
    for (uint16_t& c : from) c = random.next() % 4 == 0 ? 0xF81F : uint16_t(random.next());
    const blending mix{uint8_t(n % 2 == 0 ? 255 : random.next()), n % 3 == 0 ? 0xF81F : -1};
    write_run(f, m, x0, y, from, x1 - x0, mix);
    for (int32_t py = held.y0; py < held.y1; ++py)
      for (int32_t px = held.x0; px < held.x1; ++px) {
        const numbers was = read(f, old, px, py);
        const bool written = py == y && px >= x0 && px < x1 && from[px - x0] != mix.key;
        assert_true(read(f, m, px, py) == (written ? expected(f, from[px - x0], was, mix.alpha, px, py) : was));
      }
    // Bytes beside the held rows.
    const int32_t rows = f == pixel_format::mono1_pages ? (held.y1 - held.y0 + 7) / 8 : held.y1 - held.y0;
    for (int k = 0; k < 16; ++k) assert_int_equal(memory[k], before[k]);
    for (int k = 16 + rows * m.stride_bytes; k < int(sizeof memory); ++k) assert_int_equal(memory[k], before[k]);
    for (int32_t j = 0; j < rows; ++j)
      for (int32_t k = pixel_row_bytes(f, held.x1 - held.x0); k < m.stride_bytes; ++k) assert_int_equal(m.bytes[j * m.stride_bytes + k], old.bytes[j * m.stride_bytes + k]);
  }
}

SPANTEX_CASE(memory_that_cannot_hold_its_pixels_is_refused) {
  const rectangle held{0, 0, 33, 9};
  SPANTEX_ASSERT_STATUS(check(pixel_format::grey8, {nullptr, 33, held}), bad_pointer);
  SPANTEX_ASSERT_STATUS(check(pixel_format(10), {memory, 33, held}), out_of_range);
  SPANTEX_ASSERT_STATUS(check(pixel_format::grey8, {memory, 33, {0, 0, 0, 9}}), bad_size);
  SPANTEX_ASSERT_STATUS(check(pixel_format::grey8, {memory, 5000, {0, 0, 4097, 9}}), bad_size);
  SPANTEX_ASSERT_STATUS(check(pixel_format::grey8, {memory, 33, {-1, 0, 30, 9}}), bad_size);
  struct { pixel_format f; int32_t bytes; } rows[] = {{pixel_format::rgb565, 66}, {pixel_format::rgb565_swapped, 66}, {pixel_format::rgb888, 99}, {pixel_format::rgba8888, 132},
                                                      {pixel_format::grey8, 33}, {pixel_format::grey4, 17}, {pixel_format::mono1, 5}, {pixel_format::mono1_pages, 33}};
  for (auto r : rows) {
    assert_int_equal(pixel_row_bytes(r.f, 33), r.bytes);
    assert_int_equal(pixel_bytes(r.f, 33, 9), r.bytes * (r.f == pixel_format::mono1_pages ? 2 : 9));
    SPANTEX_ASSERT_OK(check(r.f, {memory, r.bytes, held}));
    SPANTEX_ASSERT_STATUS(check(r.f, {memory, r.bytes - 1, held}), bad_size);
  }
  SPANTEX_ASSERT_STATUS(check(pixel_format::rgb565, {memory + 1, 66, held}), bad_alignment);
  SPANTEX_ASSERT_STATUS(check(pixel_format::rgb565, {memory, 67, held}), bad_alignment);
  SPANTEX_ASSERT_OK(check(pixel_format::rgb565_swapped, {memory + 1, 67, held}));
  SPANTEX_ASSERT_STATUS(check(pixel_format::grey4, {memory, 64, {1, 0, 33, 9}}), bad_alignment);
  SPANTEX_ASSERT_STATUS(check(pixel_format::mono1, {memory, 64, {4, 0, 33, 9}}), bad_alignment);
  SPANTEX_ASSERT_STATUS(check(pixel_format::mono1_pages, {memory, 64, {4, 4, 33, 9}}), bad_alignment);
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(every_colour_in_every_format),
      cmocka_unit_test(every_blend_of_every_pair_of_values),
      cmocka_unit_test(dithering_turns_the_right_share_of_pixels_white),
      cmocka_unit_test(colours_of_the_engine_keep_their_bytes),
      cmocka_unit_test(a_run_touches_its_own_pixels_only_and_the_key_none),
      cmocka_unit_test(memory_that_cannot_hold_its_pixels_is_refused),
  };
  return run_suite("pixels", tests);
}
