// SPDX-License-Identifier: Apache-2.0
// Numbers for vector kernels to read from memory, which is a load, or part of the operation: g++ moves a constant that it knows through a general register, which takes
// a shuffle or two. So they are not const, though nobody changes them.
#pragma once
#include <stdint.h>

namespace spantex::kernels {

template <int32_t X> alignas(32) int32_t number32[8] = {X, X, X, X, X, X, X, X};
template <int64_t X> int64_t number64 = X;
template <int32_t U, int32_t V> alignas(64) int32_t number_of_axes[16] = {U, U, U, U, U, U, U, U, V, V, V, V, V, V, V, V};

}  // namespace spantex::kernels
