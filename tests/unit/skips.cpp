// SPDX-License-Identifier: Apache-2.0
// What the draw layer skips: the picture and the depths are the same with each of them off, and each saves what it says.
#include <tests/support.hpp>

#include <cstring>

#include <hal/sim_engine.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

constexpr int32_t one = 1 << 16, width = 61, height = 45, across = (width + 7) / 8, down = (height + 7) / 8;
constexpr rectangle screen{0, 0, width, height};
constexpr projection camera{64 * one, 64 * one, width * one / 2, height * one / 2, one / 16};

struct surface_drawn {
  bool is_polygon = false;
  plane on{};
  polygon shape{};
  texture_view map;
  filter kind = filter::bilinear;
  shading how{};
  colour_forms colours{};
};

constexpr int most_surfaces = 8;
struct test_scene {
  surface_drawn items[most_surfaces];
  int count = 0;
  surface_drawn& add() { return items[count++]; }
};

struct result {
  picture shown;
  std::vector<uint32_t> depths;
  draw_counters work;
  skip_counters skipped;
  counters machine;  // of the simulated engine
};

// Draws a scene; the machine's counts where Engine has them.
template <class Prof, class Skips, class Engine>
void draw(Engine& engine, const test_scene& s, const Skips& skips, result& out) {
  out.shown.reset(width, height);
  out.depths.assign(size_t(width * height), 0);
  std::vector<uint32_t> floors(size_t(across * down), 0);
  const depth_buffer depth{out.depths.data(), floors.data()};
  renderer<Engine, Prof, shading, counted_reads, Skips> r(engine, Prof{}, out.shown.frame(), skips);
  for (int k = 0; k < s.count; ++k) {
    const surface_drawn& item = s.items[k];
    shading how = item.how;
    if (item.colours.varies) how.colours = &item.colours;
    SPANTEX_ASSERT_OK(item.is_polygon ? r.draw(item.shape, item.map, item.kind, depth, how) : r.draw(item.on, item.map, item.kind, screen, how));
  }
  SPANTEX_ASSERT_OK(r.finish());
  out.work = r.counters();
  if constexpr (Skips::counted) out.skipped = r.skipped();
}

template <class Prof>
const result& drawn_direct(const test_scene& s, skip_set set) {
  static result out;
  static direct_engine<Prof> engine;
  draw<Prof>(engine, s, run_time_skips{set, screen}, out);
  return out;
}

template <class Prof>
const result& drawn_by_device(const test_scene& s) {
  static result out;
  static direct_engine<Prof> engine;
  draw<Prof>(engine, s, device_skips{}, out);
  return out;
}

// --- maps ----------------------------------------------------------------------------------------------

texture_view with_facts(const synthetic_map& m, wrap w) {
  texture_view t = m.view(w, w);
  texture_facts f{true, 0};
  for (size_t k = 0; k < m.levels.size(); ++k) {
    bool uniform = true;
    for (const rgba8& c : m.levels[k].texels) {
      f.opaque &= c.a == 255;
      uniform &= c == m.levels[k].texels[0];
    }
    f.uniform_levels = uint16_t(f.uniform_levels | uint16_t(uniform) << k);
  }
  t.set_facts(f);
  return t;
}

rgba8 noise(int32_t x, int32_t y) {
  random_source r(uint64_t(uint32_t(x)) << 32 | uint32_t(y));
  const uint64_t n = r.next();
  return {uint8_t(n), uint8_t(n >> 8), uint8_t(n >> 16), uint8_t(n >> 24)};
}

// Patches of 16x16 texels: of one colour, transparent, or noise.
rgba8 patch(int32_t x, int32_t y) {
  const rgba8 of = noise(x / 16 + 1000, y / 16);
  if (of.a % 4 == 0) return {of.r, of.g, of.b, 0};
  if (of.a % 4 == 1) return {of.r, of.g, of.b, 255};
  const rgba8 n = noise(x, y);
  return of.a % 4 == 2 ? n : rgba8{n.r, n.g, n.b, uint8_t(n.a & 1)};
}

