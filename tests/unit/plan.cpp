// SPDX-License-Identifier: Apache-2.0
// The planner: a picture made of spans, jobs and sections is, bit for bit, the same arithmetic on the whole map; the order of spans, the
// size of local memory and where a profile's numbers come from change nothing.
#include <tests/support.hpp>
#include <tests/whole_map.hpp>

#include <type_traits>

using namespace spantex;
using namespace spantex::sim;

namespace {

// --- the engine's picture ---

template <int Side, class Prof>
draw_counters draw_spans(const Prof& prof, const surface& s, rectangle area, picture& out) {
  direct_engine<Prof, Side> engine(prof);
  renderer<direct_engine<Prof, Side>, Prof> r(engine, prof, out.frame());
  SPANTEX_ASSERT_OK(r.draw(*s.map, *s.texture, s.kind, area));
  SPANTEX_ASSERT_OK(r.finish());
  return r.counters();
}

run_time_profile with_side(profile q, int side) {
  q.fine_side = side;
  return {q};
}

picture expected, got;

void assert_same_pictures(const char* what, int plane_index, filter kind) {
  const int64_t n = differing_pixels(expected, got);
  if (n != 0) fail_msg("%s: plane %d, filter %d: %lld pixels differ", what, plane_index, int(kind), static_cast<long long>(n));
}

// Windows of a 640 x 480 picture whose edges cut spans. step and hat weigh hundreds of texels a pixel: a third of the width and height will do.
constexpr rectangle windows[] = {{203, 170, 299, 229}, {0, 0, 77, 60}, {561, 421, 640, 480}, {300, 122, 420, 171}};
rectangle window_of(int k, filter kind) {
  const rectangle& w = windows[k];
  return uses_area(kind) ? rectangle{w.x0, w.y0, w.x0 + (w.x1 - w.x0) / 3, w.y0 + (w.y1 - w.y0) / 3} : w;
}

void check_sides(const profile& q, const synthetic_map& map, wrap wrap_u, wrap wrap_v) {
  const texture_view t = map.view(wrap_u, wrap_v);
  for (int k = 0; k < sample_plane_count; ++k) {
    const plane p = sample_plane(k);
    for (const filter kind : all_filters) {
      const surface s{&p, &t, kind};
      const rectangle window = window_of(k, kind);
      expected.reset(640, 480);
      draw_whole_map(with_side(q, 32), s, window, expected);
      const auto check = [&](auto side) {
        got.reset(640, 480);
        (void)draw_spans<side.value>(with_side(q, side.value), s, window, got);
        assert_same_pictures(side.value == 8 ? "8x8" : side.value == 16 ? "16x16" : "32x32", k, kind);
      };
      check(std::integral_constant<int, 8>{});
      check(std::integral_constant<int, 16>{});
      check(std::integral_constant<int, 32>{});
    }
  }
}

}  // namespace

SPANTEX_CASE(spans_equal_the_whole_map_for_power_of_two_maps_in_every_wrap_mode) {
  const synthetic_map& m = photographic_map(64, 64);
  for (const wrap u : all_wraps)
    for (const wrap v : all_wraps) check_sides(profiles::exact, m, u, v);
}

SPANTEX_CASE(spans_equal_the_whole_map_for_maps_of_other_sizes) {
  for (const wrap w : all_wraps) {
    check_sides(profiles::exact, photographic_map(100, 37), w, w);
    check_sides(profiles::exact, photographic_map(3, 5), w, w);
  }
}

SPANTEX_CASE(spans_equal_the_whole_map_for_maps_one_texel_wide) {
  for (const wrap w : all_wraps) {
    check_sides(profiles::exact, photographic_map(1, 1), w, w);
    check_sides(profiles::exact, photographic_map(1, 64), w, w);
    check_sides(profiles::exact, photographic_map(200, 1), w, w);
  }
}

