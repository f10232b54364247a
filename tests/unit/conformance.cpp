// SPDX-License-Identifier: Apache-2.0
// Every pixel of every filter, wrap mode, map size and texel format is one that the promised precision can produce (sim/verifier.hpp):
// exact at 8 sub-texel and 8 level bits, default at 7 and 8 (promised are 6), both within one unit of colour. No pixel may fail. And the verifier itself
// refuses pictures that are wrong by more than that.
#include <tests/properties.hpp>

#include "sim/verifier.hpp"

using namespace spantex;
using namespace spantex::sim;

namespace {

constexpr int32_t width = 160, height = 120;

// The sample planes of 640 x 480 seen through a quarter of the pixels per side: the same view, four times the minification.
plane small_plane(int k) { return plane_of(shrunk(sample_homography(k), 4), width, height); }

// The sample planes close up: the middle of the picture at one pixel per pixel.
homography close_view(int k) { return from_pixel(sample_homography(k), 240, 200); }
plane close_plane(int k) { return plane_of(close_view(k), width, height); }

picture drawn;

template <profile P>
uint64_t failures(const plane& map, const texture_view& t, filter kind, const promised_precision& bits) {
  drawn.reset(width, height);
  if (render_plane_direct<P.fine_side>(fixed_profile<P>{}, map, t, kind, drawn) != status::ok) std::abort();
  const verdict v = verify_plane(map, t, kind, P, bits, drawn.pixels.data(), width, height);
  if (v.pixels == 0) std::abort();
  if (v.failures != 0)
    std::fprintf(stderr, "# filter %d: %llu of %llu pixels fail, first (%d, %d)\n", int(kind), static_cast<unsigned long long>(v.failures),
                 static_cast<unsigned long long>(v.pixels), v.first_x, v.first_y);
  return v.failures;
}

template <profile P>
void every_pixel_conforms(const promised_precision& bits) {
  const synthetic_map* maps[] = {&photographic_map(64, 64), &photographic_map(60, 33)};
  for (int k = 0; k < sample_plane_count; ++k)
    for (const synthetic_map* m : maps)
      for (filter kind : one_sample_filters)
        for (wrap mode : all_wraps) {
          assert_int_equal(failures<P>(small_plane(k), m->view(mode, mode), kind, bits), 0);
          assert_int_equal(failures<P>(close_plane(k), m->view(mode, mode), kind, bits), 0);
        }
}

// Texels that are cheap to make: hashed cells of 4 x 4 with a gradient on them.
const synthetic_map& large_map(int32_t map_width, int32_t map_height) {
  return make_map(map_width, map_height, [](int32_t x, int32_t y) {
    const auto cell = random_source(uint64_t(x >> 2) << 32 | uint64_t(y >> 2)).next();
    return rgba8{uint8_t(cell >> 24), uint8_t((cell >> 16 & 127) + (x & 127)), uint8_t(x + 2 * y), uint8_t(cell >> 9)};
  });
}

// u and v stretched over the map, so that all of it is seen: level 0 of 512 texels stays as it is.
homography over(homography m, int32_t map_width, int32_t map_height) {
  for (wide* c : {&m.a, &m.b, &m.c}) *c = shift_right_floor(multiply(*c, map_width), 9);
  for (wide* c : {&m.d, &m.e, &m.f}) *c = shift_right_floor(multiply(*c, map_height), 9);
  return m;
}

template <profile P>
void every_size_conforms(const promised_precision& bits) {
  static const synthetic_map* const maps[] = {
      &photographic_map(1, 1),     &photographic_map(1, 100), &photographic_map(77, 1), &photographic_map(2, 3), &photographic_map(255, 5),
      &photographic_map(129, 127), &large_map(4096, 1),       &large_map(1, 4096),      &large_map(2048, 2048),  &large_map(1999, 1021)};
  int n = 0;
  for (const synthetic_map* m : maps)
    for (int k = 0; k < sample_plane_count; ++k)
      for (const filter kind : one_sample_filters) {
        if (short_run() && n % 5 != 0) {
          ++n;
          continue;
        }
        // Every pair of wrap modes in turn; the map once over the picture and at its own scale.
        const texture_view t = m->view(all_wraps[n % 3], all_wraps[n / 3 % 3]);
        const level_pixels& base = m->levels[0];
        const bool whole = ++n % 2 == 0 && base.width > 1 && base.height > 1;
        const plane p = whole ? plane_of(over(shrunk(sample_homography(k), 4), base.width, base.height), width, height) : close_plane(k);
        assert_int_equal(failures<P>(p, t, kind, bits), 0);
      }
}

template <profile P>
void every_format_conforms(const promised_precision& bits) {
  const synthetic_map* const maps[] = {&photographic_map(64, 64), &photographic_map(60, 33)};
  int n = 0;
  for (const texel_format format : plain_formats) {
    if (format == texel_format::rgba8888) continue;
    for (const synthetic_map* m : maps)
      for (int k = 0; k < sample_plane_count; ++k)
        for (const filter kind : one_sample_filters) {
          const texture_view t = in_format(*m, format).view(all_wraps[n % 3], all_wraps[n / 3 % 3]);
          assert_int_equal(failures<P>(++n % 2 == 0 ? small_plane(k) : close_plane(k), t, kind, bits), 0);
        }
  }
}

}  // namespace

