// SPDX-License-Identifier: Apache-2.0
// The promises on colours for the filters with a footprint and for contours, in drawn pictures (those of the others: properties.cpp): a pixel is the
// mean of its texels by their exact weights, rounded within its bound and without bias, and lies between them; monotone in the texels and
// along an edge; spans and sections equal the whole map bit for bit; a mirrored map gives the mirrored picture but for ties. Constants and
// mirrored screens are in properties.cpp and symmetry.cpp, with every other filter.
#include <tests/properties.hpp>

using namespace spantex;
using namespace spantex::sim;

namespace {

constexpr int32_t width = 40, height = 32;
constexpr rectangle area{0, 0, width, height};
constexpr filter footprint_filters[] = {filter::squares, filter::aniso, filter::step, filter::hat, filter::contour};
picture drawn;

template <class Prof>
void draw_view(const Prof& prof, const plane& p, const texture_view& t, filter kind, picture& out = drawn) {
  out.reset(width, height);
  SPANTEX_ASSERT_OK(render_plane_direct<Prof::max_fine_side>(prof, p, t, kind, out));
}

// use(prof, name, kind, format, wrap_u, wrap_v): every profile, filter and format, every wrap along both axes and one mixed pair. step and hat take
// formats and wraps in turn: the loader, which decodes and wraps, is the same for every filter.
template <class Use>
void for_each_combination(Use use) {
  constexpr struct { wrap u, v; } pairs[] = {
      {wrap::repeat, wrap::repeat}, {wrap::clamp, wrap::clamp}, {wrap::mirror, wrap::mirror}, {wrap::repeat, wrap::mirror}};
  for_each_profile([&](auto prof, const char* name) {
    for (const filter kind : footprint_filters)
      for (size_t f = 0; f < std::size(plain_formats); ++f)
        for (size_t w = 0; w < std::size(pairs); ++w)
          if (uses_area(kind) || short_run() ? f == w : true) use(prof, name, kind, plain_formats[f], pairs[w].u, pairs[w].v);
  });
}

// The texels of one pixel on the whole map and their weights, as SPEC "Footprints" has them, from the positions the datapath takes.
struct weighted_texels {
  static constexpr int most = max_area_side * max_area_side;
  struct { rgba8 texel; int64_t weight; } of[most];
  int count = 0;
  int64_t total = 0;
  void add(rgba8 texel, int64_t weight) {
    total += weight;
    if (weight == 0) return;
    of[count] = {texel, weight};
    ++count;
  }
  long double mean(int channel) const {
    int64_t sum = 0;
    for (int k = 0; k < count; ++k) sum += of[k].weight * channel_of(of[k].texel, channel);
    return static_cast<long double>(sum) / static_cast<long double>(total);
  }
  bool holds(int channel, uint32_t value) const {
    uint32_t least = 255, greatest = 0;
    for (int k = 0; k < count; ++k) {
      least = std::min(least, channel_of(of[k].texel, channel));
      greatest = std::max(greatest, channel_of(of[k].texel, channel));
    }
    return value >= least && value <= greatest;
  }
};

void add_level(weighted_texels& out, const texture_view& t, int level, const snapped_position& p, int bits, int64_t scale) {
  const int64_t one = int64_t(1) << bits, u = p.fraction.u, v = p.fraction.v;
  for (int k = 0; k < 4; ++k)
    out.add(t.texel(level, t.wrapped_u(p.u + (k & 1), level), t.wrapped_v(p.v + (k >> 1), level)),
            scale * (k & 1 ? u : one - u) * (k & 2 ? v : one - v));
}

template <class Prof>
void texels_of_samples(const Prof& prof, const texture_view& t, const span_coefficients& c, int i, int j, weighted_texels& out) {
  const profile& q = prof.get();
  const texel_position centre = position_at(prof, c, i, j);
  const footprint f = footprint_at(prof, c, i, j);
  const int level = c.fine.level;
  const int64_t one = int64_t(1) << q.level_bits, fraction = c.two_levels ? clamp_to(f.level - level * int32_t(one), 0, int32_t(one) - 1) : 0;
  for (int k = 0; k < f.samples; ++k) {
    if (c.kind == filter::squares) {
      const snapped_position p = snap(centre, whole_level(t, level), c.kind, q);
      const square s = square_at(f, p.fraction, q.subtexel_bits, k);
      for (int n = 0; n < 4; ++n)
        out.add(t.texel(level, t.wrapped_u(p.u + s.u + (n & 1), level), t.wrapped_v(p.v + s.v + (n >> 1), level)), s.weight[n] * s.row_weight);
      continue;
    }
    const texel_position at = sample_position(centre, f, k);
    add_level(out, t, level, snap(at, whole_level(t, level), c.kind, q), q.subtexel_bits, one - fraction);
    if (c.two_levels) add_level(out, t, level + 1, snap(at, whole_level(t, level + 1), c.kind, q), q.subtexel_bits, fraction);
  }
}

template <class Prof>
void texels_of_area(const Prof& prof, const texture_view& t, const span_coefficients& c, int i, int j, weighted_texels& out) {
  const int level = c.fine.level;
  const area_window w = area_window_at(prof, c, i, j, whole_level(t, level));
  area_weights weights(w, c.kind);
  for (int row = 0; row < w.rows; ++row) {
    int32_t weight[max_area_side];
    weights.next_row(weight);
    for (int column = 0; column < w.columns; ++column)
      out.add(t.texel(level, t.wrapped_u(w.u + column, level), t.wrapped_v(w.v + row, level)), weight[column]);
  }
}

// False where a section was too small and its correction acts (contours in seed).
template <class Prof>
bool texels_of(const Prof& prof, const texture_view& t, const span_coefficients& c, int i, int j, weighted_texels& out) {
  const profile& q = prof.get();
  if (uses_area(c.kind)) {
    texels_of_area(prof, t, c, i, j, out);
  } else if (uses_footprint(c.kind)) {
    texels_of_samples(prof, t, c, i, j, out);
  } else {
    const pixel_source s = sim::detail::source_of(prof, c, i, j);
    add_level(out, t, s.level, s.fine, q.subtexel_bits, s.two_levels ? (1 << q.level_bits) - int64_t(s.fraction) : 1 << q.level_bits);
    if (s.two_levels) add_level(out, t, s.level + 1, s.coarse, q.subtexel_bits, s.fraction);
    return !s.corrected;
  }
  return true;
}

// use(x, y, coefficients) for every pixel with W > 0, once, however many jobs it takes.
template <class Prof, class Use>
void each_pixel(const Prof& prof, const surface& s, Use use) {
  for (int32_t sy = 0; sy < height / span_side; ++sy)
    for (int32_t sx = 0; sx < width / span_side; ++sx)
      SPANTEX_ASSERT_OK(plan_span(prof, s, sx, sy, front_mask(*s.map, sx, sy), [&](span_job& job) {
        for (span_mask rest = job.completes ? job.mask : 0; rest != 0; rest &= rest - 1) {
          const int k = __builtin_ctzll(rest);
          use(sx * span_side + k % span_side, sy * span_side + k / span_side, job.coefficients);
        }
        return status::ok;
      }));
}

// The same with the texels it is a mean of; nullptr where a correction moved them.
template <class Prof, class Use>
void each_mean(const Prof& prof, const surface& s, Use use) {
  static weighted_texels mix;
  each_pixel(prof, s, [&](int32_t x, int32_t y, const span_coefficients& c) {
    mix.count = 0;
    mix.total = 0;
    const bool known = texels_of(prof, *s.texture, c, x % span_side, y % span_side, mix);
    use(x, y, c, known ? &mix : nullptr);
  });
}

// Channels that are means: alpha of a contour is a coverage.
int mean_channels(filter kind) { return kind == filter::contour ? alpha_channel : channel_count; }

long double colour_bound_of(const profile& q, const span_coefficients& c) {
  const uint64_t bound = c.kind == filter::aniso     ? aniso_colour_bound(q, uses_two_levels(c.kind))
                         : c.kind == filter::contour ? colour_bound(q, uses_two_levels(c.kind))
                                                     : mean_bound(q);
  return static_cast<long double>(bound) / error_unit;
}

}  // namespace

