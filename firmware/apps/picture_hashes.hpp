// SPDX-License-Identifier: Apache-2.0
// Small pictures whose hashes must be the same on every target, compiler and optimisation level: planes (facing, tilted, with the
// horizon inside), polygons with depth and clipping, maps of power-of-two and other sizes, every filter, wrap mode and profile.
// Runs in about 16 KiB of RAM: maps are constants, the frame is 40 x 32 pixels.
#pragma once
#include <stdint.h>

#include <hal/direct_engine.hpp>
#include <spantex/spantex.hpp>

namespace spantex::app {

inline constexpr int32_t frame_width = 40, frame_height = 32;

// A map with its levels, made when the program is compiled.
template <int Width, int Height>
struct constant_map {
  static constexpr int level_count = bit_length(uint64_t(Width > Height ? Width : Height));
  static constexpr int offset(int level) {
    int sum = 0;
    for (int k = 0; k < level; ++k) sum += level_side(Width, k) * level_side(Height, k);
    return sum;
  }

  rgba8 texels[offset(level_count)];

  constexpr constant_map() : texels() {
    for (int y = 0; y < Height; ++y)
      for (int x = 0; x < Width; ++x) texels[y * Width + x] = pattern(x, y);
    for (int level = 1; level < level_count; ++level) reduce(level);
  }

  constexpr status view(wrap mode, texture_view& out) const {
    const rgba8* levels[max_levels] = {};
    for (int k = 0; k < level_count; ++k) levels[k] = texels + offset(k);
    return texture_view::make(levels, level_count, Width, Height, mode, mode, out);
  }

 private:
  SPANTEX_WRAPS static constexpr rgba8 pattern(int x, int y) {
    const uint32_t n = (uint32_t(x) * 73856093u ^ uint32_t(y) * 19349663u) * 2654435761u;
    return {uint8_t(n >> 24), uint8_t((x * 255) / Width), uint8_t((x / 4 + y / 4) % 2 ? 220 : 40), uint8_t(255 - ((y * 200) / Height))};
  }
  // Every texel from the 2x2 above it; an odd last row or column is left out.
  constexpr void reduce(int level) {
    const int w = level_side(Width, level), h = level_side(Height, level), above = level_side(Width, level - 1),
              tall = level_side(Height, level - 1);
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        const rgba8* from = texels + offset(level - 1);
        const int x0 = min_of(2 * x, above - 1), x1 = min_of(2 * x + 1, above - 1), y0 = min_of(2 * y, tall - 1),
                  y1 = min_of(2 * y + 1, tall - 1);
        const rgba8 a = from[y0 * above + x0], b = from[y0 * above + x1], c = from[y1 * above + x0], d = from[y1 * above + x1];
        texels[offset(level) + y * w + x] = {mean(a.r, b.r, c.r, d.r), mean(a.g, b.g, c.g, d.g), mean(a.b, b.b, c.b, d.b),
                                             mean(a.a, b.a, c.a, d.a)};
      }
  }
  static constexpr uint8_t mean(int a, int b, int c, int d) { return uint8_t((a + b + c + d + 2) / 4); }
};

inline constexpr constant_map<32, 32> square_map;
inline constexpr constant_map<20, 12> odd_map;

enum class picture : uint8_t { facing, tilted, horizon, polygons };
inline constexpr int picture_count = 4;
constexpr const char* name_of(picture p) {
  constexpr const char* names[picture_count] = {"facing", "tilted", "horizon", "polygons"};
  return names[int(p)];
}
inline constexpr int filter_count = 10;
constexpr const char* name_of(filter f) {
  constexpr const char* names[filter_count] = {"nearest",   "bilinear",   "three-point", "mip-bilinear",
                                                "trilinear", "trilinear3", "squares",     "aniso",
                                                "step",      "hat"};
  return names[int(f)];
}
inline constexpr int wrap_count = 3;
constexpr const char* name_of(wrap w) {
  constexpr const char* names[wrap_count] = {"repeat", "clamp", "mirror"};
  return names[int(w)];
}

constexpr homography plane_of(picture p) {
  switch (p) {
    case picture::facing: return {60000, -21000, -180000, 20000, 58000, -90000, 3, -7, 65536};
    case picture::tilted: return {52000, -9000, 350000, -13000, 21000, 1900000, -60, 900, 30000};
    default: return {40000, -3000, 200000, -9000, -6000, 2500000, 150, 4000, -30000};
  }
}

// Two crossing quads, one of which passes behind the camera.
constexpr vertex quads[2][4] = {{{-90000, -60000, 131072, 0, 0},
                                 {90000, -60000, 262144, 32 << 16, 0},
                                 {90000, 70000, 262144, 32 << 16, 32 << 16},
                                 {-90000, 70000, 131072, 0, 32 << 16}},
                                {{-70000, 40000, 262144, -8 << 16, 0},
                                 {80000, 30000, 262144, 24 << 16, 0},
                                 {80000, 60000, -20000, 24 << 16, 64 << 16},
                                 {-70000, 70000, -20000, -8 << 16, 64 << 16}}};

struct scratch {
  rgba8 frame[frame_width * frame_height];
  uint32_t depth[frame_width * frame_height];
};

constexpr uint32_t fnv1a(const rgba8* pixels, int count) {
  uint32_t hash = 2166136261u;
  const auto add = [&](uint8_t byte) SPANTEX_WRAPS { hash = (hash ^ byte) * 16777619u; };
  for (int k = 0; k < count; ++k) {
    add(pixels[k].r); add(pixels[k].g); add(pixels[k].b); add(pixels[k].a);
  }
  return hash;
}

