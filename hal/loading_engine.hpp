// SPDX-License-Identifier: Apache-2.0
// The direct backend with double buffering: the same datapath, on halves that a loader fills beside it (texel_loader.hpp).
//
//   load_texels*  load_coefficients  start ══ loader fills h ══╗                take: filter reads h
//                                                              ╚═ state() is ok: h is the filter's
//   take of the other half: filter reads ..............................
//
// A half is the loader's from start until the loader says that it is done, the filter's while take computes; the guard that the simulator
// has (ownership.hpp) refuses anything else with half_busy. take waits for the loader, and start does, since there is one: each load is
// found done when it is first needed (hidden), or waited for (a stall), or given up after a limit of polls: device_timeout at the take of
// its half, which is empty then. Freestanding.
#pragma once
#include <stdint.h>

#include <hal/engine.hpp>
#include <hal/ownership.hpp>
#include <hal/texel_loader.hpp>
#include <spantex/datapath.hpp>
#include <spantex/profile.hpp>
#include <spantex/texel_memory.hpp>

namespace spantex {

struct loading_counters {
  uint32_t jobs = 0;            // takes that computed
  uint32_t loads = 0;           // lists given to the loader: hidden + stalls + failed, but for one under way
  uint32_t hidden = 0;          // done when first needed
  uint32_t stalls = 0;          // waited for
  uint32_t failed = 0;          // given up, or failed
  uint32_t polls_waited = 0;    // of the loader's state, in stalls
  uint32_t beside = 0;          // jobs that began to compute while the loader filled the other half
  uint32_t texels_loaded = 0;   // by the loader
  uint32_t texels_copied = 0;   // by the core, for want of room in a list
};

// The two halves, and who has them. Part of the engine; apart, so that refusals can be seen.
template <texel_loader Loader, int Fine>
class loading_halves {
 public:
  using memory = texel_memory<Fine>;
  // Runs in a row of a section: two where the torus or the map's edge divides it, three where both do; with smaller maps more.
  static constexpr int list_length = 3 * (memory::fine_side + memory::coarse_side);

  constexpr loading_halves(Loader& loader, uint32_t most_polls) : loader_(loader), most_polls_(most_polls) {}

  constexpr status may_load(half h, operation what) { return guard_.may_load(h, what, ++now_); }
  constexpr void coefficients_loaded(half h) { guard_.coefficients_loaded(h); }
  constexpr status start(half h) { return guard_.start(h, ++now_); }
  constexpr status take(half h) { return guard_.take(h, ++now_); }

  // Written at once, by the core. Errors: half_busy, bad_address.
  constexpr status load_words(half h, int first, const uint64_t* words, int count) {
    SPANTEX_TRY(may_load(h, operation::load_words));
    return guard_.noted(h, operation::load_words, of(h).texels.load(first, words, count), now_);
  }

  // Put on the half's list. Errors: half_busy, bad_address.
  constexpr status load_texels(half h, int first, const rgba8* texels, int count) {
    SPANTEX_TRY(may_load(h, operation::load_words));
    if (!memory::holds(first, count)) return guard_.noted(h, operation::load_words, status::bad_address, now_);
    one_half& x = of(h);
    const texel_copy run{texels, uint16_t(first), uint16_t(count)};
    if (x.listed < list_length) {
      if (count > 0) x.list[x.listed++] = run;
      return status::ok;
    }
    copy_cursor(x.texels.texels(), &run, 1).copy(count);
    counters_.texels_copied += uint32_t(count);
    return status::ok;
  }

  // Gives the half with its list to the loader, after what the loader has. Errors: half_busy while the filter has the half.
  constexpr status begin_loading(half h) {
    one_half& x = of(h);
    if (x.listed == 0) return status::ok;
    settle();
    SPANTEX_TRY(guard_.loads(h, operation::load_words, {++now_, not_ended}));
    loading_ = true;
    loading_half_ = h;
    ++counters_.loads;
    for (int k = 0; k < x.listed; ++k) counters_.texels_loaded += x.list[k].count;
    loader_.start(x.texels.texels(), x.list, x.listed);
    return status::ok;
  }

  // Waits until the loader has let go of the half. Errors: device_timeout, or what the loader failed with; told once, the half is empty.
  constexpr status wait(half h) {
    if (loading_ && loading_half_ == h) settle();
    one_half& x = of(h);
    const status result = x.result;
    x.result = status::ok;
    x.listed = 0;
    return result;
  }

