// SPDX-License-Identifier: Apache-2.0
// Global texture memory: uploading maps, and how much of it loading sections reads, against the address of everything the loader asks for.
#include <cstring>
#include <set>

#include <sim/draw_host.hpp>
#include <sim/figures.hpp>
#include <tests/formats.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

uint64_t words[4000];

status upload(global_memory& memory, texel_format f, const raw_map& m, texture_view& out) {
  const void* levels[max_levels] = {};
  for (size_t k = 0; k < m.levels.size(); ++k) levels[k] = m.levels[k].data();
  return memory.upload(f, levels, int(m.levels.size()), m.view.width(), m.view.height(), m.view.wrap_u(), m.view.wrap_v(), out, m.colours.data(),
                       int(m.colours.size()));
}

}  // namespace

SPANTEX_CASE(an_uploaded_map_is_a_copy_that_takes_whole_words) {
  for (const texel_format f : all_formats) {
    raw_map m = random_map(f, 21, 6, wrap::repeat, wrap::clamp, 4);
    const texture_view before = random_map(f, 21, 6, wrap::repeat, wrap::clamp, 4).view;
    std::memset(words, 0xA5, sizeof words);
    global_memory memory(words, 4000);
    texture_view first, second;
    SPANTEX_ASSERT_OK(upload(memory, f, m, first));
    size_t expected = (m.colours.size() * 4 + 7) / 8;
    for (int k = 0; k < 5; ++k) expected += (level_bytes(f, level_side(21, k), level_side(6, k)) + 7) / 8;
    assert_int_equal(memory.words_used(), expected);
    assert_int_equal(memory.words_moved(), expected);
    assert_int_equal(global_memory::words_for(f, 5, 21, 6, int(m.colours.size())), expected);
    SPANTEX_ASSERT_OK(upload(memory, f, m, second));
    assert_int_equal(memory.words_used(), 2 * expected);
    assert_int_equal(memory.words_free(), 4000 - 2 * expected);
    assert_true(words[2 * expected] == 0xA5A5A5A5A5A5A5A5u);
    for (bytes& level : m.levels) std::memset(level.data(), 0, level.size());  // the caller's bytes are not needed any more
    for (rgba8& c : m.colours) c = {1, 2, 3, 4};
    for (int level = 0; level < 5; ++level)
      for (int32_t y = 0; y < level_side(6, level); ++y)
        for (int32_t x = 0; x < level_side(21, level); ++x) {
          assert_true(first.texel(level, x, y) == before.texel(level, x, y));
          assert_true(second.texel(level, x, y) == before.texel(level, x, y));
        }
    assert_true(first.wrap_u() == wrap::repeat && first.wrap_v() == wrap::clamp && first.format() == f);
    assert_false(first.id(0) == second.id(0));
    memory.reset();
    assert_int_equal(memory.words_used(), 0);
    assert_int_equal(memory.words_moved(), 2 * expected);
  }
}

SPANTEX_CASE(a_map_that_does_not_fit_is_refused_and_nothing_is_touched) {
  const raw_map& m = random_map(texel_format::palette8, 16, 16, wrap::repeat, wrap::repeat, 1);
  const size_t needed = global_memory::words_for(texel_format::palette8, 5, 16, 16, int(m.colours.size()));
  texture_view t;
  for (size_t size : {size_t(0), size_t(1), needed - 1}) {
    std::memset(words, 0xA5, sizeof words);
    global_memory memory(words, size);
    SPANTEX_ASSERT_STATUS(upload(memory, texel_format::palette8, m, t), out_of_memory);
    assert_int_equal(memory.words_used(), 0);
    assert_int_equal(memory.words_moved(), 0);
    for (const uint64_t w : words) assert_true(w == 0xA5A5A5A5A5A5A5A5u);
  }
  global_memory memory(words, needed);
  SPANTEX_ASSERT_OK(upload(memory, texel_format::palette8, m, t));
  assert_int_equal(memory.words_free(), 0);
  SPANTEX_ASSERT_STATUS(upload(memory, texel_format::palette8, m, t), out_of_memory);
}

