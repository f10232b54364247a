// SPDX-License-Identifier: Apache-2.0
// Write-out: blends and products to the last bit, cut-outs and depth where surfaces overlap within spans, colours of vertices.
#include <tests/support.hpp>

#include <algorithm>
#include <cmath>

using namespace spantex;
using namespace spantex::sim;

namespace {

using exact_profile = fixed_profile<profiles::exact>;
using engine_type = direct_engine<exact_profile>;
using shaded_renderer = renderer<engine_type, exact_profile, shading>;
constexpr exact_profile prof;
constexpr int32_t one = 1 << 16;
constexpr int side_px = 128;
constexpr projection camera{64 * one, 64 * one, 64 * one, 64 * one, one / 16};
constexpr rectangle screen{0, 0, side_px, side_px};
picture shown, expected;
uint32_t depths[side_px * side_px], expected_depths[side_px * side_px];

uint8_t rounded_255(int x) { return uint8_t((2 * x + 255) / 510); }

bool same(rgba8 a, rgba8 b) { return a == b; }

struct drawn { polygon shape; colour_forms colours; const texture_view* map; filter kind; shading how; };

// One pixel after another, one surface after another: what pipelined drawing must equal.
void draw_in_order(const drawn* items, int count, bool with_depth) {
  static picture alone;
  expected.reset(side_px, side_px);
  for (uint32_t& d : expected_depths) d = 0;
  for (int n = 0; n < count; ++n) {
    const drawn& item = items[n];
    alone.reset(side_px, side_px);
    engine_type engine;
    renderer<engine_type, exact_profile> r(engine, prof, alone.frame());
    SPANTEX_ASSERT_OK(r.draw(item.shape, *item.map, item.kind));
    SPANTEX_ASSERT_OK(r.finish());
    for (int32_t y = 0; y < side_px; ++y)
      for (int32_t x = 0; x < side_px; ++x) {
        const size_t at = size_t(y * side_px + x);
        const polygon& p = item.shape;
        if (x < p.box.x0 || y < p.box.y0 || x >= p.box.x1 || y >= p.box.y1) continue;
        if (((coverage(p.edges, x / 8, y / 8) >> (y % 8 * 8 + x % 8)) & 1) == 0) continue;
        const uint32_t z = depth_at(p, 2 * x + 1, 2 * y + 1);
        if (with_depth && z <= expected_depths[at]) continue;
        rgba8 c = alone.pixels[at];
        const rgba8 colour = item.how.colours != nullptr ? colour_at(p, *item.how.colours, 2 * x + 1, 2 * y + 1) : item.how.colour;
        c = {rounded_255(c.r * colour.r), rounded_255(c.g * colour.g), rounded_255(c.b * colour.b), rounded_255(c.a * colour.a)};
        rgba8& there = expected.pixels[at];
        const auto over = [&](int s, int d) { return rounded_255(s * c.a + d * (255 - c.a)); };
        switch (item.how.alpha) {
          case alpha_mode::opaque: there = c; expected_depths[at] = z; break;
          case alpha_mode::cut_out:
            if (c.a >= item.how.threshold) { there = c; expected_depths[at] = z; }
            break;
          case alpha_mode::blended: there = {over(c.r, there.r), over(c.g, there.g), over(c.b, there.b), over(255, there.a)}; break;
          case alpha_mode::premultiplied: {
            const auto sum = [&](int s, int d) { return uint8_t(min_of(255, s + rounded_255(d * (255 - c.a)))); };
            there = {sum(c.r, there.r), sum(c.g, there.g), sum(c.b, there.b), sum(c.a, there.a)};
            break;
          }
        }
      }
  }
}

// Small ones lie in one span: a surface then meets the one before it while that is still being computed.
bool random_triangle(random_source& random, bool small, drawn& out) {
  const auto number = [&](int32_t low, int32_t high) { return int32_t(random.between(low, high)); };
  vertex v[3];
  for (vertex& p : v)
    p = {number(-3 * one, 3 * one), number(-3 * one, 3 * one), number(one, 4 * one), number(-64 * one, 64 * one), number(-64 * one, 64 * one)};
  for (vertex& p : v)
    if (small) p = {number(0, p.z / 8), number(0, p.z / 8), p.z, p.u, p.v};
  rgba8 c[3];
  for (rgba8& k : c) k = {uint8_t(random.next()), uint8_t(random.next()), uint8_t(random.next()), uint8_t(random.next())};
  return make_polygon(v, c, 3, camera, screen, out.shape, out.colours) == status::ok;
}

}  // namespace

