// SPDX-License-Identifier: Apache-2.0
// A mirrored scene gives the mirrored picture: exactly for a mirrored screen; up to one step of a weight (ties of the snapping go up)
// for a mirrored map.
#include "tests/support.hpp"

using namespace spantex;
using namespace spantex::sim;

namespace {

constexpr int32_t width = 160, height = 128;

homography view_of(int k) {
  homography m = sample_homography(k);
  for (wide* c : {&m.a, &m.b, &m.d, &m.e, &m.g, &m.h}) *c = *c + *c + *c;
  return m;
}

// x -> width - x, y -> height - y.
homography mirrored_x(homography m) {
  for (auto [slope, constant] : {std::pair{&m.a, &m.c}, {&m.d, &m.f}, {&m.g, &m.i}}) {
    *constant = *constant + multiply(*slope, width);
    *slope = -*slope;
  }
  return m;
}
homography mirrored_y(homography m) {
  for (auto [slope, constant] : {std::pair{&m.b, &m.c}, {&m.e, &m.f}, {&m.h, &m.i}}) {
    *constant = *constant + multiply(*slope, height);
    *slope = -*slope;
  }
  return m;
}
// u -> side - u
homography mirrored_u(homography m, int32_t side) {
  m.a = multiply(m.g, side) - m.a;
  m.b = multiply(m.h, side) - m.b;
  m.c = multiply(m.i, side) - m.c;
  return m;
}

picture straight, mirrored;

template <profile P>
void draw_into(picture& out, const homography& m, const texture_view& t, filter kind) {
  plane p{};
  SPANTEX_ASSERT_OK(make_plane(m, {0, 0, width, height}, p));
  out.reset(width, height);
  SPANTEX_ASSERT_OK(render_plane_direct<P.fine_side>(fixed_profile<P>{}, p, t, kind, out));
}

rgba8 at(const picture& p, int x, int y) { return p.pixels[size_t(y * width + x)]; }

template <profile P>
void screen_mirrors_exactly() {
  const texture_view t = photographic_map(64, 48).view(wrap::mirror, wrap::repeat);
  for (int k = 0; k < sample_plane_count; ++k)
    for (filter kind : all_filters) {
      draw_into<P>(straight, view_of(k), t, kind);
      draw_into<P>(mirrored, mirrored_x(view_of(k)), t, kind);
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) assert_true(at(straight, x, y) == at(mirrored, width - 1 - x, y));
      draw_into<P>(mirrored, mirrored_y(view_of(k)), t, kind);
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) assert_true(at(straight, x, y) == at(mirrored, x, height - 1 - y));
    }
}

int step(rgba8 a, rgba8 b) {
  int worst = 0;
  for (uint8_t rgba8::*c : {&rgba8::r, &rgba8::g, &rgba8::b, &rgba8::a}) worst = std::max(worst, std::abs(a.*c - b.*c));
  return worst;
}

}  // namespace

SPANTEX_CASE(mirrored_screen_is_exact_in_seed) { screen_mirrors_exactly<profiles::seed>(); }
SPANTEX_CASE(mirrored_screen_is_exact_in_compact) { screen_mirrors_exactly<profiles::compact>(); }
SPANTEX_CASE(mirrored_screen_is_exact_in_default) { screen_mirrors_exactly<profiles::standard>(); }
SPANTEX_CASE(mirrored_screen_is_exact_in_exact) { screen_mirrors_exactly<profiles::exact>(); }

SPANTEX_CASE(mirrored_map_differs_by_one_weight_step_at_most) {
  constexpr int32_t side = 64;
  const synthetic_map& map = photographic_map(side, side);
  const synthetic_map& flipped = make_map(side, side, [&](int32_t x, int32_t y) { return map.levels[0].at(side - 1 - x, y); });
  for (int k = 0; k < sample_plane_count; ++k)
    for (filter kind : {filter::bilinear, filter::trilinear}) {
      draw_into<profiles::exact>(straight, view_of(k), map.view(wrap::repeat, wrap::repeat), kind);
      draw_into<profiles::exact>(mirrored, mirrored_u(view_of(k), side), flipped.view(wrap::repeat, wrap::repeat), kind);
      // A weight step moves a colour by at most 255/256 of a unit, so two roundings may differ by one unit; levels likewise.
      for (size_t n = 0; n < straight.pixels.size(); ++n) assert_true(step(straight.pixels[n], mirrored.pixels[n]) <= 2);
    }
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(mirrored_screen_is_exact_in_seed),
      cmocka_unit_test(mirrored_screen_is_exact_in_compact),
      cmocka_unit_test(mirrored_screen_is_exact_in_default),
      cmocka_unit_test(mirrored_screen_is_exact_in_exact),
      cmocka_unit_test(mirrored_map_differs_by_one_weight_step_at_most),
  };
  return run_suite("symmetry", tests);
}
