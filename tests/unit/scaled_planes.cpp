// SPDX-License-Identifier: Apache-2.0
// Host kernels on planes that are scaled along their axes: planned as a whole, the same bytes as the scalar datapath.
#include <tests/kernel_pictures.hpp>

#include <math.h>

namespace {

int rows_known(const plane& p, const ready_map& map, filter kind, rectangle area) {
  kernels::upright_plane known({&p, &map.view, kind}, area);
  int rows = 0;
  for (int32_t sy = area.y0 / span_side; sy <= (area.y1 - 1) / span_side; ++sy) rows += known.row(sy) != nullptr;
  return rows;
}

double signed_power(random_source& random, double least_log2, double most_log2) {
  const double log2 = least_log2 + (most_log2 - least_log2) * double(random.between(0, 1 << 20)) / (1 << 20);
  return (random.between(0, 1) == 0 ? 1 : -1) * exp2(log2);
}

SPANTEX_CASE(scaled_planes) {
  static constexpr int32_t sides[][2] = {{64, 32}, {1, 1}, {37, 5}, {500, 375}, {1, 16}, {512, 256}};
  constexpr rectangle whole{0, 0, 203, 101}, part{19, 5, 150, 75}, low{19, 5, 150, 16};
  const rectangle areas[] = {whole, part, low};
  random_source random(41);
  int rows = 0, known = 0;
  for (const auto& side : sides)
    for (const wrap w : wraps) {
      const ready_map map(random_map(side[0], side[1]), w);
      for (const filter kind : filters)
        for (int k = 0; k < (short_run() ? 6 : 14); ++k) {
          const double far = k % 3 == 0 ? 30000 : 300;
          const double u = signed_power(random, -3, log2(far)), v = signed_power(random, -3, log2(far));
          const plane p = upright_plane(u, v, signed_power(random, -6, 5), signed_power(random, -6, 5), whole);
          const rectangle& area = areas[k / 2 % 3];
          draw_all(p, map, kind, area, 203, 101);
          if (kind == filter::aniso || far > 300) continue;
          rows += (area.y1 - 1) / span_side - area.y0 / span_side + 1;
          known += rows_known(p, map, kind, area);
        }
    }
  print_message("%d of %d rows of spans of scaled planes are planned at once\n", known, rows);
  assert_true(known * 100 >= rows * 99);
}

// What tables would cost more than they save is planned span by span.
SPANTEX_CASE(small_planes_are_not_planned_as_a_whole) {
  const ready_map map(random_map(64, 48), wrap::repeat);
  const plane p = upright_plane(3.3, 5.1, 0.7, 0.6, {0, 0, 640, 64});
  for (const filter kind : {filter::nearest, filter::bilinear, filter::trilinear}) {
    assert_int_equal(rows_known(p, map, kind, {0, 0, 640, 8}), 0);
    assert_int_equal(rows_known(p, map, kind, {8, 8, 32, 24}), 0);
    assert_int_equal(rows_known(p, map, kind, {8, 8, 33, 24}), 2);
    assert_int_equal(rows_known(p, map, kind, {0, 0, 8, 64}), 8);
    for (const rectangle area : {rectangle{0, 0, 640, 8}, rectangle{8, 8, 32, 24}, rectangle{7, 8, 33, 25}, rectangle{3, 0, 8, 63}}) draw_all(p, map, kind, area, 640, 64);
  }
}

// Halves, doubles and the like: positions and weights on ties.
SPANTEX_CASE(scaled_by_powers_of_two) {
  constexpr rectangle whole{0, 0, 96, 64};
  for (const wrap w : wraps) {
    const ready_map map(random_map(64, 48), w);
    for (const filter kind : filters)
      for (const double x : {0.125, 0.5, -1.0, 2.0, 3.0, 4.0, -8.0})
        for (const double y : {0.25, 1.0, -2.0, 16.0})
          for (const double off : {0.0, 0.25, 1.0 / 256}) draw_all(upright_plane(off, 5 + off, x, y, whole), map, kind, whole, 96, 64);
  }
}

// Spans whose extents are as long as their fractions allow to the next power of two: mantissas of one length and another in each row, few bits to round.
SPANTEX_CASE(spans_of_two_lengths) {
  constexpr rectangle whole{0, 0, 40, 64};
  const ready_map map(random_map(512, 512), wrap::repeat);
  random_source random(43);
  constexpr double largest = 16384;  // of the nine: W is then a power of two
  int unlike = 0;
  for (int k = 0; k < (short_run() ? 3000 : 30000); ++k) {
    const double reach = exp2(double(random.between(9, 11))) / 7 * 2, step = reach - double(random.between(0, 1000)) / 7500;
    const double other = signed_power(random, -2, 3), start = -20 * step + double(random.between(-9999, 9999)) / 1000;
    const plane p = k % 2 == 0 ? upright_plane(start, largest, step, other, whole) : upright_plane(largest, start, other, step, whole);
    const int rows = 8 - rows_known(p, map, filter::bilinear, whole);
    unlike += rows;
    if (rows > 0 || k < 1500) draw_all(p, map, filter::bilinear, whole, 40, 64);
  }
  print_message("%d rows of spans with more than one position\n", unlike);
  assert_true(unlike > 0);
}

// Steps between two levels of detail, where spans of one length are on one and spans of another on the next.
SPANTEX_CASE(levels_of_two_lengths) {
  constexpr rectangle whole{0, 0, 64, 64};
  const ready_map map(random_map(64, 64), wrap::repeat);
  const auto plane_of = [&](double step) { return upright_plane(0.3, 16384, step, 0.4, whole); };
  const auto level_of = [&](const plane& p, int32_t sx, int8_t& exponent) {
    span_coefficients c{};
    const reference r = reference_at(p, 16 * sx + 8, 8);
    assert_true(span_coordinates(r, profiles::standard, c));
    span_levels(profiles::standard, c);
    c.last_level = uint8_t(map.view.last_level());
    exponent = c.exponent;
    return level_at(prof{}, c, 0, 0);
  };
  int unlike = 0;
  for (int n = 0; n < (short_run() ? 20 : 100); ++n) {
    double low = 2.15 + 0.001 * n, high = low * 1.005;
    int8_t exponent = 0, other = 0;
    const int32_t before = level_of(plane_of(low), 0, exponent);
    if (level_of(plane_of(high), 0, exponent) == before) continue;
    while (nextafter(low, high) < high) {
      const double middle = low + (high - low) / 2;
      if (middle <= low || middle >= high) break;
      (level_of(plane_of(middle), 0, exponent) == before ? low : high) = middle;
    }
    for (int k = -60; k <= 60; ++k) {
      const plane p = plane_of(low * (1 + copysign(exp2(std::abs(k) / 4.0 - 48), k)));
      const int32_t level = level_of(p, 0, exponent);
      bool differs = false;
      for (int32_t sx = 1; sx < 8; ++sx) differs |= level_of(p, sx, other) != level;
      if (!differs) continue;
      ++unlike;
      draw_all(p, map, filter::trilinear, whole, 64, 64);
      if (k % 8 == 0) draw_all(p, map, filter::mip_bilinear, whole, 64, 64);
    }
  }
  print_message("%d planes with spans on two levels of detail\n", unlike);
  assert_true(unlike > 0);
}

// Turned a little, or divided by hardly more than 1.
SPANTEX_CASE(planes_that_are_nearly_scaled) {
  constexpr rectangle whole{0, 0, 96, 64};
  const ready_map map(random_map(64, 48), wrap::repeat);
  for (const double little : {0.3, 0.01, 1e-4, 1e-9})
    for (const int at : {1, 3, 6, 7}) {
      double m[9] = {0.7, 0, 3.1, 0, 1.3, 5.2, 0, 0, 1};
      m[at] = little;
      plane p{};
      SPANTEX_ASSERT_OK(make_plane(homography_of(m), whole, p));
      for (const filter kind : filters) draw_all(p, map, kind, whole, 96, 64);
    }
}

// Bases next to the end of the range and beyond it, along either axis.
SPANTEX_CASE(scaled_planes_at_the_end_of_the_range) {
  constexpr rectangle whole{0, 0, 40, 64};
  for (const wrap w : wraps) {
    const ready_map map(random_map(500, 64), w);
    for (const filter kind : filters)
      for (const double end : {32700.0, -32750.0, 24000.0, -24600.0})
        for (const double step : {0.7, 3.0, 400.0}) {
          draw_all(upright_plane(end, 3, step, 0.6, whole), map, kind, whole, 40, 64);
          draw_all(upright_plane(3, end, 0.6, step, whole), map, kind, whole, 40, 64);
        }
  }
}

// Planes so wide that the rounding of their forms could show: those before it count, as for any span (no picture was found that tells).
SPANTEX_CASE(scaled_planes_of_wide_regions) {
  constexpr rectangle whole{0, 0, 24, 64};
  const ready_map map(random_map(512, 512), wrap::repeat);
  // Next to where a mantissa is rounded, and from there a coordinate and a weight to either side.
  constexpr double border = 0.5 + 1 / 256.0 - 1 / 32768.0;
  for (int k = 0; k < 12; ++k)
    for (int j = -16; j <= 16; ++j) {
      const plane p = upright_plane(-12000.3 - k, k + border + j * exp2(-20), 1000.37 + 3 * k, 0.75, {0, 0, max_screen_px, 64});
      assert_int_equal(rows_known(p, map, filter::bilinear, whole), 0);
      for (const filter kind : {filter::nearest, filter::bilinear, filter::trilinear}) draw_all(p, map, kind, whole, 24, 64);
    }
}

// Triangles that face the viewer, before and behind each other.
SPANTEX_CASE(scaled_polygons) {
  constexpr int32_t one = 1 << 16, width = 203, height = 101;
  constexpr projection camera{100 * one, 100 * one, width * one / 2, height * one / 2, one};
  const ready_map map(random_map(64, 48), wrap::mirror);
  int at_once = 0;
  const auto each = [&](auto&& draw) {
    random_source random(47);
    for (int n = 0; n < 40; ++n) {
      const int32_t z = int32_t(random.between(40 * one, 300 * one));
      vertex v[3];
      for (vertex& x : v) {
        x.x = 4 * int32_t(random.between(-30 * one, 30 * one));
        x.y = 2 * int32_t(random.between(-30 * one, 30 * one));
        x.z = z;
        x.u = x.x / 4 * 3 + 5000;
        x.v = -x.y / 2 + 70000;
      }
      polygon p{};
      if (make_polygon(v, 3, camera, {0, 0, width, height}, p) != status::ok) continue;
      at_once += rows_known(p.map, map, filter::bilinear, p.box);
      SPANTEX_ASSERT_OK(draw(p));
    }
  };
  for (const filter kind : filters) {
    std::vector<uint32_t> depth(width * height), floors(26 * 13), own(depth), own_floors(floors);
    by_scalar.reset(width, height);
    engine_type engine;
    renderer_type r(engine, prof{}, by_scalar.frame());
    each([&](const polygon& p) { return r.draw(p, map.view, kind, {depth.data(), floors.data()}); });
    SPANTEX_ASSERT_OK(r.finish());
    for (const named_kernel& k : every_kernel) {
      if (kernels::kernel_of(k.which) == nullptr) continue;
      std::fill(own.begin(), own.end(), 0);
      std::fill(own_floors.begin(), own_floors.end(), 0);
      by_kernel.reset(width, height);
      engine_type other;
      renderer_type rest(other, prof{}, by_kernel.frame());
      draw_counters counts;
      each([&](const polygon& p) {
        return kernels::draw_polygon(kernels::kernel_of(k.which), kernels::cover_of(k.which), map.of(k.which), rest, p, map.view, kind, p.box, {own.data(), own_floors.data()}, by_kernel.frame(), counts);
      });
      if (by_kernel.pixels != by_scalar.pixels) fail_msg("%s, filter %d: not the engine's bytes", k.name, int(kind));
      assert_true(own == depth);
    }
  }
  assert_true(at_once > 0);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(scaled_planes),
      cmocka_unit_test(small_planes_are_not_planned_as_a_whole),
      cmocka_unit_test(scaled_by_powers_of_two),
      cmocka_unit_test(spans_of_two_lengths),
      cmocka_unit_test(levels_of_two_lengths),
      cmocka_unit_test(planes_that_are_nearly_scaled),
      cmocka_unit_test(scaled_planes_at_the_end_of_the_range),
      cmocka_unit_test(scaled_planes_of_wide_regions),
      cmocka_unit_test(scaled_polygons),
  };
  return run_suite("scaled_planes", tests);
}
