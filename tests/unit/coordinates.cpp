// SPDX-License-Identifier: Apache-2.0
// Texture coordinates against Nu/W as an exact fraction: every position is compared by cross-multiplication in 128 bits.
#include <sim/exact.hpp>
#include <tests/support.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

struct coordinate_statistics {
  int64_t evaluations = 0, by_how[3] = {};
  int64_t worst = 0;  // 2^-24 texel, rounded up
  int64_t worst_by_how[3] = {};

  // |raw / 2^16 - n / w| in 2^-24 texel, rounded up.
  static int64_t error(int64_t raw, int128 n, int64_t w) {
    const int128 difference = magnitude_of(int128(raw) * w - (n << 16));
    return int64_t((difference * 256 + w - 1) / w);
  }
  void note(int64_t e, const span_coefficients& c) {
    ++evaluations;
    ++by_how[int(c.how)];
    if (e > worst_by_how[int(c.how)]) worst_by_how[int(c.how)] = e;
    if (e > worst) worst = e;
  }
  void print(const char* what) const {
    const auto part = [](int64_t e) { return e == 0 ? 0.0 : 16777216.0 / double(e); };
    std::printf("# %s: %lld evaluations (affine %lld, series %lld, divide %lld), worst 1/%.0f texel (1/%.0f, 1/%.0f, 1/%.0f)\n", what,
                static_cast<long long>(evaluations), static_cast<long long>(by_how[0]), static_cast<long long>(by_how[1]),
                static_cast<long long>(by_how[2]), part(worst), part(worst_by_how[0]), part(worst_by_how[1]), part(worst_by_how[2]));
  }
};

// Within +-2^15 texels, exactly.
bool is_in_range(int128 n, int64_t w) { return magnitude_of(n) < int128(w) << 15; }

// The caller's integers where the profile answers for them.
exact_point truth_at(const profile& q, const plane& p, int32_t hx, int32_t hy) {
  return q.exact_set_up ? exact_at(p, hx, hy) : exact_point{p.u_at(hx, hy), p.v_at(hx, hy), p.w_at(hx, hy)};
}

template <class Prof>
void measure_span(const Prof& prof, const plane& p, const texture_view& t, int32_t sx, int32_t sy, coordinate_statistics& s) {
  const span_mask mask = front_mask(p, sx, sy);
  if (mask == 0) return;
  const surface what{&p, &t, filter::nearest};
  span_mask seen = 0;
  const status done = plan_span(prof, what, sx, sy, mask, [&](span_job& job) {
    assert_true((seen & job.mask) == 0);
    seen |= job.mask;
    for (span_mask rest = job.mask; rest != 0; rest &= rest - 1) {
      const int k = __builtin_ctzll(rest), i = k % span_side, j = k / span_side;
      const int32_t hx = 2 * (sx * span_side + i) + 1, hy = 2 * (sy * span_side + j) + 1;
      const auto [nu, nv, w] = truth_at(prof.get(), p, hx, hy);
      if (w <= 0) continue;  // in front by the rounded W alone
      const texel_position at = position_at(prof, job.coefficients, i, j);
      if (is_in_range(nu, w)) s.note(coordinate_statistics::error(at.u.raw(), nu, w), job.coefficients);
      if (is_in_range(nv, w)) s.note(coordinate_statistics::error(at.v.raw(), nv, w), job.coefficients);
    }
    return status::ok;
  });
  SPANTEX_ASSERT_OK(done);
  assert_true(seen == mask);
}

template <class Prof>
void measure_region(const Prof& prof, const plane& p, const texture_view& t, rectangle region, coordinate_statistics& s) {
  for (int32_t sy = region.y0 / span_side; sy <= (region.y1 - 1) / span_side; ++sy)
    for (int32_t sx = region.x0 / span_side; sx <= (region.x1 - 1) / span_side; ++sx) measure_span(prof, p, t, sx, sy, s);
}

