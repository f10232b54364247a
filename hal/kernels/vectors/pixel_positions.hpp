// SPDX-License-Identifier: Apache-2.0
// Vector kernels: spans next to the horizon, whose pixels have positions about their own centres: plan.hpp's coordinates_of_pixel() for as many pixels of a row as there are 64-bit lanes.
// Included by the machines' files alone.
#pragma once

#define SPANTEX_PIXEL_POSITIONS 1

// 128 bits a lane, two's complement: spantex/wide.hpp.
struct v_wide { v_64 low, high; };

SPANTEX_INLINE v_s64 signs(const v_wide& x) { return signs(v_s64(x.high)); }
SPANTEX_INLINE v_wide all(const spantex::wide& x) { return {v_64{} + x.low, v_64{} + uint64_t(x.high)}; }
SPANTEX_INLINE v_wide sum(const v_wide& a, const v_wide& b) {
  const v_64 low = a.low + b.low, carry = ((a.low & b.low) | ((a.low | b.low) & ~low)) >> 63;
  return {low, a.high + b.high + carry};
}
SPANTEX_INLINE v_wide negated_where(const v_wide& x, v_s64 negative) {
  const v_64 flip = v_64(negative), low = (x.low ^ flip) - flip;
  return {low, (x.high ^ flip) - (v_64(low == 0) & flip)};
}

// x times bases, of less than 2^32, modulo 2^128.
SPANTEX_INLINE v_wide times_bases(const v_wide& x, v_s64 base) {
  const v_64 size = v_64(size_of(base)), first = wide_products(x.low, size), second = wide_products(x.low >> 32, size) + (first >> 32);
  const v_64 high = wide_products(x.high, size) + (wide_products(x.high >> 32, size) << 32) + (second >> 32);
  return negated_where(v_wide{(first & 0xFFFFFFFF) | second << 32, high}, signs(base));
}

// Of numbers that are not negative.
SPANTEX_INLINE v_s64 bit_lengths(const v_wide& x) {
  const v_s64 of_high = bit_lengths(v_s64(x.high));
  return of_high != 0 ? of_high + 64 : bit_lengths(v_s64(x.low));
}
// The same, scale_down(): x / 2^drop to nearest, halves up, what of it fits 63 bits; drop is 0 or more.
SPANTEX_INLINE v_s64 scaled_down(const v_wide& x, v_s64 drop) {
  const v_64 twice = low_after(x.low << 1, x.high << 1 | x.low >> 63, v_64(drop));
  return v_s64((twice >> 1) + (twice & 1));
}

// Positions of pixels about their own centres, from the map's first texel: `width` pixels at a time, half of them a register of each number. Both halves are taken through a step before
// the next one: it is a long chain of dependent operations, and two of them take little longer than one.
template <bool MasksOnly>
class pixel_positions {
 public:
  SPANTEX_INLINE explicit pixel_positions(const row_work& work)
      : plane_(*work.map), cx_(2 * span_side * work.sx + span_side), cy_(2 * span_side * work.sy + span_side), slope_(int64_t(uint64_t(reach) * (magnitude(plane_.w.x) + magnitude(plane_.w.y)))),
        exact_(plane_.rounding_bits != 0), w_by_rows_(plane_.w.x == 0 && plane_.exact_w.x.zero()), u_(plane_.u, plane_.exact_u, exact_), v_(plane_.v, plane_.exact_v, exact_), w_(plane_.w, plane_.exact_w, exact_) {
    if constexpr (!MasksOnly) {
      const row_levels& map = work.texels->levels_in_rows();
      wrap_u_ = wrapping(work.texels->wrap_u() == wrap::clamp, map.modulo_u());
      wrap_v_ = wrapping(work.texels->wrap_v() == wrap::clamp, map.modulo_v());
    }
    if (w_by_rows_) each_group(0, [&](const values& first, int, int at) SPANTEX_INLINED { find_divisors(first, of_groups_[at / width]); });
  }

  // Whether the row's span k is one whose pixels are taken about their own centres, by the plane's rounded forms: what they tell otherwise is left.
  SPANTEX_INLINE bool are_wanted(int k) const {
    const int32_t cx = cx_ + 2 * span_side * k;
    const int64_t w = plane_.w_at(cx, cy_);
    if (w <= 0 || slope_ >= (w >> 1) - (w >> 8)) return true;  // coordinates_within(), at once
    reference r;
    set_reference(plane_, cx, cy_, r);
    span_coefficients c;
    return !span_coordinates(r, q, c);
  }

