// SPDX-License-Identifier: Apache-2.0
// The rasteriser of filters step and hat: the cells of a convex polygon add up to its exact area, each lies between nothing and full and
// errs by less than one unit, thin polygons included; hat's weights against the exact integral of the piecewise linear function.
#include "tests/support.hpp"

#include <algorithm>
#include <array>
#include <cmath>

using namespace spantex;
using namespace spantex::sim;

namespace {

constexpr int side_cells = 16;

// Twice the area by the shoelace formula in 128 bits.
int128 exact_twice_area(const area_polygon& p) {
  int128 sum = 0;
  for (int k = 0; k < p.count; ++k) {
    const area_point &a = p.at[k], &b = p.at[(k + 1) % p.count];
    sum += int128(a.u) * b.v - int128(b.u) * a.v;
  }
  return magnitude_of(sum);
}

struct cells { int32_t at[side_cells][side_cells]; };

void cover(const area_polygon& p, int bits, int columns, int rows, cells& out) {
  out = {};
  int32_t swept = 0;
  for (int row = 0; row < rows; ++row) add_covered(p, bits, columns, row, swept, out.at[row]);
}

// Twice the area of a polygon within a cell, by clipping it against the four sides in long double: the judge that shares no step.
using real = long double;
struct real_point { real u, v; };
struct real_polygon { int count = 0; std::array<real_point, 24> at; };

real_polygon clipped(const real_polygon& p, real a, real b, real c) {  // keeps a u + b v + c >= 0
  real_polygon out;
  for (int k = 0; k < p.count; ++k) {
    const real_point &from = p.at[size_t(k)], &to = p.at[size_t((k + 1) % p.count)];
    const real f = a * from.u + b * from.v + c, t = a * to.u + b * to.v + c;
    if (f >= 0) out.at[size_t(out.count++)] = from;
    if ((f > 0 && t < 0) || (f < 0 && t > 0)) {
      const real x = f / (f - t);
      out.at[size_t(out.count++)] = {from.u + x * (to.u - from.u), from.v + x * (to.v - from.v)};
    }
  }
  return out;
}

real_polygon in_cell(real_polygon p, int column, int row, int bits) {
  const real full = 1 << bits, u = column * full, v = row * full;
  p = clipped(p, 1, 0, -u);
  p = clipped(p, -1, 0, u + full);
  p = clipped(p, 0, 1, -v);
  return clipped(p, 0, -1, v + full);
}

real twice_area_of(const real_polygon& p) {
  real sum = 0;
  for (int k = 0; k < p.count; ++k) {
    const real_point &a = p.at[size_t(k)], &b = p.at[size_t((k + 1) % p.count)];
    sum += a.u * b.v - b.u * a.v;
  }
  return sum;
}

real_polygon to_real(const area_polygon& p) {
  real_polygon out;
  for (int k = 0; k < p.count; ++k) out.at[size_t(out.count++)] = {real(p.at[k].u), real(p.at[k].v)};
  return out;
}

void check_polygon(const area_polygon& p, int bits, int columns, int rows) {
  static cells got;
  cover(p, bits, columns, rows, got);
  int64_t sum = 0;
  const int32_t full = 2 << (2 * bits);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const int32_t cell = got.at[row][column];
      assert_true(cell >= 0 && cell <= full);
      const real exact = std::fabs(twice_area_of(in_cell(to_real(p), column, row, bits)));
      if (!(std::fabs(cell - exact) < 1.0625L)) fail_msg("cell %d, %d: %d instead of %Lf", column, row, cell, exact);
      sum += cell;
    }
  assert_true(sum == exact_twice_area(p));
}