SPANTEX_CASE(division_by_255_is_exact) {
  for (uint32_t x = 0; x <= 255 * 255; ++x) assert_int_equal(over_255(x), (2 * x + 255) / 510);
}

// All alphas, sources and frames.
SPANTEX_CASE(blends_round_once) {
  for (int a = 0; a < 256; ++a)
    for (int s = 0; s < 256; s += short_run() ? 15 : 1)
      for (int d = 0; d < 256; ++d) {
        const rgba8 source{uint8_t(s), uint8_t(s), uint8_t(s), uint8_t(a)}, there{uint8_t(d), uint8_t(d), uint8_t(d), uint8_t(d)};
        const rgba8 got = blended(source, there);
        assert_int_equal(got.r, rounded_255(s * a + d * (255 - a)));
        assert_int_equal(got.a, rounded_255(255 * a + d * (255 - a)));
        assert_int_equal(blended_premultiplied(source, there).g, min_of(255, s + rounded_255(d * (255 - a))));
        if (a == 255) assert_int_equal(got.b, s);
        if (a == 0) assert_int_equal(got.b, d);
      }
}

SPANTEX_CASE(products_round_once_and_255_changes_nothing) {
  for (int t = 0; t < 256; ++t)
    for (int c = 0; c < 256; ++c) {
      const rgba8 got = modulated({uint8_t(t), uint8_t(c), 255, 0}, {uint8_t(c), uint8_t(t), uint8_t(t), uint8_t(t)});
      assert_true(same(got, {rounded_255(t * c), rounded_255(t * c), uint8_t(t), 0}));
    }
}

// Random surfaces of every mode over one another, with and without depth: the two halves of the engine change nothing.
SPANTEX_CASE(overlapping_surfaces_are_drawn_in_order) {
  static drawn items[12];
  random_source random(3);
  static texture_view maps[2];
  maps[0] = photographic_map(64, 64, 2).view(wrap::repeat, wrap::repeat);
  maps[1] = make_map(64, 64, [](int32_t x, int32_t y) {
    return rgba8{uint8_t(4 * x), uint8_t(4 * y), 99, uint8_t((x / 5 + y / 7) % 3 == 0 ? 0 : (x + y) % 2 ? 255 : 4 * x)};
  }).view(wrap::repeat, wrap::repeat);
  uint64_t left = 0, blended_px = 0, hidden = 0;
  for (int round = 0; round < (short_run() ? 6 : 60); ++round)
    for (const bool with_depth : {false, true})
      for (const bool single : {false, true}) {
        int count = 0;
        while (count < 12) {
          drawn& d = items[count];
          if (!random_triangle(random, round % 2 == 0, d)) continue;
          d.map = &maps[random.next() % 2];
          d.kind = all_filters[random.next() % 8];
          d.how = {};
          d.how.alpha = alpha_mode(random.next() % 4);
          d.how.threshold = uint8_t(random.next());
          if (random.next() % 3 == 0) d.how.colours = &d.colours;
          else if (random.next() % 2 == 0) d.how.colour = {uint8_t(random.next()), 255, 0, uint8_t(random.next())};
          ++count;
        }
        draw_in_order(items, count, with_depth);
        shown.reset(side_px, side_px);
        for (uint32_t& d : depths) d = 0;
        engine_type engine;
        shaded_renderer r(engine, prof, shown.frame());
        r.single_half(single);
        for (const drawn& d : items) SPANTEX_ASSERT_OK(r.draw(d.shape, *d.map, d.kind, {with_depth ? depths : nullptr}, d.how));
        SPANTEX_ASSERT_OK(r.finish());
        assert_int_equal(differing_pixels(shown, expected), 0);
        if (with_depth)
          for (int k = 0; k < side_px * side_px; ++k) assert_int_equal(depths[k], expected_depths[k]);
        left += r.counters().pixels_left;
        blended_px += r.counters().pixels_blended;
        hidden += r.counters().spans_hidden;
      }
  print_message("%llu pixels left, %llu blended, %llu spans hidden\n", static_cast<unsigned long long>(left),
                static_cast<unsigned long long>(blended_px), static_cast<unsigned long long>(hidden));
  assert_true(left > 10000 && blended_px > 10000 && hidden > 100);
}