struct judged_pixels { int64_t pixels = 0, left_out = 0; };

template <class Prof>
static void judge_picture(const Prof& prof, const char* name, filter kind, const texture_view& t, int k, judged_pixels& judged) {
  const plane p = view_plane(k, width, height);
  draw_view(prof, p, t, kind);
  each_mean(prof, {&p, &t, kind}, [&](int32_t x, int32_t y, const span_coefficients& c, const weighted_texels* mix) {
    ++judged.pixels;
    judged.left_out += mix == nullptr;
    for (int channel = 0; mix != nullptr && channel < mean_channels(kind); ++channel) {
      const uint32_t got = channel_of(drawn.pixels[size_t(y * width + x)], channel);
      const auto wrong = [&](const char* what) {
        fail_msg("%s: %s, filter %d, format %d, view %d, (%d, %d): %u instead of %.5Lf", what, name, int(kind), int(t.format()), k, int(x), int(y), got,
                 mix->mean(channel));
      };
      if (!mix->holds(channel, got)) wrong("not between its texels");
      if (std::fabs(got - mix->mean(channel)) > colour_bound_of(prof.get(), c) + 1e-12L) wrong("beyond its bound");
    }
  });
}

static void print(const judged_pixels& judged) {
  std::printf("# %lld pixels, %.1f %% left out (clamped by seed)\n", static_cast<long long>(judged.pixels), 100.0 * double(judged.left_out) / double(judged.pixels));
}

