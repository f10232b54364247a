// SPDX-License-Identifier: Apache-2.0
// Halves that a loader fills beside the filter: the bytes of the other engines whatever the loader's pace, who is refused which half, loads
// that never end or fail, and the counts.
#include "tests/support.hpp"

#include <firmware/apps/picture_hashes.hpp>
#include <hal/loading_engine.hpp>
#include <hal/sim_engine.hpp>
#include <tests/late_loader.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

using seed = fixed_profile<profiles::seed>;
using halves = loading_halves<late_loader, 8>;
using engine_type = loading_engine<seed, late_loader>;
static_assert(fetching_engine<engine_type> && !fetching_engine<direct_engine<seed>>);

const rgba8 texels[8] = {{1, 2, 3, 4}, {5, 6, 7, 8}, {9, 10, 11, 12}, {13, 14, 15, 16}, {17, 18, 19, 20}, {21, 22, 23, 24}, {25, 26, 27, 28}, {29, 30, 31, 32}};

// A job on its way to the loader.
void submit(halves& h, half which) {
  SPANTEX_ASSERT_OK(h.load_texels(which, 0, texels, 8));
  h.coefficients_loaded(which);
  SPANTEX_ASSERT_OK(h.start(which));
  SPANTEX_ASSERT_OK(h.begin_loading(which));
}

app::scratch memory;

template <class Prof>
void same_pictures(const char* name) {
  static late_loader loader;
  static loading_engine<Prof, late_loader> engine(loader);
  static direct_engine<Prof> direct;
  static sim_engine<Prof> simulated;
  int n = 0;
  for (int what = 0; what < app::picture_count; ++what)
    for (int kind = 0; kind < app::filter_count; ++kind)
      for (const wrap mode : all_wraps)
        for (const bool odd : {false, true}) {
          const auto hash = [&](auto& e) { return app::hash_of<Prof>(app::picture(what), filter(kind), mode, odd, e, memory); };
          constexpr int paces[] = {0, 1, 7, 300, 100000};
          loader.delay = paces[n++ % 5];
          const uint32_t loaded = hash(engine), expected = hash(direct);
          if (expected == 0 || loaded != expected || hash(simulated) != expected)
            fail_msg("%s %s %s %s: not the direct engine's", name, app::name_of(app::picture(what)), app::name_of(filter(kind)), app::name_of(mode));
        }
  const loading_counters& c = engine.counters();
  assert_int_equal(engine.ownership().violation_count(), 0);
  assert_int_equal(c.loads, c.hidden + c.stalls);
  assert_true(c.hidden > 0 && c.stalls > 0 && c.beside > 0);
  assert_int_equal(c.loads, loader.starts);
  assert_int_equal(loader.stops, 0);
}

}  // namespace

SPANTEX_CASE(pictures_of_seed_are_the_other_engines) { same_pictures<seed>("seed"); }
SPANTEX_CASE(pictures_of_default_are_the_other_engines) { same_pictures<fixed_profile<profiles::standard>>("default"); }

