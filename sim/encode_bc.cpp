// SPDX-License-Identifier: Apache-2.0
// BC1, BC2, BC3 blocks. Colours: the texels farthest apart along the principal axis, then least squares for the chosen indices while that
// helps, then steps of one in one channel of one end point while they help. Errors are counted on decoded colours.
#include <spantex/bc.hpp>

#include <algorithm>
#include <array>

#include "encode.hpp"

namespace spantex::sim::detail {
namespace {

constexpr int texels = 16;
constexpr int field_bits[3] = {5, 6, 5};

using fields = std::array<int, 3>;  // of a 565 number

struct end_points { fields a, b; };

struct colour_fit {
  uint32_t c0 = 0, c1 = 0;
  int64_t error = INT64_MAX;
  std::array<uint8_t, texels> index{};
};

enum class colour_mode { four, three };

// What is to be encoded: texels that count, and whether others are to be transparent.
struct job {
  const texel_block& block;
  std::array<bool, texels> opaque;
  bool bc1;
};

uint32_t number(const fields& f) { return uint32_t(f[0] << 11 | f[1] << 5 | f[2]); }
int channel(rgba8 c, int k) { return k == 0 ? c.r : k == 1 ? c.g : c.b; }
// The nearest field whose repeated bits give x.
int narrowed(int x, int bits) {
  const int most = (1 << bits) - 1;
  return std::clamp((2 * x * most + 255) / 510, 0, most);
}

// Orders the end points as the mode asks for, chooses indices.
colour_fit assigned(const job& j, const end_points& e, colour_mode mode) {
  colour_fit fit;
  fit.c0 = number(e.a);
  fit.c1 = number(e.b);
  const bool descending = mode == colour_mode::four;
  if (descending ? fit.c0 < fit.c1 : fit.c0 > fit.c1) std::swap(fit.c0, fit.c1);
  rgba8 colour[4]{};
  bc_colours(fit.c0, fit.c1, j.bc1, colour);
  const bool three = j.bc1 && fit.c0 <= fit.c1;
  fit.error = 0;
  for (size_t k = 0; k < texels; ++k) {
    if (!j.opaque[k]) { fit.index[k] = 3; continue; }
    int64_t least = INT64_MAX;
    for (uint8_t n = 0; n < (three ? 3 : 4); ++n) {
      const int64_t error = colour_error(colour[n], j.block.texel[k]);
      if (error < least) { least = error; fit.index[k] = n; }
    }
    fit.error += least;
  }
  return fit;
}

fields fields_of(uint32_t c) { return {int(c >> 11), int(c >> 5 & 63), int(c & 31)}; }
end_points ends_of(const colour_fit& f) { return {fields_of(f.c0), fields_of(f.c1)}; }

// The texels farthest apart along the principal axis: a few rounds of power iteration on the covariance.
end_points extremes(const job& j) {
  int64_t n = 0, sum[3] = {}, covariance[3][3] = {};
  for (size_t k = 0; k < texels; ++k) {
    if (!j.opaque[k]) continue;
    ++n;
    for (int c = 0; c < 3; ++c) sum[c] += channel(j.block.texel[k], c);
  }
  for (size_t k = 0; k < texels; ++k)
    for (int c = 0; j.opaque[k] && c < 3; ++c)
      for (int d = 0; d < 3; ++d)
        covariance[c][d] += (n * channel(j.block.texel[k], c) - sum[c]) * (n * channel(j.block.texel[k], d) - sum[d]);
  int widest = 0;
  for (int c = 1; c < 3; ++c)
    if (covariance[c][c] > covariance[widest][widest]) widest = c;
  int64_t axis[3] = {covariance[widest][0], covariance[widest][1], covariance[widest][2]};
  constexpr int rounds = 8;
  for (int round = 0; round <= rounds; ++round) {
    int64_t largest = 1, scaled[3];
    for (const int64_t x : axis) largest = std::max(largest, x < 0 ? -x : x);
    for (int c = 0; c < 3; ++c) axis[c] = scaled[c] = axis[c] * 1024 / largest;  // covariances are below 2^28
    for (int c = 0; round < rounds && c < 3; ++c)
      axis[c] = covariance[c][0] * scaled[0] + covariance[c][1] * scaled[1] + covariance[c][2] * scaled[2];
  }
  size_t low = texels, high = texels;
  int64_t least = 0, most = 0;
  for (size_t k = 0; k < texels; ++k) {
    if (!j.opaque[k]) continue;
    int64_t along = 0;
    for (int c = 0; c < 3; ++c) along += axis[c] * channel(j.block.texel[k], c);
    if (low == texels || along < least) { least = along; low = k; }
    if (high == texels || along > most) { most = along; high = k; }
  }
  end_points e{};
  for (int c = 0; c < 3 && low != texels; ++c) {
    e.a[size_t(c)] = narrowed(channel(j.block.texel[high], c), field_bits[c]);
    e.b[size_t(c)] = narrowed(channel(j.block.texel[low], c), field_bits[c]);
  }
  return e;
}

// End points that are best for the fit's indices: for each channel the normal equations of x = (w a + (6 - w) b) / 6.
end_points least_squares(const job& j, const colour_fit& fit) {
  const bool three = j.bc1 && fit.c0 <= fit.c1;
  constexpr int four_weights[4] = {6, 0, 4, 2}, three_weights[4] = {6, 0, 3, 0};
  int64_t aa = 0, ab = 0, bb = 0, ax[3] = {}, bx[3] = {};
  for (size_t k = 0; k < texels; ++k) {
    if (!j.opaque[k]) continue;
    const int w = (three ? three_weights : four_weights)[fit.index[k]], v = 6 - w;
    aa += w * w;
    ab += w * v;
    bb += v * v;
    for (int c = 0; c < 3; ++c) {
      ax[c] += w * channel(j.block.texel[k], c);
      bx[c] += v * channel(j.block.texel[k], c);
    }
  }
  const int64_t determinant = aa * bb - ab * ab;
  end_points e = ends_of(fit);
  if (determinant == 0) return e;
  for (int c = 0; c < 3; ++c) {
    const auto value = [&](int64_t x) { return int(std::clamp<int64_t>(6 * x / determinant, 0, 255)); };
    e.a[size_t(c)] = narrowed(value(bb * ax[c] - ab * bx[c]), field_bits[c]);
    e.b[size_t(c)] = narrowed(value(aa * bx[c] - ab * ax[c]), field_bits[c]);
  }
  return e;
}

// Steps of one in one field, or in the same field of both ends, while any helps.
void climb(const job& j, colour_mode mode, colour_fit& best) {
  constexpr int most_rounds = 16;
  for (int round = 0; round < most_rounds && best.error != 0; ++round) {
    const end_points here = ends_of(best);
    bool better = false;
    for (size_t c = 0; c < 3; ++c)
      for (const auto& [da, db] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, -1}, {1, -1}, {-1, 1}}) {
        end_points e = here;
        e.a[c] += da;
        e.b[c] += db;
        const int most = (1 << field_bits[c]) - 1;
        if (e.a[c] < 0 || e.b[c] < 0 || e.a[c] > most || e.b[c] > most) continue;
        const colour_fit fit = assigned(j, e, mode);
        if (fit.error < best.error) { best = fit; better = true; }
      }
    if (!better) return;
  }
}

