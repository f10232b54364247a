// SPDX-License-Identifier: Apache-2.0
// Polygons: meshes without gaps or overlaps after projection and clipping, nothing behind the viewer, depth, and what is refused.
#include <tests/support.hpp>

#include <algorithm>
#include <tuple>
#include <vector>

using namespace spantex;
using namespace spantex::sim;

namespace {

constexpr int32_t one = 1 << 16, screen = 128;
constexpr rectangle whole{0, 0, screen, screen};
// 90 degrees of view: screen = 64 x / z + 64.
constexpr projection camera{64 * one, 64 * one, 64 * one, 64 * one, one / 16};

struct pixel_counts {
  uint8_t at[screen][screen];
  void clear() { *this = {}; }
};
pixel_counts counted;

span_mask polygon_mask(const polygon& p, int32_t sx, int32_t sy) { return coverage(p.edges, sx, sy) & rectangle_mask(p.box, sx, sy); }

template <class Visit>
void for_covered(const polygon& p, Visit visit) {
  for (int32_t sy = 0; sy < screen / 8; ++sy)
    for (int32_t sx = 0; sx < screen / 8; ++sx)
      for (span_mask m = polygon_mask(p, sx, sy); m != 0; m &= m - 1) {
        const int k = __builtin_ctzll(m);
        visit(sx * 8 + k % 8, sy * 8 + k / 8);
      }
}

// Counts a polygon's pixels; every one of them must be in front of the viewer.
void count(const vertex* v, int n) {
  polygon p{};
  const status s = make_polygon(v, n, camera, whole, p);
  if (s == status::degenerate) return;
  SPANTEX_ASSERT_OK(s);
  for_covered(p, [&p](int32_t x, int32_t y) {
    ++counted.at[y][x];
    assert_true(p.map.w_at(2 * x + 1, 2 * y + 1) > 0);
  });
}

void count_triangle(const vertex& a, const vertex& b, const vertex& c) {
  const vertex v[3] = {a, b, c};
  count(v, 3);
}

// Corner (i, j) of a mesh of cells x cells on a plane y = height + slope x below the viewer, from behind the viewer to the distance.
vertex floor_corner(int i, int j, int cells, int32_t height, int32_t slope_256) {
  const int32_t x = (i * 2 - cells) * 12 * one / cells, z = -2 * one + int32_t(int64_t(j) * 26 * one / cells);
  return {x, height + int32_t(int64_t(x) * slope_256 / 256), z, i * one, j * one};
}

// Pixels whose ray meets the mesh well inside its rim and beyond the near plane, in floating point with a wide margin.
bool is_well_inside(int32_t px, int32_t py, int32_t height, int32_t slope_256) {
  const double rx = (px + 0.5 - 64) / 64, ry = (py + 0.5 - 64) / 64;
  const double h = double(height) / one, m = slope_256 / 256.0, z = h / (ry - m * rx), x = rx * z;
  return z > 0.07 && z < 23.5 && x > -11.8 && x < 11.8;
}

void check_floor(int cells, int32_t height, int32_t slope_256, bool quads) {
  static vertex mesh[33][33];
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i) mesh[j][i] = floor_corner(i, j, cells, height, slope_256);
  counted.clear();
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i) {
      const vertex quad[4] = {mesh[j][i], mesh[j][i + 1], mesh[j + 1][i + 1], mesh[j + 1][i]};
      if (quads) { count(quad, 4); continue; }
      count_triangle(quad[0], quad[1], quad[2]);
      count_triangle(quad[0], quad[2], quad[3]);
    }
  int inside = 0;
  for (int32_t y = 0; y < screen; ++y)
    for (int32_t x = 0; x < screen; ++x) {
      const int times = counted.at[y][x];
      const auto wrong = [&](const char* what) {
        fail_msg("(%d, %d) %s: %d cells, height %d, slope %d", int(x), int(y), what, cells, int(height), int(slope_256));
      };
      if (times > 1) wrong("drawn twice");
      if (!is_well_inside(x, y, height, slope_256)) continue;
      ++inside;
      if (times != 1) wrong("not drawn");
    }
  assert_true(inside > 1000);
}

}  // namespace