// Copied rows and packed words deliver the same 2x2 everywhere in a box: any map, wrapped in any way, any box.
SPANTEX_CASE(copied_sections_equal_packed_ones) {
  random_source random(5);
  const auto between = [&](int32_t low, int32_t high) { return int32_t(random.between(low, high)); };
  const synthetic_map* const maps[] = {&photographic_map(32, 16), &photographic_map(21, 13), &photographic_map(1, 1), &photographic_map(3, 40)};
  static local_memory<16> packed;
  static texel_memory<16> copied;
  const fixed_profile<profiles::standard> prof{};
  for (int n = 0; n < 4000; ++n) {
    const texture_view t = maps[n % 4]->view(all_wraps[between(0, 2)], all_wraps[between(0, 2)]);
    const bool coarse = between(0, 1) != 0;
    const int side = coarse ? 8 : 16;
    section at{};
    texel_box box{};
    at.level = uint8_t(between(0, t.last_level()));
    at.origin_u = between(-60, 60);
    at.origin_v = between(-60, 60);
    box.u0 = at.origin_u + between(0, side - 1);
    box.v0 = at.origin_v + between(0, side - 1);
    box.u1 = between(box.u0, at.origin_u + side - 1);
    box.v1 = between(box.v0, at.origin_v + side - 1);
    SPANTEX_ASSERT_OK(load_section(prof, t, at, box, coarse, [&](int first, const uint64_t* words, int count) { return packed.load(first, words, count); }));
    int64_t sent = 0;
    SPANTEX_ASSERT_OK(copy_section(prof, t, at, box, coarse, [&](int first, const rgba8* from, int count) {
      assert_true(count > 0 && copied.holds(first, count) && (first >= copied.coarse_first_texel) == coarse);
      const texel_copy run{from, uint16_t(first), uint16_t(count)};
      copy_cursor(copied.texels(), &run, 1).copy(count);
      sent += count;
      return status::ok;
    }));
    assert_int_equal(sent, int64_t(box.u1 - box.u0 + 1) * (box.v1 - box.v0 + 1));
    for (int32_t v = box.v0; v < box.v1; ++v)
      for (int32_t u = box.u0; u < box.u1; ++u)
        for (int channel = 0; channel < channel_count; ++channel) {
          const local_position p{int(u & (side - 1)), int(v & (side - 1))}, none{0, 0};
          const fetched a = packed.fetch(channel, coarse ? none : p, coarse ? p : none, no_observer{}), b = copied.fetch(channel, coarse ? none : p, coarse ? p : none, no_observer{});
          for (int k = 0; k < 4; ++k) assert_int_equal(coarse ? coarse_texel(a, k) : fine_texel(a, k), coarse ? coarse_texel(b, k) : fine_texel(b, k));
        }
  }
}

// Maps that cannot be copied as they lie come as packed words, without the loader.
SPANTEX_CASE(maps_of_other_formats_are_packed) {
  static uint16_t numbers[32 * 32];
  for (int k = 0; k < 32 * 32; ++k) numbers[k] = uint16_t(k * 40503);
  const uint16_t* const levels[] = {numbers};
  texture_view t;
  SPANTEX_ASSERT_OK(texture_view::make(texel_format::rgb565, levels, 1, 32, 32, wrap::repeat, wrap::repeat, t));
  static picture shown, expected;
  shown.reset(80, 60);
  expected.reset(80, 60);
  static late_loader loader;
  static engine_type engine(loader);
  SPANTEX_ASSERT_OK(render_plane(seed{}, engine, sample_plane(1), t, filter::bilinear, shown));
  SPANTEX_ASSERT_OK(render_plane_direct<8>(seed{}, sample_plane(1), t, filter::bilinear, expected));
  assert_true(shown == expected);
  assert_int_equal(loader.starts, 0);
}

// --- ownership -----------------------------------------------------------------------------------------

SPANTEX_CASE(a_half_that_the_loader_has_is_refused_to_the_filter) {
  static late_loader loader;
  static halves h(loader, 100);
  submit(h, half::first);
  SPANTEX_ASSERT_OK(h.take(half::first));
  SPANTEX_ASSERT_STATUS(h.begin_reading(half::first), half_busy);
  assert_int_equal(h.ownership().violation_count(), 1);
  assert_int_equal(int(h.ownership().at(0).what), int(operation::take));
  assert_int_equal(int(h.ownership().at(0).which), int(half::first));
  assert_int_equal(h.counters().jobs, 0);
  SPANTEX_ASSERT_OK(h.begin_reading(half::second));  // the other half is free
  h.end_reading(half::second);
  SPANTEX_ASSERT_OK(h.wait(half::first));            // the loader's word releases it
  SPANTEX_ASSERT_OK(h.begin_reading(half::first));
  h.end_reading(half::first);
  assert_int_equal(h.ownership().violation_count(), 1);
}

