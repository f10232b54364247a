// SPDX-License-Identifier: Apache-2.0
// expects: constraints not satisfied
// An engine that cannot deliver pixels is no span_engine.
#include <spantex/draw.hpp>

namespace {
using namespace spantex;
struct mute_engine {
  status load_coefficients(half, const span_coefficients&) { return status::ok; }
  status load_words(half, int, const uint64_t*, int) { return status::ok; }
  status start(half, span_mask) { return status::ok; }
  void mark(event) {}
};
}  // namespace
using refused = spantex::renderer<mute_engine, spantex::fixed_profile<spantex::profiles::exact>>;
refused* never = nullptr;