SPANTEX_CASE(opaque_white_shading_is_the_default) {
  const texture_view t = photographic_map(64, 64).view(wrap::repeat, wrap::repeat);
  drawn d;
  random_source random(8);
  while (!random_triangle(random, false, d)) {}
  for (const filter kind : all_filters) {
    expected.reset(side_px, side_px);
    shown.reset(side_px, side_px);
    engine_type engine;
    renderer<engine_type, exact_profile> plain(engine, prof, expected.frame());
    SPANTEX_ASSERT_OK(plain.draw(d.shape, t, kind));
    SPANTEX_ASSERT_OK(plain.finish());
    shaded_renderer r(engine, prof, shown.frame());
    SPANTEX_ASSERT_OK(r.draw(d.shape, t, kind));
    SPANTEX_ASSERT_OK(r.finish());
    assert_int_equal(differing_pixels(shown, expected), 0);
  }
}

// A plane takes alpha and one colour; counters tell what was left and what was mixed.
SPANTEX_CASE(planes_are_shaded_and_counted) {
  const texture_view half = constant_map(8, 8, {200, 100, 50, 128}).view(wrap::repeat, wrap::repeat);
  const plane p = sample_plane(0);
  const auto draw = [&](const shading& how) {
    shown.reset(64, 64);
    engine_type engine;
    shaded_renderer r(engine, prof, shown.frame());
    SPANTEX_ASSERT_OK(r.draw(p, half, filter::trilinear, shown.area(), how));
    SPANTEX_ASSERT_OK(r.finish());
    return r.counters();
  };
  draw_counters c = draw({alpha_mode::cut_out, 129});
  assert_int_equal(c.pixels_left, 64 * 64);
  for (const rgba8& got : shown.pixels) assert_true(same(got, background));
  c = draw({alpha_mode::cut_out, 128});
  assert_int_equal(c.pixels_left, 0);
  for (const rgba8& got : shown.pixels) assert_true(same(got, {200, 100, 50, 128}));
  c = draw({alpha_mode::blended});
  assert_int_equal(c.pixels_blended, 64 * 64);
  for (const rgba8& got : shown.pixels) assert_true(same(got, blended({200, 100, 50, 128}, background)));
  c = draw({alpha_mode::blended, 0, {255, 255, 255, 0}});
  assert_int_equal(c.pixels_left, 64 * 64);
  c = draw({alpha_mode::opaque, 0, {128, 0, 255, 255}});
  for (const rgba8& got : shown.pixels) assert_true(same(got, {rounded_255(200 * 128), 0, 50, 128}));
}

// Colours against doubles, perspective-correct, wherever a polygon covers; clipped polygons included.
SPANTEX_CASE(colours_are_perspective_correct) {
  random_source random(11);
  double worst = 0;
  int checked = 0;
  for (int n = 0; n < (short_run() ? 40 : 400); ++n) {
    vertex v[3];
    rgba8 c[3];
    for (int k = 0; k < 3; ++k) {
      const bool behind = n % 2 && k == 0;
      v[k] = {int32_t(random.between(-4 * one, 4 * one)), int32_t(random.between(-4 * one, 4 * one)),
              behind ? int32_t(random.between(-one, 0)) : int32_t(random.between(one / 4, 8 * one)), int32_t(random.between(0, 9 * one)), 0};
      v[k].v = v[k].u * (k - 1);
      c[k] = {uint8_t(random.next()), uint8_t(random.next()), 255, uint8_t(k == 0 ? 255 : 0)};
    }
    polygon p{};
    colour_forms f{};
    if (make_polygon(v, c, 3, camera, screen, p, f) != status::ok) continue;
    // Barycentric coordinates of the ray through a pixel: exact enough in doubles.
    double m[3][3];
    for (int k = 0; k < 3; ++k) {
      const homogeneous_point h = project(v[k], camera);
      m[k][0] = double(h.x) / one;
      m[k][1] = double(h.y) / one;
      m[k][2] = double(h.z) / one;
    }
    for (int32_t y = p.box.y0; y < p.box.y1; ++y)
      for (int32_t x = p.box.x0; x < p.box.x1; ++x) {
        if (((coverage(p.edges, x / 8, y / 8) >> (y % 8 * 8 + x % 8)) & 1) == 0 || p.map.w_at(2 * x + 1, 2 * y + 1) <= 0) continue;
        double b[3], sum = 0;
        for (int k = 0; k < 3; ++k) {
          const double *q = m[(k + 1) % 3], *r = m[(k + 2) % 3];
          b[k] = (x + 0.5) * (q[1] * r[2] - q[2] * r[1]) + (y + 0.5) * (q[2] * r[0] - q[0] * r[2]) + (q[0] * r[1] - q[1] * r[0]);
          sum += b[k];
        }
        const rgba8 got = colour_at(p, f, 2 * x + 1, 2 * y + 1);
        const auto wanted = [&](int c0, int c1, int c2) { return std::min(255.0, std::max(0.0, (b[0] * c0 + b[1] * c1 + b[2] * c2) / sum)); };
        worst = std::max({worst, std::fabs(got.r - wanted(c[0].r, c[1].r, c[2].r)), std::fabs(got.g - wanted(c[0].g, c[1].g, c[2].g)),
                          std::fabs(got.a - wanted(255, 0, 0))});
        assert_int_equal(got.b, 255);
        ++checked;
      }
  }
  print_message("worst %.6f of a unit in %d pixels\n", worst, checked);
  assert_true(checked > 10000 && worst < 0.501);
}

