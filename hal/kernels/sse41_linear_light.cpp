// SPDX-License-Identifier: Apache-2.0
// sse41.cpp, in linear light.
#define SPANTEX_LINEAR 1
#include "sse41.cpp"
