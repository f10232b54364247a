// SPDX-License-Identifier: Apache-2.0
// The draw layer: spans of a plane or polygon, visibility, and the two halves of the engine used in turn, so that loading job
// k+1 overlaps computing job k. The only part of the library that names the HAL.
#pragma once
#include <stdint.h>

#include <hal/engine.hpp>
#include <spantex/coverage.hpp>
#include <spantex/global_reads.hpp>
#include <spantex/loader.hpp>
#include <spantex/plan.hpp>
#include <spantex/polygon.hpp>
#include <spantex/shade.hpp>
#include <spantex/status.hpp>
#include <spantex/visibility.hpp>

namespace spantex {

// Where pixels go: RGBA8888, rows of `stride` pixels, caller's memory.
struct frame_buffer {
  rgba8* pixels;
  int32_t width, height, stride;
};

struct draw_counters {
  uint64_t spans_total = 0;       // spans looked at
  uint64_t spans_empty = 0;       // skipped: no pixel covered
  uint64_t spans_behind = 0;      // skipped: no covered pixel in front of the viewer
  uint64_t spans_hidden = 0;      // skipped: every covered pixel behind what is drawn already
  uint64_t jobs = 0;              // engine runs
  uint64_t pixels = 0;            // pixels computed
  uint64_t words_loaded = 0;      // 64-bit words into local memory
  uint64_t words_read = 0;        // 64-bit words out of global memory (global_reads.hpp), if counted
  uint64_t loads_skipped = 0;     // sections found loaded already
  uint64_t second_levels_skipped = 0;  // two-level jobs that needed the finer one only
  uint64_t divides = 0;           // reciprocals: one a span, one a pixel where the span needs it
  uint64_t affine_jobs = 0, series_jobs = 0, divide_jobs = 0;  // by how 1/w is evaluated: not at all, by products, by a reciprocal a pixel
  uint64_t corrected_jobs = 0;    // jobs whose section did not fit and were clamped
  uint64_t pixels_left = 0;       // computed and not written: cut out, or blended with alpha 0
  uint64_t pixels_blended = 0;    // mixed with what was there
};

// Shading: opaque_only, or shading for alpha and vertex colours (shade.hpp). Reads: counted_reads fills in words_read.
template <span_engine Engine, class Prof, class Shading = opaque_only, class Reads = uncounted_reads>
class renderer {
 public:
  // The frame must outlive the renderer.
  constexpr renderer(Engine& engine, const Prof& prof, const frame_buffer& frame) : engine_(engine), prof_(prof), frame_(frame) {}

  // Use one half only: what double buffering hides becomes visible.
  constexpr void single_half(bool on) { single_half_ = on; }

  // Draws the part of the plane in front of the viewer inside `area`. Errors: what the engine reports.
  constexpr status draw(const plane& p, const texture_view& t, filter kind, rectangle area, const Shading& how = {}) {
    const surface s{&p, &t, kind};
    shade_ = how.of(p);
    return each_span(area, [&](int32_t sx, int32_t sy) {
      ++counters_.spans_total;
      const span_mask mask = rectangle_mask(area, sx, sy);
      return plan(s, sx, sy, mask);
    });
  }

  // Draws a polygon, hidden parts left out where a depth buffer is given. Errors: what the engine reports.
  constexpr status draw(const polygon& p, const texture_view& t, filter kind, depth_buffer depth = {}, const Shading& how = {}) {
    const surface s{&p.map, &t, kind};
    shade_ = how.of(p, depth.values);
    return each_span(p.box, [&](int32_t sx, int32_t sy) {
      ++counters_.spans_total;
      span_mask mask = coverage(p.edges, sx, sy) & rectangle_mask(p.box, sx, sy);
      if (mask != 0 && depth.values != nullptr) {
        SPANTEX_TRY(settle(sx, sy));
        mask = depth_test(p, sx, sy, mask & front_mask(p.map, sx, sy), depth, frame_.width, how.stores_depth_first());
        if (mask == 0) { ++counters_.spans_hidden; return status::ok; }
      }
      return plan(s, sx, sy, mask);
    });
  }