rgba8 opaque_noise(int32_t x, int32_t y) {
  const rgba8 n = noise(x, y);
  return {n.r, n.g, n.b, 255};
}

// Blocks that are uniform, transparent or neither.
texture_view bc3_map(wrap w) {
  static uint8_t bytes[2][16 * 16 * 16];
  static const bool made = [] {
    random_source random(3);
    for (auto& level : bytes)
      for (int block = 0; block < 256; ++block) {
        const bool flat = random.next() % 2 == 0;
        for (int k = 0; k < 16; ++k) level[block * 16 + k] = flat ? uint8_t(block / 64 * 0x55) : uint8_t(random.next());
      }
    return true;
  }();
  (void)made;
  const void* levels[] = {bytes[0], bytes[1]};
  texture_view t;
  SPANTEX_ASSERT_OK(texture_view::make(texel_format::bc3, levels, 2, 64, 64, w, w, t));
  return t;
}

texture_view some_map(random_source& random) {
  const wrap w = all_wraps[random.next() % 3];
  static const synthetic_map *const patches = &make_map(128, 64, patch), *const plain = &make_map(64, 64, opaque_noise), *const rough = &make_map(37, 50, noise),
                             *const dot = &make_map(1, 1, opaque_noise), *const flat = &constant_map(64, 32, {9, 200, 77, 130}), *const thin = &make_map(1, 40, noise);
  switch (random.next() % 8) {
    case 0: return with_facts(*plain, w);
    case 1: return with_facts(*rough, w);
    case 2: return with_facts(*dot, w);
    case 3: return with_facts(*flat, w);
    case 4: return with_facts(*thin, w);
    case 5: return bc3_map(w);
    default: return with_facts(*patches, w);
  }
}

// --- surfaces ------------------------------------------------------------------------------------------

plane plane_of(const double (&m)[9]) {
  plane p{};
  SPANTEX_ASSERT_OK(make_plane(homography_of(m), screen, p));
  return p;
}

// Anything, or one of those that skips are made for: whole steps, and coordinates that hardly change.
plane some_plane(random_source& random) {
  plane p{};
  const double u = double(random.between(-200, 200)), v = double(random.between(-200, 200));
  switch (random.next() % 8) {
    case 0: return plane_of({1, 0, u, 0, 1, v, 0, 0, 1});
    case 1: return plane_of({0, -1, u, 1, 0, v, 0, 0, 1});
    case 2: return plane_of({2, 0, u + 0.5, 0, -1, v, 0, 0, 1});
    case 3: return plane_of({1, 0, u + 1.0 / 512, 0, 1, v + 1.0 / 200, 0, 0, 1});
    case 4: return plane_of({0.001, 0, u, 0, 0.002, v, 0, 0, 1});
    case 5: return plane_of({0, 0, u + 0.3, 0, 0, v + 0.4, 0, 0, 1});
    default:
      while (!random_plane(random, screen, p)) {}
      return p;
  }
}

bool some_polygon(random_source& random, surface_drawn& out) {
  vertex v[4];
  rgba8 c[4];
  const int32_t z = int32_t(random.between(one, 30 * one)), side = int32_t(random.between(z / 6, z)), tilt = random.next() % 3 == 0 ? 0 : int32_t(random.between(-z / 3, z / 3));
  const int32_t x = int32_t(random.between(-z, z)), y = int32_t(random.between(-z / 2, z / 2)), size = int32_t(random.between(one, 300 * one));
  const int32_t sx[4] = {-1, 1, 1, -1}, sy[4] = {-1, -1, 1, 1};
  const bool coloured = random.next() % 4 == 0;
  for (int k = 0; k < 4; ++k) {
    v[k] = {x + sx[k] * side, y + sy[k] * side, z + sx[k] * tilt, sx[k] * size, sy[k] * size};
    const uint64_t n = coloured ? random.next() : UINT64_MAX;
    c[k] = {uint8_t(n), uint8_t(n >> 8), uint8_t(n >> 16), uint8_t(n >> 24)};
  }
  out.is_polygon = true;
  return make_polygon(v, c, 4, camera, screen, out.shape, out.colours) == status::ok;
}

