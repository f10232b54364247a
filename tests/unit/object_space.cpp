// SPDX-License-Identifier: Apache-2.0
// RD16: the rotation against long double, sums and their mean, no pixel without a sample at any orientation, the same picture for
// every strip, coverage shared with the other renderer, and quality and cost against trilinear filtering.
#include <memory>

#include <hal/recording_engine.hpp>
#include <sim/draw_host.hpp>
#include <sim/figures.hpp>
#include <sim/object_space_host.hpp>
#include <sim/pattern.hpp>
#include <sim/quality.hpp>
#include <sim/reference.hpp>
#include <tests/floor_view.hpp>
#include <tests/support.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

constexpr int32_t one = 1 << 16;
constexpr fixed_profile<profiles::standard> prof{};
using engine_type = direct_engine<fixed_profile<profiles::standard>>;
using renderer_type = object_space_renderer<engine_type, fixed_profile<profiles::standard>>;

// Frame, sums and renderer together.
struct bench {
  picture out;
  std::vector<pixel_sums> sums;
  engine_type engine{prof};
  std::unique_ptr<renderer_type> r;
  bench(int32_t width, int32_t height, int32_t rows = 0) : sums(size_t(width) * size_t(rows == 0 ? height : rows)) {
    out.reset(width, height);
    r = std::make_unique<renderer_type>(engine, prof, out.frame(), sums.data(), sums.size());
  }
};

image flat_image(int side, rgba8 c) { return image(side, side, c); }

projection camera_of(int32_t width, int32_t height, int32_t focal_px, int32_t near_z = one / 8) {
  return {focal_px * one, focal_px * one, width * one / 2, height * one / 2, near_z};
}

// A square in space: middle, unit normal, turned about it, half a side.
struct square_vertices { vertex v[4]; };
square_vertices square_at(double_vector middle, double_vector n, real turn, real half, real texels) {
  const double_vector seed = std::fabs(n.x) < 0.7L ? double_vector{1, 0, 0} : double_vector{0, 1, 0};
  const real along = dot(seed, n);
  double_vector a{seed.x - along * n.x, seed.y - along * n.y, seed.z - along * n.z};
  const real length = std::sqrt(dot(a, a));
  a = {a.x / length, a.y / length, a.z / length};
  const double_vector b{n.y * a.z - n.z * a.y, n.z * a.x - n.x * a.z, n.x * a.y - n.y * a.x};
  square_vertices s{};
  for (int k = 0; k < 4; ++k) {
    const real p = turn + k * pi / 2, x = std::cos(p) * half, y = std::sin(p) * half;
    const auto raw = [](real t) { return int32_t(std::lround(double(t * 65536))); };
    s.v[k] = {raw(middle.x + x * a.x + y * b.x), raw(middle.y + x * a.y + y * b.y), raw(middle.z + x * a.z + y * b.z), raw(texels * x), raw(texels * y)};
  }
  return s;
}

// Points spread evenly over the sphere.
double_vector sphere_point(int k, int count) {
  const real z = 1 - (2 * k + 1) / real(count), r = std::sqrt(1 - z * z), p = k * pi * (3 - std::sqrt(5.0L));
  return {r * std::cos(p), r * std::sin(p), z};
}

}  // namespace

SPANTEX_CASE(square_roots_are_to_nearest) {
  const auto check = [](uint64_t x) {
    const uint64_t f = floor_sqrt(x);
    assert_true(f * f <= x && (f == UINT32_MAX || (f + 1) * (f + 1) > x));
    const uint64_t n = nearest_sqrt(x);  // (n - 1/2)^2 <= x < (n + 1/2)^2
    assert_true(n * n + n >= x && (n == 0 || n * n - n < x));
  };
  for (uint64_t x = 0; x < 70000; ++x) check(x);
  random_source random(90);
  for (int k = 0; k < 300000; ++k) check(random.next() >> (2 + random.next() % 60));
}