// The hull of a few random points: convex, any number of corners up to six, either direction, often thin.
area_polygon random_convex(random_source& random, int32_t width, int32_t height) {
  area_point points[6];
  const int n = int(random.between(3, 6));
  const int shape = int(random.between(0, 3));
  const int32_t u0 = int32_t(random.between(0, width)), v0 = int32_t(random.between(0, height));
  for (int k = 0; k < n; ++k) {
    points[k] = {int32_t(random.between(0, width)), int32_t(random.between(0, height))};
    if (shape == 1) points[k].v = int32_t(std::clamp<int64_t>(int64_t(points[k].u) * height / width + random.between(-2, 2), 0, height));
    if (shape == 2) points[k] = {int32_t(std::clamp<int64_t>(u0 + random.between(-3, 3), 0, width)),
                                 int32_t(std::clamp<int64_t>(v0 + random.between(-3, 3), 0, height))};
  }
  std::sort(points, points + n, [](const area_point& a, const area_point& b) { return a.u != b.u ? a.u < b.u : a.v < b.v; });
  area_point hull[12];
  int count = 0;
  const auto turn = [](const area_point& a, const area_point& b, const area_point& c) {
    return int64_t(b.u - a.u) * (c.v - a.v) - int64_t(b.v - a.v) * (c.u - a.u);
  };
  for (int pass = 0, start = 0; pass < 2; ++pass, start = count) {
    for (int k = 0; k < n; ++k) {
      const area_point& p = points[pass == 0 ? k : n - 1 - k];
      while (count >= start + 2 && turn(hull[count - 2], hull[count - 1], p) <= 0) --count;
      hull[count++] = p;
    }
    --count;
  }
  area_polygon out{max_of(count, 1), {}};
  if (count == 0) out.at[0] = points[0];
  for (int k = 0; k < count; ++k) out.at[k] = hull[k];
  if ((random.next() & 1) != 0) std::reverse(out.at, out.at + out.count);
  return out;
}

}  // namespace

SPANTEX_CASE(cells_of_random_convex_polygons_add_up_to_the_exact_area) {
  random_source random(90);
  for (int n = 0; n < (short_run() ? 5000 : 100000); ++n) {
    const int columns = int(random.between(1, 16)), rows = int(random.between(1, 16)), most = columns > 8 || rows > 8 ? 7 : 8;
    const int bits = int(random.between(1, most));
    check_polygon(random_convex(random, columns << bits, rows << bits), bits, columns, rows);
  }
}

SPANTEX_CASE(degenerate_polygons_cover_nothing) {
  static cells got;
  const area_polygon none[] = {{1, {{700, 300}}}, {2, {{0, 0}, {2048, 2048}}}, {4, {{3, 3}, {3, 3}, {3, 3}, {3, 3}}},
                               {4, {{0, 5}, {900, 5}, {2048, 5}, {900, 5}}}, {6, {{7, 0}, {7, 9}, {7, 2048}, {7, 900}, {7, 4}, {7, 1}}}};
  for (const area_polygon& p : none) {
    cover(p, 8, 8, 8, got);
    for (const auto& row : got.at)
      for (const int32_t cell : row) assert_int_equal(cell, 0);
  }
}

// Not convex, and no footprint: still no weight below nothing or above full.
SPANTEX_CASE(polygons_that_cross_themselves_stay_within_a_texel) {
  static cells got;
  const area_polygon crossed[] = {{4, {{0, 0}, {2048, 2048}, {2048, 0}, {0, 1500}}}, {4, {{0, 1500}, {2048, 0}, {2048, 2048}, {0, 0}}},
                                  {4, {{0, 100}, {2048, 90}, {2048, 120}, {0, 95}}}};
  for (const area_polygon& p : crossed) {
    cover(p, 8, 8, 8, got);
    for (const auto& row : got.at)
      for (const int32_t cell : row) assert_true(cell >= 0 && cell <= 2 << 16);
  }
}

SPANTEX_CASE(whole_windows_and_half_windows_are_exact) {
  for (int bits = 1; bits <= 8; ++bits) {
    const int32_t end = 8 << bits;
    check_polygon({4, {{0, 0}, {end, 0}, {end, end}, {0, end}}}, bits, 8, 8);
    check_polygon({3, {{0, 0}, {end, 0}, {0, end}}}, bits, 8, 8);
    check_polygon({3, {{0, end}, {end, 0}, {end, end}}}, bits, 8, 8);
  }
}

