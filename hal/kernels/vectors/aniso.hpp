// SPDX-License-Identifier: Apache-2.0
// Vector kernels: filter aniso, rows of trilinear samples along each pixel's image (footprint.hpp). The axis of a span is the scalar engine's own; lanes
// are neighbouring pixels, and take a sample each at a time. Included by the machines' files alone.
#pragma once

static_assert(q.max_samples == 16 && q.sample_bias == -8, "row_work::most_ratio, tables of 16; finer() as in positions.hpp");

// By ratio of the axes, a step of 2^-4: how many samples the step begins with, in the upper half, and from where on in it they are one more.
constexpr int ratio_step_bits = 12, ratio_steps = 4 << (16 - ratio_step_bits);
struct sample_counts {
  int32_t step[ratio_steps + 1];
  constexpr sample_counts() : step() {
    for (int32_t k = 0; k <= ratio_steps; ++k) {
      const int32_t from = k << ratio_step_bits, count = samples_of(q, from);
      int32_t low = 0, high = 1 << ratio_step_bits;  // as many at low; more at high, or there is no high
      while (high - low > 1) {
        const int32_t middle = (low + high) / 2;
        (samples_of(q, from + middle) > count ? high : low) = middle;
      }
      step[k] = count << 16 | high;
    }
  }
};
constexpr sample_counts counts{};

// The clamp of the ratio is one of the number of samples.
constexpr bool ratios_limit_samples() {
  for (int most = 1; most <= q.max_samples; ++most)
    if (samples_of(q, log2_16(uint64_t(most))) > most) return false;
  return true;
}
static_assert(ratios_limit_samples());

// By number of samples.
struct sample_fractions {
  int32_t half_pitch[17], inverse[17];  // floor((2^16 + n) / 2n); ceil(2^15 / n)
  constexpr sample_fractions() : half_pitch(), inverse() {
    for (int n = 1; n <= 16; ++n) {
      half_pitch[n] = (65536 + n) / (2 * n);
      inverse[n] = ((1 << 15) + n - 1) / n;
    }
  }
};
constexpr sample_fractions of_samples{};

constexpr bool inverses_divide() {
  for (int n = 1; n <= 16; ++n)
    for (int x = 0; x <= 255 * n + n / 2; ++x)
      if ((x * of_samples.inverse[n]) >> 15 != x / n) return false;
  return true;
}
static_assert(inverses_divide());

// Of 64 pixels, as place_of() has them: the vector before it is divided by w^2; w; number of samples; the vector's size in both axes, s15.16: its signs are n's.
struct alignas(64) span_rows { int32_t n_u[span_pixel_count], n_v[span_pixel_count], w[span_pixel_count], samples[span_pixel_count], u[span_pixel_count], v[span_pixel_count]; };

// shape_of(): levels of detail and numbers of samples. False where a vector is zero.
SPANTEX_INLINE bool find_shapes(const row_work& work, const span_coefficients& c, level_number* level, span_rows& out, bool& several) {
  const axis_terms& t = c.axis;
  const bool flat = (c.g | c.h) == 0;
  const int32_t area = t.area_log2 * (1 << (16 - level_term_bits)), most = int32_t(c.last_level) << q.level_bits, whole = (1 - t.exponent) * (1 << 16);
  bool nonzero = true;
  v largest_number = set(1);
  for (int part = 0; part < parts; ++part) {
    form nu(t.c_u, t.a_u, t.b_u, part), nv(t.c_v, t.a_v, t.b_v, part), nw(1 << q.reciprocal_bits, c.g, c.h, part);
    for (int y = 0; y < span_side; y += rows_at_once) {
      const int at = place_of(y, part);
      put(out.n_u + at, nu.at);
      put(out.n_v + at, nv.at);
      put(out.w + at, nw.at);
      const wide squares[] = {squares_of(nu.at, nv.at)};
      v bits;
      nonzero &= normalised(squares, &bits);
      const v length = half_log2_of(bits) + whole, log_w = flat ? set(0) : log2_of_w(nw.at), major = length - (log_w << 1);
      const v ratio = largest(least(least((length << 1) - area - log_w, major), set(work.most_ratio)), set(0)), minor = major - ratio;
      put(level + at, detail_of(minor, most));
      const v step = look_up(counts.step, ratio >> ratio_step_bits);
      const v samples = (step >> 16) - v((ratio & ((1 << ratio_step_bits) - 1)) >= (step & 0xFFFF));
      put(out.samples + at, samples);
      largest_number = largest(largest_number, samples);
      nu.next();
      nv.next();
      nw.next();
    }
  }
  several = !all_equal(largest_number, 1);
  return nonzero;
}