SPANTEX_CASE(a_floor_of_triangles_that_passes_below_and_behind_the_viewer_has_no_gap_and_no_overlap) {
  for (const int cells : {1, 2, 7, 16, 32})
    for (const int32_t height : {one / 3, one, one + 12345, 2 * one})
      for (const int32_t slope : {0, 31, -77}) check_floor(cells, height, slope, false);
}

SPANTEX_CASE(a_floor_of_quadrilaterals_has_no_gap_and_no_overlap) {
  for (const int cells : {1, 2, 7, 16, 32})
    for (const int32_t height : {one / 3, one, one + 12345, 2 * one})
      for (const int32_t slope : {0, 31, -77}) check_floor(cells, height, slope, true);
}

// A point of a plane through the view, on the 1/256 pixel grid of the screen, whatever its depth (z = 1).
static vertex flat(int32_t x_256, int32_t y_256) { return {(x_256 - 64 * 256) * 4, (y_256 - 64 * 256) * 4, one, x_256, y_256}; }

SPANTEX_CASE(convex_polygons_that_share_edges_draw_every_pixel_once) {
  random_source random(70);
  for (int n = 0; n < 2000; ++n) {
    // A rectangle with points on its sides, in order, cut by a chord: two polygons with collinear vertices among theirs.
    const int32_t x0 = int32_t(random.between(0, 40 * 256)), x1 = int32_t(random.between(60 * 256, 128 * 256));
    const int32_t y0 = int32_t(random.between(0, 40 * 256)), y1 = int32_t(random.between(60 * 256, 128 * 256));
    const int32_t top = int32_t(random.between(x0 + 1, x1 - 1)), bottom = int32_t(random.between(x0 + 1, x1 - 1));
    const int32_t extra = int32_t(random.between(y0 + 1, y1 - 1));
    const vertex left[5] = {flat(x0, y0), flat(top, y0), flat(bottom, y1), flat(x0, y1), flat(x0, extra)};
    const vertex right[5] = {flat(top, y0), flat(x1, y0), flat(x1, extra), flat(x1, y1), flat(bottom, y1)};
    counted.clear();
    count(left, 5);
    count(right, 5);
    for (int32_t y = 0; y < screen; ++y)
      for (int32_t x = 0; x < screen; ++x) {
        const int32_t cx = x * 256 + 128, cy = y * 256 + 128;
        const bool inside = cx >= x0 && cx < x1 && cy >= y0 && cy < y1;
        assert_int_equal(counted.at[y][x], inside ? 1 : 0);
      }
  }
}

// Octagons around and beside the viewer, clipped in place by all sides of the view, against Sutherland and Hodgman with room to spare.
SPANTEX_CASE(outlines_of_most_corners_are_clipped_in_place) {
  static constexpr int8_t shape[8][2] = {{2, 1}, {1, 2}, {-1, 2}, {-2, 1}, {-2, -1}, {-1, -2}, {1, -2}, {2, -1}};
  random_source random(73);
  int most = 0, cut_by[spantex::detail::view_side_count] = {};
  for (int n = 0; n < 20000; ++n) {
    const int32_t steps = int32_t(random.between(1, 200));
    const auto some = [&](int32_t size) { return int32_t(random.between(-size, size)); };
    const int32_t at[3] = {some(8 * one), some(8 * one), some(8 * one)}, u[3] = {some(one), some(one), some(one)}, w[3] = {some(one), some(one), some(one)};
    edge_set held{};
    std::vector<edge> outline;
    for (const auto& corner : shape) {
      const auto axis = [&](int i) { return at[i] + steps * (corner[0] * u[i] + corner[1] * w[i]); };
      outline.push_back(spantex::detail::held(project({axis(0), axis(1), axis(2), 0, 0}, camera)));
      held.edges[held.count++] = outline.back();
    }
    spantex::detail::clip_to_view(camera.near_z, spantex::detail::guard_band, held);
    for (int side = 0; side < spantex::detail::view_side_count; ++side) {
      std::vector<edge> kept;
      for (size_t k = 0; k < outline.size(); ++k) {
        const edge &p = outline[k], &q = outline[(k + 1) % outline.size()];
        const int64_t here = spantex::detail::distance_from(side, camera.near_z, spantex::detail::guard_band, p), next = spantex::detail::distance_from(side, camera.near_z, spantex::detail::guard_band, q);
        edge between{};
        if (here >= 0) kept.push_back(p);
        if ((here >= 0) == (next >= 0)) continue;
        here >= 0 ? spantex::detail::cut(p, q, here, next, between) : spantex::detail::cut(q, p, next, here, between);
        kept.push_back(between);
        ++cut_by[side];
      }
      outline = kept;
    }
    assert_int_equal(held.count, outline.size());
    for (int k = 0; k < held.count; ++k) assert_true(held.edges[k] == outline[size_t(k)]);
    most = std::max(most, held.count);
  }
  assert_true(most > 10);
  for (const int cuts : cut_by) assert_true(cuts > 1000);
}

