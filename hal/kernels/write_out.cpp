// SPDX-License-Identifier: Apache-2.0
#include "write_out.hpp"

#include <string.h>

namespace spantex::kernels {
namespace {

constexpr int at_once = 4;  // pixels
constexpr bool is_little_endian = __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__;
using bytes = uint8_t __attribute__((vector_size(16)));
using colours = uint32_t __attribute__((vector_size(16)));   // of a pixel each
using channels = uint16_t __attribute__((vector_size(16)));  // of two pixels
using pairs = uint64_t __attribute__((vector_size(16)));

struct widened_pixels { channels first, second; };

inline bytes load(const rgba8* from) {
  bytes b;
  memcpy(&b, from, sizeof b);
  return b;
}

inline widened_pixels widened(bytes b) {
  constexpr bytes zero{};
  const bytes low = is_little_endian ? b : zero, high = is_little_endian ? zero : b;
  return {channels(__builtin_shufflevector(low, high, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23)),
          channels(__builtin_shufflevector(low, high, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31))};
}
inline bytes narrowed(const widened_pixels& q) {
  constexpr int low = is_little_endian ? 0 : 1;
  return __builtin_shufflevector(bytes(q.first), bytes(q.second), low, low + 2, low + 4, low + 6, low + 8, low + 10, low + 12, low + 14, low + 16, low + 18, low + 20, low + 22, low + 24,
                                 low + 26, low + 28, low + 30);
}

// over_255() of 16 bits: what products and blends of bytes come to, and what it adds, stay below 2^16.
inline channels over_255(channels x) {
  x += 128;
  return (x + (x >> 8)) >> 8;
}

inline channels alphas(channels c) { return __builtin_shufflevector(c, c, 3, 3, 3, 3, 7, 7, 7, 7); }

inline channels mixed(channels s, channels d) {
  constexpr channels full = {0, 0, 0, 255, 0, 0, 0, 255};
  const channels a = alphas(s);
  return over_255((s | full) * a + d * (255 - a));
}
inline channels mixed_premultiplied(channels s, channels d) {
  const channels sum = s + over_255(d * (255 - alphas(s)));
  const channels most = channels{} + 255;
  return sum < most ? sum : most;
}

// What becomes of four pixels; those that are not `wanted` stay, and of the others which were written.
template <alpha_mode Alpha>
inline uint32_t write_four(const rgba8* from, rgba8* to, uint32_t wanted, uint32_t threshold, bool modulates, channels colour) {
  bytes s = load(from);
  if (modulates) {
    const widened_pixels q = widened(s);
    s = narrowed({over_255(q.first * colour), over_255(q.second * colour)});
  }
  constexpr colours pixel = {1, 2, 4, 8};
  auto taken = (wanted & pixel) == pixel;
  if constexpr (Alpha == alpha_mode::cut_out || Alpha == alpha_mode::blended) taken &= (colours(s) >> (is_little_endian ? 24 : 0) & 255) >= threshold;
  const bytes there = load(to);
  bytes out = s;
  if constexpr (Alpha == alpha_mode::blended || Alpha == alpha_mode::premultiplied) {
    const widened_pixels over = widened(s), under = widened(there);
    if constexpr (Alpha == alpha_mode::blended) out = narrowed({mixed(over.first, under.first), mixed(over.second, under.second)});
    else out = narrowed({mixed_premultiplied(over.first, under.first), mixed_premultiplied(over.second, under.second)});
  }
  out = (out & bytes(taken)) | (there & ~bytes(taken));
  memcpy(to, &out, sizeof out);
  const pairs bits = pairs(colours(taken) & pixel);
  const uint64_t all = bits[0] | bits[1];
  return uint32_t(all | all >> 32);
}

// Of a span that lies in the frame; which pixels were written.
template <alpha_mode Alpha>
span_mask write_span(const rgba8* from, int32_t from_stride, rgba8* to, int32_t to_stride, span_mask mask, const shading::job& shade) {
  const uint32_t threshold = Alpha == alpha_mode::cut_out ? shade.threshold : 1;
  const rgba8 c = shade.colours.flat;
  const channels colour = {c.r, c.g, c.b, c.a, c.r, c.g, c.b, c.a};
  span_mask written = 0;
  for (int k = 0; k < span_side * span_side; k += at_once) {
    const auto wanted = uint32_t(mask >> k & 15);
    if (wanted == 0) continue;
    const int i = k % span_side, j = k / span_side;
    written |= span_mask(write_four<Alpha>(from + j * from_stride + i, to + int64_t(j) * to_stride + i, wanted, threshold, shade.modulates, colour)) << k;
  }
  return written;
}

span_mask write_span_as(const rgba8* from, int32_t from_stride, rgba8* to, int32_t to_stride, span_mask mask, const shading::job& shade) {
  switch (shade.alpha) {
    case alpha_mode::opaque: return write_span<alpha_mode::opaque>(from, from_stride, to, to_stride, mask, shade);
    case alpha_mode::cut_out: return write_span<alpha_mode::cut_out>(from, from_stride, to, to_stride, mask, shade);
    case alpha_mode::blended: return write_span<alpha_mode::blended>(from, from_stride, to, to_stride, mask, shade);
    case alpha_mode::premultiplied: return write_span<alpha_mode::premultiplied>(from, from_stride, to, to_stride, mask, shade);
  }
  return 0;
}

}  // namespace

row_work row_write_out::aside(row_work work) {
  work.pixels = row_;
  work.stride = stride;
  return work;
}

void row_write_out::write(const row_work& drawn, draw_counters& counts) const {
  const bool by_pixel = shade_.modulates && shade_.colours.varies;
  for (int k = 0; k < drawn.count; ++k) {
    const span_mask mask = drawn.masks[k];
    if (mask == 0 || drawn.left[k]) continue;
    const int32_t x0 = (drawn.sx + k) * span_side, y0 = drawn.sy * span_side;
    const rgba8* const from = row_ + x0;
    rgba8* const to = frame_.pixels + int64_t(y0) * frame_.stride + x0;
    const auto each_of = [&](span_mask pixels, auto&& each) {  // each(k, column, row in the span, index of its depth)
      for (; pixels != 0; pixels &= pixels - 1) {
        const int at = __builtin_ctzll(pixels), i = at % span_side, j = at / span_side;
        each(at, i, j, (y0 + j) * frame_.width + x0 + i);
      }
    };
    span_mask written = 0;
    if (by_pixel || x0 + span_side > frame_.width) {
      each_of(mask, [&](int at, int i, int j, int32_t depth_index) {
        const write_result result = shade_.write(from[j * stride + i], x0 + i, y0 + j, to[int64_t(j) * frame_.stride + i], depth_index);
        written |= span_mask(result != write_result::left) << at;
      });
    } else {
      written = write_span_as(from, stride, to, frame_.stride, mask, shade_);
      if (shade_.stores_depth()) each_of(written, [&](int, int i, int j, int32_t depth_index) { shade_.store_depth(x0 + i, y0 + j, depth_index); });
    }
    const auto count = uint64_t(__builtin_popcountll(written));
    counts.pixels_left += uint64_t(__builtin_popcountll(mask)) - count;
    if (shade_.alpha == alpha_mode::blended || shade_.alpha == alpha_mode::premultiplied) counts.pixels_blended += count;
  }
}

}  // namespace spantex::kernels