SPANTEX_CASE(the_rotation_turns_the_normal_to_the_viewer) {
  random_source random(91);
  real worst = 0;
  for (int k = 0; k < 200000; ++k) {
    const int bits = 1 + int(random.next() % 60);
    const int64_t x = random.any_magnitude(bits), y = random.any_magnitude(bits), z = random.any_magnitude(bits);
    if ((x | y | z) == 0) continue;
    const object_rotation r = rotation_of({wide(x), wide(y), wide(z)});
    const double_vector n{real(x), real(y), real(z)};
    const real length = std::sqrt(dot(n, n)), dn = std::hypot(n.y, n.z) / length;
    const real sin_a = n.y == 0 && n.z == 0 ? 0 : n.y / (dn * length), cos_a = n.y == 0 && n.z == 0 ? 1 : n.z / (dn * length), sin_b = n.x / length;
    const double_vector want[3] = {{dn, -sin_a * sin_b, -cos_a * sin_b}, {0, cos_a, -sin_a}, {sin_b, dn * sin_a, dn * cos_a}};
    const vector3 got[3] = {r.across, r.along, r.normal};
    for (int i = 0; i < 3; ++i) {
      const double_vector g = value(got[i], 30);
      worst = std::fmax(worst, std::fmax(std::fabs(g.x - want[i].x), std::fmax(std::fabs(g.y - want[i].y), std::fabs(g.z - want[i].z))));
    }
  }
  std::printf("# worst 2^%.2Lf\n", std::log2(worst));
  assert_true(worst <= std::ldexp(1.0L, -28));
}

SPANTEX_CASE(a_normal_along_x_leaves_the_turn_about_x_out) {
  for (const int64_t x : {int64_t(5), int64_t(-5)}) {
    const object_rotation r = rotation_of({wide(x), wide(0), wide(0)});
    const int32_t s = x > 0 ? 1 << 30 : -(1 << 30);
    assert_true(r.across.x == 0 && r.across.y == 0 && r.across.z == -s);
    assert_true(r.along.x == 0 && r.along.y == 1 << 30 && r.along.z == 0);
    assert_true(r.normal.x == s && r.normal.y == 0 && r.normal.z == 0);
  }
}

SPANTEX_CASE(a_full_pixel_overflows_nothing_and_keeps_its_mean) {
  pixel_sums p{};
  uint32_t taken = 0;
  while (add_sample(p, {255, 255, 1, 0}, 4096)) ++taken;
  assert_int_equal(taken, max_samples_per_pixel);
  assert_false(add_sample(p, {255, 255, 255, 255}, 1));
  assert_true(p.r == 255u * max_pixel_weight && p.weight == max_pixel_weight);
  assert_true((mean_of(p) == rgba8{255, 255, 1, 0}));
}

SPANTEX_CASE(every_constant_is_its_own_mean_at_every_weight) {
  random_source random(92);
  for (uint32_t c = 0; c < 256; ++c)
    for (int k = 0; k < 2000; ++k) {
      const uint32_t weight = 1 + uint32_t(random.next() % max_pixel_weight);
      const pixel_sums p{c * weight, c * weight, c * weight, c * weight, weight};
      assert_int_equal(mean_of(p).r, c);
    }
}

SPANTEX_CASE(a_constant_map_comes_out_exactly) {
  random_source random(93);
  for (int k = 0; k < 60; ++k) {
    const rgba8 c{uint8_t(random.next()), uint8_t(random.next()), uint8_t(random.next()), uint8_t(random.next())};
    const texture_map map(flat_image(64, c), prefilter::box, wrap::repeat, wrap::repeat);
    bench b(96, 64);
    const square_vertices s = square_at({0, 0, 4}, sphere_point(k, 60), k * 0.37L, 1.2L, 40);
    const status done = b.r->draw(s.v, 4, camera_of(96, 64, 80), b.out.area(), map.view(), k % 2 != 0 ? filter::trilinear : filter::bilinear, 60 + 3 * k);
    if (done == status::degenerate) continue;
    SPANTEX_ASSERT_OK(done);
    assert_true(b.r->counters().pixels > 0);
    for (const rgba8& p : b.out.pixels) assert_true(p == c || p == background);
  }
}

