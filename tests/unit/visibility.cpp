// SPDX-License-Identifier: Apache-2.0
// Visibility: depth by pixel against depth by span first.
#include <algorithm>

#include <tests/support.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

constexpr int32_t one = 1 << 16, width = 117, height = 61, across = (width + 7) / 8, down = (height + 7) / 8;
constexpr projection camera{60 * one, 60 * one, width * one / 2, height * one / 2, one / 16};

struct depths {
  uint32_t values[width * height] = {}, floors[across * down] = {};
};

bool random_polygon(random_source& random, polygon& p) {
  vertex v[4];
  const int32_t z = int32_t(random.between(one / 2, 40 * one)), x = int32_t(random.between(-z, z)), y = int32_t(random.between(-z / 2, z / 2));
  const int32_t side = int32_t(random.between(z / 8, 2 * z)), tilt = int32_t(random.between(-z / 3, z / 3));
  const int32_t sx[4] = {-1, 1, 1, -1}, sy[4] = {-1, -1, 1, 1};
  for (int k = 0; k < 4; ++k) v[k] = {x + sx[k] * side, y + sy[k] * side, z + sx[k] * tilt, 0, 0};
  return make_polygon(v, 4, camera, {0, 0, width, height}, p) == status::ok;
}

// Calls with every span of the polygon that covers something, and what it covers.
template <class Visit>
void each_span(const polygon& p, Visit visit) {
  for (int32_t sy = 0; sy < down; ++sy)
    for (int32_t sx = 0; sx < across; ++sx)
      if (const span_mask mask = coverage(p.edges, sx, sy) & rectangle_mask(p.box, sx, sy); mask != 0) visit(sx, sy, mask);
}

// Depth by the formula, a pixel at a time.
span_mask nearer_pixels(const polygon& p, int32_t sx, int32_t sy, span_mask mask, uint32_t* values, bool stores) {
  span_mask visible = 0;
  for (span_mask rest = mask; rest != 0; rest &= rest - 1) {
    const int k = __builtin_ctzll(rest);
    const int32_t x = sx * 8 + k % 8, y = sy * 8 + k / 8;
    const uint32_t z = depth_at(p, 2 * x + 1, 2 * y + 1);
    if (z <= values[y * width + x]) continue;
    if (stores) values[y * width + x] = z;
    visible |= span_mask(1) << k;
  }
  return visible;
}

depths with, without, plain;
uint64_t spans_hidden;

// The same polygons three ways; every floor is one.
void draw_all(int seed) {
  with = without = plain = {};
  spans_hidden = 0;
  random_source random{uint64_t(seed)};
  for (int n = 0; n < 400; ++n) {
    polygon p{};
    if (!random_polygon(random, p)) continue;
    const bool stores = random.between(0, 3) != 0;
    each_span(p, [&](int32_t sx, int32_t sy, span_mask mask) {
      const bool hidden = depth_range_of(p, sx, sy).most <= with.floors[sy * across + sx];
      const span_mask want = nearer_pixels(p, sx, sy, mask, plain.values, stores);
      assert_int_equal(depth_test(p, sx, sy, mask, {with.values, with.floors}, width, stores), want);
      assert_int_equal(depth_test(p, sx, sy, mask, {without.values}, width, stores), want);
      if (hidden) assert_int_equal(want, 0);
      spans_hidden += hidden;
    });
  }
}

SPANTEX_CASE(floors_change_no_pixel_and_no_depth) {
  for (int seed = 1; seed <= 8; ++seed) {
    draw_all(seed);
    assert_memory_equal(with.values, plain.values, sizeof plain.values);
    assert_memory_equal(without.values, plain.values, sizeof plain.values);
  }
}

