// SPDX-License-Identifier: Apache-2.0
// An engine chosen at run time, through virtual calls. Host only: devices resolve the contract at compile time.
#pragma once
#include <utility>

#include <hal/engine.hpp>

namespace spantex {

class any_engine {
 public:
  virtual ~any_engine() = default;
  virtual status load_coefficients(half h, const span_coefficients& c) = 0;
  virtual status load_words(half h, int first, const uint64_t* words, int count) = 0;
  virtual status start(half h, span_mask mask) = 0;
  virtual status take(half h, span_pixels& out) = 0;
  virtual void mark(event what) = 0;
};

static_assert(span_engine<any_engine>);

template <span_engine Engine>
class any_engine_of final : public any_engine {
 public:
  template <class... Arguments>
  explicit any_engine_of(Arguments&&... arguments) : engine_(std::forward<Arguments>(arguments)...) {}

  status load_coefficients(half h, const span_coefficients& c) override { return engine_.load_coefficients(h, c); }
  status load_words(half h, int first, const uint64_t* words, int count) override { return engine_.load_words(h, first, words, count); }
  status start(half h, span_mask mask) override { return engine_.start(h, mask); }
  status take(half h, span_pixels& out) override { return engine_.take(h, out); }
  void mark(event what) override { engine_.mark(what); }

  Engine& engine() { return engine_; }

 private:
  Engine engine_;
};

}  // namespace spantex