// |n| / w^2 in 2^-16 texels: both products rounded, then the scale.
SPANTEX_INLINE wide over_square(v n, v reciprocal, int drop) {
  const auto shifted = [](const wide& x, int shift) SPANTEX_INLINED { return wide{rounded_shift(x.first, shift), rounded_shift(x.second, shift)}; };
  const auto over_w = [&](auto x) SPANTEX_INLINED { return shifted(unsigned_products(x, reciprocal), q.reciprocal_bits); };
  return shifted(over_w(over_w(n)), drop);
}

// axis_at(), not saturated. False where a row is longer than `most` texels, or all of them together (bit by bit).
[[gnu::noinline]] bool find_rows(const span_coefficients& c, int32_t most, span_rows& out) {
  const int drop = c.axis.exponent - 17;
  if (drop <= 0) return false;
  v_64 beyond{};
  for (int k = 0; k < span_pixel_count; k += width) {
    const v nu = get(out.n_u + k), nv = get(out.n_v + k), minus_u = nu >> 31, minus_v = nv >> 31;
    const v r = c.how == evaluation::affine ? set(1 << q.reciprocal_bits) : reciprocals_of(get(out.w + k));
    const wide u = over_square((nu ^ minus_u) - minus_u, r, drop), w = over_square((nv ^ minus_v) - minus_v, r, drop);
    beyond |= u.first | u.second | w.first | w.second;
    put(out.u + k, narrowed(u));
    put(out.v + k, narrowed(w));
  }
  uint64_t any = 0;
  for (int k = 0; k < width / 2; ++k) any |= beyond[k];
  return any < uint64_t(most) << 16;
}

// length m 2^-16, symmetric: length up to 2^29, m from 0 to 2^15 - 1.
SPANTEX_INLINE v along(v length, v m) {
  return (small_products(length >> 15, m) + ((small_products(length & 0x7FFF, m) + 0x8000) >> 15)) >> 1;
}

// Where the samples of `width` pixels from the k-th on lie on a level, and on the next where `two`; placed(level, at, s) after each. Samples 2 m and 2 m + 1 of a loop are the m-th from
// either end of a row; positions have 14 bits of fraction, which takes nothing from what an integer number of them is snapped to, and two more for ratios.
template <bool MasksOnly, int Placed, class Shift>
SPANTEX_INLINE void place_samples(const on_level<Shift>& fine, const on_level<Shift>& coarse, bool two, const span_positions& p, const span_rows& rows, int k, int most,
                                  lanes_places (&near)[Placed], lanes_places (&far)[Placed], auto&& placed) {
  static_assert(rest_bits == 2);
  const v samples = get(rows.samples + k), pitch = look_up(of_samples.half_pitch, samples), centre_u = get(p.u + k), centre_v = get(p.v + k);
  const v minus_u = get(rows.n_u + k) >> 31, minus_v = get(rows.n_v + k) >> 31, length_u = get(rows.u + k), length_v = get(rows.v + k);
  // Positions with all the bits that samples have, from where the pixel lies on the level: where periods are powers of two, nothing is lost with what that leaves out above.
  // NEON has too few registers for it.
  struct from_centre { v u, v_; };
  const auto base = [&](const on_level<Shift>& level) SPANTEX_INLINED { return from_centre{(level.add_u + centre_u) << rest_bits, (level.add_v + centre_v) << rest_bits}; };
  const from_centre fine_base = base(fine), coarse_base = base(coarse);
  const auto take = [&](const on_level<Shift>& level, const from_centre& from, lanes_places (&at)[Placed], v u, v w, int s) SPANTEX_INLINED {
    if constexpr (MasksOnly && places_first) put_places<true>(level, down_by(u + from.u, level.cut + rest_bits), down_by(w + from.v_, level.cut + rest_bits), at[s % Placed]);
    else place_lanes<MasksOnly>(level, centre_u + (u >> rest_bits), centre_v + (w >> rest_bits), p, at[s % Placed], u & 3, w & 3);
    placed(level, at, s);
  };
  const auto take_both = [&](v u, v w, int s) SPANTEX_INLINED {
    take(fine, fine_base, near, u, w, s);
    if (two) take(coarse, coarse_base, far, u, w, s);
  };
  for (int s = 0; s < most; s += 2) {
    const v m = small_products(largest(samples - 1 - s, set(0)), pitch), u = (along(length_u, m) ^ minus_u) - minus_u, w = (along(length_v, m) ^ minus_v) - minus_v;
    take_both(-u, -w, s);
    if (s + 1 < most) take_both(u, w, s + 1);
  }
}