void make_scene(uint64_t seed, test_scene& s) {
  random_source random(seed);
  s = {};
  while (s.count < most_surfaces) {
    surface_drawn& item = s.add();
    if (random.next() % 2 == 0) item.on = some_plane(random);
    else if (!some_polygon(random, item)) { item = {}; --s.count; continue; }
    item.map = some_map(random);
    if (random.next() % 4 == 0) item.map.set_colours(colour_space::srgb);
    item.kind = all_filters[random.next() % (sizeof all_filters / sizeof all_filters[0])];
    item.how.alpha = alpha_mode(random.next() % 4);
    item.how.threshold = uint8_t(random.next());
    if (random.next() % 3 == 0) item.how.colour = {200, 255, 90, uint8_t(random.next() % 2 == 0 ? 255 : 128)};
  }
}

// --- the same picture ----------------------------------------------------------------------------------

void add(skip_counters& sum, const skip_counters& c) {
  uint64_t numbers[sizeof c / 8], sums[sizeof c / 8];
  std::memcpy(numbers, &c, sizeof c);
  std::memcpy(sums, &sum, sizeof c);
  for (size_t k = 0; k < sizeof c / 8; ++k) sums[k] += numbers[k];
  std::memcpy(&sum, sums, sizeof c);
}

template <class Prof>
void each_set_draws_the_same(int scenes) {
  static test_scene s;
  skip_counters sum{};
  for (int seed = 1; seed <= scenes; ++seed) {
    make_scene(uint64_t(seed), s);
    const result& plain = drawn_by_device<Prof>(s);
    const auto same = [&](skip_set set) {
      const result& r = drawn_direct<Prof>(s, set);
      if (r.shown.pixels != plain.shown.pixels) fail_msg("scene %d, skips %x: another picture, %d pixels", seed, set, int(differing_pixels(r.shown, plain.shown)));
      if (r.depths != plain.depths) fail_msg("scene %d, skips %x: other depths", seed, set);
      return r.skipped;
    };
    add(sum, same(all_skips));
    for (int k = 0; k < skip_count; ++k) {
      same(all_skips & ~only(static_cast<skip>(k)));
      same(only(static_cast<skip>(k)));
    }
    same(0);
  }
  // Every one was there to be seen.
  if (scenes < 10) return;
  uint64_t counts[sizeof sum / 8];
  std::memcpy(counts, &sum, sizeof sum);
  for (size_t k = 0; k < sizeof sum / 8; ++k) assert_in_range(counts[k], 1, UINT64_MAX);
}

SPANTEX_CASE(no_skip_changes_the_picture_of_default) { each_set_draws_the_same<fixed_profile<profiles::standard>>(short_run() ? 5 : 16); }
SPANTEX_CASE(no_skip_changes_the_picture_of_exact) { each_set_draws_the_same<fixed_profile<profiles::exact>>(short_run() ? 2 : 6); }
SPANTEX_CASE(no_skip_changes_the_picture_of_compact) { each_set_draws_the_same<fixed_profile<profiles::compact>>(short_run() ? 2 : 6); }
SPANTEX_CASE(no_skip_changes_the_picture_of_seed) { each_set_draws_the_same<fixed_profile<profiles::seed>>(short_run() ? 2 : 6); }

// --- less work -----------------------------------------------------------------------------------------

const result& simulated(const test_scene& s, skip_set set) {
  using prof = fixed_profile<profiles::standard>;
  static result out;
  sim_engine<prof> engine;
  draw<prof>(engine, s, run_time_skips{set, screen}, out);
  out.machine = engine.counters();
  return out;
}

using count = uint64_t (*)(const result&);

// One skip off, all others on: `counter` moves with it on alone, and `work` and `also` are less.
void saves(const test_scene& s, skip which, count counter, count work, count also) {
  const result on = simulated(s, all_skips);
  const result& off = simulated(s, all_skips & ~only(which));
  assert_in_range(counter(on), 1, UINT64_MAX);
  if (which != skip::empty && which != skip::hidden) assert_int_equal(counter(off), 0);
  assert_true(work(on) < work(off));
  assert_true(also(on) <= also(off));
  assert_true(on.shown.pixels == off.shown.pixels);
}

