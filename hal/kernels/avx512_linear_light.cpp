// SPDX-License-Identifier: Apache-2.0
// AVX-512 in linear light: rows of spans from local memory.
#include "linear_light.hpp"

#if defined(__x86_64__)
#include "avx512/by_blocks.hpp"

namespace spantex::kernels {
namespace {

template <filter Kind>
void draw_row(const row_work& work) {
  if (work.by_pixel) return linear_light_reader().any_row(work);
  constexpr colours_as light = uses_footprint(Kind) ? colours_as::samples_in_light : colours_as::light;
  plans_of_left<Kind> left;
  if (work.texels->opaque()) draw_batches<Kind, texel_kind{3, light}>(work, left);
  else draw_batches<Kind, texel_kind{4, light}>(work, left);
  draw_left<Kind>(work, left, linear_light_reader());
}

}  // namespace

constinit const row_kernels avx512_linear_light{nullptr, draw_row<filter::bilinear>, draw_row<filter::mip_bilinear>, draw_row<filter::trilinear>, draw_row<filter::aniso>};
}  // namespace spantex::kernels

#include "targets/end.hpp"
#endif
