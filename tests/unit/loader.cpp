// SPDX-License-Identifier: Apache-2.0
// The loader: every texel of a box is found in local memory where the address unit looks for it, and nothing is sent twice.
#include <tests/support.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

template <int Side>
struct loading {
  local_memory<Side> memory;
  uint8_t sent[local_memory<Side>::word_count];
  int words;
};

template <int Side>
loading<Side> loaded;

// A section of the map that holds a random box, as the planner would place it.
struct placed { section at; texel_box box; };

placed random_section(random_source& random, int side, int level) {
  placed p{};
  p.at.level = uint8_t(level);
  const auto axis = [&](int32_t& origin, int32_t& low, int32_t& high) {
    origin = int32_t(random.between(-3 * side - 40, 3 * side + 40));
    low = origin + int32_t(random.between(0, side - 1));
    high = int32_t(random.between(low, origin + side - 1));
  };
  axis(p.at.origin_u, p.box.u0, p.box.u1);
  axis(p.at.origin_v, p.box.v0, p.box.v1);
  return p;
}

template <int Side>
void load(const texture_view& t, const placed& p, bool coarse) {
  run_time_profile prof{profiles::exact};
  prof.value.fine_side = Side;
  loading<Side>& l = loaded<Side>;
  l = {};
  SPANTEX_ASSERT_OK(load_section(prof, t, p.at, p.box, coarse, [&](int first, const uint64_t* words, int count) {
    assert_true(first >= 0 && count > 0 && first + count <= local_memory<Side>::word_count);
    assert_true((first >= local_memory<Side>::coarse_first_word) == coarse);
    for (int k = 0; k < count; ++k) assert_int_equal(l.sent[first + k]++, 0);
    l.words += count;
    return l.memory.load(first, words, count);
  }));
}

uint32_t channel_of(rgba8 c, int k) { return k == 0 ? c.r : k == 1 ? c.g : k == 2 ? c.b : c.a; }

// Every 2x2 of the box, in every channel.
template <int Side>
void check_box(const texture_view& t, const placed& p, bool coarse) {
  const int side = coarse ? Side / 2 : Side, level = p.at.level;
  for (int32_t y = p.box.v0; y <= p.box.v1; ++y)
    for (int32_t x = p.box.u0; x <= p.box.u1; ++x) {
      const local_position at{x & (side - 1), y & (side - 1)};
      for (int c = 0; c < channel_count; ++c) {
        const local_position none{0, 0};
        const fetched f = loaded<Side>.memory.fetch(c, coarse ? none : at, coarse ? at : none, no_observer{});
        for (int k = 0; k < 4; ++k) {
          const int32_t u = x + (k & 1), v = y + (k >> 1);
          if (u > p.box.u1 || v > p.box.v1) continue;
          const uint32_t got = coarse ? coarse_texel(f, k) : fine_texel(f, k);
          assert_int_equal(got, channel_of(t.texel(level, t.wrapped_u(u, level), t.wrapped_v(v, level)), c));
        }
      }
    }
}

// Blocks of 2x2, aligned, that a range touches in local memory (its ends may share one through the torus).
int blocks_touched(int32_t low, int32_t high, int side) { return min_of(side / 2, int((high >> 1) - (low >> 1) + 1)); }

template <int Side>
void check_random_sections(uint64_t seed) {
  random_source random(seed);
  for (const wrap w : all_wraps)
    for (const synthetic_map* m : {&photographic_map(64, 32), &photographic_map(100, 37), &photographic_map(3, 1)}) {
      const texture_view t = m->view(w, w == wrap::mirror ? wrap::repeat : wrap::mirror);
      for (int n = 0; n < 60; ++n) {
        const bool coarse = n % 3 == 0;
        const int side = coarse ? Side / 2 : Side;
        const placed p = random_section(random, side, int(random.next() % uint64_t(t.level_count())));
        load<Side>(t, p, coarse);
        check_box<Side>(t, p, coarse);
        assert_int_equal(loaded<Side>.words, 2 * blocks_touched(p.box.u0, p.box.u1, side) * blocks_touched(p.box.v0, p.box.v1, side));
      }
    }
}

}  // namespace

SPANTEX_CASE(every_texel_of_a_box_is_found_for_8x8) { check_random_sections<8>(90); }
SPANTEX_CASE(every_texel_of_a_box_is_found_for_16x16) { check_random_sections<16>(91); }
SPANTEX_CASE(every_texel_of_a_box_is_found_for_32x32) { check_random_sections<32>(92); }

SPANTEX_CASE(a_full_section_fills_local_memory_whatever_its_origin) {
  const texture_view t = photographic_map(64, 64).view(wrap::repeat, wrap::clamp);
  for (int32_t v = -9; v <= 9; ++v)
    for (int32_t u = -9; u <= 9; ++u) {
      placed p{};
      p.at.origin_u = u;
      p.at.origin_v = v;
      p.box = {u, v, u + 7, v + 7};
      load<8>(t, p, false);
      check_box<8>(t, p, false);
      assert_int_equal(loaded<8>.words, 32);
    }
}

SPANTEX_CASE(load_words_hold_a_block_of_two_channels) {
  const rgba8 four[4] = {{1, 2, 3, 4}, {5, 6, 7, 8}, {9, 10, 11, 12}, {13, 14, 15, 16}};
  const block_words w = pack_block(four);
  assert_true(w.red_green == 0x0E0A06020D090501u);
  assert_true(w.blue_alpha == 0x100C08040F0B0703u);
}

SPANTEX_CASE(a_send_that_fails_ends_loading_with_its_status) {
  const fixed_profile<profiles::exact> prof;
  const texture_view t = photographic_map(64, 64).view(wrap::repeat, wrap::repeat);
  placed p{};
  p.box = {0, 0, 31, 31};
  int calls = 0;
  SPANTEX_ASSERT_STATUS(load_section(prof, t, p.at, p.box, false, [&](int, const uint64_t*, int) {
    return ++calls == 3 ? status::device_error : status::ok;
  }), device_error);
  assert_int_equal(calls, 3);
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(every_texel_of_a_box_is_found_for_8x8),
      cmocka_unit_test(every_texel_of_a_box_is_found_for_16x16),
      cmocka_unit_test(every_texel_of_a_box_is_found_for_32x32),
      cmocka_unit_test(a_full_section_fills_local_memory_whatever_its_origin),
      cmocka_unit_test(load_words_hold_a_block_of_two_channels),
      cmocka_unit_test(a_send_that_fails_ends_loading_with_its_status),
  };
  return run_suite("loader", tests);
}
