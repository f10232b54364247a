// SPDX-License-Identifier: Apache-2.0
// The planner: a picture made of spans, jobs and sections is, bit for bit, the same arithmetic on the whole map; the order of spans, the
// size of local memory and where a profile's numbers come from change nothing.
#include <tests/support.hpp>

#include <type_traits>

using namespace spantex;
using namespace spantex::sim;

namespace {

// --- the same arithmetic with the whole map at hand: no sections, no jobs, no correction ---

template <class Prof>
span_coefficients whole_map_coefficients(const Prof& prof, const surface& s, int32_t sx, int32_t sy, int i, int j) {
  const profile& q = prof.get();
  const int32_t cx = 16 * sx + 8, cy = 16 * sy + 8;
  span_coefficients c{};
  c.kind = s.kind;
  c.last_level = uint8_t(s.texture->last_level());
  const bool major = q.formula == level_formula::major;
  if (s.map->w_at(cx, cy) > 0) {
    const reference r = reference_at(*s.map, cx, cy);
    if (span_coordinates(*s.map, r, q, c)) {
      if (major) major_levels(*s.map, r, c);
      else span_levels(q, c);
      return c;
    }
  }
  const int32_t hx = cx + half_pixels(i), hy = cy + half_pixels(j);
  const reference r = reference_at(*s.map, hx, hy);
  pixel_coordinates(r, q, c);
  if (major) major_levels(*s.map, r, c);
  else pixel_levels(*s.map, r, hx, hy, c);
  return c;
}

uint32_t channel_of(rgba8 c, int k) { return k == 0 ? c.r : k == 1 ? c.g : k == 2 ? c.b : c.a; }

// One level of one channel at a position.
partial_colour whole_map_blend(const profile& q, const texture_view& t, filter kind, int level, const snapped_position& p, int channel) {
  const auto texel = [&](int x, int y) {
    return channel_of(t.texel(level, t.wrapped_u(p.u + x, level), t.wrapped_v(p.v + y, level)), channel);
  };
  const texels2x2 four{texel(0, 0), texel(1, 0), texel(0, 1), texel(1, 1)};
  return uses_three_points(kind) ? three_point(four, p.fraction, q) : four_point(four, p.fraction, q);
}

section whole_level(const texture_view& t, int level) {
  return {0, 0, t.ratio_u(level), t.ratio_v(level), uint8_t(level), t.width(level) == 1, t.height(level) == 1};
}

template <class Prof>
rgba8 whole_map_pixel(const Prof& prof, const surface& s, int32_t x, int32_t y) {
  const profile& q = prof.get();
  const texture_view& t = *s.texture;
  const int i = x % 8, j = y % 8;
  const span_coefficients c = whole_map_coefficients(prof, s, x / 8, y / 8, i, j);
  const texel_position at = position_at(prof, c, i, j);
  const int32_t detail = uses_levels(s.kind) ? level_at(prof, c, i, j) : 0;
  const int level = integer_level(s.kind, detail, q.level_bits, c.last_level);
  const snapped_position fine = snap(at, whole_level(t, level), s.kind, q);
  if (s.kind == filter::nearest) return t.texel(0, t.wrapped_u(fine.u, 0), t.wrapped_v(fine.v, 0));
  const bool two = uses_two_levels(s.kind) && level < t.last_level();
  uint8_t out[4];
  for (int k = 0; k < 4; ++k) {
    partial_colour colour = whole_map_blend(q, t, s.kind, level, fine, k);
    if (two) {
      const snapped_position coarse = snap(at, whole_level(t, level + 1), s.kind, q);
      const int32_t fraction = detail - (level << q.level_bits);
      colour = between_levels(colour, whole_map_blend(q, t, s.kind, level + 1, coarse, k), uint32_t(fraction), q);
    }
    out[k] = written(colour, q);
  }
  return {out[0], out[1], out[2], out[3]};
}

template <class Prof>
void draw_whole_map(const Prof& prof, const surface& s, rectangle area, picture& out) {
  for (int32_t y = area.y0; y < area.y1; ++y)
    for (int32_t x = area.x0; x < area.x1; ++x)
      if (s.map->w_at(2 * x + 1, 2 * y + 1) > 0) out.pixels[size_t(y) * size_t(out.width) + size_t(x)] = whole_map_pixel(prof, s, x, y);
}

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

// Windows of a 640 x 480 picture whose edges cut spans.
constexpr rectangle windows[] = {{203, 170, 299, 229}, {0, 0, 77, 60}, {561, 421, 640, 480}, {300, 122, 420, 171}};

void check_sides(const profile& q, const synthetic_map& map, wrap wrap_u, wrap wrap_v) {
  const texture_view t = map.view(wrap_u, wrap_v);
  for (int k = 0; k < sample_plane_count; ++k) {
    const plane p = sample_plane(k);
    for (const filter kind : all_filters) {
      const surface s{&p, &t, kind};
      const rectangle window = windows[k];
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
}

// Random planes: steep, stretched, far, across the horizon.
SPANTEX_CASE(spans_equal_the_whole_map_on_random_planes) {
  const texture_view t = photographic_map(256, 96).view(wrap::repeat, wrap::mirror);
  random_source random(60);
  const rectangle area{0, 0, 64, 48};
  for (int n = 0; n < 400; ++n) {
    plane p{};
    if (!random_plane(random, area, p)) continue;
    const filter kind = all_filters[n % 6];
    const surface s{&p, &t, kind};
    expected.reset(64, 48);
    draw_whole_map(with_side(profiles::exact, 32), s, area, expected);
    got.reset(64, 48);
    if (n % 3 == 0) (void)draw_spans<8>(with_side(profiles::exact, 8), s, area, got);
    else if (n % 3 == 1) (void)draw_spans<16>(with_side(profiles::exact, 16), s, area, got);
    else (void)draw_spans<32>(with_side(profiles::exact, 32), s, area, got);
    assert_same_pictures("random plane", n, kind);
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
        const draw_counters a = draw_spans<P.fine_side>(fixed, s, windows[k], expected);
        const draw_counters b = draw_spans<P.fine_side>(dynamic, s, windows[k], got);
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
        draw_in_order(prof, s, windows[k], got, order, single_half);
        assert_same_pictures("order", k, kind);
      };
      expected.reset(640, 480);
      (void)draw_spans<P.fine_side>(prof, s, windows[k], expected);
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
        if (mask == 0) continue;
        SPANTEX_ASSERT_OK(plan_span(prof, s, sx, sy, mask, [&](span_job& job) {
          const span_coefficients& c = job.coefficients;
          assert_true(job.mask != 0 && (job.mask & ~mask) == 0 && (seen & job.mask) == 0);
          seen |= job.mask;
          const auto holds = [](const texel_box& b, const section& at, int side) {
            return b.u0 >= at.origin_u && b.v0 >= at.origin_v && b.u1 < at.origin_u + side && b.v1 < at.origin_v + side;
          };
          assert_true(holds(job.fine, c.fine, P.fine_side));
          assert_true(!c.two_levels || (holds(job.coarse, c.coarse, P.fine_side / 2) && c.coarse.level == c.fine.level + 1));
          assert_true(c.fine.level <= t.last_level());
          for (span_mask m = job.mask; m != 0 && !c.corrects; m &= m - 1) {
            const int b = __builtin_ctzll(m), neighbour = kind == filter::nearest ? 0 : 1;
            const snapped_position at = snap(position_at(prof, c, b % 8, b / 8), c.fine, kind, P);
            assert_true(at.u >= job.fine.u0 && at.v >= job.fine.v0 && at.u + neighbour <= job.fine.u1 && at.v + neighbour <= job.fine.v1);
          }
          return status::ok;
        }));
        assert_true(seen == mask);
      }
    }
}

SPANTEX_CASE(jobs_hold_every_pixel_once_and_every_texel_it_needs) {
  check_jobs<profiles::seed>();
  check_jobs<profiles::compact>();
  check_jobs<profiles::standard>();
  check_jobs<profiles::exact>();
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
      cmocka_unit_test(spans_equal_the_whole_map_in_other_word_lengths),
      cmocka_unit_test(spans_equal_the_whole_map_on_random_planes),
      cmocka_unit_test(seed_equals_the_whole_map_where_nothing_is_clamped),
      cmocka_unit_test(compile_time_and_run_time_profiles_draw_the_same),
      cmocka_unit_test(the_order_of_spans_and_the_number_of_halves_change_nothing),
      cmocka_unit_test(jobs_hold_every_pixel_once_and_every_texel_it_needs),
      cmocka_unit_test(a_sink_that_fails_ends_planning_with_its_status),
  };
  return run_suite("plan", tests);
}