// Promised is one unit; exact needs the half of its rounding and a bit.
SPANTEX_CASE(exact_conforms_at_8_subtexel_and_8_level_bits) { every_pixel_conforms<profiles::exact>({8, 8, 0.51}); }
SPANTEX_CASE(default_conforms_at_7_subtexel_and_8_level_bits) { every_pixel_conforms<profiles::standard>({7, 8, 1}); }

SPANTEX_CASE(exact_conforms_for_every_size_of_map) { every_size_conforms<profiles::exact>({8, 8, 1}); }
SPANTEX_CASE(default_conforms_for_every_size_of_map) { every_size_conforms<profiles::standard>({7, 8, 1}); }
SPANTEX_CASE(exact_conforms_for_16_bit_maps) { every_format_conforms<profiles::exact>({8, 8, 1}); }
SPANTEX_CASE(default_conforms_for_16_bit_maps) { every_format_conforms<profiles::standard>({7, 8, 1}); }

// Rows of samples: their number, places, levels and mean.
template <profile P>
void every_row_conforms(const promised_precision& bits) {
  const synthetic_map* maps[] = {&photographic_map(64, 64), &photographic_map(60, 33), &photographic_map(512, 300)};
  for (int k = 0; k < sample_plane_count; ++k)
    for (size_t n = 0; n < std::size(maps); ++n)
      for (const bool close : {false, true}) {
        const plane p = close ? close_plane(k) : small_plane(k);
        const texture_view t = maps[n]->view(all_wraps[n % 3], all_wraps[(n + size_t(k)) % 3]);
        drawn.reset(width, height);
        SPANTEX_ASSERT_OK(render_plane_direct<P.fine_side>(fixed_profile<P>{}, p, t, filter::aniso, drawn));
        const verdict v = verify_aniso(p, t, P, bits, drawn.pixels.data(), width, height);
        assert_true(v.pixels > 5000);
        if (v.failures != 0) fail_msg("plane %d, map %d: %d of %d pixels, first (%d, %d)", k, int(n), int(v.failures), int(v.pixels), v.first_x, v.first_y);
      }
}

SPANTEX_CASE(aniso_of_exact_conforms_at_8_subtexel_and_8_level_bits) { every_row_conforms<profiles::exact>({8, 8, 1}); }
SPANTEX_CASE(aniso_of_default_conforms_at_7_subtexel_and_8_level_bits) { every_row_conforms<profiles::standard>({7, 8, 1}); }

// A level off by one, 2 samples at most instead of 16, half a pixel aside, one sample, squares. Channel by channel it sees less than the other verifier.
SPANTEX_CASE(the_verifier_of_rows_refuses_wrong_pictures) {
  const texture_view t = photographic_map(512, 300).view(wrap::repeat, wrap::repeat);
  const plane right = small_plane(2);
  profile coarser = profiles::exact, fewer = profiles::exact;
  coarser.level_bias = 16;
  fewer.max_samples = 2;
  plane aside = right;
  aside.u.c += aside.u.x;
  const auto failing = [&](const profile& q, const plane& p, filter kind) {
    drawn.reset(width, height);
    if (render_plane_direct<32>(run_time_profile{q}, p, t, kind, drawn) != status::ok) std::abort();
    const verdict v = verify_aniso(right, t, profiles::exact, {8, 8, 1}, drawn.pixels.data(), width, height);
    return double(v.failures) / double(v.pixels);
  };
  assert_true(failing(profiles::exact, right, filter::aniso) == 0);
  const double wrong[] = {failing(coarser, right, filter::aniso), failing(fewer, right, filter::aniso), failing(profiles::exact, aside, filter::aniso),
                          failing(profiles::exact, right, filter::trilinear), failing(profiles::exact, right, filter::squares)};
  for (const double share : wrong) std::printf("# %.1f %% of the pixels refused\n", 100 * share);
  for (const double share : wrong) assert_true(share > 0.1);
}