// Means over the rows of `width` pixels from the k-th on, of `fewest` to `most` samples.
#if SPANTEX_LINEAR
template <bool MasksOnly, class Shift>
SPANTEX_INLINE unfinished means_of_rows(const row_levels& map, const on_level<Shift>& fine, const on_level<Shift>& coarse, v fraction, const span_positions& p, const span_rows& rows, int k, int, int most) {
  const v samples = get(rows.samples + k);
  const bool two = !all_equal(fraction, 0);
  lanes_places near[q.max_samples], far[q.max_samples];
  place_samples<MasksOnly>(fine, coarse, two, p, rows, k, most, near, far, [](auto&&...) {});
  colour_sums sums;
  for (int s = 0; s < most; ++s) {
    const blends one = blended(map, near[s], fine.down);
    const v counted = v(samples > s);
    if (two) add_sample(sums, one, blended(map, far[s], coarse.down), fraction, counted);
    else add_sample(sums, one, counted);
  }
  return means_of(sums, samples);
}
#else
template <bool MasksOnly, class Shift>
SPANTEX_INLINE unfinished means_of_rows(const row_levels& map, const on_level<Shift>& fine, const on_level<Shift>& coarse, v fraction, const span_positions& p, const span_rows& rows, int k, int fewest, int most) {
  const v samples = get(rows.samples + k);
  const bool two = !all_equal(fraction, 0);
  constexpr int placed = places_first ? q.max_samples : 1;
  lanes_places near[placed], far[placed];
  colour_sums near_sums, far_sums;
  const auto add = [&](const on_level<Shift>& level, const lanes_places* at, colour_sums& sums, int s) SPANTEX_INLINED {
    add_colours(sums, blended(map, at[s % placed], level.down), v(samples > s), s < fewest);
  };
  const auto add_two = [&](const on_level<Shift>& level, const lanes_places* at, colour_sums& sums, int s) SPANTEX_INLINED {
    add_colours(sums, blended(map, at[s], level.down), v(samples > s), blended(map, at[s + 1], level.down), v(samples > s + 1), s + 1 < fewest);
  };
  place_samples<MasksOnly>(fine, coarse, two, p, rows, k, most, near, far, [&](const on_level<Shift>& level, const lanes_places* at, int s) SPANTEX_INLINED {
    if (!places_first) add(level, at, at == near ? near_sums : far_sums, s);
  });
  if constexpr (places_first) {
    const auto add_all = [&](const on_level<Shift>& level, const lanes_places* at, colour_sums& sums) SPANTEX_INLINED {
      int s = 0;
      for (; s + 1 < most; s += 2) add_two(level, at, sums, s);
      if (s < most) add(level, at, sums, s);
    };
    add_all(fine, near, near_sums);
    if (two) add_all(coarse, far, far_sums);
  }
  const v inverse = look_up(of_samples.inverse, samples);
  return two ? means_between<true>(near_sums, far_sums, fraction, samples, inverse) : means_between<false>(near_sums, near_sums, fraction, samples, inverse);
}
#endif

