// SPDX-License-Identifier: Apache-2.0
// Spans that keep their pixels from the frame before: the picture is that of a frame drawn alone, whatever moves, and what did not change costs nothing.
#include <functional>
#include <memory>

#include <sim/draw_host.hpp>
#include <sim/figures.hpp>
#include <sim/pattern.hpp>
#include <sim/planes.hpp>
#include <sim/unchanged.hpp>
#include <sim/world.hpp>
#include <tests/support.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

constexpr int32_t one = 1 << 16;
constexpr screen_size size{92, 60};  // no whole spans at the right and at the bottom
constexpr int columns = (size.width_px + span_side - 1) / span_side, rows = (size.height_px + span_side - 1) / span_side;

image grains() {
  image picture = random_pattern(64, 3);
  for (rgba8& c : picture.pixels) c.a = c.r;
  return picture;
}

std::shared_ptr<map_list> make_maps() {
  map_list maps;
  maps.emplace_back(grains(), prefilter::box, wrap::repeat, wrap::repeat);
  maps.emplace_back(squares_pattern(64, 8), prefilter::box, wrap::repeat, wrap::repeat);
  return std::make_shared<map_list>(std::move(maps));
}

scene_request request() {
  scene_request r;
  r.size = size;
  return r;
}

scene empty_scene(std::shared_ptr<const map_list> maps) { return {"test", size, std::move(maps), {}}; }

// A square that faces the camera; half a side, middle and depth in sixteenths of a unit; half_texels to each.
void add_square(scene& s, int32_t x, int32_t y, int32_t z, int32_t half, int map_index, const rgba8* colours = nullptr, int32_t half_texels = 1) {
  static const lens view = make_lens(size, 1.0, 1.0 / 8);
  constexpr int32_t unit = one / 16;
  const auto corner = [&](int32_t i, int32_t j) { return vertex{(x + i * half) * unit, (y + j * half) * unit, z * unit, (i + 1) * half * half_texels * one / 2, (j + 1) * half * half_texels * one / 2}; };
  const vertex v[4] = {corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)};
  if (colours != nullptr) add_polygon(s, view, v, colours, 4, map_index);
  else add_polygon(s, view, v, 4, map_index);
}

void add_wall(scene& s, int32_t z, int map_index) { add_square(s, 0, 0, z, 8 * z, map_index, nullptr, 8); }

// Seen at an angle, minified, with its edges.
void add_slanted(scene& s, const rgba8 (&colours)[4]) {
  const vertex v[4] = {{-one, -one / 2, 3 * one, 0, 0}, {one, -one / 2, 4 * one, 290 * one, 5 * one}, {one, one / 2, 2 * one, 290 * one, 160 * one}, {-one, one / 2, one, 7 * one, 160 * one}};
  add_polygon(s, make_lens(size, 1.0, 1.0 / 8), v, colours, 4, 0);
}
constexpr rgba8 plain[4] = {white, white, white, white}, faint[4] = {{255, 255, 255, 150}, {255, 255, 255, 150}, {255, 255, 255, 150}, {255, 255, 255, 150}};

// One frame after another, by kernels where they draw; each must be what the engine draws alone.
struct film {
  frame_before before;
  draw_result shown;
  void show(const scene& s, const draw_options& o) {
    shown = draw(s, o, &before);
    draw_options by_engine = o;
    by_engine.kernel = kernels::choice::scalar;
    assert_true(shown.picture.pixels == draw(s, by_engine).picture.pixels);
  }
};

draw_options options_of(filter kind, engine_choice engine = engine_choice::direct) {
  draw_options o;
  o.kind = kind;
  o.engine = engine;
  return o;
}

bool covers(const drawable& d, int sx, int sy) { return (coverage(d.shape.edges, sx, sy) & rectangle_mask(d.shape.box, sx, sy)) != 0; }