// Every normal, from face on to cos = 1/100 of edge-on, any turn, size and place; cut by the screen's edges and by the near plane; at the
// largest pitch the theory allows.
SPANTEX_CASE(no_covered_pixel_is_without_a_sample_at_any_orientation) {
  const texture_view t = unread_view(1, 1);
  random_source random(94);
  const int orientations = short_run() ? 300 : 4000;
  const auto within = [&](real low, real high) { return low + (high - low) * real(random.next() >> 11) * std::ldexp(1.0L, -53); };
  uint64_t pixels = 0, drawn = 0, too_large = 0, near_cut = 0, dropped = 0;
  uint32_t smallest = UINT32_MAX;
  for (int k = 0; k < orientations; ++k) {
    const real z = std::exp(within(-0.5L, 3.5L)), half = z * std::exp(within(-3.5L, 0.7L));
    const double_vector middle{within(-0.6L, 0.6L) * z, within(-0.5L, 0.5L) * z, z};
    const square_vertices s = square_at(middle, sphere_point(k, orientations), within(0, 2 * pi), half, 1);
    bench b(120, 88);
    const projection camera = camera_of(120, 88, 100);
    const status done = b.r->draw(s.v, 4, camera, b.out.area(), t, filter::nearest, whole_share);
    if (done == status::degenerate) continue;
    if (done == status::out_of_range) { ++too_large; continue; }
    SPANTEX_ASSERT_OK(done);
    const object_space_counters& n = b.r->counters();
    assert_int_equal(n.pixels_without_samples, 0);
    pixels += n.pixels;
    dropped += n.spreads_dropped;
    smallest = n.smallest_weight < smallest ? n.smallest_weight : smallest;
    ++drawn;
    for (const vertex& v : s.v)
      if (v.z < camera.near_z) { ++near_cut; break; }
  }
  std::printf("# %llu polygons, %llu cut by the near plane, %llu refused as too large a grid, %llu pixels, smallest weight %u of 4096, %llu spreads dropped\n",
              static_cast<unsigned long long>(drawn), static_cast<unsigned long long>(near_cut), static_cast<unsigned long long>(too_large),
              static_cast<unsigned long long>(pixels), smallest, static_cast<unsigned long long>(dropped));
  assert_true(short_run() || (drawn > 3000 && near_cut > 100 && pixels > 1000000));
  assert_true(too_large * 50 < drawn);
}

// Nearly edge-on: cos of the angle between view and plane from 1/10 to 1/1000.
SPANTEX_CASE(nearly_edge_on_polygons_have_no_holes_either) {
  const texture_view t = unread_view(1, 1);
  uint64_t pixels = 0;
  for (int k = 0; k < 360; ++k) {
    const real tilt = 1 / (10 * std::pow(100.0L, (k % 30) / 29.0L)), p = k * 2 * pi / 360;
    const double_vector n{std::cos(p) * std::sqrt(1 - tilt * tilt), std::sin(p) * std::sqrt(1 - tilt * tilt), -tilt};
    const square_vertices s = square_at({0.1L, -0.07L, 5}, n, k * 0.61L, 1.5L, 1);
    bench b(120, 88);
    const status done = b.r->draw(s.v, 4, camera_of(120, 88, 100), b.out.area(), t, filter::nearest, whole_share);
    if (done == status::degenerate) continue;
    SPANTEX_ASSERT_OK(done);
    assert_int_equal(b.r->counters().pixels_without_samples, 0);
    pixels += b.r->counters().pixels;
  }
  assert_true(pixels > 20000);
}

