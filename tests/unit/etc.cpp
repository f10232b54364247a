// SPDX-License-Identifier: Apache-2.0
// ETC1 and ETC2: blocks worked by hand for every mode, and the encoder. scripts.etc_reference compares random blocks with a second decoder.
#include <cmath>

#include <spantex/etc.hpp>
#include <tests/formats.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

// A block from fields, most significant first: each of `bits` bits.
struct field { int bits; uint32_t value; };

struct block { uint8_t bytes[8]; };

template <size_t N>
block made(const field (&fields)[N]) {
  uint64_t all = 0;
  int used = 0;
  for (const field& f : fields) {
    all = all << f.bits | f.value;
    used += f.bits;
  }
  if (used != 64) std::abort();
  block b{};
  for (int k = 0; k < 8; ++k) b.bytes[k] = uint8_t(all >> (56 - 8 * k));
  return b;
}

// The texel indices so that texel (x, y) has paint y (columns of 0 1 2 3): upper bits 0xCCCC, lower bits 0xAAAA.
constexpr field paint_is_y[2] = {{16, 0xCCCC}, {16, 0xAAAA}};

rgba8 at(const texel_block& t, int x, int y) { return t.texel[4 * y + x]; }
texel_block rgb8(const block& b) { texel_block t; decode_etc2_rgb8(b.bytes, t); return t; }
texel_block rgb8a1(const block& b) { texel_block t; decode_etc2_rgb8a1(b.bytes, t); return t; }

#define ASSERT_COLOUR(actual, ...) assert_true((actual) == (rgba8{__VA_ARGS__}))

// The colours of rows 0 to 3 of columns x0 to x1.
void assert_rows(const texel_block& t, int x0, int x1, const rgba8 (&rows)[4]) {
  for (int x = x0; x <= x1; ++x)
    for (int y = 0; y < 4; ++y) assert_true(at(t, x, y) == rows[y]);
}

}  // namespace

SPANTEX_CASE(individual_mode) {
  // bases 0x3 0x7 0xC and 0xF 0x0 0x8 times 17, tables 2 (9, 29) and 7 (47, 183), halves side by side
  const block b = made({{4, 3}, {4, 15}, {4, 7}, {4, 0}, {4, 12}, {4, 8}, {3, 2}, {3, 7}, {1, 0}, {1, 0}, paint_is_y[0], paint_is_y[1]});
  const texel_block t = rgb8(b);
  assert_rows(t, 0, 1, {{60, 128, 213, 255}, {80, 148, 233, 255}, {42, 110, 195, 255}, {22, 90, 175, 255}});
  assert_rows(t, 2, 3, {{255, 47, 183, 255}, {255, 183, 255, 255}, {208, 0, 89, 255}, {72, 0, 0, 255}});
}

SPANTEX_CASE(individual_mode_with_halves_above_each_other) {
  const block b = made({{4, 3}, {4, 15}, {4, 7}, {4, 0}, {4, 12}, {4, 8}, {3, 2}, {3, 7}, {1, 0}, {1, 1}, {16, 0x0000}, {16, 0x8001}});
  const texel_block t = rgb8(b);
  ASSERT_COLOUR(at(t, 0, 0), 80, 148, 233, 255);   // n = 0 has paint 1
  ASSERT_COLOUR(at(t, 3, 1), 60, 128, 213, 255);   // upper half
  ASSERT_COLOUR(at(t, 0, 2), 255, 47, 183, 255);   // lower half
  ASSERT_COLOUR(at(t, 3, 3), 255, 183, 255, 255);  // n = 15
}

SPANTEX_CASE(differential_mode) {
  // 5-bit bases 10 20 31 (82 165 255), deltas +3 -4 -1: 13 16 30 (107 132 247); tables 0 (2, 8), 5 (24, 80)
  const block b = made({{5, 10}, {3, 3}, {5, 20}, {3, 4}, {5, 31}, {3, 7}, {3, 0}, {3, 5}, {1, 1}, {1, 0}, paint_is_y[0], paint_is_y[1]});
  const texel_block t = rgb8(b);
  assert_rows(t, 0, 1, {{84, 167, 255, 255}, {90, 173, 255, 255}, {80, 163, 253, 255}, {74, 157, 247, 255}});
  assert_rows(t, 2, 3, {{131, 156, 255, 255}, {187, 212, 255, 255}, {83, 108, 223, 255}, {27, 52, 167, 255}});
}

