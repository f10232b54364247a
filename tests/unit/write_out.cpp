// SPDX-License-Identifier: Apache-2.0
// Write-out of what host kernels draw: alpha and colours, the same pixels, depths and counts as the scalar engine's.
#include <tests/kernel_pictures.hpp>

namespace {

using shaded_engine = direct_engine<prof, prof::max_fine_side>;
using shaded_renderer = renderer<shaded_engine, prof, shading, uncounted_reads, fixed_skips<usual_skips>>;

// Every way of write-out and several colours, with maps whose alpha varies, is 255, is 0 or 255.
template <class Draw>
void each_shading(Draw draw) {
  const synthetic_map& varied = random_map(128, 64);
  const auto with_alpha = [&](auto alpha) -> const synthetic_map& {
    return make_map(64, 64, [&](int32_t x, int32_t y) {
      const rgba8 c = varied.levels[0].texels[size_t(y * 128 + x)];
      return rgba8{c.r, c.g, c.b, uint8_t(alpha(x, y))};
    });
  };
  const synthetic_map& solid = with_alpha([](int32_t, int32_t) { return 255; });
  const synthetic_map& holed = with_alpha([](int32_t x, int32_t y) { return (x / 16 + y / 16) % 2 * 255; });
  for (const synthetic_map* map : {&varied, &solid, &holed}) {
    ready_map ready(*map, wrap::mirror);
    ready.view.set_facts({map == &solid, 0});
    for (const alpha_mode alpha : {alpha_mode::opaque, alpha_mode::cut_out, alpha_mode::blended, alpha_mode::premultiplied})
      for (const rgba8 colour : {white, rgba8{255, 255, 255, 200}, rgba8{1, 128, 254, 255}})
        draw(ready, shading{alpha, uint8_t(colour.a == 200 ? 60 : 128), colour, nullptr});
  }
}

// A frame whose rows lie further apart than its width.
frame_buffer within(picture& wider) {
  frame_buffer f = wider.frame();
  f.width = scene_width;
  return f;
}

// What lies under the picture.
void lay_background(picture& under) {
  random_source random(5);
  for (rgba8& p : under.pixels) {
    const uint64_t n = random.next();
    p = {uint8_t(n), uint8_t(n >> 8), uint8_t(n >> 16), uint8_t(n >> 24)};
  }
}

// By the engine, then by every kernel: the same pixels, depths and counts.
template <class ByEngine, class ByKernel>
void same_write_out(filter kind, ByEngine by_engine_draws, ByKernel by_kernel_draws) {
  by_scalar.reset(scene_width + 5, scene_height);
  lay_background(by_scalar);
  shaded_engine engine;
  shaded_renderer r(engine, prof{}, within(by_scalar));
  depths by_engine;
  by_engine_draws(r, by_engine);
  SPANTEX_ASSERT_OK(r.finish());
  for (const named_kernel& k : every_kernel) {
    if (kernels::kernel_of(k.which) == nullptr) continue;
    by_kernel.reset(scene_width + 5, scene_height);
    lay_background(by_kernel);
    shaded_engine other;
    shaded_renderer rest(other, prof{}, within(by_kernel));
    depths own;
    draw_counters counts;
    by_kernel_draws(k, rest, own, counts);
    if (by_kernel.pixels != by_scalar.pixels) fail_msg("%s, filter %d: not the engine's bytes", k.name, int(kind));
    assert_true(own.values == by_engine.values);
    assert_int_equal(counts.pixels, r.counters().pixels);
    assert_int_equal(counts.pixels_left, r.counters().pixels_left);
    assert_int_equal(counts.pixels_blended, r.counters().pixels_blended);
  }
}

SPANTEX_CASE(planes_are_written_out_as_the_engine_does) {
  const rectangle all{0, 0, scene_width, scene_height}, part{3, 5, 61, 44};
  each_shading([&](const ready_map& map, const shading& how) {
    for (const filter kind : filters)
      for (const plane& p : {sample_plane(1), plane_to_the_horizon(all), upright_plane(0, 0, 1, 1, all), upright_plane(0.3, 7, 0.4, 1.7, all)})
        for (const rectangle area : {all, part})
          same_write_out(
              kind, [&](shaded_renderer& r, depths&) { SPANTEX_ASSERT_OK(r.draw(p, map.view, kind, area, how)); },
              [&](const named_kernel& k, shaded_renderer& rest, depths&, draw_counters& counts) {
                SPANTEX_ASSERT_OK(kernels::draw_plane(kernels::kernel_of(k.which), map.of(k.which), rest, p, map.view, kind, area, within(by_kernel), counts, how));
              });
  });
}

SPANTEX_CASE(polygons_are_written_out_as_the_engine_does) {
  const rgba8 corners[3] = {{255, 0, 90, 255}, {0, 200, 255, 128}, {30, 255, 0, 0}};
  int varied = 0;
  each_shading([&](const ready_map& map, const shading& flat) {
    for (const filter kind : {filter::nearest, filter::trilinear})
      for (const bool leaves : {false, true})  // every other polygon pixel by pixel
        for (const bool varies : {false, true}) {
          const auto with_colours = [&](const auto& draw) {
            each_triangle([&](const polygon& p, const colour_forms& forms) {
              shading how = flat;
              if (varies) how.colours = &forms;
              varied += varies;
              return draw(p, how);
            }, 40, corners);
          };
          same_write_out(
              kind, [&](shaded_renderer& r, depths& d) { with_colours([&](const polygon& p, const shading& how) { return r.draw(p, map.view, kind, d.buffer(), how); }); },
              [&](const named_kernel& k, shaded_renderer& rest, depths& d, draw_counters& counts) {
                int n = 0;
                with_colours([&](const polygon& p, const shading& how) {
                  return kernels::draw_polygon(leaves && n++ % 2 == 0 ? kernels::leave_to_pixels : kernels::kernel_of(k.which), kernels::cover_of(k.which), map.of(k.which), rest, p, map.view, kind, p.box,
                                               d.buffer(), within(by_kernel), counts, how);
                });
              });
        }
  });
  assert_true(varied > 1000);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(planes_are_written_out_as_the_engine_does),
      cmocka_unit_test(polygons_are_written_out_as_the_engine_does),
  };
  return run_suite("write_out", tests);
}