SPANTEX_CASE(both_directions_round_a_polygon_cover_the_same_pixels) {
  random_source random(71);
  static pixel_counts first;
  for (int n = 0; n < 500; ++n) {
    const auto within = [&](int32_t low, int32_t high) { return int32_t(random.between(low, high)); };
    const auto v = [&] { return vertex{within(-3 * one, 3 * one), within(-3 * one, 3 * one), within(-one, 4 * one), 0, 0}; };
    const vertex a = v(), b = v(), c = v();
    counted.clear();
    count_triangle(a, b, c);
    first = counted;
    for (const auto& [p, q, r] : {std::tuple{b, c, a}, std::tuple{c, b, a}, std::tuple{a, c, b}}) {
      counted.clear();
      count_triangle(p, q, r);
      for (int32_t y = 0; y < screen; ++y)
        for (int32_t x = 0; x < screen; ++x) assert_int_equal(counted.at[y][x], first.at[y][x]);
    }
  }
}

// Any triangle, anywhere: through the viewer, behind, far aside. What is covered is in front, and nearer than nothing.
SPANTEX_CASE(covered_pixels_of_any_triangle_are_in_front_of_the_viewer) {
  random_source random(72);
  int64_t drawn = 0;
  for (int n = 0; n < 20000; ++n) {
    const int range = 12 + n % 15;
    const auto near = [&] { return int32_t(random.between(-(int64_t(1) << range), int64_t(1) << range)); };
    const vertex v[3] = {{near(), near(), near(), 0, 0}, {near(), near(), near(), 99 * one, 0}, {near(), near(), near(), 0, 99 * one}};
    polygon p{};
    const status s = make_polygon(v, 3, camera, whole, p);
    assert_true(s == status::ok || s == status::degenerate);
    if (s != status::ok) continue;
    for_covered(p, [&](int32_t x, int32_t y) {
      ++drawn;
      assert_true(p.map.w_at(2 * x + 1, 2 * y + 1) > 0);
    });
  }
  assert_true(drawn > 1000000);
}

SPANTEX_CASE(a_polygon_behind_the_near_plane_is_degenerate) {
  polygon p{};
  const int32_t z = camera.near_z - 1;
  const vertex v[3] = {{-one, -one, z, 0, 0}, {one, -one, z, 0, 0}, {0, one, z, 0, 0}};
  SPANTEX_ASSERT_STATUS(make_polygon(v, 3, camera, whole, p), degenerate);
}

SPANTEX_CASE(degenerate_polygons_are_refused) {
  polygon p{};
  const vertex a{0, 0, one, 0, 0}, b{one, 0, one, one, 0}, c{2 * one, 0, one, 2 * one, 0}, aside{500 * one, 500 * one, one, 0, 0};
  const vertex point[3] = {a, a, a}, line[3] = {a, b, c}, edge_on[3] = {a, {0, 0, 2 * one, 0, 0}, {0, 0, 3 * one, 0, 0}};
  const vertex through_viewer[3] = {{one, one, one, 0, 0}, {2 * one, 2 * one, 2 * one, 0, 0}, {-one, 0, 0, 0, 0}};
  const vertex outside[3] = {aside, {501 * one, 500 * one, one, 0, 0}, {500 * one, 501 * one, one, 0, 0}};
  SPANTEX_ASSERT_STATUS(make_polygon(point, 3, camera, whole, p), degenerate);
  SPANTEX_ASSERT_STATUS(make_polygon(line, 3, camera, whole, p), degenerate);
  SPANTEX_ASSERT_STATUS(make_polygon(edge_on, 3, camera, whole, p), degenerate);
  SPANTEX_ASSERT_STATUS(make_polygon(outside, 3, camera, whole, p), degenerate);
  const status s = make_polygon(through_viewer, 3, camera, whole, p);
  assert_true(s == status::ok || s == status::degenerate);
}