SPANTEX_CASE(t_mode) {
  // Red overflows: R = 111 10 = 30, dR = 0 10 = +2. c1 = (1010, 3, 9) = 170 51 153; c2 = (5, 12, 1) = 85 204 17; d number 5 = 32
  const block b = made({{3, 7}, {2, 2}, {1, 0}, {2, 2}, {4, 3}, {4, 9}, {4, 5}, {4, 12}, {4, 1}, {2, 2}, {1, 1}, {1, 1}, paint_is_y[0], paint_is_y[1]});
  const texel_block t = rgb8(b);
  assert_rows(t, 0, 3, {{170, 51, 153, 255}, {117, 236, 49, 255}, {85, 204, 17, 255}, {53, 172, 0, 255}});
  // Underflow: R = 000 01 = 1, dR = 1 00 = -4; the red of c1 is 01 00 = 4
  const block low = made({{3, 0}, {2, 1}, {1, 1}, {2, 0}, {4, 3}, {4, 9}, {4, 5}, {4, 12}, {4, 1}, {2, 2}, {1, 1}, {1, 1}, paint_is_y[0], paint_is_y[1]});
  ASSERT_COLOUR(at(rgb8(low), 2, 0), 68, 51, 153, 255);
}

SPANTEX_CASE(h_mode) {
  // c1 = (6, 1010, 1101) = 102 170 221; c2 = (6, 10, 3) = 102 170 51. R = 0 0110 = 6, dR = 101 = -3: 3, inside.
  // G = fff 0 1, dG = g 10: 111 0 1 = 29, 0 10 = +2: 31 is inside; so 000 0 1 = 1 and 1 10 = -2: -1, outside.
  // number = 1 (bit 34), 0 (bit 32), and c1 >= c2: 101 = 5: 32
  const field all[] = {{1, 0}, {4, 6}, {3, 5}, {3, 0}, {1, 0}, {1, 1}, {1, 1}, {2, 2}, {1, 1}, {4, 6}, {4, 10}, {4, 3}, {1, 1}, {1, 1}, {1, 0},
                       paint_is_y[0], paint_is_y[1]};
  const texel_block t = rgb8(made(all));
  assert_rows(t, 0, 3, {{134, 202, 253, 255}, {70, 138, 189, 255}, {134, 202, 83, 255}, {70, 138, 19, 255}});
  // c2 larger (blue 14 = 238): number 100 = 4: 23
  field other[sizeof all / sizeof all[0]];
  for (size_t k = 0; k < sizeof all / sizeof all[0]; ++k) other[k] = all[k];
  other[11].value = 14;
  ASSERT_COLOUR(at(rgb8(made(other)), 0, 0), 125, 193, 244, 255);
  // equal colours count as c1 >= c2
  other[11].value = 13;
  ASSERT_COLOUR(at(rgb8(made(other)), 0, 0), 134, 202, 253, 255);
}

// Sums outside 0..31 in several channels: red decides first, then green.
SPANTEX_CASE(red_decides_before_green_before_blue) {
  for (int channels = 1; channels < 8; ++channels) {
    block b{{0x48, 0x48, 0x48, 0x02, 0xCC, 0xCC, 0xAA, 0xAA}};  // bases 9, deltas 0
    for (int c = 0; c < 3; ++c)
      if ((channels >> c & 1) != 0) b.bytes[c] = 0xFB;  // 31 + 3
    const texel_block decoded = rgb8(b);
    const spantex::detail::etc_bits e{spantex::detail::big_endian_32(b.bytes), spantex::detail::big_endian_32(b.bytes + 4)};
    rgba8 paint[4];
    texel_block expected;
    spantex::detail::decode_planar(e, expected);
    if ((channels & 1) != 0) spantex::detail::etc_t_mode(e, paint);
    else if ((channels & 2) != 0) spantex::detail::etc_h_mode(e, paint);
    for (int k = 0; k < 16; ++k) {
      const rgba8 wanted = (channels & 3) != 0 ? paint[k / 4] : expected.texel[k];
      assert_true(decoded.texel[k] == wanted);
    }
  }
}

