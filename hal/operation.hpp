// SPDX-License-Identifier: Apache-2.0
// Names of the HAL's operations, for what counts, logs or reports them.
#pragma once
#include <stdint.h>

namespace spantex {

enum class operation : uint8_t { load_coefficients, load_words, start, take, mark };

constexpr const char* to_string(operation o) {
  switch (o) {
    case operation::load_coefficients: return "load_coefficients";
    case operation::load_words: return "load_words";
    case operation::start: return "start";
    case operation::take: return "take";
    case operation::mark: return "mark";
  }
  return "unknown operation";
}

}  // namespace spantex
