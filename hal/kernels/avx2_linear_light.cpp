// SPDX-License-Identifier: Apache-2.0
// avx2.cpp, in linear light.
#define SPANTEX_LINEAR 1
#include "avx2.cpp"
