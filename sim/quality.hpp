// SPDX-License-Identifier: Apache-2.0
// How far two pictures are apart. Colour only; alpha enters neither PSNR nor SSIM.
//   PSNR  10 log10(255^2 / mean squared difference over r, g, b), dB; infinite for equal pictures
//   SSIM  Wang et al. 2004 on BT.601 luma: Gaussian window, sigma 1.5, 11x11, K1 = 0.01, K2 = 0.03, mean over all pixels; at a
//         picture's edge the window is cut and renormalised
#pragma once
#include <stdint.h>

#include "image.hpp"
#include "reference.hpp"

namespace spantex::sim {

double psnr_db(const image& a, const ideal_image& b);
double psnr_db(const image& a, const image& b);
double flat_psnr_db(const ideal_image& reference);         // of a picture of its mean colour alone, which the right picture must beat: turned over or shifted it would not
double worst_error(const image& a, const ideal_image& b);  // of one colour channel
image rounded(const ideal_image& a);                       // to nearest
double ssim(const image& a, const image& b);

struct difference {
  int worst = 0;               // of one channel, alpha included
  uint64_t differing_px = 0;   // pixels with any difference
};
difference compare(const image& a, const image& b);

// |a - b| per colour channel, opaque.
image difference_picture(const image& a, const image& b);

}  // namespace spantex::sim