template <bool MasksOnly>
[[gnu::noinline]] unfinished means_by_lane(const row_levels& map, int32_t last, const span_positions& p, const span_rows& rows, int k, int fewest, int most) {
  if (!MasksOnly && map.exact_count() <= last)
    return each_level_in_turn(get(p.level + k) >> q.level_bits, [&](int32_t level) {
      return means_of_rows<MasksOnly>(map, level_at_once<MasksOnly>(map, level, p), level_at_once<MasksOnly>(map, min_of(level + 1, last), p), get(p.level + k) & 255, p, rows, k, fewest, most);
    });
  alignas(sizeof(v)) int32_t fine[width], coarse[width];
  put(fine, get(p.level + k) >> q.level_bits);
  put(coarse, least(get(fine) + 1, set(last)));
  return means_of_rows<MasksOnly>(map, level_by_lane(map, fine, p), level_by_lane(map, coarse, p), get(p.level + k) & 255, p, rows, k, fewest, most);
}

struct range_of { int fewest, most; };
SPANTEX_INLINE range_of numbers_of(const int32_t* samples) {
#if SPANTEX_AVX512 || SPANTEX_AVX2
  const v of = set(1) << get(samples);  // bit n: some have n
#if SPANTEX_AVX512
  const uint32_t any = uint32_t(_mm512_reduce_or_epi32(raw(of)));
#else
  const __m128i four = _mm_or_si128(_mm256_castsi256_si128(raw(of)), _mm256_extracti128_si256(raw(of), 1)), two = _mm_or_si128(four, _mm_unpackhi_epi64(four, four));
  const uint32_t any = uint32_t(_mm_cvtsi128_si32(two) | _mm_extract_epi32(two, 1));
#endif
  return {__builtin_ctz(any), 31 - __builtin_clz(any)};
#endif
  range_of r{samples[0], samples[0]};
  if (!all_equal(get(samples), r.most))
    for (int k = 1; k < width; ++k) r = {min_of(r.fewest, samples[k]), max_of(r.most, samples[k])};
  return r;
}

// False where the span is left: rows that are too long, vectors of no length, texels too far from the base.
template <bool MasksOnly>
[[gnu::noinline]] bool draw_aniso(const row_in_hand& work, int32_t sx, span_mask mask, span_positions& p, const span_coefficients& c) {
  const row_levels& map = work.texels->levels_in_rows();
  pixels_on_levels<MasksOnly, one_sample> pixels(work, p);
  span_rows rows;
  bool several = false;
  if (!find_shapes(work, c, p.level, rows, several)) return false;
  const int coarsest = MasksOnly ? 0 : pixels.coarsest();
  if (!MasksOnly && !in_reach(map, coarsest, reach_of(c), p)) return false;
  const auto rows_within = [&](int32_t limit) SPANTEX_INLINED { return find_rows(c, 2 * max_of(0, min_of(longest_row / 2, limit - reach_of(c))), rows); };
  if (several && (p.far || !rows_within(map.near_limit(coarsest)))) {
    p.far = true;
    if (MasksOnly || !rows_within(map.far_limit(coarsest))) return false;
  }
  if (!several) {
#if SPANTEX_TABLES
    if constexpr (MasksOnly) quads_on_levels<filter::trilinear>(work, sx, mask, p, c);
    else
#endif
    draw_on_levels(work, sx, mask, p, pixels);
    return true;
  }
  const auto at = [&](int n) SPANTEX_INLINED {
    const int k = n * width;
    const auto [fewest, most] = numbers_of(rows.samples + k);
    if (most == 1) {
      pixels.place(n);
      return pixels.at(n);
    }
    const v level = get(p.level + k), whole = level >> q.level_bits;
    if (!all_equal(whole, whole[0])) [[unlikely]] return means_by_lane<MasksOnly>(map, work.last_level, p, rows, k, fewest, most);
    pixels.hold(whole[0]);
    return means_of_rows<MasksOnly>(map, pixels.near(), pixels.far(), level & 255, p, rows, k, fewest, most);
  };
  draw_groups(work, sx, mask, [](int) {}, at);
  return true;
}
