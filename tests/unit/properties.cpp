// SPDX-License-Identifier: Apache-2.0
// The promises on colours, in drawn pictures, for every profile, filter, texel format and pair of wrap modes: constant in, constant out; a
// pixel lies between the texels that have a weight in it; monotone in the weights; point sampling exact; rounding within its bound and
// without bias; spans and sections equal the whole map bit for bit wherever the correction does not act.
#include <tests/properties.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

constexpr int32_t width = 64, height = 48;
constexpr rectangle area{0, 0, width, height};
picture drawn;

plane view_plane(int k) { return sim::view_plane(k, width, height); }

template <class Prof>
void draw_view(const Prof& prof, const plane& p, const texture_view& t, filter kind) {
  drawn.reset(width, height);
  SPANTEX_ASSERT_OK(render_plane_direct<Prof::max_fine_side>(prof, p, t, kind, drawn));
}

rgba8 at(int32_t x, int32_t y) { return drawn.pixels[size_t(y * width + x)]; }

// use(prof, name, kind, format, wrap_u, wrap_v) for all profiles, formats and pairs of wraps; under sanitizers with the same wrap along
// both axes only. step and hat weigh hundreds of texels: one format, the same wrap along both axes; the loader, which wraps and decodes, is the
// same for every filter.
template <class Filters, class Use>
void for_each_combination(const Filters& filters, Use use) {
  for_each_profile([&](auto prof, const char* name) {
    for (const filter kind : filters)
      for (const texel_format format : plain_formats)
        for (const wrap u : all_wraps)
          for (const wrap v : all_wraps)
            if (u == v ? !uses_area(kind) || format == texel_format::rgba8888 : !short_run() && !uses_area(kind)) use(prof, name, kind, format, u, v);
  });
}

// What the datapath's arithmetic makes of a source with the whole map at hand.
rgba8 from_whole_map(const profile& q, const texture_view& t, filter kind, const pixel_source& s) {
  if (kind == filter::nearest) return t.texel(0, t.wrapped_u(s.fine.u, 0), t.wrapped_v(s.fine.v, 0));
  uint8_t out[4];
  for (int k = 0; k < channel_count; ++k) {
    partial_colour colour = whole_map_blend(q, t, kind, s.level, s.fine, k);
    if (uses_two_levels(kind)) colour = kept_of_level(colour, q);
    if (s.two_levels) colour = between_levels(colour, whole_map_blend(q, t, kind, s.level + 1, s.coarse, k), s.fraction, q);
    out[k] = written(colour, q);
  }
  return {out[0], out[1], out[2], out[3]};
}

}  // namespace

// Every filter of every profile meets every colour; formats and wraps take the colours in turn, since a constant map is the same through all of
// them. step and hat, of which there are fewer combinations: every colour in each.
SPANTEX_CASE(constant_in_constant_out) {
  constexpr rgba8 colours[] = {{0, 0, 0, 0}, {255, 255, 255, 255}, {1, 254, 127, 128}, {200, 3, 77, 254}};
  const synthetic_map* maps[std::size(colours)][2];
  for (size_t n = 0; n < std::size(colours); ++n) maps[n][0] = &constant_map(16, 8, colours[n]), maps[n][1] = &constant_map(13, 1, colours[n]);
  size_t turn = 0;
  for_each_combination(all_filters, [&](auto prof, const char* name, filter kind, texel_format format, wrap wrap_u, wrap wrap_v) {
    const auto check = [&](size_t n, int k) {
      const plane p = view_plane(k);
      draw_view(prof, p, in_format(*maps[n][k % 2], format).view(wrap_u, wrap_v), kind);
      for (int32_t y = 0; y < height; ++y)
        for (int32_t x = 0; x < width; ++x) {
          rgba8 wanted = p.w_at(2 * x + 1, 2 * y + 1) > 0 ? as_held(format, colours[n]) : background;
          if (kind == filter::contour) wanted.a = at(x, y).a;  // a coverage: depends on the level of detail
          if (!(at(x, y) == wanted)) fail_msg("%s, filter %d, view %d: (%d, %d)", name, int(kind), k, int(x), int(y));
        }
    };
    ++turn;
    for (int k = 0; k < view_count; ++k)
      if (uses_area(kind))
        check((turn + size_t(k)) % std::size(colours), k), check((turn + size_t(k) + 2) % std::size(colours), k);
      else
        check((turn + size_t(k)) % std::size(colours), k);
  });
}

