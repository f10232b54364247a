// SPDX-License-Identifier: Apache-2.0
// ETC1 and ETC2 blocks. Each mode is fitted by itself and the best one written; errors are counted on decoded colours.
//   individual, differential   a half's mean, then steps of one a channel; all eight tables at the mean, the best two afterwards
//   planar                     least squares, then steps of one; channels are independent
//   T, H                       two clusters of colours (2-means along the widest channel), all eight distances
//   EAC alpha                  all sixteen tables, multipliers and bases about those that span the block's range
#include <spantex/etc.hpp>

#include <algorithm>
#include <array>
#include <utility>

#include "encode.hpp"

namespace spantex::sim::detail {
namespace {

constexpr int texels = 16;

using rgb = std::array<int, 3>;

// A block in the making: bits 63..0 as the format numbers them.
struct encoded {
  uint64_t bits = 0;
  int64_t error = INT64_MAX;
  void put(int high, int low, int value) { bits |= (uint64_t(value) & ((uint64_t(1) << (high - low + 1)) - 1)) << low; }
};

struct job {
  const texel_block& block;
  std::array<bool, texels> opaque;
  bool punch_through;  // etc2_rgb8a1
  bool all_opaque;
};

int channel(rgba8 c, size_t k) { return k == 0 ? c.r : k == 1 ? c.g : c.b; }

rgba8 widened(const rgb& q, int bits) { return etc_colour(q[0], q[1], q[2], bits); }

int narrowed(int64_t sum, int64_t count, int bits) {  // sum / count to the nearest of 2^bits levels
  const int64_t most = (1 << bits) - 1, whole = 255 * std::max<int64_t>(count, 1);
  return int(std::clamp<int64_t>((2 * sum * most + whole) / (2 * whole), 0, most));
}

bool in_half(int k, bool by_rows, int half) { return (by_rows ? k / 4 : k % 4) / 2 == half; }

// Bits of a texel's paint.
uint64_t paint_bits(int k, int paint) {
  const int n = 4 * (k % 4) + k / 4;
  return uint64_t(paint >> 1) << (16 + n) | uint64_t(paint & 1) << n;
}

// Chooses paints for the texels of one half (or, with half < 0, of the block): returns the error and adds the bits.
int64_t painted(const job& j, const rgba8 (&paint)[4], bool by_rows, int half, bool opaque, uint64_t& bits, int64_t limit = INT64_MAX) {
  int64_t error = 0;
  for (int k = 0; k < texels && error < limit; ++k) {
    if (half >= 0 && !in_half(k, by_rows, half)) continue;
    if (!j.opaque[size_t(k)]) {
      bits |= paint_bits(k, 2);
      continue;
    }
    int64_t least = INT64_MAX;
    int chosen = 0;
    for (int n = 0; n < 4; ++n) {
      if (n == 2 && !opaque) continue;
      const int64_t e = colour_error(paint[n], j.block.texel[k]);
      if (e < least) { least = e; chosen = n; }
    }
    error += least;
    bits |= paint_bits(k, chosen);
  }
  return error;
}

struct half_fit {
  rgb base{};
  int table = 0;
  int64_t error = INT64_MAX;
};

struct limits { rgb low, high; };

// One half with a base inside the limits.
half_fit fitted_half(const job& j, bool by_rows, int half, int bits, bool opaque, const limits& range) {
  int64_t sum[3] = {}, count = 0;
  for (int k = 0; k < texels; ++k) {
    if (!in_half(k, by_rows, half) || !j.opaque[size_t(k)]) continue;
    ++count;
    for (size_t c = 0; c < 3; ++c) sum[c] += channel(j.block.texel[k], c);
  }
  const auto error_of = [&](const rgb& base, int table, int64_t limit) {
    rgba8 paint[4];
    spantex::detail::etc_half(widened(base, bits), table, opaque, paint);
    uint64_t unused = 0;
    return painted(j, paint, by_rows, half, opaque, unused, limit);
  };
  half_fit best;
  for (size_t c = 0; c < 3; ++c) best.base[c] = std::clamp(narrowed(sum[c], count, bits), range.low[c], range.high[c]);
  int64_t by_table[8];
  for (int table = 0; table < 8; ++table) {
    by_table[table] = error_of(best.base, table, INT64_MAX);
    if (by_table[table] < best.error) { best.error = by_table[table]; best.table = table; }
  }
  int second = best.table == 0 ? 1 : 0;
  for (int table = 0; table < 8; ++table)
    if (table != best.table && by_table[table] < by_table[second]) second = table;
  const int tables[2] = {best.table, second};
  const rgb middle = best.base;
  for (int step = 0; step < 27 && best.error != 0; ++step) {
    const rgb base{middle[0] + step % 3 - 1, middle[1] + step / 3 % 3 - 1, middle[2] + step / 9 - 1};
    bool inside = step != 13;
    for (size_t c = 0; c < 3; ++c) inside = inside && base[c] >= range.low[c] && base[c] <= range.high[c];
    for (const int table : tables) {
      if (!inside) break;
      const int64_t error = error_of(base, table, best.error);
      if (error < best.error) best = {base, table, error};
    }
  }
  return best;
}

limits whole_range(int bits) {
  const int most = (1 << bits) - 1;
  return {{0, 0, 0}, {most, most, most}};
}

// Where the other half's base may be: d = second - first in -4..3.
limits near_to(const rgb& base, bool is_first) {
  limits l{};
  for (size_t c = 0; c < 3; ++c) {
    l.low[c] = std::max(0, base[c] - (is_first ? 4 : 3));
    l.high[c] = std::min(31, base[c] + (is_first ? 3 : 4));
  }
  return l;
}

struct pair_fit {
  half_fit first, second;
  int64_t error() const { return first.error + second.error; }
};

pair_fit differential_pair(const job& j, bool by_rows, bool opaque) {
  pair_fit a, b;
  a.first = fitted_half(j, by_rows, 0, 5, opaque, whole_range(5));
  b.second = fitted_half(j, by_rows, 1, 5, opaque, whole_range(5));
  bool compatible = true;
  for (size_t c = 0; c < 3; ++c) {
    const int d = b.second.base[c] - a.first.base[c];
    compatible = compatible && d >= -4 && d <= 3;
  }
  if (compatible) return {a.first, b.second};
  a.second = fitted_half(j, by_rows, 1, 5, opaque, near_to(a.first.base, true));
  b.first = fitted_half(j, by_rows, 0, 5, opaque, near_to(b.second.base, false));
  return a.error() <= b.error() ? a : b;
}

encoded halves(const job& j, const pair_fit& fit, bool by_rows, bool differential, bool opaque) {
  encoded e;
  e.error = 0;
  for (size_t c = 0; c < 3; ++c) {
    const int top = 63 - 8 * int(c), first = fit.first.base[c], second = fit.second.base[c];
    if (differential) {
      e.put(top, top - 4, first);
      e.put(top - 5, top - 7, second - first);
    } else {
      e.put(top, top - 3, first);
      e.put(top - 4, top - 7, second);
    }
  }
  e.put(39, 37, fit.first.table);
  e.put(36, 34, fit.second.table);
  e.put(33, 33, j.punch_through ? opaque : differential);
  e.put(32, 32, by_rows);
  for (int half = 0; half < 2; ++half) {
    const half_fit& f = half == 0 ? fit.first : fit.second;
    rgba8 paint[4];
    spantex::detail::etc_half(widened(f.base, differential ? 5 : 4), f.table, opaque, paint);
    e.error += painted(j, paint, by_rows, half, opaque, e.bits);
  }
  return e;
}

void keep_better(encoded& best, const encoded& e) {
  if (e.error < best.error) best = e;
}

encoded best_halves(const job& j) {
  encoded best;
  const bool opaque = j.all_opaque;
  for (const bool by_rows : {false, true}) {
    keep_better(best, halves(j, differential_pair(j, by_rows, opaque), by_rows, true, opaque));
    if (j.punch_through) continue;
    const pair_fit fit{fitted_half(j, by_rows, 0, 4, true, whole_range(4)), fitted_half(j, by_rows, 1, 4, true, whole_range(4))};
    keep_better(best, halves(j, fit, by_rows, false, true));
  }
  return best;
}

// Makes base + delta of the three bits below leave 0..31 (T: red, H: green, planar: blue): the bits of the sum that carry data are
// `a` (two bits of the base) and `b` (two of the delta); the free ones are set.
void overflow(encoded& e, int base_top, int a, int b) {
  if (a + b >= 4) e.put(base_top, base_top - 2, 7);
  else e.put(base_top - 5, base_top - 5, 1);
}

// Keeps base + delta inside 0..31 by the base's free top bit: a negative delta needs a large base.
void no_overflow(encoded& e, int base_top) { e.put(base_top, base_top, int(e.bits >> (base_top - 5) & 1)); }

int64_t planar_error(const job& j, size_t c, int o, int h, int v) {
  int64_t error = 0;
  for (int k = 0; k < texels; ++k) {
    const int64_t d = etc_planar(o, h, v, k % 4, k / 4) - channel(j.block.texel[k], c);
    error += d * d;
  }
  return error;
}

// One channel's O, H, V with `bits` bits.
std::array<int, 3> planar_channel(const job& j, size_t c, int bits, int64_t& error) {
  int64_t sum = 0, gx = 0, gy = 0;
  for (int k = 0; k < texels; ++k) {
    const int value = channel(j.block.texel[k], c);
    sum += value;
    gx += (2 * (k % 4) - 3) * value;
    gy += (2 * (k / 4) - 3) * value;
  }
  const int64_t o = 5 * sum - 3 * (gx + gy);  // the fitted plane at (0, 0), times 80; a step is 2 gx
  std::array<int, 3> q{};
  const int64_t corner[3] = {o, o + 8 * gx, o + 8 * gy};
  for (size_t n = 0; n < 3; ++n) q[n] = narrowed(std::max<int64_t>(corner[n], 0), 80, bits);
  const auto wide = [&](int x) { return spantex::detail::repeated(x, bits); };
  error = planar_error(j, c, wide(q[0]), wide(q[1]), wide(q[2]));
  for (bool better = true; better;) {
    better = false;
    for (size_t n = 0; n < 3; ++n)
      for (const int step : {-1, 1}) {
        std::array<int, 3> next = q;
        next[n] += step;
        if (next[n] < 0 || next[n] >= 1 << bits) continue;
        const int64_t e = planar_error(j, c, wide(next[0]), wide(next[1]), wide(next[2]));
        if (e < error) { error = e; q = next; better = true; }
      }
  }
  return q;
}

encoded planar(const job& j) {
  encoded e;
  int64_t errors[3];
  const auto r = planar_channel(j, 0, 6, errors[0]), g = planar_channel(j, 1, 7, errors[1]), b = planar_channel(j, 2, 6, errors[2]);
  e.error = errors[0] + errors[1] + errors[2];
  e.put(62, 57, r[0]);
  e.put(56, 56, g[0] >> 6);
  e.put(54, 49, g[0]);
  e.put(48, 48, b[0] >> 5);
  e.put(44, 43, b[0] >> 3);
  e.put(41, 39, b[0]);
  e.put(38, 34, r[1] >> 1);
  e.put(33, 33, 1);
  e.put(32, 32, r[1]);
  e.put(31, 25, g[1]);
  e.put(24, 19, b[1]);
  e.put(18, 13, r[2]);
  e.put(12, 6, g[2]);
  e.put(5, 0, b[2]);
  no_overflow(e, 63);
  no_overflow(e, 55);
  overflow(e, 47, b[0] >> 3 & 3, b[0] >> 1 & 3);
  return e;
}

// Two clusters of the block's opaque texels, as 4-bit colours. False if all are alike.
bool clusters(const job& j, rgb& a, rgb& b) {
  rgb low{255, 255, 255}, high{};
  for (int k = 0; k < texels; ++k)
    for (size_t c = 0; j.opaque[size_t(k)] && c < 3; ++c) {
      low[c] = std::min(low[c], channel(j.block.texel[k], c));
      high[c] = std::max(high[c], channel(j.block.texel[k], c));
    }
  size_t widest = 0;
  for (size_t c = 1; c < 3; ++c)
    if (high[c] - low[c] > high[widest] - low[widest]) widest = c;
  if (high[widest] <= low[widest]) return false;
  rgba8 centre[2]{};
  std::array<bool, texels> second{};
  for (int k = 0; k < texels; ++k) second[size_t(k)] = 2 * channel(j.block.texel[k], widest) > low[widest] + high[widest];
  for (int round = 0; round < 4; ++round) {
    int64_t sum[2][3] = {}, count[2] = {};
    for (int k = 0; k < texels; ++k) {
      if (!j.opaque[size_t(k)]) continue;
      ++count[second[size_t(k)]];
      for (size_t c = 0; c < 3; ++c) sum[second[size_t(k)]][c] += channel(j.block.texel[k], c);
    }
    for (int n = 0; n < 2; ++n) {
      rgb& q = n == 0 ? a : b;
      for (size_t c = 0; c < 3; ++c) q[c] = narrowed(sum[n][c], count[n], 4);
      centre[n] = widened(q, 4);
    }
    for (int k = 0; k < texels; ++k)
      second[size_t(k)] = colour_error(centre[1], j.block.texel[k]) < colour_error(centre[0], j.block.texel[k]);
  }
  return true;
}

encoded t_mode(const job& j, const rgb& a, const rgb& b, int number) {
  encoded e;
  e.put(60, 59, a[0] >> 2);
  e.put(57, 56, a[0]);
  e.put(55, 52, a[1]);
  e.put(51, 48, a[2]);
  e.put(47, 44, b[0]);
  e.put(43, 40, b[1]);
  e.put(39, 36, b[2]);
  e.put(35, 34, number >> 1);
  e.put(33, 33, j.all_opaque);
  e.put(32, 32, number);
  overflow(e, 63, a[0] >> 2, a[0] & 3);
  rgba8 paint[4];
  spantex::detail::etc_t_mode({uint32_t(e.bits >> 32), 0}, paint);
  e.error = painted(j, paint, false, -1, j.all_opaque, e.bits);
  return e;
}

// The lowest bit of the distance's number is the order of the colours.
encoded h_mode(const job& j, rgb a, rgb b, int number) {
  using spantex::detail::rgb_number;
  if ((rgb_number(widened(a, 4)) >= rgb_number(widened(b, 4))) != ((number & 1) != 0)) std::swap(a, b);
  encoded e;
  e.put(62, 59, a[0]);
  e.put(58, 56, a[1] >> 1);
  e.put(52, 52, a[1]);
  e.put(51, 51, a[2] >> 3);
  e.put(49, 47, a[2]);
  e.put(46, 43, b[0]);
  e.put(42, 39, b[1]);
  e.put(38, 35, b[2]);
  e.put(34, 34, number >> 2);
  e.put(33, 33, j.all_opaque);
  e.put(32, 32, number >> 1);
  no_overflow(e, 63);
  overflow(e, 55, (a[1] & 1) << 1 | a[2] >> 3, a[2] >> 1 & 3);
  rgba8 paint[4];
  spantex::detail::etc_h_mode({uint32_t(e.bits >> 32), 0}, paint);
  e.error = painted(j, paint, false, -1, j.all_opaque, e.bits);
  return e;
}

encoded best_etc2(const job& j) {
  encoded best = best_halves(j);
  if (best.error != 0 && j.all_opaque) keep_better(best, planar(j));
  rgb a{}, b{};
  if (best.error == 0 || !clusters(j, a, b)) return best;
  for (int number = 0; number < 8; ++number) {
    keep_better(best, t_mode(j, a, b, number));
    keep_better(best, t_mode(j, b, a, number));
    keep_better(best, h_mode(j, a, b, number));
  }
  return best;
}

void write(uint64_t bits, uint8_t* out) {
  for (int k = 0; k < 8; ++k) out[k] = uint8_t(bits >> (56 - 8 * k));
}

// Assigns modifiers; bits 47..0.
int64_t assigned_alpha(const texel_block& block, int base, int multiplier, int table, uint64_t& bits) {
  int64_t error = 0;
  bits = 0;
  for (int k = 0; k < texels; ++k) {
    int64_t least = INT64_MAX;
    uint64_t chosen = 0;
    for (uint64_t n = 0; n < 8; ++n) {
      const int64_t d = spantex::detail::byte_of(base + multiplier * eac_modifiers[table][n]) - block.texel[k].a;
      if (d * d < least) { least = d * d; chosen = n; }
    }
    error += least;
    bits |= chosen << (45 - 3 * (4 * (k % 4) + k / 4));
  }
  return error;
}

uint64_t encode_alpha(const texel_block& block) {
  int low = 255, high = 0;
  for (const rgba8& c : block.texel) {
    low = std::min<int>(low, c.a);
    high = std::max<int>(high, c.a);
  }
  if (low == high) return uint64_t(low) << 56;
  uint64_t best = 0;
  int64_t least = INT64_MAX;
  for (int table = 0; table < 16; ++table) {
    const auto& m = eac_modifiers[table];
    const int span = m[7] - m[3], fitting = (high - low + span / 2) / span;
    for (int multiplier = std::max(1, fitting - 1); multiplier <= std::min(15, fitting + 1); ++multiplier) {
      const int middle = (low + high - multiplier * (m[7] + m[3])) / 2;
      for (int base = std::clamp(middle - 2, 0, 255); base <= std::clamp(middle + 2, 0, 255) && least != 0; ++base) {
        uint64_t bits = 0;
        const int64_t error = assigned_alpha(block, base, multiplier, table, bits);
        if (error >= least) continue;
        least = error;
        best = uint64_t(base) << 56 | uint64_t(multiplier) << 52 | uint64_t(table) << 48 | bits;
      }
    }
  }
  return best;
}

}  // namespace

void encode_etc_block(texel_format format, const texel_block& block, uint8_t* out) {
  job j{block, {}, format == texel_format::etc2_rgb8a1, true};
  for (size_t k = 0; k < texels; ++k) {
    j.opaque[k] = !j.punch_through || block.texel[k].a >= 128;
    j.all_opaque = j.all_opaque && j.opaque[k];
  }
  if (format == texel_format::etc2_rgba8) {
    write(encode_alpha(block), out);
    out += 8;
  }
  write((format == texel_format::etc1 ? best_halves(j) : best_etc2(j)).bits, out);
}

}  // namespace spantex::sim::detail