// In one go, and depths first: every pixel is shown by the same polygon, of equals by the first, and drawn once.
SPANTEX_CASE(depths_first_show_what_is_seen_and_nothing_else) {
  static polygon all[400];
  static int16_t shown[width * height], seen[width * height];
  uint64_t drawn_at_once = 0, equals = 0;
  for (int seed = 1; seed <= 8; ++seed) {
    random_source random{uint64_t(seed)};
    int count = 0;
    while (count < 400) {
      const bool again = count > 0 && random.between(0, 7) == 0;  // as near as one before
      if (again) all[count] = all[random.between(0, count - 1)];
      if (again || random_polygon(random, all[count])) ++count;
    }
    const auto draw = [&](depths& d, int16_t* owner, uint64_t& pixels) {
      for (int n = 0; n < count; ++n)
        each_span(all[n], [&](int32_t sx, int32_t sy, span_mask mask) {
          for (span_mask rest = depth_test(all[n], sx, sy, mask & front_mask(all[n].map, sx, sy), {d.values, d.floors}, width, true); rest != 0; rest &= rest - 1) {
            const int k = __builtin_ctzll(rest);
            owner[(sy * 8 + k / 8) * width + sx * 8 + k % 8] = int16_t(n);
            ++pixels;
          }
        });
    };
    std::fill(shown, shown + width * height, int16_t(-1));
    std::fill(seen, seen + width * height, int16_t(-1));
    with = without = {};
    draw(without, shown, drawn_at_once);
    for (int n = 0; n < count; ++n) lay_depths(all[n], {with.values, with.floors}, width, height);
    assert_memory_equal(with.values, without.values, sizeof with.values);
    reopen_depths(with.values, width * height);
    reopen_depths(with.floors, across * down);
    uint64_t pixels = 0;
    draw(with, seen, pixels);
    assert_memory_equal(seen, shown, sizeof shown);
    assert_memory_equal(with.values, without.values, sizeof with.values);
    assert_int_equal(pixels, width * height - std::count(shown, shown + width * height, int16_t(-1)));
    for (int k = 0; k < width * height; ++k)
      for (int n = shown[k] + 1; shown[k] >= 0 && n < count; ++n) equals += all[n].depth == all[shown[k]].depth;
  }
  assert_true(drawn_at_once > 2 * 8 * uint64_t(width) * height && equals > 100);
}

SPANTEX_CASE(no_pixel_of_a_span_is_farther_than_its_floor) {
  draw_all(9);
  int known = 0;
  for (int32_t y = 0; y < height; ++y)
    for (int32_t x = 0; x < width; ++x) {
      const uint32_t floor = with.floors[y / 8 * across + x / 8];
      known += floor != 0;
      assert_true(with.values[y * width + x] >= floor);
    }
  assert_in_range(known, width * height / 2, width * height);
  assert_in_range(spans_hidden, 100, 100000);  // floors hide something
}

// The lowest floor that hides a triangle, 0 where none does, against the depth of every pixel that it covers.
uint32_t lowest_floor(const vertex (&v)[3], const polygon& p, const projection& seen, int32_t across_px, int32_t down_px) {
  static uint32_t floors[64 * 64];
  const int32_t columns = (across_px + 7) / 8, rows = (down_px + 7) / 8;
  const auto hides = [&](uint32_t floor) {
    std::fill(floors, floors + columns * rows, floor);
    return is_hidden(v, seen, {0, 0, across_px, down_px}, floors, across_px, down_px);
  };
  uint32_t low = 0, high = uint32_t(1) << 31;
  if (!hides(high)) return 0;
  while (low + 1 < high) {
    const uint32_t middle = low + (high - low) / 2;
    (hides(middle) ? high : low) = middle;
  }
  uint32_t nearest = 0;
  for (int32_t sy = 0; sy < rows; ++sy)
    for (int32_t sx = 0; sx < columns; ++sx)
      for (span_mask mask = coverage(p.edges, sx, sy) & rectangle_mask(p.box, sx, sy); mask != 0; mask &= mask - 1) {
        const int k = __builtin_ctzll(mask);
        nearest = std::max(nearest, depth_at(p, 2 * (sx * 8 + k % 8) + 1, 2 * (sy * 8 + k / 8) + 1));
      }
  assert_true(nearest <= high);
  return high;
}

