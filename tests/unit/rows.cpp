// SPDX-License-Identifier: Apache-2.0
// Drawing by rows: kernels and borders against the specification a pixel at a time; positions against exact arithmetic; filters against what a
// convex combination must keep.
#include <tests/support.hpp>

#include <algorithm>
#include <cmath>

#include <firmware/apps/rows_scenes.hpp>
#include <spantex/rows/small_plane.hpp>
#include <tests/rows_reference.hpp>

using namespace spantex;
using namespace spantex::sim;

static rows::state state;
static int32_t between(random_source& random, int32_t low, int32_t high) { return int32_t(random.between(low, high)); }
static constexpr int32_t width = 300, height = 100;  // more than one block, however wide
static uint16_t frame[width * height];

// A map with levels of its own size, exactly as much memory as its texels take.
struct small_map {
  std::vector<std::vector<uint16_t>> levels;
  texture_view view;
};
static small_map& make_small_map(int32_t w, int32_t h, int count, wrap across, wrap down, random_source& random) {
  static std::deque<small_map> maps;
  maps.clear();
  small_map& m = maps.emplace_back();
  const uint16_t* pointers[max_levels] = {};
  for (int level = 0; level < count; ++level) {
    m.levels.emplace_back(size_t(level_side(w, level) * level_side(h, level)));
    for (uint16_t& t : m.levels.back()) t = uint16_t(random.next());
    pointers[level] = m.levels.back().data();
  }
  SPANTEX_ASSERT_OK(texture_view::make(texel_format::rgb565, pointers, count, w, h, across, down, m.view));
  return m;
}
static small_map& make_small_map(int32_t w, int32_t h, int count, wrap mode, random_source& random) { return make_small_map(w, h, count, mode, mode, random); }

// W between an eighth and one over the picture, coordinates of any direction and scale; some with straight rows, some facing the viewer.
static homography random_homography(random_source& random, int kind) {
  const int64_t one = 1 << 24;
  const auto within = [&](int64_t x) { return random.between(-x, x); };
  const int64_t scale = one >> random.between(0, 5);
  const int64_t g = kind % 3 == 0 ? 0 : within(one * 3 / 8 / width), h = kind % 5 == 0 ? 0 : within(one * 3 / 8 / height);
  const int64_t i = one / 8 + (g < 0 ? -g * width : 0) + (h < 0 ? -h * height : 0) + within(one / 16);
  return {2 * within(scale), 2 * within(scale), within(one) * 32, 2 * within(scale), 2 * within(scale), within(one) * 32, g, h, i};
}

static void check_picture(const homography& m, const texture_view& t, filter kind, rectangle area) {
  static plane p;
  if (make_plane(m, {0, 0, width, height}, p) != status::ok) return;
  for (uint16_t& pixel : frame) pixel = 0xABCD;
  SPANTEX_ASSERT_OK(rows::draw_any(kind, state, rows::frame565{frame, width, height, width}, p, t, area));
  for (int32_t y = 0; y < height; ++y)
    for (int32_t x = 0; x < width; ++x) {
      uint16_t expected = 0xABCD;
      if (x >= area.x0 && x < area.x1 && y >= area.y0 && y < area.y1) (void)rows::reference_pixel(p, t, kind, x, y, expected);
      if (frame[y * width + x] != expected)
        fail_msg("%s at %d, %d: %04x instead of %04x", app::name_of_filter(kind), int(x), int(y), unsigned(frame[y * width + x]), unsigned(expected));
    }
}