SPANTEX_CASE(planar_mode) {
  // O = (17, 1000001, 100110), H = (40, 100, 5), V = (63, 0, 50) in 6, 7, 6 bits.
  // R = f 0100, dR = 01 and GO's top bit: 011 = +3, so f = 0 keeps it inside. G = f 0000, dG = 01 and BO's top bit: likewise.
  // B = fff 00, dB = g 11 with 110 = 1 10: bits 44-43 = 00, 42 = g, 41-39 = 110: a = 0, b = 3: fff = 000, g = 1: 0 - 1 outside.
  const block b = made({{1, 0}, {6, 17}, {1, 1}, {1, 0}, {6, 1}, {1, 1}, {3, 0}, {2, 0}, {1, 1}, {3, 6}, {5, 20}, {1, 1}, {1, 0},
                        {7, 100}, {6, 5}, {6, 63}, {7, 0}, {6, 50}});
  const texel_block t = rgb8(b);
  // 8 bits: O = 69, 131, 154; H = 162, 201, 20; V = 255, 0, 203
  ASSERT_COLOUR(at(t, 0, 0), 69, 131, 154, 255);
  ASSERT_COLOUR(at(t, 3, 0), 139, 184, 54, 255);   // 69 + 3 * 93 / 4 = 138.75; 131 + 52.5 = 183.5 up; 154 - 100.5 = 53.5 up
  ASSERT_COLOUR(at(t, 0, 3), 209, 33, 191, 255);   // 69 + 139.5 up; 131 - 98.25; 154 + 36.75
  ASSERT_COLOUR(at(t, 3, 3), 255, 85, 90, 255);    // 278 clamped; 131 + 52.5 - 98.25 = 85.25; 154 - 100.5 + 36.75 = 90.25
}

SPANTEX_CASE(eac_alpha) {
  // base 100, multiplier 3, table 1 (-3 -7 -10 -13 2 6 9 12); texel n has number n mod 8
  const uint8_t bytes[16] = {100, 0x31, 0x05, 0x39, 0x77, 0x05, 0x39, 0x77};
  texel_block t;
  decode_etc2_rgba8(bytes, t);
  constexpr uint8_t expected[8] = {91, 79, 70, 61, 106, 118, 127, 136};
  for (int n = 0; n < 16; ++n) assert_int_equal(at(t, n / 4, n % 4).a, expected[n % 8]);
  const uint8_t high[8] = {250, 0xF0, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF}, none[8] = {77, 0x0D, 0x05, 0x39, 0x77, 0x05, 0x39, 0x77};
  uint8_t both[16] = {};
  for (int k = 0; k < 8; ++k) both[k] = high[k];
  decode_etc2_rgba8(both, t);
  for (const rgba8& c : t.texel) assert_int_equal(c.a, 255);
  for (int k = 0; k < 8; ++k) both[k] = none[k];
  decode_etc2_rgba8(both, t);  // a multiplier of 0: the base
  for (const rgba8& c : t.texel) assert_int_equal(c.a, 77);
}

SPANTEX_CASE(punch_through) {
  // The differential block of above with bit 33 clear: paint 2 transparent, the small modifier 0.
  const field fields[] = {{5, 10}, {3, 3}, {5, 20}, {3, 4}, {5, 31}, {3, 7}, {3, 0}, {3, 5}, {1, 0}, {1, 0}, paint_is_y[0], paint_is_y[1]};
  const texel_block t = rgb8a1(made(fields));
  ASSERT_COLOUR(at(t, 0, 0), 82, 165, 255, 255);
  ASSERT_COLOUR(at(t, 1, 1), 90, 173, 255, 255);
  ASSERT_COLOUR(at(t, 0, 2), 0, 0, 0, 0);
  ASSERT_COLOUR(at(t, 1, 3), 74, 157, 247, 255);
  ASSERT_COLOUR(at(t, 2, 0), 107, 132, 247, 255);
  ASSERT_COLOUR(at(t, 3, 2), 0, 0, 0, 0);
}