// Random planes: small regions whole, large ones at random spans and along the horizon.
template <profile P>
coordinate_statistics measure_random(int small_planes, int large_planes) {
  const fixed_profile<P> prof;
  const texture_view t = unread_view(4096, 4096);
  coordinate_statistics s;
  random_source random(30);
  plane p{};
  for (int k = 0; k < small_planes; ++k) {
    const int32_t x = 8 * int32_t(random.next() % 500), y = 8 * int32_t(random.next() % 500);
    const rectangle region{x, y, x + 64, y + 64};
    if (random_plane(random, region, p)) measure_region(prof, p, t, region, s);
  }
  const rectangle screen{0, 0, 4096, 4096};
  for (int k = 0; k < large_planes; ++k) {
    if (!random_plane(random, screen, p)) continue;
    for (int n = 0; n < 8; ++n) {
      const int32_t sx = int32_t(random.next() % 512), sy = int32_t(random.next() % 512);
      measure_span(prof, p, t, sx, sy, s);
    }
    const int32_t row = int32_t(random.next() % 512);
    for (int32_t sx = 0; sx < 512; ++sx) {
      const span_mask front = front_mask(p, sx, row);
      if (front != 0 && front != full_mask) measure_span(prof, p, t, sx, row, s);
    }
  }
  return s;
}

}  // namespace

SPANTEX_CASE(exact_profile_is_within_a_512th_of_a_texel) {
  const coordinate_statistics s = measure_random<profiles::exact>(400, 1000);
  s.print("exact");
  assert_true(s.evaluations >= 2000000 && s.by_how[0] > 10000 && s.by_how[1] > 10000 && s.by_how[2] > 10000);
  assert_true(s.worst <= (1 << 24) / 512);
}

SPANTEX_CASE(default_profile_is_within_a_256th_of_a_texel) {
  const coordinate_statistics s = measure_random<profiles::standard>(400, 1000);
  s.print("default");
  assert_true(s.evaluations >= 2000000);
  assert_true(s.worst <= (1 << 24) / 256);
}

// Every profile keeps the bound that its numbers promise.
template <profile P>
static void check_own_bound(const char* name) {
  const coordinate_statistics s = measure_random<P>(100, 300);
  s.print(name);
  std::printf("#   bound of its numbers: 1/%.2f texel\n", double(error_unit) / double(coordinate_bound(P)));
  assert_true(uint64_t(s.worst - 1) << 16 <= coordinate_bound(P));
}

SPANTEX_CASE(every_profile_keeps_the_bound_of_its_numbers) {
  check_own_bound<profiles::exact>("exact");
  check_own_bound<profiles::standard>("default");
  check_own_bound<profiles::compact>("compact");
  check_own_bound<profiles::seed>("seed");
}

// The corners of what is_valid() allows: short mantissas with long reciprocals and positions, and the reverse.
SPANTEX_CASE(extreme_word_lengths_keep_the_bound_of_their_numbers) {
  check_own_bound<profile{.offset_bits = 12, .reciprocal_bits = 12}>("12, 12, 16 bits");
  check_own_bound<profile{.offset_bits = 14, .reciprocal_bits = 12}>("14, 12, 16 bits");
  check_own_bound<profile{.offset_bits = 31, .reciprocal_bits = 12}>("31, 12, 16 bits");
  check_own_bound<profile{.offset_bits = 12, .reciprocal_bits = 30}>("12, 30, 16 bits");
  check_own_bound<profile{.coordinate_bits = 4, .offset_bits = 31}>("31, 30, 4 bits");
}

SPANTEX_CASE(sample_planes_are_within_a_512th_of_a_texel) {
  const fixed_profile<profiles::exact> prof;
  const texture_view t = unread_view(512, 512);
  for (int k = 0; k < sample_plane_count; ++k) {
    coordinate_statistics s;
    measure_region(prof, sample_plane(k), t, {0, 0, 640, 480}, s);
    s.print("sample plane");
    assert_true(s.worst <= (1 << 24) / 512);
  }
}

