// SPDX-License-Identifier: Apache-2.0
// The same in linear light.
#define SPANTEX_LINEAR 1
#include "neon.cpp"
