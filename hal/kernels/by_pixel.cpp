// SPDX-License-Identifier: Apache-2.0
#include "by_pixel.hpp"

#include <spantex/datapath.hpp>
#include <spantex/srgb.hpp>

namespace spantex::kernels {
namespace {

// Four channels, two to a word, each in 32 bits of its own. four_point() and interpolated() take words for numbers: they are sums of products, and what they come to fits 32 bits.
struct channel_pairs { uint64_t rb, ga; };
constexpr uint64_t pair_of(uint32_t low, uint32_t high) { return low | uint64_t(high) << 32; }
constexpr uint32_t of_pair(uint64_t pair, bool high) { return uint32_t(high ? pair >> 32 : pair); }

// round_off(), halves up, of both.
constexpr uint64_t rounded_pair(uint64_t x, int drop) {
  if (drop <= 0) return x;
  const uint32_t half = 1u << (drop - 1), kept = ~0u >> drop;
  return (x + pair_of(half, half)) >> drop & pair_of(kept, kept);
}

// A map's colours by positions, of filters that kernels draw.
template <class Prof, bool LinearLight>
class map_colours {
 public:
  map_colours(const Prof& prof, const surface& s, const planar_map& texels)
      : prof_(prof), view_(*s.texture), map_(texels.levels_in_rows()), clamps_u_(texels.wrap_u() == wrap::clamp), clamps_v_(texels.wrap_v() == wrap::clamp) {}

  // Of a level of detail and, with TwoLevels, the next coarser one.
  void take(int32_t level, filter kind) {
    kind_ = kind;
    const int whole = integer_level(kind, level, q().level_bits, view_.last_level());
    fraction_ = uses_two_levels(kind) && whole < view_.last_level() ? uint32_t(level - (whole << q().level_bits)) : 0;
    hold(fine_, whole);
    if (fraction_ != 0) hold(coarse_, whole + 1);
  }

  // Whether all colours from that level of detail on (s.16) are one: then it is taken.
  bool are_one_from(int32_t level_16) {
    const int32_t last = view_.last_level();
    if (view_.width(last) > 1 || view_.height(last) > 1 || level_16 < last * (1 << 16)) return false;
    take(last << q().level_bits, filter::trilinear);
    return true;
  }

  // Whether all colours there are one, and which.
  bool are_one(rgba8& colour) const {
    if (view_.width(fine_.level) > 1 || view_.height(fine_.level) > 1 || fraction_ != 0) return false;
    colour = *map_.row(fine_.level, 0);
    return true;
  }

  rgba8 texel_at(const texel_position& p) const {
    const snapped_position at = snap(p, fine_, filter::nearest, q());
    return *place(0, at.u, at.v);
  }

  // Calls with(channel, partial_colour) for the four of a sample.
  void sample_at(const texel_position& p, auto&& with) const {
    channel_pairs c = blended(fine_, p);
    int bits = 2 * q().subtexel_bits;
    if (uses_two_levels(kind_)) {
      constexpr int most_bits = LinearLight ? max_linear_blend_bits : max_blend_bits;
      const int kept = min_of(bits, min_of(q().blend_bits, most_bits - q().level_bits)), drop = bits - kept;
      c = {rounded_pair(c.rb, drop), rounded_pair(c.ga, drop)};
      bits = kept;
      if (fraction_ != 0) {
        const channel_pairs next = blended(coarse_, p);
        c = {interpolated<uint64_t>(c.rb, rounded_pair(next.rb, drop), fraction_, q().level_bits), interpolated<uint64_t>(c.ga, rounded_pair(next.ga, drop), fraction_, q().level_bits)};
        bits += q().level_bits;
      }
    }
    for (int k = 0; k < channel_count; ++k) with(k, partial_colour{of_pair(k % 2 == 0 ? c.rb : c.ga, k > 1), bits});
  }

 private:
  const profile& q() const { return prof_.get(); }

  void hold(section& to, int level) const {
    if (to.level != level || to.ratio_u == 0) to = detail::section_at(view_, level);
  }

  // The upper left of four texels: what a level has around it spares wrapping the others.
  const rgba8* place(int level, int32_t u, int32_t v) const {
    const auto kept = [](int32_t x, int32_t length, bool clamps) { return clamps ? clamp_to(x, -1, length - 1) : wrapped(wrap::repeat, x, length); };
    return map_.row(level, kept(v, map_.rows(level), clamps_v_)) + kept(u, map_.columns(level), clamps_u_);
  }

