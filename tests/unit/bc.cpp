// SPDX-License-Identifier: Apache-2.0
// BC1..3 against libsquish, bit for bit; and the encoder against libsquish's.
#include <squish.h>

#include <cstring>

#include <spantex/bc.hpp>
#include <spantex/block_codec.hpp>
#include <tests/formats.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

struct kind { texel_format format; int squish_flag; const char* name; };
constexpr kind kinds[] = {{texel_format::bc1, squish::kDxt1, "bc1"}, {texel_format::bc2, squish::kDxt3, "bc2"}, {texel_format::bc3, squish::kDxt5, "bc3"}};

bool equals_libsquish(const kind& k, const uint8_t* block) {
  texel_block ours;
  uint8_t theirs[64];
  decoder_of(k.format)(block, ours);
  squish::Decompress(theirs, block, k.squish_flag);
  return std::memcmp(&ours, theirs, sizeof theirs) == 0;
}

bytes squished(const kind& k, const image& picture, int fit) {
  bytes out(level_bytes(k.format, picture.width_px, picture.height_px));
  squish::CompressImage(&picture.pixels[0].r, picture.width_px, picture.height_px, out.data(), k.squish_flag | fit);
  return out;
}

// A photograph whose alpha is another channel, so that all alphas occur.
const image& with_alpha(const char* name) {
  static image out;
  out = photograph(name);
  for (rgba8& c : out.pixels) c.a = uint8_t(255 - c.g);
  return out;
}

}  // namespace

SPANTEX_CASE(random_blocks_decode_as_libsquish_decodes_them) {
  const int count = short_run() ? 50000 : 1000000;
  for (const kind& k : kinds) {
    random_source random(uint64_t(k.squish_flag));
    int three = 0, six_alphas = 0;
    for (int n = 0; n < count; ++n) {
      uint8_t block[16];
      random_bytes(random, block, sizeof block);
      // A block in sixteen has equal end points or alphas: the border between the modes.
      if (n % 16 == 0) std::memcpy(block + 2, block, 2);
      if (n % 16 == 1) std::memcpy(block + 10, block + 8, 2);
      if (n % 16 == 2) block[1] = block[0];
      const uint8_t* const colours = k.format == texel_format::bc1 ? block : block + 8;
      three += spantex::detail::little_endian_16(colours) <= spantex::detail::little_endian_16(colours + 2);
      six_alphas += block[0] <= block[1];
      assert_true(equals_libsquish(k, block));
    }
    assert_true(three > count / 3 && three < 2 * count / 3);
    assert_true(six_alphas > count / 3 && six_alphas < 2 * count / 3);
  }
}

// Every pair of end points of one channel, all four indices: all 565 widenings and thirds there are.
SPANTEX_CASE(every_pair_of_end_points_decodes_as_libsquish_decodes_it) {
  for (const kind& k : kinds)
    for (uint32_t a = 0; a < 64; ++a)
      for (uint32_t b = 0; b < 64; ++b) {
        const uint32_t c0 = a << 5 | (a >> 1) << 11 | (63 - a) >> 1, c1 = b << 5 | (b >> 1) << 11 | (63 - b) >> 1;
        const uint8_t colours[8] = {uint8_t(c0), uint8_t(c0 >> 8), uint8_t(c1), uint8_t(c1 >> 8), 0xE4, 0x1B, 0xE4, 0x1B};
        uint8_t block[16] = {uint8_t(4 * a), uint8_t(4 * b), 0x88, 0xC6, 0xFA, 0x05, 0x39, 0x77};
        std::memcpy(k.format == texel_format::bc1 ? block : block + 8, colours, 8);
        assert_true(equals_libsquish(k, block));
      }
}

SPANTEX_CASE(every_pair_of_alphas_decodes_as_libsquish_decodes_it) {
  for (int a = 0; a < 256; ++a)
    for (int b = 0; b < 256; ++b) {
      const uint8_t block[16] = {uint8_t(a), uint8_t(b), 0x88, 0xC6, 0xFA, 0x05, 0x39, 0x77, 1, 2, 3, 4, 5, 6, 7, 8};
      assert_true(equals_libsquish(kinds[2], block));
    }
}

