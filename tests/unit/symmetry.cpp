// SPDX-License-Identifier: Apache-2.0
// A mirrored scene gives the mirrored picture, for every profile, filter, texel format and pair of wrap modes (a mirrored map: filters of
// one sample).
//
// Mirrored screen: exactly, where the width (height) is whole spans; hat, whose hexagon has one of the screen's two diagonals, for a screen
// turned upside down.
// Mirrored map (u -> width - u): positions mirror but for ties, which are rounded up on either side: the two snapped positions add up to
// the level's last texel, or to one step of a weight more, and to that only within the coordinate bound of a tie. The level of detail is
// the same (but `compact` may raise one of the two where a tie decides whether the section fits). Where no tie is met the colours are the
// same, but for what is not symmetric by definition: the three-point filters' diagonal turns when one axis is mirrored (both axes: the same
// triangles), and the correction of `seed` (SPEC 8).
#include <tests/properties.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

constexpr int32_t width = 48, height = 40;
constexpr rectangle area{0, 0, width, height};

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
// u -> side - u, v -> side - v.
homography mirrored_u(homography m, int32_t side) {
  m.a = multiply(m.g, side) - m.a;
  m.b = multiply(m.h, side) - m.b;
  m.c = multiply(m.i, side) - m.c;
  return m;
}
homography mirrored_v(homography m, int32_t side) {
  m.d = multiply(m.g, side) - m.d;
  m.e = multiply(m.h, side) - m.e;
  m.f = multiply(m.i, side) - m.f;
  return m;
}

homography view_of(int k) { return shrunk(sample_homography(k), 12); }

template <class Use>
void for_each_map(Use use) {
  for (const texel_format format : plain_formats)
    for (const wrap u : all_wraps)
      for (const wrap v : all_wraps)
        if (!short_run() || u == v) use(format, u, v);
}

picture straight, mirrored;

template <class Prof>
void draw_into(const Prof& prof, picture& out, const plane& p, const texture_view& t, filter kind) {
  out.reset(width, height);
  SPANTEX_ASSERT_OK(render_plane_direct<Prof::max_fine_side>(prof, p, t, kind, out));
}

rgba8 at(const picture& p, int x, int y) { return p.pixels[size_t(y * width + x)]; }

template <profile P>
void screen_mirrors_exactly() {
  const fixed_profile<P> prof;
  for_each_map([&](texel_format format, wrap wrap_u, wrap wrap_v) {
    const texture_view t = in_format(photographic_map(64, 48, 7), format).view(wrap_u, wrap_v);
    for (int k = 0; k < sample_plane_count; ++k)
      for (const filter kind : all_filters) {
        draw_into(prof, straight, plane_of(view_of(k), width, height), t, kind);
        if (kind == filter::hat) {
          draw_into(prof, mirrored, plane_of(mirrored_x(mirrored_y(view_of(k))), width, height), t, kind);
          for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) assert_true(at(straight, x, y) == at(mirrored, width - 1 - x, height - 1 - y));
          continue;
        }
        draw_into(prof, mirrored, plane_of(mirrored_x(view_of(k)), width, height), t, kind);
        for (int y = 0; y < height; ++y)
          for (int x = 0; x < width; ++x) assert_true(at(straight, x, y) == at(mirrored, width - 1 - x, y));
        draw_into(prof, mirrored, plane_of(mirrored_y(view_of(k)), width, height), t, kind);
        for (int y = 0; y < height; ++y)
          for (int x = 0; x < width; ++x) assert_true(at(straight, x, y) == at(mirrored, x, height - 1 - y));
      }
  });
}

// --- the mirrored map -----------------------------------------------------------------------------------------

// A map and its three mirror images, made once.
struct mirror_images {
  const synthetic_map *map, *u, *v, *both;
};
mirror_images images_of(int32_t map_width, int32_t map_height) {
  const synthetic_map& map = photographic_map(map_width, map_height, 8);
  const level_pixels& base = map.levels[0];
  const auto image = [&](bool u, bool v) {
    return &make_map(map_width, map_height,
                     [&, u, v](int32_t x, int32_t y) { return base.at(u ? map_width - 1 - x : x, v ? map_height - 1 - y : y); });
  };
  return {&map, image(true, false), image(false, true), image(true, true)};
}