// The same pixels as the span renderer draws, so neighbours share edges as everywhere else.
SPANTEX_CASE(coverage_is_that_of_the_span_renderer) {
  const texture_map map(flat_image(8, {9, 9, 9, 9}), prefilter::box, wrap::repeat, wrap::repeat);
  for (int k = 0; k < 40; ++k) {
    const square_vertices s = square_at({0.3L, 0, 3}, sphere_point(k, 40), k * 0.9L, 1.4L, 8);
    const vertex parts[2][3] = {{s.v[0], s.v[1], s.v[2]}, {s.v[0], s.v[2], s.v[3]}};
    bench b(96, 64);
    picture direct;
    direct.reset(96, 64);
    engine_type engine{prof};
    renderer<engine_type, fixed_profile<profiles::standard>> r(engine, prof, direct.frame());
    for (const auto& part : parts) {
      polygon p{};
      const status made = make_polygon(part, 3, camera_of(96, 64, 80), direct.area(), p);
      const status done = b.r->draw(part, 3, camera_of(96, 64, 80), b.out.area(), map.view(), filter::bilinear, 128);
      assert_int_equal(int(made), int(done));
      if (made == status::ok) SPANTEX_ASSERT_OK(r.draw(p, map.view(), filter::bilinear));
    }
    SPANTEX_ASSERT_OK(r.finish());
    assert_true(b.out == direct);
    assert_int_equal(b.r->counters().pixels, r.counters().pixels);
  }
}

SPANTEX_CASE(strips_of_any_height_give_the_same_picture) {
  const texture_map map(photographic_pattern(128, 3), prefilter::box, wrap::repeat, wrap::repeat);
  for (int k = 0; k < 12; ++k) {
    const square_vertices s = square_at({0.2L, 0.1L, 3}, sphere_point(k, 12), k * 0.7L, 1.6L, 40);
    picture wanted;
    for (const int32_t rows : {64, 1, 7, 40}) {
      bench b(96, 64, rows);
      if (b.r->draw(s.v, 4, camera_of(96, 64, 80), b.out.area(), map.view(), filter::trilinear, 100) != status::ok) continue;
      if (rows == 64) wanted = b.out;
      assert_true(b.out == wanted);
    }
  }
}

// log2 of the longer column of the map from samples to texels.
SPANTEX_CASE(the_level_is_that_of_the_pitch) {
  for (int k = 0; k < 50; ++k) {
    const real texels = std::exp2(3 + k / 10.0L);
    const square_vertices s = square_at({0.2L, 0.1L, 3}, sphere_point(k, 50), k * 0.7L, 1, texels);
    polygon p{};
    object_grid g{};
    const projection camera = camera_of(96, 64, 80);
    if (make_polygon(s.v, 4, camera, {0, 0, 96, 64}, p) != status::ok) continue;
    SPANTEX_ASSERT_OK(make_object_grid(s.v, 4, camera, p, 128, g));
    const real want = std::log2(texels * std::ldexp(real(g.pitch.mantissa), -g.pitch.exponent));
    assert_true(std::fabs(real(g.level) / 1024 - want) < 1.0L / 256);
  }
}

SPANTEX_CASE(nothing_is_allocated_while_drawing) {
  const texture_map map(photographic_pattern(64, 3), prefilter::box, wrap::repeat, wrap::repeat);
  const square_vertices s = square_at({0, 0, 3}, {0.3L, 0.4L, -std::sqrt(0.75L)}, 0.5L, 1, 40);
  bench b(96, 64);
  allocation_trap::begin();
  const status done = b.r->draw(s.v, 4, camera_of(96, 64, 80), b.out.area(), map.view(), filter::trilinear, 128);
  assert_int_equal(allocation_trap::end(), 0);
  SPANTEX_ASSERT_OK(done);
}

