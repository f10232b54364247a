// SPDX-License-Identifier: Apache-2.0
// The direct backend: the datapath itself, in the caller's memory. Inlines away; pixels are computed when they are taken.
#pragma once
#include <stdint.h>

#include <hal/engine.hpp>
#include <spantex/datapath.hpp>
#include <spantex/local_memory.hpp>
#include <spantex/profile.hpp>

namespace spantex {

// Fine: side of local memory; the profile's fine_side for a fixed profile.
template <class Prof, int Fine = Prof::max_fine_side>
class direct_engine {
 public:
  using memory = local_memory<Fine>;

  constexpr explicit direct_engine(const Prof& prof = {}) : prof_(prof) {}

  constexpr status load_coefficients(half h, const span_coefficients& c) {
    one_half& x = halves_[int(h)];
    SPANTEX_TRY(x.life.may_load());
    x.coefficients = c;
    x.life.coefficients_loaded();
    return status::ok;
  }
  constexpr status load_words(half h, int first, const uint64_t* words, int count) {
    one_half& x = halves_[int(h)];
    SPANTEX_TRY(x.life.may_load());
    return x.texels.load(first, words, count);
  }
  constexpr status start(half h, span_mask mask) {
    one_half& x = halves_[int(h)];
    SPANTEX_TRY(x.life.start());
    x.mask = mask;
    return status::ok;
  }
  constexpr status take(half h, span_pixels& out) {
    one_half& x = halves_[int(h)];
    SPANTEX_TRY(x.life.take());
    compute_span(prof_, x.coefficients, x.mask, x.texels, out, no_observer{});
    return status::ok;
  }
  constexpr void mark(event) {}

 private:
  struct one_half {
    span_coefficients coefficients{};
    span_mask mask = 0;
    memory texels{};
    half_life life{};
  };
  [[no_unique_address]] Prof prof_;
  one_half halves_[half_count];
};

static_assert(span_engine<direct_engine<fixed_profile<profiles::exact>>>);
static_assert(local_memory<8>::bits == 2560, "VR11: one copy of local texture memory is 2560 bits");
static_assert(sizeof(direct_engine<fixed_profile<profiles::seed>>) <= 1024, "seed: both copies within 1 KiB");

}  // namespace spantex