struct noted_source {
  pixel_source source;
  bool drawn;
};
noted_source sources[width * height];

// How the snapped positions of a pixel and of its image on one axis add up.
enum class sum_of { image, tie, neither };

// n + n' against the mirrored place of n, for `side` texels of the level; at and image_at: the rounded coordinates (16 fraction bits) of
// level 0. nearest: whole texels.
sum_of compare_axis(int32_t texel, uint32_t fraction, int32_t image_texel, uint32_t image_fraction, int32_t side, bool mirrors, int bits) {
  const int64_t n = (int64_t(texel) << bits) + fraction, image = (int64_t(image_texel) << bits) + image_fraction;
  if (!mirrors) return n == image ? sum_of::image : sum_of::neither;
  const int64_t excess = n + image - (int64_t(side - 1) << bits);
  // A tie goes up in both; and the floors of a series, which are no mirror images, move either of them by a part of the bound.
  return excess == 0 ? sum_of::image : excess == 1 || excess == -1 ? sum_of::tie : sum_of::neither;
}

// Is the exact position n/w size_level/size_0 - 1/2 (or n/w for nearest) within `reach` of a tie of its snapping to 2^-bits?
bool is_by_a_tie(int64_t n, int64_t w, int32_t side, int32_t side_0, int bits, bool is_nearest, long double reach) {
  const long double p = static_cast<long double>(n) / w * side / side_0;
  const long double steps = is_nearest ? p : std::ldexp(p, bits) - 0.5L;
  return std::fabs(steps - std::round(steps)) <= (is_nearest ? reach : std::ldexp(reach, bits));
}

struct tally {
  int64_t pixels = 0, ties = 0, ties_off = 0, levels_off = 0, skipped = 0;
};

struct axes {
  bool u, v;
};

// All that is compared between one pixel and its image. Counts; fails on what the rule does not allow.
template <class Prof>
void compare_pixel(const Prof& prof, const plane& p, const texture_view& t, filter kind, axes mirrors, int32_t x, int32_t y,
                   const pixel_source& a, const pixel_source& b, tally& out) {
  const profile& q = prof.get();
  const int32_t hx = 2 * x + 1, hy = 2 * y + 1;
  const int64_t w = p.w_at(hx, hy), nu = p.u_at(hx, hy), nv = p.v_at(hx, hy);
  if (!in_range(nu, w) || !in_range(nv, w)) return;
  ++out.pixels;
  assert_int_equal(a.detail, b.detail);
  if (a.level != b.level || a.two_levels != b.two_levels || a.fraction != b.fraction) {
    ++out.levels_off;
    return;
  }
  const bool is_nearest = kind == filter::nearest;
  const int bits = is_nearest ? 0 : q.subtexel_bits;
  const long double bound = static_cast<long double>(coordinate_bound(q, a.extent_log2)) / error_unit;
  bool is_tied = false;
  const auto check_axis = [&](const snapped_position& s, const snapped_position& image, int level, bool along_u) {
    const int32_t side = along_u ? t.width(level) : t.height(level), side_0 = along_u ? t.width() : t.height();
    const bool turns = along_u ? mirrors.u : mirrors.v;
    const sum_of sum = along_u ? compare_axis(s.u, s.fraction.u, image.u, image.fraction.u, side, turns, bits)
                               : compare_axis(s.v, s.fraction.v, image.v, image.fraction.v, side, turns, bits);
    if (sum == sum_of::image) return;
    if (sum == sum_of::neither) fail_msg("(%d, %d) level %d: more than a step off", int(x), int(y), level);
    is_tied = true;
    ++out.ties;
    const long double reach = std::ldexp(bound, -level) + std::ldexp(1.0L, -17 - level);
    if (!is_by_a_tie(along_u ? nu : nv, w, side, side_0, bits, is_nearest, reach)) ++out.ties_off;
  };
  for (const bool along_u : {true, false}) {
    check_axis(a.fine, b.fine, a.level, along_u);
    if (a.two_levels) check_axis(a.coarse, b.coarse, a.level + 1, along_u);
  }
  if (is_tied || a.corrected || b.corrected || (uses_three_points(kind) && mirrors.u != mirrors.v)) {
    ++out.skipped;
    return;
  }
  if (!(at(straight, x, y) == at(mirrored, x, y))) fail_msg("(%d, %d), filter %d: colours differ without a tie", int(x), int(y), int(kind));
}

