// SPDX-License-Identifier: Apache-2.0
// One program of two files that are compiled with other flags: each draws the same pictures in memory of its own.
#pragma once
#include <stdint.h>

#include <firmware/apps/rows_scenes.hpp>
#include <firmware/targets/console.hpp>
#include <spantex/rows/pictures.hpp>

namespace mixed {

inline constexpr int32_t width = 320, height = 240;
extern uint16_t frame_pixels[width * height];
extern spantex::app::map_texels texels;

struct drawn { uint32_t hash; bool beside; };  // beside: something behind the memory was written
drawn draw_elsewhere(spantex::filter kind, int picture);

namespace {

struct memory { spantex::rows::picture_state state; uint32_t guard[256]; };
memory own;

// A scene's plane, or a quad.
drawn draw(spantex::filter kind, int picture) {
  using namespace spantex;
  constexpr uint32_t guard = 0x5A5A5A5A;
  for (uint32_t& x : own.guard) x = guard;
  for (uint16_t& p : frame_pixels) p = 0;
  const rows::frame565 frame{frame_pixels, width, height, width};
  texture_view map;
  status done = texels.view(wrap::repeat, map);
  if (picture < int(sizeof app::scenes / sizeof app::scenes[0])) {
    plane p{};
    if (done == status::ok) done = make_plane(app::scenes[picture].map, {0, 0, width, height}, p);
    if (done == status::ok) done = rows::draw_any(kind, own.state, frame, p, map, rectangle{0, 0, width, height});
  } else {
    constexpr screen_point corners[] = {{20 * 256, 20 * 256}, {300 * 256, 90 * 256}, {310 * 256, 110 * 256}, {10 * 256, 230 * 256}};
    if (done == status::ok) done = rows::draw_any(kind, own.state, frame, rows::quad{{corners[0], corners[1], corners[2], corners[3]}}, map);
  }
  bool beside = done != status::ok;
  for (const uint32_t x : own.guard) beside |= x != guard;
  return {app::hash_of(frame_pixels, width * height, app::hash_seed), beside};
}

}  // namespace
}  // namespace mixed