  // One span of a plane, in whatever order the caller likes.
  constexpr status draw_span(const surface& s, int32_t sx, int32_t sy, span_mask covered, const Shading& how = {}) {
    shade_ = how.of(*s.map);
    return plan(s, sx, sy, covered);
  }

  // Takes what is still computing: what was drawn lies in the frame, which goes on.
  constexpr status flush() { return drain(); }

  // The same at the frame's end, which is marked. Call before the frame is read.
  constexpr status finish() {
    SPANTEX_TRY(drain());
    engine_.mark({event_kind::frame_end, 0});
    return status::ok;
  }

  constexpr const draw_counters& counters() const { return counters_; }

 private:
  struct pending_job {
    span_mask mask = 0;  // zero: nothing to take
    int32_t sx = 0, sy = 0;
    bool partial = false, completes = true, linear_light = false;
    [[no_unique_address]] typename Shading::job shade{};
  };
  struct loaded_section {
    texture_view::identity map;
    section at{};
    texel_box box{};
    bool valid = false;
  };

  template <class Each>
  constexpr status each_span(rectangle area, Each each) {
    area = intersection(area, {0, 0, frame_.width, frame_.height});
    if (area.empty()) return status::ok;
    for (int32_t sy = area.y0 / span_side; sy <= (area.y1 - 1) / span_side; ++sy)
      for (int32_t sx = area.x0 / span_side; sx <= (area.x1 - 1) / span_side; ++sx) SPANTEX_TRY(each(sx, sy));
    return status::ok;
  }

  constexpr status plan(const surface& s, int32_t sx, int32_t sy, span_mask covered) {
    if (covered == 0) { ++counters_.spans_empty; return status::ok; }
    const span_mask mask = covered & front_mask(*s.map, sx, sy);
    if (mask == 0) { ++counters_.spans_behind; return status::ok; }
    return plan_span(prof_, s, sx, sy, mask, [&](span_job& job) { return submit(s, sx, sy, job); });
  }

  // Collects both halves, the older job first.
  constexpr status drain() {
    for (int k = 0; k < half_count; ++k) {
      SPANTEX_TRY(noted(next_, collect(next_)));
      next_ = other(next_);
    }
    return status::ok;
  }

  // Before depth is tested in a span: the depths of pixels still being computed there must be stored. Pixels of one surface never
  // overlap, and jobs of other spans touch other pixels, so loading goes on overlapping computing but where surfaces meet in a span.
  constexpr status settle(int32_t sx, int32_t sy) {
    for (const pending_job& job : pending_)
      if (job.shade.stores_depth() && job.mask != 0 && job.sx == sx && job.sy == sy) return drain();
    return status::ok;
  }

  // A half whose operation failed is empty (hal/engine.hpp): nothing of it may be used or waited for again.
  constexpr status noted(half h, status result) {
    if (result == status::ok) return result;
    pending_[int(h)].mask = 0;
    sums_ = {};
    for (loaded_section& held : held_[int(h)]) held.valid = false;
    return result;
  }

  constexpr status submit(const surface& s, int32_t sx, int32_t sy, span_job& job) {
    const half h = next_;
    SPANTEX_TRY(noted(h, run(h, s, sx, sy, job)));
    if (!single_half_) next_ = other(h);
    return status::ok;
  }