constexpr count words = [](const result& r) { return r.work.words_loaded; };
constexpr count fetches = [](const result& r) { return r.machine.fetches; };
constexpr count cycles = [](const result& r) { return r.machine.total_cycles; };

void add_wall(test_scene& s, int32_t z, const texture_view& map, int32_t side = 4 * one) {
  const vertex v[4] = {{-side, -side, z, 0, 0}, {side, -side, z, 64 * one, 0}, {side, side, z, 64 * one, 64 * one}, {-side, side, z, 0, 64 * one}};
  surface_drawn& item = s.add();
  item.is_polygon = true;
  item.map = map;
  SPANTEX_ASSERT_OK(make_polygon(v, 4, camera, screen, item.shape));
}

void add_plane(test_scene& s, const double (&m)[9], const texture_view& map, filter kind) {
  surface_drawn& item = s.add();
  item.on = plane_of(m);
  item.map = map;
  item.kind = kind;
}

texture_view rough() { return with_facts(make_map(64, 64, noise), wrap::repeat); }

SPANTEX_CASE(spans_outside_boxes_and_polygons_are_not_looked_at) {
  test_scene s;
  add_wall(s, 30 * one, rough());
  saves(s, skip::outside, [](const result& r) { return r.skipped.spans_outside; }, [](const result& r) { return r.work.spans_total; }, cycles);
  const vertex v[3] = {{0, 0, 8 * one, 0, 0}, {2 * one, 3 * one, 8 * one, one, 0}, {one, 3 * one, 8 * one, 0, one}};
  test_scene one_triangle;
  surface_drawn& item = one_triangle.add();
  item.is_polygon = true;
  item.map = rough();
  SPANTEX_ASSERT_OK(make_polygon(v, 3, camera, screen, item.shape));
  saves(one_triangle, skip::empty, [](const result& r) { return r.work.spans_empty; }, fetches, cycles);
}

SPANTEX_CASE(a_polygon_outside_covers_nothing) {
  random_source random(23);
  int outside = 0, drawn = 0;
  for (int n = 0; n < 3000; ++n) {
    vertex v[3];
    const int32_t z = int32_t(random.between(-one, 8 * one)), x = int32_t(random.between(-12 * one, 12 * one)), y = int32_t(random.between(-12 * one, 12 * one));
    for (vertex& k : v)
      k = {x + int32_t(random.between(-4 * one, 4 * one)), y + int32_t(random.between(-4 * one, 4 * one)), z + int32_t(random.between(-4 * one, 4 * one)),
           int32_t(random.between(-one, one)), int32_t(random.between(-one, one))};
    const bool skipped = is_outside(v, 3, camera, screen);
    outside += skipped;
    polygon p{};
    const status made = make_polygon(v, 3, camera, screen, p);
    if (made != status::ok) {
      assert_true(made == status::degenerate);
      continue;
    }
    span_mask covered = 0;
    for (int32_t sy = 0; sy < down; ++sy)
      for (int32_t sx = 0; sx < across; ++sx) covered |= coverage(p.edges, sx, sy) & rectangle_mask(p.box, sx, sy);
    drawn += covered != 0;
    assert_false(skipped && covered != 0);
  }
  assert_in_range(outside, 800, 2800);
  assert_in_range(drawn, 200, 3000);
}

SPANTEX_CASE(hidden_spans_cost_nothing) {
  test_scene s;
  add_wall(s, 2 * one, rough());
  add_wall(s, 3 * one, rough());
  saves(s, skip::hidden, [](const result& r) { return r.work.spans_hidden; }, fetches, words);
  const result on = simulated(s, all_skips);
  const result& off = simulated(s, all_skips & ~only(skip::floors));
  assert_in_range(on.skipped.spans_below_floor, on.work.spans_hidden * 2 / 3, on.work.spans_hidden);  // but for those at the edges, which are not full
  assert_int_equal(off.skipped.spans_below_floor, 0);
  assert_int_equal(off.work.spans_hidden, on.work.spans_hidden);
}

