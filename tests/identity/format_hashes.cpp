// SPDX-License-Identifier: Apache-2.0
// Prints a hash of what random bytes decode to in every format, of what a fixed picture is encoded to, and of small pictures drawn from both:
// the same on every machine (tests/scripts/format_identity.py). 16-bit formats are numbers in the machine's byte order, so their random
// bytes are made as numbers.
#include <hal/direct_engine.hpp>
#include <sim/encode.hpp>
#include <spantex/global_memory.hpp>
#include <spantex/spantex.hpp>

#include <cstdio>
#include <cstdlib>
#include <cstring>

using namespace spantex;
using namespace spantex::sim;

namespace {

using prof = fixed_profile<profiles::standard>;
constexpr int side = 37, screen_side = 48;

uint64_t state = 1;
uint32_t random_32() {
  state = state * 6364136223846793005u + 1442695040888963407u;
  return uint32_t(state >> 33);
}

uint32_t hash_of(const void* data, size_t size) {
  uint32_t h = 2166136261u;
  for (size_t k = 0; k < size; ++k) h = (h ^ static_cast<const uint8_t*>(data)[k]) * 16777619u;
  return h;
}

bytes random_level(texel_format f) {
  bytes out(level_bytes(f, side, side));
  if (is_16_bit(f))
    for (size_t k = 0; k < out.size(); k += 2) {
      const uint16_t number = uint16_t(random_32());
      std::memcpy(&out[k], &number, 2);
    }
  else
    for (uint8_t& b : out) b = uint8_t(random_32());
  return out;
}

// Through global memory and the loader.
uint32_t drawn(texel_format f, const bytes& level, const palette& colours) {
  static uint64_t words[side * side];
  static direct_engine<prof> engine;
  static rgba8 screen[screen_side * screen_side];
  global_memory memory(words, side * side);
  texture_view t;
  const void* const levels[] = {level.data()};
  if (memory.upload(f, levels, 1, side, side, wrap::mirror, wrap::repeat, t, colours.data(), int(colours.size())) != status::ok) std::abort();
  const homography m{wide(70000), wide(-9000), wide(-100000), wide(8000), wide(60000), wide(300000), wide(0), wide(300), wide(65536)};
  const rectangle area{0, 0, screen_side, screen_side};
  plane p{};
  renderer<direct_engine<prof>, prof> r(engine, {}, {screen, screen_side, screen_side, screen_side});
  if (make_plane(m, area, p) != status::ok || r.draw(p, t, filter::bilinear, area) != status::ok || r.finish() != status::ok) std::abort();
  return hash_of(screen, sizeof screen);
}

void print(const char* what, texel_format f, const bytes& level, const palette& colours) {
  const image decoded = decode_level(f, level, side, side, colours);
  std::printf("%s %d decoded %08x drawn %08x\n", what, int(f), unsigned(hash_of(decoded.pixels.data(), decoded.pixels.size() * 4)),
              unsigned(drawn(f, level, colours)));
}

}  // namespace

int main() {
  image picture(side, side, {});
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      picture.at(x, y) = {uint8_t(5 * x + (random_32() & 31)), uint8_t(6 * y), uint8_t(3 * x + 3 * y), uint8_t(x * y + (random_32() & 15))};
  for (int k = 0; k < texel_format_count; ++k) {
    const texel_format f = texel_format(k);
    palette colours;
    if (palette_size(f) != 0) colours = make_palette(picture, palette_size(f));
    print("random", f, random_level(f), colours);
    print("encoded", f, encode_level(f, picture, colours), colours);
  }
}
