// SPDX-License-Identifier: Apache-2.0
// Every texel format: sizes, what a map view refuses, the loader's words, pictures, packing, palettes.
#include <cstring>
#include <set>

#include <spantex/block_codec.hpp>
#include <tests/formats.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

constexpr texel_format byte_formats[] = {texel_format::rgba8888, texel_format::rgb888, texel_format::l8, texel_format::la88, texel_format::a8};

alignas(8) uint8_t storage[4096 * 4 * 8];

status make_one(texel_format f, const void* level, int32_t w, int32_t h, const rgba8* palette, int count, texture_view& t) {
  return texture_view::make(f, &level, 1, w, h, wrap::repeat, wrap::repeat, t, palette, count);
}

}  // namespace

SPANTEX_CASE(levels_have_the_documented_bytes) {
  struct sizes { texel_format format; uint32_t of_1x1, of_5x3, of_4x4, of_4096x4096; };
  constexpr uint32_t m = 1u << 20;
  constexpr sizes all[] = {
      {texel_format::rgba8888, 4, 60, 64, 64 * m}, {texel_format::rgb888, 3, 45, 48, 48 * m},  {texel_format::rgb565, 2, 30, 32, 32 * m},
      {texel_format::argb1555, 2, 30, 32, 32 * m}, {texel_format::argb4444, 2, 30, 32, 32 * m}, {texel_format::l8, 1, 15, 16, 16 * m},
      {texel_format::la88, 2, 30, 32, 32 * m},     {texel_format::a8, 1, 15, 16, 16 * m},       {texel_format::palette8, 1, 15, 16, 16 * m},
      {texel_format::palette4, 1, 9, 8, 8 * m},    {texel_format::bc1, 8, 16, 8, 8 * m},        {texel_format::bc2, 16, 32, 16, 16 * m},
      {texel_format::bc3, 16, 32, 16, 16 * m},     {texel_format::etc1, 8, 16, 8, 8 * m},       {texel_format::etc2_rgb8, 8, 16, 8, 8 * m},
      {texel_format::etc2_rgba8, 16, 32, 16, 16 * m}, {texel_format::etc2_rgb8a1, 8, 16, 8, 8 * m}};
  static_assert(sizeof all / sizeof all[0] == texel_format_count);
  for (const sizes& s : all) {
    assert_int_equal(level_bytes(s.format, 1, 1), s.of_1x1);
    assert_int_equal(level_bytes(s.format, 5, 3), s.of_5x3);
    assert_int_equal(level_bytes(s.format, 4, 4), s.of_4x4);
    assert_int_equal(level_bytes(s.format, 4096, 4096), s.of_4096x4096);
  }
}

SPANTEX_CASE(a_view_of_any_format_is_validated) {
  const rgba8 colours[256] = {};
  for (const texel_format f : all_formats) {
    texture_view t;
    const int most = palette_size(f);
    SPANTEX_ASSERT_OK(make_one(f, storage, 16, 8, colours, most, t));
    assert_true(t.format() == f && t.width() == 16 && t.height() == 8);
    SPANTEX_ASSERT_STATUS(make_one(f, nullptr, 16, 8, colours, most, t), bad_pointer);
    SPANTEX_ASSERT_STATUS(make_one(f, storage, 0, 8, colours, most, t), bad_size);
    SPANTEX_ASSERT_STATUS(make_one(f, storage, 16, 4097, colours, most, t), bad_size);
    const void* levels[14];
    for (const void*& level : levels) level = storage;
    SPANTEX_ASSERT_STATUS(texture_view::make(f, levels, 6, 16, 8, wrap::clamp, wrap::clamp, t, colours, most), bad_levels);
    const status at_odd_address = make_one(f, storage + 1, 16, 8, colours, most, t);
    assert_int_equal(int(at_odd_address), int(is_16_bit(f) ? status::bad_alignment : status::ok));
    if (most == 0) {
      SPANTEX_ASSERT_OK(make_one(f, storage, 16, 8, nullptr, 0, t));
      continue;
    }
    SPANTEX_ASSERT_STATUS(make_one(f, storage, 16, 8, nullptr, most, t), bad_pointer);
    SPANTEX_ASSERT_STATUS(make_one(f, storage, 16, 8, colours, 0, t), out_of_range);
    SPANTEX_ASSERT_STATUS(make_one(f, storage, 16, 8, colours, most + 1, t), out_of_range);
    SPANTEX_ASSERT_OK(make_one(f, storage, 16, 8, colours, 1, t));
  }
  texture_view t;
  SPANTEX_ASSERT_STATUS(make_one(texel_format(texel_format_count), storage, 16, 8, nullptr, 0, t), out_of_range);
  const uint16_t numbers[1] = {};
  const uint16_t* levels[] = {numbers};
  for (const texel_format f : all_formats)
    assert_int_equal(int(texture_view::make(f, levels, 1, 1, 1, wrap::repeat, wrap::repeat, t)),
                     int(is_16_bit(f) ? status::ok : status::out_of_range));
}

