// SPDX-License-Identifier: Apache-2.0
// Vector kernels: texture positions and levels of detail of a span's 64 pixels. Included by the machines' files alone.
#pragma once

// Of 64 pixels, as place_of() has them: positions from the span's base in texels of level 0, s15.14, and the base, likewise; levels of detail in 2^-8.
struct alignas(64) span_positions {
  int32_t u[span_pixel_count], v[span_pixel_count];  // with `rest` bits more, where they were not to be rounded
  int rest;
  level_number level[span_pixel_count];
  int32_t base_u, base_v, origin_u, origin_v;  // origin: the base before it was taken modulo a map's period
  bool far;                                    // texels lie farther from the base than row_levels::near_limit()
  bool within;                                 // no texel lies beyond the map: is_within(); of maps that are more than masks
};

// q of the series from the slope, lanes as slope_lanes() makes them.
template <int Terms>
SPANTEX_INLINE v series_of(v e, int slope_log2) {
  v r = e;
  for (int k = 1; k < Terms; ++k) r = e - slope_product(e, r, slope_log2);
  return r;
}

// To 2^-8, then finer() with a bias of -8: its limits are whole numbers of those; clamped.
SPANTEX_INLINE v detail_of(v level_16, int32_t most) {
  const v level = rounded_shift(level_16, 8);
  return least(largest(largest(least(level, number<80>()), level - number<128>()), set(0)), set(most));
}

// Of two vectors of rows, one below the other.
template <class Number>
SPANTEX_INLINE void put_details(Number* to, v upper, v lower, int32_t most) {
  put(to, detail_of(upper, most));
  put(to + width, detail_of(lower, most));
}

// A number a row.
struct row_numbers {
  alignas(sizeof(v)) int32_t row[max_of(width, span_side)];
  SPANTEX_INLINE v from(int y) const {  // of the rows from y on that the lanes are
    v x = set(row[y]);
    for (int k = lanes_across; k < width; ++k) x[k] = row[y + 1];
    return x;
  }
};

// s5.10 of the coefficients, s.16, by rows.
struct row_levels16 : row_numbers {
  SPANTEX_INLINE void read(const span_coefficients& c) {
    for (int part = 0; part < parts; ++part) put(row + width * part, levels16(c.level_row + width * part));
  }
};

// 2 log2 w where |w - 1| < 2^-4.
SPANTEX_INLINE v twice_log2_of_slope(v e, int slope_log2) { return level_of_slope(e - half_slope_square(e, slope_log2), slope_log2); }

// c + a hx + b hy, row by row.
struct form {
  v at, down;
  SPANTEX_INLINE form(int32_t c, int32_t a, int32_t b, int part) : at(half_pixels_across() * a + (c + 2 * width * part * a - reach * b)), down(set(2 * rows_at_once * b)) {
    if constexpr (rows_at_once > 1) at += half_pixels_down() * b;
  }
  SPANTEX_INLINE void next() { at += down; }
};

// Positions of a span's rows of pixels, not rounded, by a series of so many terms; none, slopes alone, where they are fewer than 0.
constexpr int levels_alone = -1;
template <int Terms>
class series_rows {
 public:
  SPANTEX_INLINE series_rows(const span_coefficients& c, int part)
      : nu_(c.c_u, c.a_u, c.b_u, part), nv_(c.c_v, c.a_v, c.b_v, part), twice_e_(0, 2 * c.g, 2 * c.h, part), slope_log2_(c.slope_log2) {}

  // take(u, v): positions with c.exponent bits of fraction; the slope.
  SPANTEX_INLINE v next(auto&& take) {
    const v e = slope_lanes(twice_e_.at, slope_log2_);
    twice_e_.next();
    if constexpr (Terms != levels_alone) {
      v u = nu_.at, w = nv_.at;
      if constexpr (Terms > 0) {
        const v r = series_of<Terms>(e, slope_log2_);
        u -= product_with_slope(u, r, slope_log2_);
        w -= product_with_slope(w, r, slope_log2_);
      }
      take(u, w);
      nu_.next();
      nv_.next();
    }
    return e;
  }

 private:
  form nu_, nv_, twice_e_;
  int slope_log2_;
};

template <int Terms, bool Levels, bool Rounded>
SPANTEX_INLINE void find_positions(const span_coefficients& c, span_positions& out) {
  const int s = c.slope_log2, cut = c.exponent - q.coordinate_bits;
  out.rest = Rounded ? 0 : cut;
  const int32_t most = int32_t(c.last_level) << q.level_bits;
  row_levels16 levels;
  if constexpr (Levels) levels.read(c);
  for (int part = 0; part < parts; ++part) {
    series_rows<Terms> rows(c, part);
    const v column = Levels ? levels16(c.level_column + width * part) : set(0);
    const auto row = [&](int y) SPANTEX_INLINED {
      const v e = rows.next([&](v u, v w) SPANTEX_INLINED {
        const int at = place_of(y, part);
        put(out.u + at, Rounded ? rounded_shift(u, cut) : u);
        put(out.v + at, Rounded ? rounded_shift(w, cut) : w);
      });
      if constexpr (Levels) return largest(column, levels.from(y)) - twice_log2_of_slope(e, s);
    };
    if constexpr (Levels) {
#pragma GCC unroll row_pairs_at_once
      for (int y = 0; y < span_side; y += 2 * rows_at_once) {
        const v upper = row(y), lower = row(y + rows_at_once);
        put_details(out.level + place_of(y, part), upper, lower, most);
      }
    } else {  // with no more numbers to wait for, more rows at once only leave too few registers
#pragma GCC unroll 4
      for (int y = 0; y < span_side; y += rows_at_once) row(y);
    }
  }
}

