// SPDX-License-Identifier: Apache-2.0
// Bands of rows of spans that threads share, and the threads.
#include <atomic>
#include <barrier>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

#include <sim/draw_host.hpp>
#include <sim/figures.hpp>
#include <sim/parallel.hpp>
#include <sim/unchanged.hpp>
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
  assert_int_equal(bands(turned, filter::bilinear, choice::words, 7, 2), 6);
  assert_int_equal(bands(scaled, filter::bilinear, choice::pixels, 7, 2), 6);
  assert_int_equal(bands(scaled, filter::aniso, choice::words, 7, 2), 6);
  assert_int_equal(bands(scaled, filter::bilinear, choice::scalar, 7, 2), 6);  // 1, 1, 1 and 2, 1, 1
  assert_int_equal(bands(turned, filter::bilinear, choice::scalar, 40, 2), 16);  // of twenty rows 10, 3, 2, 1, 1, 1, 1, 1
  assert_int_equal(bands(turned, filter::bilinear, choice::scalar, 40, 4), 28);  // of ten 2, 2, 2, 1, 1, 1, 1
}

// As many parts are told as were announced, whatever is left out.
SPANTEX_CASE(parts_add_up) {
  scene_request r;
  r.size = {67, 197};
  const scene cubes = make_named_scene("fig8", r), plane = make_named_scene("tilted", r);
  for (const scene* s : {&cubes, &plane})
    for (const cull culled : {cull::none, cull::clockwise, cull::counterclockwise})
      for (const kernels::choice kernel : {kernels::choice::scalar, kernels::choice::fastest})
        for (const int threads : {1, 2, 3}) {
          std::atomic<int> parts{0};
          draw_options o;
          o.culled = culled;
          o.kernel = kernel;
          o.threads = threads;
          o.repeat = 2;
          o.parts_done = [&](int n) { parts += n; };
          const draw_result drawn = draw(*s, o);
          assert_int_equal(parts.load(), draw_parts(*s, o));
          assert_true((drawn.polygons_culled > 0) == (s == &cubes && culled != cull::none));
        }
}

scene cubes() {
  scene_request r;
  r.size = {67, 197};
  return make_named_scene("fig8", r);
}

// Three times over, by one to four threads. Every band is cleared, its depths too: nothing of the picture before is left.
void draw_again(const scene& s, draw_options o) {
  const draw_result once = draw(s, o);
  o.repeat = 3;
  for (o.threads = 1; o.threads <= 4; ++o.threads) {
    const draw_result again = draw(s, o);
    assert_true(once.picture.pixels == again.picture.pixels);
    assert_int_equal(once.work.pixels, again.work.pixels);
    assert_int_equal(once.work.spans_total, again.work.spans_total);
    assert_int_equal(once.work.spans_empty, again.work.spans_empty);
    assert_int_equal(once.work.spans_hidden, again.work.spans_hidden);
    assert_int_equal(once.skipped.spans_outside, again.skipped.spans_outside);
    assert_int_equal(once.skipped.spans_below_floor, again.skipped.spans_below_floor);
  }
}

SPANTEX_CASE(drawn_again_is_the_same) {
  for (const alpha_mode alpha : {alpha_mode::opaque, alpha_mode::blended}) {
    draw_options o;
    o.how.alpha = alpha;
    o.how.colour = {255, 255, 255, 128};
    o.kernel = kernels::choice::scalar;
    draw_again(cubes(), o);
    const image by_engine = draw(cubes(), o).picture;
    o.kernel = kernels::choice::fastest;
    draw_again(cubes(), o);
    assert_true(draw(cubes(), o).picture.pixels == by_engine.pixels);
  }
}

// Bands have the items that lie in them alone, but the engine counts what it leaves out of all.
SPANTEX_CASE(polygons_by_threads_are_the_same) {
  for (const kernels::choice kernel : {kernels::choice::scalar, kernels::choice::words, kernels::choice::fastest})
    for (const skip_set skips : {usual_skips, usual_skips & ~only(skip::outside)}) {
      draw_options o;
      o.kernel = kernel;
      o.skips = skips;
      draw_again(cubes(), o);
    }
}

// A kernel's maps, whoever asks.
SPANTEX_CASE(maps_are_made_ready_once) {
  scene_request r;
  r.size = {67, 45};
  const scene s = make_named_scene("turning", r);
  draw_options by_engine;
  by_engine.kernel = kernels::choice::scalar;
  const image expected = draw(s, by_engine).picture;
  const texture_map& map = s.map_of(s.items.front());
  const kernels::planar_map* const first = &map.planar(kernels::layout::rows_and_blocks);
  std::atomic<int> differ{0};
  for_each_index(8, 4, [&](int k) {
    draw_options o;
    o.kernel = k % 2 == 0 ? kernels::choice::words : kernels::choice::fastest;
    differ += draw(s, o).picture.pixels != expected.pixels;
    map.planar(kernels::layout(k % 3));
  });
  assert_int_equal(differ.load(), 0);
  assert_ptr_equal(&map.planar(kernels::layout::rows_and_blocks), first);
}