SPANTEX_CASE(views_that_differ_in_format_or_palette_are_not_the_same) {
  const rgba8 colours[32] = {};
  texture_view a, b;
  SPANTEX_ASSERT_OK(make_one(texel_format::l8, storage, 16, 8, nullptr, 0, a));
  SPANTEX_ASSERT_OK(make_one(texel_format::a8, storage, 16, 8, nullptr, 0, b));
  assert_false(a.id(0) == b.id(0));
  SPANTEX_ASSERT_OK(make_one(texel_format::palette4, storage, 16, 8, colours, 16, a));
  SPANTEX_ASSERT_OK(make_one(texel_format::palette4, storage, 16, 8, colours + 16, 16, b));
  assert_false(a.id(0) == b.id(0));
}

SPANTEX_CASE(every_byte_of_every_format_of_bytes_means_what_is_documented) {
  for (int x = 0; x < 256; ++x)
    for (int a = 0; a < 256; ++a) {
      const uint8_t p[4] = {uint8_t(x), uint8_t(a), uint8_t(x ^ 85), uint8_t(a ^ 170)};
      assert_true((unpack(texel_format::rgba8888, p) == rgba8{p[0], p[1], p[2], p[3]}));
      assert_true((unpack(texel_format::rgb888, p) == rgba8{p[0], p[1], p[2], 255}));
      assert_true((unpack(texel_format::l8, p) == rgba8{p[0], p[0], p[0], 255}));
      assert_true((unpack(texel_format::la88, p) == rgba8{p[0], p[0], p[0], p[1]}));
      assert_true((unpack(texel_format::a8, p) == rgba8{0, 0, 0, p[0]}));
      for (const texel_format f : byte_formats) {
        uint8_t q[4] = {p[0], p[1], p[2], p[3]};
        pack(f, unpack(f, p), q);
        assert_memory_equal(p, q, 4);
      }
    }
}

// |256 l - (77 r + 150 g + 29 b)| <= 128, for every r, g and some b.
SPANTEX_CASE(luminance_is_the_nearest) {
  for (int r = 0; r < 256; ++r)
    for (int g = 0; g < 256; ++g)
      for (int b = 0; b < 256; b += 5) {
        const int l = luminance({uint8_t(r), uint8_t(g), uint8_t(b), 9});
        assert_true(std::abs(256 * l - (77 * r + 150 * g + 29 * b)) <= 128);
      }
}

SPANTEX_CASE(palette4_has_even_texels_in_the_upper_half_and_rows_begin_a_byte) {
  const uint8_t level[4] = {0x12, 0x30, 0x45, 0xF0};  // 3 x 2
  palette colours;
  for (int k = 0; k < 16; ++k) colours.push_back({uint8_t(k), uint8_t(10 * k), uint8_t(15 * k), uint8_t(16 * k)});  // 6 are given
  texture_view t;
  SPANTEX_ASSERT_OK(make_one(texel_format::palette4, level, 3, 2, colours.data(), 6, t));
  constexpr int expected[2][3] = {{1, 2, 3}, {4, 5, 15}};
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 3; ++x) {
      const rgba8 got = t.texel(0, x, y);
      assert_true(expected[y][x] < 6 ? got == colours[size_t(expected[y][x])] : got == rgba8{});  // 15 is beyond the palette
    }
}