// Two triangles with an edge and its colours in common: the forms of both agree at positions on the edge, but where the exact value is a tie.
SPANTEX_CASE(neighbours_agree_along_their_edge) {
  random_source random(17);
  int checked = 0, ties = 0;
  for (int n = 0; n < (short_run() ? 300 : 3000); ++n) {
    // An edge whose ends project onto whole half pixels: x = z (hx / 2 - 64) / 64, z a multiple of 2^9.
    const auto end = [&](int32_t hx, int32_t hy) {
      const int32_t z = int32_t(random.between(64, 1024)) << 9;
      return vertex{z / 128 * (hx - 128), z / 128 * (hy - 128), z, int32_t(random.between(0, 64 * one)), int32_t(random.between(0, 64 * one))};
    };
    const int32_t hx0 = int32_t(random.between(20, 100)), hy0 = int32_t(random.between(20, 100));
    const int32_t step_x = int32_t(random.between(-9, 9)), step_y = int32_t(random.between(1, 9)), steps = 8;
    const vertex a = end(hx0, hy0), b = end(hx0 + steps * step_x, hy0 + steps * step_y);
    const vertex left{-2 * one, int32_t(random.between(-one, one)), int32_t(random.between(one / 2, 6 * one)), 0, 5 * one};
    const vertex right{2 * one, int32_t(random.between(-one, one)), int32_t(random.between(one / 2, 6 * one)), 9 * one, 0};
    const auto any = [&] { return rgba8{uint8_t(random.next()), uint8_t(random.next()), uint8_t(random.next()), uint8_t(random.next())}; };
    const rgba8 ca = any(), cb = any();
    const vertex first[3] = {a, b, left}, second[3] = {right, b, a};
    const rgba8 first_colours[3] = {ca, cb, any()}, second_colours[3] = {any(), cb, ca};
    polygon p{}, q{};
    colour_forms f{}, g{};
    if (make_polygon(first, first_colours, 3, camera, screen, p, f) != status::ok) continue;
    if (make_polygon(second, second_colours, 3, camera, screen, q, g) != status::ok) continue;
    for (int k = 0; k <= steps; ++k) {
      const int32_t hx = hx0 + k * step_x, hy = hy0 + k * step_y;
      const rgba8 x = colour_at(p, f, hx, hy), y = colour_at(q, g, hx, hy);
      const double at_a = double(steps - k) / a.z, at_b = double(k) / b.z;
      const auto agree = [&](int c0, int c1, int got, int other_got) {
        ++checked;
        if (got == other_got) return;
        const double exact = (c0 * at_a + c1 * at_b) / (at_a + at_b);
        assert_true(std::fabs(exact - std::floor(exact) - 0.5) < 1e-6 && std::abs(got - other_got) == 1);
        ++ties;
      };
      agree(ca.r, cb.r, x.r, y.r);
      agree(ca.g, cb.g, x.g, y.g);
      agree(ca.b, cb.b, x.b, y.b);
      agree(ca.a, cb.a, x.a, y.a);
      if (k == 0) assert_true(same(x, ca));
      if (k == steps) assert_true(same(x, cb));
    }
  }
  print_message("%d values equal but for %d ties\n", checked, ties);
  assert_true(checked > 1000);
}

