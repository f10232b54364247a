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
#include <spantex/shortcuts.hpp>
#include <spantex/skips.hpp>
#include <spantex/status.hpp>
#include <spantex/visibility.hpp>

namespace spantex {

// Where pixels go: RGBA8888, rows of `stride` pixels, caller's memory. Sides 1..4096, stride at least the width: not checked.
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
  uint64_t pixels = 0;            // pixels drawn: computed, or written by the draw layer (skips.hpp)
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

namespace detail {

template <bool Wanted, class T> struct only_if { using type = T; };
template <class T> struct only_if<false, T> { struct type {}; };

}  // namespace detail

// A section that is loaded is used again by whatever reads the same memory: texels of maps that are drawn must stay as they are until finish().
//
// Shading: opaque_only, or shading for alpha and vertex colours (shade.hpp). Reads: counted_reads fills in words_read. Skips: skips.hpp.
template <span_engine Engine, class Prof, class Shading = opaque_only, class Reads = uncounted_reads, class Skips = device_skips>
class renderer {
 public:
  using shading_type = Shading;

  // The frame must outlive the renderer.
  constexpr renderer(Engine& engine, const Prof& prof, const frame_buffer& frame, const Skips& skips = {}, const Reads& reads = {})
      : engine_(engine), prof_(prof), frame_(frame), skips_(skips), reads_(reads) {}

  constexpr const profile& numbers() const { return prof_.get(); }

  // Use one half only: what double buffering hides becomes visible.
  constexpr void single_half(bool on) { single_half_ = on; }

  // Draws the part of the plane in front of the viewer inside `area`. Errors: what the engine reports.
  constexpr status draw(const plane& p, const texture_view& t, filter kind, rectangle area, const Shading& how = {}) {
    const surface s{&p, &t, kind};
    shade_ = how.of(p);
    note_opaque(s);
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
    if constexpr (Skips::switchable)
      if (!skips_.on(skip::floors)) depth.floors = nullptr;
    const bool cut_out = note_opaque(s);
    return each_span(walked(p), [&](int32_t sx, int32_t sy) {
      ++counters_.spans_total;
      span_mask mask = coverage(p.edges, sx, sy) & rectangle_mask(p.box, sx, sy);
      if constexpr (Skips::switchable)
        if (mask == 0 && rectangle_mask(p.box, sx, sy) != 0 && !skips_.on(skip::empty)) {
          ++counters_.spans_empty;
          return plan_unseen(s, sx, sy, full_mask);
        }
      if (mask != 0 && depth.values != nullptr) {
        SPANTEX_TRY(settle(sx, sy));
        [[maybe_unused]] const span_mask covered = mask;
        if constexpr (Skips::switchable) skipped_.spans_below_floor += is_below_floor(p, sx, sy, depth, frame_.width);
        mask = depth_test(p, sx, sy, mask & front_mask(p.map, sx, sy), depth, frame_.width, cut_out || how.stores_depth_first());
        if (mask == 0) {
          ++counters_.spans_hidden;
          if constexpr (Skips::switchable)
            if (!skips_.on(skip::hidden)) return plan_unseen(s, sx, sy, covered);
          return status::ok;
        }
      }
      return plan(s, sx, sy, mask);
    });
  }

  // One span of a plane or polygon, in whatever order the caller likes; what it is hidden by is the caller's to know.
  constexpr status draw_span(const surface& s, int32_t sx, int32_t sy, span_mask covered) {
    shade_ = {};
    return plan(s, sx, sy, covered);
  }

  // Takes what is still computing: what was drawn lies in the frame, which goes on.
  constexpr status flush() { return drain(); }

  // The same at the frame's end, which is marked. Call before the frame is read. Nothing of the maps is remembered: their texels may change now.
  constexpr status finish() {
    forget();
    SPANTEX_TRY(drain());
    engine_.mark({event_kind::frame_end, 0});
    return status::ok;
  }