namespace {

// What the documentation says of a texel, from the bytes, by other code than the view's.
rgba8 documented(texel_format f, const raw_map& m, int level, int32_t w, int32_t x, int32_t y) {
  const bytes& b = m.levels[size_t(level)];
  const auto indexed = [&](size_t k) { return k < m.colours.size() ? m.colours[k] : rgba8{}; };
  if (is_compressed(f)) {
    texel_block block;
    decoder_of(f)(&b[(size_t(y / 4) * size_t((w + 3) / 4) + size_t(x / 4)) * block_bytes(f)], block);
    return block.texel[y % 4 * 4 + x % 4];
  }
  const size_t n = size_t(y) * size_t(w) + size_t(x);
  if (f == texel_format::palette8) return indexed(b[n]);
  if (f == texel_format::palette4) return indexed(size_t(b[size_t(y) * size_t((w + 1) / 2) + size_t(x / 2)] >> (x % 2 == 0 ? 4 : 0) & 15));
  if (!is_16_bit(f)) return unpack(f, &b[n * size_t(texel_bits(f) / 8)]);
  uint16_t number;
  std::memcpy(&number, &b[2 * n], 2);
  return unpack(f, number);
}

// The same map in RGBA8888.
const synthetic_map& twin_of(texel_format f, const raw_map& m, int32_t width, int32_t height) {
  static std::deque<synthetic_map> kept;
  synthetic_map& twin = kept.emplace_back();
  for (size_t k = 0; k < m.levels.size(); ++k) {
    level_pixels level{level_side(width, int(k)), level_side(height, int(k)), {}};
    for (int32_t y = 0; y < level.height; ++y)
      for (int32_t x = 0; x < level.width; ++x) level.texels.push_back(documented(f, m, int(k), level.width, x, y));
    twin.levels.push_back(level);
  }
  return twin;
}

struct words { int first[64], count[64], calls; uint64_t word[512]; };

words loaded(const texture_view& t, const section& at, const texel_box& box, bool coarse) {
  words w{};
  int n = 0;
  SPANTEX_ASSERT_OK(load_section(fixed_profile<profiles::exact>{}, t, at, box, coarse, [&](int first, const uint64_t* word, int count) {
    w.first[w.calls] = first;
    w.count[w.calls++] = count;
    for (int k = 0; k < count; ++k) w.word[n++] = word[k];
    return status::ok;
  }));
  return w;
}

constexpr struct { int32_t width, height; } odd_sizes[] = {{48, 40}, {37, 23}, {5, 3}, {2, 9}, {1, 1}};

}  // namespace

// Any bytes, any section (ends that share a word, wraps, levels of a few texels): the words are those of the decoded map. This is
// the fuzz test as well: under the sanitizers nothing may be read that is not there.
SPANTEX_CASE(the_loader_sends_the_words_of_the_decoded_map) {
  random_source random(17);
  for (const texel_format f : all_formats)
    for (const auto& size : odd_sizes)
      for (const wrap mode : all_wraps) {
        const raw_map& m = random_map(f, size.width, size.height, mode, wrap::mirror, random.next());
        const texture_view twin = twin_of(f, m, size.width, size.height).view(mode, wrap::mirror);
        for (int n = 0; n < 40; ++n) {
          const bool coarse = n % 2 != 0;
          const int side = coarse ? 16 : 32;
          const auto [at, box] = random_section(random, m.view, side);
          const words a = loaded(m.view, at, box, coarse), b = loaded(twin, at, box, coarse);
          assert_memory_equal(&a, &b, sizeof a);
        }
      }
}

SPANTEX_CASE(every_texel_of_a_view_is_the_documented_one) {
  for (const texel_format f : all_formats)
    for (const auto& size : odd_sizes) {
      const raw_map& m = random_map(f, size.width, size.height, wrap::repeat, wrap::clamp, uint64_t(size.width));
      for (int level = 0; level < m.view.level_count(); ++level)
        for (int32_t y = 0; y < m.view.height(level); ++y)
          for (int32_t x = 0; x < m.view.width(level); ++x)
            assert_true(m.view.texel(level, x, y) == documented(f, m, level, m.view.width(level), x, y));
    }
}

