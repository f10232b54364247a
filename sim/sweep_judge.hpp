// SPDX-License-Identifier: Apache-2.0
// Judges one point of a sweep.
//
// Two yardsticks. The *reference* is the supersampled picture: what the method is worth. The *twin* is the same method (filter, level formula, bias, samples,
// prefilter, format) with the longest words, an exact divide, levels a pixel and sections that hold everything: what the word lengths and policies cost.
// All sums run in a fixed order in double; columns are printed rounded, so that they are the same on every machine.
#pragma once
#include "image.hpp"
#include "sweep_point.hpp"
#include "sweep_subjects.hpp"

namespace spantex::sim {

sweep_result judge(const sweep_point& p, const measure_groups& wanted, sweep_subjects& subjects);

// Frame 0 as it is judged.
image picture_of(const sweep_point& p, sweep_subjects& subjects);

// Of both halves: texels, and coefficients at the profile's word lengths.
int memory_bits(const profile& p);
// Fraction bits of coordinates, 1/w, levels and weights, magnitude of numerators, bits kept between levels: the words of one pixel.
int word_bits(const profile& p);

}  // namespace spantex::sim
