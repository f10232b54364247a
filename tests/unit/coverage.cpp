// SPDX-License-Identifier: Apache-2.0
// Coverage against its definition: a pixel belongs to a polygon if its centre is inside, or on a top or left edge. Meshes must draw
// every pixel of their union once. Screen points are on the 1/256 pixel grid, so all of it is exact.
#include <tests/support.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

constexpr int32_t screen_spans = 8, screen_px = screen_spans * span_side, one_px = 1 << subpixel_bits, half_px = one_px / 2;

// Twice the area to the right of p -> q on the side of r: positive if p, q, r run clockwise (y down).
int64_t turn(screen_point p, screen_point q, screen_point r) {
  return int64_t(q.x - p.x) * (r.y - p.y) - int64_t(q.y - p.y) * (r.x - p.x);
}

screen_point centre_of(int32_t x, int32_t y) { return {x * one_px + half_px, y * one_px + half_px}; }

struct triangle { screen_point p[3]; };

triangle clockwise(triangle t) {
  if (turn(t.p[0], t.p[1], t.p[2]) < 0) { const screen_point k = t.p[1]; t.p[1] = t.p[2]; t.p[2] = k; }
  return t;
}

// By the rule, from a clockwise triangle of non-zero area.
bool contains(const triangle& t, screen_point c) {
  for (int k = 0; k < 3; ++k) {
    const screen_point p = t.p[k], q = t.p[(k + 1) % 3];
    const int64_t side = turn(p, q, c);
    const bool top = p.y == q.y && q.x > p.x, left = q.y < p.y;
    if (side < 0 || (side == 0 && !top && !left)) return false;
  }
  return true;
}

bool touches(const triangle& t, screen_point c) {
  return turn(t.p[0], t.p[1], c) >= 0 && turn(t.p[1], t.p[2], c) >= 0 && turn(t.p[2], t.p[0], c) >= 0;
}

edge_set edges_of(const triangle& t) {
  edge_set s;
  for (int k = 0; k < 3; ++k) s.edges[s.count++] = make_edge(t.p[k], t.p[(k + 1) % 3]);
  return s;
}

struct coverage_count {
  uint16_t at[screen_px][screen_px];
  void clear() { *this = {}; }
  void add(const triangle& t) {
    const edge_set edges = edges_of(t);
    for (int32_t sy = 0; sy < screen_spans; ++sy)
      for (int32_t sx = 0; sx < screen_spans; ++sx)
        for (span_mask m = coverage(edges, sx, sy); m != 0; m &= m - 1) {
          const int k = __builtin_ctzll(m);
          ++at[sy * span_side + k / span_side][sx * span_side + k % span_side];
        }
  }
};
coverage_count counted;

int32_t random_coordinate(random_source& random, int32_t low, int32_t high) {
  const int32_t x = int32_t(random.between(low, high));
  return random.next() % 2 == 0 ? x : ((x >> subpixel_bits) << subpixel_bits) + half_px;  // half of them in line with centres
}

}  // namespace

SPANTEX_CASE(triangles_cover_what_the_rule_says) {
  random_source random(50);
  int checked = 0;
  for (int n = 0; n < 3000; ++n) {
    triangle t;
    const bool small = n % 3 == 0;
    const int32_t size = small ? one_px * 3 : one_px * screen_px, x = small ? int32_t(random.next() % 60) * one_px : 0, y = x / 2;
    for (screen_point& p : t.p) p = {x + random_coordinate(random, -size / 8, size), y + random_coordinate(random, -size / 8, size)};
    t = clockwise(t);
    if (turn(t.p[0], t.p[1], t.p[2]) == 0) continue;
    counted.clear();
    counted.add(t);
    for (int32_t j = 0; j < screen_px; ++j)
      for (int32_t i = 0; i < screen_px; ++i) assert_int_equal(counted.at[j][i], contains(t, centre_of(i, j)) ? 1 : 0);
    ++checked;
  }
  assert_true(checked > 2500);
}

SPANTEX_CASE(vertices_at_the_guard_band_do_not_overflow) {
  constexpr int32_t g = guard_px << subpixel_bits;
  const screen_point corners[4] = {{-g, -g}, {g, -g}, {g, g}, {-g, g}};
  for (int a = 0; a < 4; ++a) {
    const triangle t{{corners[a], corners[(a + 1) % 4], corners[(a + 2) % 4]}};
    const edge_set edges = edges_of(t);
    for (const int32_t sx : {0, 1, 255, 511})
      for (const int32_t sy : {0, 2, 254, 511})
        for (int k = 0; k < 64; ++k)
          assert_int_equal((coverage(edges, sx, sy) >> k) & 1, contains(t, centre_of(sx * 8 + k % 8, sy * 8 + k / 8)) ? 1 : 0);
  }
}

