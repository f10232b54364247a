// SPDX-License-Identifier: Apache-2.0
// Conformance of a picture, in the manner of the Khronos texture look-up verifier: around the exact position and level of every pixel
// lies an interval that the promised bits allow; a pixel is accepted only if some position, weights and level in it produce all four
// channels at once, within the colour threshold. Judges pixels, knows nothing of how they were computed.
#pragma once
#include <cstdint>

#include <spantex/plane.hpp>
#include <spantex/profile.hpp>
#include <spantex/span.hpp>
#include <spantex/texture.hpp>

namespace spantex::sim {

struct promised_precision {
  int subtexel_bits = 8;     // a position may be off by 2^-subtexel_bits texel of the level it is used on
  int level_bits = 8;        // a level of detail may be off by 2^-level_bits
  double colour_lsb = 1;     // a channel may be off by this many units of 1/255
};

struct verdict {
  uint64_t pixels = 0, failures = 0;
  int first_x = -1, first_y = -1;  // of the first failure
};

// Pixels of the plane with W > 0 and |u|, |v| < 2^15 inside a width x height picture. Of the profile only the biases of the level count.
verdict verify_plane(const plane& map, const texture_view& texture, filter kind, const profile& biases, const promised_precision& bits,
                     const rgba8* picture, int width_px, int height_px);

// The same for aniso: a row of trilinear samples along the image of the direction, of 32 on the screen, that is nearest to the major axis at the
// middle of the pixel's span or at the pixel; their number and level by docs/SPEC.md section 11 from the exact vector and area, the level
// of detail and the logarithm of the axes' ratio each within level_bits. Samples are judged one by one: the pixel must lie, channel by
// channel, between the means of the least and of the largest that each may be.
verdict verify_aniso(const plane& map, const texture_view& texture, const profile& samples, const promised_precision& bits, const rgba8* picture,
                     int width_px, int height_px);

}  // namespace spantex::sim