vertex moved(random_source& random, const vertex& v, int64_t across_by, int64_t deep_by) {
  const auto near = [&](int64_t x, int64_t by) { return int32_t(clamp_to(x + random.between(-by, by), int64_t(INT32_MIN), int64_t(INT32_MAX))); };
  return {near(v.x, across_by), near(v.y, across_by), max_of(near(v.z, deep_by), 1), v.u, v.v};
}

// Ordinary triangles, slivers, edge-on ones, far and near ones.
SPANTEX_CASE(no_pixel_is_nearer_than_the_bound) {
  random_source random(71);
  const int count = short_run() ? 20000 : 1000000;
  int hidden = 0;
  for (int n = 0; n < count; ++n) {
    const int32_t z = random.between(1, 6) == 1 ? int32_t(random.between(1000, 32000)) * one : int32_t(random.between(one / 8, 60 * one));
    const vertex middle{int32_t(random.between(-z, z)), int32_t(random.between(-z / 2, z / 2)), z, 0, 0};
    const int64_t reach = z >> random.between(0, 12), deep = z >> random.between(1, 16);
    vertex v[3] = {moved(random, middle, reach, deep), moved(random, middle, reach, deep), moved(random, middle, reach, deep)};
    if (n % 3 == 0) {  // a steep sliver: the last corner near the line between the others, which are as deep as each other, and behind it
      const int64_t part = random.between(0, 256);
      const auto between = [&](int32_t a, int32_t b) { return int32_t(a + ((int64_t(b) - a) * part >> 8)); };
      v[1].z = v[0].z;
      v[2] = moved(random, {between(v[0].x, v[1].x), between(v[0].y, v[1].y), int32_t(std::min<int64_t>(v[0].z + random.between(0, v[0].z / 2), INT32_MAX)), 0, 0}, z >> random.between(3, 10), 0);
    }
    const projection seen{60 * one, 60 * one, width * one / 2, height * one / 2, n % 5 == 0 ? 1 : one / 16};
    polygon p{};
    if (make_polygon(v, 3, seen, {0, 0, width, height}, p) == status::ok) hidden += lowest_floor(v, p, seen, width, height) != 0;
  }
  assert_true(hidden > count / 3);
}

// Slivers from corner to corner, almost facing the viewer, whose texture coordinates leave W few bits: what its form is rounded by is more than what snapped corners make.
SPANTEX_CASE(no_pixel_is_nearer_than_the_bound_where_w_has_few_bits) {
  random_source random(72);
  constexpr int32_t side = 512;
  int hidden = 0;
  for (int n = 0; n < (short_run() ? 600 : 2000); ++n) {
    const int32_t z = int32_t(random.between(4096, 16384)) * one;
    const projection seen{side * one / 2, side * one / 2, side * one / 2, side * one / 2, z / 2};
    const int64_t texels = INT32_MAX >> random.between(0, 3), deep = random.between(0, 8), thin = z >> random.between(6, 10);
    vertex v[3] = {moved(random, {-z, -z, z, 0, 0}, thin, deep), moved(random, {z, z, z, 0, 0}, thin, deep), moved(random, {0, 0, z, 0, 0}, thin, deep)};
    for (vertex& c : v) {
      c.u = int32_t(random.between(-texels, texels));
      c.v = int32_t(random.between(-texels, texels));
    }
    polygon p{};
    if (make_polygon(v, 3, seen, {0, 0, side, side}, p) == status::ok) hidden += lowest_floor(v, p, seen, side, side) != 0;
  }
  assert_true(hidden > (short_run() ? 300 : 1000));
}