SPANTEX_CASE(spans_equal_the_whole_map_for_large_maps) {
  check_sides(profiles::exact, photographic_map(512, 512), wrap::repeat, wrap::repeat);
  check_sides(profiles::exact, photographic_map(1000, 300), wrap::mirror, wrap::clamp);
}

// Step and hat in linear light: 16-bit values by weights of 16 bits; a constant stays what it is.
SPANTEX_CASE(areas_equal_the_whole_map_in_linear_light) {
  const rgba8 colour{200, 7, 91, 33};
  for (const bool constant : {false, true}) {
    texture_view t = (constant ? constant_map(64, 64, colour) : photographic_map(64, 64)).view(wrap::repeat, wrap::mirror);
    t.set_colours(colour_space::srgb);
    for (int k = 0; k < sample_plane_count; ++k)
      for (const filter kind : {filter::step, filter::hat}) {
        const plane p = sample_plane(k);
        const surface s{&p, &t, kind};
        expected.reset(640, 480);
        got.reset(640, 480);
        draw_whole_map(with_side(profiles::exact, 32), s, window_of(k, kind), expected);
        (void)draw_spans<8>(with_side(profiles::exact, 8), s, window_of(k, kind), got);
        assert_same_pictures("linear light", k, kind);
        for (const rgba8& c : got.pixels) assert_true(!constant || c == colour || c == background);
      }
  }
}

SPANTEX_CASE(spans_equal_the_whole_map_in_other_word_lengths) {
  profile narrow = profiles::compact;
  narrow.overflow = overflow_policy::split;
  check_sides(narrow, photographic_map(64, 64), wrap::repeat, wrap::mirror);
  check_sides(profiles::standard, photographic_map(100, 37), wrap::mirror, wrap::repeat);
  profile major = profiles::exact;
  major.formula = level_formula::major;
  major.level_bias = -20;
  major.position_rounding = rounding::floor;
  check_sides(major, photographic_map(64, 64), wrap::repeat, wrap::repeat);
  major.formula = level_formula::minor;
  check_sides(major, photographic_map(64, 64), wrap::repeat, wrap::repeat);
}

// Random planes: steep, stretched, far, across the horizon.
static void check_random_planes(const profile& q, int planes, uint64_t seed) {
  const texture_view t = photographic_map(256, 96).view(wrap::repeat, wrap::mirror);
  random_source random(seed);
  for (int n = 0; n < planes; ++n) {
    const filter kind = all_filters[size_t(n) % std::size(all_filters)];
    const rectangle area = uses_area(kind) ? rectangle{0, 0, 24, 16} : rectangle{0, 0, 64, 48};
    plane p{};
    if (!random_plane(random, area, p)) continue;
    const surface s{&p, &t, kind};
    expected.reset(64, 48);
    draw_whole_map(with_side(q, 32), s, area, expected);
    got.reset(64, 48);
    if (n % 3 == 0) (void)draw_spans<8>(with_side(q, 8), s, area, got);
    else if (n % 3 == 1) (void)draw_spans<16>(with_side(q, 16), s, area, got);
    else (void)draw_spans<32>(with_side(q, 32), s, area, got);
    assert_same_pictures("random plane", n, kind);
  }
}

SPANTEX_CASE(spans_equal_the_whole_map_on_random_planes) { check_random_planes(profiles::exact, 400, 60); }

// Short words move positions out of the hull of a span's corners: sections must allow for it.
SPANTEX_CASE(spans_equal_the_whole_map_where_rounding_is_coarse) {
  profile coarse = profiles::exact;
  coarse.tolerance_bits = 16;
  for (const int bits : {10, 12, 15, 18}) {
    coarse.reciprocal_bits = bits;
    coarse.offset_bits = max_of(12, bits);
    check_random_planes(coarse, 300, 61 + uint64_t(bits));
  }
}