static void check_maps(wrap across, wrap down, uint64_t seed) {
  random_source random(seed);
  static constexpr int32_t sizes[][3] = {{64, 64, 7}, {32, 128, 8}, {48, 80, 5}, {20, 12, 3}, {7, 5, 1}, {1, 1, 1}, {256, 2, 9}, {64, 48, 7}, {48, 64, 5}};
  for (int n = 0; n < (short_run() ? 9 : 36); ++n) {
    const auto& size = sizes[n % 9];
    const texture_view& t = make_small_map(size[0], size[1], size[2], across, down, random).view;
    const homography m = random_homography(random, n);
    const rectangle area{between(random, 0, 40), between(random, 0, 40), between(random, 100, width), between(random, 100, height)};
    for (filter kind : app::row_filters) check_picture(m, t, kind, n % 2 == 0 ? rectangle{0, 0, width, height} : area);
  }
}
SPANTEX_CASE(kernels_draw_what_the_specification_says_repeat) { check_maps(wrap::repeat, wrap::repeat, 1); }
SPANTEX_CASE(kernels_draw_what_the_specification_says_clamp) { check_maps(wrap::clamp, wrap::clamp, 2); }
SPANTEX_CASE(kernels_draw_what_the_specification_says_mirror) { check_maps(wrap::mirror, wrap::mirror, 3); }
SPANTEX_CASE(kernels_draw_what_the_specification_says_repeat_across) {
  for (wrap down : {wrap::clamp, wrap::mirror}) check_maps(wrap::repeat, down, 4);
}
SPANTEX_CASE(kernels_draw_what_the_specification_says_repeat_down) {
  for (wrap across : {wrap::clamp, wrap::mirror}) check_maps(across, wrap::repeat, 5);
}

SPANTEX_CASE(planes_to_the_horizon_are_drawn_in_front_of_it_only) {
  random_source random(4);
  for (int n = 0; n < 8; ++n) {
    const texture_view& t = make_small_map(64, 64, 7, wrap::repeat, random).view;
    homography m = random_homography(random, 1);
    m.i = -multiply(m.g, random.between(0, width)) - multiply(m.h, random.between(0, height));
    for (filter kind : app::row_filters) check_picture(m, t, kind, {0, 0, width, height});
    static plane p;
    if (make_plane(m, {0, 0, width, height}, p) != status::ok) continue;
    for (int32_t y = 0; y < height; ++y)
      for (int32_t x = 0; x < width; ++x) {
        rows::reference_position at{};
        assert_int_equal(rows::find_block(p, x, y, -1, at), p.w_at(2 * x + 1, 2 * y + 1) > 0);
      }
  }
}

// A side of one texel stays one on the levels above.
SPANTEX_CASE(the_coarsest_levels_of_maps_that_are_not_square_are_drawn) {
  random_source random(7);
  const int64_t one = 1 << 16;
  static constexpr int32_t sizes[][3] = {{64, 32, 7}, {4, 64, 7}, {128, 1, 8}, {96, 32, 6}, {24, 16, 5}};
  for (wrap mode : {wrap::repeat, wrap::clamp, wrap::mirror})
    for (const auto& size : sizes) {
      const texture_view& t = make_small_map(size[0], size[1], size[2], mode, random).view;
      for (const int64_t texels_a_pixel : {7, 14, 29, 60, 130})
        for (filter kind : app::row_filters) check_picture({texels_a_pixel * one, one / 8, 3 * one, one / 8, texels_a_pixel * one, -one, 0, 0, one}, t, kind, {0, 0, width, height});
    }
}

// Up to the range's end and beyond it.
SPANTEX_CASE(planes_far_from_the_origin_are_drawn) {
  random_source random(6);
  for (wrap mode : {wrap::repeat, wrap::clamp, wrap::mirror})
    for (int32_t far : {32600, -32600}) {
      const texture_view& t = make_small_map(256, 64, 7, mode, random).view;
      const int64_t one = 1 << 16;
      for (filter kind : app::row_filters) check_picture({one, one / 8, far * one, one / 8, one, -far * one, 0, 0, one}, t, kind, {0, 0, width, height});
    }
}