  // Whether some spans may be left as they are; whether one is (run_time_skips).
  constexpr bool keeps_some() const {
    if constexpr (Skips::switchable) return skips_.keeps_some();
    return false;
  }
  constexpr bool keeps([[maybe_unused]] int32_t sx, [[maybe_unused]] int32_t sy) const {
    if constexpr (Skips::switchable) return skips_.keeps(sx, sy);
    return false;
  }

  constexpr const draw_counters& counters() const { return counters_; }
  // What is counted and watched of global memory; empty with uncounted_reads.
  constexpr Reads& reads() { return reads_; }
  // Empty with device_skips.
  constexpr const auto& skipped() const { return skipped_; }

 private:
  static constexpr bool takes_shortcuts =
      Skips::may(skip::uniform) || Skips::may(skip::one_texel) || Skips::may(skip::copy) || (Shading::enabled && Skips::may(skip::transparent));

  struct unseen { bool unseen = false; };   // computed for want of a skip: not written
  struct alike { span_mask mask = 0; };     // pixels that are all the one that is computed; zero: as computed
  struct pending_job {
    span_mask mask = 0;  // zero: nothing to take
    int32_t sx = 0, sy = 0;
    bool partial = false, completes = true, linear_light = false;
    [[no_unique_address]] typename Shading::job shade{};
    [[no_unique_address]] typename detail::only_if<Skips::switchable, unseen>::type show{};
    [[no_unique_address]] typename detail::only_if<Skips::may(skip::constant), alike>::type pixels{};
  };
  struct loaded_section {
    texture_view::identity map;
    section at{};
    texel_box box{};
    bool valid = false;
  };

  struct coloured_section {
    texture_view::identity map;
    texel_box box{};
    rgba8 colour{};
    uint8_t level = 0;
    bool valid = false;
  };
  struct coloured_sections {
    coloured_section of[2];
    constexpr coloured_section& operator[](bool coarse) { return of[coarse]; }
  };

  template <class Each>
  constexpr status each_span(rectangle area, Each each) {
    area = intersection(area, {0, 0, frame_.width, frame_.height});
    if (area.empty()) return status::ok;
    for (int32_t sy = area.y0 / span_side; sy <= (area.y1 - 1) / span_side; ++sy)
      for (int32_t sx = area.x0 / span_side; sx <= (area.x1 - 1) / span_side; ++sx)
        if (!keeps(sx, sy)) SPANTEX_TRY(each(sx, sy));
    return status::ok;
  }

  constexpr status plan(const surface& s, int32_t sx, int32_t sy, span_mask covered) {
    if (covered == 0) { ++counters_.spans_empty; return status::ok; }
    const span_mask mask = covered & front_mask(*s.map, sx, sy);
    if (mask == 0) { ++counters_.spans_behind; return status::ok; }
    if constexpr (Skips::may(skip::constant))
      if (skips_.on(skip::constant) && is_one_texel_map(s)) return fill_span(s, sx, sy, mask);
    return plan_span(prof_, s, sx, sy, mask, [&](span_job& job) { return submit(s, sx, sy, job); });
  }

  // Without a skip: what it leaves out is loaded and computed, and not written.
  constexpr status plan_unseen(const surface& s, int32_t sx, int32_t sy, span_mask wanted) {
    const span_mask mask = wanted & front_mask(*s.map, sx, sy);
    if (mask == 0) return status::ok;
    unseen_ = {true};
    const status result = plan_span(prof_, s, sx, sy, mask, [&](span_job& job) { return submit(s, sx, sy, job); });
    unseen_ = {false};
    return result;
  }