namespace {

picture from_format, from_twin;

template <profile P>
void draws_what_its_twin_draws(texel_format f, const raw_map& m, const synthetic_map& twin, filter kind, wrap u, wrap v) {
  const plane p = sample_plane(1, {0, 0, 96, 64});
  from_format.reset(96, 64);
  from_twin.reset(96, 64);
  SPANTEX_ASSERT_OK(render_plane_direct<P.fine_side>(fixed_profile<P>{}, p, m.view, kind, from_format));
  SPANTEX_ASSERT_OK(render_plane_direct<P.fine_side>(fixed_profile<P>{}, p, twin.view(u, v), kind, from_twin));
  if (!(from_format == from_twin)) fail_msg("format %d, filter %d", int(f), int(kind));
}

}  // namespace

SPANTEX_CASE(pictures_equal_those_of_the_decoded_map) {
  for (const texel_format f : all_formats) {
    const raw_map& m = random_map(f, 45, 38, wrap::mirror, wrap::repeat, 5);
    const synthetic_map& twin = twin_of(f, m, 45, 38);
    for (const filter kind : all_filters) {
      draws_what_its_twin_draws<profiles::seed>(f, m, twin, kind, wrap::mirror, wrap::repeat);
      draws_what_its_twin_draws<profiles::compact>(f, m, twin, kind, wrap::mirror, wrap::repeat);
      draws_what_its_twin_draws<profiles::standard>(f, m, twin, kind, wrap::mirror, wrap::repeat);
      draws_what_its_twin_draws<profiles::exact>(f, m, twin, kind, wrap::mirror, wrap::repeat);
    }
  }
}

namespace {

struct counting_view : texture_view {
  mutable int decoded = 0;
  void decode_block(int level, int32_t bx, int32_t by, texel_block& out) const {
    ++decoded;
    texture_view::decode_block(level, bx, by, out);
  }
};

}  // namespace

// Two rows of texels make a row of the section. At an even origin both lie in one row of blocks; at an odd one the section's two ends
// share a word, so the last block is decoded at both ends, and the first and last rows of texels share a row, which is alone in the worst case.
SPANTEX_CASE(a_block_is_decoded_once_for_a_row_of_a_section) {
  counting_view t;
  static_cast<texture_view&>(t) = random_map(texel_format::bc1, 64, 64, wrap::repeat, wrap::repeat, 9).view;
  int total = 0;
  for (int32_t v = 0; v < 8; ++v)
    for (int32_t u = 0; u < 8; ++u) {
      section at{};
      at.origin_u = u;
      at.origin_v = v;
      const texel_box box{u, v, u + 15, v + 15};
      run_time_profile prof{profiles::exact};
      prof.value.fine_side = 16;
      t.decoded = 0;
      SPANTEX_ASSERT_OK(load_section(prof, t, at, box, false, [](int, const uint64_t*, int) { return status::ok; }));
      total += t.decoded;
      const int columns = (u + 15) / 4 - u / 4 + 1;
      if (u % 2 == 0 && v % 2 == 0) assert_int_equal(t.decoded, 8 * columns);
      else assert_in_range(t.decoded, 8 * columns, 8 * (columns + 1) + (v % 2 == 0 ? 0 : 2 * columns + 2));
    }
  print_message("%.2f decodes a section\n", total / 64.0);
  assert_true(total <= 46 * 64);
}

