// SPDX-License-Identifier: Apache-2.0
// The HAL: the port of a span engine, cut at span level. A backend is a plain class that models span_engine; calls are resolved
// at compile time, so on a device the contract costs nothing.
//
// An engine has two halves, each with a coefficient memory and a local texture memory. While one computes, the other is loaded:
//
//   load_words*  load_coefficients  start ............ take        half 0
//                                   load_words* load_coefficients  start ... take     half 1
//
// Contract (one conformance suite runs over every backend):
//   load_coefficients  half_busy while the half computes
//   load_words         half_busy while the half computes; bad_address beyond local memory (nothing is written then)
//   start              half_not_loaded without coefficients since the last take; half_busy if started already
//   take               half_not_started if not started; otherwise waits and delivers the pixels of the mask given to start;
//                      texels stay loaded, coefficients are used up
//   mark               a note for traces; never fails, changes nothing
// A backend whose loader fetches texels by itself has one operation more, which fetching_engine names:
//   load_texels        `count` texels of a row of the map, as they lie in global memory, for texel `first` of the half (texel_memory.hpp) and
//                      those behind it; half_busy and bad_address as load_words. They are fetched after start, and lie where they are until take
//
// A backend with hardware or wires behind it may also report device_error and device_timeout; the half is then empty.
#pragma once
#include <stdint.h>

#include <spantex/span.hpp>
#include <spantex/status.hpp>

namespace spantex {

enum class half : uint8_t { first, second };
inline constexpr int half_count = 2;
constexpr half other(half h) { return h == half::first ? half::second : half::first; }

enum class event_kind : uint8_t { span, frame_end, map_upload, write };
struct event {
  event_kind kind;
  uint32_t value;  // span: y << 16 | x; map_upload: 64-bit words into global texture memory; write: pixels that the draw layer writes without an engine
};

template <class T, class U> inline constexpr bool same_type = false;
template <class T> inline constexpr bool same_type<T, T> = true;
template <class T, class U> concept is_exactly = same_type<T, U>;

template <class E>
concept span_engine = requires(E& e, half h, const span_coefficients& c, const uint64_t* words, int n, span_mask mask, span_pixels& out,
                               event what) {
  { e.load_coefficients(h, c) } -> is_exactly<status>;
  { e.load_words(h, n, words, n) } -> is_exactly<status>;
  { e.start(h, mask) } -> is_exactly<status>;
  { e.take(h, out) } -> is_exactly<status>;
  { e.mark(what) } -> is_exactly<void>;
};

template <class E>
concept fetching_engine = span_engine<E> && requires(E& e, half h, const rgba8* texels, int n) {
  { e.load_texels(h, n, texels, n) } -> is_exactly<status>;
};

// The life of one half, the same in every backend that owns its state.
class half_life {
 public:
  constexpr status may_load() const { return busy_ ? status::half_busy : status::ok; }
  constexpr void coefficients_loaded() { ready_ = true; }
  constexpr status start() {
    if (busy_) return status::half_busy;
    if (!ready_) return status::half_not_loaded;
    busy_ = true;
    return status::ok;
  }
  constexpr status take() {
    if (!busy_) return status::half_not_started;
    busy_ = ready_ = false;
    return status::ok;
  }

 private:
  bool ready_ = false, busy_ = false;
};

}  // namespace spantex
