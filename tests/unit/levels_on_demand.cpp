// SPDX-License-Identifier: Apache-2.0
// Levels that no span reads are not uploaded, nor averaged where no coarser one is read; blocks that no section touches are not decoded. The picture and all
// other counts are those of a map whose levels are all there.
#include <memory>
#include <set>
#include <tuple>

#include <sim/draw_host.hpp>
#include <sim/figures.hpp>
#include <sim/pattern.hpp>
#include <tests/support.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

constexpr screen_size size{80, 60};
constexpr rectangle area{0, 0, size.width_px, size.height_px};
constexpr fixed_profile<profiles::standard> prof{};

image grains() {
  image picture = random_pattern(128, 5);
  for (rgba8& c : picture.pixels) c.a = c.r;
  return picture;
}

// A plane that is minified by `scale` at the left and more to the right.
scene plane_of_scale(double scale, texel_format format, level_making when, prefilter kind = prefilter::box, wrap mode = wrap::repeat) {
  map_list maps;
  maps.emplace_back(grains(), kind, mode, mode, format, colour_space::coded, 0, when);
  scene s{"plane", size, std::make_shared<const map_list>(std::move(maps)), {}};
  add_plane(s, {scale, 0.1 * scale, 3, 0, scale, 5, -0.3 / size.width_px, 0, 1}, 0);
  return s;
}

draw_options options_of(filter kind, engine_choice engine = engine_choice::simulated) {
  draw_options o;
  o.kind = kind;
  o.engine = engine;
  o.skips = usual_skips & ~only(skip::uniform);
  return o;
}

template <class Each>
void each_job(const scene& s, filter kind, Each each) {
  const texture_view& t = s.map_of(s.items[0]).view_on_demand();
  for (int32_t sy = 0; sy * span_side < size.height_px; ++sy)
    for (int32_t sx = 0; sx * span_side < size.width_px; ++sx)
      SPANTEX_ASSERT_OK(plan_span(prof, surface{&s.items[0].shape.map, &t, kind}, sx, sy, rectangle_mask(area, sx, sy), [&](span_job& job) {
        each(t, job);
        return status::ok;
      }));
}

SPANTEX_CASE(levels_are_made_when_a_span_reads_them) {
  int left_out = 0, read = 0;
  for (const filter kind : {filter::bilinear, filter::mip_bilinear, filter::trilinear, filter::aniso})
    for (const texel_format format : {texel_format::rgba8888, texel_format::rgb565, texel_format::palette4, texel_format::bc3, texel_format::etc2_rgb8})
      for (const double scale : {0.3, 3.0, 20.0}) {
        const scene whole = plane_of_scale(scale, format, level_making::at_once), s = plane_of_scale(scale, format, level_making::on_demand);
        const draw_options o = options_of(kind);
        const draw_result all = draw(whole, o), r = draw(s, o);
        assert_true(r.picture.pixels == all.picture.pixels);
        assert_int_equal(r.work.words_read, all.work.words_read);
        assert_int_equal(r.work.words_loaded, all.work.words_loaded);
        assert_int_equal(r.blocks_decoded, all.blocks_decoded);
        std::set<int> levels;
        each_job(s, kind, [&](const texture_view&, const span_job& job) {
          levels.insert(job.coefficients.fine.level);
          if (job.coefficients.two_levels) levels.insert(job.coefficients.coarse.level);
        });
        const texture_map& map = (*s.maps)[0];
        assert_int_equal(r.levels_left_out, map.level_count() - int(levels.size()));
        assert_int_equal(all.levels_left_out, 0);
        uint64_t words = palette_size(format) / 2;
        for (const int k : levels) words += (level_bytes(format, level_side(128, k), level_side(128, k)) + 7) / 8;
        assert_int_equal(r.words_uploaded, words);
        left_out += r.levels_left_out;
        read += int(levels.size());
        if (format != texel_format::rgba8888) continue;
        for (int k = 0; k < map.level_count(); ++k)  // what was not read is not there
          if (!levels.contains(k)) assert_true(map.view_on_demand().texel(k, 0, 0) == (rgba8{0, 0, 0, 0}));
      }
  assert_true(left_out > 100 && read > 100);
}

SPANTEX_CASE(threads_make_a_level_once) {
  const scene alone = plane_of_scale(3, texel_format::bc1, level_making::on_demand);
  const draw_result one = draw(alone, options_of(filter::trilinear));
  for (int n = 0; n < 20; ++n) {
    const scene s = plane_of_scale(3, texel_format::bc1, level_making::on_demand);
    draw_options o = options_of(filter::trilinear, engine_choice::direct);
    o.kernel = kernels::choice::scalar;
    o.threads = 5;
    const draw_result r = draw(s, o);
    assert_true(r.picture.pixels == one.picture.pixels);
    assert_int_equal(r.words_uploaded, one.words_uploaded);
    assert_int_equal(r.levels_left_out, one.levels_left_out);
  }
}