// A centre and eight points around it, one a direction: a star whose triangles share edges.
SPANTEX_CASE(fans_draw_every_pixel_of_their_union_once) {
  static constexpr int way[8][2] = {{0, -1}, {1, -1}, {1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}};
  random_source random(51);
  for (int n = 0; n < 1500; ++n) {
    const int32_t radius = 1 + int32_t(random.next() % (n % 4 == 0 ? 5u : n % 4 == 1 ? 600u : 30u * one_px));
    const screen_point c{random_coordinate(random, 8 * one_px, 56 * one_px), random_coordinate(random, 8 * one_px, 56 * one_px)};
    triangle fan[8];
    screen_point ring[8];
    for (int k = 0; k < 8; ++k)
      ring[k] = {c.x + way[k][0] * int32_t(random.between(1, radius)), c.y + way[k][1] * int32_t(random.between(1, radius))};
    counted.clear();
    for (int k = 0; k < 8; ++k) {
      fan[k] = {{c, ring[k], ring[(k + 1) % 8]}};
      assert_true(turn(fan[k].p[0], fan[k].p[1], fan[k].p[2]) > 0);
      counted.add(fan[k]);
    }
    for (int32_t j = 0; j < screen_px; ++j)
      for (int32_t i = 0; i < screen_px; ++i) {
        bool inside = false, on_rim = false;
        for (const triangle& t : fan) {
          const bool in = touches(t, centre_of(i, j));
          inside = inside || in;
          on_rim = on_rim || (in && turn(t.p[1], t.p[2], centre_of(i, j)) == 0);
        }
        const int times = counted.at[j][i];
        assert_true(on_rim ? times <= 1 : times == (inside ? 1 : 0));
      }
  }
}

// Rows of triangles between horizontal lines; the points of a line lie anywhere on it, so most triangles are needles.
static void check_strips(int points, int lines, int32_t (*place)(random_source&, int), uint64_t seed) {
  static screen_point mesh[65][65];
  random_source random(seed);
  for (int j = 0; j <= lines; ++j) {
    for (int i = 0; i <= points; ++i) mesh[j][i].y = j * screen_px * one_px / lines;
    int32_t at[65] = {};
    for (int i = 1; i < points; ++i) at[i] = place(random, i);
    at[points] = screen_px * one_px;
    for (int i = 1; i <= points; ++i)  // ascending, distinct
      for (int k = i; k > 0 && at[k] < at[k - 1]; --k) { const int32_t x = at[k]; at[k] = at[k - 1]; at[k - 1] = x; }
    for (int i = 1; i < points; ++i) if (at[i] <= at[i - 1]) at[i] = at[i - 1] + 1;
    for (int i = 0; i <= points; ++i) mesh[j][i].x = at[i];
  }
  counted.clear();
  for (int j = 0; j < lines; ++j)
    for (int i = 0; i < points; ++i) {
      const screen_point &a = mesh[j][i], &b = mesh[j][i + 1], &c = mesh[j + 1][i + 1], &d = mesh[j + 1][i];
      const bool falling = random.next() % 2 == 0;
      counted.add(falling ? triangle{{a, b, c}} : triangle{{a, b, d}});
      counted.add(falling ? triangle{{a, c, d}} : triangle{{b, c, d}});
    }
  for (int32_t j = 0; j < screen_px; ++j)
    for (int32_t i = 0; i < screen_px; ++i) assert_int_equal(counted.at[j][i], 1);
}

SPANTEX_CASE(strips_draw_every_pixel_once) {
  const auto anywhere = [](random_source& r, int) { return int32_t(r.between(1, screen_px * one_px - 100)); };
  for (uint64_t k = 0; k < 40; ++k) check_strips(16, 8, anywhere, 52 + k);
}

SPANTEX_CASE(strips_with_vertices_at_pixel_centres_draw_every_pixel_once) {
  const auto centred = [](random_source& r, int) { return int32_t(r.between(1, screen_px - 2)) * one_px + half_px; };
  for (uint64_t k = 0; k < 40; ++k) check_strips(20, 64, centred, 152 + k);
}

SPANTEX_CASE(needle_thin_strips_draw_every_pixel_once) {
  const auto bundled = [](random_source& r, int i) { return int32_t((i / 16 + 1) * 12 * one_px + int32_t(r.between(-20, 20))); };
  for (uint64_t k = 0; k < 40; ++k) check_strips(64, 4, bundled, 252 + k);
}

