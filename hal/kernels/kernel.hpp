// SPDX-License-Identifier: Apache-2.0
// Host kernels: whole rows of spans of a plane at once, profile default (aniso: with any max_samples; `pixels`: draws()), the same bytes as the scalar datapath (docs/SPEC.md). A kernel draws the
// spans it is made for and says which it left; rows.hpp draws those pixel by pixel (by_pixel.hpp).
#pragma once
#include <stdint.h>
#include <string.h>

#include <new>
#include <type_traits>

#include <spantex/draw.hpp>
#include <spantex/plane.hpp>
#include "planar_map.hpp"

namespace spantex::kernels {

inline constexpr int max_row_spans = 512;  // max_screen_side

struct upright_row;

// What a kernel finds of a plane in the first of its rows and keeps for the others; of one type at a time.
class row_memory {
 public:
  // Null where make(T&), asked once, says no.
  template <class T, class Make>
  const T* kept(Make make) {
    static_assert(sizeof(T) <= sizeof bytes_ && alignof(T) <= alignment && std::is_trivially_destructible_v<T>);
    if (of_ != &name_of<T>) {
      of_ = &name_of<T>;
      made_ = make(*new (bytes_) T);
    }
    return made_ ? reinterpret_cast<const T*>(bytes_) : nullptr;
  }

 private:
  template <class T> static constexpr char name_of = 0;  // its address
  static constexpr size_t alignment = 64;
  const char* of_ = nullptr;
  bool made_ = false;
  alignas(alignment) unsigned char bytes_[2560];
};

struct row_work {
  const plane* map;
  const planar_map* texels;
  filter kind;
  int32_t last_level;      // of the map
  int32_t sx, sy;          // the first span
  int count;               // 1 to max_row_spans, side by side
  const span_mask* masks;  // count of them; zero: nothing to draw
  rgba8* pixels;           // the first one of row span_side sy, from x = 0 on
  int32_t stride;
  bool* left;              // count of them, false: the kernel sets those of spans that it did not draw
  int32_t most_ratio = 4 << 16;    // log2_16(max_samples): of the axes of rows of samples (aniso)
  row_memory* memory = nullptr;    // of all rows that are drawn of the plane, one after another
  bool by_pixel = false;           // of spans that were left, masks are of pixels in front of the viewer and `left` is set: the kernel draws those that it can pixel by pixel, and clears theirs
  upright_row* upright = nullptr;  // what is known of the whole row (upright.hpp): then the kernel draws all of them and sets none of `left`
};

// The first of the spans [at, end) that is left; null: none.
inline bool* next_left(bool* at, bool* end) { return static_cast<bool*>(memchr(at, true, size_t(end - at))); }

using row_kernel = void (*)(const row_work&);

enum class choice : uint8_t { fastest, scalar, pixels, words, sse41, avx2, neon, avx512, avx512_gathers };

inline constexpr int32_t longest_row = 2048;  // texels of level 0 along a row of samples (aniso) that kernels draw

// No position saturates: offsets are below 2^max_extent_log2 texels before they are divided by w > 1/2, samples within half a row of them.
constexpr int32_t largest_base(filter kind) { return 32767 - (2 << max_extent_log2) - 2 - (kind == filter::aniso ? longest_row / 2 : 0); }

// Whether texels are decoded before they are filtered: sRGB maps' that are blended.
inline bool in_linear_light(const planar_map& texels, filter kind) { return texels.levels_in_rows().linear_light() && kind != filter::nearest; }

// One machine's kernels by filter. Of colours as coded, and in linear light, which nearest has no use for. `work` has a filter that draws().
struct row_kernels { row_kernel nearest, bilinear, mip_bilinear, trilinear, aniso; };
void draw_by_filter(const row_kernels& coded, const row_kernels& linear_light, const row_work& work);

// Null where this machine has not what it takes.
row_kernel avx512_loads_kernel();    // AVX-512 F, BW, CD, DQ, VL, VBMI, VBMI2, VNNI; what local memory does not hold is loaded texel by texel
row_kernel avx512_gathers_kernel();  // the same, gathered
bool gathers_are_fast();             // on this processor
row_kernel avx2_kernel();    // AVX2, BMI, BMI2, LZCNT
row_kernel sse41_kernel();   // SSE4.1
row_kernel neon_kernel();    // arm64
row_kernel words_kernel();   // anything

// What `fastest` is on this machine by the numbers of profile default; any other choice itself.
choice resolved(choice c);
// By any numbers: `scalar` where nothing else draws by them.
choice resolved(choice c, const profile& numbers);

// Whether it draws by these numbers: `pixels` see draws_by_pixel(); the others, but for `scalar`, by those of profile default with any max_samples.
bool draws(choice c, const profile& numbers);

// Null: the scalar engine draws everything, chosen or for want of what the choice takes.
row_kernel kernel_of(choice c);

// How maps must be made ready for it.
layout layout_of(choice c);

// What kernels are made for.
bool draws(filter f);

}  // namespace spantex::kernels