  // The spans that are looked at for a polygon.
  constexpr rectangle walked(const polygon& p) {
    if constexpr (Skips::switchable) {
      if (!skips_.on(skip::outside)) return skips_.frame;
      skipped_.spans_outside += span_count(skips_.frame) - span_count(p.box);
    }
    return p.box;
  }
  constexpr uint64_t span_count(rectangle r) const {
    r = intersection(r, {0, 0, frame_.width, frame_.height});
    if (r.empty()) return 0;
    return uint64_t((r.x1 - 1) / span_side - r.x0 / span_side + 1) * uint64_t((r.y1 - 1) / span_side - r.y0 / span_side + 1);
  }

  // A map without alpha is stored as it is. True if that was a cut-out's: its depth is known before its pixels are.
  constexpr bool note_opaque([[maybe_unused]] const surface& s) {
    if constexpr (Shading::enabled && Skips::may(skip::opaque))
      if (skips_.on(skip::opaque) && s.texture->facts().opaque && s.kind != filter::contour) return shade_.without_alpha();
    return false;
  }

  // The map, for reading texels of a level.
  constexpr decltype(auto) texels_of(const texture_view& t, [[maybe_unused]] int level) {
    if constexpr (Reads::counted) {
      reads_.touch(level);
      return counting_map(t, reads_.blocks_decoded);
    } else {
      return (t);
    }
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

  constexpr void forget() {
    for (auto& of_half : held_)
      for (loaded_section& held : of_half) held.valid = false;
    if constexpr (Skips::may(skip::uniform) || Skips::may(skip::one_texel))
      for (coloured_section& seen : seen_.of) seen.valid = false;
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
    if constexpr (takes_shortcuts) {
      bool drawn = false;
      SPANTEX_TRY(shortcut(s, sx, sy, job, drawn));
      if (drawn) return status::ok;
    }
    if constexpr (Skips::may(skip::other_half))
      if (skips_.on(skip::other_half) && !single_half_) SPANTEX_TRY(turn_to_held(*s.texture, job));
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
    if constexpr (Skips::switchable)
      if (!skips_.on(skip::second_level)) add_second_level(*s.texture, job);
    if (c.two_levels) SPANTEX_TRY(load(h, *s.texture, c.coarse, job.coarse, true));
    SPANTEX_TRY(engine_.load_coefficients(h, c));
    pending_job next{job.mask, sx, sy, c.axis.partial, job.completes, detail::decodes(prof_, c, 0), shade_};
    if constexpr (Skips::switchable) next.show = unseen_;
    if constexpr (Skips::may(skip::constant))
      if (skips_.on(skip::constant) && is_constant(c)) compute_one(c, next);
    SPANTEX_TRY(engine_.start(h, next.mask));
    pending_[int(h)] = next;
    ++counters_.jobs;
    if (job.completes) counters_.pixels += uint64_t(__builtin_popcountll(job.mask));
    counters_.divides += uint64_t(job.divides);
    count_evaluation(c);
    if (c.corrects) ++counters_.corrected_jobs;
    if (uses_two_levels(c.kind) && !c.two_levels) ++counters_.second_levels_skipped;
    return status::ok;
  }

  constexpr void count_evaluation(const span_coefficients& c) {
    if constexpr (Skips::may(skip::constant))
      if (is_constant(c)) { ++skipped_.jobs_constant; return; }
    ++(c.how == evaluation::affine ? counters_.affine_jobs : c.how == evaluation::series ? counters_.series_jobs : counters_.divide_jobs);
  }

  // A job whose pixels are all alike computes its first.
  constexpr void compute_one(const span_coefficients& c, pending_job& job) {
    const auto more = uint64_t(__builtin_popcountll(job.mask)) - 1;
    job.pixels.mask = job.mask;
    job.mask &= ~(job.mask - 1);
    skipped_.pixels_constant += more;
    counters_.divides -= more * uint64_t(detail::reciprocals_a_pixel(c.kind, c.how));
  }

  // Without skip::second_level: the coarser level is loaded where it fits, though no pixel has a weight for it.
  constexpr void add_second_level(const texture_view& t, span_job& job) {
    span_coefficients& c = job.coefficients;
    if (!uses_two_levels(c.kind) || c.kind == filter::contour || c.two_levels || c.fine.level >= t.last_level()) return;
    c.coarse = detail::section_at(t, c.fine.level + 1);
    job.coarse = detail::touched(prof_, c, box_of(job.mask), c.coarse);
    if (!detail::fits(job.coarse, prof_.get().coarse_side())) return;
    detail::place(c.coarse, job.coarse, prof_.get().coarse_side());
    c.two_levels = true;
  }

  // --- jobs without the engine ---

  constexpr status shortcut(const surface& s, int32_t sx, int32_t sy, span_job& job, bool& drawn) {
    const span_coefficients& c = job.coefficients;
    if (c.axis.partial || !is_mean_of_texels(c.kind) || is_unseen()) return status::ok;
    // Texels are looked at where they would be loaded: what is held costs the engine less.
    const bool held = skips_.on(skip::held) && holds(next_, *s.texture, c.fine, job.fine, false) && (!c.two_levels || holds(next_, *s.texture, c.coarse, job.coarse, true));
    if (held) return status::ok;
    drawn = true;
    if constexpr (Shading::enabled && Skips::may(skip::transparent))
      if (skips_.on(skip::transparent) && leaves_all(*s.texture, job)) {
        ++skipped_.jobs_transparent;
        counters_.pixels_left += uint64_t(__builtin_popcountll(job.mask));
        return drawn_alone(*s.texture, job);
      }
    if constexpr (Skips::may(skip::uniform) || Skips::may(skip::one_texel)) {
      const bool one_texel = is_one_texel(c.fine, job.fine) && (!c.two_levels || is_one_texel(c.coarse, job.coarse));
      rgba8 colour{};
      if (skips_.on(one_texel ? skip::one_texel : skip::uniform) && has_one_colour(*s.texture, job, colour)) {
        ++(one_texel ? skipped_.jobs_one_texel : skipped_.jobs_uniform);
        SPANTEX_TRY(write_alone(sx, sy, job.mask, [&](int) { return colour; }));
        return drawn_alone(*s.texture, job, false);
      }
    }
    if constexpr (Skips::may(skip::copy)) {
      texel_steps at;
      if (skips_.on(skip::copy) && copies(prof_, c, at)) {
        ++skipped_.jobs_copied;
        const auto& map = texels_of(*s.texture, 0);
        SPANTEX_TRY(write_alone(sx, sy, job.mask, [&](int k) {
          const int i = k % span_side, j = k / span_side;
          return map.texel(0, map.wrapped_u(at.u + i * at.du_x + j * at.du_y, 0), map.wrapped_v(at.v + i * at.dv_x + j * at.dv_y, 0));
        }));
        return drawn_alone(*s.texture, job);
      }
    }
    drawn = false;
    return status::ok;
  }

  constexpr bool is_unseen() const {
    if constexpr (Skips::switchable) return unseen_.unseen;
    return false;
  }

  // Counts a job that the engine has not seen. Its divides came with the first job of its span, those of its pixels were not made.
  constexpr status drawn_alone(const texture_view& t, const span_job& job, bool reads = true) {
    const span_coefficients& c = job.coefficients;
    const int pixels = __builtin_popcountll(job.mask);
    counters_.pixels += uint64_t(pixels);
    counters_.divides += uint64_t(job.divides);
    counters_.divides -= uint64_t(pixels * detail::reciprocals_a_pixel(c.kind, c.how));
    if constexpr (Reads::counted)
      if (reads) {
        counters_.words_read += section_reads(prof_, t, c.fine, job.fine, false);
        if (c.two_levels) counters_.words_read += section_reads(prof_, t, c.coarse, job.coarse, true);
      }
    return status::ok;
  }

  constexpr bool leaves_all(const texture_view& t, const span_job& job) {
    const span_coefficients& c = job.coefficients;
    const int limit = shade_.left_below();
    const auto below = [&](int level, const texel_box& box) { return alpha_below(texels_of(t, level), level, box, limit); };
    return limit > 0 && !t.facts().opaque && below(c.fine.level, job.fine) && (!c.two_levels || below(c.coarse.level, job.coarse));
  }

  constexpr bool has_one_colour(const texture_view& t, const span_job& job, rgba8& colour) {
    const span_coefficients& c = job.coefficients;
    rgba8 coarse{};
    return section_colour(t, c.fine, job.fine, false, colour) && (!c.two_levels || (section_colour(t, c.coarse, job.coarse, true, coarse) && coarse == colour));
  }

  // The colour of a section that has one. The last such box is remembered: boxes inside it are not read again.
  constexpr bool section_colour(const texture_view& t, const section& at, const texel_box& box, bool coarse, rgba8& colour) {
    coloured_section& seen = seen_[coarse];
    if (!(seen.valid && seen.level == at.level && seen.map == t.id(at.level) && contains(seen.box, box))) {
      if (!one_colour(texels_of(t, at.level), at.level, box, colour)) return false;
      if constexpr (Reads::counted) counters_.words_read += is_one_texel(at, box) || t.facts().uniform(at.level) ? 1 : section_reads(prof_, t, at, box, coarse);
      seen = {t.id(at.level), box, colour, at.level, true};
    }
    colour = seen.colour;
    return true;
  }

  static constexpr bool contains(const texel_box& outer, const texel_box& box) {
    return box.u0 >= outer.u0 && box.v0 >= outer.v0 && box.u1 <= outer.u1 && box.v1 <= outer.v1;
  }

  static constexpr bool is_one_texel_map(const surface& s) {
    return s.texture->width() == 1 && s.texture->height() == 1 && is_mean_of_texels(s.kind);
  }

  // No plan, no job: the map's only texel.
  constexpr status fill_span(const surface& s, int32_t sx, int32_t sy, span_mask mask) {
    const rgba8 colour = texels_of(*s.texture, 0).texel(0, 0, 0);
    ++skipped_.spans_constant;
    counters_.pixels += uint64_t(__builtin_popcountll(mask));
    if constexpr (Reads::counted) ++counters_.words_read;
    return write_alone(sx, sy, mask, [&](int) { return colour; });
  }

  // Pixels that the draw layer writes itself: after those of other surfaces that are still being computed there.
  template <class Colour>
  constexpr status write_alone(int32_t sx, int32_t sy, span_mask mask, Colour colour) {
    for (const pending_job& job : pending_)
      if ((pixels_of(job) & mask) != 0 && job.sx == sx && job.sy == sy) {
        SPANTEX_TRY(drain());
        break;
      }
    engine_.mark({event_kind::write, uint32_t(__builtin_popcountll(mask))});
    skipped_.pixels_written += uint64_t(__builtin_popcountll(mask));
    for (; mask != 0; mask &= mask - 1) {
      const int k = __builtin_ctzll(mask);
      write(shade_, sx, sy, k, colour(k));
    }
    return status::ok;
  }

  static constexpr span_mask pixels_of(const pending_job& job) {
    if constexpr (Skips::may(skip::constant))
      if (job.mask != 0 && job.pixels.mask != 0) return job.pixels.mask;
    return job.mask;
  }

  // Turns to the other half where that saves a load: what it computes is taken first, in order.
  constexpr status turn_to_held(const texture_view& t, const span_job& job) {
    const span_coefficients& c = job.coefficients;
    const auto held = [&](half h) { return int(holds(h, t, c.fine, job.fine, false)) + int(c.two_levels && holds(h, t, c.coarse, job.coarse, true)); };
    if (held(other(next_)) <= held(next_)) return status::ok;
    SPANTEX_TRY(drain());
    next_ = other(next_);
    ++skipped_.loads_in_other_half;
    return status::ok;
  }

  constexpr bool holds(half h, const texture_view& t, const section& at, const texel_box& box, bool coarse) const {
    const loaded_section& held = held_[int(h)][coarse];
    return held.valid && held.at.level == at.level && held.map == t.id(at.level) && contains(held.box, box);
  }

  // Loads a section unless the half holds it already. A held section serves every box inside it: a box that had
  // to be clamped is as large as its section, so it is inside only if it is the same one.
  constexpr status load(half h, const texture_view& t, section& at, const texel_box& box, bool coarse) {
    loaded_section& held = held_[int(h)][coarse];
    if (skips_.on(skip::held) && holds(h, t, at, box, coarse)) {
      at.origin_u = held.at.origin_u;
      at.origin_v = held.at.origin_v;
      ++counters_.loads_skipped;
      return status::ok;
    }
    held.valid = false;
    SPANTEX_TRY(send(h, t, at, box, coarse));
    if constexpr (Reads::counted) counters_.words_read += section_reads(prof_, t, at, box, coarse);
    held = {t.id(at.level), at, box, true};
    return status::ok;
  }

  // A section to the engine: texels as they lie in the map where it fetches those, else packed words.
  [[gnu::always_inline]] constexpr status send(half h, const texture_view& t, const section& at, const texel_box& box, bool coarse) {
    const auto& map = texels_of(t, at.level);
    if constexpr (fetching_engine<Engine>)
      if (t.format() == texel_format::rgba8888)
        return copy_section(prof_, t, at, box, coarse, [&](int first, const rgba8* texels, int count) {
          counters_.words_loaded += uint64_t(count + 1) / 2;
          return engine_.load_texels(h, first, texels, count);
        });
    return load_section(prof_, map, at, box, coarse, [&](int first, const uint64_t* words, int count) {
      counters_.words_loaded += uint64_t(count);
      return engine_.load_words(h, first, words, count);
    });
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
    if constexpr (Skips::switchable)
      if (job.show.unseen) { job.mask = 0; return status::ok; }
    if constexpr (Skips::may(skip::constant))
      if (job.pixels.mask != 0) {
        const rgba8 colour = pixels.pixel[__builtin_ctzll(job.mask)];
        job.mask = job.pixels.mask;
        for (rgba8& c : pixels.pixel) c = colour;
      }
    for (; job.mask != 0; job.mask &= job.mask - 1) {
      const int k = __builtin_ctzll(job.mask);
      write(job.shade, job.sx, job.sy, k, pixels.pixel[k]);
    }
    return status::ok;
  }

  constexpr void write(const typename Shading::job& shade, int32_t sx, int32_t sy, int k, rgba8 colour) {
    const int32_t x = sx * span_side + k % span_side, y = sy * span_side + k / span_side;
    rgba8& there = frame_.pixels[y * frame_.stride + x];
    if constexpr (Shading::enabled) count(shade, shade.write(colour, x, y, there, y * frame_.width + x));
    else there = colour;
  }

  constexpr rgba8 mean_of(const pending_job& job) const {
    if constexpr (Prof::has_linear_light)
      if (job.linear_light) return mean_linear_colour(sums_, prof_.get().colour_rounding);
    return mean_colour(sums_, prof_.get().colour_rounding);
  }

  constexpr void count(const typename Shading::job& shade, write_result result) {
    if constexpr (Skips::may(skip::opaque)) skipped_.pixels_opaque += shade.no_alpha;
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
  [[no_unique_address]] typename detail::only_if<Skips::may(skip::uniform) || Skips::may(skip::one_texel), coloured_sections>::type seen_{};
  [[no_unique_address]] Skips skips_;
  [[no_unique_address]] Reads reads_;
  [[no_unique_address]] typename detail::only_if<Skips::counted, skip_counters>::type skipped_{};
  [[no_unique_address]] typename detail::only_if<Skips::switchable, unseen>::type unseen_{};
  half next_ = half::first;
  bool single_half_ = false;
};

}  // namespace spantex