SPANTEX_CASE(what_a_view_refuses_is_not_uploaded) {
  global_memory memory(words, 4000);
  texture_view t;
  const void* levels[] = {words, nullptr};
  const auto with = [&](int count, int32_t w, int32_t h, int colours) {
    return memory.upload(texel_format::palette4, levels, count, w, h, wrap::repeat, wrap::repeat, t, reinterpret_cast<const rgba8*>(words), colours);
  };
  SPANTEX_ASSERT_STATUS(with(1, 0, 4, 16), bad_size);
  SPANTEX_ASSERT_STATUS(with(2, 4, 4, 16), bad_pointer);
  SPANTEX_ASSERT_STATUS(with(4, 4, 4, 16), bad_levels);
  SPANTEX_ASSERT_STATUS(with(1, 4, 4, 17), out_of_range);
  assert_int_equal(memory.words_used(), 0);
}

namespace {

// Notes the words of every byte that the loader asks for.
struct watched_view : texture_view {
  mutable std::set<uint32_t> words;
  void note(uint32_t begin, uint32_t bytes) const {
    for (uint32_t k = begin / 8; k <= (begin + bytes - 1) / 8; ++k) words.insert(k);
  }
  rgba8 texel(int level, int32_t x, int32_t y) const {
    const uint32_t w = uint32_t(width(level)), n = uint32_t(y) * w + uint32_t(x);
    if (format() == texel_format::palette4) note(uint32_t(y) * ((w + 1) / 2) + uint32_t(x) / 2, 1);
    else note(n * uint32_t(texel_bits(format()) / 8), uint32_t(texel_bits(format()) / 8));
    return {};
  }
  void decode_block(int level, int32_t bx, int32_t by, texel_block& out) const {
    note(uint32_t(by * ((width(level) + 3) / 4) + bx) * block_bytes(format()), block_bytes(format()));
    out = {};
  }
};

}  // namespace

SPANTEX_CASE(words_read_are_those_that_hold_what_is_loaded) {
  random_source random(23);
  for (const texel_format f : all_formats)
    for (const wrap mode : all_wraps)
      for (const auto& [width, height] : {std::pair{64, 64}, {37, 23}, {9, 40}, {3, 1}}) {
        watched_view t;
        static_cast<texture_view&>(t) = random_map(f, width, height, mode, wrap::repeat, 2).view;
        for (int n = 0; n < 50; ++n) {
          t.words.clear();
          run_time_profile prof{profiles::exact};
          prof.value.fine_side = n % 3 == 0 ? 8 : n % 3 == 1 ? 16 : 32;
          const bool coarse = n % 2 != 0;
          const int side = coarse ? prof.value.fine_side / 2 : prof.value.fine_side;
          const auto [at, box] = random_section(random, t, side);
          SPANTEX_ASSERT_OK(load_section(prof, t, at, box, coarse, [](int, const uint64_t*, int) { return status::ok; }));
          assert_int_equal(section_reads(prof, t, at, box, coarse), t.words.size());
        }
      }
}

namespace {

// Words that all sections of 16 x 16 texels at 8 x 8 origins read.
uint32_t reads_of_all_offsets(texel_format f) {
  const texture_view t = random_map(f, 64, 64, wrap::repeat, wrap::repeat, 2).view;
  run_time_profile prof{profiles::exact};
  prof.value.fine_side = 16;
  uint32_t sum = 0;
  for (int32_t v = 0; v < 8; ++v)
    for (int32_t u = 0; u < 8; ++u) {
      section at{};
      at.origin_u = u;
      at.origin_v = v;
      sum += section_reads(prof, t, at, {u, v, u + 15, v + 15}, false);
    }
  return sum;
}

draw_result drawn(texel_format f, profile_choice profile) {
  scene_request r;
  r.size = {320, 240};
  r.texture = photograph("brick.png");
  r.format = f;
  draw_options o;
  o.profile = profile;
  o.kind = filter::trilinear;
  o.counted = true;
  o.skips = default_skips;  // compression makes sections uniform that were not, and those would not be loaded
  return draw(make_named_scene("tilted", r), o);
}

}  // namespace