SPANTEX_CASE(what_is_held_is_not_loaded) {
  test_scene s;
  add_plane(s, {0.02, 0, 1.2, 0, 0.02, 1.2, 0, 0, 1}, rough(), filter::bilinear);
  const result held = simulated(s, only(skip::held));
  const result both = simulated(s, only(skip::held) | only(skip::other_half));
  const result none = simulated(s, 0);
  assert_int_equal(none.work.loads_skipped, 0);
  assert_true(held.work.loads_skipped > 0 && held.work.words_loaded < none.work.words_loaded);
  assert_true(both.skipped.loads_in_other_half > 0 && both.work.words_loaded < held.work.words_loaded);
  assert_true(held.shown.pixels == none.shown.pixels && both.shown.pixels == none.shown.pixels);
}

SPANTEX_CASE(levels_without_weight_are_not_loaded) {
  test_scene s;
  add_plane(s, {0.4, 0, 1.2, 0, 0.4, 1.2, 0, 0, 1}, rough(), filter::trilinear);
  const result on = simulated(s, all_skips);
  const result& off = simulated(s, all_skips & ~only(skip::second_level));
  assert_int_equal(on.work.second_levels_skipped, on.work.jobs);
  assert_int_equal(off.work.second_levels_skipped, 0);
  assert_true(on.work.words_loaded < off.work.words_loaded && on.machine.texel_reads < off.machine.texel_reads);
}

SPANTEX_CASE(a_map_of_one_texel_takes_no_job) {
  test_scene s;
  add_plane(s, {0.4, 0.1, 1.2, 0, 0.4, 1.2, 0.001, 0, 1}, with_facts(make_map(1, 1, noise), wrap::repeat), filter::trilinear);
  saves(s, skip::constant, [](const result& r) { return r.skipped.spans_constant; }, [](const result& r) { return r.work.divides; }, cycles);
  assert_int_equal(simulated(s, all_skips).work.jobs, 0);
}

// The same coordinates everywhere: one pixel of a span is computed. What one texel gives needs not even that.
SPANTEX_CASE(pixels_that_are_all_alike_are_one) {
  test_scene s;
  add_plane(s, {0.25, 0, 0, 0, 0.25, 0, 0, 0, 1}, with_facts(make_map(1, 1, noise), wrap::repeat), filter::bilinear);
  const result on = simulated(s, only(skip::constant));
  assert_int_equal(on.skipped.spans_constant, across * down);
  surface_drawn& item = s.items[0];
  item.map = rough();
  item.on = plane_of({0, 0, 3.3, 0, 0, 5.7, 0, 0, 1});
  saves(s, skip::constant, [](const result& r) { return r.skipped.pixels_constant; }, fetches, cycles);
  const result& still = simulated(s, all_skips);
  assert_int_equal(still.skipped.jobs_constant, still.work.jobs);
  assert_int_equal(still.machine.pixels, still.work.jobs);
  assert_int_equal(still.work.affine_jobs, 0);
}

SPANTEX_CASE(texels_that_are_all_alike_are_neither_loaded_nor_filtered) {
  for (const bool known : {false, true}) {
    const synthetic_map& flat = constant_map(64, 64, {1, 2, 3, 4});
    test_scene s;
    add_plane(s, {0.9, 0.1, 1.2, 0, 1.4, 1.2, 0.001, 0, 1}, known ? with_facts(flat, wrap::repeat) : flat.view(wrap::repeat, wrap::repeat), filter::trilinear);
    saves(s, skip::uniform, [](const result& r) { return r.skipped.jobs_uniform; }, words, fetches);
    const result& on = simulated(s, all_skips);
    assert_int_equal(on.work.words_loaded, 0);
    assert_int_equal(on.machine.fetches, 0);
    assert_int_equal(on.skipped.pixels_written, width * height);
  }
}

