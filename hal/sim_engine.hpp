// SPDX-License-Identifier: Apache-2.0
// The simulated backend: the datapath of every other backend, so the same bytes, run on the machine of VR11 that sim/ models block by
// block, so every cycle, word and bank read is accounted for. Host only.
//
//   load_words, load_coefficients ─► loader_unit ─► local memory, coefficients of half h
//   start ─► coordinate_unit ─► banks ─► filter_unit ─► pixels of half h ─► take
//
// Time is event time: each operation is given the earliest interval its blocks allow. A load begins when the port is free; start begins
// when the pipeline is free and the half's loading has ended; take moves the host's time to the end of that half's computing.
#pragma once
#include <stdint.h>

#include <cassert>
#include <vector>

#include <hal/engine.hpp>
#include <hal/operation.hpp>
#include <sim/banks.hpp>
#include <sim/coordinate_unit.hpp>
#include <sim/counters.hpp>
#include <sim/filter_unit.hpp>
#include <sim/loader_unit.hpp>
#include <sim/ownership.hpp>
#include <sim/timing.hpp>
#include <sim/trace.hpp>
#include <spantex/datapath.hpp>
#include <spantex/local_memory.hpp>
#include <spantex/profile.hpp>

namespace spantex {

// Fine: side of local memory; the profile's fine_side for a fixed profile. Banks: the bank map; another one than parity shows conflicts.
template <class Prof, int Fine = Prof::max_fine_side, class Banks = parity_banks>
class sim_engine {
 public:
  using memory = local_memory<Fine, Banks>;

  // The sink, if any, must outlive the engine. `table` must be valid.
  explicit sim_engine(const Prof& prof = {}, const sim::latencies& table = {}, sim::trace_sink* sink = nullptr)
      : prof_(prof), table_(table), loader_(table), coordinates_(table), filters_(table), sink_(sink) {
    assert(sim::is_valid(table));
    for (one_half& x : halves_) x.bursts.reserve(256);
  }

  status load_coefficients(half h, const span_coefficients& c) {
    SPANTEX_TRY(guard_.may_load(h, operation::load_coefficients, host_time_));
    halves_[int(h)].coefficients = c;
    guard_.coefficients_loaded(h);
    transfer(h, operation::load_coefficients, 0, table_.coefficient_words + (uses_footprint(c.kind) || c.kind == filter::contour ? table_.axis_words : 0) +
                                                (c.kind == filter::contour ? table_.contour_words : 0));
    return status::ok;
  }

  status load_words(half h, int first, const uint64_t* words, int count) {
    SPANTEX_TRY(guard_.may_load(h, operation::load_words, host_time_));
    SPANTEX_TRY(guard_.noted(h, operation::load_words, halves_[int(h)].texels.load(first, words, count), host_time_));
    counters_.words_loaded += uint64_t(count);
    transfer(h, operation::load_words, first, count);
    return status::ok;
  }

  status start(half h, span_mask mask) {
    SPANTEX_TRY(guard_.start(h, host_time_));
    one_half& x = halves_[int(h)];
    x.mask = mask;
    sim::bank_totals reads;
    compute_span(prof_, x.coefficients, mask, x.texels, x.pixels, sim::bank_observer(reads));
    counters_.fetches += reads.fetches;
    counters_.texel_reads += reads.fetches / channel_count * uint64_t(texels_per_sample(x.coefficients.kind) * (x.coefficients.two_levels ? 2 : 1));
    counters_.bank_conflicts += reads.conflicts;
    schedule(h, __builtin_popcountll(mask), int(reads.fetches / channel_count), sim::held_cycles(reads));
    return status::ok;
  }