// Who asks for the whole map gets the bytes of one made at once; a kernel does.
SPANTEX_CASE(a_view_has_all_levels) {
  for (const prefilter kind : {prefilter::box, prefilter::triangle, prefilter::kaiser, prefilter::lanczos})
    for (int f = 0; f < texel_format_count; ++f) {
      const scene whole = plane_of_scale(1, texel_format(f), level_making::at_once, kind, wrap::mirror), s = plane_of_scale(1, texel_format(f), level_making::on_demand, kind, wrap::mirror);
      const texture_view &a = whole.texture(whole.items[0]), &b = s.texture(s.items[0]);
      assert_int_equal(a.level_count(), b.level_count());
      for (int k = 0; k < a.level_count(); ++k)
        for (int32_t y = 0; y < a.height(k); ++y)
          for (int32_t x = 0; x < a.width(k); ++x) assert_true(a.texel(k, x, y) == b.texel(k, x, y));
      assert_true(a.facts().opaque == b.facts().opaque);
    }
  const scene whole = plane_of_scale(1, texel_format::rgba8888, level_making::at_once), s = plane_of_scale(1, texel_format::rgba8888, level_making::on_demand);
  draw_options o;
  o.kind = filter::trilinear;
  o.kernel = kernels::choice::words;
  assert_true(draw(s, o).picture.pixels == draw(whole, o).picture.pixels);
  assert_int_equal(draw(s, o).levels_left_out, 0);
}

// --- blocks --------------------------------------------------------------------------------------------

using block_name = std::tuple<int, int32_t, int32_t>;  // level, across, down

// Notes every block that the loader decodes.
struct watched_map {
  const texture_view& map;
  std::vector<block_name>& decoded;
  operator const texture_view&() const { return map; }
  texel_format format() const { return map.format(); }
  rgba8 texel(int level, int32_t x, int32_t y) const { return map.texel(level, x, y); }
  void decode_block(int level, int32_t bx, int32_t by, texel_block& out) const {
    decoded.emplace_back(level, bx, by);
    map.decode_block(level, bx, by, out);
  }
};

SPANTEX_CASE(blocks_are_decoded_where_sections_touch_them) {
  for (const texel_format format : {texel_format::bc1, texel_format::bc2, texel_format::bc3, texel_format::etc1, texel_format::etc2_rgba8})
    for (const double scale : {0.1, 1.0, 3.0}) {
      const scene s = plane_of_scale(scale, format, level_making::at_once);
      std::vector<block_name> decoded;
      std::set<block_name> touched;
      each_job(s, filter::trilinear, [&](const texture_view& t, const span_job& job) {
        const auto load = [&](const section& at, const texel_box& box, bool coarse) {
          SPANTEX_ASSERT_OK(load_section(prof, watched_map{t, decoded}, at, box, coarse, [](int, const uint64_t*, int) { return status::ok; }));
          // A load word has 2x2 texels: with each of the box its neighbour in the pair, which before the section's origin is the one at its far end.
          const int32_t side = coarse ? prof.get().coarse_side() : prof.get().fine_side;
          const auto held = [&](int32_t k, int32_t origin) { return k < origin ? k + side : k; };
          for (int32_t v = box.v0 & ~1; v <= (box.v1 | 1); ++v)
            for (int32_t u = box.u0 & ~1; u <= (box.u1 | 1); ++u)
              touched.emplace(at.level, t.wrapped_u(held(u, at.origin_u), at.level) / block_side, t.wrapped_v(held(v, at.origin_v), at.level) / block_side);
        };
        load(job.coefficients.fine, job.fine, false);
        if (job.coefficients.two_levels) load(job.coefficients.coarse, job.coarse, true);
      });
      draw_options o = options_of(filter::trilinear);
      o.skips = default_skips & ~only(skip::held);  // each section is loaded
      const draw_result r = draw(s, o);
      assert_int_equal(r.blocks_decoded, decoded.size());
      const std::set<block_name> once(decoded.begin(), decoded.end());
      for (const block_name& b : once) assert_true(touched.contains(b));
      uint64_t all = 0;
      for (int k = 0; k < s.texture(s.items[0]).level_count(); ++k) all += uint64_t(blocks_across(level_side(128, k)) * blocks_across(level_side(128, k)));
      assert_true(once.size() < all);
      if (scale < 0.5) assert_true(once.size() * 8 < all);
      o.skips = default_skips;
      assert_true(draw(s, o).blocks_decoded <= r.blocks_decoded);
    }
  assert_int_equal(draw(plane_of_scale(1, texel_format::rgb565, level_making::at_once), options_of(filter::trilinear)).blocks_decoded, 0);
}

}  // namespace

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(levels_are_made_when_a_span_reads_them),
      cmocka_unit_test(threads_make_a_level_once),
      cmocka_unit_test(a_view_has_all_levels),
      cmocka_unit_test(blocks_are_decoded_where_sections_touch_them),
  };
  return run_suite("levels_on_demand", tests);
}