  // Those of span k, of groups of `width` with pixels in the mask.
  SPANTEX_INLINE void find(int k, span_mask mask, span_positions& out) const {
    each_group(k, [&](const values& first, int pixel, int at) SPANTEX_INLINED {
      const auto wanted = uint32_t(mask >> pixel) & ((1u << width) - 1);
      if (wanted == 0) return;
      if (w_by_rows_) return find_group(first, of_groups_[at / width], wanted, out.u + at, out.v + at);
      divisors by;
      find_divisors(first, by);
      find_group(first, by, wanted, out.u + at, out.v + at);
    });
  }

 private:
  static constexpr int halves_of_group = 2;
  typedef int32_t v_half __attribute__((vector_size(2 * width)));

  // What a group's pixels add to a form's value at the first one, and what the group below does.
  struct stepped {
    v_s64 step[halves_of_group];
    v_wide exact_step[halves_of_group];
    spantex::wide exact_down;

    SPANTEX_INLINE stepped(const linear_form& f, const wide_form& e, bool exact) {
      if (exact) exact_down = multiply(e.y, 2 * rows_at_once);
      for (int k = 0; k < width; ++k) {
        const int half = k / wide_lanes, lane = k % wide_lanes, hx = 2 * (k % lanes_across), hy = 2 * (k / lanes_across);
        step[half][lane] = hx * f.x + hy * f.y;
        if (!exact) continue;
        const spantex::wide more = multiply(e.x, hx) + multiply(e.y, hy);
        exact_step[half].low[lane] = more.low;
        exact_step[half].high[lane] = uint64_t(more.high);
      }
    }
  };

  // A group's first pixel, by the forms. From one group to the next below by sums, which take less than products.
  struct values {
    int64_t u, v, w;
    spantex::wide exact_u, exact_v, exact_w;
    SPANTEX_INLINE values(const pixel_positions& of, int32_t hx, int32_t hy) : u(of.plane_.u_at(hx, hy)), v(of.plane_.v_at(hx, hy)), w(of.plane_.w_at(hx, hy)) {
      if (!of.exact_) return;
      exact_u = of.plane_.value(of.plane_.exact_u, hx, hy);
      exact_v = of.plane_.value(of.plane_.exact_v, hx, hy);
      exact_w = of.plane_.value(of.plane_.exact_w, hx, hy);
    }
    SPANTEX_INLINE void step(const pixel_positions& of) {
      u += 2 * rows_at_once * of.plane_.u.y;
      v += 2 * rows_at_once * of.plane_.v.y;
      w += 2 * rows_at_once * of.plane_.w.y;
      if (!of.exact_) return;
      exact_u = exact_u + of.u_.exact_down;
      exact_v = exact_v + of.v_.exact_down;
      exact_w = exact_w + of.w_.exact_down;
    }
  };

  // Calls with(first, pixel, at) for each group of span k: the first one of its pixels by the forms, in the span, and in span_positions.
  SPANTEX_INLINE void each_group(int k, auto&& with) const {
    for (int part = 0; part < parts; ++part) {
      const int x = lanes_across * part;
      values first(*this, cx_ + 2 * span_side * k + half_pixels(x), cy_ + half_pixels(0));
      for (int y = 0; y < span_side; y += rows_at_once, first.step(*this)) with(first, span_side * y + x, place_of(y, part));
    }
  }

  // What becomes of positions along an axis of a map that is more than masks.
  struct wrapping {
    int64_t least = least_position;
    int32_t period = 0;  // 0: masks are all it takes, or the axis is clamped
    uint32_t inverse_period = 0, before = 0;

    wrapping() = default;
    SPANTEX_INLINE wrapping(bool clamps, int32_t length) : period(length) {
      if (clamps) least += int64_t(1) << q.coordinate_bits;  // so that the texel half a texel further has a 16-bit number too
      if (length == 0) return;
      inverse_period = uint32_t(((uint64_t(1) << 32) + uint32_t(length) - 1) / uint32_t(length));
      before = uint32_t((32768 + length - 1) / length * length);
    }
  };
  static constexpr int64_t least_position = -(int64_t(1) << (15 + q.coordinate_bits)), most_position = -least_position - 1;  // coordinate