  channel_pairs blended(const section& at, const texel_position& p) const {
    const snapped_position here = snap(p, at, kind_, q());
    const rgba8 *const top = place(at.level, here.u, here.v), *const bottom = top + map_.stride(at.level);
    const channel_pairs t[] = {pairs_of(top[0]), pairs_of(top[1]), pairs_of(bottom[0]), pairs_of(bottom[1])};
    const weights_of<uint64_t> w{here.fraction.u, here.fraction.v};
    return {four_point<uint64_t>({t[0].rb, t[1].rb, t[2].rb, t[3].rb}, w, q()).value, four_point<uint64_t>({t[0].ga, t[1].ga, t[2].ga, t[3].ga}, w, q()).value};
  }

  static channel_pairs pairs_of(rgba8 c) {
    if constexpr (LinearLight) return {pair_of(srgb_decoded(uint32_t(c.r)), srgb_decoded(uint32_t(c.b))), pair_of(srgb_decoded(uint32_t(c.g)), c.a)};
    return {pair_of(c.r, c.b), pair_of(c.g, c.a)};
  }

  const Prof& prof_;
  const texture_view& view_;
  const row_levels& map_;
  bool clamps_u_, clamps_v_;
  filter kind_ = filter::nearest;
  section fine_{}, coarse_{};
  uint32_t fraction_ = 0;
};

// W^2 J of a span's pixels: derivatives by x are alike in a row, those by y in a column.
class span_gradients {
 public:
  span_gradients(const plane& p, int32_t cx, int32_t cy) : plane_(p), cx_(cx), cy_(cy) {}

  scaled_gradients at(int i, int j) {
    const cut_gradients &row = of_row(j), &column = of_column(i);
    return on_one_scale({{row.value[0], column.value[1], row.value[2], column.value[3]}, {row.dropped[0], column.dropped[1], row.dropped[2], column.dropped[3]}});
  }

  // No pixel's level of detail (unbiased_level(), s.16) is below this: the largest W, and the shorter of rows' and columns' shortest, of which the longer counts. A 64th is for cuts and log2.
  int32_t least_level() {
    int32_t row = INT32_MAX, column = INT32_MAX;
    int64_t w = 1;
    for (int k = 0; k < span_side; ++k) {
      row = min_of(row, length_log2(of_row(k)));
      column = min_of(column, length_log2(of_column(k)));
    }
    for (const int corner : {0, 1, 2, 3}) {
      const int64_t there = plane_.w_at(cx_ + half_pixels(corner & 1 ? span_side - 1 : 0), cy_ + half_pixels(corner & 2 ? span_side - 1 : 0));
      w = there > w ? there : w;
    }
    return max_of(row, column) + (1 << 16) - 2 * log2_16(uint64_t(w)) - (1 << 10);
  }

 private:
  struct line {
    cut_gradients g{};
    bool known = false;
  };

  const cut_gradients& of_row(int j) { return found(rows_[j], 0, 0, j); }
  const cut_gradients& of_column(int i) { return found(columns_[i], 1, i, 0); }
  const cut_gradients& found(line& to, int by_y, int i, int j) const {
    if (!to.known) {
      const int32_t hx = cx_ + half_pixels(i), hy = cy_ + half_pixels(j);
      const int64_t w = plane_.w_at(hx, hy);
      cut_gradient(plane_, by_y, w, hx, hy, to.g);
      cut_gradient(plane_, 2 + by_y, w, hx, hy, to.g);
      to.known = true;
    }
    return to.g;
  }
  // What is not of the line is 0.
  static int32_t length_log2(const cut_gradients& g) {
    const gradient_logs logs = gradient_logs_of(on_one_scale(g));
    return max_of(logs.x, logs.y);
  }

  const plane& plane_;
  int32_t cx_, cy_;
  line rows_[span_side], columns_[span_side];
};

// coordinates_of_pixel() and position_at() of the pixels of a row, each about its own centre.
template <class Prof>
class lone_positions {
 public:
  lone_positions(const plane& p, int32_t hx, int32_t hy) : plane_(p), w_(p.w_at(hx, hy)), u_(p.u_at(hx, hy)), v_(p.v_at(hx, hy)) {
    if (plane_.rounding_bits != 0) exact_ = {p.value(p.exact_u, hx, hy), p.value(p.exact_v, hx, hy), p.value(p.exact_w, hx, hy)};
  }