// Of spans that are not kept, too.
SPANTEX_CASE(frames_drawn_again_are_the_same) {
  scene_request r;
  r.size = {67, 45};
  const scene first = make_named_scene("turning", r);
  r.turn_degrees = 7;
  const scene second = make_named_scene("turning", r);
  for (const int threads : {1, 2}) {
    frame_before of_one, of_three;
    draw_options o;
    o.kernel = kernels::choice::scalar;
    o.threads = threads;
    draw(first, o, &of_one);
    draw(first, o, &of_three);
    const draw_result once = draw(second, o, &of_one);
    o.repeat = 3;
    const draw_result again = draw(second, o, &of_three);
    assert_true(once.spans_unchanged > 0 && once.work.pixels > 0);
    assert_true(once.picture.pixels == again.picture.pixels);
    assert_int_equal(once.work.pixels, again.work.pixels);
    assert_int_equal(once.work.spans_hidden, again.work.spans_hidden);
    assert_int_equal(once.skipped.spans_below_floor, again.skipped.spans_below_floor);
  }
}

std::vector<int> equal_shares(int count, int threads) {
  std::vector<int> starts;
  for (int k = 0; k <= threads; ++k) starts.push_back(count * k / threads);
  return starts;
}

// Each once, whatever the number of threads; what fails is told.
SPANTEX_CASE(a_team_does_everything_once) {
  for (const int threads : {1, 2, 3, 7}) {
    thread_team team(threads);
    for (const int count : {0, 1, 2, 5, 6, 7, 8, 100, 1000}) {
      std::vector<std::atomic<int>> times(static_cast<size_t>(count));
      team.run(count, [&](int k) { ++times[size_t(k)]; });
      team.run_by_shares(equal_shares(count, threads), [&](int k, int) { ++times[size_t(k)]; });
      for (const std::atomic<int>& t : times) assert_int_equal(t.load(), 2);
    }
    std::atomic<int> done{0};
    std::atomic<bool> failed{false};
    bool told = false;
    try {
      team.run(1000, [&](int k) {
        if (k == 0) {
          failed = true;
          throw std::runtime_error("0");
        }
        while (!failed) std::this_thread::yield();
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        ++done;
      });
    } catch (const std::runtime_error&) {
      told = true;
    }
    assert_true(told);
    assert_true(done < 999);
    done = 1;
    team.run(1, [&](int) { done = 0; });
    assert_int_equal(done.load(), 0);
  }
}

// In order, by whoever is free.
SPANTEX_CASE(a_team_works_in_order) {
  constexpr int threads = 4, each = 25;
  thread_team team(threads);
  std::atomic<int> round[threads * each];
  std::atomic<int> begun{0};
  std::barrier in_step(threads);
  team.run(threads * each, [&](int k) {
    round[k] = begun++ / threads;
    in_step.arrive_and_wait();
  });
  for (int k = 0; k < threads * each; ++k) assert_int_equal(round[k].load(), k / threads);
}

SPANTEX_CASE(threads_keep_their_shares) {
  constexpr int threads = 4, each = 3;
  thread_team team(threads);
  std::thread::id by[2][threads * each];
  for (auto& now : by) {
    std::barrier in_step(threads);  // so that nobody has time to help
    team.run_by_shares(equal_shares(threads * each, threads), [&](int k, int) {
      now[k] = std::this_thread::get_id();
      in_step.arrive_and_wait();
    });
  }
  for (int k = 0; k < threads * each; ++k) {
    assert_true(by[0][k] == by[1][k]);
    assert_true(by[0][k] == by[0][k / each * each]);
    if (k >= each) assert_true(by[0][k] != by[0][k - each]);
  }
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(bands_are_as_high_as_they_are_planned),
      cmocka_unit_test(parts_add_up),
      cmocka_unit_test(drawn_again_is_the_same),
      cmocka_unit_test(polygons_by_threads_are_the_same),
      cmocka_unit_test(maps_are_made_ready_once),
      cmocka_unit_test(frames_drawn_again_are_the_same),
      cmocka_unit_test(a_team_does_everything_once),
      cmocka_unit_test(a_team_works_in_order),
      cmocka_unit_test(threads_keep_their_shares),
  };
  return run_suite("bands", tests);
}