SPANTEX_CASE(a_half_that_the_filter_has_is_refused_to_the_loader) {
  static late_loader loader;
  static halves h(loader, 100);
  SPANTEX_ASSERT_OK(h.begin_reading(half::second));
  SPANTEX_ASSERT_OK(h.load_texels(half::second, 0, texels, 8));
  SPANTEX_ASSERT_STATUS(h.begin_loading(half::second), half_busy);
  assert_int_equal(h.ownership().violation_count(), 1);
  assert_int_equal(int(h.ownership().at(0).what), int(operation::load_words));
  assert_int_equal(loader.starts, 0);
  h.end_reading(half::second);
  SPANTEX_ASSERT_OK(h.begin_loading(half::second));
  assert_int_equal(loader.starts, 1);
}

SPANTEX_CASE(a_started_half_takes_no_texels) {
  static late_loader loader;
  static engine_type engine(loader);
  SPANTEX_ASSERT_OK(engine.load_texels(half::first, 79, texels, 1));
  SPANTEX_ASSERT_STATUS(engine.load_texels(half::first, 79, texels, 2), bad_address);
  SPANTEX_ASSERT_STATUS(engine.load_texels(half::first, -1, texels, 1), bad_address);
  SPANTEX_ASSERT_STATUS(engine.load_texels(half::first, 0, texels, -1), bad_address);
  SPANTEX_ASSERT_OK(engine.load_coefficients(half::first, {}));
  SPANTEX_ASSERT_OK(engine.start(half::first, 1));
  SPANTEX_ASSERT_STATUS(engine.load_texels(half::first, 0, texels, 1), half_busy);
  assert_int_equal(engine.ownership().violation_count(), 4);
}

// --- loads that go wrong -------------------------------------------------------------------------------

void submit(engine_type& e, half h) {
  SPANTEX_ASSERT_OK(e.load_texels(h, 0, texels, 8));
  SPANTEX_ASSERT_OK(e.load_coefficients(h, {}));
  SPANTEX_ASSERT_OK(e.start(h, 1));
}

SPANTEX_CASE(a_load_that_never_ends_is_given_up) {
  static late_loader loader;
  static engine_type engine(loader, {}, 1000);
  static span_pixels pixels;
  loader.delay = -1;
  submit(engine, half::first);
  submit(engine, half::second);  // waits for the first, in vain; each half tells its own
  assert_int_equal(engine.counters().polls_waited, 1000);
  assert_int_equal(loader.stops, 1);
  SPANTEX_ASSERT_STATUS(engine.take(half::first, pixels), device_timeout);
  assert_int_equal(engine.counters().polls_waited, 1000);
  SPANTEX_ASSERT_STATUS(engine.take(half::second, pixels), device_timeout);
  assert_int_equal(engine.counters().polls_waited, 2000);
  assert_int_equal(loader.stops, 2);
  assert_int_equal(engine.counters().failed, 2);
  assert_int_equal(engine.counters().jobs, 0);
  for (const half h : {half::first, half::second}) SPANTEX_ASSERT_STATUS(engine.start(h, 1), half_not_loaded);  // empty
  loader.delay = 5;
  submit(engine, half::first);
  SPANTEX_ASSERT_OK(engine.take(half::first, pixels));
}

SPANTEX_CASE(a_load_that_fails_is_told_by_its_half) {
  static late_loader loader;
  static engine_type engine(loader);
  static span_pixels pixels;
  loader.outcome = status::device_error;
  submit(engine, half::first);
  loader.poll(), loader.poll(), loader.poll();
  loader.outcome = status::ok;
  submit(engine, half::second);
  SPANTEX_ASSERT_OK(engine.take(half::second, pixels));
  SPANTEX_ASSERT_STATUS(engine.take(half::first, pixels), device_error);
  assert_int_equal(engine.counters().failed, 1);
}

