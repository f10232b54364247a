/* SPDX-License-Identifier: Apache-2.0
 *
 * The C interface in use: a sky, a floor, a rotated picture, a perspective picture and a shadow blended over the floor, into an RGB565 frame of 320 x 240 pixels.
 * tools/demo_drawing makes a PNG of it; docs/DRAWING.md explains. */
#include <spantex/spantex.h>

enum { width = 320, height = 240, side = 64, level_count = 7 };
enum { one = 1 << 16, px = 256 }; /* s15.16, 1/256 pixel */

static uint16_t floor_texels[side * side * 4 / 3 + 1], sky_texels[side * side], picture_texels[side * side];
static spantex_map floor_map, sky_map, picture_map;
static spantex_state state;

static uint16_t rgb(int r, int g, int b) { return (uint16_t)((r >> 3) << 11 | (g >> 2) << 5 | b >> 3); }

static int at_least_0(int x) { return x < 0 ? 0 : x; }

/* Tiles with joints; every level a mean of four. */
static spantex_status make_floor_map(void) {
  const uint16_t *levels[level_count];
  uint16_t *to = floor_texels;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const int grain = (x * 29 + y * 53 + x * y * 7) % 23, joint = x % 32 == 0 || y % 32 == 0, dark = ((x ^ y) & 32) != 0;
      to[y * side + x] = joint ? rgb(60, 55, 50) : dark ? rgb(70 + grain, 95 + grain, 120 + grain) : rgb(200 + grain, 190 + grain, 165 + grain);
    }
  levels[0] = to;
  for (int level = 1, n = side / 2; level < level_count; ++level, n /= 2) {
    const uint16_t *const from = levels[level - 1];
    to += 4 * n * n;
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        int r = 2, g = 2, b = 2;
        for (int k = 0; k < 4; ++k) {
          const uint16_t t = from[(2 * y + k / 2) * 2 * n + 2 * x + k % 2];
          r += t >> 11;
          g += t >> 5 & 63;
          b += t & 31;
        }
        to[y * n + x] = (uint16_t)(r >> 2 << 11 | g >> 2 << 5 | b >> 2);
      }
    levels[level] = to;
  }
  return spantex_map_init(&floor_map, levels, level_count, side, side, SPANTEX_REPEAT, SPANTEX_REPEAT);
}

/* A sky that is alike on four sides, and a target to hang up; round where the key colour is around it. */
static spantex_status make_other_maps(void) {
  const uint16_t *const sky[] = {sky_texels}, *const picture[] = {picture_texels};
  spantex_status status;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const int wave = at_least_0((x < 32 ? x : 63 - x) - (y > 20 ? y - 20 : 20 - y) * 3), dx = 2 * x - 63, dy = 2 * y - 63, square = dx * dx + dy * dy;
      sky_texels[y * side + x] = rgb(80 + y * 2 + wave * 2, 130 + y + wave * 2, 225 + wave / 2);
      picture_texels[y * side + x] = square > 63 * 63 ? rgb(255, 0, 255) : dx * 3 > dy * 9 && dx > 0 ? rgb(250, 220, 60)
                                                                        : (square / 600) % 2 == 0 ? rgb(200, 40, 30) : rgb(240, 240, 235);
    }
  status = spantex_map_init(&sky_map, sky, 1, side, side, SPANTEX_CLAMP, SPANTEX_CLAMP);
  return status != SPANTEX_OK ? status : spantex_map_init(&picture_map, picture, 1, side, side, SPANTEX_CLAMP, SPANTEX_CLAMP);
}

/* Maps must have been made. */
spantex_status draw_into(void *user, spantex_target *target);
spantex_status draw_into(void *user, spantex_target *target) {
  const spantex_camera camera = {250, -60, 30, 260 * one, 160 * one, 100 * one};
  const spantex_floor floor = {0, 0, 13 * one / 10, 24 * one};
  const spantex_map *const faces[6] = {&sky_map, &sky_map, &sky_map, &sky_map, NULL, NULL};
  const spantex_point wall[4] = {{190 * px, 40 * px}, {295 * px, 20 * px}, {300 * px, 190 * px}, {185 * px, 150 * px}};
  const spantex_point shadow[4] = {{60 * px, 196 * px}, {150 * px, 190 * px}, {180 * px, 215 * px}, {50 * px, 225 * px}};
  const spantex_sprite wheel = {{100 * px, 120 * px}, {side / 2 * one, side / 2 * one}, 2 * one, 2 * one, 200};
  const int32_t key = rgb(255, 0, 255);
  spantex_status status;
  (void)user;
  status = spantex_draw_cube(&state, target, faces, SPANTEX_BILINEAR, &camera);
  if (status == SPANTEX_OK) status = spantex_draw_floor(&state, target, &floor_map, SPANTEX_TRILINEAR, &camera, &floor);
  if (status == SPANTEX_OK) status = spantex_draw_quad(&state, target, &floor_map, SPANTEX_BILINEAR, wall, NULL);
  if (status == SPANTEX_OK) status = spantex_target_blend(target, 130, key);
  if (status == SPANTEX_OK) status = spantex_draw_quad(&state, target, &picture_map, SPANTEX_NEAREST, shadow, NULL);
  if (status == SPANTEX_OK) status = spantex_target_blend(target, 255, key);
  return status != SPANTEX_OK ? status : spantex_draw_sprite(&state, target, &picture_map, SPANTEX_NEAREST, &wheel);
}

spantex_status make_maps(void);
spantex_status make_maps(void) {
  const spantex_status status = make_floor_map();
  return status != SPANTEX_OK ? status : make_other_maps();
}

spantex_status draw_scene(uint16_t *frame);
spantex_status draw_scene(uint16_t *frame) {
  const spantex_rectangle screen = {0, 0, width, height};
  spantex_target target;
  spantex_status status = make_maps();
  if (status == SPANTEX_OK) status = spantex_target_init(&target, SPANTEX_RGB565, frame, 2 * width, screen);
  return status != SPANTEX_OK ? status : draw_into(NULL, &target);
}
