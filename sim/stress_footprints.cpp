// SPDX-License-Identifier: Apache-2.0
#include "sim/stress_footprints.hpp"

#include <spantex/accuracy.hpp>
#include <spantex/plan.hpp>

#include <array>

#include "sim/stress_samples.hpp"

namespace spantex::sim {
namespace {

using real = long double;

double in_units(uint64_t bound) { return double(bound) / double(error_unit); }

// One pixel as the planner would hand it to the engine, its map, and the exact numbers it stands for.
struct pixel_under_test {
  run_time_profile prof;
  const plane& map;
  stress_map sampled;
  span_at span;
  int k, i, j;
  int32_t hx, hy;
  bool whole;  // evaluated about the span's centre
  reference about;
  span_coefficients c;
  int128 w, u, v;  // exact: W, Nu, Nv at the pixel's centre
  stress_judge& judge;

  const texture_view& view() const { return sampled.view; }
  const profile& q() const { return prof.value; }
  int extent_log2() const { return q().offset_bits - 1 - c.exponent; }
  void note(stress_stage stage, double error, double bound) const { judge.note(stage, error, bound, span, k); }
};

void fill_coefficients(pixel_under_test& p, filter kind) {
  const int32_t cx = 16 * p.span.x + 8, cy = 16 * p.span.y + 8;
  const surface s{&p.map, &p.sampled.view, kind};
  p.c = spantex::detail::blank_coefficients(s);
  p.whole = false;
  if (p.map.w_at(cx, cy) > 0) {
    p.whole = spantex::detail::coordinates_of_span(p.prof, s, cx, cy, p.about, p.c);
  }
  if (p.whole) {
    if (uses_footprint(kind)) span_axis(p.q(), p.c);
    if (kind == filter::contour) {
      formula_levels(p.q(), p.map, p.about, p.c);
      span_contour(p.q(), p.c);
    }
    return;
  }
  spantex::detail::coordinates_of_pixel(p.prof, s, p.hx, p.hy, p.about, p.c);
  if (uses_footprint(kind)) pixel_axis(p.map, p.q(), p.hx, p.hy, p.c);
  if (kind == filter::contour) {
    formula_levels_of_pixel(p.q(), p.map, p.about, p.hx, p.hy, p.c);
    pixel_contour(p.map, p.hx, p.hy, p.c);
  }
}

// --- squares, aniso ------------------------------------------------------------------------------------------

// W^2 J, texels per half pixel times W^2, and W. From the forms that the pixel's vector comes from: the rounded ones, exactly, or, where set-up's
// rounding would show in a span, those before it, to 2^-64 of A W and Nu G.
struct exact_gradients { real ux, uy, vx, vy, w; };

bool takes_exact_forms(const pixel_under_test& p) {
  const reference rounded = reference_at(p.map, 16 * p.span.x + 8, 16 * p.span.y + 8);
  return p.whole && (p.about.w_exponent != 0 || p.about.w != rounded.w || p.about.c_u != rounded.c_u || p.about.c_v != rounded.c_v);
}

exact_gradients gradients_of(const pixel_under_test& p) {
  const plane& m = p.map;
  if (!takes_exact_forms(p))
    return {real(m.u.x * p.w - p.u * m.w.x), real(m.u.y * p.w - p.u * m.w.y), real(m.v.x * p.w - p.v * m.w.x), real(m.v.y * p.w - p.v * m.w.y), real(p.w)};
  const auto number = [](const wide& x) { return real(int128_of(x)); };
  const real w = number(m.value(m.exact_w, p.hx, p.hy)), u = number(m.value(m.exact_u, p.hx, p.hy)), v = number(m.value(m.exact_v, p.hx, p.hy));
  const auto gradient = [&](const wide& slope, real n, const wide& slope_of_w) { return number(slope) * w - n * number(slope_of_w); };
  return {gradient(m.exact_u.x, u, m.exact_w.x), gradient(m.exact_u.y, u, m.exact_w.y), gradient(m.exact_v.x, v, m.exact_w.x), gradient(m.exact_v.y, v, m.exact_w.y), w};
}

struct exact_vector { real u, v; };

// J along the direction that the engine chose, texels per pixel.
exact_vector vector_of(const exact_gradients& g, int direction) {
  const screen_direction d = direction_at(direction);
  const real scale = std::ldexp(g.w * g.w, direction_bits - 1), c = real(d.cos), s = real(d.sin);
  return {(c * g.ux + s * g.uy) / scale, (c * g.vx + s * g.vy) / scale};
}

// The level that SPEC section 11 gives the exact vector and the exact area.
real exact_footprint_level(const pixel_under_test& p, const exact_vector& along, const exact_gradients& g) {
  const profile& q = p.q();
  const real w2 = g.w * g.w, length = std::log2(std::hypot(along.u, along.v));
  const real area = std::log2(std::fabs(g.ux * g.vy - g.uy * g.vx) * 4 / (w2 * w2));
  const real ratio = std::clamp(std::min(2 * length - area, length), 0.0L, std::log2(real(q.max_samples)));
  const real minor = length - ratio;
  return std::clamp(finer_level(minor, q.sample_bias) + q.level_bias / 16.0L, 0.0L, real(p.view().last_level()));
}

void judge_vector(const pixel_under_test& p, const footprint& f) {
  const profile& q = p.q();
  const exact_gradients g = gradients_of(p);
  const scaled_jacobian j = p.whole ? scaled_jacobian{span_jacobian(q, p.c), p.c.exponent} : jacobian_at(p.map, p.hx, p.hy);
  const exact_vector exact = vector_of(g, major_direction(j.columns));
  const real length = std::hypot(exact.u, exact.v);
  if (length == 0 || length > 16000) return;  // beyond, components saturate, and the level is the last one
  const auto whole_length = uint32_t(length) + 1;
  const double bound = in_units(p.whole ? axis_bound(q, p.extent_log2(), p.c.axis.exponent, whole_length)
                                        : pixel_axis_bound(j.exponent, p.c.axis.exponent, whole_length));
  p.note(stress_stage::footprint_vector, double(std::fabs(f.u.raw() / 65536.0L - exact.u)), bound);
  p.note(stress_stage::footprint_vector, double(std::fabs(f.v.raw() / 65536.0L - exact.v)), bound);
  if (p.c.kind != filter::aniso) return;
  const real computed = std::ldexp(real(f.level), -q.level_bits);
  p.note(stress_stage::footprint_level, double(std::fabs(computed - exact_footprint_level(p, exact, g))), in_units(footprint_level_bound(q)));
}

// Where the fetch finds what it wants, whatever the position.
void hold(section& at, const snapped_position& p) {
  at.origin_u = p.u - 1;
  at.origin_v = p.v - 2;
}

using channel_sums = std::array<real, channel_count>;

void note_colour(const pixel_under_test& p, stress_stage stage, const footprint_sums& sums, const channel_sums& exact, real weight, double bound) {
  const rgba8 got = mean_colour(sums, p.q().colour_rounding);
  const uint8_t channels[channel_count] = {got.r, got.g, got.b, got.a};
  for (size_t n = 0; n < channel_count; ++n) p.note(stage, double(std::fabs(channels[n] - exact[n] / weight)), bound);
}

void judge_aniso(pixel_under_test& p, random_source& r) {
  const profile& q = p.q();
  const footprint f = footprint_at(p.prof, p.c, p.i, p.j);
  judge_vector(p, f);
  const texel_position centre = position_at(p.prof, p.c, p.i, p.j);
  const int whole = integer_level(p.c.kind, f.level, q.level_bits, p.c.last_level);
  p.c.two_levels = whole < p.c.last_level;
  p.c.fine = spantex::detail::section_at(p.view(), whole);
  p.c.coarse = spantex::detail::section_at(p.view(), p.c.two_levels ? whole + 1 : whole);
  const int64_t fraction = p.c.two_levels ? f.level - (whole << q.level_bits) : 0, one = int64_t(1) << q.level_bits;
  footprint_sums sums{};
  channel_sums exact{};
  for (int k = 0; k < f.samples; ++k) {
    const real part = real(2 * k + 1 - f.samples) / (2 * f.samples);
    for (const coordinate length : {f.u, f.v})
      p.note(stress_stage::sample, double(std::fabs(sample_offset(length, k, f.samples).raw() - length.raw() * part)) / 65536,
             in_units(sample_bound(uint32_t(magnitude(length.raw()) >> 16) + 1)));
    const texel_position at = sample_position(centre, f, k);
    const snapped_position fine = snap(at, p.c.fine, p.c.kind, q), coarse = snap(at, p.c.coarse, p.c.kind, q);
    hold(p.c.fine, fine);
    hold(p.c.coarse, coarse);
    p.c.axis.first_sample = uint8_t(k);
    p.c.axis.last_sample = uint8_t(k + 1);
    const four_texel_memory memory = random_texels(r);
    add(sums, compute_footprint(p.prof, p.c, memory, p.i, p.j, no_observer{}));
    for (size_t n = 0; n < channel_count; ++n) {
      const int64_t low = exact_blend(uint32_t(memory.words[n]), fine.fraction, q.subtexel_bits, false);
      const int64_t high = exact_blend(uint32_t(memory.words[n] >> 32), coarse.fraction, q.subtexel_bits, false);
      exact[n] += std::ldexp(real((one - fraction) * low + fraction * high), -2 * q.subtexel_bits - q.level_bits);
    }
  }
  note_colour(p, stress_stage::aniso, sums, exact, f.samples, in_units(aniso_colour_bound(q, uses_two_levels(p.c.kind))));
}

// SPEC section 11: a texel of square m weighs a twentieth more on the centre's side along each axis in which the row runs.
void judge_squares(pixel_under_test& p, random_source& r) {
  const profile& q = p.q();
  const footprint f = footprint_at(p.prof, p.c, p.i, p.j);
  judge_vector(p, f);
  const texel_position centre = position_at(p.prof, p.c, p.i, p.j);
  p.c.fine = spantex::detail::section_at(p.view(), f.level >> q.level_bits);
  const snapped_position middle = snap(centre, p.c.fine, p.c.kind, q);
  const int64_t u = magnitude(f.u.raw()), v = magnitude(f.v.raw());
  const bool flat = v * 32768 < u * 13573, steep = u * 32768 < v * 13573;
  const int along_u = steep ? 0 : f.u.raw() < 0 && !flat ? -1 : 1, along_v = flat ? 0 : f.v.raw() < 0 && !steep ? -1 : 1;
  const int halves = f.samples / 2;
  footprint_sums sums{};
  channel_sums exact{};
  real weights = 0;
  for (int k = 0; k < f.samples; ++k) {
    const int m = k - halves, side = m > 0 ? 1 : m < 0 ? -1 : 0, row = halves + 3 - std::abs(m);
    const square s = square_at(f, middle.fraction, q.subtexel_bits, k);
    hold(p.c.fine, {middle.u + s.u, middle.v + s.v, middle.fraction});
    p.c.axis.first_sample = uint8_t(k);
    p.c.axis.last_sample = uint8_t(k + 1);
    const four_texel_memory memory = random_texels(r);
    add(sums, compute_footprint(p.prof, p.c, memory, p.i, p.j, no_observer{}));
    // Diagonals run to the right first: the square with the larger u has the larger number.
    const int turn = along_u < 0 ? -1 : 1, sign_u = along_u == 0 ? 0 : side, sign_v = along_v * (along_u == 0 ? 1 : turn) * side;
    for (int t = 0; t < 4; ++t) {
      const int a = (t & 1) * 2 - 1, b = (t >> 1) * 2 - 1, lean = flat || steep ? a * sign_u + b * sign_v : (a * sign_u + b * sign_v) / 2;
      const int weight = (5 - lean) * row;
      weights += weight;
      for (size_t n = 0; n < channel_count; ++n) exact[n] += weight * real((memory.words[n] >> (8 * t)) & 255);
    }
  }
  note_colour(p, stress_stage::squares, sums, exact, weights, in_units(mean_bound(q)));
}

// --- step, hat -----------------------------------------------------------------------------------------------

// Twice the area of a convex polygon, by clipping in long double: shares no step with area.hpp.
struct real_point { real u, v; };
struct real_polygon {
  int count = 0;
  std::array<real_point, 16> at;
};

// Keeps a u + b v + c >= 0.
real_polygon clipped(const real_polygon& p, real a, real b, real c) {
  real_polygon out;
  for (int k = 0; k < p.count; ++k) {
    const real_point &from = p.at[size_t(k)], &to = p.at[size_t((k + 1) % p.count)];
    const real f = a * from.u + b * from.v + c, t = a * to.u + b * to.v + c;
    if (f >= 0) out.at[size_t(out.count++)] = from;
    if ((f > 0 && t < 0) || (f < 0 && t > 0)) out.at[size_t(out.count++)] = {from.u + f / (f - t) * (to.u - from.u), from.v + f / (f - t) * (to.v - from.v)};
  }
  return out;
}

real twice_area_of(const real_polygon& p) {
  real sum = 0;
  for (int k = 0; k < p.count; ++k) {
    const real_point &a = p.at[size_t(k)], &b = p.at[size_t((k + 1) % p.count)];
    sum += a.u * b.v - b.u * a.v;
  }
  return std::fabs(sum);
}

bool is_convex(const area_polygon& p) {
  bool left = false, right = false;
  for (int k = 0; k < p.count; ++k) {
    const area_point &a = p.at[k], &b = p.at[(k + 1) % p.count], &c = p.at[(k + 2) % p.count];
    const int64_t turn = int64_t(b.u - a.u) * (c.v - b.v) - int64_t(b.v - a.v) * (c.u - b.u);
    left = left || turn < 0;
    right = right || turn > 0;
  }
  return !(left && right);
}

// SPEC "Footprints: step and hat": the polygons of a window. False if one is not convex, which rounding can make of a thin one.
struct window_polygons {
  area_polygon at[hat_layers];
  int count;
};
bool polygons_of(const area_window& w, filter kind, window_polygons& out) {
  out.count = layer_count(kind);
  for (int m = 0; m < out.count; ++m) {
    area_polygon& p = out.at[m];
    p.count = corner_count(kind);
    for (int k = 0; k < p.count; ++k) {
      const auto part = [&](int32_t from, int32_t to) {
        const int32_t x = (to - from) * (2 * m + 1);
        return from + (x < 0 ? -((-x + 8) / 16) : (x + 8) / 16);
      };
      p.at[k] = kind == filter::hat ? area_point{part(w.centre.u, w.corner[k].u), part(w.centre.v, w.corner[k].v)} : w.corner[k];
    }
    spantex::detail::thicken(p, {w.columns << w.bits, w.rows << w.bits});
    if (!is_convex(p)) return false;
  }
  return true;
}

real_polygon to_real(const area_polygon& p) {
  real_polygon out;
  for (int k = 0; k < p.count; ++k) out.at[size_t(out.count++)] = {real(p.at[k].u), real(p.at[k].v)};
  return out;
}

struct cell_weights { int32_t at[max_area_side][max_area_side]; };

cell_weights weights_of(const area_window& w, filter kind) {
  cell_weights out{};
  area_weights area(w, kind);
  for (int row = 0; row < w.rows; ++row) area.next_row(out.at[row]);
  return out;
}

void judge_areas(const pixel_under_test& p, const area_window& w, const cell_weights& got) {
  window_polygons layers;
  if (!polygons_of(w, p.c.kind, layers)) return;
  const bool hat = p.c.kind == filter::hat;
  const real full = real(1 << w.bits);
  int64_t sum = 0;
  real whole = 0;
  for (int m = 0; m < layers.count; ++m) whole += twice_area_of(to_real(layers.at[m]));
  for (int row = 0; row < w.rows; ++row) {
    real_polygon strips[hat_layers];
    for (int m = 0; m < layers.count; ++m)
      strips[m] = clipped(clipped(to_real(layers.at[m]), 0, 1, -row * full), 0, -1, (row + 1) * full);
    for (int column = 0; column < w.columns; ++column) {
      real exact = 0;
      for (int m = 0; m < layers.count; ++m)
        exact += twice_area_of(clipped(clipped(strips[m], 1, 0, -column * full), -1, 0, (column + 1) * full));
      p.note(stress_stage::area, double(std::fabs(got.at[row][column] - (hat ? exact / 2 : exact))), in_units(area_bound(hat)));
      sum += got.at[row][column];
    }
  }
  if (!hat) p.note(stress_stage::area, double(std::fabs(real(sum) - whole)), 0.25);  // they add up to the polygon's area
}

// Corners against exact positions, where the footprint is not clipped towards the horizon.
void judge_corners(const pixel_under_test& p) {
  if (!p.whole) {
    span_coefficients unclipped{};
    if (!coordinates_within(2, p.about, p.q(), false, unclipped)) return;
  }
  constexpr int32_t square[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, hexagon[6][2] = {{2, 0}, {2, 2}, {0, 2}, {-2, 0}, {-2, -2}, {0, -2}};  // SPEC
  const bool hat = p.c.kind == filter::hat;
  const double bound = in_units(corner_bound(p.q(), p.extent_log2()));
  for (int k = 0; k < (hat ? 6 : 4); ++k) {
    const wide_position at = position_beside(p.prof, p.c, p.i, p.j, area_corner(p.c.kind, k));
    const int32_t hx = p.hx + (hat ? hexagon : square)[k][0], hy = p.hy + (hat ? hexagon : square)[k][1];
    const exact_point e = p.q().exact_set_up ? exact_at(p.map, hx, hy) : exact_point{p.map.u_at(hx, hy), p.map.v_at(hx, hy), p.map.w_at(hx, hy)};
    const auto judge = [&](wide_coordinate x, int128 n) {
      p.note(stress_stage::corner, double(real(size_of(int128(x.raw()) * e.w - (n << 16))) / std::ldexp(real(e.w), 16)), bound);
    };
    judge(at.u, e.u);
    judge(at.v, e.v);
  }
}

// Random texels by place.
struct torus_memory {
  static constexpr int fine_side = 32;
  uint8_t texel[channel_count][fine_side][fine_side];
  uint64_t at(int channel, int x, int y) const { return texel[channel][y % fine_side][x % fine_side]; }
  template <class Observer>
  fetched fetch(int channel, local_position p, local_position, const Observer&) const {
    return {at(channel, p.x, p.y) | at(channel, p.x + 1, p.y) << 8 | at(channel, p.x, p.y + 1) << 16 | at(channel, p.x + 1, p.y + 1) << 24};
  }
};

void judge_area_filter(pixel_under_test& p, random_source& r) {
  const profile& q = p.q();
  judge_corners(p);
  p.c.fine = spantex::detail::section_at(p.view(), spantex::detail::area_level(p.prof, p.view(), p.c, p.i, p.j));
  const area_window w = area_window_at(p.prof, p.c, p.i, p.j, p.c.fine);
  const cell_weights weights = weights_of(w, p.c.kind);
  judge_areas(p, w, weights);
  torus_memory memory;
  for (auto& channel : memory.texel)
    for (auto& row : channel)
      for (uint8_t& texel : row) texel = uint8_t(r.next() >> 56);
  const footprint_sums sums = compute_area(p.prof, p.c, memory, p.i, p.j, no_observer{});
  channel_sums exact{};
  real total = 0;
  for (int row = 0; row < w.rows; ++row)
    for (int column = 0; column < w.columns; ++column) {
      const real weight = weights.at[row][column];
      total += weight;
      for (int n = 0; n < channel_count; ++n)
        exact[size_t(n)] += weight * real(memory.at(n, (w.u + column) & (memory.fine_side - 1), (w.v + row) & (memory.fine_side - 1)));
    }
  note_colour(p, stress_stage::step_hat, sums, exact, total, in_units(mean_bound(q)));
}

// --- contours --------------------------------------------------------------------------------------------------

real exact_coverage(real distance, int outline) {
  const auto fill = [](real x) { return std::clamp(x + 0.5L, 0.0L, 1.0L); };
  const real half = outline / 32.0L;
  return outline == 0 ? fill(distance) : fill(distance + half) - fill(distance - half);
}

void judge_contour(pixel_under_test& p, random_source& r) {
  const profile& q = p.q();
  const texel_position centre = position_at(p.prof, p.c, p.i, p.j);
  p.c.contour = terms_of({uint16_t(r.next()), uint16_t(16 + r.below(65520)), uint8_t(r.below(2) ? r.next() : 0), field_unit(r.below(2))});
  const int32_t level = level_at(p.prof, p.c, p.i, p.j);
  const int whole = integer_level(p.c.kind, level, q.level_bits, p.c.last_level);
  p.c.two_levels = whole < p.c.last_level;
  p.c.fine = spantex::detail::section_at(p.view(), whole);
  p.c.coarse = spantex::detail::section_at(p.view(), p.c.two_levels ? whole + 1 : whole);
  const snapped_position fine = snap(centre, p.c.fine, p.c.kind, q), coarse = snap(centre, p.c.coarse, p.c.kind, q);
  hold(p.c.fine, fine);
  hold(p.c.coarse, coarse);
  const four_texel_memory memory = random_texels(r);
  const uint8_t got = compute_pixel(p.prof, p.c, memory, p.i, p.j, no_observer{}).a;
  const uint64_t word = memory.words[alpha_channel];
  const auto field = [&](uint64_t texels, weights w) {
    return std::ldexp(real(exact_blend(uint32_t(texels), w, q.subtexel_bits, false)), -2 * q.subtexel_bits) - p.c.contour.threshold / 256.0L;
  };
  const bool doubled = p.c.two_levels && p.c.contour.own_units;
  const real f = p.c.two_levels ? std::ldexp(real(level - (whole << q.level_bits)), -q.level_bits) : 0;
  const real exact_field = (1 - f) * field(word, fine.fraction) + f * field(word >> 32, coarse.fraction) * (doubled ? 2 : 1);
  field_gradient gradient = gradient_of(fine_texels({word}), fine.fraction, q.subtexel_bits);
  if (p.c.two_levels)
    gradient = between_levels(gradient, gradient_of(coarse_texels({word}), coarse.fraction, q.subtexel_bits), uint32_t(level - (whole << q.level_bits)), q.level_bits);
  const int32_t log2 = steepness_log2(p.prof, p.c, gradient, p.i, p.j);  // the scale as computed: its error is judged on pictures (T=contour)
  const real exact = std::clamp(exact_field * std::exp2(log2 / 65536.0L), -32.0L, 32.0L);
  const uint64_t distance_bound = contour_distance_bound(q, doubled, (log2 >> 16) + 1, uint32_t(std::fabs(exact)) + 1);
  p.note(stress_stage::contour, double(std::fabs(got - 255 * exact_coverage(exact, p.c.contour.outline))), in_units(contour_bound(distance_bound)));
}

}  // namespace

// Areas cost a hundred times what samples do: every tenth.
void judge_footprint(const profile& prof, const plane& map, span_at s, span_mask mask, uint64_t seed, stress_judge& judge) {
  random_source r(seed);
  constexpr filter kinds[20] = {filter::squares, filter::squares, filter::squares, filter::squares, filter::squares, filter::squares, filter::aniso,
                                filter::aniso,   filter::aniso,   filter::aniso,   filter::aniso,   filter::aniso,   filter::contour, filter::contour,
                                filter::contour, filter::contour, filter::contour, filter::contour, filter::step,    filter::hat};
  const filter kind = kinds[r.below(20)];
  const int first = int(r.below(span_pixel_count));
  for (int n = 0; n < span_pixel_count; ++n) {
    const int k = (first + n) % span_pixel_count, i = k % span_side, j = k / span_side;
    const int32_t hx = 16 * s.x + 8 + half_pixels(i), hy = 16 * s.y + 8 + half_pixels(j);
    if ((mask >> k & 1) == 0 || map.w_at(hx, hy) <= 0) continue;
    pixel_under_test p{{prof}, map,   stress_map(r.next()), s, k, i, j, hx, hy, false, {}, {}, map.w_at(hx, hy), map.u_at(hx, hy), map.v_at(hx, hy),
                       judge};
    fill_coefficients(p, kind);
    switch (kind) {
      case filter::squares:
        return judge_squares(p, r);
      case filter::aniso:
        return judge_aniso(p, r);
      case filter::contour:
        return judge_contour(p, r);
      default:
        return judge_area_filter(p, r);
    }
  }
}

}  // namespace spantex::sim