// Exactly 1/8 and 1/4 where a section's borders are those of blocks; more where they cut blocks, which are read whole.
SPANTEX_CASE(compressed_maps_read_an_eighth_or_a_quarter_plus_the_cut_blocks) {
  run_time_profile prof{profiles::exact};
  prof.value.fine_side = 16;
  const auto aligned = [&](texel_format f) {
    return section_reads(prof, random_map(f, 64, 64, wrap::repeat, wrap::repeat, 2).view, section{}, {0, 0, 15, 15}, false);
  };
  assert_int_equal(aligned(texel_format::rgba8888), 128);
  assert_int_equal(aligned(texel_format::rgb888), 96);
  assert_int_equal(aligned(texel_format::rgb565), 64);
  assert_int_equal(aligned(texel_format::palette8), 32);
  assert_int_equal(aligned(texel_format::palette4), 16);
  for (const texel_format f : {texel_format::bc1, texel_format::etc1, texel_format::etc2_rgb8, texel_format::etc2_rgb8a1}) assert_int_equal(aligned(f), 16);
  for (const texel_format f : {texel_format::bc2, texel_format::bc3, texel_format::etc2_rgba8}) assert_int_equal(aligned(f), 32);
  // At any origin: 16 rows of 8 words, or 9 at odd ones: 136 on average; 4 blocks, or 5 at three origins in four: (4 + 3/4)^2 = 22.56.
  assert_int_equal(reads_of_all_offsets(texel_format::rgba8888), 64 * 136);
  assert_int_equal(reads_of_all_offsets(texel_format::bc1), 64 * 22.5625);
  assert_int_equal(reads_of_all_offsets(texel_format::bc3), 2 * 64 * 22.5625);
}

SPANTEX_CASE(pictures_from_compressed_maps_read_far_less) {
  struct expected { texel_format format; double least_share, most_share; };
  for (const profile_choice p : {profile_choice::standard, profile_choice::exact}) {
    const draw_result plain = drawn(texel_format::rgba8888, p);
    print_message("rgba8888: %llu words read, %llu loaded, %llu uploaded\n", static_cast<unsigned long long>(plain.work.words_read),
                  static_cast<unsigned long long>(plain.work.words_loaded), static_cast<unsigned long long>(plain.words_uploaded));
    for (const expected& e : {expected{texel_format::rgb565, 0.5, 0.7}, {texel_format::palette8, 0.25, 0.5}, {texel_format::bc1, 0.125, 0.25},
                              {texel_format::etc2_rgb8, 0.125, 0.25}, {texel_format::bc3, 0.25, 0.5}, {texel_format::etc2_rgba8, 0.25, 0.5}}) {
      const draw_result r = drawn(e.format, p);
      const double share = double(r.work.words_read) / double(plain.work.words_read);
      print_message("%s: %llu words read, %.4f of rgba8888\n", std::string(name_of(format_names, e.format)).c_str(),
                    static_cast<unsigned long long>(r.work.words_read), share);
      assert_int_equal(r.work.words_loaded, plain.work.words_loaded);
      assert_true(share > e.least_share && share < e.most_share);
    }
  }
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(an_uploaded_map_is_a_copy_that_takes_whole_words),
      cmocka_unit_test(a_map_that_does_not_fit_is_refused_and_nothing_is_touched),
      cmocka_unit_test(what_a_view_refuses_is_not_uploaded),
      cmocka_unit_test(words_read_are_those_that_hold_what_is_loaded),
      cmocka_unit_test(compressed_maps_read_an_eighth_or_a_quarter_plus_the_cut_blocks),
      cmocka_unit_test(pictures_from_compressed_maps_read_far_less),
  };
  return run_suite("global_memory", tests);
}
