// SPDX-License-Identifier: Apache-2.0
// A decorator that breaks an engine on purpose: fails, corrupts or delays the n-th operation. Nothing is random, so that a test can
// walk through every n until nothing breaks any more.
//
// Operations are load_coefficients, load_words, start and take, counted together from 1. A failing one does not reach the engine.
// After device_error or device_timeout the half is empty, as the contract says: what it computed is discarded, its coefficients are
// gone and its texels are overwritten, so that whoever relies on them is found out.
#pragma once
#include <stdint.h>

#include <hal/engine.hpp>
#include <hal/operation.hpp>

namespace spantex {

struct fault_plan {
  uint64_t fail_operation = 0;               // which; 0: none
  status failure = status::device_error;
  uint64_t corrupt_word = 0;                 // which loaded word; 0: none
  uint64_t word_flips = 1;                   // bits that come out inverted
  uint64_t corrupt_take = 0;                 // which take; 0: none
  uint8_t colour_flips = 1;                  // bits of every channel of every pixel that come out inverted
  uint64_t delay_operation = 0;              // which; 0: none
  uint64_t delay_cycles = 0;
};

struct fault_log {
  uint64_t operations = 0, words = 0, takes = 0;  // seen
  uint64_t failed = 0, corrupted = 0, delayed_cycles = 0;
  operation failed_operation = operation::mark;   // the one that failed, if any did
};

template <span_engine Engine>
class faulty_engine {
 public:
  static constexpr int longest_burst = 640;  // words of the largest local memory

  // The engine must outlive the decorator.
  constexpr explicit faulty_engine(Engine& engine, const fault_plan& plan = {}) : engine_(engine), plan_(plan) {}

  constexpr status load_coefficients(half h, const span_coefficients& c) {
    SPANTEX_TRY(reached(h, operation::load_coefficients));
    SPANTEX_TRY(engine_.load_coefficients(h, c));
    empty_[int(h)] = false;
    return status::ok;
  }

  constexpr status load_words(half h, int first, const uint64_t* words, int count) {
    SPANTEX_TRY(reached(h, operation::load_words));
    const uint64_t before = log_.words;
    if (count > 0) log_.words += uint64_t(count);
    const bool hit = plan_.corrupt_word > before && plan_.corrupt_word <= log_.words;
    if (!hit || count > longest_burst) return engine_.load_words(h, first, words, count);
    uint64_t altered[longest_burst] = {};
    for (int k = 0; k < count; ++k) altered[k] = words[k];
    altered[plan_.corrupt_word - before - 1] ^= plan_.word_flips;
    ++log_.corrupted;
    return engine_.load_words(h, first, altered, count);
  }

  constexpr status start(half h, span_mask mask) {
    SPANTEX_TRY(reached(h, operation::start));
    if (empty_[int(h)]) return status::half_not_loaded;
    SPANTEX_TRY(engine_.start(h, mask));
    started_[int(h)] = true;
    return status::ok;
  }

  constexpr status take(half h, span_pixels& out) {
    SPANTEX_TRY(reached(h, operation::take));
    SPANTEX_TRY(engine_.take(h, out));
    started_[int(h)] = false;
    if (++log_.takes != plan_.corrupt_take) return status::ok;
    ++log_.corrupted;
    const uint8_t flips = plan_.colour_flips;
    for (rgba8& p : out.pixel) p = {uint8_t(p.r ^ flips), uint8_t(p.g ^ flips), uint8_t(p.b ^ flips), uint8_t(p.a ^ flips)};
    for (uint32_t& channel : out.sums.channel) channel ^= flips;
    return status::ok;
  }

  constexpr void mark(event what) { engine_.mark(what); }

  constexpr const fault_log& log() const { return log_; }

 private:
  constexpr status reached(half h, operation what) {
    ++log_.operations;
    if (log_.operations == plan_.delay_operation) delay();
    if (log_.operations != plan_.fail_operation) return status::ok;
    ++log_.failed;
    log_.failed_operation = what;
    if (plan_.failure == status::device_error || plan_.failure == status::device_timeout) lose(h);
    return plan_.failure;
  }

  constexpr void delay() {
    log_.delayed_cycles += plan_.delay_cycles;
    if constexpr (requires { engine_.delay(plan_.delay_cycles); }) engine_.delay(plan_.delay_cycles);
  }

  // How far to overwrite: as the engine tells, else until it refuses.
  static constexpr int word_count() {
    if constexpr (requires { Engine::memory::word_count; }) return Engine::memory::word_count;
    else return longest_burst;
  }

  constexpr void lose(half h) {
    span_pixels discarded{};
    if (started_[int(h)]) (void)engine_.take(h, discarded);
    started_[int(h)] = false;
    constexpr uint64_t lost = 0xA55AA55AA55AA55Au;
    for (int k = 0; k < word_count() && engine_.load_words(h, k, &lost, 1) == status::ok; ++k) {}
    empty_[int(h)] = true;
  }

  Engine& engine_;
  fault_plan plan_;
  fault_log log_{};
  bool empty_[half_count] = {}, started_[half_count] = {};
};

}  // namespace spantex