struct judged_pixels { int64_t pixels = 0, left_out = 0; };

// One pass over a picture for what concerns a single pixel; `what` tells the combination.
template <class Prof>
static void judge_picture(const Prof& prof, const char* what, filter kind, const texture_view& t, int k, rounding_error& error, judged_pixels& judged) {
  const profile& q = prof.get();
  const plane p = view_plane(k);
  draw_view(prof, p, t, kind);
  each_source(prof, {&p, &t, kind}, area, [&](int32_t x, int32_t y, const pixel_source& source) {
    ++judged.pixels;
    if (source.corrected) {
      ++judged.left_out;
      return;
    }
    const auto wrong = [&](const char* how) { fail_msg("%s: %s, filter %d, view %d, (%d, %d)", how, what, int(kind), k, int(x), int(y)); };
    if (!(at(x, y) == from_whole_map(q, t, kind, source))) wrong("differs from the whole map");
    const shares mix = shares_of(source, t, kind, q.subtexel_bits, q.level_bits);
    for (int c = 0; c < channel_count; ++c) {
      const uint32_t got = channel_of(at(x, y), c);
      if (got < mix.smallest(c) || got > mix.largest(c)) wrong("not between its texels");
      if (c < 3) error.note(got, mix.value(c), mix.bits);
    }
  });
}

SPANTEX_CASE(pixels_are_what_their_texels_and_weights_make) {
  judged_pixels judged;
  double largest_mean = 0;
  for_each_combination(one_sample_filters, [&](auto prof, const char* name, filter kind, texel_format format, wrap wrap_u, wrap wrap_v) {
    char what[64];
    std::snprintf(what, sizeof what, "%s, format %d, wrap %d %d", name, int(format), int(wrap_u), int(wrap_v));
    rounding_error error;
    for (int k = 0; k < view_count; ++k) judge_picture(prof, what, kind, in_format(map_for(k), format).view(wrap_u, wrap_v), k, error, judged);
    if (!error.is_within_bound(prof.get(), uses_two_levels(kind))) fail_msg("%s, filter %d: %.5f LSB", name, int(kind), error.worst_lsb());
    if (!error.is_unbiased()) fail_msg("%s, filter %d, format %d: mean error %.4f LSB", name, int(kind), int(format), error.mean_lsb());
    if (kind == filter::nearest) assert_int_equal(error.worst, 0);
    largest_mean = std::fmax(largest_mean, std::fabs(error.mean_lsb()));
  });
  std::printf("# %lld pixels, %.1f %% left out (clamped by seed); largest mean error %.4f LSB\n",
              static_cast<long long>(judged.pixels), 100.0 * double(judged.left_out) / double(judged.pixels), largest_mean);
  assert_true(judged.left_out < judged.pixels / 4);
}

// Any bytes are a map of bytes, palettes or blocks. Wraps and views in turn.
SPANTEX_CASE(pixels_of_every_other_format_are_what_their_texels_make) {
  judged_pixels judged;
  size_t turn = 0;
  for_each_profile([&](auto prof, const char* name) {
    for (const filter kind : one_sample_filters)
      for_each_other_format(turn, [&](texel_format format, size_t n) {
        char what[64];
        std::snprintf(what, sizeof what, "%s, format %d", name, int(format));
        rounding_error error;
        for (const int k : {int(n % view_count), int((n + 2) % view_count)}) {
          const level_pixels& like = map_for(k).levels[0];
          const raw_map& map = random_map(format, like.width, like.height, all_wraps[n % 3], all_wraps[n / 3 % 3], n);
          judge_picture(prof, what, kind, map.view, k, error, judged);
        }
        if (!error.is_within_bound(prof.get(), uses_two_levels(kind))) fail_msg("%s, filter %d: %.5f LSB", what, int(kind), error.worst_lsb());
        if (kind == filter::nearest) assert_int_equal(error.worst, 0);
      });
  });
  std::printf("# %lld pixels, %.1f %% left out (clamped by seed)\n", static_cast<long long>(judged.pixels), 100.0 * double(judged.left_out) / double(judged.pixels));
  assert_true(judged.left_out < judged.pixels / 4);
}