int spans_without(const drawable& a, const drawable& b) {
  int n = 0;
  for (int sy = 0; sy < rows; ++sy)
    for (int sx = 0; sx < columns; ++sx) n += !covers(a, sx, sy) && !covers(b, sx, sy);
  return n;
}

SPANTEX_CASE(a_moving_object_leaves_its_background) {
  static film f;
  const auto maps = make_maps();
  for (const engine_choice engine : {engine_choice::direct, engine_choice::simulated})
    for (const kernels::choice kernel : {kernels::choice::fastest, kernels::choice::words, kernels::choice::scalar})
      for (const int threads : {1, 3}) {
        f = {};
        drawable object{};
        for (int k = 0; k < 6; ++k) {
          scene s = empty_scene(maps);
          add_wall(s, 48, 0);
          add_square(s, 2 * k - 4, k, 32, 6, 1);
          draw_options o = options_of(filter::trilinear, engine);
          o.kernel = kernel;
          o.threads = threads;
          o.counted = true;
          f.show(s, o);
          const int kept = k == 0 ? 0 : spans_without(object, s.items.back());
          assert_int_equal(f.shown.spans_unchanged, kept);
          assert_in_range(kept, k == 0 ? 0 : columns * rows / 2, columns * rows - 1);
          // Only the wall in the other spans, but for those that the object hides, and the object are looked at.
          const draw_result alone = draw(s, o);
          if (k > 0) assert_true(f.shown.work.words_loaded * 2 < alone.work.words_loaded && f.shown.work.jobs * 2 < alone.work.jobs);
          object = s.items.back();
        }
      }
}

SPANTEX_CASE(a_still_frame_costs_nothing) {
  static film f;
  for (const engine_choice engine : {engine_choice::direct, engine_choice::simulated}) {
    f = {};
    for (int k = 0; k < 3; ++k) {
      scene s = make_named_scene("fig8", request());  // maps made anew for each frame: found to be the same by their texels
      const size_t count = s.items.size();
      s.items.reserve(2 * count);
      for (size_t n = 0; n < count; n += 2) s.items.push_back(s.items[n]);  // some surfaces twice
      f.show(s, options_of(filter::trilinear, engine));
      assert_int_equal(f.shown.spans_unchanged, k == 0 ? 0 : columns * rows);
      if (k == 0) continue;
      assert_int_equal(f.shown.work.spans_total, 0);
      assert_int_equal(f.shown.work.words_loaded, 0);
      assert_int_equal(f.shown.work.words_read, 0);
      assert_int_equal(f.shown.machine.fetches, 0);
      assert_int_equal(f.shown.machine.total_cycles, 0);
    }
    // A plane has no depth; spans behind the viewer are kept too.
    const auto maps = make_maps();
    for (const matrix& m : {tilted_plane, horizon_plane}) {
      f = {};
      for (int k = 0; k < 2; ++k) {
        scene s = empty_scene(maps);
        add_plane(s, stretched(m, size), 0);
        f.show(s, options_of(filter::bilinear, engine));
        assert_int_equal(f.shown.spans_unchanged, k == 0 ? 0 : columns * rows);
        if (k == 0) continue;
        for (const uint64_t count : {f.shown.work.spans_total, f.shown.work.jobs, f.shown.work.pixels, f.shown.work.spans_behind}) assert_int_equal(count, 0);
      }
    }
  }
}

SPANTEX_CASE(a_moving_camera_keeps_nothing) {
  static film f;
  f = {};
  for (int k = 0; k < 4; ++k) {
    scene_request r = request();
    r.turn_degrees = k;
    f.show(make_named_scene("fig8", r), options_of(filter::trilinear));
    assert_int_equal(f.shown.spans_unchanged, 0);
  }
}

