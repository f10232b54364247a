// SPDX-License-Identifier: Apache-2.0
#include "sim/stress_judge.hpp"

#include <spantex/accuracy.hpp>
#include <spantex/coordinates.hpp>
#include <spantex/datapath.hpp>
#include <spantex/level.hpp>
#include <spantex/plan.hpp>

#include <algorithm>
#include <cstdlib>

#include "sim/random.hpp"
#include "sim/stress_footprints.hpp"
#include "sim/stress_samples.hpp"

namespace spantex::sim {
namespace {

constexpr int last_level_judged = 12;  // level errors count where the exact level lies in [0, 12]

double in_units(uint64_t bound) { return double(bound) / double(error_unit); }

long double ratio(int128 a, int128 b) { return static_cast<long double>(a) / static_cast<long double>(b); }

stress_stage stage_of(evaluation how) {
  switch (how) {
    case evaluation::affine:
      return stress_stage::affine;
    case evaluation::series:
      return stress_stage::series;
    case evaluation::divide:
      break;
  }
  return stress_stage::divide;
}

}  // namespace

stress_bounds::stress_bounds(const profile& p) : prof(p) {
  for (int exponent = 0; exponent <= max_exponent; ++exponent) {
    const int extent_log2 = p.offset_bits - 1 - exponent;
    if (extent_log2 > max_extent_log2) continue;
    numerator[exponent] = in_units(numerator_bound(p, extent_log2));
    affine[exponent] = in_units(affine_bound(p, extent_log2) - set_up_bound(p));
    series[exponent] = in_units(series_bound(p, extent_log2) - set_up_bound(p));
    divide[exponent] = in_units(divide_bound(p, extent_log2) - set_up_bound(p));
  }
  pixel_numerator = in_units(pixel_numerator_bound(p));
  pixel = in_units(pixel_bound(p) - set_up_bound(p));
  set_up = in_units(set_up_bound(p));
  saturation = in_units(saturation_bound());
  relative_w = in_units(relative_w_bound(p));
  reciprocal = in_units(reciprocal_unit_bound(p));
  level = in_units(level_bound(p));
  major_level = in_units(major_level_bound(p));
  log2 = in_units(log2_bound());
  for (int k = 0; k < max_levels; ++k) snapping[k] = in_units(snapping_bound(p, k));
  for (const bool two : {false, true}) colour[two] = in_units(colour_bound(p, two));
}

// A span with its coefficients as the planner fills them, its own or those of each pixel.
class stress_judge::span_under_test {
 public:
  span_under_test(const profile& p, const plane& m, span_at s) : prof{p}, map(m), at(s), cx_(16 * s.x + 8), cy_(16 * s.y + 8) {
    c_.last_level = last_level_judged + 1;
    if (m.w_at(cx_, cy_) <= 0) return;
    whole = spantex::detail::coordinates_of_span(prof, {&m, nullptr, filter::trilinear}, cx_, cy_, reference_, c_);
    if (whole) set_levels(cx_, cy_);
  }

  const span_coefficients& coefficients(int i, int j) {
    if (!whole) spantex::detail::coordinates_of_pixel(prof, {&map, nullptr, filter::trilinear}, hx(i), hy(j), reference_, c_);
    return c_;
  }

  // The same with the terms of a formula of the level of detail.
  const span_coefficients& with_levels(int i, int j, level_formula f) {
    if (!whole) set_levels(hx(i), hy(j));
    terms_[int(f)].copy_to(c_);
    return c_;
  }

  // What the coefficients are made from, and the position of a pixel from there.
  const reference& about() const { return reference_; }
  int32_t dx(int i) const { return whole ? half_pixels(i) : 0; }
  int32_t dy(int j) const { return whole ? half_pixels(j) : 0; }
  // Made from the plane's rounded forms, not from the exact ones.
  bool is_rounded(int i, int j) const {
    return map.dropped_bits > 0 && reference_.w_exponent == 0 && reference_.w == (whole ? map.w_at(cx_, cy_) : map.w_at(hx(i), hy(j)));
  }
  int64_t w0() const { return reference_.w; }
  int64_t w_of(int i, int j) const { return w0() + reference_.g * dx(i) + reference_.h * dy(j); }
  int128 offset_u(int i, int j) const { return reference_.c_u + int128(reference_.a_u) * dx(i) + int128(reference_.b_u) * dy(j); }
  int128 offset_v(int i, int j) const { return reference_.c_v + int128(reference_.a_v) * dx(i) + int128(reference_.b_v) * dy(j); }

