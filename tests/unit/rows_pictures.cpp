// SPDX-License-Identifier: Apache-2.0
// What programs draw in one call: quads hit their corners, sprites at every tenth of a degree and floors and cubes in every direction are where exact or
// double arithmetic says, every part of a screen gets the pixels of the whole, and what cannot be drawn is refused.
#include <tests/support.hpp>

#include <algorithm>
#include <cmath>

#include <firmware/apps/rows_scenes.hpp>
#include <spantex/rows/pictures.hpp>
#include <spantex/rows/targets.hpp>

using namespace spantex;
using namespace spantex::sim;
using namespace spantex::rows;

namespace {

constexpr int32_t width = 96, height = 72, one = 1 << 16;
constexpr rectangle screen{0, 0, width, height};
constexpr double pi = 3.14159265358979323846;
picture_state memory;
uint16_t frame[width * height], other[width * height];
const frame565 target{frame, width, height, width};
app::map_texels texels;
polygon shape;
plane ground;

texture_view make_view(wrap mode) {
  texels.make();
  texture_view t;
  SPANTEX_ASSERT_OK(texels.view(mode, t));
  return t;
}

// A map of its own size, no two texels alike.
uint16_t small_texels[64 * 64];
texture_view make_small(int32_t w, int32_t h) {
  for (int k = 0; k < w * h; ++k) small_texels[k] = uint16_t(k * 31 + 1);
  const uint16_t* const levels[] = {small_texels};
  texture_view t;
  SPANTEX_ASSERT_OK(texture_view::make(texel_format::rgb565, levels, 1, w, h, wrap::clamp, wrap::clamp, t));
  return t;
}

void clear() { std::fill(std::begin(frame), std::end(frame), uint16_t(0)); }
bool covered(const polygon& p, int32_t x, int32_t y) { return (coverage(p.edges, x / 8, y / 8) & rectangle_mask(p.box, x / 8, y / 8)) >> (y % 8 * 8 + x % 8) & 1; }

int32_t between(random_source& random, int32_t low, int32_t high) { return int32_t(random.between(low, high)); }
int32_t px(int32_t x) { return x * 256; }

// --- quads and triangles -----------------------------------------------------------------------------------

// Numerators and divisor at a corner, of the forms as they were before their last rounding.
struct fraction { int128 u, v, w; };
fraction at_corner(const plane& p, screen_point at) {
  const auto value = [&](const linear_form& f, const wide_form& exact) {
    const bool rounded = p.dropped_bits > 0;
    const int128 x = rounded ? to_int128(exact.x) : f.x, y = rounded ? to_int128(exact.y) : f.y, c = rounded ? to_int128(exact.c) : f.c;
    return 128 * c + x * (at.x - 128 * p.origin_x) + y * (at.y - 128 * p.origin_y);
  };
  return {value(p.u, p.exact_u), value(p.v, p.exact_v), value(p.w, p.exact_w)};
}
// Of corners on whole texels.
bool hits(const plane& p, screen_point at, texel_point t) {
  const fraction f = at_corner(p, at);
  return f.w > 0 && f.u == f.w * (t.u >> 16) && f.v == f.w * (t.v >> 16);
}
double miss_texels(const plane& p, screen_point at, texel_point t) {
  const fraction f = at_corner(p, at);
  const auto off = [&](int128 n, int32_t x) { return std::abs(double((long double)n / (long double)f.w - (long double)x / 65536)); };
  return f.w > 0 ? std::max(off(f.u, t.u), off(f.v, t.v)) : 1e9;
}

// Of a triangle, doubled.
double area_of(int64_t px, int64_t py, int64_t qx, int64_t qy, int64_t rx, int64_t ry) { return std::abs(double((qx - px) * (ry - py) - (qy - py) * (rx - px))); }

SPANTEX_CASE(quads_hit_their_corners_exactly_by_the_map_s_rectangle) {
  random_source random(1);
  int made = 0;
  for (int n = 0; n < 4000; ++n) {
    screen_point c[4];
    for (screen_point& p : c) p = {between(random, -px(20), px(140)), between(random, -px(20), px(140))};
    const map_corners map = corners_of_map(between(random, 1, 512), between(random, 1, 512));
    const status s = make_quad(c, {map.at[0], map.at[1], map.at[2], map.at[3]}, screen, shape);
    if (s == status::degenerate) continue;
    SPANTEX_ASSERT_OK(s);
    ++made;
    for (int k = 0; k < 4; ++k) assert_true(hits(shape.map, c[k], map.at[k]));
  }
  assert_true(made > 500);
}

SPANTEX_CASE(quads_between_any_convex_corners_hit_them) {
  random_source random(2);
  int made = 0;
  double worst = 0;
  for (int n = 0; n < 40000; ++n) {
    const int32_t reach = px(1) << random.between(4, 12);
    screen_point c[4];
    texel_point map[4];
    for (screen_point& p : c) p = {between(random, -reach, reach), between(random, -reach, reach)};
    for (texel_point& t : map) t = {between(random, -256 * one, 256 * one), between(random, -256 * one, 256 * one)};
    const status s = make_quad(c, map, {0, 0, 4096, 4096}, shape);
    if (s == status::degenerate) continue;
    SPANTEX_ASSERT_OK(s);
    ++made;
    // Slivers, whose smallest triangle is less than a thousandth of the largest, magnify what rounding of depths leaves.
    double least = 1e30, most = 0;
    for (int k = 0; k < 4; ++k) {
      const auto shown = [&](int at) { return map[at % 4]; };
      const auto seen = [&](int at) { return c[at % 4]; };
      const double a = area_of(shown(k + 1).u, shown(k + 1).v, shown(k + 2).u, shown(k + 2).v, shown(k + 3).u, shown(k + 3).v);
      const double b = area_of(seen(k + 1).x, seen(k + 1).y, seen(k + 2).x, seen(k + 2).y, seen(k + 3).x, seen(k + 3).y);
      least = std::min(least, b / a);
      most = std::max(most, b / a);
    }
    if (most > 1000 * least) continue;
    for (int k = 0; k < 4; ++k) worst = std::max(worst, miss_texels(shape.map, c[k], map[k]));
  }
  print_message("%d quads, worst corner %.3g texels off\n", made, worst);
  assert_true(made > 1000);
  assert_true(worst < 1.0 / 65536);
}

SPANTEX_CASE(an_upright_quad_copies_its_map) {
  const texture_view t = make_small(37, 23);
  clear();
  const screen_point c[] = {{px(5), px(7)}, {px(42), px(7)}, {px(42), px(30)}, {px(5), px(30)}};
  SPANTEX_ASSERT_OK(rows::draw<filter::nearest>(memory, target, quad{{c[0], c[1], c[2], c[3]}}, t));
  const texel_point flipped[] = {{37 * one, 0}, {0, 0}, {0, 23 * one}, {37 * one, 23 * one}};
  for (int mirrored = 0; mirrored < 2; ++mirrored) {
    if (mirrored) SPANTEX_ASSERT_OK(rows::draw_any(filter::nearest, memory, target, quad{{c[0], c[1], c[2], c[3]}, flipped}, t));
    for (int32_t y = 0; y < height; ++y)
      for (int32_t x = 0; x < width; ++x) {
        const bool in = x >= 5 && x < 42 && y >= 7 && y < 30;
        assert_int_equal(frame[y * width + x], in ? small_texels[(y - 7) * 37 + (mirrored ? 41 - x : x - 5)] : 0);
      }
  }
}

// Set up if and only if their box, as it is found for the largest screen, meets the clip rectangle.
SPANTEX_CASE(pictures_at_the_edges_of_the_screen_are_left_out_when_they_do_not_meet_it) {
  random_source random(9);
  constexpr rectangle clip{100, 100, 148, 136};
  int met = 0, beside = 0;
  for (int n = 0; n < 20000; ++n) {
    const int32_t x = between(random, px(80), px(160)), y = between(random, px(80), px(150)), side = between(random, 16, px(24));
    const screen_point c[] = {{x, y}, {x + side, y + between(random, -64, 64)}, {x + side, y + side}, {x, y + side}};
    const map_corners map = corners_of_map(16, 16);
    const screen_vertex v[] = {{c[0], map.at[0], 1}, {c[1], map.at[1], 2}, {c[2], map.at[2], 3}};
    const sprite turned{{x, y}, {8 * one, 8 * one}, side * 16, side * 16, between(random, 0, 3599)};
    const auto made = [&](int what, rectangle within, polygon& out) {
      return what == 0 ? make_quad({c[0], c[1], c[2], c[3]}, {map.at[0], map.at[1], map.at[2], map.at[3]}, within, out)
             : what == 1 ? make_triangle({v[0], v[1], v[2]}, within, out) : make_sprite(turned, 16, 16, within, out);
    };
    for (int what = 0; what < 3; ++what) {
      if (made(what, {0, 0, 4096, 4096}, shape) != status::ok) continue;
      const rectangle box = intersection(shape.box, clip);
      const status s = made(what, clip, shape);
      assert_int_equal(int(s), int(box.empty() ? status::degenerate : status::ok));
      ++(box.empty() ? beside : met);
      if (s == status::ok) assert_true(shape.box == box);
    }
  }
  assert_true(met > 5000 && beside > 5000);
}

SPANTEX_CASE(quads_that_are_none_are_refused) {
  const map_corners m = corners_of_map(16, 16);
  const auto made = [&](screen_point a, screen_point b, screen_point c, screen_point d, rectangle clip = screen) {
    return make_quad({a, b, c, d}, {m.at[0], m.at[1], m.at[2], m.at[3]}, clip, shape);
  };
  const screen_point a{px(4), px(4)}, b{px(40), px(4)}, c{px(40), px(40)}, d{px(4), px(40)};
  SPANTEX_ASSERT_OK(made(a, b, c, d));
  SPANTEX_ASSERT_OK(made(a, d, c, b));                                                    // the other way round: mirrored
  SPANTEX_ASSERT_STATUS(made(a, c, b, d), degenerate);                                    // crosses itself
  SPANTEX_ASSERT_STATUS(made(a, b, {px(10), px(10)}, d), degenerate);                     // not convex
  SPANTEX_ASSERT_STATUS(made(a, {px(20), px(20)}, c, d), degenerate);                     // three in line
  SPANTEX_ASSERT_STATUS(made(a, a, c, d), degenerate);
  SPANTEX_ASSERT_STATUS(made(a, b, c, d, {50, 50, 60, 60}), degenerate);                  // outside
  SPANTEX_ASSERT_STATUS(made(a, b, c, d, {0, 0, 0, 0}), bad_size);
  SPANTEX_ASSERT_STATUS(made(a, {max_corner, 0}, c, d), out_of_range);
  SPANTEX_ASSERT_STATUS(make_quad({a, b, c, d}, {m.at[0], m.at[1], m.at[2], {0, max_texel + 1}}, screen, shape), out_of_range);
  SPANTEX_ASSERT_STATUS(make_quad({a, b, c, d}, {m.at[0], m.at[2], m.at[1], m.at[3]}, screen, shape), degenerate);
  SPANTEX_ASSERT_OK(made({-max_corner + 1, -max_corner + 1}, {max_corner - 1, -max_corner + 1}, {max_corner - 1, max_corner - 1}, {-max_corner + 1, max_corner - 1}));
  assert_true(covered(shape, 0, 0) && covered(shape, width - 1, height - 1));
}

SPANTEX_CASE(triangles_on_the_screen_are_those_of_camera_space) {
  random_source random(3);
  const projection camera{64 * one, 64 * one, 48 * one, 36 * one, one / 8};
  int made = 0;
  for (int n = 0; n < 3000; ++n) {
    // On whole pixels, so that both have the same corners: x = 64 X / Z + 48.
    vertex v[3];
    screen_vertex s[3];
    for (int k = 0; k < 3; ++k) {
      const int32_t z = between(random, 1, 7) * one, x = between(random, -60, 60), y = between(random, -50, 50);
      v[k] = {x * (z / 64), y * (z / 64), z, between(random, 0, 100) * one, between(random, 0, 100) * one};
      s[k] = {{px(x + 48), px(y + 36)}, {v[k].u, v[k].v}, uint32_t(z)};
    }
    static polygon other_shape;
    const status a = make_polygon(v, 3, camera, screen, other_shape), b = make_triangle({s[0], s[1], s[2]}, screen, shape);
    assert_int_equal(int(a), int(b));
    if (a != status::ok) continue;
    ++made;
    assert_true(shape.front_facing == other_shape.front_facing);
    for (int k = 0; k < 3; ++k) assert_true(hits(shape.map, s[k].at, s[k].map));
    for (int32_t y = 0; y < height; y += 5)
      for (int32_t x = 0; x < width; x += 3) {
        if (!covered(shape, x, y)) continue;
        assert_true(covered(other_shape, x, y));
        const auto u = [&](const plane& p) { return double(p.u_at(2 * x + 1, 2 * y + 1)) / double(p.w_at(2 * x + 1, 2 * y + 1)); };
        assert_true(std::abs(u(shape.map) - u(other_shape.map)) < 1e-6);
      }
  }
  assert_true(made > 1000);
}

SPANTEX_CASE(triangle_lists_cover_a_square_once_cull_and_refuse) {
  const texture_view t = make_small(32, 32);
  // Two triangles of one quad, by indices; the second turned the other way.
  const screen_vertex v[] = {{{px(8), px(8)}, {0, 0}, 5}, {{px(40), px(8)}, {32 * one, 0}, 5}, {{px(40), px(40)}, {32 * one, 32 * one}, 5}, {{px(8), px(40)}, {0, 32 * one}, 5},
                             {{px(60), px(60)}, {0, 0}, 1}};
  const uint16_t indices[] = {0, 1, 2, 0, 3, 2, 4, 4, 4, 0, 1, 9};
  triangle_list list{v, 5, indices, 3};
  clear();
  SPANTEX_ASSERT_OK(rows::draw<filter::nearest>(memory, target, list, t));
  for (int32_t y = 0; y < height; ++y)
    for (int32_t x = 0; x < width; ++x) assert_int_equal(frame[y * width + x], x >= 8 && x < 40 && y >= 8 && y < 40 ? small_texels[(y - 8) * 32 + x - 8] : 0);
  clear();
  list.cull = culling::back;
  SPANTEX_ASSERT_OK(rows::draw<filter::nearest>(memory, target, list, t));
  for (int32_t y = 0; y < height; ++y)
    for (int32_t x = 0; x < width; ++x) assert_int_equal(frame[y * width + x] != 0, x >= 8 && x < 40 && y >= 8 && y < 40 && x >= y);
  clear();
  list.triangle_count = 4;
  SPANTEX_ASSERT_STATUS(rows::draw<filter::nearest>(memory, target, list, t), out_of_range);  // an index beyond, found before anything is drawn
  SPANTEX_ASSERT_STATUS(rows::draw<filter::nearest>(memory, target, triangle_list{v, 5, nullptr, 2}, t), out_of_range);
  SPANTEX_ASSERT_STATUS(rows::draw<filter::nearest>(memory, target, triangle_list{nullptr, 5, indices, 1}, t), bad_pointer);
  SPANTEX_ASSERT_STATUS(rows::draw<filter::nearest>(memory, target, triangle_list{v, 5, indices, -1}, t), bad_size);
  SPANTEX_ASSERT_STATUS(rows::draw<filter::aniso>(memory, target, triangle_list{v, 5, indices, 1}, t), out_of_range);
  for (uint16_t pixel : frame) assert_int_equal(pixel, 0);
  SPANTEX_ASSERT_OK(rows::draw<filter::nearest>(memory, target, triangle_list{nullptr, 0, nullptr, 0}, t));
  screen_vertex flat[] = {v[0], v[1], v[2]};
  flat[1].w = 0;
  SPANTEX_ASSERT_STATUS(rows::draw<filter::nearest>(memory, target, triangle_list{flat, 3, nullptr, 1}, t), out_of_range);
  // The same in camera space.
  const vertex w[] = {{-one, -one, 4 * one, 0, 0}, {one, -one, 4 * one, 32 * one, 0}, {one, one, 4 * one, 32 * one, 32 * one}};
  SPANTEX_ASSERT_OK(rows::draw<filter::nearest>(memory, target, mesh{w, 3, nullptr, 1, {64 * one, 64 * one, 48 * one, 36 * one, one}}, t));
  assert_true(frame[36 * width + 50] != 0);
}

// --- sprites -----------------------------------------------------------------------------------------------

SPANTEX_CASE(sprites_lie_where_double_arithmetic_says_at_every_tenth_of_a_degree) {
  random_source random(4);
  double worst = 0;
  for (int angle = 0; angle < 3600; ++angle) {
    assert_int_equal(spantex::detail::angle_of(angle).turn, uint32_t(((uint64_t(angle) << 32) + 1800) / 3600));
    assert_int_equal(spantex::detail::angle_of(angle - 3600 * int(random.between(0, 500000))).turn, spantex::detail::angle_of(angle).turn);
    const int32_t w = between(random, 1, 64), h = between(random, 1, 64);
    sprite s{{between(random, 0, px(width)), between(random, 0, px(height))}, {between(random, 0, w * one), between(random, 0, h * one)}, between(random, one / 4, 4 * one),
             between(random, one / 4, 4 * one), angle};
    if (random.next() % 4 == 0) s.scale_x = -s.scale_x;
    if (random.next() % 4 == 0) s.scale_y = -s.scale_y;
    const status made = make_sprite(s, w, h, screen, shape);
    if (made == status::degenerate) continue;  // turned off the screen
    SPANTEX_ASSERT_OK(made);
    assert_true(shape.front_facing == ((s.scale_x < 0) == (s.scale_y < 0)));
    const double c = std::cos(angle * pi / 1800), si = std::sin(angle * pi / 1800);
    for (int32_t y = 0; y < height; y += 3)
      for (int32_t x = 0; x < width; x += 3) {
        const double dx = x + 0.5 - s.at.x / 256.0, dy = y + 0.5 - s.at.y / 256.0;
        const double u = s.pivot.u / 65536.0 + (c * dx + si * dy) * 65536 / s.scale_x, v = s.pivot.v / 65536.0 + (c * dy - si * dx) * 65536 / s.scale_y;
        const double wu = double(shape.map.u_at(2 * x + 1, 2 * y + 1)) / double(shape.map.w_at(2 * x + 1, 2 * y + 1));
        const double wv = double(shape.map.v_at(2 * x + 1, 2 * y + 1)) / double(shape.map.w_at(2 * x + 1, 2 * y + 1));
        worst = std::max({worst, std::abs(u - wu), std::abs(v - wv)});
        // Corners are rounded to 1/256 pixel.
        const double mu = 65536.0 / 100 / std::abs(s.scale_x), mv = 65536.0 / 100 / std::abs(s.scale_y);
        if (u > mu && v > mv && u < w - mu && v < h - mv) assert_true(covered(shape, x, y));
        if (u < -mu || v < -mv || u > w + mu || v > h + mv) assert_false(covered(shape, x, y));
      }
  }
  print_message("worst %.3g texels\n", worst);
  assert_true(worst < 2e-6);
}

SPANTEX_CASE(sprites_at_right_angles_copy_their_maps) {
  const texture_view t = make_small(30, 20);
  for (int quarter = -4; quarter < 8; ++quarter) {
    clear();
    SPANTEX_ASSERT_OK(rows::draw<filter::nearest>(memory, target, sprite{{px(48), px(36)}, {10 * one, 5 * one}, one, one, 900 * quarter}, t));
    for (int32_t y = 0; y < height; ++y)
      for (int32_t x = 0; x < width; ++x) {
        // Clockwise: a texel right of the pivot goes down, a texel below it to the left.
        int32_t u = x - 48, v = y - 36;
        for (int k = 0; k < (quarter & 3); ++k) {
          const int32_t previous = u;
          u = v;
          v = -1 - previous;
        }
        u += 10;
        v += 5;
        const bool in = u >= 0 && u < 30 && v >= 0 && v < 20;
        assert_int_equal(frame[y * width + x], in ? small_texels[v * 30 + u] : 0);
      }
  }
}

SPANTEX_CASE(sprites_scale_as_asked_and_bad_ones_are_refused) {
  const texture_view t = make_small(8, 8);
  clear();
  SPANTEX_ASSERT_OK(rows::draw<filter::nearest>(memory, target, sprite{{px(10), px(10)}, {0, 0}, 3 * one, -2 * one, 0}, t));
  for (int32_t y = 0; y < height; ++y)
    for (int32_t x = 0; x < width; ++x) {
      const bool in = x >= 10 && x < 34 && y < 10;
      assert_int_equal(frame[y * width + x], in && y >= 0 && 9 - y < 16 ? small_texels[(9 - y) / 2 * 8 + (x - 10) / 3] : 0);
    }
  const sprite good{{px(10), px(10)}, {0, 0}, one, one, 0};
  const auto made = [&](const sprite& s, int32_t w = 8, int32_t h = 8, rectangle clip = screen) { return make_sprite(s, w, h, clip, shape); };
  const auto with = [&](auto change) { sprite s = good; change(s); return s; };
  SPANTEX_ASSERT_OK(made(good));
  SPANTEX_ASSERT_STATUS(made(with([](sprite& s) { s.scale_x = 0; })), degenerate);
  SPANTEX_ASSERT_STATUS(made(with([](sprite& s) { s.scale_y = 0; })), degenerate);
  SPANTEX_ASSERT_STATUS(made(with([](sprite& s) { s.at.x = max_corner; })), out_of_range);
  SPANTEX_ASSERT_STATUS(made(with([](sprite& s) { s.at.x = px(1000); })), degenerate);  // off the screen
  SPANTEX_ASSERT_STATUS(made(with([](sprite& s) { s.scale_x = s.scale_y = INT32_MIN; s.pivot = {INT32_MIN, INT32_MIN}; })), out_of_range);
  SPANTEX_ASSERT_STATUS(made(good, 0, 8), bad_size);
  SPANTEX_ASSERT_STATUS(made(good, 8, 4097), bad_size);
  SPANTEX_ASSERT_STATUS(made(good, 8, 8, {0, 0, 4097, 8}), bad_size);
  SPANTEX_ASSERT_OK(made(with([](sprite& s) { s.scale_x = s.scale_y = 10000 * one; s.pivot = {4 * one, 4 * one}; })));
  assert_true(covered(shape, 0, 0) && covered(shape, width - 1, height - 1));
}

// --- around a camera -----------------------------------------------------------------------------------------

struct direction { double ahead, up, right; };
direction ray(const looking_camera& c, int32_t x, int32_t y) {
  const double r = c.roll * pi / 1800, p = c.pitch * pi / 1800, h = c.heading * pi / 1800;
  const double dx = x + 0.5 - c.centre_x / 65536.0, dy = c.centre_y / 65536.0 - y - 0.5, f = c.focal / 65536.0;
  const double right = dx * std::cos(r) + dy * std::sin(r), up = dy * std::cos(r) - dx * std::sin(r);  // a camera whose right side is lowered
  const double level = f * std::cos(p) - up * std::sin(p), rise = f * std::sin(p) + up * std::cos(p);
  return {level * std::cos(h) - right * std::sin(h), rise, level * std::sin(h) + right * std::cos(h)};
}

looking_camera random_camera(random_source& random) {
  return {between(random, -4000, 4000), between(random, -900, 900), between(random, -1800, 1800), between(random, 30 * one, 200 * one), between(random, 0, width * one),
          between(random, 0, height * one)};
}

SPANTEX_CASE(floors_and_ceilings_lie_where_rays_meet_them) {
  random_source random(5);
  int made = 0, pixels = 0;
  for (int n = 0; n < 1500; ++n) {
    const looking_camera camera = random_camera(random);
    const floor_map map{between(random, -100 * one, 100 * one), between(random, -100 * one, 100 * one), between(random, 0, 1) != 0 ? between(random, one, 9 * one) : -between(random, one, 9 * one),
                        between(random, one, 40 * one)};
    const status s = make_floor(camera, map, screen, ground);
    if (s == status::degenerate) continue;
    SPANTEX_ASSERT_OK(s);
    ++made;
    for (int32_t y = 0; y < height; y += 7)
      for (int32_t x = 0; x < width; x += 7) {
        const direction d = ray(camera, x, y);
        const double length = std::sqrt(d.ahead * d.ahead + d.up * d.up + d.right * d.right), h = map.height / 65536.0, t = map.texels_per_unit / 65536.0;
        if (std::abs(d.up) < 0.02 * length) continue;
        const int64_t w = ground.w_at(2 * x + 1, 2 * y + 1);
        assert_true((w > 0) == ((d.up < 0) == (h > 0)));
        if (w <= 0) continue;
        ++pixels;
        const double u = t * (map.x / 65536.0 - h * d.ahead / d.up), v = t * (map.z / 65536.0 - h * d.right / d.up);
        assert_true(std::abs(u - double(ground.u_at(2 * x + 1, 2 * y + 1)) / double(w)) < 1e-3);
        assert_true(std::abs(v - double(ground.v_at(2 * x + 1, 2 * y + 1)) / double(w)) < 1e-3);
      }
  }
  print_message("%d planes, %d pixels\n", made, pixels);
  assert_true(made > 500 && pixels > 30000);
  const looking_camera level{0, 0, 0, 64 * one, 48 * one, 20 * one};
  SPANTEX_ASSERT_STATUS(make_floor(level, {0, 0, 0, one}, screen, ground), degenerate);
  SPANTEX_ASSERT_STATUS(make_floor({0, 899, 0, 64 * one, 48 * one, 36 * one}, {0, 0, one, one}, screen, ground), degenerate);  // looks up
  SPANTEX_ASSERT_STATUS(make_floor(level, {0, 0, one, 0}, screen, ground), out_of_range);
  SPANTEX_ASSERT_STATUS(make_floor({0, 0, 0, 0, 0, 0}, {0, 0, one, one}, screen, ground), out_of_range);
  SPANTEX_ASSERT_STATUS(make_floor(level, {0, 0, one, one}, {0, 0, 0, 0}, ground), bad_size);
  // A level camera's horizon is at its centre.
  SPANTEX_ASSERT_OK(make_floor(level, {0, 0, one, one}, screen, ground));
  for (int32_t y = 0; y < height; ++y) assert_true((ground.w_at(1, 2 * y + 1) > 0) == (y >= 20));
}

SPANTEX_CASE(faces_of_a_cube_cover_every_pixel_once_where_rays_meet_them) {
  random_source random(6);
  static polygon faces[cube_face_count];
  for (int n = 0; n < 200; ++n) {
    const looking_camera camera = n == 0 ? looking_camera{0, 0, 0, 48 * one, 48 * one, 36 * one} : random_camera(random);
    bool seen[cube_face_count];
    for (int f = 0; f < cube_face_count; ++f) {
      const status s = make_cube_face(camera, cube_face(f), 64, 32, screen, faces[f]);
      assert_true(s == status::ok || s == status::degenerate);
      seen[f] = s == status::ok;
    }
    for (int32_t y = 0; y < height; ++y)
      for (int32_t x = 0; x < width; ++x) {
        int count = 0, face = 0;
        for (int f = 0; f < cube_face_count; ++f)
          if (seen[f] && covered(faces[f], x, y)) { ++count; face = f; }
        assert_int_equal(count, 1);
        if (x % 5 != 0 || y % 5 != 0) continue;
        const direction d = ray(camera, x, y);
        // Right and down on each face, and what faces it.
        const double towards[] = {d.ahead, d.right, -d.ahead, -d.right, d.up, -d.up}, across[] = {d.right, -d.ahead, -d.right, d.ahead, d.right, d.right},
                     down[] = {-d.up, -d.up, -d.up, -d.up, d.ahead, -d.ahead};
        const double u = 32 + 32 * across[face] / towards[face], v = 16 + 16 * down[face] / towards[face];
        assert_true(towards[face] > 0);
        const auto at = [&](const linear_form& form) { return double(faces[face].map.value(form, 2 * x + 1, 2 * y + 1)) / double(faces[face].map.w_at(2 * x + 1, 2 * y + 1)); };
        assert_true(std::abs(u - at(faces[face].map.u)) < 1e-3 && std::abs(v - at(faces[face].map.v)) < 1e-3);
      }
  }
  const looking_camera level{0, 0, 0, 48 * one, 48 * one, 36 * one};
  SPANTEX_ASSERT_STATUS(make_cube_face(level, cube_face::behind, 64, 64, screen, faces[0]), degenerate);
  SPANTEX_ASSERT_STATUS(make_cube_face(level, cube_face(6), 64, 64, screen, faces[0]), out_of_range);
  SPANTEX_ASSERT_STATUS(make_cube_face(level, cube_face::ahead, 0, 64, screen, faces[0]), bad_size);
  SPANTEX_ASSERT_STATUS(make_cube_face({}, cube_face::ahead, 64, 64, screen, faces[0]), out_of_range);
}

// --- parts of a screen -----------------------------------------------------------------------------------------

template <class Target>
status draw_everything(const Target& to, const texture_view& t) {
  const looking_camera camera{300, 40, 15, 60 * one, 48 * one, 30 * one};
  SPANTEX_TRY(rows::draw<filter::bilinear>(memory, to, cube_view{camera, {&t, &t, &t, &t, &t, nullptr}}));
  SPANTEX_TRY(rows::draw<filter::trilinear>(memory, to, floor_view{camera, {one, 2 * one, one, 40 * one}}, t));
  SPANTEX_TRY(rows::draw<filter::bilinear>(memory, to, quad{{{px(10), px(8)}, {px(60), px(3)}, {px(70), px(60)}, {px(4), px(40)}}}, t));
  const screen_vertex v[] = {{{px(70), px(2)}, {0, 0}, 100}, {{px(95), px(30)}, {99 * one, 0}, 300}, {{px(50), px(50)}, {0, 80 * one}, 200}};
  SPANTEX_TRY(rows::draw<filter::three_point>(memory, to, triangle_list{v, 3, nullptr, 1}, t));
  return rows::draw<filter::nearest>(memory, to, sprite{{px(60), px(50)}, {128 * one, 128 * one}, one / 9, one / 11, 333}, t);
}

struct immediate_display {
  void start(const rectangle& w, const uint8_t* from, uint32_t, int) {
    for (int32_t y = w.y0; y < w.y1; ++y) std::copy_n(reinterpret_cast<const uint16_t*>(from) + (y - w.y0) * (w.x1 - w.x0), w.x1 - w.x0, other + y * width + w.x0);
  }
  void wait(int) {}
};

SPANTEX_CASE(tiles_show_the_pixels_of_the_whole_screen) {
  const texture_view t = make_view(wrap::repeat);
  clear();
  SPANTEX_ASSERT_OK(draw_everything(target, t));
  alignas(4) static uint8_t tiles[2][2 * 96 * 32];
  immediate_display d;
  SPANTEX_ASSERT_OK(draw_tiles(d, screen, 40, 19, {{tiles[0], tiles[1]}, sizeof tiles[0]}, [&](const auto& tile) {
    tile.fill(0);
    return draw_everything(tile, t);
  }, fixed_format<pixel_format::rgb565>{}));
  assert_memory_equal(frame, other, sizeof frame);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(quads_hit_their_corners_exactly_by_the_map_s_rectangle),
      cmocka_unit_test(quads_between_any_convex_corners_hit_them),
      cmocka_unit_test(an_upright_quad_copies_its_map),
      cmocka_unit_test(pictures_at_the_edges_of_the_screen_are_left_out_when_they_do_not_meet_it),
      cmocka_unit_test(quads_that_are_none_are_refused),
      cmocka_unit_test(triangles_on_the_screen_are_those_of_camera_space),
      cmocka_unit_test(triangle_lists_cover_a_square_once_cull_and_refuse),
      cmocka_unit_test(sprites_lie_where_double_arithmetic_says_at_every_tenth_of_a_degree),
      cmocka_unit_test(sprites_at_right_angles_copy_their_maps),
      cmocka_unit_test(sprites_scale_as_asked_and_bad_ones_are_refused),
      cmocka_unit_test(floors_and_ceilings_lie_where_rays_meet_them),
      cmocka_unit_test(faces_of_a_cube_cover_every_pixel_once_where_rays_meet_them),
      cmocka_unit_test(tiles_show_the_pixels_of_the_whole_screen),
  };
  return run_suite("rows_pictures", tests);
}