// The profiles that clamp or coarsen are exact, too, where their local memory holds the section.
SPANTEX_CASE(seed_equals_the_whole_map_where_nothing_is_clamped) {
  const texture_view t = photographic_map(64, 64).view(wrap::repeat, wrap::repeat);
  const double magnified[9] = {0.21, -0.13, 3.3, 0.09, 0.24, -5.1, 0.00003, 0.00002, 1};
  plane p{};
  SPANTEX_ASSERT_OK(make_plane(homography_of(magnified), {0, 0, 640, 480}, p));
  for (const filter kind : {filter::nearest, filter::bilinear, filter::three_point}) {
    const surface s{&p, &t, kind};
    const fixed_profile<profiles::seed> prof;
    expected.reset(640, 480);
    got.reset(640, 480);
    draw_whole_map(prof, s, {0, 0, 640, 480}, expected);
    const draw_counters c = draw_spans<8>(prof, s, {0, 0, 640, 480}, got);
    assert_int_equal(c.corrected_jobs, 0);
    assert_same_pictures("seed", 0, kind);
  }
}

template <profile P>
static void check_profile_types() {
  const fixed_profile<P> fixed;
  const run_time_profile dynamic{P};
  for (const wrap w : all_wraps) {
    const texture_view t = photographic_map(100, 37).view(w, w);
    for (int k = 0; k < sample_plane_count; ++k)
      for (const filter kind : all_filters) {
        const plane p = sample_plane(k);
        const surface s{&p, &t, kind};
        expected.reset(640, 480);
        got.reset(640, 480);
        const draw_counters a = draw_spans<P.fine_side>(fixed, s, window_of(k, kind), expected);
        const draw_counters b = draw_spans<P.fine_side>(dynamic, s, window_of(k, kind), got);
        assert_same_pictures("profile types", k, kind);
        assert_int_equal(a.jobs, b.jobs);
        assert_int_equal(a.words_loaded, b.words_loaded);
      }
  }
}

SPANTEX_CASE(compile_time_and_run_time_profiles_draw_the_same) {
  check_profile_types<profiles::seed>();
  check_profile_types<profiles::compact>();
  check_profile_types<profiles::standard>();
  check_profile_types<profiles::exact>();
}

// Draws the spans of a window in the order of a permutation.
template <class Prof, class Order>
static void draw_in_order(const Prof& prof, const surface& s, rectangle area, picture& out, Order order, bool single_half) {
  constexpr int side = Prof::max_fine_side;
  static int32_t spans[4096][2];
  int count = 0;
  for (int32_t sy = area.y0 / 8; sy <= (area.y1 - 1) / 8; ++sy)
    for (int32_t sx = area.x0 / 8; sx <= (area.x1 - 1) / 8; ++sx) { spans[count][0] = sx; spans[count][1] = sy; ++count; }
  direct_engine<Prof, side> engine(prof);
  renderer<direct_engine<Prof, side>, Prof> r(engine, prof, out.frame());
  r.single_half(single_half);
  for (int k = 0; k < count; ++k) {
    const int n = order(k, count);
    SPANTEX_ASSERT_OK(r.draw_span(s, spans[n][0], spans[n][1], rectangle_mask(area, spans[n][0], spans[n][1])));
  }
  SPANTEX_ASSERT_OK(r.finish());
}

template <profile P>
static void check_orders() {
  const fixed_profile<P> prof;
  const texture_view t = photographic_map(100, 64).view(wrap::repeat, wrap::mirror);
  for (int k = 0; k < sample_plane_count; ++k)
    for (const filter kind : all_filters) {
      const plane p = sample_plane(k);
      const surface s{&p, &t, kind};
      const auto draw = [&](auto order, bool single_half) {
        got.reset(640, 480);
        draw_in_order(prof, s, window_of(k, kind), got, order, single_half);
        assert_same_pictures("order", k, kind);
      };
      expected.reset(640, 480);
      (void)draw_spans<P.fine_side>(prof, s, window_of(k, kind), expected);
      draw([](int n, int) { return n; }, true);
      draw([](int n, int count) { return count - 1 - n; }, false);
      // A multiplier that shares no factor with the count visits every span once.
      draw([](int n, int count) { int step = 61; while (count % step == 0) ++step; return int(int64_t(n) * step % count); }, false);
    }
}