  // The filter has the half, until end_reading. Errors: half_busy while the loader has it.
  constexpr status begin_reading(half h) {
    SPANTEX_TRY(guard_.computes(h, operation::take, {++now_, not_ended}));
    ++counters_.jobs;
    if (loading_ && loader_.state() == status::half_busy) ++counters_.beside;
    return status::ok;
  }
  constexpr void end_reading(half h) { guard_.computed(h, ++now_); }

  constexpr const memory& texels(half h) const { return halves_[int(h)].texels; }
  constexpr Loader& loader() const { return loader_; }
  constexpr const loading_counters& counters() const { return counters_; }
  constexpr const half_ownership<1>& ownership() const { return guard_; }

 private:
  struct one_half {
    memory texels{};
    texel_copy list[list_length]{};
    int listed = 0;
    status result = status::ok;  // of the last load
  };
  constexpr one_half& of(half h) { return halves_[int(h)]; }

  // Sees the load that is under way to its end: the loader's word, and nothing else, releases the half.
  constexpr void settle() {
    if (!loading_) return;
    status s = loader_.state();
    uint32_t polls = 0;
    for (; s == status::half_busy && polls < most_polls_; ++polls) {
      loader_.poll();
      s = loader_.state();
    }
    counters_.polls_waited += polls;
    ++(s != status::ok ? counters_.failed : polls != 0 ? counters_.stalls : counters_.hidden);
    if (s != status::ok) loader_.stop();
    of(loading_half_).result = s == status::half_busy ? status::device_timeout : s;
    loading_ = false;
    guard_.loaded(loading_half_, ++now_);
  }

  Loader& loader_;
  uint32_t most_polls_;
  one_half halves_[half_count];
  half_ownership<1> guard_;
  loading_counters counters_{};
  cycle now_ = 0;
  half loading_half_ = half::first;
  bool loading_ = false;
};

// Fine: side of local memory; the profile's fine_side for a fixed profile.
template <class Prof, texel_loader Loader, int Fine = Prof::max_fine_side>
class loading_engine {
 public:
  using memory = texel_memory<Fine>;
  static constexpr uint32_t default_polls = 1u << 20;

  // The loader must outlive the engine. most_polls: how long a load is waited for.
  constexpr explicit loading_engine(Loader& loader, const Prof& prof = {}, uint32_t most_polls = default_polls) : prof_(prof), halves_(loader, most_polls) {}

  constexpr status load_coefficients(half h, const span_coefficients& c) {
    SPANTEX_TRY(halves_.may_load(h, operation::load_coefficients));
    jobs_[int(h)].coefficients = c;
    halves_.coefficients_loaded(h);
    return status::ok;
  }
  constexpr status load_words(half h, int first, const uint64_t* words, int count) { return halves_.load_words(h, first, words, count); }
  constexpr status load_texels(half h, int first, const rgba8* texels, int count) { return halves_.load_texels(h, first, texels, count); }
  constexpr status start(half h, span_mask mask) {
    SPANTEX_TRY(halves_.start(h));
    jobs_[int(h)].mask = mask;
    return halves_.begin_loading(h);
  }
  constexpr status take(half h, span_pixels& out) {
    SPANTEX_TRY(halves_.take(h));
    SPANTEX_TRY(halves_.wait(h));
    SPANTEX_TRY(halves_.begin_reading(h));
    compute_span(prof_, jobs_[int(h)].coefficients, jobs_[int(h)].mask, halves_.texels(h), out, polling{halves_.loader()});
    halves_.end_reading(h);
    return status::ok;
  }
  constexpr void mark(event) {}

  constexpr const loading_counters& counters() const { return halves_.counters(); }
  constexpr const half_ownership<1>& ownership() const { return halves_.ownership(); }

 private:
  // Gives the loader of the other half its time while this one is filtered.
  struct polling {
    Loader& loader;
    constexpr void fetch_begin() const { loader.poll(); }
  };
  struct one_job {
    span_coefficients coefficients{};
    span_mask mask = 0;
  };
  [[no_unique_address]] Prof prof_;
  loading_halves<Loader, Fine> halves_;
  one_job jobs_[half_count];
};

}  // namespace spantex