  // Levels by the same integers: the longer column of the Jacobian, texels per pixel (a pixel about itself takes the plane's), and K / W^2.
  long double exact_jacobian_level(int i, int j) const {
    if (!whole) return exact_level(map, hx(i), hy(j));
    const reference& r = reference_;
    const int128 w = w_of(i, j), u = offset_u(i, j), v = offset_v(i, j);
    const auto column = [&](int64_t a, int64_t d, int64_t g) {
      return std::hypot(static_cast<long double>(a * w - u * g), static_cast<long double>(d * w - v * g));
    };
    return std::log2(2 * std::fmax(column(r.a_u, r.a_v, r.g), column(r.b_u, r.b_v, r.h))) - 2 * std::log2(static_cast<long double>(w));
  }
  long double exact_major_axis_level(int i, int j) const {
    return static_cast<long double>(map.major_log2) / 65536 -
           2 * (std::log2(static_cast<long double>(w_of(i, j))) + static_cast<long double>(reference_.w_exponent));
  }

  int32_t hx(int i) const { return cx_ + half_pixels(i); }
  int32_t hy(int j) const { return cy_ + half_pixels(j); }

  run_time_profile prof;
  const plane& map;
  span_at at;
  bool whole = false;

 private:
  struct level_terms {
    int16_t row[span_side], column[span_side];
    void copy_from(const span_coefficients& c) { std::copy_n(c.level_row, span_side, row), std::copy_n(c.level_column, span_side, column); }
    void copy_to(span_coefficients& c) const { std::copy_n(row, span_side, c.level_row), std::copy_n(column, span_side, c.level_column); }
  };

  void set_levels(int32_t hx, int32_t hy) {
    major_levels(map, reference_, c_);
    terms_[int(level_formula::major)].copy_from(c_);
    if (whole)
      span_levels(prof.value, c_);
    else
      pixel_levels(map, hx, hy, c_);
    terms_[int(level_formula::jacobian)].copy_from(c_);
  }

  int32_t cx_, cy_;
  reference reference_{};
  span_coefficients c_{};
  level_terms terms_[2];
};

// What the datapath makes of one pixel that is in front, and the exact numbers it stands for: the caller's where the profile keeps them, else
// those of the plane's rounded forms.
struct stress_judge::evaluated_pixel {
  evaluated_pixel(span_under_test& of, int index) : span(of), k(index), i(index % span_side), j(index / span_side) {
    const int32_t hx = of.hx(i), hy = of.hy(j);
    if (of.map.w_at(hx, hy) <= 0) return;
    const exact_point exact = of.prof.value.exact_set_up
                                  ? exact_at(of.map, hx, hy)
                                  : exact_point{of.map.u_at(hx, hy), of.map.v_at(hx, hy), of.map.w_at(hx, hy)};
    w = exact.w;
    if (w <= 0) return;
    numerator[0] = exact.u;
    numerator[1] = exact.v;
    c = &span.coefficients(i, j);
    at = position_at(span.prof, *c, i, j);
    for (const int axis : {0, 1}) counts[axis] = in_range(numerator[axis], w);
  }
  coordinate position(bool v) const { return v ? at.v : at.u; }
  // What set-up's rounding can have done to a coordinate: d (1 + |u|) / W, and what the exact forms are cut by.
  double set_up_error(bool v) const {
    if (!span.prof.value.exact_set_up || span.map.dropped_bits <= 0) return 0;
    if (!span.is_rounded(i, j)) return std::ldexp(1.0, -26);
    const plane& p = span.map;
    const auto half_units = double(set_up_half_units(span.hx(i) - p.origin_x, span.hy(j) - p.origin_y));
    return half_units / 2 * (1 + double(ratio(size_of(numerator[v]), w))) / double(p.w_at(span.hx(i), span.hy(j)));
  }
  stress_stage stage() const { return span.whole ? stage_of(c->how) : stress_stage::pixel; }