colour_fit fitted(const job& j, colour_mode mode) {
  colour_fit best = assigned(j, extremes(j), mode);
  for (int round = 0; round < 4; ++round) {
    const colour_fit fit = assigned(j, least_squares(j, best), mode);
    if (fit.error >= best.error) break;
    best = fit;
  }
  climb(j, mode, best);
  return best;
}

void write_colours(const colour_fit& fit, uint8_t* out) {
  out[0] = uint8_t(fit.c0);
  out[1] = uint8_t(fit.c0 >> 8);
  out[2] = uint8_t(fit.c1);
  out[3] = uint8_t(fit.c1 >> 8);
  for (size_t y = 0; y < 4; ++y)
    out[4 + y] = uint8_t(fit.index[4 * y] | fit.index[4 * y + 1] << 2 | fit.index[4 * y + 2] << 4 | fit.index[4 * y + 3] << 6);
}

void encode_colours(const texel_block& block, bool bc1, uint8_t* out) {
  job j{block, {}, bc1};
  bool any_transparent = false;
  for (size_t k = 0; k < texels; ++k) {
    j.opaque[k] = !bc1 || block.texel[k].a >= 128;
    any_transparent = any_transparent || !j.opaque[k];
  }
  colour_fit best;
  if (bc1) best = fitted(j, colour_mode::three);
  if (!any_transparent) {
    const colour_fit four = fitted(j, colour_mode::four);
    if (four.error < best.error) best = four;
  }
  write_colours(best, out);
}

