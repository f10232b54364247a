// SPDX-License-Identifier: Apache-2.0
// Kernels: what becomes of a level's colours. Included by the machines' files alone.
#pragma once

enum class rounded { at_once, after_level, between_levels, as_sample };  // the last: between levels too, of a row of one sample
