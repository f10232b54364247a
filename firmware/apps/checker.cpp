// SPDX-License-Identifier: Apache-2.0
// The smallest whole program: a chessboard on a floor, seen in perspective, drawn into a frame buffer. Runs on a host or a device.
#include <hal/direct_engine.hpp>
#include <spantex/spantex.hpp>

using namespace spantex;

constexpr fixed_profile<profiles::standard> word_lengths;
static direct_engine<fixed_profile<profiles::standard>> unit;
static rgba8 chessboard[64 * 64], screen[160 * 120];

static status draw_floor() {
  for (int k = 0; k < 64 * 64; ++k) chessboard[k] = (k / 8 + k / 512) % 2 == 0 ? rgba8{255, 255, 255, 255} : rgba8{200, 30, 30, 255};
  const rgba8* const levels[] = {chessboard};
  texture_view texture;
  SPANTEX_TRY(texture_view::make(levels, 1, 64, 64, wrap::repeat, wrap::repeat, texture));

  constexpr int32_t one = 1 << 16;  // s15.16: lengths in camera space, texels, pixels
  const projection camera{120 * one, 120 * one, 80 * one, 60 * one, one / 8};
  const vertex floor[] = {{-9 * one, one, 0, 0, 0}, {9 * one, one, 0, 288 * one, 0},
                          {9 * one, one, 20 * one, 288 * one, 320 * one}, {-9 * one, one, 20 * one, 0, 320 * one}};
  polygon tile{};
  SPANTEX_TRY(make_polygon(floor, 4, camera, {0, 0, 160, 120}, tile));

  renderer r(unit, word_lengths, {screen, 160, 120, 160});
  SPANTEX_TRY(r.draw(tile, texture, filter::bilinear));
  return r.finish();
}

int main() { return draw_floor() == status::ok && screen[119 * 160 + 80].a == 255 ? 0 : 1; }
