// SPDX-License-Identifier: Apache-2.0
// Windowed sinc in integers. Arguments are ratios n / d of integers, so nothing depends on a machine's floating point.
//
//   pi^2             10597407032 2^-30, to nearest
//   sin(pi f)/(pi f) f in [0, 1/2]: 1 - y/6 (1 - y/20 (1 - y/42 (1 - ...))), y = (pi f)^2 <= 2.47; six terms leave y^7/15! < 2^-31
//   sinc(n/d)        with i whole and f the distance to the nearest integer, |sin(pi t)| = sin(pi f), so sinc(t) = +-sinc(f) f/t: no pi in it
//   I0(2 sqrt z)     sum over k of z^k / (k!)^2 (Abramowitz & Stegun 9.6.12); z <= 4: terms beyond the 12th are below 2^-34
//
// Checked against libm in tests/unit/prefilter.cpp: within 2^-27 for sinc, 2^-24 for I0.
#pragma once
#include <stdint.h>

namespace spantex::sim {

inline constexpr int64_t one_q30 = int64_t(1) << 30;
inline constexpr int64_t pi_squared_q30 = 10597407032;
inline constexpr int64_t pi_q30 = 3373259426;

namespace detail {

constexpr int64_t product_q30(int64_t a, int64_t b) { return (a * b + one_q30 / 2) >> 30; }

// sin(pi f) / (pi f), f in [0, 1/2], both s.30.
constexpr int64_t small_sinc(int64_t f) {
  const int64_t y = product_q30(product_q30(f, f), pi_squared_q30);
  int64_t p = one_q30;
  for (int k = 6; k >= 1; --k) p = one_q30 - product_q30(y, p) / ((2 * k) * (2 * k + 1));
  return p;
}

struct reduced { int64_t distance; bool odd; };  // to the nearest integer, in 1/d; parity of the whole part
constexpr reduced reduce(int64_t n, int64_t d) {
  const int64_t rest = n % d;
  return {2 * rest <= d ? rest : d - rest, (n / d) % 2 != 0};
}

constexpr int64_t ratio_q30(int64_t n, int64_t d) { return (n * one_q30 + d / 2) / d; }

}  // namespace detail

// sin(pi n/d) / (pi n/d), 30 fraction bits; |n| < 2^32, 0 < d < 2^32.
constexpr int64_t sinc(int64_t n, int64_t d) {
  if (n < 0) n = -n;
  if (n == 0) return one_q30;
  const detail::reduced r = detail::reduce(n, d);
  const int64_t magnitude = detail::small_sinc(detail::ratio_q30(r.distance, d)) * r.distance / n;
  return r.odd ? -magnitude : magnitude;
}

// cos(pi n/d), 30 fraction bits; |n| < 2^31, 0 < d < 2^31: sin(pi (n/d + 1/2)).
constexpr int64_t cos_pi(int64_t n, int64_t d) {
  if (n < 0) n = -n;
  const detail::reduced r = detail::reduce(2 * n + d, 2 * d);
  const int64_t f = detail::ratio_q30(r.distance, 2 * d);
  const int64_t magnitude = detail::product_q30(detail::product_q30(pi_q30, f), detail::small_sinc(f));
  return r.odd ? -magnitude : magnitude;
}

// I0(2 sqrt z), z in [0, 4], both 28 fraction bits.
constexpr int64_t bessel_i0(int64_t z) {
  constexpr int64_t one = int64_t(1) << 28;
  int64_t term = one, sum = one;
  for (int64_t k = 1; k <= 12; ++k) {
    term = ((term * z + one / 2) >> 28) / (k * k);
    sum += term;
  }
  return sum;
}

inline constexpr int window_reach = 3;  // texels of the coarser level

// Unscaled weights at distance n/d texels of the coarser level, 30 fraction bits; 0 from window_reach on; d <= 8192.
constexpr int64_t lanczos_weight(int64_t n, int64_t d) {
  if (n >= window_reach * d || n <= -window_reach * d) return 0;
  return detail::product_q30(sinc(n, d), sinc(n, window_reach * d));
}

constexpr int64_t kaiser_weight(int64_t n, int64_t d) {
  if (n >= window_reach * d || n <= -window_reach * d) return 0;
  const int64_t whole = window_reach * window_reach * d * d;
  const int64_t z = ((4 * (whole - n * n)) << 28) / whole;  // (beta / 2)^2 (1 - (t/3)^2), beta = 4
  return (sinc(n, d) * bessel_i0(z)) >> 28;
}

}  // namespace spantex::sim
