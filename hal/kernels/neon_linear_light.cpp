// SPDX-License-Identifier: Apache-2.0
// neon.cpp, in linear light.
#define SPANTEX_LINEAR 1
#include "neon.cpp"