// The ends of the promised range: u runs through +-2^15 within the region.
SPANTEX_CASE(coordinates_just_inside_2_to_the_15_are_within_their_bound) {
  const fixed_profile<profiles::exact> prof;
  const texture_view t = unread_view(4096, 4096);
  const rectangle region{0, 0, 64, 64};
  coordinate_statistics s;
  for (const int64_t sign : {-1, 1})
    for (const int64_t slope : {1ll << 36, 1ll << 40, 5ll << 38, -(3ll << 39)})
      for (const int64_t g : {0ll, 1ll << 28, 1ll << 34}) {
        const wide one(int64_t(1) << 40), zero(0);
        const wide offset = multiply(one, sign * 32768) - multiply(wide(slope), 32);
        const homography m{wide(slope), zero, offset, zero, wide(slope), offset, wide(g), zero, one};
        plane p{};
        SPANTEX_ASSERT_OK(make_plane(m, region, p));
        measure_region(prof, p, t, region, s);
      }
  s.print("near 2^15");
  assert_true(s.evaluations > 10000);
  assert_true(s.worst <= (1 << 24) / 512);
}

SPANTEX_CASE(beyond_2_to_the_15_the_sign_and_a_far_coordinate_remain) {
  const fixed_profile<profiles::exact> prof;
  const texture_view t = unread_view(64, 64);
  const rectangle region{0, 0, 64, 64};
  random_source random(31);
  for (int k = 0; k < 2000; ++k) {
    const wide one(int64_t(1) << 30);
    const int64_t far = random.between(33000, 4000000000ll) * ((k & 1) != 0 ? 1 : -1);
    const wide h(random.between(-100000, 100000));
    const homography m{one, wide(0), multiply(one, far), wide(0), one, multiply(one, -far), wide(0), h, one};
    plane p{};
    SPANTEX_ASSERT_OK(make_plane(m, region, p));
    const surface what{&p, &t, filter::nearest};
    SPANTEX_ASSERT_OK(plan_span(prof, what, 3, 3, front_mask(p, 3, 3), [&](span_job& job) {
      for (span_mask rest = job.mask; rest != 0; rest &= rest - 1) {
        const texel_position at = position_at(prof, job.coefficients, __builtin_ctzll(rest) % 8, __builtin_ctzll(rest) / 8);
        assert_true(magnitude_of(at.u.raw()) >= 32767 << 16 && magnitude_of(at.v.raw()) >= 32767 << 16);
        assert_true((at.u.raw() < 0) == (far < 0) && (at.v.raw() < 0) == (far > 0));
      }
      return status::ok;
    }));
  }
}

// A position does not depend on how the span it lies in is cut, nor on which profile type carries the numbers.
SPANTEX_CASE(run_time_and_compile_time_profiles_give_the_same_positions) {
  const texture_view t = unread_view(512, 512);
  const auto check = [&](auto fixed) {
    const run_time_profile dynamic{fixed.get()};
    for (int k = 0; k < sample_plane_count; ++k) {
      const plane p = sample_plane(k);
      const surface what{&p, &t, filter::nearest};
      for (int32_t s = 0; s < 60; ++s) {
        const span_mask mask = front_mask(p, s, s);
        if (mask == 0) continue;
        static texel_position first[64];
        SPANTEX_ASSERT_OK(plan_span(fixed, what, s, s, mask, [&](span_job& job) {
          for (span_mask m = job.mask; m != 0; m &= m - 1) {
            const int n = __builtin_ctzll(m);
            first[n] = position_at(fixed, job.coefficients, n % 8, n / 8);
          }
          return status::ok;
        }));
        SPANTEX_ASSERT_OK(plan_span(dynamic, what, s, s, mask, [&](span_job& job) {
          for (span_mask m = job.mask; m != 0; m &= m - 1) {
            const int n = __builtin_ctzll(m);
            const texel_position q = position_at(dynamic, job.coefficients, n % 8, n / 8);
            assert_true(q.u == first[n].u && q.v == first[n].v);
          }
          return status::ok;
        }));
      }
    }
  };
  check(fixed_profile<profiles::seed>{});
  check(fixed_profile<profiles::compact>{});
  check(fixed_profile<profiles::standard>{});
  check(fixed_profile<profiles::exact>{});
}