// Alpha of a contour is a coverage: contour.cpp has it.
SPANTEX_CASE(pixels_are_means_of_their_texels) {
  judged_pixels judged;
  for_each_combination([&](auto prof, const char* name, filter kind, texel_format format, wrap wrap_u, wrap wrap_v) {
    for (int k = 0; k < view_count; ++k) judge_picture(prof, name, kind, in_format(map_for(k), format).view(wrap_u, wrap_v), k, judged);
  });
  print(judged);
  assert_true(judged.left_out < judged.pixels / 20);
}

// Any bytes are a map of bytes, palettes or blocks. Wraps and views in turn, and the formats, too, of step and hat, which weigh hundreds of texels.
SPANTEX_CASE(pixels_of_every_other_format_are_means_of_their_texels) {
  judged_pixels judged;
  size_t turn = 0;
  for_each_profile([&](auto prof, const char* name) {
    for (const filter kind : footprint_filters)
      for_each_other_format(turn, [&](texel_format format, size_t n) {
        if (uses_area(kind) && (n + size_t(kind)) % 4 != 0) return;
        const int k = int(n % view_count);
        const level_pixels& like = map_for(k).levels[0];
        judge_picture(prof, name, kind, random_map(format, like.width, like.height, all_wraps[n % 3], all_wraps[n / 3 % 3], n).view, k, judged);
      });
  });
  print(judged);
  assert_true(judged.left_out < judged.pixels / 20);
}

// On a map so large that no two pixels have the same texels: of few different means the average says nothing.
SPANTEX_CASE(roundings_have_no_bias) {
  const synthetic_map& map = photographic_map(512, 512, 9);
  long double largest = 0;
  for_each_profile([&](auto prof, const char* name) {
    for (const filter kind : footprint_filters)
      for (const texel_format format : plain_formats) {
        // Halves up are a bias where ties are the rule, as with squares' weights of a quarter.
        if ((kind == filter::squares && prof.get().colour_rounding == rounding::nearest) || (uses_area(kind) && format != texel_format::rgba8888)) continue;
        long double sum = 0;
        int64_t count = 0;
        for (int k = 0; k < 4; ++k) {
          const plane p = view_plane(k, width, height);
          const texture_view t = in_format(map, format).view(all_wraps[k % 3], all_wraps[(k + int(format)) % 3]);
          draw_view(prof, p, t, kind);
          each_mean(prof, {&p, &t, kind}, [&](int32_t x, int32_t y, const span_coefficients&, const weighted_texels* mix) {
            for (int channel = 0; mix != nullptr && channel < alpha_channel; ++channel, ++count)
              sum += channel_of(drawn.pixels[size_t(y * width + x)], channel) - mix->mean(channel);
          });
        }
        const long double mean = std::fabs(sum / static_cast<long double>(count));
        if (mean >= 0.02L || count < 5000) fail_msg("%s, filter %d, format %d: mean error %.4Lf LSB of %lld", name, int(kind), int(format), mean, static_cast<long long>(count));
        largest = std::fmax(largest, mean);
      }
  });
  std::printf("# largest mean error %.4Lf LSB\n", largest);
}

