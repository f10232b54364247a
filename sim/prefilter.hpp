// SPDX-License-Identifier: Apache-2.0
// The next level of a map from the finer one: a weighted mean along u and along v. Weights are integers with an exact sum; the mean is an
// exact integer over that sum, rounded once per level, to nearest, halves to even (halves up would brighten a 2x2 mean by an eighth of a
// step a level), and clamped to 0..255. No floating point: the same bytes on every machine, with any number of threads.
//
//   box       a texel is the mean of the part of the finer level that it covers: 2x2 for even sides; for an odd side 2m+1 three
//             texels with weights m-i, m, i+1 over 2m+1 (the box moves through its phases), so a level covers the whole map
//   triangle  KT88: filtered with [1 2 1] x [1 2 1] / 16, then halved. Halving takes the same means as box (for even sides together
//             [1 3 3 1] / 8): taking every other texel instead would move the map by half a texel a level
//   kaiser    sinc(t) I0(4 sqrt(1 - (t/3)^2)), t in texels of the coarser level, |t| < 3
//   lanczos   sinc(t) sinc(t/3), |t| < 3
//
// The last two are evaluated in integers (window.hpp) and scaled to the largest sum up to 2^16 that lets the first moment about the coarse
// texel's centre be exactly zero too: a constant stays, and a ramp stays where it is, at every size. Neighbours beyond the map's edge are
// read through the wrap mode, so a repeating map stays seamless on every level.
#pragma once
#include <stdint.h>

#include <vector>

#include <spantex/srgb.hpp>
#include <spantex/wrap.hpp>
#include "image.hpp"
#include "parallel.hpp"

namespace spantex::sim {

enum class prefilter : uint8_t { box, triangle, kaiser, lanczos };

// The texels first, first + 1, ... of the finer level (not wrapped) that make up one texel of the coarser one, along one axis.
struct taps {
  int32_t first = 0;
  std::vector<int32_t> weight;
};

struct axis_filter {
  int32_t fine = 1, coarse = 1;  // sides
  std::vector<taps> outputs;     // one per coarse texel
  int64_t weight_sum = 1;        // of every output
};

// size in [1, 4096].
axis_filter make_axis_filter(int32_t size, prefilter kind);

// Distance of the centre of fine texel k from that of coarse texel i: in units of 1 / (2 fine) coarse texel, exact.
constexpr int64_t centre_distance(int32_t k, int32_t i, int32_t fine, int32_t coarse) {
  return int64_t(2 * k + 1) * coarse - int64_t(2 * i + 1) * fine;
}

// How transparent texels count.
enum class alpha_weighting : uint8_t {
  independent,  // four channels, each by itself
  weighted,     // colours are multiplied by alpha, filtered, divided by the filtered alpha: colours of transparent texels do not bleed.
                // Where the coarse alpha is 0 the colour is that of the opaque texels under the kernel's magnitudes
};

// srgb: colours are averaged in linear light, 16 bits, and become codes again by the engine's own rule (spantex/srgb.hpp).
image halved(const image& fine, prefilter kind, wrap u, wrap v, alpha_weighting alpha = alpha_weighting::independent, int threads = 1,
             colour_space colours = colour_space::coded);

// A sum of colours in the units that they are averaged in over `total`, as a code.
uint8_t colour_mean(int64_t x, int64_t total, colour_space colours);

// x / total to nearest, halves to even, clamped to 0..most; total > 0.
int64_t mean_up_to(int64_t most, int64_t x, int64_t total);
uint8_t mean(int64_t x, int64_t total);  // 0..255

// A colour's code in the units that it is averaged in: itself, or 16 bits of linear light.
constexpr int64_t averaged(uint8_t code, colour_space colours) { return colours == colour_space::srgb ? srgb_decoded(code) : code; }

}  // namespace spantex::sim
