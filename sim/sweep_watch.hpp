// SPDX-License-Identifier: Apache-2.0
// What a sweep reads off a span engine while it draws: errors of coordinates and levels against exact arithmetic, and products. It sees the coefficients
// that the planner gave the engine, so it judges what was drawn and nothing else.
#pragma once
#include <stdint.h>

#include <hal/engine.hpp>
#include <spantex/plane.hpp>
#include <spantex/profile.hpp>
#include <spantex/span.hpp>

namespace spantex::sim {

// Multiplications of the datapath. Products with a pixel's place in its span (at most 4 bits) are sums there and not counted, nor shifts.
struct product_count {
  uint64_t short_ones = 0, long_ones = 0;  // both factors of at most 16 bits; others
  uint64_t bits = 0;                       // bits of one factor times bits of the other, summed: the area of an array multiplier
  void add(uint64_t times, int a, int b) {
    (a <= 16 && b <= 16 ? short_ones : long_ones) += times;
    bits += times * uint64_t(a) * uint64_t(b);
  }
};

class span_watch {
 public:
  explicit span_watch(const run_time_profile& prof) : prof_(prof) {}

  void about(const plane& map) { map_ = &map; }
  void span(uint32_t place) { sx_ = int32_t(place & 0xFFFF), sy_ = int32_t(place >> 16); }
  // A job's coefficients, its mask and the samples it took.
  void job(const span_coefficients& c, span_mask mask, uint64_t samples);

  struct error_sum {
    double worst = 0, squares = 0;
    uint64_t count = 0;
    void add(double error);
    double rms() const;
  };
  error_sum coordinate;  // texels of level 0, against the caller's integers
  error_sum level;       // levels, against the formula; filters of two levels without a footprint
  product_count products;

 private:
  void judge_pixel(const span_coefficients& c, int i, int j);
  void count_products(const span_coefficients& c, uint64_t pixels, uint64_t samples);

  const run_time_profile& prof_;
  const plane* map_ = nullptr;
  int32_t sx_ = 0, sy_ = 0;
};

// An engine, watched. Watch may be null.
template <class Engine>
class watched_engine {
 public:
  template <class... Arguments>
  explicit watched_engine(span_watch* watch, Arguments&&... arguments) : watch_(watch), engine_(arguments...) {}

  status load_coefficients(half h, const span_coefficients& c) {
    coefficients_[int(h)] = c;
    return engine_.load_coefficients(h, c);
  }
  status load_words(half h, int first, const uint64_t* words, int count) { return engine_.load_words(h, first, words, count); }
  status start(half h, span_mask mask) {
    const uint64_t before = engine_.counters().fetches;
    const status done = engine_.start(h, mask);
    if (watch_ != nullptr && done == status::ok) watch_->job(coefficients_[int(h)], mask, (engine_.counters().fetches - before) / channel_count);
    return done;
  }
  status take(half h, span_pixels& out) { return engine_.take(h, out); }
  void mark(event what) {
    if (watch_ != nullptr && what.kind == event_kind::span) watch_->span(what.value);
    engine_.mark(what);
  }
  const Engine& engine() const { return engine_; }

 private:
  span_watch* watch_;
  Engine engine_;
  span_coefficients coefficients_[half_count];
};

}  // namespace spantex::sim