// A verifier that accepts anything proves nothing.
SPANTEX_CASE(the_verifier_refuses_wrong_pictures) {
  const texture_view t = photographic_map(64, 64).view(wrap::repeat, wrap::repeat);
  const plane right = close_plane(1);
  plane shifted = right;
  shifted.u.c += shifted.w.c >> 5;  // 1/32 texel where W is that of the origin
  drawn.reset(width, height);
  for (filter kind : {filter::bilinear, filter::three_point, filter::trilinear}) {
    SPANTEX_ASSERT_OK(render_plane_direct<32>(fixed_profile<profiles::exact>{}, shifted, t, kind, drawn));
    const verdict v = verify_plane(right, t, kind, profiles::exact, {8, 8, 1}, drawn.pixels.data(), width, height);
    assert_true(v.failures > v.pixels / 100);
  }
  profile coarse = profiles::exact, biased = profiles::exact;
  coarse.subtexel_bits = 5;
  biased.level_bias = 1;
  for (const auto& [q, kind] : {std::pair{coarse, filter::bilinear}, std::pair{biased, filter::trilinear}}) {
    SPANTEX_ASSERT_OK(render_plane_direct<32>(run_time_profile{q}, right, t, kind, drawn));
    assert_true(verify_plane(right, t, kind, profiles::exact, {8, 8, 1}, drawn.pixels.data(), width, height).failures > 0);
  }
}

// Texels that lie elsewhere: another wrap mode, a map one texel to the side, a format's neighbouring colour.
SPANTEX_CASE(the_verifier_refuses_wrong_texels) {
  const synthetic_map &map = photographic_map(60, 33),
                      &aside = make_map(60, 33, [&](int32_t x, int32_t y) { return map.levels[0].at((x + 1) % 60, y); });
  const synthetic_map& brighter = make_map(60, 33, [&](int32_t x, int32_t y) {
    rgba8 c = map.levels[0].at(x, y);
    c.g = uint8_t(c.g < 253 ? c.g + 3 : c.g - 3);
    return c;
  });
  const auto refused = [](const texture_view& judged, const texture_view& used, filter kind) {
    drawn.reset(width, height);
    if (render_plane_direct<32>(fixed_profile<profiles::exact>{}, close_plane(1), used, kind, drawn) != status::ok) std::abort();
    const verdict v = verify_plane(close_plane(1), judged, kind, profiles::exact, {8, 8, 1}, drawn.pixels.data(), width, height);
    return v.failures > v.pixels / 10;
  };
  for (const filter kind : one_sample_filters) {
    const texture_view right = map.view(wrap::repeat, wrap::mirror);
    assert_false(refused(right, right, kind));
    assert_true(refused(right, map.view(wrap::mirror, wrap::mirror), kind));
    assert_true(refused(right, map.view(wrap::repeat, wrap::clamp), kind));
    assert_true(refused(right, aside.view(wrap::repeat, wrap::mirror), kind));
    assert_true(refused(right, brighter.view(wrap::repeat, wrap::mirror), kind));
  }
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(exact_conforms_at_8_subtexel_and_8_level_bits),
      cmocka_unit_test(default_conforms_at_7_subtexel_and_8_level_bits),
      cmocka_unit_test(exact_conforms_for_every_size_of_map),
      cmocka_unit_test(default_conforms_for_every_size_of_map),
      cmocka_unit_test(exact_conforms_for_16_bit_maps),
      cmocka_unit_test(default_conforms_for_16_bit_maps),
      cmocka_unit_test(aniso_of_exact_conforms_at_8_subtexel_and_8_level_bits),
      cmocka_unit_test(aniso_of_default_conforms_at_7_subtexel_and_8_level_bits),
      cmocka_unit_test(the_verifier_of_rows_refuses_wrong_pictures),
      cmocka_unit_test(the_verifier_refuses_wrong_pictures),
      cmocka_unit_test(the_verifier_refuses_wrong_texels),
  };
  return run_suite("conformance", tests);
}
