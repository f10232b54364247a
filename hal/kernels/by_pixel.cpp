// SPDX-License-Identifier: Apache-2.0
#include "by_pixel.hpp"

#include <spantex/datapath.hpp>
#include <spantex/srgb.hpp>

namespace spantex::kernels {
namespace {

// A pixel is a function of plane, span, pixel and map, whatever local memory holds; and what else this takes for granted of the numbers it draws by.
constexpr bool is_drawn_by_pixel(const profile& p) {
  return p.overflow == overflow_policy::split && p.scope == level_scope::pixel && p.formula == level_formula::jacobian && p.level_bias == 0 && p.exact_set_up && p.linear_light &&
         p.colour_rounding != rounding::floor;
}
static_assert(is_drawn_by_pixel(profiles::standard) && is_drawn_by_pixel(profiles::exact));

// Four channels, two to a word, each in 32 bits of its own. four_point() and interpolated() take words for numbers: they are sums of products, and what they come to fits 32 bits.
struct channel_pairs { uint64_t rb, ga; };
constexpr uint64_t pair_of(uint32_t low, uint32_t high) { return low | uint64_t(high) << 32; }
constexpr uint32_t of_pair(uint64_t pair, bool high) { return uint32_t(high ? pair >> 32 : pair); }

// round_off(), halves up, of both, each by its own number of bits.
constexpr uint64_t rounded_pair(uint64_t x, int low_drop, int high_drop) {
  const auto half = [](int drop) { return drop > 0 ? 1u << (drop - 1) : 0u; };
  x += pair_of(half(low_drop), half(high_drop));
  if (low_drop != high_drop) return pair_of(of_pair(x, false) >> low_drop, of_pair(x, true) >> high_drop);
  return x >> low_drop & pair_of(~0u >> low_drop, ~0u >> low_drop);
}

// A map's colours by positions, of filters that kernels draw.
template <class Prof, bool LinearLight>
class map_colours {
 public:
  map_colours(const Prof& prof, const surface& s, const planar_map& texels)
      : prof_(prof), view_(*s.texture), map_(texels.levels_in_rows()), clamps_u_(texels.wrap_u() == wrap::clamp), clamps_v_(texels.wrap_v() == wrap::clamp) {}

  // Those of a level of detail and, where the filter has two, of the next coarser one.
  void take(int32_t level, filter kind) {
    kind_ = kind;
    const int whole = integer_level(kind, level, q().level_bits, view_.last_level());
    fraction_ = uses_two_levels(kind) && whole < view_.last_level() ? uint32_t(level - (whole << q().level_bits)) : 0;
    hold(fine_, whole);
    if (fraction_ != 0) hold(coarse_, whole + 1);
  }

  // Whether the last level is one colour, and which.
  bool end_in_one(rgba8& colour) {
    take(view_.last_level() << q().level_bits, filter::trilinear);
    return are_one(colour);
  }

  // Whether the colours taken are one, and which.
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
    int alpha_bits = bits;
    if (uses_two_levels(kind_)) {  // kept_of_level(), between_levels()
      const auto kept = [&](int most_bits) { return min_of(bits, min_of(q().blend_bits, most_bits - q().level_bits)); };
      const int drop = bits - kept(LinearLight ? max_linear_blend_bits : max_blend_bits), alpha_drop = bits - kept(max_blend_bits);
      c = {rounded_pair(c.rb, drop, drop), rounded_pair(c.ga, drop, alpha_drop)};
      if (fraction_ != 0) {
        const channel_pairs next = blended(coarse_, p);
        c = {interpolated<uint64_t>(c.rb, rounded_pair(next.rb, drop, drop), fraction_, q().level_bits),
             interpolated<uint64_t>(c.ga, rounded_pair(next.ga, drop, alpha_drop), fraction_, q().level_bits)};
      }
      const int gained = fraction_ != 0 ? q().level_bits : 0;
      alpha_bits = bits - alpha_drop + gained;
      bits += gained - drop;
    }
    with(0, partial_colour{of_pair(c.rb, false), bits});
    with(1, partial_colour{of_pair(c.ga, false), bits});
    with(2, partial_colour{of_pair(c.rb, true), bits});
    with(alpha_channel, partial_colour{of_pair(c.ga, true), alpha_bits});
  }

 private:
  const profile& q() const { return prof_.get(); }

