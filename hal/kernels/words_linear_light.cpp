// SPDX-License-Identifier: Apache-2.0
// words.cpp, in linear light.
#define SPANTEX_LINEAR 1
#include "words.cpp"