template <profile P>
void map_mirrors_but_for_ties(const char* name) {
  const fixed_profile<P> prof;
  tally total;
  // Sides that halve exactly on every level: others round their ratio, and 2x2 means of an odd side are no mirror images.
  const mirror_images maps = images_of(64, 32);
  for_each_map([&](texel_format format, wrap wrap_u, wrap wrap_v) {
    for (int k = 0; k < sample_plane_count; ++k)
      for (const filter kind : one_sample_filters)
        for (const axes mirrors : {axes{true, false}, axes{false, true}, axes{true, true}}) {
          const homography m = view_of(k);
          const homography once = mirrors.u ? mirrored_u(m, 64) : m, image = mirrors.v ? mirrored_v(once, 32) : once;
          const synthetic_map& flipped = mirrors.u ? (mirrors.v ? *maps.both : *maps.u) : *maps.v;
          const plane p = plane_of(m, width, height), p_image = plane_of(image, width, height);
          const texture_view t = in_format(*maps.map, format).view(wrap_u, wrap_v),
                             t_image = in_format(flipped, format).view(wrap_u, wrap_v);
          draw_into(prof, straight, p, t, kind);
          draw_into(prof, mirrored, p_image, t_image, kind);
          for (noted_source& s : sources) s.drawn = false;
          each_source(prof, {&p, &t, kind}, area, [&](int32_t x, int32_t y, const pixel_source& s) { sources[y * width + x] = {s, true}; });
          each_source(prof, {&p_image, &t_image, kind}, area, [&](int32_t x, int32_t y, const pixel_source& s) {
            const noted_source& a = sources[y * width + x];
            assert_true(a.drawn);
            compare_pixel(prof, p, t, kind, mirrors, x, y, a.source, s, total);
          });
        }
  });
  std::printf("# %s: %lld pixels, %lld ties, %lld of them not by a tie, %lld with another level, %.1f %% not compared in colour\n", name,
              static_cast<long long>(total.pixels), static_cast<long long>(total.ties), static_cast<long long>(total.ties_off),
              static_cast<long long>(total.levels_off), 100.0 * double(total.skipped) / double(total.pixels));
  assert_int_equal(total.ties_off, 0);
  assert_true(total.levels_off == 0 || (P.overflow == overflow_policy::coarser && total.levels_off < total.pixels / 100));
  assert_true(total.ties > 0 && total.pixels > 100000);
}

}  // namespace

SPANTEX_CASE(mirrored_screen_is_exact_in_seed) { screen_mirrors_exactly<profiles::seed>(); }
SPANTEX_CASE(mirrored_screen_is_exact_in_compact) { screen_mirrors_exactly<profiles::compact>(); }
SPANTEX_CASE(mirrored_screen_is_exact_in_default) { screen_mirrors_exactly<profiles::standard>(); }
SPANTEX_CASE(mirrored_screen_is_exact_in_exact) { screen_mirrors_exactly<profiles::exact>(); }

SPANTEX_CASE(mirrored_map_differs_at_ties_only_in_seed) { map_mirrors_but_for_ties<profiles::seed>("seed"); }
SPANTEX_CASE(mirrored_map_differs_at_ties_only_in_compact) { map_mirrors_but_for_ties<profiles::compact>("compact"); }
SPANTEX_CASE(mirrored_map_differs_at_ties_only_in_default) { map_mirrors_but_for_ties<profiles::standard>("default"); }
SPANTEX_CASE(mirrored_map_differs_at_ties_only_in_exact) { map_mirrors_but_for_ties<profiles::exact>("exact"); }

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(mirrored_screen_is_exact_in_seed),
      cmocka_unit_test(mirrored_screen_is_exact_in_compact),
      cmocka_unit_test(mirrored_screen_is_exact_in_default),
      cmocka_unit_test(mirrored_screen_is_exact_in_exact),
      cmocka_unit_test(mirrored_map_differs_at_ties_only_in_seed),
      cmocka_unit_test(mirrored_map_differs_at_ties_only_in_compact),
      cmocka_unit_test(mirrored_map_differs_at_ties_only_in_default),
      cmocka_unit_test(mirrored_map_differs_at_ties_only_in_exact),
  };
  return run_suite("symmetry", tests);
}