// What rounding makes of thin footprints: bow-ties, lines and points get a strip that stays in the window, and weights above zero.
SPANTEX_CASE(thin_polygons_become_strips_within_their_window) {
  random_source random(91);
  static cells got;
  int64_t thickened = 0;
  for (int n = 0; n < (short_run() ? 20000 : 400000); ++n) {
    const int columns = int(random.between(1, 8)), rows = int(random.between(1, 8)), bits = int(random.between(1, 8));
    const area_point limit{columns << bits, rows << bits};
    const auto point = [&] { return area_point{int32_t(random.between(0, limit.u)), int32_t(random.between(0, limit.v))}; };
    const area_point a = point(), b = (n & 3) == 0 ? a : point();
    area_polygon p{n & 4 ? 4 : 6, {}};
    for (int k = 0; k < p.count; ++k) {
      const int64_t t = random.between(0, 64);
      p.at[k] = {int32_t(std::clamp<int64_t>(a.u + (b.u - a.u) * t / 64 + random.between(-1, 1), 0, limit.u)),
                 int32_t(std::clamp<int64_t>(a.v + (b.v - a.v) * t / 64 + random.between(-1, 1), 0, limit.v))};
    }
    const area_polygon given = p;
    spantex::detail::thicken(p, limit);
    thickened += p.count != given.count || p.at[0].u != given.at[0].u || p.at[1].u != given.at[1].u || p.at[1].v != given.at[1].v;
    for (int k = 0; k < p.count; ++k) {
      assert_true(p.at[k].u >= 0 && p.at[k].u <= limit.u && p.at[k].v >= 0 && p.at[k].v <= limit.v);
    }
    cover(p, bits, columns, rows, got);
    int64_t sum = 0;
    for (const auto& row : got.at)
      for (const int32_t cell : row) sum += cell;
    assert_true(sum > 0);
  }
  assert_true(thickened > 10000);
}

// --- hat -----------------------------------------------------------------------------------------------

namespace {

// Integral of the function that is 1 at the centre and 0 on the hexagon, over one cell; the triangle centre, a, b clipped to the cell and
// cut into triangles, over which a linear function integrates to its mean times the area.
real exact_hat(const area_window& w, int column, int row) {
  const real_point c{real(w.centre.u), real(w.centre.v)};
  real sum = 0;
  for (int k = 0; k < 6; ++k) {
    const real_point a{real(w.corner[k].u), real(w.corner[k].v)}, b{real(w.corner[(k + 1) % 6].u), real(w.corner[(k + 1) % 6].v)};
    const real whole = (a.u - c.u) * (b.v - c.v) - (b.u - c.u) * (a.v - c.v);
    if (whole == 0) continue;
    const auto height = [&](const real_point& p) { return ((a.u - p.u) * (b.v - p.v) - (b.u - p.u) * (a.v - p.v)) / whole; };
    real_polygon triangle;
    triangle.count = 3;
    triangle.at[0] = c;
    triangle.at[1] = a;
    triangle.at[2] = b;
    const real_polygon part = in_cell(triangle, column, row, w.bits);
    for (int n = 1; n + 1 < part.count; ++n) {
      const real_point &p = part.at[0], &q = part.at[size_t(n)], &r = part.at[size_t(n + 1)];
      const real area = std::fabs((q.u - p.u) * (r.v - p.v) - (r.u - p.u) * (q.v - p.v)) / 2;
      sum += area * (height(p) + height(q) + height(r)) / 3;
    }
  }
  return sum;
}

// Sum over the texels of |weight - exact| in shares of the total: what a map of 0 and 1 can be wrong by, at most half of it.
real hat_error(const area_window& w) {
  area_weights area(w, filter::hat);
  int32_t got[side_cells][side_cells] = {};
  real exact[side_cells][side_cells], total = 0, exact_total = 0, error = 0;
  for (int row = 0; row < w.rows; ++row) {
    area.next_row(got[row]);
    for (int column = 0; column < w.columns; ++column) {
      exact[row][column] = exact_hat(w, column, row);
      total += got[row][column];
      exact_total += exact[row][column];
    }
  }
  for (int row = 0; row < w.rows; ++row)
    for (int column = 0; column < w.columns; ++column) error += std::fabs(got[row][column] / total - exact[row][column] / exact_total);
  return error / 2;
}

}  // namespace