SPANTEX_CASE(polygons_cover_the_pixels_of_their_masks) {
  random_source random(5);
  const texture_view& t = make_small_map(64, 64, 7, wrap::repeat, random).view;
  const projection camera{150 << 16, 150 << 16, (width / 2) << 16, (height / 2) << 16, 1 << 13};
  static polygon p;
  int drawn = 0;
  for (int n = 0; n < 60; ++n) {
    vertex corners[3];
    const int32_t depth = between(random, 1 << 15, 6 << 16);  // of every other one: facing the viewer, drawn in wide blocks
    for (vertex& v : corners) {
      v = {between(random, -3 << 16, 3 << 16), between(random, -3 << 16, 3 << 16), n % 2 == 0 ? depth : between(random, 1 << 15, 6 << 16),
           between(random, 0, 64 << 16), between(random, 0, 64 << 16)};
    }
    if (make_polygon(corners, 3, camera, {0, 0, width, height}, p) != status::ok) continue;
    ++drawn;
    for (uint16_t& pixel : frame) pixel = 0xABCD;
    SPANTEX_ASSERT_OK(rows::draw<filter::bilinear>(state, rows::frame565{frame, width, height, width}, p, t));
    for (int32_t y = 0; y < height; ++y)
      for (int32_t x = 0; x < width; ++x) {
        const bool covered = (coverage(p.edges, x / 8, y / 8) & rectangle_mask(p.box, x / 8, y / 8)) >> (y % 8 * 8 + x % 8) & 1;
        uint16_t expected = 0xABCD;
        if (covered) (void)rows::reference_pixel(p.map, t, filter::bilinear, x, y, expected);
        assert_int_equal(frame[y * width + x], expected);
      }
  }
  assert_true(drawn > 20);
}

// --- positions -----------------------------------------------------------------------------------------

// Texels that are right, and the worst distance in units: texels of level 0 without levels.
struct exactness {
  int64_t pixels = 0, right = 0;
  double worst = 0, worst_straight = 0;

  // The true position is (nu, nv) / d.
  void compare(const rows::reference_position& found, int128 nu, int128 nv, int128 d) {
    const rows::exact_position q = rows::position_on_level_0(found);
    const auto floor_of = [](int128 n, int128 by) { return int64_t(n / by - (n % by < 0 ? 1 : 0)); };
    const int64_t u = floor_of(nu * 65536, d), v = floor_of(nv * 65536, d);
    if (u > 30000 * 65536ll || u < -30000 * 65536ll || v > 30000 * 65536ll || v < -30000 * 65536ll) return;
    ++pixels;
    right += u >> 16 == q.u >> 16 && v >> 16 == q.v >> 16;
    const double off = double(std::max(std::llabs(u - q.u), std::llabs(v - q.v))) / double(int64_t(65536) << found.b.unit_log2);
    double& most = found.b.straight ? worst_straight : worst;
    most = std::max(most, off);
  }
};

// Of a picture, against the homography itself, in 128-bit integers.
static void measure(const homography& m, int32_t w, int32_t h, int last_level, exactness& e) {
  static plane p;
  if (make_plane(m, {0, 0, w, h}, p) != status::ok) return;
  for (int32_t y = 0; y < h; ++y)
    for (int32_t x = 0; x < w; ++x) {
      const auto at = [&](wide a, wide b, wide c) { return to_int128(a) * (2 * x + 1) + to_int128(b) * (2 * y + 1) + 2 * to_int128(c); };
      const int128 d = at(m.g, m.h, m.i);
      rows::reference_position found;
      if (d > 0 && rows::find_block(p, x, y, last_level, found)) e.compare(found, at(m.a, m.b, m.c), at(m.d, m.e, m.f), d);
    }
}

SPANTEX_CASE(at_least_99_percent_of_the_texels_are_those_of_exact_arithmetic) {
  for (const app::scene& s : app::scenes)
    for (int down : {1, 2, 4}) {
      exactness e;
      measure(app::scaled_to(s.map, down), 320 / down, 240 / down, -1, e);
      print_message("%-8s 320/%d: %.3f %% right, worst 1/%.0f texel\n", s.name, down, 100.0 * double(e.right) / double(e.pixels), 1 / std::max(e.worst, e.worst_straight));
      assert_true(e.right * 100 >= e.pixels * 99);
    }
}