SPANTEX_CASE(bad_calls_are_refused) {
  polygon p{};
  vertex v[9];
  for (int k = 0; k < 9; ++k) v[k] = {k * one, k * k * one, one, 0, 0};
  SPANTEX_ASSERT_STATUS(make_polygon(v, 2, camera, whole, p), bad_size);
  SPANTEX_ASSERT_STATUS(make_polygon(v, 9, camera, whole, p), bad_size);
  SPANTEX_ASSERT_STATUS(make_polygon(v, -1, camera, whole, p), bad_size);
  projection bad = camera;
  bad.near_z = 0;
  SPANTEX_ASSERT_STATUS(make_polygon(v, 3, bad, whole, p), out_of_range);
  bad.near_z = -one;
  SPANTEX_ASSERT_STATUS(make_polygon(v, 3, bad, whole, p), out_of_range);
  projection strong{INT32_MAX, INT32_MAX, 0, 0, one};
  const vertex far[3] = {{INT32_MAX, 0, one, 0, 0}, {0, INT32_MAX, one, 0, 0}, {INT32_MIN, 0, one, 0, 0}};
  SPANTEX_ASSERT_STATUS(make_polygon(far, 3, strong, whole, p), out_of_range);
  const vertex good[3] = {flat(-100 * 256, -100 * 256), flat(12000 * 256, -100 * 256), flat(-100 * 256, 120 * 256)};  // beyond both clips
  SPANTEX_ASSERT_OK(make_polygon(good, 3, camera, whole, p));
  SPANTEX_ASSERT_STATUS(make_polygon(good, 3, camera, {-8, 0, 10, 10}, p), bad_size);
  SPANTEX_ASSERT_STATUS(make_polygon(good, 3, camera, {0, 0, 5000, 10}, p), bad_size);
}

SPANTEX_CASE(front_facing_is_clockwise_on_the_screen) {
  polygon p{};
  const vertex v[3] = {flat(0, 0), flat(100 * 256, 0), flat(0, 100 * 256)}, w[3] = {v[0], v[2], v[1]};
  SPANTEX_ASSERT_OK(make_polygon(v, 3, camera, whole, p));
  assert_true(p.front_facing);
  SPANTEX_ASSERT_OK(make_polygon(w, 3, camera, whole, p));
  assert_false(p.front_facing);
}

// --- depth --------------------------------------------------------------------------------------------------

namespace {

// A quadrilateral over the whole view on the plane a x + b y + c z = d (d > 0, in front everywhere in view).
struct view_plane { int32_t a, b, c, d; };

bool make_view_quad(const view_plane& q, polygon& p) {
  vertex v[4];
  for (int k = 0; k < 4; ++k) {
    const int32_t sx = (k == 1 || k == 2) ? 1 : -1, sy = k >= 2 ? 1 : -1;      // rays (sx, sy, 1) through the corners
    const int64_t along = int64_t(q.a) * sx + int64_t(q.b) * sy + q.c;
    const int32_t z = int32_t(int64_t(q.d) * one / along);
    v[k] = {sx * z, sy * z, z, 0, 0};
  }
  return make_polygon(v, 4, camera, whole, p) == status::ok;
}

// near / z at a pixel's centre in u0.31, exactly: z = d / (a rx + b ry + c), rx = (2 x + 1 - 128) / 128.
int64_t exact_depth(const view_plane& q, int32_t x, int32_t y) {
  const int64_t along = int64_t(q.a) * (2 * x - 127) + int64_t(q.b) * (2 * y - 127) + int64_t(q.c) * 128;  // 128 d / z
  return int64_t((int128(along) * (int64_t(camera.near_z) << 31)) / (int128(q.d) * 128 * one));
}

uint32_t depth_values[screen * screen];
picture scene;

void draw_quad(const polygon& p, const texture_view& t) {
  const fixed_profile<profiles::standard> prof;
  direct_engine<fixed_profile<profiles::standard>> engine;
  renderer<direct_engine<fixed_profile<profiles::standard>>, fixed_profile<profiles::standard>> r(engine, prof, scene.frame());
  SPANTEX_ASSERT_OK(r.draw(p, t, filter::nearest, {depth_values}));
  SPANTEX_ASSERT_OK(r.finish());
}

void clear_scene() {
  scene.reset(screen, screen);
  for (uint32_t& d : depth_values) d = 0;
}

constexpr rgba8 red{255, 0, 0, 255}, blue{0, 0, 255, 255};

}  // namespace