SPANTEX_CASE(what_moves_unseen_changes_nothing) {
  static film f;
  const auto maps = make_maps();
  for (const bool before_wall : {false, true})
    for (const int32_t z : {60, 48}) {  // behind the wall, and in its plane: there the first one is seen
      f = {};
      for (int k = 0; k < 4; ++k) {
        scene s = empty_scene(maps);
        if (before_wall) add_square(s, 2 * k, 0, z, 9, 1);
        add_wall(s, 48, 0);
        if (!before_wall) add_square(s, 2 * k, 0, z, 9, 1);
        f.show(s, options_of(filter::bilinear));
        if (k > 0 && z == 60) assert_int_equal(f.shown.spans_unchanged, columns * rows);
        if (k > 0 && z == 48) assert_in_range(f.shown.spans_unchanged, 1, columns * rows - 1);
      }
    }
}

// What was there shows again where an object is taken away, and an object that stays is drawn where another one goes from before it.
SPANTEX_CASE(random_changes_are_drawn) {
  static film f;
  const auto maps = make_maps();
  random_source random(71);
  uint64_t kept = 0, changed = 0;
  const alpha_mode modes[] = {alpha_mode::opaque, alpha_mode::cut_out, alpha_mode::blended, alpha_mode::premultiplied};
  for (int run = 0; run < (short_run() ? 16 : 32); ++run) {
    f = {};
    struct square { int32_t x, y, z, half, map; rgba8 colour; };
    std::vector<square> all;
    const auto some = [&] {
      const uint8_t a = uint8_t(random.between(0, 255));
      return square{int32_t(random.between(-30, 30)), int32_t(random.between(-20, 20)), int32_t(32 + 8 * random.between(0, 3)), int32_t(random.between(2, 20)),
                    int32_t(random.between(0, 1)), random.between(0, 1) != 0 ? white : rgba8{a, 255, a, a}};
    };
    for (int k = 0; k < 8; ++k) all.push_back(some());
    draw_options o = options_of(run % 3 == 0 ? filter::nearest : filter::trilinear);
    o.how.alpha = modes[run % 4];
    for (int frame = 0; frame < 12; ++frame) {
      scene s = empty_scene(maps);
      add_wall(s, 48, 0);
      for (const square& q : all) {
        const rgba8 colours[4] = {q.colour, q.colour, q.colour, q.colour};
        add_square(s, q.x, q.y, q.z, q.half, q.map, colours);
      }
      f.show(s, o);
      kept += uint64_t(f.shown.spans_unchanged);
      changed += uint64_t(columns * rows - f.shown.spans_unchanged);
      const size_t at = size_t(random.between(0, int64_t(all.size()) - 1));
      switch (random.between(0, 5)) {
        case 0: all[at] = some(); break;
        case 1: all.insert(all.begin() + std::ptrdiff_t(at), some()); break;
        case 2: if (all.size() > 3) all.erase(all.begin() + std::ptrdiff_t(at)); break;
        case 3: std::swap(all[at], all.back()); break;
        case 4: std::rotate(all.begin(), all.begin() + std::ptrdiff_t(at), all.end()); break;
        default: all.push_back(all[at]); break;  // the same one twice
      }
    }
  }
  assert_true(kept > changed / 4 && changed > kept / 4);
}

// --- whatever a pixel depends on -----------------------------------------------------------------------

// The change shows, and is drawn after the frame without it.
void is_drawn(const scene& s, const draw_options& o, const scene& changed, const draw_options& how, int line = __builtin_LINE()) {
  static film f;
  f = {};
  f.show(s, o);
  const image was = f.shown.picture;
  f.show(changed, how);
  if (f.shown.picture.pixels == was.pixels) fail_msg("line %d: the change does not show", line);
}

scene wall_of(const std::shared_ptr<const map_list>& maps) {
  scene s = empty_scene(maps);
  add_wall(s, 48, 0);
  return s;
}