SPANTEX_CASE(bad_input_is_refused) {
  const texture_view t = unread_view(1, 1);
  const square_vertices s = square_at({0, 0, 3}, {0, 0, -1}, 0.5L, 1, 40);
  projection camera = camera_of(96, 64, 80);
  bench b(96, 64);
  const auto draw_with = [&](const projection& c, int share) { return b.r->draw(s.v, 4, c, b.out.area(), t, filter::bilinear, share); };
  SPANTEX_ASSERT_STATUS(draw_with(camera, 0), out_of_range);
  SPANTEX_ASSERT_STATUS(draw_with(camera, 257), out_of_range);
  SPANTEX_ASSERT_STATUS(b.r->draw(s.v, 4, camera, b.out.area(), t, filter::aniso, 128), out_of_range);
  SPANTEX_ASSERT_STATUS(b.r->draw(nullptr, 4, camera, b.out.area(), t, filter::bilinear, 128), bad_pointer);
  SPANTEX_ASSERT_STATUS(b.r->draw(s.v, 2, camera, b.out.area(), t, filter::bilinear, 128), bad_size);
  camera.focal_x = -camera.focal_x;
  SPANTEX_ASSERT_STATUS(draw_with(camera, 128), out_of_range);
  renderer_type no_sums(b.engine, prof, b.out.frame(), nullptr, 10), few_sums(b.engine, prof, b.out.frame(), b.sums.data(), 3);
  SPANTEX_ASSERT_STATUS(no_sums.draw(s.v, 4, camera_of(96, 64, 80), b.out.area(), t, filter::bilinear, 128), bad_pointer);
  SPANTEX_ASSERT_STATUS(few_sums.draw(s.v, 4, camera_of(96, 64, 80), b.out.area(), t, filter::bilinear, 128), bad_size);
  vertex line[3] = {s.v[0], s.v[0], s.v[1]};
  SPANTEX_ASSERT_STATUS(b.r->draw(line, 3, camera_of(96, 64, 80), b.out.area(), t, filter::bilinear, 128), degenerate);
  // A floor from near to far at a fine pitch: more samples along an axis than a grid holds.
  const vertex floor[4] = {{-40 * one, one, one / 4, 0, 0}, {40 * one, one, one / 4, 0, 0}, {4000 * one, one, 4000 * one, 0, one}, {-4000 * one, one, 4000 * one, one, one}};
  SPANTEX_ASSERT_STATUS(b.r->draw(floor, 4, camera_of(96, 64, 80), b.out.area(), t, filter::bilinear, 256), out_of_range);
}

// Many blocks of samples go through the engine, but a frame ends once.
SPANTEX_CASE(a_frame_has_one_end) {
  const texture_map map(photographic_pattern(64, 3), prefilter::box, wrap::repeat, wrap::repeat);
  const square_vertices s = square_at({0, 0, 3}, {0.3L, 0.4L, -std::sqrt(0.75L)}, 0.5L, 1, 40);
  static picture out;
  out.reset(96, 64);
  std::vector<pixel_sums> sums(96 * 64);
  engine_type engine{prof};
  recording log;
  recording_engine<engine_type> watched(engine, log);
  object_space_renderer<recording_engine<engine_type>, fixed_profile<profiles::standard>> r(watched, prof, out.frame(), sums.data(), sums.size());
  for (int k = 0; k < 2; ++k) SPANTEX_ASSERT_OK(r.draw(s.v, 4, camera_of(96, 64, 80), out.area(), map.view(), filter::trilinear, 128));
  SPANTEX_ASSERT_OK(r.finish());
  int ends = 0, takes = 0;
  for (const recorded_operation& op : log.operations) {
    ends += op.what == operation::mark && op.note.kind == event_kind::frame_end;
    takes += op.what == operation::take;
  }
  assert_true(takes > 100);
  assert_int_equal(ends, 1);
  assert_true(log.operations.back().what == operation::mark);
}