struct alpha_fit {
  int a0 = 0, a1 = 0;
  int64_t error = INT64_MAX;
  std::array<uint8_t, texels> index{};
};

alpha_fit assigned_alpha(const texel_block& block, int a0, int a1) {
  alpha_fit fit{a0, a1, 0, {}};
  uint8_t alpha[8]{};
  bc3_alphas(a0, a1, alpha);
  for (size_t k = 0; k < texels; ++k) {
    int64_t least = INT64_MAX;
    for (uint8_t n = 0; n < 8; ++n) {
      const int64_t d = alpha[n] - block.texel[k].a;
      if (d * d < least) { least = d * d; fit.index[k] = n; }
    }
    fit.error += least;
  }
  return fit;
}

// End points among the block's own values and a few steps inwards: eight values over the whole range, or six and 0 and 255.
alpha_fit fitted_alpha(const texel_block& block) {
  int low = 255, high = 0, inner_low = 255, inner_high = 0;
  for (const rgba8& c : block.texel) {
    low = std::min<int>(low, c.a);
    high = std::max<int>(high, c.a);
    if (c.a != 0) inner_low = std::min<int>(inner_low, c.a);
    if (c.a != 255) inner_high = std::max<int>(inner_high, c.a);
  }
  alpha_fit best;
  const auto consider = [&](int a0, int a1) {
    const alpha_fit fit = assigned_alpha(block, a0, a1);
    if (fit.error < best.error) best = fit;
  };
  constexpr int most_steps = 4;
  for (int up = 0; up <= most_steps; ++up)
    for (int down = 0; down <= most_steps; ++down) {
      if (high - down > low + up) consider(high - down, low + up);
      if (inner_low + up <= inner_high - down) consider(inner_low + up, inner_high - down);
    }
  consider(low, low);
  return best;
}

void write_alpha(const alpha_fit& fit, uint8_t* out) {
  out[0] = uint8_t(fit.a0);
  out[1] = uint8_t(fit.a1);
  uint64_t bits = 0;
  for (size_t k = 0; k < texels; ++k) bits |= uint64_t(fit.index[k]) << (3 * k);
  for (size_t k = 0; k < 6; ++k) out[2 + k] = uint8_t(bits >> (8 * k));
}

}  // namespace

void encode_bc_block(texel_format format, const texel_block& block, uint8_t* out) {
  if (format == texel_format::bc1) return encode_colours(block, true, out);
  encode_colours(block, false, out + 8);
  if (format == texel_format::bc3) return write_alpha(fitted_alpha(block), out);
  for (size_t k = 0; k < 8; ++k) {
    const auto level = [&](size_t n) { return int(spantex::detail::narrowed_colour(block.texel[n].a, 4)); };
    out[k] = uint8_t(level(2 * k) | level(2 * k + 1) << 4);
  }
}

}  // namespace spantex::sim::detail