  void hold(section& to, int level) const {
    const bool none = to.ratio_u == 0;
    if (none || to.level != level) to = detail::section_at(view_, level);
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

  // No pixel's level of detail (unbiased_level(), s.16) is below this: by the largest W, and bounds of rows' and of columns' lengths, of which the longer counts. A 64th is for cuts and log2.
  int32_t least_level() {
    constexpr int last = span_side - 1;
    int64_t w = 1;
    for (const int corner : {0, 1, 2, 3}) {
      const int64_t there = plane_.w_at(cx_ + half_pixels(corner & 1 ? last : 0), cy_ + half_pixels(corner & 2 ? last : 0));
      w = there > w ? there : w;
    }
    return max_of(shortest_log2(of_row(0), of_row(last), 0), shortest_log2(of_column(0), of_column(last), 1)) + (1 << 16) - 2 * log2_16(uint64_t(w)) - (1 << 10);
  }

 private:
  struct line {
    cut_gradients g{};
    bool is_known = false;
  };

  const cut_gradients& of_row(int j) { return known(rows_[j], 0, 0, j); }
  const cut_gradients& of_column(int i) { return known(columns_[i], 1, i, 0); }
  const cut_gradients& known(line& to, int by_y, int i, int j) const {
    if (!to.is_known) {
      const int32_t hx = cx_ + half_pixels(i), hy = cy_ + half_pixels(j);
      const int64_t w = plane_.w_at(hx, hy);
      cut_gradient(plane_, by_y, w, hx, hy, to.g);
      cut_gradient(plane_, 2 + by_y, w, hx, hy, to.g);
      to.is_known = true;
    }
    return to.g;
  }
  // Of lines between two, at least: what is linear between numbers of one sign is no smaller than the smaller of them.
  static int32_t shortest_log2(const cut_gradients& first, const cut_gradients& last, int by_y) {
    const int u = by_y, v = 2 + by_y;
    const scaled_gradients ends = on_one_scale({{first.value[u], last.value[u], first.value[v], last.value[v]}, {first.dropped[u], last.dropped[u], first.dropped[v], last.dropped[v]}});
    const auto least = [](int32_t a, int32_t b) { return (a ^ b) < 0 ? 0 : min_of(a < 0 ? -a : a, b < 0 ? -b : b); };
    return gradient_logs_of({least(ends.ux, ends.uy), 0, least(ends.vx, ends.vy), 0, ends.drop}).x;
  }

  const plane& plane_;
  int32_t cx_, cy_;
  line rows_[span_side], columns_[span_side];
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
    const bool samples = uses_footprint(s_.kind), levels = uses_levels(s_.kind) && !samples;
    span_coefficients c = detail::blank_coefficients(s_);
    reference r;
    const bool whole = p.w_at(cx, cy) > 0 && detail::coordinates_of_span(prof_, s_, cx, cy, r, c);
    if (!whole) c = detail::blank_coefficients(s_);
    else if (samples) span_axis(q, c);
    else if (levels) formula_levels(q, p, r, c);
    const auto to = [&](int k) -> rgba8& { return pixels[int64_t(k / span_side) * stride + sx * span_side + k % span_side]; };
    span_gradients gradients(p, cx, cy);
    rgba8 one;
    if (!whole && levels && colours_.end_in_one(one) && finer(gradients.least_level(), q.mip_bias) >= s_.texture->last_level() * (1 << 16)) {
      for (; mask != 0; mask &= mask - 1) to(__builtin_ctzll(mask)) = one;
      return;
    }
    pixel found[span_pixel_count];
    int count = 0;
    for (; mask != 0; mask &= mask - 1) {
      const int k = __builtin_ctzll(mask), i = k % span_side, j = k / span_side;
      const int32_t hx = cx + half_pixels(i), hy = cy + half_pixels(j);
      if (!whole && samples) pixel_axis(jacobian_of(gradients.at(i, j), p.w_at(hx, hy)), q, c);
      else if (!whole && levels) pixel_levels(gradient_logs_of(gradients.at(i, j)), p.w_at(hx, hy), c);
      pixel& next = found[count];
      next.k = k;
      if (samples) next.image = footprint_at(prof_, c, i, j);
      else next.image.level = levels ? level_at(prof_, c, i, j) : 0;
      colours_.take(next.image.level, s_.kind);
      if (colours_.are_one(to(k))) continue;
      if (!whole) detail::coordinates_of_pixel(prof_, s_, hx, hy, r, c);
      next.at = position_at(prof_, c, i, j);
      ++count;
    }
    for (int n = 0; n < count; ++n) {
      const pixel& x = found[n];
      colours_.take(x.image.level, s_.kind);
      to(x.k) = s_.kind == filter::nearest ? colours_.texel_at(x.at) : samples ? mean_of(x.image, x.at) : sample(x.at);
    }
  }

 private:
  struct pixel {
    int k;  // of the span
    texel_position at;
    footprint image;  // of filters of one sample the level alone
  };

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

// A profile with other samples.
template <profile P>
struct other_samples : fixed_profile<P> {
  profile numbers;
  const profile& get() const { return numbers; }
};

profile with_samples_of(profile p, const profile& numbers) {
  p.max_samples = numbers.max_samples;
  p.sample_spacing = numbers.sample_spacing;
  p.sample_slack = numbers.sample_slack;
  p.sample_bias = numbers.sample_bias;
  return p;
}

}  // namespace

bool draws_by_pixel(const profile& numbers) {
  return numbers == with_samples_of(profiles::standard, numbers) || numbers == with_samples_of(profiles::exact, numbers);
}

void draw_by_pixel(const surface& s, const planar_map& texels, const profile& numbers, int32_t sx, int32_t sy, span_mask mask, rgba8* pixels, int32_t stride) {
  const auto draw = [&](const auto& prof) {
    using prof_type = std::remove_cvref_t<decltype(prof)>;
    if (in_linear_light(texels, s.kind)) span_by_pixel<prof_type, true>(prof, s, texels).draw(sx, sy, mask, pixels, stride);
    else span_by_pixel<prof_type, false>(prof, s, texels).draw(sx, sy, mask, pixels, stride);
  };
  const auto draw_by = [&]<profile P>() {
    if (!uses_footprint(s.kind) || numbers == P) draw(fixed_profile<P>{});
    else draw(other_samples<P>{{}, numbers});
  };
  if (numbers == with_samples_of(profiles::exact, numbers)) draw_by.template operator()<profiles::exact>();
  else draw_by.template operator()<profiles::standard>();
}

void leave_to_pixels(const row_work& work) {
  for (int k = 0; k < work.count; ++k) work.left[k] = work.masks[k] != 0;
}

}  // namespace spantex::kernels