SPANTEX_CASE(one_texel_is_not_loaded) {
  test_scene s;
  add_plane(s, {1.0 / 64, 0, 0, 0, 1.0 / 64, 0, 0, 0, 1}, rough(), filter::nearest);
  saves(s, skip::one_texel, [](const result& r) { return r.skipped.jobs_one_texel; }, words, cycles);
}

SPANTEX_CASE(whole_steps_are_copied) {
  for (const filter kind : one_sample_filters) {
    test_scene s;
    add_plane(s, {0, -1, 7, 1, 0, 3, 0, 0, 1}, rough(), kind);
    saves(s, skip::copy, [](const result& r) { return r.skipped.jobs_copied; }, fetches, words);
    assert_int_equal(simulated(s, all_skips).work.jobs, 0);
    s.items[0].on = plane_of({1, 0, 1.0 / 8, 0, 1, 0, 0, 0, 1});  // an eighth of a texel aside
    assert_int_equal(simulated(s, all_skips).skipped.jobs_copied, 0);
  }
}

// The nine texels across that bilinear needs are one more than seed's memory has: their positions are clamped, and no copies.
SPANTEX_CASE(a_clamped_section_is_not_copied) {
  using seed = fixed_profile<profiles::seed>;
  test_scene s;
  add_plane(s, {1, 0, 7, 0, 1, 3, 0, 0, 1}, rough(), filter::bilinear);
  const result& plain = drawn_by_device<seed>(s);
  const result& r = drawn_direct<seed>(s, all_skips);
  assert_true(plain.work.corrected_jobs > 0);
  assert_true(r.shown.pixels == plain.shown.pixels);
}

SPANTEX_CASE(opaque_maps_are_not_blended) {
  for (const alpha_mode alpha : {alpha_mode::cut_out, alpha_mode::blended, alpha_mode::premultiplied}) {
    test_scene s;
    add_wall(s, 3 * one, with_facts(make_map(64, 64, opaque_noise), wrap::repeat));
    s.items[0].how.alpha = alpha;
    const result on = simulated(s, all_skips);
    const result& off = simulated(s, all_skips & ~only(skip::opaque));
    assert_int_equal(on.skipped.pixels_opaque, on.work.pixels);
    assert_int_equal(off.skipped.pixels_opaque, 0);
    assert_int_equal(on.work.pixels_blended, 0);
    assert_int_equal(off.work.pixels_blended, alpha == alpha_mode::cut_out ? 0 : on.work.pixels);
    assert_true(on.depths == off.depths);
  }
}

SPANTEX_CASE(transparent_texels_are_not_loaded) {
  for (const alpha_mode alpha : {alpha_mode::cut_out, alpha_mode::blended}) {
    test_scene s;
    add_plane(s, {0.9, 0.1, 1.2, 0, 1.4, 1.2, 0.001, 0, 1}, make_map(64, 64, [](int32_t x, int32_t y) {
                                                              const rgba8 n = noise(x, y);
                                                              return rgba8{n.r, n.g, n.b, 0};
                                                            }).view(wrap::repeat, wrap::repeat), filter::bilinear);
    s.items[0].how.alpha = alpha;
    saves(s, skip::transparent, [](const result& r) { return r.skipped.jobs_transparent; }, words, fetches);
    const result& on = simulated(s, all_skips);
    assert_int_equal(on.work.words_loaded, 0);
    assert_int_equal(on.work.pixels_left, width * height);
  }
}