SPANTEX_CASE(white_vertices_change_nothing_and_equal_ones_cost_nothing) {
  random_source random(23);
  drawn d;
  for (int n = 0; n < 200; ++n) {
    vertex v[3];
    for (vertex& p : v)
      p = {int32_t(random.between(-3 * one, 3 * one)), int32_t(random.between(-3 * one, 3 * one)), int32_t(random.between(one, 4 * one)), int32_t(random.next() % 999999), 7};
    // Blue is 255 at every vertex, red varies: blue must come out 255 through its form.
    const rgba8 c[3] = {{1, 0, 255, 9}, {200, 0, 255, 9}, {90, 0, 255, 9}}, flat[3] = {{9, 8, 7, 6}, {9, 8, 7, 6}, {9, 8, 7, 6}};
    if (make_polygon(v, c, 3, camera, screen, d.shape, d.colours) != status::ok) continue;
    assert_true(d.colours.varies);
    for (int32_t y = d.shape.box.y0; y < d.shape.box.y1; ++y)
      for (int32_t x = d.shape.box.x0; x < d.shape.box.x1; ++x) {
        if (d.shape.map.w_at(2 * x + 1, 2 * y + 1) <= 0) continue;
        const rgba8 got = colour_at(d.shape, d.colours, 2 * x + 1, 2 * y + 1);
        assert_true(got.g == 0 && got.b == 255 && got.a == 9);
      }
    SPANTEX_ASSERT_OK(make_polygon(v, flat, 3, camera, screen, d.shape, d.colours));
    assert_true(!d.colours.varies && same(colour_at(d.shape, d.colours, 64, 64), flat[0]));
  }
}

// Cut-outs keep loading overlapped with computing: a wall of them in front of another, span by span, as in opaque drawing.
SPANTEX_CASE(a_cut_out_hides_what_lies_behind_where_it_is_there) {
  const auto wall = [](int32_t z, polygon& p) {
    const vertex v[4] = {{-z, -z, z, 0, 0}, {z, -z, z, 64 * one, 0}, {z, z, z, 64 * one, 64 * one}, {-z, z, z, 0, 64 * one}};
    SPANTEX_ASSERT_OK(make_polygon(v, 4, camera, screen, p));
  };
  polygon near{}, far{};
  wall(one, near);
  wall(3 * one, far);
  const texture_view holes = make_map(64, 64, [](int32_t x, int32_t y) { return rgba8{255, 0, 0, uint8_t((x / 8 + y / 8) % 2 ? 255 : 0)}; })
                                 .view(wrap::repeat, wrap::repeat);
  const texture_view blue = constant_map(8, 8, {0, 0, 255, 255}).view(wrap::repeat, wrap::repeat);
  for (uint32_t& d : depths) d = 0;
  shown.reset(side_px, side_px);
  engine_type engine;
  shaded_renderer r(engine, prof, shown.frame());
  SPANTEX_ASSERT_OK(r.draw(near, holes, filter::nearest, {depths}, {alpha_mode::cut_out, 128}));
  SPANTEX_ASSERT_OK(r.draw(far, blue, filter::nearest, {depths}, {}));
  SPANTEX_ASSERT_OK(r.finish());
  int red = 0;
  for (const rgba8& c : shown.pixels) {
    assert_true(same(c, {255, 0, 0, 255}) || same(c, {0, 0, 255, 255}));
    red += c.r == 255;
  }
  assert_int_equal(red, side_px * side_px / 2);
}

int main() {
  const CMUnitTest tests[] = {cmocka_unit_test(division_by_255_is_exact),
                              cmocka_unit_test(blends_round_once),
                              cmocka_unit_test(products_round_once_and_255_changes_nothing),
                              cmocka_unit_test(overlapping_surfaces_are_drawn_in_order),
                              cmocka_unit_test(opaque_white_shading_is_the_default),
                              cmocka_unit_test(planes_are_shaded_and_counted),
                              cmocka_unit_test(colours_are_perspective_correct),
                              cmocka_unit_test(neighbours_agree_along_their_edge),
                              cmocka_unit_test(white_vertices_change_nothing_and_equal_ones_cost_nothing),
                              cmocka_unit_test(a_cut_out_hides_what_lies_behind_where_it_is_there)};
  return run_suite("shade", tests);
}
