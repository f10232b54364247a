// SPDX-License-Identifier: Apache-2.0
// What one integer level a span and the clamp cost at span borders in profile seed: how much steps between neighbouring pixels differ from
// those of the same word lengths with per-pixel levels and sections that hold everything, across span borders and inside spans.
// default has no such difference from exact. The numbers are quoted in docs/ACCURACY.md.
#include "tests/support.hpp"

#include <cstdlib>

using namespace spantex;
using namespace spantex::sim;

namespace {

constexpr int32_t width = 640, height = 480;
picture judged, ideal;

struct step_error { double across = 0, inside = 0; };

// Mean | step of one picture - step of the other | between horizontal neighbours, red channel.
step_error step_errors() {
  double across = 0, inside = 0;
  int64_t border_count = 0, inner_count = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x + 1 < width; ++x) {
      const size_t k = size_t(y * width + x);
      const int step = (judged.pixels[k + 1].r - judged.pixels[k].r) - (ideal.pixels[k + 1].r - ideal.pixels[k].r);
      const bool border = x % span_side == span_side - 1;
      (border ? across : inside) += std::abs(step);
      ++(border ? border_count : inner_count);
    }
  return {across / double(border_count), inside / double(inner_count)};
}

template <profile P, profile Ideal>
step_error against(int plane_index, filter kind) {
  const texture_view t = photographic_map(512, 512).view(wrap::repeat, wrap::repeat);
  const plane p = sample_plane(plane_index);
  judged.reset(width, height);
  ideal.reset(width, height);
  SPANTEX_ASSERT_OK(render_plane_direct<P.fine_side>(fixed_profile<P>{}, p, t, kind, judged));
  SPANTEX_ASSERT_OK(render_plane_direct<Ideal.fine_side>(fixed_profile<Ideal>{}, p, t, kind, ideal));
  return step_errors();
}

constexpr int tilted = 1, grazing = 2;
constexpr profile seed_without_spans = [] {
  profile p = profiles::seed;
  p.overflow = overflow_policy::split;
  p.scope = level_scope::pixel;
  return p;
}();
constexpr profile seed_without_clamp = [] {
  profile p = profiles::seed;
  p.overflow = overflow_policy::split;
  return p;
}();

// exact with the weights and colours of default: what is left is due to its spans.
constexpr profile exact_of_default = [] {
  profile p = profiles::exact;
  p.subtexel_bits = profiles::standard.subtexel_bits;
  p.blend_bits = profiles::standard.blend_bits;
  return p;
}();

}  // namespace

SPANTEX_CASE(seed_shows_its_spans) {
  for (int k : {tilted, grazing}) {
    const step_error level = against<seed_without_clamp, seed_without_spans>(k, filter::trilinear);
    const step_error both = against<profiles::seed, seed_without_spans>(k, filter::trilinear);
    std::fprintf(stderr, "# plane %d, one level a span: %.3f units across span borders, %.3f inside; with the clamp: %.3f, %.3f\n", k,
                 level.across, level.inside, both.across, both.inside);
    assert_true(level.across < 0.1 && level.inside < 0.1);
    assert_true(both.across > 2 * both.inside && both.across > level.across);
  }
}

SPANTEX_CASE(default_does_not) {
  for (int k : {tilted, grazing}) {
    const step_error e = against<profiles::standard, exact_of_default>(k, filter::trilinear);
    std::fprintf(stderr, "# default, plane %d: %.3f units across span borders, %.3f inside\n", k, e.across, e.inside);
    assert_true(e.across < 0.02 && e.inside < 0.02);
  }
}

int main() {
  const CMUnitTest tests[] = {cmocka_unit_test(seed_shows_its_spans), cmocka_unit_test(default_does_not)};
  return run_suite("block_artefacts", tests);
}