SPANTEX_CASE(the_order_of_spans_and_the_number_of_halves_change_nothing) {
  check_orders<profiles::seed>();
  check_orders<profiles::compact>();
  check_orders<profiles::standard>();
  check_orders<profiles::exact>();
}

// What a job promises the engine, for every profile: sections fit, every pixel once, nothing clamped unless said.
template <profile P>
static void check_jobs() {
  const fixed_profile<P> prof;
  const texture_view t = unread_view(512, 300);
  for (int k = 0; k < sample_plane_count; ++k)
    for (const filter kind : all_filters) {
      const plane p = sample_plane(k);
      const surface s{&p, &t, kind};
      for (int32_t n = 0; n < 60; ++n) {
        const int32_t sx = (n * 37 + 5) % 80, sy = n;
        const span_mask mask = front_mask(p, sx, sy);
        span_mask seen = 0;
        int planned = 0;  // reciprocals that planning itself took: one for all pixels, or each its own
        if (mask == 0) continue;
        SPANTEX_ASSERT_OK(plan_span(prof, s, sx, sy, mask, [&](span_job& job) {
          const span_coefficients& c = job.coefficients;
          assert_true(job.mask != 0 && (job.mask & ~mask) == 0 && (seen & job.mask) == 0);
          assert_true(job.completes || c.axis.partial);
          if (job.completes) seen |= job.mask;
          planned += job.divides - (job.completes ? spantex::detail::reciprocals_a_pixel(kind, c.how) * __builtin_popcountll(job.mask) : 0);
          const auto holds = [](const texel_box& b, const section& at, int side) {
            return b.u0 >= at.origin_u && b.v0 >= at.origin_v && b.u1 < at.origin_u + side && b.v1 < at.origin_v + side;
          };
          assert_true(holds(job.fine, c.fine, P.fine_side));
          assert_true(!c.two_levels || (holds(job.coarse, c.coarse, P.fine_side / 2) && c.coarse.level == c.fine.level + 1));
          assert_true(c.fine.level <= t.last_level());
          for (span_mask m = job.mask; m != 0 && !c.corrects && !c.axis.partial; m &= m - 1) {
            const int b = __builtin_ctzll(m), neighbour = kind == filter::nearest ? 0 : 1;
            if (uses_area(kind)) {
              const area_window w = area_window_at(prof, c, b % 8, b / 8, c.fine);
              assert_true(w.u >= job.fine.u0 && w.v >= job.fine.v0 && w.u + w.columns - 1 <= job.fine.u1 && w.v + w.rows - 1 <= job.fine.v1);
              assert_true(w.columns >= 1 && w.columns <= P.fine_side && w.rows >= 1 && w.rows <= P.fine_side);
              continue;
            }
            const snapped_position at = snap(position_at(prof, c, b % 8, b / 8), c.fine, kind, P);
            assert_true(at.u >= job.fine.u0 && at.v >= job.fine.v0 && at.u + neighbour <= job.fine.u1 && at.v + neighbour <= job.fine.v1);
          }
          return status::ok;
        }));
        assert_true(seen == mask);
        assert_true(planned == 1 || planned == __builtin_popcountll(mask));
      }
    }
}

SPANTEX_CASE(jobs_hold_every_pixel_once_and_every_texel_it_needs) {
  check_jobs<profiles::seed>();
  check_jobs<profiles::compact>();
  check_jobs<profiles::standard>();
  check_jobs<profiles::exact>();
}