  void next() {
    w_ += 2 * plane_.w.x;
    u_ += 2 * plane_.u.x;
    v_ += 2 * plane_.v.x;
    if (plane_.rounding_bits != 0) exact_ = {exact_.u + (plane_.exact_u.x + plane_.exact_u.x), exact_.v + (plane_.exact_v.x + plane_.exact_v.x), exact_.w + (plane_.exact_w.x + plane_.exact_w.x)};
  }

  int64_t w() const { return w_; }  // 2 W

  texel_position at() const {
    const inverse over_w = invert(w_);
    axis u = about(u_, w_, over_w), v = about(v_, w_, over_w);
    if (!rounding_is_small(plane_, w_, bit_length(uint64_t(max_of(size_of(u.base), size_of(v.base)) + 2)))) return exactly();
    u.rest = u_ - u.base * w_;
    v.rest = v_ - v.base * w_;
    return {coordinate_of(u, over_w), coordinate_of(v, over_w)};
  }

 private:
  struct axis {
    int32_t base;
    bool in_range;
    int64_t rest;
  };
  struct exact_values { wide u, v, w; };

  static int32_t size_of(int32_t x) { return x < 0 ? -x : x; }
  static axis about(int64_t n, int64_t w, inverse over_w) {
    axis a{0, true, 0};
    a.base = detail::whole_quotient(n, w, over_w, a.in_range);
    return a;
  }

  // scale_down() of numbers whose result fits.
  static int64_t rounded(const wide& x, int drop) {
    const wide m = magnitude(x);
    const auto size = int64_t(drop == 0 ? m.low : (low_after(m, drop - 1) + 1) >> 1);
    return x.negative() ? -size : size;
  }

  // exact_reference_at()
  texel_position exactly() const {
    const bool in_front = !exact_.w.negative() && !exact_.w.zero();  // otherwise by the rounded W alone
    const int cut = in_front ? max_of(0, bit_length(exact_.w) - detail::exact_w_bits) : 0;
    const int64_t w = in_front ? rounded(exact_.w, cut) : w_;
    const inverse over_w = invert(w);
    const auto coordinate_by = [&](const wide& n, int64_t rounded_n) {
      axis a{};
      if (!in_front) {
        a = about(rounded_n, w, over_w);
        a.rest = rounded_n - a.base * w;
      } else if (bit_length(n) - cut > 62) {
        a = {n.negative() ? -32767 : 32767, false, 0};
      } else {
        a = about(rounded(n, cut), w, over_w);
        a.rest = rounded(n - multiply(exact_.w, a.base), cut);
      }
      return coordinate_of(a, over_w);
    };
    return {coordinate_by(exact_.u, u_), coordinate_by(exact_.v, v_)};
  }

  // pixel_coordinates(), coordinate_at()
  static coordinate coordinate_of(const axis& a, inverse over_w) {
    constexpr const profile& q = Prof::value;
    constexpr int exponent = min_of(q.offset_bits - 2, max_exponent);
    const int32_t offset = a.in_range ? quotient(a.rest, max_of(0, bit_length(magnitude(a.rest)) - 31), over_w, exponent) : 0;
    return sat_to<coordinate>(s<31, 16>::from_raw(int64_t(a.base) * (1 << 16) + int64_t(scale_down(offset, exponent - q.coordinate_bits)) * (1 << (16 - q.coordinate_bits))));
  }

  const plane& plane_;
  int64_t w_, u_, v_;
  exact_values exact_{};
};

template <class Prof, bool LinearLight>
class span_by_pixel {
 public:
  span_by_pixel(const Prof& prof, const surface& s, const planar_map& texels) : prof_(prof), s_(s), colours_(prof, s, texels) {}