// Profiles that split; seed shares a level over the span, which the whole-map arithmetic does not, but for step and hat, whose level bounds their
// texels. Contours follow the profile's policy, where the others are always split.
SPANTEX_CASE(footprints_equal_the_whole_map) {
  static picture expected;
  int pictures = 0;
  for_each_combination([&](auto prof, const char* name, filter kind, texel_format format, wrap wrap_u, wrap wrap_v) {
    if (prof.get().scope == level_scope::span && !uses_area(kind)) return;
    if (kind == filter::contour && prof.get().overflow != overflow_policy::split) return;
    for (int k = 0; k < view_count; ++k) {
      const plane p = view_plane(k, width, height);
      const texture_view t = in_format(map_for(k), format).view(wrap_u, wrap_v);
      draw_view(prof, p, t, kind);
      expected.reset(width, height);
      draw_whole_map(prof, {&p, &t, kind}, area, expected);
      if (!(drawn == expected)) fail_msg("%s, filter %d, format %d, view %d", name, int(kind), int(format), k);
      ++pictures;
    }
  });
  assert_true(pictures > (short_run() ? 200 : 400));
}

// A map whose texels are nowhere darker gives a picture that is nowhere darker. A contour's coverage need not: its steepness follows the field's gradient.
SPANTEX_CASE(pictures_are_monotone_in_their_texels) {
  static picture brighter;
  int64_t raised = 0;
  for (const bool even : {true, false}) {
    const synthetic_map& dark = map_for(even ? 0 : 1);
    const level_pixels& base = dark.levels[0];
    const synthetic_map& bright = make_map(base.width, base.height, [&](int32_t x, int32_t y) {
      rgba8 c = base.at(x, y);
      random_source r(uint64_t(x) << 32 | uint64_t(y));
      for (uint8_t* channel : {&c.r, &c.g, &c.b, &c.a})
        if (r.next() % 3 == 0) *channel = uint8_t(std::min<uint64_t>(255, *channel + r.next() % 40));
      return c;
    });
    for_each_profile([&](auto prof, const char* name) {
      for (const filter kind : footprint_filters)
        for (int k = 0; k < view_count; ++k) {
          const plane p = view_plane(k, width, height);
          draw_view(prof, p, dark.view(wrap::repeat, wrap::mirror), kind);
          draw_view(prof, p, bright.view(wrap::repeat, wrap::mirror), kind, brighter);
          for (size_t n = 0; n < drawn.pixels.size(); ++n)
            for (int channel = 0; channel < channel_count; ++channel) {
              const uint32_t a = channel_of(drawn.pixels[n], channel), b = channel_of(brighter.pixels[n], channel);
              if (b < a && !(kind == filter::contour && channel == alpha_channel)) fail_msg("%s, filter %d, view %d: %u after %u at pixel %d", name, int(kind), k, b, a, int(n));
              raised += b > a;
            }
        }
    });
  }
  assert_true(raised > 100000);
}

