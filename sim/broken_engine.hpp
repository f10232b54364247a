// SPDX-License-Identifier: Apache-2.0
// An engine with one thing wrong: what a device under test may do, to show that the bench names it. Otherwise the direct engine, bit for bit.
#pragma once
#include <stdint.h>

#include <functional>

#include <hal/direct_engine.hpp>

namespace spantex::sim {

enum class broken_part : uint8_t {
  none,
  answers,      // a started half says that it was not
  fetch,        // two banks of the finer level exchanged where a 2x2 starts at odd coordinates
  filter,       // the weights of the two axes exchanged
  write_out,    // colours cut instead of rounded
  coordinates,  // half a texel off where w changes
  level,        // a tenth of a level too coarse
  coarse_fetch, // a bit of the coarser level's words always 0
  footprint,    // rows of samples half as long
  memory_cell,  // one pixel wrong, once
};
namespace detail {

// Local memory whose fetches come back wrong.
template <class Memory>
struct broken_fetches {
  static constexpr int fine_side = Memory::fine_side, coarse_side = Memory::coarse_side;
  const Memory& inner;
  broken_part part;

  static fetched exchanged(fetched f, int a, int b) {
    const uint64_t differing = ((f.word >> (8 * a)) ^ (f.word >> (8 * b))) & 0xFF;
    return {f.word ^ differing << (8 * a) ^ differing << (8 * b)};
  }
  template <class Observer>
  fetched fetch(int channel, local_position fine, local_position coarse, const Observer& o) const {
    const fetched f = inner.fetch(channel, fine, coarse, o);
    if (part == broken_part::fetch && (fine.x & fine.y & 1) != 0) return exchanged(f, 0, 3);
    if (part == broken_part::filter) return exchanged(f, 1, 2);  // the texels that the two weights tell apart
    if (part == broken_part::coarse_fetch) return {f.word & ~(uint64_t(0x40) << 32)};
    return f;
  }
};

}  // namespace detail

// Broken from take `from` on, counted from 0.
template <class Prof>
class broken_engine {
 public:
  using memory = local_memory<Prof::max_fine_side>;

  explicit broken_engine(broken_part part = broken_part::none, uint64_t from = 0) : part_(part), from_(from) {}
  void break_at(broken_part part, uint64_t from = 0) { part_ = part, from_ = from; }

  status load_coefficients(half h, const span_coefficients& c) {
    SPANTEX_TRY(sound_.load_coefficients(h, c));
    halves_[int(h)].coefficients = c;
    return status::ok;
  }
  status load_words(half h, int first, const uint64_t* words, int count) {
    SPANTEX_TRY(sound_.load_words(h, first, words, count));
    return halves_[int(h)].texels.load(first, words, count);
  }
  status start(half h, span_mask mask) {
    SPANTEX_TRY(sound_.start(h, mask));
    halves_[int(h)].mask = mask;
    return status::ok;
  }
  status take(half h, span_pixels& out) {
    SPANTEX_TRY(sound_.take(h, out));
    const bool first = takes_ == from_;
    if (takes_++ < from_ || part_ == broken_part::none) return status::ok;
    if (part_ == broken_part::answers) return status::half_not_started;
    if (part_ != broken_part::memory_cell) compute(halves_[int(h)], out);
    else if (const span_mask mask = halves_[int(h)].mask; first && mask != 0) out.pixel[__builtin_ctzll(mask)].g ^= 4;
    return status::ok;
  }
  void mark(event) {}

 private:
  struct one_half {
    span_coefficients coefficients{};
    span_mask mask = 0;
    memory texels{};
  };

  void compute(const one_half& x, span_pixels& out) const {
    run_time_profile p{Prof::value};
    if (part_ == broken_part::write_out) p.value.colour_rounding = rounding::floor;
    const detail::broken_fetches<memory> texels{x.texels, part_};
    compute_span(p, changed(x.coefficients), x.mask, texels, out, no_observer{});
  }
  span_coefficients changed(span_coefficients c) const {
    if (part_ == broken_part::coordinates && (c.g | c.h) != 0) c.c_u += c.exponent > 0 ? int32_t(1) << (c.exponent - 1) : 0;
    if (part_ == broken_part::level)
      for (int16_t(&terms)[span_side] : {std::ref(c.level_row), std::ref(c.level_column)})
        for (int16_t& term : terms) term = int16_t(min_of(term + 102, INT16_MAX));
    if (part_ == broken_part::footprint)
      for (int32_t axis_terms::*term : {&axis_terms::c_u, &axis_terms::a_u, &axis_terms::b_u, &axis_terms::c_v, &axis_terms::a_v, &axis_terms::b_v})
        c.axis.*term /= 2;
    return c;
  }

  direct_engine<Prof> sound_;
  broken_part part_;
  uint64_t from_, takes_ = 0;
  one_half halves_[half_count];
};

}  // namespace spantex::sim