// Numbers up to the ends of their types, triangles of 1/128 to 128 pixels, clip rectangles anywhere: bounded or not, and never exceeded.
SPANTEX_CASE(no_pixel_is_nearer_than_the_bound_at_the_ends_of_the_range) {
  random_source random(73);
  int bounded = 0, unbounded = 0;
  for (int n = 0; n < (short_run() ? 60000 : 1000000); ++n) {
    const int32_t near_z = n % 6 == 0 ? 1 : int32_t(random.between(1, n % 6 == 1 ? 1 << 20 : INT32_MAX / 2));
    const int64_t z = random.between(near_z, n % 6 == 2 ? INT32_MAX : clamp_to(int64_t(near_z) * 4, int64_t(0), int64_t(INT32_MAX)));
    const int64_t focal = random.between(one, max_screen_px / 2 * int64_t(one)), x = random.between(-20 * 256, 4100 * 256), y = random.between(-20 * 256, 4100 * 256);
    const int64_t reach = int64_t(1) << random.between(0, 14), deep = z >> random.between(0, 30), texels = n % 2 != 0 ? INT32_MAX : INT32_MAX >> random.between(0, 20);
    const projection seen{int32_t(focal), int32_t(focal), int32_t(random.between(0, 2047) * one), int32_t(random.between(0, 2047) * one), near_z};
    const auto texel = [&] { return int32_t(random.between(0, 3) == 0 ? (random.between(0, 1) == 0 ? INT32_MIN : INT32_MAX) : random.between(-texels, texels)); };
    vertex v[3];
    bool in_range = true;
    for (vertex& c : v) {
      const int64_t depth = clamp_to(z + random.between(-deep, deep), int64_t(near_z), int64_t(INT32_MAX));
      const auto along = [&](int64_t at, int32_t centre) {
        const double offset = (double(at + random.between(-reach, reach)) * 256 - centre) * double(depth) / double(focal);
        in_range = in_range && offset > INT32_MIN && offset < INT32_MAX;
        return in_range ? int32_t(offset) : 0;
      };
      c = {along(x, seen.centre_x), along(y, seen.centre_y), int32_t(depth), texel(), texel()};
    }
    const auto near = [&](int64_t at) { return int32_t(clamp_to((at >> 8) - random.between(0, 40), int64_t(0), int64_t(4000))); };
    const int32_t x0 = near(x), y0 = near(y), x1 = min_of(x0 + int32_t(random.between(1, 80)), max_screen_px), y1 = min_of(y0 + int32_t(random.between(1, 80)), max_screen_px);
    polygon p{};
    if (!in_range || make_polygon(v, 3, seen, {x0, y0, x1, y1}, p) != status::ok) continue;
    spantex::detail::seen_corner corners[3];
    uint32_t most_texel = 0;
    for (int k = 0; k < 3; ++k) {
      const homogeneous_point h = project(v[k], seen);
      corners[k] = {spantex::detail::snapped(h.x, h.z), spantex::detail::snapped(h.y, h.z), (int64_t(near_z) << 31) / h.z};
      in_range = in_range && magnitude(corners[k].x) < uint64_t(guard_px) << 8 && magnitude(corners[k].y) < uint64_t(guard_px) << 8;
      most_texel = std::max({most_texel, uint32_t(magnitude(v[k].u)), uint32_t(magnitude(v[k].v))});
    }
    if (!in_range) continue;
    const uint64_t bound = spantex::detail::depth_bound(corners, most_texel, p.box.x1 - p.box.x0 + p.box.y1 - p.box.y0);
    (bound == spantex::detail::no_bound ? unbounded : bounded) += 1;
    for (int32_t sy = p.box.y0 / 8; sy <= (p.box.y1 - 1) / 8; ++sy)
      for (int32_t sx = p.box.x0 / 8; sx <= (p.box.x1 - 1) / 8; ++sx)
        for (span_mask mask = coverage(p.edges, sx, sy) & rectangle_mask(p.box, sx, sy); mask != 0; mask &= mask - 1) {
          const int k = __builtin_ctzll(mask);
          assert_true(depth_at(p, 2 * (sx * 8 + k % 8) + 1, 2 * (sy * 8 + k / 8) + 1) <= bound);
        }
  }
  print_message("%d bounded, %d not\n", bounded, unbounded);
  assert_true(bounded > (short_run() ? 5000 : 100000) && unbounded > 100);
}

