// SPDX-License-Identifier: Apache-2.0
// expects: constraints not satisfied
// Every operation reports a status.
#include <spantex/draw.hpp>

namespace {
using namespace spantex;
struct silent_engine {
  void load_coefficients(half, const span_coefficients&) {}
  status load_words(half, int, const uint64_t*, int) { return status::ok; }
  status start(half, span_mask) { return status::ok; }
  status take(half, span_pixels&) { return status::ok; }
  void mark(event) {}
};
}  // namespace
using refused = spantex::renderer<silent_engine, spantex::fixed_profile<spantex::profiles::exact>>;
refused* never = nullptr;