// The share of the weight that lies in the wrong texels, for hexagons of every size, place and direction: eight layers leave less than
// 1/150 where the pixel's image is at least a quarter of a texel wide (64 units), 1/80 down to a sixteenth, where layers are rounded to
// a unit or two.
SPANTEX_CASE(weights_of_hat_are_within_a_150th_of_the_exact_integral) {
  random_source random(92);
  real worst_narrow = 0, worst_wide = 0;
  int64_t judged = 0;
  for (int n = 0; n < (short_run() ? 1000 : 20000); ++n) {
    // Two axes of the pixel's image, and the perspective that skews the hexagon.
    const auto axis = [&] { return double(random.between(-1000, 1000)) / 1000 * std::pow(2.0, double(random.between(4, 10))); };
    const double a = axis(), b = axis(), c = axis(), d = axis(), g = double(random.between(-90, 90)) / 400, h = double(random.between(-90, 90)) / 400;
    const double offset_u = double(random.between(0, 255)), offset_v = double(random.between(0, 255));
    area_window w{0, 0, 0, 0, 8, {}, {}};
    const auto at = [&](double x, double y) {
      const double scale = 1 / (1 + g * x / 2 + h * y / 2);
      return area_point{int32_t(std::lround(4096 + offset_u + (a * x + b * y) * scale)), int32_t(std::lround(4096 + offset_v + (c * x + d * y) * scale))};
    };
    w.centre = at(0, 0);
    for (int k = 0; k < 6; ++k) {
      const screen_offset o = area_corner(filter::hat, k);
      w.corner[k] = at(o.x / 2.0, o.y / 2.0);
    }
    int32_t u0 = 1 << 20, v0 = 1 << 20, u1 = 0, v1 = 0;
    for (const area_point& p : w.corner) {
      u0 = std::min(u0, p.u); u1 = std::max(u1, p.u);
      v0 = std::min(v0, p.v); v1 = std::max(v1, p.v);
    }
    w.columns = texels_within(u0, u1, 8);
    w.rows = texels_within(v0, v1, 8);
    const double narrow = std::fabs(a * d - b * c) / std::max(std::hypot(a - b, c - d), std::max(std::hypot(a, c), std::hypot(b, d)));
    if (w.columns > 8 || w.rows > 8 || narrow < 16) continue;
    for (area_point* p : {&w.centre, w.corner, w.corner + 1, w.corner + 2, w.corner + 3, w.corner + 4, w.corner + 5}) {
      p->u -= (u0 >> 8) << 8;
      p->v -= (v0 >> 8) << 8;
    }
    real& worst = narrow < 64 ? worst_narrow : worst_wide;
    worst = std::max(worst, hat_error(w));
    ++judged;
  }
  std::printf("# hat: %lld hexagons, worst share of the weight in wrong texels 1/%.0Lf, narrow ones 1/%.0Lf\n", static_cast<long long>(judged),
              1 / worst_wide, 1 / worst_narrow);
  assert_true(judged > (short_run() ? 100 : 2000));
  assert_true(worst_wide < 1.0L / 150 && worst_narrow < 1.0L / 80);
}

// No more than 2^24 in all, so that sums of 255 times them fit 32 bits: the largest windows, filled as far as a hexagon can.
SPANTEX_CASE(weights_add_up_to_less_than_2_24) {
  for (const int side : {8, 16}) {
    const int32_t end = 2048;
    area_window w{0, 0, side, side, side == 8 ? 8 : 7, {end / 2, end / 2}, {{0, 0}, {end, 0}, {end, end}, {0, end}}};
    for (const filter kind : {filter::step, filter::hat}) {
      if (kind == filter::hat) { w.corner[4] = {0, end / 2}; w.corner[5] = {0, 1}; }
      area_weights area(w, kind);
      int64_t sum = 0;
      for (int row = 0; row < side; ++row) {
        int32_t weight[max_area_side];
        area.next_row(weight);
        for (int n = 0; n < side; ++n) sum += weight[n];
      }
      assert_true(sum > 1 << 22 && sum * 255 < int64_t(1) << 32);
    }
  }
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(cells_of_random_convex_polygons_add_up_to_the_exact_area),
      cmocka_unit_test(degenerate_polygons_cover_nothing),
      cmocka_unit_test(polygons_that_cross_themselves_stay_within_a_texel),
      cmocka_unit_test(whole_windows_and_half_windows_are_exact),
      cmocka_unit_test(thin_polygons_become_strips_within_their_window),
      cmocka_unit_test(weights_of_hat_are_within_a_150th_of_the_exact_integral),
      cmocka_unit_test(weights_add_up_to_less_than_2_24),
  };
  return run_suite("area", tests);
}