template <class Prof, class Engine>
constexpr status draw(picture what, const texture_view& map, filter kind, renderer<Engine, Prof>& r, scratch& memory) {
  if (what != picture::polygons) {
    plane p{};
    SPANTEX_TRY(make_plane(plane_of(what), {0, 0, frame_width, frame_height}, p));
    SPANTEX_TRY(r.draw(p, map, kind, {0, 0, frame_width, frame_height}));
    return r.finish();
  }
  const projection camera{frame_width << 15, frame_width << 15, frame_width << 15, frame_height << 15, 1 << 14};
  for (const auto& corners : quads) {
    polygon p{};
    SPANTEX_TRY(make_polygon(corners, 4, camera, {0, 0, frame_width, frame_height}, p));
    SPANTEX_TRY(r.draw(p, map, kind, {memory.depth}));
  }
  return r.finish();
}

// Hash of one picture; 0 if a status stopped it.
template <class Prof, class Engine>
constexpr uint32_t hash_of(picture what, filter kind, wrap mode, bool odd_size, Engine& engine, scratch& memory) {
  for (int k = 0; k < frame_width * frame_height; ++k) {
    memory.frame[k] = {};
    memory.depth[k] = 0;
  }
  texture_view map;
  if ((odd_size ? odd_map.view(mode, map) : square_map.view(mode, map)) != status::ok) return 0;
  renderer<Engine, Prof> r(engine, Prof{}, {memory.frame, frame_width, frame_height, frame_width});
  if (draw(what, map, kind, r, memory) != status::ok) return 0;
  return fnv1a(memory.frame, frame_width * frame_height);
}

// All pictures of a profile: report(picture, filter, wrap, odd size, hash).
template <class Prof, class Report>
void each_hash(scratch& memory, direct_engine<Prof>& engine, Report report) {
  for (int what = 0; what < picture_count; ++what)
    for (int kind = 0; kind < filter_count; ++kind)
      for (int mode = 0; mode < wrap_count; ++mode)
        for (int odd = 0; odd < 2; ++odd)
          report(picture(what), filter(kind), wrap(mode), odd != 0,
                 hash_of<Prof>(picture(what), filter(kind), wrap(mode), odd != 0, engine, memory));
}

// --- contours, linear light, write-out -----------------------------------------------------------------

struct style { const char* name; filter kind; bool linear_light, vertex_colours; contour_style contour; shading how; };
inline constexpr style styles[] = {
    {"contour-fill", filter::contour, false, false, {130 << 8, 40 << 8, 0, field_unit::level_0}, {}},
    {"contour-line", filter::contour, true, false, {100 << 8, 70 << 7, 29, field_unit::own_level}, {alpha_mode::blended}},
    {"linear-three-point", filter::three_point, true, false, {}, {}},
    {"linear-trilinear", filter::trilinear, true, true, {}, {alpha_mode::premultiplied}},
    {"linear-squares", filter::squares, true, false, {}, {}},
    {"linear-aniso", filter::aniso, true, false, {}, {alpha_mode::opaque, 0, {200, 255, 90, 17}}},
    {"cut-out", filter::mip_bilinear, false, true, {}, {alpha_mode::cut_out, 150}},
    {"blended", filter::bilinear, false, true, {}, {alpha_mode::blended}}};

inline constexpr rgba8 vertex_colours[4] = {{255, 0, 10, 255}, {20, 255, 200, 255}, {255, 255, 255, 60}, {0, 90, 255, 200}};

template <class Prof>
uint32_t shaded_hash_of(picture what, const style& s, direct_engine<Prof>& engine, scratch& memory) {
  for (int k = 0; k < frame_width * frame_height; ++k) {
    memory.frame[k] = {9, 99, 199, 255};
    memory.depth[k] = 0;
  }
  texture_view map;
  if (odd_map.view(wrap::repeat, map) != status::ok || map.set_contour(s.contour) != status::ok) return 0;
  if (s.linear_light) map.set_colours(colour_space::srgb);
  renderer<direct_engine<Prof>, Prof, shading> r(engine, Prof{}, {memory.frame, frame_width, frame_height, frame_width});
  const rectangle screen{0, 0, frame_width, frame_height};
  if (what != picture::polygons) {
    plane p{};
    if (make_plane(plane_of(what), screen, p) != status::ok || r.draw(p, map, s.kind, screen, s.how) != status::ok) return 0;
    return r.finish() == status::ok ? fnv1a(memory.frame, frame_width * frame_height) : 0;
  }
  const projection camera{frame_width << 15, frame_width << 15, frame_width << 15, frame_height << 15, 1 << 14};
  for (const auto& corners : quads) {
    polygon p{};
    colour_forms colours{};
    if (make_polygon(corners, vertex_colours, 4, camera, screen, p, colours) != status::ok) return 0;
    shading how = s.how;
    if (s.vertex_colours) how.colours = &colours;
    if (r.draw(p, map, s.kind, {memory.depth}, how) != status::ok) return 0;
  }
  return r.finish() == status::ok ? fnv1a(memory.frame, frame_width * frame_height) : 0;
}

// report(picture, style's name, hash), the map of 20 x 12 texels, repeated.
template <class Prof, class Report>
void each_shaded_hash(scratch& memory, direct_engine<Prof>& engine, Report report) {
  for (int what = 0; what < picture_count; ++what)
    for (const style& s : styles) report(picture(what), s.name, shaded_hash_of(picture(what), s, engine, memory));
}

}  // namespace spantex::app