// A profile that splits is never corrected; compact raises the level instead.
SPANTEX_CASE(only_seed_is_ever_corrected) {
  for_each_combination(one_sample_filters, [&](auto prof, const char*, filter kind, texel_format format, wrap wrap_u, wrap wrap_v) {
    if (prof.get().overflow == overflow_policy::clamp || format != texel_format::rgba8888) return;
    for (int k = 0; k < view_count; ++k) {
      const plane p = view_plane(k);
      const texture_view t = map_for(k).view(wrap_u, wrap_v);
      const surface s{&p, &t, kind};
      each_source(prof, s, area, [&](int32_t, int32_t, const pixel_source& source) { assert_false(source.corrected); });
    }
  });
}

// Nearest shows the texel that holds the exact position Nu/W, unless that lies within the coordinate bound of the texel's edge. What is not judged for
// that, or because seed's correction moved it, is a share of all pixels with a position in range, and has a limit for each profile.
SPANTEX_CASE(point_sampling_is_exact) {
  for_each_profile([&](auto prof, const char* name) {
    int64_t near_an_edge = 0, corrected = 0, pixels = 0;
    for (const texel_format format : plain_formats)
      for (const wrap wrap_u : all_wraps)
        for (const wrap wrap_v : all_wraps)
          for (int k = 0; k < view_count; ++k) {
            const plane p = view_plane(k);
            const texture_view t = in_format(map_for(k), format).view(wrap_u, wrap_v);
            draw_view(prof, p, t, filter::nearest);
            const surface s{&p, &t, filter::nearest};
            each_source(prof, s, area, [&](int32_t x, int32_t y, const pixel_source& source) {
              const int32_t hx = 2 * x + 1, hy = 2 * y + 1;
              const int64_t w = p.w_at(hx, hy), nu = p.u_at(hx, hy), nv = p.v_at(hx, hy);
              if (!in_range(nu, w) || !in_range(nv, w)) return;
              ++pixels;
              if (source.corrected) {
                ++corrected;
                return;
              }
              const long double bound = static_cast<long double>(coordinate_bound(prof.get(), source.extent_log2)) / error_unit;
              const auto is_near_edge = [&](int64_t n) {
                const long double u = static_cast<long double>(n) / w;
                return std::fabs(u - std::round(u)) <= bound;
              };
              if (is_near_edge(nu) || is_near_edge(nv)) {
                ++near_an_edge;
                return;
              }
              const rgba8 wanted =
                  t.texel(0, t.wrapped_u(int32_t(floor_quotient(nu, w)), 0), t.wrapped_v(int32_t(floor_quotient(nv, w)), 0));
              if (!(at(x, y) == wanted)) fail_msg("%s, view %d, (%d, %d)", name, k, int(x), int(y));
            });
          }
    const profile& q = prof.get();
    const double near = double(near_an_edge) / double(pixels), moved = double(corrected) / double(pixels);
    std::printf("# %s: %lld pixels, %.2f %% not judged: %.2f %% near an edge, %.2f %% clamped\n", name, static_cast<long long>(pixels),
                100 * (near + moved), 100 * near, 100 * moved);
    // compact's words are short: its bound is wide. seed draws nearest from 8x8 texels of level 0, which these views seldom hold.
    assert_true(near < (q == profiles::compact ? 0.45 : 0.02));
    assert_true(q.overflow == overflow_policy::clamp ? moved < 0.7 : corrected == 0);
  });
}

// --- monotone ------------------------------------------------------------------------------------------------------