// --- the divide ----------------------------------------------------------------------------------------

// reciprocal_of_w(w, 30), w in (1/2, 3/2).
SPANTEX_INLINE v reciprocals_of(v w) {
  const v below_one = v(w < number<1 << 30>());
  const v_32 twice = v_32(w) << 1, m = twice + (twice & v_32(below_one));
  const v_32 r = v_32(reciprocal_wide(v(m), look_up(wide_seeds.seed, v((m >> 24) & 127))));
  return v(below_one < 0 ? rounded_shift(r, 1) : rounded_shift(r, 2));
}

// n / w, rounded to coordinate_bits; shift is 32 or more.
SPANTEX_INLINE v divided(v n, v reciprocal, int shift) { return narrowed(signed_products(n, reciprocal), shift); }
static_assert(q.offset_bits - 1 - max_extent_log2 - q.coordinate_bits + q.reciprocal_bits >= 32);

[[gnu::noinline]] void divide_positions(const span_coefficients& c, span_positions& out) {
  out.rest = 0;
  const int shift = c.exponent - q.coordinate_bits + q.reciprocal_bits;
  const bool w_by_rows = c.g == 0;
  row_numbers of_rows;
  if (w_by_rows)
    for (int part = 0; part < parts; ++part) put(of_rows.row + width * part, reciprocals_of((1 << q.reciprocal_bits) + half_pixels_of(width * part) * c.h));
  for (int part = 0; part < parts; ++part) {
    form nu(c.c_u, c.a_u, c.b_u, part), nv(c.c_v, c.a_v, c.b_v, part), nw(1 << q.reciprocal_bits, c.g, c.h, part);
    for (int y = 0; y < span_side; y += rows_at_once) {
      const v r = w_by_rows ? of_rows.from(y) : reciprocals_of(nw.at);
      const int at = place_of(y, part);
      put(out.u + at, divided(nu.at, r, shift));
      put(out.v + at, divided(nv.at, r, shift));
      nu.next();
      nv.next();
      nw.next();
    }
  }
}

// level_at() where it takes a table.
[[gnu::noinline]] void steep_levels(const span_coefficients& c, span_positions& out) {
  const int32_t most = int32_t(c.last_level) << q.level_bits;
  row_levels16 levels;
  levels.read(c);
  for (int part = 0; part < parts; ++part) {
    form nw(1 << q.reciprocal_bits, c.g, c.h, part);
    const v column = levels16(c.level_column + width * part);
#pragma GCC unroll 8
    for (int y = 0; y < span_side; y += rows_at_once, nw.next())
      put(out.level + place_of(y, part), detail_of(largest(column, levels.from(y)) - (log2_of_w(nw.at) << 1), most));
  }
}

// Where slopes are zero, rows are of one length, and columns: the pixels have one level.
template <bool Rounded>
[[gnu::noinline]] void find_facing_positions(const span_coefficients& c, span_positions& out) {
  find_positions<0, false, Rounded>(c, out);
  const v level = detail_of(set(max_of(c.level_row[0], c.level_column[0]) * 64), int32_t(c.last_level) << q.level_bits);
#pragma GCC unroll 8
  for (int k = 0; k < span_pixel_count; k += width) put(out.level + k, level);
}

// Calls with.operator()<Terms>() for the terms of the series, none where the span is affine. False where it takes the divide.
SPANTEX_INLINE bool by_terms(const span_coefficients& c, auto&& with) {
  switch (c.how == evaluation::affine ? 0 : c.how == evaluation::series ? c.terms : levels_alone) {
    case 0: with.template operator()<0>(); return true;
    case 1: with.template operator()<1>(); return true;
    case 2: with.template operator()<2>(); return true;
    case 3: with.template operator()<3>(); return true;
    case 4: with.template operator()<4>(); return true;
    default: return false;
  }
}
static_assert(most_series_terms == 4);

template <bool Levels, bool Rounded = true>
SPANTEX_INLINE void find_positions(const span_coefficients& c, span_positions& out) {
  if (Levels && c.g == 0 && c.h == 0) return find_facing_positions<Rounded>(c, out);
  if (!by_terms(c, [&]<int Terms>() SPANTEX_INLINED { find_positions<Terms, Levels, Rounded>(c, out); })) {
    if (Levels && c.slope_log2 <= most_level_slope_log2) find_positions<levels_alone, Levels, Rounded>(c, out);
    divide_positions(c, out);
  }
  if (Levels && c.slope_log2 > most_level_slope_log2) steep_levels(c, out);
}