SPANTEX_CASE(each_coefficient_counts) {
  scene base = empty_scene(make_maps());
  add_slanted(base, plain);
  const draw_options o = options_of(filter::bilinear);
  static image picture;
  picture = draw(base, o).picture;
  using number = std::function<int64_t&(drawable&)>;
  std::vector<number> numbers;
  for (const auto form : {&plane::u, &plane::v, &plane::w})
    for (const auto k : {&linear_form::x, &linear_form::y, &linear_form::c})
      numbers.emplace_back([=](drawable& d) -> int64_t& { return d.shape.map.*form.*k; });
  for (const auto k : {&edge::a, &edge::b, &edge::c}) numbers.emplace_back([=](drawable& d) -> int64_t& { return d.shape.edges.edges[0].*k; });
  for (const number& n : numbers) {
    // The lowest bit that shows, and the lowest of all, which keeps nothing either.
    scene changed = base;
    int bit = 0;
    for (; bit < 44; ++bit) {
      changed = base;
      n(changed.items[0]) ^= int64_t(1) << bit;
      if (draw(changed, o).picture.pixels != picture.pixels) break;
    }
    assert_in_range(bit, 0, 43);
    is_drawn(base, o, changed, o);
    changed = base;
    n(changed.items[0]) ^= 1;
    frame_before before;
    draw(base, o, &before);
    assert_int_equal(draw(changed, o, &before).spans_unchanged, 0);
  }
}

SPANTEX_CASE(depths_count) {
  scene base = empty_scene(make_maps());
  add_wall(base, 48, 0);
  add_square(base, 0, 0, 40, 10, 1);
  const draw_options o = options_of(filter::bilinear);
  for (const auto k : {&linear_form::x, &linear_form::y, &linear_form::c}) {
    scene changed = base;
    changed.items[1].shape.depth.*k -= int64_t(1) << (k == &linear_form::c ? 45 : 42);
    is_drawn(base, o, changed, o);
  }
}

SPANTEX_CASE(maps_count) {
  const auto maps = make_maps();
  const scene base = wall_of(maps);
  const draw_options o = options_of(filter::trilinear);
  const auto with = [&](texture_map map) {
    map_list list;
    list.push_back(std::move(map));
    list.emplace_back(squares_pattern(64, 8), prefilter::box, wrap::repeat, wrap::repeat);
    return wall_of(std::make_shared<const map_list>(std::move(list)));
  };
  image picture = grains();
  frame_before before;
  draw(base, o, &before);
  assert_int_equal(draw(with({picture, prefilter::box, wrap::repeat, wrap::repeat}), o, &before).spans_unchanged, columns * rows);
  is_drawn(base, o, with({picture, prefilter::triangle, wrap::repeat, wrap::repeat}), o);
  is_drawn(base, o, with({picture, prefilter::box, wrap::mirror, wrap::repeat}), o);
  is_drawn(base, o, with({picture, prefilter::box, wrap::repeat, wrap::clamp}), o);
  is_drawn(base, o, with({picture, prefilter::box, wrap::repeat, wrap::repeat, texel_format::rgb565}), o);
  is_drawn(base, o, with({picture, prefilter::box, wrap::repeat, wrap::repeat, texel_format::rgba8888, colour_space::coded, 1}), o);
  {
    texture_map linear(picture, prefilter::box, wrap::repeat, wrap::repeat);
    linear.set_colours(colour_space::srgb);
    is_drawn(base, o, with(std::move(linear)), o);
  }
  {
    contour_style style;
    style.threshold = 100 << 8;
    texture_map field(picture, prefilter::box, wrap::repeat, wrap::repeat);
    field.set_contour(style);
    is_drawn(base, options_of(filter::contour), with(std::move(field)), options_of(filter::contour));
  }
  picture.at(9, 9).g ^= 255;  // one texel
  is_drawn(base, o, with({picture, prefilter::box, wrap::repeat, wrap::repeat}), o);
  // The same list with another map in the same place.
  static film f;
  f = {};
  f.show(base, o);
  (*maps)[0] = texture_map(picture, prefilter::box, wrap::repeat, wrap::repeat);
  f.show(base, o);
  assert_int_equal(f.shown.spans_unchanged, 0);
  scene other = base;
  other.items[0].map_index = 1;
  is_drawn(base, o, other, o);
}