// u is the same everywhere but for rounding, and that decides between two texels: k + 1/2 - 2^-9 is where snapping turns.
SPANTEX_CASE(sections_hold_positions_that_rounding_alone_moves) {
  const texture_view t = unread_view(512, 512);
  random_source random(66);
  int64_t turned = 0;
  for (int n = 0; n < 3000; ++n) {
    run_time_profile prof = with_side(profiles::exact, 8 << (n % 3));
    prof.value.reciprocal_bits = 10 + n % 7;
    prof.value.tolerance_bits = 16;
    const auto slope = [&](int64_t most) { return random.between(-most, most); };
    const int64_t one = int64_t(1) << 40, u_512 = random.between(-2000, 2000) * 512 + 255, g = slope(one / 300), h = slope(one / 300);
    const auto times_u = [&](int64_t x) { return multiply(wide(x), u_512); };
    const auto scaled = [](int64_t x) { return shift_left(wide(x), 9); };
    const homography m{times_u(g), times_u(h), times_u(one), scaled(slope(one)), scaled(slope(one)), scaled(slope(100 * one)),
                       scaled(g), scaled(h), scaled(one)};
    plane p{};
    if (make_plane(m, {0, 0, 32, 32}, p) != status::ok) continue;
    const surface s{&p, &t, filter::bilinear};
    SPANTEX_ASSERT_OK(plan_span(prof, s, 1, 2, front_mask(p, 1, 2), [&](span_job& job) {
      int32_t low = INT32_MAX, high = INT32_MIN;
      for (span_mask rest = job.mask; rest != 0; rest &= rest - 1) {
        const int k = __builtin_ctzll(rest);
        const snapped_position at = snap(position_at(prof, job.coefficients, k % 8, k / 8), job.coefficients.fine, s.kind, prof.value);
        assert_true(at.u >= job.fine.u0 && at.u + 1 <= job.fine.u1 && at.v >= job.fine.v0 && at.v + 1 <= job.fine.v1);
        low = min_of(low, at.u);
        high = max_of(high, at.u);
      }
      turned += low != high;
      return status::ok;
    }));
  }
  assert_true(turned > 300);
}

SPANTEX_CASE(a_sink_that_fails_ends_planning_with_its_status) {
  const fixed_profile<profiles::exact> prof;
  const texture_view t = unread_view(512, 512);
  const plane p = sample_plane(3);
  const surface s{&p, &t, filter::trilinear};
  for (int32_t sy = 0; sy < 60; ++sy) {
    const span_mask mask = front_mask(p, 40, sy);
    if (mask == 0) continue;
    int calls = 0;
    SPANTEX_ASSERT_STATUS(plan_span(prof, s, 40, sy, mask, [&](span_job&) { ++calls; return status::device_timeout; }), device_timeout);
    assert_int_equal(calls, 1);
  }
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(spans_equal_the_whole_map_for_power_of_two_maps_in_every_wrap_mode),
      cmocka_unit_test(spans_equal_the_whole_map_for_maps_of_other_sizes),
      cmocka_unit_test(spans_equal_the_whole_map_for_maps_one_texel_wide),
      cmocka_unit_test(spans_equal_the_whole_map_for_large_maps),
      cmocka_unit_test(areas_equal_the_whole_map_in_linear_light),
      cmocka_unit_test(spans_equal_the_whole_map_in_other_word_lengths),
      cmocka_unit_test(spans_equal_the_whole_map_on_random_planes),
      cmocka_unit_test(spans_equal_the_whole_map_where_rounding_is_coarse),
      cmocka_unit_test(seed_equals_the_whole_map_where_nothing_is_clamped),
      cmocka_unit_test(compile_time_and_run_time_profiles_draw_the_same),
      cmocka_unit_test(the_order_of_spans_and_the_number_of_halves_change_nothing),
      cmocka_unit_test(jobs_hold_every_pixel_once_and_every_texel_it_needs),
      cmocka_unit_test(sections_hold_positions_that_rounding_alone_moves),
      cmocka_unit_test(a_sink_that_fails_ends_planning_with_its_status),
  };
  return run_suite("plan", tests);
}
