// SPDX-License-Identifier: Apache-2.0
// What the suites on properties share: small views, maps in every texel format, a loop over the profiles, and what a pixel is made of:
// its texels and their weights as whole numbers, by the planner's and the datapath's decisions or by exact arithmetic alone.
#pragma once
#include <algorithm>
#include <cmath>

#include <tests/formats.hpp>
#include <tests/whole_map.hpp>

#include <sim/exact.hpp>
#include <spantex/accuracy.hpp>

namespace spantex::sim {

// --- views ---------------------------------------------------------------------------------------------

// The same view through 1/factor of the pixels per side: factor times the minification.
inline homography shrunk(homography m, int32_t factor) {
  for (wide* c : {&m.a, &m.b, &m.d, &m.e, &m.g, &m.h}) *c = multiply(*c, factor);
  return m;
}

// The view from pixel (x, y) on.
inline homography from_pixel(homography m, int32_t x, int32_t y) {
  m.c = m.c + multiply(m.a, x) + multiply(m.b, y);
  m.f = m.f + multiply(m.d, x) + multiply(m.e, y);
  m.i = m.i + multiply(m.g, x) + multiply(m.h, y);
  return m;
}

// u and v divided by 2^log2.
inline homography magnified(homography m, int log2) {
  for (wide* c : {&m.a, &m.b, &m.c, &m.d, &m.e, &m.f}) *c = shift_right_floor(*c, log2);
  return m;
}

inline plane plane_of(const homography& m, int32_t width, int32_t height) {
  plane p{};
  if (make_plane(m, {0, 0, width, height}, p) != status::ok) std::abort();
  return p;
}

// Whole views, heavily minified and near 1:1, a horizon, and a magnified one.
inline constexpr int view_count = 5;
inline plane view_plane(int k, int32_t width, int32_t height) {
  switch (k) {
    case 0:
      return plane_of(shrunk(sample_homography(0), 3), width, height);
    case 1:
      return plane_of(shrunk(sample_homography(1), 5), width, height);
    case 2:
      return plane_of(from_pixel(sample_homography(2), 240, 200), width, height);
    case 3:
      return plane_of(shrunk(sample_homography(3), 10), width, height);
    default:
      return plane_of(magnified(from_pixel(sample_homography(1), 240, 200), 3), width, height);
  }
}

// Small, so that every map edge and wrap is met; the second has no side that halves exactly.
inline const synthetic_map& map_for(int view) {
  static const synthetic_map &even = photographic_map(32, 16, 5), &odd = photographic_map(21, 13, 6);
  return view % 2 == 0 ? even : odd;
}

// u, v at the centre of pixel (0, 0) and their steps a pixel, in 2^-12 texel.
inline plane ramp(int32_t u0, int32_t u_x, int32_t v0, int32_t v_y, int32_t w, int32_t h) {
  const auto n = [](int64_t k) { return wide(k << 20); };
  const homography m{n(2 * u_x), n(0), n(2 * u0 - u_x), n(0), n(2 * v_y), n(2 * v0 - v_y), n(0), n(0), n(2 << 12)};
  return plane_of(m, w, h);
}

// --- profiles, formats -----------------------------------------------------------------------------------

// use(fixed_profile<P>, name) for each of the four.
template <class Use>
void for_each_profile(Use use) {
  use(fixed_profile<profiles::seed>{}, "seed");
  use(fixed_profile<profiles::compact>{}, "compact");
  use(fixed_profile<profiles::standard>{}, "default");
  use(fixed_profile<profiles::exact>{}, "exact");
}

// Of 32 and 16 bits, which the synthetic maps come in.
inline constexpr texel_format plain_formats[] = {texel_format::rgba8888, texel_format::rgb565, texel_format::argb1555,
                                               texel_format::argb4444};

// The nearest colour that a format holds.
constexpr rgba8 as_held(texel_format f, rgba8 c) { return f == texel_format::rgba8888 ? c : unpack(f, pack(f, c)); }

// A synthetic map in a texel format.
struct formatted_map {
  const synthetic_map* source;
  texel_format format;
  std::vector<std::vector<uint16_t>> packed;
  texture_view view(wrap wrap_u, wrap wrap_v) const {
    if (format == texel_format::rgba8888) return source->view(wrap_u, wrap_v);
    const uint16_t* levels[max_levels] = {};
    for (size_t k = 0; k < packed.size(); ++k) levels[k] = packed[k].data();
    texture_view t;
    const level_pixels& base = source->levels[0];
    if (texture_view::make(format, levels, int(packed.size()), base.width, base.height, wrap_u, wrap_v, t) != status::ok) std::abort();
    return t;
  }
};

inline const formatted_map& in_format(const synthetic_map& source, texel_format f) {
  static std::deque<formatted_map> kept;
  for (const formatted_map& m : kept)
    if (m.source == &source && m.format == f) return m;
  kept.push_back({&source, f, {}});
  if (f == texel_format::rgba8888) return kept.back();
  for (const level_pixels& level : source.levels) {
    std::vector<uint16_t>& out = kept.back().packed.emplace_back();
    for (const rgba8& c : level.texels) out.push_back(pack(f, c));
  }
  return kept.back();
}

// use(format, turn) for the others: bytes, palettes, blocks; turn counts on, for wraps and views that take turns.
template <class Use>
void for_each_other_format(size_t& turn, Use use) {
  for (const texel_format f : all_formats)
    if (std::find(std::begin(plain_formats), std::end(plain_formats), f) == std::end(plain_formats)) use(f, turn++);
}

// --- what a pixel is made of -------------------------------------------------------------------------------

struct pixel_source {
  int32_t detail;  // level of detail, in steps; 0 for filters without levels
  int level;       // of `fine`
  bool two_levels;
  snapped_position fine, coarse;  // before any correction
  uint32_t fraction;              // of the level of detail
  bool corrected;                 // the section does not hold it: the correction moves it
  texel_position at;
  int extent_log2;  // of its span: what the coordinate bound depends on
};

namespace detail {

inline bool is_moved(const snapped_position& p, const section& at, int side, filter kind, const profile& q) {
  const corrected c = correct(p, at, side, kind, q);
  return c.fraction.u != p.fraction.u || c.fraction.v != p.fraction.v || c.at.x != (p.u & (side - 1)) || c.at.y != (p.v & (side - 1)) ||
         p.u < at.origin_u || p.v < at.origin_v || p.u - at.origin_u > side - 1 || p.v - at.origin_v > side - 1;
}

template <class Prof>
pixel_source source_of(const Prof& prof, const span_coefficients& c, int i, int j) {
  const profile& q = prof.get();
  pixel_source s{};
  s.at = position_at(prof, c, i, j);
  s.detail = uses_levels(c.kind) ? level_at(prof, c, i, j) : 0;
  s.level = c.fine.level;
  s.two_levels = c.two_levels;
  s.fine = snap(s.at, c.fine, c.kind, q);
  s.corrected = is_moved(s.fine, c.fine, q.fine_side, c.kind, q);
  s.extent_log2 = q.offset_bits - 1 - c.exponent;
  if (c.two_levels) {
    s.coarse = snap(s.at, c.coarse, c.kind, q);
    s.corrected = s.corrected || is_moved(s.coarse, c.coarse, q.coarse_side(), c.kind, q);
    s.fraction = uint32_t(clamp_to(s.detail - (s.level << q.level_bits), 0, (1 << q.level_bits) - 1));
  }
  return s;
}

}  // namespace detail

// use(x, y, source) for every pixel of the area with W > 0, as the planner cuts it.
template <class Prof, class Use>
void each_source(const Prof& prof, const surface& s, rectangle area, Use use) {
  for (int32_t sy = area.y0 / span_side; sy <= (area.y1 - 1) / span_side; ++sy)
    for (int32_t sx = area.x0 / span_side; sx <= (area.x1 - 1) / span_side; ++sx) {
      const span_mask mask = rectangle_mask(area, sx, sy) & front_mask(*s.map, sx, sy);
      if (mask == 0) continue;
      SPANTEX_ASSERT_OK(plan_span(prof, s, sx, sy, mask, [&](span_job& job) {
        for (span_mask rest = job.mask; rest != 0; rest &= rest - 1) {
          const int k = __builtin_ctzll(rest), i = k % span_side, j = k / span_side;
          use(sx * span_side + i, sy * span_side + j, detail::source_of(prof, job.coefficients, i, j));
        }
        return status::ok;
      }));
    }
}

// A texel and its share of a pixel, in 2^-bits.
struct share {
  rgba8 texel;
  int64_t weight;
};
struct shares {
  share of[8];
  int count = 0, bits = 0;
  void add(rgba8 texel, int64_t weight) { of[count++] = {texel, weight}; }
  // The exact colour, in 2^-bits.
  int64_t value(int channel) const {
    int64_t sum = 0;
    for (int k = 0; k < count; ++k) sum += of[k].weight * channel_of(of[k].texel, channel);
    return sum;
  }
  // Rounded once, halves to even.
  uint8_t rounded(int channel) const { return uint8_t(shift_right(value(channel), bits, rounding::even)); }
  // The smallest and largest of the texels that have a weight at all.
  uint32_t smallest(int channel) const {
    uint32_t least = 255;
    for (int k = 0; k < count; ++k)
      if (of[k].weight != 0 && channel_of(of[k].texel, channel) < least) least = channel_of(of[k].texel, channel);
    return least;
  }
  uint32_t largest(int channel) const {
    uint32_t most = 0;
    for (int k = 0; k < count; ++k)
      if (of[k].weight != 0 && channel_of(of[k].texel, channel) > most) most = channel_of(of[k].texel, channel);
    return most;
  }
};

namespace detail {

inline void add_level(shares& out, const texture_view& t, int level, const snapped_position& p, bool three, int subtexel_bits,
                      int64_t scale) {
  const auto texel = [&](int x, int y) { return t.texel(level, t.wrapped_u(p.u + x, level), t.wrapped_v(p.v + y, level)); };
  const int64_t one = int64_t(1) << subtexel_bits, u = p.fraction.u, v = p.fraction.v;
  if (three) {
    out.add(texel(0, 0), scale * (one - (u > v ? u : v)));
    out.add(u > v ? texel(1, 0) : texel(0, 1), scale * (u > v ? u - v : v - u));
    out.add(texel(1, 1), scale * (u > v ? v : u));
    return;
  }
  out.add(texel(0, 0), scale * (one - u) * (one - v));
  out.add(texel(1, 0), scale * u * (one - v));
  out.add(texel(0, 1), scale * (one - u) * v);
  out.add(texel(1, 1), scale * u * v);
}

}  // namespace detail

// The texels of a pixel on the whole map, and their exact weights.
inline shares shares_of(const pixel_source& s, const texture_view& t, filter kind, int subtexel_bits, int level_bits) {
  shares out;
  if (kind == filter::nearest) {
    out.add(t.texel(0, t.wrapped_u(s.fine.u, 0), t.wrapped_v(s.fine.v, 0)), 1);
    return out;
  }
  const bool three = uses_three_points(kind);
  out.bits = (three ? 1 : 2) * subtexel_bits + (s.two_levels ? level_bits : 0);
  detail::add_level(out, t, s.level, s.fine, three, subtexel_bits, s.two_levels ? (1 << level_bits) - int64_t(s.fraction) : 1);
  if (s.two_levels) detail::add_level(out, t, s.level + 1, s.coarse, three, subtexel_bits, s.fraction);
  return out;
}

// --- the same by exact arithmetic ----------------------------------------------------------------------------

// floor(n / d), d > 0.
constexpr int128 floor_quotient(int128 n, int128 d) { return n / d - (n % d < 0 ? 1 : 0); }

// n/w size_level/size_0 - 1/2 in 2^-bits, rounded once, halves up; 59 + 12 + 10 bits.
inline int32_t exactly_snapped(int64_t n, int64_t w, int32_t size_level, int32_t size_0, int bits) {
  if (size_level == 1) return 0;
  const int128 unit = int128(w) * size_0;
  return int32_t(floor_quotient((int128(n) * size_level << (bits + 1)) - ((int128(1) << bits) - 1) * unit, 2 * unit));
}

inline snapped_position exact_position_on(const plane& p, const texture_view& t, int level, int32_t hx, int32_t hy, int bits) {
  const int32_t u = exactly_snapped(p.u_at(hx, hy), p.w_at(hx, hy), t.width(level), t.width(), bits);
  const int32_t v = exactly_snapped(p.v_at(hx, hy), p.w_at(hx, hy), t.height(level), t.height(), bits);
  const int32_t mask = (1 << bits) - 1;
  return {u >> bits, v >> bits, {uint32_t(u & mask), uint32_t(v & mask)}};
}

// What a pixel with W > 0 is made of for two-level filters: position and level from the plane's integers, each rounded once to the
// profile's bits (ties of a logarithm cannot occur but at whole and half levels, which 8 bits hold).
inline pixel_source exact_source(const plane& p, const texture_view& t, const profile& q, int32_t x, int32_t y) {
  const int32_t hx = 2 * x + 1, hy = 2 * y + 1, one = 1 << q.level_bits, last = t.last_level() * one;
  const long double formula = biased_level(q, q.formula == level_formula::major ? exact_major_level(p, hx, hy) : exact_level(p, hx, hy));
  const long double exact = std::floor(formula * one + 0.5L);
  const int32_t level = exact < 0 ? 0 : exact > last ? last : int32_t(exact);
  pixel_source s{};
  s.detail = level;
  s.level = level >> q.level_bits;
  s.fraction = uint32_t(level & (one - 1));
  s.fine = exact_position_on(p, t, s.level, hx, hy, q.subtexel_bits);
  s.two_levels = s.fraction != 0;
  if (s.two_levels) s.coarse = exact_position_on(p, t, s.level + 1, hx, hy, q.subtexel_bits);
  return s;
}

// --- rounding errors --------------------------------------------------------------------------------------------

// Distance of written colours from exact values, in LSB / 2^32.
struct rounding_error {
  int64_t worst = 0;
  int128 sum = 0;
  int64_t count = 0;
  void note(uint32_t colour, int64_t exact, int bits) {
    const int64_t error = ((int64_t(colour) << bits) - exact) * (int64_t(1) << (32 - bits));
    if (error > worst || -error > worst) worst = error < 0 ? -error : error;
    sum += error;
    ++count;
  }
  double worst_lsb() const { return double(worst) / 4294967296.0; }
  double mean_lsb() const { return count == 0 ? 0 : double(sum) / double(count) / 4294967296.0; }
  bool is_unbiased() const { return 50 * magnitude_of(sum) < int128(count) << 32; }  // less than 0.02 LSB
  bool is_within_bound(const profile& q, bool two_levels) const { return uint64_t(worst) <= colour_bound(q, two_levels) >> (error_unit_log2 - 32); }
};

}  // namespace spantex::sim