// As defined, however a core finds them.
SPANTEX_CASE(inverses_are_exact) {
  random_source random(12);
  const auto check = [](uint32_t m) {
    const auto expected = int32_t(((uint64_t(1) << 62) - 1) / m);
    const int32_t found[] = {rows::detail::inverse_of(m), rows::detail::inverse_by_bits(m), rows::detail::inverse_by_halves(m)};
    for (int32_t x : found) if (x != expected) fail_msg("of %08x", unsigned(m));
  };
  for (uint32_t n = 0x8000; n <= 0xFFFF; ++n) {
    check(n << 16);
    check(n << 16 | 0xFFFF);
  }
  for (uint32_t n = 0; n < 100000; ++n) {
    check(0x80000000u + n);
    check(0xFFFFFFFFu - n);
    check(uint32_t(random.next()) | 0x80000000u);
  }
}

// Where the horizon is level the planes of rows_scenes.hpp need no block narrower than 32 pixels, level by level; on level 0 alone towards the horizon.
SPANTEX_CASE(blocks_of_planes_with_a_level_horizon_are_wide) {
  static plane p;
  for (int k = 0; k < 3; ++k)
    for (int last_level : {-1, 8}) {
      SPANTEX_ASSERT_OK(make_plane(app::scenes[k].map, {0, 0, 320, 240}, p));
      int blocks = 0, narrow = 0;
      for (int32_t y = 0; y < 240; ++y)
        for (int32_t x = 0; x < 320; ++x) {
          rows::reference_position at{};
          assert_true(rows::find_block(p, x, y, last_level, at));
          if (at.i != 0 || at.j != 0) continue;
          ++blocks;
          narrow += at.b.k < rows::largest_block_log2;
        }
      print_message("%s%s: %d blocks, %d narrower than 32 pixels\n", app::scenes[k].name, last_level < 0 ? "" : ", levels", blocks, narrow);
      const bool grazing = k == 2;
      assert_true(blocks <= (!grazing ? 80 : last_level < 0 ? 230 : 130));
      assert_true(narrow <= (grazing && last_level < 0 ? 30 : 0));
    }
}

// As cores with vectors make them, four at once.
SPANTEX_CASE(rows_in_lanes_are_those_made_one_by_one) {
  typedef int32_t lanes __attribute__((vector_size(16)));
  typedef uint32_t numbers __attribute__((vector_size(16)));
  random_source random(7);
  int checked = 0;
  for (int n = 0; n < 2000; ++n) {
    static plane p;
    rows::reference_position at;
    if (make_plane(random_homography(random, n), {0, 0, width, height}, p) != status::ok) continue;
    if (!rows::find_block(p, between(random, 0, width - 1), between(random, 0, height - 1), n % 2 == 0 ? -1 : 6, at) || at.b.k == 0) continue;
    at.b.u.offset = between(random, -(1 << 20), 1 << 20);
    rows::walk made[32];
    rows::detail::make_rows(at.b, 0, std::min(1 << at.b.n, rows::detail::strip_rows), made);
    for (int j = 0; j < 1 << at.b.n; ++j) {
      const uint32_t first = uint32_t(j & ~3);
      const int lane = j & 3;
      const auto four = rows::detail::axis_at<lanes>(at.b.u, rows::detail::numbers_of(numbers{first, first + 1, first + 2, first + 3}), at.b.k);
      rows::walk w;
      rows::row_at(at.b, j, w);
      assert_true(four.start[lane] == w.u && four.step[lane] == w.du && four.bend[lane] == w.ddu);
      if (j < rows::detail::strip_rows) assert_memory_equal(&made[j], &w, sizeof w);
      ++checked;
    }
  }
  print_message("%d rows\n", checked);
  assert_true(checked > 10000);
}

// The bound of docs/ACCURACY.md "Rows".
SPANTEX_CASE(positions_keep_their_bound) {
  for (int last_level : {-1, 12}) {
    random_source random(6);
    exactness e;
    for (int n = 0; n < (short_run() ? 20 : 100); ++n) measure(random_homography(random, n), width, height, last_level, e);
    print_message("%lld positions%s, %.3f %% of the texels right, worst 1/%.1f unit, straight rows 1/%.1f\n", (long long)e.pixels, last_level < 0 ? "" : " with levels",
                  100.0 * double(e.right) / double(e.pixels), 1 / e.worst, 1 / e.worst_straight);
    assert_true(e.worst <= 1.0 / 28 && e.worst_straight <= 1.0 / 45);
    if (last_level < 0) assert_true(e.right * 100 >= e.pixels * 99);
  }
}

