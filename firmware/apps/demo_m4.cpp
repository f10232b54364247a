// SPDX-License-Identifier: Apache-2.0
// A picture drawn by a microcontroller: a tiled floor to the horizon (trilinear) and a box on it (bilinear polygons), 320 x 240 pixels of RGB565. On a board
// the frame buffer would be the display's; under the emulator it becomes a file of the host (tools/demo_m4 makes a PNG of it).
#include <spantex/rows/draw.hpp>

#include <firmware/targets/semihosting.hpp>

using namespace spantex;

static constexpr int32_t width = 320, height = 240, side = 64, level_count = 7;
static uint16_t frame[width * height], tiles[side * side * 4 / 3 + 1], planks[side * side];
static rows::state state;

static uint16_t rgb(int r, int g, int b) { return pack(texel_format::rgb565, {uint8_t(r), uint8_t(g), uint8_t(b), 255}); }

// Light and dark tiles with joints; levels are means of four.
static status make_tiles(texture_view& out) {
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const bool joint = x % 32 < 1 || y % 32 < 1, dark = ((x ^ y) & 32) != 0;
      const int grain = (x * 29 + y * 53 + x * y * 7) % 23;
      tiles[y * side + x] = joint ? rgb(60, 55, 50) : dark ? rgb(70 + grain, 95 + grain, 120 + grain) : rgb(200 + grain, 190 + grain, 165 + grain);
    }
  const uint16_t* levels[level_count] = {tiles};
  uint16_t* to = tiles + side * side;
  for (int level = 1, n = side / 2; level < level_count; ++level, to += n * n, n /= 2) {
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        const uint16_t* p = levels[level - 1] + 4 * y * n + 2 * x;
        to[y * n + x] = rows::rounded(rows::four_point({p[0], p[1], p[2 * n], p[2 * n + 1]}, 16, 16), 2 * rows::weight_bits);
      }
    levels[level] = to;
  }
  return texture_view::make(texel_format::rgb565, levels, level_count, side, side, wrap::repeat, wrap::repeat, out);
}

static status make_planks(texture_view& out) {
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const bool frame_of_box = x < 6 || y < 6 || x >= side - 6 || y >= side - 6, gap = y % 13 == 6;
      const int grain = (x * 3 + (y / 13) * 17) % 29;
      planks[y * side + x] = frame_of_box ? rgb(110 + grain, 66, 30) : gap ? rgb(58, 34, 16) : rgb(180 + grain, 118 + grain, 60);
    }
  const uint16_t* const levels[] = {planks};
  return texture_view::make(texel_format::rgb565, levels, 1, side, side, wrap::clamp, wrap::clamp, out);
}

static constexpr int32_t one = 1 << 16;  // s15.16: lengths in camera space, texels, pixels
static constexpr projection camera{300 * one, 300 * one, 160 * one, 84 * one, one / 8};

// A face of the box, from its corners in clockwise order.
static status draw_face(const rows::frame565& target, const texture_view& map, const vertex (&corners)[4]) {
  static polygon face;
  const status s = make_polygon(corners, 4, camera, {0, 0, width, height}, face);
  if (s == status::degenerate) return status::ok;  // not to be seen
  return s == status::ok ? rows::draw<filter::bilinear>(state, target, face, map) : s;
}

static status draw_box(const rows::frame565& target, const texture_view& map) {
  constexpr int32_t t = side * one, y0 = one * 3 / 10, y1 = one * 13 / 10;             // the floor is at y = 1.3, y down
  constexpr int32_t ax = -one * 9 / 10, az = one * 41 / 10, bx = one * 2 / 10, bz = one * 33 / 10, cx = one * 105 / 100, cz = one * 44 / 10, dx = -one * 5 / 100, dz = one * 52 / 10;
  const vertex left[] = {{ax, y0, az, 0, 0}, {bx, y0, bz, t, 0}, {bx, y1, bz, t, t}, {ax, y1, az, 0, t}};
  const vertex right[] = {{bx, y0, bz, 0, 0}, {cx, y0, cz, t, 0}, {cx, y1, cz, t, t}, {bx, y1, bz, 0, t}};
  const vertex top[] = {{ax, y0, az, 0, 0}, {dx, y0, dz, t, 0}, {cx, y0, cz, t, t}, {bx, y0, bz, 0, t}};
  SPANTEX_TRY(draw_face(target, map, top));
  SPANTEX_TRY(draw_face(target, map, left));
  return draw_face(target, map, right);
}

static status draw_scene() {
  for (int32_t y = 0; y < height; ++y)
    for (int32_t x = 0; x < width; ++x) frame[y * width + x] = rgb(90 + y * 3 / 2 > 235 ? 235 : 90 + y * 3 / 2, 140 + y > 240 ? 240 : 140 + y, 235);
  texture_view floor_map, box_map;
  SPANTEX_TRY(make_tiles(floor_map));
  SPANTEX_TRY(make_planks(box_map));
  const rows::frame565 target{frame, width, height, width};
  // The floor, 1.3 below the eye and turned by 30 degrees: u = 24 (X cos + Z sin) texels, Z = 1.3 * 300 / (y - 84).
  const homography floor{24 * 1126, 0, 24 * (-160 * 1126 + 300 * 650), -24 * 650, 0, 24 * (160 * 650 + 300 * 1126), 0, 1000, -84000};
  plane p{};
  SPANTEX_TRY(make_plane(floor, {0, 0, width, height}, p));
  SPANTEX_TRY(rows::draw<filter::trilinear>(state, target, p, floor_map, {0, 86, width, height}));
  return draw_box(target, box_map);
}

int main() {
  if (draw_scene() != status::ok) return 1;
  return semihosting::write_file(SPANTEX_OUT, frame, sizeof frame) ? 0 : 2;
}
