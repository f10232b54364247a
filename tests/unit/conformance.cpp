// SPDX-License-Identifier: Apache-2.0
// Every pixel of every filter, wrap mode and map size is one that the promised precision can produce (sim/verifier.hpp): exact at 8
// sub-texel and 8 level bits, default at 7 and 6, both within one unit of colour. No pixel may fail. And the verifier itself refuses
// pictures that are wrong by more than that.
#include "tests/support.hpp"

#include "sim/verifier.hpp"

using namespace spantex;
using namespace spantex::sim;

namespace {

constexpr int32_t width = 160, height = 120;

// The sample planes of 640 x 480 seen through a quarter of the pixels per side: the same view, four times the minification.
plane small_plane(int k) {
  homography m = sample_homography(k);
  for (wide* c : {&m.a, &m.b, &m.d, &m.e, &m.g, &m.h}) *c = *c + *c + *c + *c;
  plane p{};
  if (make_plane(m, {0, 0, width, height}, p) != status::ok) std::abort();
  return p;
}

// The sample planes close up: the middle of the picture at one pixel per pixel.
plane close_plane(int k) {
  homography m = sample_homography(k);
  m.c = m.c + multiply(m.a, 240) + multiply(m.b, 200);
  m.f = m.f + multiply(m.d, 240) + multiply(m.e, 200);
  m.i = m.i + multiply(m.g, 240) + multiply(m.h, 200);
  plane p{};
  if (make_plane(m, {0, 0, width, height}, p) != status::ok) std::abort();
  return p;
}

picture drawn;

template <profile P>
uint64_t failures(const plane& map, const texture_view& t, filter kind, const promised_precision& bits) {
  drawn.reset(width, height);
  if (render_plane_direct<P.fine_side>(fixed_profile<P>{}, map, t, kind, drawn) != status::ok) std::abort();
  const verdict v = verify_plane(map, t, kind, bits, drawn.pixels.data(), width, height);
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
      for (filter kind : all_filters)
        for (wrap mode : all_wraps) {
          assert_int_equal(failures<P>(small_plane(k), m->view(mode, mode), kind, bits), 0);
          assert_int_equal(failures<P>(close_plane(k), m->view(mode, mode), kind, bits), 0);
        }
}

}  // namespace

SPANTEX_CASE(exact_conforms_at_8_subtexel_and_8_level_bits) { every_pixel_conforms<profiles::exact>({8, 8, 1}); }
SPANTEX_CASE(default_conforms_at_7_subtexel_and_6_level_bits) { every_pixel_conforms<profiles::standard>({7, 6, 1}); }
SPANTEX_CASE(exact_conforms_with_half_a_unit_and_a_bit_for_rounding) { every_pixel_conforms<profiles::exact>({8, 8, 0.51}); }

// A verifier that accepts anything proves nothing.
SPANTEX_CASE(the_verifier_refuses_wrong_pictures) {
  const texture_view t = photographic_map(64, 64).view(wrap::repeat, wrap::repeat);
  const plane right = close_plane(1);
  plane shifted = right;
  shifted.u.c += shifted.w.c >> 5;  // 1/32 texel where W is that of the origin
  drawn.reset(width, height);
  for (filter kind : {filter::bilinear, filter::three_point, filter::trilinear}) {
    SPANTEX_ASSERT_OK(render_plane_direct<32>(fixed_profile<profiles::exact>{}, shifted, t, kind, drawn));
    const verdict v = verify_plane(right, t, kind, {8, 8, 1}, drawn.pixels.data(), width, height);
    assert_true(v.failures > v.pixels / 100);
  }
  constexpr profile coarse = [] { profile p = profiles::exact; p.subtexel_bits = 5; return p; }();
  SPANTEX_ASSERT_OK(render_plane_direct<32>(fixed_profile<coarse>{}, right, t, filter::bilinear, drawn));
  assert_true(verify_plane(right, t, filter::bilinear, {8, 8, 1}, drawn.pixels.data(), width, height).failures > 0);
  constexpr profile biased = [] { profile p = profiles::exact; p.level_bias = 1; return p; }();
  SPANTEX_ASSERT_OK(render_plane_direct<32>(fixed_profile<biased>{}, right, t, filter::trilinear, drawn));
  assert_true(verify_plane(right, t, filter::trilinear, {8, 8, 1}, drawn.pixels.data(), width, height).failures > 0);
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(exact_conforms_at_8_subtexel_and_8_level_bits),
      cmocka_unit_test(default_conforms_at_7_subtexel_and_6_level_bits),
      cmocka_unit_test(exact_conforms_with_half_a_unit_and_a_bit_for_rounding),
      cmocka_unit_test(the_verifier_refuses_wrong_pictures),
  };
  return run_suite("conformance", tests);
}
