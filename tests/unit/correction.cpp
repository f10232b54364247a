// SPDX-License-Identifier: Apache-2.0
// What becomes of a section that is too small (docs/SPEC.md "Sections and jobs"): VR11's correction, the place of a clamped section, and how
// a span is cut where the profile splits.
#include <tests/support.hpp>

using namespace spantex;
using namespace spantex::sim;

// A corrected position is the position itself moved to the nearest one the section can serve: texel + weight in
// [origin, origin + side - 2 + (1 - 2^-subtexel_bits)].
SPANTEX_CASE(corrected_positions_are_the_nearest_in_the_section) {
  for (const int bits : {1, 6, 8})
    for (const int side : {4, 8, 16, 32})
      for (const int32_t origin : {-37, -8, 0, 5}) {
        profile q = profiles::exact;
        q.subtexel_bits = bits;
        section at{};
        at.origin_u = origin;
        at.origin_v = -origin;
        const int32_t one = 1 << bits, high = (side - 2) * one + one - 1;
        for (int32_t offset = -3 * side * one; offset <= 3 * side * one; ++offset) {
          const auto place = [&](int32_t first) { return first * one + offset; };
          const auto texel = [&](int32_t first) { return place(first) >> bits; };
          const uint32_t rest = uint32_t(offset & (one - 1));
          const corrected c = correct({texel(origin), texel(-origin), {rest, rest}}, at, side, filter::bilinear, q);
          const int32_t wanted = clamp_to(offset, 0, high);
          const auto local = [&](int32_t first) { return (first + (wanted >> bits)) & (side - 1); };
          assert_true(c.at.x == local(origin) && c.at.y == local(-origin));
          assert_true(int32_t(c.fraction.u) == (wanted & (one - 1)) && c.fraction.v == c.fraction.u);
        }
      }
}

SPANTEX_CASE(corrected_texels_of_nearest_are_those_of_the_section) {
  section at{};
  at.origin_u = at.origin_v = -5;
  for (int32_t texel = -40; texel <= 40; ++texel) {
    const corrected c = correct({texel, texel, {0, 0}}, at, 8, filter::nearest, profiles::exact);
    assert_int_equal(c.at.x, clamp_to(texel, -5, 2) & 7);
    assert_int_equal(c.fraction.u, 0);
  }
}

// A section that does not hold its box lies in the middle of it, and its job is corrected.
SPANTEX_CASE(clamped_sections_have_the_middle_of_what_they_cannot_hold) {
  const fixed_profile<profiles::seed> prof;
  const texture_view t = photographic_map(64, 64).view(wrap::repeat, wrap::mirror);
  const plane p = sample_plane(1);
  int64_t clamped = 0;
  for (int32_t sy = 0; sy < 60; ++sy)
    for (int32_t sx = 0; sx < 80; sx += 3) {
      const span_mask mask = front_mask(p, sx, sy);
      if (mask == 0) continue;
      const surface s{&p, &t, filter::bilinear};
      SPANTEX_ASSERT_OK(plan_span(prof, s, sx, sy, mask, [&](span_job& job) {
        const span_coefficients& c = job.coefficients;
        const texel_box box = spantex::detail::touched(prof, c, box_of(job.mask), spantex::detail::section_at(t, c.fine.level));
        const auto check = [&](int32_t low, int32_t high, int32_t origin) {
          if (high - low < 8) return assert_int_equal(origin, low);
          const int32_t off_by = (2 * origin + 7) - (low + high);  // twice the distance of the middles
          assert_true(off_by == 0 || off_by == -1 || off_by == 1);
          assert_true(c.corrects);
          ++clamped;
        };
        check(box.u0, box.u1, c.fine.origin_u);
        check(box.v0, box.v1, c.fine.origin_v);
        return status::ok;
      }));
    }
  assert_true(clamped > 500);
}

// `split`: jobs are the largest aligned runs in Morton order. No job could have been joined with the other half of its run: the box of both
// would not fit. (A job's own run is the smallest aligned one that holds its pixels.)
template <profile P>
static void check_runs() {
  const fixed_profile<P> prof;
  const texture_view t = unread_view(512, 512);
  int64_t parts = 0;
  for (int k = 0; k < sample_plane_count; ++k) {
    const plane p = sample_plane(k);
    const surface s{&p, &t, filter::bilinear};
    for (int32_t n = 0; n < 60; ++n) {
      const int32_t sx = (n * 37 + 5) % 80;
      if (front_mask(p, sx, n) != full_mask) continue;
      span_job all[64];
      int count = 0;
      SPANTEX_ASSERT_OK(plan_span(prof, s, sx, n, full_mask, [&](span_job& job) { all[count++] = job; return status::ok; }));
      if (count == 1 || all[0].coefficients.a_u == 0) continue;  // whole, or pixel by pixel
      for (int j = 0, index = 0; j < count; ++j) {
        const int size = __builtin_popcountll(all[j].mask);
        assert_true(index % size == 0 && all[j].mask == spantex::detail::run_mask(index, size));  // aligned, in order, no gap
        const int run = index / (2 * size) * (2 * size);
        span_job both = all[j];
        both.mask = spantex::detail::run_mask(run, 2 * size);
        assert_false(spantex::detail::take_sections(prof, t, 0, false, both));
        index += size;
        ++parts;
      }
    }
  }
  assert_true(parts > 500);
}

SPANTEX_CASE(a_span_is_split_into_the_largest_runs_that_fit) {
  check_runs<profile{.fine_side = 8}>();
  check_runs<profiles::standard>();
}

// `coarser`: the level is the first at or above the wanted one whose section fits.
SPANTEX_CASE(a_level_is_raised_until_its_section_fits_and_no_further) {
  const fixed_profile<profiles::compact> prof;
  const texture_view t = unread_view(512, 512);
  int64_t raised = 0;
  for (int k = 0; k < sample_plane_count; ++k) {
    const plane p = sample_plane(k);
    const surface s{&p, &t, filter::mip_bilinear};
    for (int32_t n = 0; n < 60; ++n) {
      const int32_t sx = (n * 37 + 5) % 80;
      const span_mask mask = front_mask(p, sx, n);
      if (mask == 0) continue;
      SPANTEX_ASSERT_OK(plan_span(prof, s, sx, n, mask, [&](span_job& job) {
        const span_coefficients& c = job.coefficients;
        const int pixel = __builtin_ctzll(job.mask);
        const int wanted = integer_level(s.kind, level_at(prof, c, pixel % 8, pixel / 8), profiles::compact.level_bits, c.last_level);
        assert_true(c.fine.level >= wanted);
        for (int level = wanted; level < c.fine.level; ++level, ++raised) {
          span_job finer = job;
          assert_false(spantex::detail::take_sections(prof, t, level, false, finer));
        }
        return status::ok;
      }));
    }
  }
  assert_true(raised > 100);
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(corrected_positions_are_the_nearest_in_the_section),
      cmocka_unit_test(corrected_texels_of_nearest_are_those_of_the_section),
      cmocka_unit_test(clamped_sections_have_the_middle_of_what_they_cannot_hold),
      cmocka_unit_test(a_span_is_split_into_the_largest_runs_that_fit),
      cmocka_unit_test(a_level_is_raised_until_its_section_fits_and_no_further),
  };
  return run_suite("correction", tests);
}