// Clip rectangles beyond the frame, and no floors.
SPANTEX_CASE(what_is_outside_of_the_frame_is_not_hidden) {
  uint32_t floors[across * down];
  std::fill(floors, floors + across * down, uint32_t(1) << 31);
  const auto triangle_at = [](int32_t x, int32_t y, vertex (&v)[3]) {
    const auto corner = [&](int32_t dx, int32_t dy) { return vertex{(x + dx - width / 2) * one / 6, (y + dy - height / 2) * one / 6, 10 * one, 0, 0}; };
    v[0] = corner(0, 0);
    v[1] = corner(9, 0);
    v[2] = corner(0, 9);
  };
  constexpr rectangle beyond{0, 0, 2 * width, 2 * height};
  vertex v[3];
  triangle_at(20, 20, v);
  assert_true(is_hidden(v, camera, beyond, floors, width, height));
  assert_false(is_hidden(v, camera, beyond, nullptr, width, height));
  triangle_at(width + 3, 20, v);
  assert_false(is_hidden(v, camera, beyond, floors, width, height));
  triangle_at(20, height + 3, v);
  assert_false(is_hidden(v, camera, beyond, floors, width, height));
}

// What it says is hidden shows nothing, span by span; and it says so of most of what shows nothing behind a wall.
SPANTEX_CASE(hidden_triangles_show_nothing) {
  int hidden = 0, shows_nothing = 0;
  for (uint64_t seed = 1; seed <= 40; ++seed) {
    with = {};
    random_source random{seed};
    for (int n = 0; n < 200; ++n) {
      vertex v[3];
      const int32_t z = int32_t(random.between(one / 2, 40 * one)), side = n < 20 ? 2 * z : z / 4;
      const int64_t x = random.between(-z, z), y = random.between(-z / 2, z / 2);
      for (vertex& c : v) c = {int32_t(x + random.between(-side, side)), int32_t(y + random.between(-side, side)), int32_t(z + random.between(-z / 8, z / 8)), 0, 0};
      polygon p{};
      if (make_polygon(v, 3, camera, {0, 0, width, height}, p) != status::ok) continue;
      const bool said = is_hidden(v, camera, {0, 0, width, height}, with.floors, width, height);
      uint64_t shown = 0;
      each_span(p, [&](int32_t sx, int32_t sy, span_mask mask) { shown += uint64_t(__builtin_popcountll(depth_test(p, sx, sy, mask, {with.values, with.floors}, width, true))); });
      if (said) assert_int_equal(shown, 0);
      hidden += said;
      shows_nothing += shown == 0;
    }
  }
  print_message("%d hidden of %d that show nothing\n", hidden, shows_nothing);
  assert_true(hidden > 200);
}

SPANTEX_CASE(depths_of_a_span_lie_between_its_corners) {
  random_source random(3);
  for (int n = 0; n < 200; ++n) {
    polygon p{};
    if (!random_polygon(random, p)) continue;
    each_span(p, [&](int32_t sx, int32_t sy, span_mask) {
      const depth_range r = depth_range_of(p, sx, sy);
      uint32_t least = UINT32_MAX, most = 0;
      for (int k = 0; k < 64; ++k) {
        const uint32_t z = depth_at(p, 2 * (sx * 8 + k % 8) + 1, 2 * (sy * 8 + k / 8) + 1);
        if (z < least) least = z;
        if (z > most) most = z;
      }
      assert_int_equal(r.least, least);
      assert_int_equal(r.most, most);
    });
  }
}

