// SPDX-License-Identifier: Apache-2.0
// Exact arithmetic to judge the engine by: 128-bit integers, wide enough that no step rounds.
#pragma once
#include <cmath>
#include <cstdint>

#include <spantex/plane.hpp>
#include <spantex/profile.hpp>

namespace spantex::sim {

__extension__ using int128 = __int128;
__extension__ using uint128 = unsigned __int128;

constexpr int128 size_of(int128 x) { return x < 0 ? -x : x; }
constexpr int128 int128_of(wide a) { return int128(uint128(uint64_t(a.high)) << 64 | a.low); }
constexpr int bits_of(int128 x) {
  const uint128 m = uint128(size_of(x));
  return uint64_t(m >> 64) != 0 ? 64 + bit_length(uint64_t(m >> 64)) : bit_length(uint64_t(m));
}

// floor(n / d), d > 0.
constexpr int128 floor_of(int128 n, int128 d) { return n / d - (n % d < 0 ? 1 : 0); }

// Nu, Nv and W at a position by the caller's integers, before set-up rounded them: cut to 62 bits of W, so right to 2^-45 texel; exact where they
// are shorter.
struct exact_point {
  int128 u, v;
  int64_t w;
};
inline exact_point exact_at(const plane& p, int32_t hx, int32_t hy) {
  if (p.dropped_bits <= 0) return {p.u_at(hx, hy), p.v_at(hx, hy), p.w_at(hx, hy)};
  const int128 w = int128_of(p.value(p.exact_w, hx, hy));
  const int cut = bits_of(w) > 62 ? bits_of(w) - 62 : 0;
  return {int128_of(p.value(p.exact_u, hx, hy)) >> cut, int128_of(p.value(p.exact_v, hx, hy)) >> cut, int64_t(w >> cut)};
}

// |raw / 2^16 - numerator / w| in texels, from an exact integer difference; w > 0. 32 + 62 and 77 + 16 bits: nothing overflows in range.
inline double coordinate_error(int32_t raw, int128 numerator, int64_t w) {
  const int128 difference = int128(raw) * w - (numerator << 16);
  const int128 size = difference < 0 ? -difference : difference;
  return double(static_cast<long double>(size) / (static_cast<long double>(w) * 65536.0L));
}

// The exact position lies within (-2^15, 2^15), so a coordinate is promised for it.
inline bool in_range(int128 numerator, int64_t w) {
  const int128 limit = int128(w) << 15;
  return numerator < limit && numerator > -limit;
}

// |snapped / 2^bits - (numerator / w size_level / size_0 - 1/2)| in texels of a level, from an exact integer difference: at most 25 + 62 +
// 12 bits and 77 + 12 + 9.
inline double snapped_error(int32_t snapped, int bits, int128 numerator, int64_t w, int32_t size_level, int32_t size_0) {
  const int128 unit = int128(w) * size_0;
  const int128 difference = (int128(2) * snapped + (int128(1) << bits)) * unit - (numerator * size_level << (bits + 1));
  const int128 size = difference < 0 ? -difference : difference;
  return double(static_cast<long double>(size) / (static_cast<long double>(unit) * static_cast<long double>(int64_t(1) << (bits + 1))));
}

// Vulkan's rho as log2, at a point in half pixels where w > 0: the longer column of the Jacobian, texels per pixel. The
// numerators A W - Nu G are exact integers of up to 105 bits; only the final logarithm is floating point, in long double.
inline long double exact_level(const plane& p, int32_t hx, int32_t hy) {
  const int64_t w = p.w_at(hx, hy), nu = p.u_at(hx, hy), nv = p.v_at(hx, hy);
  const auto column = [&](int64_t a, int64_t d, int64_t g) {
    const long double x = static_cast<long double>(int128(a) * w - int128(nu) * g);
    const long double y = static_cast<long double>(int128(d) * w - int128(nv) * g);
    return std::hypot(x, y);
  };
  const long double length = std::fmax(column(p.u.x, p.v.x, p.w.x), column(p.u.y, p.v.y, p.w.y));
  return std::log2(2 * length) - 2 * std::log2(static_cast<long double>(w));
}

// KT88's formula at a point where w > 0: log2 K - 2 log2 W, with the plane's own log2 K.
inline long double exact_major_level(const plane& p, int32_t hx, int32_t hy) {
  return static_cast<long double>(p.major_log2) / 65536 - 2 * std::log2(static_cast<long double>(p.w_at(hx, hy)));
}

// Its counterpart for the minor axis: log2 K' - log2 W.
inline long double exact_minor_level(const plane& p, int32_t hx, int32_t hy) {
  return static_cast<long double>(p.minor_log2) / 65536 - std::log2(static_cast<long double>(p.w_at(hx, hy)));
}

inline long double exact_level(level_formula f, const plane& p, int32_t hx, int32_t hy) {
  switch (f) {
    case level_formula::major: return exact_major_level(p, hx, hy);
    case level_formula::minor: return exact_minor_level(p, hx, hy);
    case level_formula::jacobian: break;
  }
  return exact_level(p, hx, hy);
}

// What SPEC section 6 makes of a formula's level, before it is clamped.
inline long double finer_level(long double level, int bias) { return std::fmax(level + bias / 16.0L, std::fmin(level, -5 * bias / 128.0L)); }
inline long double biased_level(const profile& q, long double level) { return finer_level(level, q.mip_bias) + q.level_bias / 16.0L; }

}  // namespace spantex::sim