  status take(half h, span_pixels& out) {
    SPANTEX_TRY(guard_.take(h, host_time_));
    const one_half& x = halves_[int(h)];
    for (span_mask rest = x.mask; rest != 0; rest &= rest - 1) {
      const int k = __builtin_ctzll(rest);
      out.pixel[k] = x.pixels.pixel[k];
    }
    out.sums = x.pixels.sums;
    host_time_ = sim::later(host_time_, guard_.computing(h).end);
    settle();
    return status::ok;
  }

  void mark(event what) {
    if (what.kind == event_kind::write) {
      delay(sim::cycle(what.value) * sim::cycle(table_.host_write_cycles));
      counters_.total_cycles = sim::later(counters_.total_cycles, host_time_);
    }
    if (sink_ != nullptr) sink_->mark(host_time_, what);
  }

  // The host is busy elsewhere for so long.
  void delay(sim::cycle cycles) {
    host_time_ += cycles;
    settle();
  }

  const sim::counters& counters() const { return counters_; }
  const sim::latencies& table() const { return table_; }
  const sim::ownership_guard& ownership() const { return guard_; }
  sim::cycle host_time() const { return host_time_; }

 private:
  struct one_half {
    span_coefficients coefficients{};
    span_mask mask = 0;
    memory texels{};
    span_pixels pixels{};
    sim::cycle loaded_at = 0;
    sim::interval issue;                // of the last start: the pipeline takes pixels of this half
    std::vector<sim::interval> bursts;  // since the half was last started
  };

  void transfer(half h, operation what, int first, int words) {
    if (words == 0) return;
    const sim::interval time = loader_.load(host_time_, words);
    one_half& x = halves_[int(h)];
    x.loaded_at = time.end;
    x.bursts.push_back(time);
    (void)guard_.loads(h, what, time);  // refusals are recorded
    counters_.load_cycles += time.length();
    counters_.hidden_load_cycles += sim::overlap_cycles(time, halves_[int(other(h))].issue);
    counters_.total_cycles = sim::later(counters_.total_cycles, time.end);
    if (sink_ != nullptr) sink_->load({h, what == operation::load_coefficients, first, words, time});
  }

  // The pipeline takes one sample at a time; a pixel is one or, with a footprint, several.
  void schedule(half h, int pixels, int samples, sim::cycle held_cycles) {
    one_half& x = halves_[int(h)];
    const sim::cycle idle_since = coordinates_.free_at();
    const sim::interval issue = coordinates_.issue(sim::later(host_time_, x.loaded_at), samples, held_cycles);
    const sim::cycle end = issue.end + coordinates_.fill_cycles() + filters_.fill_cycles();
    if (counters_.jobs != 0 && issue.begin > idle_since) stalled({idle_since, issue.begin});
    (void)guard_.computes(h, operation::start, {issue.begin, end});
    x.issue = issue;
    // Bursts of the other half that were requested before this start and still stream.
    for (const sim::interval& burst : halves_[int(other(h))].bursts)
      counters_.hidden_load_cycles += sim::overlap_cycles(burst, issue);
    x.bursts.clear();
    ++counters_.jobs;
    counters_.pixels += uint64_t(pixels);
    counters_.compute_cycles += issue.length();
    counters_.total_cycles = sim::later(counters_.total_cycles, end);
    if (sink_ != nullptr) sink_->compute({h, pixels, issue, end});
    settle();
  }

  void stalled(sim::interval time) {
    counters_.stall_cycles += time.length();
    if (sink_ != nullptr) sink_->stall(time);
  }

  void settle() {
    if (sink_ != nullptr) sink_->settled(sim::earlier(host_time_, coordinates_.free_at()));
  }

  Prof prof_;
  sim::latencies table_;
  sim::loader_unit loader_;
  sim::coordinate_unit coordinates_;
  sim::filter_unit filters_;
  sim::ownership_guard guard_;
  sim::trace_sink* sink_;
  sim::counters counters_;
  sim::cycle host_time_ = 0;
  one_half halves_[half_count];
};

static_assert(span_engine<sim_engine<fixed_profile<profiles::seed>>>);

}  // namespace spantex