  constexpr status run(half h, const surface& s, int32_t sx, int32_t sy, span_job& job) {
    SPANTEX_TRY(collect(h));
    engine_.mark({event_kind::span, uint32_t(sy) << 16 | uint32_t(sx)});
    span_coefficients& c = job.coefficients;
    SPANTEX_TRY(load(h, *s.texture, c.fine, job.fine, false));
    if (c.two_levels) SPANTEX_TRY(load(h, *s.texture, c.coarse, job.coarse, true));
    SPANTEX_TRY(engine_.load_coefficients(h, c));
    SPANTEX_TRY(engine_.start(h, job.mask));
    pending_[int(h)] = {job.mask, sx, sy, c.axis.partial, job.completes, detail::decodes(prof_, c, 0), shade_};
    ++counters_.jobs;
    if (job.completes) counters_.pixels += uint64_t(__builtin_popcountll(job.mask));
    counters_.divides += uint64_t(job.divides);
    ++(c.how == evaluation::affine ? counters_.affine_jobs : c.how == evaluation::series ? counters_.series_jobs : counters_.divide_jobs);
    if (c.corrects) ++counters_.corrected_jobs;
    if (uses_two_levels(c.kind) && !c.two_levels) ++counters_.second_levels_skipped;
    return status::ok;
  }

  // Loads a section unless the half holds it already. A held section serves every box inside it: a box that had
  // to be clamped is as large as its section, so it is inside only if it is the same one.
  constexpr status load(half h, const texture_view& t, section& at, const texel_box& box, bool coarse) {
    loaded_section& held = held_[int(h)][coarse];
    const bool same_level = held.valid && held.at.level == at.level && held.map == t.id();
    const bool inside = box.u0 >= held.box.u0 && box.v0 >= held.box.v0 && box.u1 <= held.box.u1 && box.v1 <= held.box.v1;
    if (same_level && inside) {
      at.origin_u = held.at.origin_u;
      at.origin_v = held.at.origin_v;
      ++counters_.loads_skipped;
      return status::ok;
    }
    held.valid = false;
    SPANTEX_TRY(load_section(prof_, t, at, box, coarse, [&](int first, const uint64_t* words, int count) {
      counters_.words_loaded += uint64_t(count);
      return engine_.load_words(h, first, words, count);
    }));
    if constexpr (Reads::counted) counters_.words_read += section_reads(prof_, t, at, box, coarse);
    held = {t.id(), at, box, true};
    return status::ok;
  }

  // Waits for a half and writes its pixels out.
  constexpr status collect(half h) {
    pending_job& job = pending_[int(h)];
    if (job.mask == 0) return status::ok;
    span_pixels pixels;
    pixels.sums = {};
    SPANTEX_TRY(engine_.take(h, pixels));
    if (job.partial) {
      add(sums_, pixels.sums);
      if (!job.completes) { job.mask = 0; return status::ok; }
      pixels.pixel[__builtin_ctzll(job.mask)] = mean_of(job);
      sums_ = {};
    }
    for (; job.mask != 0; job.mask &= job.mask - 1) {
      const int k = __builtin_ctzll(job.mask);
      const int32_t x = job.sx * span_side + k % span_side, y = job.sy * span_side + k / span_side;
      rgba8& there = frame_.pixels[y * frame_.stride + x];
      if constexpr (Shading::enabled) count(job.shade.write(pixels.pixel[k], x, y, there, y * frame_.width + x));
      else there = pixels.pixel[k];
    }
    return status::ok;
  }

  constexpr rgba8 mean_of(const pending_job& job) const {
    if constexpr (Prof::has_linear_light)
      if (job.linear_light) return mean_linear_colour(sums_, prof_.get().colour_rounding);
    return mean_colour(sums_, prof_.get().colour_rounding);
  }

  constexpr void count(write_result result) {
    if (result == write_result::left) ++counters_.pixels_left;
    if (result == write_result::mixed) ++counters_.pixels_blended;
  }

  Engine& engine_;
  Prof prof_;
  frame_buffer frame_;
  draw_counters counters_{};
  pending_job pending_[half_count];
  footprint_sums sums_{};  // of the parts taken so far of one pixel
  loaded_section held_[half_count][2];
  [[no_unique_address]] typename Shading::job shade_{};  // of the surface being drawn
  half next_ = half::first;
  bool single_half_ = false;
};

}  // namespace spantex
