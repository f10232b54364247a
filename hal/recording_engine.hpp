// SPDX-License-Identifier: Apache-2.0
// A decorator that writes down every operation with its arguments and its answer, and the replay of such a recording on any engine: the
// same operations in the same order, every answer and every pixel compared. Host only.
#pragma once
#include <stdint.h>

#include <string>

#include <hal/engine.hpp>
#include <hal/operation.hpp>
#include <hal/recording.hpp>
#include <spantex/filter.hpp>

namespace spantex {

template <span_engine Engine>
class recording_engine {
 public:
  // Both must outlive the decorator. Operations are appended to the log.
  recording_engine(Engine& engine, recording& log) : engine_(engine), log_(log) {}

  status load_coefficients(half h, const span_coefficients& c) {
    recorded_operation op{operation::load_coefficients, h, engine_.load_coefficients(h, c)};
    op.at = log_.coefficients.size();
    log_.coefficients.push_back(c);
    if (op.result == status::ok) partial_[int(h)] = c.axis.partial;
    return kept(op);
  }
  status load_words(half h, int first, const uint64_t* words, int count) {
    recorded_operation op{operation::load_words, h, engine_.load_words(h, first, words, count)};
    op.first = first;
    op.count = count;
    op.at = log_.words.size();
    if (count > 0) log_.words.insert(log_.words.end(), words, words + count);
    return kept(op);
  }
  status start(half h, span_mask mask) {
    recorded_operation op{operation::start, h, engine_.start(h, mask)};
    op.mask = mask;
    if (op.result == status::ok) started_[int(h)] = mask;
    return kept(op);
  }
  status take(half h, span_pixels& out) {
    recorded_operation op{operation::take, h, engine_.take(h, out)};
    if (op.result == status::ok) op.mask = started_[int(h)];
    op.partial = op.result == status::ok && partial_[int(h)];
    if (op.partial) {
      op.at = log_.sums.size();
      log_.sums.push_back(out.sums);
      return kept(op);
    }
    op.at = log_.pixels.size();
    for (span_mask rest = op.mask; rest != 0; rest &= rest - 1) log_.pixels.push_back(out.pixel[__builtin_ctzll(rest)]);
    return kept(op);
  }
  void mark(event what) {
    engine_.mark(what);
    recorded_operation op;
    op.note = what;
    (void)kept(op);
  }

 private:
  status kept(const recorded_operation& op) {
    log_.operations.push_back(op);
    return op.result;
  }

  Engine& engine_;
  recording& log_;
  span_mask started_[half_count] = {};
  bool partial_[half_count] = {};
};

// The first difference between a recording and its replay, if there is one.
struct replay_result {
  status result = status::ok;  // mismatch: an answer or a pixel differs
  size_t operation_index = 0;  // operations replayed, or the one that differs
  operation what = operation::mark;
  half which = half::first;
  int32_t span_x = 0, span_y = 0;  // of the latest span mark before the half was started
  int pixel = -1;                  // in the span, 8 y + x; -1: the answers differ
  status expected_status = status::ok, got_status = status::ok;
  rgba8 expected{}, got{};

  std::string text() const {
    if (result == status::ok) return "all " + std::to_string(operation_index) + " operations as recorded";
    std::string s = "operation " + std::to_string(operation_index) + ", " + to_string(what) + " of half " + std::to_string(int(which)) +
                    ", span (" + std::to_string(span_x) + ", " + std::to_string(span_y) + ")";
    if (pixel < 0) return s + ": recorded '" + to_string(expected_status) + "', got '" + to_string(got_status) + "'";
    return s + ", pixel (" + std::to_string(pixel % span_side) + ", " + std::to_string(pixel / span_side) + "): recorded " +
           colour(expected) + ", got " + colour(got);
  }

 private:
  static std::string colour(rgba8 c) {
    return std::to_string(c.r) + " " + std::to_string(c.g) + " " + std::to_string(c.b) + " " + std::to_string(c.a);
  }
};

namespace detail {

template <span_engine Engine>
status repeat_operation(const recording& log, const recorded_operation& op, Engine& engine, span_pixels& pixels) {
  switch (op.what) {
    case operation::load_coefficients: return engine.load_coefficients(op.which, log.coefficients[op.at]);
    case operation::load_words: return engine.load_words(op.which, op.first, log.words.data() + op.at, op.count);
    case operation::start: return engine.start(op.which, op.mask);
    case operation::take: return engine.take(op.which, pixels);
    case operation::mark: break;
  }
  engine.mark(op.note);
  return status::ok;
}

// The first pixel of a take that differs, or -1.
inline int differing_pixel(const recording& log, const recorded_operation& op, const span_pixels& got, rgba8& expected) {
  if (op.partial) {
    const footprint_sums& a = log.sums[op.at];
    const bool same = a == got.sums;
    if (!same) expected = mean_colour(a, rounding::nearest);
    return same ? -1 : __builtin_ctzll(op.mask);
  }
  size_t at = op.at;
  for (span_mask rest = op.mask; rest != 0; rest &= rest - 1, ++at) {
    const int k = __builtin_ctzll(rest);
    expected = log.pixels[at];
    if (!(got.pixel[k] == expected)) return k;
  }
  return -1;
}

}  // namespace detail

// Stops at the first difference.
template <span_engine Engine>
replay_result replay(const recording& log, Engine& engine) {
  uint32_t marked = 0, span_of[half_count] = {};
  replay_result r;
  for (const recorded_operation& op : log.operations) {
    if (op.what == operation::mark && op.note.kind == event_kind::span) marked = op.note.value;
    if (op.what == operation::start) span_of[int(op.which)] = marked;
    span_pixels pixels{};
    const status got = detail::repeat_operation(log, op, engine, pixels);
    rgba8 expected{};
    const int pixel = got == op.result && op.what == operation::take ? detail::differing_pixel(log, op, pixels, expected) : -1;
    if (got == op.result && pixel < 0) {
      ++r.operation_index;
      continue;
    }
    const uint32_t span = op.what == operation::take ? span_of[int(op.which)] : marked;
    r.result = status::mismatch;
    r.what = op.what;
    r.which = op.which;
    r.span_x = int32_t(span & 0xFFFF);
    r.span_y = int32_t(span >> 16);
    r.pixel = pixel;
    r.expected_status = op.result;
    r.got_status = got;
    if (pixel >= 0) { r.expected = expected; r.got = op.partial ? mean_colour(pixels.sums, rounding::nearest) : pixels.pixel[pixel]; }
    return r;
  }
  return r;
}

}  // namespace spantex