// Blocks of every shape as far as W, u and v may go in them: nothing overflows (sanitizers), and the bound is kept.
SPANTEX_CASE(blocks_at_their_limits_keep_their_bound) {
  random_source random(15);
  exactness e;
  int drawn = 0;
  for (int n = 0; n < (short_run() ? 40000 : 400000); ++n) {
    const bool straight = n % 3 == 0;
    const int k = between(random, 1, straight ? 8 : 5), rows_log2 = between(random, 0, 5), width_of = (1 << k) - 1, height_of = (1 << rows_log2) - 1;
    const int64_t w = int64_t(1) << between(random, 40, 44);
    const bool steepest = random.between(0, 1) == 0, farthest = random.between(0, 1) == 0, tie = random.between(0, 1) == 0;
    const auto share = [&](int64_t x, bool all) { return all ? x : x / 1024 * random.between(0, 1024) >> random.between(0, 5); };
    const auto either_way = [&](int64_t x) { return random.between(0, 1) == 0 ? x : -x; };
    // All of `most`, some across and the rest down.
    const auto split = [&](int64_t most, bool down_alone, int64_t& across, int64_t& down) {
      const int64_t part = down_alone ? 0 : rows_log2 == 0 ? 16 : random.between(0, 16);
      across = either_way(most / 16 * part / width_of);
      down = rows_log2 == 0 ? 0 : either_way(most / 16 * (16 - part) / height_of);
    };
    plane p{};
    p.origin_x = 1 << k;
    p.origin_y = 1 << rows_log2;
    split(share(w / 8, steepest), straight, p.w.x, p.w.y);
    p.w.c = w;
    for (linear_form* f : {&p.u, &p.v}) {
      const int64_t c = tie ? either_way(w / 2) : random.between(-w / 2, w / 2), base = random.between(-1000, 1000);  // half a texel: the base may be either
      split(share((straight ? 256 : 96) * w - w, farthest), false, f->x, f->y);
      *f = {f->x + base * p.w.x, f->y + base * p.w.y, c + base * w};
    }
    rows::centre about{};
    rows::reference_position at{};
    if (rows::block_at<false>(p, 0, 0, k, rows_log2, {}, about, at.b) != rows::outcome::drawn) continue;
    ++drawn;
    for (at.j = 0; at.j <= height_of; at.j += max_of(height_of / 3, 1))
      for (at.i = 0; at.i <= width_of; at.i += max_of(width_of / 3, 1)) {
        const int32_t hx = 2 * at.i + 1, hy = 2 * at.j + 1;
        e.compare(at, p.u_at(hx, hy), p.v_at(hx, hy), p.w_at(hx, hy));
      }
  }
  print_message("%d blocks, worst 1/%.1f unit, straight rows 1/%.1f\n", drawn, 1 / e.worst, 1 / e.worst_straight);
  assert_true(drawn > 10000 && e.worst <= 1.0 / 28 && e.worst_straight <= 1.0 / 45);
}

// A plane whose horizon crosses the picture or lies near it, of any direction, steep or all but level, texels from 2^-10 to 2^9 pixels.
static homography random_horizon(random_source& random, int32_t w, int32_t h) {
  const int64_t one = 1 << 24;
  const auto within = [&](int64_t x) { return random.between(-x, x); };
  const auto slope = [&](int32_t side, int flattest) { return within((one << 2) / side >> random.between(0, flattest)); };
  int64_t g = 0, f = 0;
  switch (random.between(0, 5)) {
    case 0: f = slope(h, 14); break;
    case 1: g = slope(w, 14); break;
    case 2: g = slope(w, 16); f = slope(h, 16); break;
    case 3: f = slope(h, 5); g = f >> random.between(1, 12); break;
    case 4: g = slope(w, 5); f = g >> random.between(1, 12); break;
    default: break;
  }
  // A number at a time: in which order compilers take operands is theirs.
  const int64_t x = random.between(-50, w + 50), y = random.between(-50, h + 50), near = one >> random.between(0, 12);
  const int64_t i = g == 0 && f == 0 ? one : -g * x - f * y + near;
  const auto scale = [&] {
    const int64_t larger = one << random.between(0, 9);
    return within(larger >> random.between(0, 10));
  };
  const auto offset = [&] { return within(one << random.between(0, 22)); };
  return {scale(), scale(), offset(), scale(), scale(), offset(), g, f, i};
}