namespace {

// One channel along a line on which one weight grows.
struct channel_run {
  int direction = 0;
  uint8_t last = 0;
  void begin(uint8_t c) {
    direction = 0;
    last = c;
  }
  bool goes_on(uint8_t c) {
    const int step = (c > last) - (c < last);
    const bool keeps = step == 0 || direction == 0 || step == direction;
    if (step != 0) direction = step;
    last = c;
    return keeps;
  }
};

// Sources of one picture, by pixel.
struct noted_source {
  pixel_source source;
  bool known;
};
noted_source sources[64 * 512];

bool is_same_cell(const pixel_source& a, const pixel_source& b, bool along_u, bool three) {
  const auto lower = [](const pixel_source& s) { return s.fine.fraction.v >= s.fine.fraction.u; };
  const bool other_weight = along_u ? a.fine.fraction.v == b.fine.fraction.v : a.fine.fraction.u == b.fine.fraction.u;
  return a.fine.u == b.fine.u && a.fine.v == b.fine.v && other_weight && (!three || lower(a) == lower(b));
}

template <class Prof>
int check_ramp(const Prof& prof, const char* name, const plane& p, const texture_view& t, filter kind, bool along_u) {
  const int32_t w = along_u ? 512 : 64, h = along_u ? 64 : 512;
  static picture shown;
  shown.reset(w, h);
  SPANTEX_ASSERT_OK(render_plane_direct<Prof::max_fine_side>(prof, p, t, kind, shown));
  const surface s{&p, &t, kind};
  each_source(prof, s, {0, 0, w, h}, [&](int32_t x, int32_t y, const pixel_source& source) {
    sources[y * w + x] = {source, !source.corrected && !source.two_levels && source.level == 0};
  });
  int compared = 0;
  const int32_t step = along_u ? 1 : w, across = along_u ? w : 1, length = along_u ? w : h, lines = along_u ? h : w;
  for (int32_t line = 0; line < lines; ++line) {
    channel_run run[channel_count];
    for (int32_t k = 0; k < length; ++k) {
      const int32_t n = line * across + k * step;
      const rgba8 colour = shown.pixels[size_t(n)];
      const bool same = k > 0 && sources[n].known && sources[n - step].known &&
                        is_same_cell(sources[n].source, sources[n - step].source, along_u, uses_three_points(kind));
      for (int c = 0; c < channel_count; ++c) {
        const auto value = uint8_t(channel_of(colour, c));
        if (!same)
          run[c].begin(value);
        else if (!run[c].goes_on(value))
          fail_msg("%s, filter %d: turns at pixel %d of line %d", name, int(kind), int(k), int(line));
      }
      compared += same;
    }
  }
  return compared;
}

}  // namespace

// Two texels in 512 pixels: every weight of the profile, across the map's edge.
SPANTEX_CASE(pictures_are_monotone_in_each_position_weight) {
  const synthetic_map& map = map_for(0);
  const int32_t texel = 1 << 12, u_edge = 32 * texel - texel / 2, v_edge = 16 * texel - texel / 2;
  const plane along_u = ramp(u_edge - texel, texel / 256, 5 * texel, texel / 31, 512, 64);
  const plane along_v = ramp(7 * texel, texel / 31, v_edge - texel, texel / 256, 64, 512);
  for_each_combination(one_sample_filters, [&](auto prof, const char* name, filter kind, texel_format format, wrap wrap_u, wrap wrap_v) {
    if (wrap_u != wrap_v) return;
    const texture_view t = in_format(map, format).view(wrap_u, wrap_v);
    assert_true(check_ramp(prof, name, along_u, t, kind, true) > 20000);
    assert_true(check_ramp(prof, name, along_v, t, kind, false) > 20000);
  });
}