  struct divisor { v_s64 bits; v_64 y; };
  struct numerator {
    v_s64 base, c, in;
    SPANTEX_INLINE void take_where(v_s64 mask, const numerator& other) {
      base = mask != 0 ? other.base : base;
      c = mask != 0 ? other.c : c;
      in = mask != 0 ? other.in : in;
    }
  };
  struct pixels {
    divisor by;
    numerator u, v;
    SPANTEX_INLINE void take_where(v_s64 mask, const pixels& other) {
      by.bits = mask != 0 ? other.by.bits : by.bits;
      by.y = mask != 0 ? other.by.y : by.y;
      u.take_where(mask, other.u);
      v.take_where(mask, other.v);
    }
  };

  // What W says of a group's pixels, by the rounded forms and by the exact ones.
  struct divisors {
    v_s64 w[halves_of_group];
    divisor by[halves_of_group];
    v_wide exact_w[halves_of_group];
    v_s64 in_front[halves_of_group], cut[halves_of_group];
    divisor exactly[halves_of_group];
  };

  SPANTEX_INLINE static void each_half(auto&& step) {
#pragma GCC unroll 2
    for (int k = 0; k < halves_of_group; ++k) step(k);
  }

  SPANTEX_INLINE static void invert(v_s64 w, divisor& by) {
    by.bits = bit_lengths(w);
    by.y = inverses(w, by.bits);
  }
  SPANTEX_INLINE void find_divisors(const values& first, divisors& d) const {
    each_half([&](int k) SPANTEX_INLINED {
      d.w[k] = first.w + w_.step[k];
      invert(d.w[k], d.by[k]);
      if (!exact_) return;
      d.exact_w[k] = sum(all(first.exact_w), w_.exact_step[k]);
      d.in_front[k] = ~signs(d.exact_w[k]) & ((d.exact_w[k].low | d.exact_w[k].high) != 0);
      d.cut[k] = largest(bit_lengths(d.exact_w[k]) - detail::exact_w_bits, all(0));
      invert(scaled_down(d.exact_w[k], d.cut[k]), d.exactly[k]);
    });
  }

  // whole_quotient() of a number of so many bits; or of one more, where rounding carried into it: the quotient is the same.
  SPANTEX_INLINE static void find_base(v_s64 n, v_s64 bits, v_s64 negative, v_s64 in, const divisor& by, numerator& out) {
    const v_s64 base = whole_quotients(n, bits, by.bits, by.y, in);
    out.in = in & (size_of(base) <= 32768);
    out.base = out.in != 0 ? base : negated_where(all(32767), negative);
  }
  // exact_axis_at()
  SPANTEX_INLINE static void find_exact_base(const v_wide& n, v_s64 cut, const divisor& by, numerator& out) {
    const v_s64 negative = signs(n);
    const v_wide size = negated_where(n, negative);
    const v_s64 bits = bit_lengths(size) - cut;
    find_base(negated_where(scaled_down(size, cut), negative), bits, negative, bits <= 62, by, out);
  }
  SPANTEX_INLINE static void find_exact_rest(const v_wide& n, const v_wide& w, v_s64 cut, numerator& out) {
    const v_wide c = sum(n, times_bases(w, -out.base));
    const v_s64 negative = signs(c);
    out.c = negated_where(scaled_down(negated_where(c, negative), cut), negative);
  }

  // pixel_coordinates(), position_at()
  SPANTEX_INLINE v_half position(const numerator& n, const divisor& by, const wrapping& a) const {
    constexpr int exponent = min_of(q.offset_bits - 2, max_exponent), below = exponent - q.coordinate_bits;
    constexpr int64_t lift = int64_t(1) << 32;  // shifts of lanes with a sign take several operations
    const v_s64 drop = largest(bit_lengths(size_of(n.c)) - 31, all(0)), mantissa = n.in & quotients(n.c, drop, by.y, by.bits - 32 + 63 - drop - exponent);
    const v_s64 offset = v_s64(v_64(mantissa + ((1 << (below - 1)) + (lift << below))) >> below) - lift;
    v_s64 at = least(largest((n.base << q.coordinate_bits) + offset, all(MasksOnly ? least_position : a.least)), all(most_position));
    if constexpr (!MasksOnly) {
      if (a.period != 0) {
        const v_64 from = v_64(at + (int64_t(a.before) << q.coordinate_bits)), periods = wide_products(from >> q.coordinate_bits, v_64{} + a.inverse_period) >> 32;
        at = v_s64(from - (wide_products(periods, v_64{} + uint64_t(a.period)) << q.coordinate_bits));
      }
    }
    return __builtin_convertvector(at, v_half);
  }

