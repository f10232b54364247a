// SPDX-License-Identifier: Apache-2.0
// Texture packs: what is read is what was compiled; every kind of damage has its status; every cut and every flipped bit is refused; nothing
// beyond the given size is read (make sanitize: the buffers are exactly as long as said).
#include <atomic>
#include <cstring>
#include <memory>

#include <sim/map.hpp>
#include <sim/pack.hpp>
#include <tests/formats.hpp>  // last: cmocka.h defines fail as a macro

namespace {

using namespace spantex;
using namespace spantex::sim;
namespace pf = spantex::pack_format;

constexpr prefilter all_prefilters[] = {prefilter::box, prefilter::triangle, prefilter::kaiser, prefilter::lanczos};

const image& noise(int width, int height) {
  static image out;
  static random_source random(31);
  out = image(width, height, {});
  for (rgba8& c : out.pixels) c = {uint8_t(random.next()), uint8_t(random.next()), uint8_t(random.next()), uint8_t(random.next())};
  return out;
}

const bytes& compiled(const image& picture, const compile_options& o) {
  static bytes pack;
  pack = compile_pack(picture, o);
  return pack;
}

const bytes& small_pack(texel_format format = texel_format::argb4444) {
  compile_options o;
  o.format = format;
  return compiled(noise(5, 3), o);
}

// A copy that ends where its bytes end, at a multiple of 16 as malloc gives it.
struct exact_copy {
  uint8_t* data;
  explicit exact_copy(const uint8_t* from, size_t size) : data(static_cast<uint8_t*>(std::malloc(size == 0 ? 1 : size))) {
    if (size != 0) std::memcpy(data, from, size);
  }
  ~exact_copy() { std::free(data); }
};

status opened(const bytes& pack, texture_pack& out, payload_check check = payload_check::crc) {
  const exact_copy copy(pack.data(), pack.size());
  return texture_pack::open(copy.data, pack.size(), out, check);
}

status opened(const bytes& pack) {
  texture_pack ignored;
  return opened(pack, ignored);
}

void put16(bytes& b, size_t at, uint32_t x) {
  b[at] = uint8_t(x);
  b[at + 1] = uint8_t(x >> 8);
}
void put32(bytes& b, size_t at, uint32_t x) {
  put16(b, at, x & 0xFFFF);
  put16(b, at + 2, x >> 16);
}
uint32_t get16(const bytes& b, size_t at) { return b[at] | uint32_t(b[at + 1]) << 8; }

void seal_header(bytes& b) { put32(b, 44, crc32(b.data() + 48, get16(b, 6) - 48, crc32(b.data(), 44))); }

SPANTEX_CASE(the_checksum_is_zlibs) {
  const uint8_t text[] = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  assert_true(crc32(text, 9) == 0xCBF43926u);
  assert_true(crc32(text + 4, 5, crc32(text, 4)) == 0xCBF43926u);
  assert_true(crc32(text, 0) == 0);
}

void check_contents(const image& picture, const compile_options& o) {
  static bytes pack;
  static std::vector<image> levels;
  pack = compile_pack(picture, o);
  levels = compile_levels(picture, o);
  const palette colours = compile_palette(picture, o);
  texture_pack p;
  SPANTEX_ASSERT_OK(texture_pack::open(pack.data(), pack.size(), p));
  const texture_view& t = p.view();
  assert_int_equal(t.level_count(), levels.size());
  assert_int_equal(get16(pack, 26), colours.size());
  assert_true(t.wrap_u() == o.wrap_u && t.wrap_v() == o.wrap_v && t.format() == o.format);
  assert_int_equal(p.alpha_threshold(), o.alpha_threshold);
  assert_true(p.srgb() == o.srgb);
  bool opaque = true, binary = true;
  for (int k = 0; k < t.level_count(); ++k) {
    bool uniform = true;
    assert_int_equal(t.width(k), levels[size_t(k)].width_px);
    assert_int_equal(t.height(k), levels[size_t(k)].height_px);
    const image wanted = decode_level(o.format, encode_level(o.format, levels[size_t(k)], colours), t.width(k), t.height(k), colours);
    for (int32_t y = 0; y < t.height(k); ++y)
      for (int32_t x = 0; x < t.width(k); ++x) {
        const rgba8 got = t.texel(k, x, y);
        assert_true(got == wanted.at(x, y));
        opaque = opaque && got.a == 255;
        binary = binary && (got.a == 255 || got.a == 0);
        uniform = uniform && got == t.texel(k, 0, 0);
      }
    assert_true(p.uniform(k) == uniform);
  }
  assert_true(p.opaque() == opaque && p.binary_alpha() == binary);
}

SPANTEX_CASE(what_is_read_is_what_was_compiled) {
  const int sizes[][2] = {{1, 1}, {2, 1}, {1, 9}, {16, 16}, {37, 20}, {64, 3}};
  for (const auto& s : sizes)
    for (const texel_format format : all_formats)
      for (const prefilter kind : all_prefilters) {
        compile_options o;
        o.format = format;
        o.levels = kind;
        o.wrap_u = wrap::mirror;
        o.wrap_v = wrap::clamp;
        o.inverse = format == texel_format::rgb565;
        o.srgb = format == texel_format::argb1555;
        o.alpha_threshold = has_alpha(format) && kind == prefilter::kaiser ? 77 : 0;
        check_contents(noise(s[0], s[1]), o);
        o.level_count = 1;
        check_contents(image(s[0], s[1], {9, 8, 7, 255}), o);
      }
}

SPANTEX_CASE(a_pack_shows_what_a_map_made_of_the_picture_shows) {
  for (const texel_format format : all_formats) {
    static image picture;
    picture = noise(29, 18);
    compile_options o;
    o.format = format;
    o.levels = prefilter::kaiser;
    o.wrap_v = wrap::clamp;
    static bytes pack;
    pack = compile_pack(picture, o);
    const texture_map map(picture, o.levels, o.wrap_u, o.wrap_v, format), packed(bytes(pack), "m.stx");
    const texture_view &a = packed.view(), &b = map.view();
    assert_int_equal(a.level_count(), b.level_count());
    for (int k = 0; k < b.level_count(); ++k)
      for (int32_t y = 0; y < b.height(k); ++y)
        for (int32_t x = 0; x < b.width(k); ++x) assert_true(a.texel(k, x, y) == b.texel(k, x, y));
  }
}

SPANTEX_CASE(packs_do_not_depend_on_threads_and_tell_their_progress) {
  for (const texel_format format : all_formats) {
    static image picture;
    picture = noise(21, 34);
    compile_options o;
    o.format = format;
    o.inverse = format == texel_format::bc3;
    o.alpha_threshold = has_alpha(format) ? 90 : 0;
    static bytes one;
    one = compile_pack(picture, o);
    std::atomic<int> parts{0};
    o.threads = 3;
    o.parts_done = [&](int n) { parts += n; };
    assert_true(compile_pack(picture, o) == one);
    assert_int_equal(parts.load(), compile_parts(picture, o));
  }
}

status open_compiled(const image& picture, const compile_options& o, texture_pack& p) {
  const bytes& pack = compiled(picture, o);
  return texture_pack::open(pack.data(), pack.size(), p);
}

SPANTEX_CASE(facts_are_true_of_every_level) {
  static image picture;
  picture = image(8, 8, {10, 20, 30, 255});
  texture_pack p;
  SPANTEX_ASSERT_OK(open_compiled(picture, {}, p));
  assert_true(p.opaque() && p.binary_alpha() && p.uniform(0) && p.uniform(3) && !p.alpha_tested());
  picture.at(3, 3) = {10, 20, 30, 0};  // binary on level 0 only
  SPANTEX_ASSERT_OK(open_compiled(picture, {}, p));
  assert_true(!p.opaque() && !p.binary_alpha() && !p.uniform(0) && !p.uniform(1) && p.uniform(3));
  compile_options o;
  o.level_count = 1;
  SPANTEX_ASSERT_OK(open_compiled(picture, o, p));
  assert_true(!p.opaque() && p.binary_alpha());
  o.format = texel_format::rgb565;
  SPANTEX_ASSERT_OK(open_compiled(picture, o, p));
  assert_true(p.opaque() && p.uniform(0));
}

// What a format does to alpha is told, not what the picture had.
SPANTEX_CASE(facts_are_those_of_the_format) {
  struct expectation { texel_format format; uint8_t alpha; bool opaque, binary; };
  for (const expectation& e : {expectation{texel_format::bc1, 130, true, true}, {texel_format::bc1, 120, false, true},
                               {texel_format::etc2_rgb8a1, 120, false, true}, {texel_format::etc2_rgb8, 0, true, true},
                               {texel_format::bc2, 250, true, true}, {texel_format::bc2, 240, false, false},
                               {texel_format::la88, 254, false, false}, {texel_format::a8, 255, true, true}, {texel_format::l8, 0, true, true}}) {
    texture_pack p;
    compile_options o;
    o.format = e.format;
    SPANTEX_ASSERT_OK(open_compiled(image(8, 8, {90, 80, 70, e.alpha}), o, p));
    assert_true(p.opaque() == e.opaque && p.binary_alpha() == e.binary && p.uniform(0));
  }
  for (const texel_format format : all_formats) {
    texture_pack p;
    compile_options o;
    o.format = format;
    SPANTEX_ASSERT_OK(open_compiled(noise(16, 16), o, p));
    assert_true(p.opaque() != has_alpha(format));
  }
  static image picture;  // two colours, one in the format
  picture = image(4, 4, {100, 100, 100, 255});
  picture.at(1, 2) = {101, 100, 100, 255};
  compile_options o;
  for (const texel_format format : {texel_format::rgb888, texel_format::l8, texel_format::rgb565}) {
    texture_pack p;
    o.format = format;
    SPANTEX_ASSERT_OK(open_compiled(picture, o, p));
    assert_true(p.uniform(0) == (format != texel_format::rgb888));
  }
}

SPANTEX_CASE(every_cut_is_refused) {
  for (const texel_format format : all_formats) {
    static bytes pack, cut;
    pack = small_pack(format);
    for (size_t size = 0; size < pack.size(); ++size) {
      cut.assign(pack.begin(), pack.begin() + long(size));
      SPANTEX_ASSERT_STATUS(opened(cut), pack_truncated);
    }
    SPANTEX_ASSERT_OK(opened(pack));
  }
}

SPANTEX_CASE(every_flipped_bit_is_refused) {
  for (const texel_format format : all_formats) {
    static bytes pack;
    pack = small_pack(format);
    for (size_t bit = 0; bit < 8 * pack.size(); ++bit) {
      pack[bit / 8] = uint8_t(pack[bit / 8] ^ 1u << (bit % 8));
      assert_int_not_equal(int(opened(pack)), int(status::ok));
      pack[bit / 8] = uint8_t(pack[bit / 8] ^ 1u << (bit % 8));
    }
    SPANTEX_ASSERT_OK(opened(pack));
  }
}

// Headers of random numbers with a right checksum: never a read beyond the bytes, never a view that does not lie within them.
SPANTEX_CASE(sealed_nonsense_stays_within_its_bytes) {
  random_source random(41);
  static bytes packs[texel_format_count], broken;
  for (const texel_format format : all_formats) packs[size_t(format)] = small_pack(format);
  int refused = 0;
  for (int k = 0; k < 40000; ++k) {
    const bytes& pack = packs[size_t(k % texel_format_count)];
    broken = pack;
    for (int n = int(random.between(1, 3)); n > 0; --n) {
      const size_t at = size_t(random.between(8, int64_t(get16(pack, 6)) - 1));
      broken[at] = uint8_t(random.next());
    }
    seal_header(broken);
    const exact_copy copy(broken.data(), broken.size());
    texture_pack p;
    if (texture_pack::open(copy.data, broken.size(), p, payload_check::none) != status::ok) {
      ++refused;
      continue;
    }
    for (int level = 0; level < p.view().level_count(); ++level) {
      const rgba8 last = p.view().texel(level, p.view().width(level) - 1, p.view().height(level) - 1);
      assert_true(p.view().texel(level, 0, 0).r <= 255 && last.r <= 255);
    }
  }
  assert_in_range(refused, 2000, 39999);
}

SPANTEX_CASE(each_kind_of_damage_has_its_status) {
  struct damage { const char* what; status expected; void (*apply)(bytes&); };
  static constexpr damage kinds[] = {
      {"magic", status::pack_not_a_pack, [](bytes& b) { b[0] = 'P'; }},
      {"version", status::pack_bad_version, [](bytes& b) { put16(b, 4, 2); seal_header(b); }},
      {"header checksum", status::pack_bad_header, [](bytes& b) { b[16] ^= 1; }},
      {"header bytes", status::pack_bad_header, [](bytes& b) { put16(b, 6, get16(b, 6) + 8); }},
      {"too many levels", status::pack_bad_header, [](bytes& b) { b[13] = 200; seal_header(b); }},
      {"format", status::pack_bad_field, [](bytes& b) { b[12] = 250; seal_header(b); }},
      {"wrap u", status::pack_bad_field, [](bytes& b) { b[14] = 3; seal_header(b); }},
      {"wrap v", status::pack_bad_field, [](bytes& b) { b[15] = 3; seal_header(b); }},
      {"flags", status::pack_bad_field, [](bytes& b) { b[20] |= 16; seal_header(b); }},
      {"contour without a scale", status::pack_bad_field, [](bytes& b) { b[20] |= 8; seal_header(b); }},
      {"contour of an unknown unit", status::pack_bad_field, [](bytes& b) { b[20] |= 8; b[35] = 1; b[37] = 2; seal_header(b); }},
      {"reserved byte of a contour", status::pack_bad_field, [](bytes& b) { b[20] |= 8; b[35] = 1; b[38] = 1; seal_header(b); }},
      {"style of what is no contour", status::pack_bad_field, [](bytes& b) { b[35] = 1; seal_header(b); }},
      {"order", status::pack_bad_field, [](bytes& b) { b[22] = 0; seal_header(b); }},
      {"unknown order", status::pack_bad_field, [](bytes& b) { b[22] = 3; seal_header(b); }},
      {"uniform level that is none", status::pack_bad_field, [](bytes& b) { put16(b, 24, 1u << b[13]); seal_header(b); }},
      {"palette where none belongs", status::pack_bad_field, [](bytes& b) { b[26] = 1; seal_header(b); }},
      {"reserved", status::pack_bad_field, [](bytes& b) { b[39] = 1; seal_header(b); }},
      {"palette offset", status::pack_bad_layout, [](bytes& b) { b[28] = 64; seal_header(b); }},
      {"no width", status::bad_size, [](bytes& b) { put16(b, 16, 0); seal_header(b); }},
      {"height 4097", status::bad_size, [](bytes& b) { put16(b, 18, 4097); seal_header(b); }},
      {"another width", status::pack_bad_layout, [](bytes& b) { put16(b, 16, 6); seal_header(b); }},
      {"level offset", status::pack_bad_layout, [](bytes& b) { b[48] ^= 8; seal_header(b); }},
      {"level bytes", status::pack_bad_layout, [](bytes& b) { b[52] ^= 2; seal_header(b); }},
      {"huge level offset", status::pack_bad_layout, [](bytes& b) { put32(b, 56, 0xFFFFFFF8u); seal_header(b); }},
      {"whole size", status::pack_truncated, [](bytes& b) { put32(b, 8, uint32_t(b.size()) + 8); seal_header(b); }},
      {"size below the header", status::pack_bad_layout, [](bytes& b) { put32(b, 8, 8); seal_header(b); }},
      {"size below the levels", status::pack_bad_layout, [](bytes& b) { put32(b, 8, uint32_t(b.size()) - 8); seal_header(b); }},
      {"texels", status::pack_bad_payload, [](bytes& b) { b[get16(b, 6)] ^= 1; }},
      {"padding", status::pack_bad_payload, [](bytes& b) { b.back() = 1; }},
      {"other order", status::pack_byte_order, [](bytes& b) { b[22] = uint8_t(3 - b[22]); seal_header(b); }},
  };
  static constexpr damage of_palettes[] = {
      {"no colours", status::pack_bad_field, [](bytes& b) { put16(b, 26, 0); seal_header(b); }},
      {"too many colours", status::pack_bad_field, [](bytes& b) { put16(b, 26, 17); seal_header(b); }},
      {"fewer colours", status::pack_bad_layout, [](bytes& b) { put16(b, 26, get16(b, 26) - 2); seal_header(b); }},
      {"no palette offset", status::pack_bad_layout, [](bytes& b) { put32(b, 28, 0); seal_header(b); }},
      {"another palette offset", status::pack_bad_layout, [](bytes& b) { put32(b, 28, get16(b, 28) + 8); seal_header(b); }},
      {"an order of bytes", status::pack_bad_field, [](bytes& b) { b[22] = 1; seal_header(b); }},
      {"a colour", status::pack_bad_payload, [](bytes& b) { b[get16(b, 28)] ^= 1; }},
      {"two indices in a byte", status::pack_bad_layout, [](bytes& b) { b[12] = uint8_t(texel_format::palette8); seal_header(b); }},
  };
  const auto check = [](const damage& d, texel_format format) {
    static bytes pack;
    pack = small_pack(format);
    d.apply(pack);
    const status got = opened(pack);
    if (got != d.expected) print_error("%s: %s\n", d.what, to_string(got));
    assert_int_equal(int(got), int(d.expected));
  };
  for (const damage& d : kinds) check(d, texel_format::argb4444);
  for (const damage& d : of_palettes) check(d, texel_format::palette4);
}

SPANTEX_CASE(the_order_of_bytes_is_that_of_16_bit_formats_alone) {
  constexpr auto other = pf::byte_order(3 - pf::native_order);
  for (const texel_format format : all_formats) {
    static image picture;
    picture = noise(5, 3);
    compile_options o;
    o.format = format;
    static bytes pack;
    pack = compile_pack(picture, o);
    assert_int_equal(pack[22], is_16_bit(format) ? pf::native_order : pf::bytes_only);
    o.order = other;
    const bytes& swapped = compiled(picture, o);
    if (!is_16_bit(format)) {
      assert_true(swapped == pack);
      continue;
    }
    SPANTEX_ASSERT_STATUS(opened(swapped), pack_byte_order);
    for (size_t at = 80; at < 80 + 30; at += 2) assert_true(swapped[at] == pack[at + 1] && swapped[at + 1] == pack[at]);  // 5x3 texels
  }
}

SPANTEX_CASE(too_many_levels_for_the_size_are_refused) {
  static bytes pack;
  compile_options o;
  o.level_count = 3;
  pack = compiled(noise(4, 4), o);
  put16(pack, 16, 2);  // levels of 2, 1, 1: the layout is that of another size, so all sizes change
  put16(pack, 18, 2);
  pack.resize(72 + 16 + 8 + 8);
  const uint32_t entries[] = {72, 16, 88, 4, 96, 4};
  for (size_t k = 0; k < 6; ++k) put32(pack, 48 + 4 * k, entries[k]);
  put32(pack, 8, uint32_t(pack.size()));
  put32(pack, 40, crc32(pack.data() + 72, pack.size() - 72));
  put16(pack, 24, 0);
  seal_header(pack);
  SPANTEX_ASSERT_STATUS(opened(pack), bad_levels);
}

SPANTEX_CASE(null_and_misaligned_bytes_are_refused) {
  texture_pack p;
  SPANTEX_ASSERT_STATUS(texture_pack::open(nullptr, 100, p), bad_pointer);
  const bytes& pack = small_pack();
  alignas(8) static uint8_t room[4096];
  for (size_t shift = 0; shift < 8; ++shift) {
    std::memcpy(room + shift, pack.data(), pack.size());
    assert_int_equal(int(texture_pack::open(room + shift, pack.size(), p)), int(shift == 0 ? status::ok : status::pack_misaligned));
  }
}

SPANTEX_CASE(a_refused_pack_leaves_what_was_there) {
  static bytes pack, broken;
  pack = small_pack();
  texture_pack p;
  SPANTEX_ASSERT_OK(texture_pack::open(pack.data(), pack.size(), p));
  const auto before = p.view().id(0);
  broken = pack;
  broken.back() ^= 1;
  SPANTEX_ASSERT_STATUS(opened(broken, p), pack_bad_payload);
  assert_true(p.view().id(0) == before);
  SPANTEX_ASSERT_OK(opened(broken, p, payload_check::none));  // the caller's choice
}

SPANTEX_CASE(bytes_beyond_the_pack_are_not_looked_at) {
  static bytes pack;
  pack = small_pack();
  pack.resize(pack.size() + 100, 0xA5);
  SPANTEX_ASSERT_OK(opened(pack));
}

SPANTEX_CASE(opening_allocates_nothing) {
  const bytes& pack = small_pack();
  texture_pack p;
  allocation_trap::begin();
  const status s = texture_pack::open(pack.data(), pack.size(), p);
  assert_int_equal(allocation_trap::end(), 0);
  SPANTEX_ASSERT_OK(s);
}

// --- alpha test ----------------------------------------------------------------------------------------

// No other scale comes nearer to the wanted share, and the test keeps exactly the texels that it means to.
SPANTEX_CASE(coverage_is_as_near_as_alphas_allow) {
  for (const int threshold : {1, 2, 60, 128, 200, 255})
    for (const int kept : {0, 1, 13, 50, 99, 100}) {
      static image level, scaled;
      level = noise(17, 9);
      scaled = level;
      const alpha_coverage wanted{kept, 100};
      keep_coverage(scaled, uint8_t(threshold), wanted);
      const auto off = [&](int64_t n) { return std::llabs(n * 100 - kept * int64_t(level.pixels.size())); };
      const int64_t reached = coverage_of(scaled, uint8_t(threshold)).kept;
      for (int t = 1; t <= 256; ++t) {
        int64_t n = 0;
        for (const rgba8& c : level.pixels) n += c.a >= t;
        assert_true(off(reached) <= off(n));
      }
      for (size_t k = 0; k < level.pixels.size(); ++k)
        for (size_t n = 0; n < level.pixels.size(); ++n)
          assert_true(level.pixels[k].a > level.pixels[n].a || scaled.pixels[k].a <= scaled.pixels[n].a);
    }
}

// Leaves: thin shapes that a filter thins out. Every level keeps the share of level 0 as nearly as any threshold would, in every format.
SPANTEX_CASE(levels_keep_the_coverage_of_level_0) {
  static image leaves;
  leaves = image(128, 128, {});
  for (int y = 0; y < 128; ++y)
    for (int x = 0; x < 128; ++x) leaves.at(x, y) = {40, 160, 30, uint8_t((x * 7 + y * 3) % 29 < 6 || (x * x + y * y) % 97 < 8 ? 255 : 0)};
  for (const texel_format format : all_formats)
    for (const prefilter kind : all_prefilters) {
      if (!has_alpha(format)) continue;
      if (is_compressed(format) && kind != prefilter::kaiser) continue;  // slow
      compile_options o;
      o.format = format;
      o.levels = kind;
      o.alpha = alpha_weighting::weighted;
      o.alpha_threshold = 200;
      static bytes pack;
      pack = compile_pack(leaves, o);
      texture_pack p;
      SPANTEX_ASSERT_OK(texture_pack::open(pack.data(), pack.size(), p));
      assert_true(p.alpha_tested());
      const double wanted = double(coverage_of(leaves, 200).kept) / (128 * 128);
      static std::vector<image> plain;
      o.alpha_threshold = 0;
      plain = compile_levels(leaves, o);
      double lost = 0;
      for (int level = 0; level <= 4; ++level) {
        int kept = 0;
        for (int y = 0; y < p.view().height(level); ++y)
          for (int x = 0; x < p.view().width(level); ++x) kept += p.view().texel(level, x, y).a >= 200;
        const double texels = p.view().width(level) * p.view().height(level);
        double least = 1;  // that any threshold would reach
        for (int t = 1; t <= 256 && level > 0; ++t) {
          const auto n = std::count_if(plain[size_t(level)].pixels.begin(), plain[size_t(level)].pixels.end(), [&](const rgba8& c) { return c.a >= t; });
          least = std::min(least, std::abs(double(n) / texels - wanted));
        }
        assert_true(std::abs(kept / texels - wanted) <= (level == 0 ? 0 : least) + 1e-12);
        lost = std::max(lost, std::abs(double(coverage_of(plain[size_t(level)], 200).kept) / texels - wanted));
      }
      assert_true(lost > 0.2);  // what happens without
    }
}

// Whatever rounding, palette or block do to alpha, the test keeps the texels that it keeps of the levels without a format.
SPANTEX_CASE(no_format_moves_a_texel_across_the_threshold) {
  for (const int threshold : {1, 40, 129, 200, 255})
    for (const texel_format format : all_formats) {
      if (!has_alpha(format)) continue;
      static image picture;
      picture = noise(23, 18);
      picture.at(3, 3).a = 0;  // texels on either side
      compile_options o;
      o.alpha_threshold = uint8_t(threshold);
      static std::vector<image> wanted;
      wanted = compile_levels(picture, o);
      o.format = format;
      texture_pack p;
      SPANTEX_ASSERT_OK(open_compiled(picture, o, p));
      for (int k = 0; k < p.view().level_count(); ++k)
        for (int y = 0; y < p.view().height(k); ++y)
          for (int x = 0; x < p.view().width(k); ++x)
            assert_int_equal(p.view().texel(k, x, y).a >= threshold, wanted[size_t(k)].at(x, y).a >= threshold);
    }
}

// --- maps and C arrays ---------------------------------------------------------------------------------

SPANTEX_CASE(a_map_takes_a_pack_and_refuses_a_broken_one) {
  static bytes pack;
  pack = small_pack();
  const texture_view view = [] {
    static texture_map map(bytes(pack), "m.stx");
    static texture_map moved(std::move(map));
    return moved.view();
  }();
  assert_int_equal(view.width(), 5);
  pack.back() ^= 1;
  bool refused = false;
  try {
    texture_map(bytes(pack), "m.stx");
  } catch (const input_error& e) {
    refused = std::strstr(e.what(), "m.stx") != nullptr && std::strstr(e.what(), "damaged") != nullptr;
  }
  assert_true(refused);
}

SPANTEX_CASE(identifiers_are_made_of_file_names) {
  assert_string_equal(identifier_of("a/b/brick-2.stx.c").c_str(), "brick_2_stx");
  assert_string_equal(identifier_of("2.h").c_str(), "map_2");
  for (const char* word : {"int", "xor_eq", "alignas", "_Alignas", "uint8_t", "main"}) assert_string_equal(identifier_of(std::string(word) + ".c").c_str(), ("map_" + std::string(word)).c_str());
  for (const char* name : {"Int", "ints", "in", "t"}) assert_string_equal(identifier_of(std::string(name) + ".c").c_str(), name);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {cmocka_unit_test(the_checksum_is_zlibs),
                              cmocka_unit_test(what_is_read_is_what_was_compiled),
                              cmocka_unit_test(a_pack_shows_what_a_map_made_of_the_picture_shows),
                              cmocka_unit_test(packs_do_not_depend_on_threads_and_tell_their_progress),
                              cmocka_unit_test(facts_are_true_of_every_level),
                              cmocka_unit_test(facts_are_those_of_the_format),
                              cmocka_unit_test(every_cut_is_refused),
                              cmocka_unit_test(every_flipped_bit_is_refused),
                              cmocka_unit_test(sealed_nonsense_stays_within_its_bytes),
                              cmocka_unit_test(each_kind_of_damage_has_its_status),
                              cmocka_unit_test(the_order_of_bytes_is_that_of_16_bit_formats_alone),
                              cmocka_unit_test(too_many_levels_for_the_size_are_refused),
                              cmocka_unit_test(null_and_misaligned_bytes_are_refused),
                              cmocka_unit_test(a_refused_pack_leaves_what_was_there),
                              cmocka_unit_test(bytes_beyond_the_pack_are_not_looked_at),
                              cmocka_unit_test(opening_allocates_nothing),
                              cmocka_unit_test(coverage_is_as_near_as_alphas_allow),
                              cmocka_unit_test(levels_keep_the_coverage_of_level_0),
                              cmocka_unit_test(no_format_moves_a_texel_across_the_threshold),
                              cmocka_unit_test(a_map_takes_a_pack_and_refuses_a_broken_one),
                              cmocka_unit_test(identifiers_are_made_of_file_names)};
  return run_suite("pack", tests);
}