// Magnified maps: spans of small reach have large exponents, so positions are shifted down by more than 31 bits.
template <profile P>
static void check_magnified() {
  const fixed_profile<P> fixed;
  const run_time_profile dynamic{P};
  const texture_view t = unread_view(64, 64);
  random_source random(32);
  int64_t far = 0;
  for (int k = 0; k < 3000; ++k) {
    const int64_t one = int64_t(1) << 40, most = int64_t(1) << random.between(2, 36);
    const int64_t g = random.between(-one / 64, one / 64) * (k % 2), h = random.between(-one / 64, one / 64) * (k % 2);
    const auto near = [&](int64_t x) { return wide(x + random.between(-most, most)); };  // u is close to 2, v to 3
    const homography m{near(2 * g), near(2 * h), near(2 * one), near(3 * g), near(3 * h), near(3 * one), wide(g), wide(h), wide(one)};
    plane p{};
    if (make_plane(m, {0, 0, 32, 32}, p) != status::ok) continue;
    const surface what{&p, &t, filter::nearest};
    SPANTEX_ASSERT_OK(plan_span(fixed, what, 1, 1, front_mask(p, 1, 1), [&](span_job& job) {
      const span_coefficients& c = job.coefficients;
      far += c.exponent - P.coordinate_bits + (c.how == evaluation::affine ? 0 : P.reciprocal_bits) > 31;
      for (span_mask rest = job.mask; rest != 0; rest &= rest - 1) {
        const int n = __builtin_ctzll(rest);
        const texel_position a = position_at(fixed, c, n % 8, n / 8), b = position_at(dynamic, c, n % 8, n / 8);
        assert_true(a.u == b.u && a.v == b.v);
      }
      return status::ok;
    }));
  }
  assert_true(far > 100 || P.coordinate_bits > 4);
}

SPANTEX_CASE(magnified_positions_are_the_same_in_short_and_in_long_words) {
  check_magnified<profile{.coordinate_bits = 4, .offset_bits = 15, .reciprocal_bits = 14, .tolerance_bits = 16}>();
  check_magnified<profile{.coordinate_bits = 4, .offset_bits = 12, .reciprocal_bits = 12, .tolerance_bits = 16}>();
  check_magnified<profiles::compact>();
  check_magnified<profiles::exact>();
}

