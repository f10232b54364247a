// SPDX-License-Identifier: Apache-2.0
// Masks of polygons' spans by vectors: the pixels and depths of coverage(), front_mask() and depth_test(), whoever makes them.
#include <algorithm>
#include <vector>

#include <hal/kernels/masks.hpp>
#include <tests/support.hpp>

using namespace spantex;
using namespace spantex::sim;
using kernels::masked_polygon;
using kernels::row_masks;

namespace {

constexpr kernels::row_cover (*every_cover[])() = {kernels::words_cover, kernels::avx2_cover, kernels::avx512_cover};

screen_point centre_of(int32_t x, int32_t y) { return {centre_subpixels(x), centre_subpixels(y)}; }

// Where row.mask says that there is something.
void assert_ends(const row_masks& row, int count) {
  int from = count, to = 0;
  for (int k = 0; k < count; ++k) {
    if (row.mask[k] == 0) continue;
    from = min_of(from, k);
    to = k + 1;
  }
  assert_int_equal(row.from, from);
  assert_int_equal(row.to, to);
}

// Up to as many edges as there may be, of any length, all about one span; areas that cut spans.
SPANTEX_CASE(they_cover_the_same_pixels) {
  random_source random(57);
  int partial[max_edges + 1] = {};
  uint64_t all_behind = 0, cut_in_front = 0;
  for (int n = 0; n < 60000; ++n) {
    const int32_t far = 1 << (11 + n % 12), sx = int32_t(random.next() % 512), sy = int32_t(random.next() % 512);
    const screen_point inside = centre_of(sx * span_side + int32_t(random.next() % span_side), sy * span_side + int32_t(random.next() % span_side));
    polygon p{};
    p.map.w = n % 3 == 0 ? linear_form{random.between(-5, 5), random.between(-5, 5), random.between(-300, 300)} : linear_form{0, 0, 1};
    p.map.origin_x = 16 * sx;
    p.map.origin_y = 16 * sy;
    edge_set& s = p.edges;
    s.count = 1 + n / 12 % max_edges;
    for (int k = 0; k < s.count; ++k) {
      const auto near = [&](int32_t x) { return x + int32_t(random.between(-far, far)); };
      const screen_point a{near(inside.x), near(inside.y)}, b{near(inside.x), near(inside.y)};
      s.edges[k] = make_edge(a, b);
      if (s.edges[k].at(inside.x, inside.y) < 0) s.edges[k] = make_edge(b, a);
    }
    const auto near = [&](int32_t span, int spans) { return clamp_to((span + spans) * span_side + int32_t(random.between(-7, 7)), 0, max_screen_px); };
    const rectangle area{near(sx, int(random.between(-9, 0))), near(sy, -1), near(sx, int(random.between(1, 10))), near(sy, 2)};
    if (area.empty()) continue;
    const masked_polygon masked(p, area, {}, max_screen_px, max_screen_px, false);
    for (const auto cover_here : every_cover) {
      if (cover_here() == nullptr) continue;
      for (int32_t y = area.y0 / span_side; y <= (area.y1 - 1) / span_side; ++y) {
        row_masks row;
        draw_counters counts;
        cover_here()(masked, y, nullptr, row, counts);
        uint64_t jobs = 0, pixels = 0, behind = 0;
        for (int k = 0; k < masked.span_count(); ++k) {
          const int32_t x = masked.first_span() + k;
          const span_mask covered = coverage(s, x, y) & rectangle_mask(area, x, y), expected = covered & front_mask(p.map, x, y);
          behind += covered != 0 && expected == 0;
          cut_in_front += expected != 0 && expected != covered;
          partial[s.count] += expected != 0 && expected != full_mask;
          assert_true(row.mask[k] == expected);
          jobs += expected != 0;
          pixels += uint64_t(__builtin_popcountll(expected));
        }
        assert_ends(row, masked.span_count());
        assert_int_equal(counts.spans_total, masked.span_count());
        assert_int_equal(counts.jobs, jobs);
        assert_int_equal(counts.pixels, pixels);
        assert_int_equal(counts.spans_behind, behind);
        assert_int_equal(counts.spans_empty, uint64_t(masked.span_count()) - jobs - behind);
        all_behind += behind;
      }
    }
  }
  for (int count = 1; count <= max_edges; ++count) assert_true(partial[count] > 1000);
  assert_true(all_behind > 1000 && cut_in_front > 1000);
}

constexpr int32_t one = 1 << 16, width = 117, height = 61, across = (width + 7) / 8, down = (height + 7) / 8;
constexpr projection camera{60 * one, 60 * one, width * one / 2, height * one / 2, one / 16}, far_camera{60 * one, 60 * one, width * one / 2, height * one / 2, 1};

// In front of the camera and across it, some of them as far away as depths go, or as near.
bool random_polygon(random_source& random, polygon& p) {
  vertex v[3];
  const int32_t kind = int32_t(random.between(0, 9));
  const int32_t z = kind == 0 ? int32_t(random.between(20000, 32000)) * one : kind == 1 ? one / 16 : int32_t(random.between(one / 4, 40 * one));
  const auto depth_of_corner = [&] { return kind == 0 ? z : kind == 1 ? z + int32_t(random.between(-z / 2, z / 4)) : z + int32_t(random.between(-z / 2, z / 50)); };
  for (vertex& x : v) {
    const int64_t far = min_of(z, 10000 * one);
    x = {int32_t(random.between(-2 * far, 2 * far)), int32_t(random.between(-far, far)), depth_of_corner(), 0, 0};
  }
  return make_polygon(v, 3, kind == 0 ? far_camera : camera, {0, 0, width, height}, p) == status::ok;
}

struct depths {
  std::vector<uint32_t> values = std::vector<uint32_t>(width * height), floors = std::vector<uint32_t>(across * down);
};

// A picture's depths by several covers, with spans left out at random.
SPANTEX_CASE(they_hide_the_same_pixels) {
  static depths plain, by_vectors;
  for (const auto cover_here : every_cover) {
    if (cover_here() == nullptr) continue;
    uint64_t hidden = 0, below = 0, saturated = 0;
    for (uint64_t seed = 1; seed <= 12; ++seed) {
      plain = by_vectors = {};
      random_source random{seed};
      for (int n = 0; n < 300; ++n) {
        polygon p{};
        if (!random_polygon(random, p)) continue;
        const bool stores = random.between(0, 3) != 0;
        const masked_polygon masked(p, p.box, {by_vectors.values.data(), by_vectors.floors.data()}, width, height, stores);
        for (int32_t sy = p.box.y0 / span_side; sy <= (p.box.y1 - 1) / span_side; ++sy) {
          bool leaves[across];
          for (bool& x : leaves) x = random.between(0, 9) == 0;
          const bool leaves_some = random.between(0, 1) == 0;
          row_masks row;
          draw_counters counts;
          cover_here()(masked, sy, leaves_some ? leaves : nullptr, row, counts);
          uint64_t seen = 0, total = 0;
          for (int k = 0; k < masked.span_count(); ++k) {
            const int32_t sx = masked.first_span() + k;
            span_mask mask = coverage(p.edges, sx, sy) & rectangle_mask(p.box, sx, sy) & front_mask(p.map, sx, sy);
            if (leaves_some && leaves[k]) mask = 0;
            else ++total;
            const depth_range range = depth_range_of(p, sx, sy);
            saturated += mask != 0 && (range.least <= 1 || range.most >= uint32_t(1) << 31);
            const span_mask want = mask == 0 ? 0 : depth_test(p, sx, sy, mask, {plain.values.data()}, width, stores);
            assert_true(row.mask[k] == want);
            hidden += mask != 0 && want == 0;
            seen += want != 0;
          }
          assert_ends(row, masked.span_count());
          assert_int_equal(counts.jobs, seen);
          assert_int_equal(counts.spans_total, total);
          assert_int_equal(counts.spans_empty + counts.spans_behind + counts.spans_hidden, total - seen);
        }
        assert_true(by_vectors.values == plain.values);
      }
      for (int32_t y = 0; y < height; ++y)
        for (int32_t x = 0; x < width; ++x) assert_true(by_vectors.floors[size_t(y / 8 * across + x / 8)] <= plain.values[size_t(y * width + x)]);
      for (const uint32_t f : by_vectors.floors) below += f != 0;
    }
    assert_true(hidden > 1000 && below > 1000 && saturated > 100);
  }
}

// Spans that several polygons cover together have a floor, where pixels are compared eight at a time.
SPANTEX_CASE(floors_rise_where_several_cover_a_span) {
  const vertex corners[4] = {{-40 * one, -20 * one, 10 * one, 0, 0}, {40 * one, -20 * one, 10 * one, 0, 0}, {40 * one, 20 * one, 10 * one, 0, 0}, {-40 * one, 20 * one, 10 * one, 0, 0}};
  const vertex halves[2][3] = {{corners[0], corners[1], corners[2]}, {corners[0], corners[2], corners[3]}};
  static depths d;
  if (kernels::avx2_cover() == nullptr && kernels::avx512_cover() == nullptr) skip();
  for (const auto cover_here : {kernels::avx2_cover, kernels::avx512_cover}) {
    if (cover_here() == nullptr) continue;
    d = {};
    for (const auto& half : halves) {
      polygon p{};
      SPANTEX_ASSERT_OK(make_polygon(half, 3, camera, {0, 0, width, height}, p));
      const masked_polygon masked(p, p.box, {d.values.data(), d.floors.data()}, width, height, true);
      for (int32_t sy = p.box.y0 / span_side; sy <= (p.box.y1 - 1) / span_side; ++sy) {
        row_masks row;
        draw_counters counts;
        cover_here()(masked, sy, nullptr, row, counts);
      }
    }
    for (int32_t sy = 0; sy < height / 8; ++sy)
      for (int32_t sx = 0; sx < width / 8; ++sx) assert_true(d.floors[size_t(sy * across + sx)] > 0);
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(they_cover_the_same_pixels),
      cmocka_unit_test(they_hide_the_same_pixels),
      cmocka_unit_test(floors_rise_where_several_cover_a_span),
  };
  return run_suite("masks", tests);
}