SPANTEX_CASE(write_out_counts) {
  const auto maps = make_maps();
  draw_options o = options_of(filter::trilinear);
  o.how.alpha = alpha_mode::cut_out;
  o.how.threshold = 60;
  const std::function<void(draw_options&)> changes[] = {
      [](draw_options& d) { d.kind = filter::bilinear; },
      [](draw_options& d) { d.profile = profile_choice::seed; },
      [](draw_options& d) { d.changes.level = level_formula::minor; },
      [](draw_options& d) { d.how.alpha = alpha_mode::blended; },
      [](draw_options& d) { d.how.threshold = 90; },
  };
  scene half = empty_scene(maps), shaded = half;  // with some background
  add_slanted(half, plain);
  add_slanted(shaded, faint);
  for (const auto& change : changes) {
    draw_options changed = o;
    change(changed);
    is_drawn(shaded, o, shaded, changed, int(&change - changes));
  }
  is_drawn(half, o, shaded, o);
  draw_options changed = o;
  changed.background = {1, 2, 3, 255};
  is_drawn(half, o, half, changed);
  const scene plane = make_named_scene("tilted", request());
  changed = options_of(filter::bilinear);
  changed.how.colour = {200, 255, 255, 255};
  is_drawn(plane, options_of(filter::bilinear), plane, changed);
  o = changed = options_of(filter::contour);
  changed.threshold = uint16_t(90 << 8);
  is_drawn(plane, o, plane, changed);
  changed = o;
  changed.outline = uint8_t(32);
  is_drawn(plane, o, plane, changed);
  o.threshold = uint16_t(254 << 8);
  changed = o;
  changed.field_scale = uint16_t(16);
  is_drawn(plane, o, plane, changed);
  // Vertex colours that vary.
  const rgba8 ramp[4] = {{255, 0, 0, 255}, {0, 255, 0, 255}, {0, 0, 255, 255}, {0, 0, 255, 255}}, other[4] = {{255, 0, 0, 255}, {0, 254, 0, 255}, {0, 0, 255, 255}, {0, 0, 255, 255}};
  scene a = empty_scene(maps), b = a;
  add_square(a, 0, 0, 40, 12, 1, ramp);
  add_square(b, 0, 0, 40, 12, 1, other);
  is_drawn(a, options_of(filter::nearest), b, options_of(filter::nearest));
}

SPANTEX_CASE(other_frames_start_afresh) {
  static film f;
  f = {};
  const scene s = wall_of(make_maps());
  f.show(s, options_of(filter::bilinear));
  scene small = s;
  small.size = {size.width_px, size.height_px - 8};
  f.show(small, options_of(filter::bilinear));
  assert_int_equal(f.shown.spans_unchanged, 0);
  f.show(empty_scene(s.maps), options_of(filter::bilinear));
  assert_int_equal(f.shown.spans_unchanged, 0);
  // In object space pixels are not of spans.
  draw_options o = options_of(filter::bilinear);
  o.space = sampling_space::object;
  frame_before before;
  draw(s, o, &before);
  assert_int_equal(draw(s, o, &before).spans_unchanged, 0);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(a_moving_object_leaves_its_background),
      cmocka_unit_test(a_still_frame_costs_nothing),
      cmocka_unit_test(a_moving_camera_keeps_nothing),
      cmocka_unit_test(what_moves_unseen_changes_nothing),
      cmocka_unit_test(random_changes_are_drawn),
      cmocka_unit_test(each_coefficient_counts),
      cmocka_unit_test(depths_count),
      cmocka_unit_test(maps_count),
      cmocka_unit_test(write_out_counts),
      cmocka_unit_test(other_frames_start_afresh),
  };
  return run_suite("unchanged", tests);
}