SPANTEX_CASE(squares_of_a_pixel_and_less_tile_the_screen) {
  for (const int32_t side : {one_px, one_px / 2, one_px / 4}) {
    for (const int32_t shift : {0, 1, half_px, one_px - 1}) {
      counted.clear();
      const int32_t first = -one_px + shift;
      for (int32_t y = first; y < 9 * one_px; y += side)
        for (int32_t x = first; x < 9 * one_px; x += side) {
          counted.add({{{x, y}, {x + side, y}, {x + side, y + side}}});
          counted.add({{{x, y}, {x + side, y + side}, {x, y + side}}});
        }
      for (int32_t j = 0; j < 8; ++j)
        for (int32_t i = 0; i < 8; ++i) assert_int_equal(counted.at[j][i], 1);
    }
  }
}

SPANTEX_CASE(a_square_on_pixel_centres_owns_its_top_and_left_edges) {
  counted.clear();
  const int32_t a = 8 * one_px + half_px, b = 11 * one_px + half_px;
  counted.add({{{a, a}, {b, a}, {b, b}}});
  counted.add({{{a, a}, {b, b}, {a, b}}});
  for (int32_t j = 0; j < screen_px; ++j)
    for (int32_t i = 0; i < screen_px; ++i) assert_int_equal(counted.at[j][i], i >= 8 && i < 11 && j >= 8 && j < 11 ? 1 : 0);
}

SPANTEX_CASE(rectangles_cover_their_pixels) {
  random_source random(53);
  for (int n = 0; n < 20000; ++n) {
    const auto at = [&] { return int32_t(random.between(-20, 40)); };
    const rectangle r{at(), at(), at(), at()};
    const int32_t sx = int32_t(random.next() % 4), sy = int32_t(random.next() % 4);
    const span_mask mask = rectangle_mask(r, sx, sy);
    for (int k = 0; k < 64; ++k) {
      const int32_t x = sx * 8 + k % 8, y = sy * 8 + k / 8;
      assert_int_equal((mask >> k) & 1, x >= r.x0 && x < r.x1 && y >= r.y0 && y < r.y1 ? 1 : 0);
    }
  }
}

SPANTEX_CASE(front_masks_hold_the_pixels_with_positive_w) {
  random_source random(54);
  int partial = 0;
  for (int n = 0; n < 20000; ++n) {
    plane p{};
    p.w = {random.any_magnitude(n % 2 == 0 ? 3 : 28), random.any_magnitude(n % 2 == 0 ? 3 : 28), random.any_magnitude(n % 2 == 0 ? 8 : 36)};
    p.origin_x = int32_t(random.next() % 100);
    p.origin_y = int32_t(random.next() % 100);
    const int32_t sx = int32_t(random.next() % 12), sy = int32_t(random.next() % 12);
    const span_mask mask = front_mask(p, sx, sy);
    partial += mask != 0 && mask != full_mask;
    for (int k = 0; k < 64; ++k)
      assert_int_equal((mask >> k) & 1, p.w_at(16 * sx + 2 * (k % 8) + 1, 16 * sy + 2 * (k / 8) + 1) > 0 ? 1 : 0);
  }
  assert_true(partial > 500);
}

SPANTEX_CASE(boxes_are_the_smallest_that_hold_the_mask) {
  random_source random(55);
  for (int n = 0; n < 20000; ++n) {
    span_mask mask = random.next();
    for (uint64_t k = random.next() % 6; k > 0; --k) mask &= random.next();
    if (mask == 0) continue;
    mask_box expected{8, 8, -1, -1};
    for (int k = 0; k < 64; ++k)
      if ((mask >> k) & 1) {
        const int x = k % 8, y = k / 8;
        expected = {min_of(expected.x0, x), min_of(expected.y0, y), max_of(expected.x1, x), max_of(expected.y1, y)};
      }
    const mask_box b = box_of(mask);
    assert_true(b.x0 == expected.x0 && b.y0 == expected.y0 && b.x1 == expected.x1 && b.y1 == expected.y1);
  }
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(triangles_cover_what_the_rule_says),
      cmocka_unit_test(vertices_at_the_guard_band_do_not_overflow),
      cmocka_unit_test(fans_draw_every_pixel_of_their_union_once),
      cmocka_unit_test(strips_draw_every_pixel_once),
      cmocka_unit_test(strips_with_vertices_at_pixel_centres_draw_every_pixel_once),
      cmocka_unit_test(needle_thin_strips_draw_every_pixel_once),
      cmocka_unit_test(squares_of_a_pixel_and_less_tile_the_screen),
      cmocka_unit_test(a_square_on_pixel_centres_owns_its_top_and_left_edges),
      cmocka_unit_test(rectangles_cover_their_pixels),
      cmocka_unit_test(front_masks_hold_the_pixels_with_positive_w),
      cmocka_unit_test(boxes_are_the_smallest_that_hold_the_mask),
  };
  return run_suite("coverage", tests);
}