// KT88's figure 7, a floor to its horizon: one polygon of it wants more samples than a grid holds and is refused; cut into bands of depth it is drawn, but for
// what lies beyond +-30000 texels, where vertices have no coordinates: the last four of 191 rows.
SPANTEX_CASE(a_floor_to_the_horizon_is_drawn_in_bands) {
  scene_request request;
  request.size = {320, 240};
  const scene s = make_named_scene("fig7", request);
  object_space_options o;
  o.background = {255, 0, 255, 255};
  assert_int_equal(render_object_space(s, o).items_left_out, 1);
  o.band_ratio = 2;
  const object_space_result r = render_object_space(s, o);
  assert_int_equal(r.items_left_out, 0);
  assert_int_equal(r.samples.pixels_without_samples, 0);
  uint64_t visible = 0;
  for (int j = 0; j < 240; ++j)
    for (int i = 0; i < 320; ++i) {
      const ideal_position p = position(s.items[0].plane_matrix, i + 0.5, j + 0.5);
      if (!(p.w > 0)) continue;
      ++visible;
      // The host's limit falls in steps of 1.25.
      if (r.picture.at(i, j) == o.background) assert_true(std::max(std::fabs(p.u), std::fabs(p.v)) > 22000);
    }
  std::printf("# %llu of %llu pixels\n", static_cast<unsigned long long>(r.samples.pixels), static_cast<unsigned long long>(visible));
  assert_true(r.samples.pixels > visible * 97 / 100);
}

SPANTEX_CASE(tilted_and_grazing_planes_are_better_than_trilinear_at_two_pitches) {
  const rgba8 black{0, 0, 0, 255};
  for (const char* name : {"tilted", "grazing"}) {
    scene_request request;
    request.size = {320, 240};
    const scene s = make_named_scene(name, request);
    const ideal_image reference = render_reference(s, black, 2);
    draw_options trilinear;
    trilinear.kind = filter::trilinear;
    const double usual = psnr_db(draw(s, trilinear).picture, reference);
    std::printf("# %s: trilinear %.2f dB, 8 reads a pixel\n", name, usual);
    for (const double band_ratio : {0.0, 2.0})
      for (const int share : {256, 128}) {
        object_space_options o;
        o.share = share;
        o.band_ratio = band_ratio;
        const object_space_result r = render_object_space(s, o);
        const double quality = psnr_db(r.picture, reference), px = double(r.samples.pixels);
        std::printf("# %s, pitch %d/256, %s: %.2f dB, %.1f samples, %.0f reads, %.2f divides a pixel, at most %.0f samples' weight\n", name, share,
                    band_ratio == 0 ? "one polygon" : "bands", quality, double(r.samples.samples) / px, double(r.texel_reads) / px,
                    double(r.samples.divides) / px, r.samples.largest_weight / 4096.0);
        assert_int_equal(r.samples.pixels, 320 * 240);
        assert_int_equal(r.samples.pixels_without_samples, 0);
        assert_int_equal(r.samples.spreads_dropped, 0);
        if (share == 128) assert_true(quality > usual);
      }
  }
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(square_roots_are_to_nearest),
      cmocka_unit_test(the_rotation_turns_the_normal_to_the_viewer),
      cmocka_unit_test(a_normal_along_x_leaves_the_turn_about_x_out),
      cmocka_unit_test(a_full_pixel_overflows_nothing_and_keeps_its_mean),
      cmocka_unit_test(every_constant_is_its_own_mean_at_every_weight),
      cmocka_unit_test(a_constant_map_comes_out_exactly),
      cmocka_unit_test(no_covered_pixel_is_without_a_sample_at_any_orientation),
      cmocka_unit_test(nearly_edge_on_polygons_have_no_holes_either),
      cmocka_unit_test(coverage_is_that_of_the_span_renderer),
      cmocka_unit_test(strips_of_any_height_give_the_same_picture),
      cmocka_unit_test(the_level_is_that_of_the_pitch),
      cmocka_unit_test(nothing_is_allocated_while_drawing),
      cmocka_unit_test(bad_input_is_refused),
      cmocka_unit_test(a_frame_has_one_end),
      cmocka_unit_test(a_floor_to_the_horizon_is_drawn_in_bands),
      cmocka_unit_test(tilted_and_grazing_planes_are_better_than_trilinear_at_two_pitches),
  };
  return run_suite("object_space", tests);
}
