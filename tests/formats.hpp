// SPDX-License-Identifier: Apache-2.0
// What the tests of texel formats share: the photographic maps, maps encoded level by level, random blocks.
#pragma once
#include <cmath>
#include <string>
#include <utility>

#include <sim/encode.hpp>
#include <sim/map.hpp>
#include <tests/support.hpp>  // last: cmocka.h defines fail as a macro

namespace spantex::sim {

inline constexpr texel_format all_formats[] = {
    texel_format::rgba8888, texel_format::rgb565, texel_format::argb1555, texel_format::argb4444, texel_format::rgb888, texel_format::l8,
    texel_format::la88, texel_format::a8, texel_format::palette8, texel_format::palette4, texel_format::bc1, texel_format::bc2,
    texel_format::bc3, texel_format::etc1, texel_format::etc2_rgb8, texel_format::etc2_rgba8, texel_format::etc2_rgb8a1};
static_assert(sizeof all_formats / sizeof all_formats[0] == texel_format_count);

// A photograph of Debian's python3-skimage; kept until the program ends.
inline const image& photograph(const char* name) {
  static std::deque<std::pair<std::string, image>> kept;
  for (const auto& [known, picture] : kept)
    if (known == name) return picture;
  kept.emplace_back(name, load_image("/usr/lib/python3/dist-packages/skimage/data/" + std::string(name)));
  return kept.back().second;
}

inline double psnr_rgb_db(const image& a, const image& b) {
  double sum = 0;
  for (size_t k = 0; k < a.pixels.size(); ++k) sum += double(detail::colour_error(a.pixels[k], b.pixels[k]));
  return 10 * std::log10(255.0 * 255.0 * 3 * double(a.pixels.size()) / sum);
}

inline void random_bytes(random_source& random, uint8_t* out, size_t count) {
  for (size_t k = 0; k < count; ++k) out[k] = uint8_t(random.next() >> 32);
}

// A map whose levels are any bytes: each decodes to something.
struct raw_map {
  std::vector<bytes> levels;
  palette colours;
  texture_view view;
};

inline const raw_map& random_map(texel_format f, int32_t width, int32_t height, wrap u, wrap v, uint64_t seed) {
  static std::deque<raw_map> kept;
  raw_map& m = kept.emplace_back();
  random_source random(seed);
  const int count = bit_length(uint64_t(max_of(width, height)));
  const void* levels[max_levels] = {};
  for (int k = 0; k < count; ++k) {
    m.levels.emplace_back(level_bytes(f, level_side(width, k), level_side(height, k)));
    random_bytes(random, m.levels.back().data(), m.levels.back().size());
  }
  for (int k = 0; k < count; ++k) levels[k] = m.levels[size_t(k)].data();
  m.colours.resize(size_t(palette_size(f)) * 3 / 4);  // so that some indices are beyond it
  for (rgba8& c : m.colours) random_bytes(random, &c.r, sizeof c);
  if (texture_view::make(f, levels, count, width, height, u, v, m.view, m.colours.data(), int(m.colours.size())) != status::ok) std::abort();
  return m;
}

// A section of any level of side texels a side, and a box within it.
struct boxed_section { section at; texel_box box; };

inline boxed_section random_section(random_source& random, const texture_view& t, int side) {
  boxed_section s{};
  s.at.level = uint8_t(random.next() % uint64_t(t.level_count()));
  s.at.origin_u = int32_t(random.between(-80, 80));
  s.at.origin_v = int32_t(random.between(-80, 80));
  s.box.u0 = s.at.origin_u + int32_t(random.between(0, side - 1));
  s.box.v0 = s.at.origin_v + int32_t(random.between(0, side - 1));
  s.box.u1 = int32_t(random.between(s.box.u0, s.at.origin_u + side - 1));
  s.box.v1 = int32_t(random.between(s.box.v0, s.at.origin_v + side - 1));
  return s;
}

}  // namespace spantex::sim
