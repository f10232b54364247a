// SPDX-License-Identifier: Apache-2.0
// JSON with line numbers: the parser is nlohmann's, read through an iterator that counts lines, so that a specification is refused with file, line and reason.
#pragma once
#include <stdint.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace spantex::tool {

struct spec_node {
  enum class kind : uint8_t { nothing, truth, integer, real, text, list, object };
  kind what = kind::nothing;
  int line = 0;
  bool truth = false;
  int64_t integer = 0;
  double real = 0;
  std::string text{};
  std::vector<spec_node> items{};                          // list
  std::vector<std::pair<std::string, spec_node>> members{};  // object, in the file's order; names differ

  const spec_node* find(const std::string& name) const;
};

// One document. Throws sim::input_error "file:line: reason": syntax, a name twice, nothing but comments, brackets deeper than 64.
spec_node parse_spec(const std::string& file, const std::string& text);

// Throws sim::input_error "file:line: reason".
[[noreturn]] void refuse(const std::string& file, const spec_node& at, const std::string& reason);

}  // namespace spantex::tool