  // plan_about(), without jobs. All pixels are found before the first texel is read, so that reading does not wait for what is found.
  void draw(int32_t sx, int32_t sy, span_mask mask, rgba8* pixels, int32_t stride) {
    const profile& q = prof_.get();
    const int32_t cx = 2 * span_side * sx + span_side, cy = 2 * span_side * sy + span_side;
    const plane& p = *s_.map;
    span_coefficients c = detail::blank_coefficients(s_);
    reference r;
    const bool whole = p.w_at(cx, cy) > 0 && detail::coordinates_of_span(prof_, s_, cx, cy, r, c);
    if (!whole) c = detail::blank_coefficients(s_);
    else if (uses_footprint(s_.kind)) span_axis(q, c);
    else if (uses_levels(s_.kind)) formula_levels(q, p, r, c);
    const auto to = [&](int k) -> rgba8& { return pixels[int64_t(k / span_side) * stride + sx * span_side + k % span_side]; };
    span_gradients gradients(p, cx, cy);
    if (!whole && uses_levels(s_.kind) && !uses_footprint(s_.kind) && colours_.are_one_from(finer(gradients.least_level(), q.mip_bias))) {
      for (; mask != 0; mask &= mask - 1) (void)colours_.are_one(to(__builtin_ctzll(mask)));
      return;
    }
    found pixel[span_pixel_count];
    int count = 0;
    for (int j = 0; j < span_side; ++j) {
      auto of_row = uint32_t(mask >> (span_side * j) & 0xFF);
      lone_positions<Prof> lone(p, cx + half_pixels(0), cy + half_pixels(j));
      for (int i = 0; of_row != 0; ++i, of_row >>= 1, lone.next()) {
        if ((of_row & 1) == 0) continue;
        if (!whole && uses_levels(s_.kind)) {
          if (uses_footprint(s_.kind)) pixel_axis(jacobian_of(gradients.at(i, j), lone.w()), q, c);
          else c.level_row[j] = c.level_column[i] = level_term(gradient_logs_of(gradients.at(i, j)), lone.w());
        }
        found& one = pixel[count];
        one.k = span_side * j + i;
        if (uses_footprint(s_.kind)) one.image = footprint_at(prof_, c, i, j);
        else one.image.level = uses_levels(s_.kind) ? level_at(prof_, c, i, j) : 0;
        colours_.take(one.image.level, s_.kind);
        if (colours_.are_one(to(one.k))) continue;
        one.at = whole ? position_at(prof_, c, i, j) : lone.at();
        ++count;
      }
    }
    for (int n = 0; n < count; ++n) {
      const found& one = pixel[n];
      colours_.take(one.image.level, s_.kind);
      to(one.k) = s_.kind == filter::nearest ? colours_.texel_at(one.at) : uses_footprint(s_.kind) ? mean_of(one.image, one.at) : sample(one.at);
    }
  }

 private:
  struct found {
    int k;  // pixel of the span
    texel_position at;
    footprint image;  // of filters of one sample the level alone
  };

  // pixel_levels(): of the longer of both.
  static int16_t level_term(const gradient_logs& g, int64_t w) { return detail::level_term(max_of(g.x, g.y) + (1 << 16) - 2 * log2_16(uint64_t(w))); }

  rgba8 sample(const texel_position& at) const {
    uint8_t out[channel_count];
    colours_.sample_at(at, [&](int k, partial_colour x) { out[k] = LinearLight && k != alpha_channel ? written_linear(x, prof_.get()) : written(x, prof_.get()); });
    return {out[0], out[1], out[2], out[3]};
  }

  // compute_footprint()
  rgba8 mean_of(const footprint& f, const texel_position& centre) const {
    const profile& q = prof_.get();
    footprint_sums sums{};
    for (int n = 0; n < f.samples; ++n) {
      partial_colour one{};
      colours_.sample_at(sample_position(centre, f, n), [&](int k, partial_colour x) {
        one = LinearLight ? detail::linear_sum(x, q) : summable(x, q);
        sums.channel[k] += one.value;
      });
      sums.weight += 1u << one.bits;
    }
    return LinearLight ? mean_linear_colour(sums, q.colour_rounding) : mean_colour(sums, q.colour_rounding);
  }

  const Prof& prof_;
  const surface& s_;
  map_colours<Prof, LinearLight> colours_;
};

// Profile default with other samples.
struct other_samples : fixed_profile<profiles::standard> {
  profile numbers = profiles::standard;
  const profile& get() const { return numbers; }
};

}  // namespace

void draw_by_pixel(const surface& s, const planar_map& texels, int max_samples, int32_t sx, int32_t sy, span_mask mask, rgba8* pixels, int32_t stride) {
  const auto draw = [&](const auto& prof) {
    using prof_type = std::remove_cvref_t<decltype(prof)>;
    if (in_linear_light(texels, s.kind)) span_by_pixel<prof_type, true>(prof, s, texels).draw(sx, sy, mask, pixels, stride);
    else span_by_pixel<prof_type, false>(prof, s, texels).draw(sx, sy, mask, pixels, stride);
  };
  if (!uses_footprint(s.kind) || max_samples == profiles::standard.max_samples) return draw(fixed_profile<profiles::standard>{});
  other_samples few;
  few.numbers.max_samples = max_samples;
  draw(few);
}

}  // namespace spantex::kernels