// The bound of docs/ACCURACY.md "Rows" for the level of detail: 0.0246, and what its rounding adds.
SPANTEX_CASE(levels_of_rows_keep_their_bound) {
  random_source random(14);
  double worst = 0;
  int checked = 0;
  for (int n = 0; n < 4000; ++n) {
    static plane p;
    if (make_plane(random_horizon(random, width, height), {0, 0, width, height}, p) != status::ok) continue;
    for (int k = 0; k < 20; ++k) {
      const int32_t x = between(random, 0, width - 1), y = between(random, 0, height - 1);
      rows::reference_position at{};
      if (!rows::find_block(p, x, y, 12, at)) continue;
      const rows::level_run run = rows::level_rows_of(at.b).row(at.j);
      const double exact = double(p.major_log2) / 65536 - 2 * std::log2(double(p.w_at(2 * x + 1, 2 * y + 1))) - 1;
      worst = std::max(worst, std::abs((run.start + at.i * run.step) / 65536.0 - exact));
      ++checked;
    }
  }
  print_message("%d levels of detail, worst %.4f\n", checked, worst);
  assert_true(checked > 10000 && worst <= 0.025);
}

// Against the plane's own forms. And no pixel leaves its block's box, by which kernels are let off looking for the map's borders.
SPANTEX_CASE(positions_keep_their_bound_towards_any_horizon) {
  random_source random(10);
  exactness e[2];
  int64_t scaled = 0;
  for (int n = 0; n < (short_run() ? 2000 : 40000); ++n) {
    static plane p;
    if (make_plane(random_horizon(random, width, height), {0, 0, width, height}, p) != status::ok) continue;
    for (int k = 0; k < 40; ++k) {
      const int32_t x = between(random, 0, width - 1), y = between(random, 0, height - 1), hx = 2 * x + 1, hy = 2 * y + 1;
      const bool levels = k % 2 != 0;
      rows::reference_position found;
      const int64_t w = p.w_at(hx, hy);
      assert_int_equal(rows::find_block(p, x, y, levels ? 12 : -1, found), w > 0);
      if (w <= 0 || found.b.k == 0) continue;
      scaled += found.b.unit_log2 > 2;
      e[levels].compare(found, p.u_at(hx, hy), p.v_at(hx, hy), w);
      rows::walk at[2];
      rows::detail::box box;
      const int last = (1 << found.b.n) - 1, count = std::min(1 << found.b.k, 32), first = found.i & -32;
      rows::detail::set_offsets(found.b, found.b.unit_log2, rows::snap);
      const auto row_from = [&](int j, rows::walk& out) {
        rows::row_at(found.b, j, out);
        out = rows::advanced(out, first);
      };
      row_from(0, at[0]);
      row_from(last, at[1]);
      rows::detail::box_of_rows(at[0], at[1], count, 0, box);
      for (int j = 0; j <= last; ++j) {
        row_from(j, at[0]);
        for (int i = 0; i < count; ++i, at[0].step()) assert_true(at[0].u >= box.u.low && at[0].u <= box.u.high && at[0].v >= box.v.low && at[0].v <= box.v.high);
      }
    }
  }
  print_message("%lld positions, worst 1/%.1f texel, straight rows 1/%.1f; %lld with levels, worst 1/%.1f and 1/%.1f unit, %lld of units of 8 texels and more\n", (long long)e[0].pixels,
                1 / e[0].worst, 1 / e[0].worst_straight, (long long)e[1].pixels, 1 / e[1].worst, 1 / e[1].worst_straight, (long long)scaled);
  assert_true(e[0].pixels > 5000 && e[1].pixels > 5000 && scaled > 1000);
  for (const exactness& x : e) assert_true(x.worst <= 1.0 / 28 && x.worst_straight <= 1.0 / 45);
}