SPANTEX_CASE(photographs_that_libsquish_compressed_decode_as_it_decodes_them) {
  for (const char* name : {"brick.png", "astronaut.png"})
    for (const kind& k : kinds)
      for (const int fit : {int(squish::kColourRangeFit), int(squish::kColourClusterFit)}) {
        const image& picture = with_alpha(name);
        const bytes data = squished(k, picture, fit);
        static image theirs;
        theirs = picture;
        squish::DecompressImage(&theirs.pixels[0].r, picture.width_px, picture.height_px, data.data(), k.squish_flag);
        assert_true(decode_level(k.format, data, picture.width_px, picture.height_px).pixels == theirs.pixels);
      }
}

// Worked by hand: c0 = pure red, c1 = pure blue; row 0 has indices 0 1 2 3, the others 0.
SPANTEX_CASE(a_block_worked_by_hand_has_the_documented_colours) {
  constexpr uint8_t block[8] = {0x00, 0xF8, 0x1F, 0x00, 0xE4, 0, 0, 0}, swapped[8] = {0x1F, 0x00, 0x00, 0xF8, 0xE4, 0, 0, 0};
  texel_block t;
  decode_bc1(block, t);
  assert_true((t.texel[0] == rgba8{255, 0, 0, 255} && t.texel[1] == rgba8{0, 0, 255, 255}));
  assert_true((t.texel[2] == rgba8{170, 0, 85, 255} && t.texel[3] == rgba8{85, 0, 170, 255}));
  decode_bc1(swapped, t);
  assert_true((t.texel[2] == rgba8{127, 0, 127, 255} && t.texel[3] == rgba8{0, 0, 0, 0} && t.texel[4] == rgba8{0, 0, 255, 255}));
}

SPANTEX_CASE(our_encoder_is_within_half_a_decibel_of_libsquishs_cluster_fit_and_beats_its_range_fit) {
  for (const char* name : {"brick.png", "astronaut.png"})
    for (const kind& k : kinds) {
      const image& picture = photograph(name);
      const auto psnr = [&](const bytes& data) {
        return psnr_rgb_db(picture, decode_level(k.format, data, picture.width_px, picture.height_px));
      };
      const double ours = psnr(encode_level(k.format, picture)), range = psnr(squished(k, picture, squish::kColourRangeFit)),
                   cluster = psnr(squished(k, picture, squish::kColourClusterFit));
      print_message("%s %s: %.2f dB; libsquish range fit %.2f, cluster fit %.2f\n", name, k.name, ours, range, cluster);
      assert_true(ours > range && ours > cluster - 0.5);
    }
}

SPANTEX_CASE(alpha_is_kept_transparent_texels_of_bc1_stay_transparent) {
  const image& picture = with_alpha("astronaut.png");
  for (const kind& k : kinds) {
    const image decoded = decode_level(k.format, encode_level(k.format, picture), picture.width_px, picture.height_px);
    double sum = 0;
    int64_t wrong = 0;
    for (size_t n = 0; n < picture.pixels.size(); ++n) {
      const int a = picture.pixels[n].a, b = decoded.pixels[n].a;
      wrong += (a >= 128 ? 255 : 0) != b;
      sum += double((a - b) * (a - b));
    }
    if (k.format == texel_format::bc1) assert_int_equal(wrong, 0);
    else if (k.format == texel_format::bc2) assert_true(sum / double(picture.pixels.size()) < 17.0 * 17 / 12 * 1.1);  // a uniform error of +-8.5
    else assert_true(sum / double(picture.pixels.size()) < 4);
  }
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(random_blocks_decode_as_libsquish_decodes_them),
      cmocka_unit_test(every_pair_of_end_points_decodes_as_libsquish_decodes_it),
      cmocka_unit_test(every_pair_of_alphas_decodes_as_libsquish_decodes_it),
      cmocka_unit_test(photographs_that_libsquish_compressed_decode_as_it_decodes_them),
      cmocka_unit_test(a_block_worked_by_hand_has_the_documented_colours),
      cmocka_unit_test(our_encoder_is_within_half_a_decibel_of_libsquishs_cluster_fit_and_beats_its_range_fit),
      cmocka_unit_test(alpha_is_kept_transparent_texels_of_bc1_stay_transparent),
  };
  return run_suite("bc", tests);
}