  span_under_test& span;
  int k, i, j;
  int64_t w = 0;
  int128 numerator[2] = {};
  const span_coefficients* c = nullptr;
  texel_position at{};
  bool counts[2] = {};
};

void stress_judge::note(stress_stage stage, double error, double bound, span_at s, int pixel) {
  stress_record& record = row_.stages[int(stage)];
  ++record.judged;
  if (!(error <= bound)) ++record.failures;
  const bool largest = error > record.largest.error, worst = bound > 0 ? error > record.share * bound : error > 0 && record.share < 1;
  if (!largest && !worst && record.judged != 1) return;
  const stress_worst here{error, bound, row_.family, seed_, s.x, s.y, pixel};
  if (largest || record.judged == 1) record.largest = here;
  if (worst || record.judged == 1) {
    record.worst = here;
    record.share = here.share();
  }
}

// n, relative w and 1/w of a pixel, against the integers that its coefficients are made from.
void stress_judge::judge_arithmetic(const evaluated_pixel& e) {
  const span_coefficients& c = *e.c;
  const int bits = e.span.prof.value.reciprocal_bits;
  const int128 w0 = e.span.w0();
  const double limit = e.span.whole ? bounds_.numerator[c.exponent] : bounds_.pixel_numerator;
  for (const bool v : {false, true}) {
    if (!e.counts[v] || !(v ? e.span.about().v_in_range : e.span.about().u_in_range)) continue;
    const int32_t n =
        (v ? numerator_at<run_time_profile>(c, c.c_v, c.a_v, c.b_v, e.i, e.j) : numerator_at<run_time_profile>(c, c.c_u, c.a_u, c.b_u, e.i, e.j))
            .raw();
    const int128 exact = v ? e.span.offset_v(e.i, e.j) : e.span.offset_u(e.i, e.j);  // n = exact / w0
    note(stress_stage::numerator, double(ratio(size_of(n * w0 - (exact << c.exponent)), w0 << c.exponent)), limit, e.span.at, e.k);
  }
  if (!e.span.whole) return;
  const int128 w = w_at(e.span.prof, c, e.i, e.j), exact = e.span.w_of(e.i, e.j);
  note(stress_stage::relative_w, double(ratio(size_of(w * w0 - (exact << bits)), w0 << bits)), bounds_.relative_w, e.span.at, e.k);
  if (c.how != evaluation::divide) return;
  const int128 one = int128(1) << (2 * bits), product = w * reciprocal_of_w(uint32_t(w), bits);
  note(stress_stage::reciprocal, double(ratio(size_of(product - one), one)), bounds_.reciprocal, e.span.at, e.k);
}

// One coordinate of a pixel on its map: snapped to a level, to a single texel, and on the nearest texel.
void stress_judge::judge_axis(const evaluated_pixel& e, const stress_map& sampled, bool v, double bound) {
  const profile& q = e.span.prof.value;
  const texture_view& t = sampled.view;
  const section at = spantex::detail::section_at(t, sampled.level), whole = spantex::detail::section_at(t, 0);
  const snapped_position p = snap(e.at, at, filter::bilinear, q), texel = snap(e.at, whole, filter::nearest, q);
  const int32_t snapped = ((v ? p.v : p.u) << q.subtexel_bits) + int32_t(v ? p.fraction.v : p.fraction.u), k = v ? texel.v : texel.u;
  const int32_t side = v ? t.height(sampled.level) : t.width(sampled.level), side_0 = v ? t.height() : t.width();
  if (side == 1)
    note(stress_stage::one_wide, std::abs(snapped), 0, e.span.at, e.k);
  else
    note(stress_stage::snapped, snapped_error(snapped, q.subtexel_bits, e.numerator[v], e.w, side, side_0),
         std::ldexp(bound, -sampled.level) + bounds_.snapping[sampled.level], e.span.at, e.k);
  if (side_0 == 1) {
    note(stress_stage::one_wide, std::abs(k), 0, e.span.at, e.k);
  } else {
    const int128 before = int128(k) * e.w - e.numerator[v], behind = -before - e.w;
    note(stress_stage::nearest, double(ratio(std::max(int128(0), std::max(before, behind)), e.w)), bound, e.span.at, e.k);
    const int128 within = e.numerator[v] - floor_of(e.numerator[v], e.w) * e.w;  // of the texel that holds the exact position
    row_.undecided += double(ratio(std::min(within, e.w - within), e.w)) < bound;
  }
}

// |u| or |v| >= 2^15: +-32767 or beyond, with the right sign.
void stress_judge::judge_out_of_range(const evaluated_pixel& e, bool v) {
  const int64_t raw = e.position(v).raw();
  const int64_t outwards = e.numerator[v] < 0 ? -raw : raw, least = int64_t(32767) << 16;
  note(stress_stage::out_of_range, double(std::max(int64_t(0), least - outwards)) / 65536, 0, e.span.at, e.k);
}

// Exact levels are logarithms of exact integers, in long double.
void stress_judge::judge_levels(span_under_test& span, const evaluated_pixel& e) {
  const auto limited = [](long double level) { return std::clamp(level, 0.0L, static_cast<long double>(last_level_judged)); };
  const auto judge = [&](stress_stage stage, level_formula f, long double formula, double bound) {
    const long double exact = biased_level(span.prof.value, formula);
    const long double computed =
        std::ldexp(static_cast<long double>(level_at(span.prof, span.with_levels(e.i, e.j, f), e.i, e.j)), -span.prof.value.level_bits);
    note(stage, double(std::fabs(limited(computed) - limited(exact))), bound, span.at, e.k);
  };
  judge(stress_stage::level_jacobian, level_formula::jacobian, span.exact_jacobian_level(e.i, e.j), bounds_.level);
  judge(stress_stage::level_major, level_formula::major, span.exact_major_axis_level(e.i, e.j), bounds_.major_level);
  const auto judge_log2 = [&](uint64_t x) {
    note(stress_stage::log2, double(std::fabs(static_cast<long double>(log2_16(x)) / 65536 - std::log2(static_cast<long double>(x)))),
         bounds_.log2, span.at, e.k);
  };
  judge_log2(uint64_t(e.w));
  if (span.whole) judge_log2(w_at(span.prof, *e.c, e.i, e.j));
}

// The datapath's colour of a pixel from random texels, against the exact blend with the weights of its snapped position and level.
void stress_judge::judge_colour(span_under_test& span, const evaluated_pixel& e, const stress_map& sampled) {
  const profile& q = span.prof.value;
  span_coefficients c = span.with_levels(e.i, e.j, q.formula);
  c.kind = filter((e.k / 5 + span.at.x + span.at.y) % 6);
  c.last_level = uint8_t(sampled.view.last_level());
  const int32_t level = uses_levels(c.kind) ? level_at(span.prof, c, e.i, e.j) : 0;
  const int whole = integer_level(c.kind, level, q.level_bits, c.last_level);
  c.two_levels = uses_two_levels(c.kind) && whole < c.last_level;
  c.fine = spantex::detail::section_at(sampled.view, whole);
  c.coarse = spantex::detail::section_at(sampled.view, c.two_levels ? whole + 1 : whole);
  const snapped_position fine = snap(e.at, c.fine, c.kind, q), coarse = snap(e.at, c.coarse, c.kind, q);
  c.fine.origin_u = fine.u - 3, c.fine.origin_v = fine.v - 1;  // sections that hold the position: the correction does not act
  c.coarse.origin_u = coarse.u, c.coarse.origin_v = coarse.v - 2;
  random_source r(mix(seed_, uint64_t(span.at.x) << 32 | uint32_t(span.at.y), uint64_t(e.k)));
  const four_texel_memory memory = random_texels(r);
  const rgba8 got = compute_pixel(span.prof, c, memory, e.i, e.j, no_observer{});
  const uint8_t channels[channel_count] = {got.r, got.g, got.b, got.a};
  const bool three = uses_three_points(c.kind);
  const int64_t f = c.two_levels ? level - (whole << q.level_bits) : 0, one = int64_t(1) << q.level_bits;
  const int bits = 2 * q.subtexel_bits + q.level_bits;
  for (int k = 0; k < channel_count; ++k) {
    const int64_t low = exact_blend(uint32_t(memory.words[k]), fine.fraction, q.subtexel_bits, three);
    const int64_t high = exact_blend(uint32_t(memory.words[k] >> 32), coarse.fraction, q.subtexel_bits, three);
    const int64_t error = std::abs((int64_t(channels[k]) << bits) - ((one - f) * low + f * high));
    note(stress_stage::colour, std::ldexp(double(error), -bits), c.kind == filter::nearest ? 0 : bounds_.colour[uses_two_levels(c.kind)], span.at,
         e.k);
  }
  const int kept = q.blend_bits + q.level_bits;
  const auto value = uint32_t(r.next() % ((uint64_t(255) << kept) + 1));
  const int64_t error = std::abs((int64_t(written({value, kept}, q)) << kept) - int64_t(value));
  note(stress_stage::write_out, std::ldexp(double(error), -kept), q.colour_rounding == rounding::floor ? 1 : 0.5, span.at, e.k);
}

// Levels and colours are judged for every fifth pixel: logarithms are slow.
stress_judge::signed_error stress_judge::judge_pixel(span_under_test& span, const stress_map& sampled, int k, bool adverse) {
  const evaluated_pixel e(span, k);
  if (e.w <= 0) return {};
  const stress_stage stage = e.stage();
  const span_coefficients& c = *e.c;
  const double bound = stage == stress_stage::pixel      ? bounds_.pixel
                       : stage == stress_stage::affine   ? bounds_.affine[c.exponent]
                       : stage == stress_stage::series   ? bounds_.series[c.exponent]
                                                         : bounds_.divide[c.exponent];
  signed_error result{0, 0, bound, e.counts[0] && e.counts[1]};
  if (result.counts) result.bound += std::fmin(std::fmax(e.set_up_error(false), e.set_up_error(true)), bounds_.set_up);
  for (const bool v : {false, true}) {
    if (!e.counts[v]) {
      judge_out_of_range(e, v);
      continue;
    }
    const auto error = double(ratio(int128(e.position(v).raw()) * e.w - (e.numerator[v] << 16), int128(e.w) << 16));
    (v ? result.v : result.u) = error;
    ++row_.evaluations;
    row_.adverse += adverse;
    const bool saturates = (e.numerator[v] << 16) > int128(coordinate::raw_max()) * e.w;
    const double limit = bound + std::fmin(e.set_up_error(v), bounds_.set_up) + (saturates ? bounds_.saturation : 0);
    note(stage, std::fabs(error), limit, span.at, k);
    judge_axis(e, sampled, v, limit);
  }
  judge_arithmetic(e);
  if (result.counts && k % 5 == 0) {
    judge_levels(span, e);
    judge_colour(span, e, sampled);
  }
  return result;
}

void stress_judge::judge_span(const plane& map, span_at s, span_mask mask, bool adverse) {
  span_under_test span(bounds_.prof, map, s);
  const stress_map sampled(mix(seed_, uint64_t(s.x), uint64_t(s.y)));
  for (span_mask rest = mask; rest != 0; rest &= rest - 1) judge_pixel(span, sampled, __builtin_ctzll(rest), adverse);
  judge_footprint(bounds_.prof, map, s, mask, mix(seed_, uint64_t(s.x) << 32 | uint32_t(s.y), 5), *this);
}

void stress_judge::judge_walk(stress_stage stage, const plane& map, int line, int spans, bool down) {
  signed_error first{};
  for (int n = 0; n < spans; ++n) {
    const span_at s = down ? span_at{line / span_side, n} : span_at{n, line / span_side};
    span_under_test span(bounds_.prof, map, s);
    const stress_map sampled(mix(seed_, uint64_t(s.x), uint64_t(s.y)));
    const bool adverse = is_adverse(row_.family, map, s);
    for (int along = 0; along < span_side; ++along) {
      const int across = line % span_side, k = down ? along * span_side + across : across * span_side + along;
      const signed_error here = judge_pixel(span, sampled, k, adverse);
      if (!here.counts) continue;
      if (!first.counts) first = here;
      note(stage, std::max(std::fabs(here.u - first.u), std::fabs(here.v - first.v)), here.bound + first.bound, s, k);
    }
    if (n % 8 == 7) judge_moved(map, s);
  }
}

void stress_judge::judge_walks(const stress_plane_case& c) {
  const auto spans = [](int pixels) { return (pixels + span_side - 1) / span_side; };
  judge_walk(stress_stage::row, c.map, c.y0, spans(c.width_px), false);
  judge_walk(stress_stage::column, c.map, c.x0, spans(c.height_px), true);
}

void stress_judge::judge_moved(const plane& map, span_at s) {
  plane moved = map;
  for (linear_form plane::*form : {&plane::u, &plane::v, &plane::w})
    (moved.*form).c = map.value(map.*form, map.origin_x + 16 * s.x, map.origin_y + 16 * s.y);
  for (wide_form plane::*form : {&plane::exact_u, &plane::exact_v, &plane::exact_w})
    (moved.*form).c = map.value(map.*form, map.origin_x + 16 * s.x, map.origin_y + 16 * s.y);
  span_under_test here(bounds_.prof, map, s), there(bounds_.prof, moved, {0, 0});
  for (int k = 0; k < span_pixel_count; ++k) {
    const evaluated_pixel a(here, k), b(there, k);
    if (a.w <= 0 && b.w <= 0) continue;
    const bool same_side = a.w == b.w;
    const int64_t u = int64_t(a.at.u.raw()) - b.at.u.raw(), v = int64_t(a.at.v.raw()) - b.at.v.raw();
    note(stress_stage::moved, same_side ? double(std::max(std::abs(u), std::abs(v))) : 1e9, 0, s, k);
  }
}

// The contract of SPEC section 1, in 128-bit integers: a common power of two such that |Nu|, |Nv| < 2^59 and |W| < 2^45 by the sum of the
// magnitudes within the region and 16 pixels around it; scaling up is exact.
void stress_judge::judge_set_up(const exact_plane& exact, rectangle region, const plane& map, int32_t hx, int32_t hy) {
  const int32_t ox = region.x0 + region.x1, oy = region.y0 + region.y1, rx = region.x1 - region.x0 + 32, ry = region.y1 - region.y0 + 32;
  const auto bits = [&](const exact_form& f) { return bits_of(size_of(f.x) * rx + size_of(f.y) * ry + size_of(f.at(ox, oy))); };
  const int drop = std::max(std::max(bits(exact.u), bits(exact.v)) - 59, bits(exact.w) - 45);
  const auto judge = [&](const exact_form& f, const linear_form& rounded) {
    const int128 value = map.value(rounded, hx, hy);
    const int128 difference = drop > 0 ? (value << drop) - f.at(hx, hy) : value - (f.at(hx, hy) << -drop);
    const double half_units = double(2 * std::ldexp(static_cast<long double>(size_of(difference)), -std::max(drop, 0)));
    note(stress_stage::set_up, half_units, drop > 0 ? double(set_up_half_units(hx - ox, hy - oy)) : 0, {hx / 16, hy / 16}, 0);
  };
  judge(exact.u, map.u);
  judge(exact.v, map.v);
  judge(exact.w, map.w);
  if (map.dropped_bits <= 0) return;
  const auto judge_kept = [&](const exact_form& f, const wide_form& kept) {
    note(stress_stage::set_up, f.at(hx, hy) == int128_of(map.value(kept, hx, hy)) ? 0 : 1e30, 0, {hx / 16, hy / 16}, 0);
  };
  judge_kept(exact.u, map.exact_u);
  judge_kept(exact.v, map.exact_v);
  judge_kept(exact.w, map.exact_w);
}

}  // namespace spantex::sim