// One pixel whose position stays while the scale about it grows: only the fraction of the level moves.
SPANTEX_CASE(pictures_are_monotone_in_the_fraction_of_the_level) {
  constexpr int32_t x = 19, y = 26, texel = 1 << 12;
  for_each_combination(one_sample_filters, [&](auto prof, const char* name, filter kind, texel_format format, wrap wrap_u, wrap wrap_v) {
    if (!uses_two_levels(kind) || wrap_u != wrap_v) return;
    const texture_view t = in_format(map_for(0), format).view(wrap_u, wrap_v);
    channel_run run[channel_count];
    pixel_source last{};
    int compared = 0;
    for (int k = 0; k < 256; ++k) {
      const int32_t step = texel + 16 * k, u = 31 * texel + 1234 - step * x, v = 15 * texel + 999 - step * y;
      const plane p = ramp(u, step, v, step, width, height);
      const surface s{&p, &t, kind};
      drawn.reset(width, height);
      direct_engine<decltype(prof), decltype(prof)::max_fine_side> engine(prof);
      renderer<decltype(engine), decltype(prof)> r(engine, prof, drawn.frame());
      SPANTEX_ASSERT_OK(r.draw(p, t, kind, {x, y, x + 1, y + 1}));
      SPANTEX_ASSERT_OK(r.finish());
      each_source(prof, s, {x, y, x + 1, y + 1}, [&](int32_t, int32_t, const pixel_source& now) {
        const auto same_place = [](const snapped_position& a, const snapped_position& b) {
          return a.u == b.u && a.v == b.v && a.fraction.u == b.fraction.u && a.fraction.v == b.fraction.v;
        };
        const bool same = k > 0 && now.level == last.level && same_place(now.fine, last.fine) && !now.corrected &&
                          (!now.two_levels || !last.two_levels || same_place(now.coarse, last.coarse));
        if (same && now.fraction < last.fraction) fail_msg("%s: the fraction falls at scale %d", name, k);
        for (int c = 0; c < channel_count; ++c) {
          const auto value = uint8_t(channel_of(at(x, y), c));
          if (!same)
            run[c].begin(value);
          else if (!run[c].goes_on(value))
            fail_msg("%s, filter %d: turns at scale %d", name, int(kind), k);
        }
        compared += same;
        last = now;
      });
    }
    if (compared < 200) fail_msg("%s: only %d steps compared", name, compared);
  });
}

// Weights of exactly 1/2 and 1/4, where every second or fourth exact value is a tie: a map at half its size, shifts by half and quarter texels,
// and the mean of four that one square is.
SPANTEX_CASE(weights_of_a_half_and_a_quarter_have_no_bias) {
  constexpr int32_t texel = 1 << 12;
  constexpr struct { int32_t at, step; } views[] = {{32 * texel, 2 * texel}, {32 * texel, texel}, {32 * texel + texel / 4, texel}};
  double largest_mean = 0;
  for_each_profile([&](auto prof, const char* name) {
    const profile& q = prof.get();
    const synthetic_map& map = photographic_map(256, 256, 8);
    const texture_view t = map.view(wrap::repeat, wrap::repeat);
    for (const filter kind : {filter::bilinear, filter::three_point, filter::mip_bilinear, filter::trilinear, filter::squares})
      for (const auto& view : views) {
        const plane p = ramp(view.at, view.step, view.at, view.step, width, height);
        draw_view(prof, p, t, kind);
        rounding_error error;
        each_source(prof, {&p, &t, kind}, area, [&](int32_t x, int32_t y, const pixel_source& source) {
          if (source.corrected) return;
          shares mix = shares_of(source, t, kind, q.subtexel_bits, q.level_bits);
          if (kind == filter::squares) {
            for (int k = 0; k < 4; ++k) mix.of[k].weight = 1;
            mix.bits = 2;
          }
          for (int c = 0; c < 3; ++c) error.note(channel_of(at(x, y), c), mix.value(c), mix.bits);
        });
        assert_true(error.count > 2000);
        if (!error.is_unbiased()) fail_msg("%s, filter %d: mean error %.4f LSB", name, int(kind), error.mean_lsb());
        largest_mean = std::fmax(largest_mean, std::fabs(error.mean_lsb()));
      }
  });
  std::printf("# largest mean error %.4f LSB\n", largest_mean);
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(constant_in_constant_out),
      cmocka_unit_test(pixels_are_what_their_texels_and_weights_make),
      cmocka_unit_test(pixels_of_every_other_format_are_what_their_texels_make),
      cmocka_unit_test(weights_of_a_half_and_a_quarter_have_no_bias),
      cmocka_unit_test(only_seed_is_ever_corrected),
      cmocka_unit_test(point_sampling_is_exact),
      cmocka_unit_test(pictures_are_monotone_in_each_position_weight),
      cmocka_unit_test(pictures_are_monotone_in_the_fraction_of_the_level),
  };
  return run_suite("properties", tests);
}
