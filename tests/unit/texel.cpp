// SPDX-License-Identifier: Apache-2.0
// 16-bit texel formats over all 2^16 numbers, and pictures drawn from them in every filter, wrap mode and profile.
#include "tests/support.hpp"

using namespace spantex;
using namespace spantex::sim;

namespace {

constexpr texel_format packed_formats[] = {texel_format::rgb565, texel_format::argb1555, texel_format::argb4444};

struct widths { int r, g, b, a; };
constexpr widths widths_of(texel_format f) {
  return f == texel_format::rgb565 ? widths{5, 6, 5, 0} : f == texel_format::argb1555 ? widths{5, 5, 5, 1} : widths{4, 4, 4, 4};
}

// value / (2^bits - 1) as a share of 255, to nearest: |2 (2^bits - 1) result - 2 255 value| <= 2^bits - 1
bool is_nearest(uint8_t result, uint32_t value, int bits) {
  const int64_t most = (int64_t(1) << bits) - 1;
  return std::abs(2 * most * result - 2 * 255 * int64_t(value)) <= most;
}

uint32_t field(uint32_t raw, int shift, int bits) { return (raw >> shift) & ((1u << bits) - 1); }

}  // namespace

SPANTEX_CASE(every_16_bit_number_unpacks_to_the_nearest_8_bits) {
  for (texel_format f : packed_formats) {
    const widths w = widths_of(f);
    for (uint32_t raw = 0; raw < 1u << 16; ++raw) {
      const rgba8 c = unpack(f, uint16_t(raw));
      assert_true(is_nearest(c.b, field(raw, 0, w.b), w.b));
      assert_true(is_nearest(c.g, field(raw, w.b, w.g), w.g));
      assert_true(is_nearest(c.r, field(raw, w.b + w.g, w.r), w.r));
      assert_true(w.a == 0 ? c.a == 255 : is_nearest(c.a, field(raw, w.b + w.g + w.r, w.a), w.a));
    }
  }
}

SPANTEX_CASE(every_16_bit_number_survives_unpacking_and_packing) {
  for (texel_format f : packed_formats)
    for (uint32_t raw = 0; raw < 1u << 16; ++raw) assert_int_equal(pack(f, unpack(f, uint16_t(raw))), raw);
}

SPANTEX_CASE(packing_takes_the_nearest_level_of_every_channel) {
  for (int bits : {1, 4, 5, 6})
    for (int x = 0; x < 256; ++x) {
      const int64_t most = (int64_t(1) << bits) - 1, level = spantex::detail::narrowed_colour(uint8_t(x), bits);
      assert_true(std::abs(2 * level * 255 - 2 * x * most) <= 255);
    }
}

SPANTEX_CASE(a_packed_view_is_validated_like_any_other) {
  static const uint16_t texels[16] = {};
  const uint16_t* levels[] = {texels, nullptr};
  texture_view t;
  SPANTEX_ASSERT_OK(texture_view::make(texel_format::rgb565, levels, 1, 4, 4, wrap::repeat, wrap::repeat, t));
  SPANTEX_ASSERT_STATUS(texture_view::make(texel_format::rgb565, levels, 2, 4, 4, wrap::repeat, wrap::repeat, t), bad_pointer);
  SPANTEX_ASSERT_STATUS(texture_view::make(texel_format::rgb565, levels, 4, 4, 4, wrap::repeat, wrap::repeat, t), bad_levels);
  SPANTEX_ASSERT_STATUS(texture_view::make(texel_format::rgb565, levels, 1, 0, 4, wrap::repeat, wrap::repeat, t), bad_size);
  SPANTEX_ASSERT_STATUS(texture_view::make(texel_format::rgba8888, levels, 1, 4, 4, wrap::repeat, wrap::repeat, t), out_of_range);
}

namespace {

// A map in a 16-bit format beside the same map unpacked.
struct twin_maps {
  std::vector<std::vector<uint16_t>> packed;
  synthetic_map unpacked;
};

const twin_maps& twins(texel_format f) {
  static std::deque<twin_maps> kept;
  const synthetic_map& source = photographic_map(48, 40);
  twin_maps m;
  for (const level_pixels& level : source.levels) {
    m.packed.emplace_back();
    m.unpacked.levels.push_back({level.width, level.height, {}});
    for (const rgba8& c : level.texels) {
      m.packed.back().push_back(pack(f, c));
      m.unpacked.levels.back().texels.push_back(unpack(f, pack(f, c)));
    }
  }
  kept.push_back(m);
  return kept.back();
}

texture_view packed_view(const twin_maps& m, texel_format f, wrap mode) {
  const uint16_t* levels[max_levels] = {};
  for (size_t k = 0; k < m.packed.size(); ++k) levels[k] = m.packed[k].data();
  texture_view t;
  if (texture_view::make(f, levels, int(m.packed.size()), 48, 40, mode, mode, t) != status::ok) std::abort();
  return t;
}

picture from_packed, from_unpacked;

template <profile P>
void draws_what_its_unpacked_map_draws(texel_format f) {
  const twin_maps& m = twins(f);
  const plane p = sample_plane(1, {0, 0, 96, 64});
  for (filter kind : all_filters)
    for (wrap mode : all_wraps) {
      from_packed.reset(96, 64);
      from_unpacked.reset(96, 64);
      SPANTEX_ASSERT_OK(render_plane_direct<P.fine_side>(fixed_profile<P>{}, p, packed_view(m, f, mode), kind, from_packed));
      SPANTEX_ASSERT_OK(render_plane_direct<P.fine_side>(fixed_profile<P>{}, p, m.unpacked.view(mode, mode), kind, from_unpacked));
      assert_true(from_packed == from_unpacked);
    }
}

}  // namespace

SPANTEX_CASE(pictures_equal_those_of_the_unpacked_map) {
  for (texel_format f : packed_formats) {
    draws_what_its_unpacked_map_draws<profiles::seed>(f);
    draws_what_its_unpacked_map_draws<profiles::compact>(f);
    draws_what_its_unpacked_map_draws<profiles::standard>(f);
    draws_what_its_unpacked_map_draws<profiles::exact>(f);
  }
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(every_16_bit_number_unpacks_to_the_nearest_8_bits),
      cmocka_unit_test(every_16_bit_number_survives_unpacking_and_packing),
      cmocka_unit_test(packing_takes_the_nearest_level_of_every_channel),
      cmocka_unit_test(a_packed_view_is_validated_like_any_other),
      cmocka_unit_test(pictures_equal_those_of_the_unpacked_map),
  };
  return run_suite("texel", tests);
}
