// SPDX-License-Identifier: Apache-2.0
// AVX-512: spans that local memory does not hold, from the map's rows. Their texels are gathered, or loaded one by one: which takes less time is a matter of the
// processor (docs/TRIED.md), the bytes are the same.
#pragma once
#include "kernel.hpp"

namespace spantex::kernels {

struct row_reader {
  row_kernel any_row;
  bool (*planned_aniso)(const row_work& work, int k, const span_coefficients& c);  // the row's span k; false where it was not drawn
};
row_reader gathering_reader();
row_reader loading_reader();
row_reader linear_light_reader();  // loads them

}  // namespace spantex::kernels