SPANTEX_CASE(a_renderer_hands_the_time_limit_on) {
  static late_loader loader;
  static engine_type engine(loader, {}, 50);
  static picture shown;
  shown.reset(64, 48);
  loader.delay = -1;
  const texture_view t = photographic_map(64, 64).view(wrap::repeat, wrap::repeat);
  renderer<engine_type, seed> r(engine, seed{}, shown.frame());
  SPANTEX_ASSERT_STATUS(r.draw(sample_plane(0), t, filter::bilinear, shown.area()), device_timeout);
  SPANTEX_ASSERT_STATUS(r.flush(), device_timeout);
  SPANTEX_ASSERT_OK(r.flush());
  loader.delay = 2;
  SPANTEX_ASSERT_OK(r.draw(sample_plane(0), t, filter::bilinear, shown.area()));
  SPANTEX_ASSERT_OK(r.finish());
  static picture expected;
  expected.reset(64, 48);
  SPANTEX_ASSERT_OK(render_plane_direct<8>(seed{}, sample_plane(0), t, filter::bilinear, expected));
  assert_true(shown == expected);
}

// --- counts --------------------------------------------------------------------------------------------

SPANTEX_CASE(stalls_and_hidden_loads_are_counted) {
  static late_loader loader;
  static halves h(loader, 100);
  loader.delay = 7;
  submit(h, half::first);
  SPANTEX_ASSERT_OK(h.take(half::first));
  SPANTEX_ASSERT_OK(h.wait(half::first));  // nothing to hide behind
  assert_int_equal(h.counters().stalls, 1);
  assert_int_equal(h.counters().polls_waited, 7);
  submit(h, half::second);
  SPANTEX_ASSERT_OK(h.begin_reading(half::first));
  assert_int_equal(h.counters().beside, 1);
  for (int k = 0; k < 7; ++k) loader.poll();
  h.end_reading(half::first);
  SPANTEX_ASSERT_OK(h.take(half::second));
  SPANTEX_ASSERT_OK(h.wait(half::second));
  SPANTEX_ASSERT_OK(h.begin_reading(half::second));
  assert_int_equal(h.counters().hidden, 1);
  assert_int_equal(h.counters().stalls, 1);
  assert_int_equal(h.counters().polls_waited, 7);
  assert_int_equal(h.counters().beside, 1);
  assert_int_equal(h.counters().loads, 2);
  assert_int_equal(h.counters().jobs, 2);
  assert_int_equal(h.counters().texels_loaded, 16);
}

SPANTEX_CASE(runs_beyond_the_list_are_copied_at_once) {
  static late_loader loader;
  static halves h(loader, 100);
  for (int k = 0; k < halves::list_length; ++k) SPANTEX_ASSERT_OK(h.load_texels(half::first, k, texels + 1, 1));
  SPANTEX_ASSERT_OK(h.load_texels(half::first, 40, texels + 2, 3));
  assert_int_equal(h.counters().texels_copied, 3);
  const fetched f = h.texels(half::first).fetch(0, {0, 5}, {}, no_observer{});
  assert_int_equal(fine_texel(f, 0), texels[2].r);
  assert_int_equal(fine_texel(f, 1), texels[3].r);
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(pictures_of_seed_are_the_other_engines),
      cmocka_unit_test(pictures_of_default_are_the_other_engines),
      cmocka_unit_test(copied_sections_equal_packed_ones),
      cmocka_unit_test(maps_of_other_formats_are_packed),
      cmocka_unit_test(a_half_that_the_loader_has_is_refused_to_the_filter),
      cmocka_unit_test(a_half_that_the_filter_has_is_refused_to_the_loader),
      cmocka_unit_test(a_started_half_takes_no_texels),
      cmocka_unit_test(a_load_that_never_ends_is_given_up),
      cmocka_unit_test(a_load_that_fails_is_told_by_its_half),
      cmocka_unit_test(a_renderer_hands_the_time_limit_on),
      cmocka_unit_test(stalls_and_hidden_loads_are_counted),
      cmocka_unit_test(runs_beyond_the_list_are_copied_at_once),
  };
  return run_suite("loading_engine", tests);
}