SPANTEX_CASE(encoded_uncompressed_levels_hold_the_nearest_colours) {
  static const image picture = [] {
    image out(23, 17, {});
    random_source random(8);
    for (rgba8& c : out.pixels) random_bytes(random, &c.r, 4);
    return out;
  }();
  for (const texel_format f : all_formats) {
    if (is_compressed(f)) continue;
    const palette colours = palette_size(f) == 0 ? palette{} : make_palette(picture, palette_size(f));
    const image decoded = decode_level(f, encode_level(f, picture, colours), 23, 17, colours);
    for (size_t k = 0; k < picture.pixels.size(); ++k) {
      const rgba8 c = picture.pixels[k];
      uint8_t packed[4] = {};
      if (!is_16_bit(f) && palette_size(f) == 0) pack(f, c, packed);
      const rgba8 expected = is_16_bit(f) ? unpack(f, pack(f, c))
                             : palette_size(f) != 0 ? colours[size_t(nearest_colour(colours.data(), int(colours.size()), c))]
                                                    : unpack(f, packed);
      assert_true(decoded.pixels[k] == expected);
    }
  }
}

SPANTEX_CASE(a_picture_of_few_colours_keeps_them) {
  static image picture(64, 64, {});
  for (int most : {1, 2, 5, 16, 200, 256}) {
    for (size_t k = 0; k < picture.pixels.size(); ++k) {
      const uint32_t n = uint32_t(k * k) % uint32_t(most);
      picture.pixels[k] = {uint8_t(n), uint8_t(7 * n), uint8_t(255 - n), uint8_t(n * n)};
    }
    std::set<uint32_t> distinct;
    for (const rgba8& c : picture.pixels) distinct.insert(uint32_t(c.r) << 24 | uint32_t(c.g) << 16 | uint32_t(c.b) << 8 | c.a);
    const texel_format f = most <= 16 ? texel_format::palette4 : texel_format::palette8;
    const palette colours = make_palette(picture, palette_size(f));
    assert_int_equal(colours.size(), distinct.size());
    assert_true(decode_level(f, encode_level(f, picture, colours), 64, 64, colours).pixels == picture.pixels);
  }
}

SPANTEX_CASE(palettes_of_photographs_are_good) {
  const image& picture = photograph("astronaut.png");
  for (const auto& [f, least_db] : {std::pair{texel_format::palette8, 36.0}, {texel_format::palette4, 26.0}}) {
    const palette colours = make_palette(picture, palette_size(f));
    assert_true(int(colours.size()) <= palette_size(f));
    const double db = psnr_rgb_db(picture, decode_level(f, encode_level(f, picture, colours), picture.width_px, picture.height_px, colours));
    print_message("palette of %d: %.2f dB\n", palette_size(f), db);
    assert_true(db > least_db);
  }
}

SPANTEX_CASE(levels_that_end_inside_a_block_are_encoded_as_well) {
  static image picture;
  picture = image(7, 5, {200, 100, 50, 255});
  for (const texel_format f : all_formats) {
    if (!is_compressed(f)) continue;
    const image decoded = decode_level(f, encode_level(f, picture), 7, 5);
    for (const rgba8& c : decoded.pixels) assert_true(std::abs(c.r - 200) <= 4 && std::abs(c.g - 100) <= 4 && std::abs(c.b - 50) <= 4 && c.a == 255);
  }
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(levels_have_the_documented_bytes),
      cmocka_unit_test(a_view_of_any_format_is_validated),
      cmocka_unit_test(views_that_differ_in_format_or_palette_are_not_the_same),
      cmocka_unit_test(every_byte_of_every_format_of_bytes_means_what_is_documented),
      cmocka_unit_test(luminance_is_the_nearest),
      cmocka_unit_test(palette4_has_even_texels_in_the_upper_half_and_rows_begin_a_byte),
      cmocka_unit_test(the_loader_sends_the_words_of_the_decoded_map),
      cmocka_unit_test(every_texel_of_a_view_is_the_documented_one),
      cmocka_unit_test(pictures_equal_those_of_the_decoded_map),
      cmocka_unit_test(a_block_is_decoded_once_for_a_row_of_a_section),
      cmocka_unit_test(encoded_uncompressed_levels_hold_the_nearest_colours),
      cmocka_unit_test(a_picture_of_few_colours_keeps_them),
      cmocka_unit_test(palettes_of_photographs_are_good),
      cmocka_unit_test(levels_that_end_inside_a_block_are_encoded_as_well),
  };
  return run_suite("formats", tests);
}