// A pixel's alpha is between those of both levels' texels, and a cut-out's threshold is drawn.
SPANTEX_CASE(texels_that_are_seen_are_drawn) {
  static synthetic_map clear_above = make_map(64, 64, [](int32_t x, int32_t y) {
    const rgba8 n = noise(x, y);
    return rgba8{n.r, n.g, n.b, 0};
  });
  for (size_t k = 1; k < clear_above.levels.size(); ++k)
    for (rgba8& c : clear_above.levels[k].texels) c.a = 255;
  test_scene s;
  add_plane(s, {1.5, 0.1, 1.2, 0, 1.5, 1.2, 0, 0, 1}, clear_above.view(wrap::repeat, wrap::repeat), filter::trilinear);
  s.items[0].how.alpha = alpha_mode::blended;
  assert_int_equal(simulated(s, all_skips).skipped.jobs_transparent, 0);
  assert_int_equal(simulated(s, all_skips).work.pixels_left, 0);
  s.items[0].map = constant_map(64, 64, {7, 7, 9, 99}).view(wrap::repeat, wrap::repeat);
  s.items[0].how.alpha = alpha_mode::cut_out;
  for (const uint8_t threshold : {uint8_t(98), uint8_t(99), uint8_t(100)}) {
    s.items[0].how.threshold = threshold;
    assert_int_equal(simulated(s, all_skips).work.pixels_left, threshold > 99 ? width * height : 0);
  }
}

// What nearly lets a job be skipped: each differs in one thing alone.
SPANTEX_CASE(what_is_nearly_alike_is_drawn) {
  using prof = fixed_profile<profiles::standard>;
  const auto same = [](const test_scene& s) { assert_true(drawn_direct<prof>(s, all_skips).shown.pixels == drawn_by_device<prof>(s).shown.pixels); };
  test_scene dots;  // the corners of a section alike, not what is between
  add_plane(dots, {0.4, 0, 1.2, 0, 0.4, 1.2, 0, 0, 1}, make_map(64, 64, [](int32_t x, int32_t y) {
                                                         return x % 5 == 2 && y % 5 == 2 ? rgba8{200, 0, 0, 255} : rgba8{1, 2, 3, 255};
                                                       }).view(wrap::repeat, wrap::repeat), filter::bilinear);
  same(dots);
  static synthetic_map two_colours = constant_map(64, 64, {1, 2, 3, 255});  // each level has its own
  for (rgba8& c : two_colours.levels[1].texels) c = {90, 91, 92, 255};
  test_scene levels;
  add_plane(levels, {1.5, 0.1, 1.2, 0, 1.5, 1.2, 0, 0, 1}, two_colours.view(wrap::repeat, wrap::repeat), filter::trilinear);
  same(levels);
  test_scene thin;  // one texel wide, not high
  add_plane(thin, {0.2, 0, 1.2, 0, 0.3, 1.2, 0, 0, 1}, make_map(1, 40, noise).view(wrap::repeat, wrap::repeat), filter::bilinear);
  same(thin);
  test_scene faint;  // an opaque map, and a colour that is not
  add_wall(faint, 3 * one, with_facts(make_map(64, 64, opaque_noise), wrap::repeat));
  faint.items[0].how.alpha = alpha_mode::blended;
  faint.items[0].how.colour = {255, 255, 255, 128};
  same(faint);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(no_skip_changes_the_picture_of_default),
      cmocka_unit_test(no_skip_changes_the_picture_of_exact),
      cmocka_unit_test(no_skip_changes_the_picture_of_compact),
      cmocka_unit_test(no_skip_changes_the_picture_of_seed),
      cmocka_unit_test(spans_outside_boxes_and_polygons_are_not_looked_at),
      cmocka_unit_test(a_polygon_outside_covers_nothing),
      cmocka_unit_test(hidden_spans_cost_nothing),
      cmocka_unit_test(what_is_held_is_not_loaded),
      cmocka_unit_test(levels_without_weight_are_not_loaded),
      cmocka_unit_test(a_map_of_one_texel_takes_no_job),
      cmocka_unit_test(pixels_that_are_all_alike_are_one),
      cmocka_unit_test(texels_that_are_all_alike_are_neither_loaded_nor_filtered),
      cmocka_unit_test(one_texel_is_not_loaded),
      cmocka_unit_test(whole_steps_are_copied),
      cmocka_unit_test(a_clamped_section_is_not_copied),
      cmocka_unit_test(opaque_maps_are_not_blended),
      cmocka_unit_test(transparent_texels_are_not_loaded),
      cmocka_unit_test(texels_that_are_seen_are_drawn),
      cmocka_unit_test(what_is_nearly_alike_is_drawn),
  };
  return run_suite("skips", tests);
}