// --- filters -------------------------------------------------------------------------------------------

static int channel(uint16_t c, int k) { return k == 0 ? c >> 11 : k == 1 ? c >> 5 & 63 : c & 31; }

SPANTEX_CASE(colours_lie_between_their_texels_and_constants_stay) {
  random_source random(7);
  for (int n = 0; n < 400000; ++n) {
    const rows::texels t{uint16_t(random.next()), uint16_t(random.next()), uint16_t(random.next()), uint16_t(random.next())};
    const uint32_t fu = uint32_t(random.between(0, 31)), fv = uint32_t(random.between(0, 31)), f = uint32_t(random.between(0, 15));
    const rows::sums four = rows::four_point(t, fu, fv), other = rows::four_point({t.t11, t.t00, t.t10, t.t01}, fv, fu);
    const uint16_t results[] = {rows::rounded(four, 10), rows::rounded(rows::three_point(t, fu, fv), 5), rows::rounded(rows::between_levels(four, other, f), 14)};
    for (int k = 0; k < 3; ++k) {
      const int c[] = {channel(uint16_t(t.t00), k), channel(uint16_t(t.t10), k), channel(uint16_t(t.t01), k), channel(uint16_t(t.t11), k)};
      const auto [low, high] = std::minmax({c[0], c[1], c[2], c[3]});
      for (uint16_t r : results) assert_in_range(channel(r, k), low, high);
      const double exact = (c[0] * (32. - fu) + c[1] * double(fu)) * (32. - fv) + (c[2] * (32. - fu) + c[3] * double(fu)) * double(fv);
      assert_true(std::abs(channel(results[0], k) - exact / 1024) <= 0.5);
    }
    const rows::texels flat{t.t00, t.t00, t.t00, t.t00};
    assert_int_equal(rows::rounded(rows::four_point(flat, fu, fv), 10), t.t00);
    assert_int_equal(rows::rounded(rows::three_point(flat, fu, fv), 5), t.t00);
  }
}

// Two texels at a time in one product: every weight, channels at their ends, where sums come closest to leaving their half.
SPANTEX_CASE(pairs_of_texels_are_weighted_as_the_specification_says) {
  const uint16_t ends[] = {0, 0xFFFF, 0xF81F, 0x07E0};
  for (uint32_t fu = 0; fu < 32; ++fu)
    for (uint32_t fv = 0; fv < 32; ++fv)
      for (int k = 0; k < 256; ++k) {
        const rows::texels t{ends[k & 3], ends[k >> 2 & 3], ends[k >> 4 & 3], ends[k >> 6]}, other{t.t11, t.t01, t.t00, t.t10};
        const uint32_t gu = 31 - fv, gv = fu, f = uint32_t(k) & 15;
        const rows::detail::upper_sums four = rows::detail::four_points(t, fu, fv), next = rows::detail::four_points(other, gu, gv);
        assert_int_equal(rows::detail::pixel_of(four), rows::rounded(rows::four_point(t, fu, fv), 10));
        assert_int_equal(rows::detail::pixel_between(four, next, f), rows::rounded(rows::between_levels(rows::four_point(t, fu, fv), rows::four_point(other, gu, gv), f), 14));
      }
}

