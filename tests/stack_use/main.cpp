// SPDX-License-Identifier: Apache-2.0
// How deep the stack goes below each call of the C interface: what lies below is painted, the call made with random pictures, formats and filters, and the paint looked
// for. A line "function bytes pictures" each, numbers in hexadecimal; pictures: calls that succeeded.
#include <spantex/spantex.h>

#include <firmware/targets/console.hpp>

namespace {

constexpr int side = 64, level_count = 7, width = 48, height = 40, rounds = 400;
constexpr int32_t one = 1 << 16;
uint16_t texels[side * side * 4 / 3 + 1];
alignas(4) uint8_t pixels[4 * width * height];
spantex_map map;
spantex_target target;
spantex_state state;

uint32_t seed = 1;
int32_t random_from(int32_t low, int32_t high) {  // high not included
  seed = seed * 1664525u + 1013904223u;
  return low + int32_t((seed >> 8) % uint32_t(high - low));
}
int32_t random_s16(int32_t low, int32_t high) { return random_from(low * 256, high * 256) * 256; }

enum function : int { map_init, target_init, target_fill, plane, quad, sprite, triangles, mesh, floor, cube, function_count };
constexpr const char* names[function_count] = {"map_init", "target_init", "target_fill", "draw_plane", "draw_quad", "draw_sprite", "draw_triangles", "draw_mesh", "draw_floor", "draw_cube"};
uint32_t deepest[function_count], drawn[function_count];

template <class Call>
[[gnu::noinline]] void watch(function f, const Call& call) {
  constexpr uint32_t paint = 0xC5C5C5C5, words = 512;
  volatile uint32_t* top;
  asm volatile("mov %0, sp" : "=r"(top));
  for (volatile uint32_t* p = top - words; p < top; ++p) *p = paint;
  drawn[f] += call() == SPANTEX_OK;
  volatile uint32_t* p = top - words;
  while (p < top && *p == paint) ++p;
  const uint32_t bytes = uint32_t(top - p) * 4;
  if (bytes > deepest[f]) deepest[f] = bytes;
}

spantex_wrap random_wrap() { return spantex_wrap(random_from(0, 3)); }
spantex_point random_point() { return {random_from(-20 * 256, (width + 20) * 256), random_from(-20 * 256, (height + 20) * 256)}; }
spantex_camera random_camera() { return {random_from(0, 3600), random_from(-900, 900), random_from(0, 3600), random_s16(10, 90), random_s16(0, width), random_s16(0, height)}; }

void make_map() {
  const uint16_t* levels[level_count];
  for (uint16_t& t : texels) t = uint16_t(random_from(0, 65536));
  levels[0] = texels;
  for (int k = 1; k < level_count; ++k) levels[k] = levels[k - 1] + (side >> (k - 1)) * (side >> (k - 1));
  const spantex_wrap u = random_wrap(), v = random_wrap();
  watch(map_init, [&] { return spantex_map_init(&map, levels, level_count, side, side, u, v); });
}

void make_target() {
  constexpr int32_t stride[] = {2, 2, 3, 3, 4, 4, 1, 1, 1, 1};
  const int format = random_from(0, 10);
  watch(target_init, [&] { return spantex_target_init(&target, spantex_format(format), pixels, stride[format] * width, {0, 0, width, height}); });
  if (random_from(0, 2)) spantex_target_clip(&target, {random_from(0, 20), random_from(0, 20), random_from(20, width), random_from(20, height)});
  if (random_from(0, 2)) spantex_target_blend(&target, uint8_t(random_from(0, 256)), random_from(-1, 65536));
  watch(target_fill, [&] { return spantex_target_fill(&target, uint16_t(random_from(0, 65536))); });
}

void draw_all(spantex_filter kind) {
  const spantex_matrix matrix = {random_s16(-3, 4), random_s16(-3, 4), random_s16(-200, 200), random_s16(-3, 4), random_s16(-3, 4), random_s16(-200, 200),
                                 random_from(-900, 900), random_from(-900, 900), one};
  watch(plane, [&] { return spantex_draw_plane(&state, &target, &map, kind, &matrix, {0, 0, width, height}); });
  const spantex_point first = random_point(), last = {first.x + random_from(1, 9000), first.y + random_from(1, 9000)};
  const spantex_point corners[4] = {first, {last.x, first.y}, random_from(0, 2) ? spantex_point{last.x + 300, last.y} : random_point(), {first.x, last.y}};
  spantex_texel_point at[4];
  for (spantex_texel_point& p : at) p = {random_s16(-90, 90), random_s16(-90, 90)};
  const bool own = random_from(0, 2) != 0;
  watch(quad, [&] { return spantex_draw_quad(&state, &target, &map, kind, corners, own ? at : nullptr); });
  const spantex_sprite picture = {random_point(), at[0], random_s16(-3, 4), random_s16(-3, 4), random_from(0, 3600)};
  watch(sprite, [&] { return spantex_draw_sprite(&state, &target, &map, kind, &picture); });
  spantex_screen_vertex on_screen[6];
  spantex_vertex in_space[6];
  for (int k = 0; k < 6; ++k) {
    on_screen[k] = {random_point(), {random_s16(-90, 90), random_s16(-90, 90)}, uint32_t(random_from(1, 100000))};
    in_space[k] = {random_s16(-9, 10), random_s16(-9, 10), random_s16(-4, 20), random_s16(-90, 90), random_s16(-90, 90)};
  }
  watch(triangles, [&] { return spantex_draw_triangles(&state, &target, &map, kind, on_screen, 6, nullptr, 2, 1); });
  const spantex_projection camera = {40 * one, 40 * one, width / 2 * one, height / 2 * one, one};
  watch(mesh, [&] { return spantex_draw_mesh(&state, &target, &map, kind, &camera, in_space, 6, nullptr, 2, 1); });
  const spantex_camera seen_by = random_camera();
  const spantex_floor ground = {random_s16(-90, 90), random_s16(-90, 90), random_s16(-3, 4), random_s16(1, 60)};
  watch(floor, [&] { return spantex_draw_floor(&state, &target, &map, kind, &seen_by, &ground); });
  const spantex_map* const faces[6] = {&map, &map, &map, &map, &map, &map};
  watch(cube, [&] { return spantex_draw_cube(&state, &target, faces, kind, &seen_by); });
}

}  // namespace

int main() {
  for (int k = 0; k < rounds; ++k) {
    make_map();
    make_target();
    draw_all(spantex_filter(k % 5));
  }
  for (int f = 0; f < function_count; ++f) {
    console::print("spantex_");
    console::print(names[f]);
    console::print(" ");
    console::print_hex(deepest[f]);
    console::print(" ");
    console::print_hex(drawn[f]);
    console::print("\n");
  }
  return 0;
}