// The vertices are rounded to 2^-16: depth may differ by what that moves the plane, 2^-15 of itself at z >= 1/2.
SPANTEX_CASE(depth_is_near_over_z) {
  random_source random(73);
  for (int n = 0; n < 300; ++n) {
    const view_plane q{int32_t(random.between(-300, 300)), int32_t(random.between(-300, 300)), 1000, int32_t(random.between(500, 8000))};
    polygon p{};
    assert_true(make_view_quad(q, p));
    for (int32_t y = 0; y < screen; y += 5)
      for (int32_t x = 0; x < screen; x += 7) {
        const int64_t want = exact_depth(q, x, y), got = depth_at(p, 2 * x + 1, 2 * y + 1);
        assert_true(magnitude_of(got - want) <= (want >> 14) + 2);
      }
  }
}

// Planes parallel to the screen have exact vertices: the depth is the floor of near/z, less than one unit away.
SPANTEX_CASE(depth_of_a_plane_parallel_to_the_screen_is_exact) {
  for (const int32_t z : {one / 16, one / 8, one / 4, one / 2, one, 2 * one, 4 * one, 64 * one}) {
    const vertex v[4] = {{-z, -z, z, 0, 0}, {z, -z, z, 0, 0}, {z, z, z, 0, 0}, {-z, z, z, 0, 0}};
    polygon p{};
    SPANTEX_ASSERT_OK(make_polygon(v, 4, camera, whole, p));
    const int64_t want = (int64_t(camera.near_z) << 31) / z;
    for (int32_t y = 0; y < screen; y += 3)
      for (int32_t x = 0; x < screen; x += 3) assert_true(magnitude_of(int64_t(depth_at(p, 2 * x + 1, 2 * y + 1)) - want) <= 4);
  }
}

SPANTEX_CASE(the_nearer_polygon_wins_in_either_order) {
  const texture_view near_map = constant_map(8, 8, red).view(wrap::repeat, wrap::repeat);
  const texture_view far_map = constant_map(8, 8, blue).view(wrap::repeat, wrap::repeat);
  random_source random(74);
  for (int n = 0; n < 40; ++n) {
    const int32_t a = int32_t(random.between(-300, 300)), b = int32_t(random.between(-300, 300)), d = int32_t(random.between(600, 4000));
    polygon near{}, far{};
    assert_true(make_view_quad({a, b, 1000, d}, near) && make_view_quad({a, b, 1000, d + d / 100}, far));
    for (const bool near_first : {true, false}) {
      clear_scene();
      draw_quad(near_first ? near : far, near_first ? near_map : far_map);
      draw_quad(near_first ? far : near, near_first ? far_map : near_map);
      for (const rgba8& c : scene.pixels) assert_true(c == red);
    }
  }
}

// A pixel is visible if its depth exceeds the stored one: of two polygons at the same place the first stays.
SPANTEX_CASE(the_first_polygon_stays_where_depths_are_equal) {
  const texture_view first = constant_map(8, 8, red).view(wrap::repeat, wrap::repeat);
  const texture_view second = constant_map(8, 8, blue).view(wrap::repeat, wrap::repeat);
  polygon p{};
  assert_true(make_view_quad({120, -70, 1000, 2000}, p));
  clear_scene();
  draw_quad(p, first);
  draw_quad(p, second);
  for (const rgba8& c : scene.pixels) assert_true(c == red);
}