// Spans covered as a whole and in part, also where depths are saturated: nearer than the near plane beyond the polygon's edge, or as near.
SPANTEX_CASE(what_is_nearer_is_seen_and_kept) {
  random_source random(6);
  static depths tested, wanted;
  tested = wanted = {};
  int whole = 0, in_part = 0, saturated = 0;
  for (int n = 0; n < 4000; ++n) {
    if (n % 20 == 0) tested = wanted = {};
    const int32_t z = n % 4 == 0 ? one / 16 : int32_t(random.between(one / 16, 3 * one)), tilt = n % 4 == 0 ? 0 : int32_t(random.between(-z, z));
    vertex v[4];
    for (int k = 0; k < 4; ++k) {
      const int32_t sx = k == 1 || k == 2 ? 1 : -1, sy = k >= 2 ? 1 : -1;
      v[k] = {sx * int32_t(random.between(z / 4, 2 * z)), sy * int32_t(random.between(z / 8, z)), z + sx * tilt, 0, 0};
    }
    polygon p{};
    if (make_polygon(v, 4, camera, {0, 0, width, height}, p) != status::ok) continue;
    each_span(p, [&](int32_t sx, int32_t sy, span_mask mask) {
      const bool stores = n % 3 != 0;
      const span_mask seen = nearer_pixels(p, sx, sy, mask, wanted.values, stores);
      const depth_range r = depth_range_of(p, sx, sy);
      whole += mask == full_mask;
      in_part += mask != full_mask;
      saturated += mask == full_mask && (r.least == 1 || r.most == uint32_t(1) << 31);
      assert_true(depth_test(p, sx, sy, mask, {tested.values, nullptr}, width, stores) == seen);
    });
    assert_true(std::equal(std::begin(tested.values), std::end(tested.values), std::begin(wanted.values)));
  }
  std::printf("# %d spans as a whole, %d in part, %d saturated\n", whole, in_part, saturated);
  assert_true(whole > 10000 && in_part > 10000 && saturated > 1000);
}

// Nearly edge-on, beyond what 64 bits of depth hold: what a span may be taken for from its corners must hold for the pixels that are drawn.
SPANTEX_CASE(slivers_are_hidden_by_nothing_but_nearer_pixels) {
  random_source random(4);
  int slivers = 0, flat = 0;
  for (int n = 0; n < 200000; ++n) {
    const auto any = [&](int most) { return int32_t(random.between(-(int64_t(1) << random.between(0, most)), int64_t(1) << random.between(0, most))); };
    const projection eye{any(30), any(30), width * one / 2, height * one / 2, int32_t(random.between(1, int64_t(1) << random.between(1, 30)))};
    const vertex a{any(28), any(28), any(28), 0, 0}, b{any(28), any(28), any(28), 0, 0};
    const vertex along{a.x + (b.x - a.x) / 2 + any(4), a.y + (b.y - a.y) / 2 + any(4), a.z + (b.z - a.z) / 2 + any(4), 0, 0};
    const vertex v[3] = {a, b, along};
    polygon p{};
    if (make_polygon(v, 3, eye, {0, 0, width, height}, p) != status::ok) continue;
    flat += p.depth.x == 0 && p.depth.y == 0;
    each_span(p, [&](int32_t sx, int32_t sy, span_mask mask) {
      const depth_range r = depth_range_of(p, sx, sy);
      for (; mask != 0; mask &= mask - 1) {
        const int k = __builtin_ctzll(mask);
        const uint32_t z = depth_at(p, 2 * (sx * 8 + k % 8) + 1, 2 * (sy * 8 + k / 8) + 1);
        assert_true(r.least <= z && z <= r.most);
        ++slivers;
      }
    });
  }
  std::printf("# %d pixels, %d polygons of one depth\n", slivers, flat);
  assert_true(slivers > 1000 && flat > 10);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(floors_change_no_pixel_and_no_depth),
      cmocka_unit_test(depths_first_show_what_is_seen_and_nothing_else),
      cmocka_unit_test(no_pixel_of_a_span_is_farther_than_its_floor),
      cmocka_unit_test(no_pixel_is_nearer_than_the_bound),
      cmocka_unit_test(no_pixel_is_nearer_than_the_bound_where_w_has_few_bits),
      cmocka_unit_test(no_pixel_is_nearer_than_the_bound_at_the_ends_of_the_range),
      cmocka_unit_test(what_is_outside_of_the_frame_is_not_hidden),
      cmocka_unit_test(hidden_triangles_show_nothing),
      cmocka_unit_test(depths_of_a_span_lie_between_its_corners),
      cmocka_unit_test(what_is_nearer_is_seen_and_kept),
      cmocka_unit_test(slivers_are_hidden_by_nothing_but_nearer_pixels),
  };
  return run_suite("visibility", tests);
}