namespace {

// W falls to 2^-5 to 2^-20 of its largest value at a pixel where u and v lie near whole numbers of up to 2^15.
struct far_place {
  homography m;
  int32_t x, y;
};
far_place random_far_place(random_source& random) {
  const auto scaled = [](wide x, int bits) { return shift_left(x, bits); };
  far_place f{{}, int32_t(random.next() % 4000), int32_t(random.next() % 4000)};
  const int small = int(random.between(45, 80)), steep = int(random.between(25, 41));  // bits of W there, of up to 93, and of its slopes over 40
  const auto slope = [&] { return scaled(wide(random.between(-(int64_t(1) << 39), int64_t(1) << 39)), steep + 1); };
  const wide g = slope(), h = slope(), w = scaled(wide(random.between(1 << 20, 1 << 21)), small - 21);
  // Over pixel centres: (2 x + 1) / 2.
  const auto from_place = [&](wide x, wide y) { return shift_right_floor(multiply(x, 2 * f.x + 1) + multiply(y, 2 * f.y + 1), 1); };
  const wide i = w - from_place(g, h);
  const auto numerator = [&](wide& a, wide& b, wide& c) {
    const int64_t base = random.between(-32700, 32700);
    const wide da = scaled(wide(random.between(-(1 << 20), 1 << 20)), small - 24), db = scaled(wide(random.between(-(1 << 20), 1 << 20)), small - 24);
    a = multiply(g, base) + da;
    b = multiply(h, base) + db;
    c = multiply(i, base) - from_place(da, db);
  };
  numerator(f.m.a, f.m.b, f.m.c);
  numerator(f.m.d, f.m.e, f.m.f);
  f.m.g = g;
  f.m.h = h;
  f.m.i = i;
  return f;
}

// By the matrix itself, not by what the plane keeps of it; cut to 62 bits of W.
exact_point by_matrix(const homography& m, int32_t hx, int32_t hy) {
  const auto at = [&](wide a, wide b, wide c) { return int128_of(a) * hx + int128_of(b) * hy + 2 * int128_of(c); };
  const int128 w = at(m.g, m.h, m.i);
  const int cut = w > 0 && bits_of(w) > 62 ? bits_of(w) - 62 : 0;
  return {at(m.a, m.b, m.c) >> cut, at(m.d, m.e, m.f) >> cut, int64_t(w >> cut)};
}

template <profile P>
coordinate_statistics measure_far_places(double& largest_share) {
  const fixed_profile<P> prof;
  const texture_view t = unread_view(4096, 4096);
  coordinate_statistics s;
  random_source random(36);
  largest_share = 0;
  for (int k = 0; k < 400; ++k) {
    const far_place f = random_far_place(random);
    plane p{};
    if (make_plane(f.m, {0, 0, 4096, 4096}, p) != status::ok) continue;
    const surface what{&p, &t, filter::nearest};
    for (int32_t n = 0; n < 9; ++n) {
      const int32_t sx = clamp_to(f.x / 8 + n % 3 - 1, 0, 511), sy = clamp_to(f.y / 8 + n / 3 - 1, 0, 511);
      const span_mask front = front_mask(p, sx, sy);
      if (front == 0) continue;
      SPANTEX_ASSERT_OK(plan_span(prof, what, sx, sy, front, [&](span_job& job) {
        const span_coefficients& c = job.coefficients;
        const bool single = (c.a_u | c.b_u | c.a_v | c.b_v | c.g | c.h) == 0;
        const double bound = double(single ? pixel_bound(P) : coordinate_bound(P, P.offset_bits - 1 - c.exponent)) / double(error_unit);
        for (span_mask rest = job.mask; rest != 0; rest &= rest - 1) {
          const int bit = __builtin_ctzll(rest), i = bit % span_side, j = bit / span_side;
          const exact_point e = by_matrix(f.m, 2 * (sx * span_side + i) + 1, 2 * (sy * span_side + j) + 1);
          if (e.w <= 0) continue;
          const texel_position at = position_at(prof, c, i, j);
          for (const auto& [raw, n128] : {std::pair(at.u.raw(), e.u), std::pair(at.v.raw(), e.v)}) {
            if (!is_in_range(n128, e.w)) continue;
            s.note(coordinate_statistics::error(raw, n128, e.w), c);
            largest_share = std::fmax(largest_share, coordinate_error(raw, n128, e.w) / bound);
          }
        }
        return status::ok;
      }));
    }
  }
  return s;
}

constexpr profile with_rounded_set_up(profile p) {
  p.exact_set_up = false;
  return p;
}

}  // namespace

// Far from the origin and near the horizon, against rational arithmetic on the caller's matrix: within the bound; without the exact forms the
// same spans are whole texels off.
SPANTEX_CASE(the_callers_integers_count_where_w_is_small) {
  double share = 0;
  const coordinate_statistics exact = measure_far_places<profiles::exact>(share);
  exact.print("exact, small W");
  assert_true(exact.evaluations > 50000 && share <= 1);
  const coordinate_statistics standard = measure_far_places<profiles::standard>(share);
  standard.print("default, small W");
  assert_true(share <= 1);
  const coordinate_statistics rounded = measure_far_places<with_rounded_set_up(profiles::exact)>(share);
  rounded.print("exact from rounded forms");
  assert_true(rounded.worst > int64_t(1) << 24);
}