SPANTEX_CASE(intersecting_polygons_part_along_their_line) {
  const texture_view map_a = constant_map(8, 8, red).view(wrap::repeat, wrap::repeat);
  const texture_view map_b = constant_map(8, 8, blue).view(wrap::repeat, wrap::repeat);
  random_source random(75);
  int64_t reds = 0, blues = 0;
  for (int n = 0; n < 40; ++n) {
    const auto slope = [&] { return int32_t(random.between(-400, 400)); };
    const view_plane qa{slope(), slope(), 1000, 2000}, qb{slope(), slope(), 1000, 2000 + int32_t(random.between(-100, 100))};
    polygon pa{}, pb{};
    assert_true(make_view_quad(qa, pa) && make_view_quad(qb, pb));
    clear_scene();
    draw_quad(n % 2 == 0 ? pa : pb, n % 2 == 0 ? map_a : map_b);
    draw_quad(n % 2 == 0 ? pb : pa, n % 2 == 0 ? map_b : map_a);
    for (int32_t y = 0; y < screen; ++y)
      for (int32_t x = 0; x < screen; ++x) {
        const int64_t da = exact_depth(qa, x, y), db = exact_depth(qb, x, y);
        const rgba8 c = scene.pixels[size_t(y * screen + x)];
        (c == red ? reds : blues) += 1;
        if (magnitude_of(da - db) <= (da >> 13)) continue;  // the rounding of vertices decides
        assert_true(c == (da > db ? red : blue));
      }
  }
  assert_true(reds > 100000 && blues > 100000);
}

// floor(256 x / z + 1/2): the nearest 256th of a pixel, halves up, for both signs.
SPANTEX_CASE(vertices_snap_to_the_nearest_256th_halves_up) {
  random_source random(21);
  for (int k = 0; k < 1000000; ++k) {
    const int64_t z = 1 + int64_t(magnitude(random.any_magnitude(31)));
    int64_t x = random.between(-16000, 16000) * z + random.between(0, z - 1);
    if (k % 4 == 0) x = (random.between(-4000000, 4000000) * 2 + 1) * z / 512;  // on a tie where z is a multiple of 512, else next to one
    const int64_t snapped = spantex::detail::snapped(x, z);
    // snapped - 1/2 <= 256 x / z < snapped + 1/2
    assert_true(int128(2 * snapped - 1) * z <= int128(512) * x && int128(512) * x < int128(2 * snapped + 1) * z);
  }
  assert_int_equal(spantex::detail::snapped(1, 512), 1);
  assert_int_equal(spantex::detail::snapped(-1, 512), 0);
  assert_int_equal(spantex::detail::snapped(int64_t(1) << 44, 1), int64_t(guard_px) << subpixel_bits);
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(vertices_snap_to_the_nearest_256th_halves_up),
      cmocka_unit_test(a_floor_of_triangles_that_passes_below_and_behind_the_viewer_has_no_gap_and_no_overlap),
      cmocka_unit_test(a_floor_of_quadrilaterals_has_no_gap_and_no_overlap),
      cmocka_unit_test(convex_polygons_that_share_edges_draw_every_pixel_once),
      cmocka_unit_test(outlines_of_most_corners_are_clipped_in_place),
      cmocka_unit_test(both_directions_round_a_polygon_cover_the_same_pixels),
      cmocka_unit_test(covered_pixels_of_any_triangle_are_in_front_of_the_viewer),
      cmocka_unit_test(a_polygon_behind_the_near_plane_is_degenerate),
      cmocka_unit_test(degenerate_polygons_are_refused),
      cmocka_unit_test(bad_calls_are_refused),
      cmocka_unit_test(front_facing_is_clockwise_on_the_screen),
      cmocka_unit_test(depth_is_near_over_z),
      cmocka_unit_test(depth_of_a_plane_parallel_to_the_screen_is_exact),
      cmocka_unit_test(the_nearer_polygon_wins_in_either_order),
      cmocka_unit_test(the_first_polygon_stays_where_depths_are_equal),
      cmocka_unit_test(intersecting_polygons_part_along_their_line),
  };
  return run_suite("polygon", tests);
}
