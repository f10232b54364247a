// SPDX-License-Identifier: Apache-2.0
#include "kernel.hpp"

#include "by_pixel.hpp"

namespace spantex::kernels {

void draw_by_filter(const row_kernels& coded, const row_kernels& linear_light, const row_work& work) {
  const row_kernels& kernels = in_linear_light(*work.texels, work.kind) ? linear_light : coded;
  switch (work.kind) {
    case filter::nearest: return kernels.nearest(work);
    case filter::bilinear: return kernels.bilinear(work);
    case filter::mip_bilinear: return kernels.mip_bilinear(work);
    case filter::trilinear: return kernels.trilinear(work);
    default: return kernels.aniso(work);
  }
}

choice resolved(choice c) {
  if (c != choice::fastest) return c;
  if (gathers_are_fast() && avx512_gathers_kernel() != nullptr) return choice::avx512_gathers;
  for (const choice one : {choice::avx512, choice::avx2, choice::sse41, choice::neon})
    if (kernel_of(one) != nullptr) return one;
  return choice::words;
}

bool draws(choice c, const profile& numbers) {
  if (c == choice::pixels) return draws_by_pixel(numbers);
  profile by = profiles::standard;
  by.max_samples = numbers.max_samples;
  return c != choice::scalar && numbers == by;
}

choice resolved(choice c, const profile& numbers) {
  if (c != choice::fastest || draws(c, numbers)) return resolved(c);
  return draws(choice::pixels, numbers) ? choice::pixels : choice::scalar;
}

row_kernel kernel_of(choice c) {
  switch (resolved(c)) {
    case choice::pixels: return leave_to_pixels;
    case choice::words: return words_kernel();
    case choice::sse41: return sse41_kernel();
    case choice::avx2: return avx2_kernel();
    case choice::neon: return neon_kernel();
    case choice::avx512: return avx512_loads_kernel();
    case choice::avx512_gathers: return avx512_gathers_kernel();
    case choice::fastest:
    case choice::scalar: break;
  }
  return nullptr;
}

bool draws(filter f) {
  return f == filter::nearest || f == filter::bilinear || f == filter::mip_bilinear || f == filter::trilinear || f == filter::aniso;
}

layout layout_of(choice c) {
  switch (resolved(c)) {
    case choice::avx512:
    case choice::avx512_gathers: return layout::rows_and_blocks;
    case choice::neon: return layout::rows_and_planes;
    default: return layout::rows;
  }
}

}  // namespace spantex::kernels