// exact_reference_at against 128-bit integers: W to 45 bits, offsets and slopes in its scale.
SPANTEX_CASE(exact_references_are_the_callers_integers_cut_to_45_bits_of_w) {
  random_source random(37);
  int64_t compared = 0;
  for (int k = 0; k < 20000; ++k) {
    const far_place f = random_far_place(random);
    plane p{};
    reference r{};
    if (make_plane(f.m, {0, 0, 4096, 4096}, p) != status::ok) continue;
    const int32_t hx = 2 * f.x + 1 + int32_t(random.between(-8, 8)), hy = 2 * f.y + 1 + int32_t(random.between(-8, 8));
    const auto at = [&](wide a, wide b, wide c) { return int128_of(a) * hx + int128_of(b) * hy + 2 * int128_of(c); };
    const int128 w = at(f.m.g, f.m.h, f.m.i);
    assert_true(exact_reference_at(p, hx, hy, r) == (w > 0));
    if (w <= 0) continue;
    const int cut = bits_of(w) > 45 ? bits_of(w) - 45 : 0;
    const auto is_cut = [&](int64_t x, int128 exact, int drop) { assert_true(magnitude_of((int128(x) << drop) - exact) * 2 <= int128(1) << drop); };
    is_cut(r.w, w, cut);
    is_cut(r.g, int128_of(f.m.g), cut + r.slope_drop);
    assert_true(r.w_exponent == cut - p.dropped_bits);
    const auto axis = [&](bool good, int32_t base, int64_t c, int64_t a, int64_t b, wide x, wide y, wide one) {
      const int128 n = at(x, y, one);
      assert_true(good == (magnitude_of(n) <= (w << 15) - (w >> 1)) || magnitude_of(magnitude_of(n) - (w << 15)) < w);
      if (!good) return;
      assert_true(magnitude_of(n - base * w) <= w / 2 + (w >> 12));
      is_cut(c, n - base * w, cut);
      is_cut(a, int128_of(x) - base * int128_of(f.m.g), cut + r.slope_drop);
      is_cut(b, int128_of(y) - base * int128_of(f.m.h), cut + r.slope_drop);
      ++compared;
    };
    axis(r.u_in_range, r.base_u, r.c_u, r.a_u, r.b_u, f.m.a, f.m.b, f.m.c);
    axis(r.v_in_range, r.base_v, r.c_v, r.a_v, r.b_v, f.m.d, f.m.e, f.m.f);
  }
  assert_true(compared > 10000);
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(the_callers_integers_count_where_w_is_small),
      cmocka_unit_test(exact_references_are_the_callers_integers_cut_to_45_bits_of_w),
      cmocka_unit_test(exact_profile_is_within_a_512th_of_a_texel),
      cmocka_unit_test(default_profile_is_within_a_256th_of_a_texel),
      cmocka_unit_test(every_profile_keeps_the_bound_of_its_numbers),
      cmocka_unit_test(extreme_word_lengths_keep_the_bound_of_their_numbers),
      cmocka_unit_test(sample_planes_are_within_a_512th_of_a_texel),
      cmocka_unit_test(coordinates_just_inside_2_to_the_15_are_within_their_bound),
      cmocka_unit_test(beyond_2_to_the_15_the_sign_and_a_far_coordinate_remain),
      cmocka_unit_test(run_time_and_compile_time_profiles_give_the_same_positions),
      cmocka_unit_test(magnified_positions_are_the_same_in_short_and_in_long_words),
  };
  return run_suite("coordinates", tests);
}
