// SPDX-License-Identifier: Apache-2.0
// GCK09's test: the chessboard to the horizon, four pictures: step and hat, each convolved on the screen in double precision and weighted
// on the map by the engine. The claim is that the second is as good as the first. Judges: a box of 64x64 samples of the board a pixel, and
// a Gaussian, because the box is step's own original.
#include <iostream>
#include <memory>
#include <string>

#include "tests/support.hpp"

#include "sim/draw_host.hpp"
#include "sim/figures.hpp"
#include "sim/parallel.hpp"
#include "sim/quality.hpp"
#include "sim/screen_filter.hpp"

using namespace spantex;
using namespace spantex::sim;

namespace {

constexpr screen_size whole{320, 240}, quarter{160, 120};  // other directions of the board at a quarter of the pixels
constexpr rgba8 background{0, 0, 0, 255};
constexpr int kernel_samples = 32, judge_samples = 64, gauss_samples = 32;

scene board(screen_size size, double turn_degrees) {
  scene_request r;
  r.size = size;
  r.turn_degrees = turn_degrees;
  return make_named_scene("chessboard", r);
}

ideal_image convolved(const scene& s, screen_kernel kernel, int samples, kernel_plane on = kernel_plane::screen) {
  const auto map = [](double u, double v) { return chessboard_at(u, v, chessboard_texels); };
  return filter_on_screen(s.items[0].plane_matrix, s.size, map, kernel, on, samples, background, hardware_threads());
}

image on_map(const scene& s, filter kind, profile_choice p) {
  draw_options o;
  o.kind = kind;
  o.profile = p;
  o.background = background;
  return draw(s, o).picture;
}

struct judges { ideal_image box, gauss; };
struct marks { double box_db, gauss_db; };
marks judged(const image& picture, const judges& by) { return {psnr_db(picture, by.box), psnr_db(picture, by.gauss)}; }

void print(const char* what, const marks& m) { std::printf("#   %-22s %6.2f %6.2f\n", what, m.box_db, m.gauss_db); }

// Pictures are owned by statics: a failing assertion leaves by longjmp.
struct experiment {
  scene drawn;
  judges by;
  marks step, hat;  // of the originals
};
std::unique_ptr<experiment> at(screen_size size, double turn_degrees) {
  auto e = std::make_unique<experiment>();
  e->drawn = board(size, turn_degrees);
  e->by = {convolved(e->drawn, screen_kernel::step, judge_samples), convolved(e->drawn, screen_kernel::gauss, gauss_samples)};
  e->step = judged(rounded(convolved(e->drawn, screen_kernel::step, kernel_samples)), e->by);
  e->hat = judged(rounded(convolved(e->drawn, screen_kernel::hat, kernel_samples)), e->by);
  std::printf("# turned by %g degrees           box  gauss\n", 25 + turn_degrees);
  print("step on the screen", e->step);
  print("hat on the screen", e->hat);
  if (size.width_px != whole.width_px) return e;
  for (const screen_kernel k : {screen_kernel::step, screen_kernel::hat})
    print(k == screen_kernel::step ? "step on the map, ideal" : "hat on the map, ideal",
          judged(rounded(convolved(e->drawn, k, kernel_samples, kernel_plane::map)), e->by));
  return e;
}

std::unique_ptr<experiment> current;

void check(screen_size size, double turn_degrees) {
  current = at(size, turn_degrees);
  for (const named<profile_choice>& p : profile_names) {
    const marks step = judged(on_map(current->drawn, filter::step, p.value), current->by);
    const marks hat = judged(on_map(current->drawn, filter::hat, p.value), current->by);
    print((std::string("step on the map, ") + std::string(p.name)).c_str(), step);
    print((std::string("hat on the map, ") + std::string(p.name)).c_str(), hat);
    assert_true(hat.box_db >= current->hat.box_db - 0.5);
    assert_true(step.gauss_db >= current->step.gauss_db - 0.5);
  }
}

}  // namespace

SPANTEX_CASE(on_the_map_is_as_good_as_on_the_screen) { check(whole, 0); }
SPANTEX_CASE(on_the_map_is_as_good_as_on_the_screen_along_the_squares) { check(quarter, -25); }
SPANTEX_CASE(on_the_map_is_as_good_as_on_the_screen_along_the_diagonal) { check(quarter, 20); }

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(on_the_map_is_as_good_as_on_the_screen),
      cmocka_unit_test(on_the_map_is_as_good_as_on_the_screen_along_the_squares),
      cmocka_unit_test(on_the_map_is_as_good_as_on_the_screen_along_the_diagonal),
  };
  return run_suite("chessboard", tests);
}