// Along a row that runs over an edge from black to white, weights of white texels only grow: from magnified to 6 texels a pixel, the footprint
// long along the row or across it.
SPANTEX_CASE(pictures_are_monotone_along_an_edge) {
  constexpr int32_t texel = 1 << 12;
  const synthetic_map& edge = make_map(64, 64, [](int32_t x, int32_t) { return x < 32 ? rgba8{0, 0, 0, 0} : rgba8{255, 255, 255, 255}; });
  const texture_view t = edge.view(wrap::clamp, wrap::clamp);
  int64_t grown = 0;
  for_each_profile([&](auto prof, const char* name) {
    for (const filter kind : footprint_filters)
      for (const int32_t step : {texel / 37, texel / 5, texel, texel * 5 / 2, texel * 6})
        for (const int32_t across : {texel / 7, texel, texel * 3}) {
          const plane p = ramp(32 * texel - step * width / 2 + 77, step, 5 * texel, across, width, height);
          draw_view(prof, p, t, kind);
          // compact blurs spans that do not fit, seed clamps them, contours too: what they promise is judged where they do neither.
          if (kind == filter::contour && prof.get().overflow != overflow_policy::split && max_of(step, across) > texel / 2) continue;
          for (int32_t y = 0; y < height; ++y)
            for (int32_t x = 1; x < width; ++x) {
              const rgba8 &before = drawn.pixels[size_t(y * width + x - 1)], &after = drawn.pixels[size_t(y * width + x)];
              for (int channel = 0; channel < channel_count; ++channel) {
                const uint32_t a = channel_of(before, channel), b = channel_of(after, channel);
                if (b < a) fail_msg("%s, filter %d, steps %d %d: %u after %u at (%d, %d)", name, int(kind), int(step), int(across), b, a, int(x), int(y));
                grown += b > a;
              }
            }
        }
  });
  assert_true(grown > 50000);
}

// SPEC "Footprints: step and hat": towards the horizon the footprint is halved about its centre, all slopes alike, until w stays in (1/2, 3/2); out of
// range it is the square of 2^10 texels for every half pixel.
SPANTEX_CASE(footprints_at_the_horizon_and_out_of_range_are_as_specified) {
  const profile& q = profiles::exact;
  const int64_t one = int64_t(1) << 40;
  plane p{{5 * one, -3 * one, 70 * one}, {2 * one, 9 * one, -20 * one}, {one, 2 * one, 4 * one}, 0, 0, 0};
  span_coefficients c{};
  reference r = reference_at(p, 0, 0);
  pixel_area_coordinates(r, q, c);  // 2 (1 + 2) / 4 = 3/2 of w; a half is 3/4, too much, a quarter 3/8
  const auto is_near = [](int64_t got, int64_t wanted) { return magnitude(got - wanted) <= 2; };
  assert_true(c.centred && is_near(c.g, int64_t(1) << (q.reciprocal_bits - 4)) && is_near(c.h, int64_t(1) << (q.reciprocal_bits - 3)));
  for (const auto& [slope, wanted] : {std::pair{c.a_u, r.a_u}, {c.b_u, r.b_u}, {c.a_v, r.a_v}, {c.b_v, r.b_v}})
    assert_true(is_near(slope, int64_t(((int128(wanted) << c.exponent) / 16) / one)));
  p.u.c = int64_t(1) << 58;
  r = reference_at(p, 0, 0);
  assert_false(r.u_in_range);
  pixel_area_coordinates(r, q, c);
  assert_true(c.centred && c.how == evaluation::affine && c.c_u == 0 && c.c_v == 0 && c.b_u == 0 && c.a_v == 0);
  assert_true(c.a_u == 1024 << c.exponent && c.b_v == 1024 << c.exponent);
}

int main() {
  const CMUnitTest tests[] = {
      cmocka_unit_test(pixels_are_means_of_their_texels),
      cmocka_unit_test(pixels_of_every_other_format_are_means_of_their_texels),
      cmocka_unit_test(roundings_have_no_bias),
      cmocka_unit_test(footprints_equal_the_whole_map),
      cmocka_unit_test(pictures_are_monotone_in_their_texels),
      cmocka_unit_test(pictures_are_monotone_along_an_edge),
      cmocka_unit_test(footprints_at_the_horizon_and_out_of_range_are_as_specified),
  };
  return run_suite("footprint_properties", tests);
}