  // By the rounded forms or, where that shows, by the exact ones: coordinates_of_pixel().
  SPANTEX_INLINE void find_group(const values& first, const divisors& d, uint32_t wanted, int32_t* to_u, int32_t* to_v) const {
    v_s64 nu[halves_of_group], nv[halves_of_group];
    each_half([&](int k) SPANTEX_INLINED {
      nu[k] = first.u + u_.step[k];
      nv[k] = first.v + v_.step[k];
    });
    pixels p[halves_of_group];
    const auto by_rounded = [&](pixels (&out)[halves_of_group]) SPANTEX_INLINED {
      each_half([&](int k) SPANTEX_INLINED {
        out[k].by = d.by[k];
        const auto find = [&](v_s64 n, numerator& x) SPANTEX_INLINED {
          find_base(n, bit_lengths(size_of(n)), signs(n), all(-1), d.by[k], x);
          x.c = n - times_bases(d.w[k], x.base);
        };
        find(nu[k], out[k].u);
        find(nv[k], out[k].v);
      });
    };
    if (!exact_) {
      by_rounded(p);
    } else {
      // By bit_length(larger base + 2), as reach_bits() has it; `bits`, which takes no division, is no larger than it, and bits + 2 or 3 no smaller.
      const auto rounding_shows = [&](int k, v_s64 bits) SPANTEX_INLINED { return d.in_front[k] & (bits + (plane_.rounding_bits + set_up_tolerance_bits) >= d.by[k].bits); };
      uint32_t some = 0, every = 0;
      each_half([&](int k) SPANTEX_INLINED {
        const v_s64 bits = least(bit_lengths(largest(size_of(nu[k]), size_of(nv[k]))) - d.by[k].bits, all(16));
        some |= signs_of(rounding_shows(k, largest(bits + 2, all(3)))) << (wide_lanes * k);
        every |= signs_of(rounding_shows(k, bits)) << (wide_lanes * k);
      });
      if ((some & wanted) == 0) {
        by_rounded(p);
      } else {
        by_exact(first, d, p);
        if ((every & wanted) != wanted) {
          pixels near[halves_of_group];
          by_rounded(near);
          each_half([&](int k) SPANTEX_INLINED { p[k].take_where(~rounding_shows(k, bit_lengths(largest(size_of(near[k].u.base), size_of(near[k].v.base)) + 2)), near[k]); });
        }
      }
    }
    v_half u[halves_of_group], v_of[halves_of_group];
    each_half([&](int k) SPANTEX_INLINED {
      u[k] = position(p[k].u, p[k].by, wrap_u_);
      v_of[k] = position(p[k].v, p[k].by, wrap_v_);
    });
    __builtin_memcpy(to_u, u, sizeof u);
    __builtin_memcpy(to_v, v_of, sizeof v_of);
  }

  // exact_reference_at()
  SPANTEX_INLINE void by_exact(const values& first, const divisors& d, pixels (&out)[halves_of_group]) const {
    v_wide nu[halves_of_group], nv[halves_of_group];
    each_half([&](int k) SPANTEX_INLINED {
      nu[k] = sum(all(first.exact_u), u_.exact_step[k]);
      nv[k] = sum(all(first.exact_v), v_.exact_step[k]);
      out[k].by = d.exactly[k];
      find_exact_base(nu[k], d.cut[k], d.exactly[k], out[k].u);
      find_exact_base(nv[k], d.cut[k], d.exactly[k], out[k].v);
    });
    each_half([&](int k) SPANTEX_INLINED {
      find_exact_rest(nu[k], d.exact_w[k], d.cut[k], out[k].u);
      find_exact_rest(nv[k], d.exact_w[k], d.cut[k], out[k].v);
    });
  }

  const plane& plane_;
  const int32_t cx_, cy_;  // the first span's centre
  const int64_t slope_;
  const bool exact_, w_by_rows_;  // whether rounding may show; whether W is the same along a row
  stepped u_, v_, w_;
  wrapping wrap_u_, wrap_v_;
  divisors of_groups_[groups];  // where W is
};
