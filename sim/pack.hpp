// SPDX-License-Identifier: Apache-2.0
// The map compiler: a picture to a texture pack (spantex/pack.hpp, docs/TEXTURES.md). Integers only: the same bytes on every machine.
#pragma once
#include <stdint.h>
#include <string.h>

#include <string>
#include <vector>

#include <spantex/contour_style.hpp>
#include <spantex/pack.hpp>
#include "encode.hpp"
#include "file.hpp"
#include "image.hpp"
#include "prefilter.hpp"

namespace spantex::sim {

struct compile_options {
  texel_format format = texel_format::rgba8888;
  prefilter levels = prefilter::box;
  wrap wrap_u = wrap::repeat, wrap_v = wrap::repeat;
  alpha_weighting alpha = alpha_weighting::independent;
  bool inverse = false;
  uint8_t alpha_threshold = 0;  // of an alpha test whose coverage the levels keep; 0: none
  int level_count = 0;          // 0: all
  bool srgb = false;            // colours are sRGB codes: averaged in linear light, and the pack says so
  pack_format::byte_order order = pack_format::native_order;  // of 16-bit texels
  int threads = 1;
  progress_callback parts_done;  // compile_pack
};

inline constexpr int all_levels(int width, int height) { return bit_length(uint64_t(max_of(width, height))); }

// The palette of all levels, made from level 0 as texture_map does; empty for formats without one. With an alpha test the texels on either
// side of the threshold have colours of their own, as many as their share, at least one, so every texel finds one on its side, unless level 0 lies wholly on the other.
palette compile_palette(const image& level0, const compile_options& options);

// The levels before they are put into a format. The inverse filter sharpens each from the unsharpened chain; level 0 stays, but for
// alphas that the format would move across the threshold. They are settled:
//   uncompressed  at the nearest alpha that the format keeps on its own side
//   palette       at the palette's nearest colour on its own side
//   compressed    blocks with such a texel: all alphas are pushed away from the threshold by the least of 1, 2, 4 .. 128, 255 that helps
std::vector<image> compile_levels(const image& level0, const compile_options& options);

bytes compile_pack(const image& level0, const compile_options& options);

// A contour map from its levels (distance_field.hpp), which stay as they are: of the options the format, wraps, byte order and threads count.
bytes compile_contour_pack(const std::vector<image>& levels, const contour_style& style, const compile_options& options);
int compile_parts(const image& level0, const compile_options& options);  // how many parts_done is told of

// The share of texels with alpha >= threshold is brought as near to kept / texels as whole alphas allow: with t the alpha that so many texels
// reach, alpha becomes floor(alpha threshold / t), at most 255, so that alpha >= t exactly where the new one is >= threshold.
struct alpha_coverage { int64_t kept, texels; };
alpha_coverage coverage_of(const image& level, uint8_t threshold);
void keep_coverage(image& level, uint8_t threshold, const alpha_coverage& wanted);

inline bool is_pack(const uint8_t* data, size_t size) { return size >= sizeof pack_format::magic && memcmp(data, pack_format::magic, sizeof pack_format::magic) == 0; }

// A C99 (and C++) source with the pack: `static const` in a header, external names in a source. Names NAME and NAME_bytes.
enum class c_linkage : uint8_t { internal, external };
std::string c_array(const bytes& pack, const std::string& name, c_linkage linkage);

// A C and C++ identifier from a file's name: brick-2.stx gives brick_2, 2.c map_2, int.c map_int.
std::string identifier_of(const std::string& path);

}  // namespace spantex::sim