SPANTEX_CASE(maps_and_filters_that_rows_do_not_have_are_refused) {
  random_source random(8);
  static plane p;
  SPANTEX_ASSERT_OK(make_plane(app::scenes[0].map, {0, 0, width, height}, p));
  const rows::frame565 target{frame, width, height, width};
  const rectangle screen{0, 0, width, height};
  const texture_view odd = make_small_map(20, 12, 4, wrap::repeat, random).view;
  SPANTEX_ASSERT_STATUS(rows::draw_any(filter::trilinear, state, target, p, odd, screen), bad_levels);
  SPANTEX_ASSERT_OK(rows::draw_any(filter::bilinear, state, target, p, odd, screen));
  SPANTEX_ASSERT_STATUS(rows::draw_any(filter::aniso, state, target, p, odd, screen), out_of_range);
  static const rgba8 texel[1] = {};
  const rgba8* const levels[] = {texel};
  texture_view wrong;
  SPANTEX_ASSERT_OK(texture_view::make(levels, 1, 1, 1, wrap::repeat, wrap::repeat, wrong));
  SPANTEX_ASSERT_STATUS(rows::draw_any(filter::nearest, state, target, p, wrong, screen), out_of_range);
}

SPANTEX_CASE(set_up_in_64_bits_gives_the_plane_of_128) {
  random_source random(9);
  int made = 0;
  for (int n = 0; n < 20000; ++n) {
    const int64_t slope = int64_t(1) << random.between(4, 39), constant = int64_t(1) << random.between(4, 51);
    const auto x = [&](int64_t most) { return random.between(-most, most); };
    const rows::homography64 m{x(slope), x(slope), x(constant), x(slope), x(slope), x(constant), x(slope), x(slope), x(constant)};
    static plane wide, small;
    const rectangle region{0, 0, between(random, 1, 4096), between(random, 1, 4096)};
    const status a = make_plane({m.a, m.b, m.c, m.d, m.e, m.f, m.g, m.h, m.i}, region, wide), b = rows::make_small_plane<true>(m, region, small);
    assert_int_equal(int(a), int(b));
    if (a != status::ok) continue;
    ++made;
    const linear_form *const w[] = {&wide.u, &wide.v, &wide.w}, *const s[] = {&small.u, &small.v, &small.w};
    for (int k = 0; k < 3; ++k) assert_true(w[k]->x == s[k]->x && w[k]->y == s[k]->y && w[k]->c == s[k]->c);
    assert_true(wide.origin_x == small.origin_x && wide.origin_y == small.origin_y && wide.major_log2 == small.major_log2);
  }
  assert_true(made > 5000);
  static plane p;
  assert_int_equal(int(rows::make_small_plane<false>({int64_t(1) << 40, 0, 0, 0, 0, 0, 0, 0, 1}, {0, 0, 8, 8}, p)), int(status::out_of_range));
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(kernels_draw_what_the_specification_says_repeat),
      cmocka_unit_test(kernels_draw_what_the_specification_says_clamp),
      cmocka_unit_test(kernels_draw_what_the_specification_says_mirror),
      cmocka_unit_test(kernels_draw_what_the_specification_says_repeat_across),
      cmocka_unit_test(kernels_draw_what_the_specification_says_repeat_down),
      cmocka_unit_test(planes_to_the_horizon_are_drawn_in_front_of_it_only),
      cmocka_unit_test(the_coarsest_levels_of_maps_that_are_not_square_are_drawn),
      cmocka_unit_test(planes_far_from_the_origin_are_drawn),
      cmocka_unit_test(polygons_cover_the_pixels_of_their_masks),
      cmocka_unit_test(at_least_99_percent_of_the_texels_are_those_of_exact_arithmetic),
      cmocka_unit_test(inverses_are_exact),
      cmocka_unit_test(blocks_of_planes_with_a_level_horizon_are_wide),
      cmocka_unit_test(rows_in_lanes_are_those_made_one_by_one),
      cmocka_unit_test(positions_keep_their_bound),
      cmocka_unit_test(blocks_at_their_limits_keep_their_bound),
      cmocka_unit_test(positions_keep_their_bound_towards_any_horizon),
      cmocka_unit_test(levels_of_rows_keep_their_bound),
      cmocka_unit_test(colours_lie_between_their_texels_and_constants_stay),
      cmocka_unit_test(pairs_of_texels_are_weighted_as_the_specification_says),
      cmocka_unit_test(maps_and_filters_that_rows_do_not_have_are_refused),
      cmocka_unit_test(set_up_in_64_bits_gives_the_plane_of_128),
  };
  return run_suite("rows", tests);
}
