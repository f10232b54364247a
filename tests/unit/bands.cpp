// SPDX-License-Identifier: Apache-2.0
// Bands of rows of spans that threads share.
#include <sim/draw_host.hpp>
#include <sim/figures.hpp>
#include <tests/support.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

// Higher ones for planes that a kernel plans as a whole, not for any others.
SPANTEX_CASE(bands_are_as_high_as_they_are_planned) {
  constexpr matrix scaled{0.73, 0, 11.3, 0, 0.61, 5.7, 0, 0, 1}, turned{0.8, -0.3, 100, 0.3, 0.8, 20, 0, 0, 1};
  const auto bands = [](const matrix& m, filter kind, kernels::choice kernel, int32_t rows, int threads) {
    scene s{"plane", {64, rows * span_side}, plane_maps(scene_request{}), {}};
    add_plane(s, m, 0);
    draw_options o;
    o.kind = kind;
    o.kernel = kernel;
    o.threads = threads;
    return draw(s, o).machines;
  };
  using kernels::choice;
  assert_int_equal(bands(scaled, filter::bilinear, choice::words, 40, 2), 2);
  assert_int_equal(bands(scaled, filter::bilinear, choice::words, 40, 40), 10);
  assert_int_equal(bands(scaled, filter::bilinear, choice::words, 7, 2), 1);
  assert_int_equal(bands(turned, filter::bilinear, choice::words, 7, 2), 7);
  assert_int_equal(bands(scaled, filter::aniso, choice::words, 7, 2), 7);
  assert_int_equal(bands(scaled, filter::bilinear, choice::scalar, 7, 2), 7);
  assert_int_equal(bands(turned, filter::bilinear, choice::scalar, 40, 2), 32);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(bands_are_as_high_as_they_are_planned),
  };
  return run_suite("bands", tests);
}