SPANTEX_CASE(opaque_blocks_decode_alike_with_and_without_punch_through) {
  random_source random(3);
  for (int n = 0; n < (short_run() ? 10000 : 200000); ++n) {
    block b;
    random_bytes(random, b.bytes, 8);
    b.bytes[3] |= 2;  // bit 33: differential, or opaque
    const texel_block x = rgb8(b), y = rgb8a1(b);
    for (int k = 0; k < 16; ++k) assert_true(x.texel[k] == y.texel[k]);
  }
}

namespace {

enum mode { individual, differential, t, h, planar, mode_count };

mode mode_of(const uint8_t* p) {
  if ((p[3] & 2) == 0) return individual;
  const auto outside = [](uint8_t byte) {
    const int sum = (byte >> 3) + ((byte & 7) ^ 4) - 4;
    return sum < 0 || sum > 31;
  };
  return outside(p[0]) ? t : outside(p[1]) ? h : outside(p[2]) ? planar : differential;
}

struct quality { const char* name; double etc1_db, etc2_db; };

}  // namespace

// ETC2 holds ETC1, so it can only be better; 32 dB was asked for the brick map.
SPANTEX_CASE(photographs_are_encoded_well_and_in_every_mode) {
  for (const quality& q : {quality{"brick.png", 42, 42}, quality{"astronaut.png", 35, 35.5}}) {
    const image& picture = photograph(q.name);
    double psnr[2] = {};
    int modes[mode_count] = {};
    for (const texel_format f : {texel_format::etc1, texel_format::etc2_rgb8}) {
      const bytes data = encode_level(f, picture);
      psnr[f == texel_format::etc2_rgb8] = psnr_rgb_db(picture, decode_level(f, data, picture.width_px, picture.height_px));
      for (size_t at = 0; at < data.size(); at += 8) {
        const mode m = mode_of(data.data() + at);
        assert_true(f == texel_format::etc2_rgb8 || m == individual || m == differential);
        if (f == texel_format::etc2_rgb8) ++modes[m];
      }
    }
    print_message("%s: etc1 %.2f dB, etc2 %.2f dB; individual %d, differential %d, T %d, H %d, planar %d\n", q.name, psnr[0], psnr[1],
                  modes[individual], modes[differential], modes[t], modes[h], modes[planar]);
    assert_true(psnr[0] >= q.etc1_db && psnr[1] >= q.etc2_db && psnr[1] >= psnr[0]);
    for (const int n : modes) assert_true(n > 0);
  }
}

SPANTEX_CASE(alpha_is_encoded_within_a_few_steps) {
  static image picture;
  picture = photograph("astronaut.png");
  for (rgba8& c : picture.pixels) c.a = uint8_t(255 - c.g);
  const image coded = decode_level(texel_format::etc2_rgba8, encode_level(texel_format::etc2_rgba8, picture), picture.width_px, picture.height_px);
  const image punched = decode_level(texel_format::etc2_rgb8a1, encode_level(texel_format::etc2_rgb8a1, picture), picture.width_px, picture.height_px);
  double sum = 0;
  for (size_t k = 0; k < picture.pixels.size(); ++k) {
    const int d = picture.pixels[k].a - coded.pixels[k].a;
    sum += double(d * d);
    assert_int_equal(punched.pixels[k].a, picture.pixels[k].a >= 128 ? 255 : 0);
  }
  print_message("alpha: %.2f dB\n", 10 * std::log10(255.0 * 255 * double(picture.pixels.size()) / sum));
  assert_true(sum / double(picture.pixels.size()) < 4);
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(individual_mode),
      cmocka_unit_test(individual_mode_with_halves_above_each_other),
      cmocka_unit_test(differential_mode),
      cmocka_unit_test(t_mode),
      cmocka_unit_test(h_mode),
      cmocka_unit_test(red_decides_before_green_before_blue),
      cmocka_unit_test(planar_mode),
      cmocka_unit_test(eac_alpha),
      cmocka_unit_test(punch_through),
      cmocka_unit_test(opaque_blocks_decode_alike_with_and_without_punch_through),
      cmocka_unit_test(photographs_are_encoded_well_and_in_every_mode),
      cmocka_unit_test(alpha_is_encoded_within_a_few_steps),
  };
  return run_suite("etc", tests);
}
